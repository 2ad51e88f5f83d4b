//! Surveys of where the tip can go: each page has one at most, in a thread beside that of its solves.

use std::sync::Arc;

use tokio::sync::{mpsc, watch};
use whipcord::Cancel;

use crate::bench::Bench;
use crate::inverse;
use crate::opened::Opened;
use crate::protocol::{Request, ToPage};

/// Answers the latest request for a survey; `None` ends the one that goes on, and so does a newer request.
pub async fn surveys(
    opened: watch::Receiver<Opened>,
    mut latest: watch::Receiver<Option<Arc<Request>>>,
    send: mpsc::Sender<ToPage>,
) {
    while latest.changed().await.is_ok() {
        loop {
            let Some(request) = latest.borrow_and_update().clone() else { break };
            let file = Arc::clone(&opened.borrow().usable.file);
            let guard = Guard(Cancel::new());
            let cancel = guard.0.clone();
            let id = request.id;
            let mut work = tokio::task::spawn_blocking(move || {
                let preset = request.presets().ok().and_then(|all| all.first().copied());
                let preset = preset.ok_or_else(|| "no model is chosen".to_owned())?;
                let case = Bench::new(Arc::clone(&file)).case(&request)?;
                inverse::survey(&file, (preset, &case), id, &cancel)
            });
            let outcome = tokio::select! {
                outcome = &mut work => Some(outcome),
                changed = latest.changed() => {
                    drop(guard);
                    let _ = work.await;
                    if changed.is_err() {
                        return;
                    }
                    None
                }
            };
            // A newer request, or none any more.
            let Some(outcome) = outcome else { continue };
            // A survey that panics costs this page its connection, and no other.
            let Ok(found) = outcome else { return };
            let message = match found {
                Ok(Some(cloud)) => ToPage::Cloud(cloud),
                Ok(None) => break,
                Err(message) => ToPage::NoCloud { id, message },
            };
            if send.send(message).await.is_err() {
                return;
            }
            break;
        }
    }
}

/// Ends a survey when it is dropped, as when its page goes.
struct Guard(Cancel);

impl Drop for Guard {
    fn drop(&mut self) {
        self.0.cancel();
    }
}
