//! Robots of the paper before cameras whose pictures are known.

use std::path::Path;

use whipcord::{
    Actuation, Model, ModelKind, Pose, Robot, Solution, Stations, UnitQuaternion, Vec3,
};
use whipcord_estimation::Place;
use whipcord_estimation::camera::{Camera, Distortion, Lens, Orthographic, Pinhole};
use whipcord_vision::Photo;
use whipcord_vision::detect::{Kind, Mark, Search, colour, find};
use whipcord_vision::render::{Blur, Light, Marker, Noise, Rendered, Scene};

/// A lens that bends the image by several pixels at its edges.
pub const BENT: [f64; 5] = [-0.3, 0.1, 0.0005, 0.0003, 0.0];

/// A robot, its shape, a camera, and how the photograph is taken.
pub struct Shot {
    pub robot: Robot,
    pub solution: Solution,
    pub camera: Camera,
    pub scene: Scene,
}

impl Shot {
    /// One of the paper's four cases, or the robot without a cable (0), from afar at this azimuth in rad: a little
    /// blurred, under uneven light, with noise of this deviation.
    pub fn of(case: usize, azimuth: f64, noise: f64) -> Self {
        let (robot, solution) = robot(case);
        let mut scene = Scene::of(&robot);
        scene.light = Light { gradient: [0.4, -0.3], vignette: 0.3 };
        scene.blur = Blur { deviation: 1.0, motion: [0.0, 0.0] };
        let seed = 1000 * case as u64 + (100.0 * (azimuth + 4.0)) as u64;
        scene.noise = Noise::of(noise, seed);
        Self { robot, solution, camera: camera(azimuth, None), scene }
    }

    /// The same from 0.9 m through a lens that bends.
    pub fn bent(self, azimuth: f64) -> Self {
        Self { camera: camera(azimuth, Some(&BENT)), ..self }
    }

    /// With a round marker of 1.4 mm before each disk.
    pub fn with_markers(mut self, rgb: [u8; 3]) -> Self {
        let towards = -self.camera.pose().rotation.rotate(Vec3::Z);
        let before = |(i, pose): (usize, &Pose)| Marker {
            place: Place::Disk(i),
            offset: pose.rotation.conjugate().rotate(0.0105 * towards),
            radius: 0.0014,
            colour: colour(rgb),
        };
        self.scene.markers = self.solution.disks.poses.iter().enumerate().map(before).collect();
        self
    }

    pub fn take(&self) -> Rendered {
        self.scene.photograph(&self.robot, &self.solution, &self.camera).unwrap()
    }
}

/// All of a kind, wherever and in whatever colour.
pub const fn any(kind: Kind) -> Search<'static> {
    Search { kind, colour: None, radius: None, mask: None }
}

/// What is found of a kind; nothing where nothing is.
pub fn found(photo: &Photo, kind: Kind) -> Vec<Mark> {
    find(photo, &any(kind)).unwrap_or_default()
}

fn robot(case: usize) -> (Robot, Solution) {
    let name = if case == 0 { "prototype.toml".to_owned() } else { format!("case-{case}.toml") };
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/table1");
    let file = whipcord_io::load(folder.join(name)).expect("the example is valid");
    let model = Model::new(ModelKind::Cosserat, Stations::Equal(46), Actuation::Natural);
    let mut prepared = model.prepare(&file.robot, &file.case.loads).expect("the model takes it");
    let solution = prepared.solve(&file.case, None).expect("there is an answer");
    (file.robot, solution)
}

/// A camera that looks along −x turned by `azimuth` rad about z, the robot upright in its picture of 720×660
/// pixels, 2.8 pixels for each mm; from 0.9 m through this lens, or from afar.
fn camera(azimuth: f64, distortion: Option<&[f64]>) -> Camera {
    let (centre, distance) = ([359.5, 329.5], 0.9);
    let lens = match distortion {
        None => Lens::Orthographic(Orthographic::new(2800.0, centre).unwrap()),
        Some(coefficients) => {
            let distortion = Distortion::new(coefficients).unwrap();
            let focal = [2800.0 * distance; 2];
            Lens::Pinhole(Pinhole::new(focal, centre, distortion).unwrap())
        }
    };
    // Its x, y and z are the world's y, −z and −x, turned about z.
    let upright = UnitQuaternion::from_wxyz([0.5, -0.5, -0.5, 0.5]).unwrap();
    let rotation = UnitQuaternion::exp(azimuth * Vec3::Z) * upright;
    let forward = rotation.rotate(Vec3::Z);
    assert!((rotation.rotate(Vec3::Y) + Vec3::Z).norm() < 1e-12);
    let position = Vec3::new(0.0, 0.0, 0.09) - distance * forward;
    Camera::new(lens, Pose { position, rotation }, Some([720, 660])).unwrap()
}

/// The distance of each from the one found nearest to it, within 3 pixels.
pub fn misses(found: &[Mark], truth: &[[f64; 2]]) -> Vec<Option<f64>> {
    let away = |mark: &Mark, p: &[f64; 2]| (mark.pixel[0] - p[0]).hypot(mark.pixel[1] - p[1]);
    let nearest = |p: &[f64; 2]| found.iter().map(|mark| away(mark, p)).min_by(f64::total_cmp);
    truth.iter().map(|p| nearest(p).filter(|&d| d < 3.0)).collect()
}

/// Root of the mean square of the distances, where all were found and nothing else.
pub fn rms(found: &[Mark], truth: &[[f64; 2]]) -> f64 {
    assert_eq!(found.len(), truth.len(), "{found:?}");
    let distances: Vec<f64> = misses(found, truth).into_iter().flatten().collect();
    assert_eq!(distances.len(), truth.len(), "{found:?} {truth:?}");
    (distances.iter().map(|d| d * d).sum::<f64>() / distances.len() as f64).sqrt()
}
