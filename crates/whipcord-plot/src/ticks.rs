//! Round numbers that cover a range.

/// Fewest and most ticks on an axis.
pub(crate) const FEWEST: usize = 3;
pub(crate) const MOST: usize = 10;

/// Multiples of a round step.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Linear {
    pub values: Vec<f64>,
    /// Decimals that tell the values apart.
    pub decimals: usize,
}

/// Round numbers in geometric progression.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Logarithmic {
    pub values: Vec<LogTick>,
    /// Unlabelled numbers between them.
    pub minor: Vec<f64>,
}

/// `digit · 10^exponent`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LogTick {
    pub digit: u8,
    pub exponent: i32,
}

impl LogTick {
    /// The number nearest to it, so that 3 · 10⁻¹ is written as 0.3.
    pub fn value(self) -> f64 {
        let Self { digit, exponent } = self;
        format!("{digit}e{exponent}").parse().unwrap_or(f64::INFINITY)
    }
}

/// Exact where the power is: `powi` is off by a bit or two for negative exponents.
pub(crate) fn power_of_ten(exponent: i32) -> f64 {
    format!("1e{exponent}").parse().unwrap_or(f64::INFINITY)
}

/// The smallest of 1, 2 and 5 times a power of ten that is not below `least`, as digit and
/// exponent.
pub(crate) fn round_up(least: f64) -> (f64, i32) {
    let exponent = least.log10().floor() as i32;
    for (digit, exponent) in
        [(1.0, exponent), (2.0, exponent), (5.0, exponent), (1.0, exponent + 1)]
    {
        if digit * power_of_ten(exponent) >= least * (1.0 - 1e-12) {
            return (digit, exponent);
        }
    }
    (2.0, exponent + 1)
}

/// `digit · 10^exponent · k` without the rounding of `0.1 · 3`.
fn multiple(k: f64, digit: f64, exponent: i32) -> f64 {
    if exponent < 0 {
        k * digit / power_of_ten(-exponent)
    } else {
        k * digit * power_of_ten(exponent)
    }
}

/// At most `most` (5 or more) ticks from at most `low` to at least `high`.
pub(crate) fn linear(low: f64, high: f64, most: usize) -> Linear {
    let (low, high) = widened(low, high);
    let intervals = most.max(5) as f64 - 1.0;
    let (mut digit, mut exponent) = round_up((high - low) / intervals);
    loop {
        let step = multiple(1.0, digit, exponent);
        // A limit that is a multiple up to rounding needs no further step.
        let first = (low / step + 1e-9).floor();
        let last = (high / step - 1e-9).ceil().max(first + 1.0);
        if last - first <= intervals {
            // Two ticks show no scale.
            let last = last.max(first + 2.0);
            let values =
                (0..=(last - first) as usize).map(|i| multiple(first + i as f64, digit, exponent));
            return Linear {
                values: values.collect(),
                decimals: usize::try_from(-exponent).unwrap_or(0),
            };
        }
        (digit, exponent) = match digit as u8 {
            1 => (2.0, exponent),
            2 => (5.0, exponent),
            _ => (1.0, exponent + 1),
        };
    }
}

/// Multiples of a round step inside a range: of a step of at least `least_step`, or of the largest below it of which the
/// range has two, since one tick shows no scale.
pub(crate) fn inside(low: f64, high: f64, least_step: f64) -> Linear {
    // Of any step that is no longer than half of the range there are two multiples inside.
    let (mut digit, mut exponent) = round_up(least_step);
    loop {
        let step = multiple(1.0, digit, exponent);
        let (first, last) = ((low / step - 1e-9).ceil(), (high / step + 1e-9).floor());
        let count = if last >= first { (last - first).min(1000.0) as usize + 1 } else { 0 };
        if count >= 2 || 2.0 * step <= high - low || high <= low {
            return Linear {
                values: (0..count).map(|i| multiple(first + i as f64, digit, exponent)).collect(),
                decimals: usize::try_from(-exponent).unwrap_or(0),
            };
        }
        (digit, exponent) = match digit as u8 {
            1 => (5.0, exponent - 1),
            2 => (1.0, exponent),
            _ => (2.0, exponent),
        };
    }
}

/// A range with some width, so that steps are not lost in the rounding of its limits.
fn widened(low: f64, high: f64) -> (f64, f64) {
    let (low, high) = if low <= high { (low, high) } else { (high, low) };
    let largest = low.abs().max(high.abs());
    if largest == 0.0 {
        (0.0, 1.0)
    } else if high - low < 1e-6 * largest {
        (low - 0.1 * largest, high + 0.1 * largest)
    } else {
        (low, high)
    }
}

/// At most `most` (5 or more) ticks from at most `low` to at least `high`, both positive.
pub(crate) fn logarithmic(low: f64, high: f64, most: usize) -> Logarithmic {
    let (low, high) = if low <= high { (low, high) } else { (high, low) };
    let most = most.max(5);
    // From the finest: every digit, the usual three, and whole decades at growing distances.
    let candidates = [&[1_u8, 2, 3, 4, 5, 6, 7, 8, 9][..], &[1, 2, 5]]
        .into_iter()
        .map(|digits| digit_ticks(low, high, digits))
        .chain((1..).map(|stride| decade_ticks(low, high, stride)));
    let mut values = Vec::new();
    for candidate in candidates {
        if candidate.len() <= most {
            values = candidate;
            break;
        }
    }
    while values.len() < FEWEST {
        // Only whole decades can be so few, or a range that hardly is one.
        let next =
            values.last().map_or(LogTick { digit: 1, exponent: 0 }, |&t| after(t, &[1, 2, 5]));
        values.push(next);
    }
    let minor = minor(&values);
    Logarithmic { values, minor }
}

fn decade(value: f64) -> i32 {
    let mut exponent = value.log10().floor() as i32;
    // The logarithm of a power of ten may fall just short of a whole number.
    if power_of_ten(exponent + 1) <= value * (1.0 + 1e-12) {
        exponent += 1;
    }
    exponent
}

fn after(tick: LogTick, digits: &[u8]) -> LogTick {
    match digits.iter().find(|&&d| d > tick.digit) {
        Some(&digit) => LogTick { digit, ..tick },
        None => LogTick { digit: 1, exponent: tick.exponent + 1 },
    }
}

fn digit_ticks(low: f64, high: f64, digits: &[u8]) -> Vec<LogTick> {
    let mut tick = LogTick { digit: 1, exponent: decade(low) };
    loop {
        let next = after(tick, digits);
        if next.value() > low * (1.0 + 1e-9) {
            break;
        }
        tick = next;
    }
    let mut values = vec![tick];
    // One more than any axis takes is enough to be refused.
    while tick.value() < high * (1.0 - 1e-9) && values.len() <= MOST {
        tick = after(tick, digits);
        values.push(tick);
    }
    values
}

fn decade_ticks(low: f64, high: f64, stride: i32) -> Vec<LogTick> {
    let first = decade(low).div_euclid(stride) * stride;
    let mut last = first;
    while power_of_ten(last) < high * (1.0 - 1e-9) {
        last += stride;
    }
    (first..=last)
        .step_by(usize::try_from(stride).unwrap_or(1))
        .map(|exponent| LogTick { digit: 1, exponent })
        .collect()
}

fn minor(values: &[LogTick]) -> Vec<f64> {
    let (Some(first), Some(last)) = (values.first(), values.last()) else {
        return Vec::new();
    };
    let decades = last.exponent - first.exponent;
    let digits: &[u8] = if decades > 10 { &[1] } else { &[1, 2, 3, 4, 5, 6, 7, 8, 9] };
    let mut minor = Vec::new();
    let mut tick = after(*first, digits);
    while tick.value() < last.value() * (1.0 - 1e-9) {
        if !values.contains(&tick) {
            minor.push(tick.value());
        }
        tick = after(tick, digits);
    }
    minor
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn is_round(step: f64) -> bool {
        // The difference of two ticks is rounded, and may be above the round step.
        let (digit, exponent) = round_up(step * (1.0 - 1e-6));
        (step / multiple(1.0, digit, exponent) - 1.0).abs() < 1e-6
    }

    proptest! {
        #[test]
        fn linear_ticks_cover_the_range_in_round_steps(
            low in -1e3..1e3_f64,
            width in 0.0..1e3_f64,
            magnitude in -12..12_i32,
            most in 5..=MOST,
        ) {
            let scale = power_of_ten(magnitude);
            let (low, high) = (low * scale, (low + width) * scale);
            let Linear { values, .. } = linear(low, high, most);
            prop_assert!((FEWEST..=most).contains(&values.len()), "{values:?}");
            let slack = 1e-6 * (high - low).abs().max(1e-3 * high.abs());
            prop_assert!(values[0] <= low + slack);
            prop_assert!(values[values.len() - 1] >= high - slack);
            let step = values[1] - values[0];
            prop_assert!(is_round(step), "{values:?}");
            for pair in values.windows(2) {
                prop_assert!((pair[1] - pair[0] - step).abs() < 1e-6 * step);
            }
        }

        #[test]
        fn decimals_tell_the_ticks_apart(low in -50.0..50.0_f64, width in 1e-3..100.0_f64) {
            let Linear { values, decimals } = linear(low, low + width, MOST);
            let mut labels: Vec<String> =
                values.iter().map(|v| format!("{v:.decimals$}")).collect();
            for (label, value) in labels.iter().zip(&values) {
                prop_assert!((label.parse::<f64>().unwrap() - value).abs() < 1e-9 * width);
            }
            labels.dedup();
            prop_assert_eq!(labels.len(), values.len());
        }

        #[test]
        fn logarithmic_ticks_cover_the_range(
            low in -18.0..6.0_f64,
            width in 0.0..20.0_f64,
            most in 5..=MOST,
        ) {
            let (low, high) = (10_f64.powf(low), 10_f64.powf(low + width));
            let Logarithmic { values, minor } = logarithmic(low, high, most);
            prop_assert!((FEWEST..=most).contains(&values.len()), "{values:?}");
            prop_assert!(values[0].value() <= low * (1.0 + 1e-8));
            prop_assert!(values[values.len() - 1].value() >= high * (1.0 - 1e-8));
            prop_assert!(values.windows(2).all(|w| w[0].value() < w[1].value()));
            prop_assert!(minor.len() < 120);
        }

        #[test]
        fn ticks_inside_are_inside(
            low in -1.0..0.0_f64, width in 0.1..5.0_f64, step in 0.01..1.0_f64
        ) {
            let high = low + width;
            for v in inside(low, high, step).values {
                prop_assert!(v > low - 1e-6 && v < high + 1e-6);
            }
        }
    }

    #[test]
    fn ticks_below_one_are_short_numbers() {
        let values: Vec<String> =
            logarithmic(0.38, 0.56, 8).values.iter().map(|t| t.value().to_string()).collect();
        assert_eq!(values, ["0.3", "0.4", "0.5", "0.6"]);
    }

    #[test]
    fn everyday_ranges() {
        assert_eq!(linear(0.0, 1.0, 6).values, [0.0, 0.2, 0.4, 0.6, 0.8, 1.0]);
        assert_eq!(linear(0.0, 0.3, 5).values, [0.0, 0.1, 0.2, 0.3]);
        assert_eq!(linear(0.0, 0.0, 6).values, [0.0, 0.2, 0.4, 0.6, 0.8, 1.0]);
        let sections: Vec<f64> =
            logarithmic(5.0, 320.0, 8).values.into_iter().map(LogTick::value).collect();
        assert_eq!(sections, [5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0]);
        let errors = logarithmic(3e-13, 0.04, 8).values;
        assert!(errors.iter().all(|t| t.digit == 1));
        assert_eq!(inside(-4.0, 4.0, 1.5).values, [-4.0, -2.0, 0.0, 2.0, 4.0]);
        // Labels are to be 20 apart, of which the range has only 0.
        assert_eq!(inside(-18.0, 18.0, 20.0).values, [-10.0, 0.0, 10.0]);
        assert_eq!(inside(3.0, 3.0, 1.0).values, [3.0]);
    }
}
