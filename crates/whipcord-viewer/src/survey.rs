//! Surveys of where the tip can go.

use std::sync::Arc;

use whipcord::Cancel;
use whipcord_io::CaseFile;

use crate::background::Tell;
use crate::bench::Bench;
use crate::holes::with_holes;
use crate::inverse;
use crate::protocol::{Request, ToPage};

/// Surveys by the first model of a request, and tells; nothing where it was cancelled.
pub fn survey(file: &Arc<CaseFile>, request: &Request, cancel: &Cancel, tell: &Tell) {
    let id = request.id;
    let found = || {
        let preset = request.presets().ok().and_then(|all| all.first().copied());
        let preset = preset.ok_or_else(|| "no model is chosen".to_owned())?;
        let file = with_holes(file, &request.holes)?;
        let case = Bench::new(Arc::clone(&file)).case(request)?;
        inverse::survey(&file, (preset, &case), id, cancel)
    };
    let message = match found() {
        Ok(Some(cloud)) => ToPage::Cloud(cloud),
        Ok(None) => return,
        Err(message) => ToPage::NoCloud { id, message },
    };
    // A page that has gone hears nothing.
    let _ = tell.blocking_send(message);
}
