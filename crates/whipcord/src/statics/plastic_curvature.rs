//! What friction against bending holds along the backbone: the plastic curvature that earlier steps left.

use super::grid::{Grid, Nodes, SHOOTING_NODES, Step};
use crate::section::{BENDING_AXES, Strain};
use whipcord_numerics::GAUSS_3;

/// Plastic curvature about x and y of the sections in 1/m: between the ends of each step of the grid that it was found on it is a
/// parabola, with the change of the slope from this step to its neighbour of the same length between the same disks; linear where
/// there is none. It may jump from step to step. On another grid it is interpolated.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct PlasticCurvature {
    /// Ends of the steps in m, the base first; empty where nothing is held anywhere.
    ends: Vec<f64>,
    /// At the start and at the end of each step.
    values: Vec<[[f64; BENDING_AXES]; 2]>,
    /// Of each step the neighbour whose slope tells how it is curved, or itself.
    neighbours: Vec<usize>,
}

/// Ends of steps that are as near as this part of the backbone are the same.
const ROUNDING: f64 = 1e-10;

impl PlasticCurvature {
    /// At the start and at the end of each step of a grid.
    pub fn new(grid: &Grid, values: Vec<[[f64; BENDING_AXES]; 2]>) -> Self {
        debug_assert_eq!(grid.len(), values.len());
        Self { ends: grid.ends(), values, neighbours: neighbours(grid) }
    }

    /// What the strains at both ends of each step of a grid leave, eq. (2) of the page on bending friction.
    pub fn left(grid: &Grid, strains: &[[Strain; 2]]) -> Self {
        let at = |k: usize, strains: &[Strain; 2]| {
            core::array::from_fn(|end| {
                let section = &grid.at_end(k, end).section;
                let bend = strains[end].angular - section.rest_curvature;
                section.friction().map_or([0.0; BENDING_AXES], |friction| friction.left(bend))
            })
        };
        let values = strains.iter().enumerate().map(|(k, strains)| at(k, strains)).collect();
        Self::new(grid, values)
    }

    /// At an arc length; `inside` says on which side where two steps meet there.
    pub fn at(&self, s: f64, inside: f64) -> [f64; BENDING_AXES] {
        let (Some(&length), false) = (self.ends.last(), self.values.is_empty()) else {
            return [0.0; BENDING_AXES];
        };
        let reach = ROUNDING * length;
        let place = if inside > s { s + reach } else { s - reach };
        let k = self.ends.partition_point(|&end| end <= place);
        let k = k.saturating_sub(1).min(self.values.len() - 1);
        let (start, end) = (self.ends[k], self.ends[k + 1]);
        let share = ((s - start) / (end - start)).clamp(0.0, 1.0);
        let [near, far] = self.values[k];
        // Newton's form of the parabola, by the change of the slope from middle to middle.
        let [before, after] = self.values[self.neighbours[k]];
        let sign = match self.neighbours[k] {
            next if next > k => 1.0,
            last if last < k => -1.0,
            _ => 0.0,
        };
        let bulge = 0.5 * sign * share * (share - 1.0);
        core::array::from_fn(|axis| {
            let slope = far[axis] - near[axis];
            near[axis] + share * slope + bulge * (after[axis] - before[axis] - slope)
        })
    }

    /// At the sections of a solution: behind each of these arc lengths, at the tip in front of it.
    pub fn at_stations(&self, stations: &[f64]) -> Vec<[f64; BENDING_AXES]> {
        stations.iter().map(|&s| self.at(s, s + 1.0)).collect()
    }
}

/// Of each step of a grid its neighbour: steps of one length between two disks, loads or anchors are taken in pairs from the base on.
fn neighbours(grid: &Grid) -> Vec<usize> {
    let steps = &grid.steps;
    let mut is_break = vec![false; steps.len() + 1];
    for &k in grid.disks.iter().chain(&grid.loads).chain(&grid.anchors) {
        is_break[k] = true;
    }
    let follows = |k: usize| {
        let (before, now) = (steps[k - 1].length, steps[k].length);
        !is_break[k] && (now - before).abs() <= 1e-6 * now
    };
    let mut found = Vec::with_capacity(steps.len());
    let mut first = 0;
    for k in 0..steps.len() {
        if k == 0 || !follows(k) {
            first = k;
        }
        let has_next = k + 1 < steps.len() && follows(k + 1);
        found.push(match (k - first) % 2 {
            0 if has_next => k + 1,
            _ if k > first => k - 1,
            _ => k,
        });
    }
    found
}

impl Grid {
    /// Whether friction against bending is where it begins to slide at an end of a step with these strains, at start and end of each.
    pub fn is_friction_at_limit(&self, strains: &[[Strain; 2]]) -> bool {
        strains.iter().enumerate().any(|(k, strains)| {
            (0..2).any(|end| {
                let section = &self.at_end(k, end).section;
                let bend = strains[end].angular - section.rest_curvature;
                section.friction().is_some_and(|friction| friction.is_at_limit(bend))
            })
        })
    }

    /// Gives the sections the plastic curvature that earlier steps of actuation left.
    pub fn set_plastic(&mut self, plastic: &PlasticCurvature) {
        set(&mut self.gauss, &self.steps, &GAUSS_3.nodes, plastic);
        set(&mut self.shooting, &self.steps, &SHOOTING_NODES, plastic);
    }
}

fn set(nodes: &mut Nodes, steps: &[Step], places: &[f64], plastic: &PlasticCurvature) {
    for (k, step) in steps.iter().enumerate() {
        let middle = step.start + 0.5 * step.length;
        for (j, place) in places.iter().enumerate() {
            let s = step.start + place * step.length;
            // The middle itself lies inside a step of the other grid, or between two of them that agree there.
            let held = plastic.at(s, if s == middle { middle + step.length } else { middle });
            if let Some(friction) = nodes.node_mut(k, j).section.friction_mut() {
                friction.plastic = held;
            }
        }
    }
}
