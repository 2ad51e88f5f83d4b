//! Loads so strong that a shot from the base misses the tip by many orders of magnitude.

use whipcord::cosserat::Options;
use whipcord::{
    Backbone, Cable, Case, Disks, DistributedLoad, Loads, Material, Model, Robot, Routing, Section,
    Solution, SolveError, Statics, Stations, Vec3,
};

fn cantilever(length: f64, diameter: f64) -> Robot {
    let backbone = Backbone {
        section: Some(Section::circle(diameter)),
        material: Material {
            young_modulus: Some(1.1e9),
            poisson_ratio: Some(0.3),
            density: Some(1040.0),
            ..Material::default()
        },
        ..Backbone::new(length)
    };
    Robot::new(backbone, Disks::equally_spaced(length, 10, 0.008), vec![]).unwrap()
}

fn solve(robot: &Robot, loads: Loads) -> Solution {
    let case = Case { loads, ..Case::default() };
    Model::Cosserat(Options::default()).solve(robot, &case).unwrap()
}

/// `x/L` of the tip of the paper's backbone under a transverse tip force in N, by collocation
/// (SciPy's `solve_bvp`) on the stretched and sheared rod, continued in the load.
const TRANSVERSE: [(f64, f64); 3] = [(10.0, 0.933), (30.0, 0.965), (100.0, 0.992)];

#[test]
fn a_strong_transverse_force_pulls_the_rod_straight() {
    let robot = cantilever(0.18, 0.003);
    for (force, x) in TRANSVERSE {
        let loads = Loads { tip_force: Vec3::X * force, ..Loads::default() };
        let solution = solve(&robot, loads);
        let tip = solution.disks.tip().position / 0.18;
        assert!((tip.x - x).abs() < 1e-3, "{force} N: {}", tip.x);
        assert!(solution.diagnostics.stable == Some(true));
    }
}

/// The first integral of the rod under a dead force: without shear and stretch,
/// `½ u²·EI + F·t` is constant, and the curvature at the tip vanishes.
#[test]
fn the_base_moment_meets_the_first_integral_of_the_elastica() {
    // So slender that stretch and shear do not count.
    let robot = cantilever(0.18, 0.0003);
    let stiffness = 1.1e9 * core::f64::consts::PI * 0.0003_f64.powi(4) / 64.0;
    let euler = 2.467 * stiffness / (0.18 * 0.18);
    for force in [5.0, 50.0, 300.0] {
        let loads = Loads { tip_force: Vec3::X * force * euler, ..Loads::default() };
        let solution = solve(&robot, loads);
        let along_tip = solution.disks.tip().rotation.rotate(Vec3::Z).x;
        let moment = solution.base_wrench.unwrap().moment.norm();
        let exact = (2.0 * stiffness * force * euler * along_tip).sqrt();
        assert!((moment / exact - 1.0).abs() < 1e-4, "{force}: {moment} {exact}");
    }
}

#[test]
fn a_long_thread_hangs_down() {
    // 3 m of a rod of 0.5 mm under its own weight: 5000 times the weight that bends it by a radian.
    let robot = cantilever(3.0, 0.0005);
    let loads = Loads { gravity: Some(Vec3::X * 9.81), ..Loads::default() };
    let solution = solve(&robot, loads);
    let tip = solution.disks.tip().position;
    assert!(tip.x > 2.97 && tip.x < 3.0 && tip.z > 0.0 && tip.z < 0.1, "{tip:?}");
    assert!(solution.diagnostics.stable == Some(true));
    let weight = 1040.0 * 9.81 * 3.0 * core::f64::consts::PI * 0.0005_f64.powi(2) / 4.0;
    assert!((solution.base_wrench.unwrap().force.x / weight - 1.0).abs() < 1e-12);
}

/// A rod under a uniform load across it hangs in the direction of the load but for a layer of the thickness
/// `δ = √(EI/(qL))` at its base. There, with α the angle to the load, `α′ = −(2/δ) sin(α/2)` falls from a right
/// angle, so that `∫ (1 − cos α) ds = 2δ (1 − cos π/4)` and `∫ sin α ds = 2δ sin π/4`; and as the force falls by
/// q, `M₀²/(2 EI q) = L − ∫ (1 − cos α) ds`. All of them are off by δ²/L.
#[test]
fn a_strong_uniform_load_bends_a_layer_at_the_base() {
    // So slender that stretch and shear do not count.
    let robot = cantilever(0.18, 3e-6);
    let stiffness = 1.1e9 * core::f64::consts::PI * 3e-6_f64.powi(4) / 64.0;
    for strength in [1e3_f64, 1e4, 1e5] {
        let load = strength * stiffness / 0.18_f64.powi(3);
        let distributed = vec![DistributedLoad::uniform(0.18, load * Vec3::X)];
        let solution = solve(&robot, Loads { distributed, ..Loads::default() });
        let layer = 1.0 / strength.sqrt();
        let half = core::f64::consts::FRAC_PI_4;
        let short = 2.0 * layer * (1.0 - half.cos());
        let tip = solution.disks.tip().position / 0.18;
        let moment = solution.base_wrench.unwrap().moment.norm();
        let borne = moment * moment / (2.0 * stiffness * load * 0.18);
        for (found, expected) in
            [(tip.x, 1.0 - short), (tip.z, 2.0 * layer * half.sin()), (borne, 1.0 - short)]
        {
            let missed = (found - expected).abs();
            assert!(missed < 2.0 * layer * layer, "{strength}: {found} {expected}");
        }
        assert!(solution.diagnostics.stable == Some(true));
    }
}

/// What is out of all proportion is refused, with what to do, after a bounded search.
#[test]
fn absurd_loads_are_refused_with_a_reason() {
    let backbone = cantilever(0.18, 0.003).backbone().clone();
    let helix = Routing::Helix { start_angle: 0.0, turns: 0.75, radius: 0.008 };
    let disks = Disks::equally_spaced(0.18, 10, 0.008);
    let robot = Robot::new(backbone, disks, vec![Cable::new("pull", helix)]).unwrap();
    let force = |force| Loads { tip_force: force, ..Loads::default() };
    let absurd = [
        force(Vec3::X * 1e6),
        force(Vec3::Z * -1e6),
        force(Vec3::new(0.0, 0.3, 1.0) * 1e6),
        Loads { tip_follower: true, ..force(Vec3::X * 1e4) },
    ];
    let tried = if cfg!(debug_assertions) { 1 } else { absurd.len() };
    for loads in absurd.into_iter().take(tried) {
        let case = Case { loads, ..Case::with_tensions(&[3.9]) };
        let refused = Model::Cosserat(Options::default()).solve(&robot, &case);
        let Err(SolveError::NotConverged { advice, iterations, .. }) = refused else {
            panic!("{refused:?}")
        };
        assert!(advice.contains("units"), "{advice}");
        assert!(iterations < 1000, "{iterations}");
    }
}

/// A steel rod that its cable winds up by as much as one and a half turns: the base bears the weight
/// and its moment about it, which the shape tells.
#[test]
fn a_straight_cable_with_gravity_converges_from_cold_at_any_tension() {
    let (density, area) = (7850.0, core::f64::consts::PI * 1e-6);
    let backbone = Backbone {
        section: Some(Section::circle(0.002)),
        material: Material {
            young_modulus: Some(200e9),
            poisson_ratio: Some(0.3),
            density: Some(density),
            ..Material::default()
        },
        ..Backbone::new(0.5)
    };
    let cable = Cable::new("pull", Routing::Straight { angle: 0.0, radius: 0.015 });
    let disks = Disks::equally_spaced(0.5, 10, 0.015);
    let robot = Robot::new(backbone, disks, vec![cable]).unwrap();
    let options = Options { stations: Stations::Equal(401), ..Options::default() };
    for gravity in [Vec3::X * -9.81, Vec3::X * 9.81, Vec3::Y * 9.81, Vec3::Z * -9.81] {
        for tension in [5.0, 15.0, 45.0, 150.0, 200.0, 300.0] {
            let mut case = Case::with_tensions(&[tension]);
            case.loads.gravity = Some(gravity);
            let solution = Model::Cosserat(options.clone()).solve(&robot, &case).unwrap();
            let borne = solution.base_wrench.unwrap();
            let weight = gravity * (density * area);
            assert!((borne.force - weight * 0.5).norm() < 1e-12, "{tension} N: {borne:?}");
            let at = |i: usize| solution.shape.poses[i].position.cross(weight);
            let (h, ends) = (0.5 / 400.0, (at(0) + at(400)) * 0.5);
            let moment = (1..400).fold(ends, |sum, i| sum + at(i)) * h;
            let missed = (borne.moment - moment).norm();
            // The trapezoidal rule errs by h² times the slope of the ends.
            let bound = h * h * weight.norm();
            assert!(missed < bound, "{tension} N: {missed:e}, {bound:e}");
        }
    }
}

/// A finger with three cables that a force presses over, of so many N.
fn pressed(force: f64, share: f64) -> (Robot, Case) {
    let cable = |k: u32| {
        let start_angle = f64::from(k) * core::f64::consts::TAU / 3.0;
        let routing = Routing::Helix { start_angle, turns: 0.4, radius: 0.008 };
        Cable::new(format!("{k}"), routing)
    };
    let bare = cantilever(0.18, 0.003);
    let cables = (0..3).map(cable).collect();
    let robot = Robot::new(bare.backbone().clone(), bare.disks().clone(), cables).unwrap();
    let tip_force = Vec3::new(force, 0.4 * force, 0.0);
    let loads = Loads { tip_force, ..Loads::default() };
    (robot, Case { loads, ..Case::with_tensions(&[share * 3.0, 0.5, 0.2]) })
}

/// What single shooting cannot reach is gone on to from the nodes of a neighbouring answer, without raising the load once more.
#[test]
fn strong_loads_are_followed_from_a_neighbour() {
    for force in [2.0, 3.0, 5.0] {
        for share in [0.97, 1.03] {
            let (robot, case) = pressed(force, 1.0);
            let model = Model::Cosserat(Options::default());
            let mut model = model.prepare(&robot, &case.loads).unwrap();
            let before = model.solve(&pressed(force, share).1, None).unwrap();
            let cold = model.solve(&case, None).unwrap();
            let warm = model.solve(&case, Some(&before)).unwrap();
            let apart = warm.disks.distances(&cold.disks).fold(0.0, f64::max);
            assert!(apart < 1e-9, "{force} N, {share}: {apart:.1e}");
            assert_eq!(warm.diagnostics.stable, Some(true));
            let [few, many] = [&warm, &cold].map(|of| of.diagnostics.iterations);
            assert!(2 * few <= many, "{force} N, {share}: {few} of {many}");
        }
    }
}

/// An answer that tells no nodes, as one from a file, is a start by its wrench and its tensions.
#[test]
fn an_answer_without_nodes_is_a_start_as_well() {
    let (robot, case) = pressed(0.05, 1.0);
    let model = Model::Cosserat(Options::default());
    let mut model = model.prepare(&robot, &case.loads).unwrap();
    let mut before = model.solve(&pressed(0.05, 0.9).1, None).unwrap();
    let with_nodes = model.solve(&case, Some(&before)).unwrap();
    before.internal.clear();
    let without = model.solve(&case, Some(&before)).unwrap();
    let apart = with_nodes.disks.distances(&without.disks).fold(0.0, f64::max);
    assert!(apart < 1e-9, "{apart:.1e}");
    assert_ne!(with_nodes.internal, without.internal);
}
