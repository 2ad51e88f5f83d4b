//! Holes that the page chooses, and holes that are looked for.

use tokio_tungstenite::tungstenite::Message;
use whipcord::{Case, Model, ModelKind, Robot, Routing, Statics as _, Stations};
use whipcord_io::load;

use crate::protocol::{Answer, Command, DesignRequest, Designed, Frame, FromPage, Request, ToPage};
use crate::tests::{Client, example, serve};

const FILE: &str = "table1/case-3.toml";

/// The robot of the file with other holes, under a tension.
fn places(holes: &[usize], tension: f64) -> Vec<[f64; 3]> {
    let file = load(example(FILE)).unwrap();
    let mut cables = file.robot.cables().to_vec();
    cables[0].routing = Routing::holes(holes.to_vec());
    let robot =
        Robot::new(file.robot.backbone().clone(), file.robot.disks().clone(), cables).unwrap();
    let model = Model::new(ModelKind::CosseratDisks, Stations::Disks, Default::default());
    let case = Case { commands: Case::with_tensions(&[tension]).commands, ..file.case };
    let solution = model.solve(&robot, &case).unwrap();
    solution.disks.poses.iter().map(|pose| pose.position.to_array()).collect()
}

async fn frame(client: &mut Client, request: &Request) -> Frame {
    client.ask(request).await;
    match client.hear().await {
        ToPage::Frame(frame) => frame,
        other => panic!("{other:?}"),
    }
}

#[tokio::test]
async fn chosen_holes_are_solved_and_those_of_the_file_come_back() {
    let (mut client, scene) = Client::connect(serve(&example(FILE)).await).await;
    let list = vec![1, 2, 3, 4, 5, 6, 6, 6, 6, 6];
    let own = scene.cables[0].holes.clone().unwrap();
    assert_eq!(own.len(), 10);
    let Command::Tension(tension) = scene.initial.commands[0] else { panic!() };
    let models = vec!["cosserat-disks".to_owned()];
    let usual = Request { id: 1, models, ..scene.initial.clone() };
    let chosen = Request { id: 2, holes: vec![Some(list.clone())], ..usual.clone() };
    for (request, holes) in [(&usual, &own), (&chosen, &list), (&usual, &own)] {
        let frame = frame(&mut client, request).await;
        let Answer::Solved(solved) = &frame.answers[0] else { panic!("{:?}", frame.answers) };
        let expected = places(holes, tension)[9];
        let found = solved.positions.last().unwrap();
        assert!((0..3).all(|c| (found[c] - expected[c]).abs() < 1e-6), "{found:?} {expected:?}");
        // Only where they are others the page is told where the cables run.
        let told = frame.cables.map(|cables| cables[0].holes.clone().unwrap());
        assert_eq!(told, (holes != &own).then(|| holes.clone()));
    }
    // What no robot can have is an answer with the reason, and a later request has its own.
    for holes in [vec![Some(vec![99; 10])], vec![Some(vec![1; 11])], vec![None, Some(vec![1])]] {
        let frame = frame(&mut client, &Request { holes, ..chosen.clone() }).await;
        assert!(matches!(&frame.answers[0], Answer::Failed { message, .. } if !message.is_empty()));
    }
    let frame = frame(&mut client, &usual).await;
    assert!(matches!(frame.answers[0], Answer::Solved(_)));
}

#[tokio::test]
async fn planted_holes_are_found_for_places_that_the_page_gives() {
    let (mut client, scene) = Client::connect(serve(&example(FILE)).await).await;
    let list = vec![2, 3, 4, 4, 5, 5, 6, 7, 7, 7];
    let Command::Tension(tension) = scene.initial.commands[0] else { panic!() };
    let asked = DesignRequest {
        request: Request { id: 4, ..scene.initial.clone() },
        cable: 0,
        tension: false,
        places: places(&list, tension)[1..].to_vec(),
    };
    let say = |asked: &DesignRequest| {
        let message = FromPage::Design(asked.clone());
        Message::Text(serde_json::to_string(&message).unwrap().into())
    };
    client.say(say(&asked)).await;
    let ToPage::Designed(Designed { id, holes, error, proven, commands, .. }) = client.hear().await
    else {
        panic!()
    };
    assert_eq!((id, &holes, proven), (4, &list, true));
    assert!(error < 1e-6 && commands == scene.initial.commands);
    // Places for other disks than there are.
    client.say(say(&DesignRequest { places: vec![[0.0; 3]], ..asked })).await;
    assert!(matches!(client.hear().await, ToPage::NoDesign { id: 4, .. }));
}
