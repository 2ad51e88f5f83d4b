//! Buckled shapes, snap-through, and all equilibria under one load, of both rods.

use core::f64::consts::{FRAC_PI_2, PI};

use crate::common::round;
use whipcord::cosserat::{Cosserat, Options, Workspace};
use whipcord::{
    Actuation, Backbone, BranchOptions, Branches, Cable, CableCommand, Case, CriticalKind, Disks,
    Equilibrium, Loads, Material, Model, ModelKind, RestCurvature, Robot, Routing, Section,
    Shortening, Solution, SolveError, Stations, Vec3,
};

const RODS: [ModelKind; 2] = [ModelKind::Cosserat, ModelKind::CosseratDisks];

fn branches_with(kind: ModelKind, robot: &Robot, case: &Case, options: &BranchOptions) -> Branches {
    let model = Model::new(kind, Stations::Disks, Actuation::Natural);
    model.prepare(robot, &case.loads).unwrap().branches(case, options).unwrap()
}

fn branches(kind: ModelKind, robot: &Robot, case: &Case) -> Branches {
    branches_with(kind, robot, case, &BranchOptions::default())
}

/// Length 1 and EI = 1 in the plane of x and z, 100 times as stiff across it; `EI/(EA L²) = 1e-10`.
fn blade(rest_curvature: f64) -> Robot {
    blade_of(1e-5, rest_curvature)
}

/// The same for another radius of gyration: its square is `EI/(EA L²)`.
fn blade_of(gyration: f64, rest_curvature: f64) -> Robot {
    let (width, height) = (gyration * 12_f64.sqrt(), 10.0 * gyration * 12_f64.sqrt());
    let young = 12.0 / (height * width.powi(3));
    let backbone = Backbone {
        section: Some(Section::rectangle(width, height)),
        material: Material {
            young_modulus: Some(young),
            poisson_ratio: Some(0.3),
            ..Material::default()
        },
        rest_curvature: RestCurvature::Uniform(Vec3::Y * rest_curvature),
        ..Backbone::new(1.0)
    };
    Robot::new(backbone, Disks::equally_spaced(1.0, 11, 0.01), vec![]).unwrap()
}

fn force(x: f64, z: f64) -> Case {
    let loads = Loads { tip_force: Vec3::new(x, 0.0, z), ..Loads::default() };
    Case { loads, ..Case::default() }
}

/// The plane elastica by itself: with `θ` from the z axis, `θ′ = κ + M`, `M′ = F_z sin θ − F_x cos θ`,
/// shot from the base with the classical Runge–Kutta method. Returns the moment left at the tip and
/// the tip.
fn plane(rest_curvature: f64, [fx, fz]: [f64; 2], base_moment: f64) -> (f64, [f64; 2]) {
    const STEPS: usize = 400;
    let rate = |[theta, moment, _, _]: [f64; 4]| {
        let (sin, cos) = theta.sin_cos();
        [rest_curvature + moment, fz * sin - fx * cos, sin, cos]
    };
    let h = 1.0 / STEPS as f64;
    let mut y = [0.0, base_moment, 0.0, 0.0];
    for _ in 0..STEPS {
        let at = |f: f64, k: [f64; 4]| core::array::from_fn(|i| y[i] + f * h * k[i]);
        let k1 = rate(y);
        let k2 = rate(at(0.5, k1));
        let k3 = rate(at(0.5, k2));
        let k4 = rate(at(1.0, k3));
        y = core::array::from_fn(|i| y[i] + h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]));
    }
    (y[1], [y[2], y[3]])
}

/// All equilibria of the plane elastica: the roots of the moment at the tip, by a scan of the moment
/// at the base.
fn all_in_plane(rest_curvature: f64, force: [f64; 2]) -> Vec<[f64; 2]> {
    const PARTS: usize = 4000;
    let at = |m: f64| plane(rest_curvature, force, m).0;
    let reach = 3.0 * (force[0].abs() + force[1].abs()) + 10.0;
    let moment = |i: usize| reach * (2.0 * i as f64 / PARTS as f64 - 1.0) + 1e-7;
    let mut found = Vec::new();
    let mut before = at(moment(0));
    for i in 1..=PARTS {
        let after = at(moment(i));
        if before * after < 0.0 {
            let (mut low, mut high) = (moment(i - 1), moment(i));
            for _ in 0..60 {
                let middle = 0.5 * (low + high);
                if at(low) * at(middle) <= 0.0 { high = middle } else { low = middle }
            }
            found.push(plane(rest_curvature, force, low).1);
        }
        before = after;
    }
    found
}

fn tip(solution: &Solution) -> [f64; 2] {
    let p = solution.disks.tip().position;
    assert!(p.y.abs() < 1e-7, "{p:?} is not in the plane");
    [p.x, p.z]
}

fn is_near(a: [f64; 2], b: [f64; 2]) -> bool {
    (a[0] - b[0]).hypot(a[1] - b[1]) < 1e-6
}

/// `∫ dt/√(1 − k² sin² t)` and `∫ √(1 − k² sin² t) dt` over a quarter turn, by the arithmetic–geometric
/// mean.
fn elliptic(k: f64) -> (f64, f64) {
    let (mut a, mut b, mut c, mut power, mut sum) = (1.0, (1.0 - k * k).sqrt(), k, 0.5, 0.0);
    while c > 1e-16 {
        sum += power * c * c;
        (a, b, c) = (0.5 * (a + b), f64::sqrt(a * b), 0.5 * (a - b));
        power *= 2.0;
    }
    let first = FRAC_PI_2 / a;
    (first, first * (1.0 - sum))
}

/// Love, art. 263: under an end load `P = K(k)² EI/L²` with `k = sin(α/2)` the tip of a column leans by
/// α, and sits at `x = 2 k L/K`, `z = (2 E/K − 1) L`.
#[test]
fn a_buckled_column_is_the_elastica() {
    let column = blade(0.0);
    for (degrees, kind) in
        [20.0_f64, 60.0, 100.0, 140.0].into_iter().flat_map(|d| RODS.map(|k| (d, k)))
    {
        let k = (0.5 * degrees.to_radians()).sin();
        let (first, second) = elliptic(k);
        let load = first * first;
        let found = branches(kind, &column, &force(0.0, -load));
        assert!(found.complete);
        let [ref straight, ref bent @ ..] = found.equilibria[..] else { panic!("{found:?}") };
        assert_eq!((straight.branch, straight.stable), (Some(0), Some(false)));
        assert!(is_near(tip(&straight.solution), [0.0, 1.0]));
        let exact = [2.0 * k / first, 2.0 * second / first - 1.0];
        assert_eq!(bent.len(), 2, "{kind}, {degrees}: {found:?}");
        for (one, other) in [(0, 1), (1, 0)] {
            let [x, z] = tip(&bent[one].solution);
            assert!(is_near([x.abs(), z], exact), "{degrees}: {x} {z} {exact:?}");
            assert_eq!(bent[one].stable, Some(true));
            assert!(x * tip(&bent[other].solution)[0] < 0.0);
        }
        // They part from the straight column at Euler's load.
        let [ref at] = found.critical_points[..] else { panic!("{found:?}") };
        assert_eq!(at.kind, CriticalKind::Bifurcation(vec![1, 2]));
        let euler = FRAC_PI_2 * FRAC_PI_2;
        assert!((at.load * load / euler - 1.0).abs() < 1e-4, "{}", at.load * load / euler);
    }
}

/// Love, art. 263, so close to Euler's load that the branches come to all of the load before the first
/// step along them ends.
#[test]
fn a_column_a_little_above_eulers_load_has_a_bent_pair() {
    for (above, kind) in [1e-5_f64, 1e-4, 1e-3].into_iter().flat_map(|a| RODS.map(|k| (a, k))) {
        let load = (1.0 + above) * FRAC_PI_2 * FRAC_PI_2;
        let (mut low, mut high) = (0.0, 0.5);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if elliptic(middle).0.powi(2) < load { low = middle } else { high = middle }
        }
        let (first, second) = elliptic(low);
        let exact = [2.0 * low / first, 2.0 * second / first - 1.0];
        let found = branches(kind, &blade(0.0), &force(0.0, -load));
        assert!(found.complete);
        // The answer of a solve by the other rod may be that of coarser steps, on which the pair parts elsewhere.
        let followed =
            found.equilibria.iter().filter(|e| kind == ModelKind::Cosserat || e.branch.is_some());
        let stable: Vec<_> = followed.map(|e| (e.branch, e.stable)).collect();
        let pair = [(Some(1), Some(true)), (Some(2), Some(true))];
        assert_eq!(stable, [&[(Some(0), Some(false))][..], &pair].concat(), "{kind}, {above}");
        let [one, other] = [1, 2].map(|i: usize| tip(&found.equilibria[i].solution));
        assert!(one[0] * other[0] < 0.0);
        for [x, z] in [one, other] {
            let away = (x.abs() - exact[0]).hypot(z - exact[1]);
            assert!(away < 1e-2 * exact[0], "{above}: {x} {z} {exact:?}");
        }
    }
}

/// Just above the critical load.
#[test]
fn a_round_column_just_above_eulers_load_has_a_straight_shape_and_a_bent_pair() {
    let diameter = 1e-5_f64;
    let young = 64.0 / (PI * diameter.powi(4));
    let rod = round(1.0, diameter, young, 0.35 * young);
    let column = Robot::new(rod, Disks::equally_spaced(1.0, 11, 0.01), vec![]).unwrap();
    let found = branches(ModelKind::Cosserat, &column, &force(0.0, -1.002 * PI * PI / 4.0));
    let stable: Vec<_> = found.equilibria.iter().map(|e| e.stable).collect();
    assert_eq!(stable, [Some(false), Some(true), Some(true)], "{:?}", found.critical_points);
}

/// A rod bent at rest, pushed on its end: one shape leads from no load to all of it, and of what a scan
/// of the plane finds beside it, nothing hangs on it.
#[test]
fn a_bent_rod_bends_on_without_a_branch() {
    for (push, kind) in
        [[-0.3, -2.0], [0.5, -3.0], [0.0, -4.0]].into_iter().flat_map(|p| RODS.map(|k| (p, k)))
    {
        let found = branches(kind, &blade(0.6), &force(push[0], push[1]));
        assert!(found.complete && found.critical_points.is_empty(), "{found:?}");
        let [ref shape] = found.equilibria[..] else { panic!("{found:?}") };
        let exact = all_in_plane(0.6, push);
        assert!(exact.iter().any(|&e| is_near(e, tip(&shape.solution))), "{exact:?}");
        assert_eq!((shape.branch, shape.stable), (Some(0), Some(true)));
    }
}

/// Well beyond the second buckling load all shapes of a column in its plane are found: straight, and
/// bent in one and in two waves to both sides. Others leave the plane.
#[test]
fn beyond_the_second_buckling_load_a_column_has_five_shapes() {
    let load = 1.3 * 9.0 * PI * PI / 4.0;
    let (column, case) = (blade(0.0), force(0.0, -load));
    let options = BranchOptions { most_branches: 5, ..BranchOptions::default() };
    for kind in RODS {
        let found = branches_with(kind, &column, &case, &options);
        assert!(!found.complete);
        let mut exact = all_in_plane(0.0, [0.0, -load]);
        assert_eq!(exact.len(), 5, "{exact:?}");
        let in_plane = |e: &&Equilibrium| e.solution.disks.tip().position.y.abs() < 1e-7;
        for equilibrium in found.equilibria.iter().filter(in_plane) {
            let here = tip(&equilibrium.solution);
            let place = exact.iter().position(|&e| is_near(e, here));
            exact.remove(place.unwrap_or_else(|| panic!("{here:?} is not among {exact:?}")));
        }
        assert!(exact.is_empty(), "{exact:?} were not found: {:?}", found.critical_points);
        let stable =
            found.equilibria.iter().filter(in_plane).filter(|e| e.stable == Some(true)).count();
        assert_eq!(stable, 2);
    }
}

/// Between two locked cables a column buckles at four times the load, sidewards and with its tip
/// upright.
#[test]
fn a_column_between_locked_cables_buckles_with_its_tip_upright() {
    // Thick enough for cables to pull on: EA = 1e6.
    let column = blade_of(1e-3, 0.0);
    let cable = |angle: f64| Cable::new("cable", Routing::Straight { angle, radius: 0.05 });
    let cables = vec![cable(0.0), Cable { name: "other".into(), ..cable(PI) }];
    let robot = Robot::new(column.backbone().clone(), column.disks().clone(), cables).unwrap();
    // 50 N from each of them.
    let command = CableCommand { tension: None, shortening: Some(Shortening::Length(100.0 / 1e6)) };
    let case = Case { commands: vec![command; 2], ..force(0.0, -1.1 * PI * PI) };
    let found = branches(ModelKind::Cosserat, &robot, &case);
    let stable: Vec<_> = found.equilibria.iter().map(|e| e.stable).collect();
    assert_eq!(stable, [Some(false), Some(true), Some(true)], "{:?}", found.critical_points);
    let critical = found.critical_points[0].load * 1.1;
    assert!((critical - 1.0).abs() < 1e-3, "{critical}");
    for bent in &found.equilibria[1..] {
        let pose = bent.solution.disks.tip();
        assert!(pose.position.x.abs() > 0.1, "{pose:?}");
        assert!(pose.rotation.rotate(Vec3::Z).x.abs() < 1e-2, "{pose:?}");
    }
}

#[test]
fn without_load_there_is_one_shape() {
    let found = branches(ModelKind::Cosserat, &blade(0.6), &Case::default());
    assert_eq!(found.equilibria.len(), 1);
    assert_eq!(found.equilibria[0].stable, Some(true));
    assert!(found.critical_points.is_empty() && found.complete);
}

#[test]
fn what_has_no_shape_without_load_has_no_branches() {
    let cable = Cable::new("pull", Routing::Straight { angle: 0.0, radius: 0.01 });
    let blade = blade(0.0);
    let robot = Robot::new(blade.backbone().clone(), blade.disks().clone(), vec![cable]).unwrap();
    let case = Case { loads: force(0.0, -1.0).loads, ..Case::with_tensions(&[1e9]) };
    let model = Cosserat::new(&robot, &case.loads, &Options::default()).unwrap();
    let outcome = model.branches(&case, &BranchOptions::default(), &mut Workspace::default());
    assert!(matches!(outcome, Err(SolveError::SectionFolds { .. })), "{outcome:?}");
}
