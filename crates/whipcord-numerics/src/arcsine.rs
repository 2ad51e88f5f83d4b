/// Below this argument the power series is summed; above it the closed form loses at most two
/// digits, and those in the second derivative.
const SERIES_LIMIT: f64 = 0.04;

/// `(2n)! / (4ⁿ n!² (2n+1))`, the coefficients of `asin(√x)/√x` in ascending powers of x.
const SERIES: [f64; 12] = [
    1.0,
    1.0 / 6.0,
    3.0 / 40.0,
    5.0 / 112.0,
    35.0 / 1152.0,
    63.0 / 2816.0,
    231.0 / 13_312.0,
    143.0 / 10_240.0,
    6435.0 / 557_056.0,
    12_155.0 / 1_245_184.0,
    46_189.0 / 5_505_024.0,
    88_179.0 / 12_058_624.0,
];

/// `A(x) = asin(√x)/√x` for 0 ≤ x < 1, with its first two derivatives.
///
/// It is analytic at 0, where the arcsine of a length is not: with x = sin²(φ/2) an angle is
/// φ = 2√x A, its square φ² = 4xA², and an arc is A times as long as its chord.
///
/// ```
/// let [a, da, _] = whipcord_numerics::asin_ratio(0.25);
/// assert!((a - std::f64::consts::FRAC_PI_3).abs() < 1e-15);
/// // 2xA′ + A = 1/√(1−x)
/// assert!((0.5 * da + a - 1.0 / 0.75_f64.sqrt()).abs() < 1e-14);
/// ```
#[inline]
#[must_use]
pub fn asin_ratio(x: f64) -> [f64; 3] {
    if x < SERIES_LIMIT {
        // Fewer terms reach the last bit where x is small, as it is between close disks.
        if x < 0.003 { series::<7>(x) } else { series::<12>(x) }
    } else {
        let s = x.sqrt();
        let c = (1.0 - x).sqrt();
        let a = s.asin() / s;
        // 2xA′ + A = 1/c and its derivative 2xA″ + 3A′ = 1/(2c³).
        let inverse = 1.0 / c;
        let da = (inverse - a) / (2.0 * x);
        let dda = (0.5 * inverse * inverse * inverse - 3.0 * da) / (2.0 * x);
        [a, da, dda]
    }
}

#[inline]
fn series<const N: usize>(x: f64) -> [f64; 3] {
    let mut p = [0.0; 3];
    for n in (0..N).rev() {
        p[2] = p[2] * x + p[1];
        p[1] = p[1] * x + p[0];
        p[0] = p[0] * x + SERIES[n];
    }
    [p[0], p[1], 2.0 * p[2]]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn satisfies_its_differential_equations_on_both_sides_of_every_switch() {
        for x in [0.0, 1e-12, 1e-4, 0.00299, 0.00301, 0.0399, 0.0401, 0.3, 0.9, 0.999] {
            let [a, da, dda] = asin_ratio(x);
            let c = f64::sqrt(1.0 - x);
            let first = 2.0 * x * da + a - 1.0 / c;
            let second = 2.0 * x * dda + 3.0 * da - 0.5 / (c * c * c);
            assert!(first.abs() < 1e-15 / c, "{x}: {first:e}");
            assert!(second.abs() < 1e-13 / (c * c * c), "{x}: {second:e}");
            if x > 1e-3 {
                assert!((a - x.sqrt().asin() / x.sqrt()).abs() < 1e-15 * a);
            }
        }
        let jump = asin_ratio(0.04)[1] - asin_ratio(0.04 - 1e-16)[1];
        assert!(jump.abs() < 1e-14);
    }
}
