//! What inertia, weight and loads exert on a node in one stage, and how this changes with a factor and in time.

use whipcord_numerics::{Twist, Vec3};

use crate::block::transposed_bracket;
use crate::conserving::Conserving;
use crate::element::{POINTS, add_to_nodes};
use crate::iteration::Mechanics;
use crate::rod::Rod;
use crate::scheme::Scheme;
use crate::stage::Stage;

/// What a factor on all masses multiplies in the equations of a node; weight that acts by the gradient of its height is left out.
pub(crate) fn inertia_and_weight(
    Mechanics { rod, loads }: Mechanics<'_>,
    stage: &Stage,
    scheme: &Scheme,
    a: usize,
) -> Twist {
    let node = &rod.nodes[a];
    let moving = if scheme.inertia == 0.0 { 0.0 } else { 1.0 };
    let change = (stage.velocities[a] - stage.velocity_history[a]) * scheme.inertia;
    let Twist { linear: nu, angular: omega } = stage.velocities[a];
    let weight = match stage.by_heights(scheme) {
        true => Vec3::ZERO,
        false => {
            let weight = loads.gravity * node.mass + stage.loads[a].weight;
            stage.poses[a].rotation.conjugate().rotate(weight)
        }
    };
    Twist {
        linear: (change.linear + omega.cross(nu) * moving) * node.mass - weight,
        angular: node.inertia.scale(change.angular)
            + omega.cross(node.inertia.scale(omega)) * moving,
    }
}

/// What loads over time add to the residual of each node in 1 s; `None` where there are none.
pub(crate) fn load_rates(
    mechanics: Mechanics<'_>,
    stage: &mut Stage,
    scheme: &Scheme,
    time: f64,
) -> Option<Vec<Twist>> {
    let Mechanics { rod, loads } = mechanics;
    let rates = loads.rates_at(time)?;
    let mut out = vec![Twist::default(); rod.nodes.len()];
    if stage.by_heights(scheme) {
        // Forces act by the gradient of their heights.
        let forces = Conserving::of_forces(rod, stage, scheme, &rates);
        add_forces(rod, stage, &forces, 1.0, &mut out);
    }
    for a in loads.first_free()..rod.nodes.len() {
        let (rate, turn) = (&rates[a], stage.poses[a].rotation.conjugate());
        let force = if stage.by_heights(scheme) { Vec3::ZERO } else { turn.rotate(rate.force) };
        out[a].linear -= force + rate.follower_force;
        out[a].angular -= turn.rotate(rate.moment) + rate.follower_moment;
    }
    Some(out)
}

/// Adds to what the equations of motion lack what forces on the strains, times the weights of the points and a factor, are there.
pub(crate) fn add_forces(
    rod: &Rod,
    stage: &Stage,
    forces: &[Twist],
    factor: f64,
    out: &mut [Twist],
) {
    for (q, force) in forces.iter().enumerate() {
        let (e, k) = (q / POINTS, q % POINTS);
        let across = transposed_bracket(&stage.strains[q], force);
        add_to_nodes(&mut out[2 * e..], force, &across, factor, k, rod.lengths[e]);
    }
}

/// Dead force, with the weight, and moment of a node in its frame; with the moment alone where the force acts by the gradient of its height.
pub(crate) fn dead_load(
    Mechanics { rod, loads }: Mechanics<'_>,
    stage: &Stage,
    a: usize,
    with_force: bool,
) -> Twist {
    let load = &stage.loads[a];
    let turn = stage.poses[a].rotation.conjugate();
    let force =
        if with_force { load.force + loads.gravity * rod.nodes[a].mass } else { Vec3::ZERO };
    Twist { linear: turn.rotate(force), angular: turn.rotate(load.moment) }
}
