//! What the page is told of a robot file.

use std::fs;

use whipcord::{Model, ModelKind, Pose, Statics as _, Stations, UnitQuaternion, Vec3};
use whipcord_io::load;

use super::example;
use crate::scene::scene;

/// Case 3 of the paper, measured at disks, between them and beside them as its Cosserat rod has them, in a frame that was
/// `moved`: where that was in the world, and where the page has it.
fn measured(moved: Pose, registration: &str) -> (Vec<Vec3>, Vec<Vec3>) {
    let path = example("table1/case-3.toml");
    let file = load(&path).unwrap();
    let stations = Stations::At(vec![0.0, 0.04, 0.071, 0.18]);
    let rod = Model::new(ModelKind::Cosserat, stations, Default::default());
    let shape = rod.solve(&file.robot, &file.case).unwrap().shape;
    let mut table = String::from("arc_length,offset_x,offset_y,offset_z,x,y,z\n");
    let mut world = Vec::new();
    for (pose, s) in shape.poses.iter().zip(&shape.arc_length) {
        for offset in [Vec3::ZERO, Vec3::X * 0.012, Vec3::Y * 0.007] {
            let place = pose.transform(offset);
            let [a, b, c] = offset.to_array();
            let [x, y, z] = moved.transform(place).to_array();
            table += &format!("{s:?},{a:?},{b:?},{c:?},{x:?},{y:?},{z:?}\n");
            world.push(place);
        }
    }
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("seen.csv"), table).unwrap();
    let [own, base] = [folder.path().join("own.toml"), path.canonicalize().unwrap()];
    let text = format!(
        "extends = {base:?}\n[measured]\ndisks = \"seen.csv\"\nregistration = \"{registration}\"\n"
    );
    fs::write(&own, text).unwrap();
    let shown = scene(&load(&own).unwrap()).measured.into_iter().map(Vec3::from);
    (world, shown.collect())
}

fn farthest((world, shown): &(Vec<Vec3>, Vec<Vec3>)) -> f64 {
    assert_eq!(world.len(), shown.len());
    world.iter().zip(shown).map(|(a, b)| (*a - *b).norm()).fold(0.0, f64::max)
}

#[test]
fn what_was_measured_is_shown_where_it_lies_beside_the_robot() {
    let turn = UnitQuaternion::exp(Vec3::new(0.3, -1.1, 2.0));
    let moved = Pose { position: Vec3::new(0.2, -0.4, 1.0), rotation: turn };
    for registration in ["rigid", "base"] {
        let off = farthest(&measured(moved, registration));
        // The rod takes other steps where markers are than at the disks.
        assert!(off < 1e-6, "{registration}: {off}");
    }
    assert!(farthest(&measured(Pose::IDENTITY, "none")) < 1e-15);
    assert!(farthest(&measured(moved, "none")) > 0.5);
}
