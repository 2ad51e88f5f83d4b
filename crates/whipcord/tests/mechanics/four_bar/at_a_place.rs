//! What the model says of one place: how it moves with the lengths, and how it yields where the strain energy is
//! known.

use core::f64::consts::TAU;

use whipcord::four_bar::{LengthRule, Objective, Options};
use whipcord::kinematics::{ComplianceUnknown, DerivativeMethod, DrivenBy, Local, Matrix6};
use whipcord::{
    Actuation, Case, Differentiable, Model, ModelKind, Pose, Robot, Routing, Shortening, Solution,
    Statics, Stations, Twist, UnitQuaternion, Vec3,
};

use super::{equal_disks, robot};

/// Where sections know their energy and cables slide.
fn sliding() -> Options {
    Options { objective: Objective::StrainEnergy, lengths: LengthRule::Free, ..Options::default() }
}

fn case(shortenings: &[f64], base: Pose) -> Case {
    let given: Vec<_> = shortenings.iter().map(|&s| Shortening::Length(s)).collect();
    Case { base, ..Case::with_shortenings(&given) }
}

fn turned_base() -> Pose {
    let rotation = UnitQuaternion::exp(Vec3::new(0.7, -0.4, 1.1));
    Pose { position: Vec3::new(0.3, -0.1, 0.2), rotation }
}

fn winding(cables: u32) -> Vec<Routing> {
    let angle = |i: u32| TAU * f64::from(i) / f64::from(cables) + 0.2;
    (0..cables)
        .map(|i| Routing::Helix { start_angle: angle(i), turns: 0.2, radius: 0.008 })
        .collect()
}

/// `(8 (f(h) − f(−h)) − (f(2h) − f(−2h)))/12h` of what `of` reads off the answer at the place.
fn fourth_order<const N: usize>(
    at: impl Fn(f64) -> Solution,
    h: f64,
    of: impl Fn(&Solution) -> [f64; N],
) -> [f64; N] {
    let [a, b, c, d] = [1.0, -1.0, 2.0, -2.0].map(|step| of(&at(step * h)));
    core::array::from_fn(|k| (8.0 * (a[k] - b[k]) - (c[k] - d[k])) / (12.0 * h))
}

#[test]
fn jacobians_are_differences_of_answers_in_the_frame_of_the_base() {
    let (robot, base, place) = (robot(&equal_disks(0.18, 9), winding(3)), turned_base(), 0.131);
    let to_base = base.rotation.conjugate();
    let shortenings = [0.006, 0.001, -0.02];
    for options in [Options::default(), sliding()] {
        let model = Model::FourBar(options);
        let (solution, local) = model.solve_at(&robot, &case(&shortenings, base), place).unwrap();
        assert_eq!(
            (local.driven_by.as_slice(), local.method),
            (&[DrivenBy::Shortening; 3][..], DerivativeMethod::Exact)
        );
        let there = model.at(Stations::At(vec![place]));
        let rest = solution.shape.tip().rotation.conjugate();
        for cable in 0..3 {
            let at = |step: f64| {
                let mut moved = shortenings;
                moved[cable] += step;
                there.solve(&robot, &case(&moved, base)).unwrap()
            };
            let motion = |solution: &Solution| {
                let pose = solution.shape.tip();
                let p = to_base.rotate(pose.position);
                let w = to_base.rotate((pose.rotation * rest).log());
                [p.x, p.y, p.z, w.x, w.y, w.z]
            };
            let lengths = |solution: &Solution| [0, 1, 2].map(|i| solution.cables[i].length);
            let Twist { linear: v, angular: w } = local.actuation_jacobian[cable];
            let exact = [v.x, v.y, v.z, w.x, w.y, w.z];
            let found = fourth_order(at, 4e-5, motion);
            for (k, (exact, found)) in exact.iter().zip(found).enumerate() {
                let size = if k < 3 { 1.0 } else { 1.0 / 0.008 };
                assert!((exact - found).abs() < 1e-7 * size, "cable {cable}: {exact} {found}");
            }
            for (row, found) in local.length_jacobian.iter().zip(fourth_order(at, 4e-5, lengths)) {
                assert!((row[cable] - found).abs() < 1e-7, "cable {cable}: {} {found}", row[cable]);
            }
        }
        // The cable that is not pulled is slack.
        assert_eq!(local.actuation_jacobian[2], Twist::default());
    }
}

fn yields(local: &Local) -> [Matrix6; 2] {
    let yields = local.compliances.unwrap();
    [yields.tensions_held.compliance, yields.lengths_held.compliance]
}

/// Each section turns about its own middle: `Σ (l/EI)(L − s)² = L³/3EI (1 − 1/4n²)`, and the turn of the tip is
/// L/EI.
#[test]
fn a_straight_robot_is_a_cantilever() {
    let (n, length) = (9_u32, 0.18);
    let robot = robot(&equal_disks(length, 9), winding(1));
    let case = case(&[0.0], Pose::IDENTITY);
    let (_, local) = Model::FourBar(sliding()).solve_at(&robot, &case, length).unwrap();
    let stiffness = 1.1e9 * core::f64::consts::PI * 0.0015_f64.powi(4) / 4.0;
    let sections = 1.0 - 0.25 / f64::from(n * n);
    for compliance in yields(&local) {
        let bent = compliance.at(0, 0) * 3.0 * stiffness / length.powi(3) / sections;
        let turned = compliance.at(4, 4) * stiffness / length;
        let twisted = compliance.at(5, 5) * stiffness / 1.3 / length;
        assert!((bent - 1.0).abs() < 1e-9, "{bent}");
        assert!((turned - 1.0).abs() < 1e-9 && (twisted - 1.0).abs() < 1e-9, "{turned} {twisted}");
    }
}

/// By Maxwell's theorem what a wrench does to the lengths at held tensions is what the tensions do to the place:
/// `C_τ = C_ℓ + J K⁻¹ Jᵀ` with J the Jacobian by the shortenings and K the change of the tensions by them.
#[test]
fn compliance_with_tensions_held_is_that_with_cables_locked_and_what_they_let_go() {
    let robot = robot(&equal_disks(0.18, 9), winding(1));
    let (place, shortening) = (0.153, 0.007);
    let model = Model::FourBar(sliding());
    let (_, local) = model.solve_at(&robot, &case(&[shortening], turned_base()), place).unwrap();
    let [free, locked] = yields(&local);
    let at = |step: f64| model.solve(&robot, &case(&[shortening + step], Pose::IDENTITY)).unwrap();
    let tension = |solution: &Solution| [solution.cables[0].tension.unwrap()];
    let [stiffness] = fourth_order(at, 4e-5, tension);
    let Twist { linear: v, angular: w } = local.actuation_jacobian[0];
    let column = [v.x, v.y, v.z, w.x, w.y, w.z];
    let largest = |block: (usize, usize)| {
        let entries = (0..9).map(|k| free.at(3 * block.0 + k / 3, 3 * block.1 + k % 3).abs());
        entries.fold(0.0, f64::max)
    };
    for i in 0..6 {
        for j in 0..6 {
            let size = largest((i / 3, j / 3));
            let expected = locked.at(i, j) + column[i] * column[j] / stiffness;
            assert!((free.at(i, j) - expected).abs() < 1e-6 * size, "{i} {j}");
        }
    }
    assert!(free.asymmetry(0.18) < 1e-9 && locked.asymmetry(0.18) < 1e-9);
}

/// With many sections it yields as the rod does, which hardly gets shorter. (Three cables at their lengths would hold what
/// stretches it as well, which the sections cannot.)
#[test]
fn many_sections_yield_as_the_rod_does() {
    let robot = robot(&equal_disks(0.18, 40), winding(3)[..2].to_vec());
    let tensions = [6.0, 2.0];
    let rod = Model::new(ModelKind::Cosserat, Stations::Disks, Actuation::Tension);
    let pulled = Case::with_tensions(&tensions);
    let (answer, exact) = rod.solve_at(&robot, &pulled, 0.18).unwrap();
    // The sections get no shorter: what all cables lose alike is put back.
    let lost = |i: usize| answer.cables[i].initial_length - answer.cables[i].length;
    let strain = 1.0 - answer_length(&robot, &rod, &pulled) / 0.18;
    let shortenings = [0, 1].map(|i| lost(i) - strain * answer.cables[i].initial_length);
    let case = case(&shortenings, Pose::IDENTITY);
    let (_, ours) = Model::FourBar(sliding()).solve_at(&robot, &case, 0.18).unwrap();
    for (name, (exact, ours)) in
        ["tensions", "lengths"].iter().zip(yields(&exact).into_iter().zip(yields(&ours)))
    {
        let apart = |i: usize, j: usize| (ours.at(i, j) - exact.at(i, j)).abs();
        for block in 0..4 {
            let (rows, columns) = (block / 2 * 3, block % 2 * 3);
            let entries = || (0..9).map(|k| (rows + k / 3, columns + k % 3));
            let size = entries().map(|(i, j)| exact.at(i, j).abs()).fold(0.0, f64::max);
            let worst = entries().map(|(i, j)| apart(i, j)).fold(0.0, f64::max);
            assert!(worst < 0.04 * size, "{name} held, block {block}: {}", worst / size);
        }
    }
}

/// Length of the backbone under a case, along its centre line.
fn answer_length(robot: &Robot, model: &Model, case: &Case) -> f64 {
    let poses = model.at(Stations::Equal(2001)).solve(robot, case).unwrap().shape.poses;
    poses.windows(2).map(|pair| (pair[1].position - pair[0].position).norm()).sum()
}

#[test]
fn what_is_not_known_is_said() {
    let known = robot(&equal_disks(0.18, 6), winding(1));
    let bare = {
        let mut backbone = known.backbone().clone();
        backbone.material.young_modulus = None;
        Robot::new(backbone, known.disks().clone(), known.cables().to_vec()).unwrap()
    };
    let shared = Options { objective: Objective::StrainEnergy, ..Options::default() };
    for (robot, options, expected) in [
        (&known, Options::default(), ComplianceUnknown::NoEnergy),
        (&known, shared, ComplianceUnknown::SharedLengths),
        (&bare, sliding(), ComplianceUnknown::NoStiffness),
    ] {
        let case = case(&[0.004], Pose::IDENTITY);
        let (_, local) = Model::FourBar(options).solve_at(robot, &case, 0.1).unwrap();
        assert_eq!(local.compliances.unwrap_err(), expected);
        assert_eq!(local.actuation_jacobian.len(), 1);
    }
}
