//! The tensions of the cables, and of their passages where they rub, while something else changes.

use crate::statics::friction::{Carried, HeldHoles, HoleChange, HoleSource, Holes, Standing};
use crate::statics::hold::{Critical, Hold};

/// What changes an answer beside the shape at constant tensions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Cause {
    /// A wrench.
    Nothing,
    /// By its number.
    Parameter(usize),
    /// Of a cable, in the last step.
    Command(usize),
    /// Of a cable, in all steps alike.
    Offset(usize),
    /// Below the base disk, of a cable.
    Tension(usize),
}

/// The holes of an answer with friction, as the model gives them.
#[derive(Clone, Debug)]
pub(crate) struct AnswerHoles<'a> {
    pub holes: &'a Holes,
    pub standing: &'a Standing,
    /// What each parameter changes by itself.
    pub parameters: Vec<HoleSource>,
    /// How the state before the last substep changes: with each parameter, then with the command of each cable in all steps, then
    /// with that in the step of the substep. `None` where that is the robot at rest.
    pub carried: Option<&'a [Carried]>,
    /// Whether `Dᵢ` in it are relative to those at rest.
    pub is_relative: bool,
    /// How far a command that is changed by as much in all steps is changed here, and one of the step alone: all of it, but on the way of a step.
    pub commanded: [f64; 2],
    /// Whether it is the answer; else only what the holes remember is asked for.
    pub is_last: bool,
}

/// The holes of an answer with friction.
#[derive(Clone, Debug)]
pub(super) struct SlidingHoles {
    pub held: HeldHoles,
    parameters: Vec<HoleChange>,
    offsets: Vec<HoleChange>,
    commands: Vec<HoleChange>,
    tensions: Vec<HoleChange>,
    nothing: HoleChange,
    /// Where what is carried is relative to the robot at rest: how that changes with each parameter.
    relative_to: Vec<Carried>,
}

impl SlidingHoles {
    /// Of an answer whose lengths and angles of the passages change with the tension of each as `by_tension` says, as [`HeldHoles::new`] has it.
    pub fn new<'b>(
        answer: &AnswerHoles<'_>,
        by_tension: impl Fn(usize) -> &'b [f64],
    ) -> Result<Self, Critical> {
        let AnswerHoles { holes, standing, parameters, carried, .. } = answer;
        let holds = match answer.is_last {
            true => &[Hold::Commands, Hold::Tensions, Hold::Lengths][..],
            false => &[Hold::Commands],
        };
        let held = HeldHoles::new(holes, standing, holds, by_tension)?;
        let count = parameters.len();
        let at_rest: Vec<Carried> = parameters.iter().map(|source| source.at_rest(holes)).collect();
        let before = |i: usize| match carried {
            Some(carried) => {
                let mut carried = carried.get(i).cloned().unwrap_or_default();
                if let Some(rest) = at_rest.get(i).filter(|_| answer.is_relative) {
                    carried.beyond.iter_mut().zip(&rest.beyond).for_each(|(by, rest)| *by += rest);
                }
                carried
            }
            None => at_rest.get(i).cloned().unwrap_or_default(),
        };
        let changes = parameters.iter().enumerate();
        let parameters = changes.map(|(i, source)| held.change(source, &before(i))).collect();
        let cables = 0..holes.of_cable.len();
        let command = |cable: usize, column: usize, part: f64| {
            let mut source = HoleSource::command(cable, standing.commands[cable].is_length());
            source.commands.iter_mut().for_each(|change| *change *= part);
            held.change(&source, &before(count + column))
        };
        let [in_all, in_last] = answer.commanded;
        let tension = |cable: usize| {
            let mut tensions = vec![0.0; cable + 1];
            tensions[cable] = 1.0;
            HoleChange { tensions, ..HoleChange::default() }
        };
        Ok(Self {
            offsets: cables.clone().map(|cable| command(cable, cable, in_all)).collect(),
            commands: (cables.clone())
                .map(|cable| command(cable, cables.len() + cable, in_last))
                .collect(),
            tensions: cables.map(tension).collect(),
            parameters,
            relative_to: if answer.is_relative { at_rest } else { Vec::new() },
            nothing: HoleChange::default(),
            held,
        })
    }

    pub fn change(&self, cause: Cause) -> &HoleChange {
        match cause {
            Cause::Nothing => &self.nothing,
            Cause::Parameter(p) => &self.parameters[p],
            Cause::Command(cable) => &self.commands[cable],
            Cause::Offset(cable) => &self.offsets[cable],
            Cause::Tension(cable) => &self.tensions[cable],
        }
    }

    /// The changes of the tensions of all passages, and of those below the base, with a cause that changes lengths and angles at
    /// constant tensions by `outputs`.
    pub fn tensions(&self, hold: Hold, outputs: &[f64], cause: Cause) -> [Vec<f64>; 2] {
        let mut tensions = self.held.tensions(hold, outputs, self.change(cause));
        let base = tensions.split_off(self.held.passages());
        [tensions, base]
    }

    /// How the state that the holes remember changes, as [`AnswerHoles::carried`] has it. `outputs` has what a cause changes of
    /// lengths and angles at constant tensions.
    pub fn carried(&self, outputs: impl Fn(Cause) -> Vec<f64>) -> Vec<Carried> {
        self.causes().map(|cause| self.carry(&outputs(cause), cause)).collect()
    }

    /// The causes whose changes are carried: each parameter, then the command of each cable in all steps, then that in the last.
    pub fn causes(&self) -> impl Iterator<Item = Cause> + use<> {
        let cables = 0..self.commands.len();
        let parameters = (0..self.parameters.len()).map(Cause::Parameter);
        parameters.chain(cables.clone().map(Cause::Offset)).chain(cables.map(Cause::Command))
    }

    fn carry(&self, outputs: &[f64], cause: Cause) -> Carried {
        let change = self.change(cause);
        let tensions = self.held.tensions(Hold::Commands, outputs, change);
        let mut carried = self.held.carry(outputs, &tensions, change);
        self.held.shift_to_event(&mut carried, outputs, &tensions, change);
        if let Cause::Parameter(p) = cause
            && let Some(rest) = self.relative_to.get(p)
        {
            carried.beyond.iter_mut().zip(&rest.beyond).for_each(|(by, rest)| *by -= rest);
        }
        carried
    }

    /// The lengths of the cables of those of their passages.
    pub fn cable_lengths(&self, outputs: &[f64]) -> Vec<f64> {
        let cables = 0..self.commands.len();
        cables.map(|c| self.held.of_cable(c).iter().map(|&p| outputs[p]).sum()).collect()
    }

    /// What the outputs are worth where the lengths of the cables are worth this.
    pub fn worth_of_lengths(&self, lengths: &[f64]) -> Vec<f64> {
        let mut worth = vec![0.0; 2 * self.held.passages()];
        for (cable, length) in lengths.iter().enumerate() {
            self.held.of_cable(cable).iter().for_each(|&p| worth[p] = *length);
        }
        worth
    }

    /// The way back, where the tensions of all passages, and those below the base, are worth this: the commands of the cables, the
    /// equations of the holes, and the outputs by these.
    pub fn pull_back(&self, hold: Hold, worth: &[f64]) -> (Vec<f64>, Vec<f64>, Vec<f64>) {
        let by_commands = self.held.pull_back(Hold::Commands, worth);
        let command = |change| self.held.worth_of(Hold::Commands, &by_commands, change);
        let commands = self.commands.iter().map(command).collect();
        let equations = match hold {
            Hold::Commands => by_commands,
            _ => self.held.pull_back(hold, worth),
        };
        let outputs = self.held.worth_of_outputs(hold, &equations);
        (commands, equations, outputs)
    }

    /// What a parameter is worth by the equations of the holes.
    pub fn worth_of(&self, hold: Hold, equations: &[f64], parameter: usize) -> f64 {
        self.held.worth_of(hold, equations, &self.parameters[parameter])
    }
}
