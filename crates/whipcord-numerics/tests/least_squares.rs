//! Non-linear least squares against certified values.
//!
//! Source of the regressions: NIST, Statistical Reference Datasets, Nonlinear Regression
//! (<https://www.itl.nist.gov/div898/strd/nls/nls_main.shtml>): data, both starts, certified estimates with
//! their standard deviations, and the certified residual sum of squares.
#![allow(clippy::unwrap_used, reason = "a test stops where something is missing")]

use whipcord_numerics::SingularValues;
use whipcord_numerics::least_squares::{
    Loss, Negligible, NoResiduals, Options, Residuals, Status, Workspace, minimise,
};

/// `y = f(b; x)`, with its slopes by `b`.
struct Regression {
    x: &'static [f64],
    y: &'static [f64],
    /// The value, and its derivatives.
    model: fn(f64, &[f64], &mut [f64]) -> f64,
    jacobians: usize,
}

impl Residuals for Regression {
    type Refusal = ();

    fn count(&self) -> usize {
        self.x.len()
    }

    fn residuals(&mut self, b: &[f64], into: &mut [f64]) -> Result<(), ()> {
        let mut slopes = [0.0; 8];
        for ((into, &x), &y) in into.iter_mut().zip(self.x).zip(self.y) {
            *into = (self.model)(x, b, &mut slopes) - y;
        }
        Ok(())
    }

    fn jacobian(&mut self, b: &[f64], into: &mut [f64]) -> Result<(), ()> {
        self.jacobians += 1;
        for (row, &x) in into.chunks_exact_mut(b.len()).zip(self.x) {
            (self.model)(x, b, row);
        }
        Ok(())
    }
}

struct Certified {
    name: &'static str,
    problem: fn() -> Regression,
    starts: [&'static [f64]; 2],
    estimates: &'static [f64],
    deviations: &'static [f64],
    sum_of_squares: f64,
    /// Evaluations it may take from each start: what MINPACK's lmdif takes without those for its
    /// differences (SciPy 1.17.1, `least_squares(method="lm", x_scale="jac")` with these tolerances), or
    /// little more.
    evaluations: [usize; 2],
}

fn misra1a() -> Regression {
    Regression {
        x: &[
            77.6, 114.9, 141.1, 190.8, 239.9, 289.0, 332.8, 378.4, 434.8, 477.3, 536.8, 593.1,
            689.1, 760.0,
        ],
        y: &[
            10.07, 14.73, 17.94, 23.93, 29.61, 35.18, 40.02, 44.82, 50.76, 55.05, 61.01, 66.40,
            75.47, 81.78,
        ],
        model: |x, b, slopes| {
            let decay = (-b[1] * x).exp();
            slopes[0] = 1.0 - decay;
            slopes[1] = b[0] * x * decay;
            b[0] * (1.0 - decay)
        },
        jacobians: 0,
    }
}

/// A cubic over a cubic with the constant 1.
fn thurber() -> Regression {
    Regression {
        x: &[
            -3.067, -2.981, -2.921, -2.912, -2.840, -2.797, -2.702, -2.699, -2.633, -2.481, -2.363,
            -2.322, -1.501, -1.460, -1.274, -1.212, -1.100, -1.046, -0.915, -0.714, -0.566, -0.545,
            -0.400, -0.309, -0.109, -0.103, 0.010, 0.119, 0.377, 0.790, 0.963, 1.006, 1.115, 1.572,
            1.841, 2.047, 2.200,
        ],
        y: &[
            80.574, 84.248, 87.264, 87.195, 89.076, 89.608, 89.868, 90.101, 92.405, 95.854,
            100.696, 101.060, 401.672, 390.724, 567.534, 635.316, 733.054, 759.087, 894.206,
            990.785, 1090.109, 1080.914, 1122.643, 1178.351, 1260.531, 1273.514, 1288.339,
            1327.543, 1353.863, 1414.509, 1425.208, 1421.384, 1442.962, 1464.350, 1468.705,
            1447.894, 1457.628,
        ],
        model: |x, b, slopes| {
            let above = b[0] + x * (b[1] + x * (b[2] + x * b[3]));
            let below = 1.0 + x * (b[4] + x * (b[5] + x * b[6]));
            for k in 0..4 {
                slopes[k] = x.powi(k as i32) / below;
            }
            for k in 4..7 {
                slopes[k] = -above / (below * below) * x.powi(k as i32 - 3);
            }
            above / below
        },
        jacobians: 0,
    }
}

/// Kowalik and Osborne's problem.
fn mgh09() -> Regression {
    Regression {
        x: &[4.0, 2.0, 1.0, 0.5, 0.25, 0.167, 0.125, 0.1, 0.0833, 0.0714, 0.0625],
        y: &[
            0.1957, 0.1947, 0.1735, 0.1600, 0.0844, 0.0627, 0.0456, 0.0342, 0.0323, 0.0235, 0.0246,
        ],
        model: |x, b, slopes| {
            let (above, below) = (x * x + x * b[1], x * x + x * b[2] + b[3]);
            slopes[0] = above / below;
            slopes[1] = b[0] * x / below;
            slopes[2] = -b[0] * above * x / (below * below);
            slopes[3] = -b[0] * above / (below * below);
            b[0] * above / below
        },
        jacobians: 0,
    }
}

const CERTIFIED: [Certified; 3] = [
    Certified {
        name: "Misra1a",
        problem: misra1a,
        starts: [&[500.0, 0.0001], &[250.0, 0.0005]],
        estimates: &[2.389_421_291_8e2, 5.501_564_318_1e-4],
        deviations: &[2.707_007_524_1, 7.266_868_843_6e-6],
        sum_of_squares: 1.245_513_889_4e-1,
        evaluations: [21, 6],
    },
    Certified {
        name: "Thurber",
        problem: thurber,
        starts: [
            &[1000.0, 1000.0, 400.0, 40.0, 0.7, 0.3, 0.03],
            &[1300.0, 1500.0, 500.0, 75.0, 1.0, 0.4, 0.05],
        ],
        estimates: &[
            1.288_139_680_0e3,
            1.491_079_253_5e3,
            5.832_383_687_7e2,
            7.541_664_429_1e1,
            9.662_950_286_4e-1,
            3.979_728_579_7e-1,
            4.972_729_734_9e-2,
        ],
        deviations: &[
            4.664_796_334_4,
            3.957_115_608_6e1,
            2.869_869_610_2e1,
            5.567_537_027_0,
            3.133_334_068_7e-2,
            1.498_492_819_8e-2,
            6.584_234_462_3e-3,
        ],
        sum_of_squares: 5.642_708_239_7e3,
        evaluations: [46, 31],
    },
    Certified {
        name: "MGH09",
        problem: mgh09,
        starts: [&[25.0, 39.0, 41.5, 39.0], &[0.25, 0.39, 0.415, 0.39]],
        estimates: &[
            1.928_069_345_8e-1,
            1.912_823_287_3e-1,
            1.230_565_069_3e-1,
            1.360_623_306_8e-1,
        ],
        deviations: &[
            1.143_531_222_7e-2,
            1.963_322_091_1e-1,
            8.084_203_123_2e-2,
            9.002_554_230_8e-2,
        ],
        sum_of_squares: 3.075_056_038_5e-4,
        evaluations: [600, 32],
    },
];

#[test]
fn certified_estimates_and_deviations() {
    let mut workspace = Workspace::default();
    for certified in CERTIFIED {
        for (start, most) in certified.starts.iter().zip(certified.evaluations) {
            let mut problem = (certified.problem)();
            let mut b = start.to_vec();
            let options = Options { iterations: 600, ..Options::default() };
            let outcome = minimise(&mut problem, &mut b, &options, &mut workspace).unwrap();
            let name = certified.name;
            assert!(outcome.status.is_converged(), "{name}: {outcome:?}");
            assert_eq!(problem.jacobians, outcome.iterations + 1, "{name}");
            for (found, exact) in b.iter().zip(certified.estimates) {
                assert!((found / exact - 1.0).abs() < 1e-6, "{name}: {found} {exact}");
            }
            let (n, m) = (b.len(), problem.count());
            let sum = 2.0 * outcome.cost;
            assert!((sum / certified.sum_of_squares - 1.0).abs() < 1e-9, "{name}: {sum}");
            // The covariance V Σ⁻² Vᵀ s².
            let seen = SingularValues::of(n, workspace.jacobian());
            for (j, exact) in certified.deviations.iter().enumerate() {
                let along = (0..n).map(|k| (seen.direction(k)[j] / seen.values[k]).powi(2));
                let deviation = (along.sum::<f64>() * sum / (m - n) as f64).sqrt();
                assert!((deviation / exact - 1.0).abs() < 1e-5, "{name}: {deviation} {exact}");
            }
            assert!(outcome.evaluations <= most, "{name}: {} evaluations", outcome.evaluations);
        }
    }
}

/// Misra1a with two wrong measurements.
fn with_outliers() -> Regression {
    Regression {
        y: &[
            10.07, 14.73, 17.94, 23.93, 34.61, 35.18, 40.02, 44.82, 50.76, 47.05, 61.01, 66.40,
            75.47, 81.78,
        ],
        ..misra1a()
    }
}

/// The minima that SciPy 1.17.1 finds for the same losses, `least_squares(loss=…, f_scale=0.2)`, and for
/// the bound.
#[test]
fn robust_and_bounded_minima() {
    let scale = 0.2;
    let start = [250.0, 5e-4];
    for (loss, published, cost) in [
        (Loss::Huber { scale }, [2.379_946_45e2, 5.527_319_71e-4], 2.650_447_256_567_405_8),
        (Loss::SoftL1 { scale }, [2.374_746_15e2, 5.541_104_28e-4], 2.608_289_750_574_176_2),
        (Loss::Cauchy { scale }, [2.388_195_84e2, 5.506_580_96e-4], 0.322_521_993_157_583_4),
    ] {
        let mut b = start;
        let options = Options { loss, ..Options::default() };
        let mut workspace = Workspace::default();
        let outcome = minimise(&mut with_outliers(), &mut b, &options, &mut workspace).unwrap();
        assert!(outcome.status.is_converged(), "{loss:?}: {outcome:?}");
        assert!((outcome.cost - cost).abs() < 1e-9 * cost, "{loss:?}: {}", outcome.cost);
        for (found, published) in b.iter().zip(published) {
            assert!((found / published - 1.0).abs() < 1e-5, "{loss:?}: {found} {published}");
        }
        assert!(workspace.weights()[4] < 0.05 && workspace.weights()[0] > 0.7);
    }
    let mut b = [200.0, 5e-4];
    let options = Options { lower: vec![0.0, 0.0], upper: vec![230.0, 1.0], ..Options::default() };
    let outcome = minimise(&mut misra1a(), &mut b, &options, &mut Workspace::default()).unwrap();
    assert!(outcome.status.is_converged(), "{outcome:?}");
    assert!(b[0] == 230.0 && (b[1] / 5.752_257_74e-4 - 1.0).abs() < 1e-7, "{b:?}");
    assert!((outcome.cost - 0.123_810_984_953_258_4).abs() < 1e-10);
}

/// A parabola over the logarithm, that has no value below `from` and an answer at `at`.
struct Fenced {
    from: f64,
    at: f64,
}

impl Residuals for Fenced {
    type Refusal = f64;

    fn count(&self) -> usize {
        1
    }

    fn residuals(&mut self, x: &[f64], into: &mut [f64]) -> Result<(), f64> {
        if x[0] <= self.from {
            return Err(x[0]);
        }
        into[0] = x[0].ln() - self.at.ln();
        Ok(())
    }

    fn jacobian(&mut self, x: &[f64], into: &mut [f64]) -> Result<(), f64> {
        into[0] = 1.0 / x[0];
        Ok(())
    }
}

#[test]
fn steps_to_where_there_is_no_answer_are_shortened() {
    let mut workspace = Workspace::default();
    // Newton's step from e² goes to −e².
    let mut x = [1f64.exp().powi(2)];
    let mut problem = Fenced { from: 0.0, at: 1.0 };
    let outcome = minimise(&mut problem, &mut x, &Options::default(), &mut workspace).unwrap();
    assert!(outcome.status.is_converged() && (x[0] - 1.0).abs() < 1e-12, "{outcome:?} {x:?}");
    assert!(matches!(outcome.refusal, Some(NoResiduals::Refused(x)) if x < 0.0));
    // The minimum lies behind the fence.
    let mut x = [3.0];
    let mut problem = Fenced { from: 2.0, at: 1.0 };
    let outcome = minimise(&mut problem, &mut x, &Options::default(), &mut workspace).unwrap();
    assert_eq!(outcome.status, Status::Refused);
    assert!(x[0] > 2.0 && x[0] < 2.0 + 1e-9, "{x:?}");
    let refused = minimise(&mut problem, &mut [1.5], &Options::default(), &mut workspace);
    assert_eq!(refused, Err(NoResiduals::Refused(1.5)));
}

/// Only the sum of the first two unknowns is seen, and nothing of the third.
struct Blind;

impl Residuals for Blind {
    type Refusal = ();

    fn count(&self) -> usize {
        2
    }

    fn residuals(&mut self, x: &[f64], into: &mut [f64]) -> Result<(), ()> {
        into.copy_from_slice(&[(x[0] + x[1]).exp() - 2.0, x[0] + x[1]]);
        Ok(())
    }

    fn jacobian(&mut self, x: &[f64], into: &mut [f64]) -> Result<(), ()> {
        let slope = (x[0] + x[1]).exp();
        into.copy_from_slice(&[slope, slope, 0.0, 1.0, 1.0, 0.0]);
        Ok(())
    }
}

#[test]
fn what_is_not_seen_stays() {
    let mut x = [0.3, -0.1, 5.0];
    let mut workspace = Workspace::default();
    let outcome = minimise(&mut Blind, &mut x, &Options::default(), &mut workspace).unwrap();
    assert!(outcome.status.is_converged(), "{outcome:?}");
    assert!((x[0] - x[1] - 0.4).abs() < 1e-3 && (x[2] - 5.0).abs() < 1e-9, "{x:?}");
    let y = x[0] + x[1];
    assert!((y.exp() * (y.exp() - 2.0) + y).abs() < 1e-5);
    let seen = SingularValues::of(3, workspace.jacobian());
    assert!(seen.values[0] > 1.0 && seen.values[1] < 1e-15 && seen.values[2] < 1e-15);
}

#[test]
fn too_few_steps_are_said() {
    let mut b = [500.0, 0.0001];
    let options = Options { iterations: 3, ..Options::default() };
    let outcome = minimise(&mut misra1a(), &mut b, &options, &mut Workspace::default()).unwrap();
    assert_eq!((outcome.status, outcome.iterations), (Status::IterationLimit, 3));
}

/// A point that two cameras see: four numbers of three unknowns that are met but for what rounding and `noise` make of them.
struct NearlyExact {
    seen: [f64; 4],
    /// What the unknowns are counted from.
    near: [f64; 3],
}

impl NearlyExact {
    fn at(&self, x: &[f64]) -> [f64; 3] {
        core::array::from_fn(|i| self.near[i] + x[i])
    }

    /// Columns and rows, and their slopes.
    fn model(x: &[f64]) -> ([f64; 4], [f64; 12]) {
        let (mut values, mut slopes) = ([0.0; 4], [0.0; 12]);
        for camera in 0..2 {
            let (sine, cosine) = (0.4 * camera as f64).sin_cos();
            let (along, depth) = (x[0] - 0.2 * camera as f64, x[2]);
            let by = [[cosine, 0.0, sine], [0.0, 1.0, 0.0], [-sine, 0.0, cosine]];
            let [u, v, w] = by.map(|row| row[0] * along + row[1] * x[1] + row[2] * depth);
            for (k, above) in [u, v].into_iter().enumerate() {
                values[2 * camera + k] = 319.5 + 800.0 * above / w;
                for j in 0..3 {
                    slopes[3 * (2 * camera + k) + j] =
                        800.0 * (by[k][j] / w - above * by[2][j] / (w * w));
                }
            }
        }
        (values, slopes)
    }
}

impl Residuals for NearlyExact {
    type Refusal = ();

    fn count(&self) -> usize {
        4
    }

    fn residuals(&mut self, x: &[f64], into: &mut [f64]) -> Result<(), ()> {
        let (model, _) = Self::model(&self.at(x));
        for (into, (model, seen)) in into.iter_mut().zip(model.iter().zip(&self.seen)) {
            *into = model - seen;
        }
        Ok(())
    }

    fn jacobian(&mut self, x: &[f64], into: &mut [f64]) -> Result<(), ()> {
        into.copy_from_slice(&Self::model(&self.at(x)).1);
        Ok(())
    }
}

#[test]
fn nearly_exact_problems_converge() {
    let mut random = 7_u64;
    let mut next = || {
        random =
            random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (random >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    };
    for noise in [0.0, 1e-13, 1e-12, 1e-11, 1e-10, 1e-9, 1e-8, 1e-7] {
        for _ in 0..1000 {
            let truth = [0.2 * next(), 0.2 * next(), 0.5 + 0.2 * next()];
            let seen = NearlyExact::model(&truth).0.map(|value| value + noise * next());
            let far = if next() < 0.0 { 0.05 } else { 1e-9 };
            let near = truth.map(|x| x + far * next());
            let mut x = [0.0; 3];
            let mut problem = NearlyExact { seen, near };
            let outcome =
                minimise(&mut problem, &mut x, &Options::default(), &mut Workspace::default())
                    .unwrap();
            assert!(outcome.status.is_converged(), "{noise} {truth:?} {outcome:?}");
            let x = problem.at(&x);
            let apart = x.iter().zip(truth).map(|(x, truth)| (x - truth).abs());
            assert!(apart.sum::<f64>() < 1e-10 + 1e-2 * noise);
        }
    }
}

/// A curved valley whose bottom hardly falls, beside noise: `y = (b₁ − b₂²)·x + noise`, and a slight pull along the valley.
struct CurvedValley {
    noise: Vec<f64>,
    evaluations: usize,
}

impl Residuals for CurvedValley {
    type Refusal = ();

    fn count(&self) -> usize {
        self.noise.len() + 1
    }

    fn residuals(&mut self, b: &[f64], into: &mut [f64]) -> Result<(), ()> {
        self.evaluations += 1;
        for (i, (into, noise)) in into.iter_mut().zip(&self.noise).enumerate() {
            *into = 1e3 * (b[0] - b[1] * b[1]) * (1.0 + i as f64 / 50.0) + noise;
        }
        into[self.noise.len()] = 1e-2 * (b[1] - 10.0);
        Ok(())
    }

    fn jacobian(&mut self, b: &[f64], into: &mut [f64]) -> Result<(), ()> {
        for (i, row) in into.chunks_exact_mut(2).enumerate() {
            let x = 1e3 * (1.0 + i as f64 / 50.0);
            row.copy_from_slice(&[x, -2.0 * x * b[1]]);
        }
        into[2 * self.noise.len()..].copy_from_slice(&[0.0, 1e-2]);
        Ok(())
    }
}

/// In a valley along which nothing is known the search ends once what is left to gain is far below the noise, and it says that it
/// has converged; on the wall of the valley nothing is lost of the accuracy.
#[test]
fn a_search_ends_where_less_than_the_noise_is_to_be_gained() {
    let noise: Vec<f64> = (0..100).map(|i: i32| (f64::from(i) * 1.7).sin() * 1.5).collect();
    let search = |negligible| {
        let mut problem = CurvedValley { noise: noise.clone(), evaluations: 0 };
        let mut b = [3.0, 1.0];
        let options = Options { negligible, iterations: 100_000, ..Options::default() };
        let outcome = minimise(&mut problem, &mut b, &options, &mut Workspace::default()).unwrap();
        (outcome, b, problem.evaluations)
    };
    let (exact, full, all) = search(Negligible::Nothing);
    assert!(exact.status.is_converged(), "{exact:?}");
    assert!((full[1] - 10.0).abs() < 0.1, "{full:?}");
    let part = 1e-4;
    let (outcome, b, evaluations) = search(Negligible::PartOfCost(part / 99.0));
    assert_eq!(outcome.status, Status::Cost);
    assert!(evaluations * 4 < all, "{evaluations} of {all}");
    // The valley: one deviation of what is known is about 1/8000.
    assert!((b[0] - b[1] * b[1] - (full[0] - full[1] * full[1])).abs() < 0.2 / 8000.0, "{b:?}");
    // And no more than what the criterion says is above the least cost, in units of the variance.
    let variance = 2.0 * exact.cost / 99.0;
    assert!(2.0 * (outcome.cost - exact.cost) / variance < 0.1, "{outcome:?} {exact:?}");
    let (known, c, _) = search(Negligible::Cost(0.5 * part * variance));
    assert_eq!(known.status, Status::Cost);
    assert!((c[0] - b[0]).abs() < 1e-6 * b[0].abs(), "{b:?} {c:?}");
}
