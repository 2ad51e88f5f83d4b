//! Long work beside the solves of a page, in a thread of its own: each page has one of each kind at most.

use std::sync::Arc;

use tokio::sync::{mpsc, watch};
use whipcord::Cancel;
use whipcord_io::CaseFile;

use crate::opened::Opened;
use crate::protocol::ToPage;

/// What the page is told meanwhile.
pub type Tell = mpsc::Sender<ToPage>;

/// Does `work` for the latest request; `None` ends what goes on, and so does a newer request.
pub async fn of_latest<R: Send + Sync + 'static>(
    opened: watch::Receiver<Opened>,
    mut latest: watch::Receiver<Option<Arc<R>>>,
    tell: Tell,
    work: fn(&Arc<CaseFile>, &R, &Cancel, &Tell),
) {
    while latest.changed().await.is_ok() {
        loop {
            let Some(request) = latest.borrow_and_update().clone() else { break };
            let file = Arc::clone(&opened.borrow().usable.file);
            let guard = Guard(Cancel::new());
            let (cancel, tell) = (guard.0.clone(), tell.clone());
            let mut working =
                tokio::task::spawn_blocking(move || work(&file, &request, &cancel, &tell));
            tokio::select! {
                outcome = &mut working => {
                    // Work that panics costs this page its connection, and no other.
                    if outcome.is_err() {
                        return;
                    }
                    break;
                }
                changed = latest.changed() => {
                    drop(guard);
                    let _ = working.await;
                    if changed.is_err() {
                        return;
                    }
                }
            }
        }
    }
}

/// Ends the work when it is dropped, as when its page goes.
struct Guard(Cancel);

impl Drop for Guard {
    fn drop(&mut self) {
        self.0.cancel();
    }
}
