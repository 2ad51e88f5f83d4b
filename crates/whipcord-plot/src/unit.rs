//! Units that give readable numbers.

/// A unit: its name, and what SI numbers are multiplied by to be in it.
pub(crate) type Unit = (&'static str, f64);

const LENGTHS: [Unit; 4] = [("m", 1.0), ("mm", 1e3), ("µm", 1e6), ("nm", 1e9)];
const TIMES: [Unit; 4] = [("s", 1.0), ("ms", 1e3), ("µs", 1e6), ("ns", 1e9)];

const FORCES: [Unit; 4] = [("kN", 1e-3), ("N", 1.0), ("mN", 1e3), ("µN", 1e6)];
const MOMENTS: [Unit; 4] = [("kN·m", 1e-3), ("N·m", 1.0), ("mN·m", 1e3), ("µN·m", 1e6)];
const LINE_FORCES: [Unit; 4] = [("kN/m", 1e-3), ("N/m", 1.0), ("mN/m", 1e3), ("µN/m", 1e6)];
const LINE_MOMENTS: [Unit; 3] = [("N·m/m", 1.0), ("mN·m/m", 1e3), ("µN·m/m", 1e6)];
const MASSES: [Unit; 3] = [("kg", 1.0), ("g", 1e3), ("mg", 1e6)];

/// The unit of force in which a number is at least 1.
pub(crate) fn force(size: f64) -> Unit {
    choose(&FORCES, size)
}

/// The same of moments.
pub(crate) fn moment(size: f64) -> Unit {
    choose(&MOMENTS, size)
}

/// The same of forces for each metre.
pub(crate) fn line_force(size: f64) -> Unit {
    choose(&LINE_FORCES, size)
}

/// The same of moments for each metre.
pub(crate) fn line_moment(size: f64) -> Unit {
    choose(&LINE_MOMENTS, size)
}

/// The same of masses.
pub(crate) fn mass(size: f64) -> Unit {
    choose(&MASSES, size)
}

/// A quantity in SI, written in a unit.
pub(crate) fn written(value: f64, (name, factor): Unit) -> String {
    format!("{} {name}", digits(value * factor))
}

/// Three digits that count, and none that do not.
pub(crate) fn digits(value: f64) -> String {
    let size = value.abs();
    if size != 0.0 && !(1e-4..1e6).contains(&size) {
        return format!("{value:.2e}").replace('-', "−");
    }
    let decimals = if size == 0.0 { 0.0 } else { (2.0 - size.log10().floor()).max(0.0) };
    let text = format!("{value:.0$}", decimals as usize);
    let text =
        if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    text.replace('-', "−")
}

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
        assert_eq!(written(0.02, force(0.02)), "20 mN");
        assert_eq!(written(3.0, force(3.0)), "3 N");
        assert_eq!(written(0.018, mass(0.018)), "18 g");
        assert_eq!(written(1234.5, line_force(1234.5)), "1.23 kN/m");
    }

    #[test]
    fn numbers_have_the_digits_that_count() {
        let texts = [0.0, 9.81, 0.6, 123.4, 0.012_345, 20.0, 1e9].map(digits);
        assert_eq!(texts, ["0", "9.81", "0.6", "123", "0.0123", "20", "1.00e9"]);
    }
}
