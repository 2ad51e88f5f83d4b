//! Medians and other quantiles.

/// The middle value; the values are sorted in part. NaN-free and not empty.
pub(super) fn median<T: Copy + PartialOrd + Default>(values: &mut [T]) -> T {
    if values.is_empty() {
        return T::default();
    }
    let k = rank(values.len() as u64, 0.5) as usize;
    let order = |a: &T, b: &T| a.partial_cmp(b).unwrap_or(core::cmp::Ordering::Equal);
    *values.select_nth_unstable_by(k, order).1
}

/// The middle one of the values that each call gives anew.
pub(super) fn median_of<I: Iterator<Item = f32>>(values: impl Fn() -> I) -> f32 {
    quantile_of(values, 0.5)
}

/// The value that this share of the values lie below, of values that each call gives anew; 0 of none. Exact: the
/// values are counted by the upper half of their bits, and those that agree in it with the one that is looked for by
/// the lower half. A copy of them to sort would take as much memory as they do.
pub(super) fn quantile_of<I: Iterator<Item = f32>>(values: impl Fn() -> I, share: f64) -> f32 {
    let mut counts = vec![0_u64; 1 << 16];
    values().for_each(|value| counts[(ordered(value) >> 16) as usize] += 1);
    let all: u64 = counts.iter().sum();
    if all == 0 {
        return 0.0;
    }
    let mut rank = rank(all, share);
    let upper = place(&counts, &mut rank);
    counts.fill(0);
    values()
        .map(ordered)
        .filter(|bits| bits >> 16 == upper)
        .for_each(|bits| counts[(bits & 0xffff) as usize] += 1);
    number(upper << 16 | place(&counts, &mut rank))
}

/// The number of the value, from 0, that this share of all lie below.
fn rank(all: u64, share: f64) -> u64 {
    ((all - 1) as f64 * share).round() as u64
}

/// Where the counts, summed up, exceed the rank; which is then that among what is counted there.
fn place(counts: &[u64], rank: &mut u64) -> u32 {
    let mut place = 0;
    while place + 1 < counts.len() && counts[place] <= *rank {
        *rank -= counts[place];
        place += 1;
    }
    place as u32
}

/// Bits that have the order of the numbers.
fn ordered(value: f32) -> u32 {
    let bits = value.to_bits();
    if bits >> 31 == 1 { !bits } else { bits | 1 << 31 }
}

/// The number of these bits.
fn number(ordered: u32) -> f32 {
    f32::from_bits(if ordered >> 31 == 1 { ordered & !(1 << 31) } else { !ordered })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counted_quantiles_are_those_of_sorted_values() {
        let mut values: Vec<f32> =
            (0..1000).map(|k| ((k * 7919 % 1000) as f32 - 400.0) * 1e-3).collect();
        values.extend([0.25, 0.25, 0.25, -1e30, 1e30, 1e-40, -1e-40]);
        let mut sorted = values.clone();
        sorted.sort_by(f32::total_cmp);
        for share in [0.0, 0.001, 0.3, 0.5, 0.7, 0.9999, 1.0] {
            let k = ((values.len() - 1) as f64 * share).round() as usize;
            assert_eq!(quantile_of(|| values.iter().copied(), share), sorted[k], "{share}");
        }
        assert_eq!(median_of(|| values.iter().copied()), median(&mut values.clone()));
        assert_eq!(median_of(|| [3.5_f32].into_iter()), 3.5);
        assert_eq!(median_of(core::iter::empty), 0.0);
    }
}
