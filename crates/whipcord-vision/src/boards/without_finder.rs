//! A build that finds no boards: there are none.

use super::{Board, BoardError, SeenBoard, Unseen};
use crate::photo::Photo;

pub(super) const DICTIONARIES: &[&str] = &[];

/// No board has one, so that there is no board.
#[derive(Clone, Copy, Debug)]
pub(super) enum Finder {}

impl Finder {
    pub(super) const fn built() -> Result<Self, BoardError> {
        Err(BoardError::NotBuilt)
    }
}

/// No board has any.
#[derive(Clone, Copy, Debug)]
pub(super) enum Markers {}

impl Markers {
    pub(super) const fn new(_: [usize; 2], _: f64, _: &str) -> Result<Self, BoardError> {
        Err(BoardError::NotBuilt)
    }

    pub(super) const fn squares(&self) -> [usize; 2] {
        match *self {}
    }

    pub(super) const fn dictionary(&self) -> &'static str {
        match *self {}
    }

    pub(super) const fn relative_side(&self) -> f64 {
        match *self {}
    }

    pub(super) const fn code(&self, _: usize) -> Option<(u64, usize)> {
        match *self {}
    }
}

/// What is seen of a board in a photograph: there is no board to look for.
///
/// # Errors
/// None is returned.
pub const fn find(_: &Photo, board: &Board) -> Result<SeenBoard, Unseen> {
    match board.finder {}
}
