//! One number for each pixel.

/// One number for each pixel, row by row.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Plane {
    pub width: usize,
    pub height: usize,
    pub values: Vec<f32>,
}

impl Plane {
    pub fn new(width: usize, height: usize) -> Self {
        Self { width, height, values: vec![0.0; width * height] }
    }

    pub fn get(&self, column: usize, row: usize) -> f32 {
        self.values[row * self.width + column]
    }

    /// The value between pixels, linear in both directions; outside the picture that of its edge.
    pub fn at(&self, [u, v]: [f64; 2]) -> f32 {
        let u = u.clamp(0.0, (self.width - 1) as f64);
        let v = v.clamp(0.0, (self.height - 1) as f64);
        let (i, j) = (u as usize, v as usize);
        let (right, below) = ((i + 1).min(self.width - 1), (j + 1).min(self.height - 1));
        let (a, b) = ((u - i as f64) as f32, (v - j as f64) as f32);
        let upper = (1.0 - a) * self.get(i, j) + a * self.get(right, j);
        let lower = (1.0 - a) * self.get(i, below) + a * self.get(right, below);
        (1.0 - b) * upper + b * lower
    }

    /// Blurred by a Gaussian of this standard deviation in pixels, the edges held.
    pub fn blurred(&self, deviation: f64) -> Self {
        let kernel = gaussian(deviation);
        self.along(&kernel, 1, 0).along(&kernel, 0, 1)
    }

    /// Weighted sums along one direction, the middle of the kernel on the pixel.
    fn along(&self, kernel: &[f32], right: usize, down: usize) -> Self {
        let mut out = Self::new(self.width, self.height);
        let middle = kernel.len() / 2;
        let clamped = |at: usize, k: usize, step: usize, end: usize| {
            (at + k * step).saturating_sub(middle * step).min(end - 1)
        };
        for row in 0..self.height {
            for column in 0..self.width {
                let sum = kernel.iter().enumerate().map(|(k, weight)| {
                    let i = clamped(column, k, right, self.width);
                    let j = clamped(row, k, down, self.height);
                    weight * self.get(i, j)
                });
                out.values[row * self.width + column] = sum.sum();
            }
        }
        out
    }

    /// Means over squares of `factor` pixels a side. Square (i, j) has its centre at
    /// `factor·i + (factor − 1)/2` of the pixels before.
    pub fn shrunk(&self, factor: usize) -> Self {
        let mut out = Self::new((self.width / factor).max(1), (self.height / factor).max(1));
        let (width, height) = (self.width.min(factor), self.height.min(factor));
        for row in 0..out.height {
            for column in 0..out.width {
                let mut sum = 0.0;
                for j in 0..height {
                    for i in 0..width {
                        sum += self.get(column * factor + i, row * factor + j);
                    }
                }
                out.values[row * out.width + column] = sum / (width * height) as f32;
            }
        }
        out
    }
}

/// Weights of a Gaussian, at whole pixels, that sum to one.
fn gaussian(deviation: f64) -> Vec<f32> {
    let reach = (4.0 * deviation).ceil() as i32;
    let weights: Vec<f64> = (-reach..=reach)
        .map(|i| (-0.5 * (f64::from(i) / deviation.max(1e-6)).powi(2)).exp())
        .collect();
    let sum: f64 = weights.iter().sum();
    weights.iter().map(|w| (w / sum) as f32).collect()
}
