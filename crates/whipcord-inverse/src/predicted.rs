//! What is predicted for the next point of a path.

/// Where the derivatives at a point of a path lead for the next one.
pub(crate) struct Predicted {
    pub unknowns: Vec<f64>,
    /// The size of the step, and how far the point before is from that of its derivatives, in scales.
    pub sizes: [f64; 2],
    /// What the residuals of the linear problem leave, where no constraint is violated.
    pub distance: Option<f64>,
}

impl Predicted {
    /// The square of sizes that the curvature of the residuals goes with.
    fn square(&self) -> f64 {
        let [size, stale] = self.sizes;
        size * (size + 2.0 * stale)
    }

    /// Whether with this curvature the residuals there are within a distance.
    pub fn is_within(&self, curvature: Option<f64>, distance: f64) -> bool {
        let left = self.distance.zip(curvature).map(|(left, of)| left + of * self.square());
        left.is_some_and(|left| left <= distance)
    }

    /// The curvature that these residuals there show, where it was taken for another.
    pub fn curvature(&self, known: Option<f64>, distance: f64) -> Option<f64> {
        let seen = distance / self.square().max(f64::MIN_POSITIVE);
        // One point may lie where the curvatures of its residuals cancel.
        known.map(|known| seen.clamp(0.5 * known, 2.0 * known))
    }
}
