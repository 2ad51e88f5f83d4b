use crate::{Pose, Twist};

/// The motion over one step of `g′ = g ξ̂(s)` on SE(3), of order 6: exponential of the Magnus
/// series with the twist at the three nodes of [`crate::GAUSS_3`].
///
/// Blanes, Casas, Oteo and Ros, *The Magnus expansion and some of its applications*, Phys. Rep. 470
/// (2009), section 5.4, written for a twist that multiplies from the right: the commutators of an
/// even number of brackets keep their sign, those of an odd number change it.
///
/// `twists` are `ξ` times the length of the step.
#[inline(always)]
#[must_use]
pub fn magnus_6(twists: &[Twist; 3]) -> Pose {
    let [a, b, c] = *twists;
    let alpha_1 = b;
    let alpha_2 = (c - a) * (15.0_f64.sqrt() / 3.0);
    let alpha_3 = (c + a - b * 2.0) * (10.0 / 3.0);
    let inner = alpha_1.bracket(alpha_2);
    let outer = alpha_1.bracket(alpha_3 * 2.0 - inner) * (1.0 / 60.0);
    let series = (alpha_1 * 20.0 + alpha_3 + inner).bracket(alpha_2 + outer) * (1.0 / 240.0);
    Pose::exp(alpha_1 + alpha_3 * (1.0 / 12.0) + series)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{GAUSS_3, Vec3};

    fn twist(s: f64) -> Twist {
        Twist {
            linear: Vec3::new(0.2 * s, 0.1 * (3.0 * s).sin(), 1.0),
            angular: Vec3::new((2.0 * s).sin(), (3.0 * s).cos(), 0.5 + s * s),
        }
    }

    fn end(steps: usize) -> Pose {
        let h = 1.0 / steps as f64;
        (0..steps).fold(Pose::IDENTITY, |pose, k| {
            let at = |c: f64| twist((k as f64 + c) * h) * h;
            pose * magnus_6(&GAUSS_3.nodes.map(at))
        })
    }

    #[test]
    fn sixth_order() {
        let exact = end(256);
        let error = |n: usize| (end(n).position - exact.position).norm();
        for n in [4, 8] {
            let order = (error(n) / error(2 * n)).log2();
            assert!((5.7..6.6).contains(&order), "{n}: {order}");
        }
    }

    /// Independent of the series: many small steps of the exponential midpoint rule, extrapolated.
    #[test]
    fn agrees_with_the_midpoint_rule() {
        let midpoint = |steps: usize| {
            let h = 1.0 / steps as f64;
            (0..steps)
                .fold(Pose::IDENTITY, |g, k| g * Pose::exp(twist((k as f64 + 0.5) * h) * h))
                .position
        };
        let extrapolated = (4.0 * midpoint(8192) - midpoint(4096)) / 3.0;
        assert!((end(64).position - extrapolated).norm() < 1e-11);
    }
}
