//! What is true of the distance from any body.

use whipcord::{Form, Obstacle, Pose, Vec3};

use crate::obstacles::forms::{Draws, all, at_origin};

/// |d(p) − d(q)| ≤ |p − q|: what is not the distance jumps, or grows faster, somewhere.
#[test]
fn grows_no_faster_than_the_way() {
    for (name, form) in all() {
        let obstacle = at_origin(form);
        let mut draws = Draws::new(1);
        for _ in 0..4000 {
            let p = draws.vector(0.05);
            for reach in [1e-2, 1e-4, 1e-6] {
                let q = p + draws.vector(reach);
                let change = obstacle.surface(p).distance - obstacle.surface(q).distance;
                let way = (p - q).norm();
                assert!(change.abs() <= way + 1e-13, "{name}: {p:?} {q:?}: {change} over {way}");
            }
        }
    }
}

/// The normal is the gradient. Where the nearest point jumps, there is none; such places are few.
#[test]
fn its_gradient_is_the_normal() {
    const STEP: f64 = 1e-7;
    for (name, form) in all() {
        let obstacle = at_origin(form);
        let mut draws = Draws::new(2);
        let mut kinks = 0;
        for _ in 0..2000 {
            let p = draws.vector(0.05);
            let normal = obstacle.surface(p).normal;
            assert!((normal.norm() - 1.0).abs() < 1e-12, "{name}");
            let along = |axis: Vec3| {
                let [a, b] = [-STEP, STEP].map(|h| obstacle.surface(p + h * axis).distance);
                (b - a) / (2.0 * STEP)
            };
            let gradient = Vec3::new(along(Vec3::X), along(Vec3::Y), along(Vec3::Z));
            if (gradient - normal).norm() > 2e-6 {
                kinks += 1;
            }
        }
        assert!(kinks <= 6, "{name}: {kinks} kinks");
    }
}

/// But for pipes with corners: in the elbow, the distance is only to the nearer of two bores.
///
/// From outside, the point at the distance against the normal is on the surface, and so it is from
/// inside.
#[test]
fn the_way_out_ends_on_the_surface() {
    for (name, form) in all() {
        let obstacle = at_origin(form);
        if name == "cornered pipe" {
            continue;
        }
        let mut draws = Draws::new(3);
        let mut worst = 0.0_f64;
        for _ in 0..4000 {
            let p = draws.vector(0.03);
            let there = obstacle.surface(p);
            if let Form::Pipe(pipe) = &obstacle.form {
                // Far behind a bend, the distance is that from the plane of an end.
                let from_middle = pipe.middle().0.iter().map(|&q| (p - q).norm());
                if from_middle.fold(f64::INFINITY, f64::min) > 2.0 * pipe.radius() {
                    continue;
                }
            }
            let foot = p - there.distance * there.normal;
            worst = worst.max(obstacle.surface(foot).distance.abs());
        }
        assert!(worst < 1e-13, "{name}: {worst}");
    }
}

#[test]
fn moves_with_the_obstacle() {
    let mut draws = Draws::new(4);
    for (name, form) in all() {
        let still = at_origin(form);
        for _ in 0..100 {
            let pose = draws.pose();
            let moved = Obstacle { pose, ..still.clone() };
            let p = draws.vector(0.04);
            let (a, b) = (still.surface(p), moved.surface(pose.transform(p)));
            assert!((a.distance - b.distance).abs() < 1e-14, "{name}");
            let turned = Pose { position: Vec3::ZERO, ..pose }.transform(a.normal);
            assert!((turned - b.normal).norm() < 1e-9, "{name}: {p:?}");
        }
    }
}

/// At the middle, on axes and on the surface itself, too, the normal is a unit vector.
#[test]
fn has_a_normal_everywhere() {
    let values = [-0.02, -0.015, -0.01, -1e-300, 0.0, 5e-15, 0.01, 0.015, 0.02, 0.03, 1e3];
    for (name, form) in all() {
        let obstacle = at_origin(form);
        for x in values {
            for y in values {
                for z in values {
                    let there = obstacle.surface(Vec3::new(x, y, z));
                    assert!(there.distance.is_finite(), "{name}: {x} {y} {z}");
                    assert!((there.normal.norm() - 1.0).abs() < 1e-12, "{name}: {x} {y} {z}");
                }
            }
        }
    }
}
