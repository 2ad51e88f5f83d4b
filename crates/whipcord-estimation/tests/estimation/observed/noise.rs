//! Numbers that are drawn in the same way each time.

/// Uniform and normal numbers from a seed (Marsaglia's xorshift, Box and Muller).
pub struct Noise(u64);

impl Noise {
    pub fn of(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1)
    }

    /// From 0 to 1.
    pub fn uniform(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        ((self.0 >> 11) as f64 + 0.5) / (1u64 << 53) as f64
    }

    pub fn between(&mut self, least: f64, most: f64) -> f64 {
        least + (most - least) * self.uniform()
    }

    pub fn normal(&mut self) -> f64 {
        let (a, b) = (self.uniform(), self.uniform());
        (-2.0 * a.ln()).sqrt() * (core::f64::consts::TAU * b).cos()
    }

    /// A pixel that is off by this standard deviation.
    pub fn beside(&mut self, pixel: [f64; 2], deviation: f64) -> [f64; 2] {
        pixel.map(|x| x + deviation * self.normal())
    }
}
