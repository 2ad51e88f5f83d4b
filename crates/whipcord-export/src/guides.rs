//! Where cables are held at the backbone: at the disks, or all along it.

use whipcord::{ModelKind, Robot, Vec3};

use crate::places::nearest;

/// A place at which a cable is held.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Guide {
    /// Number of the place along the backbone.
    pub place: usize,
    /// Offset from the backbone in m, in the frame of the cross-section.
    pub offset: Vec3,
}

/// Whether the cables of this model follow their routing between the disks, instead of straight lines from hole to hole.
pub const fn follows_routing(model: ModelKind) -> bool {
    matches!(model, ModelKind::Cosserat | ModelKind::ConstantCurvature)
}

/// The guides of each cable from the base on: at every one of these places for a model whose cables follow their routing, else at
/// the disks and where the cable is anchored.
pub fn guides(robot: &Robot, model: ModelKind, places: &[f64]) -> Vec<Vec<Guide>> {
    let everywhere = follows_routing(model) || !robot.has_disks();
    let at_disks: Vec<usize> =
        robot.disks().arc_lengths.iter().map(|&s| nearest(places, s)).collect();
    let of_cable = |route: &whipcord::robot::Route| {
        let last = nearest(places, route.end());
        let is_guide = |k: &usize| everywhere || *k == last || at_disks.binary_search(k).is_ok();
        let held = (0..=last).filter(is_guide);
        held.map(|place| {
            let offset = route.at(places[place].min(route.end())).offset;
            Guide { place, offset }
        })
        .collect()
    };
    robot.routes().iter().map(of_cable).collect()
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test fails by panicking")]
mod tests {
    use whipcord::{Backbone, Cable, Disks, Routing};

    use super::*;

    #[test]
    fn cables_are_held_at_disks_and_at_their_end_or_everywhere() {
        let cable = Cable {
            ends_at: Some(0.06),
            ..Cable::new("a", Routing::Linear { start: [0.01, 0.0], end: [0.0, 0.0] })
        };
        let disks = Disks::equally_spaced(0.1, 3, 0.01);
        let robot = Robot::new(Backbone::new(0.1), disks, vec![cable]).unwrap();
        let places: Vec<f64> = (0..=10).map(|k| 0.01 * f64::from(k)).collect();
        let at = |model| -> Vec<usize> {
            guides(&robot, model, &places)[0].iter().map(|guide| guide.place).collect()
        };
        assert_eq!(at(ModelKind::CosseratDisks), [0, 5, 6]);
        assert_eq!(at(ModelKind::Cosserat), [0, 1, 2, 3, 4, 5, 6]);
        let last = guides(&robot, ModelKind::FourBar, &places)[0][2];
        assert!((last.offset - Vec3::new(0.004, 0.0, 0.0)).norm() < 1e-12);
    }
}
