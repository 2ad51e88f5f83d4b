use std::collections::BTreeSet;
use std::fs::{self, DirEntry, File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::process;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// Files that are being written and have not yet got their names.
static UNFINISHED: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());
static COUNT: AtomicUsize = AtomicUsize::new(0);

fn unfinished() -> MutexGuard<'static, BTreeSet<PathBuf>> {
    // A thread that panicked while it held the lock left the set as it was.
    UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Links that may lead from one to the next, as on Linux.
const LONGEST_CHAIN: usize = 40;
/// What the names of temporary files begin and end with.
const PREFIX: &str = ".whipcord-";
const SUFFIX: &str = ".tmp";
/// A temporary file that is younger than this may be about to be locked by the process that writes it.
const STALE_AFTER: Duration = Duration::from_secs(60);

/// Writes a file whole or not at all: into a temporary file beside it, which takes its name when all of it is on the
/// disk. A symbolic link stays one and its target is written, also where that does not exist yet. A pipe or a device is
/// written to directly.
///
/// A process that is killed leaves its temporary file behind. The next call that writes to the same folder removes it.
///
/// # Errors
/// What the operating system says. The file that was there before is then untouched.
pub fn write_atomically(path: impl AsRef<Path>, content: &[u8]) -> io::Result<()> {
    let path = path.as_ref();
    if let Ok(target) = target_of(path) {
        remove_stale(folder_of(&target));
    }
    write_one_of_many(path, content)
}

/// [`write_atomically`] of one of many files in a folder: it does not look through the folder for what killed processes left behind,
/// which [`remove_stale`] does once for all.
///
/// # Errors
/// As [`write_atomically`].
pub fn write_one_of_many(path: impl AsRef<Path>, content: &[u8]) -> io::Result<()> {
    let path = path.as_ref();
    match fs::metadata(path) {
        // A device or a pipe must not be replaced by a file.
        Ok(found) if !found.is_file() => {
            return OpenOptions::new().write(true).open(path)?.write_all(content);
        }
        _ => {}
    }
    let target = target_of(path)?;
    let folder = folder_of(&target);
    if !folder.exists() {
        return Err(no_folder(path, &target, folder));
    }
    let (temporary, file) = create_in(folder)?;
    let written = fill(&file, content).and_then(|()| {
        // A file that is replaced keeps its permissions.
        if let Ok(found) = fs::metadata(&target) {
            fs::set_permissions(&temporary, found.permissions())?;
        }
        fs::rename(&temporary, &target)
    });
    if written.is_err() {
        // The error that is reported is the first one.
        let _ = fs::remove_file(&temporary);
    }
    unfinished().remove(&temporary);
    written
}

/// Removes the files that [`write_atomically`] has begun and not finished: for a handler that ends
/// the process while other threads write.
pub fn remove_unfinished() {
    for path in unfinished().iter() {
        // There is no one left to tell.
        let _ = fs::remove_file(path);
    }
}

/// The file that symbolic links lead to; it need not exist.
fn target_of(path: &Path) -> io::Result<PathBuf> {
    let mut target = path.to_owned();
    for _ in 0..LONGEST_CHAIN {
        let is_link = fs::symlink_metadata(&target).is_ok_and(|found| found.is_symlink());
        if !is_link {
            target.file_name().ok_or(io::ErrorKind::InvalidFilename)?;
            return Ok(target);
        }
        let next = fs::read_link(&target)?;
        target = folder_of(&target).join(next);
    }
    Err(io::Error::other("its symbolic links lead in a circle"))
}

/// There is no folder to write to; a link does not show which one that is.
fn no_folder(path: &Path, target: &Path, folder: &Path) -> io::Error {
    let folder = folder.display();
    let message = if path == target {
        format!("the folder {folder} does not exist")
    } else {
        format!(
            "it is a symbolic link to {}, and the folder {folder} does not exist",
            target.display()
        )
    };
    io::Error::new(io::ErrorKind::NotFound, message)
}

fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

/// A new temporary file, locked for as long as it is open, so that nobody takes it for one that a dead process left.
fn create_in(folder: &Path) -> io::Result<(PathBuf, File)> {
    loop {
        let (process, count) = (process::id(), COUNT.fetch_add(1, Ordering::Relaxed));
        let temporary = folder.join(format!("{PREFIX}{process}-{count}{SUFFIX}"));
        // Known before it exists, so that no moment is left in which it could be forgotten.
        unfinished().insert(temporary.clone());
        match File::create_new(&temporary) {
            Ok(file) => {
                // Some file systems have no locks: there nobody removes the file.
                let _ = file.try_lock();
                return Ok((temporary, file));
            }
            Err(error) => {
                unfinished().remove(&temporary);
                if error.kind() != io::ErrorKind::AlreadyExists {
                    return Err(error);
                }
            }
        }
    }
}

/// Removes temporary files that nobody writes any more: their process was killed. What cannot be looked at or removed
/// stays: the file that is to be written does not depend on it.
pub fn remove_stale(folder: impl AsRef<Path>) {
    let Ok(entries) = fs::read_dir(folder) else { return };
    for entry in entries.flatten() {
        let name = entry.file_name();
        let is_temporary =
            name.to_str().is_some_and(|name| name.starts_with(PREFIX) && name.ends_with(SUFFIX));
        if is_temporary && is_stale(&entry).unwrap_or(false) {
            let _ = fs::remove_file(entry.path());
        }
    }
}

fn is_stale(entry: &DirEntry) -> io::Result<bool> {
    let found = entry.metadata()?;
    // A clock that was set back makes a file of the future, which is not old.
    let age = found.modified()?.elapsed().unwrap_or_default();
    Ok(found.is_file() && age >= STALE_AFTER && File::open(entry.path())?.try_lock().is_ok())
}

fn fill(mut file: &File, content: &[u8]) -> io::Result<()> {
    file.write_all(content)?;
    file.sync_all()
}

#[cfg(test)]
mod tests {
    use std::time::SystemTime;

    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).unwrap();
        entries.map(|e| e.unwrap().file_name().into_string().unwrap()).collect()
    }

    #[test]
    fn a_file_is_written_and_replaced_without_remains() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("out.csv");
        write_atomically(&path, b"one").unwrap();
        write_atomically(&path, b"two").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"two");
        assert_eq!(names(folder.path()), ["out.csv"]);
    }

    #[test]
    fn a_failure_leaves_nothing() {
        let folder = tempfile::tempdir().unwrap();
        assert!(write_atomically(folder.path(), b"x").is_err());
        assert!(write_atomically(folder.path().join("none/out"), b"x").is_err());
        assert!(names(folder.path()).is_empty());
    }

    #[cfg(unix)]
    #[test]
    fn links_and_devices_stay_what_they_are() {
        let folder = tempfile::tempdir().unwrap();
        let (file, link) = (folder.path().join("file"), folder.path().join("link"));
        fs::write(&file, "old").unwrap();
        std::os::unix::fs::symlink(&file, &link).unwrap();
        write_atomically(&link, b"new").unwrap();
        assert_eq!(fs::read(&file).unwrap(), b"new");
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
        write_atomically("/dev/null", b"gone").unwrap();
        assert!(!fs::metadata("/dev/null").unwrap().is_file());
    }

    #[cfg(unix)]
    #[test]
    fn a_link_to_a_file_that_does_not_exist_yet_is_followed() {
        use std::os::unix::fs::symlink;
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        fs::create_dir(at("results")).unwrap();
        symlink("second", at("first")).unwrap();
        symlink("results/file", at("second")).unwrap();
        write_atomically(at("first"), b"new").unwrap();
        assert_eq!(fs::read(at("results/file")).unwrap(), b"new");
        for link in ["first", "second"] {
            assert!(fs::symlink_metadata(at(link)).unwrap().is_symlink(), "{link}");
        }
        // Where it leads to cannot be written.
        symlink("none/file", at("lost")).unwrap();
        symlink("circle", at("circle")).unwrap();
        for link in ["lost", "circle"] {
            assert!(write_atomically(at(link), b"new").is_err(), "{link}");
            assert!(fs::symlink_metadata(at(link)).unwrap().is_symlink(), "{link}");
        }
        assert_eq!(names(folder.path()).len(), 5);
    }

    /// A temporary file of another process, last written so many seconds ago.
    fn left(folder: &Path, name: &str, seconds: u64) -> (PathBuf, File) {
        let path = folder.join(name);
        let file = File::create(&path).unwrap();
        file.set_modified(SystemTime::now() - Duration::from_secs(seconds)).unwrap();
        (path, file)
    }

    #[test]
    fn what_a_killed_process_left_is_removed_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let (dead, _) = left(folder.path(), ".whipcord-4194304-0.tmp", 120);
        let kept = [
            // One that is being written, one that has just been created, and files of others.
            left(folder.path(), ".whipcord-4194304-1.tmp", 120),
            left(folder.path(), ".whipcord-4194304-2.tmp", 1),
            left(folder.path(), "whipcord.tmp", 120),
            left(folder.path(), ".out.csv.tmp", 120),
        ];
        kept[0].1.lock().unwrap();
        write_atomically(folder.path().join("out.csv"), b"x").unwrap();
        assert!(!dead.exists());
        for (path, _) in &kept {
            assert!(path.exists(), "{}", path.display());
        }
        assert_eq!(names(folder.path()).len(), 5);
    }

    #[test]
    fn a_name_of_the_greatest_length_can_be_written() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("n".repeat(255));
        write_atomically(&path, b"x").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"x");
    }

    #[test]
    fn what_is_unfinished_can_be_removed() {
        let folder = tempfile::tempdir().unwrap();
        let (temporary, _file) = create_in(folder.path()).unwrap();
        assert!(temporary.exists());
        fs::remove_file(&temporary).unwrap();
        unfinished().remove(&temporary);
    }
}
