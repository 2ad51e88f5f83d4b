//! Where the iteration of a section starts that has no strain of its own yet: from the sections before it.

use crate::section::Strain;

/// Places that differ by this part of their arc length are one: the end of a step and the start of the next.
const SAME: f64 = 1e-9;

/// The next strain by extrapolation from the three before it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Guess {
    known: usize,
    at: [f64; 3],
    pub strains: [Strain; 3],
}

impl Guess {
    #[inline]
    pub fn at(&self, arc_length: f64) -> Option<Strain> {
        let [a, b, c] = self.strains;
        match self.known {
            1.. if self.is_last(arc_length) => Some(c),
            0 => None,
            1 | 2 => Some(c),
            _ => Some(match extrapolation(self.at, arc_length) {
                Some([wa, wb]) => c + (a - c) * wa + (b - c) * wb,
                None => c,
            }),
        }
    }

    #[inline]
    fn is_last(&self, arc_length: f64) -> bool {
        (arc_length - self.at[2]).abs() <= SAME * arc_length
    }

    /// Forgets all but the last strain, where a cable ends and the strains jump.
    #[inline]
    pub fn jump(&mut self) {
        self.known = self.known.min(1);
    }

    /// Of a place where a strain is known the later one counts.
    #[inline]
    pub fn learn(&mut self, arc_length: f64, strain: Strain) {
        if self.known > 0 && self.is_last(arc_length) {
            self.strains[2] = strain;
            return;
        }
        self.known += 1;
        self.at = [self.at[1], self.at[2], arc_length];
        self.strains = [self.strains[1], self.strains[2], strain];
    }
}

/// Weights of what is known at the first two of three places, less what is known at the third, in what a
/// parabola through all three has at another place, less the same: a strain that is held, and that no
/// iteration corrects, is so kept to the last bit. `None` where that place is farther off than the three
/// are from one another.
#[inline]
pub(super) fn extrapolation([a, b, c]: [f64; 3], at: f64) -> Option<[f64; 2]> {
    (at - c <= c - a).then(|| {
        [(at - b) * (at - c) / ((a - b) * (a - c)), (at - a) * (at - c) / ((b - a) * (b - c))]
    })
}
