//! A model of a robot with its commands and its last solution.

use std::sync::Arc;

use whipcord::derivatives::Place;
use whipcord::{
    Actuation, Budget, CableCommand, Case, Differentiable as _, Model, Prepared, Shortening,
    Solution, Stations, Status as SolveStatus, Twist, Vec3, WarmStart,
};
use whipcord_io::CaseFile;

use crate::robot::{
    RobotFile, check_commands, check_motors, check_tensions, model_kind, solve_failure,
};
use crate::status::{Failure, Status};
use crate::values::{Diagnostics, Stability};

/// What a model of a robot is solved with, again and again.
pub struct Solver {
    file: Arc<CaseFile>,
    model: Model,
    prepared: Prepared,
    budget: Budget,
    case: Case,
    /// The answers of this solve and of the one before: a failed solve leaves them.
    answer: Solution,
    before: Solution,
    /// Answers that there are, 2 at most.
    answers: usize,
    /// Where the motors have left their drives, and where the commands at hand would lead them: backlash remembers.
    outputs: Vec<f64>,
    next_outputs: Vec<f64>,
    /// Of the tip, with the command of each cable.
    motions: Vec<Twist>,
}

impl Solver {
    pub(crate) fn new(robot: &RobotFile, model: &str) -> Result<Self, Failure> {
        let file = Arc::clone(&robot.file);
        let kind = model_kind(model)?;
        let model = Model::new(kind, Stations::Disks, Actuation::Natural);
        let prepared = model
            .prepare(&file.robot, &file.case.loads)
            .map_err(|error| solve_failure(&file, &error))?;
        let [outputs, next_outputs] = outputs_of(&file);
        Ok(Self {
            model,
            prepared,
            budget: Budget::default(),
            case: file.case.clone(),
            answer: Solution::empty(kind),
            before: Solution::empty(kind),
            answers: 0,
            outputs,
            next_outputs,
            motions: Vec::new(),
            file,
        })
    }

    /// Back to the commands and loads of the file, without a solution.
    pub(crate) fn reset(&mut self) {
        self.case.clone_from(&self.file.case);
        self.answers = 0;
        [self.outputs, self.next_outputs] = outputs_of(&self.file);
    }

    pub(crate) fn file(&self) -> &CaseFile {
        &self.file
    }

    pub(crate) fn set_budget(&mut self, iterations: usize, integration_steps: usize) {
        self.budget = Budget { iterations, integration_steps };
        self.prepared.set_budget(self.budget);
    }

    pub(crate) fn set_tolerance(&mut self, tolerance: f64) -> Result<(), Failure> {
        if !Model::TOLERANCES.contains(&tolerance) {
            let (least, greatest) = (Model::TOLERANCES.start(), Model::TOLERANCES.end());
            return Err(Failure::new(
                Status::InvalidArgument,
                format!(
                    "the tolerance is {tolerance}: give a part of the backbone's length from {least:e} to {greatest}"
                ),
            ));
        }
        let model = self.model.clone().with_tolerance(tolerance);
        let prepared = model.prepare(&self.file.robot, &self.case.loads);
        self.prepared = prepared.map_err(|error| solve_failure(&self.file, &error))?;
        self.prepared.set_budget(self.budget);
        self.model = model;
        Ok(())
    }

    pub(crate) fn set_tensions(&mut self, tensions: &[f64]) -> Result<(), Failure> {
        check_tensions(tensions)?;
        for (command, &tension) in self.case.commands.iter_mut().zip(tensions) {
            *command = by_tension(tension);
        }
        self.let_go_of_motors();
        Ok(())
    }

    pub(crate) fn set_shortenings(&mut self, shortenings: &[f64]) {
        for (command, &by) in self.case.commands.iter_mut().zip(shortenings) {
            *command = shortened(by);
        }
        self.let_go_of_motors();
    }

    /// Of each cable its shortening where the flag is 1, else its tension.
    pub(crate) fn set_commands(
        &mut self,
        commands: &[f64],
        by_shortening: &[u8],
    ) -> Result<(), Failure> {
        check_commands(commands, by_shortening)?;
        for (command, (&value, &flag)) in
            self.case.commands.iter_mut().zip(commands.iter().zip(by_shortening))
        {
            *command = if flag == 0 { by_tension(value) } else { shortened(value) };
        }
        self.let_go_of_motors();
        Ok(())
    }

    pub(crate) fn set_motors(&mut self, commands: &[f64]) -> Result<(), Failure> {
        check_motors(&self.file.robot, commands)?;
        self.let_go_of_motors();
        for (i, (motor, &command)) in self.file.robot.motors().iter().zip(commands).enumerate() {
            let output = motor.output(self.outputs[i], command);
            self.next_outputs[i] = output;
            for of in &motor.cables {
                self.case.commands[of.cable] = shortened(of.pull() * output);
            }
        }
        Ok(())
    }

    /// Commands of the motors that the case has are no longer in force.
    fn let_go_of_motors(&mut self) {
        if let Some(last) = self.case.motors.last_mut() {
            last.fill(None);
        }
        self.next_outputs.copy_from_slice(&self.outputs);
    }

    pub(crate) fn set_tip_load(&mut self, force: Vec3, moment: Vec3) {
        self.case.loads.tip_force = force;
        self.case.loads.tip_moment = moment;
    }

    /// Solves for the commands and loads at hand, from the solution before.
    pub(crate) fn solve(&mut self) -> Result<(), Failure> {
        let status = if self.answers == 0 && !self.case.before.is_empty() {
            self.solve_all_steps()?;
            SolveStatus::Converged
        } else {
            let from = match self.answers {
                0 => WarmStart::None,
                _ => WarmStart::Solution(&self.answer),
            };
            let solved = self.prepared.solve_into(&self.case, from, &mut self.before);
            let status = solved.map_err(|error| solve_failure(&self.file, &error))?;
            core::mem::swap(&mut self.answer, &mut self.before);
            self.answers = (self.answers + 1).min(2);
            status
        };
        self.outputs.copy_from_slice(&self.next_outputs);
        // The way there is in the solution now.
        self.case.before.clear();
        self.case.loads_before.clear();
        self.case.independent = false;
        match status {
            SolveStatus::Converged => Ok(()),
            SolveStatus::BudgetSpent => Err(Failure::new(
                Status::BudgetSpent,
                "the budget is spent: the solution is the best shape so far, solve again to go on from it",
            )),
        }
    }

    /// The way through the steps of the file.
    fn solve_all_steps(&mut self) -> Result<(), Failure> {
        let Self { prepared, case, answer, before, .. } = self;
        let mut answers = 0;
        let solved = prepared.solve_steps(case, |solution| {
            core::mem::swap(answer, before);
            *answer = solution;
            answers = (answers + 1).min(2);
        });
        solved.map_err(|(step, error)| {
            let Failure { status, message } = solve_failure(&self.file, &error);
            Failure::new(status, format!("step {}: {message}", step + 1))
        })?;
        // Independent steps lead to no other.
        self.answers = if self.case.independent { 1 } else { answers };
        Ok(())
    }

    /// The last solution.
    pub(crate) fn solution(&self) -> Result<&Solution, Failure> {
        match self.answers {
            0 => Err(unsolved()),
            _ => Ok(&self.answer),
        }
    }

    pub(crate) fn diagnostics(&self) -> Result<Diagnostics, Failure> {
        let of = &self.solution()?.diagnostics;
        let stability = match of.stable {
            None => Stability::Unknown,
            Some(true) => Stability::Stable,
            Some(false) => Stability::Unstable,
        };
        Ok(Diagnostics {
            iterations: of.iterations,
            steps: of.steps,
            residual: of.residual,
            stability,
        })
    }

    /// Tensions in N, in the order of the cables.
    pub(crate) fn tensions(&self) -> Result<impl ExactSizeIterator<Item = f64> + use<'_>, Failure> {
        let cables = &self.solution()?.cables;
        if cables.iter().any(|cable| cable.tension.is_none()) {
            return Err(Failure::new(
                Status::Unavailable,
                "this model computes no tensions: use another one, such as cosserat",
            ));
        }
        // All are there, as was just seen.
        Ok(cables.iter().map(|cable| cable.tension.unwrap_or_default()))
    }

    /// The motion of the tip in the world by the command of each cable.
    pub(crate) fn jacobian(&mut self) -> Result<&[Twist], Failure> {
        let Self { file, model, prepared, case, answer, before, answers, motions, .. } = self;
        if *answers == 0 {
            return Err(unsolved());
        }
        let robot = &file.robot;
        let fail = |error| solve_failure(file, &error);
        if !model.has_derivatives(robot) {
            let length = robot.backbone().length;
            let solved = model.solve_at_from(robot, case, length, Some(answer));
            *motions = solved.map_err(fail)?.1.actuation_jacobian;
        } else if robot.has_history() {
            // What slides is seen only on the way from the solution before.
            let from = (*answers > 1).then_some(&*before);
            let solved = prepared.solve_with_derivatives(case, from, &[]).map_err(fail)?;
            *motions = solved.1.actuation_jacobian(Place::Tip);
        } else {
            prepared.tip_by_commands(case, answer, motions).map_err(fail)?;
        }
        let turn = case.base.rotation;
        for motion in &mut *motions {
            motion.linear = turn.rotate(motion.linear);
            motion.angular = turn.rotate(motion.angular);
        }
        Ok(motions)
    }
}

const fn by_tension(tension: f64) -> CableCommand {
    CableCommand { tension: Some(tension), shortening: None }
}

const fn shortened(by: f64) -> CableCommand {
    CableCommand { tension: None, shortening: Some(Shortening::Length(by)) }
}

fn unsolved() -> Failure {
    Failure::new(Status::Unavailable, "there is no solution yet: call whipcord_solver_solve first")
}

/// Where the steps of the file before the last leave the drives of the motors, and where the last one does.
fn outputs_of(file: &CaseFile) -> [Vec<f64>; 2] {
    let mut outputs = vec![0.0; file.robot.motors().len()];
    let mut before = outputs.clone();
    for step in &file.case.motors {
        if file.case.independent {
            outputs.fill(0.0);
        }
        before.clone_from(&outputs);
        for ((motor, output), command) in file.robot.motors().iter().zip(&mut outputs).zip(step) {
            if let &Some(command) = command {
                *output = motor.output(*output, command);
            }
        }
    }
    [before, outputs]
}
