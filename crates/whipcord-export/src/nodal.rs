//! Loads as forces and moments on the bodies of a chain.

use whipcord::{DistributedLoad, Loads, UnitQuaternion, Vec3};
use whipcord_numerics::GAUSS_2;

use crate::places::nearest;

/// A force and a moment on a body.
#[derive(Clone, Debug, PartialEq)]
pub struct NodalLoad {
    /// What it is called, after the lists of the robot file.
    pub name: String,
    /// The body, from 0 at the base.
    pub node: usize,
    /// In N: in the world, or in the frame of the body where it follows it.
    pub force: Vec3,
    /// In N·m, in the same frame.
    pub moment: Vec3,
    /// Whether both turn with the body.
    pub follower: bool,
}

/// The loads without weight, for a base that is turned by `base` and bodies at these arc lengths. A distributed load goes to the
/// two nodes beside it by the law of the lever.
pub fn nodal_loads(loads: &Loads, base: UnitQuaternion, places: &[f64]) -> Vec<NodalLoad> {
    let to_world = loads.to_world(base);
    let mut found = Vec::new();
    let mut add = |name: String, node: usize, [force, moment]: [Vec3; 2], follower: bool| {
        if force == Vec3::ZERO && moment == Vec3::ZERO {
            return;
        }
        let [force, moment] = match follower {
            true => [force, moment],
            false => [force, moment].map(|v| to_world.rotate(v)),
        };
        found.push(NodalLoad { name, node, force, moment, follower });
    };
    let tip = [loads.tip_force, loads.tip_moment];
    add("load:tip".to_owned(), places.len() - 1, tip, loads.tip_follower);
    for (k, point) in loads.points.iter().enumerate() {
        let name = format!("load:point-{}", k + 1);
        add(name, nearest(places, point.at), [point.force, point.moment], point.follower);
    }
    for (k, load) in loads.distributed.iter().enumerate() {
        for (node, load_of_node) in shared(load, places).into_iter().enumerate() {
            let name = format!("load:distributed-{}:node-{node}", k + 1);
            add(name, node, load_of_node, load.follower);
        }
    }
    found
}

/// Force and moment of a distributed load on each node.
fn shared(load: &DistributedLoad, places: &[f64]) -> Vec<[Vec3; 2]> {
    let mut nodes = vec![[Vec3::ZERO; 2]; places.len()];
    for piece in load.profile.pieces() {
        let [from, to] = piece.at;
        for (k, ends) in places.windows(2).enumerate() {
            let (a, b) = (from.max(ends[0]), to.min(ends[1]));
            if a >= b {
                continue;
            }
            for (place, weight) in GAUSS_2.nodes.into_iter().zip(GAUSS_2.weights) {
                let s = a + place * (b - a);
                let along = (s - from) / (to - from);
                let lever = (s - ends[0]) / (ends[1] - ends[0]);
                for (i, [start, end]) in [piece.force, piece.moment].into_iter().enumerate() {
                    let value = (start * (1.0 - along) + end * along) * (weight * (b - a));
                    nodes[k][i] += value * (1.0 - lever);
                    nodes[k + 1][i] += value * lever;
                }
            }
        }
    }
    nodes
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test fails by panicking")]
mod tests {
    use whipcord::{LoadFrame, PointLoad, Profile};

    use super::*;

    #[test]
    fn sums_and_first_moments_of_distributed_loads_are_kept() {
        let at = vec![0.013, 0.05, 0.09];
        let force = vec![Vec3::X, Vec3::X * 3.0, Vec3::ZERO];
        let load = DistributedLoad {
            profile: Profile::Linear { at, force, moment: Vec::new() },
            follower: false,
        };
        let places: Vec<f64> = (0..=10).map(|k| 0.01 * f64::from(k)).collect();
        let loads = Loads { distributed: vec![load], ..Loads::default() };
        let found = nodal_loads(&loads, UnitQuaternion::IDENTITY, &places);
        let sum: f64 = found.iter().map(|load| load.force.x).sum();
        let about_base: f64 = found.iter().map(|load| load.force.x * places[load.node]).sum();
        let trapezoids = 0.037 * 2.0 + 0.04 * 1.5;
        assert!((sum - trapezoids).abs() < 1e-12, "{sum}");
        // A trapezoid from 1 to 3 has its centroid at 7/12 of its width, a triangle at a third.
        let moments = 0.074 * (0.013 + 0.037 * 7.0 / 12.0) + 0.06 * (0.05 + 0.04 / 3.0);
        assert!((about_base - moments).abs() < 1e-12, "{about_base} {moments}");
    }

    #[test]
    fn dead_loads_are_turned_to_the_world_and_followers_are_not() {
        let quarter = UnitQuaternion::exp(Vec3::new(0.0, core::f64::consts::FRAC_PI_2, 0.0));
        let point = PointLoad { at: 0.1, force: Vec3::X, follower: true, ..PointLoad::default() };
        let mut loads = Loads { tip_force: Vec3::Z, points: vec![point], ..Loads::default() };
        let found = nodal_loads(&loads, quarter, &[0.0, 0.1, 0.2]);
        assert_eq!([found[0].node, found[1].node], [2, 1]);
        assert!((found[0].force - Vec3::X).norm() < 1e-12);
        assert_eq!((found[1].force, found[1].follower), (Vec3::X, true));
        loads.frame = LoadFrame::World;
        assert_eq!(nodal_loads(&loads, quarter, &[0.0, 0.2])[0].force, Vec3::Z);
    }
}
