//! One page: its requests, and their answers.
//!
//! A request waits in a place that holds one. A newer one takes that place, so that a solver that is slower than the
//! sliders always solves for where they are, never for where they were. A page has one solve at a time, in a thread of its own:
//! the operating system shares the processors among the pages, and none waits for the solves of another.

use std::sync::Arc;
use std::time::{Duration, Instant};

use axum::extract::ws::{Message, WebSocket};
use futures_util::{SinkExt as _, StreamExt as _};
use tokio::sync::{mpsc, oneshot, watch};
use whipcord::Cancel;

use crate::background::of_latest;
use crate::bench::Bench;
use crate::beside::Beside;
use crate::design::design;
use crate::history::History;
use crate::opened::{Opened, Usable};
use crate::play::play;
use crate::protocol::{
    self, Answer, DesignRequest, FromPage, Malformed, PlayRequest, Request, Shown, ToPage,
};
use crate::survey::survey;

/// Messages that wait to be sent to a page that is slow to take them.
const WAITING: usize = 4;

/// What another program shows: pages that are slow to take it miss some.
pub type Shows = watch::Receiver<History>;

/// What all pages share.
#[derive(Clone, Debug)]
pub struct Shared {
    /// The robot file as it is now.
    pub opened: watch::Receiver<Opened>,
    /// Robots that are shown beside its own.
    pub beside: Arc<[Beside]>,
    /// What another program shows.
    pub shown: Option<Shows>,
    /// How long solves may take.
    pub limits: Limits,
}

/// How long the solve of a request may take.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// That a newer request has overtaken: while a slider moves, shapes that do not take longer are shown.
    pub patience: Duration,
    /// Of any request: it then has an answer that says so.
    pub deadline: Duration,
}

/// A request and when it came.
type Arrived = (Arc<Request>, Instant);

/// Serves one page until it goes.
pub async fn serve(socket: WebSocket, shared: Shared) {
    let (mut out, mut incoming) = socket.split();
    let (send, mut messages) = mpsc::channel::<ToPage>(WAITING);
    let (ask, latest) = watch::channel::<Option<Arrived>>(None);
    let (ask_survey, latest_survey) = watch::channel::<Option<Arc<Request>>>(None);
    let (ask_play, latest_play) = watch::channel::<Option<Arc<PlayRequest>>>(None);
    let (ask_design, latest_design) = watch::channel::<Option<Arc<DesignRequest>>>(None);
    let writer = async move {
        while let Some(message) = messages.recv().await {
            // What is sent has been checked to hold numbers only, which is all that could fail.
            let Ok(text) = serde_json::to_string(&message) else { continue };
            if out.send(Message::Text(text.into())).await.is_err() {
                break;
            }
        }
    };
    let surveyor = of_latest(shared.opened.clone(), latest_survey, send.clone(), survey);
    let player = of_latest(shared.opened.clone(), latest_play, send.clone(), play);
    let designer = of_latest(shared.opened.clone(), latest_design, send.clone(), design);
    let (tell_begun, begun) = oneshot::channel();
    let shower = show(shared.shown.clone(), shared.opened.clone(), begun, send.clone());
    let solver = solve(shared, latest, tell_begun, send.clone());
    let reader = async move {
        while let Some(Ok(message)) = incoming.next().await {
            let read = match message {
                Message::Text(text) => protocol::read(&text),
                Message::Binary(bytes) => Err(Malformed::NotText { bytes: bytes.len() }),
                Message::Close(_) => break,
                Message::Ping(_) | Message::Pong(_) => continue,
            };
            match read {
                Ok(FromPage::Solve(request)) => {
                    ask.send_replace(Some((Arc::new(request), Instant::now())));
                }
                Ok(FromPage::Survey(request)) => {
                    ask_survey.send_replace(Some(Arc::new(request)));
                }
                Ok(FromPage::EndSurvey) => {
                    ask_survey.send_replace(None);
                }
                Ok(FromPage::Play(request)) => {
                    ask_play.send_replace(Some(Arc::new(request)));
                }
                Ok(FromPage::EndPlay) => {
                    ask_play.send_replace(None);
                }
                Ok(FromPage::Design(request)) => {
                    ask_design.send_replace(Some(Arc::new(request)));
                }
                Ok(FromPage::EndDesign) => {
                    ask_design.send_replace(None);
                }
                Err(error) => {
                    if send.send(ToPage::Error { message: error.to_string() }).await.is_err() {
                        break;
                    }
                }
            }
        }
    };
    tokio::select! {
        () = writer => {}
        () = solver => {}
        () = surveyor => {}
        () = player => {}
        () = shower => {}
        () = designer => {}
        () = reader => {}
    }
}

/// Tells the page of what another program shows, until the page goes.
async fn show(
    shown: Option<Shows>,
    opened: watch::Receiver<Opened>,
    begun: oneshot::Receiver<()>,
    send: mpsc::Sender<ToPage>,
) {
    if let Some(mut shown) = shown
        && begun.await.is_ok()
    {
        // A page that is opened later begins with what was shown before; from then on a slow one passes over what it has no time for.
        let mut new = shown.borrow_and_update().all();
        loop {
            for each in new {
                if send.send(ToPage::Shown(fitting(&each, &opened))).await.is_err() {
                    return;
                }
            }
            if shown.changed().await.is_err() {
                break;
            }
            new = shown.borrow_and_update().latest().into_iter().collect();
        }
    }
    std::future::pending().await
}

/// What is shown, without a shape of another robot: the file may have changed since the stream began.
fn fitting(shown: &Shown, opened: &watch::Receiver<Opened>) -> Shown {
    let mut shown = shown.clone();
    let stations = opened.borrow().usable.scene.stations.len();
    if let Some(first) = shown.shapes.first_mut()
        && matches!(first, Some(Answer::Solved(solved)) if solved.positions.len() != stations)
    {
        *first = None;
    }
    shown
}

/// Ends a solve when it is dropped.
struct Guard(Cancel);

impl Drop for Guard {
    fn drop(&mut self) {
        self.0.cancel();
    }
}

/// Waits until there is a newer request that has waited for `patience`.
async fn superseded(mut latest: watch::Receiver<Option<Arrived>>, patience: Duration) {
    // A page that has gone wants no answer either.
    if latest.changed().await.is_ok() {
        tokio::time::sleep(patience).await;
    }
}

/// Tells the page of the file, and answers the latest of its requests.
async fn solve(
    shared: Shared,
    mut latest: watch::Receiver<Option<Arrived>>,
    begun: oneshot::Sender<()>,
    send: mpsc::Sender<ToPage>,
) {
    let mut begun = Some(begun);
    let Shared { mut opened, beside, limits, .. } = shared;
    let (mut bench, mut known): (Option<Bench>, Option<Arc<Usable>>) = (None, None);
    opened.mark_changed();
    loop {
        tokio::select! {
            biased;
            changed = opened.changed() => {
                if changed.is_err() {
                    return;
                }
                let Opened { usable, broken } = opened.borrow_and_update().clone();
                // The robot that last could be used is told of once, and can be moved whatever is wrong with the file since.
                let is_known = known.as_ref().is_some_and(|known| Arc::ptr_eq(known, &usable));
                if !is_known {
                    bench = Some(Bench::sharing(Arc::clone(&usable.file), Arc::clone(&usable.stock)));
                    let scene = ToPage::Scene(Box::new(usable.scene.clone()));
                    known = Some(usable);
                    if send.send(scene).await.is_err() {
                        return;
                    }
                    for (k, other) in beside.iter().enumerate() {
                        if send.send(other.message(k + 1)).await.is_err() {
                            return;
                        }
                    }
                    if let Some(begun) = begun.take() {
                        let _ = begun.send(());
                    }
                }
                if let Some(why) = broken
                    && send.send(ToPage::Broken { message: why.to_string() }).await.is_err()
                {
                    return;
                }
            }
            changed = latest.changed() => {
                if changed.is_err() {
                    return;
                }
                let Some((request, arrival)) = latest.borrow_and_update().clone() else { continue };
                let Some(mut at_work) = bench.take() else { continue };
                let cancel = Cancel::new();
                at_work.cancelled_by(&cancel, limits.deadline);
                // When the page goes, this is dropped, and the solve ends.
                let guard = Guard(cancel.clone());
                let mut solved = tokio::task::spawn_blocking(move || {
                    let frame = at_work.solve(&request, arrival);
                    (at_work, frame)
                });
                // A solve that panics costs this page its connection, and no other.
                let (outcome, is_overtaken) = tokio::select! {
                    outcome = &mut solved => (outcome, false),
                    () = superseded(latest.clone(), limits.patience) => {
                        cancel.cancel();
                        (solved.await, true)
                    }
                    () = tokio::time::sleep(limits.deadline) => {
                        cancel.cancel();
                        (solved.await, false)
                    }
                };
                drop(guard);
                let Ok((back, frame)) = outcome else { return };
                bench = Some(back);
                if is_overtaken {
                    continue;
                }
                let message = match frame {
                    Ok(frame) => ToPage::Frame(frame),
                    Err(error) => ToPage::Error { message: error.to_string() },
                };
                if send.send(message).await.is_err() {
                    return;
                }
            }
        }
    }
}
