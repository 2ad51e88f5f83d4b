//! The order from base to tip.
//!
//! Marks are neighbours when they are joined by the shortest tree through all of them. A robot's marks make that a
//! row, as long as they are closer to their neighbours than to others; its ends are the base and the tip.

use super::bars::distance;
use super::{DetectError, Mark};

/// Where the base is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Base {
    /// The end further to the left.
    Left,
    /// The end further to the right.
    Right,
    /// The upper end.
    Top,
    /// The lower end.
    Bottom,
    /// The end nearer to this pixel.
    Near([f64; 2]),
}

/// What is known of the marks before they are found.
#[derive(Clone, Copy, Debug, Default)]
pub struct Expected<'a> {
    /// How many there are.
    pub count: Option<usize>,
    /// Where they are along the backbone, from the base: as many as [`Self::count`]. Then an order that fits the
    /// distances only from the other end is noticed, and without a base the better order is taken where one fits
    /// clearly better.
    pub places: Option<&'a [f64]>,
    /// Where the base is.
    pub base: Option<Base>,
}

/// A gap of as many usual ones has room for another mark.
const GAP: f64 = 1.6;
/// Ends that differ by less, in usual distances, are not told apart.
const TELLING: f64 = 0.5;

/// Marks in order from base to tip, all of them and as many as expected.
///
/// # Errors
/// [`DetectError`] when they are too few or too many, lie in no row, or the base cannot be told.
pub fn in_order(marks: &[Mark], expected: &Expected<'_>) -> Result<Vec<Mark>, DetectError> {
    if let Some(count) = expected.count.filter(|&count| marks.len() > count) {
        let mut sure: Vec<&Mark> = marks.iter().collect();
        sure.sort_by(|a, b| b.confidence.total_cmp(&a.confidence));
        return Err(DetectError::TooMany {
            found: pixels(marks),
            expected: count,
            least_sure: sure[count..].iter().map(|mark| mark.pixel).collect(),
        });
    }
    let too_few = |row: &[Mark], gaps: Vec<usize>| {
        let expected = expected.count.unwrap_or(2);
        DetectError::TooFew { found: pixels(row), expected, gaps }
    };
    if marks.len() < 2 {
        // One mark has no order, but a count of one is met by it.
        let met = expected.count == Some(marks.len());
        return if met { Ok(marks.to_vec()) } else { Err(too_few(marks, Vec::new())) };
    }
    let row = row(marks);
    if let Some(count) = expected.count.filter(|&count| marks.len() < count) {
        return Err(match row {
            Ok(row) => {
                // From either end where the base is not known.
                let row = from_base(row.clone(), expected).unwrap_or(row);
                let gaps = if row.len() >= 4 { gaps(&row) } else { Vec::new() };
                let room = count - marks.len();
                too_few(&row, gaps.into_iter().take(room).collect())
            }
            Err(_) => too_few(marks, Vec::new()),
        });
    }
    let row = from_base(row?, expected)?;
    let gaps = gaps(&row);
    if expected.count.is_none() && row.len() >= 4 && !gaps.is_empty() {
        return Err(DetectError::Gap { found: pixels(&row), gaps });
    }
    Ok(row)
}

fn pixels(marks: &[Mark]) -> Vec<[f64; 2]> {
    marks.iter().map(|mark| mark.pixel).collect()
}

fn steps(row: &[Mark]) -> Vec<f64> {
    row.windows(2).map(|pair| distance(pair[0].pixel, pair[1].pixel)).collect()
}

/// After which marks, from 1, another would fit in: where the way to the next is long beside both of its
/// neighbours'.
fn gaps(row: &[Mark]) -> Vec<usize> {
    let steps = steps(row);
    let beside = |i: usize| {
        let before = i.checked_sub(1).map(|i| steps[i]);
        let most = before.into_iter().chain(steps.get(i + 1).copied()).fold(0.0, f64::max);
        if most > 0.0 { most } else { f64::INFINITY }
    };
    (0..steps.len()).filter(|&i| steps[i] > GAP * beside(i)).map(|i| i + 1).collect()
}

/// The marks along the shortest tree that joins them (Prim), if it is a row.
fn row(marks: &[Mark]) -> Result<Vec<Mark>, DetectError> {
    let count = marks.len();
    let mut neighbours: Vec<Vec<usize>> = vec![Vec::new(); count];
    // To each mark outside the tree: the nearest one inside, and how far that is.
    let far = |to: usize, i: usize| distance(marks[to].pixel, marks[i].pixel);
    let mut nearest: Vec<(usize, f64)> = (0..count).map(|i| (0, far(0, i))).collect();
    let mut outside: Vec<usize> = (1..count).collect();
    while let Some(at) =
        (0..outside.len()).min_by(|&a, &b| nearest[outside[a]].1.total_cmp(&nearest[outside[b]].1))
    {
        let new = outside.swap_remove(at);
        let from = nearest[new].0;
        neighbours[new].push(from);
        neighbours[from].push(new);
        for &i in &outside {
            let way = far(new, i);
            if way < nearest[i].1 {
                nearest[i] = (new, way);
            }
        }
    }
    if let Some(branch) = neighbours.iter().position(|list| list.len() > 2) {
        return Err(DetectError::NoRow { found: pixels(marks), at: marks[branch].pixel });
    }
    let first = neighbours.iter().position(|list| list.len() == 1).unwrap_or(0);
    let mut order = vec![first];
    let mut before = first;
    while let Some(&next) =
        order.last().and_then(|&last| neighbours[last].iter().find(|&&i| i != before))
    {
        before = order[order.len() - 1];
        order.push(next);
    }
    Ok(order.into_iter().map(|i| marks[i]).collect())
}

/// The row, turned so that it begins at the base.
fn from_base(mut row: Vec<Mark>, expected: &Expected<'_>) -> Result<Vec<Mark>, DetectError> {
    let (Some(&first), Some(&last)) = (row.first(), row.last()) else { return Ok(row) };
    let ends = [first.pixel, last.pixel];
    let ambiguous = DetectError::AmbiguousBase { ends };
    let mut steps = steps(&row);
    let fits = expected.places.and_then(|places| {
        let fit = [misfit(&steps, places, false)?, misfit(&steps, places, true)?];
        // A view shortens some distances more than others: only a clear difference tells.
        let clear = fit[0].min(fit[1]) < 0.5 * fit[0].max(fit[1]) && fit[0].max(fit[1]) > 0.1;
        clear.then_some(fit)
    });
    let usual = super::median(&mut steps);
    let turned = match expected.base {
        Some(base) => {
            let rank = |[u, v]: [f64; 2]| match base {
                Base::Left => u,
                Base::Right => -u,
                Base::Top => v,
                Base::Bottom => -v,
                Base::Near(pixel) => distance(pixel, [u, v]),
            };
            let (a, b) = (rank(ends[0]), rank(ends[1]));
            if (a - b).abs() < TELLING * usual {
                return Err(ambiguous);
            }
            b < a
        }
        None => match fits {
            Some([forward, reversed]) => reversed < forward,
            None => return Err(ambiguous),
        },
    };
    if let Some([forward, reversed]) = fits {
        let [here, there] = if turned { [reversed, forward] } else { [forward, reversed] };
        if there < here {
            let base = ends[usize::from(turned)];
            return Err(DetectError::Mirrored { base, forward: here, reversed: there });
        }
    }
    if turned {
        row.reverse();
    }
    Ok(row)
}

/// Relative deviation of the steps from those of the robot, at the best common scale; `None` where there are not as
/// many.
fn misfit(steps: &[f64], places: &[f64], reversed: bool) -> Option<f64> {
    let mut wanted: Vec<f64> = places.windows(2).map(|pair| (pair[1] - pair[0]).abs()).collect();
    if wanted.len() != steps.len() || steps.iter().chain(&wanted).any(|&step| step <= 0.0) {
        return None;
    }
    if reversed {
        wanted.reverse();
    }
    let ratios: Vec<f64> = steps.iter().zip(&wanted).map(|(a, b)| (a / b).ln()).collect();
    let mean = ratios.iter().sum::<f64>() / ratios.len() as f64;
    let variance = ratios.iter().map(|r| (r - mean).powi(2)).sum::<f64>() / ratios.len() as f64;
    Some(variance.sqrt())
}
