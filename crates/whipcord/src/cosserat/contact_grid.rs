//! Where the nodes of the rod are under contact forces, and the states at them.

use whipcord_numerics::UnitQuaternion;

use super::friction::Friction;
use super::loaded::Trajectory;
use super::prepared::Cosserat;
use super::state::{Node, State};
use super::target::Target;
use crate::case::Case;
use crate::error::SolveError;
use crate::robot::Robot;
use crate::section::step_tolerance;
use crate::solution::Solution;
use crate::statics::grid::Grid;
use crate::statics::loads::AppliedLoads;
use crate::statics::options::{Accuracy, Options, StabilityAnalysis};
use crate::statics::plastic_curvature::PlasticCurvature;
use crate::statics::plastic_steps::PlasticRod as _;
use crate::stations::Stations;

/// Where its nodes are.
#[derive(Clone, Debug)]
pub(super) struct ContactGrid {
    pub(super) model: Cosserat,
    pub(super) grid: Grid,
    /// How many steps there are at least, and how often each is halved.
    pub(super) steps: usize,
    pub(super) halvings: usize,
    pub(super) stations: Vec<f64>,
    pub(super) pushes: Vec<f64>,
    /// Where cables rub, and their tensions in each step by those of their nodes.
    pub(super) friction: Option<Friction>,
    pub(super) profile: Vec<f64>,
}

impl ContactGrid {
    pub(super) fn new(
        robot: &Robot,
        options: &Options,
        case: &Case,
        (least, halvings): (usize, usize),
        (stations, pushes): (&[f64], &[f64]),
        plastic: Option<&PlasticCurvature>,
    ) -> Result<Self, SolveError> {
        let mut places = stations.to_vec();
        places.extend_from_slice(pushes);
        places.sort_by(f64::total_cmp);
        places.dedup();
        let steps = match options.accuracy {
            Accuracy::Steps(steps) => steps,
            Accuracy::Tolerance(_) => least,
        };
        let options = Options {
            stations: Stations::At(places),
            accuracy: Accuracy::Steps(steps),
            stability: StabilityAnalysis::Off,
            ..options.clone()
        };
        let model = Cosserat::new(robot, &case.loads, &options)?;
        let grid = match halvings {
            0 => model.grid.clone(),
            _ => Grid::refined(robot, &model.layout, steps, halvings)?,
        };
        let friction = model.has_friction().then(|| model.friction_on(&grid));
        let profile = friction
            .as_ref()
            .map(|friction| friction.nodes.flat_profile(&grid))
            .unwrap_or_default();
        let (stations, pushes) = (stations.to_vec(), pushes.to_vec());
        let mut made = Self { model, grid, steps, halvings, stations, pushes, friction, profile };
        if let Some(plastic) = plastic {
            made.set_plastic(plastic);
        }
        Ok(made)
    }

    /// Sets the plastic curvature that the steps of actuation before left.
    pub(super) fn set_plastic(&mut self, left: &PlasticCurvature) {
        self.grid.set_plastic(left);
        self.model.set_plastic(left.clone());
    }

    /// The node of a station or a push.
    pub(super) fn node(&self, arc_length: f64) -> usize {
        let stations = self.model.stations();
        let place = stations.partition_point(|&s| s < arc_length).min(stations.len() - 1);
        self.grid.stations[place]
    }
}

/// The state at other nodes.
pub(super) fn carried(state: &State, from: &[f64], to: &[f64]) -> State {
    let nodes = to.iter().map(|&s| {
        let after = from.partition_point(|&at| at < s).clamp(1, from.len() - 1);
        let (a, b) = (state.nodes[after - 1], state.nodes[after]);
        let part = ((s - from[after - 1]) / (from[after] - from[after - 1])).clamp(0.0, 1.0);
        if part == 0.0 {
            return a;
        }
        if part == 1.0 {
            return b;
        }
        let turn = (a.rotation.conjugate() * b.rotation).log();
        Node {
            rotation: a.rotation * UnitQuaternion::exp(turn * part),
            moment: a.moment + (b.moment - a.moment) * part,
            ..a
        }
    });
    State { nodes: nodes.collect(), ..state.clone() }
}

/// Where an answer stood, by one shot with the wrench at its base.
pub(super) fn near(
    answer: &Solution,
    contact_grid: &ContactGrid,
    loads: &AppliedLoads,
    trajectory: &mut Trajectory,
) -> Option<State> {
    let base = answer.base_wrench?;
    let tension =
        |&cable: &usize| answer.cables.get(cable).and_then(|state| state.tension).unwrap_or(0.0);
    let tensions: Vec<f64> = contact_grid.model.layout.order.iter().map(tension).collect();
    let target = Target {
        tensions: &tensions,
        per_node: 0,
        base_moment: base.moment,
        follower_force: loads.follower_share(base.force),
        load: 1.0,
        sample: true,
        step_tolerance: step_tolerance(0.0),
    };
    trajectory.shoot(&contact_grid.grid, loads, &target).ok()?;
    let start = |k: usize| Node {
        rotation: trajectory.poses[k].rotation,
        moment: trajectory.samples[3 * k].wrench.angular,
        force: target.follower_force,
    };
    let steps = contact_grid.grid.len();
    let tip = Node { rotation: trajectory.poses[steps].rotation, ..Node::default() };
    let nodes = (0..steps).map(start).chain([tip]).collect();
    Some(State { nodes, tensions, load: 1.0 })
}
