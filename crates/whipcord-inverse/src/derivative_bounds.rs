//! Bounds of the second and third derivatives of a point of an unloaded rod by the tensions of its cables.

use whipcord::{Robot, Vec3};

use crate::corners::{greatest_product, greatest_sum};
use crate::rod_cells::{BETWEEN, Cell, Rod, State};
use crate::rod_sections::{Equilibrium, Pair, Section};

/// What bounds the derivatives of one point of the backbone of a robot without loads and friction.
///
/// The Hessian of the potential of a section is at least `K`, because each stretch `ℓᵢ` is convex, and with `αᵢ² = λ_max(Aᵢ K⁻¹ Aᵢᵀ)`
/// the strains change along any change `δ` of the tensions, `|δᵢ| ≤ hᵢ`, by
///
/// ```text
/// ‖∂_δ ξ‖_K ≤ ‖Σ δᵢ Aᵢᵀ tᵢ‖_{K⁻¹} ≤ β₁                                                 (9)
/// ‖∂_δ² ξ‖_K ≤ β₂ = 2 β₁ Σ hᵢαᵢ²/ℓᵢ + (2/√3) β₁² Σ τᵢαᵢ³/ℓᵢ²                            (10)
/// ‖∂_δ³ ξ‖_K ≤ β₃ = 3 β₂ Σ hᵢαᵢ²/ℓᵢ + 2√3 β₁² Σ hᵢαᵢ³/ℓᵢ² + 2√3 β₁β₂ Σ τᵢαᵢ³/ℓᵢ² + 3 β₁³ Σ τᵢαᵢ⁴/ℓᵢ³
/// ```
///
/// where `2/√3` and 3 bound the third and the fourth derivative of a norm. `β₁` is no more than `η = Σ hᵢαᵢ`. Cables that pull against one another hardly bend the robot: with the tangents `tᵢ⁰` in the
/// middle of the box, from which `tᵢ` differs by no more than `αᵢβ₁/ℓᵢ`, it is no more than the greatest `‖Σ δᵢ Aᵢᵀ tᵢ⁰‖_{K⁻¹}` at its corners over `1 − Σ hᵢαᵢ²/ℓᵢ`, and no more than that at its corners and `β₂`.
///
/// A cable resists only what turns it, and it hardly turns against the sections of a robot that bends: `qᵢ`, the greatest `‖Pᵢ Aᵢ ∂_δξ‖`, is no more than in the middle of the box and what it changes by,
/// and with it the derivatives of the stretches are bounded by
///
/// ```text
/// qᵢ ≤ qᵢ⁰ + αᵢβ₂ + 2 qᵢαᵢβ₁/ℓᵢ                                                          (10a)
/// β₂ = Σ αᵢ/ℓᵢ (2 hᵢqᵢ + τᵢ (2 αᵢβ₁ + qᵢ) qᵢ/ℓᵢ)
/// β₃ = 3 Σ αᵢ/ℓᵢ (hᵢαᵢβ₂ + (hᵢ (2 αᵢβ₁ + qᵢ) qᵢ + τᵢ (αᵢβ₁ + 2 qᵢ) αᵢβ₂)/ℓᵢ + τᵢ (2 αᵢ²β₁² + 2 αᵢβ₁qᵢ + qᵢ²) qᵢ/ℓᵢ²)
/// ```
///
/// It is `ℓₖ ≥ ℓₖ(ξ*) − αₖ Σ τⱼαⱼ`, and over the box `ℓₖ ≥ ℓₖ(τ₀) − αₖη`. From the strains the bounds go on to the point by (11a) and its derivative. The rotation
/// `Ω` along `δ` is no more than the greatest in the middle of the box and the bound of its derivative, and this is no more than the greatest in the middle and the bound of the second. All that is added to what is known in the middle
/// counts by the part `t` of the way from there to the side of the box.
#[derive(Clone, Debug)]
pub(crate) struct DerivativeBounds {
    pub rod: Rod,
    /// Its sections without tensions.
    at_rest: Vec<Equilibrium>,
}

/// Tensions in N: those in the middle, and all that differ from them by the sum of a part of each edge.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TensionBox<'a> {
    pub center: &'a [f64],
    /// The tensions of each edge, one after the other.
    pub edges: &'a [f64],
    /// The greatest part of each edge.
    pub half: &'a [f64],
}

/// Bounds of `‖∂_δ² p‖` and `‖∂_δ³ p‖` in m for all changes `δ` from the middle of a box to another of its points.
#[derive(Clone, Copy, Debug)]
struct OfPoint {
    second: f64,
    third: f64,
}

/// Memory of [`DerivativeBounds::remainders`].
#[derive(Clone, Debug, Default)]
pub(crate) struct Memory {
    greatest: Vec<f64>,
    most: Vec<f64>,
    /// Of each section the greatest `‖Σ ±hᵢ Aᵢᵀ tᵢ‖_{K⁻¹}` in the middle of the box.
    changes: Vec<f64>,
    /// Of each cable in each section the greatest `‖Pᵢ Aᵢ ∂_δξ‖` there.
    turns: Vec<f64>,
    /// Of each cable in a cell: `qᵢ` and `ℓᵢ`.
    turned: Vec<f64>,
    stretch: Vec<f64>,
    /// `αᵢ/ℓᵢ`
    parts: Vec<f64>,
    /// Of each cell the greatest `‖Ω‖` in the middle of the box at its three places.
    spins: Vec<[f64; 3]>,
    /// Likewise `‖∂Ω‖` at its end.
    rates: Vec<f64>,
    scaled: Vec<Pair>,
    vectors: Vec<[Vec3; 1]>,
    products: Vec<Vec3>,
    sums: Vec<Vec3>,
}

/// The `t` at which derivatives along a box are bounded.
const PARTS: [f64; 3] = [0.3, 0.6, 1.0];
/// So often the bounds of the strains of a cell are made from one another.
const REFINEMENTS: usize = 4;
/// A cable whose stretch may get smaller than this has no bound.
const LEAST_STRETCH: f64 = 0.1;

impl DerivativeBounds {
    /// Of the point of the backbone at an arc length, with so many times the pieces that it takes at least; `None` for a robot without stiffness.
    pub fn of(robot: &Robot, arc_length: f64, times: usize) -> Option<Self> {
        let rod = Rod::of(robot, arc_length, times)?;
        let none = vec![0.0; rod.cables];
        let equilibrium = |section: &Section| {
            let mut at_rest = Equilibrium::default();
            section.equilibrium(&none, &mut at_rest)?;
            Some(at_rest)
        };
        let at_rest = rod.sections.iter().map(equilibrium).collect::<Option<_>>()?;
        Some(Self { rod, at_rest })
    }

    /// How far from the base the point can be, in m, for all tensions up to these.
    pub fn farthest(&self, greatest: &[f64]) -> f64 {
        let of = |cell: &Cell| cell.width * (1.0 + cell.stretching * cell.change(greatest));
        self.rod.cells.iter().map(of).sum()
    }

    /// How finely a change by these tensions is to be divided: how much it bends the robot at rest, in rad, and twice what it adds to the stiffness of a section, with which
    /// proofs of six cables take the fewest boxes.
    pub fn weight(&self, tensions: &[f64]) -> f64 {
        let Rod { cells, sections, .. } = &self.rod;
        let states = sections.iter().zip(&self.at_rest);
        let turned: Vec<f64> =
            states.map(|(section, at_rest)| section.bending(tensions, at_rest)).collect();
        let of = |cell: &Cell| cell.width * turned[cell.sections[1]];
        let stiffened = |cell: &Cell| -> f64 {
            tensions.iter().zip(&cell.alpha).map(|(t, a)| t.abs() * a * a).sum()
        };
        let most = cells.iter().map(stiffened).fold(0.0, f64::max);
        cells.iter().map(of).sum::<f64>() + 2.0 * most
    }

    /// Bounds of what polynomials of the point of first and of second degree leave within a box, with the state in its middle; `None` where there are none.
    ///
    /// Taylor's formula has the derivatives at `τ₀ + t δ`, `0 ≤ t ≤ 1`, and most of those near the middle: they are bounded for a few `t`, and those between by those of the next.
    pub fn remainders(
        &self,
        of: TensionBox<'_>,
        state: &State,
        memory: &mut Memory,
    ) -> Option<[f64; 2]> {
        self.look_at_middle(of, state, memory);
        let mut remainders = [0.0; 2];
        let mut from = 0.0_f64;
        for to in PARTS {
            let OfPoint { second, third } = self.of_point(to, of.center, state, memory)?;
            remainders[0] += second / 2.0 * ((1.0 - from).powi(2) - (1.0 - to).powi(2));
            remainders[1] += third / 6.0 * ((1.0 - from).powi(3) - (1.0 - to).powi(3));
            from = to;
        }
        Some(remainders)
    }

    /// How far the greatest changes of a box go in its middle.
    fn look_at_middle(&self, of: TensionBox<'_>, state: &State, memory: &mut Memory) {
        let Rod { cells, sections, cables: n } = &self.rod;
        let n = *n;
        let TensionBox { edges, half, .. } = of;
        let Memory { most, changes, turns, spins, rates, scaled, vectors, products, sums, .. } =
            memory;
        most.clear();
        most.resize(n, 0.0);
        for (edge, half) in edges.chunks_exact(n.max(1)).zip(half) {
            most.iter_mut().zip(edge).for_each(|(most, of)| *most += (of * half).abs());
        }
        changes.clear();
        turns.clear();
        turns.resize(n * sections.len(), 0.0);
        let states = sections.iter().zip(&state.equilibria);
        for ((section, at), turns) in states.zip(turns.chunks_exact_mut(n.max(1))) {
            changes.push(section.greatest_change(at, edges, half, scaled));
            section.greatest_turns(at, half, vectors, turns);
        }
        let places = |cell: usize| state.spins(cell).map(|of| greatest_turn(of, half, vectors));
        spins.clear();
        spins.extend((0..cells.len()).map(places));
        rates.clear();
        rates.extend((0..cells.len()).map(|cell| {
            products.clear();
            let each = half.iter().flat_map(|a| half.iter().map(move |b| a * b));
            products.extend(state.spin_rates(cell).iter().zip(each).map(|(of, by)| *of * by));
            greatest_product(products, half.len(), sums)
        }));
    }

    /// Bounds of the derivatives at all `τ₀ + s t δ` with `|s| ≤ 1`.
    fn of_point(
        &self,
        t: f64,
        center: &[f64],
        state: &State,
        memory: &mut Memory,
    ) -> Option<OfPoint> {
        memory.greatest.clear();
        let greatest = center.iter().zip(&memory.most).map(|(c, h)| c + t * h);
        memory.greatest.extend(greatest);
        // ‖Ω‖, ‖∂Ω‖ and ‖∂²Ω‖ at the end of a cell.
        let [mut turn, mut turn_2, mut turn_3] = [0.0; 3];
        let (mut second, mut third) = (0.0, 0.0);
        for (number, cell) in self.rod.cells.iter().enumerate() {
            let at = cell.sections.map(|section| &state.equilibria[section]);
            // `η`
            let change = cell.change(&memory.most);
            let [b1, b2, b3] = self.strains(t, cell, change, at, memory)?;
            let bent = cell.width * cell.bending;
            // In the middle of the box at the three places of the cell, none of which is farther from another place than a quarter.
            let spins = memory.spins[number].map(|of| BETWEEN * of);
            let in_middle = spins.into_iter().fold(0.0, f64::max) + 0.25 * bent * b1;
            let far = turn + bent * b1;
            let mut w1 = far;
            if t * bent * b1 < 1.0 {
                w1 = w1.min((in_middle + t * (turn_2 + bent * b2)) / (1.0 - t * bent * b1));
            }
            // Means over the cell of powers of ‖Ω‖, which grows no faster than along a line; and of ‖∂Ω‖ and ‖∂²Ω‖, whose bounds are convex.
            let first = w1.min(0.5 * (turn + far));
            let squared = (w1 * w1).min((turn * turn + turn * far + far * far) / 3.0);
            let cubed = w1.powi(3).min(0.25 * (turn + far) * (turn * turn + far * far));
            let w2 = turn_2 + bent * (first * b1 + b2);
            let mean_2 = 0.5 * (turn_2 + w2);
            let w3 = turn_3 + bent * ((mean_2 + squared) * b1 + 2.0 * first * b2 + b3);
            let mean_3 = 0.5 * (turn_3 + w3);
            let fastest = at.map(|of| of.strain[0].norm()).into_iter().fold(0.0, f64::max);
            let longest = cell.width * (BETWEEN * fastest + t * cell.stretching * change);
            let stretched = cell.width * cell.stretching;
            second += longest * (mean_2 + squared) + stretched * (2.0 * first * b1 + b2);
            third += longest * (mean_3 + 3.0 * mean_2 * w1 + cubed)
                + stretched * (3.0 * ((mean_2 + squared) * b1 + first * b2) + b3);
            turn_2 = w2.min(BETWEEN * memory.rates[number] + t * w3);
            turn = far.min(spins[2] + t * turn_2);
            turn_3 = w3;
        }
        Some(OfPoint { second, third })
    }

    /// `β₁`, `β₂` and `β₃` of a cell; `None` where a cable may get too short.
    fn strains(
        &self,
        t: f64,
        cell: &Cell,
        change: f64,
        at: [&Equilibrium; 3],
        memory: &mut Memory,
    ) -> Option<[f64; 3]> {
        let Memory { greatest, most, changes, turns, turned, stretch, parts, .. } = memory;
        let n = self.rod.cables;
        let change_from_rest = cell.change(greatest);
        stretch.clear();
        stretch.extend((0..n).map(|k| {
            let each = at.iter().map(|of| of.stretches[k]);
            let in_middle = each.fold(f64::INFINITY, f64::min) / BETWEEN;
            let from_rest = cell.stretch[k] - cell.alpha[k] * change_from_rest;
            (in_middle - t * cell.alpha[k] * change).max(from_rest)
        }));
        if stretch.iter().zip(&cell.alpha).any(|(l, a)| *a > 0.0 && *l < LEAST_STRETCH) {
            return None;
        }
        // αᵢ/ℓᵢ, zero of cables that do not cross.
        parts.clear();
        parts.extend(cell.alpha.iter().zip(&*stretch).map(|(alpha, stretch)| alpha / stretch));
        let (mut by_change, mut by_change_2, mut pulled_2, mut pulled_3) = (0.0, 0.0, 0.0, 0.0);
        for (k, part) in parts.iter().enumerate() {
            let first = part * cell.alpha[k];
            by_change += most[k] * first;
            by_change_2 += most[k] * first * part;
            pulled_2 += greatest[k] * first * part;
            pulled_3 += greatest[k] * first * part * part;
        }
        let of_norm = 2.0 / 3.0_f64.sqrt();
        let together =
            BETWEEN * cell.sections.map(|at| changes[at]).into_iter().fold(0.0, f64::max);
        let mut b1 = change;
        if t * by_change < 1.0 {
            b1 = b1.min(together / (1.0 - t * by_change));
        }
        let mut b2 = 2.0 * b1 * by_change + of_norm * b1 * b1 * pulled_2;
        turned.clear();
        turned.extend(cell.alpha.iter().map(|alpha| alpha * b1));
        // Each bound follows from valid ones, and is valid itself.
        for _ in 0..REFINEMENTS {
            let of_cables: f64 = (0..n)
                .map(|k| {
                    let twice = 2.0 * cell.alpha[k] * b1 + turned[k];
                    parts[k] * turned[k] * (2.0 * most[k] + greatest[k] * twice / stretch[k])
                })
                .sum();
            b2 = b2.min(of_cables);
            b1 = b1.min(together + t * b2);
            for (k, turned) in turned.iter_mut().enumerate() {
                let whole = cell.alpha[k] * b1;
                let in_middle = cell.sections.map(|at| turns[n * at + k]);
                let in_middle = in_middle.into_iter().fold(0.0, f64::max);
                let in_middle = BETWEEN * in_middle + (BETWEEN - 1.0) * whole;
                let changed = cell.alpha[k] * b2 + 2.0 * *turned * whole / stretch[k];
                *turned = turned.min(whole).min(in_middle + t * changed);
            }
        }
        let of_all = 3.0 * (b2 * by_change + of_norm * b1 * (b1 * by_change_2 + b2 * pulled_2))
            + 3.0 * b1.powi(3) * pulled_3;
        let of_cables: f64 = (0..n)
            .map(|k| {
                let (first, second, q) = (cell.alpha[k] * b1, cell.alpha[k] * b2, turned[k]);
                let of_two =
                    most[k] * (2.0 * first + q) * q + greatest[k] * (first + 2.0 * q) * second;
                let of_three = greatest[k] * (2.0 * first * (first + q) + q * q) * q;
                parts[k] * (most[k] * second + (of_two + of_three / stretch[k]) / stretch[k])
            })
            .sum();
        Some([b1, b2, of_all.min(3.0 * of_cables)])
    }
}

/// The greatest rotation of all changes of the coordinates by no more than the half widths.
fn greatest_turn(spins: &[Vec3], half: &[f64], scaled: &mut Vec<[Vec3; 1]>) -> f64 {
    scaled.clear();
    scaled.extend(spins.iter().zip(half).map(|(spin, half)| [*spin * *half]));
    greatest_sum(scaled, |[turn]| turn.norm_squared())
}

#[cfg(test)]
mod tests {
    use super::*;
    use whipcord::cosserat::{self, Accuracy};
    use whipcord::{Along, Backbone, Cable, Case, Disks, Material, Model, Routing, Statics};
    use whipcord::{Pose, StabilityAnalysis, UnitQuaternion};
    use whipcord_numerics::random::SplitMix64;

    const LENGTH: f64 = 0.18;

    fn backbone() -> Backbone {
        let material = Material {
            young_modulus: Some(1.1e9),
            poisson_ratio: Some(0.3),
            ..Material::default()
        };
        let section = Some(whipcord::Section::circle(0.003));
        Backbone { section, material, ..Backbone::new(LENGTH) }
    }

    fn robot(cables: Vec<Cable>) -> Robot {
        robot_of(backbone(), cables)
    }

    fn robot_of(backbone: Backbone, cables: Vec<Cable>) -> Robot {
        let disks = Disks { holes: Some(12), ..Disks::equally_spaced(LENGTH, 10, 0.008) };
        Robot::new(backbone, disks, cables).unwrap()
    }

    fn robots() -> Vec<Robot> {
        let straight = |name: &str, degrees: f64, ends_at: Option<f64>| {
            let routing = Routing::Straight { angle: degrees.to_radians(), radius: 0.008 };
            Cable { ends_at, ..Cable::new(name, routing) }
        };
        let helix = |name: &str, turns: f64| {
            let routing = Routing::Helix { start_angle: 0.4, turns, radius: 0.008 };
            Cable::new(name, routing)
        };
        vec![
            robot(vec![straight("a", 0.0, Some(0.1)), straight("b", 80.0, None), helix("c", 1.0)]),
            robot(vec![helix("a", 1.5), helix("b", -1.0), straight("c", 200.0, Some(0.14))]),
        ]
    }

    /// Whose sections change along them: smoothly, from disk to disk, and in a jump between two disks.
    fn uneven_robots() -> Vec<Robot> {
        let straight = |name: &str, degrees: f64| {
            let routing = Routing::Straight { angle: degrees.to_radians(), radius: 0.008 };
            Cable::new(name, routing)
        };
        let three = || vec![straight("a", 0.0), straight("b", 130.0), straight("c", 220.0)];
        let outer = |arc_lengths: &[f64], values: &[f64]| {
            let outer = Along::At { arc_lengths: arc_lengths.to_vec(), values: values.to_vec() };
            Some(whipcord::Section::Round { outer, inner: Along::Uniform(0.0) })
        };
        let tapered = outer(&[0.0, LENGTH], &[0.0034, 0.0026]);
        let stepped = outer(&[0.05, 0.09, 0.09, 0.15], &[0.0032, 0.003, 0.0025, 0.0027]);
        let holes = [vec![1, 2, 3, 4, 4, 4, 4, 3, 2, 1], vec![5, 6, 7, 8, 9, 9, 8, 8, 7, 7]];
        let through = |(of, name): (Vec<usize>, &str)| Cable::new(name, Routing::holes(of));
        let mut along_holes: Vec<Cable> = holes.into_iter().zip(["a", "b"]).map(through).collect();
        along_holes.push(straight("c", 270.0));
        let bent = Vec3::new(4.0, -3.0, 2.0);
        vec![
            robot_of(Backbone { section: tapered, ..backbone() }, three()),
            robot_of(Backbone { section: stepped, ..backbone() }, three()),
            robot_of(Backbone { rest_curvature: Along::Uniform(bent), ..backbone() }, three()),
            robot_of(Backbone { extensible: false, shearable: false, ..backbone() }, along_holes),
        ]
    }

    fn tip(robot: &Robot, base: Pose, tensions: &[f64]) -> Vec3 {
        let model = Model::Cosserat(cosserat::Options {
            accuracy: Accuracy::Tolerance(1e-11),
            stability: StabilityAnalysis::Off,
            ..cosserat::Options::default()
        });
        let case = Case { base, ..Case::with_tensions(tensions) };
        let solution = model.solve(robot, &case).unwrap();
        solution.disks.poses.last().unwrap().position
    }

    /// Coordinates along which the tensions change together and by themselves.
    const EDGES: [f64; 9] = [1.0, 0.0, 0.5, 0.0, 1.0, 0.0, -0.3, 0.2, 1.0];

    fn moved(center: &[f64], by: &[f64]) -> Vec<f64> {
        let sum = |k: usize| (0..3).map(|a| EDGES[3 * a + k] * by[a]).sum::<f64>();
        (0..3).map(|k| center[k] + sum(k)).collect()
    }

    #[test]
    fn second_derivatives_are_those_of_differences() {
        let base =
            Pose { rotation: UnitQuaternion::exp(Vec3::new(0.3, -0.8, 1.1)), ..Pose::default() };
        let center = [2.0, 1.0, 1.5];
        for robot in robots() {
            let bounds = DerivativeBounds::of(&robot, LENGTH, 1).unwrap();
            let mut state = State::default();
            bounds.rod.bend(base.rotation, &center, &EDGES, &mut state).unwrap();
            let mut second = Vec::new();
            bounds.rod.second_derivatives(&state, &mut second);
            let h = 0.01;
            for (a, b) in (0..3).flat_map(|a| (0..=a).map(move |b| (a, b))) {
                let at = |i: f64, j: f64| {
                    let mut by = [0.0; 3];
                    by[a] += i * h;
                    by[b] += j * h;
                    tip(&robot, base, &moved(&center, &by))
                };
                let differences = (at(1.0, 1.0) - at(1.0, -1.0) - at(-1.0, 1.0) + at(-1.0, -1.0))
                    * (0.25 / (h * h));
                let error = (second[a * (a + 1) / 2 + b] - differences).norm();
                let scale = second.iter().map(|of| of.norm()).fold(0.0, f64::max);
                assert!(error <= 2e-4 * scale, "{a} {b}: {error} of {scale}");
            }
        }
    }

    #[test]
    fn derivatives_along_changes_of_a_box_are_within_their_bounds() {
        let mut random = SplitMix64::new(3);
        let mut tightest = [0.0_f64; 2];
        for robot in robots() {
            let bounds = DerivativeBounds::of(&robot, LENGTH, 1).unwrap();
            let (mut state, mut memory) = (State::default(), Memory::default());
            for (size, part) in [0.03, 0.2, 0.5].into_iter().flat_map(|s| [(s, 0.3), (s, 1.0)]) {
                let center = [0, 1, 2].map(|_| 1.5 + 2.0 * random.next_part());
                let half = [0, 1, 2].map(|_| size * (0.2 + random.next_part()));
                bounds.rod.bend(UnitQuaternion::IDENTITY, &center, &EDGES, &mut state).unwrap();
                let of = TensionBox { center: &center, edges: &EDGES, half: &half };
                bounds.look_at_middle(of, &state, &mut memory);
                let of_point = bounds.of_point(part, &center, &state, &mut memory);
                let OfPoint { second, third } = of_point.unwrap();
                for _ in 0..4 {
                    // From a point of a part of the box along a change to one of its corners.
                    let from = half.map(|h| part * h * (2.0 * random.next_part() - 1.0) * 0.8);
                    let along = half.map(|h| if random.next_part() < 0.5 { h } else { -h });
                    let step = 0.05;
                    let p = [-2.0, -1.0, 0.0, 1.0, 2.0].map(|k| {
                        let by = [0, 1, 2].map(|a| from[a] + k * step * along[a]);
                        tip(&robot, Pose::default(), &moved(&center, &by))
                    });
                    let of_second = (p[1] + p[3] - p[2] * 2.0).norm() / (step * step);
                    let of_third =
                        (p[4] - p[3] * 2.0 + p[1] * 2.0 - p[0]).norm() * 0.5 / step.powi(3);
                    assert!(of_second <= second, "{of_second} beyond {second}");
                    assert!(of_third <= third, "{of_third} beyond {third}");
                    tightest[0] = tightest[0].max(of_second / second);
                    tightest[1] = tightest[1].max(of_third / third);
                }
            }
        }
        // Bounds of another order would prove nothing.
        assert!(tightest[0] > 0.2 && tightest[1] > 0.03, "{tightest:?}");
    }

    #[test]
    fn polynomials_leave_no_more_than_their_remainders_and_integrals_than_their_errors() {
        let mut random = SplitMix64::new(8);
        let mut tightest = [0.0_f64; 2];
        let all = || robots().into_iter().chain(uneven_robots());
        for (robot, times) in all().flat_map(|robot| [(robot.clone(), 1), (robot, 2)]) {
            let bounds = DerivativeBounds::of(&robot, LENGTH, times).unwrap();
            let (mut state, mut memory) = (State::default(), Memory::default());
            let mut second = Vec::new();
            for size in [0.05, 0.2, 0.5] {
                let center = [0, 1, 2].map(|_| 1.0 + 4.0 * random.next_part());
                let half = [0, 1, 2].map(|_| size * (0.2 + random.next_part()));
                bounds.rod.bend(UnitQuaternion::IDENTITY, &center, &EDGES, &mut state).unwrap();
                let of = TensionBox { center: &center, edges: &EDGES, half: &half };
                let remainders = bounds.remainders(of, &state, &mut memory).unwrap();
                bounds.rod.second_derivatives(&state, &mut second);
                let error = (tip(&robot, Pose::default(), &center) - state.end()).norm();
                assert!(error <= state.error + 1e-9 * LENGTH, "{error} beyond {}", state.error);
                for corner in 0..8 {
                    let by: [f64; 3] =
                        [0, 1, 2].map(|a| if corner >> a & 1 == 1 { half[a] } else { -half[a] });
                    let first = (0..3).fold(state.end(), |p, a| p + state.motions[a] * by[a]);
                    let pairs = (0..3).flat_map(|a| (0..3).map(move |b| (a, b)));
                    let both = pairs.fold(first, |p, (a, b): (usize, usize)| {
                        let (row, column) = (a.max(b), a.min(b));
                        p + second[row * (row + 1) / 2 + column] * (0.5 * by[a] * by[b])
                    });
                    let there = tip(&robot, Pose::default(), &moved(&center, &by));
                    for (degree, polynomial) in [first, both].into_iter().enumerate() {
                        let left = (there - polynomial).norm();
                        let most = remainders[degree] + 2.0 * state.error;
                        assert!(left <= most, "{degree}: {left} beyond {most}");
                        tightest[degree] = tightest[degree].max(left / most);
                    }
                }
            }
        }
        assert!(tightest[0] > 0.2 && tightest[1] > 0.02, "{tightest:?}");
    }
}
