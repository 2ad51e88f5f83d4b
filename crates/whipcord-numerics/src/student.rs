//! Quantiles of Student's distribution.

/// The value that a variable with Student's distribution stays below with this probability; with
/// infinitely many degrees of freedom that of the normal distribution. NaN where there is none: degrees of
/// freedom that are not positive, a probability that is not between 0 and 1.
///
/// ```
/// use whipcord_numerics::student_quantile;
/// assert!((student_quantile(0.975, 5.0) - 2.570_581_835_636_314).abs() < 1e-12);
/// assert!((student_quantile(0.975, f64::INFINITY) - 1.959_963_984_540_054).abs() < 1e-12);
/// ```
#[must_use]
pub fn student_quantile(probability: f64, freedom: f64) -> f64 {
    if !(probability > 0.0 && probability < 1.0 && freedom > 0.0) {
        return f64::NAN;
    }
    if probability < 0.5 {
        return -student_quantile(1.0 - probability, freedom);
    }
    // Bisection: the tail falls with the value.
    let tail = 1.0 - probability;
    let (mut low, mut high) = (0.0, 1.0);
    while upper_tail(high, freedom) > tail && high < 1e150 {
        low = high;
        high *= 2.0;
    }
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            break;
        }
        if upper_tail(middle, freedom) > tail { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// The probability of a value above `t ≥ 0`: `½ I_x(ν/2, ½)` with `x = ν/(ν + t²)`
/// (Abramowitz and Stegun, Handbook of Mathematical Functions, 26.7.1).
fn upper_tail(t: f64, freedom: f64) -> f64 {
    // Beyond this the two distributions agree to rounding.
    if freedom > 1e15 {
        return 0.5 * complementary_error(t / core::f64::consts::SQRT_2);
    }
    let (a, b) = (0.5 * freedom, 0.5);
    let y = t * t / (freedom + t * t);
    let x = freedom / (freedom + t * t);
    // x^a y^b / B(a, b): the power by the logarithm of what is near 1.
    let log_beta = 0.5 * core::f64::consts::PI.ln() - half_step(a);
    let front = (a * (-y).ln_1p() + b * y.ln() - log_beta).exp();
    if t == 0.0 {
        0.5
    } else if x < (a + 1.0) / (a + b + 2.0) {
        0.5 * front * fraction(x, a, b) / a
    } else {
        0.5 * (1.0 - front * fraction(y, b, a) / b)
    }
}

/// The continued fraction of the incomplete beta function, 26.5.8, by Lentz's method.
fn fraction(x: f64, a: f64, b: f64) -> f64 {
    const LEAST: f64 = 1e-300;
    let keep = |value: f64| if value.abs() < LEAST { LEAST } else { value };
    let mut c = 1.0;
    let mut d = 1.0 / keep(1.0 - (a + b) * x / (a + 1.0));
    let mut value = d;
    for m in 1..10_000 {
        let m = f64::from(m);
        for term in [
            m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m)),
            -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0)),
        ] {
            d = 1.0 / keep(1.0 + term * d);
            c = keep(1.0 + term / c);
            value *= d * c;
        }
        if (c * d - 1.0).abs() < 1e-16 {
            break;
        }
    }
    value
}

/// `ln Γ(a + ½) − ln Γ(a)` for `a > 0`: its series in `1/a`, after the recurrence.
fn half_step(a: f64) -> f64 {
    let (mut a, mut below) = (a, 0.0);
    while a < 40.0 {
        below += (1.0 + 0.5 / a).ln();
        a += 1.0;
    }
    let z = 1.0 / (a * a);
    let series = (-1.0 / 8.0 + z * (1.0 / 192.0 - z * (1.0 / 640.0 - z * (17.0 / 14336.0)))) / a;
    0.5 * a.ln() + series - below
}

/// `erfc(x)` for `x ≥ 0`: the series 7.1.6 near zero, the continued fraction 7.1.14 beyond.
fn complementary_error(x: f64) -> f64 {
    let front = (-x * x).exp() / core::f64::consts::PI.sqrt();
    if x < 2.0 {
        let (mut term, mut sum) = (2.0 * x, 0.0);
        for n in 0..200 {
            sum += term;
            term *= 2.0 * x * x / (2.0 * f64::from(n) + 3.0);
        }
        1.0 - front * sum
    } else {
        let tail = (1..200).rev().fold(x, |below, n| x + 0.5 * f64::from(n) / below);
        front / tail
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `scipy.stats.t.ppf` of SciPy 1.17.1.
    #[test]
    fn agrees_with_scipy() {
        for (probability, freedom, value) in TABLE {
            let found = student_quantile(probability, freedom);
            assert!((found / value - 1.0).abs() < 1e-10, "{probability} {freedom}: {found}");
            assert_eq!(student_quantile(1.0 - probability, freedom) < 0.0, found > 0.0);
        }
        for (probability, freedom) in [(0.0, 3.0), (1.0, 3.0), (0.9, 0.0), (f64::NAN, 3.0)] {
            assert!(student_quantile(probability, freedom).is_nan());
        }
        assert!(student_quantile(0.5, 7.0).abs() < 1e-15);
    }

    const TABLE: [(f64, f64, f64); 8] = [
        (0.975, 1.0, 12.706_204_736_174_694),
        (0.975, 2.0, 4.302_652_729_749_462),
        (0.95, 3.0, 2.353_363_434_801_823_3),
        (0.975, 10.0, 2.228_138_851_986_274),
        (0.995, 29.0, 2.756_385_903_670_605),
        (0.975, 896.0, 1.962_615_127_984_448_1),
        (0.6, 1000000.0, 0.253_347_170_537_841_84),
        (0.975, f64::INFINITY, 1.959_963_984_540_054),
    ];
}
