use whipcord_numerics::{Mat3, Vec3};

use super::equilibrium::damped_equilibrium;
use super::properties::Coupling;
use super::*;

fn section() -> Section {
    Section::new(
        Stiffness {
            shear: Vec3::new(3000.0, 3000.0, 8000.0),
            bending: Vec3::new(4.4e-3, 5.0e-3, 3.4e-3),
        },
        Vec3::new(1.0, -2.0, 0.5),
    )
}

fn crossings() -> [Crossing; 3] {
    [
        Crossing::new(Vec3::new(0.008, 0.0, 0.0), Vec3::new(0.0, 0.2, 0.0)),
        Crossing::new(Vec3::new(-0.004, 0.006, 0.0), Vec3::new(0.1, -0.1, 0.0)),
        Crossing::default(),
    ]
}

/// A section whose strains are all coupled.
fn coupled() -> Section {
    section().coupled(Coupling {
        shear: Mat3::from_rows(
            Vec3::new(0.0, 300.0, -900.0),
            Vec3::new(300.0, 0.0, 500.0),
            Vec3::new(-900.0, 500.0, 0.0),
        ),
        mixed: Mat3::from_rows(
            Vec3::new(0.4, -0.7, 1.1),
            Vec3::new(0.3, 0.5, -0.6),
            Vec3::new(-1.5, 0.9, 0.8),
        ),
        bending: Mat3::from_rows(
            Vec3::new(0.0, 1e-3, -5e-4),
            Vec3::new(1e-3, 0.0, 7e-4),
            Vec3::new(-5e-4, 7e-4, 0.0),
        ),
    })
}

/// The same stiffness with these axes of shear and extension held.
fn held(section: &Section, axes: [bool; 3]) -> Section {
    let mut stiffness = section.stiffness;
    for i in (0..3).filter(|&i| axes[i]) {
        stiffness.shear[i] = f64::INFINITY;
    }
    let coupling = section.coupling().copied().unwrap_or_default();
    Section::new(stiffness, section.rest_curvature).coupled(coupling)
}

fn sections() -> Vec<Section> {
    let holds =
        [[false; 3], [false, false, true], [true, true, false], [false, true, false], [true; 3]];
    let both = |axes| [held(&section(), axes), held(&coupled(), axes)];
    holds.into_iter().flat_map(both).collect()
}

/// What is left of eqs. (1) and (2), and of the strain of the axes that are held.
fn residual(s: &Section, c: &[Crossing], tau: &[f64], w: BodyWrench, x: &Strain) -> f64 {
    let (dv, du) = (x.linear - Vec3::Z, x.angular - s.rest_curvature);
    let k = s.coupling().copied().unwrap_or_default();
    let mut force = s.stiffness.shear.scale(dv) + k.shear * dv + k.mixed * du - w.linear;
    let mut moment =
        s.stiffness.bending.scale(du) + k.mixed.transpose() * dv + k.bending * du - w.angular;
    for (c, &t) in c.iter().zip(tau) {
        let tangent = x.linear + x.angular.cross(c.offset) + c.slope;
        let pull = tangent * (t / tangent.norm());
        force += pull;
        moment += c.offset.cross(pull);
    }
    let mut left = moment.norm();
    for i in 0..3 {
        let held = s.compliance.shear[i] == 0.0;
        left += if held { 1e3 * dv[i].abs() } else { force[i].abs() };
    }
    left
}

const WRENCH: BodyWrench =
    BodyWrench { linear: Vec3::new(0.3, -0.2, -1.0), angular: Vec3::new(0.02, 0.05, 0.01) };

#[test]
fn meets_equations_1_and_2_from_a_far_start() {
    for section in sections() {
        for tensions in [[4.0, 2.0, 1.0], [0.0, 30.0, 0.0], [20.0, 10.0, 5.0], [0.0; 3]] {
            let mut x = section.rest_strain();
            equilibrium(&section, &crossings(), &tensions, WRENCH, &mut x).unwrap();
            let left = residual(&section, &crossings(), &tensions, WRENCH, &x);
            let bound = 1e-11 * (1.0 + tensions[0] + tensions[1]);
            assert!(left < bound, "{section:?} {tensions:?}: {left}");
            let damped =
                damped_equilibrium(&section, &crossings(), &tensions, WRENCH, 0.008).unwrap();
            assert!((damped.linear - x.linear).norm() < 1e-12);
            assert!((damped.angular - x.angular).norm() < 1e-9);
        }
    }
}

#[test]
fn tangent_is_the_derivative_of_the_strain() {
    let direction =
        BodyWrench { linear: Vec3::new(1.0, 0.5, -0.7), angular: Vec3::new(0.01, -0.02, 0.03) };
    let tensions = [4.0, 2.0, 1.0];
    for section in sections() {
        let solve = |h: f64| {
            let mut x = section.rest_strain();
            equilibrium(&section, &crossings(), &tensions, WRENCH + direction * h, &mut x).unwrap();
            (x, Tangent::at(&section, &crossings(), &tensions, &x).unwrap())
        };
        let h = 1e-4;
        let difference = (solve(h).0 - solve(-h).0) * (0.5 / h);
        let exact = solve(0.0).1.solve(direction);
        assert!((difference.angular - exact.angular).norm() < 1e-7 * exact.angular.norm());
        assert!((difference.linear - exact.linear).norm() <= 1e-7 * exact.linear.norm());
    }
}

#[test]
fn a_great_stiffness_tends_to_a_held_axis() {
    let tensions = [4.0, 2.0, 1.0];
    for base in [section(), coupled()] {
        let strain = |section: &Section| {
            let mut x = section.rest_strain();
            equilibrium(section, &crossings(), &tensions, WRENCH, &mut x).unwrap();
            x
        };
        let limit = strain(&held(&base, [true; 3]));
        for factor in [1e3, 1e6, 1e9, 1e12, 1e15] {
            let mut stiff = base.clone();
            stiff.stiffness.shear *= factor;
            let off = (strain(&stiff).angular - limit.angular).norm();
            assert!(off < 10.0 / factor + 1e-12, "{factor:e}: {off:e}");
        }
    }
}

#[test]
fn bending_stiffness_is_that_under_a_moment_alone() {
    for section in sections() {
        let stiffness = section.bending_stiffness();
        for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
            let moment = 1e-3 * axis;
            let mut x = section.rest_strain();
            let wrench = BodyWrench { linear: Vec3::ZERO, angular: moment };
            equilibrium(&section, &[], &[], wrench, &mut x).unwrap();
            let left = stiffness * (x.angular - section.rest_curvature) - moment;
            assert!(left.norm() < 1e-15);
        }
    }
}

#[test]
fn too_much_tension_folds() {
    let tensions = [1000.0, 0.0, 0.0];
    let mut x = section().rest_strain();
    let fault = equilibrium(&section(), &crossings(), &tensions, BodyWrench::default(), &mut x);
    assert_eq!(fault.unwrap_err(), SectionFault::Folded { cable: 0 });
}

/// A cable that all but folds its section, and another one: the stretch of the first is that of a separate program, with Newton's method on the potential under
/// tensions that rise step by step.
#[test]
fn a_cable_that_is_all_but_used_up_leaves_a_stretch() {
    let (shear, axial) = (3060.25, 8653.96);
    let stiffness = Stiffness {
        shear: Vec3::new(shear, shear, axial),
        bending: Vec3::new(2.032663e-3, 2.032663e-3, 1.437599e-3),
    };
    let section = Section::new(stiffness, Vec3::ZERO);
    let crossings = [
        Crossing::new(
            Vec3::new(1.431471e-3, -3.497316e-3, 0.0),
            Vec3::new(0.016294, 0.021441, 0.0),
        ),
        Crossing::new(Vec3::new(1.292289e-3, 0.0, 0.0), Vec3::new(0.021699, 0.0, 0.0)),
    ];
    let solve = |tension: f64| -> Result<f64, SectionFault> {
        let mut x = section.rest_strain();
        let tensions = [tension, 2.0714];
        equilibrium(&section, &crossings, &tensions, BodyWrench::default(), &mut x)?;
        let left = residual(&section, &crossings, &tensions, BodyWrench::default(), &x);
        assert!(left < 1e-8 * tension, "{tension}: {left}");
        Ok(crossings[0].tangent(&x).norm())
    };
    for (tension, stretch) in
        [(120.0, 0.143_900_764_837_5), (141.0, 0.016_178_863_110_0), (145.0, 0.002_477_722_620_9)]
    {
        let found = solve(tension).unwrap();
        assert!((found - stretch).abs() < 1e-8, "{tension}: {found}");
    }
    assert_eq!(solve(150.0).unwrap_err(), SectionFault::Folded { cable: 0 });
}
