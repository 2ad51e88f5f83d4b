//! The sign of the verdict of stability at 0.995 and 1.005 of exact critical loads, by both rods.
//!
//! Rods have length 1 and a least bending stiffness of 1. Exact values are closed forms, or come from the
//! linearised equations of the column, integrated here by another method.
//!
//! `cargo test --release -p whipcord --test mechanics any_model::critical_loads:: -- --nocapture` prints the table of
//! `docs/theory/critical-loads.md`.

use core::f64::consts::{FRAC_PI_2, PI, TAU};

use whipcord::{
    Along, Backbone, Cable, Case, Diagnostics, Disks, DistributedLoad, Loads, Model, ModelKind,
    NoStability, PointLoad, RestCurvature, Robot, Routing, Section, Shortening, Solution,
    StabilityAnalysis, Statics as _, Stiffness, Vec3,
};

use crate::common;

const RODS: [ModelKind; 2] = [ModelKind::Cosserat, ModelKind::CosseratDisks];

/// Torsional stiffness where it does not matter.
const TORSION: f64 = 0.7;

/// One case: its exact critical load and the robot under any load.
struct Critical {
    name: String,
    exact: f64,
    at: Box<dyn Fn(f64) -> (Robot, Case)>,
    /// The rods that it is exact for.
    rods: &'static [ModelKind],
}

fn critical(name: &str, exact: f64, at: impl Fn(f64) -> (Robot, Case) + 'static) -> Critical {
    Critical { name: name.to_owned(), exact, at: Box::new(at), rods: &RODS }
}

#[derive(Clone)]
struct Rod {
    bending: Along<[f64; 2]>,
    shear: Option<f64>,
    axial: Option<f64>,
    torsion: f64,
    /// Twist of the unloaded rod in rad.
    twist: f64,
    disks: usize,
}

impl Rod {
    fn round() -> Self {
        let bending = Along::Uniform([1.0; 2]);
        Self { bending, shear: None, axial: None, torsion: TORSION, twist: 0.0, disks: 11 }
    }

    fn backbone(&self) -> Backbone {
        let stiffness = Stiffness::Diagonal {
            shear: self.shear.map(|k| [k; 2].into()),
            axial: self.axial.map(Into::into),
            bending: self.bending.clone(),
            torsion: self.torsion.into(),
        };
        Backbone {
            stiffness: Some(stiffness),
            extensible: self.axial.is_some(),
            shearable: self.shear.is_some(),
            rest_curvature: RestCurvature::Uniform(Vec3::new(0.0, 0.0, self.twist)),
            ..Backbone::new(1.0)
        }
    }

    fn robot(&self, cables: Vec<Cable>) -> Robot {
        Robot::new(self.backbone(), Disks::equally_spaced(1.0, self.disks, 0.01), cables).unwrap()
    }
}

fn under(robot: Robot, loads: Loads) -> (Robot, Case) {
    (robot, Case { loads, ..Case::default() })
}

fn pushed(force: f64) -> Loads {
    Loads { tip_force: -force * Vec3::Z, ..Loads::default() }
}

fn spread(force: Vec3) -> Loads {
    Loads { distributed: vec![DistributedLoad::uniform(1.0, force)], ..Loads::default() }
}

/// The first zero of a function that is positive before it.
fn first_zero(step: f64, f: impl Fn(f64) -> f64) -> f64 {
    let mut high = step;
    while f(high) > 0.0 {
        high += step;
    }
    let mut low = high - step;
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if f(middle) > 0.0 { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// The critical factor of a column clamped at its base whose sections bear the compression `n(s)` times the
/// factor: `(B θ′)′ + f n θ = 0`, `θ(0) = 0`, `B θ′(1) = 0`, with the matrix `B(s)` of bending stiffness about two
/// fixed axes. Runge–Kutta on both solutions from the base; the determinant of their end moments vanishes.
fn column(bending: impl Fn(f64) -> [[f64; 2]; 2], compression: impl Fn(f64) -> f64) -> f64 {
    const STEPS: usize = 2000;
    let end_moments = |factor: f64| {
        let slope = |s: f64, [a, b, m, n]: [f64; 4]| {
            let [[p, q], [_, r]] = bending(s);
            let det = p * r - q * q;
            let load = factor * compression(s);
            [(r * m - q * n) / det, (p * n - q * m) / det, -load * a, -load * b]
        };
        let solve = |mut state: [f64; 4]| {
            let h = 1.0 / STEPS as f64;
            let plus = |y: [f64; 4], f: f64, k: [f64; 4]| core::array::from_fn(|i| y[i] + f * k[i]);
            for step in 0..STEPS {
                let s = step as f64 * h;
                let k1 = slope(s, state);
                let k2 = slope(s + 0.5 * h, plus(state, 0.5 * h, k1));
                let k3 = slope(s + 0.5 * h, plus(state, 0.5 * h, k2));
                let k4 = slope(s + h, plus(state, h, k3));
                for i in 0..4 {
                    state[i] += h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]);
                }
            }
            state
        };
        let [_, _, a, b] = solve([0.0, 0.0, 1.0, 0.0]);
        let [_, _, c, d] = solve([0.0, 0.0, 0.0, 1.0]);
        // Twice the same zero where both planes are alike: the lesser moment is that of one plane.
        if b.abs() + c.abs() < 1e-12 { a.min(d) } else { a * d - b * c }
    };
    first_zero(0.05, end_moments)
}

fn columns() -> Vec<Critical> {
    let euler = FRAC_PI_2 * FRAC_PI_2;
    let round = Rod::round();
    let mut cases = Vec::new();
    for disks in [2, 3, 11, 31] {
        let rod = Rod { disks, ..Rod::round() };
        let name = format!("Euler, {disks} disks");
        cases.push(critical(&name, euler, move |p| under(rod.robot(vec![]), pushed(p))));
    }
    // Haringx (1948), with the stretch: P (1 + P (1/GA − 1/EA)) = P_E.
    for (name, shear, axial) in [
        ("Haringx: GA = 20", Some(20.0), None),
        ("EA = 60", None, Some(60.0)),
        ("Haringx: GA = 30, EA = 90", Some(30.0), Some(90.0)),
    ] {
        let gives = shear.map_or(0.0, f64::recip) - axial.map_or(0.0, |k: f64| k.recip());
        let exact = ((1.0 + 4.0 * gives * euler).sqrt() - 1.0) / (2.0 * gives);
        let rod = Rod { shear, axial, ..Rod::round() };
        cases.push(critical(name, exact, move |p| under(rod.robot(vec![]), pushed(p))));
    }
    // Greenhill (1881): from the first zero of the Bessel function of order −1/3.
    let rod = round.clone();
    cases.push(critical("Greenhill: own weight", 7.837_347_438_943_484, move |q| {
        under(rod.robot(vec![]), spread(-q * Vec3::Z))
    }));
    let alike = |stiffness: f64| [[stiffness, 0.0], [0.0, stiffness]];
    let both = column(|_| alike(1.0), |s| 1.0 + (1.0 - s));
    let rod = round.clone();
    cases.push(critical("weight and as much at the tip", both, move |q| {
        let loads = Loads { tip_force: -q * Vec3::Z, ..spread(-q * Vec3::Z) };
        under(rod.robot(vec![]), loads)
    }));
    // Timoshenko and Gere, Theory of Elastic Stability, arts. 2.11 and 2.14.
    let rod = round.clone();
    cases.push(critical("P at the tip and at half the length", 2.067_232_896_738_349, move |p| {
        let middle = PointLoad { at: 0.5, force: -p * Vec3::Z, ..PointLoad::default() };
        under(rod.robot(vec![]), Loads { points: vec![middle], ..pushed(p) })
    }));
    let stepped = Along::At {
        arc_lengths: vec![0.0, 0.5, 0.5, 1.0],
        values: vec![[4.0; 2], [4.0; 2], [1.0; 2], [1.0; 2]],
    };
    let rod = Rod { bending: stepped, ..Rod::round() };
    cases.push(critical(
        "stepped: lower half four times as stiff",
        6.061_044_348_559_758,
        move |p| under(rod.robot(vec![]), pushed(p)),
    ));
    // A cone, twice as thick at the base: tan(√P/2) = −√P/2, see the columns of `cosserat`.
    cases.push(critical("tapered: truncated cone", 16.463_433_462_777_81, |p| {
        let tip: f64 = 1e-4;
        let young = 64.0 / (PI * tip.powi(4));
        let mut backbone = common::round(1.0, tip, young, 0.4 * young);
        backbone.section =
            Some(Section::Round { outer: Along::PerDisk(vec![2.0 * tip, tip]), inner: 0.0.into() });
        let robot = Robot::new(backbone, Disks::equally_spaced(1.0, 2, 0.01), vec![]).unwrap();
        under(robot, pushed(p))
    }));
    let linear = |from: f64, to: f64| Along::At {
        arc_lengths: vec![0.0, 1.0],
        values: vec![[from; 2], [to; 2]],
    };
    let exact = column(|s| alike(3.0 - 2.0 * s), |_| 1.0);
    let rod = Rod { bending: linear(3.0, 1.0), ..Rod::round() };
    cases.push(critical("tapered: EI from 3 to 1", exact, move |p| {
        under(rod.robot(vec![]), pushed(p))
    }));
    let exact = column(|s| alike(3.0 - 2.0 * s), |s| 1.0 - s);
    let rod = Rod { bending: linear(3.0, 1.0), ..Rod::round() };
    cases.push(critical("tapered, own weight", exact, move |q| {
        under(rod.robot(vec![]), spread(-q * Vec3::Z))
    }));
    for (name, strong, twist) in [
        ("pretwisted by π, EI 1 and 4", 4.0, PI),
        ("pretwisted by 4π, EI 1 and 4", 4.0, 4.0 * PI),
        ("pretwisted by π/2, EI 1 and 50", 50.0, FRAC_PI_2),
    ] {
        let turned = move |s: f64| {
            let (sin, cos) = (twist * s).sin_cos();
            let off = (1.0 - strong) * sin * cos;
            [[cos * cos + strong * sin * sin, off], [off, sin * sin + strong * cos * cos]]
        };
        let exact = column(turned, |_| 1.0);
        let rod = Rod { bending: Along::Uniform([1.0, strong]), twist, ..Rod::round() };
        cases.push(critical(name, exact, move |p| under(rod.robot(vec![]), pushed(p))));
    }
    cases
}

/// Prandtl and Michell (1899): a strip that all but does not bend edgewise, from Bessel functions of order −1/4
/// and −1/6.
fn strips() -> Vec<Critical> {
    let mut cases = Vec::new();
    for torsion in [0.7, 0.1, 3.0_f64] {
        let strip = Rod { bending: Along::Uniform([1.0, 1e6]), torsion, ..Rod::round() };
        let (tip, all) = (strip.clone(), strip);
        let scale = torsion.sqrt();
        cases.push(critical(
            &format!("lateral, force at the tip, GJ = {torsion}"),
            4.012_599_343_578_901 * scale,
            move |p| {
                let loads = Loads { tip_force: p * Vec3::X, ..Loads::default() };
                under(tip.robot(vec![]), loads)
            },
        ));
        cases.push(critical(
            &format!("lateral, force all along, GJ = {torsion}"),
            12.853_763_321_383_318 * scale,
            move |q| under(all.robot(vec![]), spread(q * Vec3::X)),
        ));
    }
    cases
}

/// A central cable is straight from disk to disk and buckles every span as a column with pinned ends.
fn spans() -> Vec<Critical> {
    let of = |spans: usize| {
        let rod = Rod { disks: spans + 1, ..Rod::round() };
        let name = format!("central cable, {spans} spans");
        let exact = PI * PI * (spans * spans) as f64;
        let case = critical(&name, exact, move |tension| {
            let cable = Cable::new("central", Routing::Straight { angle: 0.0, radius: 0.0 });
            (rod.robot(vec![cable]), Case::with_tensions(&[tension]))
        });
        Critical { rods: &[ModelKind::CosseratDisks], ..case }
    };
    [2, 3, 4, 5, 8, 15, 16, 17, 31, 60].into_iter().map(of).collect()
}

fn around(count: usize) -> Vec<Cable> {
    let cable = |i: usize| {
        let angle = TAU * i as f64 / count as f64;
        Cable::new(format!("{i}"), Routing::Straight { angle, radius: 0.01 })
    };
    (0..count).map(cable).collect()
}

/// Straight cables all round that are held at their lengths keep the tip upright: clamped and guided, `π²`.
fn locked() -> Vec<Critical> {
    let mut cases = Vec::new();
    for count in [3, 4, 6] {
        let stiff = Rod::round();
        cases.push(critical(&format!("{count} locked cables, no stretch"), PI * PI, move |p| {
            let case = Case::with_shortenings(&vec![Shortening::Length(0.0); count]);
            (stiff.robot(around(count)), Case { loads: pushed(p), ..case })
        }));
        // Shortened so that they press the rod by 12 in all, and stay taut under the load. Disks are so many that
        // this takes no more than 0.1 % of what a section between two of them bears.
        const AXIAL: f64 = 1e7;
        let rod = Rod { axial: Some(AXIAL), disks: 41, ..Rod::round() };
        cases.push(critical(&format!("{count} locked cables, taut"), PI * PI, move |p| {
            let case = Case::with_shortenings(&vec![Shortening::Length(12.0 / AXIAL); count]);
            (rod.robot(around(count)), Case { loads: pushed(p), ..case })
        }));
    }
    let plane = Rod::round();
    cases.push(critical("2 locked cables, free across them", FRAC_PI_2 * FRAC_PI_2, move |p| {
        let case = Case::with_shortenings(&[Shortening::Length(0.0); 2]);
        (plane.robot(around(2)), Case { loads: pushed(p), ..case })
    }));
    cases
}

/// With the eigenvalue; the verdict without it is the same.
fn solve(kind: ModelKind, robot: &Robot, case: &Case) -> Result<Solution, String> {
    let by = |analysis| {
        let model = Model::new(kind, Default::default(), Default::default());
        model.with_stability(analysis).solve(robot, case).map_err(|error| error.to_string())
    };
    let [verdict, answer] = [StabilityAnalysis::Verdict, StabilityAnalysis::Eigenvalue].map(by);
    let of = |solved: &Result<Solution, String>| {
        let diagnostics = solved.as_ref().ok().map(|solution| solution.diagnostics.clone());
        diagnostics.map(|found| (found.stable, found.stability_absent, found.stability_lost_at))
    };
    assert_eq!(of(&verdict), of(&answer), "{kind}");
    if let (Ok(quick), Ok(full)) = (&verdict, &answer) {
        let [quick, full] = [quick, full].map(|solution| solution.diagnostics.stability);
        let is_clear = full.is_none_or(|least| least >= Diagnostics::NEAR_CRITICAL);
        assert!(quick == full || quick.is_none() && is_clear, "{kind}: {quick:?}, {full:?}");
    }
    answer
}

/// What the answer says of the shape that the load leads to: whether it is stable, and at which fraction of
/// the load it is lost.
#[derive(Debug)]
enum Says {
    Stable,
    /// The answer itself is unstable.
    Unstable(Option<f64>),
    /// The answer is stable, and lies beyond this fraction of the load.
    Left(f64),
    Nothing(String),
}

fn says(kind: ModelKind, robot: &Robot, case: &Case) -> Says {
    let solution = match solve(kind, robot, case) {
        Ok(solution) => solution,
        Err(error) => return Says::Nothing(error),
    };
    let diagnostics = &solution.diagnostics;
    match (diagnostics.stable, diagnostics.stability_lost_at) {
        (Some(true), None) => Says::Stable,
        (Some(true), Some(load)) => Says::Left(load),
        (Some(false), load) => Says::Unstable(load),
        (None, _) => Says::Nothing(format!("{:?}", diagnostics.stability_absent)),
    }
}

fn show(said: &Says, factor: f64) -> String {
    match said {
        Says::Stable => "stable".to_owned(),
        Says::Unstable(None) => "unstable".to_owned(),
        Says::Unstable(Some(at)) => format!("unstable, lost at {:.5}", at * factor),
        Says::Left(at) => format!("left at {:.5}", at * factor),
        Says::Nothing(why) => format!("none: {why}"),
    }
}

/// Prints the rows of the table, and what is wrong in them.
fn check(cases: &[Critical]) {
    let mut wrong = Vec::new();
    for Critical { name, exact, at, rods } in cases {
        for &kind in *rods {
            let of = |factor: f64| {
                let (robot, case) = at(factor * exact);
                says(kind, &robot, &case)
            };
            let (below, above) = (of(0.995), of(1.005));
            let row = format!(
                "| {name} | {exact:.6} | {} | {} | {} |",
                kind.name(),
                show(&below, 0.995),
                show(&above, 1.005)
            );
            println!("{row}");
            let near = |load: f64| (1.005 * load - 1.0).abs() < 1e-3;
            let is_right = matches!(below, Says::Stable)
                && match above {
                    Says::Unstable(lost_at) => lost_at.is_none_or(near),
                    Says::Left(load) => near(load),
                    _ => false,
                };
            if !is_right {
                wrong.push(row);
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn columns_buckle_at_their_exact_loads() {
    check(&columns());
}

#[test]
fn strips_tip_over_at_their_exact_loads() {
    check(&strips());
}

#[test]
fn spans_buckle_under_a_central_cable_at_their_exact_tensions() {
    check(&spans());
}

#[test]
fn columns_between_locked_cables_buckle_at_their_exact_loads() {
    check(&locked());
}

/// Beyond the critical load of a perfect column or strip the answer is a stable branch.
#[test]
fn perfect_columns_leave_the_straight_shape() {
    for Critical { name, exact, at, rods } in columns().iter().chain(&strips()) {
        for &kind in *rods {
            for factor in [1.005, 1.2] {
                let (robot, case) = at(factor * exact);
                let said = says(kind, &robot, &case);
                assert!(matches!(said, Says::Left(_)), "{name}, {kind:?}, {factor}: {said:?}");
            }
        }
    }
}

/// Cables along the axis are never a reason to buckle where they follow it.
#[test]
fn a_continuous_central_cable_never_buckles_a_rod() {
    for Critical { exact, at, .. } in spans() {
        let (robot, case) = at(1.3 * exact);
        let said = says(ModelKind::Cosserat, &robot, &case);
        assert!(matches!(said, Says::Stable), "{said:?}");
    }
}

/// A dead moment has no potential, and a rod under nothing else has one equilibrium.
#[test]
fn roll_up_by_a_dead_moment_is_not_called_unstable() {
    for kind in RODS {
        for torsion in [0.5, 0.77, 1.0, 2.0] {
            for turns in [0.05, 0.25, 0.5, 0.9, 1.0, 1.5, 2.0] {
                let rod = Rod { torsion, ..Rod::round() };
                let loads = Loads { tip_moment: TAU * turns * Vec3::Y, ..Loads::default() };
                let (robot, case) = under(rod.robot(vec![]), loads);
                let diagnostics = solve(kind, &robot, &case).unwrap().diagnostics;
                let label = format!("{kind:?}, GJ = {torsion}, {turns} turns: {diagnostics:?}");
                assert!(!diagnostics.is_unstable(), "{label}");
                assert_eq!(diagnostics.stability_lost_at, None, "{label}");
                if turns >= 1.0 {
                    let absent = Some(NoStability::DeadMoments);
                    assert_eq!(diagnostics.stability_absent, absent, "{label}");
                }
            }
        }
    }
}

/// The fraction of the load at which stability is said to be lost is where it is lost.
#[test]
fn stability_is_lost_where_it_is_said_to_be() {
    let mut lost = 0;
    for (n, cables) in [0, 3, 4, 6].into_iter().enumerate() {
        for axial in [None, Some(1e5)] {
            let rod = Rod { axial, disks: 6, ..Rod::round() };
            let robot = rod.robot(around(cables));
            let shorten = |i: usize| Shortening::Length(1e-4 * (n % 3) as f64 * (1 + i % 2) as f64);
            let lengths: Vec<Shortening> = (0..cables).map(shorten).collect();
            // Not across cables that just fit the straight rod: chords slacken by the square of the deflection, so
            // that they let the tip turn a little, and the path has several shapes at one load.
            let across = if n == 1 { 0.1 } else { 0.0 };
            let force = Vec3::new(across, 0.0, -6.0 - 2.0 * n as f64);
            for kind in RODS {
                let at = |factor: f64| {
                    let loads = Loads { tip_force: factor * force, ..Loads::default() };
                    solve(kind, &robot, &Case { loads, ..Case::with_shortenings(&lengths) })
                };
                let label = format!("{kind:?}, {cables} cables, {axial:?}, {force:?}");
                let Ok(whole) = at(1.0) else { continue };
                let Some(load) = whole.diagnostics.stability_lost_at else { continue };
                println!("{label}: lost at {load:.4}");
                assert!(load > 0.01, "{label}: lost at {load}");
                // Lengths that fit the buckled shape need not fit the straight one.
                let (Ok(below), Ok(above)) = (at(0.99 * load), at(1.01 * load)) else { continue };
                let (below, above) = (below.diagnostics, above.diagnostics);
                lost += 1;
                assert_eq!(below.stable, Some(true), "{label}: below {load}: {below:?}");
                assert_eq!(below.stability_lost_at, None, "{label}: below {load}");
                let beyond = above.stability_lost_at;
                assert!(
                    above.is_unstable() || beyond.is_some(),
                    "{label}: above {load}: {above:?}"
                );
            }
        }
    }
    assert!(lost >= 5, "{lost}");
}
