//! Derivatives of functions by differences.

/// Derivative at 0 of a function with vector values, by central differences of `step`, a half and a quarter of it, extrapolated
/// (Richardson): the error is of order `step⁶`, beside rounding divided by `step`. Where the function has no value on one side, by
/// differences on the other, of order `step⁴`.
///
/// # Errors
/// That of the function where it has no values on either side.
pub fn derivative<E>(
    mut value: impl FnMut(f64) -> Result<Vec<f64>, E>,
    step: f64,
) -> Result<Vec<f64>, E> {
    let central = |before: Vec<f64>, mut after: Vec<f64>, h: f64| {
        after.iter_mut().zip(&before).for_each(|(a, b)| *a = (*a - b) / (2.0 * h));
        after
    };
    match (value(-step), value(step)) {
        (Ok(before), Ok(after)) => {
            let coarse = central(before, after, step);
            let middle = central(value(-0.5 * step)?, value(0.5 * step)?, 0.5 * step);
            let mut fine = central(value(-0.25 * step)?, value(0.25 * step)?, 0.25 * step);
            for ((fine, middle), coarse) in fine.iter_mut().zip(&middle).zip(&coarse) {
                *fine = (64.0 * *fine - 20.0 * middle + coarse) / 45.0;
            }
            Ok(fine)
        }
        (Err(_), Ok(after)) => one_sided(value, after, step),
        (Ok(before), Err(_)) => one_sided(value, before, -step),
        (Err(error), Err(_)) => Err(error),
    }
}

fn one_sided<E>(
    mut value: impl FnMut(f64) -> Result<Vec<f64>, E>,
    far: Vec<f64>,
    step: f64,
) -> Result<Vec<f64>, E> {
    // At 1/4, 1/2, 3/4 and 1 of the step, each less the value at 0.
    const WEIGHTS: [f64; 4] = [16.0, -12.0, 16.0 / 3.0, -1.0];
    let here = value(0.0)?;
    let mut sum = vec![0.0; far.len()];
    let mut add = |weight: f64, there: &[f64]| {
        for (sum, (there, here)) in sum.iter_mut().zip(there.iter().zip(&here)) {
            *sum += weight * (there - here) / step;
        }
    };
    add(WEIGHTS[3], &far);
    for (k, weight) in WEIGHTS[..3].iter().enumerate() {
        add(*weight, &value(0.25 * (k + 1) as f64 * step)?);
    }
    Ok(sum)
}

#[cfg(test)]
mod tests {
    use super::derivative;

    #[test]
    fn smooth_functions_have_their_derivatives() {
        let value = |t: f64| Ok::<_, ()>(vec![(1.0 + t).ln(), (2.0 + t).powi(-4), 3.0 * t]);
        let found = derivative(value, 1e-2).unwrap();
        for (found, exact) in found.iter().zip([1.0, -4.0 / 32.0, 3.0]) {
            assert!((found - exact).abs() < 1e-12, "{found} {exact}");
        }
    }

    #[test]
    fn one_side_serves_where_the_other_has_no_value() {
        for sign in [-1.0, 1.0] {
            let value = |t: f64| if sign * t < 0.0 { Err(()) } else { Ok(vec![(1.0 + t).exp()]) };
            let found = derivative(value, 1e-2).unwrap()[0];
            assert!((found - 1.0_f64.exp()).abs() < 1e-10, "{found}");
        }
        assert_eq!(derivative(|_| Err::<Vec<f64>, _>(7), 1.0), Err(7));
    }
}
