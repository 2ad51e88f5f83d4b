//! Cross-sections of a rod without loads under the tensions of its cables, with the derivatives of their strains by coordinates of the tensions.
//!
//! A section minimises `½‖ξ − ξ*‖²_K + Σ τᵢ ℓᵢ(ξ)` over its strains `ξ = (v, u)`, with the stretch `ℓᵢ = ‖Aᵢξ + rᵢ′‖` of cable i,
//! `Aᵢξ = v + u × rᵢ`, and its unit tangent `tᵢ`. With tensions `τ = τ₀ + Σ eₐ xₐ`, `aᵢ = Aᵢ∂ₐξ`, `bᵢ = Aᵢ∂_bξ` and `Pᵢ = I − tᵢtᵢᵀ`
//!
//! ```text
//! H = K + Σ τᵢ Aᵢᵀ Pᵢ Aᵢ/ℓᵢ,   H ∂ₐξ = −Σ eₐᵢ Aᵢᵀ tᵢ                                        (9a)
//! H ∂ₐ∂_bξ = −Σ Aᵢᵀ ((eₐᵢ Pᵢbᵢ + e_bᵢ Pᵢaᵢ)/ℓᵢ − τᵢ ((tᵢ·aᵢ) Pᵢbᵢ + (tᵢ·bᵢ) Pᵢaᵢ + (aᵢ·Pᵢbᵢ) tᵢ)/ℓᵢ²)
//! ```

use whipcord::section::CrossedSection;
use whipcord::{Mat3, Robot, Vec3};

use crate::corners::greatest_sum;

/// Strains `v` and `u`, or what belongs to them: a force and a moment.
pub(crate) type Pair = [Vec3; 2];

/// A section with the cables that cross it.
#[derive(Clone, Debug)]
pub(crate) struct Section {
    crossed: CrossedSection,
    /// `∂v/∂N`, `∂v/∂M` and `∂u/∂M`.
    compliance: [Mat3; 3],
}

/// A section under tensions.
#[derive(Clone, Debug, Default)]
pub(crate) struct Equilibrium {
    pub strain: Pair,
    /// Of each cable of the robot, infinite where it does not cross.
    pub stretches: Vec<f64>,
    /// `tᵢ` and `rᵢ × tᵢ`.
    pub pulls: Vec<Pair>,
    /// `∂ₐξ` of each coordinate.
    pub first: Vec<Pair>,
    /// `∂ₐ∂_bξ` of coordinates `b ≤ a`, one row after the other.
    pub second: Vec<Pair>,
    /// `H⁻¹` in blocks.
    softness: [[Mat3; 2]; 2],
    /// Of each cable that crosses, with each coordinate.
    turned: Vec<Turned>,
}

/// How a cable changes with a coordinate.
#[derive(Clone, Copy, Debug)]
struct Turned {
    /// `Pᵢaᵢ`
    beside: Vec3,
    /// `Pᵢaᵢ/ℓᵢ`
    bent: Vec3,
    /// `eₐᵢ − τᵢ tᵢ·aᵢ/ℓᵢ`
    change: f64,
    /// `rᵢ`
    offset: Vec3,
    /// `τᵢ tᵢ/ℓᵢ`
    pull: Vec3,
}

impl Section {
    pub fn of(robot: &Robot, arc_length: f64, compliance: [Mat3; 3]) -> Option<Self> {
        let crossed = CrossedSection::of(robot, arc_length).ok()?;
        Some(Self { crossed, compliance })
    }

    /// Whether it is another one but for small parts.
    pub fn is_like(&self, other: &Self) -> bool {
        self.crossed.is_like(&other.crossed)
    }

    /// The equilibrium under the tensions of all cables; `None` where a cable would be compressed to nothing.
    pub fn equilibrium(&self, tensions: &[f64], at: &mut Equilibrium) -> Option<()> {
        let n = tensions.len();
        at.stretches.clear();
        at.stretches.resize(n, f64::INFINITY);
        at.pulls.clear();
        at.pulls.resize(n, [Vec3::ZERO; 2]);
        at.strain = self.crossed.pulls(tensions, &mut at.stretches, &mut at.pulls)?;
        Some(())
    }

    /// The first derivatives of an equilibrium by coordinates, each with the tensions of an edge; `None` where there are none.
    pub fn first(&self, tensions: &[f64], edges: &[f64], at: &mut Equilibrium) -> Option<()> {
        let Equilibrium { stretches, pulls, first, softness, .. } = at;
        // H⁻¹ = (I + K⁻¹ B)⁻¹ K⁻¹ with B = Σ τᵢ Aᵢᵀ Pᵢ Aᵢ/ℓᵢ, whose blocks are P, −P r̂ and r̂ P, −r̂ P r̂: K⁻¹ may have no inverse.
        let mut geometric = [[Mat3::ZERO; 2]; 2];
        for (cable, r) in self.crossed.cables() {
            let t = pulls[cable][0];
            let part = tensions[cable] / stretches[cable];
            let beside = (Mat3::IDENTITY - Mat3::outer(t, t)) * part;
            let (right, left) = (beside * Mat3::skew(-r), Mat3::skew(r) * beside);
            let of = [[beside, right], [left, left * Mat3::skew(-r)]];
            for (sums, of) in geometric.iter_mut().flatten().zip(of.iter().flatten()) {
                *sums += *of;
            }
        }
        let [vv, vu, uu] = self.compliance;
        let soft = [[vv, vu], [vu.transpose(), uu]];
        let product =
            |i: usize, j: usize| soft[i][0] * geometric[0][j] + soft[i][1] * geometric[1][j];
        let matrix = [
            [product(0, 0).plus_identity(), product(0, 1)],
            [product(1, 0), product(1, 1).plus_identity()],
        ];
        *softness = block_solve(matrix, soft)?;
        first.clear();
        first.extend(edges.chunks_exact(tensions.len()).map(|edge| {
            let [force, moment] = exerted(edge, pulls);
            times(softness, [-force, -moment])
        }));
        Some(())
    }

    /// The second derivatives of an equilibrium that has its first.
    pub fn second(&self, tensions: &[f64], edges: &[f64], at: &mut Equilibrium) {
        let n = tensions.len();
        let Equilibrium { stretches, pulls, first, second, softness, turned, .. } = at;
        let count = first.len();
        turned.clear();
        for (cable, r) in self.crossed.cables() {
            let (t, per_stretch) = (pulls[cable][0], 1.0 / stretches[cable]);
            let part = tensions[cable] * per_stretch;
            turned.extend(first.iter().enumerate().map(|(i, [v, u])| {
                let a = *v + u.cross(r);
                let along = t.dot(a);
                let beside = a - t * along;
                let change = edges[i * n + cable] - along * part;
                Turned { beside, bent: beside * per_stretch, change, offset: r, pull: t * part }
            }));
        }
        second.clear();
        for (i, j) in (0..count).flat_map(|i| (0..=i).map(move |j| (i, j))) {
            let mut sum = [Vec3::ZERO; 2];
            for of in turned.chunks_exact(count) {
                let (a, b) = (&of[i], &of[j]);
                let force = a.pull * a.beside.dot(b.bent) - b.bent * a.change - a.bent * b.change;
                add(&mut sum, force, a.offset);
            }
            second.push(sum);
        }
        second.iter_mut().for_each(|of| *of = times(softness, *of));
    }

    /// The greatest `‖Σ δᵢ Aᵢᵀ tᵢ‖_{K⁻¹}` of all changes of the coordinates by no more than the half widths.
    pub fn greatest_change(
        &self,
        at: &Equilibrium,
        edges: &[f64],
        half: &[f64],
        scaled: &mut Vec<Pair>,
    ) -> f64 {
        let [vv, vu, uu] = self.compliance;
        scaled.clear();
        let n = at.pulls.len();
        scaled.extend(edges.chunks_exact(n).zip(half).map(|(edge, half)| {
            let [force, moment] = exerted(edge, &at.pulls);
            [force * *half, moment * *half]
        }));
        let squared = |&[force, moment]: &Pair| {
            force.dot(vv * force) + 2.0 * force.dot(vu * moment) + moment.dot(uu * moment)
        };
        greatest_sum(scaled, squared)
    }

    /// The greatest `‖Pᵢ Aᵢ ∂_δξ‖` of each cable of all changes of the coordinates by no more than the half widths, zero where it does not cross.
    pub fn greatest_turns(
        &self,
        at: &Equilibrium,
        half: &[f64],
        scaled: &mut Vec<[Vec3; 1]>,
        turns: &mut [f64],
    ) {
        turns.fill(0.0);
        for (cable, r) in self.crossed.cables() {
            let t = at.pulls[cable][0];
            scaled.clear();
            scaled.extend(at.first.iter().zip(half).map(|([v, u], half)| {
                let a = (*v + u.cross(r)) * *half;
                [a - t * t.dot(a)]
            }));
            turns[cable] = greatest_sum(scaled, |[a]| a.norm_squared());
        }
    }

    /// How much tensions on the section in this state bend the bare backbone.
    pub fn bending(&self, tensions: &[f64], at: &Equilibrium) -> f64 {
        let [force, moment] = exerted(tensions, &at.pulls);
        let [_, vu, uu] = self.compliance;
        (vu.transpose_mul(force) + uu * moment).norm()
    }
}

/// A matrix in blocks times a force and a moment.
fn times([upper, lower]: &[[Mat3; 2]; 2], [force, moment]: Pair) -> Pair {
    [upper[0] * force + upper[1] * moment, lower[0] * force + lower[1] * moment]
}

/// `M⁻¹ B` in blocks; `None` where the first block of `M` or what eliminating it leaves of the last has no inverse.
fn block_solve(
    [[a, b], [c, d]]: [[Mat3; 2]; 2],
    [upper, lower]: [[Mat3; 2]; 2],
) -> Option<[[Mat3; 2]; 2]> {
    let a = a.inverse()?;
    let left = (d - c * a * b).inverse()?;
    let column = |k: usize| {
        let lower = left * (lower[k] - c * a * upper[k]);
        [a * (upper[k] - b * lower), lower]
    };
    let (first, second) = (column(0), column(1));
    Some([[first[0], second[0]], [first[1], second[1]]])
}

/// Adds `Aᵀ` of a force on a cable.
fn add(to: &mut Pair, force: Vec3, offset: Vec3) {
    to[0] += force;
    to[1] += offset.cross(force);
}

/// What tensions exert, for what each cable exerts under 1 N.
fn exerted(tensions: &[f64], pulls: &[Pair]) -> Pair {
    let each = tensions.iter().zip(pulls).filter(|(tension, _)| **tension != 0.0);
    each.fold([Vec3::ZERO; 2], |[force, moment], (tension, pull)| {
        [force + pull[0] * *tension, moment + pull[1] * *tension]
    })
}
