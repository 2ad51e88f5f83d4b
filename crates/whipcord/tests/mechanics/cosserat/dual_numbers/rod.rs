//! A rod of dual numbers.

use core::f64::consts::{PI, TAU};
use core::ops::Neg;

use super::dual::{Dual, V, c, cross, dot, minus, plus, solve, times};

pub const LENGTH: f64 = 0.2;
/// Steps of each half of the rod.
pub const STEPS: usize = if cfg!(debug_assertions) { 100 } else { 200 };

/// A rod whose numbers are given by their place in a list, so that any of them can be differentiated
/// by: E, ν, d, ρ, u* (3), gravity (3), tip force (3), tip moment (3), force and moment halfway (6),
/// dead force and moment per metre (6), those that turn with the rod (6), then eight for each cable:
/// command, and what its course takes. Unknown are the base moment, the tensions where lengths are given,
/// and the force at the base of what turns with the rod, where anything does.
pub struct Rod {
    pub kinds: Vec<usize>,
    pub by_length: bool,
    pub follows: bool,
}

pub const SPREAD: usize = 22;
pub const RODS_OWN: usize = SPREAD + 12;
pub const PER_CABLE: usize = 8;

/// What a shot leaves at the tip, and where it ends.
pub struct Shot {
    pub miss: Vec<Dual>,
    /// Position and rotation halfway and at the tip.
    pub frames: [(V, [V; 3]); 2],
    pub lengths: Vec<Dual>,
}

impl Rod {
    fn cable<'a>(&self, numbers: &'a [Dual], i: usize) -> &'a [Dual] {
        &numbers[RODS_OWN + PER_CABLE * i..RODS_OWN + PER_CABLE * (i + 1)]
    }

    /// The second cable ends halfway.
    fn reaches(&self, i: usize, half: usize) -> bool {
        half == 0 || i != 1
    }

    fn course(&self, numbers: &[Dual], i: usize, s: f64) -> (V, V) {
        let n = self.cable(numbers, i);
        let polar = |angle: Dual, rate: Dual, radius: Dual| {
            let (sin, cos) = angle.sin_cos();
            let slope = radius * rate;
            ([radius * cos, radius * sin, c(0.0)], [-(slope * sin), slope * cos, c(0.0)])
        };
        match self.kinds[i] {
            0 => polar(n[1], c(0.0), n[2]),
            1 => {
                let rate = n[2] * c(TAU / LENGTH);
                polar(n[1] + rate * c(s), rate, n[3])
            }
            2 => {
                let (dx, dy) = ((n[3] - n[1]) * c(1.0 / LENGTH), (n[4] - n[2]) * c(1.0 / LENGTH));
                ([n[1] + dx * c(s), n[2] + dy * c(s), c(0.0)], [dx, dy, c(0.0)])
            }
            _ => {
                let at = |a: Dual, b: Dual, d: Dual| a + b * c(s) + d * c(s * s);
                let slope = |b: Dual, d: Dual| b + d * c(2.0 * s);
                (
                    [at(n[1], n[2], n[3]), at(n[4], n[5], n[6]), c(0.0)],
                    [slope(n[2], n[3]), slope(n[5], n[6]), c(0.0)],
                )
            }
        }
    }

    /// What is left of the six equations of a section.
    #[expect(clippy::too_many_arguments, reason = "a section and all that acts on it")]
    fn residual(
        &self,
        n: &[Dual],
        tensions: &[Dual],
        s: f64,
        half: usize,
        force: V,
        moment: V,
        x: &[Dual; 6],
    ) -> [Dual; 6] {
        let (v, u) = ([x[0], x[1], x[2]], [x[3], x[4], x[5]]);
        let shear = n[0] / (c(2.0) * (c(1.0) + n[1]));
        let area = c(PI / 4.0) * n[2] * n[2];
        let second = c(PI / 64.0) * n[2] * n[2] * n[2] * n[2];
        let (ga, ea) = (shear * area, n[0] * area);
        let (ei, gj) = (n[0] * second, c(2.0) * shear * second);
        let mut f = minus([ga * v[0], ga * v[1], ea * (v[2] - c(1.0))], force);
        let mut m = minus([ei * (u[0] - n[4]), ei * (u[1] - n[5]), gj * (u[2] - n[6])], moment);
        for (i, tension) in tensions.iter().enumerate() {
            if self.reaches(i, half) {
                let (r, slope) = self.course(n, i, s);
                let along = plus(plus(v, cross(u, r)), slope);
                let pull = times(*tension / dot(along, along).sqrt(), along);
                f = plus(f, pull);
                m = plus(m, cross(r, pull));
            }
        }
        [f[0], f[1], f[2], m[0], m[1], m[2]]
    }

    /// The strain of a section, by Newton's method, and its derivative by the implicit function
    /// theorem on the six equations.
    #[expect(clippy::too_many_arguments, reason = "a section and all that acts on it")]
    fn strain(
        &self,
        n: &[Dual],
        tensions: &[Dual],
        s: f64,
        half: usize,
        force: V,
        moment: V,
        guess: &mut [f64; 6],
    ) -> (V, V) {
        let value = |list: &[Dual]| list.iter().map(|d| c(d.0)).collect::<Vec<_>>();
        let (plain, pulls) = (value(n), value(tensions));
        let (f, m) = (force.map(|d| c(d.0)), moment.map(|d| c(d.0)));
        let jacobian = |x: &[f64; 6]| -> Vec<Vec<f64>> {
            let columns: Vec<[Dual; 6]> = (0..6)
                .map(|j| {
                    let x = core::array::from_fn(|i| Dual(x[i], if i == j { 1.0 } else { 0.0 }));
                    self.residual(&plain, &pulls, s, half, f, m, &x)
                })
                .collect();
            (0..6).map(|i| columns.iter().map(|column| column[i].1).collect()).collect()
        };
        for _ in 0..30 {
            let left = self.residual(&plain, &pulls, s, half, f, m, &guess.map(c));
            let step = solve(jacobian(guess), left.iter().map(|d| d.0).collect());
            for (x, d) in guess.iter_mut().zip(&step) {
                *x -= d;
            }
            if step[..3].iter().all(|d| d.abs() < 1e-9) && step[3..].iter().all(|d| d.abs() < 1e-7)
            {
                break;
            }
        }
        let left = self.residual(n, tensions, s, half, force, moment, &guess.map(c));
        let rates = solve(jacobian(guess), left.iter().map(|d| -d.1).collect());
        let x: Vec<Dual> = guess.iter().zip(&rates).map(|(x, d)| Dual(*x, *d)).collect();
        ([x[0], x[1], x[2]], [x[3], x[4], x[5]])
    }

    /// From the base, for a base moment and, where lengths are given, tensions.
    pub fn shoot(&self, n: &[Dual], unknown: &[Dual]) -> Shot {
        let cables = self.kinds.len();
        let tensions: Vec<Dual> = (0..cables)
            .map(|i| if self.by_length { unknown[3 + i] } else { self.cable(n, i)[0] })
            .collect();
        let line = n[3] * c(PI / 4.0) * n[2] * n[2];
        let gravity = [n[7], n[8], n[9]];
        let vector = |i: usize| [n[i], n[i + 1], n[i + 2]];
        // R by columns, p, M; then lengths, those at rest, and the force of what turns with the rod.
        let last = 15 + 2 * cables;
        let mut state = vec![c(0.0); last + 3];
        if self.follows {
            state[last..].copy_from_slice(&unknown[unknown.len() - 3..]);
        }
        (state[0], state[4], state[8]) = (c(1.0), c(1.0), c(1.0));
        state[12..15].copy_from_slice(&unknown[..3]);
        let mut guess = [0.0, 0.0, 1.0, n[4].0, n[5].0, n[6].0];
        let mut frames = [([c(0.0); 3], [[c(0.0); 3]; 3]); 2];
        for half in 0..2 {
            let mut rate = |s: f64, y: &[Dual]| -> Vec<Dual> {
                let axes: [V; 3] = [0, 3, 6].map(|k| [y[k], y[k + 1], y[k + 2]]);
                let mut force = plus([n[10], n[11], n[12]], times(line * c(LENGTH - s), gravity));
                if half == 0 {
                    force = plus(force, [n[16], n[17], n[18]]);
                }
                force = plus(force, times(c(LENGTH - s), vector(SPREAD)));
                force = plus(force, [y[last], y[last + 1], y[last + 2]]);
                let moment = [y[12], y[13], y[14]];
                let body = |a: V| axes.map(|axis| dot(axis, a));
                let (v, u) =
                    self.strain(n, &tensions, s, half, body(force), body(moment), &mut guess);
                let turned = |a: V| {
                    plus(plus(times(a[0], axes[0]), times(a[1], axes[1])), times(a[2], axes[2]))
                };
                let mut out = Vec::with_capacity(y.len());
                for k in 0..3 {
                    // Column k of R û.
                    let unit: V = core::array::from_fn(|i| c(if i == k { 1.0 } else { 0.0 }));
                    out.extend(turned(cross(u, unit)));
                }
                let velocity = turned(v);
                out.extend(velocity);
                let turning = plus(vector(SPREAD + 3), turned(vector(SPREAD + 9)));
                out.extend(minus(cross(force, velocity), turning));
                let mut rest = Vec::new();
                for i in 0..cables {
                    let (r, slope) = self.course(n, i, s);
                    let along = plus(plus(v, cross(u, r)), slope);
                    let at_rest = [n[4], n[5], n[6]];
                    let loose = plus(plus([c(0.0), c(0.0), c(1.0)], cross(at_rest, r)), slope);
                    let reaches = c(if self.reaches(i, half) { 1.0 } else { 0.0 });
                    out.push(reaches * dot(along, along).sqrt());
                    rest.push(reaches * dot(loose, loose).sqrt());
                }
                out.extend(rest);
                out.extend(turned(vector(SPREAD + 6)).map(Neg::neg));
                out
            };
            let h = 0.5 * LENGTH / STEPS as f64;
            for k in 0..STEPS {
                let s = 0.5 * LENGTH * half as f64 + k as f64 * h;
                let ahead = |f: f64, slope: &[Dual]| -> Vec<Dual> {
                    state.iter().zip(slope).map(|(y, d)| *y + c(f * h) * *d).collect()
                };
                let k1 = rate(s, &state);
                let k2 = rate(s + 0.5 * h, &ahead(0.5, &k1));
                let k3 = rate(s + 0.5 * h, &ahead(0.5, &k2));
                let k4 = rate(s + h, &ahead(1.0, &k3));
                for i in 0..state.len() {
                    let sum = k1[i] + k4[i] + c(2.0) * (k2[i] + k3[i]);
                    state[i] = state[i] + c(h / 6.0) * sum;
                }
            }
            let axes = [0, 3, 6].map(|k| [state[k], state[k + 1], state[k + 2]]);
            frames[half] = ([state[9], state[10], state[11]], axes);
            if half == 0 {
                for i in 0..3 {
                    state[12 + i] = state[12 + i] - n[19 + i];
                }
            }
        }
        let mut miss: Vec<Dual> = (0..3).map(|i| state[12 + i] - n[13 + i]).collect();
        let lengths = state[15..15 + cables].to_vec();
        if self.by_length {
            // The first number of a cable is its shortening.
            let loose = &state[15 + cables..];
            miss.extend((0..cables).map(|i| lengths[i] - loose[i] + self.cable(n, i)[0]));
        }
        if self.follows {
            miss.extend_from_slice(&state[last..]);
        }
        Shot { miss, frames, lengths }
    }

    /// Rates of frames, lengths and tensions with one of the numbers.
    pub fn derivative(
        &self,
        numbers: &[f64],
        unknown: &[f64],
        by: usize,
        matrix: &[Vec<f64>],
    ) -> Shot {
        let seeded = |list: &[f64], by: usize| -> Vec<Dual> {
            let seed = |(i, x): (usize, &f64)| Dual(*x, if i == by { 1.0 } else { 0.0 });
            list.iter().enumerate().map(seed).collect()
        };
        let n = seeded(numbers, by);
        let right = self.shoot(&n, &seeded(unknown, usize::MAX)).miss;
        let rates = solve(matrix.to_vec(), right.iter().map(|d| -d.1).collect());
        let x: Vec<Dual> = unknown.iter().zip(&rates).map(|(x, d)| Dual(*x, *d)).collect();
        let mut shot = self.shoot(&n, &x);
        shot.miss = x;
        shot
    }

    /// What is left at the tip by each unknown; by rows.
    pub fn jacobian(&self, numbers: &[f64], unknown: &[f64]) -> Vec<Vec<f64>> {
        let n: Vec<Dual> = numbers.iter().map(|x| c(*x)).collect();
        let columns: Vec<Vec<Dual>> = (0..unknown.len())
            .map(|j| {
                let seed = |(i, x): (usize, &f64)| Dual(*x, if i == j { 1.0 } else { 0.0 });
                let x: Vec<Dual> = unknown.iter().enumerate().map(seed).collect();
                self.shoot(&n, &x).miss
            })
            .collect();
        let row = |i: usize| columns.iter().map(|column| column[i].1).collect();
        (0..unknown.len()).map(row).collect()
    }
}
