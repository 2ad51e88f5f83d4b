//! Poses of the nodes from the strains, and what dead forces exert on the strains.

use whipcord::Wrench;
use whipcord_numerics::{GAUSS_2, Pose, Twist, Vec3};

use crate::block::{dot, transposed_bracket};
use crate::element::{POINTS, poses, strain_at};
use crate::rod::Rod;

/// Poses of all nodes from that of the base.
pub(crate) fn nodes(rod: &Rod, base: Pose, strains: &[Twist], out: &mut [Pose]) {
    let mut pose = base;
    out[0] = pose;
    for (e, &h) in rod.lengths.iter().enumerate() {
        let [middle, end] = poses(pose, &strains[POINTS * e..POINTS * (e + 1)], h);
        out[2 * e + 1] = middle;
        out[2 * e + 2] = end;
        pose = end;
    }
}

/// Work of forces on the nodes, up to a constant: `Σ F · p`.
pub(crate) fn work(poses: &[Pose], force: impl Fn(usize) -> Vec3) -> f64 {
    poses.iter().enumerate().map(|(a, pose)| force(a).dot(pose.position)).sum()
}

/// The gradient by the strains of the work of forces and moments on the nodes, in the frame that the poses are given in: the force on the strain of each
/// point, times its weight, eq. (17) of the page on motion.
pub(crate) fn work_gradient(
    rod: &Rod,
    strains: &[Twist],
    poses: &[Pose],
    wrench: impl Fn(usize) -> Wrench,
    out: &mut [Twist],
) {
    let [from, to] = GAUSS_2.nodes;
    let slope = 0.5 / (to - from);
    // Force and moment about the node of all that acts beyond it, in the frame of the base.
    let (mut sum, mut moment) = (Vec3::ZERO, Vec3::ZERO);
    for e in (0..rod.elements()).rev() {
        let points = &strains[POINTS * e..POINTS * (e + 1)];
        let half = 0.5 * rod.lengths[e];
        let change = (points[1] - points[0]) * slope;
        let mut gradient = [Twist::default(); POINTS];
        for (node, place) in [(2 * e + 2, 0.75), (2 * e + 1, 0.25)] {
            let of_node = wrench(node);
            sum += of_node.force;
            moment += of_node.moment;
            let turn = poses[node].rotation.conjugate();
            let wrench = Twist { linear: turn.rotate(sum), angular: turn.rotate(moment) };
            let middle = strain_at(points, place);
            let exponent = middle * half + middle.bracket(change) * (half * half / 12.0);
            let force = transposed_exponential(&exponent, &wrench);
            let sixth = half * half / 12.0;
            let of_middle = force * half - transposed_bracket(&change, &force) * sixth;
            let of_change = transposed_bracket(&middle, &force) * (sixth * slope);
            let t = (place - from) / (to - from);
            gradient[0] = gradient[0] + of_middle * (1.0 - t) - of_change;
            gradient[1] = gradient[1] + of_middle * t + of_change;
            let arm = poses[node].position - poses[node - 1].position;
            moment += arm.cross(sum);
        }
        out[POINTS * e..POINTS * (e + 1)].copy_from_slice(&gradient);
    }
}

/// Terms of the series of the exponential: the twist of a half element, and of a free base in a step, is below 1.
const TERMS: usize = 16;

/// `dexp(−Ω)ᵀ W = Σ (−ad_Ωᵀ)ᵏ W/(k + 1)!`.
fn transposed_exponential(exponent: &Twist, wrench: &Twist) -> Twist {
    let (mut sum, mut term) = (*wrench, *wrench);
    for k in 1..TERMS {
        term = transposed_bracket(exponent, &term) * (-1.0 / (k + 1) as f64);
        sum = sum + term;
        if dot(&term, &term) <= 1e-36 * dot(&sum, &sum) {
            break;
        }
    }
    sum
}

/// How each node turns and moves for small changes of the strains and of the pose of the base, the base included: exactly, the transpose of [`work_gradient`]. The change of
/// the base is along and about its own axes; turns and displacements are in the frame that the poses are given in.
pub(crate) fn exact_displacements(
    rod: &Rod,
    strains: &[Twist],
    poses: &[Pose],
    (base, changes): (Twist, &[Twist]),
    mut found: impl FnMut(usize, Vec3, Vec3),
) {
    let [from, to] = GAUSS_2.nodes;
    let slope = 0.5 / (to - from);
    let mut turn = poses[0].rotation.rotate(base.angular);
    let mut shift = poses[0].rotation.rotate(base.linear);
    found(0, turn, shift);
    for e in 0..rod.elements() {
        let range = POINTS * e..POINTS * (e + 1);
        let (points, changes) = (&strains[range.clone()], &changes[range]);
        let half = 0.5 * rod.lengths[e];
        let sixth = half * half / 12.0;
        let of_points = |of: &[Twist]| (of[1] - of[0]) * slope;
        let (change, d_change) = (of_points(points), of_points(changes));
        for (node, place) in [(2 * e + 1, 0.25), (2 * e + 2, 0.75)] {
            let (middle, d_middle) = (strain_at(points, place), strain_at(changes, place));
            let exponent = middle * half + middle.bracket(change) * sixth;
            let d_exponent =
                d_middle * half + (d_middle.bracket(change) + middle.bracket(d_change)) * sixth;
            let own = exponential_change(&exponent, &d_exponent);
            let arm = poses[node].position - poses[node - 1].position;
            let rotation = poses[node].rotation;
            shift += turn.cross(arm) + rotation.rotate(own.linear);
            turn += rotation.rotate(own.angular);
            found(node, turn, shift);
        }
    }
}

/// `dexp(−Ω) x = Σ (−ad_Ω)ᵏ x/(k + 1)!`.
pub(crate) fn exponential_change(exponent: &Twist, x: &Twist) -> Twist {
    let (mut sum, mut term) = (*x, *x);
    for k in 1..TERMS {
        term = exponent.bracket(term) * (-1.0 / (k + 1) as f64);
        sum = sum + term;
    }
    sum
}

/// The greatest displacement of a node for small changes of the strains.
pub(crate) fn displacement(rod: &Rod, poses: &[Pose], changes: &[Twist]) -> f64 {
    let mut greatest = 0.0_f64;
    displacements(rod, poses, changes, |_, _, shift| greatest = greatest.max(shift.norm()));
    greatest
}

/// How each node beyond the base turns and moves for small changes of the strains, in the order of their numbers.
pub(crate) fn displacements(
    rod: &Rod,
    poses: &[Pose],
    changes: &[Twist],
    mut found: impl FnMut(usize, Vec3, Vec3),
) {
    let (mut turn, mut shift) = (Vec3::ZERO, Vec3::ZERO);
    for e in 0..rod.elements() {
        for k in 0..POINTS {
            let q = POINTS * e + k;
            let (from, to) = (poses[q], poses[q + 1]);
            let change = &changes[q];
            // Half of an element has the changes of its point.
            let half = to.rotation.rotate(change.angular) * (0.5 * rod.lengths[e]);
            let arm = to.position - from.position;
            shift += (turn + half * 0.5).cross(arm)
                + to.rotation.rotate(change.linear) * (0.5 * rod.lengths[e]);
            turn += half;
            found(q + 1, turn, shift);
        }
    }
}
