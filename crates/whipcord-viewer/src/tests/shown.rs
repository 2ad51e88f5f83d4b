//! Several robots, and shapes that another program shows.

use std::time::Duration;

use tokio::sync::watch;

use super::{Client, example, serve_by};
use crate::beside::Beside;
use crate::history::History;
use crate::protocol::{Answer, Shown, ToPage};
use crate::server::{Server, Viewed};

const ARM: &str = "two-segment-arm.toml";

fn shown(time: f64, shape: Option<Answer>) -> Shown {
    Shown { time, shapes: vec![shape], measured: Vec::new() }
}

#[tokio::test]
async fn robots_beside_are_told_of_and_all_pages_hear_what_is_shown() {
    let (tell, heard) = watch::channel(History::default());
    let mut viewed = Viewed::read(&example(ARM), &[]).unwrap();
    viewed.beside = vec![Beside::read(&example("helical-finger.toml")).unwrap()];
    viewed.shown = Some(heard);
    let port = serve_by(Server::listen(0).await.unwrap(), viewed);
    let (mut first, scene) = Client::connect(port).await;
    let ToPage::Beside { number: 1, scene: other, answer } = first.hear().await else { panic!() };
    assert_ne!(other.title, scene.title);
    let Answer::Solved(solved) = &answer else { panic!("{answer:?}") };
    assert_eq!(solved.positions.len(), other.stations.len());

    let next = async |client: &mut Client| match client.hear().await {
        ToPage::Shown(shown) => shown,
        other => panic!("{other:?}"),
    };
    tell.send_modify(|history| history.push(shown(1.0, None)));
    assert_eq!(next(&mut first).await.time, 1.0);
    // Who comes later begins with what was shown before.
    let (mut second, _) = Client::connect(port).await;
    assert!(matches!(second.hear().await, ToPage::Beside { .. }));
    assert_eq!(next(&mut second).await.time, 1.0);
    // The shape of another robot than that of the file is not shown for it.
    let mut solved = solved.clone();
    solved.positions.pop();
    tell.send_modify(|history| history.push(shown(2.0, Some(Answer::Solved(solved)))));
    let last = next(&mut second).await;
    assert_eq!((last.time, last.shapes[0].is_none()), (2.0, true));
    assert_eq!(next(&mut first).await.time, 2.0);
    let (mut third, _) = Client::connect(port).await;
    assert!(matches!(third.hear().await, ToPage::Beside { .. }));
    assert_eq!((next(&mut third).await.time, next(&mut third).await.time), (1.0, 2.0));
    // When the program is gone, pages go on.
    drop(tell);
    tokio::time::sleep(Duration::from_millis(50)).await;
    first.ask(&scene.initial).await;
    assert!(matches!(first.hear().await, ToPage::Frame(_)));
}
