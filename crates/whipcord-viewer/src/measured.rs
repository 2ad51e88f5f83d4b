//! What was measured on the real robot, and the cameras that saw it, as the page is told of them.

use whipcord::{ModelPreset, Pose, Stations};
use whipcord_estimation::camera::{Camera, Lens};
use whipcord_estimation::observation::{Seen, distances};
use whipcord_estimation::registration::Alignment;
use whipcord_io::{CaseFile, Measured, MeasuringCamera};

use crate::convert::{array, pose};
use crate::protocol::{self, Marker, Sight};

/// Places along an edge of a picture whose distortion the page is told of. Between them it is linear: of the cubic distortion of
/// wide lenses a hundredth of a pixel is left, relative to pictures of a thousand.
const COLUMNS: usize = 33;
const ROWS: usize = 25;

/// Markers of each step, in the world: brought there, where the file says how, as onto the answers of the first model. None where
/// there are no such answers, or no motion brings them to it.
pub fn by_step(file: &CaseFile, first: Option<ModelPreset>) -> Vec<Vec<Marker>> {
    let mut steps = vec![Vec::new(); file.case.before.len() + 1];
    let Some(measured) = &file.measured else { return steps };
    let Some(motion) = motion(file, measured, first) else { return steps };
    for seen in &measured.observations {
        let sight = match seen.seen {
            Seen::Position(position) => {
                Some(Sight::Position { position: array(motion.transform(position)) })
            }
            Seen::Pixel { camera, pixel } => {
                let ray = measured.cameras.get(camera).and_then(|of| of.camera.ray(pixel).ok());
                ray.map(|ray| Sight::Line {
                    camera,
                    origin: array(ray.origin),
                    direction: array(ray.direction),
                })
            }
            Seen::Rotation { .. } => None,
        };
        if let (Some(seen_at), Some(step)) = (sight, steps.get_mut(seen.step)) {
            step.push(Marker {
                seen: seen_at,
                arc_length: Some(seen.place.arc_length(file.robot.disks())),
                offset: array(seen.offset),
            });
        }
    }
    steps
}

/// What brings the frame of the measurement to the world.
fn motion(file: &CaseFile, measured: &Measured, first: Option<ModelPreset>) -> Option<Pose> {
    let Measured { observations, alignment, .. } = measured;
    if *alignment == Alignment::None || !observations.iter().any(|seen| seen.seen.is_position()) {
        return Some(Pose::IDENTITY);
    }
    let (robot, case) = (&file.robot, &file.case);
    let first = first?;
    let model = first.model(Stations::Disks, robot.disks().count() - 1);
    let answers = model.prepare(robot, &case.loads).ok()?.solve_all(case).ok()?;
    let answers: Vec<_> = answers.iter().collect();
    distances(first.kind, robot, case, &answers, observations, *alignment).ok()??.motion
}

/// The cameras of the file.
pub fn cameras(file: &CaseFile) -> Vec<protocol::Camera> {
    let all = file.measured.iter().flat_map(|measured| &measured.cameras);
    all.map(|MeasuringCamera { name, camera, .. }| of(name, camera)).collect()
}

fn of(name: &str, camera: &Camera) -> protocol::Camera {
    let (lens, centre) = match camera.lens() {
        Lens::Pinhole(lens) => {
            let (focal, centre) = (lens.focal(), lens.centre());
            (protocol::Lens::Pinhole { focal, centre }, centre)
        }
        Lens::Orthographic(lens) => {
            let (scale, centre) = (lens.scale(), lens.centre());
            (protocol::Lens::Orthographic { scale, centre }, centre)
        }
    };
    // A camera file need not say how large its pictures are: the axis of most lenses is in their middle.
    let size = match camera.size() {
        Some(size) => size.map(f64::from),
        None => centre.map(|c| (2.0 * c + 1.0).max(1.0)),
    };
    let places = (0..ROWS).flat_map(|row| (0..COLUMNS).map(move |column| [column, row]));
    let ideal = places.map(|[column, row]| {
        // The centre of the first pixel is (0, 0), so that the picture begins half a pixel before it.
        let pixel = [
            size[0] * column as f64 / (COLUMNS - 1) as f64 - 0.5,
            size[1] * row as f64 / (ROWS - 1) as f64 - 0.5,
        ];
        let [x, y] = camera.undistort(pixel).ok()?;
        let place = match lens {
            protocol::Lens::Pinhole { focal, .. } => {
                [centre[0] + focal[0] * x, centre[1] + focal[1] * y]
            }
            protocol::Lens::Orthographic { scale, .. } => {
                [centre[0] + scale * x, centre[1] + scale * y]
            }
        };
        place.iter().all(|c| c.is_finite()).then_some(place)
    });
    protocol::Camera {
        name: name.to_owned(),
        pose: pose(&camera.pose()),
        lens,
        size,
        columns: COLUMNS,
        ideal: ideal.collect(),
    }
}
