use proptest::prelude::*;
use whipcord::four_bar::{Chord, LengthRule, Objective, Options};
use whipcord::{Backbone, Material, Robot, Routing, Stations, Stiffness, Vec3};

use super::oracle::{self, Section};
use super::{equal_disks, robot, solve, try_solve};

fn objective(strain: bool) -> Objective {
    if strain { Objective::StrainEnergy } else { Objective::CouplerAngle }
}

fn chord(arc: bool) -> Chord {
    if arc { Chord::Arc } else { Chord::Bisector }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn a_section_is_the_least_that_a_search_finds(
        lower in 0.1_f64..0.7,
        ratio in 0.6_f64..1.6,
        turn in -1.0_f64..1.0,
        start in -3.0_f64..3.0,
        part in 0.01_f64..1.0,
        strain: bool,
        arc: bool,
    ) {
        let length = 0.02;
        let (a0, a1) = (lower * length, lower * ratio * length);
        let from = Vec3::new(a0 * start.cos(), a0 * start.sin(), 0.0);
        let to = Vec3::new(a1 * (start + turn).cos(), a1 * (start + turn).sin(), 0.0);
        let routing = Routing::Linear { start: [from.x, from.y], end: [to.x, to.y] };
        let robot = robot(&[0.0, length], vec![routing]);
        let (objective, chord) = (objective(strain), chord(arc));
        let section = Section { length, from, to, chord, objective, rest: Vec3::ZERO };
        // A length that some bend of up to 140° (arc: 100°) has, before the cable crosses over.
        let most = f64::min(if arc { 0.75 } else { 0.94 }, 0.9 * length * (a0 + a1) / (4.0 * a0 * a1));
        let axis = (from / a0 + to / a1).cross(Vec3::Z) * -1.0;
        let target = section.cable(axis * (2.0 * (part * most).asin() / axis.norm()));
        let shortening = section.cable(Vec3::ZERO) - target;
        prop_assume!(shortening > 0.0);
        let options = Options { objective, chord, ..Options::default() };
        let solution = solve(&robot, &options, &[shortening]);
        let tip = solution.disks.tip();
        let w = tip.rotation.log();
        prop_assert!((oracle::pose(length, chord, w).position - tip.position).max_abs() < 1e-15);
        prop_assert!((section.cable(w) - target).abs() < 1e-12 * length);
        let least = section.least(target).unwrap();
        let found = section.measure(w);
        prop_assert!(found < least + 1e-8 * (1.0 + least), "{found} {least}");
    }

    #[test]
    fn without_shortening_every_routing_stays_straight(
        start_angle in -4.0_f64..4.0,
        turns in -2.0_f64..2.0,
        radius in 0.001_f64..0.01,
        x in prop::collection::vec(-0.01_f64..0.01, 1..4),
        end in -0.01_f64..0.01,
        holes in prop::collection::vec(1_usize..=12, 7),
        rule in 0_usize..3,
        strain: bool,
        arc: bool,
    ) {
        let routings = vec![
            Routing::Helix { start_angle, turns, radius },
            Routing::Polynomial { x, y: vec![0.004, end] },
            Routing::Linear { start: [radius, 0.0], end: [0.0, end] },
            Routing::holes(holes),
        ];
        let disks = [0.0, 0.01, 0.04, 0.055, 0.08, 0.1, 0.13];
        let options = Options {
            objective: objective(strain),
            chord: chord(arc),
            lengths: LengthRule::ALL[rule],
            ..Options::default()
        };
        let solution = solve(&robot(&disks, routings), &options, &[0.0; 4]);
        for (pose, &at) in solution.disks.poses.iter().zip(&disks) {
            prop_assert!((pose.position - Vec3::Z * at).max_abs() < 1e-16);
            prop_assert!(pose.rotation.log() == Vec3::ZERO);
        }
        for cable in &solution.cables {
            prop_assert!((cable.length - cable.initial_length).abs() < 1e-15 && !cable.slack);
        }
    }
}

#[test]
fn a_straight_cable_bends_each_section_by_twice_the_arcsine() {
    let (a, l0) = (0.008, 0.02);
    let robot = robot(&equal_disks(0.18, 9), vec![Routing::Straight { angle: 0.4, radius: a }]);
    for strain in [false, true] {
        for rule in LengthRule::ALL {
            for shortening in [1e-9, 1e-4, 0.002, 0.006, 0.011, 0.015, 0.0155] {
                let options =
                    Options { objective: objective(strain), lengths: *rule, ..Options::default() };
                let solution = solve(&robot, &options, &[9.0 * shortening]);
                let bend = 2.0 * f64::asin(shortening / (2.0 * a));
                for pair in solution.disks.poses.windows(2) {
                    let step = (pair[0].inverse() * pair[1]).rotation.log();
                    let expected = Vec3::new(-f64::sin(0.4), f64::cos(0.4), 0.0) * bend;
                    let error = (step - expected).max_abs();
                    assert!(error < 1e-12, "{rule} {shortening}: {step:?} {error:e}");
                }
                assert!(solution.diagnostics.residual < 1e-12);
                let Some(tension) = solution.cables[0].tension else {
                    assert!(!strain);
                    continue;
                };
                // U = EI φ²/2l₀ with ℓ = l₀ − 2a sin(φ/2): τ = EI φ/(a l₀ cos(φ/2)), which tends
                // to the τ = EI u/a of the Cosserat rod.
                let stiffness = 1.1e9 * std::f64::consts::PI * 0.003_f64.powi(4) / 64.0;
                let expected = stiffness * bend / (a * l0 * f64::cos(0.5 * bend));
                assert!(
                    (tension - expected).abs() < 1e-9 * expected + 1e-10,
                    "{tension} {expected}"
                );
            }
        }
    }
}

#[test]
fn tension_is_the_slope_of_the_energy() {
    let routing = Routing::Helix { start_angle: 0.3, turns: 0.75, radius: 0.008 };
    let disks = [0.0, 0.02, 0.035, 0.06, 0.08];
    let robot = robot(&disks, vec![routing]);
    let stiffness = 1.1e9 * std::f64::consts::PI * 0.003_f64.powi(4) / 64.0;
    for &lengths in LengthRule::ALL {
        let options = Options { objective: Objective::StrainEnergy, lengths, ..Options::default() };
        let energy = |shortening: f64| -> f64 {
            let poses = solve(&robot, &options, &[shortening]).disks.poses;
            let parts = poses.windows(2).zip(disks.windows(2)).map(|(pair, s)| {
                let w = (pair[0].inverse() * pair[1]).rotation.log();
                0.5 * stiffness * (w.x * w.x + w.y * w.y + w.z * w.z / 1.3) / (s[1] - s[0])
            });
            parts.sum()
        };
        let h = 1e-6;
        let slope = (energy(0.006 + h) - energy(0.006 - h)) / (2.0 * h);
        let tension = solve(&robot, &options, &[0.006]).cables[0].tension.unwrap();
        assert!((slope - tension).abs() < 1e-7 * tension, "{lengths}: {slope} {tension}");
    }
}

#[test]
fn the_free_rule_has_less_energy_than_the_others_and_one_tension() {
    let disks = [0.0, 0.02, 0.035, 0.06, 0.08, 0.1];
    let routing = Routing::Linear { start: [0.009, 0.0], end: [0.002, 0.003] };
    let robot = robot(&disks, vec![routing]);
    let strain = |lengths| {
        let options = Options { objective: Objective::StrainEnergy, lengths, ..Options::default() };
        let solution = solve(&robot, &options, &[0.005]);
        assert!(
            (solution.cables[0].initial_length - solution.cables[0].length - 0.005).abs() < 1e-13
        );
        let poses = &solution.disks.poses;
        let parts = poses.windows(2).zip(disks.windows(2)).map(|(pair, s)| {
            let w = (pair[0].inverse() * pair[1]).rotation.log();
            (w.x * w.x + w.y * w.y + w.z * w.z / 1.3) / (s[1] - s[0])
        });
        parts.sum::<f64>()
    };
    let free = strain(LengthRule::Free);
    assert!(free < 0.999 * strain(LengthRule::Proportional));
    assert!(free < 0.999 * strain(LengthRule::Equal));
}

#[test]
fn length_rules_share_the_shortening_as_they_say() {
    let disks = [0.0, 0.02, 0.035, 0.06];
    let routing = Routing::Helix { start_angle: 0.3, turns: 0.4, radius: 0.008 };
    let robot = robot(&disks, vec![routing]);
    let route = &robot.routes()[0];
    let shortening = 0.004;
    let hole = |i: usize| route.at(disks[i]).offset;
    let initial = |i: usize| (hole(i + 1) - hole(i) + Vec3::Z * (disks[i + 1] - disks[i])).norm();
    let whole: f64 = (0..3).map(initial).sum();
    for lengths in [LengthRule::Proportional, LengthRule::Equal] {
        let solution = solve(&robot, &Options { lengths, ..Options::default() }, &[shortening]);
        assert!((solution.cables[0].initial_length - whole).abs() < 1e-16);
        let poses = &solution.disks.poses;
        for i in 0..3 {
            let length = (poses[i + 1].transform(hole(i + 1)) - poses[i].transform(hole(i))).norm();
            let expected = match lengths {
                LengthRule::Equal => shortening / 3.0,
                _ => initial(i) * shortening / whole,
            };
            assert!((initial(i) - length - expected).abs() < 1e-15, "{lengths} {i}");
        }
    }
}

#[test]
fn a_cable_that_is_too_long_hangs_loose() {
    let helix = Routing::Helix { start_angle: 0.0, turns: 1.0, radius: 0.008 };
    let robot = robot(&equal_disks(0.1, 5), vec![helix]);
    for &lengths in LengthRule::ALL {
        let options = Options { objective: Objective::StrainEnergy, lengths, ..Options::default() };
        let solution = solve(&robot, &options, &[-0.003]);
        let cable = &solution.cables[0];
        assert!(cable.slack && cable.tension == Some(0.0));
        assert!((cable.length - cable.initial_length).abs() < 1e-16);
        assert!(solution.disks.tip().rotation.log() == Vec3::ZERO);
        assert!(solution.diagnostics.residual == 0.0);
    }
}

#[test]
fn beyond_the_end_of_the_cable_the_robot_stays_straight() {
    let robot = robot(&equal_disks(0.18, 9), vec![Routing::holes(vec![1, 2, 3, 3, 4])]);
    for &lengths in LengthRule::ALL {
        let solution = solve(&robot, &Options { lengths, ..Options::default() }, &[0.005]);
        let poses = &solution.disks.poses;
        for i in 0..9 {
            let step = poses[i].inverse() * poses[i + 1];
            let bent = step.rotation.log().norm();
            assert!(if i < 4 { bent > 0.05 } else { bent < 1e-15 }, "{lengths} {i} {bent}");
        }
        assert!(
            (solution.cables[0].length - solution.cables[0].initial_length + 0.005).abs() < 1e-13
        );
    }
}

#[test]
fn stations_meet_the_disks_and_follow_the_backbone() {
    let helix = Routing::Helix { start_angle: 0.0, turns: 0.75, radius: 0.008 };
    let robot = robot(&equal_disks(0.18, 9), vec![helix]);
    for chord in [Chord::Bisector, Chord::Arc] {
        let options = Options { chord, stations: Stations::Equal(91), ..Options::default() };
        let solution = solve(&robot, &options, &[0.01]);
        assert_eq!(solution.shape.poses.len(), 91);
        for (i, disk) in solution.disks.poses.iter().enumerate() {
            let station = solution.shape.poses[10 * i];
            assert!((station.position - disk.position).max_abs() < 1e-15);
            assert!((station.rotation.conjugate() * disk.rotation).log().max_abs() < 1e-14);
        }
        let steps = solution.shape.poses.windows(2);
        let length: f64 = steps.map(|p| (p[1].position - p[0].position).norm()).sum();
        // Chords of arcs as long as the backbone; the bisector's arcs are longer than their links.
        match chord {
            Chord::Arc => assert!(length < 0.18 && length > 0.17999),
            Chord::Bisector => assert!(length > 0.18 && length < 0.1803),
        }
    }
}

#[test]
fn the_printed_equations_twist_a_robot_at_rest_and_keep_it_in_a_plane() {
    let robot = robot(&equal_disks(0.18, 9), vec![Routing::holes((1..=10).collect())]);
    let printed = Options { objective: Objective::AsPrinted, ..Options::default() };
    let rest = solve(&robot, &printed, &[0.0]);
    for pair in rest.disks.poses.windows(2) {
        let step = (pair[0].inverse() * pair[1]).rotation.log();
        // One hole of twelve, back.
        assert!((step.z.to_degrees() + 30.0).abs() < 0.1, "{step:?}");
    }
    let pulled = solve(&robot, &printed, &[0.012]);
    assert!((pulled.cables[0].length - pulled.cables[0].initial_length + 0.012).abs() < 1e-14);
    for solution in [&rest, &pulled] {
        for position in solution.disks.positions() {
            assert!(position.y.abs() < 1e-15, "{position:?}");
        }
    }
    // With a straight cable that pulls they are the default model.
    let straight = super::robot(&equal_disks(0.18, 9), vec![Routing::holes(vec![4; 10])]);
    let a = solve(&straight, &printed, &[0.01]);
    let b = solve(&straight, &Options::default(), &[0.01]);
    assert!(a.disks.distances(&b.disks).all(|d| d < 1e-14));
}

/// The strain energy of a stiffness that is given is that of the section and material it comes from,
/// and asks for no Poisson's ratio.
#[test]
fn a_given_stiffness_is_weighed_as_that_of_a_material() {
    let made = robot(
        &equal_disks(0.18, 9),
        vec![Routing::Helix { start_angle: 0.3, turns: 0.5, radius: 0.008 }],
    );
    let area = made.backbone().section_at(made.disks(), 0.0).unwrap();
    let (young, shear) = (1.1e9, made.backbone().material.shear_modulus().unwrap());
    let bending = young * area.second_moment_x;
    let stiffness = Stiffness::diagonal([1.0; 2], 1.0, [bending; 2], shear * area.torsion_constant);
    let given = |stiffness| {
        let backbone = Backbone {
            section: None,
            material: Material::default(),
            stiffness: Some(stiffness),
            ..made.backbone().clone()
        };
        Robot::new(backbone, made.disks().clone(), made.cables().to_vec()).unwrap()
    };
    let options = Options { objective: Objective::StrainEnergy, ..Options::default() };
    let (a, b) = (solve(&made, &options, &[0.008]), solve(&given(stiffness), &options, &[0.008]));
    for (p, q) in a.disks.poses.iter().zip(&b.disks.poses) {
        assert!((p.position - q.position).norm() < 1e-12);
    }
    let tensions = [&a, &b].map(|solution| solution.cables[0].tension.unwrap());
    assert!((tensions[0] / tensions[1] - 1.0).abs() < 1e-9, "{tensions:?}");

    let mut matrix = [[0.0; 6]; 6];
    for (i, row) in matrix.iter_mut().enumerate() {
        row[i] = 1.0;
    }
    (matrix[3][5], matrix[5][3]) = (0.2, 0.2);
    let coupled = given(Stiffness::Matrix(matrix.into()));
    let refusal = try_solve(&coupled, &options, &[0.008]).unwrap_err();
    assert!(refusal.to_string().contains("`backbone.stiffness.matrix`"), "{refusal}");
    assert!(try_solve(&coupled, &Options::default(), &[0.008]).is_ok());
}
