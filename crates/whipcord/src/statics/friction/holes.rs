//! The holes of a robot, and what they remember.

use super::trail::Trail;
use crate::robot::Robot;
use crate::solution::SlipState;
use crate::statics::command::Command;

/// Of the greatest tension: what rounding leaves of a bound that is met.
const MET: f64 = 1e-9;

/// Drives whose motion is computed elsewhere, beside the holes.
#[derive(Clone, Debug, Default)]
pub(crate) struct Drives {
    /// The cables whose first passage is outside of the robot, from the drive to the hole in the base; of no length.
    pub outside: Vec<usize>,
    /// Pairs of these cables: by how much in m a tension of 1 N at the drive of the second lengthens the first.
    pub yields: Vec<(usize, usize, f64)>,
}

/// What does not change from step to step.
#[derive(Clone, Debug)]
pub(crate) struct Holes {
    /// Passages of each cable from the base on.
    pub of_cable: Vec<Vec<usize>>,
    /// Friction coefficients of the cables.
    pub coefficients: Vec<f64>,
    /// `ℓ⁰/EA` of every passage in m/N.
    pub yielding: Vec<f64>,
    /// Compliance in m/N of drive and cable outside the robot, of each cable: it has the tension of the first passage.
    pub outside: Vec<f64>,
    /// `Dᵢ` of the robot at rest.
    pub at_rest: Vec<f64>,
    /// Of the backbone, in m.
    pub length: f64,
    /// By how much a tension of 1 N shortens a cable, in m: its order of magnitude, `κ` of eq. (2).
    pub compliance: f64,
    /// Of the greatest tension: a bound of eq. (1) that is nearer is met.
    pub met: f64,
    pub drives: Drives,
}

impl Holes {
    /// Of passages from the base to the tip, numbered in this order: the cable of each, and its length in m on the robot at
    /// rest.
    pub fn new(
        robot: &Robot,
        passages: impl Iterator<Item = (usize, f64)>,
        length: f64,
        compliance: f64,
    ) -> Self {
        let cables = robot.cables();
        let mut of_cable = vec![Vec::new(); cables.len()];
        let (mut at_rest, mut yielding) = (Vec::new(), Vec::new());
        for (p, (cable, rest_length)) in passages.enumerate() {
            of_cable[cable].push(p);
            let stiffness = cables[cable].axial_stiffness;
            yielding.push(stiffness.map_or(0.0, |stiffness| rest_length / stiffness));
            at_rest.push(rest_length);
        }
        let coefficients = cables.iter().map(|cable| cable.friction.unwrap_or(0.0)).collect();
        let outside = (0..cables.len()).map(|cable| robot.outside_compliance(cable)).collect();
        let mut holes = Self {
            of_cable,
            coefficients,
            yielding,
            outside,
            at_rest,
            length,
            compliance,
            met: MET,
            drives: Drives::default(),
        };
        let lengths = holes.at_rest.clone();
        holes.at_rest = holes.beyond(&lengths, &vec![0.0; lengths.len()]);
        holes
    }

    /// Of cables that rub nowhere, and so have one passage each: the compliance in m/N of each outside the robot, and its length in m on
    /// the robot at rest.
    pub fn of_whole_cables(
        robot: &Robot,
        cables: impl Iterator<Item = (usize, f64)>,
        compliance: f64,
    ) -> Self {
        let (mut yielding, mut outside, mut at_rest) = (Vec::new(), Vec::new(), Vec::new());
        for (cable, rest_length) in cables {
            let stiffness = robot.cables()[cable].axial_stiffness;
            yielding.push(stiffness.map_or(0.0, |stiffness| rest_length / stiffness));
            outside.push(robot.outside_compliance(cable));
            at_rest.push(rest_length);
        }
        Self {
            of_cable: (0..at_rest.len()).map(|cable| vec![cable]).collect(),
            coefficients: vec![0.0; at_rest.len()],
            yielding,
            outside,
            at_rest,
            length: robot.backbone().length,
            compliance,
            met: MET,
            drives: Drives::default(),
        }
    }

    /// All holes, each with its cable, its place on it, and the passage behind it.
    pub fn all(&self) -> impl Iterator<Item = ((usize, usize), usize)> + '_ {
        self.of_cable.iter().enumerate().flat_map(|(cable, passages)| {
            passages.iter().enumerate().map(move |(place, &p)| ((cable, place), p))
        })
    }

    /// What the drive of a cable leaves for the part beyond the hole in the base: `D₁ − T₁ c`, with the compliance c outside.
    pub fn at_drive(&self, cable: usize, beyond: &[f64], tensions: &[f64]) -> f64 {
        let first = self.of_cable[cable][0];
        let stretched = tensions[first] * self.outside[cable];
        let yielded: f64 = self.yielded(cable).map(|(other, by)| by * tensions[other]).sum();
        beyond[first] - stretched - yielded
    }

    /// By how much in m the tension of 1 N in each of these passages lengthens what the drive of a cable leaves, beside the stretch.
    pub fn yielded(&self, cable: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let own = self.drives.yields.iter().filter(move |(of, ..)| *of == cable);
        own.map(|&(_, other, by)| (self.of_cable[other][0], by))
    }

    /// Whether the near end of the first passage of a cable is a drive, not a hole.
    pub fn starts_outside(&self, cable: usize) -> bool {
        self.drives.outside.contains(&cable)
    }

    /// Whether any cable rubs.
    pub fn rub(&self) -> bool {
        self.coefficients.iter().any(|&coefficient| coefficient > 0.0)
    }

    /// Number of all passages.
    pub fn count(&self) -> usize {
        self.at_rest.len()
    }

    /// `Dᵢ` of every passage, the unstretched cable beyond its near hole, at these lengths and tensions of passages.
    pub fn beyond(&self, lengths: &[f64], tensions: &[f64]) -> Vec<f64> {
        let mut beyond = vec![0.0; lengths.len()];
        self.beyond_into(lengths, tensions, &mut beyond);
        beyond
    }

    pub fn beyond_into(&self, lengths: &[f64], tensions: &[f64], beyond: &mut Vec<f64>) {
        beyond.resize(lengths.len(), 0.0);
        for passages in &self.of_cable {
            let mut sum = 0.0;
            for &p in passages.iter().rev() {
                sum += lengths[p] - tensions[p] * self.yielding[p];
                beyond[p] = sum;
            }
        }
    }

    /// The values that a cable with friction has at its holes, of those of all passages.
    pub fn of<T: Copy>(&self, cable: usize, of_passages: &[T], into: &mut Vec<T>) {
        into.clear();
        if self.coefficients[cable] > 0.0 && !of_passages.is_empty() {
            into.extend(self.of_cable[cable].iter().map(|&p| of_passages[p]));
        }
    }

    /// The lengths of the cables of those of all passages, in m.
    pub fn cable_lengths(&self, of_passages: &[f64], into: &mut Vec<f64>) {
        into.clear();
        let length = |passages: &Vec<usize>| passages.iter().map(|&p| of_passages[p]).sum::<f64>();
        into.extend(self.of_cable.iter().map(length));
    }

    /// Calls `lock` with every passage that keeps its length however the robot moves a little, and how far it gives
    /// in m/N: the pieces of a cable that rubs and sticks in all holes, well within eq. (1).
    ///
    /// # Errors
    /// [`Slides`] where a cable slides in a hole or is about to: its tensions then change with the
    /// angles, and the way it slides with the motion.
    pub fn lock<S>(
        &self,
        commands: &[Command],
        turns: &[f64],
        history: &History<S>,
        mut lock: impl FnMut(usize, f64),
    ) -> Result<(), Slides> {
        /// A hole that is so near to letting the cable slide, of its grip, counts as sliding.
        const SLIPS: f64 = 1e-6;
        let History { tensions, slip_states, .. } = history;
        for (cable, passages) in self.of_cable.iter().enumerate() {
            if self.coefficients[cable] == 0.0 {
                continue;
            }
            let outside = usize::from(self.starts_outside(cable));
            for (place, &p) in passages.iter().enumerate() {
                if tensions[p] <= 0.0 {
                    continue;
                }
                if place < outside {
                    continue;
                }
                let incoming = match (place.checked_sub(1), commands[cable]) {
                    // What winds the cable up holds it, whatever the base hole does.
                    (_, Command::Length { .. }) if place == outside => None,
                    (Some(before), _) => Some(tensions[passages[before]]),
                    (None, Command::Tension(given)) => Some(given),
                    (None, Command::Length { .. }) => None,
                };
                if let Some(incoming) = incoming {
                    let grip = self.coefficients[cable] * turns[p];
                    let slips = (tensions[p] / incoming).ln().abs() >= (1.0 - SLIPS) * grip;
                    if slips || slip_states[p] != SlipState::Sticks {
                        return Err(Slides);
                    }
                }
                lock(p, self.yielding[p]);
            }
        }
        Ok(())
    }
}

/// A cable slides in a hole or is about to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Slides;

/// What the holes remember of the steps before, and the shape that they left.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct History<S> {
    /// `Dᵢ` of every passage, in m; empty before the first step.
    pub beyond: Vec<f64>,
    /// Tension of every passage in N.
    pub tensions: Vec<f64>,
    /// Tension below the base disk, by cable.
    pub base: Vec<f64>,
    /// How the cable stands in the near hole of every passage.
    pub slip_states: Vec<SlipState>,
    /// `None` before the first step.
    pub shape: Option<S>,
    /// The ends of all substeps, where derivatives are asked for.
    pub trail: Option<Trail<S>>,
}

impl<S> Default for History<S> {
    fn default() -> Self {
        Self {
            beyond: Vec::new(),
            tensions: Vec::new(),
            base: Vec::new(),
            slip_states: Vec::new(),
            shape: None,
            trail: None,
        }
    }
}

impl<S> History<S> {
    /// Of the robot at rest.
    pub fn at_rest(holes: &Holes) -> Self {
        Self {
            beyond: holes.at_rest.clone(),
            tensions: vec![0.0; holes.count()],
            base: vec![0.0; holes.of_cable.len()],
            slip_states: vec![SlipState::Sticks; holes.count()],
            shape: None,
            trail: None,
        }
    }

    /// Before the first step, and to keep the ends of all substeps.
    pub fn with_trail() -> Self {
        let trail = Some(Trail::default());
        Self { trail, ..Self::default() }
    }

    /// Whether no step was taken.
    pub fn is_empty(&self) -> bool {
        self.beyond.is_empty()
    }

    /// Moves on to these tensions, `Dᵢ` and `φᵢ` of all passages; a slip of less than `least` in m is none.
    pub(super) fn advance(
        &mut self,
        holes: &Holes,
        commands: &[Command],
        (tensions, beyond, turns): (&[f64], &[f64], &[f64]),
        least: f64,
        shape: S,
    ) {
        for (p, slip_state) in self.slip_states.iter_mut().enumerate() {
            *slip_state = SlipState::after(self.beyond[p] - beyond[p], least);
        }
        for (cable, command) in commands.iter().enumerate() {
            let first = holes.of_cable[cable][0];
            let (wrap, tension) = (holes.coefficients[cable] * turns[first], tensions[first]);
            let (least, most) = (tension * (-wrap).exp(), tension * wrap.exp());
            self.base[cable] = match (*command, self.slip_states[first]) {
                (Command::Tension(given), _) => given,
                // Pulled in, the base bears more than the first piece.
                (Command::Length { .. }, SlipState::Pulled) => most,
                (Command::Length { .. }, SlipState::Released) => least,
                (Command::Length { .. }, SlipState::Sticks) => self.base[cable].clamp(least, most),
            };
        }
        self.beyond.clear();
        self.beyond.extend_from_slice(beyond);
        self.tensions.clear();
        self.tensions.extend_from_slice(tensions);
        self.shape = Some(shape);
    }
}

impl SlipState {
    pub(super) const fn after(slip: f64, least: f64) -> Self {
        if slip > least {
            Self::Pulled
        } else if slip < -least {
            Self::Released
        } else {
            Self::Sticks
        }
    }
}
