/// A cable: where it runs and what it is made of.
#[derive(Clone, Debug, PartialEq)]
pub struct Cable {
    /// Name, unique in the robot.
    pub name: String,
    /// Group of cables that it belongs to, such as the segment that it bends. Cables of a group can share parameters in a fit.
    pub group: Option<String>,
    /// Where it runs in the cross-sections.
    pub routing: Routing,
    /// How far it runs from the centres of its holes; of no effect where it is not led through holes.
    pub hole_offset: HoleOffset,
    /// Arc length in m at which it is anchored; `None` is the tip, or, for a list of holes, the disk of its
    /// last hole.
    pub ends_at: Option<f64>,
    /// Capstan friction coefficient at the holes.
    pub friction: Option<f64>,
    /// Axial stiffness E·A in N; `None` is inextensible.
    pub axial_stiffness: Option<f64>,
}

/// How far a cable runs from the centres of its holes, the same at all disks: it lies at the side of a hole that is wider than
/// itself, or the holes were drilled on another circle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HoleOffset {
    /// About the axis of the backbone in rad, from x towards y.
    pub angle: f64,
    /// Away from the axis in m, negative towards it.
    pub radius: f64,
}

/// How a cable runs along the robot. Lengths in m, angles in rad from x towards y.
#[derive(Clone, Debug, PartialEq)]
pub enum Routing {
    /// Through one hole of each disk from the base on; a list shorter than the disks ends the
    /// cable at its last hole.
    Holes {
        /// Hole numbers, from 1.
        holes: Vec<usize>,
        /// Course between the disks, for the continuous models.
        interpolation: Interpolation,
    },
    /// Parallel to the backbone.
    Straight {
        /// Angle.
        angle: f64,
        /// Distance from the backbone's axis.
        radius: f64,
    },
    /// On a helix round the backbone.
    Helix {
        /// Angle at the base.
        start_angle: f64,
        /// Turns over the whole backbone, positive counter-clockwise.
        turns: f64,
        /// Distance from the backbone's axis.
        radius: f64,
    },
    /// On the straight line between a point of the base and a point of the tip.
    Linear {
        /// (x, y) at the base.
        start: [f64; 2],
        /// (x, y) at the tip of the backbone.
        end: [f64; 2],
    },
    /// By polynomials in the arc length.
    Polynomial {
        /// Coefficients of x in ascending powers of the arc length in m.
        x: Vec<f64>,
        /// Coefficients of y in ascending powers of the arc length in m.
        y: Vec<f64>,
    },
}

/// How a cable through holes runs between the disks in the continuous models.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Interpolation {
    /// Twice continuously differentiable cubic splines, with not-a-knot ends, of the unwrapped hole
    /// angle and of the radius.
    #[default]
    Spline,
    /// Monotone piecewise cubics of the same: no overshoot, but the curvature jumps.
    Pchip,
    /// Fourier series of order 8 in x and y, as in the paper.
    Fourier,
}

impl Routing {
    /// Through these holes, with the default interpolation.
    #[must_use]
    pub const fn holes(holes: Vec<usize>) -> Self {
        Self::Holes { holes, interpolation: Interpolation::Spline }
    }
}

impl Cable {
    /// An inextensible, frictionless cable.
    #[must_use]
    pub fn new(name: impl Into<String>, routing: Routing) -> Self {
        Self {
            name: name.into(),
            group: None,
            routing,
            hole_offset: HoleOffset::default(),
            ends_at: None,
            friction: None,
            axial_stiffness: None,
        }
    }

    /// Whether it has friction at its holes.
    #[must_use]
    pub fn has_friction(&self) -> bool {
        self.friction.is_some_and(|coefficient| coefficient > 0.0)
    }
}
