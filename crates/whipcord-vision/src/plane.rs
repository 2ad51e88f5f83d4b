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

    /// Blurred by a Gaussian of this standard deviation in pixels, the edges held. In place: beside the plane this needs
    /// as many of its rows as the Gaussian reaches.
    pub fn blurred(mut self, deviation: f64) -> Self {
        let kernel = gaussian(deviation);
        self.blur_rows(&kernel);
        self.blur_columns(&kernel);
        self
    }

    /// Weighted sums along each row, the middle of the kernel on the pixel.
    fn blur_rows(&mut self, kernel: &[f32]) {
        let reach = kernel.len() / 2;
        let mut padded = Vec::with_capacity(self.width + 2 * reach);
        for row in self.values.chunks_exact_mut(self.width) {
            let (first, last) = (row[0], row[self.width - 1]);
            padded.clear();
            padded.resize(reach, first);
            padded.extend_from_slice(row);
            padded.resize(self.width + 2 * reach, last);
            row.fill(0.0);
            for (k, &weight) in kernel.iter().enumerate() {
                add_scaled(row, weight, &padded[k..]);
            }
        }
    }

    /// The same along each column.
    fn blur_columns(&mut self, kernel: &[f32]) {
        let (width, reach) = (self.width, kernel.len() / 2);
        // The rows that have been overwritten and are still needed: row j in place j modulo their number.
        let mut before = vec![0.0; (reach + 1) * width];
        let kept = |row: usize| (row % (reach + 1)) * width..(row % (reach + 1) + 1) * width;
        for row in 0..self.height {
            let (upper, below) = self.values.split_at_mut((row + 1) * width);
            let current = &mut upper[row * width..];
            before[kept(row)].copy_from_slice(current);
            current.fill(0.0);
            for (k, &weight) in kernel.iter().enumerate() {
                let from = (row + k).saturating_sub(reach).min(self.height - 1);
                let values = match from.checked_sub(row + 1) {
                    Some(further) => &below[further * width..(further + 1) * width],
                    None => &before[kept(from)],
                };
                add_scaled(current, weight, values);
            }
        }
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

fn add_scaled(sums: &mut [f32], weight: f32, values: &[f32]) {
    for (sum, value) in sums.iter_mut().zip(values) {
        *sum += weight * value;
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_blur_is_the_weighted_sum_of_what_is_around() {
        for (width, height, deviation) in [(23, 17, 1.0), (5, 4, 2.5), (1, 9, 0.7)] {
            let values = (0..width * height).map(|i| (i * 7919 % 101) as f32 / 100.0).collect();
            let plane = Plane { width, height, values };
            let kernel = gaussian(deviation);
            let reach = (kernel.len() / 2) as i32;
            let blurred = plane.clone().blurred(deviation);
            for row in 0..height {
                for column in 0..width {
                    let held = |at: usize, off: i32, end: usize| {
                        (at as i32 + off).clamp(0, end as i32 - 1) as usize
                    };
                    let mut sum = 0.0;
                    for v in -reach..=reach {
                        for u in -reach..=reach {
                            let weight =
                                kernel[(u + reach) as usize] * kernel[(v + reach) as usize];
                            sum += weight * plane.get(held(column, u, width), held(row, v, height));
                        }
                    }
                    assert!((blurred.get(column, row) - sum).abs() < 1e-5, "{column} {row}");
                }
            }
        }
    }
}
