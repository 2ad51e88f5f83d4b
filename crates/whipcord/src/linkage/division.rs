//! Into what a section of the backbone is divided.

/// Where a section bends, the same for all sections of a robot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Division {
    /// The rigid link before the first joint, as a fraction of the section's length.
    pub first: f64,
    pub joints: &'static [Joint],
    /// Whether each joint is an arc along its link, and not a point before it.
    pub is_arc: bool,
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

    /// Where along a section, as fractions of it, its curve changes direction at once: the joints between rigid bodies.
    pub(super) fn corners(&self) -> impl Iterator<Item = f64> + '_ {
        let joints = if self.is_arc { &[] } else { self.joints };
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
