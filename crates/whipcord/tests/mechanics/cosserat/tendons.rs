//! The Cosserat model of rods with tendons against exact solutions.

use core::f64::consts::PI;

use crate::common::{fine_options, round, solve_finely};
use whipcord::cosserat::Options;
use whipcord::{
    Actuation, Backbone, Cable, CableCommand, Case, Disks, Mat3, Material, Model, Pose, Robot,
    Routing, Section, Shortening, Statics, Vec3,
};

/// The steel rod with tendons of the examples beside Till, Aloi and Rucker (2019): 0.5 m long, 2 mm
/// thick, E = 200 GPa, G = 80 GPa; the tendons run 15.06 mm off the axis.
fn till_rod(routings: Vec<Routing>) -> Robot {
    let cable = |(i, routing)| Cable::new(format!("tendon {i}"), routing);
    let cables = routings.into_iter().enumerate().map(cable).collect();
    Robot::new(round(0.5, 0.002, 200e9, 80e9), Disks::equally_spaced(0.5, 2, TILL_OFFSET), cables)
        .unwrap()
}

const TILL_OFFSET: f64 = 0.01506;
const TILL_EI: f64 = 0.157_079_632_679_489_68;
const TILL_EA: f64 = 628_318.530_717_958_6;

fn straight(angle: f64) -> Routing {
    Routing::Straight { angle, radius: TILL_OFFSET }
}

/// Largest difference between the entries of two rotations.
fn rotation_error(pose: &Pose, rows: [[f64; 3]; 3]) -> f64 {
    let [a, b, c] = rows.map(Vec3::from);
    let off = pose.rotation.to_matrix() - Mat3::from_rows(a, b, c);
    off.rows.iter().map(|row| row.max_abs()).fold(0.0, f64::max)
}

/// u = τ r/EI, v₃ = 1 − τ/EA, ℓ = L (v₃ − r u): the tendon runs along e₃ however far the rod bends,
/// so that it does not stiffen the bend. Columns: τ, u, tip, tendon length.
#[test]
fn one_straight_tendon_bends_the_rod_to_a_circle() {
    let table = [
        (
            1.0,
            0.09587493771855773,
            [0.011982053313308552, 0.0, 0.4998077264554756],
            0.4992772659442638,
        ),
        (
            5.0,
            0.4793746885927887,
            [0.05963503440900809, 0.0, 0.4952222905057264],
            0.496386329721319,
        ),
        (
            15.0,
            1.4381240657783663,
            [0.17214801975257246, 0.0, 0.45800185382848885],
            0.489158989163957,
        ),
        (
            30.0,
            2.8762481315567325,
            [0.3016690984553297, 0.0, 0.3446033044728465],
            0.478317978327914,
        ),
    ];
    let robot = till_rod(vec![straight(0.0)]);
    for (tension, curvature, tip, length) in table {
        let solution = solve_finely(&robot, &Case::with_tensions(&[tension]));
        let pose = solution.shape.tip();
        let error = (pose.position - Vec3::from(tip)).norm();
        assert!(error < 1e-11, "{tension} N: tip off by {error:.1e}");
        assert!((pose.rotation.log() - Vec3::new(0.0, 0.5 * curvature, 0.0)).norm() < 1e-11);
        assert!((solution.cables[0].length - length).abs() < 1e-12);
    }
}

/// Geometry of Rao et al., Front. Robot. AI 7 (2021) 630245: two segments of 200 mm with three
/// tendons each at 10 mm, E = 54 GPa, ν = 0.3, 1.4 mm thick. Without load each segment is an arc, and
/// the tip the product of two exponentials. Columns: tensions, tip, frame at the tip.
#[test]
fn two_segments_are_two_arcs() {
    let table = [
        (
            [8.0, 0.0, 0.0, 0.0, 0.0, 0.0],
            [0.0, 0.3273324772075587, 0.12718532200432506],
            [
                [1.0, 0.0, 0.0],
                [0.0, -0.00044965987471190516, 0.9999998989029933],
                [0.0, -0.9999998989029935, -0.00044965987471190516],
            ],
        ),
        (
            [4.0, 0.0, 0.0, 0.0, 2.0, 0.0],
            [0.12760760288796014, 0.14346742278527996, 0.33640679939193496],
            [
                [0.7829413061970957, -0.0032337161631724345, 0.6220871756676565],
                [-0.2440376468983721, 0.9182355466344023, 0.3119120193152642],
                [-0.5722311927417896, -0.3960214943368558, 0.7181353897953453],
            ],
        ),
        (
            [2.0, 0.0, 0.0, 0.0, 1.0, 0.0],
            [0.06695127322169811, 0.07680843920072095, 0.38348419583447707],
            [
                [0.9430594674669653, -0.00021155543857148874, 0.33262410625993455],
                [-0.0653240292125099, 0.9804078885491355, 0.18583095349825052],
                [-0.3261466112477132, -0.1969779868790475, 0.9245691216219103],
            ],
        ),
    ];
    let backbone = Backbone {
        section: Some(Section::circle(0.0014)),
        material: Material {
            young_modulus: Some(54e9),
            poisson_ratio: Some(0.3),
            ..Material::default()
        },
        ..Backbone::new(0.4)
    };
    let angles = [90.0, -30.0, 210.0, 90.0, -30.0, 210.0_f64];
    let cables = angles.iter().enumerate().map(|(i, angle)| Cable {
        ends_at: (i < 3).then_some(0.2),
        ..Cable::new(
            format!("tendon {i}"),
            Routing::Straight { angle: angle.to_radians(), radius: 0.01 },
        )
    });
    let disks = Disks::equally_spaced(0.4, 3, 0.01);
    let robot = Robot::new(backbone, disks, cables.collect()).unwrap();
    for (tensions, tip, frame) in table {
        let pose = solve_finely(&robot, &Case::with_tensions(&tensions)).shape.tip();
        let error = (pose.position - Vec3::from(tip)).norm();
        assert!(error < 1e-10, "{tensions:?}: tip off by {error:.1e}");
        let turned = rotation_error(&pose, frame);
        assert!(turned < 1e-10, "{tensions:?}: frame off by {turned:.1e}");
    }
}

/// GJ u + 2 τ r² u/√(v₃² + r²u²) = M and EA (v₃ − 1) = −2 τ v₃/√(…): without the tendons' part the
/// twist would be 5.4 % larger.
#[test]
fn antagonistic_tendons_stiffen_torsion() {
    let robot = till_rod(vec![straight(0.0), straight(PI)]);
    let mut case = Case::with_tensions(&[15.0, 15.0]);
    case.loads.tip_moment = Vec3::new(0.0, 0.0, 0.05);
    let solution = solve_finely(&robot, &case);
    for (s, pose) in solution.shape.arc_length.iter().zip(&solution.shape.poses) {
        let twist = pose.rotation.log() - Vec3::new(0.0, 0.0, 0.3774495653436675 * s);
        assert!(twist.norm() < 1e-11, "{twist:?}");
        assert!((pose.position - Vec3::new(0.0, 0.0, 0.9999522542885266 * s)).norm() < 1e-12);
    }
}

/// τ = d/(L (1/EA + r²/EI)) for a pull d.
#[test]
fn pulling_a_straight_tendon_takes_the_tension_of_the_closed_form() {
    let robot = till_rod(vec![straight(0.3)]);
    let options = Options { actuation: Actuation::Shortening, ..fine_options() };
    for pull in [0.001, 0.005, 0.02] {
        let case = Case::with_shortenings(&[Shortening::Length(pull)]);
        let solution = Model::Cosserat(options.clone()).solve(&robot, &case).unwrap();
        let expected = pull / (0.5 * (1.0 / TILL_EA + TILL_OFFSET.powi(2) / TILL_EI));
        let error = solution.cables[0].tension.unwrap() / expected - 1.0;
        assert!(error.abs() < 1e-10, "{pull}: {error:.1e}");
        if pull == 0.005 {
            assert!((expected - 6.918_174_064_603_673).abs() < 1e-12);
        }
    }
}

/// An elastic tendon takes up part of the pull itself: τ = d/(L (1/EA + r²/EI) + ℓ₀/k).
#[test]
fn an_elastic_tendon_stretches() {
    let mut cable = Cable::new("tendon", straight(0.0));
    cable.axial_stiffness = Some(500.0);
    let rod = till_rod(vec![]);
    let robot = Robot::new(rod.backbone().clone(), rod.disks().clone(), vec![cable]).unwrap();
    let case = Case {
        commands: vec![CableCommand { tension: None, shortening: Some(Shortening::Length(0.005)) }],
        ..Case::default()
    };
    let solution = solve_finely(&robot, &case);
    let expected = 0.005 / (0.5 * (1.0 / TILL_EA + TILL_OFFSET.powi(2) / TILL_EI) + 0.5 / 500.0);
    assert!((solution.cables[0].tension.unwrap() / expected - 1.0).abs() < 1e-10);
}

/// A tendon through the centroid compresses the rod, v₃ = 1 − τ/EA, and never buckles it: its force
/// turns with the rod. A dead force of 1.5503 N does.
#[test]
fn a_central_tendon_never_buckles_the_rod() {
    let central = Routing::Straight { angle: 0.0, radius: 0.0 };
    let robot = till_rod(vec![central]);
    for tension in [1.6, 1000.0] {
        let solution = solve_finely(&robot, &Case::with_tensions(&[tension]));
        let straight = Vec3::new(0.0, 0.0, 0.5 * (1.0 - tension / TILL_EA));
        assert!((solution.shape.tip().position - straight).norm() < 1e-12);
        assert!(solution.diagnostics.stability.unwrap() > 0.9);

        // Nor does it soften the rod against a load across the tip.
        let mut case = Case::with_tensions(&[tension]);
        case.loads.tip_force = Vec3::new(0.01, 0.0, 0.0);
        let pulled = solve_finely(&robot, &case);
        let slack =
            solve_finely(&robot, &Case { commands: Case::with_tensions(&[0.0]).commands, ..case });
        let ratio = pulled.shape.tip().position.x / slack.shape.tip().position.x;
        assert!((ratio - 1.0).abs() < 0.01, "{ratio}");
        assert!(pulled.diagnostics.stability.unwrap() > 0.9);
    }
    let mut case = Case::with_tensions(&[0.0]);
    case.loads.tip_force = Vec3::new(0.0, 0.0, -1.6);
    assert!(solve_finely(&robot, &case).diagnostics.stability.unwrap() < 0.0);
}

/// Without load the strains of a helically routed rod are constant in the frame that turns with the
/// routing: six algebraic equations and one matrix exponential. Columns: tension, turns, tip, frame at
/// the tip, tendon length. The routing is that of Till's tendon robot.
#[test]
fn one_helical_tendon_for_any_tension() {
    let table = [
        (
            2.0,
            1.0,
            [2.7924997972024815e-07, 0.007547445042902928, 0.4998848620808162],
            [
                [0.9997675758531086, 0.021556647881708177, -0.00032435305095354205],
                [-0.02155664788170817, 0.9997676284616737, 3.4963885769484975e-06],
                [0.000324353050953542, 3.4963885769484145e-06, 0.9999999473914354],
            ],
            0.5074170612783606,
        ),
        (
            5.0,
            1.0,
            [3.968150638250165e-06, 0.01903740184182742, 0.4992760415295137],
            [
                [0.9986914018079323, 0.05110526779509754, -0.0019327592963034046],
                [-0.05110526779509702, 0.9986932708100673, 4.9419425796171836e-05],
                [0.0019327592963033862, 4.941942579617124e-05, 0.9999981309978648],
            ],
            0.5052300814823203,
        ),
        (
            10.0,
            1.0,
            [2.6617453950125367e-05, 0.03850929968363682, 0.49705278205988956],
            [
                [0.9956701917524635, 0.09268671394889814, -0.007074059157559234],
                [-0.09268671394889824, 0.9956952671948751, 0.00032854692138217074],
                [0.007074059157559241, 0.000328546921382169, 0.9999749245575891],
            ],
            0.5015852440941804,
        ),
        (
            15.0,
            1.0,
            [7.340398314428787e-05, 0.058159618204179246, 0.4932687885876945],
            [
                [0.9921234673382016, 0.12443622298302577, -0.014375394482889452],
                [-0.12443622298302566, 0.9922272018556287, 0.0008979462481471211],
                [0.014375394482889436, 0.0008979462481471184, 0.9998962654825733],
            ],
            0.49794056695559674,
        ),
        (
            5.0,
            0.65,
            [0.011660149737799965, 0.03500279416800196, 0.4979386427375639],
            [
                [0.998461083645177, 0.030326608533367723, -0.046430176190426366],
                [-0.025838402662852044, 0.9952002112058042, 0.09438705718405559],
                [0.04906976048486719, -0.09304212180995218, 0.994452272447029],
            ],
            0.5001416214691534,
        ),
        (
            15.0,
            0.65,
            [0.0355367356932193, 0.10380305298959791, 0.4813485106956541],
            [
                [0.9890100380349037, 0.05280033630302188, -0.13809876593436254],
                [-0.011761241264541018, 0.9591933901785933, 0.282506129918835],
                [0.1473798421434257, -0.27777718539161983, 0.9492728887973636],
            ],
            0.4928874856194956,
        ),
    ];
    for (tension, turns, tip, frame, length) in table {
        let helix = Routing::Helix { start_angle: 0.0, turns, radius: TILL_OFFSET };
        let robot = till_rod(vec![helix]);
        let solution = solve_finely(&robot, &Case::with_tensions(&[tension]));
        let pose = solution.shape.tip();
        let error = (pose.position - Vec3::from(tip)).norm();
        assert!(error < 1e-11, "{tension} N, {turns} turns: tip off by {error:.1e}");
        let turned = rotation_error(&pose, frame);
        assert!(turned < 1e-10, "{tension} N, {turns} turns: frame off by {turned:.1e}");
        assert!((solution.cables[0].length - length).abs() < 1e-12);
    }
}
