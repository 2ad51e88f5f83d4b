//! How an answer changes with the lengths that are prescribed: eqs. (11) and (12) of
//! `docs/theory/four-bar.md`.

use whipcord_numerics::{Ldlt3, Pose, SingularValues, Sym3, Twist, Vec3};

use super::bend::Bend;
use super::model::FourBar;
use super::options::{LengthRule, Objective};
use super::section::Section;
use super::workspace::{LOOSE, Workspace};
use crate::case::Case;
use crate::error::SolveError;
use crate::kind::ModelKind;
use crate::refusal;
use crate::solution::Solution;

/// How an answer of the four-bar model changes with how much each cable is shortened.
///
/// A cable that is as long as prescribed stays so: where it is just about to get slack, the
/// derivative is that of pulling it. Cables that depend on one another, such as three straight ones,
/// can only be shortened together; of a shortening that contradicts the others the part counts that
/// does not, as in the answer itself. A slack cable changes nothing.
///
/// ```
/// use whipcord::four_bar::{FourBar, Options, Workspace};
/// use whipcord::{Backbone, Cable, Case, Disks, Robot, Routing, Shortening};
///
/// let cable = Cable::new("pull", Routing::Straight { angle: 0.0, radius: 0.008 });
/// let robot = Robot::new(Backbone::new(0.1), Disks::equally_spaced(0.1, 6, 0.008), vec![cable])?;
/// let model = FourBar::new(&robot, &Options::default())?;
/// let case = Case::with_shortenings(&[Shortening::Length(0.005)]);
/// let (solution, derivatives) = model.solve_with_derivatives(&case, &mut Workspace::default())?;
/// // Pulling the cable at +x turns the tip about y.
/// let motion = derivatives.disk(5)[0];
/// assert!(motion.angular.y > 0.0 && motion.linear.x > 0.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Derivatives {
    cables: usize,
    /// By disk and station, then by cable.
    disks: Vec<Twist>,
    stations: Vec<Twist>,
    /// By rows of lengths.
    lengths: Vec<f64>,
}

impl Derivatives {
    /// How a disk, counted from 0 at the base, moves by metre of shortening of each cable: the velocity
    /// of its centre in m/m and its angular velocity in rad/m, in the frame in which the shape is given.
    ///
    /// # Panics
    /// When there is no such disk.
    #[must_use]
    pub fn disk(&self, disk: usize) -> &[Twist] {
        &self.disks[disk * self.cables..(disk + 1) * self.cables]
    }

    /// The same of a station of [`Solution::shape`], from 0.
    ///
    /// # Panics
    /// When there is no such station.
    #[must_use]
    pub fn station(&self, station: usize) -> &[Twist] {
        &self.stations[station * self.cables..(station + 1) * self.cables]
    }

    /// How the length of each cable changes by metre of shortening of each cable, in m/m: −1 for one that is
    /// as long as prescribed, by its own shortening, and what the robot does to a slack one.
    ///
    /// # Panics
    /// When there is no such cable.
    #[must_use]
    pub fn length(&self, cable: usize) -> &[f64] {
        &self.lengths[cable * self.cables..(cable + 1) * self.cables]
    }
}

impl FourBar {
    /// The shape under a case, and how it changes with the prescribed lengths.
    ///
    /// # Errors
    /// As [`Self::solve`]; [`SolveError::Unsupported`] for the objective `as-printed` and for lengths that
    /// contradict each other, where the answer is a compromise; [`SolveError::NoDerivatives`] at the end of a
    /// branch of shapes.
    pub fn solve_with_derivatives(
        &self,
        case: &Case,
        workspace: &mut Workspace,
    ) -> Result<(Solution, Derivatives), SolveError> {
        if self.options.objective == Objective::AsPrinted {
            return Err(unsupported(
                "with the objective as-printed",
                "take the objective coupler-angle or strain-energy",
            ));
        }
        refusal::derivatives_among_obstacles(ModelKind::FourBar, case)?;
        let mut solution = Solution::empty(ModelKind::FourBar);
        let compromise = self.solve_and_tell(case, workspace, &mut solution)?;
        if compromise {
            return Err(contradiction());
        }
        let derivatives = self.derivatives(case.base, workspace)?;
        Ok((solution, derivatives))
    }

    fn derivatives(&self, base: Pose, workspace: &Workspace) -> Result<Derivatives, SolveError> {
        let cables = self.initial_lengths.len();
        let bends: Vec<Bend> = workspace.joints.iter().map(|joint| joint.bend()).collect();
        // By section, then by cable.
        let mut rates = vec![Vec3::ZERO; self.sections.len() * cables];
        match self.options.lengths {
            LengthRule::Proportional | LengthRule::Equal => {
                let mut pulls = &workspace.pulls[..];
                let rows = rates.chunks_mut(cables.max(1));
                for ((section, bend), rates) in self.sections.iter().zip(&bends).zip(rows) {
                    let (own, rest) = pulls.split_at(section.passages.len());
                    pulls = rest;
                    let (section, bend) =
                        (core::slice::from_ref(section), core::slice::from_ref(bend));
                    let group = Group::new(section, bend, own).ok_or(SolveError::NoDerivatives)?;
                    let share = |cable: usize, initial: f64| {
                        let (target, whole) =
                            (workspace.targets[cable], self.initial_lengths[cable]);
                        let there = self.share(cable, initial, target);
                        // A share is linear in the target.
                        (there, (there - self.share(cable, initial, target - whole)) / whole)
                    };
                    group.rates(cables, share, rates);
                }
            }
            LengthRule::Free => {
                let group = Group::new(&self.sections, &bends, &workspace.pulls)
                    .ok_or(SolveError::NoDerivatives)?;
                group.rates(cables, |cable, _| (workspace.targets[cable], 1.0), &mut rates);
            }
        }
        Ok(self.moved(base, &bends, &rates))
    }

    /// What all moves, from how the coordinates of the sections change with each cable.
    fn moved(&self, base: Pose, bends: &[Bend], rates: &[Vec3]) -> Derivatives {
        let cables = self.initial_lengths.len();
        let mut lengths = vec![0.0; cables * cables];
        let mut disks = vec![Twist::default(); (bends.len() + 1) * cables];
        let mut poses = vec![base];
        for (i, (section, &bend)) in self.sections.iter().zip(bends).enumerate() {
            let below = poses[i];
            poses.push(below * bend.pose(section.length, section.chord));
            let motion = bend.motion_at(1.0, section.length, section.chord);
            let turn = bend.turn();
            for j in 0..cables {
                let rate = rates[i * cables + j];
                disks[(i + 1) * cables + j] =
                    carried(&below, &poses[i + 1], disks[i * cables + j], &motion, rate);
            }
            for passage in &section.passages {
                let length = passage.length(&turn, section.length, section.chord);
                for j in 0..cables {
                    lengths[passage.cable * cables + j] +=
                        length.gradient.dot(rates[i * cables + j]);
                }
            }
        }
        let mut stations = Vec::with_capacity(self.stations.len() * cables);
        for &at in &self.stations {
            let (i, t) = self.robot.disks().locate(at);
            let (section, bend) = (&self.sections[i], bends[i]);
            let there = poses[i] * bend.pose_at(t, section.length, section.chord);
            let motion = bend.motion_at(t, section.length, section.chord);
            stations.extend((0..cables).map(|j| {
                let k = i * cables + j;
                carried(&poses[i], &there, disks[k], &motion, rates[k])
            }));
        }
        Derivatives { cables, disks, stations, lengths }
    }
}

/// Lengths that contradict each other have no derivatives.
pub(super) fn contradiction() -> SolveError {
    unsupported(
        "of lengths that contradict each other",
        "give lengths that the cables can have together",
    )
}

fn unsupported(what: &'static str, advice: &'static str) -> SolveError {
    SolveError::Unsupported {
        model: ModelKind::FourBar,
        path: "a request for derivatives".to_owned(),
        what,
        advice,
    }
}

/// Motion of the place `there` of a section: what the lower disk carries it along with, and what the section
/// adds when its coordinates change at this rate.
fn carried(below: &Pose, there: &Pose, of_below: Twist, motion: &[Twist; 3], rate: Vec3) -> Twist {
    let [a, b, c] = motion;
    let own = |part: fn(&Twist) -> Vec3| {
        below.rotation.rotate(part(a) * rate.x + part(b) * rate.y + part(c) * rate.z)
    };
    let arm = there.position - below.position;
    Twist {
        linear: of_below.linear + of_below.angular.cross(arm) + own(|twist| twist.linear),
        angular: of_below.angular + own(|twist| twist.angular),
    }
}

/// Sections that share the lengths of their cables, linearised at their minimum, eq. (11).
struct Group<'a> {
    sections: &'a [Section],
    /// `∇²F + Σλ∇²ℓ` of each section.
    factors: Vec<Ldlt3>,
    /// Length and gradient of each passage, section by section.
    lengths: Vec<(f64, Vec3)>,
}

/// Directions of the lengths that the sections yield to by less than this, relative to the most, are ones that
/// cables do not have.
const DEPENDENT: f64 = 1e-10;

/// How often the square of the constraints is added with ten times the weight.
const ATTEMPTS: usize = 8;

impl<'a> Group<'a> {
    /// `pulls` are the multipliers of the passages. `None` where the sections are not at a minimum.
    fn new(sections: &'a [Section], bends: &[Bend], pulls: &[f64]) -> Option<Self> {
        let mut lengths = Vec::with_capacity(pulls.len());
        let mut factors = Vec::with_capacity(sections.len());
        let mut pulls = pulls.iter();
        for (section, &bend) in sections.iter().zip(bends) {
            let turn = bend.turn();
            let mut hessian = section.measure(bend).hessian;
            let mut squares = Sym3::default();
            for (passage, &pull) in section.passages.iter().zip(&mut pulls) {
                let length = passage.length(&turn, section.length, section.chord);
                hessian = hessian + length.hessian * pull;
                if pull > 0.0 {
                    squares = squares + Sym3::square(length.gradient);
                }
                lengths.push((length.value, length.gradient));
            }
            // A section by itself may be a minimum by its constraints alone. Their square changes no motion
            // that keeps to them.
            let size = [squares.xx, squares.yy, squares.zz].into_iter().fold(0.0, f64::max);
            let attempts = if sections.len() == 1 && size > 0.0 { ATTEMPTS } else { 0 };
            let weight = section.rest_hessian().xx / size;
            factors.push(hessian.ldlt().or_else(|| {
                let weights = (0..attempts).map(|k| weight * 10_f64.powi(k as i32));
                weights.map(|weight| (hessian + squares * weight).ldlt()).find_map(|found| found)
            })?);
        }
        Some(Self { sections, factors, lengths })
    }

    /// How the coordinates change by metre of shortening of each cable, by section, then by cable, where `share`
    /// says how long a cable of this number and initial length is to be in the group, and by how much of a metre
    /// of the whole.
    fn rates(&self, cables: usize, share: impl Fn(usize, f64) -> (f64, f64), rates: &mut [Vec3]) {
        let passages = || {
            self.sections
                .iter()
                .enumerate()
                .flat_map(|(s, section)| section.passages.iter().map(move |passage| (s, passage)))
        };
        let (mut length, mut initial) = (vec![0.0; cables], vec![0.0; cables]);
        for ((_, passage), &(own, _)) in passages().zip(&self.lengths) {
            length[passage.cable] += own;
            initial[passage.cable] += passage.initial;
        }
        let binding: Vec<(usize, f64)> = (0..cables)
            .filter_map(|cable| {
                let (target, part) = share(cable, initial[cable]);
                let binds = length[cable] > 0.0 && length[cable] >= target * (1.0 - LOOSE);
                binds.then_some((cable, part))
            })
            .collect();
        let m = binding.len();
        // Arms `g` of the binding cables and `H⁻¹g`, by section, then by cable.
        let row = |cable: usize| binding.iter().position(|(of, _)| *of == cable);
        let mut arms = vec![Vec3::ZERO; self.sections.len() * m];
        for ((s, passage), (_, gradient)) in passages().zip(&self.lengths) {
            if let Some(i) = row(passage.cable) {
                arms[s * m + i] = *gradient;
            }
        }
        let yielding: Vec<Vec3> =
            (0..arms.len()).map(|k| self.factors[k / m].solve(arms[k])).collect();
        let mut schur = vec![0.0; m * m];
        for (of, by) in arms.chunks(m.max(1)).zip(yielding.chunks(m.max(1))) {
            for (entry, k) in schur.iter_mut().zip(0..) {
                *entry += of[k / m].dot(by[k % m]);
            }
        }
        let seen = SingularValues::of(m, &schur);
        for (j, (cable, part)) in binding.iter().enumerate() {
            for k in 0..m {
                let (value, direction) = (seen.values[k], seen.direction(k));
                if value <= DEPENDENT * seen.values[0] {
                    continue;
                }
                let weight = -part * direction[j] / value;
                for s in 0..self.sections.len() {
                    let of = yielding[s * m..].iter().zip(direction);
                    let step = of.fold(Vec3::ZERO, |sum, (by, d)| sum + *by * *d);
                    rates[s * cables + cable] += step * weight;
                }
            }
        }
    }
}
