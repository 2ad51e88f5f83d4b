//! Models laid over a photograph, and how far each is from what was seen there.

pub mod seen;
pub mod tables;

use whipcord::camera::{Camera, Miss};
use whipcord::{
    Case, Drive, Model, ModelKind, Observation, Robot, Shape, Solution, SolveError, Stations,
};
use whipcord_io::CaseFile;
use whipcord_plot::{FINE_STATIONS, RobotView};

use crate::markers::places;
use crate::statistics::mean;
use crate::superposition::seen::Marker;
use crate::timing;
use crate::words::label;

/// A model on the case of a photograph.
#[derive(Debug)]
pub struct Run {
    /// Which model.
    pub model: ModelKind,
    /// Its answer, or why it has none.
    pub outcome: Result<Superposed, SolveError>,
}

/// An answer over the photograph.
#[derive(Debug)]
pub struct Superposed {
    /// At the disks.
    pub solution: Solution,
    /// Smooth, for the picture.
    pub fine: Shape,
    /// How far it is from each marker that was seen; `None` where the camera does not see it there.
    pub misses: Vec<Option<Miss>>,
}

/// Root mean squares over the markers that are not at the base.
#[derive(Clone, Copy, Debug)]
pub struct Rms {
    /// In pixels.
    pub pixels: f64,
    /// In m, from the rays through the pixels.
    pub distance: f64,
}

impl Run {
    /// Solves a case, whose commands are those of the photograph, by a model.
    pub fn new(
        model: ModelKind,
        file: &CaseFile,
        case: &Case,
        camera: &Camera,
        markers: &[Marker],
    ) -> Self {
        let outcome = superposed(model, &file.robot, case, camera, markers);
        Self { model, outcome }
    }

    /// What the picture's legend says.
    pub fn label(&self, markers: &[Marker], length: f64) -> String {
        let Ok(superposed) = &self.outcome else { return self.model.to_string() };
        let name = label(self.model, &superposed.solution);
        match superposed.rms(markers) {
            Some(Rms { distance, .. }) => format!(
                "{name}: RMS {:.2} mm, {:.2} % of the length",
                1e3 * distance,
                1e2 * distance / length
            ),
            None => name,
        }
    }
}

impl Superposed {
    /// As pictures show it.
    pub fn view(&self, label: String) -> RobotView {
        let solution = Solution { shape: self.fine.clone(), ..self.solution.clone() };
        RobotView::model(label, &solution)
    }

    /// Over the markers that are not at the base, which holds them whatever the model says; `None` where
    /// there are none.
    pub fn rms(&self, markers: &[Marker]) -> Option<Rms> {
        let misses = markers.iter().zip(&self.misses).filter(|(marker, _)| !marker.is_at_base());
        let misses: Vec<Miss> = misses.filter_map(|(_, miss)| *miss).collect();
        let rms = |of: fn(&Miss) -> f64| {
            let squares: Vec<f64> = misses.iter().map(|miss| of(miss).powi(2)).collect();
            mean(&squares).sqrt()
        };
        (!misses.is_empty())
            .then(|| Rms { pixels: rms(|miss| miss.pixels), distance: rms(|miss| miss.distance) })
    }
}

fn superposed(
    kind: ModelKind,
    robot: &Robot,
    case: &Case,
    camera: &Camera,
    markers: &[Marker],
) -> Result<Superposed, SolveError> {
    let at = |stations| Model::new(kind, stations, Drive::Natural);
    let solution = timing::solve_once(&at(Stations::Disks), robot, case).map_err(|(_, e)| e)?;
    let follow = |stations| -> Result<Shape, SolveError> {
        let mut prepared = at(stations).prepare(robot, &case.loads)?;
        Ok(prepared.solve(case, Some(&solution))?.shape)
    };
    let fine = follow(Stations::Equal(FINE_STATIONS)).unwrap_or_else(|_| solution.shape.clone());
    let observations: Vec<&Observation> = markers.iter().map(|marker| &marker.seen).collect();
    let places = places(kind, robot, case, &solution, &observations)?;
    let misses = places.into_iter().zip(markers).map(|(place, m)| camera.miss(place, m.pixel).ok());
    let misses = misses.collect();
    Ok(Superposed { solution, fine, misses })
}
