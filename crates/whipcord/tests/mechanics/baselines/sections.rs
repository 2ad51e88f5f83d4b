//! Sections of an arc or of rigid bodies: against the rods, closed forms and virtual work.

use proptest::prelude::*;
use whipcord::cosserat::Accuracy;
use whipcord::pseudo_rigid_body::{Coefficients, Options};
use whipcord::{
    Actuation, Backbone, Cable, Case, Disks, Loads, Model, ModelKind, PointLoad, PointMass,
    RestCurvature, Robot, Routing, Shortening, Solution, SolveError, StabilityAnalysis,
    Statics as _, Stations, Stiffness, Vec3, cosserat_disks,
};

use crate::common::{
    Wildness, bending_stiffness, distance, fine_options, helix, lengths_of, paper_backbone,
    paper_disks, robot as any_robot, samples,
    sections::{ARC, BODIES},
    stability_of_path, straight,
    symmetry::Symmetry,
    tensions,
};

const PCC: ModelKind = ModelKind::PiecewiseConstantCurvature;
const PRB: ModelKind = ModelKind::PseudoRigidBody;

fn try_solve(kind: ModelKind, robot: &Robot, case: &Case) -> Result<Solution, SolveError> {
    Model::new(kind, Stations::Disks, Actuation::Natural)
        .with_stability(StabilityAnalysis::Eigenvalue)
        .solve(robot, case)
}

fn solve(kind: ModelKind, robot: &Robot, case: &Case) -> Solution {
    try_solve(kind, robot, case).unwrap()
}

/// The paper's rod with so many sections, which does not stretch or shear.
fn rod(sections: usize, routings: Vec<Routing>) -> Robot {
    let backbone = Backbone { extensible: false, shearable: false, ..paper_backbone() };
    let disks = Disks::equally_spaced(0.18, sections + 1, 0.008);
    let cable = |(i, routing)| Cable::new(format!("cable {i}"), routing);
    Robot::new(backbone, disks, routings.into_iter().enumerate().map(cable).collect()).unwrap()
}

/// At the answer no small change of any coordinate does work: told by the energy alone, put together here
/// from poses and hole distances.
#[test]
fn no_small_change_does_work() {
    let robot = rod(5, vec![helix(20.0, 0.7), helix(160.0, -0.3)]);
    let point = PointLoad { at: 0.108, force: Vec3::new(0.0, -0.1, 0.05), ..PointLoad::default() };
    let loads =
        Loads { tip_force: Vec3::new(0.1, 0.05, -0.1), points: vec![point], ..Loads::default() };
    let case = Case { loads, ..Case::with_tensions(&[3.0, 1.5]) };
    for parts in [ARC, BODIES] {
        let q = parts.coordinates(&robot, &case);
        let scale = bending_stiffness(&robot) / 0.18;
        for k in 0..q.len() {
            for a in 0..q[k].len() {
                let energy = |step: f64| {
                    let mut q = q.clone();
                    q[k][a] += step;
                    parts.energy(&robot, &case, &q)
                };
                let work = (energy(1e-4) - energy(-1e-4)) / 2e-4;
                assert!(work.abs() < 1e-7 * scale, "{} {k} {a}: {work:e}", parts.kind);
                // It would notice: the section's own moment is not small.
                assert!(a == 0 || (energy(0.02) - energy(0.0)).abs() > 1e-8 * scale);
            }
        }
        // What the base holds are the forces that act.
        let wrench = solve(parts.kind, &robot, &case).base_wrench.unwrap();
        let force = case.loads.tip_force + case.loads.points[0].force;
        assert!((wrench.force - force).norm() < 1e-14);
    }
}

/// One section with a straight cable: the bend φ that makes `½ EI φ²/h + 2τ (h/φ − r) sin(φ/2)` stationary.
#[test]
fn one_arc_with_a_straight_cable_is_a_closed_form() {
    let robot = rod(1, vec![straight(0.0)]);
    let (h, r, k) = (0.18, 0.008, bending_stiffness(&robot));
    for tension in [0.3, 0.6, 0.9] {
        let found = solve(PCC, &robot, &Case::with_tensions(&[tension]));
        let phi = found.disks.tip().rotation.log().norm();
        let (sin, cos) = (0.5 * phi).sin_cos();
        let slope = -2.0 * h / (phi * phi) * sin + (h / phi - r) * cos;
        assert!(
            (k * phi / h + tension * slope).abs() < 1e-11,
            "{phi} {:e} {:?} {:?}",
            k * phi / h + tension * slope,
            found.disks.tip(),
            found.diagnostics
        );
        assert!((found.cables[0].length - 2.0 * (h / phi - r) * sin).abs() < 1e-15);
    }
}

/// Largest distance from the rod with the same straight cables between the disks, with so many sections.
fn error(kind: ModelKind, sections: usize, routing: &Routing, case: &Case) -> f64 {
    let robot = rod(sections, vec![routing.clone()]);
    let options =
        cosserat_disks::Options { accuracy: Accuracy::Tolerance(1e-9), ..Default::default() };
    let reference = Model::CosseratDisks(options).solve(&robot, case).unwrap();
    distance(&solve(kind, &robot, case), &reference)
}

/// The error of arcs falls with the square of their number, and with the fourth power where a straight cable bends
/// all of them alike. Rigid bodies come within what their coefficients are off by, and stay there.
#[test]
fn arcs_come_to_the_rod() {
    let push = Loads { tip_force: Vec3::new(0.05, 0.1, -0.05), ..Loads::default() };
    let pulled = Case::with_tensions(&[3.0]);
    let loaded = Case { loads: push, ..Case::with_tensions(&[2.0]) };
    for (routing, case, ratio) in [
        (straight(0.0), &pulled, 15.0..19.0),
        (helix(0.0, 0.5), &pulled, 3.9..4.2),
        (helix(0.0, 0.5), &loaded, 3.9..4.2),
    ] {
        let [coarse, fine] = [8, 16].map(|sections| error(PCC, sections, &routing, case));
        assert!(ratio.contains(&(coarse / fine)), "{coarse:e} {fine:e}");
        let bodies = [8, 16].map(|sections| error(PRB, sections, &routing, case));
        assert!(bodies.iter().all(|error| (1e-4..1e-3).contains(error)), "{bodies:?}");
    }
}

/// A cantilever of one section under a force at its tip, across it or inclined, against the elastica: the tip to
/// 1.3 % of the length up to `F L²/EI = 2` across (Su 2009 states 1.2 %, for a mechanism of such beams).
#[test]
fn bodies_bend_as_the_elastica() {
    let robot = rod(1, vec![]);
    let unit = bending_stiffness(&robot) / 0.18_f64.powi(2);
    let mut worst = 0.0_f64;
    for (strength, degrees) in [(0.5, 90.0), (1.0, 90.0), (2.0, 90.0), (5.0, 30.0), (1.5, 150.0)] {
        let (sin, cos) = f64::to_radians(degrees).sin_cos();
        let tip_force = Vec3::new(sin, 0.0, cos) * (strength * unit);
        let case = Case { loads: Loads { tip_force, ..Loads::default() }, ..Case::default() };
        let elastica = Model::Cosserat(fine_options()).solve(&robot, &case).unwrap().disks.tip();
        let ours = solve(PRB, &robot, &case).disks.tip();
        worst = worst.max((ours.position - elastica.position).norm() / 0.18);
    }
    assert!((0.01..0.013).contains(&worst), "{worst}");
    // A moment bends it to the sum of the joints' compliances.
    let moment = Vec3::Y * (bending_stiffness(&robot) / 0.18);
    let case = Case { loads: Loads { tip_moment: moment, ..Loads::default() }, ..Case::default() };
    let bend = solve(PRB, &robot, &case).disks.tip().rotation.log().norm();
    let sum: f64 = [3.51_f64, 2.99, 2.58].iter().map(|k| k.recip()).sum();
    assert!((bend - sum).abs() < 1e-10 && (bend - 1.0).abs() < 0.01, "{bend}");
    let rao = Options { coefficients: Coefficients::Rao, ..Options::default() };
    let bend = Model::PseudoRigidBody(rao).solve(&robot, &case).unwrap().disks.tip();
    assert!((bend.rotation.log().norm() - 1.0).abs() < 0.002);
}

/// A straight rod that is pressed buckles at `π² EI/4L²`; so do many arcs, and their stability says so.
#[test]
fn a_column_buckles_at_eulers_load() {
    let robot = rod(24, vec![]);
    let euler = core::f64::consts::PI.powi(2) * bending_stiffness(&robot) / (4.0 * 0.18 * 0.18);
    for (kind, near) in [(PCC, 2e-3), (PRB, 2e-2)] {
        let stability = |share: f64| {
            let tip_force = Vec3::Z * (-share * euler);
            let case = Case { loads: Loads { tip_force, ..Loads::default() }, ..Case::default() };
            stability_of_path(&solve(kind, &robot, &case))
        };
        assert!((stability(0.0) - 1.0).abs() < 1e-6);
        // It falls in proportion to the load, and is nothing at the critical one.
        assert!((stability(0.5) - 0.5).abs() < near, "{}", stability(0.5));
        assert!(stability(1.0 - 2.0 * near) > 0.0 && stability(1.0 + 2.0 * near) < 0.0);
        // Beyond it the answer is the buckled column.
        assert!((stability(3.0) + 2.0 / 3.0).abs() < near, "{}", stability(3.0));
    }
}

/// What mirrors, turns and moves the robot does so to its shape; what is solved again from its answer stays.
#[test]
fn symmetries_hold_and_neighbours_lead_to_the_same_answer() {
    let wild = [Wildness::UNLOADED, Wildness::LOADED];
    let mut solved = [0; 2];
    for (k, (robot, case)) in
        wild.into_iter().flat_map(|wild| samples(any_robot(wild), 100)).enumerate()
    {
        // Anchors between disks, and sections so long that their cables fold them, are for others.
        for (count, kind) in solved.iter_mut().zip([PCC, PRB]) {
            let model = Model::new(kind, Stations::Disks, Actuation::Natural)
                .with_stability(StabilityAnalysis::Eigenvalue);
            let answer = match model.solve(&robot, &case) {
                Ok(answer) => answer,
                Err(SolveError::Unsupported { .. } | SolveError::SectionFolds { .. }) => continue,
                Err(error) => panic!("{kind} {k}: {error}"),
            };
            *count += 1;
            let length = robot.backbone().length;
            for symmetry in [Symmetry::Mirror, Symmetry::turn_of(&robot, 5)] {
                let image = model.solve(&symmetry.robot(&robot), &symmetry.case(&case)).unwrap();
                let error = symmetry.error(&answer, &image, length);
                assert!(error < 1e-9, "{kind} {k} {symmetry:?}: {error:e}");
            }
            let mut prepared = model.prepare(&robot, &case.loads).unwrap();
            let again = prepared.solve(&case, Some(&answer)).unwrap();
            assert!(distance(&again, &answer) < 1e-9 * length, "{kind} {k}");
            assert!(again.diagnostics.iterations <= answer.diagnostics.iterations);
        }
    }
    assert!(solved.iter().all(|&count| count > 40), "{solved:?}");
}

/// A pressed robot is held by its cables where they are locked as the rod with the same cables is.
#[test]
fn locked_cables_hold() {
    let robot = rod(16, vec![straight(0.0), straight(90.0)]);
    let euler = core::f64::consts::PI.powi(2) * bending_stiffness(&robot) / (4.0 * 0.18 * 0.18);
    let loads = Loads { tip_force: Vec3::Z * (-0.7 * euler), ..Loads::default() };
    let pulled = Case { loads: loads.clone(), ..Case::with_tensions(&[1.0, 0.5]) };
    let stability = |kind| {
        let before = solve(kind, &robot, &pulled);
        let locked = solve(kind, &robot, &lengths_of(&before, &loads));
        assert!(distance(&before, &locked) < 1e-8);
        [before, locked].map(|answer| answer.diagnostics.stability.unwrap())
    };
    let rods = stability(ModelKind::CosseratDisks);
    assert!(rods[1] > rods[0] + 0.1, "{rods:?}");
    for kind in [PCC, PRB] {
        let ours = stability(kind);
        let off = ours.iter().zip(rods).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(off < 0.03, "{kind} {ours:?} {rods:?}");
    }
}

/// The lengths of an answer lead back to it, under load too.
#[test]
fn lengths_lead_back_to_the_tensions() {
    let robot = rod(8, vec![straight(0.0), helix(120.0, 0.25), straight(240.0)]);
    let push = Loads { tip_force: Vec3::new(0.03, 0.05, -0.02), ..Loads::default() };
    for loads in [Loads::default(), push] {
        for kind in [PCC, PRB] {
            let case = Case { loads: loads.clone(), ..Case::with_tensions(&[3.0, 1.0, 0.5]) };
            let pulled = solve(kind, &robot, &case);
            let held = solve(kind, &robot, &lengths_of(&pulled, &loads));
            assert!(distance(&held, &pulled) < 1e-9, "{:e}", distance(&held, &pulled));
            for (a, b) in tensions(&held).iter().zip(tensions(&pulled)) {
                assert!((a - b).abs() < 1e-6, "{a} {b}");
            }
            // What is held besides is no less stable.
            let stability = |s: &Solution| s.diagnostics.stability.unwrap();
            assert!(stability(&held) > stability(&pulled) - 1e-6);
        }
    }
    // A cable that is paid out hangs loose.
    let robot = rod(8, vec![straight(0.0), straight(90.0)]);
    let case = Case::with_shortenings(&[Shortening::Length(0.005), Shortening::Length(-0.002)]);
    let found = solve(PCC, &robot, &case);
    assert!(found.cables[1].slack && !found.cables[0].slack);
    assert!((found.cables[0].length - 0.175).abs() < 1e-13);
}

/// Loads and a mass between two disks: the arcs come to the rod with the same straight cables, with the square of the length of the
/// sections, and the base bears what acts.
#[test]
fn loads_between_disks_act_where_they_are() {
    for follower in [false, true] {
        let errors = [12, 24].map(|sections| {
            let bare = rod(sections, vec![straight(0.0)]);
            let backbone = Backbone { linear_density: Some(0.0.into()), ..bare.backbone().clone() };
            let robot = Robot::new(backbone, bare.disks().clone(), bare.cables().to_vec()).unwrap();
            // A third of a section from a disk.
            let at = 0.18 * (0.5 + 1.0 / 36.0);
            let force = Vec3::new(0.15, -0.1, 0.05);
            let moment = Vec3::new(1e-3, 0.0, 5e-4);
            let mut case = Case::with_tensions(&[1.0]);
            case.loads.points = vec![PointLoad { at, force, moment, follower }];
            case.loads.masses = vec![PointMass { at: 0.18 * (0.25 + 1.0 / 36.0), mass: 0.01 }];
            case.loads.gravity = Some(Vec3::new(0.0, 9.81, 0.0));
            let found = solve(PCC, &robot, &case);
            if !follower {
                let expected = force + Vec3::new(0.0, 0.0981, 0.0);
                assert!((found.base_wrench.unwrap().force - expected).norm() < 1e-12);
            }
            let exact = solve(ModelKind::CosseratDisks, &robot, &case);
            found.disks.distances(&exact.disks).fold(0.0, f64::max) / 0.18
        });
        assert!(errors[0] < 5e-3, "{follower} {errors:?}");
        assert!((2.5..6.0).contains(&(errors[0] / errors[1])), "{follower} {errors:?}");
    }
}

#[test]
fn what_the_sections_cannot_take_is_refused_by_name() {
    let pull = Case::with_tensions(&[1.0]);
    let with = |cable: Cable, backbone: Backbone| {
        Robot::new(backbone, paper_disks(), vec![cable]).unwrap()
    };
    let plain = Cable::new("a", straight(0.0));
    let loaded = |loads: Loads| Case { loads, ..pull.clone() };
    let gravity = Some(Vec3::Z * 9.81);
    let usual = with(plain.clone(), paper_backbone());
    let rolled_up =
        Backbone { rest_curvature: RestCurvature::Uniform(Vec3::Y * 200.0), ..paper_backbone() };
    let mut k = [[0.0; 6]; 6];
    for (i, row) in k.iter_mut().enumerate() {
        row[i] = if i < 3 { 1e3 } else { 4e-3 };
    }
    (k[3][5], k[5][3]) = (1e-3, 1e-3);
    let coupled = Backbone { stiffness: Some(Stiffness::Matrix(k.into())), ..Backbone::new(0.18) };
    let cases = [
        (with(plain.clone(), coupled), pull.clone(), "backbone.stiffness.matrix"),
        (with(plain.clone(), rolled_up), pull.clone(), "backbone.rest_curvature"),
        (with(plain, Backbone::new(0.18)), pull.clone(), "backbone.diameter"),
        (usual.clone(), loaded(Loads { gravity, ..Loads::default() }), "backbone.density"),
        (
            usual.clone(),
            Case { commands: vec![Default::default()], ..Case::default() },
            "cables[0].tension",
        ),
    ];
    for (robot, case, at) in cases {
        for kind in [PCC, PRB] {
            match try_solve(kind, &robot, &case) {
                Err(
                    SolveError::Unsupported { model, path, .. }
                    | SolveError::Missing { model, path, .. },
                ) => assert_eq!((model, path.as_str()), (kind, at)),
                other => panic!("{at}: {other:?}"),
            }
        }
    }
    // Out of all proportion: a reason, with how far it came.
    let far = loaded(Loads { tip_force: Vec3::new(1e5, 0.0, -1e6), ..Loads::default() });
    for kind in [PCC, PRB] {
        if let Err(error) = try_solve(kind, &usual, &far) {
            let is_reason =
                matches!(error, SolveError::NotConverged { last_load, .. } if last_load < 1.0);
            assert!(is_reason, "{error:?}");
        }
    }
}

/// What became of lengths.
#[derive(Debug, PartialEq)]
enum Fate {
    Met,
    Refused,
    /// With how far they can be had, and refused again at that.
    RefusedTwice,
}

/// Lengths are met or refused; those out of reach with how far they can be had, all shortened in the same proportion.
fn fate(kind: ModelKind, robot: &Robot, shortenings: &[f64], loads: &Loads) -> Fate {
    let case = |part: f64| {
        let scaled = |&s: &f64| Shortening::Length(if s > 0.0 { part * s } else { s });
        let shortenings: Vec<Shortening> = shortenings.iter().map(scaled).collect();
        Case { loads: loads.clone(), ..Case::with_shortenings(&shortenings) }
    };
    match try_solve(kind, robot, &case(1.0)) {
        Ok(solution) => {
            for (cable, shortening) in solution.cables.iter().zip(shortenings) {
                let excess = cable.length - (cable.initial_length - shortening);
                assert!(excess < 1e-11 && (cable.slack || excess > -1e-11), "{excess:e}");
            }
            Fate::Met
        }
        Err(SolveError::UnreachableLength { cable, requested, reachable }) => {
            let number: usize = cable.rsplit(' ').next().unwrap().parse().unwrap();
            assert!((requested - shortenings[number]).abs() < 1e-12 && reachable < requested);
            if loads.is_none() && reachable > 0.0 {
                let part = reachable / requested;
                if try_solve(kind, robot, &case(0.999 * part)).is_err() {
                    return Fate::RefusedTwice;
                }
            }
            Fate::Refused
        }
        Err(SolveError::ContradictoryLengths { misses }) => {
            assert!(misses.len() > 1 && misses.iter().all(|miss| miss.excess > 0.0));
            Fate::Refused
        }
        Err(SolveError::TensionsNotFound) => Fate::Refused,
        Err(error) => panic!("{error}"),
    }
}

fn random_lengths() -> impl Strategy<Value = (Robot, Vec<f64>)> {
    let cable = (0.0..360.0_f64, -0.5..0.5_f64, -0.08..0.16_f64);
    (proptest::collection::vec(cable, 1..5), 2..14_usize).prop_map(|(cables, sections)| {
        let routings = cables.iter().map(|&(at, turns, _)| helix(at, turns)).collect();
        (rod(sections, routings), cables.iter().map(|cable| cable.2).collect())
    })
}

#[test]
fn lengths_out_of_reach_are_refused_with_what_can_be_had() {
    for kind in [PCC, PRB] {
        let of = |(robot, shortenings): (Robot, Vec<f64>)| {
            fate(kind, &robot, &shortenings, &Loads::default())
        };
        let fates: Vec<Fate> = samples(random_lengths(), 60).map(of).collect();
        let count = |fate: Fate| fates.iter().filter(|found| **found == fate).count();
        let [met, refused, twice] = [Fate::Met, Fate::Refused, Fate::RefusedTwice].map(count);
        assert!(met > 30 && refused > 3 && twice <= 3, "{kind}: {met} {refused} {twice}");
    }
}

/// How long refusals take:
/// `cargo test --release -p whipcord --test mechanics refusals_are_quick -- --ignored --nocapture`
#[test]
#[ignore = "a measurement"]
#[allow(clippy::print_stdout, reason = "a measurement tells what it found")]
fn refusals_are_quick() {
    for kind in [PCC, PRB] {
        let (mut refused, mut solved) = (Vec::new(), Vec::new());
        let mut kinds = std::collections::BTreeMap::<&str, usize>::new();
        for (robot, shortenings) in samples(random_lengths(), 300) {
            let lengths: Vec<_> = shortenings.iter().map(|&s| Shortening::Length(s)).collect();
            for push in [Vec3::ZERO, Vec3::new(0.05, 0.02, -0.03)] {
                let loads = Loads { tip_force: push, ..Loads::default() };
                let case = Case { loads, ..Case::with_shortenings(&lengths) };
                let start = std::time::Instant::now();
                let answer = try_solve(kind, &robot, &case);
                let time = 1e3 * start.elapsed().as_secs_f64();
                let name = match answer {
                    Ok(_) => "solved",
                    Err(SolveError::UnreachableLength { .. }) => "unreachable",
                    Err(SolveError::ContradictoryLengths { .. }) => "contradictory",
                    Err(SolveError::TensionsNotFound) => "not found",
                    Err(_) => "other",
                };
                *kinds.entry(name).or_default() += 1;
                (if name == "solved" { &mut solved } else { &mut refused }).push(time);
            }
        }
        for (name, list) in [("solved", &mut solved), ("refused", &mut refused)] {
            list.sort_by(f64::total_cmp);
            let at = |part: f64| list[((list.len() - 1) as f64 * part) as usize];
            println!(
                "{kind} {name}: median {:.2} ms, 90 % {:.2} ms, 99 % {:.2} ms, most {:.2} ms",
                at(0.5),
                at(0.9),
                at(0.99),
                at(1.0)
            );
        }
        println!("{kind} {kinds:?}");
    }
}

/// A cable that is anchored in the only section, at a part t of it: of an arc that bends by φ its way is known in closed form, and its
/// tension makes `½ EI/l φ² + τ ℓ(φ)` least.
#[test]
fn a_cable_ends_between_two_disks() {
    let (length, radius) = (0.05, 0.008);
    let backbone = Backbone { ..paper_backbone() };
    let backbone = Backbone { length, ..backbone };
    let stiffness = 1.1e9 * core::f64::consts::PI * 0.003_f64.powi(4) / 64.0;
    for t in [0.2, 0.6, 0.95] {
        let routing = Routing::Straight { angle: 0.0, radius };
        let cable = Cable { ends_at: Some(t * length), ..Cable::new("pull", routing) };
        let disks = Disks::equally_spaced(length, 2, radius);
        let robot = Robot::new(backbone.clone(), disks, vec![cable]).unwrap();
        let way = |phi: f64| {
            let (sin, cos) = (t * phi).sin_cos();
            let (x, z) = (length * (1.0 - cos) / phi, length * sin / phi);
            (x + radius * cos - radius).hypot(z - radius * sin)
        };
        for tension in [0.5, 3.0] {
            let energy = |phi: f64| 0.5 * stiffness / length * phi * phi + tension * way(phi);
            let (mut low, mut high) = (1e-6, 1.5);
            for _ in 0..200 {
                let third = (high - low) / 3.0;
                if energy(low + third) < energy(high - third) {
                    high -= third;
                } else {
                    low += third;
                }
            }
            let exact = 0.5 * (low + high);
            let answer = try_solve(PCC, &robot, &Case::with_tensions(&[tension])).unwrap();
            let bend = answer.disks.tip().rotation.log().y;
            assert!((bend - exact).abs() < 1e-6, "{t} {tension}: {bend} {exact}");
            let length = answer.cables[0].length;
            assert!((length - way(bend)).abs() < 1e-12, "{length}");
            assert!((answer.cables[0].initial_length - t * 0.05).abs() < 1e-12);
        }
    }
}

/// With more and more disks the sections with an anchor between two disks tend to the rod.
#[test]
fn cables_that_end_between_disks_tend_to_those_of_the_rod() {
    let robot = |sections: usize| {
        let helix = Routing::Helix { start_angle: 0.4, turns: 0.5, radius: 0.008 };
        let ending = Cable { ends_at: Some(0.1007), ..Cable::new("a", helix) };
        let disks = Disks::equally_spaced(0.18, sections + 1, 0.008);
        Robot::new(paper_backbone(), disks, vec![ending]).unwrap()
    };
    let case = Case::with_tensions(&[3.0]);
    let rod = Model::new(ModelKind::Cosserat, Stations::Disks, Actuation::Natural);
    let rod = rod.solve(&robot(80), &case).unwrap().disks.tip().position;
    for kind in [PCC, PRB] {
        let error = |sections: usize| {
            (try_solve(kind, &robot(sections), &case).unwrap().disks.tip().position - rod).norm()
        };
        // What shear and extension of the rod make, and of rigid bodies their stiffness, which is 1 % off.
        let (coarse, fine) = (error(9), error(72));
        let most = if kind == PCC { 1.5e-4 } else { 6e-4 };
        assert!(fine < most && fine < 0.5 * coarse, "{kind}: {coarse:e} {fine:e}");
    }
}
