//! A page that moves its sliders at the rate of a display, for a minute.

use std::time::{Duration, Instant};

use tokio::time::{MissedTickBehavior, interval};

use super::{Client, example, serve};
use crate::protocol::{Command, ToPage};

const RATE: u64 = 60;

/// Resident memory of this process in MiB, where the system tells.
fn resident() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmRSS:"))?;
    Some(line.split_whitespace().nth(1)?.parse::<f64>().ok()? / 1024.0)
}

/// Moves all sliders, and returns the times in s from request to frame, and the memory after a tenth and at the end.
async fn move_for(seconds: u64) -> (Vec<f64>, Option<(f64, f64)>) {
    let port = serve(&example("two-segment-arm.toml")).await;
    let (mut client, scene) = Client::connect(port).await;
    let mut request = scene.initial;
    let mut ticks = interval(Duration::from_micros(1_000_000 / RATE));
    ticks.set_missed_tick_behavior(MissedTickBehavior::Delay);
    let last = RATE * seconds;
    let (mut times, mut early) = (Vec::new(), None);
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
        match client.hear().await {
            ToPage::Frame(frame) => assert_eq!(frame.id, id),
            other => panic!("{other:?}"),
        }
        times.push(begun.elapsed().as_secs_f64());
        if id == last / 10 {
            early = resident();
        }
    }
    (times, early.zip(resident()))
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn sliders_that_move_for_a_second_are_followed() {
    let (times, _) = move_for(1).await;
    assert_eq!(times.len() as u64, RATE);
}

/// `cargo test -p whipcord-viewer --release soak -- --ignored --nocapture`
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
#[ignore = "takes a minute"]
async fn sliders_that_move_for_a_minute_are_followed_without_growth_of_memory() {
    let begun = Instant::now();
    let (mut times, memory) = move_for(60).await;
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
}
