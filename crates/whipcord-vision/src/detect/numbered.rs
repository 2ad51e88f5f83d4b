//! Marks with the numbers of the disks they are.

use super::{Base, DetectError, Expected, Mark, Search, find, in_order};
use crate::photo::Photo;

/// The row of disks or markers that a photograph shows, as far as it is known.
#[derive(Clone, Copy, Debug, Default)]
pub struct Row<'a> {
    /// How many there are, hidden ones included.
    pub count: Option<usize>,
    /// Where all of them are along the backbone in m, from the base; of no effect without a count.
    pub places: Option<&'a [f64]>,
    /// Numbers, from 1, of those that the photograph does not show.
    pub hidden: &'a [usize],
    /// Where the base is.
    pub base: Option<Base>,
}

/// What is looked for, from base to tip, each with its number from 1.
///
/// # Errors
/// [`DetectError`] when they are too few or too many, lie in no row, or the base cannot be told.
pub fn find_row(
    photo: &Photo,
    search: &Search<'_>,
    row: &Row<'_>,
) -> Result<Vec<(usize, Mark)>, DetectError> {
    let numbers = shown(row.hidden, row.count)?;
    let place = |number: &usize| Some(*row.places?.get(number - 1)?);
    let places: Option<Vec<f64>> =
        numbers.as_ref().and_then(|numbers| numbers.iter().map(place).collect());
    let expected = Expected {
        count: numbers.as_ref().map(Vec::len),
        places: places.as_deref(),
        base: row.base,
    };
    let marks = in_order(&find(photo, search)?, &expected)?;
    let numbers = numbers.unwrap_or_else(|| (1..=marks.len()).collect());
    Ok(numbers.into_iter().zip(marks).collect())
}

/// Numbers, from 1, of the disks that can be found, where it is known how many there are.
fn shown(hidden: &[usize], count: Option<usize>) -> Result<Option<Vec<usize>>, DetectError> {
    let Some(count) = count else {
        return if hidden.is_empty() { Ok(None) } else { Err(DetectError::HiddenOfHowMany) };
    };
    if let Some(&number) = hidden.iter().find(|&&number| !(1..=count).contains(&number)) {
        return Err(DetectError::NoSuchHidden { number, count });
    }
    Ok(Some((1..=count).filter(|number| !hidden.contains(number)).collect()))
}
