//! Random permutations of many numbers of which single values can be asked for without the others.

use whipcord_numerics::random::mixed;

/// A permutation of `0 … count − 1`, one for each key.
///
/// A balanced Feistel network permutes the numbers of an even number of bits; those beyond `count` are permuted again until one
/// is within (J. Black and P. Rogaway, Ciphers with arbitrary finite domains, 2002).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Permutation {
    count: u64,
    key: u64,
    half: u32,
}

const ROUNDS: u64 = 6;

impl Permutation {
    pub fn new(count: u64, key: u64) -> Self {
        let bits = u64::BITS - count.saturating_sub(1).leading_zeros();
        Self { count, key, half: bits.div_ceil(2).max(1) }
    }

    /// The value at a place below `count`.
    pub fn at(&self, place: u64) -> u64 {
        let mut value = place;
        loop {
            value = self.network(value);
            if value < self.count {
                return value;
            }
        }
    }

    fn network(&self, value: u64) -> u64 {
        let mask = (1_u64 << self.half) - 1;
        let (mut left, mut right) = (value >> self.half, value & mask);
        for round in 0..ROUNDS {
            let next = left ^ (mixed(self.key ^ mixed(right ^ (round << 56))) & mask);
            (left, right) = (right, next);
        }
        (left << self.half) | right
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_value_comes_once() {
        for count in [1, 2, 3, 5, 16, 17, 1000, 4096] {
            for key in 0..4 {
                let permutation = Permutation::new(count, key);
                let mut seen = vec![false; usize::try_from(count).unwrap()];
                for place in 0..count {
                    let value = usize::try_from(permutation.at(place)).unwrap();
                    assert!(!core::mem::replace(&mut seen[value], true), "{count} {key} {place}");
                }
            }
        }
    }

    #[test]
    fn keys_give_other_permutations() {
        let of =
            |key| (0..100).map(|place| Permutation::new(100, key).at(place)).collect::<Vec<_>>();
        assert_ne!(of(1), of(2));
        // Neighbours are torn apart.
        let fixed = of(1).iter().enumerate().filter(|(k, value)| *k as u64 == **value).count();
        assert!(fixed < 10, "{fixed}");
    }
}
