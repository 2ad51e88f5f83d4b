//! A catheter in a bent pipe.

use super::{among, assert_clear};
use whipcord::cosserat::{Cosserat, Options, Workspace};
use whipcord::four_bar::{FourBar, LengthRule, Objective};
use whipcord::obstacle::{Bends, Pipe};
use whipcord::{
    Actuation, Backbone, Cable, Case, Disks, Form, InsertionStop, Material, Model, ModelKind,
    Obstacle, Pose, Robot, Routing, Section, Shape, Shortening, Solution, SolveError, Stations,
    Vec3,
};

const LENGTH: f64 = 0.15;

/// A rod of 1.5 mm of nickel-titanium on which disks of 3 mm sit, with a cable at +x.
fn catheter(sections: usize) -> Robot {
    rod(0.0015, sections, Some(0.0015))
}

/// A rod of nickel-titanium of such a diameter, with a cable at +x, and with plates of an outer radius where it has any.
fn rod(diameter: f64, sections: usize, plates: Option<f64>) -> Robot {
    let material =
        Material { young_modulus: Some(6e10), poisson_ratio: Some(0.3), ..Material::default() };
    let section = Some(Section::circle(diameter));
    let backbone = Backbone { material, section, ..Backbone::new(LENGTH) };
    let disks = Disks {
        outer_radius: plates,
        thickness: plates.map(|_| 0.001),
        ..Disks::equally_spaced(LENGTH, sections + 1, 0.001)
    };
    let cable = Cable::new("pull", Routing::Straight { angle: 0.0, radius: 0.001 });
    Robot::new(backbone, disks, vec![cable]).unwrap()
}

/// A vessel with a bore of such a radius that goes straight on for 30 mm, bends on a radius of 80 mm by so many steps of 10° in the plane
/// of each direction, an angle about z from x, and goes straight on.
fn vessel(radius: f64, bends: &[(u8, f64)]) -> Obstacle {
    let turn = 0.08;
    let mut points = vec![Vec3::new(0.0, 0.0, -0.02), Vec3::ZERO, Vec3::new(0.0, 0.0, 0.02)];
    let (mut end, mut tangent) = (Vec3::new(0.0, 0.0, 0.03), Vec3::Z);
    points.push(end);
    for &(steps, direction) in bends {
        let (sin, cos) = direction.to_radians().sin_cos();
        let aside = Vec3::new(cos, sin, 0.0);
        let aside = aside - tangent * aside.dot(tangent);
        let aside = aside / aside.norm();
        let (from, along) = (end, tangent);
        for k in 1..=steps {
            let (sin, cos) = (f64::from(k) * core::f64::consts::PI / 18.0).sin_cos();
            end = from + along * (turn * sin) + aside * (turn * (1.0 - cos));
            points.push(end);
            tangent = along * cos + aside * sin;
        }
    }
    points.extend([0.02, 0.08, 0.14].map(|on| end + tangent * on));
    let form = Form::Pipe(Pipe::new(radius, &points, Bends::Smooth).unwrap());
    Obstacle { name: "vessel".to_owned(), form, pose: Pose::IDENTITY, friction: 0.0, movable: None }
}

/// A bore of 3 mm radius that bends towards +x by so many steps of 10°.
fn pipe(steps: u8) -> Obstacle {
    vessel(0.003, &[(steps, 0.0)])
}

fn chain(robot: &Robot, case: &Case) -> Result<Solution, SolveError> {
    let options = whipcord::four_bar::Options {
        objective: Objective::StrainEnergy,
        lengths: LengthRule::Free,
        ..Default::default()
    };
    FourBar::new(robot, &options)?.solve(case, None, &mut Default::default())
}

/// The moments that bend a chain of sections in the plane are those of what pushes it beyond them, and of
/// the cable: each section by itself, about the middle of its bend.
fn assert_balanced(solution: &Solution, sections: usize) {
    let stiffness = 6e10 * core::f64::consts::PI * 0.0015_f64.powi(4) / 64.0;
    let length = LENGTH / sections as f64;
    let poses = &solution.disks.poses;
    let tension = solution.cables[0].tension.unwrap();
    for (k, pair) in poses.windows(2).enumerate() {
        let bend = (pair[0].rotation.conjugate() * pair[1].rotation).log().y;
        let pull = tension * 0.001 * (0.5 * bend).cos();
        // What is beyond turns about the lower disk's centre while the chord turns by half the bend.
        let mut pushed = 0.0;
        for touch in &solution.contacts {
            let force = touch.normal * touch.force.unwrap();
            if touch.arc_length > solution.disks.arc_length[k] + 1e-9 {
                let chord = pair[1].position - pair[0].position;
                let beyond = touch.point - pair[1].position;
                pushed += 0.5 * chord.cross(force).y + beyond.cross(force).y;
            }
        }
        let left = stiffness / length * bend - pull - pushed;
        let scale = stiffness / LENGTH;
        assert!(left.abs() < 1e-6 * scale, "section {k}: {left} of {scale} N m");
    }
}

#[test]
fn a_catheter_follows_a_vessel_round_a_right_angle() {
    let robot = catheter(16);
    let vessel = pipe(9);
    for shortening in [0.0, 0.002] {
        let case = Case::with_shortenings(&[Shortening::Length(shortening)]);
        let solution = chain(&robot, &among(case, vec![vessel.clone()])).unwrap();
        assert!(solution.contacts.len() >= 3, "{:?}", solution.contacts);
        let (bend, direction) = solution.disks.bend();
        assert!(bend > 1.2 && direction.abs() < 1e-6, "{bend} towards {direction}");
        assert_eq!(solution.cables[0].slack, shortening == 0.0);
        assert_clear(&robot, &solution, &vessel);
        assert_balanced(&solution, 16);
    }
}

/// The rod in a vessel lies where the chain does, and its base bears what the vessel pushes.
fn assert_rod_agrees(steps: u8, sections: usize, shortening: f64) {
    let vessel = pipe(steps);
    let robot = catheter(sections);
    let case = Case::with_shortenings(&[Shortening::Length(shortening)]);
    let case = among(case, vec![vessel.clone()]);
    let options = Options { actuation: Actuation::Shortening, ..Options::default() };
    let model = Cosserat::new(&robot, &case.loads, &options).unwrap();
    let rod = model.solve(&case, None, &mut Workspace::default()).unwrap();
    let chain = chain(&robot, &case).unwrap();
    let apart = rod.disks.distances(&chain.disks).fold(0.0, f64::max);
    assert!(apart < 0.01 * LENGTH, "{apart}");
    assert!(rod.contacts.len() >= 2, "{:?}", rod.contacts);
    assert!(rod.diagnostics.discretization_error.unwrap() < 1e-6 * LENGTH);
    assert_clear(&robot, &rod, &vessel);
    let (_, total) = super::pushes_of(&rod);
    let base = rod.base_wrench.unwrap();
    let bending = 6e10 * core::f64::consts::PI * 0.0015_f64.powi(4) / 64.0 / LENGTH;
    assert!((base.force - total.force).norm() < 1e-6 * bending / LENGTH);
    assert!((base.moment - total.moment).norm() < 1e-6 * bending);
}

#[test]
fn the_rod_and_the_chain_agree_in_a_gentle_bend() {
    assert_rod_agrees(3, 16, 0.0);
}

/// The vessel holds it where the forces of the vessel alone would buckle it more than once.
#[test]
#[cfg_attr(debug_assertions, ignore = "a minute without optimisation")]
fn the_rod_and_the_chain_agree_round_a_right_angle() {
    for sections in [10, 16, 20] {
        for shortening in [0.0, 0.0014] {
            assert_rod_agrees(9, sections, shortening);
        }
    }
}

/// Arcs and rigid bodies are inserted and lie where the rod does; their bases bear what the vessel pushes.
#[test]
fn sections_lie_where_the_rod_does() {
    for (steps, sections, shortening) in [(3, 16, 0.0), (9, 10, 0.0), (9, 16, 0.0014)] {
        let vessel = pipe(steps);
        let robot = catheter(sections);
        let case = Case::with_shortenings(&[Shortening::Length(shortening)]);
        let case = among(case, vec![vessel.clone()]);
        let solve = |kind: ModelKind| {
            let model = Model::new(kind, Stations::Disks, Actuation::Shortening);
            model.prepare(&robot, &case.loads).unwrap().solve(&case, None).unwrap()
        };
        let rod = solve(ModelKind::Cosserat);
        for kind in [ModelKind::PiecewiseConstantCurvature, ModelKind::PseudoRigidBody] {
            let ours = solve(kind);
            let apart = rod.disks.distances(&ours.disks).fold(0.0, f64::max);
            assert!(apart < 0.01 * LENGTH, "{kind}: {apart}");
            assert!(ours.contacts.len() >= 2, "{kind}: {:?}", ours.contacts);
            assert_clear(&robot, &ours, &vessel);
            let (mut force, mut moment) = (Vec3::ZERO, Vec3::ZERO);
            for touch in &ours.contacts {
                let push = touch.normal * touch.force.unwrap();
                force += push;
                moment += touch.point.cross(push);
            }
            let base = ours.base_wrench.unwrap();
            let bending = 6e10 * core::f64::consts::PI * 0.0015_f64.powi(4) / 64.0 / LENGTH;
            assert!((base.force - force).norm() < 1e-6 * bending / LENGTH);
            assert!((base.moment - moment).norm() < 1e-6 * bending);
        }
    }
}

/// The models agree where a robot lies in a vessel.
fn assert_models_agree(robot: &Robot, vessel: &Obstacle) {
    let Form::Pipe(bore) = &vessel.form else { unreachable!() };
    let case = among(Case::with_tensions(&[20.0]), vec![vessel.clone()]);
    let solve = |kind: ModelKind| {
        let model = Model::new(kind, Stations::Equal(121), Actuation::Natural);
        let solved = model.prepare(robot, &case.loads).unwrap().solve(&case, None);
        solved.unwrap_or_else(|error| panic!("{kind} in a bore of {} m: {error}", bore.radius()))
    };
    let sections = solve(ModelKind::PiecewiseConstantCurvature);
    for kind in [ModelKind::Cosserat, ModelKind::CosseratDisks, ModelKind::PseudoRigidBody] {
        let rod = solve(kind);
        let apart = rod.disks.distances(&sections.disks).fold(0.0, f64::max);
        assert!(apart < 0.01 * LENGTH, "{kind}: {apart}");
        assert!(rod.contacts.len() >= 3, "{kind}: {:?}", rod.contacts);
        assert_backbone_is_clear(robot, &rod, vessel);
        if robot.disks().outer_radius.is_some() {
            assert_clear(robot, &rod, vessel);
        }
    }
}

fn assert_backbone_is_clear(robot: &Robot, solution: &Solution, vessel: &Obstacle) {
    let Shape { arc_length, poses, .. } = &solution.shape;
    for (&s, pose) in arc_length.iter().zip(poses).skip(1) {
        let radius = robot.backbone().outer_radius_at(robot.disks(), s);
        let gap = vessel.surface(pose.position).distance - radius;
        assert!(gap > -1e-6 * LENGTH, "{gap} at {s}");
    }
}

/// With half a millimetre and less around the disks all steps of the way in are short.
#[test]
#[cfg_attr(debug_assertions, ignore = "a minute without optimisation")]
fn a_catheter_finds_its_way_into_a_narrow_vessel() {
    for radius in [0.0022, 0.002, 0.0019, 0.0018, 0.0017, 0.0016] {
        assert_models_agree(&catheter(20), &vessel(radius, &[(9, 0.0)]));
    }
}

/// Its rims wander round the bore, and its tip jumps from side to side.
#[test]
#[cfg_attr(debug_assertions, ignore = "a minute without optimisation")]
fn a_catheter_follows_a_vessel_that_bends_to_and_fro_and_in_space() {
    for (radius, bends) in [(0.003, [(5, 0.0), (5, 180.0)]), (0.003, [(4, 0.0), (4, 90.0)])] {
        assert_models_agree(&catheter(20), &vessel(radius, &bends));
    }
}

/// Where no way in is found they are laid along the bore and let go, and come to where a way in leads to.
#[test]
#[cfg_attr(debug_assertions, ignore = "a minute without optimisation")]
fn robots_lie_in_narrow_vessels_that_bend_to_and_fro_and_in_space() {
    assert_models_agree(&catheter(20), &vessel(0.0022, &[(4, 0.0), (4, 90.0)]));
    assert_models_agree(&rod(0.003, 20, None), &vessel(0.0022, &[(5, 0.0), (5, 180.0)]));
}

/// Friction remembers the way in.
#[test]
#[cfg_attr(debug_assertions, ignore = "a minute without optimisation")]
fn a_catheter_rubs_along_a_vessel() {
    for (radius, friction) in [(0.003, 0.3), (0.0022, 0.1)] {
        let vessel = Obstacle { friction, ..vessel(radius, &[(9, 0.0)]) };
        assert_models_agree(&catheter(20), &vessel);
    }
}

/// A tube without plates, or with plates that it is as thick as, is as near to the bore everywhere where it lies along it.
#[test]
#[cfg_attr(debug_assertions, ignore = "a minute without optimisation")]
fn a_tube_lies_along_a_vessel() {
    for plates in [None, Some(0.0015)] {
        let tube = rod(0.003, 20, plates);
        for radius in [0.003, 0.0022, 0.0018] {
            assert_models_agree(&tube, &vessel(radius, &[(9, 0.0)]));
        }
    }
}

/// A bore that the disks fit goes over into one that they do not.
#[test]
fn a_robot_that_gets_stuck_is_told_where() {
    let bore = |name: &str, radius: f64, ends: [f64; 2]| {
        let points = ends.map(|z| Vec3::new(0.0, 0.0, z));
        let form = Form::Pipe(Pipe::new(radius, &points, Bends::Corners).unwrap());
        let (name, pose) = (name.to_owned(), Pose::IDENTITY);
        Obstacle { name, form, pose, friction: 0.0, movable: None }
    };
    let mouth = 0.06;
    let bores = vec![bore("sleeve", 0.002, [-0.02, mouth]), bore("narrow", 0.001, [mouth, 0.2])];
    let case = among(Case::with_tensions(&[0.0]), bores);
    for kind in [ModelKind::Cosserat, ModelKind::PiecewiseConstantCurvature] {
        let model = Model::new(kind, Stations::Disks, Actuation::Natural);
        let error =
            model.prepare(&catheter(20), &case.loads).unwrap().solve(&case, None).unwrap_err();
        let SolveError::NotInserted { pipe, inserted, length, why } = &error else {
            panic!("{kind}: {error}")
        };
        // Its disks do not fit the bore at all.
        assert!(!matches!(why, InsertionStop::NoClearance { .. }), "{kind}: {error}");
        // Whichever pushes it hardest where it has bent aside.
        assert!(["sleeve", "narrow"].contains(&pipe.as_str()), "{kind}: {pipe}");
        assert_eq!(*length, LENGTH);
        // As far as its tip may go, or farther where the rod bends aside before it enters the wide bore.
        assert!((mouth - 0.001..LENGTH).contains(inserted), "{kind}: {inserted}");
        let text = error.to_string();
        assert!(text.contains(&format!("inserted into pipe `{pipe}` by only")), "{text}");
        assert!(!text.contains("actuation") && !text.contains("pull"), "{text}");
    }
}

#[test]
fn a_vessel_that_is_too_narrow_is_told_of() {
    let mut vessel = pipe(3);
    let Form::Pipe(bore) = &vessel.form else { unreachable!() };
    vessel.form = Form::Pipe(Pipe::new(0.001, bore.points(), Bends::Smooth).unwrap());
    let case = among(Case::with_shortenings(&[Shortening::Length(0.0)]), vec![vessel]);
    let error = chain(&catheter(10), &case).unwrap_err();
    let SolveError::ObstacleInTheWay { obstacle, .. } = &error else { panic!("{error}") };
    assert_eq!(obstacle, "vessel");
}

/// No way leads into a bore from a base that stands in the body around it.
#[test]
fn a_base_beside_the_bore_is_in_the_way() {
    let mut vessel = pipe(3);
    let Form::Pipe(bore) = &vessel.form else { unreachable!() };
    let radius = bore.radius();
    vessel.pose.position.x += 0.01;
    let case = among(Case::with_shortenings(&[Shortening::Length(0.0)]), vec![vessel]);
    let error = chain(&catheter(10), &case).unwrap_err();
    let SolveError::ObstacleInTheWay { arc_length, depth, .. } = error else { panic!("{error}") };
    assert_eq!(arc_length, 0.0);
    // The smooth line through the points is not quite straight.
    assert!((depth - (0.01 - radius)).abs() < 1e-4, "{depth}");
}
