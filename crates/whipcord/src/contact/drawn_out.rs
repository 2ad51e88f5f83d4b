//! Obstacles that come from elsewhere to where they are.

use whipcord_numerics::{Pose, Vec3};

use super::scene::Scene;

/// How far each obstacle is drawn out of the robot.
#[derive(Clone, Debug)]
pub(super) struct DrawnOut {
    /// Where the obstacles are in the end, as the base sees them.
    pub homes: Vec<Pose>,
    /// In m.
    pub ways: Vec<Vec3>,
}

impl DrawnOut {
    /// Puts the obstacles to where they are when this part of their way is left.
    pub fn place(&self, left: f64, scene: &mut Scene) {
        for (number, (home, way)) in self.homes.iter().zip(&self.ways).enumerate() {
            if *way != Vec3::ZERO {
                scene.place(number, Pose { position: home.position + *way * left, ..*home });
            }
        }
    }
}
