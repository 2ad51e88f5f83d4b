//! What the page is answered is what the library says.

use std::sync::Arc;
use std::time::Instant;

use whipcord::{CableCommand, Model, ModelKind, ModelPreset, Shortening, Statics as _, Stations};
use whipcord_io::load;

use super::example;
use crate::bench::Bench;
use crate::convert::array;
use crate::protocol::{Answer, Command, Compliance, Request, Solved};
use crate::scene::{model, scene};
use crate::stations::Places;

fn only(answers: Vec<Answer>) -> Solved {
    match answers.into_iter().next().unwrap() {
        Answer::Solved(solved) => *solved,
        Answer::Failed { model, message } => panic!("{model}: {message}"),
    }
}

#[test]
fn an_answer_is_that_of_the_library() {
    let file = Arc::new(load(example("two-segment-arm.toml")).unwrap());
    let mut request = scene(&file).initial;
    request.commands[3] = Command::Tension(12.5);
    request.tip_force = [0.2, -0.1, 0.0];
    let mut bench = Bench::new(Arc::clone(&file));
    let frame = bench.solve(&request, Instant::now()).unwrap();
    let solved = only(frame.answers);

    let mut case = file.case.clone();
    case.commands[3] = CableCommand { tension: Some(12.5), shortening: None };
    case.loads.tip_force = request.tip_force.into();
    let expected = model(ModelPreset::usual(ModelKind::Cosserat), &Places::of(&file.robot))
        .solve(&file.robot, &case)
        .unwrap();
    let positions: Vec<_> = expected.shape.positions().map(array).collect();
    assert_eq!(solved.positions, positions);
    for (found, cable) in solved.cables.iter().zip(&expected.cables) {
        assert_eq!((found.length, found.tension), (cable.length, cable.tension));
    }
    // The places at which a frame gives the shape change the steps of the integration, and little else.
    let at_disks = Model::new(ModelKind::Cosserat, Stations::Disks, Default::default());
    let at_disks = at_disks.solve(&file.robot, &case).unwrap();
    let apart = at_disks.disks.tip().position - expected.disks.tip().position;
    assert!(apart.norm() < 1e-6 * file.robot.backbone().length);
}

#[test]
fn a_geometric_model_is_driven_by_the_lengths_that_tensions_give() {
    let file = Arc::new(load(example("table1/case-3.toml")).unwrap());
    let models = vec!["four-bar".to_owned()];
    let request = Request { models, gravity: [0.0; 3], ..scene(&file).initial };
    let solved =
        only(Bench::new(Arc::clone(&file)).solve(&request, Instant::now()).unwrap().answers);
    assert_eq!(solved.driven_by.as_deref(), Some("cosserat"));

    let places = Places::of(&file.robot);
    let mut case = file.case.clone();
    case.loads.gravity = None;
    let rod =
        model(ModelPreset::usual(ModelKind::Cosserat), &places).solve(&file.robot, &case).unwrap();
    for (command, cable) in case.commands.iter_mut().zip(&rod.cables) {
        let shortening = cable.initial_length - cable.length;
        // Where the cables run is the same to both models; how long they take themselves to be is not.
        let share = shortening / cable.initial_length;
        command.shortening = Some(Shortening::Fraction(share));
    }
    let expected =
        model(ModelPreset::usual(ModelKind::FourBar), &places).solve(&file.robot, &case).unwrap();
    let apart = |(found, expected): (&[f64; 3], whipcord::Vec3)| {
        (whipcord::Vec3::from(*found) - expected).norm()
    };
    let worst = solved.positions.iter().zip(expected.shape.positions()).map(apart);
    assert!(worst.fold(0.0, f64::max) < 1e-9);
}

#[test]
fn a_geometric_model_is_driven_by_the_lengths_that_steps_and_friction_left() {
    let file = Arc::new(load(example("rubbing-finger.toml")).unwrap());
    let models = vec!["cosserat-disks".to_owned(), "four-bar".to_owned()];
    let request = Request { models, ..scene(&file).initial };
    let frame = Bench::new(Arc::clone(&file)).solve(&request, Instant::now()).unwrap();
    let [rod, driven] = frame.answers.try_into().unwrap();
    let (rod, driven) = (only(vec![rod]), only(vec![driven]));
    assert_eq!(driven.driven_by.as_deref(), Some("cosserat-disks"));

    let shares = rod.cables.iter().map(|cable| 1.0 - cable.length / cable.initial_length);
    let fraction =
        |share| CableCommand { tension: None, shortening: Some(Shortening::Fraction(share)) };
    let case = whipcord::Case { commands: shares.map(fraction).collect(), ..Default::default() };
    let expected = model(ModelPreset::usual(ModelKind::FourBar), &Places::of(&file.robot))
        .solve(&file.robot, &case)
        .unwrap();
    let apart = expected.shape.tip().position - (*driven.positions.last().unwrap()).into();
    assert!(apart.norm() < 1e-9 * file.robot.backbone().length, "{apart:?}");
    // Friction holds more of the cable back than the same tension without the steps before.
    let mut at_once = (*file).clone();
    at_once.case.before.clear();
    let mut bench = Bench::new(Arc::new(at_once));
    let [_, straight] = bench.solve(&request, Instant::now()).unwrap().answers.try_into().unwrap();
    let [x, y] = [driven, only(vec![straight])].map(|solved| solved.cables[0].length);
    assert!(y - x > 1e-4, "{x} {y}");
}

#[test]
fn what_rubs_does_not_depend_on_how_the_sliders_went_there() {
    let mut file = load(example("contact/rubbing-wall.toml")).unwrap();
    file.case.before.clear();
    let file = Arc::new(file);
    let mut bench = Bench::new(Arc::clone(&file));
    let mut request = scene(&file).initial;
    let mut ask = |tension| {
        request.commands[0] = Command::Tension(tension);
        only(bench.solve(&request, Instant::now()).unwrap().answers)
    };
    let [up, _, down] = [3.0, 3.6, 3.0].map(&mut ask);
    assert!(up.contacts.iter().any(|touch| touch.friction.is_some()), "{:?}", up.contacts);
    assert_eq!(up.positions, down.positions);
    assert_eq!(up.contacts, down.contacts);
}

#[test]
fn what_has_no_answer_says_why_and_the_next_request_is_answered() {
    let file = Arc::new(load(example("two-segment-arm.toml")).unwrap());
    let initial = scene(&file).initial;
    let mut bench = Bench::new(file);
    let mut request = initial.clone();
    request.commands[0] = Command::Tension(60_000.0);
    let frame = bench.solve(&request, Instant::now()).unwrap();
    let Some(Answer::Failed { model, message }) = frame.answers.first() else {
        panic!("{frame:?}");
    };
    assert_eq!(model, "cosserat");
    assert!(message.contains("pull the cable less"), "{message}");
    for bad in [f64::NAN, -1.0, 1e30] {
        request.commands[0] = Command::Tension(bad);
        let frame = bench.solve(&request, Instant::now()).unwrap();
        assert!(matches!(frame.answers[0], Answer::Failed { .. }), "{bad}");
    }
    request.commands.pop();
    let frame = bench.solve(&request, Instant::now()).unwrap();
    assert!(matches!(frame.answers[0], Answer::Failed { .. }));
    only(bench.solve(&initial, Instant::now()).unwrap().answers);
}

#[test]
fn the_compliance_of_the_tip_is_how_far_a_small_force_moves_it() {
    let file = Arc::new(load(example("two-segment-arm.toml")).unwrap());
    let mut request = Request { compliance: true, ..scene(&file).initial };
    let mut bench = Bench::new(Arc::clone(&file));
    let before = only(bench.solve(&request, Instant::now()).unwrap().answers);
    let Some(Compliance::Known { values, directions }) = before.compliance else {
        panic!("{:?}", before.compliance);
    };
    let force = 1e-4;
    request.tip_force = directions[0].map(|d| d * force);
    let after = only(bench.solve(&request, Instant::now()).unwrap().answers);
    let (a, b) = (before.positions.last().unwrap(), after.positions.last().unwrap());
    let moved: f64 = (0..3).map(|k| (b[k] - a[k]) * directions[0][k]).sum();
    assert!((moved / force / values[0] - 1.0).abs() < 1e-3, "{} {}", moved / force, values[0]);
}

/// A bar under a push along it beyond Euler's load, π²EI/4L² = 0.49 N, leans to where it was pushed aside first; from cold,
/// to where it is pushed aside now.
#[test]
fn the_compliance_is_that_of_the_shape_which_is_shown() {
    let text = "[backbone]\nlength = \"200 mm\"\nsection = { width = \"2 mm\", height = \"6 mm\" }\nyoung_modulus = \"2 GPa\"\npoisson_ratio = 0.3\n\
        [disks]\ncount = 11\nhole_circle_radius = \"8 mm\"\nholes = 4\n\
        [[cables]]\nname = \"a\"\nrouting = { kind = \"straight\", angle = 0, radius = \"8 mm\" }\n";
    let file = Arc::new(whipcord_io::parse(text, "rod.toml").unwrap());
    for kind in [ModelKind::Cosserat, ModelKind::CosseratDisks] {
        let mut bench = Bench::new(Arc::clone(&file));
        let mut request = Request {
            models: vec![kind.name().to_owned()],
            tip_force: [0.05, 0.0, -0.7],
            ..scene(&file).initial
        };
        let mut ask =
            |request: &Request| only(bench.solve(request, Instant::now()).unwrap().answers);
        ask(&request);
        request.tip_force[0] = -0.01;
        request.compliance = true;
        let shown = ask(&request);
        let tip = |solved: &Solved| whipcord::Vec3::from(*solved.positions.last().unwrap());
        let mut cold = Bench::new(Arc::clone(&file));
        let other = only(cold.solve(&request, Instant::now()).unwrap().answers);
        assert!(
            tip(&shown).x > 0.02 && tip(&other).x < -0.02,
            "{:?} {:?}",
            tip(&shown),
            tip(&other)
        );

        let Some(Compliance::Known { values, directions }) = shown.compliance else {
            panic!("{kind}: {:?}", shown.compliance);
        };
        let force = 1e-5;
        for (value, direction) in values.into_iter().zip(directions.map(whipcord::Vec3::from)) {
            let pushed = |by: f64| {
                let tip_force = whipcord::Vec3::from(request.tip_force) + direction * (by * force);
                Request { tip_force: array(tip_force), compliance: false, ..request.clone() }
            };
            let moved = tip(&ask(&pushed(1.0))) - tip(&ask(&pushed(-1.0)));
            let found = moved * (0.5 / force);
            assert!(
                (found - direction * value).norm() < 1e-2 * values[0],
                "{kind}: {found:?} {value}"
            );
        }
    }
}

#[test]
fn a_preset_is_a_choice_of_its_own() {
    let file = Arc::new(load(example("table1/case-2.toml")).unwrap());
    let scene = scene(&file);
    let names = ["four-bar", "four-bar-sliding", "four-bar-strain-energy"];
    let offered = |name| scene.models.iter().any(|one| one.name == name && one.refusal.is_none());
    assert!(names.into_iter().all(offered), "{:?}", scene.models);

    let models = names.map(str::to_owned).to_vec();
    let request = Request { models, gravity: [0.0; 3], ..scene.initial };
    let frame = Bench::new(file).solve(&request, Instant::now()).unwrap();
    let tip = |answer: &Answer, name| match answer {
        Answer::Solved(solved) if solved.model == name => {
            whipcord::Vec3::from(*solved.positions.last().unwrap())
        }
        other => panic!("{name}: {other:?}"),
    };
    let tips: Vec<_> = frame.answers.iter().zip(names).map(|(one, name)| tip(one, name)).collect();
    // Around a helix, what angles and energy find least are different shapes.
    assert!((tips[2] - tips[1]).norm() > 1e-6, "{tips:?}");
    assert!((tips[2] - tips[0]).norm() > 1e-6, "{tips:?}");
}

#[test]
fn every_example_can_be_viewed() {
    let mut files = Vec::new();
    // Those among obstacles take seconds each without optimisation; one of them is viewed in a browser.
    for folder in ["", "table1"] {
        let entries =
            std::fs::read_dir(example(folder)).unwrap().map(|entry| entry.unwrap().path());
        files.extend(entries.filter(|path| path.extension().is_some_and(|e| e == "toml")));
    }
    assert!(files.len() > 10);
    for path in files {
        let scene = scene(&load(&path).unwrap());
        assert!(!scene.initial.models.is_empty(), "{}", path.display());
        for range in [scene.ranges.tension, scene.ranges.shortening, scene.ranges.force] {
            assert!(range > 0.0 && range.is_finite(), "{}: {range}", path.display());
        }
    }
}
