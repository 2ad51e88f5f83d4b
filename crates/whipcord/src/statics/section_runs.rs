//! Sections that follow one another and all differ: each is solved by itself, so that several are solved at once.
//!
//! Each starts from its response at rest to the tensions, to the second order. First those of a few nodes that are spread over the run; then those
//! in the middle between two that are known, with what these depart from their responses: on the cubic through the four nearest; and last all that
//! are left. Sections that are earlier ones turned about the backbone ([`super::turned_sections`]) are not solved but turned. The same order, and the
//! same start of each section, hold for a single robot, whose sections are side by side in the lanes of the processor, and for a batch, whose robots are.

use core::ops::Range;

use super::section_table::{Place, SectionTable, WIDTH};
use super::turned_sections::{TurnedSection, turned_sections};

/// Nodes one behind the other, through which the same cables run.
#[derive(Clone, Debug)]
pub(crate) struct SectionRun {
    /// Of the nodes of the grid.
    pub nodes: Range<usize>,
    /// In the order in which they are solved.
    pub waves: Vec<Wave>,
    /// The nodes whose sections those of waves give.
    pub turned: Vec<TurnedSection>,
    /// All of its sections: the waves one behind the other, and those that are turned.
    pub sections: SectionTable,
    /// The node of the grid in each slot of these.
    pub in_slots: Vec<usize>,
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

/// A cubic through nodes that are farther from one another than from the node between them says nothing there.
const MOST_WEIGHT: f64 = 2.0;
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
        if places.len() < FIRST {
            return None;
        }
        let mut turned = turned_sections(places);
        let is_turned = |at: &usize| turned.binary_search_by_key(at, |of| of.node).is_ok();
        // The others are counted by themselves.
        let solved: Vec<usize> = (0..places.len()).filter(|at| !is_turned(at)).collect();
        let count = solved.len();
        let mut known: Vec<usize> = match count {
            ..=FIRST => (0..count).collect(),
            _ => (0..FIRST).map(|i| i * (count - 1) / (FIRST - 1)).collect(),
        };
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
            let start = |&at: &usize| {
                let (nodes, weights) = between(places, &solved, &known, at);
                match weights.iter().all(|weight| weight.abs() <= MOST_WEIGHT) {
                    true => WaveStart::Between { nodes: nodes.map(|of| first + of), weights },
                    false => WaveStart::Response,
                }
            };
            let starts = next.iter().map(start).collect();
            known.extend_from_slice(&next);
            known.sort_unstable();
            waves.push((next, starts));
        }
        let mut all = Vec::new();
        let mut in_slots = Vec::new();
        for (at, starts) in waves {
            let slots = in_slots.len()..in_slots.len() + at.len();
            in_slots.extend(at.iter().map(|&at| solved[at]));
            // Slots between two waves hold some section, so that nothing is computed of zeros.
            in_slots.resize(in_slots.len().next_multiple_of(WIDTH), solved[at[at.len() - 1]]);
            let nodes = at.iter().map(|&at| first + solved[at]).collect();
            all.push(Wave { slots, nodes, starts });
        }
        in_slots.extend(turned.iter().map(|of| of.node));
        let last = in_slots[in_slots.len() - 1];
        in_slots.resize(in_slots.len().next_multiple_of(WIDTH), last);
        for TurnedSection { node, of, .. } in &mut turned {
            (*node, *of) = (first + *node, first + *of);
        }
        let of_step = |at: &usize| (first + at) % 3 == 1;
        let mut middles: Vec<usize> = (0..places.len()).filter(of_step).collect();
        let last = middles.last().copied().unwrap_or(0);
        let nodes = middles.iter().map(|at| first + at).collect();
        let cables = places.first().map_or(0, |place| place.crossings.len());
        middles.resize(middles.len().next_multiple_of(WIDTH), last);
        Some(Self {
            nodes: first..first + places.len(),
            waves: all,
            turned,
            sections: SectionTable::of(&in_slots, places, cables),
            in_slots: in_slots.iter().map(|at| first + at).collect(),
            middles: nodes,
            of_middles: SectionTable::of(&middles, places, cables),
        })
    }
}

/// Four known ones of the solved places next to one of them, and the weights of the last three of these where their cubic is met.
fn between(
    places: &[Place<'_>],
    solved: &[usize],
    known: &[usize],
    at: usize,
) -> ([usize; 4], [f64; 3]) {
    let behind = known.partition_point(|&of| of < at);
    let from = behind.saturating_sub(2).min(known.len() - 4);
    let mut nodes = [0, 1, 2, 3].map(|i| known[from + i]);
    nodes.sort_by_key(|of| of.abs_diff(at));
    let nodes = nodes.map(|of| solved[of]);
    let s = |of: usize| places[of].arc_length;
    let at = s(solved[at]);
    let weight = |i: usize| {
        let others = (0..4).filter(|&other| other != i);
        others.fold(1.0, |weight, other| {
            weight * (at - s(nodes[other])) / (s(nodes[i]) - s(nodes[other]))
        })
    };
    (nodes, [weight(1), weight(2), weight(3)])
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
        // Cables along cones: of the same slope they are the same, turned.
        let crossings = |k: usize, slope: usize| {
            let (sin, cos) = (0.1 * k as f64).sin_cos();
            let at = |r: f64| Vec3::new(r * cos, r * sin, 0.0);
            [1e-3, 2e-3].map(|r| Crossing::new(at(r), at(slope as f64)))
        };
        // All differ; every fifth is the same; some in the middle are the same as those before.
        let slopes: [fn(usize) -> usize; 3] =
            [|k| k, |k| k % 5, |k| if (k / 4) % 3 == 1 { k % 4 } else { 100 + k }];
        for (count, slope) in (1..200_usize).flat_map(|count| slopes.map(|slope| (count, slope))) {
            let all: Vec<_> = (0..count + 5).map(|k| crossings(k, slope(k))).collect();
            // Five nodes that are solved otherwise lie in front.
            let place = |k: usize| Place {
                section: &section,
                crossings: &all[k],
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
            let first = |node: usize| (5..=node).find(|&of| slope(of) == slope(node)).unwrap();
            let turned = (5..count + 5).filter(|&node| first(node) < node).count();
            assert_eq!(runs[0].turned.len(), turned);
            for TurnedSection { node, of, .. } in &runs[0].turned {
                assert!(known[*of] && !known[*node] && *of == first(*node));
                known[*node] = true;
            }
            assert!(known[5..].iter().all(|&of| of));
            assert!((5..count + 5).all(|node| runs[0].in_slots.contains(&node)));
        }
    }
}
