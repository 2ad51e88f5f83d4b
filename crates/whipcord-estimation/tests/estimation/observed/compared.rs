//! Models beside what was measured: what was put in comes out.

use whipcord::{
    Actuation, Backbone, Cable, Case, Disks, Material, Model, ModelKind, Pose, Robot, Routing,
    Section, Solution, Statics, Stations, UnitQuaternion, Vec3,
};
use whipcord_estimation::camera::{Camera, Lens, Orthographic};
use whipcord_estimation::observation::{Incomparable, distances, in_image, overlay};
use whipcord_estimation::registration::{Alignment, RegistrationError};
use whipcord_estimation::{Observation, Place, Seen};

fn robot() -> Robot {
    let backbone = Backbone {
        section: Some(Section::circle(0.003)),
        material: Material {
            young_modulus: Some(1.1e9),
            poisson_ratio: Some(0.3),
            ..Default::default()
        },
        ..Backbone::new(0.18)
    };
    let cable = Cable::new("pull", Routing::Straight { angle: 0.3, radius: 0.008 });
    Robot::new(backbone, Disks::equally_spaced(0.18, 10, 0.008), vec![cable]).unwrap()
}

/// In two steps.
fn case() -> Case {
    let before = vec![Case::with_tensions(&[1.0]).commands];
    Case { before, ..Case::with_tensions(&[3.0]) }
}

/// The answers to both steps.
fn answers(robot: &Robot) -> Vec<Solution> {
    let model = Model::new(ModelKind::Cosserat, Default::default(), Default::default());
    model.prepare(robot, &case().loads).unwrap().solve_all(&case()).unwrap()
}

fn answer(robot: &Robot) -> Solution {
    answers(robot).pop().unwrap()
}

fn observation(step: usize, place: Place, offset: Vec3, seen: Seen) -> Observation {
    Observation { step, place, offset, seen, deviation: None }
}

fn seen_at_disks(solution: &Solution, seen_as: impl Fn(Vec3) -> Vec3) -> Vec<Observation> {
    let positions = solution.disks.poses.iter().map(|pose| pose.position).enumerate();
    positions
        .map(|(i, p)| observation(1, Place::Disk(i), Vec3::ZERO, Seen::Position(seen_as(p))))
        .collect()
}

#[test]
fn a_measurement_in_another_frame_is_moved_onto_the_answer() {
    let robot = robot();
    let answers = answers(&robot);
    let answers: Vec<&Solution> = answers.iter().collect();
    let solution = answers[1];
    let turn = UnitQuaternion::exp(Vec3::new(0.4, -1.1, 0.7));
    let frame = Pose { position: Vec3::new(0.3, -0.2, 1.0), rotation: turn };
    let mut seen = seen_at_disks(solution, |p| frame.transform(p));
    // What was seen in an image plays no part.
    let pixel = Seen::Pixel { camera: 0, pixel: [0.0, 0.0] };
    seen.push(observation(1, Place::Disk(3), Vec3::ZERO, pixel));
    let compared = |seen: &[Observation], alignment| {
        distances(ModelKind::Cosserat, &robot, &case(), &answers, seen, alignment)
    };
    let found = compared(&seen, Alignment::Rigid).unwrap().unwrap();
    assert_eq!(found.markers.len(), 10);
    assert!(found.rms().unwrap() < 1e-12);
    let moved = found.motion.unwrap();
    let Pose { position, rotation } = moved * frame;
    assert!(position.norm() < 1e-12 && rotation.log().norm() < 1e-12);
    assert!((found.disk(1, 10).unwrap() - solution.disks.poses[9].position).norm() < 1e-12);
    // Left where it is, it is as far off as the frame.
    let left = compared(&seen, Alignment::None).unwrap().unwrap();
    let off: f64 = solution.disks.poses[1..]
        .iter()
        .map(|pose| (frame.transform(pose.position) - pose.position).norm_squared())
        .sum();
    assert!(left.motion.is_none() && (left.rms().unwrap() - (off / 9.0).sqrt()).abs() < 1e-12);
    // One point on the base shifts, and does not turn.
    let shift = Vec3::new(0.1, 0.2, -0.3);
    let off = Vec3::new(0.0, 0.0, 4e-3);
    let mut seen = seen_at_disks(solution, |p| p + shift + off);
    seen[0].seen = Seen::Position(shift);
    let based = compared(&seen, Alignment::Base).unwrap().unwrap();
    assert_eq!(based.motion.unwrap().position, -shift);
    assert!((based.rms().unwrap() - 4e-3).abs() < 1e-15);
}

#[test]
fn markers_off_the_backbone_and_between_disks_have_their_places() {
    let robot = robot();
    let answers = answers(&robot);
    let answers: Vec<&Solution> = answers.iter().collect();
    let solution = answers[1];
    let offset = Vec3::new(0.006, -0.002, 0.001);
    let pose = solution.disks.poses[4];
    let s = robot.disks().arc_lengths[4];
    let there = Seen::Position(pose.transform(offset));
    let seen = [
        observation(1, Place::Disk(4), offset, there),
        // The same place by its arc length: it is solved for once more.
        observation(1, Place::ArcLength(s), offset, there),
    ];
    let found = distances(ModelKind::Cosserat, &robot, &case(), &answers, &seen, Alignment::None);
    let found = found.unwrap().unwrap();
    assert!(found.rms().unwrap() < 1e-9, "{:?}", found.rms());
    assert!(found.markers.iter().all(|marker| marker.disk.is_none() && !marker.at_base));
    let refused =
        distances(ModelKind::Cosserat, &robot, &case(), &answers, &seen[..1], Alignment::Rigid);
    let expected = RegistrationError::TooFew { given: 1, least: 2 };
    assert_eq!(refused, Err(Incomparable::Motion(expected)));
}

/// Each step is as far off as was put in: the root mean square is that over all of them.
#[test]
fn all_steps_count() {
    let robot = robot();
    let answers = answers(&robot);
    let answers: Vec<&Solution> = answers.iter().collect();
    let compared = |seen: &[Observation], alignment| {
        let found =
            distances(ModelKind::Cosserat, &robot, &case(), &answers, seen, alignment).unwrap();
        found.unwrap()
    };
    let off = [5e-3, 1e-3];
    let s = 0.95 * 0.18;
    let model = Model::new(ModelKind::Cosserat, Stations::At(vec![s]), Default::default());
    let mut seen = Vec::new();
    for (step, (answer, off)) in answers.iter().zip(off).enumerate() {
        let shift = Vec3::new(off, 0.0, 0.0);
        let tip = Seen::Position(answer.disks.tip().position + shift);
        seen.push(observation(step, Place::Disk(9), Vec3::ZERO, tip));
        let between = model.solve(&robot, &case().steps().nth(step).unwrap()).unwrap();
        let there = Seen::Position(between.shape.poses[0].position + shift);
        seen.push(observation(step, Place::ArcLength(s), Vec3::ZERO, there));
    }
    let found = compared(&seen, Alignment::None);
    assert_eq!((found.steps(), found.moving().count()), (2, 4));
    let rms = (13e-6_f64).sqrt();
    assert!((found.rms().unwrap() - rms).abs() < 1e-8, "{:?}", found.rms());
    assert!((found.rms_of_disk(10).unwrap() - rms).abs() < 1e-12);
    // One marker in each step: together they fix one motion for all steps, and the least turn.
    let frame = Pose {
        position: Vec3::new(0.3, -0.2, 1.0),
        rotation: UnitQuaternion::exp(Vec3::new(0.4, -1.1, 0.7)),
    };
    let one_each: Vec<Observation> = answers
        .iter()
        .enumerate()
        .map(|(step, answer)| {
            let tip = Seen::Position(frame.transform(answer.disks.tip().position));
            observation(step, Place::Disk(9), Vec3::ZERO, tip)
        })
        .collect();
    let found = compared(&one_each, Alignment::Rigid);
    assert!(found.rms().unwrap() < 1e-12 && found.motion.is_some(), "{:?}", found.rms());
    // The base was measured in each step, 2 mm apart: it is shifted by the mean.
    let mut based = one_each;
    for (step, x) in [0.1, 0.102].into_iter().enumerate() {
        let base = Seen::Position(Vec3::new(x, 0.0, 0.0));
        based.push(observation(step, Place::Disk(0), Vec3::ZERO, base));
    }
    let moved = compared(&based, Alignment::Base).motion.unwrap();
    assert!((moved.position - Vec3::new(-0.101, 0.0, 0.0)).norm() < 1e-15);
}

#[test]
fn an_answer_is_as_far_from_what_a_camera_saw_as_was_put_in() {
    let robot = robot();
    let solution = answer(&robot);
    // From above: 2000 pixels to the metre.
    let lens = Lens::Orthographic(Orthographic::new(2000.0, [320.0, 240.0]).unwrap());
    let camera = Camera::new(lens, Pose::IDENTITY, None).unwrap();
    let poses = solution.disks.poses.iter().enumerate();
    let seen: Vec<Observation> = poses
        .map(|(i, pose)| {
            let [u, v] = camera.project(pose.position).unwrap();
            let off = if i == 0 { [50.0, 0.0] } else { [3.0, -4.0] };
            let pixel = Seen::Pixel { camera: 1, pixel: [u + off[0], v + off[1]] };
            observation(1, Place::Disk(i), Vec3::ZERO, pixel)
        })
        .collect();
    assert!(in_image(&robot, &seen, 0, 1).is_empty() && in_image(&robot, &seen, 1, 0).is_empty());
    let markers = in_image(&robot, &seen, 1, 1);
    let model = Model::new(ModelKind::Cosserat, Stations::Disks, Actuation::Natural);
    let found = overlay(&model, &robot, &case(), &camera, &markers, 37).unwrap();
    let rms = found.rms(&markers).unwrap();
    assert!((rms.pixels - 5.0).abs() < 1e-6 && (rms.distance - 2.5e-3).abs() < 1e-9, "{rms:?}");
    assert_eq!((found.residuals.len(), found.fine.poses.len()), (10, 37));
}
