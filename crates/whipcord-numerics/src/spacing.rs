//! Equally spaced values between two ends.

/// This many values from `from` to `to` at equal distances, both ends exactly as given: `to * k / n` with k = n
/// may differ from `to` by rounding. A single value is `from`.
///
/// ```
/// use whipcord_numerics::equally_spaced;
///
/// let places: Vec<f64> = equally_spaced(0.0, 0.11, 81).collect();
/// assert_eq!(places.len(), 81);
/// assert_eq!([places[0], places[80]], [0.0, 0.11]);
/// ```
pub fn equally_spaced(from: f64, to: f64, count: usize) -> impl Iterator<Item = f64> + Clone {
    let last = count.saturating_sub(1);
    (0..count).map(move |k| match k {
        0 => from,
        k if k == last => to,
        k => from + (to - from) * k as f64 / last as f64,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ends_are_exact_and_nothing_lies_beyond_them() {
        for millimetres in 1..=2000 {
            for count in [2, 3, 7, 41, 81] {
                let (from, to) = (-1e-3, 1e-3 * f64::from(millimetres));
                let values: Vec<f64> = equally_spaced(from, to, count).collect();
                assert_eq!([values[0], values[count - 1]], [from, to]);
                assert!(values.windows(2).all(|pair| pair[0] < pair[1]), "{to}, {count}");
            }
        }
        assert_eq!(equally_spaced(1.0, 2.0, 0).count(), 0);
        assert_eq!(equally_spaced(1.0, 2.0, 1).collect::<Vec<_>>(), [1.0]);
    }
}
