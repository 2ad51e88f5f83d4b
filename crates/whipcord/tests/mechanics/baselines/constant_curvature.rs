//! One arc: against the Cosserat rod, which straight cables bend to exactly that, against Webster and
//! Jones, and where it must refuse.

use core::f64::consts::TAU;

use proptest::prelude::*;
use whipcord::constant_curvature::{ConstantCurvature, Options, Workspace};
use whipcord::{
    Actuation, Backbone, Cable, Case, Loads, Model, ModelKind, RestCurvature, Robot, Routing,
    Section, Shape, Shortening, Solution, SolveError, Statics as _, Stations, Stiffness, Vec3,
};

use crate::common::{
    self, fine_options, helix, lengths_of, paper_backbone, paper_disks, paper_robot, straight,
    tensions,
};

fn try_solve(robot: &Robot, case: &Case, actuation: Actuation) -> Result<Solution, SolveError> {
    let options = Options { actuation, ..Options::default() };
    ConstantCurvature::new(robot, &options)?.solve(case, &mut Workspace::default())
}

fn solve(robot: &Robot, case: &Case) -> Solution {
    try_solve(robot, case, Actuation::Natural).unwrap()
}

fn shortened(lengths: &[f64]) -> Case {
    let lengths: Vec<_> = lengths.iter().map(|&l| Shortening::Length(l)).collect();
    Case::with_shortenings(&lengths)
}

/// A bar that bends unlike about x and y, bent at rest, with cables at these angles and radii.
fn bar(cables: &[(f64, f64)], rest: Vec3) -> Robot {
    let backbone = Backbone {
        section: Some(Section::rectangle(0.004, 0.002)),
        rest_curvature: RestCurvature::Uniform(rest),
        ..paper_backbone()
    };
    let cable = |(i, &(angle, radius)): (usize, &(f64, f64))| {
        Cable::new(format!("cable {i}"), Routing::Straight { angle, radius })
    };
    let cables = cables.iter().enumerate().map(cable).collect();
    Robot::new(backbone, paper_disks(), cables).unwrap()
}

/// Greatest difference of positions in m and of rotations.
fn apart(a: &Shape, b: &Shape) -> f64 {
    let of = |(a, b): (&whipcord::Pose, &whipcord::Pose)| {
        let turn = (a.rotation.conjugate() * b.rotation).log().norm();
        (a.position - b.position).norm().max(turn)
    };
    a.poses.iter().zip(&b.poses).map(of).fold(0.0, f64::max)
}

proptest! {
    #![proptest_config(common::config(40))]

    /// Straight cables and no load bend a rod to an arc: the equations of the rod say so exactly.
    #[test]
    fn it_is_the_cosserat_rod_with_straight_cables(
        cables in prop::collection::vec((0.0..TAU, 0.002..0.01, 0.0_f64..8.0), 1..6),
        rest in prop::array::uniform2(-4.0_f64..4.0),
    ) {
        let places: Vec<_> = cables.iter().map(|&(angle, radius, _)| (angle, radius)).collect();
        let robot = bar(&places, Vec3::new(rest[0], rest[1], 0.0));
        let pull: Vec<_> = cables.iter().map(|c| c.2).collect();
        let case = Case::with_tensions(&pull);
        let ours = solve(&robot, &case);
        let rod = Model::Cosserat(fine_options()).solve(&robot, &case).unwrap();
        prop_assert!(apart(&ours.disks, &rod.disks) < 1e-10);
        for (a, b) in ours.cables.iter().zip(&rod.cables) {
            prop_assert!((a.length - b.length).abs() < 1e-12);
            prop_assert!((a.initial_length - b.initial_length).abs() < 1e-12);
        }
        // Its lengths lead back to the same arc, and to the same tensions where they say which.
        let back = solve(&robot, &lengths_of(&ours, &Loads::default()));
        prop_assert!(apart(&back.disks, &ours.disks) < 1e-9);
        if cables.len() <= 2 {
            for (a, b) in tensions(&back).iter().zip(&pull) {
                prop_assert!((a - b).abs() < 1e-6, "{a} {b}");
            }
        }
    }
}

/// Webster and Jones 2010: three cables at 120° on the radius d, of lengths ℓ, bend to
/// `κ = 2 √(ℓ₁² + ℓ₂² + ℓ₃² − ℓ₁ℓ₂ − ℓ₁ℓ₃ − ℓ₂ℓ₃) / (d (ℓ₁ + ℓ₂ + ℓ₃))` on the length `(ℓ₁ + ℓ₂ + ℓ₃)/3`.
#[test]
fn three_cables_are_the_formula_of_webster_and_jones() {
    let robot = paper_robot(vec![straight(0.0), straight(120.0), straight(240.0)]);
    let lengths = [0.1741, 0.1779, 0.1768];
    let found = solve(&robot, &shortened(&lengths.map(|l| 0.18 - l)));
    let [a, b, c] = lengths;
    let sum = a + b + c;
    let root = (a * a + b * b + c * c - a * b - a * c - b * c).sqrt();
    let (kappa, length) = (2.0 * root / (0.008 * sum), sum / 3.0);
    // Towards the shortest cable, and by the lengths of the others beyond it towards the third.
    let phi = (3.0_f64.sqrt() * (c - b)).atan2(b + c - 2.0 * a);
    let tip = found.disks.tip();
    let (across, along) = ((1.0 - (kappa * length).cos()) / kappa, (kappa * length).sin() / kappa);
    let expected = Vec3::new(across * phi.cos(), across * phi.sin(), along);
    assert!((tip.position - expected).norm() < 1e-12, "{:?} {expected:?}", tip.position);
    assert!((tip.rotation.log().norm() - kappa * length).abs() < 1e-11);
    for (cable, length) in found.cables.iter().zip(lengths) {
        assert!((cable.length - length).abs() < 1e-14 && !cable.slack);
        assert!(cable.tension.unwrap() > 0.0);
    }
}

/// Without a material it bends as one that is alike in all directions and does not stretch; what
/// tensions that takes it does not say.
#[test]
fn lengths_alone_need_no_material() {
    let routings = || vec![straight(20.0), straight(140.0)];
    let known = {
        let backbone = Backbone { extensible: false, ..paper_backbone() };
        let cables = paper_robot(routings()).cables().to_vec();
        Robot::new(backbone, paper_disks(), cables).unwrap()
    };
    let bare = Robot::new(Backbone::new(0.18), paper_disks(), known.cables().to_vec()).unwrap();
    let case = shortened(&[0.006, -0.004]);
    let (a, b) = (solve(&known, &case), solve(&bare, &case));
    assert!(apart(&a.disks, &b.disks) < 1e-12);
    assert!(a.cables[0].tension.unwrap() > 0.0 && a.base_wrench.is_some());
    assert!(b.cables[0].tension.is_none() && b.base_wrench.is_none());
    // The antagonist hangs loose: the arc is that of the first cable alone.
    assert!(!b.cables[0].slack && b.cables[1].slack);
    let bend = b.disks.tip().rotation.log();
    assert!((bend.norm() - 0.006 / 0.008).abs() < 1e-12);
    // Where both commands are given the length counts.
    let mut both = case.clone();
    both.commands.iter_mut().for_each(|command| command.tension = Some(5.0));
    assert_eq!(solve(&bare, &both), b);
    assert_eq!(solve(&known, &both), a);
    let pulled = try_solve(&known, &both, Actuation::Tension).unwrap();
    assert_eq!(pulled.cables[1].tension, Some(5.0));
}

#[test]
fn what_lengths_cannot_be_had_is_said() {
    let robot = Robot::new(
        Backbone::new(0.18),
        paper_disks(),
        paper_robot(vec![straight(0.0), straight(180.0)]).cables().to_vec(),
    )
    .unwrap();
    match try_solve(&robot, &shortened(&[0.005, 0.003]), Actuation::Shortening) {
        Err(SolveError::ContradictoryLengths { misses }) => {
            // The best arc misses both by half of what they lack together.
            assert_eq!(misses.len(), 2);
            assert!(misses.iter().all(|miss| (miss.excess - 0.004).abs() < 1e-6), "{misses:?}");
        }
        other => panic!("{other:?}"),
    }
    match try_solve(&robot, &shortened(&[0.2, -1.0]), Actuation::Shortening) {
        Err(SolveError::UnreachableLength { cable, reachable, .. }) => {
            assert_eq!(cable, "cable 0");
            assert!(reachable > 0.17 && reachable <= 0.18, "{reachable}");
        }
        other => panic!("{other:?}"),
    }
    // Four times `EI/r²` presses the cable's length to nothing, and more.
    let robot = paper_robot(vec![straight(0.0)]);
    let stiffness = common::bending_stiffness(&robot);
    let limit = stiffness / 0.008_f64.powi(2);
    match try_solve(&robot, &Case::with_tensions(&[4.0 * limit]), Actuation::Tension) {
        Err(SolveError::SectionFolds { last_load, .. }) => {
            assert!((0.23..0.26).contains(&last_load), "{last_load}");
        }
        other => panic!("{other:?}"),
    }
}

/// What is refused, at which place of the file.
fn refused(robot: &Robot, case: &Case, actuation: Actuation) -> String {
    match try_solve(robot, case, actuation) {
        Err(
            SolveError::Unsupported { model: ModelKind::ConstantCurvature, path, .. }
            | SolveError::Missing { model: ModelKind::ConstantCurvature, path, .. },
        ) => path,
        other => panic!("{other:?}"),
    }
}

#[test]
fn courses_that_no_arc_takes_are_refused_by_name() {
    let pull = Case::with_tensions(&[1.0]);
    let spin = |holes: &[usize]| Routing::holes(holes.to_vec());
    for (routing, path) in [
        (helix(0.0, 0.5), "cables[0].routing.turns"),
        (Routing::Linear { start: [0.008, 0.0], end: [0.004, 0.0] }, "cables[0].routing.end"),
        (Routing::Polynomial { x: vec![0.008], y: vec![0.0, 0.0, 0.1] }, "cables[0].routing.y[2]"),
        (spin(&[2, 2, 2, 3, 3, 3, 3, 3, 3, 3]), "cables[0].holes[3]"),
        (spin(&[2; 6]), "cables[0].holes"),
    ] {
        assert_eq!(refused(&paper_robot(vec![routing]), &pull, Actuation::Natural), path);
    }
    // A conical robot's cables converge.
    let mut disks = paper_disks();
    disks.hole_circle_radii[4] = 0.007;
    let cables = paper_robot(vec![spin(&[2; 10])]).cables().to_vec();
    let cone = Robot::new(paper_backbone(), disks, cables).unwrap();
    assert_eq!(refused(&cone, &pull, Actuation::Natural), "disks.hole_circle_radius[4]");
    let cables = vec![Cable { ends_at: Some(0.1), ..Cable::new("a", straight(0.0)) }];
    let short = Robot::new(paper_backbone(), paper_disks(), cables).unwrap();
    assert_eq!(refused(&short, &pull, Actuation::Natural), "cables[0].ends_at");
    // Holes in one line, and routings that amount to it, are taken.
    for routing in [
        spin(&[2; 10]),
        helix(30.0, 0.0),
        Routing::Linear { start: [0.004, 0.004], end: [0.004, 0.004] },
        Routing::Polynomial { x: vec![0.008, 0.0], y: vec![] },
    ] {
        solve(&paper_robot(vec![routing]), &pull);
    }
}

#[test]
fn backbones_that_tensions_do_not_bend_to_an_arc_are_refused_by_name() {
    let pull = Case::with_tensions(&[1.0]);
    let with = |backbone: Backbone| {
        let cables = paper_robot(vec![straight(0.0)]).cables().to_vec();
        Robot::new(backbone, paper_disks(), cables).unwrap()
    };
    let tapered = Section::Round {
        outer: whipcord::Along::PerDisk((0..10).map(|i| 3e-3 - 1e-4 * f64::from(i)).collect()),
        inner: 0.0.into(),
    };
    let taper = with(Backbone { section: Some(tapered), ..paper_backbone() });
    assert_eq!(refused(&taper, &pull, Actuation::Tension), "backbone.diameters");
    // Its lengths it may be given all the same.
    assert!(solve(&taper, &shortened(&[0.005])).cables[0].tension.is_none());
    let mut k = [[0.0; 6]; 6];
    for (i, k) in k.iter_mut().enumerate() {
        k[i] = if i < 3 { 1e3 } else { 4e-3 };
    }
    (k[3][5], k[5][3]) = (1e-3, 1e-3);
    let coupled =
        with(Backbone { stiffness: Some(Stiffness::Matrix(k.into())), ..Backbone::new(0.18) });
    assert_eq!(refused(&coupled, &pull, Actuation::Tension), "backbone.stiffness.matrix");
    let twisted = RestCurvature::Uniform(Vec3::new(0.0, 2.0, 1.0));
    let twisted = with(Backbone { rest_curvature: twisted, ..paper_backbone() });
    assert_eq!(
        refused(&twisted, &shortened(&[0.001]), Actuation::Natural),
        "backbone.rest_curvature"
    );
    assert_eq!(refused(&with(Backbone::new(0.18)), &pull, Actuation::Tension), "backbone.diameter");
}

#[test]
fn cases_that_no_arc_answers_are_refused_by_name() {
    let robot = paper_robot(vec![straight(0.0)]);
    let loads = Loads { tip_force: Vec3::X, ..Loads::default() };
    let loaded = Case { loads, ..Case::with_tensions(&[1.0]) };
    assert_eq!(refused(&robot, &loaded, Actuation::Natural), "loads.tip_force");
    let lacking = Case { commands: vec![Default::default()], ..Case::default() };
    assert_eq!(refused(&robot, &lacking, Actuation::Natural), "cables[0].tension");
    let with = |cable: Cable, backbone: Backbone| {
        Robot::new(backbone, paper_disks(), vec![cable]).unwrap()
    };
    let plain = Cable::new("a", straight(0.0));
    let rubbing = with(Cable { friction: Some(0.1), ..plain.clone() }, paper_backbone());
    let pull = Case::with_tensions(&[1.0]);
    assert_eq!(refused(&rubbing, &pull, Actuation::Tension), "cables[0].friction");
    // Friction changes no length, but then nobody knows the tension at the base.
    assert!(solve(&rubbing, &shortened(&[0.002])).cables[0].tension.is_none());
    let elastic = Cable { axial_stiffness: Some(2e3), ..plain };
    let bare = with(elastic.clone(), Backbone::new(0.18));
    assert_eq!(
        refused(&bare, &shortened(&[0.002]), Actuation::Natural),
        "cables[0].axial_stiffness"
    );
    // On a backbone of known stiffness it stretches by what it is pulled with.
    let found = solve(&with(elastic, paper_backbone()), &shortened(&[0.002]));
    let cable = &found.cables[0];
    let stretched = 0.18 - 0.002 + 0.18 * cable.tension.unwrap() / 2e3;
    assert!((cable.length - stretched).abs() < 1e-14);
    let off = Options { stations: Stations::At(vec![0.2]), ..Options::default() };
    assert!(matches!(ConstantCurvature::new(&robot, &off), Err(SolveError::Invalid(_))));
}
