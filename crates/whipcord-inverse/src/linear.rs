//! Residuals and constraints at one point, with their derivatives.

/// A problem at one point: residuals and constraints with their derivatives by the unknowns.
#[derive(Clone, Debug, Default)]
pub(crate) struct Linear {
    /// Residuals.
    pub residual: Vec<f64>,
    /// Their derivatives, by rows.
    pub jacobian: Vec<f64>,
    /// What is left until each constraint is violated, as a part of its range; negative where it is.
    pub slack: Vec<f64>,
    /// The rates at which the unknowns use it up, by rows.
    pub rows: Vec<f64>,
}

impl Linear {
    /// `½‖r‖²`.
    pub fn cost(&self) -> f64 {
        0.5 * self.residual.iter().map(|r| r * r).sum::<f64>()
    }

    /// `‖r‖`.
    pub fn distance(&self) -> f64 {
        (2.0 * self.cost()).sqrt()
    }

    /// What a violation of 1 counts for beside the cost: so much that constraints are kept wherever they can be.
    pub fn penalty(&self) -> f64 {
        1e2 * self.cost().max(1e-30)
    }

    /// The greatest violation of a constraint, 0 where all are kept.
    pub fn violation(&self) -> f64 {
        self.slack.iter().map(|slack| -slack).fold(0.0, f64::max)
    }
}
