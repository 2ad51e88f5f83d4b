//! Whether markers are numbered from the wrong end.

use whipcord::{Actuation, Model, ModelKind, Stations, Vec3};
use whipcord_estimation::identification::Unknown;
use whipcord_estimation::observation::{is_reversed, places};
use whipcord_estimation::{Observation, Seen};
use whipcord_io::CaseFile;

use super::moves_base;
use crate::describe::reversed;

/// What is said of the cases whose markers on the axis fit the model of the file as it is far better in
/// opposite order, in one of its steps. Where the place of the base is what is sought, the order is not told by it.
pub fn reversed_cases(kind: ModelKind, cases: &[CaseFile], unknowns: &[Unknown]) -> Vec<String> {
    let placed = cases.iter().enumerate().filter(|(i, _)| !moves_base(*i, unknowns));
    placed.filter(|(_, file)| is_any_reversed(kind, file)).map(|(_, file)| reversed(file)).collect()
}

fn is_any_reversed(kind: ModelKind, file: &CaseFile) -> bool {
    let Some(measured) = &file.measured else { return false };
    let model = Model::new(kind, Stations::Disks, Actuation::Natural);
    let Ok(mut prepared) = model.prepare(&file.robot, &file.case.loads) else { return false };
    let mut solutions = Vec::new();
    // A step without an answer is spoken of elsewhere.
    let _ = prepared.solve_steps(&file.case, |solution| solutions.push(solution));
    file.case.single_steps().zip(&solutions).enumerate().any(|(step, (case, solution))| {
        let seen = measured.observations.iter();
        let seen = seen.filter(|seen| seen.step == step && seen.offset == Vec3::ZERO);
        let seen: Vec<&Observation> = seen.collect();
        if seen.is_empty() {
            return false;
        }
        let there = places(&model, &file.robot, &case, solution, seen.iter().copied());
        let Ok(there) = there else { return false };
        let arc_length = |seen: &Observation| seen.place.arc_length(file.robot.disks());
        let pairs = || seen.iter().zip(&there);
        let in_space = pairs().filter_map(|(seen, there)| match seen.seen {
            Seen::Position(at) => Some((arc_length(seen), at.to_array(), there.to_array())),
            Seen::Pixel { .. } | Seen::Rotation { .. } => None,
        });
        let in_image = |number: usize| {
            let pixels = pairs().filter_map(|(seen, there)| match seen.seen {
                Seen::Pixel { camera, pixel } if camera == number => {
                    let model = measured.cameras[camera].camera.project(*there).ok()?;
                    Some((arc_length(seen), pixel, model))
                }
                _ => None,
            });
            is_reversed(&pixels.collect::<Vec<_>>())
        };
        is_reversed(&in_space.collect::<Vec<_>>()) || (0..measured.cameras.len()).any(in_image)
    })
}
