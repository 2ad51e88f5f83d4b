//! Cables that are anchored to the rod between two disks.
//!
//! Such a cable runs straight from its last hole `h₀` to its anchor, which the cross-section at `(R, p)` has at `r`: its chord is
//! `c = p + R r − h₀`, and its line goes through the hole. What it exerts on the rod at the anchor is therefore, seen from
//! the disk, what it exerts on the disk in eq. (3), and beyond the anchor the rod bears
//!
//! ```text
//! w₂ = w + τ (t, h₀ × t),      δw₂ = δw + δτ (t, h₀ × t) + τ (δt, h₀ × δt),   δt = (I − t tᵀ) R (ζ + η × r)/ℓ      (10)
//! ```
//!
//! with the rotation `η` and the displacement `ζ` of the cross-section in its frame.

use whipcord_numerics::{Pose, Twist, UnitQuaternion};

use super::chord::{Chord, along_cable, unit_pull};
use crate::section::BodyWrench;
use crate::statics::passages::{Anchor, Passage};
use whipcord_numerics::Vec3;

/// The anchors of a span, from the base on.
#[derive(Clone, Copy, Debug)]
pub(super) struct Anchors<'a> {
    pub at: &'a [Anchor],
    /// Of all cables of the span.
    pub passages: &'a [Passage],
    pub tensions: &'a [f64],
}

/// How a chord changes.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ChordChange {
    /// `δℓ`.
    pub longer: f64,
    /// `δt`, in the frame of the near disk.
    pub tilt: Vec3,
}

/// A variation of which the anchors are told what it does to them.
#[derive(Debug)]
pub(super) struct Varied<'a> {
    pub chords: &'a [Chord],
    /// The anchor whose cable pulls by 1 N more.
    pub pulled: Option<usize>,
    /// Takes the changes of the chords.
    pub changes: &'a mut [ChordChange],
}

impl Anchors<'_> {
    /// What the cables exert that are anchored at a node, whose cross-section stands at `pose`; `chords` takes their chords.
    #[inline]
    pub fn pull(&self, node: usize, pose: &Pose, chords: &mut [Chord]) -> BodyWrench {
        let mut sum = BodyWrench::default();
        for anchor in self.at.iter().filter(|anchor| anchor.node == node) {
            let i = anchor.passage;
            chords[i] = Chord::between(&self.passages[i], pose);
            sum = sum + unit_pull(self.passages[i].near, &chords[i]) * self.tensions[i];
        }
        sum
    }

    /// The same as it was when the chords were drawn.
    #[inline]
    pub fn pull_of(&self, node: usize, chords: &[Chord]) -> BodyWrench {
        let here = self.at.iter().filter(|anchor| anchor.node == node);
        here.fold(BodyWrench::default(), |sum, &Anchor { passage: i, .. }| {
            sum + unit_pull(self.passages[i].near, &chords[i]) * self.tensions[i]
        })
    }

    /// The change of that when the cross-section at the node, which is turned so, moves.
    #[inline]
    pub fn change(
        &self,
        node: usize,
        rotation: UnitQuaternion,
        by: &Twist,
        varied: &mut Varied<'_>,
    ) -> BodyWrench {
        let mut sum = BodyWrench::default();
        let here = self.at.iter().enumerate().filter(|(_, anchor)| anchor.node == node);
        for (a, &Anchor { passage: i, .. }) in here {
            let (passage, chord) = (&self.passages[i], &varied.chords[i]);
            let way = rotation.rotate(by.linear + by.angular.cross(passage.far));
            let longer = chord.along.dot(way);
            let tilt = (way - chord.along * longer) * (1.0 / chord.length);
            varied.changes[a] = ChordChange { longer, tilt };
            sum = sum + along_cable(passage.near, tilt * self.tensions[i]);
            if varied.pulled == Some(a) {
                sum = sum + unit_pull(passage.near, chord);
            }
        }
        sum
    }
}
