//! What the films of all verbs have in common.

/// Width of a film in px.
pub const FILM_WIDTH: f64 = 720.0;
/// Direction from which films are seen, in rad: one for all pictures.
pub const AZIMUTH: f64 = -1.0;
/// How long a picture is seen at most, in ms.
const LONGEST: f64 = 10_000.0;

/// So many numbers below `count`, spread evenly, the last among them.
pub fn spread(count: usize, most: usize) -> impl Iterator<Item = usize> {
    let shown = count.min(most);
    (0..shown).map(move |k| match shown {
        1 => count - 1,
        _ => k * (count - 1) / (shown - 1),
    })
}

/// How long each picture is seen in ms, for the times in s at which they begin. The last is seen for a second, before the film begins again.
pub fn durations(times: &[f64]) -> Vec<u16> {
    let ends = times.iter().skip(1).copied().chain(times.last().map(|last| last + 1.0));
    #[expect(
        clippy::cast_sign_loss,
        clippy::cast_possible_truncation,
        reason = "within the limits"
    )]
    let milliseconds = |seconds: f64| (1e3 * seconds).clamp(1.0, LONGEST).round() as u16;
    times.iter().zip(ends).map(|(from, to)| milliseconds(to - from)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_are_spread_to_the_last_and_seen_for_their_times() {
        assert_eq!(spread(5, 9).collect::<Vec<_>>(), [0, 1, 2, 3, 4]);
        assert_eq!(spread(9, 3).collect::<Vec<_>>(), [0, 4, 8]);
        assert_eq!(spread(9, 1).collect::<Vec<_>>(), [8]);
        assert_eq!(durations(&[0.0, 0.04, 20.0]), [40, 10_000, 1000]);
    }
}
