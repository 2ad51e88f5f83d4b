//! Shapes that inverse problems start from, in files.

use std::fs;
use std::path::PathBuf;

use whipcord::{Actuation, Model, ModelKind, Stations, Vec3};
use whipcord_inverse::{
    CableLimits, CommandedBy, InverseSolver, Limits, ReachOptions, ReachStatus, Target,
};
use whipcord_io::{AtlasFileError, atlas_to_parquet, load, load_atlas, start_from_atlas};

/// Of an example under a greatest tension in N.
fn solver(example: &str, kind: ModelKind, greatest: f64) -> InverseSolver {
    let examples = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../examples");
    let file = load(examples.join(example)).unwrap();
    let model = Model::new(kind, Stations::Disks, Actuation::Natural);
    let limits = CableLimits { tension: [0.5, greatest], ..CableLimits::default() };
    let limits = Limits::uniform(file.robot.cables().len(), limits);
    InverseSolver::new(&model, &file.robot, &file.case, &limits, CommandedBy::Tensions).unwrap()
}

fn arm() -> InverseSolver {
    solver("two-segment-arm.toml", ModelKind::PseudoRigidBody, 40.0)
}

fn scratch(name: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("atlas");
    fs::create_dir_all(&folder).unwrap();
    let path = folder.join(name);
    let _ = fs::remove_file(&path);
    path
}

#[test]
fn an_atlas_is_kept_for_the_same_robot_and_limits() {
    let path = scratch("kept.parquet");
    let mut first = arm();
    start_from_atlas(&mut first, &path).unwrap();
    let written = fs::read(&path).unwrap();
    let read = load_atlas(&path, first.atlas_identity()).unwrap().unwrap();
    // Every bit of the numbers; of the orientations what is left of a unit quaternion that is normed again.
    let made = first.atlas().unwrap().clone();
    assert!(read.tips.len() > 1000 && made.tips.len() == read.tips.len());
    assert_eq!((&read.commands, &read.disks), (&made.commands, &made.disks));
    for (a, b) in read.tips.iter().zip(&made.tips) {
        assert_eq!(a.position, b.position);
        assert!((a.rotation * b.rotation.conjugate()).log().norm() < 1e-15);
    }
    // The next run reads it, and answers the same.
    let mut second = arm();
    start_from_atlas(&mut second, &path).unwrap();
    assert_eq!(second.atlas().unwrap(), &read);
    let target = Target::Tip(Vec3::new(0.06, 0.03, 0.28));
    let [a, b] = [first, second].map(|mut solver| {
        let answer = solver.reach(&target, &ReachOptions::default()).unwrap();
        assert_eq!(answer.status, ReachStatus::Reached);
        answer.commands
    });
    assert_eq!(a, b);
    assert_eq!(fs::read(&path).unwrap(), written);
    // Another limit, load, robot or model has other shapes.
    let others = [
        solver("two-segment-arm.toml", ModelKind::PseudoRigidBody, 20.0),
        solver("three-cable-segment.toml", ModelKind::PseudoRigidBody, 40.0),
        solver("two-segment-arm.toml", ModelKind::PiecewiseConstantCurvature, 40.0),
    ];
    for mut other in others {
        assert_eq!(load_atlas(&path, other.atlas_identity()), Ok(None));
        assert!(other.set_atlas(read.clone()).is_err());
        start_from_atlas(&mut other, &path).unwrap();
        assert!(load_atlas(&path, other.atlas_identity()).unwrap().is_some());
    }
}

#[test]
fn what_is_no_atlas_is_not_overwritten() {
    let path = scratch("letter.parquet");
    for content in [&b"Dear reader"[..], b"PAR1", b""] {
        fs::write(&path, content).unwrap();
        let refused = start_from_atlas(&mut arm(), &path).unwrap_err();
        assert!(matches!(refused, AtlasFileError::NoAtlas { .. }), "{refused}");
        assert!(refused.to_string().contains("give another name"), "{refused}");
        assert_eq!(fs::read(&path).unwrap(), content);
    }
    let folder = start_from_atlas(&mut arm(), path.parent().unwrap()).unwrap_err();
    assert!(matches!(folder, AtlasFileError::Unreadable { .. }), "{folder}");
}

#[test]
fn a_damaged_atlas_is_refused_or_whole() {
    let mut solver = arm();
    let whole = atlas_to_parquet(solver.atlas().unwrap());
    let (path, identity) = (scratch("damaged.parquet"), solver.atlas_identity());
    let mut refused = 0;
    for k in 0..60_usize {
        let mut bytes = whole.clone();
        let at = k.wrapping_mul(7919) % bytes.len();
        match k % 3 {
            0 => bytes.truncate(at),
            // Near the end is the footer.
            1 => {
                let at = bytes.len() - 1 - at % 6000;
                bytes[at] ^= 1 << (k % 8);
            }
            _ => bytes[at] ^= 1 << (k % 8),
        }
        fs::write(&path, &bytes).unwrap();
        match load_atlas(&path, identity) {
            Ok(Some(atlas)) => drop(arm().set_atlas(atlas)),
            Ok(None) => {}
            Err(AtlasFileError::NoAtlas { .. }) => refused += 1,
            Err(error) => panic!("{error}"),
        }
    }
    assert!(refused > 20, "{refused}");
}
