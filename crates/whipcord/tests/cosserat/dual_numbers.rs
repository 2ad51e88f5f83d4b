//! The derivatives of the Cosserat model against dual numbers, which go through a rod of their own:
//! rotation matrices instead of quaternions, the classical Runge–Kutta method on many steps, sections
//! by Newton's method on all six equations. It shares no code with the model.

use core::f64::consts::{PI, TAU};
use core::ops::{Add, Div, Mul, Neg, Sub};

use whipcord::cosserat::{Accuracy, Cosserat, Hold, Options, Place, Workspace};
use whipcord::{
    Backbone, Cable, CableCommand, Case, Disks, DistributedLoad, Loads, Material, Parameter,
    PointLoad, Profile, RestCurvature, Robot, Routing, Section, Shortening, Vec3,
};

/// A value and its derivative.
#[derive(Clone, Copy, Debug, Default)]
struct Dual(f64, f64);

type V = [Dual; 3];

impl Add for Dual {
    type Output = Self;
    fn add(self, b: Self) -> Self {
        Self(self.0 + b.0, self.1 + b.1)
    }
}
impl Sub for Dual {
    type Output = Self;
    fn sub(self, b: Self) -> Self {
        Self(self.0 - b.0, self.1 - b.1)
    }
}
impl Neg for Dual {
    type Output = Self;
    fn neg(self) -> Self {
        Self(-self.0, -self.1)
    }
}
impl Mul for Dual {
    type Output = Self;
    fn mul(self, b: Self) -> Self {
        Self(self.0 * b.0, self.0 * b.1 + self.1 * b.0)
    }
}
impl Div for Dual {
    type Output = Self;
    fn div(self, b: Self) -> Self {
        Self(self.0 / b.0, (self.1 - self.0 / b.0 * b.1) / b.0)
    }
}
impl Dual {
    fn sqrt(self) -> Self {
        let root = self.0.sqrt();
        Self(root, 0.5 * self.1 / root)
    }
    fn sin_cos(self) -> (Self, Self) {
        let (s, c) = self.0.sin_cos();
        (Self(s, c * self.1), Self(c, -s * self.1))
    }
}

fn c(x: f64) -> Dual {
    Dual(x, 0.0)
}
fn plus(a: V, b: V) -> V {
    core::array::from_fn(|i| a[i] + b[i])
}
fn minus(a: V, b: V) -> V {
    core::array::from_fn(|i| a[i] - b[i])
}
fn times(f: Dual, a: V) -> V {
    a.map(|x| f * x)
}
fn dot(a: V, b: V) -> Dual {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
fn cross(a: V, b: V) -> V {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// By Gaussian elimination with row exchanges.
fn solve(mut a: Vec<Vec<f64>>, mut x: Vec<f64>) -> Vec<f64> {
    let n = x.len();
    for k in 0..n {
        let pivot = (k..n).max_by(|&i, &j| a[i][k].abs().total_cmp(&a[j][k].abs())).unwrap();
        a.swap(k, pivot);
        x.swap(k, pivot);
        for i in k + 1..n {
            let f = a[i][k] / a[k][k];
            for j in k..n {
                a[i][j] -= f * a[k][j];
            }
            x[i] -= f * x[k];
        }
    }
    for k in (0..n).rev() {
        for j in k + 1..n {
            x[k] -= a[k][j] * x[j];
        }
        x[k] /= a[k][k];
    }
    x
}

const LENGTH: f64 = 0.2;
/// Steps of each half of the rod.
const STEPS: usize = if cfg!(debug_assertions) { 100 } else { 200 };

/// A rod whose numbers are given by their place in a list, so that any of them can be differentiated
/// by: E, ν, d, ρ, u* (3), gravity (3), tip force (3), tip moment (3), force and moment halfway (6),
/// dead force and moment per metre (6), those that turn with the rod (6), then eight for each cable:
/// command, and what its course takes. Unknown are the base moment, the tensions where lengths are given,
/// and the force at the base of what turns with the rod, where anything does.
struct Rod {
    kinds: Vec<usize>,
    by_length: bool,
    follows: bool,
}

const SPREAD: usize = 22;
const RODS_OWN: usize = SPREAD + 12;
const PER_CABLE: usize = 8;

/// What a shot leaves at the tip, and where it ends.
struct Shot {
    miss: Vec<Dual>,
    /// Position and rotation halfway and at the tip.
    frames: [(V, [V; 3]); 2],
    lengths: Vec<Dual>,
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
    fn shoot(&self, n: &[Dual], unknown: &[Dual]) -> Shot {
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
    fn derivative(&self, numbers: &[f64], unknown: &[f64], by: usize, matrix: &[Vec<f64>]) -> Shot {
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
    fn jacobian(&self, numbers: &[f64], unknown: &[f64]) -> Vec<Vec<f64>> {
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

/// Numbers between −1 and 1, the same in every run.
struct Noise(u64);

impl Noise {
    fn next(&mut self) -> f64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
}

/// A random rod: its numbers by place, the robot, the case, and which parameter each number is.
fn random(
    seed: u64,
    loaded: bool,
    spread: bool,
) -> (Rod, Vec<f64>, Robot, Case, Vec<Option<Parameter>>) {
    let mut noise = Noise(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) + 1);
    for _ in 0..8 {
        noise.next();
    }
    let (young, nu, d, rho) = (1.1e9, 0.3, 0.003, 1040.0);
    let ei = young * PI / 64.0 * f64::powi(d, 4);
    let (force, moment) = (ei / (LENGTH * LENGTH), ei / LENGTH);
    let load = if loaded { 1.0 } else { 0.0 };
    let mut numbers = vec![young, nu, d, rho];
    numbers.extend((0..3).map(|_| noise.next() / LENGTH));
    numbers.extend((0..3).map(|_| load * 9.81 * noise.next()));
    numbers.extend((0..3).map(|_| load * force * noise.next()));
    numbers.extend((0..3).map(|_| load * 0.5 * moment * noise.next()));
    numbers.extend((0..3).map(|_| load * 0.5 * force * noise.next()));
    numbers.extend((0..3).map(|_| load * 0.3 * moment * noise.next()));
    let per_metre = if spread { 1.0 / LENGTH } else { 0.0 };
    for _ in 0..2 {
        numbers.extend((0..3).map(|_| per_metre * force * noise.next()));
        numbers.extend((0..3).map(|_| per_metre * 0.3 * moment * noise.next()));
    }
    let mut which = vec![
        Some(Parameter::YoungModulus),
        Some(Parameter::PoissonRatio),
        Some(Parameter::Diameter),
        Some(Parameter::Density),
    ];
    type ByAxis = fn(usize) -> Parameter;
    let by_axis: [ByAxis; 6] = [
        |axis| Parameter::RestCurvature { axis },
        |axis| Parameter::Gravity { axis },
        |axis| Parameter::TipForce { axis },
        |axis| Parameter::TipMoment { axis },
        |axis| Parameter::PointForce { load: 0, axis },
        |axis| Parameter::PointMoment { load: 0, axis },
    ];
    which.extend(by_axis.iter().flat_map(|p| (0..3).map(|axis| Some(p(axis)))));
    for load in 0..2 {
        let there = |parameter: Parameter| spread.then_some(parameter);
        which.extend((0..3).map(|axis| there(Parameter::LineForce { load, axis })));
        which.extend((0..3).map(|axis| there(Parameter::LineMoment { load, axis })));
    }
    let cables = 1 + seed as usize % 4;
    let (mut kinds, mut list, mut commands) = (Vec::new(), Vec::new(), Vec::new());
    for cable in 0..cables {
        let kind = (seed as usize + cable) % 4;
        kinds.push(kind);
        let (angle, radius) = (PI * noise.next(), 0.008 + 0.002 * noise.next());
        let tension = (0.3 + 0.2 * noise.next()) * ei / (LENGTH * radius);
        let (x, y) = (radius * angle.cos(), radius * angle.sin());
        let mut more = || 0.3 * radius * noise.next();
        let mut own = [tension, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
        let mut mine = vec![None; PER_CABLE];
        let routing = match kind {
            0 => {
                (own[1], own[2]) = (angle, radius);
                mine[1..3].copy_from_slice(&[
                    Some(Parameter::Angle { cable }),
                    Some(Parameter::Radius { cable }),
                ]);
                Routing::Straight { angle, radius }
            }
            1 => {
                (own[1], own[2], own[3]) = (angle, more() / radius, radius);
                mine[1..4].copy_from_slice(&[
                    Some(Parameter::Angle { cable }),
                    Some(Parameter::Turns { cable }),
                    Some(Parameter::Radius { cable }),
                ]);
                Routing::Helix { start_angle: angle, turns: own[2], radius }
            }
            2 => {
                (own[1], own[2], own[3], own[4]) = (x, y, x + more(), y + more());
                for axis in 0..2 {
                    mine[1 + axis] = Some(Parameter::Start { cable, axis });
                    mine[3 + axis] = Some(Parameter::End { cable, axis });
                }
                Routing::Linear { start: [x, y], end: [own[3], own[4]] }
            }
            _ => {
                let per = [1.0, 1.0 / LENGTH, 1.0 / (LENGTH * LENGTH)];
                for (axis, start) in [x, y].into_iter().enumerate() {
                    for power in 0..3 {
                        let at = 1 + 3 * axis + power;
                        own[at] = if power == 0 { start } else { more() * per[power] };
                        mine[at] = Some(Parameter::Coefficient { cable, axis, power });
                    }
                }
                Routing::Polynomial { x: own[1..4].to_vec(), y: own[4..7].to_vec() }
            }
        };
        numbers.extend(own);
        which.extend(mine);
        commands.push(CableCommand { tension: Some(tension), shortening: None });
        let ends_at = (cable == 1).then_some(0.5 * LENGTH);
        list.push(Cable { ends_at, ..Cable::new(format!("{cable}"), routing) });
    }
    let vector = |i: usize| Vec3::new(numbers[i], numbers[i + 1], numbers[i + 2]);
    let backbone = Backbone {
        section: Some(Section::circle(d)),
        material: Material {
            young_modulus: Some(young),
            poisson_ratio: Some(nu),
            density: Some(rho),
            ..Material::default()
        },
        rest_curvature: RestCurvature::Uniform(vector(4)),
        ..Backbone::new(LENGTH)
    };
    let robot = Robot::new(backbone, Disks::equally_spaced(LENGTH, 3, 0.01), list).unwrap();
    let loads = Loads {
        gravity: loaded.then(|| vector(7)),
        tip_force: vector(10),
        tip_moment: vector(13),
        points: vec![PointLoad {
            at: 0.5 * LENGTH,
            force: vector(16),
            moment: vector(19),
            follower: false,
        }],
        distributed: match spread {
            false => vec![],
            true => [false, true].map(|follower| along_all(&vector, follower)).to_vec(),
        },
        ..Loads::default()
    };
    let rod = Rod { kinds, by_length: false, follows: spread };
    (rod, numbers, robot, Case { commands, loads, ..Case::default() }, which)
}

/// What is spread along all of the rod, from the vectors by their place.
fn along_all(vector: &dyn Fn(usize) -> Vec3, follower: bool) -> DistributedLoad {
    let first = if follower { SPREAD + 6 } else { SPREAD };
    let (force, moment) = (vector(first), vector(first + 3));
    let profile = Profile::Constant { from: 0.0, to: LENGTH, force, moment };
    DistributedLoad { profile, follower }
}

/// Largest difference of a column, relative to its largest entry.
fn check(seed: u64, loaded: bool, by_length: bool, spread: bool) -> f64 {
    let (mut rod, mut numbers, robot, mut case, which) = random(seed, loaded, spread);
    let options =
        Options { accuracy: Accuracy::Tolerance(3e-12), residual: 1e-13, ..Options::default() };
    let model = Cosserat::new(&robot, &case.loads, &options).unwrap();
    let mut workspace = Workspace::default();
    let cables = rod.kinds.len();
    let mut solution = model.solve(&case, None, &mut workspace).unwrap();
    if by_length {
        rod.by_length = true;
        for (i, cable) in solution.cables.iter().enumerate() {
            let shortening = cable.initial_length - cable.length;
            numbers[RODS_OWN + PER_CABLE * i] = shortening;
            case.commands[i] =
                CableCommand { tension: None, shortening: Some(Shortening::Length(shortening)) };
        }
    }
    let parameters: Vec<Parameter> = which.iter().flatten().copied().collect();
    let derivatives;
    (solution, derivatives) = model
        .solve_with_derivatives(&case, Some(&solution), &parameters, &mut workspace)
        .unwrap_or_else(|e| panic!("robot {seed}: {e}"));
    let base = solution.base_wrench.unwrap().moment;
    let mut unknown = vec![base.x, base.y, base.z];
    if by_length {
        unknown.extend(solution.cables.iter().map(|cable| cable.tension.unwrap()));
    }
    if spread {
        // What is not dead of the force at the base.
        let of = |i: usize| Vec3::new(numbers[i], numbers[i + 1], numbers[i + 2]);
        let weight = numbers[3] * PI / 4.0 * numbers[2].powi(2) * LENGTH;
        let dead = of(7) * weight + of(10) + of(16) + of(SPREAD) * LENGTH;
        let turning = solution.base_wrench.unwrap().force - dead;
        unknown.extend([turning.x, turning.y, turning.z]);
    }
    // To the answer of this rod's own discretisation.
    let n: Vec<Dual> = numbers.iter().map(|x| c(*x)).collect();
    for _ in 0..3 {
        let x: Vec<Dual> = unknown.iter().map(|x| c(*x)).collect();
        let left = rod.shoot(&n, &x).miss.iter().map(|d| d.0).collect();
        let step = solve(rod.jacobian(&numbers, &unknown), left);
        unknown.iter_mut().zip(&step).for_each(|(x, d)| *x -= d);
    }
    let matrix = rod.jacobian(&numbers, &unknown);
    let mut number = 0;
    let mut worst: f64 = 0.0;
    for by in 0..numbers.len() {
        let change = match which[by] {
            Some(_) => {
                number += 1;
                derivatives.parameter(number - 1, Hold::Commands)
            }
            None if by >= RODS_OWN && (by - RODS_OWN).is_multiple_of(PER_CABLE) => {
                derivatives.command((by - RODS_OWN) / PER_CABLE)
            }
            None => continue,
        };
        let exact = rod.derivative(&numbers, &unknown, by, &matrix);
        let (mut off, mut size) = (0.0_f64, 0.0_f64);
        let mut compare = |a: f64, b: f64, unit: f64| {
            off = off.max((a - b).abs() / unit);
            size = size.max(b.abs() / unit);
        };
        for (place, (p, axes)) in [Place::Disk(1), Place::Tip].into_iter().zip(&exact.frames) {
            let twist = change.twist(place);
            // φ = ½ Σ aₖ × aₖ′ over the columns of R.
            let turn = axes.iter().fold([0.0; 3], |sum, a| {
                let (x, d) = (a.map(|q| c(q.0)), a.map(|q| c(q.1)));
                let part = cross(x, d);
                core::array::from_fn(|i| sum[i] + 0.5 * part[i].0)
            });
            for i in 0..3 {
                compare(twist.linear[i], p[i].1, LENGTH);
                compare(twist.angular[i], turn[i], 1.0);
            }
        }
        for i in 0..cables {
            compare(change.lengths()[i], exact.lengths[i].1, LENGTH);
            if by_length {
                compare(change.tensions()[i], exact.miss[3 + i].1, unknown[3 + i]);
            }
        }
        let relative = if size == 0.0 { off } else { off / size };
        assert!(
            relative < 1e-7,
            "robot {seed}, loaded {loaded}, by length {by_length}, spread {spread}, {:?} ({by}): {relative:.1e}",
            which[by]
        );
        worst = worst.max(relative);
    }
    worst
}

#[test]
fn dual_numbers_give_the_same_derivatives() {
    let robots = if cfg!(debug_assertions) { 1 } else { 5 };
    let mut worst: f64 = 0.0;
    for seed in 0..robots {
        for by_length in [false, true] {
            worst = worst.max(check(seed, seed % 3 != 2, by_length, false));
        }
    }
    println!("{robots} robots, both ways of driving: they differ by {worst:.1e} at most");
}

/// With forces and moments spread along the rod, some dead and some that turn with it.
#[test]
fn dual_numbers_give_the_same_derivatives_under_spread_loads() {
    let robots = if cfg!(debug_assertions) { 1 } else { 2 };
    let mut worst: f64 = 0.0;
    for seed in 0..robots {
        worst = worst.max(check(seed + 1, true, seed % 2 == 1, true));
    }
    println!("{robots} robots: they differ by {worst:.1e} at most");
}
