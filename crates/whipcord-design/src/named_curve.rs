//! Curves by their names, for a backbone of any length.

use crate::curve::Curve;
use crate::error::DesignError;

/// A curve by its name. It begins at the base along the backbone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NamedCurve {
    /// Which curve.
    pub kind: CurveKind,
    /// Direction in rad from x in which it first bends.
    pub direction: f64,
}

/// The curves that have a name.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CurveKind {
    /// An arc of a circle of this radius in m.
    Circle {
        /// Radius.
        radius: f64,
    },
    /// An arc of a circle that turns by this angle in rad over the length.
    Arc {
        /// Angle.
        angle: f64,
    },
    /// A helix of this radius that climbs by the pitch in a turn, in m; left-handed where the pitch is negative.
    Helix {
        /// Radius.
        radius: f64,
        /// Pitch.
        pitch: f64,
    },
    /// One way by this angle in rad over the first half, back over the second.
    S {
        /// Angle.
        angle: f64,
    },
    /// Curvature that goes linearly from one value to another, in 1/m.
    Clothoid {
        /// At the base.
        start: f64,
        /// At the tip.
        end: f64,
    },
}

impl NamedCurve {
    /// Names of the curves.
    pub const NAMES: [&str; 5] = ["circle", "arc", "helix", "s", "clothoid"];

    /// Its name.
    #[must_use]
    pub const fn name(&self) -> &'static str {
        match self.kind {
            CurveKind::Circle { .. } => "circle",
            CurveKind::Arc { .. } => "arc",
            CurveKind::Helix { .. } => "helix",
            CurveKind::S { .. } => "s",
            CurveKind::Clothoid { .. } => "clothoid",
        }
    }

    /// Its numbers by their names, in SI.
    #[must_use]
    pub fn numbers(&self) -> Vec<(&'static str, f64)> {
        match self.kind {
            CurveKind::Circle { radius } => vec![("radius", radius)],
            CurveKind::Arc { angle } | CurveKind::S { angle } => vec![("angle", angle)],
            CurveKind::Helix { radius, pitch } => vec![("radius", radius), ("pitch", pitch)],
            CurveKind::Clothoid { start, end } => vec![("start", start), ("end", end)],
        }
    }

    /// The curve of this length in m.
    ///
    /// # Errors
    /// [`DesignError::Curve`] for numbers that cannot be.
    pub fn curve(&self, length: f64) -> Result<Curve, DesignError> {
        let curve = match self.kind {
            CurveKind::Circle { radius } => Curve::circle(length, radius),
            CurveKind::Arc { angle } => Curve::new(length, 0.0, move |_| angle / length, |_| 0.0),
            CurveKind::Helix { radius, pitch } => Curve::helix(length, radius, pitch),
            CurveKind::S { angle } => Curve::s_curve(length, angle),
            CurveKind::Clothoid { start, end } => Curve::clothoid(length, [start, end]),
        };
        let curve = curve.towards(self.direction);
        curve.check()?;
        Ok(curve)
    }
}
