//! The initial guess of shooting: one linear step of the rod from its shape without load.
//!
//! The wrench that the loads exert on the shape without load changes its strains; on the shape that
//! follows they exert a wrench that is nearer to the one in equilibrium, as long as the load bends
//! the rod much less than would buckle it. One such pass costs a fraction of a shot.

use whipcord_numerics::{Pose, Vec3};

use super::problem::Problem;
use super::scratch::Scratch;
use super::state::{Node, State};
use super::unloaded::integrate;
use crate::section::BodyWrench;
use crate::shape::Wrench;
use crate::statics::grid::Grid;
use crate::statics::loads::AppliedLoads;

/// Of the base moment: a pass that changes it more is not going to converge soon.
const MOST_CHANGE: f64 = 0.3;

/// Sets the point that Newton's method starts from, the strains of its first shot, and the nodes of multiple shooting.
pub(super) fn guess(problem: &Problem<'_>, scratch: &mut Scratch, load: f64) {
    let Problem { grid, .. } = *problem;
    let Scratch { poses, applied, newton, chain, tensions, unloaded, guess, trajectory, .. } =
        scratch;
    let State { nodes, tensions: of_chain, load: at_load } = &mut chain.state;
    nodes.clear();
    nodes.extend(poses.iter().map(|pose| Node { rotation: pose.rotation, ..Node::default() }));
    of_chain.clone_from(tensions);
    *at_load = load;
    guess.wrenches.resize(grid.len(), BodyWrench::default());
    let mut at_base = carry(grid, applied, poses, load, |k, middle, _| {
        // A step turns by little: its ends serve for its middle.
        let [near, far] = [k, k + 1].map(|k: usize| poses[k].rotation.conjugate());
        guess.wrenches[k] = BodyWrench {
            linear: 0.5 * (near.rotate(middle.force) + far.rotate(middle.force)),
            angular: 0.5 * (near.rotate(middle.moment) + far.rotate(middle.moment)),
        };
    });
    let strains = &unloaded.strains;
    let better = guess.relax(grid, tensions, strains).then(|| {
        integrate(grid, &guess.strains, &mut guess.poses);
        turn(nodes, &guess.poses);
        carry(grid, applied, &guess.poses, load, |k, _, start| nodes[k].bear(start))
    });
    let change = |better: &Wrench| (better.moment - at_base.moment).norm();
    if let Some(better) = better.filter(|b| change(b) <= MOST_CHANGE * at_base.moment.norm()) {
        at_base = better;
        trajectory.seed(grid, &guess.strains);
    } else {
        trajectory.seed(grid, strains);
        turn(nodes, poses);
        carry(grid, applied, poses, load, |k, _, start| nodes[k].bear(start));
    }
    newton.point.base_moment = at_base.moment;
    newton.point.follower_force = at_base.force;
    newton.point.tensions.clone_from(tensions);
}

fn turn(nodes: &mut [Node], poses: &[Pose]) {
    for (node, pose) in nodes.iter_mut().zip(poses) {
        node.rotation = pose.rotation;
    }
}

/// What the base would exert if the loads acted on this shape. `pass` is told, from the tip down, force and moment in the middle of each
/// step, and at its start the moment and the followers' force, in the base frame.
#[inline]
fn carry(
    grid: &Grid,
    loads: &AppliedLoads,
    poses: &[Pose],
    load: f64,
    mut pass: impl FnMut(usize, Wrench, Wrench),
) -> Wrench {
    let (mut moment, mut follower_force) = (Vec3::ZERO, Vec3::ZERO);
    for k in (0..grid.len()).rev() {
        let (near, far) = (&poses[k], &poses[k + 1]);
        let follower = loads.follower(k + 1);
        follower_force += far.rotation.rotate(follower.force);
        moment += loads.moment(k + 1) + far.rotation.rotate(follower.moment);
        let mut force = loads.force(k, 2) + follower_force;
        let mut spread = Vec3::ZERO;
        if let Some(line) = loads.line(k) {
            let h = grid.steps[k].length;
            let contact_response = h * far.rotation.rotate(line.follower_force(0.5));
            force += 0.5 * contact_response;
            follower_force += contact_response;
            spread = h * (line.moment(0.5) + far.rotation.rotate(line.follower_moment(0.5)));
        }
        let along = (far.position - near.position).cross(force) + spread;
        let middle = Wrench { force: load * force, moment: load * (moment + 0.5 * along) };
        moment += along;
        pass(k, middle, Wrench { force: load * follower_force, moment: load * moment });
    }
    Wrench { moment: moment * load, force: follower_force * load }
}
