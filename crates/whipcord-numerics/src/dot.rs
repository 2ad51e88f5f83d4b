/// Sums that do not wait for one another.
const LANES: usize = 8;

/// The scalar product of two vectors, of as many entries as the shorter one has. Its sums are in an order of their own, which is the
/// same on every processor.
///
/// ```
/// assert_eq!(whipcord_numerics::dot(&[1.0, 2.0, 3.0], &[4.0, 5.0, 6.0]), 32.0);
/// ```
#[inline]
#[must_use]
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    let n = a.len().min(b.len());
    let (a, b) = (&a[..n], &b[..n]);
    let ((a, rest_of_a), (b, rest_of_b)) = (a.as_chunks::<LANES>(), b.as_chunks::<LANES>());
    let mut sums = [0.0; LANES];
    for (a, b) in a.iter().zip(b) {
        for ((sum, a), b) in sums.iter_mut().zip(a).zip(b) {
            *sum += a * b;
        }
    }
    let rest: f64 = rest_of_a.iter().zip(rest_of_b).map(|(a, b)| a * b).sum();
    let [a, b, c, d, e, f, g, h] = sums;
    ((a + b) + (c + d)) + ((e + f) + (g + h)) + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_of_any_length_are_summed() {
        for n in 0..40_u32 {
            let a: Vec<f64> = (0..n).map(f64::from).collect();
            // Whole numbers have no rounding: 0² + 1² + … + (n − 1)².
            let squares = (1..n.max(1)).map(|i| i * i).sum::<u32>();
            assert_eq!(dot(&a, &a), f64::from(squares));
        }
    }
}
