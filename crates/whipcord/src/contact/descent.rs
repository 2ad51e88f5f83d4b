//! Which contacts touch where many depend on one another, by descent.

use super::complementarity::{Complementarity, ROUNDING, Touching};

/// So often contacts are taken in or let go on the way down, by their number.
const DESCENTS: usize = 10;
/// The most that their equations take on it, by those of all of them once.
const MOST_EFFORT: f64 = 20.0;

impl Complementarity {
    /// Which touch, without friction, where many contacts depend on one another, as around a rim in a bore without clearance: from no forces on, contacts
    /// are taken in one at a time, and forces grow until the next one would pull, which is let go (Lawson and Hanson, *Solving Least Squares
    /// Problems*, 1974). It ends where M has no negative eigenvalues on those that touch on the way.
    pub(super) fn descend(&mut self) -> Option<Touching> {
        let count = self.gaps.len();
        let before = core::mem::take(&mut self.forces);
        let mut forces = vec![0.0; count];
        let mut refused = vec![false; count];
        let scale = self.gaps.iter().fold(0.0_f64, |most, gap| most.max(gap.abs()));
        self.contacts.iter_mut().for_each(|contact| contact.touches = false);
        let mut held = None;
        let mut effort = 0.0;
        for _ in 0..DESCENTS * count {
            let touching = self.contacts.iter().filter(|contact| contact.touches).count();
            effort += (touching as f64 / count as f64).powi(3);
            if effort > MOST_EFFORT {
                break;
            }
            self.forces.clone_from(&before);
            let Some((next, negative)) = self.forces_of_touching() else { break };
            // The part of the way to these forces on which none pulls.
            let most = next.iter().fold(0.0_f64, |most, (_, force)| most.max(force.abs()));
            let pulling = next.iter().filter(|(_, force)| *force < -ROUNDING * most);
            let first = pulling
                .map(|&(i, force)| (i, forces[i] / (forces[i] - force)))
                .min_by(|a, b| a.1.total_cmp(&b.1));
            let part = first.map_or(1.0, |(_, part)| part);
            for (i, force) in next {
                forces[i] = (forces[i] + part * (force - forces[i])).max(0.0);
            }
            if part > 0.0 {
                refused.fill(false);
            }
            if let Some((i, _)) = first {
                forces[i] = 0.0;
                self.contacts[i].touches = false;
                refused[i] = part == 0.0;
                continue;
            }
            let gap = |i: usize| {
                let row = &self.matrix[i * count..(i + 1) * count];
                self.gaps[i] + row.iter().zip(&forces).map(|(m, f)| m * f).sum::<f64>()
            };
            let open = (0..count).filter(|&i| !self.contacts[i].touches && !refused[i]);
            let overlapping = open.map(|i| (i, gap(i))).filter(|(_, gap)| *gap < -ROUNDING * scale);
            match overlapping.min_by(|a, b| a.1.total_cmp(&b.1)) {
                Some((i, _)) => self.contacts[i].touches = true,
                None => {
                    held = Some(Touching { negative });
                    break;
                }
            }
        }
        self.forces = if held.is_some() { forces } else { before };
        held
    }
}
