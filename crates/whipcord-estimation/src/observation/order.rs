//! Whether markers are numbered from the wrong end.

/// Whether markers fit a model far better in opposite order, as where the tip was taken for the base: the root mean
/// square is three times less. Of each its arc length in m, where it was seen and where the model has it;
/// all in one image, or all in space.
#[must_use]
pub fn is_reversed<const N: usize>(markers: &[(f64, [f64; N], [f64; N])]) -> bool {
    let mut order: Vec<_> = markers.iter().collect();
    order.sort_by(|a, b| a.0.total_cmp(&b.0));
    let square = |a: &[f64; N], b: &[f64; N]| -> f64 {
        a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum()
    };
    let own: f64 = order.iter().map(|(_, seen, model)| square(seen, model)).sum();
    let pairs = order.iter().zip(order.iter().rev());
    let opposite: f64 = pairs.map(|((_, seen, _), (_, _, model))| square(seen, model)).sum();
    markers.len() >= 3 && 9.0 * opposite < own
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_opposite_order_is_seen() {
        // A quarter of a circle, seen to a tenth of the distance between markers.
        let at = |i: usize, off: f64| {
            let angle = i as f64 * 0.15;
            [angle.sin() + off, 1.0 - angle.cos() - off]
        };
        let marker = |seen: usize, model: usize| {
            (model as f64, at(seen, 0.015 * (-1f64).powi(seen as i32)), at(model, 0.0))
        };
        let right: Vec<_> = (0..10).map(|i| marker(i, i)).collect();
        let wrong: Vec<_> = (0..10).rev().map(|i| marker(9 - i, i)).collect();
        assert!(!is_reversed(&right) && is_reversed(&wrong));
        // Two say nothing, and neither does a model that is far off either way.
        assert!(!is_reversed(&wrong[..2]));
        let far: Vec<_> = (0..10).map(|i| (i as f64, at(9 - i, 0.0), [5.0, -(i as f64)])).collect();
        assert!(!is_reversed(&far));
    }
}
