//! Synthetic photographs of the boards that cameras are calibrated with.

use whipcord::Vec3;
use whipcord_estimation::camera::{Camera, ViewError};

use super::{Blur, Light, Noise, Occluder, RenderError, sensor};
use crate::boards::Board;
use crate::coverage::Coverage;
use crate::photo::Photo;

/// How a board looks, and what comes between it and its photograph.
#[derive(Clone, Debug, PartialEq)]
pub struct BoardScene {
    /// What lies behind the board, in linear light.
    pub background: [f32; 3],
    /// Its white.
    pub white: [f32; 3],
    /// Its black.
    pub black: [f32; 3],
    /// What lies before the board, drawn in this order.
    pub occluders: Vec<Occluder>,
    /// How evenly it is lit.
    pub light: Light,
    /// How sharp the photograph is.
    pub blur: Blur,
    /// What the sensor adds.
    pub noise: Noise,
}

impl Default for BoardScene {
    /// Printed on white paper before a grey wall, sharp, evenly lit and without noise.
    fn default() -> Self {
        Self {
            background: [0.35, 0.34, 0.32],
            white: [0.8; 3],
            black: [0.03; 3],
            occluders: Vec::new(),
            light: Light::default(),
            blur: Blur::default(),
            noise: Noise::default(),
        }
    }
}

/// A synthetic photograph of a board, and what is true of it.
#[derive(Clone, Debug, PartialEq)]
pub struct RenderedBoard {
    /// The photograph.
    pub photo: Photo,
    /// Where each inner corner is, in pixels, by number, seen or hidden.
    pub corners: Vec<[f64; 2]>,
}

/// Straight pieces that an edge is drawn as: the lens bends it.
const PIECES: usize = 8;

impl BoardScene {
    /// The photograph that a camera takes of a board whose frame is that of the world.
    ///
    /// # Errors
    /// [`RenderError`] when the camera cannot take it.
    pub fn photograph(&self, board: &Board, camera: &Camera) -> Result<RenderedBoard, RenderError> {
        let [width, height] = camera.size().ok_or(RenderError::NoSize)?.map(|n| n as usize);
        let mut photo = Photo::uniform(width, height, self.background);
        let mut coverage = Coverage::default();
        let square = board.square();
        let [columns, rows] = board.corners().map(|n| n + 1);
        let origin = board.point(0) - square * Vec3::new(1.0, 1.0, 0.0);
        let mut paint = |from: [f64; 2], to: [f64; 2], colour| -> Result<(), ViewError> {
            let corners = rectangle(origin, from, to, camera)?;
            coverage.paint(&mut photo, &corners, colour);
            Ok(())
        };
        let end = [columns as f64, rows as f64].map(|n| n * square);
        paint([-square; 2], end.map(|at| at + square), self.white)?;
        for (column, row) in (0..rows).flat_map(|row| (0..columns).map(move |column| (column, row)))
        {
            let from = [column, row].map(|n| n as f64 * square);
            if (column + row) % 2 == 0 {
                paint(from, from.map(|at| at + square), self.black)?;
            }
            let Some(marker) = board.marker([column, row]) else { continue };
            let from = from.map(|at| at + 0.5 * (square - marker.side));
            let cell = marker.side / marker.cells as f64;
            paint(from, from.map(|at| at + marker.side), self.black)?;
            for (k, _) in marker.black.iter().enumerate().filter(|(_, black)| !**black) {
                let at = [k % marker.cells, k / marker.cells];
                let from = [0, 1].map(|i| from[i] + at[i] as f64 * cell);
                paint(from, from.map(|at| at + cell), self.white)?;
            }
        }
        for occluder in &self.occluders {
            coverage.paint(&mut photo, &occluder.corners, occluder.colour);
        }
        sensor::expose(&mut photo, self.light, self.blur, self.noise);
        let corners =
            (0..board.count()).map(|k| camera.project(board.point(k))).collect::<Result<_, _>>()?;
        Ok(RenderedBoard { photo, corners })
    }
}

/// A rectangle of the board as a polygon in the picture.
fn rectangle(
    origin: Vec3,
    from: [f64; 2],
    to: [f64; 2],
    camera: &Camera,
) -> Result<Vec<[f64; 2]>, ViewError> {
    let corners = [from, [to[0], from[1]], to, [from[0], to[1]]];
    let mut points = Vec::with_capacity(4 * PIECES);
    for (k, a) in corners.iter().enumerate() {
        let b = corners[(k + 1) % 4];
        for i in 0..PIECES {
            let t = i as f64 / PIECES as f64;
            let [x, y] = [0, 1].map(|axis| a[axis] + t * (b[axis] - a[axis]));
            points.push(camera.project(origin + Vec3::new(x, y, 0.0))?);
        }
    }
    Ok(points)
}
