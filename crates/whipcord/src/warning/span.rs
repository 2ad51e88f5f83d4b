//! The strains of a backbone between two stations.

use core::f64::consts::{PI, TAU};

use whipcord_numerics::{Pose, Twist, Vec3};

/// A backbone is not stretched or compressed by more than this share between two stations: where each constant strain between
/// two frames would do so, none of them is its own.
const MOST_STRETCH: f64 = 0.5;

/// The constant strain between two frames that are `length` apart along the backbone, as in [`crate::Shape::strains`], for any
/// turn up to one and a half: rotations by θ, θ − 2π and θ + 2π about the same axis lead to the same frame, and of these the strain
/// is taken that stretches the backbone least. `None` where that is not told: a whole turn has no axis.
pub(super) fn strain(from: Pose, to: Pose, length: f64) -> Option<Twist> {
    let next = from.inverse() * to;
    let least = next.log();
    let angle = least.angular.norm();
    let stretch = |strain: &Twist| (strain.linear.norm() - 1.0).abs();
    let mut best = least * (1.0 / length);
    // Of a turn of less than a quarter the others are longer by far.
    if angle > 0.5 * PI || stretch(&best) > MOST_STRETCH {
        for other in [angle - TAU, angle + TAU].into_iter().filter(|_| angle > 1e-6) {
            let angular = least.angular * (other / angle);
            let linear = unrolled(angular, next.position);
            let strain = Twist { linear, angular } * (1.0 / length);
            if stretch(&strain) < stretch(&best) - 1e-9 {
                best = strain;
            }
        }
    }
    (stretch(&best) <= MOST_STRETCH).then_some(best)
}

/// `V⁻¹ p` of the exponential of rigid motions: the path at constant strain with the rotation vector `w` that leads to p,
/// `V⁻¹ = 1 − [w]/2 + (1 − (φ/2) cot(φ/2)) [w]²/φ²`, φ = |w|.
fn unrolled(w: Vec3, p: Vec3) -> Vec3 {
    let angle = w.norm();
    let share = (1.0 - 0.5 * angle / (0.5 * angle).tan()) / (angle * angle);
    let turned = w.cross(p);
    p - turned * 0.5 + w.cross(turned) * share
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turns_of_more_than_half_a_circle_are_told_by_the_length() {
        let start = Pose::exp(Twist { linear: Vec3::Y, angular: Vec3::new(0.2, 0.4, -1.0) });
        for (degrees, twist, stretch) in [
            (10.0, 0.0, 1.0),
            (170.0, 0.5, 1.0),
            (220.0, 0.0, 1.02),
            (300.0, -0.4, 0.98),
            (500.0, 0.0, 1.0),
        ] {
            let angular = Vec3::new(0.6, -0.8, 0.0) * f64::to_radians(degrees) + Vec3::Z * twist;
            let given = Twist { linear: Vec3::Z * stretch, angular } * (1.0 / 0.3);
            let given = Twist { linear: Vec3::Z * stretch, ..given };
            let found = strain(start, start * Pose::exp(given * 0.3), 0.3).unwrap();
            assert!((found.angular - given.angular).max_abs() < 1e-9, "{degrees}: {found:?}");
            assert!((found.linear - given.linear).max_abs() < 1e-9, "{degrees}: {found:?}");
        }
    }

    #[test]
    fn a_whole_turn_has_no_axis() {
        assert_eq!(strain(Pose::IDENTITY, Pose::IDENTITY, 0.1), None);
    }
}
