//! Bounds of the second derivatives of a point of an unloaded rod by the tensions of its cables.

use whipcord::section::section_compliance;
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
/// where `2/√3` bounds the third derivative of a norm and `ℓₖ ≥ ℓₖ(ξ*) − αₖ Σ τⱼαⱼ`. From the strains the bounds
/// go on to the point by `R′ = R û`, `p′ = R v` (11).
#[derive(Clone, Debug)]
pub(crate) struct CurvatureBound {
    cells: Vec<Cell>,
    cables: usize,
}

/// A piece of the backbone.
#[derive(Clone, Debug)]
struct Cell {
    width: f64,
    /// `√λ_max` of `∂v/∂N` and `∂u/∂M`, which bound strains by their norm in `K`.
    stretching: f64,
    bending: f64,
    /// `αᵢ` of each cable, 0 behind its end, and its stretch at rest.
    alpha: Vec<f64>,
    stretch: Vec<f64>,
}

/// Pieces of the backbone between two disks, at whose ends and middle the sections are looked at.
const PIECES: usize = 4;
/// What a section may be worse between the places that are looked at.
const BETWEEN: f64 = 1.02;
/// A cable whose stretch may get smaller than this has no bound.
const LEAST_STRETCH: f64 = 0.1;

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
        let cells = places
            .windows(2)
            .map(|pair| Cell::of(robot, pair[0], pair[1]))
            .collect::<Option<_>>()?;
        Some(Self { cells, cables: robot.cables().len() })
    }

    /// Writes a bound of `‖∂ᵢ∂ⱼp‖` in m/N², by rows, for all tensions up to these; `false` where there is none.
    pub fn second_derivatives(&self, greatest: &[f64], into: &mut Vec<f64>) -> bool {
        let n = self.cables;
        into.clear();
        into.resize(n * n, 0.0);
        // Of the rotation: ‖∂ᵢR‖ and ‖∂ᵢ∂ⱼR‖ as angles, at the beginning of a cell.
        let mut first = vec![0.0; n];
        let mut second = vec![0.0; n * n];
        let mut rates = vec![0.0; n * n];
        for cell in &self.cells {
            let change: f64 = greatest.iter().zip(&cell.alpha).map(|(t, a)| t * a).sum();
            let stretch: Vec<f64> =
                cell.alpha.iter().zip(&cell.stretch).map(|(a, l)| l - a * change).collect();
            if stretch.iter().zip(&cell.alpha).any(|(l, a)| *a > 0.0 && *l < LEAST_STRETCH) {
                return false;
            }
            let third: f64 = (0..n)
                .map(|k| greatest[k] * cell.alpha[k].powi(3) / stretch[k].powi(2))
                .filter(|term| term.is_finite())
                .sum();
            let third = 2.0 / 3.0_f64.sqrt() * third;
            let h = cell.width;
            let longest = 1.0 + cell.stretching * change;
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
    /// Between two arc lengths.
    fn of(robot: &Robot, from: f64, to: f64) -> Option<Self> {
        let n = robot.cables().len();
        let mut cell = Self {
            width: to - from,
            stretching: 0.0,
            bending: 0.0,
            alpha: vec![0.0; n],
            stretch: vec![f64::INFINITY; n],
        };
        let inside = 1e-9 * (to - from);
        for s in [from + inside, 0.5 * (from + to), to - inside] {
            let [vv, vu, uu] = section_compliance(robot, s)?;
            let largest = |m: &Mat3| {
                let values = m.symmetric_eigenvalues();
                BETWEEN * values.into_iter().fold(0.0, f64::max).max(0.0).sqrt()
            };
            cell.stretching = cell.stretching.max(largest(&vv));
            cell.bending = cell.bending.max(largest(&uu));
            let rest = robot.backbone().rest_curvature_at(robot.disks(), s);
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
                let stretch = (Vec3::Z + rest.cross(point.offset) + point.slope).norm() / BETWEEN;
                cell.stretch[cable] = cell.stretch[cable].min(stretch);
            }
        }
        Some(cell)
    }
}

fn skew(r: Vec3) -> Mat3 {
    Mat3 { rows: [Vec3::new(0.0, -r.z, r.y), Vec3::new(r.z, 0.0, -r.x), Vec3::new(-r.y, r.x, 0.0)] }
}
