//! Searches on steps of a fixed number, whose errors are far below the noise: they cost a part of those to a tolerance.

use super::forward::Forward;
use super::pieces::Piece;
use crate::observation::Observation;
use whipcord::cosserat::Accuracy;
use whipcord::model::Model;

/// Steps from base to tip that are tried.
const STEPS: [usize; 4] = [18, 36, 72, 144];
/// Greatest error at the start, as a part of the length of the backbone, and in pixels.
const NEAR: f64 = 1e-7;
const NEAR_PIXELS: f64 = 1e-3;
/// So many pieces are looked at.
const LOOKED_AT: usize = 32;

impl Forward<'_> {
    /// The model with the fewest steps that are enough at these values; none where the model has none to choose.
    pub(super) fn coarse_model(&self, x: &[f64]) -> Option<Model> {
        let (Model::Cosserat(options) | Model::CosseratDisks(options)) = &self.model else {
            return None;
        };
        if matches!(options.accuracy, Accuracy::Steps(_)) {
            return None;
        }
        let every = self.pieces.len().div_ceil(LOOKED_AT).max(1);
        let looked_at: Vec<(usize, ())> =
            (0..self.pieces.len()).step_by(every).map(|piece| (piece, ())).collect();
        let near: Vec<f64> = self
            .experiments
            .iter()
            .flat_map(|of| &of.observations)
            .flat_map(|seen| vec![self.tolerance(seen); seen.numbers()])
            .collect();
        let by = |model: &Model| {
            self.each_piece(&looked_at, |solver, piece: &Piece| solver.predict_by(model, piece, x))
                .ok()?
                .into_iter()
                .collect::<Result<Vec<_>, _>>()
                .ok()
        };
        let exact = by(&self.model)?;
        STEPS.into_iter().map(|steps| self.model.clone().with_steps(steps)).find(|model| {
            by(model).is_some_and(|found| {
                exact.iter().zip(&found).all(|(exact, found)| {
                    let pairs = exact.numbers.iter().zip(&found.numbers).zip(&exact.rows);
                    pairs.into_iter().all(|((a, b), row)| (a - b).abs() <= near[*row])
                })
            })
        })
    }

    fn tolerance(&self, seen: &Observation) -> f64 {
        match seen.seen.is_in_image() {
            true => NEAR_PIXELS,
            false => NEAR * self.robot.backbone().length,
        }
    }
}
