//! The loads of a file as the page draws them.

use whipcord::{DistributedLoad, Loads, Vec3};

use crate::convert::array;
use crate::protocol::{Acting, Load};

/// Places along a load that is spread over the whole backbone.
const PLACES: f64 = 16.0;

/// What acts on a backbone of this length in m.
pub fn acting(of: &Loads, length: f64) -> Acting {
    Acting {
        tip_force: array(of.tip_force),
        tip_moment: array(of.tip_moment),
        tip_follower: of.tip_follower,
        gravity: array(of.gravity.unwrap_or_default()),
        loads: loads(of, length),
    }
}

/// All but tip load and gravity, which have sliders.
pub fn loads(loads: &Loads, length: f64) -> Vec<Load> {
    let points = loads.points.iter().map(|load| Load::Single {
        arc_length: load.at,
        force: array(load.force),
        moment: array(load.moment),
        follows: load.follower,
    });
    let spread = loads.distributed.iter().map(|load| spread(load, length));
    let masses = loads.masses.iter().map(|of| Load::Mass { arc_length: of.at, mass: of.mass });
    points.chain(spread).chain(masses).collect()
}

fn spread(load: &DistributedLoad, length: f64) -> Load {
    let (mut arc_lengths, mut forces, mut moments) = (Vec::new(), Vec::new(), Vec::new());
    for piece in load.profile.pieces() {
        let [from, to] = piece.at;
        let parts = (PLACES * (to - from) / length).ceil().clamp(1.0, PLACES);
        let first = if arc_lengths.is_empty() { 0 } else { 1 };
        for k in first..=parts as usize {
            let t = k as f64 / parts;
            let mix = |[a, b]: [Vec3; 2]| array(a * (1.0 - t) + b * t);
            arc_lengths.push(from * (1.0 - t) + to * t);
            forces.push(mix(piece.force));
            moments.push(mix(piece.moment));
        }
    }
    Load::Spread { arc_lengths, forces, moments, follows: load.follower }
}
