//! The sections under wrenches on their cross-sections: where the energy of bending and twist, less
//! the work of the wrenches, is stationary among the shapes that the cables allow; eqs. (14) to (16).

use whipcord_numerics::{DenseLu, Pose, Twist, Vec3};

use super::bend::Bend;
use super::section::Section;
use crate::shape::{Solution, Wrench};

/// A wrench in the base frame, in the measure of the model, at a fraction of a section.
#[derive(Clone, Copy, Debug)]
pub(super) struct Load {
    pub section: usize,
    /// From 0 to 1.
    pub part: f64,
    pub wrench: Wrench,
}

/// An equilibrium, and its linearisation.
#[derive(Clone, Debug, Default)]
pub(super) struct ContactResponse {
    pub bends: Vec<Bend>,
    /// By cable.
    pub multipliers: Vec<f64>,
    pub lengths: Vec<f64>,
    /// Of the disks, the base's first, in the base frame.
    pub disks: Vec<Pose>,
    /// How the end of each section moves with its coordinates, base frame.
    motions: Vec<[Twist; 3]>,
    active: Vec<usize>,
    gradient: Vec<f64>,
    hessian: Vec<f64>,
    lu: DenseLu,
    /// Gradients of the lengths of the active cables, then `H⁻¹` times them; by cable.
    arms: Vec<Vec<f64>>,
    eased: Vec<Vec<f64>>,
    schur: Vec<f64>,
    schur_lu: DenseLu,
    /// The Newton step from where it stands, and the multipliers that it leads to.
    left: Vec<f64>,
    pulls: Vec<f64>,
    /// How the loads' places move with the coordinates, by rows.
    jacobian: Vec<f64>,
    /// `Σ v × F` and `Σ ω × m` of the loads by coordinate.
    torques: Vec<[Vec3; 2]>,
}

/// The equations have no linearisation that could be solved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct SingularSystem;

/// Longest step of a coordinate.
const LONGEST: f64 = 0.3;
/// Cables that depend on one another yield by this, relative to the most.
const YIELD: f64 = 1e-12;

impl ContactResponse {
    /// From rest.
    pub fn reset(&mut self, sections: &[Section], cables: usize) {
        self.bends.clear();
        self.bends.extend(sections.iter().map(|section| section.rest));
        self.multipliers.clear();
        self.multipliers.resize(cables, 0.0);
    }

    /// At an answer.
    pub fn at(bends: Vec<Bend>, multipliers: Vec<f64>) -> Self {
        Self { bends, multipliers, ..Self::default() }
    }

    /// From the disks of an answer.
    pub fn start_from(&mut self, sections: &[Section], answer: &Solution) {
        self.reset(sections, 0);
        let pairs = answer.disks.poses.windows(2);
        for (bend, pair) in self.bends.iter_mut().zip(pairs) {
            let rotation = pair[0].rotation.conjugate() * pair[1].rotation;
            *bend = Bend::of(rotation).unwrap_or(*bend);
        }
    }

    /// Where the disks are.
    fn place(&mut self, sections: &[Section]) {
        self.disks.clear();
        let mut pose = Pose::IDENTITY;
        self.disks.push(pose);
        self.motions.clear();
        for (section, bend) in sections.iter().zip(&self.bends) {
            let motion = bend.motion_at(1.0, section.length, section.chord);
            self.motions.push(motion.map(|twist| turned(&pose, twist)));
            pose = pose * bend.pose(section.length, section.chord);
            self.disks.push(pose);
        }
    }

    /// Linearises the equations where it stands. Cables that are longer than their targets pull.
    pub fn linearise(
        &mut self,
        sections: &[Section],
        targets: &[f64],
        loads: &[Load],
    ) -> Result<(), SingularSystem> {
        let (count, cables) = (sections.len(), targets.len());
        let n = 3 * count;
        self.place(sections);
        self.gradient.clear();
        self.gradient.resize(n, 0.0);
        self.hessian.clear();
        self.hessian.resize(n * n, 0.0);
        self.lengths.clear();
        self.lengths.resize(cables, 0.0);
        self.arms.resize_with(cables, Vec::new);
        for arm in &mut self.arms {
            arm.clear();
            arm.resize(n, 0.0);
        }
        for (s, (section, bend)) in sections.iter().zip(&self.bends).enumerate() {
            let measure = section.measure(*bend);
            let mut hessian = measure.hessian;
            let turn = bend.turn();
            for passage in &section.passages {
                let length = passage.length(&turn, section.length, section.chord);
                self.lengths[passage.cable] += length.value;
                hessian = hessian + length.hessian * self.multipliers[passage.cable];
                let arm = <[f64; 3]>::from(length.gradient);
                self.arms[passage.cable][3 * s..3 * s + 3].copy_from_slice(&arm);
            }
            let rows = [
                [hessian.xx, hessian.yx, hessian.zx],
                [hessian.yx, hessian.yy, hessian.zy],
                [hessian.zx, hessian.zy, hessian.zz],
            ];
            for (a, row) in rows.iter().enumerate() {
                self.gradient[3 * s + a] = measure.gradient[a];
                let at = (3 * s + a) * n + 3 * s;
                self.hessian[at..at + 3].copy_from_slice(row);
            }
        }
        if !loads.is_empty() {
            self.add_loads(sections, loads);
        }
        self.lu.factor(n, &self.hessian).map_err(|_| SingularSystem)?;
        // A cable pulls that would be too long without its pull.
        let stiff = 1.0 / (sections.iter().map(|s| s.length).sum::<f64>().powi(2));
        self.active.clear();
        for (c, &target) in targets.iter().enumerate() {
            if self.multipliers[c] + stiff * (self.lengths[c] - target) > 0.0 {
                self.active.push(c);
            }
        }
        let m = self.active.len();
        self.eased.resize_with(cables, Vec::new);
        for &c in &self.active {
            self.eased[c].clone_from(&self.arms[c]);
            self.lu.solve(&mut self.eased[c]);
        }
        self.schur.clear();
        for &i in &self.active {
            for &j in &self.active {
                self.schur.push(dot(&self.arms[i], &self.eased[j]));
            }
        }
        let most = (0..m).map(|i| self.schur[i * m + i].abs()).fold(0.0, f64::max);
        for i in 0..m {
            self.schur[i * m + i] += YIELD * most;
        }
        self.schur_lu.factor(m, &self.schur).map_err(|_| SingularSystem)?;
        // H δq + Aᵀμ = −∇F + Q and A δq = targets − lengths
        self.left.clear();
        self.left.extend(self.gradient.iter().map(|g| -g));
        self.lu.solve(&mut self.left);
        self.pulls.clear();
        for &c in &self.active {
            let excess = self.lengths[c] - targets[c];
            self.pulls.push(excess + dot(&self.arms[c], &self.left));
        }
        self.schur_lu.solve(&mut self.pulls);
        for (&c, &pull) in self.active.iter().zip(&self.pulls) {
            self.left.iter_mut().zip(&self.eased[c]).for_each(|(x, y)| *x -= pull * y);
        }
        if self.left.iter().all(|x| x.is_finite()) { Ok(()) } else { Err(SingularSystem) }
    }

    /// The largest coordinate of the step that is left.
    pub fn unsettled(&self) -> f64 {
        self.left.iter().fold(0.0, |most, x| most.max(x.abs()))
    }

    /// Takes the work of the wrenches off the energy: eqs. (15) and (16).
    fn add_loads(&mut self, sections: &[Section], loads: &[Load]) {
        let n = 3 * sections.len();
        self.torques.clear();
        self.torques.resize(n, [Vec3::ZERO; 2]);
        for load in loads {
            let Wrench { force, moment } = load.wrench;
            let at = self.pose_at(sections, load.section, load.part).position;
            for s in 0..=load.section {
                let moved = self.moved(sections, s, load, at);
                for (a, twist) in moved.iter().enumerate() {
                    let work = force.dot(twist.linear) + moment.dot(twist.angular);
                    self.gradient[3 * s + a] -= work;
                    let [by_force, by_moment] = &mut self.torques[3 * s + a];
                    *by_force += twist.linear.cross(force);
                    *by_moment += twist.angular.cross(moment);
                }
            }
            self.add_own(sections, load, at);
        }
        let last = loads.iter().map(|load| load.section).max().unwrap_or(0);
        for s in 0..=last {
            for a in 0..3 {
                let spin = self.motions[s][a].angular;
                for k in 3 * (s + 1)..3 * (last + 1) {
                    let [by_force, by_moment] = self.torques[k];
                    self.hessian[(3 * s + a) * n + k] -= spin.dot(by_force);
                    self.hessian[k * n + 3 * s + a] -= spin.dot(by_force + by_moment);
                }
            }
        }
    }

    /// What a load adds to a section's own block: differences of the motion with the section's
    /// coordinates serve, for they set only how fast the iteration is.
    fn add_own(&mut self, sections: &[Section], load: &Load, at: Vec3) {
        const H: f64 = 1e-6;
        let n = 3 * sections.len();
        let Wrench { force, moment } = load.wrench;
        for s in 0..=load.section {
            let (section, bend, below) = (&sections[s], self.bends[s], self.disks[s]);
            let inside = s == load.section;
            let part = if inside { load.part } else { 1.0 };
            let arm = if inside { Vec3::ZERO } else { at - self.disks[s + 1].position };
            let about = moment + arm.cross(force);
            let own = self.motions[s];
            for b in 0..3 {
                let mut step = [0.0; 3];
                step[b] = H;
                let motion =
                    |step: Vec3| bend.moved(step).motion_at(part, section.length, section.chord);
                let (after, before) = (motion(Vec3::from(step)), motion(-Vec3::from(step)));
                let swing = if inside { Vec3::ZERO } else { own[b].angular.cross(arm) };
                for a in 0..3 {
                    let rate = |part: fn(&Twist) -> Vec3| {
                        let change = (part(&after[a]) - part(&before[a])) / (2.0 * H);
                        below.rotation.rotate(change)
                    };
                    let linear = rate(|twist| twist.linear);
                    let angular = rate(|twist| twist.angular);
                    self.hessian[(3 * s + a) * n + 3 * s + b] -= force.dot(linear)
                        + about.dot(angular)
                        + own[a].angular.dot(swing.cross(force));
                }
            }
        }
    }

    /// How the place of a load, at this position, moves with the coordinates of a section below it.
    fn moved(&self, sections: &[Section], s: usize, load: &Load, at: Vec3) -> [Twist; 3] {
        if s == load.section {
            if load.part == 1.0 {
                return self.motions[s];
            }
            let section = &sections[s];
            let motion = self.bends[s].motion_at(load.part, section.length, section.chord);
            return motion.map(|twist| turned(&self.disks[s], twist));
        }
        let arm = at - self.disks[s + 1].position;
        self.motions[s]
            .map(|Twist { linear, angular }| Twist { linear: linear + angular.cross(arm), angular })
    }

    /// Pose of the cross-section at a fraction of a section, base frame.
    pub fn pose_at(&self, sections: &[Section], s: usize, part: f64) -> Pose {
        if part == 1.0 {
            return self.disks[s + 1];
        }
        let section = &sections[s];
        self.disks[s] * self.bends[s].pose_at(part, section.length, section.chord)
    }

    /// Takes a part of the step that is left, with what changes of the wrenches that it was linearised with do.
    pub fn advance(&mut self, changes: impl Iterator<Item = f64>, part: f64) {
        let n = self.left.len();
        let mut step = self.left.clone();
        let mut pulls = self.pulls.clone();
        let mut contact_response = vec![0.0; n];
        for (row, change) in self.jacobian.chunks(n).zip(changes) {
            contact_response.iter_mut().zip(row).for_each(|(x, y)| *x += change * y);
        }
        self.yield_to(&mut contact_response, Some(&mut pulls));
        step.iter_mut().zip(&contact_response).for_each(|(x, y)| *x += y);
        let size = step.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        let part = if part * size > LONGEST { LONGEST / size } else { part };
        for (bend, step) in self.bends.iter_mut().zip(step.chunks(3)) {
            let next = bend.moved(Vec3::new(step[0], step[1], step[2]) * part);
            if next.is_valid() {
                *bend = next;
            }
        }
        for (c, multiplier) in self.multipliers.iter_mut().enumerate() {
            let found = self.active.iter().position(|&k| k == c).map_or(0.0, |k| pulls[k]);
            *multiplier += part * (found - *multiplier);
        }
    }

    /// Overwrites generalised forces by the motion that they cause while the cables that pull keep their
    /// lengths, and adds what it changes of their multipliers.
    fn yield_to(&self, column: &mut [f64], pulls: Option<&mut Vec<f64>>) {
        self.lu.solve(column);
        self.hold_cables(column, pulls);
    }

    /// Takes off a motion at constant multipliers what keeps the cables that pull at their lengths.
    fn hold_cables(&self, column: &mut [f64], pulls: Option<&mut Vec<f64>>) {
        let mut changes: Vec<f64> =
            self.active.iter().map(|&c| dot(&self.arms[c], column)).collect();
        self.schur_lu.solve(&mut changes);
        for (&c, &pull) in self.active.iter().zip(&changes) {
            column.iter_mut().zip(&self.eased[c]).for_each(|(x, y)| *x -= pull * y);
        }
        if let Some(pulls) = pulls {
            pulls.iter_mut().zip(&changes).for_each(|(x, y)| *x += y);
        }
    }

    /// Whether an even number of directions, mostly none, is unstable while the loads stay as they are: by the
    /// determinant of the matrix with the cables that are held.
    pub fn stands(&self) -> bool {
        let held = !self.active.is_empty() && self.schur_lu.is_determinant_negative();
        self.lu.is_determinant_negative() == held
    }

    /// How the places of loads move with the coordinates: six rows for each, those of its point first.
    fn fill_jacobian(&self, sections: &[Section], loads: &[Load], jacobian: &mut Vec<f64>) {
        let n = 3 * sections.len();
        jacobian.clear();
        jacobian.resize(6 * loads.len() * n, 0.0);
        for (k, load) in loads.iter().enumerate() {
            let at = self.pose_at(sections, load.section, load.part).position;
            for s in 0..=load.section {
                for (a, twist) in self.moved(sections, s, load, at).iter().enumerate() {
                    let parts = [twist.linear, twist.angular].map(<[f64; 3]>::from);
                    for (row, value) in parts.into_iter().flatten().enumerate() {
                        jacobian[(6 * k + row) * n + 3 * s + a] = value;
                    }
                }
            }
        }
    }

    /// How places move with the coordinates where it was linearised last, as rows.
    pub fn jacobian_of(&self, sections: &[Section], places: &[Load]) -> Vec<f64> {
        let mut jacobian = Vec::new();
        self.fill_jacobian(sections, places, &mut jacobian);
        jacobian
    }

    /// The inverse of the Hessian where it was linearised last, by rows.
    pub fn inverse(&self) -> Vec<f64> {
        let n = self.gradient.len();
        let unit = |j: usize| (0..n).map(|i| if i == j { 1.0 } else { 0.0 }).collect();
        let mut columns: Vec<Vec<f64>> = (0..n).map(unit).collect();
        self.lu.solve_columns(&mut columns);
        let entry = |at: usize| columns[at % n.max(1)][at / n.max(1)];
        (0..n * n).map(entry).collect()
    }

    /// Gradients of the lengths of the cables where it was linearised last.
    pub fn arms(&self) -> &[Vec<f64>] {
        &self.arms
    }

    /// How the places of the loads that it was linearised with move with each component of a wrench on each of
    /// them, into `compliance` by rows; and how with the step that is left, into `drift`.
    pub fn compliance(
        &mut self,
        sections: &[Section],
        loads: &[Load],
        compliance: &mut Vec<f64>,
        drift: &mut Vec<f64>,
    ) {
        let n = 3 * sections.len();
        let rows = 6 * loads.len();
        let mut jacobian = core::mem::take(&mut self.jacobian);
        self.fill_jacobian(sections, loads, &mut jacobian);
        drift.clear();
        drift.extend(jacobian.chunks(n).map(|row| dot(row, &self.left)));
        compliance.clear();
        compliance.resize(rows * rows, 0.0);
        let mut columns: Vec<Vec<f64>> = jacobian.chunks(n).map(<[f64]>::to_vec).collect();
        self.lu.solve_columns(&mut columns);
        for column in &mut columns {
            self.hold_cables(column, None);
        }
        // Several columns side by side: the sums do not wait for one another.
        const LANES: usize = 8;
        let mut block = vec![[0.0; LANES]; n];
        for (first, columns) in (0..rows).step_by(LANES).zip(columns.chunks(LANES)) {
            for (k, lanes) in block.iter_mut().enumerate() {
                for (x, column) in lanes.iter_mut().zip(columns) {
                    *x = column[k];
                }
            }
            for (i, row) in jacobian.chunks(n).enumerate() {
                let mut sums = [0.0; LANES];
                for (f, lanes) in row.iter().zip(&block) {
                    for (sum, x) in sums.iter_mut().zip(lanes) {
                        *sum += f * x;
                    }
                }
                let at = i * rows + first;
                compliance[at..at + columns.len()].copy_from_slice(&sums[..columns.len()]);
            }
        }
        self.jacobian = jacobian;
    }
}

fn turned(pose: &Pose, Twist { linear, angular }: Twist) -> Twist {
    Twist { linear: pose.rotation.rotate(linear), angular: pose.rotation.rotate(angular) }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
