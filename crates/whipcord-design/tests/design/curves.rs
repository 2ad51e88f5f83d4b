//! Routings, rest curvatures and tapers for curves, through forward solves.

use core::f64::consts::{PI, TAU};

use whipcord::{
    Actuation, Backbone, Case, Loads, Model, ModelKind, Robot, Section, Stations, Vec3,
};
use whipcord_design::{
    Curve, DesignError, rest_curvature_for_curve, route_for_curve, taper_for_curve,
};

use crate::robots::{LENGTH, straight};

fn rod() -> Model {
    Model::new(ModelKind::Cosserat, Stations::Disks, Actuation::Tension)
}

/// Ten curves that the cable can reach with 4 N within its disks, and what the shear that the closed form leaves out may move them by.
fn curves() -> Vec<(&'static str, Curve, f64)> {
    let l = LENGTH;
    vec![
        ("circle", Curve::circle(l, 1.0 / 5.8), 1e-9),
        ("flat arc", Curve::circle(l, 1.0), 1e-9),
        ("S", Curve::s_curve(l, 0.35), 2e-4),
        ("clothoid", Curve::clothoid(l, [0.5, 6.5]), 2e-4),
        ("clothoid through zero", Curve::clothoid(l, [-5.0, 6.0]), 2e-4),
        ("helix", Curve::new(l, 0.3, |_| 6.0, |_| 12.0), 2e-4),
        ("steep helix", Curve::new(l, 0.0, |_| 6.0, |_| 50.0), 4e-4),
        ("helix by radius and pitch", Curve::helix(l, 0.03, 0.4), 2e-4),
        (
            "waves",
            Curve::new(
                l,
                1.0,
                move |s| 4.0 + 2.0 * (TAU * s / l).sin(),
                move |s| 20.0 * (TAU * s / l).cos(),
            ),
            4e-4,
        ),
        ("twisted clothoid", Curve::new(l, 0.0, move |s| 0.5 + 6.0 * s / l, |_| 25.0), 3e-4),
    ]
}

#[test]
fn a_cable_bends_a_rod_to_ten_curves() {
    for (name, curve, tolerance) in curves() {
        let route = route_for_curve(&straight(&[0.0], 0.008), 0, &curve, 4.0).unwrap();
        println!("{name}: {:.2e} of the length, radii {:?}", route.error / LENGTH, route.radii);
        assert!(route.error <= tolerance * LENGTH, "{name}: {:.2e}", route.error / LENGTH);
        assert!(route.solution.diagnostics.is_unstable() || route.radii[1] <= 0.0081);
    }
}

/// What 4 N within the disks do not make, with the word of the reason, and what tension does where the cable only runs too far out.
#[test]
fn curves_beyond_the_disks_are_refused_with_the_reason() {
    let l = LENGTH;
    let curves = [
        ("circle of 100 mm", Curve::circle(l, 0.1), "far"),
        ("S of 57°", Curve::s_curve(l, 1.0), "far"),
        ("clothoid up to 20/m", Curve::clothoid(l, [0.0, 20.0]), "far"),
        ("helix of 30 mm by 90 mm", Curve::helix(l, 0.03, 0.09), "far"),
        ("torsion of 2000/m", Curve::new(l, 0.0, |_| 5.0, |_| 2_000.0), "winding"),
        ("shorter than the backbone", Curve::circle(0.1, 0.5), "short"),
    ];
    let robot = straight(&[0.0], 0.008);
    for (name, curve, reason) in curves {
        let refused = route_for_curve(&robot, 0, &curve, 4.0);
        let Err(error) = refused else { panic!("{name}: {refused:?}") };
        println!("{name}: {error}");
        match error {
            DesignError::NotAttainable { tension, .. } => {
                assert_eq!(reason, "far", "{name}");
                assert!(tension > 4.0, "{name}: {tension}");
                let brought_in = route_for_curve(&robot, 0, &curve, tension);
                assert!(brought_in.is_ok(), "{name}: {tension} {brought_in:?}");
            }
            DesignError::NotConverged { .. } => assert_eq!(reason, "winding", "{name}"),
            DesignError::Curve { .. } => assert_eq!(reason, "short", "{name}"),
            other => panic!("{name}: {other}"),
        }
    }
    // Backbones that the closed form is not for.
    let bent = whipcord::Along::Uniform(Vec3::X * 3.0);
    let square = Section::Rectangle {
        width: whipcord::Along::Uniform(0.002),
        height: whipcord::Along::Uniform(0.004),
    };
    for backbone in [
        Backbone { rest_curvature: bent, ..robot.backbone().clone() },
        Backbone { section: Some(square), ..robot.backbone().clone() },
    ] {
        let other = Robot::new(backbone, robot.disks().clone(), robot.cables().to_vec()).unwrap();
        let refused = route_for_curve(&other, 0, &Curve::circle(l, 1.0), 4.0);
        assert!(matches!(refused, Err(DesignError::Backbone { .. })), "{refused:?}");
    }
}

/// A straight cable bends a rod to a circle: τ = EI κ/r, and the axis is shortened by the tension.
#[test]
fn the_routing_of_a_circle_is_straight_at_the_radius_of_the_textbook() {
    let tension = 4.0;
    let route =
        route_for_curve(&straight(&[0.0], 0.008), 0, &Curve::circle(LENGTH, 0.2), tension).unwrap();
    let (d, e) = (0.003_f64, 1.1e9);
    let (bending, axial) = (e * PI * d.powi(4) / 64.0, e * PI * d * d / 4.0);
    let radius = bending / 0.2 * (1.0 - tension / axial) / tension;
    assert!((route.radii[0] - radius).abs() < 1e-9 && (route.radii[1] - radius).abs() < 1e-9);
}

#[test]
fn curves_that_cannot_be_are_refused_with_the_tension_that_would_do() {
    let robot = straight(&[0.0], 0.008);
    let refused = route_for_curve(&robot, 0, &Curve::circle(LENGTH, 0.1), 2.0);
    let Err(DesignError::NotAttainable { radius, largest, tension, .. }) = refused else {
        panic!("{refused:?}");
    };
    assert!(radius > largest);
    let route = route_for_curve(&robot, 0, &Curve::circle(LENGTH, 0.1), 1.001 * tension).unwrap();
    assert!(route.error < 1e-9);
    let short = route_for_curve(&robot, 0, &Curve::circle(0.1, 1.0), 2.0);
    assert!(matches!(short, Err(DesignError::Curve { .. })));
    let slack = route_for_curve(&robot, 0, &Curve::circle(LENGTH, 1.0), 0.0);
    assert!(matches!(slack, Err(DesignError::Curve { .. })));
    let wild = Curve::new(LENGTH, 0.0, |_| f64::NAN, |_| 0.0);
    assert!(matches!(route_for_curve(&robot, 0, &wild, 1.0), Err(DesignError::Curve { .. })));
}

#[test]
fn a_pre_bent_rod_takes_the_curve_under_cables_gravity_and_tip_load() {
    let curve = Curve::new(LENGTH, 0.3, |s| 5.0 + 3.0 * (TAU * s / LENGTH).sin(), |_| 15.0);
    let loads = Loads {
        gravity: Some(Vec3::new(0.0, -9.81, 0.0)),
        tip_force: Vec3::new(0.08, 0.05, -0.06),
        ..Loads::default()
    };
    let case = Case { loads, ..Case::with_tensions(&[2.0, 1.0]) };
    let robot = straight(&[0.4, 2.1], 0.008);
    let error = |places| {
        rest_curvature_for_curve(&rod(), &robot, &case, &curve, places).unwrap().error / LENGTH
    };
    let (coarse, fine) = (error(19), error(37));
    println!("19 places {coarse:.1e}, 37 places {fine:.1e}");
    assert!(coarse < 1e-4 && fine < 5e-5, "{coarse:.1e} {fine:.1e}");
}

#[test]
fn a_tapered_rod_takes_the_curve_under_a_cable_gravity_and_a_tip_load() {
    let curve = Curve::new(LENGTH, 0.0, |s| 4.0 * (1.0 + 0.6 * (TAU * s / LENGTH).sin()), |_| 0.0);
    let robot = straight(&[0.0], 0.008);
    let bare =
        taper_for_curve(&rod(), &robot, &Case::with_tensions(&[3.0]), &curve, 37, [0.001, 0.008])
            .unwrap();
    // EI κ = τ r.
    for (diameter, s) in bare.diameters.iter().zip(&bare.places).skip(1).take(35) {
        let bending = 3.0 * 0.008 / curve.curvature(*s);
        let exact = (64.0 * bending / (PI * 1.1e9)).powf(0.25);
        assert!((diameter / exact - 1.0).abs() < 5e-3, "{s}: {diameter} {exact}");
    }
    let loads = Loads {
        gravity: Some(Vec3::new(0.0, 0.0, -9.81)),
        tip_force: Vec3::new(0.05, 0.0, -0.02),
        ..Loads::default()
    };
    let case = Case { loads, ..Case::with_tensions(&[3.0]) };
    let loaded = taper_for_curve(&rod(), &robot, &case, &curve, 37, [0.001, 0.008]).unwrap();
    println!("taper: {:.1e} and {:.1e}", bare.error / LENGTH, loaded.error / LENGTH);
    assert!(bare.error < 1e-3 * LENGTH && loaded.error < 1e-3 * LENGTH);
    let Some(Section::Round { outer, .. }) = &loaded.robot.backbone().section else { panic!() };
    assert_eq!(outer.values(), loaded.diameters);
    let s_curve =
        taper_for_curve(&rod(), &robot, &case, &Curve::s_curve(LENGTH, 0.5), 37, [0.001, 0.008]);
    assert!(matches!(s_curve, Err(DesignError::Curve { .. })));
}
