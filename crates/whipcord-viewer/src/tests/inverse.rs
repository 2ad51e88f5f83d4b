//! Dragging the tip to a place, and surveys of where it can go.

use std::fs;
use std::sync::Arc;
use std::time::{Duration, Instant};

use tokio_tungstenite::tungstenite::Message;
use whipcord::{ModelKind, Vec3};
use whipcord_io::parse;

use super::{Client, example, serve, tip};
use crate::bench::Bench;
use crate::protocol::{Answer, Command, Frame, FromPage, Reach, Request, ToPage};
use crate::scene::scene;

const ARM: &str = "two-segment-arm.toml";
const LIMITS: &str = "\n[limits]\ntension = [\"0.5 N\", \"40 N\"]\n";

fn bench(more: &str) -> (Bench, Request) {
    let path = example(ARM);
    let text = fs::read_to_string(&path).unwrap() + more;
    let file = Arc::new(parse(&text, &path).unwrap());
    let initial = scene(&file).initial;
    (Bench::new(file), initial)
}

fn found(frame: &Frame) -> (bool, Vec<Command>, f64, usize) {
    match frame.reach.clone().unwrap() {
        Reach::Found { reached, commands, distance, limits } => {
            assert!(limits.iter().all(|of| of.slider.is_some() && !of.words.is_empty()));
            (reached, commands, distance, limits.len())
        }
        Reach::Failed { message } => panic!("{message}"),
    }
}

fn shown(frame: &Frame) -> Vec3 {
    match &frame.answers[0] {
        Answer::Solved(solved) => (*solved.positions.last().unwrap()).into(),
        Answer::Failed { message, .. } => panic!("{message}"),
    }
}

/// The place moves as a pointer does, each time from the commands before.
#[test]
fn commands_follow_the_place_within_the_limits() {
    let (mut bench, mut request) = bench(LIMITS);
    let start = tip(ARM, ModelKind::Cosserat, &request);
    for step in 0..40 {
        let turn = f64::from(step) / 40.0 * core::f64::consts::TAU;
        // Lower on the far side, and so small that the S in which the arm begins reaches all of it with these tensions.
        let away = 1.0 - turn.cos();
        let place = start + Vec3::new(0.015 * turn.sin(), 0.015 * away, -0.015 * away);
        request.target = Some(place.to_array());
        let frame = bench.solve(&request, Instant::now()).unwrap();
        let (reached, commands, distance, _) = found(&frame);
        assert!(reached && distance <= 3e-5, "{step}: {distance}");
        assert!((shown(&frame) - place).norm() < 4e-5);
        let is_kept = |command: &Command| (0.5..=40.0).contains(&command.value());
        assert!(commands.iter().all(is_kept), "{commands:?}");
        request.commands = commands;
        // What the library says of these commands.
        assert!((tip(ARM, ModelKind::Cosserat, &request) - place).norm() < 4e-5);
    }
}

#[test]
fn a_place_out_of_reach_has_the_nearest_commands_and_their_limits() {
    let (mut bench, mut request) = bench(LIMITS);
    request.target = Some([0.4, 0.0, 0.2]);
    let frame = bench.solve(&request, Instant::now()).unwrap();
    let (reached, _, distance, _) = found(&frame);
    assert!(!reached && distance > 0.05, "{distance}");
    assert!(((shown(&frame) - Vec3::new(0.4, 0.0, 0.2)).norm() - distance).abs() < 1e-6);
    // Loads may change from request to request.
    request.tip_force = [0.0, 0.1, 0.0];
    let place = tip(ARM, ModelKind::Cosserat, &request) + Vec3::new(-0.005, 0.0, 0.0);
    request.target = Some(place.to_array());
    let frame = bench.solve(&request, Instant::now()).unwrap();
    let (reached, _, _, _) = found(&frame);
    assert!(reached && (shown(&frame) - place).norm() < 4e-5);
    request.models.clear();
    let frame = bench.solve(&request, Instant::now()).unwrap();
    assert!(matches!(frame.reach, Some(Reach::Failed { .. })) && frame.answers.is_empty());
}

fn say(message: &FromPage) -> Message {
    Message::Text(serde_json::to_string(message).unwrap().into())
}

#[tokio::test]
async fn a_survey_lets_other_requests_pass_and_is_ended() {
    let port = serve(&example("three-cable-segment.toml")).await;
    let (mut client, scene) = Client::connect(port).await;
    let survey = |id| FromPage::Survey(Request { id, ..scene.initial.clone() });
    client.say(say(&survey(7))).await;
    let (mut asked, mut frames, mut cloud) = (0, 0, None);
    while cloud.is_none() || frames < asked {
        if cloud.is_none() {
            asked += 1;
            client.ask(&Request { id: 100 + asked, ..scene.initial.clone() }).await;
        }
        match client.hear().await {
            ToPage::Frame(frame) => frames = frame.id - 100,
            ToPage::Cloud(found) => cloud = Some(found),
            other => panic!("{other:?}"),
        }
    }
    let cloud = cloud.unwrap();
    assert_eq!((cloud.id, cloud.dimension), (7, 2));
    assert!(cloud.points.len() > 100 && cloud.points.len() == cloud.dexterity.len());
    // Answers were not held up by the survey.
    assert!(frames > 1, "{frames}");
    // One that is ended says nothing; one that is replaced neither.
    client.say(say(&survey(8))).await;
    client.say(say(&FromPage::EndSurvey)).await;
    let silence = tokio::time::timeout(Duration::from_secs(2), client.hear()).await;
    assert!(silence.is_err(), "{silence:?}");
    client.say(say(&survey(9))).await;
    client.say(say(&survey(10))).await;
    let ToPage::Cloud(cloud) = client.hear().await else { panic!() };
    assert_eq!(cloud.id, 10);
}
