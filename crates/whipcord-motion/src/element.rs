//! The quadratic element: three nodes of Lobatto's rule, which carry velocities and masses, and two points of Gauss's rule, which carry
//! strains.

use whipcord_numerics::{GAUSS_2, Pose, Twist};

/// Nodes of an element, both ends included.
pub(crate) const NODES: usize = 3;
/// Points at which an element has its strains.
pub(crate) const POINTS: usize = 2;
/// Weights of the nodes, which add up to 1: of Lobatto's rule, which is Simpson's.
pub(crate) const LOBATTO: [f64; NODES] = [1.0 / 6.0, 4.0 / 6.0, 1.0 / 6.0];
/// Places of the nodes, as fractions of the element.
pub(crate) const PLACES: [f64; NODES] = [0.0, 0.5, 1.0];

/// Values of the shape functions at the points: `SHAPES[q][a]` of node `a` at point `q`.
pub(crate) const SHAPES: [[f64; NODES]; POINTS] =
    [shapes(GAUSS_2.nodes[0]), shapes(GAUSS_2.nodes[1])];
/// Their slopes by the fraction of the element.
pub(crate) const SLOPES: [[f64; NODES]; POINTS] =
    [slopes(GAUSS_2.nodes[0]), slopes(GAUSS_2.nodes[1])];

/// Values of the shape functions at a fraction of the element.
pub(crate) const fn shapes(x: f64) -> [f64; NODES] {
    [2.0 * (x - 0.5) * (x - 1.0), -4.0 * x * (x - 1.0), 2.0 * x * (x - 0.5)]
}

const fn slopes(x: f64) -> [f64; NODES] {
    [4.0 * x - 3.0, 4.0 - 8.0 * x, 4.0 * x - 1.0]
}

/// The strain at a fraction of an element, linear through its two points.
#[inline]
pub(crate) fn strain_at(points: &[Twist], x: f64) -> Twist {
    let [from, to] = GAUSS_2.nodes;
    let t = (x - from) / (to - from);
    points[0] * (1.0 - t) + points[1] * t
}

/// Adds to the three nodes of an element of length `h` what acts, with a weight, on the slope and the value of a field at a point.
#[inline]
pub(crate) fn add_to_nodes(
    nodes: &mut [Twist],
    slope: &Twist,
    value: &Twist,
    weight: f64,
    k: usize,
    h: f64,
) {
    for (a, node) in nodes.iter_mut().take(NODES).enumerate() {
        let (f, d) = (weight * SHAPES[k][a], weight * SLOPES[k][a] / h);
        *node = *node + *slope * d + *value * f;
    }
}

/// The motion along a part of an element of length `h` with linear strain: `middle` is the strain at its middle, `change` what it changes by
/// from end to end; the exponential of the fourth-order Magnus series, eq. (3) of the page on motion.
#[inline]
pub(crate) fn motion(middle: Twist, change: Twist, h: f64) -> Pose {
    Pose::exp(middle * h + middle.bracket(change) * (h * h / 12.0))
}

/// Poses of the middle and of the end of an element of length `h` from the pose of its start.
#[inline]
pub(crate) fn poses(start: Pose, points: &[Twist], h: f64) -> [Pose; 2] {
    let [from, to] = GAUSS_2.nodes;
    let change = (points[1] - points[0]) * (0.5 / (to - from));
    let middle = start * motion(strain_at(points, 0.25), change, 0.5 * h);
    [middle, middle * motion(strain_at(points, 0.75), change, 0.5 * h)]
}

/// Pose at a fraction of an element of length `h` from the poses of its first two nodes.
#[inline]
pub(crate) fn pose_at(nodes: &[Pose], points: &[Twist], h: f64, x: f64) -> Pose {
    let [from, to] = GAUSS_2.nodes;
    let slope = (points[1] - points[0]) * (1.0 / (to - from));
    let node = if x < PLACES[1] { 0 } else { 1 };
    let part = x - PLACES[node];
    let middle = strain_at(points, PLACES[node] + 0.5 * part);
    nodes[node] * motion(middle, slope * part, part * h)
}

#[cfg(test)]
mod tests {
    use super::*;
    use whipcord_numerics::{GAUSS_3, Vec3, magnus_6};

    #[test]
    fn shape_functions_reproduce_parabolas() {
        for q in 0..POINTS {
            let x = GAUSS_2.nodes[q];
            for power in 0..3 {
                let at = |s: f64| s.powi(power);
                let value: f64 = (0..NODES).map(|a| SHAPES[q][a] * at(PLACES[a])).sum();
                let slope: f64 = (0..NODES).map(|a| SLOPES[q][a] * at(PLACES[a])).sum();
                let exact = f64::from(power) * x.powi((power - 1).max(0));
                assert!((value - at(x)).abs() < 1e-15 && (slope - exact).abs() < 1e-14);
            }
        }
    }

    #[test]
    fn poses_inside_an_element_meet_those_of_its_nodes() {
        let points = [0.8, 1.3].map(|u| Twist {
            linear: Vec3::new(0.1, 0.0, 1.0),
            angular: Vec3::new(u, 1.0 - u, 0.3 * u),
        });
        let h = 0.3;
        let [middle, end] = poses(Pose::IDENTITY, &points, h);
        let nodes = [Pose::IDENTITY, middle];
        for (x, known) in [(0.0, Pose::IDENTITY), (0.5, middle), (1.0, end)] {
            let found = pose_at(&nodes, &points, h, x);
            assert!((found.position - known.position).norm() < 1e-15);
        }
        let before = pose_at(&nodes, &points, h, 0.5 - 1e-9);
        assert!((before.position - middle.position).norm() < 1e-9);
    }

    /// Against the sixth-order series in many small steps: order 4.
    #[test]
    fn poses_are_of_fourth_order() {
        let strain = |s: f64| Twist {
            linear: Vec3::new(0.1, 0.02, 1.0),
            angular: Vec3::new(2.0 - s, 1.0 + 3.0 * s, 0.7 * s),
        };
        let error = |h: f64| {
            let points = GAUSS_2.nodes.map(|x| strain(x * h));
            let [_, end] = poses(Pose::IDENTITY, &points, h);
            let fine = (0..64).fold(Pose::IDENTITY, |pose, k| {
                let piece = h / 64.0;
                pose * magnus_6(&GAUSS_3.nodes.map(|x| strain((k as f64 + x) * piece) * piece))
            });
            (end.position - fine.position).norm()
        };
        let order = (error(0.4) / error(0.2)).log2();
        assert!((4.6..5.6).contains(&order), "{order}");
    }
}
