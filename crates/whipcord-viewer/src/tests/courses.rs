//! Courses that the page plays, forces at places of the backbone, and what is told of loads and moments.

use std::fs;
use std::sync::Arc;
use std::time::{Duration, Instant};

use tokio_tungstenite::tungstenite::Message;
use whipcord::{Model, ModelKind, Vec3};
use whipcord_io::{load, parse};
use whipcord_motion::Simulation;

use super::{Client, example, serve};
use crate::bench::Bench;
use crate::protocol::{
    Answer, Course, FromPage, Load, Moment, PlayRequest, Pull, Request, Solved, ToPage, Track,
};
use crate::scene::scene;

fn say(message: &FromPage) -> Message {
    Message::Text(serde_json::to_string(message).unwrap().into())
}

fn solved(answer: &Answer) -> &Solved {
    match answer {
        Answer::Solved(solved) => solved,
        Answer::Failed { message, .. } => panic!("{message}"),
    }
}

fn tip(moment: &Moment) -> Vec3 {
    (*solved(&moment.answers[0]).positions.last().unwrap()).into()
}

/// All parts of the course that is asked for.
async fn played(client: &mut Client, asked: &PlayRequest) -> (Vec<Moment>, Option<String>, usize) {
    client.say(say(&FromPage::Play(asked.clone()))).await;
    let (mut all, mut parts) = (Vec::new(), 0);
    loop {
        let ToPage::Track(Track { id, course, from, moments, complete, message }) =
            client.hear().await
        else {
            panic!("something else than a course")
        };
        assert_eq!((id, course, from), (asked.request.id, asked.course, all.len()));
        all.extend(moments);
        parts += 1;
        if complete {
            return (all, message, parts);
        }
    }
}

#[tokio::test]
async fn steps_of_a_file_are_those_that_the_library_solves() {
    let path = example("hysteresis-loop.toml");
    let port = serve(&path).await;
    let (mut client, scene) = Client::connect(port).await;
    let file = load(&path).unwrap();
    let count = file.case.before.len() + 1;
    assert_eq!((scene.courses.len(), scene.courses[0].count), (1, count));
    let models = vec!["cosserat".to_owned(), "four-bar".to_owned()];
    let request = Request { id: 3, models, ..scene.initial.clone() };
    let (moments, message, _) =
        played(&mut client, &PlayRequest { course: Course::Steps, request }).await;
    assert_eq!((moments.len(), message), (count, None));
    let model = Model::new(ModelKind::Cosserat, Default::default(), Default::default());
    let expected =
        model.prepare(&file.robot, &file.case.loads).unwrap().solve_all(&file.case).unwrap();
    for (moment, expected) in moments.iter().zip(&expected) {
        assert!((tip(moment) - expected.shape.tip().position).norm() < 1e-6 * scene.length);
        // A model that does not go through them says so.
        assert!(
            matches!(&moment.answers[1], Answer::Failed { message, .. } if !message.is_empty())
        );
    }
}

#[tokio::test]
async fn a_motion_is_that_of_the_simulation_and_comes_in_parts() {
    let path = example("released-arm.toml");
    let port = serve(&path).await;
    let (mut client, scene) = Client::connect(port).await;
    let asked =
        PlayRequest { course: Course::Motion, request: Request { id: 5, ..scene.initial.clone() } };
    let (moments, message, parts) = played(&mut client, &asked).await;
    assert!(message.is_none() && parts > 3);
    assert_eq!(moments.len(), scene.courses[0].count);
    let file = load(&path).unwrap();
    let (every, steps, rows) = file.motion.rows().unwrap();
    let commands = file.motion.commands(&file.robot, &file.case);
    let mut simulation =
        Simulation::with_commands(&file.robot, &file.case, &commands, file.motion.options())
            .unwrap();
    let expected = simulation.run(&commands, every, steps, rows).unwrap();
    for (moment, state) in moments.iter().zip(&expected.states) {
        assert!((moment.time - state.time).abs() < 1e-12);
        assert!((tip(moment) - state.tip().position).norm() < 1e-12);
        let cables = &solved(&moment.answers[0]).cables;
        assert_eq!(cables[0].tension, Some(state.cables[0].tension));
    }
}

#[tokio::test]
async fn loads_are_told_of_where_they_change_in_a_course() {
    let text = fs::read_to_string(example("released-arm.toml")).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("arm.toml");
    let pushed = "[[motion.loads]]\nfactor = [[\"0 s\", 0], [\"0.5 s\", 1]]\n\
                  [[motion.loads.point]]\nat = \"100 mm\"\nforce = [\"0.2 N\", \"0 N\", \"0 N\"]\n";
    fs::write(&path, format!("{text}\n{pushed}")).unwrap();
    let port = serve(&path).await;
    let (mut client, scene) = Client::connect(port).await;
    let asked =
        PlayRequest { course: Course::Motion, request: Request { id: 2, ..scene.initial.clone() } };
    let (moments, message, _) = played(&mut client, &asked).await;
    assert_eq!(message, None);
    for moment in &moments {
        // Behind the ramp nothing changes.
        let Some(acting) = &moment.acting else {
            assert!(moment.time > 0.5);
            continue;
        };
        assert!(moment.time < 0.52 && acting.gravity == scene.initial.gravity);
        let at_place = |load: &Load| match load {
            Load::Single { arc_length, force, .. } if *arc_length == 0.1 => force[0],
            _ => 0.0,
        };
        let sum: f64 = acting.loads.iter().map(at_place).sum();
        assert!((sum - 0.2 * (moment.time / 0.5).min(1.0)).abs() < 1e-12, "{sum}");
    }
    // Rows of a table have loads of their own.
    let rows = "left [N],right [N],tip_force.y [N]\n1,0,0\n1,0,0\n1,0,0.1\n";
    fs::write(folder.path().join("rows.csv"), rows).unwrap();
    let (robot, _) = text.split_once("[motion]").unwrap();
    let robot = robot.replace("tension = \"0 N\"\n", "");
    fs::write(&path, format!("{robot}\n[commands]\ntable = \"rows.csv\"\neach = \"in order\"\n"))
        .unwrap();
    let (mut client, scene) = Client::connect(serve(&path).await).await;
    let asked =
        PlayRequest { course: Course::Steps, request: Request { id: 1, ..scene.initial.clone() } };
    let (moments, message, _) = played(&mut client, &asked).await;
    assert_eq!(message, None);
    let forces: Vec<_> =
        moments.iter().map(|moment| moment.acting.as_ref().map(|of| of.tip_force)).collect();
    assert_eq!(forces, [Some([0.0; 3]), None, Some([0.0, 0.1, 0.0])]);
}

#[tokio::test]
async fn a_motion_that_is_ended_says_nothing_more() {
    // So long that it is not over before its end is asked for.
    let text = fs::read_to_string(example("released-arm.toml")).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("arm.toml");
    fs::write(&path, text.replace("duration = \"2 s\"", "duration = \"2000 s\"")).unwrap();
    let port = serve(&path).await;
    let (mut client, scene) = Client::connect(port).await;
    let request = Request { id: 5, ..scene.initial.clone() };
    client.say(say(&FromPage::Play(PlayRequest { course: Course::Motion, request }))).await;
    client.say(say(&FromPage::EndPlay)).await;
    while let Ok(message) = tokio::time::timeout(Duration::from_secs(3), client.hear()).await {
        let ToPage::Track(track) = message else { panic!("something else than a course") };
        assert!(!track.complete, "{:?}", track.message);
    }
}

#[test]
fn a_force_at_a_place_is_a_load_of_the_case_in_the_frame_of_the_world() {
    let path = example("two-segment-arm.toml");
    let text = fs::read_to_string(&path).unwrap();
    // On a wall: its frame of loads is not the world.
    let text = format!("{text}\n[base]\nrotation = {{ axis = [1, 0, 0], angle = \"45 deg\" }}\n");
    let file = Arc::new(parse(&text, &path).unwrap());
    let told = scene(&file);
    let pull = Pull { arc_length: told.stations[7], force: [0.2, -0.1, 0.05] };
    let request = Request { pull: Some(pull), compliance: false, ..told.initial.clone() };
    let frame = Bench::new(Arc::clone(&file)).solve(&request, Instant::now()).unwrap();
    let mut case = file.case.clone();
    let turned = case.base.rotation.conjugate();
    case.loads.points.push(whipcord::PointLoad {
        at: pull.arc_length,
        force: turned.rotate(pull.force.into()),
        ..Default::default()
    });
    let model = Model::new(ModelKind::Cosserat, Default::default(), Default::default());
    let expected = model.prepare(&file.robot, &case.loads).unwrap().solve(&case, None).unwrap();
    let found = Vec3::from(*solved(&frame.answers[0]).positions.last().unwrap());
    assert!((found - expected.shape.tip().position).norm() < 1e-6 * told.length);
    // Beyond the tip there is no place, which is said.
    let pull = Pull { arc_length: 2.0 * told.length, ..pull };
    let request = Request { pull: Some(pull), ..request };
    let frame = Bench::new(file).solve(&request, Instant::now()).unwrap();
    assert!(matches!(&frame.answers[0], Answer::Failed { .. }));
}

/// A rod that a moment at its tip bends and twists has that moment everywhere.
#[test]
fn moments_are_those_of_the_backbone() {
    let path = example("two-segment-arm.toml");
    let text = fs::read_to_string(&path).unwrap();
    let text =
        text.replace("\"9.81 m/s^2\"", "\"0\"") + "tip_moment = [\"0\", \"30 mN*m\", \"0\"]\n";
    let file = Arc::new(parse(&text, &path).unwrap());
    let cables = file.robot.cables().len();
    let mut request = scene(&file).initial;
    request.commands = vec![crate::protocol::Command::Tension(0.0); cables];
    let frame = Bench::new(file).solve(&request, Instant::now()).unwrap();
    let solved = solved(&frame.answers[0]);
    let moments = solved.moments.clone().unwrap();
    assert_eq!(moments.len(), solved.strains.len());
    for [x, y, z] in moments {
        assert!(x.abs() < 1e-9 && (y - 0.03).abs() < 1e-7 && z.abs() < 1e-9, "{x} {y} {z}");
    }
}

#[test]
fn loads_of_the_file_are_told() {
    let path = example("two-segment-arm.toml");
    let text = fs::read_to_string(&path).unwrap()
        + "[[loads.point]]\nat = \"100 mm\"\nforce = [\"0 N\", \"0.3 N\", \"0 N\"]\nfollower = true\n\
           [[loads.mass]]\nat = \"200 mm\"\nmass = \"15 g\"\n\
           [[loads.distributed]]\nforce = [\"0 N/m\", \"0 N/m\", \"-0.5 N/m\"]\n";
    let file = parse(&text, &path).unwrap();
    let told = scene(&file).loads;
    let force = [0.0, 0.3, 0.0];
    let point = Load::Single { arc_length: 0.1, force, moment: [0.0; 3], follows: true };
    assert_eq!(told[0], point);
    let Load::Spread { arc_lengths, forces, moments, follows } = &told[1] else { panic!() };
    assert_eq!((arc_lengths.first(), arc_lengths.last()), (Some(&0.0), Some(&0.3)));
    assert!(forces.iter().all(|force| *force == [0.0, 0.0, -0.5]) && !follows);
    assert_eq!((forces.len(), moments.len()), (arc_lengths.len(), arc_lengths.len()));
    assert_eq!(told[2], Load::Mass { arc_length: 0.2, mass: 0.015 });
}
