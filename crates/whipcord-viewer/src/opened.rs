//! The robot file as it is now on disk.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, SystemTime};

use tokio::sync::watch;
use whipcord_io::{CaseFile, FileError, load, render};

use crate::protocol::Scene;
use crate::scene::scene;

/// How often the file is looked at. Editors replace files, write them in pieces, and keep them on disks that tell
/// of no change: looking is what always works.
const EVERY: Duration = Duration::from_millis(200);

/// A robot file, or what is wrong with it.
#[derive(Clone, Debug)]
pub enum Opened {
    /// It can be used.
    Usable(Arc<Usable>),
    /// It cannot: what the command line would print.
    Broken(Arc<str>),
}

/// A robot file, and what the page is told of it.
#[derive(Debug)]
pub struct Usable {
    /// The file.
    pub file: Arc<CaseFile>,
    /// What the page is told.
    pub scene: Scene,
}

impl Opened {
    /// Reads the file.
    ///
    /// # Errors
    /// [`FileError`] with all that is wrong with it.
    pub fn read(path: &Path) -> Result<(Self, Watched), FileError> {
        let file = load(path)?;
        let watched = Watched::new(file.files().map(Path::to_owned).collect());
        let file = Arc::new(file);
        let scene = scene(&file);
        Ok((Self::Usable(Arc::new(Usable { file, scene })), watched))
    }

    fn broken(error: &FileError, path: &Path) -> (Self, Watched) {
        let named = error.sources.files().iter().map(|source| source.path.clone());
        let mut files: Vec<PathBuf> = named.collect();
        if files.is_empty() {
            files.push(path.to_owned());
        }
        let message = render(error, false).trim_end().to_owned();
        (Self::Broken(message.into()), Watched::new(files))
    }
}

/// The files that a robot file was read from, as they were then.
#[derive(Debug)]
pub struct Watched {
    files: Vec<PathBuf>,
    stamps: Vec<Stamp>,
}

/// What tells one state of a file from another; none where there is no such file.
type Stamp = Option<(SystemTime, u64)>;

impl Watched {
    fn new(files: Vec<PathBuf>) -> Self {
        let stamps = files.iter().map(|file| stamp(file)).collect();
        Self { files, stamps }
    }

    fn has_changed(&self) -> bool {
        self.files.iter().zip(&self.stamps).any(|(file, before)| stamp(file) != *before)
    }
}

fn stamp(file: &Path) -> Stamp {
    let metadata = fs::metadata(file).ok()?;
    Some((metadata.modified().ok()?, metadata.len()))
}

/// Reads the file again whenever it changes, and tells.
pub async fn follow(path: PathBuf, mut watched: Watched, tell: watch::Sender<Opened>) {
    let mut ticks = tokio::time::interval(EVERY);
    ticks.set_missed_tick_behavior(tokio::time::MissedTickBehavior::Delay);
    loop {
        ticks.tick().await;
        if !watched.has_changed() {
            continue;
        }
        let path = path.clone();
        let read = move || match Opened::read(&path) {
            Ok(opened) => opened,
            Err(error) => Opened::broken(&error, &path),
        };
        // Only a panic ends the task without a result; the file then stays as it was last read.
        let Ok((opened, now)) = tokio::task::spawn_blocking(read).await else { continue };
        watched = now;
        tell.send_replace(opened);
    }
}
