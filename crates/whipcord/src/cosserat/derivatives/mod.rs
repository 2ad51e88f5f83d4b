//! Exact derivatives of an answer (see `docs/theory/derivatives.md`).
//!
//! The answer solves discrete equations; the implicit function theorem gives its derivative from
//! their linearisation. From the inside out: `replay` goes over the steps once more and linearises
//! every stage; `forward` combines the stages of a step for several columns at a time (`lanes`);
//! `elimination` solves the linear problem between base and tip; `partials` says where a parameter
//! enters; `holding` keeps cables at their lengths; `adjoint` is the way back. What is differentiated
//! is the discrete solution, so that derivatives agree with differences of [`super::Cosserat::solve`] on
//! the same steps to rounding, and with those of the rod to its discretisation error.

mod adjoint;
mod elimination;
mod forward;
mod holding;
mod lanes;
mod partials;
mod replay;

use whipcord_numerics::{Twist, Vec3};

use self::adjoint::stage_pulls;
use self::elimination::{Critical, Elimination, NodeChange};
use self::forward::{Effect, Forcing, Maps};
pub(crate) use self::holding::Held;
use self::partials::{Partial, Setting};
use self::replay::{AXES, Answer, Replay};
use super::command::Command;
use super::grid::{Grid, Layout, Step};
use super::loaded::STAGES;
use super::loads::AppliedLoads;
use super::section::Strain;
use super::unloaded::Fault;
use crate::case::Case;
use crate::kinematics::{DrivenBy, Local, Matrix6, Means, Yield};
use crate::parameter::Parameter;
use crate::robot::{Robot, RobotError};
use crate::shape::Wrench;

/// A place of the answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// A station of [`crate::Solution::shape`], from 0.
    Station(usize),
    /// A disk, from 0 at the base.
    Disk(usize),
    /// The tip.
    Tip,
}

/// What is held while something else changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Hold {
    /// What the case gives: the tension of each cable driven by it, the length of the others.
    Commands,
    /// The tension of every cable: motors that control forces, or hung weights.
    Tensions,
    /// The length of every taut cable, as long as its end outside the robot is locked; a cable of
    /// given axial stiffness stretches. A cable without tension stays slack.
    Lengths,
}

/// How an answer changes with one number.
#[derive(Clone, Debug, PartialEq)]
pub struct Change {
    places: Places,
    nodes: Vec<NodeChange>,
    strains: Vec<Strain>,
    /// By cables of the robot.
    lengths: Vec<f64>,
    tensions: Vec<f64>,
}

/// A scalar's sensitivity to the answer: what [`Derivatives::pull_back`] takes. What is not set is
/// zero.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cotangent {
    /// To translation and rotation of places, base frame, as [`Change::twist`] has them.
    pub places: Vec<(Place, Twist)>,
    /// To the length of each cable of the robot; shorter lists leave the others at zero.
    pub lengths: Vec<f64>,
    /// To the tension of each cable of the robot.
    pub tensions: Vec<f64>,
    /// To the wrench at the base.
    pub base_wrench: Wrench,
}

/// The sensitivity of a scalar to everything that can change.
#[derive(Clone, Debug, PartialEq)]
pub struct Gradient {
    /// To the command of each cable: its tension in N, or its shortening in m.
    pub commands: Vec<f64>,
    /// To each parameter that was asked for.
    pub parameters: Vec<f64>,
    /// To a dead force and moment at each place, base frame, by [`Gradient::wrench`].
    nodes: Vec<Wrench>,
    places: Places,
}

/// The derivatives of one answer of the Cosserat model.
///
/// Motions and wrenches are in the base frame: a change of pose is the velocity of the station's
/// point and the angular velocity of its frame, `δR = φ̂ R`; a wrench acts at that point and does not
/// turn. So the two are work-conjugate, and under dead forces a compliance is symmetric. (A dead
/// *moment* has no potential for turns about more than one axis; follower loads have none at all.)
///
/// Cables that are slack stay slack: at the very load at which one goes slack the answer has a kink,
/// and the derivatives are those of the side that the answer says.
///
/// ```
/// use whipcord::cosserat::{Cosserat, Hold, Options, Place, Workspace};
/// use whipcord::{Backbone, Cable, Case, Disks, Loads, Material, Parameter, Robot, Routing, Section};
///
/// let material =
///     Material { young_modulus: Some(1.1e9), poisson_ratio: Some(0.3), ..Default::default() };
/// let section = Some(Section::circle(0.003));
/// let backbone = Backbone { section, material, ..Backbone::new(0.18) };
/// let disks = Disks::equally_spaced(0.18, 10, 0.008);
/// let cable = Cable::new("pull", Routing::Straight { angle: 0.0, radius: 0.008 });
/// let robot = Robot::new(backbone, disks, vec![cable])?;
///
/// let model = Cosserat::new(&robot, &Loads::default(), &Options::default())?;
/// let (solution, derivatives) = model.solve_with_derivatives(
///     &Case::with_tensions(&[3.0]),
///     None,
///     &[Parameter::YoungModulus],
///     &mut Workspace::default(),
/// )?;
/// // The bend is τ r L/EI: it grows with the tension as it is.
/// let jacobian = derivatives.actuation_jacobian(Place::Tip);
/// let bend = solution.disks.tip().rotation.log().norm();
/// assert!((jacobian[0].angular.norm() - bend / 3.0).abs() < 1e-9);
/// // A locked cable stiffens the robot.
/// let free = derivatives.compliance(Place::Tip, Hold::Tensions)?;
/// let locked = derivatives.compliance(Place::Tip, Hold::Lengths)?;
/// assert!(locked.at(0, 0) < free.at(0, 0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Derivatives {
    places: Places,
    steps: Vec<Step>,
    replay: Replay,
    maps: Maps,
    elimination: Elimination,
    partials: Vec<Partial>,
    /// Grid place of each cable of the robot.
    place_of: Vec<usize>,
    commands: Vec<Command>,
    /// What a change of each tension does at constant other tensions; by grid places.
    by_tension: Vec<Raw>,
    held: Held,
    /// Length of the backbone in m.
    length: f64,
}

/// Nodes of the grid that have names.
#[derive(Clone, Debug, Default, PartialEq)]
struct Places {
    stations: Vec<usize>,
    disks: Vec<usize>,
    tip: usize,
}

/// A change at constant tensions, in the terms of the grid.
#[derive(Clone, Debug, Default)]
struct Raw {
    nodes: Vec<NodeChange>,
    lengths: Vec<f64>,
}

/// What acts: a column's source.
#[derive(Clone, Copy, Debug)]
enum Source {
    Tension(usize),
    Parameter(usize),
    /// Component of a dead wrench at a node, the force first.
    Wrench {
        node: usize,
        component: usize,
    },
}

/// Why an answer has no derivatives.
#[derive(Clone, Debug)]
pub(super) enum NoDerivatives {
    Fault(Fault),
    Parameter(RobotError),
    Critical,
}

impl From<Critical> for NoDerivatives {
    fn from(_: Critical) -> Self {
        Self::Critical
    }
}

impl From<Fault> for NoDerivatives {
    fn from(fault: Fault) -> Self {
        Self::Fault(fault)
    }
}

/// The answer that is differentiated, as the solver left it.
pub(super) struct Solved<'a> {
    pub robot: &'a Robot,
    pub case: &'a Case,
    pub layout: &'a Layout,
    pub grid: &'a Grid,
    pub loads: &'a AppliedLoads,
    pub commands: &'a [Command],
    pub tensions: &'a [f64],
    pub poses: &'a [whipcord_numerics::Pose],
    pub base_wrench: Wrench,
    /// Moment, and force of the followers, in the base frame at the start of each step, of an answer
    /// that has them.
    pub starts: Option<&'a [Wrench]>,
    pub strains: &'a [Strain],
}

impl Derivatives {
    pub(super) fn of(solved: &Solved<'_>, parameters: &[Parameter]) -> Result<Self, NoDerivatives> {
        let Solved { robot, case, layout, grid, loads, tensions, .. } = *solved;
        let mut replay = Replay::default();
        replay.run(&Answer {
            grid,
            loads,
            tensions,
            poses: solved.poses,
            base_moment: solved.base_wrench.moment,
            follower_force: loads.follower_share(solved.base_wrench.force),
            starts: solved.starts,
            strains: solved.strains,
        })?;
        let setting = Setting { robot, case, layout, grid, tensions };
        let partials = parameters
            .iter()
            .map(|parameter| Partial::new(&setting, &replay, parameter))
            .collect::<Result<Vec<_>, _>>()
            .map_err(NoDerivatives::Parameter)?;
        let cables = tensions.len();
        let mut maps = Maps::default();
        maps.compute(&grid.steps, &replay, cables, partials.len(), &|k, i, p| {
            partials[p].forcing(STAGES * k + i)
        });
        let mut elimination = Elimination::default();
        elimination.eliminate(&maps, loads, |node| solved.poses[node])?;
        let mut place_of = vec![0; cables];
        for (place, &cable) in layout.order.iter().enumerate() {
            place_of[cable] = place;
        }
        let mut derivatives = Self {
            places: Places {
                stations: grid.stations.clone(),
                disks: grid.disks.clone(),
                tip: grid.len(),
            },
            steps: grid.steps.clone(),
            replay,
            maps,
            elimination,
            partials,
            place_of,
            commands: solved.commands.to_vec(),
            by_tension: Vec::new(),
            held: Held::default(),
            length: robot.backbone().length,
        };
        derivatives.by_tension =
            (0..cables).map(|place| derivatives.raw(Source::Tension(place))).collect();
        derivatives.hold(robot, layout, tensions)?;
        let tip = derivatives.raw(Source::Wrench { node: grid.len(), component: 0 });
        let finite = derivatives.by_tension.iter().chain([&tip]).all(Raw::is_finite);
        if finite { Ok(derivatives) } else { Err(NoDerivatives::Critical) }
    }

    fn hold(
        &mut self,
        robot: &Robot,
        layout: &Layout,
        tensions: &[f64],
    ) -> Result<(), NoDerivatives> {
        let cables = tensions.len();
        let compliance = |place: usize| {
            let stiffness = robot.cables()[layout.order[place]].axial_stiffness;
            stiffness.map_or(0.0, |k| layout.rest_lengths[place] / k)
        };
        let taut = |place: usize| tensions[place] > 0.0;
        let driven = |place: usize| matches!(self.commands[place], Command::Length { .. });
        let matrix = |i: usize, j: usize| self.by_tension[j].lengths[i];
        self.held = Held::new(cables, matrix, compliance, taut, driven)?;
        Ok(())
    }

    /// The change that a source makes at constant tensions.
    fn raw(&self, source: Source) -> Raw {
        let cables = self.place_of.len();
        let input = match source {
            Source::Tension(place) => Some(place),
            Source::Parameter(p) if self.partials[p].acts() => Some(cables + p),
            _ => None,
        };
        let added = match source {
            Source::Tension(_) => None,
            Source::Parameter(p) => self.partials[p].added,
            Source::Wrench { node, component } => Some((node, unit_wrench(component))),
        };
        let effect = |k: usize| input.map_or_else(Effect::default, |i| self.maps.effects_of(k)[i]);
        let wrench = |node: usize| match added {
            Some((at, wrench)) if at == node => wrench,
            _ => Wrench::default(),
        };
        let mut raw = Raw::default();
        self.elimination.solve(effect, wrench, &mut raw.nodes);
        raw.lengths = match source {
            Source::Parameter(p) => self.partials[p].lengths.clone(),
            _ => vec![0.0; cables],
        };
        for k in 0..self.steps.len() {
            let node = &raw.nodes[k];
            for (place, length) in raw.lengths.iter_mut().enumerate() {
                let [turn, moment, force] = &self.maps.length_by_state[k * cables + place];
                *length += turn.dot(node.turn) + moment.dot(node.moment) + force.dot(node.force);
                if let Some(input) = input {
                    let at = (k * self.maps.inputs + input) * cables + place;
                    *length += self.maps.length_by_input[at];
                }
            }
        }
        raw
    }

    /// A change at constant tensions completed by the tensions that keep what is held; `targets` is
    /// the change of the lengths that are to be kept.
    fn completed(&self, source: Source, hold: Hold, targets: &[f64]) -> Change {
        let raw = self.raw(source);
        let cables = self.place_of.len();
        let right: Vec<f64> = (0..cables)
            .map(|place| targets.get(place).copied().unwrap_or(0.0) - raw.lengths[place])
            .collect();
        let mut tensions = self.held.tensions(hold, &right);
        let Raw { mut nodes, mut lengths } = raw;
        for (column, &tension) in self.by_tension.iter().zip(&tensions) {
            if tension != 0.0 {
                for (node, by) in nodes.iter_mut().zip(&column.nodes) {
                    node.add(tension, by);
                }
                for (length, by) in lengths.iter_mut().zip(&column.lengths) {
                    *length += tension * by;
                }
            }
        }
        let strains = self.strains(&nodes, source, &tensions);
        if let Source::Parameter(p) = source {
            // What acts on the rod between base and tip adds to what the nodes carry.
            nodes[0].force += self.partials[p].forcing(0).force;
        }
        if let Source::Tension(place) = source {
            tensions[place] += 1.0;
        }
        self.change(nodes, strains, &lengths, &tensions)
    }

    fn change(
        &self,
        nodes: Vec<NodeChange>,
        strains: Vec<Strain>,
        lengths: &[f64],
        tensions: &[f64],
    ) -> Change {
        let of_robot = |values: &[f64]| self.place_of.iter().map(|&place| values[place]).collect();
        Change {
            places: self.places.clone(),
            nodes,
            strains,
            lengths: of_robot(lengths),
            tensions: of_robot(tensions),
        }
    }

    /// How the strain behind each node changes, and of the tip in front of it: eq. (d1) at the nodes.
    fn strains(&self, nodes: &[NodeChange], source: Source, tensions: &[f64]) -> Vec<Strain> {
        let cables = tensions.len();
        (0..nodes.len())
            .map(|node| {
                let at = STAGES * node;
                let stage = &self.replay.stages[at];
                let mut change = nodes[node];
                if node == self.steps.len() {
                    self.elimination.arriving(&mut change, node);
                    if let Source::Wrench { node: place, component } = source
                        && place == node
                    {
                        change.moment += unit_wrench(component).moment;
                        change.force += unit_wrench(component).force;
                    }
                    if let Source::Parameter(p) = source
                        && let Some((place, wrench)) = self.partials[p].added
                        && place == node
                    {
                        change.moment += wrench.moment;
                        change.force += wrench.force;
                    }
                }
                let active = self.steps[node.min(self.steps.len() - 1)].active;
                let mut forcing = match source {
                    Source::Parameter(p) => self.partials[p].forcing(at),
                    _ => Forcing::default(),
                };
                let pulls = self.replay.pulls_at(at, cables, active);
                for (place, ((pull, _), tension)) in pulls.iter().zip(tensions).enumerate() {
                    let own = matches!(source, Source::Tension(p) if p == place);
                    let tension = tension + if own { 1.0 } else { 0.0 };
                    forcing.force_balance += tension * pull.linear;
                    forcing.moment_balance += tension * pull.angular;
                }
                stage.strain_change(&change, &forcing)
            })
            .collect()
    }

    /// How the answer changes with the command of a cable: its tension in N where that drives it,
    /// else its shortening in m. All other commands are held. A cable that is slack moves nothing.
    #[must_use]
    pub fn command(&self, cable: usize) -> Change {
        let place = self.place_of[cable];
        match self.commands[place] {
            Command::Tension(_) => self.completed(Source::Tension(place), Hold::Commands, &[]),
            Command::Length { .. } => {
                let cables = self.place_of.len();
                let right: Vec<f64> =
                    (0..cables).map(|i| if i == place { -1.0 } else { 0.0 }).collect();
                let tensions = self.held.tensions(Hold::Commands, &right);
                self.with_tensions(&tensions)
            }
        }
    }

    /// How the answer changes with the tension of a cable in N, all other tensions held.
    #[must_use]
    pub fn tension(&self, cable: usize) -> Change {
        self.completed(Source::Tension(self.place_of[cable]), Hold::Tensions, &[])
    }

    /// The change that goes with changes of the tensions, by grid places, and with nothing else.
    fn with_tensions(&self, tensions: &[f64]) -> Change {
        let cables = tensions.len();
        let mut nodes = vec![NodeChange::default(); self.steps.len() + 1];
        let mut lengths = vec![0.0; cables];
        for (column, &tension) in self.by_tension.iter().zip(tensions) {
            for (node, by) in nodes.iter_mut().zip(&column.nodes) {
                node.add(tension, by);
            }
            for (length, by) in lengths.iter_mut().zip(&column.lengths) {
                *length += tension * by;
            }
        }
        // No wrench at all is added: the component does not matter.
        let nothing = Source::Wrench { node: usize::MAX, component: 0 };
        let strains = self.strains(&nodes, nothing, tensions);
        self.change(nodes, strains, &lengths, tensions)
    }

    /// How the answer changes with a parameter, by its number in the list that was asked for.
    ///
    /// # Panics
    /// When no parameter has this number.
    #[must_use]
    pub fn parameter(&self, index: usize, hold: Hold) -> Change {
        let targets = &self.partials[index].targets;
        self.completed(Source::Parameter(index), hold, targets)
    }

    /// How the answer changes with a component of a dead wrench at a place, base frame: force in N
    /// along x, y, z, then moment in N·m about x, y, z.
    #[must_use]
    pub fn wrench(&self, at: Place, component: usize, hold: Hold) -> Change {
        let node = self.places.node(at);
        self.completed(Source::Wrench { node, component }, hold, &[])
    }

    /// The actuation Jacobian of a place: for the command of each cable ([`Self::command`]) the
    /// velocity of the place's point and its angular velocity, base frame.
    #[must_use]
    pub fn actuation_jacobian(&self, at: Place) -> Vec<Twist> {
        let node = self.places.node(at);
        self.jacobian(|cable| {
            let place = self.place_of[cable];
            let right: Vec<f64> = match self.commands[place] {
                Command::Tension(_) => {
                    self.by_tension[place].lengths.iter().map(|length| -length).collect()
                }
                Command::Length { .. } => {
                    (0..self.place_of.len()).map(|i| if i == place { -1.0 } else { 0.0 }).collect()
                }
            };
            let mut tensions = self.held.tensions(Hold::Commands, &right);
            if matches!(self.commands[place], Command::Tension(_)) {
                tensions[place] += 1.0;
            }
            self.twist_of(node, &tensions)
        })
    }

    /// The Jacobian of a place by the tensions of all cables in N, whatever drives them.
    #[must_use]
    pub fn tension_jacobian(&self, at: Place) -> Vec<Twist> {
        let node = self.places.node(at);
        self.jacobian(|cable| self.by_tension[self.place_of[cable]].nodes[node].twist())
    }

    fn jacobian(&self, column: impl Fn(usize) -> Twist) -> Vec<Twist> {
        (0..self.place_of.len()).map(column).collect()
    }

    fn twist_of(&self, node: usize, tensions: &[f64]) -> Twist {
        let mut change = NodeChange::default();
        for (column, &tension) in self.by_tension.iter().zip(tensions) {
            change.add(tension, &column.nodes[node]);
        }
        change.twist()
    }

    /// The compliance of a place: its motion under a dead wrench that is applied to it.
    ///
    /// # Errors
    /// [`crate::SolveError::NoDerivatives`] where the robot is so near to buckling that it is not
    /// finite.
    pub fn compliance(&self, at: Place, hold: Hold) -> Result<Matrix6, crate::SolveError> {
        let node = self.places.node(at);
        let mut columns = [Twist::default(); 6];
        for (component, column) in columns.iter_mut().enumerate() {
            let raw = self.raw(Source::Wrench { node, component });
            let right: Vec<f64> = raw.lengths.iter().map(|length| -length).collect();
            let tensions = self.held.tensions(hold, &right);
            let (free, pulled) = (raw.nodes[node].twist(), self.twist_of(node, &tensions));
            *column = free + pulled;
            if !(column.linear.is_finite() && column.angular.is_finite()) {
                return Err(crate::SolveError::NoDerivatives);
            }
        }
        Ok(Matrix6::from_columns(&columns))
    }

    /// The stiffness of a place, the inverse of its compliance; `None` where it cannot move in every
    /// direction, as at the base.
    ///
    /// # Errors
    /// As [`Self::compliance`].
    pub fn stiffness(&self, at: Place, hold: Hold) -> Result<Option<Matrix6>, crate::SolveError> {
        Ok(self.compliance(at, hold)?.inverse(self.length))
    }

    /// All that is to be said of one place.
    ///
    /// # Errors
    /// As [`Self::compliance`].
    pub fn at(&self, place: Place) -> Result<Local, crate::SolveError> {
        let yielding = |hold: Hold| -> Result<Yield, crate::SolveError> {
            let compliance = self.compliance(place, hold)?;
            Ok(Yield { compliance, stiffness: compliance.inverse(self.length) })
        };
        let driven = |&grid: &usize| match self.commands[grid] {
            Command::Tension(_) => DrivenBy::Tension,
            Command::Length { .. } => DrivenBy::Shortening,
        };
        Ok(Local {
            driven_by: self.place_of.iter().map(driven).collect(),
            actuation_jacobian: self.actuation_jacobian(place),
            tensions_held: yielding(Hold::Tensions)?,
            lengths_held: yielding(Hold::Lengths)?,
            means: Means::Exact,
        })
    }

    /// How the lengths of the cables change with their tensions in m/N, all others held: by rows of
    /// lengths. Symmetric and not positive under dead forces.
    #[must_use]
    pub fn length_by_tension(&self) -> Vec<Vec<f64>> {
        let entry =
            |i: usize, j: usize| self.by_tension[self.place_of[j]].lengths[self.place_of[i]];
        let cables = self.place_of.len();
        (0..cables).map(|i| (0..cables).map(|j| entry(i, j)).collect()).collect()
    }

    /// The gradient of a scalar by every command, parameter and dead wrench, from its sensitivity to
    /// the answer: one sweep, whatever the number of parameters. `hold` is what is held when a
    /// parameter or a wrench changes.
    #[must_use]
    pub fn pull_back(&self, cotangent: &Cotangent, hold: Hold) -> Gradient {
        let cables = self.place_of.len();
        let at_place = |values: &[f64]| -> Vec<f64> {
            let mut out = vec![0.0; cables];
            for (&place, value) in self.place_of.iter().zip(values) {
                out[place] = *value;
            }
            out
        };
        let tensions = at_place(&cotangent.tensions);
        let lengths = at_place(&cotangent.lengths);
        let mut nodes = vec![NodeChange::default(); self.steps.len() + 1];
        for (at, twist) in &cotangent.places {
            let node = &mut nodes[self.places.node(*at)];
            node.position += twist.linear;
            node.turn += twist.angular;
        }
        nodes[0].moment += cotangent.base_wrench.moment;
        nodes[0].force += cotangent.base_wrench.force;
        // What a change of each tension is worth, by all that it moves.
        let worth: Vec<f64> = (self.by_tension.iter().zip(&tensions))
            .map(|(column, own)| {
                let moved: f64 = column.nodes.iter().zip(&nodes).map(|(a, b)| a.dot(b)).sum();
                let longer: f64 = column.lengths.iter().zip(&lengths).map(|(a, b)| a * b).sum();
                own + moved + longer
            })
            .collect();
        let by_length = self.held.pull_back(hold, &worth);
        let by_commands = self.held.pull_back(Hold::Commands, &worth);
        let commands = (0..cables)
            .map(|cable| {
                let place = self.place_of[cable];
                match self.commands[place] {
                    Command::Length { .. } => -by_commands[place],
                    Command::Tension(_) => {
                        let lengths = &self.by_tension[place].lengths;
                        let held: f64 = by_commands.iter().zip(lengths).map(|(a, b)| a * b).sum();
                        worth[place] - held
                    }
                }
            })
            .collect();
        let lengths: Vec<f64> = lengths.iter().zip(&by_length).map(|(a, b)| a - b).collect();
        let extra = |k: usize| {
            let mut sum = [Vec3::ZERO; 3];
            for (place, length) in lengths.iter().enumerate() {
                let rates = &self.maps.length_by_state[k * cables + place];
                for (s, rate) in sum.iter_mut().zip(rates) {
                    *s += *length * *rate;
                }
            }
            sum
        };
        let mut steps = Vec::new();
        self.elimination.pull_back(&nodes, extra, &mut steps);
        let mut stages = Vec::new();
        stage_pulls(&self.steps, &self.replay, &steps, &lengths, &mut stages);
        let mut wrenches = vec![Wrench::default()];
        wrenches.extend(steps.iter().map(|step| step.added));
        let parameters = (self.partials.iter())
            .map(|partial| {
                let acting: f64 =
                    stages.iter().enumerate().map(|(i, pull)| pull.dot(&partial.forcing(i))).sum();
                let longer: f64 = partial.lengths.iter().zip(&lengths).map(|(a, b)| a * b).sum();
                let asked: f64 = partial.targets.iter().zip(&by_length).map(|(a, b)| a * b).sum();
                let added = partial.added.map_or(0.0, |(node, wrench)| {
                    wrenches[node].force.dot(wrench.force)
                        + wrenches[node].moment.dot(wrench.moment)
                });
                let at_base = cotangent.base_wrench.force.dot(partial.forcing(0).force);
                acting + longer + asked + added + at_base
            })
            .collect();
        Gradient { commands, parameters, nodes: wrenches, places: self.places.clone() }
    }
}

impl Change {
    /// Velocity of the place's point and its angular velocity, base frame.
    ///
    /// # Panics
    /// When there is no such station or disk.
    #[must_use]
    pub fn twist(&self, at: Place) -> Twist {
        self.nodes[self.places.node(at)].twist()
    }

    /// Rates of the strains `v` and `u` at a place, body frame: just behind it, and at the tip just
    /// in front of it.
    #[must_use]
    pub fn strain(&self, at: Place) -> Twist {
        self.strains[self.places.node(at)]
    }

    /// Rates of the lengths of the cables in m.
    #[must_use]
    pub fn lengths(&self) -> &[f64] {
        &self.lengths
    }

    /// Rates of the tensions of the cables in N.
    #[must_use]
    pub fn tensions(&self) -> &[f64] {
        &self.tensions
    }

    /// Rate of what rod and cables exert on the base, base frame.
    #[must_use]
    pub fn base_wrench(&self) -> Wrench {
        Wrench { force: self.nodes[0].force, moment: self.nodes[0].moment }
    }
}

impl Gradient {
    /// To a dead force and moment at a place, base frame.
    #[must_use]
    pub fn wrench(&self, at: Place) -> Wrench {
        self.nodes[self.places.node(at)]
    }
}

impl Places {
    fn node(&self, at: Place) -> usize {
        match at {
            Place::Station(i) => self.stations[i],
            Place::Disk(i) => self.disks[i],
            Place::Tip => self.tip,
        }
    }
}

impl Raw {
    fn is_finite(&self) -> bool {
        self.nodes.iter().all(|n| n.turn.is_finite() && n.position.is_finite())
            && self.lengths.iter().all(|l| l.is_finite())
    }
}

fn unit_wrench(component: usize) -> Wrench {
    match component {
        0..3 => Wrench { force: AXES[component], moment: Vec3::ZERO },
        _ => Wrench { force: Vec3::ZERO, moment: AXES[component % 3] },
    }
}
