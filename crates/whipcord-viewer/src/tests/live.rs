//! A server and its pages.

use std::fs;
use std::ops::RangeInclusive;
use std::time::Duration;

use proptest::prelude::*;
use proptest::strategy::ValueTree as _;
use proptest::test_runner::TestRunner;
use tokio_tungstenite::tungstenite::Message;
use whipcord::{ModelKind, ModelPreset, Vec3};

use super::{Client, example, serve, serve_by, serve_with, tip};
use crate::connection::Limits;
use crate::error::ViewError;
use crate::protocol::{Answer, Command, Frame, Request, Scene, ToPage};
use crate::server::{Server, Viewed};

fn solved(message: ToPage) -> Frame {
    match message {
        ToPage::Frame(frame) => {
            assert!(frame.answers.iter().all(|a| matches!(a, Answer::Solved(_))), "{frame:?}");
            frame
        }
        other => panic!("{other:?} is no frame"),
    }
}

fn broken(message: ToPage) -> String {
    match message {
        ToPage::Broken { message } => message,
        other => panic!("{other:?} is no mistake in the file"),
    }
}

fn opened(message: ToPage) -> Scene {
    match message {
        ToPage::Scene(scene) => *scene,
        other => panic!("{other:?} is no robot"),
    }
}

const ARM: &str = "two-segment-arm.toml";
const MODELS: [ModelKind; 2] = [ModelKind::Cosserat, ModelKind::CosseratDisks];

/// The first slider on its way from 14 N, by both models.
fn moved(initial: &Request, ids: RangeInclusive<u64>) -> Vec<Request> {
    let at = |id| {
        let mut commands = initial.commands.clone();
        commands[0] = Command::Tension(14.0 + id as f64 * 0.01);
        let models = MODELS.map(|kind| kind.name().to_owned()).to_vec();
        Request { id, commands, models, ..initial.clone() }
    };
    ids.map(at).collect()
}

/// Whether a frame is what the library says to a request alone.
fn assert_answers(frame: &Frame, request: &Request) {
    assert_eq!((frame.id, frame.answers.len()), (request.id, MODELS.len()));
    for (answer, kind) in frame.answers.iter().zip(MODELS) {
        let Answer::Solved(solved) = answer else { panic!("{answer:?}") };
        let found = Vec3::from(*solved.positions.last().unwrap());
        // Each model from where the slider was before, and at other places along the robot.
        assert!((found - tip(ARM, kind, request)).norm() < 1e-6, "{kind}: {found:?}");
    }
}

#[tokio::test]
async fn the_latest_request_is_answered_and_none_queue_up() {
    let port = serve(&example(ARM)).await;
    let (mut client, scene) = Client::connect(port).await;
    const LAST: u64 = 300;
    let requests = moved(&scene.initial, 1..=LAST);
    client.ask_all(&requests).await;
    let mut frames = Vec::new();
    while frames.last().is_none_or(|frame: &Frame| frame.id != LAST) {
        frames.push(solved(client.hear().await));
    }
    assert!(frames.windows(2).all(|w| w[1].id > w[0].id));
    // One that was begun when the others came, the last, and few of those that were read meanwhile.
    assert!(frames.len() <= 30, "{} of {LAST} were answered", frames.len());
    assert_answers(frames.last().unwrap(), requests.last().unwrap());
    // Nothing comes after the answer to the last.
    let next = moved(&scene.initial, LAST + 1..=LAST + 1);
    client.ask_all(&next).await;
    assert_answers(&solved(client.hear().await), &next[0]);
}

#[tokio::test]
async fn sliders_that_are_faster_than_solves_are_followed_to_where_they_end() {
    let port = serve(&example(ARM)).await;
    let (mut client, scene) = Client::connect(port).await;
    let (mut answered, mut asked) = (Vec::new(), 0);
    // Twenty positions in the time of each answer.
    for _ in 0..10 {
        client.ask_all(&moved(&scene.initial, asked + 1..=asked + 20)).await;
        asked += 20;
        answered.push(solved(client.hear().await));
    }
    while answered.last().is_none_or(|frame| frame.id != asked) {
        answered.push(solved(client.hear().await));
    }
    assert!(answered.windows(2).all(|w| w[1].id > w[0].id));
    assert!(answered.len() < asked as usize / 2, "{} of {asked} were answered", answered.len());
    assert_answers(answered.last().unwrap(), &moved(&scene.initial, asked..=asked)[0]);
}

/// A request that keeps a solve busy for seconds.
fn heavy(initial: &Request) -> Request {
    Request { id: 1, gravity: [1e6, 0.0, 0.0], ..initial.clone() }
}

async fn limited(patience: Duration, deadline: Duration) -> u16 {
    let server = Server::listen(0).await.unwrap().with_limits(Limits { patience, deadline });
    serve_by(server, Viewed::read(&example(ARM), &[]).unwrap())
}

/// A server that waits for no time goes on to the next request at once.
#[tokio::test]
async fn a_solve_that_is_overtaken_ends_and_is_not_answered() {
    let port = limited(Duration::ZERO, Duration::MAX).await;
    let (mut client, scene) = Client::connect(port).await;
    client.ask(&heavy(&scene.initial)).await;
    // Long enough for the solve to begin, and a small part of what it takes.
    tokio::time::sleep(Duration::from_millis(30)).await;
    let next = moved(&scene.initial, 2..=2);
    client.ask_all(&next).await;
    assert_answers(&solved(client.hear().await), &next[0]);
}

#[tokio::test]
async fn a_solve_that_takes_too_long_ends_and_its_answer_says_so() {
    let port = limited(Duration::MAX, Duration::ZERO).await;
    let (mut client, scene) = Client::connect(port).await;
    client.ask(&heavy(&scene.initial)).await;
    let ToPage::Frame(Frame { id: 1, answers, .. }) = client.hear().await else { panic!() };
    let [Answer::Failed { message, .. }] = &answers[..] else { panic!("{answers:?}") };
    assert!(message.contains("the viewer stopped the solve"), "{message}");
}

/// Pages of which each has a solve that takes seconds, more than there are processors: another page is answered meanwhile.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn pages_with_slow_solves_stop_no_other() {
    const SLOW: usize = 20;
    let port = limited(Duration::ZERO, Duration::MAX).await;
    let mut slow = Vec::new();
    for _ in 0..SLOW {
        let (mut client, scene) = Client::connect(port).await;
        client.ask(&heavy(&scene.initial)).await;
        slow.push(client);
    }
    let (mut quick, scene) = Client::connect(port).await;
    let mut times = Vec::new();
    for request in moved(&scene.initial, 2..=11) {
        let begun = std::time::Instant::now();
        quick.ask(&request).await;
        assert_answers(&solved(quick.hear().await), &request);
        times.push(begun.elapsed().as_secs_f64() * 1e3);
    }
    times.sort_by(f64::total_cmp);
    println!("beside {SLOW} slow pages: {:.0} ms median, {:.0} ms at most", times[5], times[9]);
    // The slow ones are still at work: none of them has been answered, or few.
    let mut answered = 0;
    for client in &mut slow {
        let heard = tokio::time::timeout(Duration::from_millis(1), client.hear()).await;
        answered += usize::from(heard.is_ok());
    }
    assert!(answered < SLOW / 2, "{answered} of {SLOW} slow pages were answered first");
}

#[tokio::test]
async fn a_page_begins_with_the_models_that_were_named() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("arm.toml");
    fs::copy(example(ARM), &path).unwrap();
    let [rod, disks] = MODELS.map(ModelPreset::usual);
    let port = serve_with(&path, &[disks, rod, disks]).await;
    let (mut client, scene) = Client::connect(port).await;
    assert_eq!(scene.initial.models, ["cosserat-disks", "cosserat"]);
    fs::write(&path, fs::read_to_string(&path).unwrap() + "\n").unwrap();
    assert_eq!(opened(client.hear().await).initial.models, ["cosserat-disks", "cosserat"]);
    let refused = ModelPreset::usual(ModelKind::ConstantCurvature);
    let error = Viewed::read(&path, &[rod, refused]).unwrap_err();
    assert!(matches!(error, ViewError::Refused { .. }), "{error}");
}

#[tokio::test]
async fn a_file_that_changes_is_told_of() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("arm.toml");
    let text = fs::read_to_string(example("two-segment-arm.toml")).unwrap();
    fs::write(&path, &text).unwrap();
    let port = serve(&path).await;
    let (mut client, scene) = Client::connect(port).await;
    assert_eq!(scene.length, 0.3);
    fs::write(&path, text.replace("300 mm", "300 mn")).unwrap();
    let why = broken(client.hear().await);
    assert!(why.contains("arm.toml:7:") && why.contains("300 mn"), "{why}");
    // The robot that was is still moved.
    client.ask(&scene.initial).await;
    solved(client.hear().await);
    // Editors write another file and move it there.
    let other = folder.path().join("arm.toml.new");
    fs::write(&other, text.replace("300 mm", "310 mm")).unwrap();
    fs::rename(&other, &path).unwrap();
    assert_eq!(opened(client.hear().await).length, 0.31);
}

#[tokio::test]
async fn a_named_file_that_was_missing_is_noticed_when_it_comes_back() {
    let folder = tempfile::tempdir().unwrap();
    let [arm, own] = ["arm.toml", "own.toml"].map(|name| folder.path().join(name));
    let text = fs::read_to_string(example("two-segment-arm.toml")).unwrap();
    fs::write(&arm, &text).unwrap();
    fs::write(&own, "extends = \"arm.toml\"\ntitle = \"own\"\n").unwrap();
    let port = serve(&own).await;
    let (mut client, scene) = Client::connect(port).await;
    assert_eq!((scene.title.as_str(), scene.length), ("own", 0.3));
    for length in ["310 mm", "320 mm"] {
        fs::remove_file(&arm).unwrap();
        let why = broken(client.hear().await);
        assert!(why.contains("arm.toml") && why.contains("no such file"), "{why}");
        fs::write(&arm, text.replace("300 mm", length)).unwrap();
        assert_eq!(format!("{} mm", opened(client.hear().await).length * 1e3), length);
    }
}

#[tokio::test]
async fn a_page_that_comes_while_the_file_is_broken_has_the_robot_that_was() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("arm.toml");
    let text = fs::read_to_string(example("two-segment-arm.toml")).unwrap();
    fs::write(&path, &text).unwrap();
    let port = serve(&path).await;
    let (mut first, _) = Client::connect(port).await;
    fs::write(&path, text.replace("300 mm", "300 mn")).unwrap();
    let why = broken(first.hear().await);

    let (mut second, scene) = Client::connect(port).await;
    assert_eq!((scene.length, broken(second.hear().await)), (0.3, why));
    second.ask(&scene.initial).await;
    solved(second.hear().await);
    fs::write(&path, &text).unwrap();
    for client in [&mut first, &mut second] {
        assert!(matches!(client.hear().await, ToPage::Scene(_)));
    }
}

/// Messages of all kinds that mean nothing: garbage, JSON of other shapes, and requests with a part that is wrong.
fn malformed(valid: &str) -> impl Strategy<Value = Message> + use<> {
    let valid = valid.to_owned();
    let cut = (0..valid.len(), any::<prop::sample::Index>(), any::<char>());
    let spoilt = cut.prop_map(move |(length, at, letter)| {
        let mut text: Vec<char> = valid.chars().take(length).collect();
        if !text.is_empty() {
            let at = at.index(text.len());
            text[at] = letter;
        }
        Message::Text(text.into_iter().collect::<String>().into())
    });
    let json = prop_oneof![
        Just(r#"{"type":"solve"}"#),
        Just(r#"{"type":"nothing"}"#),
        Just(r#"{"type":"solve","id":-1}"#),
        Just(r#"{"type":"solve","id":1e400}"#),
        Just("[[[[[[[[[[]]]]]]]]]]"),
        Just("null"),
        Just("NaN"),
        Just(""),
    ];
    prop_oneof![
        ".{0,200}".prop_map(|text: String| Message::Text(text.into())),
        spoilt,
        json.prop_map(|text| Message::Text(text.into())),
        prop::collection::vec(any::<u8>(), 0..200).prop_map(|bytes| Message::Binary(bytes.into())),
    ]
}

#[tokio::test]
async fn ten_thousand_malformed_messages_are_answered_one_by_one() {
    let port = serve(&example("two-segment-arm.toml")).await;
    let (mut client, scene) = Client::connect(port).await;
    let valid = serde_json::to_string(&crate::protocol::FromPage::Solve(scene.initial.clone()));
    let strategy = malformed(&valid.unwrap());
    let mut runner = TestRunner::deterministic();
    for n in 0..10_000 {
        let message = strategy.new_tree(&mut runner).unwrap().current();
        client.say(message.clone()).await;
        match client.hear().await {
            ToPage::Error { message } => assert!(!message.is_empty()),
            other => panic!("message {n}, {message:?}, is answered by {other:?}"),
        }
    }
    client.ask(&scene.initial).await;
    solved(client.hear().await);
}

#[tokio::test]
async fn a_message_beyond_the_bound_ends_the_connection_and_not_the_server() {
    let port = serve(&example("two-segment-arm.toml")).await;
    let (mut client, scene) = Client::connect(port).await;
    let long = "x".repeat(crate::protocol::MOST_BYTES + 1);
    client.say(Message::Text(long.into())).await;
    client.wait_for_the_end().await;
    let (mut client, _) = Client::connect(port).await;
    client.ask(&scene.initial).await;
    solved(client.hear().await);
}

#[tokio::test]
async fn a_hundred_pages_are_served_at_once() {
    let port = serve(&example("two-segment-arm.toml")).await;
    let mut clients = Vec::new();
    for _ in 0..100 {
        clients.push(Client::connect(port).await);
    }
    for (k, (client, scene)) in clients.iter_mut().enumerate() {
        scene.initial.id = k as u64;
        client.ask(&scene.initial).await;
    }
    for (k, (client, _)) in clients.iter_mut().enumerate() {
        assert_eq!(solved(client.hear().await).id, k as u64);
    }
}
