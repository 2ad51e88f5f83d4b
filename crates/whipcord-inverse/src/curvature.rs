//! Bounds of the second derivatives of a point of an unloaded rod by the tensions of its cables.

use whipcord::section::{CrossedSection, section_compliance};
use whipcord::{Mat3, Robot, Vec3};

/// What bounds the second derivatives of one point of the backbone of a robot without loads and friction.
///
/// A section minimises `½‖ξ − ξ*‖²_K + Σ τᵢ ℓᵢ(ξ)` over its strains `ξ = (v, u)`, with the stretch `ℓᵢ = ‖Aᵢξ + rᵢ′‖` of cable i,
/// `Aᵢξ = v + u × rᵢ`, and its unit tangent `tᵢ`. Because `ℓᵢ` is convex, the Hessian is at least `K`, and with `αᵢ² = λ_max(Aᵢ K⁻¹ Aᵢᵀ)`
/// the strains change along any change `δ` of the tensions, `|δᵢ| ≤ hᵢ`, by
///
/// ```text
/// ‖∂_δ ξ‖_K ≤ ‖Σ δᵢ Aᵢᵀ tᵢ‖_{K⁻¹} ≤ β                                  (9)
/// ‖∂_δ² ξ‖_K ≤ 2β Σ hᵢ αᵢ²/ℓᵢ + (2/√3) β² Σ τᵢ αᵢ³/ℓᵢ²                 (10)
/// ```
///
/// where `2/√3` bounds the third derivative of a norm. `β` is no more than `η = Σ hᵢαᵢ`. Cables that pull against one another hardly bend the robot: with the tangents `tᵢ⁰` in the
/// middle of the box, from which `tᵢ` differs by no more than `αᵢβ/ℓᵢ`, it is no more than the greatest `‖Σ δᵢ Aᵢᵀ tᵢ⁰‖_{K⁻¹}` at its corners over `1 − Σ hᵢαᵢ²/ℓᵢ`.
///
/// It is `ℓₖ ≥ ℓₖ(ξ*) − αₖ Σ τⱼαⱼ`, and over the box `ℓₖ ≥ ℓₖ(τ₀) − αₖη`. From the strains the bounds go on to the point by `R′ = R û`, `p′ = R v` (11).
#[derive(Clone, Debug)]
pub(crate) struct CurvatureBound {
    cells: Vec<Cell>,
    /// The sections that are looked at, those that are alike once.
    sections: Vec<Section>,
    cables: usize,
}

/// Tensions in N: those in the middle, and all that differ from them by the sum of a part between -1 and 1 of each edge.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TensionBox<'a> {
    pub center: &'a [f64],
    /// How much each tension differs at most.
    pub half: &'a [f64],
    /// The tensions of each edge, one after the other.
    pub edges: &'a [f64],
}

/// Memory of [`CurvatureBound::second_derivative`].
#[derive(Clone, Debug, Default)]
pub(crate) struct Memory {
    greatest: Vec<f64>,
    /// Of each section in the middle of the box: the stretch of each cable, `‖v‖`, and the greatest `‖Σ ±hᵢ Aᵢᵀ tᵢ‖_{K⁻¹}`.
    stretches: Vec<f64>,
    velocities: Vec<f64>,
    changes: Vec<f64>,
    stretch: Vec<f64>,
    pulls: Vec<[Vec3; 2]>,
    /// Of each edge.
    sums: Vec<[Vec3; 2]>,
}

/// A section with the cables that cross it.
#[derive(Clone, Debug)]
struct Section {
    crossed: CrossedSection,
    /// `∂v/∂N`, `∂v/∂M` and `∂u/∂M`.
    compliance: [Mat3; 3],
}

/// A piece of the backbone.
#[derive(Clone, Debug)]
struct Cell {
    width: f64,
    /// `√λ_max` of `∂v/∂N` and `∂u/∂M`, which bound strains by their norm in `K`.
    stretching: f64,
    bending: f64,
    /// `αᵢ` of each cable, 0 behind its end.
    alpha: Vec<f64>,
    /// Stretch of each cable at rest.
    stretch: Vec<f64>,
    /// The sections at its ends and in its middle.
    sections: [usize; 3],
}

/// Pieces of the backbone between two disks, at whose ends and middle the sections are looked at: so many, and where a cable turns about the backbone so many that
/// it turns by no more than [`TURN`] along one.
const PIECES: usize = 2;
/// In rad.
const TURN: f64 = 0.35;
/// What a section may be worse between the places that are looked at.
const BETWEEN: f64 = 1.02;
/// A cable whose stretch may get smaller than this has no bound.
const LEAST_STRETCH: f64 = 0.1;
/// The corners of a box of more tensions are too many to look at.
const MOST_CORNERS: usize = 8;

impl CurvatureBound {
    /// Of the point of the backbone at an arc length; `None` for a robot without stiffness.
    pub fn of(robot: &Robot, arc_length: f64) -> Option<Self> {
        let mut places = vec![0.0];
        for pair in robot.disks().arc_lengths.windows(2) {
            let pieces = pieces(robot, pair[0], pair[1]);
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

    /// How far from the base the point can be, in m, for all tensions up to these.
    pub fn farthest(&self, greatest: &[f64]) -> f64 {
        let of = |cell: &Cell| cell.width * (1.0 + cell.stretching * cell.change(greatest));
        self.cells.iter().map(of).sum()
    }

    /// How much these tensions bend the robot at rest, in rad, and what they add to its stiffness.
    pub fn bending(&self, tensions: &[f64]) -> f64 {
        let n = self.cables;
        let none = vec![0.0; n];
        let turned = |section: &Section| {
            let (mut stretches, mut pulls) = (vec![f64::INFINITY; n], vec![[Vec3::ZERO; 2]; n]);
            section.crossed.pulls(&none, &mut stretches, &mut pulls)?;
            let [force, moment] = exerted(tensions, &pulls);
            let [_, vu, uu] = section.compliance;
            Some((vu.transpose_mul(force) + uu * moment).norm())
        };
        let turned: Vec<f64> = self.sections.iter().map(|of| turned(of).unwrap_or(0.0)).collect();
        let of = |cell: &Cell| cell.width * turned[cell.sections[1]];
        let stiffened = |cell: &Cell| -> f64 {
            tensions.iter().zip(&cell.alpha).map(|(t, a)| t.abs() * a * a).sum()
        };
        let most = self.cells.iter().map(stiffened).fold(0.0, f64::max);
        self.cells.iter().map(of).sum::<f64>() + most
    }

    /// A bound of `‖∂_δ² p‖` in m for all tensions of a box and all changes `δ` from its middle to another of its points; `None` where there is none.
    pub fn second_derivative(&self, of: TensionBox<'_>, memory: &mut Memory) -> Option<f64> {
        let n = self.cables;
        let TensionBox { center, half, edges } = of;
        let Memory { greatest, stretches, velocities, changes, stretch, pulls, sums } = memory;
        greatest.clear();
        greatest.extend(center.iter().zip(half).map(|(c, h)| c + h));
        stretches.clear();
        stretches.resize(n * self.sections.len(), f64::INFINITY);
        velocities.clear();
        changes.clear();
        for (section, stretches) in self.sections.iter().zip(stretches.chunks_exact_mut(n)) {
            pulls.clear();
            pulls.resize(n, [Vec3::ZERO; 2]);
            velocities.push(section.crossed.pulls(center, stretches, pulls)?);
            changes.push(section.greatest_change(edges, pulls, sums));
        }
        let (mut first, mut second, mut whole) = (0.0, 0.0, 0.0);
        for cell in &self.cells {
            // `η`
            let change = cell.change(half);
            let change_from_rest = cell.change(greatest);
            stretch.clear();
            stretch.extend((0..n).map(|k| {
                let at = cell.sections.map(|at| stretches[n * at + k]);
                let in_middle = at.into_iter().fold(f64::INFINITY, f64::min) / BETWEEN;
                let from_rest = cell.stretch[k] - cell.alpha[k] * change_from_rest;
                (in_middle - cell.alpha[k] * change).max(from_rest)
            }));
            if stretch.iter().zip(&cell.alpha).any(|(l, a)| *a > 0.0 && *l < LEAST_STRETCH) {
                return None;
            }
            let fastest = cell.sections.map(|at| velocities[at]).into_iter().fold(0.0, f64::max);
            let longest = BETWEEN * fastest + cell.stretching * change;
            let sum = |term: &dyn Fn(usize) -> f64| -> f64 {
                (0..n).filter(|&k| cell.alpha[k] > 0.0).map(term).sum()
            };
            let turning = sum(&|k| half[k] * cell.alpha[k].powi(2) / stretch[k]);
            let third = sum(&|k| greatest[k] * cell.alpha[k].powi(3) / stretch[k].powi(2));
            let together = cell.sections.map(|at| changes[at]).into_iter().fold(0.0, f64::max);
            // `β`
            let own = BETWEEN * together / (1.0 - turning);
            let along = if turning < 1.0 { change.min(own) } else { change };
            let rate = 2.0 * along * turning + 2.0 / 3.0_f64.sqrt() * along * along * third;
            let h = cell.width;
            // At the end of the cell, which is the greatest.
            first += h * cell.bending * along;
            second += h * cell.bending * (first * along + rate);
            whole += h * longest * (second + first * first);
            whole += h * cell.stretching * (2.0 * first * along + rate);
        }
        Some(whole)
    }
}

impl Section {
    fn of(robot: &Robot, arc_length: f64, compliance: [Mat3; 3]) -> Option<Self> {
        let crossed = CrossedSection::of(robot, arc_length).ok()?;
        Some(Self { crossed, compliance })
    }

    /// Whether it is another one, but for far less than [`BETWEEN`].
    fn is_like(&self, other: &Self) -> bool {
        self.crossed.is_like(&other.crossed)
    }

    /// The greatest `‖Σ δᵢ Aᵢᵀ tᵢ‖_{K⁻¹}` of all changes of the tensions by parts of edges, for what each cable exerts under 1 N. It is at a corner.
    fn greatest_change(
        &self,
        edges: &[f64],
        pulls: &[[Vec3; 2]],
        sums: &mut Vec<[Vec3; 2]>,
    ) -> f64 {
        let n = pulls.len();
        if n == 0 || n > MOST_CORNERS {
            return f64::INFINITY;
        }
        let [vv, vu, uu] = self.compliance;
        sums.clear();
        sums.extend(edges.chunks_exact(n).map(|edge| exerted(edge, pulls)));
        // Opposite corners are alike.
        let corner = |signs: u32| {
            let sign = |k: usize| if signs >> k & 1 == 1 { -1.0 } else { 1.0 };
            let each = sums.iter().enumerate();
            let [force, moment] = each.fold([Vec3::ZERO; 2], |[force, moment], (k, of)| {
                [force + of[0] * sign(k), moment + of[1] * sign(k)]
            });
            force.dot(vv * force) + 2.0 * force.dot(vu * moment) + moment.dot(uu * moment)
        };
        (0..1 << (n - 1)).map(corner).fold(0.0, f64::max).sqrt()
    }
}

/// What tensions exert, for what each cable exerts under 1 N.
fn exerted(tensions: &[f64], pulls: &[[Vec3; 2]]) -> [Vec3; 2] {
    let each = tensions.iter().zip(pulls).filter(|(tension, _)| **tension != 0.0);
    each.fold([Vec3::ZERO; 2], |[force, moment], (tension, pull)| {
        [force + pull[0] * *tension, moment + pull[1] * *tension]
    })
}

impl Cell {
    /// How much the strains can change in the norm of `K` with changes of the tensions up to these in N.
    fn change(&self, tensions: &[f64]) -> f64 {
        tensions.iter().zip(&self.alpha).map(|(t, a)| t * a).sum()
    }

    /// Between two arc lengths; its sections are those of the list, or are added to it.
    fn of(robot: &Robot, from: f64, to: f64, sections: &mut Vec<Section>) -> Option<Self> {
        let n = robot.cables().len();
        let mut cell = Self {
            width: to - from,
            stretching: 0.0,
            bending: 0.0,
            alpha: vec![0.0; n],
            stretch: vec![f64::INFINITY; n],
            sections: [0; 3],
        };
        let inside = 1e-9 * (to - from);
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
                let x = -skew(point.offset);
                let mixed = vu * x.transpose();
                let form = vv + mixed + mixed.transpose() + x * uu * x.transpose();
                cell.alpha[cable] = cell.alpha[cable].max(largest(&form));
            }
            let section = Section::of(robot, s, [vv, vu, uu])?;
            let (mut at_rest, mut pulls) = (vec![f64::INFINITY; n], vec![[Vec3::ZERO; 2]; n]);
            section.crossed.pulls(&vec![0.0; n], &mut at_rest, &mut pulls)?;
            let stretches = cell.stretch.iter_mut().zip(&at_rest);
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

/// Into how many pieces the backbone between two disks is divided.
fn pieces(robot: &Robot, from: f64, to: f64) -> usize {
    /// Places at which the direction of a cable is looked at.
    const PLACES: usize = 64;
    let ends = robot.routes().iter().filter(|route| route.end() > from);
    let turned = ends.map(|route| {
        let end = to.min(route.end());
        let at = |k: usize| route.at(from + (end - from) * k as f64 / PLACES as f64).offset;
        let turn = |k: usize| {
            let (a, b) = (at(k), at(k + 1));
            (a.x * b.y - a.y * b.x).atan2(a.dot(b)).abs()
        };
        (0..PLACES).map(turn).sum()
    });
    let most = turned.fold(0.0, f64::max);
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small number")]
    let pieces = (most / TURN).ceil() as usize;
    pieces.max(PIECES)
}

fn skew(r: Vec3) -> Mat3 {
    Mat3 { rows: [Vec3::new(0.0, -r.z, r.y), Vec3::new(r.z, 0.0, -r.x), Vec3::new(-r.y, r.x, 0.0)] }
}
