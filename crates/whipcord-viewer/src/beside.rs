//! Robots that are shown beside that of the file.

use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

use whipcord_io::{CaseFile, load};

use crate::bench::Bench;
use crate::error::ViewError;
use crate::protocol::{Answer, Scene, ToPage};
use crate::scene::scene;

/// A robot that is shown beside that of the file.
#[derive(Clone, Debug)]
pub struct Beside {
    /// Its file.
    pub file: Arc<CaseFile>,
    scene: Scene,
    answer: Answer,
}

impl Beside {
    /// Reads its file, and solves it by the first model that takes it.
    ///
    /// # Errors
    /// [`ViewError::File`] for a file that cannot be used.
    pub fn read(path: &Path) -> Result<Self, ViewError> {
        let file = Arc::new(load(path)?);
        let scene = scene(&file);
        let solved = Bench::new(Arc::clone(&file)).solve(&scene.initial, Instant::now());
        let answer = solved.ok().and_then(|frame| frame.answers.into_iter().next());
        let answer = answer.unwrap_or_else(|| Answer::Failed {
            model: String::new(),
            message: "no model takes this robot".to_owned(),
        });
        Ok(Self { file, scene, answer })
    }

    /// What pages are told of it, with its number.
    pub fn message(&self, number: usize) -> ToPage {
        let (scene, answer) = (Box::new(self.scene.clone()), self.answer.clone());
        ToPage::Beside { number, scene, answer }
    }
}
