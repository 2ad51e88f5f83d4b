//! The robot file as it is now on disk.

use std::fs;
use std::hash::{DefaultHasher, Hasher as _};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, SystemTime};

use tokio::sync::watch;
use whipcord::ModelPreset;
use whipcord_io::{CaseFile, FileError, load, render};

use crate::error::ViewError;
use crate::protocol::Scene;
use crate::scene::{begin_with, scene};
use crate::stock::Stock;

/// How often the file is looked at. Editors replace files, write them in pieces, and keep them on disks that tell
/// of no change: looking is what always works.
const EVERY: Duration = Duration::from_millis(200);

/// A robot file as it last could be used, and what is wrong with it since.
#[derive(Clone, Debug)]
pub struct Opened {
    /// The robot that can be moved.
    pub usable: Arc<Usable>,
    /// Why the file as it now is cannot be used, where it cannot: what the command line would print.
    pub broken: Option<Arc<str>>,
}

/// A robot file, and what the page is told of it.
#[derive(Debug)]
pub struct Usable {
    /// The file.
    pub file: Arc<CaseFile>,
    /// What the page is told.
    pub scene: Scene,
    /// Its models, for all pages.
    pub stock: Arc<Stock>,
}

impl Opened {
    /// Reads the file. A page begins with these models, or with the first that takes the robot.
    ///
    /// # Errors
    /// [`ViewError::File`] with all that is wrong with it, [`ViewError::Refused`] for a model that does not take the robot.
    pub fn read(path: &Path, models: &[ModelPreset]) -> Result<(Self, Watched), ViewError> {
        let (read, watched) = read(path, vec![path.to_owned()]);
        let mut usable = read?;
        begin_with(&mut usable.scene, models)?;
        Ok((Self { usable: Arc::new(usable), broken: None }, watched))
    }
}

/// Reads the file, while it and `known` are watched. A file that cannot be used is mended by a change of any of them,
/// or of one that it names and that is not there.
fn read(path: &Path, known: Vec<PathBuf>) -> (Result<Usable, FileError>, Watched) {
    let (loaded, mut watched) = Watched::during(known, || {
        let loaded = load(path);
        let named = match &loaded {
            Ok(file) => file.files().map(Path::to_owned).collect(),
            Err(error) => error.sources.files().iter().map(|s| s.path.clone()).collect(),
        };
        (loaded, named)
    });
    let usable = loaded.map(|file| {
        watched.keep(|watched| file.files().any(|path| path == watched));
        let file = Arc::new(file);
        let scene = scene(&file);
        Usable { file, scene, stock: Arc::default() }
    });
    (usable, watched)
}

/// Files as they were when they were read.
#[derive(Debug)]
pub struct Watched(Vec<(PathBuf, Option<Stamp>)>);

/// What tells one state of a file from another.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
struct Stamp {
    modified: SystemTime,
    bytes: u64,
    /// A hash of the contents, where the file was changed so shortly before it was looked at that another change may have
    /// the same time.
    contents: Option<u64>,
}

/// The coarsest clock of a file system: files that are changed twice within it may be of the same time.
const COARSEST: Duration = Duration::from_secs(2);

impl Stamp {
    /// The file as it is now, with its contents where it was changed recently or where that is asked for; none where there
    /// is no such file.
    fn of(file: &Path, with_contents: bool) -> Option<Self> {
        let metadata = fs::metadata(file).ok()?;
        let (modified, bytes) = (metadata.modified().ok()?, metadata.len());
        let wanted = with_contents || is_recent(modified);
        let contents = if wanted { hash_of_contents(file) } else { None };
        Some(Self { modified, bytes, contents })
    }
}

/// Whether a change at this time may be followed by another of the same time. A time to come counts as well: clocks are
/// set back, and those of other machines differ.
fn is_recent(modified: SystemTime) -> bool {
    modified.elapsed().map_or(true, |since| since < COARSEST)
}

fn hash_of_contents(file: &Path) -> Option<u64> {
    let mut hasher = DefaultHasher::new();
    hasher.write(&fs::read(file).ok()?);
    Some(hasher.finish())
}

impl Watched {
    /// What `read` gives, and the files that it names beside those that are known, as they were before it: what is saved
    /// meanwhile is a change. So it reads again when it names a file that was not looked at before.
    fn during<T>(
        mut known: Vec<PathBuf>,
        mut read: impl FnMut() -> (T, Vec<PathBuf>),
    ) -> (T, Self) {
        loop {
            let before = known.iter().map(|file| Stamp::of(file, false)).collect::<Vec<_>>();
            let (found, mut named) = read();
            named.retain(|file| !known.contains(file));
            if named.is_empty() {
                return (found, Self(known.into_iter().zip(before).collect()));
            }
            known.append(&mut named);
        }
    }

    fn keep(&mut self, wanted: impl Fn(&Path) -> bool) {
        self.0.retain(|(file, _)| wanted(file));
    }

    fn files(&self) -> Vec<PathBuf> {
        self.0.iter().map(|(file, _)| file.clone()).collect()
    }

    /// Takes the files as they are now for those that were read.
    fn stamp_anew(&mut self) {
        for (file, before) in &mut self.0 {
            *before = Stamp::of(file, false);
        }
    }

    /// Whether a file is not as it was. Contents are compared as long as another change may have the same time, and once
    /// after that.
    fn has_changed(&mut self) -> bool {
        self.0.iter_mut().any(|(file, before)| {
            let compared = before.is_some_and(|before| before.contents.is_some());
            // Asked before the contents are read: what is written after that has a later time.
            let is_old = before.is_some_and(|before| !is_recent(before.modified));
            let now = Stamp::of(file, compared);
            if now != *before {
                return true;
            }
            if is_old && let Some(before) = before {
                before.contents = None;
            }
            false
        })
    }
}

/// Reads the file again whenever it changes, and tells.
pub async fn follow(
    path: PathBuf,
    models: Vec<ModelPreset>,
    mut watched: Watched,
    tell: watch::Sender<Opened>,
) {
    let mut ticks = tokio::time::interval(EVERY);
    ticks.set_missed_tick_behavior(tokio::time::MissedTickBehavior::Delay);
    loop {
        ticks.tick().await;
        if !watched.has_changed() {
            continue;
        }
        let (path, known) = (path.clone(), watched.files());
        // Only a panic ends the task without a result: this state of the file is passed over.
        watched.stamp_anew();
        let reading = tokio::task::spawn_blocking(move || read(&path, known));
        let Ok((read, now)) = reading.await else { continue };
        watched = now;
        tell.send_modify(|opened| match read {
            Ok(mut usable) => {
                // The robot may have become one that a model does not take: then the page begins with the first that does.
                let _ = begin_with(&mut usable.scene, &models);
                *opened = Opened { usable: Arc::new(usable), broken: None };
            }
            Err(error) => opened.broken = Some(render(&error, false).trim_end().into()),
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_saved_while_a_file_is_read_is_a_change() {
        let folder = tempfile::tempdir().unwrap();
        let [first, second] = ["a.toml", "b.toml"].map(|name| folder.path().join(name));
        fs::write(&first, "one").unwrap();
        let mut readings = 0;
        let ((), mut watched) = Watched::during(vec![first.clone()], || {
            readings += 1;
            ((), vec![first.clone(), second.clone()])
        });
        // The second file was known only after the first reading.
        assert_eq!((readings, watched.files()), (2, vec![first.clone(), second.clone()]));
        assert!(!watched.has_changed());
        fs::write(&second, "").unwrap();
        assert!(watched.has_changed());

        let ((), mut watched) = Watched::during(watched.files(), || {
            fs::write(&first, "longer").unwrap();
            ((), vec![first.clone()])
        });
        assert!(watched.has_changed());
    }

    /// Sets the time of a file's change.
    fn date(file: &Path, modified: SystemTime) {
        fs::File::options().write(true).open(file).unwrap().set_modified(modified).unwrap();
    }

    #[test]
    fn a_change_of_the_same_time_and_length_is_noticed() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("arm.toml");
        for apart in [Duration::ZERO, Duration::from_secs(1)] {
            let time = SystemTime::now() - apart;
            fs::write(&file, "300 mm").unwrap();
            date(&file, time);
            let ((), mut watched) = Watched::during(vec![file.clone()], || ((), vec![]));
            assert!(!watched.has_changed());
            fs::write(&file, "300 mn").unwrap();
            date(&file, time);
            assert!(watched.has_changed());
            watched.stamp_anew();
            assert!(!watched.has_changed());
        }
    }

    #[test]
    fn a_file_of_long_ago_is_told_by_its_time_and_length_alone() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("arm.toml");
        fs::write(&file, "300 mm").unwrap();
        let time = SystemTime::now() - 2 * COARSEST;
        date(&file, time);
        let ((), watched) = Watched::during(vec![file.clone()], || ((), vec![]));
        assert_eq!(watched.0[0].1.map(|stamp| stamp.contents), Some(None));

        // One that was of now is looked into once more when it has become old.
        date(&file, SystemTime::now());
        let ((), mut watched) = Watched::during(vec![file.clone()], || ((), vec![]));
        assert!(watched.0[0].1.is_some_and(|stamp| stamp.contents.is_some()));
        date(&file, time);
        if let Some(stamp) = &mut watched.0[0].1 {
            stamp.modified = time;
        }
        assert!(!watched.has_changed());
        assert_eq!(watched.0[0].1.map(|stamp| stamp.contents), Some(None));
    }
}
