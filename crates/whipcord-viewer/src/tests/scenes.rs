//! What the page is told of a robot file.

use std::fs;
use std::sync::Arc;
use std::time::Instant;

use whipcord::{Model, ModelKind, Pose, Shape, Statics as _, Stations, UnitQuaternion, Vec3};
use whipcord_io::load;

use super::example;
use crate::bench::Bench;
use crate::protocol::{Answer, Frame, Lens, Sight};
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
    let told = scene(&load(&own).unwrap());
    // Where the model has it is where the frame of the page has it.
    let model = Bench::new(Arc::new(load(&own).unwrap())).solve(&told.initial, Instant::now());
    let Ok(Frame { answers, .. }) = model else { panic!() };
    let Answer::Solved(solved) = &answers[0] else { panic!("{answers:?}") };
    let poses = solved.positions.iter().zip(&solved.orientations).map(|(&position, &turn)| Pose {
        position: position.into(),
        rotation: UnitQuaternion::from_wxyz(turn).unwrap(),
    });
    let shape = Shape { arc_length: told.stations.clone(), poses: poses.collect() };
    let shown = told.measured[0].iter().zip(&world).map(|(marker, expected)| {
        let place = shape.at(marker.arc_length.unwrap()).transform(marker.offset.into());
        assert!((place - *expected).norm() < 1e-4 * told.length, "{marker:?}");
        let Sight::Position { position } = marker.seen else { panic!("{marker:?}") };
        Vec3::from(position)
    });
    (world.clone(), shown.collect())
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

/// A camera with a strong distortion that sees the robot of case 3: its file, and pixels of its disks.
const CAMERA: &str = "%YAML:1.0\n---\nimage_width: 640\nimage_height: 480\ncamera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   data: [ 700., 0., 310., 0., 710., 250., 0., 0., 1. ]\ndistortion_coefficients: !!opencv-matrix\n   rows: 1\n   cols: 5\n   dt: d\n   data: [ -0.2, 0.05, 0.001, -0.002, 0. ]\nrvec: [ 1.5707963267948966, 0., 0. ]\ntvec: [ 0., 0.1, 0.6 ]\n";

#[test]
fn lines_of_sight_and_pictures_are_those_of_the_camera() {
    let path = example("table1/case-3.toml").canonicalize().unwrap();
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("left.yml"), CAMERA).unwrap();
    let camera = whipcord_io::load_camera(folder.path().join("left.yml")).unwrap();
    let file = load(&path).unwrap();
    let shape = Model::new(ModelKind::Cosserat, Stations::Disks, Default::default())
        .solve(&file.robot, &file.case)
        .unwrap()
        .shape;
    let mut table = String::from("disk,u,v\n");
    for (k, place) in shape.positions().enumerate() {
        let [u, v] = camera.project(place).unwrap();
        table += &format!("{},{u:?},{v:?}\n", k + 1);
    }
    fs::write(folder.path().join("seen.csv"), table).unwrap();
    let own = folder.path().join("own.toml");
    let text = format!(
        "extends = {path:?}\n[measured]\ntable = \"seen.csv\"\n[[measured.cameras]]\nname = \"left\"\nfile = \"left.yml\"\n"
    );
    fs::write(&own, text).unwrap();
    let told = scene(&load(&own).unwrap_or_else(|error| panic!("{error:?}")));
    assert_eq!(told.measured[0].len(), shape.poses.len());
    for (marker, place) in told.measured[0].iter().zip(shape.positions()) {
        let Sight::Line { camera: 0, origin, direction } = marker.seen else {
            panic!("{marker:?}")
        };
        let way = place - Vec3::from(origin);
        let off = way.cross(Vec3::from(direction)).norm();
        assert!(off < 1e-8, "{off}");
    }
    // What the page draws at an ideal place is seen at the pixel that is stretched to it.
    let [seen] = &told.cameras[..] else { panic!("{:?}", told.cameras) };
    let Lens::Pinhole { focal, centre } = seen.lens else { panic!("{seen:?}") };
    assert_eq!((seen.name.as_str(), seen.size), ("left", [640.0, 480.0]));
    let rows = seen.ideal.len() / seen.columns;
    let (row, column) = (rows / 3, seen.columns / 4);
    let [x, y] = seen.ideal[row * seen.columns + column].unwrap();
    let depth = 0.5;
    let in_camera =
        Vec3::new(depth * (x - centre[0]) / focal[0], depth * (y - centre[1]) / focal[1], depth);
    let [u, v] = camera.project(camera.pose().transform(in_camera)).unwrap();
    let expected = [
        640.0 * column as f64 / (seen.columns - 1) as f64 - 0.5,
        480.0 * row as f64 / (rows - 1) as f64 - 0.5,
    ];
    assert!(
        (u - expected[0]).abs() < 1e-6 && (v - expected[1]).abs() < 1e-6,
        "{u} {v} {expected:?}"
    );
}
