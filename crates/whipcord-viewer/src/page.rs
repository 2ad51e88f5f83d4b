//! The page, as it was built into this binary.

use crate::error::ViewError;

/// The files of the page.
#[derive(Clone, Copy, Debug)]
pub struct Page {
    /// The page itself.
    pub html: &'static str,
    /// Its script.
    pub script: &'static str,
    /// Its style sheet.
    pub style: &'static str,
}

/// None where the page was not built before this crate.
const PAGE: Option<Page> = include!(concat!(env!("OUT_DIR"), "/page.rs"));

/// The page.
///
/// # Errors
/// [`ViewError::NoPage`] where this binary was built without.
pub fn page() -> Result<Page, ViewError> {
    PAGE.ok_or(ViewError::NoPage)
}
