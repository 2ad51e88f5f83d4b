//! The backbone of a rod without loads in pieces, with a point of it and its derivatives by coordinates of the tensions.
//!
//! From the strains of the sections, with `R′ = R û`, `p′ = R v` (11), the rotations `Ωₐ` of the sections and the point change by
//!
//! ```text
//! Ωₐ′ = R ∂ₐu,   ∂_bΩₐ′ = Ω_b × R ∂ₐu + R ∂ₐ∂_bu                                        (11a)
//! ∂ₐ∂_b p′ = ∂_bΩₐ × R v + Ωₐ × (Ω_b × R v) + Ωₐ × R ∂_bv + Ω_b × R ∂ₐv + R ∂ₐ∂_bv
//! ```
//!
//! of which the part that is symmetric in a and b is the second derivative.

use whipcord::section::{CrossedSection, section_compliance};
use whipcord::{Mat3, Robot, UnitQuaternion, Vec3};

use crate::rod_sections::{Equilibrium, Section};

/// The part of a backbone up to a point, in pieces.
#[derive(Clone, Debug)]
pub(crate) struct Rod {
    pub cells: Vec<Cell>,
    /// The sections that are looked at, those that are alike once.
    pub sections: Vec<Section>,
    pub cables: usize,
}

/// A piece of the backbone.
#[derive(Clone, Debug)]
pub(crate) struct Cell {
    pub width: f64,
    /// `√λ_max` of `∂v/∂N` and `∂u/∂M`, which bound strains by their norm in `K`.
    pub stretching: f64,
    pub bending: f64,
    /// The most that the direction of a cable turns about the backbone along it, in rad.
    turn: f64,
    /// `αᵢ` of each cable, 0 behind its end.
    pub alpha: Vec<f64>,
    /// Stretch of each cable at rest.
    pub stretch: Vec<f64>,
    /// The sections at its start, in its middle and at its end.
    pub sections: [usize; 3],
}

/// The shape under tensions.
#[derive(Clone, Debug, Default)]
pub(crate) struct State {
    /// Of each section.
    pub equilibria: Vec<Equilibrium>,
    nodes: Vec<Node>,
    /// `Ωₐ` of each node in the world.
    spins: Vec<Vec3>,
    /// `∂_bΩₐ` at the end of each piece, and of the last one.
    spin_rates: Vec<Vec3>,
    rate: Vec<Vec3>,
    /// `Ωₐ` at the end of the last piece.
    spin: Vec<Vec3>,
    /// `∂ₐp` of the point in the world.
    pub motions: Vec<Vec3>,
    /// What the integrals leave of the point, in m: an estimate from the order of their rules.
    pub error: f64,
    /// Coordinates of the tensions.
    coordinates: usize,
}

/// One of the three places of a cell at which its sections are.
#[derive(Clone, Copy, Debug)]
struct Node {
    rotation: Mat3,
    position: Vec3,
}

/// Pieces of the backbone between two disks: so many unless all its sections are alike, and where a cable turns about the backbone so many that it turns by no more than [`TURN`] along one.
const PIECES: usize = 2;
/// In rad.
const TURN: f64 = 0.6;
/// What a section may be worse between the places that are looked at.
pub(crate) const BETWEEN: f64 = 1.02;

impl Rod {
    /// Up to the point of the backbone at an arc length, with so many times the pieces that it takes at least; `None` for a robot without stiffness.
    pub fn of(robot: &Robot, arc_length: f64, times: usize) -> Option<Self> {
        let mut places = vec![0.0];
        for pair in robot.disks().arc_lengths.windows(2) {
            let pieces = times * pieces(robot, pair[0], pair[1]);
            for piece in 1..=pieces {
                let at = pair[0] + (pair[1] - pair[0]) * piece as f64 / pieces as f64;
                if at < arc_length {
                    places.push(at);
                }
            }
        }
        for route in robot.routes() {
            places.extend(route.breakpoints().iter().filter(|&&s| s < arc_length));
            places.extend(Some(route.end()).filter(|&s| s < arc_length));
        }
        places.extend(robot.backbone().places().into_iter().filter(|&s| s > 0.0 && s < arc_length));
        places.push(arc_length);
        places.sort_by(f64::total_cmp);
        places.dedup();
        let mut sections = Vec::new();
        let cells = places
            .windows(2)
            .map(|pair| Cell::of(robot, pair[0], pair[1], &mut sections))
            .collect::<Option<_>>()?;
        Some(Self { cells, sections, cables: robot.cables().len() })
    }

    /// The equilibria of the sections with their derivatives by each coordinate, whose tensions are those of an edge; the rotations of all places with each and their rates; and the point with its first derivatives and what the integrals
    /// leave of it. `None` where a section has no equilibrium.
    pub fn bend(
        &self,
        base: UnitQuaternion,
        tensions: &[f64],
        edges: &[f64],
        state: &mut State,
    ) -> Option<()> {
        let State { equilibria, nodes, spins, spin, motions, error, coordinates, spin_rates, rate } =
            state;
        equilibria.resize_with(self.sections.len(), Equilibrium::default);
        for (section, equilibrium) in self.sections.iter().zip(equilibria.iter_mut()) {
            section.equilibrium(tensions, equilibrium)?;
            section.first(tensions, edges, equilibrium)?;
            section.second(tensions, edges, equilibrium);
        }
        let count = edges.len() / self.cables.max(1);
        *coordinates = count;
        nodes.clear();
        spins.clear();
        let (mut rotation, mut position) = (base, Vec3::ZERO);
        for of in [&mut *spin, &mut *motions] {
            of.clear();
            of.resize(count, Vec3::ZERO);
        }
        spin_rates.clear();
        rate.clear();
        rate.resize(count * count, Vec3::ZERO);
        *error = 0.0;
        let mut left: f64 = self.cells.iter().map(|cell| cell.width).sum();
        for cell in &self.cells {
            let at = cell.sections.map(|of| &equilibria[of]);
            let (strains, h) = (at.map(|of| of.strain), cell.width);
            let turns = turns(strains.map(|[_, u]| u), h);
            let quaternions = [rotation, rotation * turns[0], rotation * turns[1]];
            rotation = quaternions[2].renormalized();
            let frames = quaternions.map(UnitQuaternion::to_matrix);
            let velocities = [0, 1, 2].map(|k| frames[k] * strains[k][0]);
            let [half, whole] = integrals(velocities, h);
            let positions = [position, position + half, position + whole];
            position = positions[2];
            nodes.extend([0, 1, 2].map(|k| Node { rotation: frames[k], position: positions[k] }));
            let first = spins.len();
            spins.resize(first + 3 * count, Vec3::ZERO);
            for (a, (spin, motion)) in spin.iter_mut().zip(motions.iter_mut()).enumerate() {
                let bends = [0, 1, 2].map(|k| frames[k] * at[k].first[a][1]);
                let [half, whole] = integrals(bends, h);
                let turned = [*spin, *spin + half, *spin + whole];
                *spin = turned[2];
                let mut moved = [Vec3::ZERO; 3];
                for k in 0..3 {
                    spins[first + k * count + a] = turned[k];
                    let stretch = frames[k] * at[k].first[a][0];
                    moved[k] = turned[k].cross(velocities[k]) + stretch;
                }
                *motion += integrals(moved, h)[1];
            }
            let simpson = [1.0, 4.0, 1.0].map(|weight| weight * h / 6.0);
            for (k, weight) in simpson.into_iter().enumerate() {
                let spins = &spins[first + k * count..first + (k + 1) * count];
                let mut second = at[k].second.iter();
                for (a, [_, u]) in at[k].first.iter().enumerate() {
                    let bend = frames[k] * (*u * weight);
                    for (b, spin) in spins.iter().enumerate() {
                        rate[a * count + b] += spin.cross(bend);
                    }
                    for (b, [_, u]) in second.by_ref().take(a + 1).enumerate() {
                        let by = frames[k] * (*u * weight);
                        rate[a * count + b] += by;
                        if a != b {
                            rate[b * count + a] += by;
                        }
                    }
                }
            }
            spin_rates.extend_from_slice(rate);
            left -= h;
            *error += cell.error(strains.map(|[_, u]| u), left);
        }
        Some(())
    }

    /// `∂ₐ∂_b p` of the point in the world by coordinates `b ≤ a` of a state, one row after the other.
    pub fn second_derivatives(&self, state: &State, second: &mut Vec<Vec3>) {
        let State { equilibria, nodes, spins, .. } = state;
        let n = state.coordinates;
        second.clear();
        second.resize(n * (n + 1) / 2, Vec3::ZERO);
        let Some(end) = nodes.last().map(|node| node.position) else { return };
        // What the second derivatives of the strains of each section are multiplied by: sums of R and of −â R with the arm a of the point about the section.
        let mut own: Vec<[Mat3; 2]> = vec![[Mat3::ZERO; 2]; equilibria.len()];
        let mut arms: Vec<Arms> = vec![Arms::default(); n];
        let places = nodes.iter().zip(spins.chunks_exact(n.max(1)));
        let cells = self.cells.iter().flat_map(|cell| {
            let simpson = [1.0, 4.0, 1.0].map(|weight| weight * cell.width / 6.0);
            cell.sections.into_iter().zip(simpson)
        });
        for ((node, spins), (section, weight)) in places.zip(cells) {
            let Equilibrium { strain, first, .. } = &equilibria[section];
            let arm = end - node.position;
            let turned = node.rotation * weight;
            own[section][0] += turned;
            own[section][1] += Mat3::skew(-arm) * turned;
            let velocity = node.rotation * strain[0];
            for ((arms, [v, u]), spin) in arms.iter_mut().zip(first).zip(spins) {
                let (bend, stretch) = (node.rotation * *u, node.rotation * *v);
                *arms = Arms {
                    spin: *spin,
                    bend: bend * (0.5 * weight),
                    stretch: stretch * weight,
                    along: 0.5 * weight * (spin.dot(velocity) - bend.dot(arm)),
                    of_spin: spin.dot(arm),
                };
            }
            let velocity = velocity * weight;
            let mut sums = second.iter_mut();
            for (number, a) in arms.iter().enumerate() {
                for (b, sum) in arms[..=number].iter().zip(&mut sums) {
                    // ½ (Ω_b × R ∂ₐu + Ωₐ × R ∂_bu) × arm and the mean of Ωₐ × (Ω_b × v) and Ω_b × (Ωₐ × v), by products of three vectors.
                    *sum += a.bend * b.of_spin + b.bend * a.of_spin;
                    *sum += a.spin * b.along + b.spin * a.along - velocity * a.spin.dot(b.spin);
                    *sum += a.spin.cross(b.stretch) + b.spin.cross(a.stretch);
                }
            }
        }
        for (equilibrium, [of_v, of_u]) in equilibria.iter().zip(&own) {
            for (sum, [v, u]) in second.iter_mut().zip(&equilibrium.second) {
                *sum += *of_v * *v + *of_u * *u;
            }
        }
    }
}

/// Of a place with a coordinate, with the weight of the place in an integral.
#[derive(Clone, Copy, Debug, Default)]
struct Arms {
    /// `Ωₐ`, without the weight.
    spin: Vec3,
    /// Half of `R ∂ₐu`.
    bend: Vec3,
    /// `R ∂ₐv`.
    stretch: Vec3,
    /// Half of `Ωₐ·R v` but `R ∂ₐu·arm`.
    along: f64,
    /// `Ωₐ·arm`, without the weight.
    of_spin: f64,
}

impl State {
    /// From the base to the point, in the world.
    pub fn end(&self) -> Vec3 {
        self.nodes.last().map_or(Vec3::ZERO, |node| node.position)
    }

    /// `Ωₐ` of all coordinates at the start, in the middle and at the end of a cell.
    pub fn spins(&self, cell: usize) -> [&[Vec3]; 3] {
        let n = self.coordinates;
        [0, 1, 2].map(|k| &self.spins[(3 * cell + k) * n..(3 * cell + k + 1) * n])
    }

    /// `∂_bΩₐ` at the end of a cell, those of each a one after the other.
    pub fn spin_rates(&self, cell: usize) -> &[Vec3] {
        let n = self.coordinates * self.coordinates;
        &self.spin_rates[cell * n..(cell + 1) * n]
    }
}

impl Cell {
    /// How much the strains can change in the norm of `K` with changes of the tensions up to these in N.
    pub fn change(&self, tensions: &[f64]) -> f64 {
        tensions.iter().zip(&self.alpha).map(|(t, a)| t * a).sum()
    }

    /// About what the integrals over it leave of a point so far behind it, from the curvatures at its start, in its middle and at its end: Simpson's rule leaves the 2880th part of the fourth derivative.
    fn error(&self, curvatures: [Vec3; 3], behind: f64) -> f64 {
        const SIMPSON: f64 = 2880.0;
        /// A bending stiffness with the fourth power of a diameter changes faster than what turns.
        const FASTER: f64 = 4.0;
        let most = curvatures.map(Vec3::norm).into_iter().fold(f64::MIN_POSITIVE, f64::max);
        let [start, middle, end] = curvatures;
        let changes = [start - middle, middle - end, start - end].map(Vec3::norm);
        let changed = changes.into_iter().fold(0.0, f64::max) / most;
        // What changes by a part of itself changes like what turns by that angle.
        let bent = self.width * most;
        let angle = bent + self.turn.max(changed);
        FASTER * bent * angle.powi(3) * (self.width + behind * angle) / SIMPSON
    }

    /// Between two arc lengths; its sections are those of the list, or are added to it.
    fn of(robot: &Robot, from: f64, to: f64, sections: &mut Vec<Section>) -> Option<Self> {
        let n = robot.cables().len();
        let mut cell = Self {
            width: to - from,
            stretching: 0.0,
            bending: 0.0,
            turn: 0.0,
            alpha: vec![0.0; n],
            stretch: vec![f64::INFINITY; n],
            sections: [0; 3],
        };
        let mut at_rest = Equilibrium::default();
        let inside = 1e-9 * (to - from);
        cell.turn = turn_of_cables(robot, from, to, 2);
        for (place, s) in [from + inside, 0.5 * (from + to), to - inside].into_iter().enumerate() {
            let [vv, vu, uu] = section_compliance(robot, s)?;
            let largest = |m: &Mat3| {
                let values = m.symmetric_eigenvalues();
                BETWEEN * values.into_iter().fold(0.0, f64::max).max(0.0).sqrt()
            };
            cell.stretching = cell.stretching.max(largest(&vv));
            cell.bending = cell.bending.max(largest(&uu));
            for (cable, route) in robot.routes().iter().enumerate() {
                if route.end() <= from + inside {
                    continue;
                }
                let point = route.at(s.min(route.end()));
                // A ξ = v + X u with X = −r̂.
                let x = Mat3::skew(-point.offset);
                let mixed = vu * x.transpose();
                let form = vv + mixed + mixed.transpose() + x * uu * x.transpose();
                cell.alpha[cable] = cell.alpha[cable].max(largest(&form));
            }
            let section = Section::of(robot, s, [vv, vu, uu])?;
            section.equilibrium(&vec![0.0; n], &mut at_rest)?;
            let stretches = cell.stretch.iter_mut().zip(&at_rest.stretches);
            stretches.for_each(|(least, at_rest)| *least = least.min(at_rest / BETWEEN));
            cell.sections[place] =
                sections.iter().position(|known| known.is_like(&section)).unwrap_or_else(|| {
                    sections.push(section);
                    sections.len() - 1
                });
        }
        Some(cell)
    }
}

/// Integrals over the first half and the whole of a piece of what is known at its start, in its middle and at its end, by the parabola through them.
fn integrals([start, middle, end]: [Vec3; 3], width: f64) -> [Vec3; 2] {
    [
        (start * 5.0 + middle * 8.0 - end) * (width / 24.0),
        (start + middle * 4.0 + end) * (width / 6.0),
    ]
}

/// Turns from the start of a piece to its middle and its end, to the fourth order of its width: exponentials of Magnus' series.
fn turns(curvatures: [Vec3; 3], width: f64) -> [UnitQuaternion; 2] {
    let [start, middle, end] = curvatures;
    let [half, whole] = integrals(curvatures, width);
    // ½∫∫ of commutators of a line with this mean and slope over a width h: h³/12 mean × slope.
    let in_half = (start * 3.0 + middle * 6.0 - end) * 0.125;
    let by_half = in_half.cross(middle - start) * (width * width / 24.0);
    let by_whole = middle.cross(end - start) * (width * width / 12.0);
    [UnitQuaternion::exp(half + by_half), UnitQuaternion::exp(whole + by_whole)]
}

/// Into how many pieces the backbone between two disks is divided at least.
fn pieces(robot: &Robot, from: f64, to: f64) -> usize {
    /// Places at which the direction of a cable is looked at.
    const PLACES: usize = 64;
    let most = turn_of_cables(robot, from, to, PLACES);
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small number")]
    let pieces = (most / TURN).ceil() as usize;
    let inside = 1e-9 * (to - from);
    let [start, middle, end] =
        [from + inside, 0.5 * (from + to), to - inside].map(|s| CrossedSection::of(robot, s).ok());
    let is_like = |of: Option<CrossedSection>| match (&start, of) {
        (Some(start), Some(of)) => start.is_like(&of),
        _ => false,
    };
    pieces.max(if is_like(middle) && is_like(end) { 1 } else { PIECES })
}

/// The most that the direction of a cable turns about the backbone between two arc lengths, in rad, seen from so many places and the first.
fn turn_of_cables(robot: &Robot, from: f64, to: f64, places: usize) -> f64 {
    let ends = robot.routes().iter().filter(|route| route.end() > from);
    let turned = ends.map(|route| {
        let end = to.min(route.end());
        let at = |k: usize| route.at(from + (end - from) * k as f64 / places as f64).offset;
        let turn = |k: usize| {
            let (a, b) = (at(k), at(k + 1));
            (a.x * b.y - a.y * b.x).atan2(a.dot(b)).abs()
        };
        (0..places).map(turn).sum()
    });
    turned.fold(0.0, f64::max)
}
