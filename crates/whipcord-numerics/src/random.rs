//! Pseudo-random numbers that are the same on every machine.
//!
//! Source: Steele, Lea and Flood, Fast splittable pseudorandom number generators, OOPSLA 2014 (SplitMix64).

/// A sequence of pseudo-random numbers.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SplitMix64(u64);

/// What the state grows by from one number to the next: 2⁶⁴ over the golden ratio, made odd.
const STEP: u64 = 0x9E37_79B9_7F4A_7C15;

impl SplitMix64 {
    /// The sequence of a seed.
    #[must_use]
    pub const fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// The next number.
    pub const fn next_u64(&mut self) -> u64 {
        let next = mixed(self.0);
        self.0 = self.0.wrapping_add(STEP);
        next
    }

    /// One of many independent sequences of a seed.
    #[must_use]
    pub const fn of(seed: u64, number: u64) -> Self {
        Self(seed ^ mixed(number))
    }

    /// The next number of a normal distribution with mean 0 and standard deviation 1 (Box and Muller).
    pub fn next_normal(&mut self) -> f64 {
        let radius = (-2.0 * (1.0 - self.next_part()).ln()).sqrt();
        radius * (core::f64::consts::TAU * self.next_part()).cos()
    }

    /// The next number in 0 … 1, 1 excluded.
    pub fn next_part(&mut self) -> f64 {
        part(self.next_u64())
    }
}

/// The number that follows from another as if at random: [`SplitMix64`] with this state.
#[must_use]
pub const fn mixed(state: u64) -> u64 {
    let mut z = state.wrapping_add(STEP);
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}

/// The upper 53 bits as a number in 0 … 1, 1 excluded.
#[must_use]
pub fn part(bits: u64) -> f64 {
    #[allow(clippy::cast_precision_loss, reason = "53 bits")]
    let upper = (bits >> 11) as f64;
    upper / 9_007_199_254_740_992.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sequence_is_the_published_one() {
        // The first numbers of seed 1234567, as the authors' own program prints them.
        let mut random = SplitMix64::new(1_234_567);
        let first = [0; 3].map(|_: u64| random.next_u64());
        assert_eq!(
            first,
            [6_457_827_717_110_365_317, 3_203_168_211_198_807_973, 9_817_491_932_198_370_423]
        );
    }

    #[test]
    fn normal_numbers_have_mean_zero_and_deviation_one() {
        let mut random = SplitMix64::of(3, 1);
        let numbers: Vec<f64> = (0..20_000).map(|_| random.next_normal()).collect();
        let mean = numbers.iter().sum::<f64>() / 20_000.0;
        let square = numbers.iter().map(|x| x * x).sum::<f64>() / 20_000.0;
        // Four standard deviations of the means.
        assert!(mean.abs() < 0.03 && (square - 1.0).abs() < 0.04, "{mean} {square}");
        assert_ne!(SplitMix64::of(3, 2).next_u64(), SplitMix64::of(3, 1).next_u64());
    }

    #[test]
    fn parts_are_below_one() {
        assert_eq!(part(0), 0.0);
        assert!(part(u64::MAX) < 1.0);
    }
}
