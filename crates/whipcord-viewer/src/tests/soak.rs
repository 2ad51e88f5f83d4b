//! A page that moves its sliders at the rate of a display, for a minute.

use std::time::{Duration, Instant};

use tokio::time::{MissedTickBehavior, interval};
use whipcord::{ModelKind, Vec3};

use super::{Client, example, serve, tip};
use crate::protocol::{Answer, Command, Frame, Request, ToPage};

const ARM: &str = "two-segment-arm.toml";
const RATE: u64 = 60;

/// Resident memory of this process in MiB, where the system tells.
fn resident() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmRSS:"))?;
    Some(line.split_whitespace().nth(1)?.parse::<f64>().ok()? / 1024.0)
}

/// Opens so many pages, each of which solves by two models and surveys, and closes them all.
async fn pages_come_and_go(port: u16, count: usize) {
    let mut pages = Vec::new();
    for _ in 0..count {
        let (mut client, scene) = Client::connect(port).await;
        let models = ["cosserat", "cosserat-disks"].map(str::to_owned).to_vec();
        let request = Request { id: 1, models, compliance: true, ..scene.initial };
        client.ask(&request).await;
        assert!(matches!(client.hear().await, ToPage::Frame(_)));
        pages.push(client);
    }
}

/// Memory in MiB before pages come, with all of them open, and when they have gone.
async fn memory_of_pages(count: usize) -> Option<[f64; 3]> {
    let port = serve(&example(ARM)).await;
    // What the first page has made once for all.
    pages_come_and_go(port, 2).await;
    let before = resident()?;
    pages_come_and_go(port, count).await;
    let most = resident()?;
    // The server has noticed that they have gone.
    tokio::time::sleep(Duration::from_secs(1)).await;
    Some([before, most, resident()?])
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn memory_returns_when_pages_have_gone() {
    let Some([before, most, after]) = memory_of_pages(40).await else { return };
    println!("{before:.1} MiB, with 40 pages {most:.1} MiB, then {after:.1} MiB");
    assert!(after - before < 30.0, "{before:.1} MiB, then {after:.1} MiB");
}

/// What became of sliders that were moved.
struct Moved {
    /// From request to frame, in s.
    times: Vec<f64>,
    /// In MiB, after a tenth and at the end.
    memory: Option<(f64, f64)>,
    /// Some requests, and where their frames had the tip.
    tips: Vec<(Request, Vec3)>,
}

/// Moves all sliders.
async fn move_for(seconds: u64) -> Moved {
    let port = serve(&example(ARM)).await;
    let (mut client, scene) = Client::connect(port).await;
    let mut request = scene.initial;
    let mut ticks = interval(Duration::from_micros(1_000_000 / RATE));
    ticks.set_missed_tick_behavior(MissedTickBehavior::Delay);
    let last = RATE * seconds;
    let (mut times, mut early, mut tips) = (Vec::new(), None, Vec::new());
    for id in 1..=last {
        ticks.tick().await;
        request.id = id;
        for (k, command) in request.commands.iter_mut().enumerate() {
            let phase = id as f64 / RATE as f64 * (1.0 + 0.3 * k as f64);
            *command = Command::Tension(8.0 + 7.0 * phase.sin());
        }
        request.tip_force[0] = 0.2 * (id as f64 / RATE as f64).cos();
        let begun = Instant::now();
        client.ask(&request).await;
        let heard = client.hear().await;
        times.push(begun.elapsed().as_secs_f64());
        let ToPage::Frame(Frame { id: answered, answers, .. }) = heard else { panic!("{heard:?}") };
        let [Answer::Solved(solved)] = &answers[..] else { panic!("{answers:?}") };
        assert_eq!(answered, id);
        if id % (last / 5) == 0 {
            tips.push((request.clone(), (*solved.positions.last().unwrap()).into()));
        }
        if id == last / 10 {
            early = resident();
        }
    }
    Moved { times, memory: early.zip(resident()), tips }
}

/// Each tip is that of a solve of its request alone, and none is that of another.
fn assert_follow(tips: &[(Request, Vec3)]) {
    assert_eq!(tips.len(), 5);
    for (k, (request, found)) in tips.iter().enumerate() {
        let expected = tip(ARM, ModelKind::Cosserat, request);
        assert!((*found - expected).norm() < 1e-6, "{found:?} {expected:?}");
        assert!(tips[..k].iter().all(|(_, other)| (*other - expected).norm() > 1e-3));
    }
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn sliders_that_move_for_a_second_are_followed() {
    assert_follow(&move_for(1).await.tips);
}

/// `cargo test -p whipcord-viewer --release soak -- --ignored --nocapture`
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
#[ignore = "takes a minute, and is about times: of an optimised build on a machine that does nothing else"]
async fn sliders_that_move_for_a_minute_are_followed_without_growth_of_memory() {
    let begun = Instant::now();
    let Moved { mut times, memory, tips } = move_for(60).await;
    let rate = times.len() as f64 / begun.elapsed().as_secs_f64();
    times.sort_by(f64::total_cmp);
    let at = |share: f64| times[(share * (times.len() - 1) as f64) as usize] * 1e3;
    println!(
        "{} frames, {rate:.1} a second; from request to frame {:.2} ms at the median, {:.2} ms for 99 of 100, {:.2} ms at most",
        times.len(),
        at(0.5),
        at(0.99),
        at(1.0)
    );
    if let Some((early, late)) = memory {
        println!("memory {early:.1} MiB after 6 s, {late:.1} MiB at the end");
        assert!(late - early < 4.0, "{early} MiB, then {late} MiB");
    }
    assert_follow(&tips);
    assert!(rate >= 55.0 && at(0.5) < 2.0, "{rate} a second, {} ms", at(0.5));
}
