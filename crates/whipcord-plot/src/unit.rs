//! Units that give readable numbers.

/// A unit: its name, and what SI numbers are multiplied by to be in it.
pub(crate) type Unit = (&'static str, f64);

const LENGTHS: [Unit; 4] = [("m", 1.0), ("mm", 1e3), ("µm", 1e6), ("nm", 1e9)];
const TIMES: [Unit; 4] = [("s", 1.0), ("ms", 1e3), ("µs", 1e6), ("ns", 1e9)];

/// Millimetres, or a smaller unit where the largest length is below a hundredth of one.
pub(crate) fn length(largest: f64) -> Unit {
    choose(&LENGTHS[1..], 100.0 * largest)
}

/// The unit of time in which the largest number is at least 1.
pub(crate) fn time(largest: f64) -> Unit {
    choose(&TIMES, largest)
}

fn choose(units: &[Unit], value: f64) -> Unit {
    // Nothing measures nothing: the first unit is as good as any.
    let fits = |unit: &&Unit| value * unit.1 >= 1.0 || value == 0.0;
    units.iter().find(fits).copied().unwrap_or(units[units.len() - 1])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_follow_the_size() {
        assert_eq!(length(0.004).0, "mm");
        assert_eq!(length(2.0).0, "mm");
        assert_eq!(length(0.0).0, "mm");
        assert_eq!(length(3e-6).0, "µm");
        assert_eq!(length(3e-14).0, "nm");
        assert_eq!(time(2.5e-6).0, "µs");
        assert_eq!(time(10.0).0, "s");
    }
}
