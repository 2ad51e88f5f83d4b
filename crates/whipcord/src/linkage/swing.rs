//! A rotation about an axis across the tangent, and the arc that bends by it, with two derivatives.

use whipcord_numerics::{Mat3, Vec3};

/// The rotation `exp(b̂)` with `b = (b_x, b_y, 0)` in rad.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Swing {
    pub rotation: Mat3,
    /// What a change of `b_x` and of `b_y` turns it about: the first columns of the left Jacobian.
    pub turn: [Vec3; 2],
    /// `∂turn[a]/∂b[c]`.
    pub turn_by: [[Vec3; 2]; 2],
    /// Where an arc of unit length ends that starts along z and bends by `b`, and its derivatives.
    pub arc: Vec3,
    pub arc_by: [Vec3; 2],
    pub arc_by_twice: [[Vec3; 2]; 2],
}

impl Swing {
    pub fn new(x: f64, y: f64) -> Self {
        let b = Vec3::new(x, y, 0.0);
        let (square, parts) = (b.norm_squared(), [x, y]);
        let [[c2, d2, e2], [c3, d3, e3]] = coefficients(square);
        // sin β/β = 1 − β² c₃ and its derivatives by β².
        let (s, ds, dds) = (1.0 - square * c3, -c3 - square * d3, -2.0 * d3 - square * e3);
        let axes = [Vec3::X, Vec3::Y];
        let across = axes.map(|e| e.cross(Vec3::Z));
        let to_side = b.cross(Vec3::Z);
        let skew = Mat3::skew(b);
        let twice = |a: usize| b * parts[a] - axes[a] * square;
        let mut swing = Self {
            rotation: (skew * s + (skew * skew) * c2).plus_identity(),
            arc: Vec3::Z * s + to_side * c2,
            ..Self::default()
        };
        for a in 0..2 {
            let by_a = 2.0 * parts[a];
            swing.turn[a] = axes[a] + b.cross(axes[a]) * c2 + twice(a) * c3;
            swing.arc_by[a] = Vec3::Z * (ds * by_a) + to_side * (d2 * by_a) + across[a] * c2;
            for c in 0..2 {
                let by_c = 2.0 * parts[c];
                let same = if a == c { 1.0 } else { 0.0 };
                swing.turn_by[a][c] = b.cross(axes[a]) * (d2 * by_c)
                    + axes[c].cross(axes[a]) * c2
                    + twice(a) * (d3 * by_c)
                    + (axes[c] * parts[a] + b * same - axes[a] * by_c) * c3;
                swing.arc_by_twice[a][c] = Vec3::Z * (dds * by_a * by_c + 2.0 * same * ds)
                    + to_side * (e2 * by_a * by_c + 2.0 * same * d2)
                    + across[c] * (d2 * by_a)
                    + across[a] * (d2 * by_c);
            }
        }
        swing
    }

    /// The same with derivatives by `b` where this is the swing of `part · b`; the arc is that of `part` of the length.
    pub fn of_part(mut self, part: f64) -> Self {
        let square = part * part;
        self.arc *= part;
        self.turn = self.turn.map(|v| v * part);
        self.arc_by = self.arc_by.map(|v| v * square);
        self.turn_by = self.turn_by.map(|row| row.map(|v| v * square));
        self.arc_by_twice = self.arc_by_twice.map(|row| row.map(|v| v * (square * part)));
        self
    }

    /// The same where the arc is longer, by what makes its chord for the whole bend `b = (x, y)` as long as the link.
    pub fn with_chord(mut self, x: f64, y: f64) -> Self {
        let [stretch, slope, curve] = arc_over_chord(x * x + y * y);
        let by = [x, y].map(|part| 2.0 * part * slope);
        let (arc, arc_by) = (self.arc, self.arc_by);
        for a in 0..2 {
            self.arc_by[a] = arc_by[a] * stretch + arc * by[a];
            for c in 0..2 {
                let same = if a == c { 2.0 * slope } else { 0.0 };
                let twice = 4.0 * [x, y][a] * [x, y][c] * curve + same;
                self.arc_by_twice[a][c] = self.arc_by_twice[a][c] * stretch
                    + arc_by[a] * by[c]
                    + arc_by[c] * by[a]
                    + arc * twice;
            }
        }
        self.arc *= stretch;
        self
    }
}

/// `(β/2)/sin(β/2)`, how much longer an arc is than its chord, and its first two derivatives by `x = β²`.
pub(super) fn arc_over_chord(x: f64) -> [f64; 3] {
    let [_, [f, d, e]] = half_bend(x);
    let inverse = 1.0 / f;
    let square = inverse * inverse;
    [inverse, -d * square, (2.0 * d * d * inverse - e) * square]
}

/// `cos(β/2)` and `sin(β/2)/(β/2)`, each with its first two derivatives by `x = β²`.
pub(super) fn half_bend(x: f64) -> [[f64; 3]; 2] {
    const SERIES: f64 = 1.0;
    let quarter = 0.25 * x;
    let [f0, f1] = if quarter < SERIES {
        [series::<0>(quarter), series::<1>(quarter)]
    } else {
        let half = quarter.sqrt();
        let (sin, cos) = half.sin_cos();
        let f1 = sin / half;
        // `2x f₁′ = f₀ − f₁` and `2f₀′ = −f₁`.
        let d1 = (cos - f1) / (2.0 * quarter);
        let d0 = -0.5 * f1;
        [[cos, d0, -0.5 * d1], [f1, d1, (d0 - 3.0 * d1) / (2.0 * quarter)]]
    };
    [f0, f1].map(|[f, d, e]| [f, 0.25 * d, 0.0625 * e])
}

/// Of `c₂ = (1 − cos β)/β²` and `c₃ = (β − sin β)/β³` the value and two derivatives by `x = β²`.
fn coefficients(x: f64) -> [[f64; 3]; 2] {
    // Below, the closed forms lose digits; the series is exact to rounding up to there.
    const SERIES: f64 = 1.0;
    if x < SERIES {
        return [series::<2>(x), series::<3>(x)];
    }
    // With `f_n = Σ (−x)^k/(2k + n)!`: `2x f_n′ = f_{n−1} − n f_n`.
    let beta = x.sqrt();
    let (sin, cos) = beta.sin_cos();
    let f1 = sin / beta;
    let (f2, f3) = ((1.0 - cos) / x, (1.0 - f1) / x);
    let half = 0.5 / x;
    let d1 = (cos - f1) * half;
    let d2 = (f1 - 2.0 * f2) * half;
    let d3 = (f2 - 3.0 * f3) * half;
    [[f2, d2, (d1 - 4.0 * d2) * half], [f3, d3, (d2 - 5.0 * d3) * half]]
}

/// `Σ (−x)^k/(2k + N)!` and its first two derivatives, for N up to 3.
fn series<const N: usize>(x: f64) -> [f64; 3] {
    const TERMS: usize = 11;
    let n = N as f64;
    let mut term = [1.0, 1.0, 0.5, 1.0 / 6.0][N];
    let mut sum = [0.0; 3];
    let mut powers = [1.0, 0.0, 0.0];
    for k in 0..TERMS {
        let k = k as f64;
        for (sum, power) in sum.iter_mut().zip(powers) {
            *sum += term * power;
        }
        // The power x^(k+1) and its derivatives.
        powers = [powers[0] * x, (k + 1.0) * powers[0], (k + 1.0) * powers[1]];
        term /= -(2.0 * k + n + 1.0) * (2.0 * k + n + 2.0);
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use whipcord_numerics::{Pose, Twist};

    fn columns(swing: &Swing) -> Vec<Vec3> {
        let mut all = vec![swing.arc];
        all.extend(swing.turn);
        all.extend(swing.arc_by);
        all
    }

    #[test]
    fn it_is_the_exponential() {
        for (x, y) in [(0.0, 0.0), (1e-9, -2e-9), (0.3, 0.2), (0.9, 0.4), (-2.0, 1.5), (0.0, 6.0)] {
            let swing = Swing::new(x, y);
            let angular = Vec3::new(x, y, 0.0);
            let exact = Pose::exp(Twist { linear: Vec3::Z, angular });
            let off = swing.rotation - exact.rotation.to_matrix();
            assert!(off.rows.iter().all(|row| row.max_abs() < 1e-14), "{x} {y}");
            assert!((swing.arc - exact.position).max_abs() < 1e-14, "{x} {y}");
        }
    }

    #[test]
    fn its_derivatives_are_those_of_differences() {
        let step = 1e-5;
        // On both sides of where the series ends.
        for (x, y) in [(0.0, 0.0), (0.2, -0.5), (0.7, 0.7), (0.75, 0.75), (-1.8, 1.1)] {
            let at = |dx: f64, dy: f64| Swing::new(x + dx, y + dy);
            let swing = at(0.0, 0.0);
            for (c, (dx, dy)) in [(step, 0.0), (0.0, step)].into_iter().enumerate() {
                let (ahead, behind) = (at(dx, dy), at(-dx, -dy));
                let slope: Vec<Vec3> = columns(&ahead)
                    .iter()
                    .zip(columns(&behind))
                    .map(|(a, b)| (*a - b) / (2.0 * step))
                    .collect();
                let mut exact = vec![swing.arc_by[c]];
                exact.extend([0, 1].map(|a| swing.turn_by[a][c]));
                exact.extend([0, 1].map(|a| swing.arc_by_twice[a][c]));
                for (a, b) in slope.iter().zip(exact) {
                    assert!((*a - b).max_abs() < 1e-9, "{x} {y}: {a:?} {b:?}");
                }
                // The rotation's change is its turn about the column.
                let spin = (ahead.rotation - behind.rotation) * (0.5 / step);
                let turned = spin - Mat3::skew(swing.turn[c]) * swing.rotation;
                assert!(turned.rows.iter().all(|row| row.max_abs() < 1e-9), "{x} {y}");
            }
        }
    }
}
