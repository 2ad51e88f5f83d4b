//! Into what a section of the backbone is divided.

/// Where a section bends, the same for all sections of a robot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Division {
    /// The rigid link before the first joint, as a fraction of the section's length.
    pub first: f64,
    pub joints: &'static [Joint],
    /// How it bends at each joint.
    pub bend: Bend,
    /// What its stiffness resists.
    pub energy: Energy,
}

/// How a section bends at a joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Bend {
    /// At a point, with a rigid link behind it.
    Point,
    /// Along an arc that is as long as the link.
    Arc,
    /// Along an arc whose chord is as long as the link.
    Chord,
}

/// What the stiffness of a section resists.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Energy {
    /// Its twist and its bends, each by itself.
    Coordinates,
    /// The rotation vector from its start to its end; of one joint.
    RotationVector,
}

/// A place that bends about x and y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Joint {
    /// Stiffness by `EI` over the section's length.
    pub stiffness: f64,
    /// The link behind it, as a fraction of the section's length.
    pub link: f64,
}

impl Division {
    /// How many coordinates a section has.
    pub(super) const fn coordinates(&self) -> usize {
        1 + 2 * self.joints.len()
    }

    /// Whether it bends along arcs.
    pub(super) const fn is_arc(&self) -> bool {
        !matches!(self.bend, Bend::Point)
    }

    /// A section that twists by more than this in rad has folded.
    pub(super) const fn most_twist(&self) -> f64 {
        match self.energy {
            Energy::Coordinates => f64::INFINITY,
            // The rotation vector of more has turned over.
            Energy::RotationVector => core::f64::consts::PI,
        }
    }

    /// Where along a section, as fractions of it, its curve changes direction at once: the joints between rigid bodies.
    pub(super) fn corners(&self) -> impl Iterator<Item = f64> + '_ {
        let joints = if self.is_arc() { &[] } else { self.joints };
        joints.iter().scan(self.first, |reached, joint| {
            let corner = *reached;
            *reached += joint.link;
            Some(corner)
        })
    }

    /// Which part of the bend that one moment makes falls to each joint.
    pub(super) fn shares(&self) -> [f64; 3] {
        let compliance = |k: usize| self.joints.get(k).map_or(0.0, |joint| 1.0 / joint.stiffness);
        let each: [f64; 3] = core::array::from_fn(compliance);
        let all: f64 = each.iter().sum();
        each.map(|one| one / all)
    }
}
