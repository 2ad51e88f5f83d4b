//! The chain on a mesh as an equilibrium path.

use whipcord_numerics::{Pose, Vec3};

use super::chain::Chain;
use super::node::{Direction, Node, NodeStep, State};
use super::problem::Problem;
use super::scratch::Scratch;
use super::scratch::finish;
use super::stability_check;
use super::task::Task;
use crate::statics::command::Command;
use crate::statics::lengths::Effort;
use crate::statics::outcome::{Found, Open};
use crate::statics::path::{EquilibriumPath, Step};
use crate::statics::scales::Scales;
use crate::statics::trace::Stage;

/// The chain of a problem whose loads are gathered; without friction.
pub(super) struct ChainPath<'a> {
    problem: &'a Problem<'a>,
    commands: Vec<Command>,
    load: f64,
    scratch: &'a mut Scratch,
}

impl<'a> ChainPath<'a> {
    pub fn new(problem: &'a Problem<'a>, scratch: &'a mut Scratch) -> Self {
        scratch.chain.trace.stage = Stage::ArcLength;
        scratch.chain.trace.steps = problem.mesh.grid.len();
        Self { problem, commands: problem.commands.to_vec(), load: 0.0, scratch }
    }

    /// Asks the chain, which stands at a state, for what a step is for.
    fn ask<T>(
        &mut self,
        step: Step<'_, NodeStep>,
        residual: f64,
        ask: impl FnOnce(&mut Chain, &Task<'_>) -> T,
    ) -> T {
        let Problem { frame, mesh, tolerance, meter, .. } = *self.problem;
        let Scratch { chain, groups, applied, .. } = &mut *self.scratch;
        let by_length = self.commands.iter().any(Command::is_length);
        let task = Task {
            frame,
            mesh,
            loads: applied,
            load: self.load,
            step,
            groups,
            commands: if by_length { &self.commands } else { &[] },
            derivatives: false,
            tolerance: tolerance.max(residual),
            meter,
        };
        ask(chain, &task)
    }

    /// Newton's method at the load of the state, and the answer copied out of the chain.
    pub fn finish(mut self) -> Result<Found, Open> {
        let closed = self.ask(Step::Close, 0.0, |chain, task| chain.newton(task, false));
        let (iterations, residual) = closed?;
        Ok(finish(self.problem, self.scratch, Effort { iterations, residual }))
    }
}

impl EquilibriumPath for ChainPath<'_> {
    type Part = Node;

    fn commands(&self) -> &[Command] {
        &self.commands
    }

    fn set_commands(&mut self, commands: &[Command]) {
        self.commands.clear();
        self.commands.extend_from_slice(commands);
    }

    fn has_ended(&self) -> bool {
        self.problem.meter.has_ended()
    }

    fn weight(&self, k: usize) -> f64 {
        self.problem.frame.weight(k)
    }

    fn scales(&self) -> Scales {
        self.problem.frame.scales(self.problem.mesh)
    }

    fn state(&self) -> State {
        let Chain { nodes, tensions, .. } = &self.scratch.chain;
        State { nodes: nodes.clone(), tensions: tensions.clone(), load: self.load }
    }

    fn set_state(&mut self, state: State) {
        let Scratch { chain, groups, .. } = &mut *self.scratch;
        chain.nodes = state.nodes;
        chain.pull(groups, &state.tensions);
        self.load = state.load;
    }

    fn converge(&mut self, across: Option<&Direction>, residual: f64) -> Option<usize> {
        let step = across.map_or(Step::Close, Step::Across);
        let closed = self.ask(step, residual, |chain, task| chain.newton(task, false));
        let (iterations, _) = closed.ok()?;
        self.load = self.scratch.chain.load;
        Some(iterations)
    }

    fn direction(&mut self, step: Step<'_, NodeStep>) -> Option<Direction> {
        self.ask(step, 0.0, Chain::direction)
    }

    fn unstable_directions(&mut self) -> Option<usize> {
        if self.scratch.applied.any_follower() {
            let negative = self.ask(Step::Close, 0.0, Chain::is_determinant_negative);
            return negative.map(usize::from);
        }
        stability_check::unstable_directions(self.problem, self.load, self.scratch)
    }

    fn lengths(&mut self) -> Option<&[f64]> {
        self.ask(Step::Close, 0.0, Chain::measure).ok()?;
        Some(&self.scratch.chain.lengths)
    }

    fn tip(&mut self) -> Vec3 {
        // A span that folds keeps the poses it had before.
        let _ = self.ask(Step::Close, 0.0, Chain::measure);
        let spans = self.problem.mesh.spans.iter();
        let ends = spans.map(|steps| self.scratch.chain.poses[steps.end - 1]);
        ends.fold(Pose::IDENTITY, |disk, end| disk * end).position
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::case::{CableCommand, Case, DistributedLoad, Loads, PointLoad, Shortening};
    use crate::cosserat_disks::statics::start_of_path;
    use crate::cosserat_disks::{CosseratDisks, Options, Workspace};
    use crate::robot::{Backbone, Cable, Disks, Robot, Routing, Stiffness};
    use crate::statics::path::state::PartChange as _;

    /// Loads of all kinds, within spans and at disks, and a cable that is driven by its length.
    fn loaded() -> (Robot, Case) {
        let stiffness = Stiffness::Diagonal {
            shear: None,
            axial: None,
            bending: [2.0, 1.0].into(),
            torsion: 0.8.into(),
        };
        let backbone = Backbone {
            stiffness: Some(stiffness),
            extensible: false,
            shearable: false,
            ..Backbone::new(1.0)
        };
        let cable = Cable::new("cable", Routing::Straight { angle: 3.4, radius: 0.05 });
        let robot = Robot::new(backbone, Disks::equally_spaced(1.0, 4, 0.06), vec![cable]).unwrap();
        let spread = |force: Vec3, follower| DistributedLoad {
            follower,
            ..DistributedLoad::uniform(1.0, force)
        };
        let point = |at: f64, follower| PointLoad {
            at,
            force: Vec3::new(0.3, 0.2, -0.4),
            moment: Vec3::new(0.1, -0.2, 0.3),
            follower,
        };
        let loads = Loads {
            tip_force: Vec3::new(0.5, 1.0, -1.0),
            tip_moment: Vec3::new(0.1, 0.3, -0.2),
            points: vec![point(0.5, false), point(0.8, true)],
            distributed: vec![
                spread(Vec3::new(1.0, 0.0, -2.0), false),
                spread(Vec3::new(-1.0, 0.5, 0.0), true),
            ],
            ..Loads::default()
        };
        let shortening = Some(Shortening::Length(0.005));
        let commands = vec![CableCommand { tension: None, shortening }];
        (robot, Case { commands, loads, ..Case::default() })
    }

    /// The tangent of the path is the derivative of its equilibria by the load, by central differences.
    #[test]
    fn tangents_are_derivatives_by_the_load() {
        const STEP: f64 = 1e-4;
        let (robot, case) = loaded();
        let model = CosseratDisks::new(&robot, &case.loads, &Options::default()).unwrap();
        let mesh = model.mesh(4).unwrap();
        let mut workspace = Workspace::default();
        model.accept(&case, &mesh, &mut workspace).unwrap();
        let Workspace { scratch, commands, meter, .. } = &mut workspace;
        let problem = model.problem(&mesh, (commands, meter), &case).unwrap();
        let start = start_of_path(&problem, scratch).unwrap().unwrap();
        let mut path = ChainPath::new(&problem, scratch);
        let mut at = |from: &State, load: f64| {
            path.set_state(State { load, ..from.clone() });
            path.converge(None, 0.0).unwrap();
            let here = path.state();
            let tangent = path.direction(Step::Along(&here.along_load())).unwrap();
            (here, tangent)
        };
        let (near, _) = at(&start, 0.3);
        let (here, tangent) = at(&near, 0.6);
        let (ahead, _) = at(&here, 0.6 + STEP);
        let (behind, _) = at(&here, 0.6 - STEP);
        let rate = tangent.load / (2.0 * STEP);
        let turns = ahead.nodes.iter().zip(&behind.nodes).zip(&tangent.nodes);
        let mut greatest: f64 = 0.0;
        for ((ahead, behind), step) in turns {
            let turned = (behind.rotation.conjugate() * ahead.rotation).log() * rate;
            let moment = (ahead.moment - behind.moment) * rate;
            greatest = greatest.max(turned.norm()).max(moment.norm());
            let own = NodeStep::default().plus(1.0, *step).change;
            assert!((turned - own.turn).norm() < 1e-4, "{turned:?} {:?}", own.turn);
            assert!((moment - own.moment).norm() < 1e-4, "{moment:?} {:?}", own.moment);
        }
        assert!(greatest > 0.1, "{greatest}");
        let tension = (ahead.tensions[0] - behind.tensions[0]) * rate;
        assert!(here.tensions[0] > 0.1, "{}", here.tensions[0]);
        let off = tension - tangent.tensions[0];
        assert!(off.abs() < 1e-3 * (1.0 + tension.abs()), "{tension} {}", tangent.tensions[0]);
    }
}
