//! Any number of cables through one section, or through all sections together: minimise the sum of
//! the measures with no cable longer than prescribed, eqs. (8) and (9).
//!
//! The method of multipliers (Hestenes, Powell, Rockafellar): for given multipliers λ ≥ 0 and
//! penalty σ the function Φ = ΣF + Σ (max(0, λ + σc)² − λ²)/2σ of the coordinates is minimised by
//! Newton's method with its exact Hessian, made positive definite where it is not, and a line
//! search, so every step descends; then λ becomes max(0, λ + σc). Cables that do not bind have
//! λ = 0. Where the lengths cannot all be had the coordinates tend to the least sum of squared
//! excess lengths, and among those shapes to the least ΣF, whatever the number of cables and
//! however dependent their constraints are.

use whipcord_numerics::{DenseLu, Jet, Ldlt3, Sym3, Vec3};

use super::bend::Bend;
use super::section::{NO_LEVER, Section};
use crate::budget::Meter;

/// How the iteration ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Ending {
    /// Every cable is as long as prescribed, or slack.
    Met,
    /// No such shape was found: the coordinates are where the excess lengths are least.
    Missed,
}

/// How one minimisation ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stop {
    Met,
    /// At the least sum of squared excess lengths.
    Compromise,
    /// Nowhere in particular.
    Stalled,
}

/// The state of the iteration; its buffers are kept between uses.
#[derive(Clone, Debug, Default)]
pub(super) struct Several {
    /// One for each section.
    pub bends: Vec<Bend>,
    /// By cable, in rad²/m.
    pub multipliers: Vec<f64>,
    /// By cable, summed over the sections.
    pub lengths: Vec<f64>,
    /// Newton steps spent.
    pub iterations: usize,
    /// What the solve may still spend.
    pub meter: Meter,
    penalty: f64,
    levers: Vec<f64>,
    /// By cable: length at rest.
    at_rest: Vec<f64>,
    pulls: Vec<f64>,
    active: Vec<usize>,
    trial: Vec<Bend>,
    steps: Vec<Vec3>,
    gradients: Vec<Vec3>,
    measures: Vec<Jet>,
    passages: Vec<Jet>,
    factors: Vec<Ldlt3>,
    schur: Vec<f64>,
    rhs: Vec<f64>,
    couplings: Vec<f64>,
    lu: DenseLu,
}

/// Penalty at the start, relative to the stiffness against a cable: each update of the
/// multipliers cuts the excess lengths by about this factor.
const PENALTY: f64 = 1e2;
/// Greatest penalty: beyond it rounding would spoil the directions along the constraints.
const GREATEST_PENALTY: f64 = 1e10;
/// Size of a Newton step after which the error is of the order of rounding.
const FINEST: f64 = 1e-8;
/// Longest step in any coordinate: what lies beyond is another fold of the section.
const LONGEST: f64 = 0.25;
/// Smallest part of the way to the targets that is tried as one step.
const LEAST_APPROACH: f64 = 1.0 / 256.0;
/// Conflict of the lengths up to which the least-squares shape is given as the answer, relative
/// to the length of the backbone concerned.
pub(super) const MOST_CONFLICT: f64 = 0.01;
const MOST_UPDATES: usize = 30;
const MOST_STEPS: usize = 40;
/// Excess length that counts as none, relative to the length at rest.
const MET: f64 = 2e-13;

impl Several {
    /// Minimises over `sections`; `targets` are the prescribed lengths, by cable, summed over
    /// these sections. Starts from rest; where that does not lead there in one go,
    /// the lengths are brought to their targets little by little.
    pub fn solve(&mut self, sections: &[Section], targets: &[f64]) -> Ending {
        self.reset(sections, targets);
        let least = match self.minimise(sections, targets) {
            Stop::Met => return Ending::Met,
            // Lengths that do contradict each other do so from the first part of the way on.
            Stop::Compromise if self.is_tolerable(sections, targets) => 0.25,
            Stop::Compromise | Stop::Stalled => LEAST_APPROACH,
        };
        let found = self.state();
        if self.approach(sections, targets, least) >= 1.0 {
            return Ending::Met;
        }
        self.restore(&found);
        self.evaluate(sections, targets);
        Ending::Missed
    }

    /// Whether the lengths contradict each other by so little that the least-squares shape is an
    /// answer.
    pub fn is_tolerable(&self, sections: &[Section], targets: &[f64]) -> bool {
        let reach: f64 = sections.iter().map(|section| section.length).sum();
        self.worst(targets).1 <= MOST_CONFLICT * reach
    }

    /// Brings the lengths from those at rest to their targets, in steps that are
    /// halved where they fail but no smaller than `least`; the part of the way that it got.
    fn approach(&mut self, sections: &[Section], targets: &[f64], least: f64) -> f64 {
        let spent = self.iterations;
        self.reset(sections, targets);
        self.iterations = spent;
        let penalty = self.penalty;
        let (mut done, mut step) = (0.0, 0.25);
        let mut part = targets.to_vec();
        let mut state = self.state();
        while done < 1.0 && !self.meter.has_ended() {
            let next = if done + step < 1.0 { done + step } else { 1.0 };
            for ((part, &target), &rest) in part.iter_mut().zip(targets).zip(&self.at_rest) {
                *part = if next < 1.0 { rest + next * (target - rest) } else { target };
            }
            self.penalty = penalty;
            if self.minimise(sections, &part) == Stop::Met {
                (done, step) = (next, 2.0 * step);
                state = self.state();
            } else {
                self.restore(&state);
                step *= 0.5;
                if step < least {
                    break;
                }
            }
        }
        done
    }

    fn state(&self) -> (Vec<Bend>, Vec<f64>) {
        (self.bends.clone(), self.multipliers.clone())
    }

    fn restore(&mut self, (bends, multipliers): &(Vec<Bend>, Vec<f64>)) {
        self.bends.copy_from_slice(bends);
        self.multipliers.copy_from_slice(multipliers);
    }

    /// Minimises from where the coordinates and multipliers are.
    fn minimise(&mut self, sections: &[Section], targets: &[f64]) -> Stop {
        let mut merit = self.evaluate(sections, targets);
        let mut last_violation = f64::INFINITY;
        // Multipliers far from their values deserve no more than a rough minimum.
        let mut tolerance = 1e-2;
        for _ in 0..MOST_UPDATES {
            if self.meter.has_ended() {
                break;
            }
            let mut size = f64::INFINITY;
            let mut steps = 0;
            while size > tolerance && steps < MOST_STEPS {
                self.set_pulls(targets);
                let slope = self.newton_step(sections);
                steps += 1;
                self.meter.iterate();
                self.meter.integrate(sections.len());
                let Some(next) = self.descend(sections, targets, merit, slope) else { break };
                (size, merit) = next;
            }
            self.iterations += steps;
            self.set_pulls(targets);
            self.multipliers.copy_from_slice(&self.pulls);
            let (violation, relative) = self.violation(targets);
            if size <= FINEST && relative <= MET {
                return Stop::Met;
            }
            if violation > 0.25 * last_violation {
                if size <= FINEST && self.is_least_squares(sections, targets) {
                    return Stop::Compromise;
                }
                self.penalty *= 10.0;
                if self.penalty > GREATEST_PENALTY / self.least_lever() {
                    break;
                }
            }
            last_violation = violation;
            tolerance = (1e-2 * tolerance).max(FINEST);
            merit = self.merit(targets);
        }
        Stop::Stalled
    }

    /// The lengths that one cable takes on the way to the targets: to a millionth in one section,
    /// to a thousandth in several, where every step costs more.
    pub fn range(&mut self, sections: &[Section], targets: &[f64], cable: usize) -> (f64, f64) {
        let longest = self.at_rest[cable];
        let least = if sections.len() == 1 { 1e-6 } else { 1e-3 };
        let part = self.approach(sections, targets, least);
        (longest + part * (targets[cable] - longest), longest)
    }

    /// Whether every cable is as long as prescribed, or slack, to this length in m.
    pub fn is_met(&self, targets: &[f64], to: f64) -> bool {
        self.violation(targets).0 <= to
    }

    /// The cable that exceeds its prescribed length most, and by how much.
    pub fn worst(&self, targets: &[f64]) -> (usize, f64) {
        let excess = self.lengths.iter().zip(targets).map(|(length, target)| length - target);
        excess.enumerate().fold((0, f64::NEG_INFINITY), |most, (i, excess)| {
            if excess > most.1 { (i, excess) } else { most }
        })
    }

    /// Whether a single cable pulls, so that nothing contradicts it.
    pub fn only_one_pulls(&self) -> bool {
        self.multipliers.iter().filter(|&&multiplier| multiplier > 0.0).count() == 1
    }

    /// Greatest violation of `c ≤ 0, λ ≥ 0, λc = 0`, in m and relative to the length at
    /// rest: what a pulling cable is off its length, and what any other is longer.
    fn violation(&self, targets: &[f64]) -> (f64, f64) {
        let mut most = (0.0_f64, 0.0_f64);
        for (i, &target) in targets.iter().enumerate() {
            let excess = self.lengths[i] - target;
            let miss = if self.multipliers[i] > 0.0 { excess.abs() } else { excess.max(0.0) };
            if miss > 0.0 {
                most = (most.0.max(miss), most.1.max(miss / self.at_rest[i]));
            }
        }
        most
    }

    fn least_lever(&self) -> f64 {
        let most = self.levers.iter().copied().fold(0.0, f64::max);
        self.levers.iter().copied().filter(|&l| l > 1e-6 * most).fold(most, f64::min)
    }

    fn reset(&mut self, sections: &[Section], targets: &[f64]) {
        let (n, cables) = (sections.len(), targets.len());
        self.iterations = 0;
        for list in [
            &mut self.multipliers,
            &mut self.lengths,
            &mut self.pulls,
            &mut self.levers,
            &mut self.at_rest,
        ] {
            list.clear();
            list.resize(cables, 0.0);
        }
        for list in [&mut self.bends, &mut self.trial] {
            list.clear();
            list.extend(sections.iter().map(|section| section.rest));
        }
        for list in [&mut self.steps, &mut self.gradients] {
            list.clear();
            list.resize(n, Vec3::ZERO);
        }
        for section in sections {
            for passage in &section.passages {
                self.levers[passage.cable] += section.lever(passage).1;
                self.at_rest[passage.cable] += passage.initial;
            }
        }
        let reach = sections.iter().map(|s| s.length).sum::<f64>();
        let least = self.least_lever().max(NO_LEVER * reach * reach);
        self.penalty = PENALTY / least;
    }

    /// Measures and lengths at the coordinates, and Φ.
    fn evaluate(&mut self, sections: &[Section], targets: &[f64]) -> f64 {
        self.measures.clear();
        self.passages.clear();
        self.lengths.fill(0.0);
        for (section, &bend) in sections.iter().zip(&self.bends) {
            let turn = bend.turn();
            self.measures.push(section.measure(bend));
            for passage in &section.passages {
                let length = passage.length(&turn, section.length, section.chord);
                self.lengths[passage.cable] += length.value;
                self.passages.push(length);
            }
        }
        self.merit(targets)
    }

    fn merit(&self, targets: &[f64]) -> f64 {
        let measure: f64 = self.measures.iter().map(|m| m.value).sum();
        let cables = self.multipliers.iter().zip(&self.lengths).zip(targets);
        let penalty: f64 = cables
            .map(|((&multiplier, &length), &target)| {
                let pull = (multiplier + self.penalty * (length - target)).max(0.0);
                pull * pull - multiplier * multiplier
            })
            .sum();
        measure + penalty / (2.0 * self.penalty)
    }

    fn set_pulls(&mut self, targets: &[f64]) {
        self.active.clear();
        for i in 0..targets.len() {
            let pull = self.multipliers[i] + self.penalty * (self.lengths[i] - targets[i]);
            self.pulls[i] = pull.max(0.0);
            if pull > 0.0 {
                self.active.push(i);
            }
        }
    }

    /// The Newton step of Φ into `steps`; returns its slope along it, which is not positive.
    ///
    /// The penalty couples the sections of a cable. Its rank is the number of binding cables, so
    /// each section is eliminated by itself: with the blocks H_s and the arms g_is,
    /// `(I/σ + Σ gᵀH⁻¹g) ν = −Σ gᵀH⁻¹∇` and `step = −H⁻¹(∇ + Σ νg)`. A single section is
    /// factored with its penalty, which may be what makes it positive definite.
    fn newton_step(&mut self, sections: &[Section]) -> f64 {
        let single = sections.len() == 1;
        self.factors.clear();
        let mut first = 0;
        for (s, section) in sections.iter().enumerate() {
            let mut gradient = self.measures[s].gradient;
            let mut hessian = self.measures[s].hessian;
            for (k, passage) in section.passages.iter().enumerate() {
                let (length, pull) = (&self.passages[first + k], self.pulls[passage.cable]);
                if pull > 0.0 {
                    gradient += length.gradient * pull;
                    hessian = hessian + length.hessian * pull;
                    if single {
                        hessian = hessian + Sym3::square(length.gradient) * self.penalty;
                    }
                }
            }
            first += section.passages.len();
            self.gradients[s] = gradient;
            self.factors.push(positive_factors(hessian, section.rest_hessian()));
        }
        if !single {
            self.couple(sections);
        }
        let mut slope = 0.0;
        let mut first = 0;
        for (s, section) in sections.iter().enumerate() {
            let mut force = self.gradients[s];
            if !single {
                for (k, passage) in section.passages.iter().enumerate() {
                    let coupling = self.couplings[passage.cable];
                    force += self.passages[first + k].gradient * coupling;
                }
            }
            first += section.passages.len();
            self.steps[s] = -self.factors[s].solve(force);
            slope += self.steps[s].dot(self.gradients[s]);
        }
        slope
    }

    /// The ν of [`Self::newton_step`], by cable.
    fn couple(&mut self, sections: &[Section]) {
        let (m, cables) = (self.active.len(), self.pulls.len());
        self.couplings.clear();
        self.couplings.resize(cables, 0.0);
        if m == 0 {
            return;
        }
        self.schur.clear();
        self.schur.resize(m * m, 0.0);
        self.rhs.clear();
        self.rhs.resize(m, 0.0);
        let row = |active: &[usize], cable: usize| active.iter().position(|&c| c == cable);
        let mut first = 0;
        for (s, section) in sections.iter().enumerate() {
            for (k, passage) in section.passages.iter().enumerate() {
                let Some(i) = row(&self.active, passage.cable) else { continue };
                let eased = self.factors[s].solve(self.passages[first + k].gradient);
                self.rhs[i] -= eased.dot(self.gradients[s]);
                for (l, other) in section.passages.iter().enumerate() {
                    if let Some(j) = row(&self.active, other.cable) {
                        self.schur[i * m + j] += eased.dot(self.passages[first + l].gradient);
                    }
                }
            }
            first += section.passages.len();
        }
        for i in 0..m {
            self.schur[i * m + i] += 1.0 / self.penalty;
        }
        if self.lu.factor(m, &self.schur).is_ok() {
            self.lu.solve(&mut self.rhs);
            for (i, &cable) in self.active.iter().enumerate() {
                self.couplings[cable] = self.rhs[i];
            }
        }
    }

    /// Moves along the step, not too far, as far as Φ falls; returns the size of the Newton step
    /// and the new Φ, or `None` when Φ does not fall at all.
    fn descend(
        &mut self,
        sections: &[Section],
        targets: &[f64],
        merit: f64,
        slope: f64,
    ) -> Option<(f64, f64)> {
        let size = self.steps.iter().map(|step| step.max_abs()).fold(0.0, f64::max);
        self.trial.copy_from_slice(&self.bends);
        // Below this the change of Φ drowns in rounding.
        let noise = 1e-14 * (merit.abs() + 1e-6);
        let mut t = if size > LONGEST { LONGEST / size } else { 1.0 };
        while t * size > 1e-12 || t == 1.0 {
            for (s, bend) in self.bends.iter_mut().enumerate() {
                *bend = self.trial[s].moved(self.steps[s] * t);
            }
            if self.bends.iter().all(|bend| bend.is_valid()) {
                let next = self.evaluate(sections, targets);
                if next <= merit + 1e-4 * t * slope + noise {
                    return Some((size, next));
                }
            }
            t *= 0.5;
        }
        self.bends.copy_from_slice(&self.trial);
        self.evaluate(sections, targets);
        None
    }

    /// Whether no small move reduces the sum of squared excess lengths.
    fn is_least_squares(&self, sections: &[Section], targets: &[f64]) -> bool {
        let (mut rest, mut total) = (0.0, 0.0);
        let mut first = 0;
        for section in sections {
            let mut sum = Vec3::ZERO;
            for (k, passage) in section.passages.iter().enumerate() {
                let excess = (self.lengths[passage.cable] - targets[passage.cable]).max(0.0);
                let arm = self.passages[first + k].gradient * excess;
                sum += arm;
                total += arm.norm();
            }
            rest += sum.norm();
            first += section.passages.len();
        }
        total > 0.0 && rest <= 1e-6 * total
    }
}

/// The factors of a matrix, moved towards `rest` as far as it takes to make it positive definite.
fn positive_factors(matrix: Sym3, rest: Sym3) -> Ldlt3 {
    if let Some(factors) = matrix.ldlt() {
        return factors;
    }
    let size = [matrix.xx, matrix.yy, matrix.zz].into_iter().map(f64::abs).fold(rest.xx, f64::max);
    let mut shift = 1e-3 * size / rest.xx;
    while shift.is_finite() {
        if let Some(factors) = (matrix + rest * shift).ldlt() {
            return factors;
        }
        shift *= 4.0;
    }
    // Reached only by a matrix that is not finite: the null step, which ends the iteration.
    Ldlt3::default()
}
