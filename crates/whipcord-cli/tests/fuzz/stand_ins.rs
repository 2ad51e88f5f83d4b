//! Whether the runner notices what it is there for: programs that hang, take too much memory, are killed or say nothing. What
//! they stand in for hardly ever does.

use std::fs;
use std::os::unix::fs::PermissionsExt as _;
use std::path::{Path, PathBuf};
use std::time::Duration;

use crate::kinds::Kind;
use crate::runner::{Plan, Programs, Tally, run_programs};

const SEED: u64 = 1;

/// Runs so many executions with a shell script in place of the worker and of the command.
fn run(kind: Kind, executions: usize, script: &str) -> (Tally, tempfile::TempDir) {
    let folder = tempfile::tempdir().expect("a folder");
    let program = folder.path().join("stand-in");
    fs::write(&program, format!("#!/bin/sh\n{script}\n")).expect("a script");
    fs::set_permissions(&program, fs::Permissions::from_mode(0o700)).expect("it may be run");
    let kept = folder.path().join("kept");
    let programs = Programs { worker: program.clone(), command: program, kept };
    let plan = Plan { kind, executions, time: Duration::from_millis(700), memory: 1000 };
    (run_programs(&programs, plan, SEED), folder)
}

/// What was kept is the mutant of this number, and the failure names its file and says why.
fn assert_kept(kind: Kind, index: usize, failure: &str, why: &str, folder: &Path) {
    assert!(failure.contains(why), "{failure}");
    let place = PathBuf::from(failure.rsplit(": ").next().expect("a place"));
    assert!(place.starts_with(folder.join("kept")), "{failure}");
    assert_eq!(fs::read(&place).expect("it is kept"), kind.mutant(SEED, index).1);
}

/// A script that goes on as the test of this name in this binary.
fn as_test(name: &str) -> String {
    let program = std::env::current_exe().expect("the path of the test");
    format!("exec '{}' --ignored --exact {name} --nocapture", program.display())
}

#[test]
fn a_worker_that_hangs_is_ended() {
    let (tally, folder) = run(Kind::Camera, 2, "echo 'fuzz done 1 10 2048'\nexec sleep 60");
    assert_eq!((tally.executions, tally.taken, tally.timeouts), (2, 1, 1), "{tally:?}");
    assert_eq!((tally.worst_time, tally.worst_memory), (Duration::from_micros(10), 2));
    assert_kept(Kind::Camera, 1, &tally.failures[0], "no answer in", folder.path());
}

/// It is started anew for what follows the mutant that killed it.
#[test]
fn a_worker_that_is_killed_is_started_anew() {
    let (tally, folder) = run(Kind::Csv, 3, "echo 'fuzz done 1 10 2048'\nkill -SEGV $$");
    assert_eq!((tally.executions, tally.taken, tally.timeouts), (3, 2, 0), "{tally:?}");
    assert_eq!(tally.failures.len(), 1, "{tally:?}");
    assert_kept(Kind::Csv, 1, &tally.failures[0], "signal: 11", folder.path());
}

#[test]
fn a_worker_that_fails_is_noticed() {
    let (tally, folder) =
        run(Kind::Mesh, 1, "echo 'thread panicked' >&2\necho 'note: a backtrace' >&2\nexit 101");
    assert_eq!((tally.executions, tally.taken, tally.failures.len()), (1, 0, 1), "{tally:?}");
    assert_kept(Kind::Mesh, 0, &tally.failures[0], "101: thread panicked", folder.path());
}

#[test]
fn memory_beyond_the_limit_is_noticed() {
    let script = as_test("stand_ins::takes_memory");
    for kind in [Kind::Camera, Kind::Solve] {
        let (tally, folder) = run(kind, 1, &script);
        assert_eq!((tally.executions, tally.taken, tally.failures.len()), (1, 0, 1), "{tally:?}");
        let why = "memory allocation of 4294967296 bytes failed";
        assert_kept(kind, 0, &tally.failures[0], why, folder.path());
    }
}

#[test]
#[ignore = "is run by the test above"]
fn takes_memory() {
    let bytes = std::hint::black_box(vec![1_u8; 1 << 32]);
    println!("fuzz done 1 10 {}", bytes.len());
}

#[test]
fn a_command_that_hangs_is_ended() {
    let (tally, folder) = run(Kind::Solve, 1, "exec sleep 60");
    assert_eq!((tally.executions, tally.taken, tally.timeouts), (1, 0, 1), "{tally:?}");
    assert_kept(Kind::Solve, 0, &tally.failures[0], "has not ended in", folder.path());
}

#[test]
fn a_command_without_an_answer_or_a_reason_is_noticed() {
    for (script, why) in [
        ("kill -SEGV $$", "signal: 11"),
        ("echo 'thread panicked' >&2; exit 101", "101: thread panicked"),
        ("exit 1", "exit status: 1"),
    ] {
        let (tally, folder) = run(Kind::Solve, 1, script);
        assert_eq!((tally.executions, tally.taken, tally.failures.len()), (1, 0, 1), "{tally:?}");
        assert_kept(Kind::Solve, 0, &tally.failures[0], why, folder.path());
    }
}

#[test]
fn answers_and_reasons_are_counted() {
    let (tally, _) = run(Kind::Solve, 2, "exit 0");
    assert_eq!((tally.executions, tally.taken, tally.failures.len()), (2, 2, 0), "{tally:?}");
    let (tally, _) = run(Kind::Solve, 2, "echo 'error: stopped (--timeout)' >&2; exit 1");
    assert_eq!((tally.unsolved, tally.cut, tally.failures.len()), (2, 2, 0), "{tally:?}");
    let (tally, _) = run(Kind::Solve, 2, "echo 'error: no file' >&2; exit 2");
    assert_eq!((tally.taken, tally.unsolved, tally.failures.len()), (0, 0, 0), "{tally:?}");
}

/// Only tables of numbers are searched for what is none: one in four of the commands prints one.
#[test]
fn what_is_no_number_in_a_table_is_noticed() {
    let (tally, _) = run(Kind::Solve, 48, "echo 'x,y'; echo '1,NaN'");
    let found = tally.failures.iter().filter(|line| line.contains("prints 1 that are no numbers"));
    assert_eq!(found.count(), tally.failures.len(), "{tally:?}");
    assert!((1..48).contains(&tally.failures.len()), "{tally:?}");
}
