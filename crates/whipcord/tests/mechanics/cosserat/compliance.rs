//! Derivatives of the Cosserat model against closed forms.

use crate::common::{bending_stiffness, paper_backbone, paper_robot, straight};
use whipcord::cosserat::{Accuracy, Cosserat, Options, Workspace};
use whipcord::derivatives::{Derivatives, Hold, Place};
use whipcord::{Case, Disks, Parameter, Robot, Solution, SolveError, StiffnessPart, Vec3};

const L: f64 = 0.18;

fn fine(steps: usize) -> Options {
    Options { accuracy: Accuracy::Steps(steps), residual: 1e-13, ..Options::default() }
}

fn differentiated(robot: &Robot, case: &Case, parameters: &[Parameter]) -> (Solution, Derivatives) {
    let model = Cosserat::new(robot, &case.loads, &fine(64)).unwrap();
    model.solve_with_derivatives(case, None, parameters, &mut Workspace::default()).unwrap()
}

fn close(value: f64, expected: f64, tolerance: f64) {
    assert!((value - expected).abs() <= tolerance * expected.abs(), "{value} and {expected}");
}

/// GA, EA, EI, GJ of the paper's rod.
fn stiffness(robot: &Robot) -> (f64, f64, f64, f64) {
    let section = robot.backbone().section_at(robot.disks(), 0.0).unwrap();
    let (young, shear) = (1.1e9, 1.1e9 / 2.6);
    (
        shear * section.area,
        young * section.area,
        young * section.second_moment_x,
        shear * section.torsion_constant,
    )
}

#[test]
fn a_cantilever_yields_as_timoshenko_has_it() {
    let robot = paper_robot(vec![]);
    let (ga, ea, ei, gj) = stiffness(&robot);
    let (_, derivatives) = differentiated(&robot, &Case::default(), &[]);
    let c = derivatives.compliance(Place::Tip, Hold::Tensions).unwrap();
    let bending = L.powi(3) / (3.0 * ei) + L / ga;
    for (i, expected) in [bending, bending, L / ea, L / ei, L / ei, L / gj].into_iter().enumerate()
    {
        close(c.at(i, i), expected, 1e-12);
    }
    // A force along x turns the tip about y, one along y about −x.
    let slope = L * L / (2.0 * ei);
    close(c.at(4, 0), slope, 1e-12);
    close(c.at(3, 1), -slope, 1e-12);
    assert!(c.asymmetry(L) < 1e-13);
    let k = derivatives.stiffness(Place::Tip, Hold::Tensions).unwrap().unwrap();
    // Timoshenko's beam against a turn of its tip that is kept in place.
    let phi = 12.0 * ei / (ga * L * L);
    close(k.at(4, 4), (4.0 + phi) * ei / (L * (1.0 + phi)), 1e-10);
    close(k.at(0, 4), -6.0 * ei / (L * L * (1.0 + phi)), 1e-10);
    // The base does not move, and has no stiffness of its own.
    assert_eq!(derivatives.stiffness(Place::Disk(0), Hold::Tensions).unwrap(), None);
    // In the middle only the half before it yields.
    let half = derivatives.compliance(Place::Disk(9), Hold::Tensions).unwrap();
    assert_eq!(half, c);
}

/// A straight cable bends the rod to a circle: `u = τ r/EI` at the stretch `v₃ = 1 − τ/EA`.
#[test]
fn a_straight_cable_moves_the_tip_along_circles() {
    let robot = paper_robot(vec![straight(0.0)]);
    let (_, ea, ei, _) = stiffness(&robot);
    let tension = 3.0;
    let scale = Parameter::StiffnessScale(StiffnessPart::Bending);
    let (_, derivatives) = differentiated(
        &robot,
        &Case::with_tensions(&[tension]),
        &[Parameter::YoungModulus, Parameter::Radius { cable: 0 }, scale],
    );
    let (r, u, v) = (0.008, tension * 0.008 / ei, 1.0 - tension / ea);
    let (sin, cos) = (u * L).sin_cos();
    // Tip at v/u (1 − cos uL, 0, sin uL) for a bend about y.
    let by_curvature = Vec3::new(
        v * (L * sin / u - (1.0 - cos) / (u * u)),
        0.0,
        v * (L * cos / u - sin / (u * u)),
    );
    let by_stretch = Vec3::new((1.0 - cos) / u, 0.0, sin / u);
    let expected = by_curvature * (r / ei) - by_stretch / ea;
    let jacobian = derivatives.actuation_jacobian(Place::Tip);
    assert!((jacobian[0].linear - expected).norm() < 1e-10 * expected.norm());
    close(jacobian[0].angular.y, r * L / ei, 1e-11);
    // The cable's length is L (1 − τ/EA − τ r²/EI).
    close(derivatives.length_by_tension()[0][0], -L * (1.0 / ea + r * r / ei), 1e-11);
    let change = derivatives.tension(0);
    close(change.strain(Place::Tip).unwrap().angular.y, r / ei, 1e-12);
    close(change.strain(Place::Disk(4)).unwrap().linear.z, -1.0 / ea, 1e-9);
    // All strains go with τ/E.
    let by_young = derivatives.parameter(0, Hold::Commands).twist(Place::Tip);
    let expected_by_young = jacobian[0].linear * (-tension / 1.1e9);
    assert!((by_young.linear - expected_by_young).norm() < 1e-10 * expected_by_young.norm());
    let by_radius = derivatives.parameter(1, Hold::Commands).twist(Place::Tip);
    close(by_radius.angular.y, tension * L / ei, 1e-10);
    let by_bending = derivatives.parameter(2, Hold::Commands).twist(Place::Tip);
    close(by_bending.angular.y, -u * L, 1e-10);
}

/// With inextensible cables held on both sides, the tip of a rod that does not bend much moves as
/// one whose section cannot turn: `L³/12 EI` instead of `L³/3 EI`.
#[test]
fn locked_cables_keep_the_tip_upright() {
    let robot = paper_robot([0.0, 90.0, 180.0, 270.0].map(straight).to_vec());
    let (ga, ea, ei, _) = stiffness(&robot);
    // Next to no tension: its own stiffness does not count.
    let (_, derivatives) = differentiated(&robot, &Case::with_tensions(&[1e-9; 4]), &[]);
    let free = derivatives.compliance(Place::Tip, Hold::Tensions).unwrap();
    let locked = derivatives.compliance(Place::Tip, Hold::Lengths).unwrap();
    close(free.at(0, 0), L.powi(3) / (3.0 * ei) + L / ga, 1e-6);
    close(locked.at(0, 0), L.powi(3) / (12.0 * ei) + L / ga, 1e-6);
    // Neither turn nor stretch is left.
    assert!(locked.at(4, 4).abs() < 1e-6 * L / ei, "{}", locked.at(4, 4));
    assert!(locked.at(2, 2).abs() < 1e-6 * L / ea);
    assert!(locked.asymmetry(L) < 1e-9);
    // Four straight cables have three independent lengths: tensions change by as little as they can.
    let change = derivatives.wrench(Place::Tip, 4, Hold::Lengths);
    let sum: f64 = change.tensions().iter().sum();
    assert!(sum.abs() < 1e-6 * change.tensions()[0].abs(), "{:?}", change.tensions());
}

/// Two straight cables of axial stiffness `EA_c` at `±r`, both at the same tension. Under a bending moment
/// or a pull at the tip the tension changes nothing, as cables along the rod do not resist its
/// shortening or its bend: `L/EI`, `L/EA`. Locked, they are springs beside the rod: `L/(EI + 2 EA_c r²)`,
/// `L/(EA + 2 EA_c)`.
#[test]
fn locked_cables_are_springs_beside_the_rod() {
    let (r, spring) = (0.008, 700.0);
    let cable = |(i, routing): (usize, whipcord::Routing)| whipcord::Cable {
        axial_stiffness: Some(spring),
        ..whipcord::Cable::new(format!("{i}"), routing)
    };
    let cables = [0.0, 180.0].map(straight).into_iter().enumerate().map(cable).collect();
    let robot = Robot::new(paper_backbone(), Disks::equally_spaced(L, 10, r), cables).unwrap();
    let (_, ea, ei, _) = stiffness(&robot);
    for (case, load) in
        [(Case::with_tensions(&[1.5, 1.5]), false), (Case::with_tensions(&[0.4; 2]), true)]
    {
        let mut case = case;
        // Under a load nothing is left of the route of the rod without load.
        case.loads.tip_force = Vec3::Z * if load { 1e-9 } else { 0.0 };
        let (_, derivatives) = differentiated(&robot, &case, &[]);
        let free = derivatives.compliance(Place::Tip, Hold::Tensions).unwrap();
        let locked = derivatives.compliance(Place::Tip, Hold::Lengths).unwrap();
        close(free.at(4, 4), L / ei, 1e-8);
        close(free.at(2, 2), L / ea, 1e-8);
        close(locked.at(4, 4), L / (ei + 2.0 * spring * r * r), 1e-8);
        close(locked.at(2, 2), L / (ea + 2.0 * spring), 1e-8);
        // Across the plane of the cables a bend changes no length to first order.
        close(locked.at(3, 3), free.at(3, 3), 1e-8);
        // What the moment does to the tensions: half of it for each cable, less what the rod takes.
        let change = derivatives.wrench(Place::Tip, 4, Hold::Lengths);
        let expected = spring * r / (ei + 2.0 * spring * r * r);
        close(change.tensions()[0].abs(), expected, 1e-8);
        close(change.tensions()[1], -change.tensions()[0], 1e-8);
    }
}

/// `(L − tanh(kL)/k)/T` with `k² = T/EI`: a stretched string that is clamped at one end, under 25 to
/// 2500 times the load that would buckle it. A shot from its base is off by up to `exp(80)`.
#[test]
fn a_tension_stiffens_the_rod() {
    let backbone = whipcord::Backbone {
        // So slender that shear does not count, and of a material that hardly stretches.
        section: Some(whipcord::Section::circle(1e-4)),
        ..paper_backbone()
    };
    let robot = Robot::new(backbone, Disks::equally_spaced(L, 10, 0.008), vec![]).unwrap();
    let ei = bending_stiffness(&robot);
    for times in [25.0, 2500.0] {
        let pull = times * 2.467 * ei / (L * L);
        let mut case = Case::default();
        // A nudge to the side, which bends the rod where it is clamped and keeps the solver busy.
        case.loads.tip_force = Vec3::new(1e-6 * pull, 0.0, pull);
        let (_, derivatives) = differentiated(&robot, &case, &[]);
        let c = derivatives.compliance(Place::Tip, Hold::Tensions).unwrap();
        let k = (pull / ei).sqrt();
        close(c.at(0, 0), (L - (k * L).tanh() / k) / pull, 2e-4);
    }
}

/// Near the load that buckles a column its compliance grows as `1/(1 − P/P_E)`, and stays a number.
#[test]
fn derivatives_grow_without_bound_at_the_buckling_load() {
    let robot = paper_robot(vec![]);
    let (ga, ea, ei, _) = stiffness(&robot);
    let euler = (core::f64::consts::PI / (2.0 * L)).powi(2) * ei;
    // With shear and shortening (Engesser; Haringx): P (1 − P/EA + P/GA) = P_E.
    let critical = euler * (1.0 + euler / ea - euler / ga);
    let at = |fraction: f64| -> Result<f64, SolveError> {
        let mut case = Case::default();
        case.loads.tip_force = Vec3::Z * (-fraction * critical);
        let model = Cosserat::new(&robot, &case.loads, &fine(64))?;
        let (_, derivatives) =
            model.solve_with_derivatives(&case, None, &[], &mut Workspace::default())?;
        Ok(derivatives.compliance(Place::Tip, Hold::Tensions)?.at(0, 0))
    };
    let (far, near) = (at(0.9).unwrap(), at(0.99).unwrap());
    // The first mode carries all but a little of it.
    assert!((near / far / 10.0 - 1.0).abs() < 0.05, "{}", near / far);
    for fraction in [0.999_999, 1.0 - 1e-9, 1.0, 1.0 + 1e-9] {
        match at(fraction) {
            Ok(value) => assert!(value.is_finite() && value.abs() > 1e3 * far, "{value}"),
            Err(SolveError::NoDerivatives | SolveError::NotConverged { .. }) => {}
            Err(other) => panic!("{other}"),
        }
    }
}

/// A dead moment has no potential: turning the tip changes what it does. The stiffness is left
/// unsymmetric by exactly the moment: `K − Kᵀ = m̂` in the block of rotations.
#[test]
fn a_dead_moment_leaves_the_stiffness_unsymmetric_by_itself() {
    let robot = paper_robot(vec![straight(30.0)]);
    let mut case = Case::with_tensions(&[2.0]);
    let moment = Vec3::new(3e-3, -2e-3, 4e-3);
    case.loads.tip_moment = moment;
    case.loads.tip_force = Vec3::new(0.02, 0.01, -0.03);
    let (_, derivatives) = differentiated(&robot, &case, &[]);
    let k = derivatives.stiffness(Place::Tip, Hold::Tensions).unwrap().unwrap();
    let block = k.blocks[1][1];
    let skew = block - block.transpose();
    let axial = Vec3::new(skew.rows[2].y, skew.rows[0].z, skew.rows[1].x);
    let off = (axial - moment).norm().min((axial + moment).norm());
    assert!(off < 1e-6 * moment.norm(), "{axial:?}");
    assert!((k.at(0, 1) - k.at(1, 0)).abs() < 1e-6 * k.at(0, 0).abs());
}

#[test]
fn what_is_not_there_is_refused_by_name() {
    let robot = paper_robot(vec![straight(0.0)]);
    let case = Case::with_tensions(&[1.0]);
    let model = Cosserat::new(&robot, &case.loads, &fine(16)).unwrap();
    let refused = |parameter: Parameter| {
        let result =
            model.solve_with_derivatives(&case, None, &[parameter], &mut Workspace::default());
        result.unwrap_err().to_string()
    };
    for (parameter, words) in [
        (Parameter::InnerDiameter, "backbone.inner_diameter"),
        (Parameter::Gravity { axis: 0 }, "loads.gravity"),
        (Parameter::Turns { cable: 0 }, "turns"),
        (Parameter::Radius { cable: 3 }, "radius"),
        (Parameter::TipForce { axis: 7 }, "tip_force"),
        (Parameter::PointForce { load: 0, axis: 0 }, "force"),
        (Parameter::HoleAngle { cable: 0, disk: 0 }, "angle"),
        (Parameter::LineForce { load: 0, axis: 0 }, "distributed load 1"),
        (Parameter::LineMomentAt { load: 1, entry: 2, axis: 0 }, "distributed load 2"),
        (Parameter::PointMass { mass: 3 }, "mass"),
    ] {
        let message = refused(parameter);
        assert!(message.contains(words) && message.contains("no such number"), "{message}");
    }
}

/// A cable through the same hole of every disk is a straight one: turning all of its holes turns it,
/// and widening all hole circles moves it outwards, whatever runs between the disks.
#[test]
fn holes_together_move_a_cable_as_one() {
    use whipcord::{Interpolation, Routing};
    let straight = paper_robot(vec![straight(90.0)]);
    let mut case = Case::with_tensions(&[3.0]);
    case.loads.tip_force = Vec3::new(0.03, -0.01, 0.02);
    let own = [Parameter::Angle { cable: 0 }, Parameter::Radius { cable: 0 }];
    let (_, by_own) = differentiated(&straight, &case, &own);
    for interpolation in [Interpolation::Spline, Interpolation::Fourier, Interpolation::Pchip] {
        let robot = paper_robot(vec![Routing::Holes { holes: vec![4; 10], interpolation }]);
        let mut list: Vec<Parameter> =
            (0..10).map(|disk| Parameter::HoleAngle { cable: 0, disk }).collect();
        list.extend((0..10).map(|disk| Parameter::HoleRadiusAt { disk }));
        list.push(Parameter::HoleRadius);
        let (_, by_holes) = differentiated(&robot, &case, &list);
        let sum = |range: core::ops::Range<usize>| {
            range.fold([Vec3::ZERO; 2], |sum, i| {
                let change = by_holes.parameter(i, Hold::Commands).twist(Place::Tip);
                [sum[0] + change.linear, sum[1] + change.angular]
            })
        };
        let expected = [0, 1].map(|i| by_own.parameter(i, Hold::Commands).twist(Place::Tip));
        for (range, expected) in
            [(0..10, expected[0]), (10..20, expected[1]), (20..21, expected[1])]
        {
            let [linear, angular] = sum(range.clone());
            let off = (linear - expected.linear).norm() / expected.linear.norm();
            assert!(off < 1e-8, "{interpolation:?} {range:?}: {off:.1e}");
            let off = (angular - expected.angular).norm() / expected.angular.norm();
            assert!(off < 1e-8, "{interpolation:?} {range:?}: {off:.1e}");
        }
    }
}
