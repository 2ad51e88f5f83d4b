//! How long the solves of a study take.

/// Median, 99 % and greatest of times in s, in words.
pub fn summary(mut times: Vec<f64>) -> String {
    times.sort_by(f64::total_cmp);
    let at = |share: f64| {
        let place = ((share * times.len() as f64) as usize).min(times.len().saturating_sub(1));
        1e3 * times.get(place).copied().unwrap_or(0.0)
    };
    let [median, most, slowest] = [0.5, 0.99, 1.0].map(at);
    format!("median {median:.2} ms, 99 % within {most:.1} ms, slowest {slowest:.1} ms")
}
