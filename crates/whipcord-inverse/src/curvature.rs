//! Bounds of the second derivatives of a point of an unloaded rod by the tensions of its cables.

use whipcord::section::{CrossedSection, section_compliance};
use whipcord::{Mat3, Robot, Vec3};

/// What bounds the second derivatives of one point of the backbone of a robot without loads and friction.
///
/// A section minimises `½‖ξ − ξ*‖²_K + Σ τᵢ ℓᵢ(ξ)` over its strains `ξ = (v, u)`, with the stretch `ℓᵢ = ‖Aᵢξ + rᵢ′‖` of cable i
/// and `Aᵢξ = v + u × rᵢ`. Because `ℓᵢ` is convex, the Hessian is at least `K`, and with `αᵢ² = λ_max(Aᵢ K⁻¹ Aᵢᵀ)`
///
/// ```text
/// ‖∂ᵢξ‖_K ≤ αᵢ                                                        (9)
/// ‖∂ᵢ∂ⱼξ‖_K ≤ αᵢαⱼ (αᵢ/ℓᵢ + αⱼ/ℓⱼ + (2/√3) Σ τₖ αₖ³/ℓₖ²)           (10)
/// ```
///
/// where `2/√3` bounds the third derivative of a norm. It is `ℓₖ ≥ ℓₖ(ξ*) − αₖ Σ τⱼαⱼ`, and over a box of half widths `h`
/// about `τ₀` also `ℓₖ ≥ ℓₖ(τ₀) − αₖ Σ hⱼαⱼ`, for which its sections are solved: that is done where the first is not enough. From the strains the bounds
/// go on to the point by `R′ = R û`, `p′ = R v` (11).
#[derive(Clone, Debug)]
pub(crate) struct CurvatureBound {
    cells: Vec<Cell>,
    /// The sections that are looked at, those that are alike once.
    sections: Vec<CrossedSection>,
    cables: usize,
}

/// A box of tensions in N.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TensionBox<'a> {
    pub center: &'a [f64],
    pub half: &'a [f64],
}

/// Memory of [`CurvatureBound::second_derivatives`].
#[derive(Clone, Debug, Default)]
pub(crate) struct Memory {
    greatest: Vec<f64>,
    /// Of each section in the middle of the box: the stretch of each cable, and `‖v‖`.
    stretches: Vec<f64>,
    velocities: Vec<f64>,
    stretch: Vec<f64>,
    /// Of the rotation at the beginning of a cell: `‖∂ᵢR‖` and `‖∂ᵢ∂ⱼR‖` as angles.
    first: Vec<f64>,
    second: Vec<f64>,
    rates: Vec<f64>,
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

/// Pieces of the backbone between two disks, at whose ends and middle the sections are looked at.
const PIECES: usize = 4;
/// What a section may be worse between the places that are looked at.
const BETWEEN: f64 = 1.02;
/// A cable whose stretch may get smaller than this has no bound.
const LEAST_STRETCH: f64 = 0.1;
/// Above this a stretch that is bounded from rest is near enough.
const GOOD_STRETCH: f64 = 0.5;

impl CurvatureBound {
    /// Of the point of the backbone at an arc length; `None` for a robot without stiffness.
    pub fn of(robot: &Robot, arc_length: f64) -> Option<Self> {
        let mut places = vec![0.0];
        for pair in robot.disks().arc_lengths.windows(2) {
            for piece in 1..=PIECES {
                let at = pair[0] + (pair[1] - pair[0]) * piece as f64 / PIECES as f64;
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

    /// How much a change of the tension of each cable by 1 N can bend the robot.
    pub fn bending(&self, cable: usize) -> f64 {
        self.cells.iter().map(|cell| cell.width * cell.bending * cell.alpha[cable]).sum()
    }

    /// Writes a bound of `‖∂ᵢ∂ⱼp‖` in m/N², by rows, for all tensions of a box; `false` where there is none.
    pub fn second_derivatives(
        &self,
        of: TensionBox<'_>,
        memory: &mut Memory,
        into: &mut Vec<f64>,
    ) -> bool {
        let n = self.cables;
        let TensionBox { center, half } = of;
        let Memory { greatest, stretches, velocities, stretch, first, second, rates } = memory;
        greatest.clear();
        greatest.extend(center.iter().zip(half).map(|(c, h)| c + h));
        let from_rest = self.cells.iter().all(|cell| {
            let change = cell.change(greatest);
            let stretches = cell.stretch.iter().zip(&cell.alpha);
            stretches.fold(f64::INFINITY, |least, (l, a)| least.min(l - a * change)) >= GOOD_STRETCH
        });
        if !from_rest {
            stretches.clear();
            stretches.resize(n * self.sections.len(), f64::INFINITY);
            velocities.clear();
            for (section, stretches) in self.sections.iter().zip(stretches.chunks_exact_mut(n)) {
                let Some(velocity) = section.stretches(center, stretches) else { return false };
                velocities.push(velocity);
            }
        }
        let squares = [&mut *into, &mut *second, &mut *rates].map(|list| (list, n * n));
        for (list, size) in squares.into_iter().chain([(&mut *first, n)]) {
            list.clear();
            list.resize(size, 0.0);
        }
        for cell in &self.cells {
            let change = cell.change(if from_rest { greatest } else { half });
            stretch.clear();
            let fastest = if from_rest {
                stretch.extend_from_slice(&cell.stretch);
                1.0
            } else {
                stretch.extend((0..n).map(|k| {
                    let least = cell.sections.map(|at| stretches[n * at + k]);
                    least.into_iter().fold(f64::INFINITY, f64::min) / BETWEEN
                }));
                let fastest = cell.sections.map(|at| velocities[at]);
                BETWEEN * fastest.into_iter().fold(0.0, f64::max)
            };
            stretch.iter_mut().zip(&cell.alpha).for_each(|(l, a)| *l -= a * change);
            if stretch.iter().zip(&cell.alpha).any(|(l, a)| *a > 0.0 && *l < LEAST_STRETCH) {
                return false;
            }
            let third: f64 = (0..n)
                .map(|k| greatest[k] * cell.alpha[k].powi(3) / stretch[k].powi(2))
                .filter(|term| term.is_finite())
                .sum();
            let third = 2.0 / 3.0_f64.sqrt() * third;
            let h = cell.width;
            let longest = fastest + cell.stretching * change;
            for i in 0..n {
                let (ai, li) = (cell.alpha[i], stretch[i]);
                for j in 0..n {
                    let (aj, lj) = (cell.alpha[j], stretch[j]);
                    rates[i * n + j] =
                        if ai * aj == 0.0 { 0.0 } else { ai * aj * (ai / li + aj / lj + third) };
                }
            }
            // At the end of the cell, which is the greatest.
            for i in 0..n {
                first[i] += cell.bending * cell.alpha[i] * h;
            }
            for i in 0..n {
                for j in 0..n {
                    let turning = (first[j] * cell.alpha[i]).min(first[i] * cell.alpha[j]);
                    second[i * n + j] += h * cell.bending * (turning + rates[i * n + j]);
                }
            }
            for i in 0..n {
                for j in 0..n {
                    let stretching = cell.stretching
                        * (first[i] * cell.alpha[j] + first[j] * cell.alpha[i] + rates[i * n + j]);
                    let turning = (second[i * n + j] + first[i] * first[j]) * longest;
                    into[i * n + j] += h * (turning + stretching);
                }
            }
        }
        true
    }
}

impl Cell {
    /// How much the strains can change in the norm of `K` with changes of the tensions up to these in N.
    fn change(&self, tensions: &[f64]) -> f64 {
        tensions.iter().zip(&self.alpha).map(|(t, a)| t * a).sum()
    }

    /// Between two arc lengths; its sections are those of the list, or are added to it.
    fn of(robot: &Robot, from: f64, to: f64, sections: &mut Vec<CrossedSection>) -> Option<Self> {
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
            let section = CrossedSection::of(robot, s).ok()?;
            let mut at_rest = vec![f64::INFINITY; n];
            section.stretches(&vec![0.0; n], &mut at_rest)?;
            let stretches = cell.stretch.iter_mut().zip(&at_rest);
            stretches.for_each(|(least, at_rest)| *least = least.min(at_rest / BETWEEN));
            cell.sections[place] =
                sections.iter().position(|known| *known == section).unwrap_or_else(|| {
                    sections.push(section);
                    sections.len() - 1
                });
        }
        Some(cell)
    }
}

fn skew(r: Vec3) -> Mat3 {
    Mat3 { rows: [Vec3::new(0.0, -r.z, r.y), Vec3::new(r.z, 0.0, -r.x), Vec3::new(-r.y, r.x, 0.0)] }
}
