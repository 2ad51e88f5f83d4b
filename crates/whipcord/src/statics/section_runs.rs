//! Sections that follow one another and all differ: each is solved by itself, so that several are solved at once.
//!
//! Each starts from its response at rest to the tensions, to the second order. First those of a few nodes that are spread over the run; then those
//! in the middle between two that are known, with what these depart from their responses: on the cubic through the four nearest; and last all that
//! are left. The same order, and the same start of each section, hold for a single robot, whose sections are side by side in the lanes of the
//! processor, and for a batch, whose robots are.

use core::ops::Range;

use super::section_table::{Place, SectionTable, WIDTH};

/// Nodes one behind the other, through which the same cables run.
#[derive(Clone, Debug)]
pub(crate) struct SectionRun {
    /// Of the nodes of the grid.
    pub nodes: Range<usize>,
    /// In the order in which they are solved.
    pub waves: Vec<Wave>,
    pub sections: SectionTable,
    /// Those of its nodes that are in the middle of a step, and what is known of their sections.
    pub middles: Vec<usize>,
    pub of_middles: SectionTable,
}

/// Sections that are solved beside one another.
#[derive(Clone, Debug)]
pub(crate) struct Wave {
    /// In the rows of numbers; the first is a multiple of [`WIDTH`].
    pub slots: Range<usize>,
    /// The node of the grid in each slot.
    pub nodes: Vec<usize>,
    /// From which departures from its response each starts.
    pub starts: Vec<WaveStart>,
}

/// Where Newton's method starts, beside the response of the section at rest.
#[derive(Clone, Copy, Debug)]
pub(crate) enum WaveStart {
    /// There.
    Response,
    /// On the cubic through the departures at four nodes of the grid, of which the last three have these weights, less what the first has.
    Between { nodes: [usize; 4], weights: [f64; 3] },
}

/// The sections of the first wave.
const FIRST: usize = 8;
/// The last wave begins where no more than so many neighbours are left together.
const LEFT: usize = 3;

impl SectionRun {
    /// The runs of a grid, from its nodes in order: the place of each, or `None` where it is solved otherwise.
    pub fn all<'a>(places: impl Iterator<Item = Option<Place<'a>>>) -> Vec<Self> {
        let mut runs = Vec::new();
        let mut run: Vec<Place<'a>> = Vec::new();
        let mut end = 0;
        for (node, place) in places.enumerate() {
            let goes_on = match (run.last(), &place) {
                (Some(last), Some(next)) => last.crossings.len() == next.crossings.len(),
                _ => false,
            };
            if !goes_on {
                runs.extend(Self::of(node - run.len(), &run));
                run.clear();
            }
            run.extend(place);
            end = node + 1;
        }
        runs.extend(Self::of(end - run.len(), &run));
        runs
    }

    /// `None` of so few that they are not worth it.
    fn of(first: usize, places: &[Place<'_>]) -> Option<Self> {
        let count = places.len();
        if count < FIRST {
            return None;
        }
        let mut known: Vec<usize> = (0..FIRST).map(|i| i * (count - 1) / (FIRST - 1)).collect();
        known.dedup();
        let mut waves = vec![(known.clone(), vec![WaveStart::Response; known.len()])];
        while known.len() < count {
            let gaps = || known.windows(2).map(|pair| pair[0] + 1..pair[1]);
            let is_last = gaps().all(|gap| gap.len() <= LEFT);
            let next: Vec<usize> = match is_last {
                true => gaps().flatten().collect(),
                false => {
                    let wide = gaps().filter(|gap| !gap.is_empty());
                    wide.map(|gap| usize::midpoint(gap.start, gap.end)).collect()
                }
            };
            let start = |&at: &usize| between(first, places, &known, at);
            let starts = next.iter().map(start).collect();
            known.extend_from_slice(&next);
            known.sort_unstable();
            waves.push((next, starts));
        }
        let mut all = Vec::new();
        let mut in_slots = Vec::new();
        for (at, starts) in waves {
            let slots = in_slots.len()..in_slots.len() + at.len();
            in_slots.extend_from_slice(&at);
            // Slots between two waves hold some section, so that nothing is computed of zeros.
            in_slots.resize(in_slots.len().next_multiple_of(WIDTH), at[at.len() - 1]);
            let nodes = at.iter().map(|at| first + at).collect();
            all.push(Wave { slots, nodes, starts });
        }
        let of_step = |at: &usize| (first + at) % 3 == 1;
        let mut middles: Vec<usize> = (0..count).filter(of_step).collect();
        let last = middles.last().copied().unwrap_or(0);
        let nodes = middles.iter().map(|at| first + at).collect();
        let cables = places.first().map_or(0, |place| place.crossings.len());
        middles.resize(middles.len().next_multiple_of(WIDTH), last);
        Some(Self {
            nodes: first..first + count,
            waves: all,
            sections: SectionTable::of(&in_slots, places, cables),
            middles: nodes,
            of_middles: SectionTable::of(&middles, places, cables),
        })
    }
}

/// The start of a place between known ones, all of them counted from the first node of the run.
fn between(first: usize, places: &[Place<'_>], known: &[usize], at: usize) -> WaveStart {
    let behind = known.partition_point(|&of| of < at);
    let from = behind.saturating_sub(2).min(known.len() - 4);
    let mut nodes = [0, 1, 2, 3].map(|i| known[from + i]);
    nodes.sort_by_key(|of| of.abs_diff(at));
    let s = |of: usize| places[of].arc_length;
    let weight = |i: usize| {
        let others = (0..4).filter(|&other| other != i);
        others.fold(1.0, |weight, other| {
            weight * (s(at) - s(nodes[other])) / (s(nodes[i]) - s(nodes[other]))
        })
    };
    let weights = [weight(1), weight(2), weight(3)];
    WaveStart::Between { nodes: nodes.map(|of| first + of), weights }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::section::{Crossing, Section, Stiffness};
    use whipcord_numerics::Vec3;

    #[test]
    fn every_node_of_a_run_is_solved_once_from_ones_before() {
        let stiffness = Stiffness { shear: Vec3::new(1.0, 1.0, 1.0), bending: Vec3::Z };
        let section = Section::new(stiffness, Vec3::ZERO);
        let crossings = [Crossing::default(); 2];
        for count in 1..200_usize {
            // Five nodes that are solved otherwise lie in front.
            let place = |k: usize| Place {
                section: &section,
                crossings: &crossings,
                arc_length: (k as f64).powf(1.1),
            };
            let places = (0..count + 5).map(|k| (k >= 5).then(|| place(k)));
            let runs = SectionRun::all(places);
            if count < FIRST {
                assert!(runs.is_empty());
                continue;
            }
            assert_eq!(runs.len(), 1);
            let mut known = vec![false; count + 5];
            for wave in &runs[0].waves {
                assert_eq!(wave.slots.start % WIDTH, 0);
                for start in &wave.starts {
                    if let WaveStart::Between { nodes, weights } = start {
                        assert!(nodes.iter().all(|&of| known[of]), "{count}");
                        assert!(weights.iter().all(|weight| weight.abs() < 2.0));
                    }
                }
                // A cubic is met to rounding.
                let cubic = |k: usize| ((k as f64).powf(1.1) / 100.0 - 0.3).powi(3);
                for (node, start) in wave.nodes.iter().zip(&wave.starts) {
                    if let WaveStart::Between { nodes: [a, b, c, d], weights } = *start {
                        let more = [b, c, d].map(|of| cubic(of) - cubic(a));
                        let sum: f64 = more.iter().zip(weights).map(|(more, w)| more * w).sum();
                        assert!((cubic(a) + sum - cubic(*node)).abs() < 1e-11);
                    }
                }
                for &node in &wave.nodes {
                    assert!(!known[node]);
                    known[node] = true;
                }
            }
            assert!(known[5..].iter().all(|&of| of));
        }
    }
}
