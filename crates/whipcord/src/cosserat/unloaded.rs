//! A rod on which nothing but its cables pulls.
//!
//! Then the total wrench vanishes at every cut, and the strains follow section by section from
//! eqs. (1) and (2) of [`super::section`]: there is no boundary value problem. The frames come from
//! one pass of a Magnus integrator of order 6, the cable lengths from Gauss quadrature.

use whipcord_numerics::{GAUSS_3, Mat3, Pose, magnus_6};

use super::grid::Grid;
use super::one_cable;
use super::section::{BodyWrench, SectionFault, Strain, Tangent, equilibrium};
use super::sensitivity::work;

/// A fault and where it lies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Fault {
    pub kind: SectionFault,
    /// Arc length in m.
    pub arc_length: f64,
}

/// Strains, lengths and their derivatives of a rod without load.
#[derive(Clone, Debug, Default)]
pub(crate) struct Unloaded {
    /// Three to each step.
    pub strains: Vec<Strain>,
    /// `ℓᵢ = ∫‖pᵢ′‖ ds` in m, in the order of the grid.
    pub lengths: Vec<f64>,
    /// `∂ℓᵢ/∂τⱼ` by rows in m/N: symmetric and not positive.
    pub length_by_tension: Vec<f64>,
    pulls: Vec<BodyWrench>,
}

impl Unloaded {
    /// Solves all sections for these tensions (N, in the order of the grid), starting from the
    /// strains of the last sweep when `warm`; their derivatives by the tensions when `derivatives`.
    pub fn sweep(
        &mut self,
        grid: &Grid,
        tensions: &[f64],
        warm: bool,
        derivatives: bool,
    ) -> Result<(), Fault> {
        let cables = tensions.len();
        let nodes = 3 * grid.len();
        let warm = warm && self.strains.len() == nodes;
        self.strains.resize(nodes, Strain::default());
        self.lengths.clear();
        // What quadrature adds to the cables of the rod at rest it adds to those of the bent one.
        self.lengths.extend(grid.gauss.rest_excess.iter().map(|excess| -excess));
        self.length_by_tension.clear();
        self.length_by_tension.resize(cables * cables, 0.0);
        self.pulls.resize(cables, BodyWrench::default());
        let mut guess = Guess::default();
        for (k, step) in grid.steps.iter().enumerate() {
            let active = &tensions[..step.active];
            for j in 0..3 {
                let (node, crossings) = grid.gauss.at(k, j, step.active);
                let section = &node.section;
                let weight = GAUSS_3.weights[j] * step.length;
                let arc_length = step.start + GAUSS_3.nodes[j] * step.length;
                let fault = |kind| Fault { kind, arc_length };
                let none = BodyWrench::default();
                let strain = if let ([crossing], true) = (crossings, section.isotropic) {
                    let one = one_cable::equilibrium(section, crossing, active[0], none)
                        .map_err(fault)?;
                    self.lengths[0] += weight * one.stretch;
                    self.length_by_tension[0] += weight * one.stretch_by_tension;
                    one.strain
                } else {
                    let mut strain = if warm {
                        self.strains[3 * k + j]
                    } else {
                        guess.at(arc_length).unwrap_or_else(|| section.rest_strain())
                    };
                    equilibrium(section, crossings, active, none, &mut strain).map_err(fault)?;
                    guess.learn(arc_length, strain);
                    for (i, crossing) in crossings.iter().enumerate() {
                        let (pull, stretch) = crossing.pull(&strain);
                        self.pulls[i] = pull;
                        self.lengths[i] += weight * stretch;
                    }
                    if derivatives {
                        let tangent =
                            Tangent::at(section, crossings, active, &strain).map_err(fault)?;
                        self.add_length_by_tension(cables, step.active, weight, &tangent);
                    }
                    strain
                };
                self.strains[3 * k + j] = strain;
            }
        }
        Ok(())
    }

    /// The stability of [`super::stability`] at the strains of the last sweep: without load eq. (8) is
    /// `∫ δuᵀ S δu ds` with any field `δu`, and its least value that of `δuᵀ S δu / δuᵀ K_bt δu` at a
    /// node.
    ///
    /// What cables add to the Hessian is not negative: the value is 1 at least. One taut cable gives two
    /// equations for the three of `δu` that leave its direction alone, so that it is 1 where a step
    /// has no more than one.
    pub fn stability(&self, grid: &Grid, tensions: &[f64]) -> Result<f64, Fault> {
        if grid.steps.iter().any(|step| taut(&tensions[..step.active]) <= 1) {
            return Ok(1.0);
        }
        let mut least = f64::MAX;
        for n in scattered(self.strains.len()) {
            let (k, j) = (n / 3, n % 3);
            let step = &grid.steps[k];
            let (node, crossings) = grid.gauss.at(k, j, step.active);
            let section = &node.section;
            let tangent =
                Tangent::at(section, crossings, &tensions[..step.active], &self.strains[n])
                    .map_err(|kind| {
                        let arc_length = step.start + GAUSS_3.nodes[j] * step.length;
                        Fault { kind, arc_length }
                    })?;
            let metric = section.bending_stiffness();
            if is_below(&tangent.reduced, &metric, least) {
                least = least_relative(&tangent.reduced, &metric);
            }
            if least <= LEAST_STABILITY {
                break;
            }
        }
        Ok(least)
    }

    /// `∂ℓᵢ/∂τⱼ = −∫ qᵢᵀ H⁻¹ qⱼ ds` with `q = (t, r × t)`, what a unit tension exerts.
    fn add_length_by_tension(
        &mut self,
        cables: usize,
        active: usize,
        weight: f64,
        tangent: &Tangent,
    ) {
        for j in 0..active {
            let change = tangent.solve(self.pulls[j]);
            for i in 0..=j {
                let value = work(&self.pulls[i], &change);
                self.length_by_tension[i * cables + j] -= weight * value;
                if i != j {
                    self.length_by_tension[j * cables + i] -= weight * value;
                }
            }
        }
    }

    /// The frames at the ends of all steps, from the strains of the last sweep.
    pub fn integrate(&self, grid: &Grid, poses: &mut Vec<Pose>) {
        poses.clear();
        let mut pose = Pose::IDENTITY;
        poses.push(pose);
        for (step, strains) in grid.steps.iter().zip(self.strains.chunks_exact(3)) {
            let h = step.length;
            pose = pose * magnus_6(&[strains[0] * h, strains[1] * h, strains[2] * h]);
            poses.push(pose);
        }
    }
}

/// The next strain by extrapolation from the two before it.
#[derive(Clone, Copy, Debug, Default)]
struct Guess {
    known: usize,
    at: [f64; 2],
    strains: [Strain; 2],
}

impl Guess {
    #[inline]
    fn at(&self, arc_length: f64) -> Option<Strain> {
        let [a, b] = self.strains;
        match self.known {
            0 => None,
            1 => Some(b),
            _ => {
                let t = (arc_length - self.at[1]) / (self.at[1] - self.at[0]);
                Some(b + (b - a) * t)
            }
        }
    }

    #[inline]
    fn learn(&mut self, arc_length: f64, strain: Strain) {
        self.known += 1;
        self.at = [self.at[1], arc_length];
        self.strains = [self.strains[1], strain];
    }
}

/// Accuracy of the stability, relative to it.
pub(super) const STABILITY_TOLERANCE: f64 = 1e-8;
/// A stability that is as good as that of the bare rod; none is less.
pub(super) const LEAST_STABILITY: f64 = 1.0 + STABILITY_TOLERANCE;

/// How many of the cables are taut.
pub(super) fn taut(tensions: &[f64]) -> usize {
    tensions.iter().filter(|&&tension| tension > 0.0).count()
}

/// Whether some direction has less than this stiffness relative to the metric, by more than the
/// tolerance.
#[inline]
fn is_below(reduced: &Mat3, metric: &Mat3, bound: f64) -> bool {
    (*reduced - *metric * (bound * (1.0 - STABILITY_TOLERANCE))).ldlt().is_none()
}

/// Least eigenvalue of the reduced stiffness relative to that of the section alone.
pub(super) fn least_relative(reduced: &Mat3, metric: &Mat3) -> f64 {
    // The stiffness of a section is positive: there always are some. Rounding alone takes them below 1.
    reduced.eigenvalues_relative_to(metric).map_or(1.0, |values| values[0].max(1.0))
}

/// The numbers below `count`, neighbours far from one another: what is least along the rod is met, or
/// nearly so, before most of the others.
pub(super) fn scattered(count: usize) -> impl Iterator<Item = usize> {
    // By the golden section, and then on to the next number that has no common factor.
    let common = |mut a: usize, mut b: usize| {
        while b > 0 {
            (a, b) = (b, a % b);
        }
        a
    };
    let stride = (count * 5 / 8..=count).find(|&stride| common(stride, count) == 1).unwrap_or(1);
    (0..count).map(move |i| i * stride % count)
}

#[cfg(test)]
mod tests {
    use super::scattered;

    #[test]
    fn scattered_numbers_are_all_numbers() {
        for count in 0..200 {
            let mut met: Vec<usize> = scattered(count).collect();
            met.sort_unstable();
            assert!(met.into_iter().eq(0..count), "{count}");
        }
    }
}
