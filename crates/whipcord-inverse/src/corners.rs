//! Bounds of sums `Σ ±xₖ` over all signs: what a box of coordinates leaves of a linear function, which is greatest at a corner.

use whipcord::Vec3;

/// Terms of which all signs are tried.
const MOST: usize = 10;
/// Terms of no more than this part of the greatest count by their norm alone.
const SMALL: f64 = 0.02;

/// The signs that change from one corner to the next, in the order of Gray's code, and whether they become negative. Opposite corners are alike: the sign of the last of the terms stays.
fn changes(terms: usize) -> impl Iterator<Item = (usize, bool)> {
    (1_u32..1 << terms.saturating_sub(1)).map(|corner| {
        let k = corner.trailing_zeros();
        (k as usize, (corner ^ (corner >> 1)) >> k & 1 == 1)
    })
}

/// An upper bound of the greatest norm of `Σ ±xₖ`, whose square is given; infinite for more terms than there is time for. Small terms are taken out.
pub(crate) fn greatest_sum<const N: usize>(
    x: &mut Vec<[Vec3; N]>,
    squared: impl Fn(&[Vec3; N]) -> f64,
) -> f64 {
    let largest = x.iter().map(&squared).fold(0.0, f64::max);
    let mut small = 0.0;
    x.retain(|of| {
        let size = squared(of);
        let is_small = size <= SMALL * SMALL * largest;
        if is_small {
            small += size.sqrt();
        }
        !is_small
    });
    if x.len() > MOST {
        return f64::INFINITY;
    }
    let mut sum = [Vec3::ZERO; N];
    for of in &*x {
        sum.iter_mut().zip(of).for_each(|(sum, of)| *sum += *of);
    }
    let mut greatest = squared(&sum);
    for (k, is_negative) in changes(x.len()) {
        let twice = if is_negative { -2.0 } else { 2.0 };
        sum.iter_mut().zip(&x[k]).for_each(|(sum, of)| *sum += *of * twice);
        greatest = greatest.max(squared(&sum));
    }
    greatest.sqrt() + small
}

/// An upper bound of the greatest norm of `Σ ±±xⱼₖ` over the signs of rows and of columns of a square matrix; infinite for more rows than there is time for. The matrix and the sums are overwritten.
pub(crate) fn greatest_product(x: &mut [Vec3], n: usize, sums: &mut Vec<Vec3>) -> f64 {
    if n == 0 {
        return 0.0;
    }
    let norm = |row: &[Vec3]| row.iter().map(|of| of.norm()).sum::<f64>();
    let largest = x.chunks_exact(n).map(norm).fold(0.0, f64::max);
    let (mut small, mut rows) = (0.0, 0);
    for row in 0..n {
        let size = norm(&x[n * row..n * (row + 1)]);
        if size <= SMALL * largest {
            small += size;
            continue;
        }
        x.copy_within(n * row..n * (row + 1), n * rows);
        rows += 1;
    }
    if rows > MOST {
        return f64::INFINITY;
    }
    sums.clear();
    sums.resize(n, Vec3::ZERO);
    for row in x.chunks_exact(n).take(rows) {
        sums.iter_mut().zip(row).for_each(|(sum, of)| *sum += *of);
    }
    let mut greatest = norm(sums);
    for (row, is_negative) in changes(rows) {
        let twice = if is_negative { -2.0 } else { 2.0 };
        let row = &x[n * row..n * (row + 1)];
        sums.iter_mut().zip(row).for_each(|(sum, of)| *sum += *of * twice);
        greatest = greatest.max(norm(sums));
    }
    greatest + small
}

#[cfg(test)]
mod tests {
    use super::*;
    use whipcord_numerics::random::SplitMix64;

    fn sign(corner: usize, of: usize) -> f64 {
        if corner >> of & 1 == 1 { -1.0 } else { 1.0 }
    }

    /// Vectors of which some are small.
    fn vectors(random: &mut SplitMix64, count: usize) -> Vec<Vec3> {
        let mut part = || 2.0 * random.next_part() - 1.0;
        let scale = |k: usize| if k % 3 == 1 { 1e-3 } else { 1.0 };
        (0..count).map(|k| Vec3::new(part(), part(), part()) * scale(k)).collect()
    }

    #[test]
    fn bounds_are_those_of_all_corners_but_for_small_terms() {
        let mut random = SplitMix64::new(5);
        for n in 0..6 {
            for _ in 0..20 {
                let x = vectors(&mut random, n);
                let sum = |corner: usize| {
                    (0..n).fold(Vec3::ZERO, |sum, k| sum + x[k] * sign(corner, k)).norm()
                };
                let exact = (0..1 << n).map(sum).fold(0.0, f64::max);
                let mut terms = x.iter().map(|x| [*x]).collect();
                let bound = greatest_sum(&mut terms, |[x]| x.norm_squared());
                let most = exact * 1.01 + 1e-15;
                assert!((exact..=most).contains(&(bound * (1.0 + 1e-12))), "{exact} {bound}");

                let x: Vec<Vec3> = (0..n).flat_map(|_| vectors(&mut random, n)).collect();
                let product = |corner: usize, other: usize| {
                    let pairs = (0..n).flat_map(|j| (0..n).map(move |k| (j, k)));
                    let each = pairs.map(|(j, k)| x[n * j + k] * sign(corner, j) * sign(other, k));
                    each.fold(Vec3::ZERO, |sum, of| sum + of).norm()
                };
                let corners = (0..1 << n).flat_map(|a| (0..1 << n).map(move |b| (a, b)));
                let exact = corners.map(|(a, b)| product(a, b)).fold(0.0, f64::max);
                let bound = greatest_product(&mut x.clone(), n, &mut Vec::new());
                assert!(exact <= bound * (1.0 + 1e-12) && bound <= exact * 3.0, "{exact} {bound}");
            }
        }
    }
}
