//! Runs mutants in processes of their own under limits of time and memory, and keeps those that are not answered.

use std::fs;
use std::io::{BufRead as _, BufReader, Write as _};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::thread;
use std::time::{Duration, Instant};

use whipcord::ModelKind;

use crate::kinds::{Kind, root};
use crate::random::Random;

/// What is run of one kind, and what it may take.
#[derive(Clone, Copy, Debug)]
pub struct Plan {
    pub kind: Kind,
    pub executions: usize,
    pub time: Duration,
    /// MiB.
    pub memory: u64,
}

/// What came of it.
#[derive(Debug, Default)]
pub struct Tally {
    pub executions: usize,
    /// Files that were taken; of solves, answers.
    pub taken: usize,
    /// Solves without an answer.
    pub unsolved: usize,
    /// Of these, the ones that `--timeout` has stopped.
    pub cut: usize,
    /// Processes that did not end within the limit: failures.
    pub timeouts: usize,
    pub worst_time: Duration,
    /// MiB.
    pub worst_memory: u64,
    /// What was not answered, each with the file that it is kept in.
    pub failures: Vec<String>,
}

/// What is run, and the folder for what it does not answer.
#[derive(Debug)]
pub struct Programs {
    /// Reads one mutant after another, as [`work`] does.
    pub worker: PathBuf,
    /// The command itself.
    pub command: PathBuf,
    pub kept: PathBuf,
}

const WORKER: &str = "WHIPCORD_FUZZ_WORKER";

/// Runs all executions of a plan.
pub fn run(plan: Plan, seed: u64) -> Tally {
    let programs = Programs {
        worker: std::env::current_exe().expect("the path of the test"),
        command: PathBuf::from(env!("CARGO_BIN_EXE_whipcord")),
        kept: root().join("target/fuzz"),
    };
    run_programs(&programs, plan, seed)
}

/// The same with these programs.
pub fn run_programs(programs: &Programs, plan: Plan, seed: u64) -> Tally {
    let mut tally = Tally::default();
    match plan.kind {
        Kind::Solve => {
            (0..plan.executions).for_each(|index| command(programs, plan, seed, index, &mut tally))
        }
        _ => {
            let mut next = 0;
            while next < plan.executions {
                next = workers(programs, plan, seed, next, &mut tally);
            }
        }
    }
    tally
}

/// A process under limits: seconds of processor time as well, in case it is orphaned.
pub fn limited(program: &Path, memory: u64) -> Command {
    let script = format!(
        "ulimit -c 0 && ulimit -v {} && ulimit -t 120 && exec \"$0\" \"$@\"",
        memory * 1024
    );
    let mut command = Command::new("sh");
    command.args(["-c", &script]).arg(program).stdin(Stdio::null()).env("RUST_BACKTRACE", "0");
    command
}

/// Whether a line of standard error may say why a process ended: after a panic, a note on backtraces follows its message.
fn is_reason(line: &str) -> bool {
    !line.trim().is_empty() && !line.starts_with("note: ")
}

/// Keeps a mutant that was not answered.
fn keep(folder: &Path, plan: Plan, seed: u64, index: usize, what: &str, tally: &mut Tally) {
    tally.failures.push(save(folder, plan, seed, index, what));
}

/// Writes a mutant to the folder, and returns the line that names it, what happened, and its file; which is printed as well.
fn save(folder: &Path, plan: Plan, seed: u64, index: usize, what: &str) -> String {
    let (name, bytes) = plan.kind.mutant(seed, index);
    let kind = plan.kind.name().replace(' ', "-");
    let mut file = folder.join(format!("{kind}-{seed}-{index}"));
    file.set_extension(name.extension().unwrap_or_default());
    let kept = fs::create_dir_all(folder).and_then(|()| fs::write(&file, bytes));
    let place = kept.map_or_else(|error| error.to_string(), |()| file.display().to_string());
    let line = format!("{} {index} of seed {seed}: {what}: {place}", plan.kind.name());
    println!("{line}");
    line
}

/// Runs executions in one process until it ends or is ended, and returns the number of the next.
fn workers(programs: &Programs, plan: Plan, seed: u64, first: usize, tally: &mut Tally) -> usize {
    let task = format!("{};{seed};{first};{}", plan.kind.name(), plan.executions);
    let scratch = tempfile::tempdir().expect("a folder");
    let mut child = limited(&programs.worker, plan.memory)
        .args(["--ignored", "--exact", "worker", "--nocapture", "--test-threads=1"])
        .env(WORKER, task)
        .env("TMPDIR", scratch.path())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the worker starts");
    let lines = lines_of(&mut child);
    let errors = child.stderr.take();
    let said = thread::spawn(move || {
        let lines = errors.map(|errors| BufReader::new(errors).lines().map_while(Result::ok));
        lines.into_iter().flatten().filter(|line| is_reason(line)).last()
    });
    let mut index = first;
    let mut begun = Instant::now();
    let outcome = loop {
        // The first answer waits for the process to start.
        let allowed = plan.time + Duration::from_secs(if index == first { 30 } else { 0 });
        match lines.recv_timeout(allowed) {
            Ok(line) => {
                let Some(line) = line.split("fuzz ").nth(1) else { continue };
                let mut words = line.split(' ');
                if words.next() == Some("done") {
                    let number =
                        |word: Option<&str>| word.and_then(|w| w.parse::<u64>().ok()).unwrap_or(0);
                    tally.executions += 1;
                    tally.taken += number(words.next()) as usize;
                    tally.worst_time =
                        tally.worst_time.max(Duration::from_micros(number(words.next())));
                    tally.worst_memory = tally.worst_memory.max(number(words.next()) / 1024);
                    index += 1;
                    begun = Instant::now();
                }
            }
            Err(RecvTimeoutError::Timeout) => {
                break Some(format!("no answer in {:?}", begun.elapsed()));
            }
            Err(RecvTimeoutError::Disconnected) if index < plan.executions => break None,
            Err(RecvTimeoutError::Disconnected) => break Some(String::new()),
        }
    };
    let timed_out = outcome.as_ref().is_some_and(|text| !text.is_empty());
    if timed_out {
        let _ = child.kill();
    }
    let status = child.wait().expect("the worker ends");
    let said = said.join().ok().flatten().unwrap_or_default();
    match outcome {
        Some(text) if timed_out => {
            tally.timeouts += 1;
            keep(&programs.kept, plan, seed, index, &text, tally);
        }
        Some(_) => return index,
        None => keep(&programs.kept, plan, seed, index, &format!("{status}: {said}"), tally),
    }
    tally.executions += 1;
    index + 1
}

fn lines_of(child: &mut Child) -> Receiver<String> {
    let (to, from) = channel();
    let output = child.stdout.take();
    thread::spawn(move || {
        for line in output.into_iter().flat_map(|out| BufReader::new(out).lines()) {
            let Ok(line) = line else { break };
            if to.send(line).is_err() {
                break;
            }
        }
    });
    from
}

/// What the other side of [`workers`] does.
pub fn work() {
    let Ok(task) = std::env::var(WORKER) else { return };
    let words: Vec<&str> = task.split(';').collect();
    let &[kind, seed, first, end] = words.as_slice() else { return };
    let kind = Kind::named(kind).expect("a kind");
    let [seed, first, end] = [seed, first, end].map(|word| word.parse::<u64>().expect("a number"));
    let scratch = tempfile::tempdir().expect("a folder");
    for index in first..end {
        let (name, bytes) = kind.mutant(seed, index as usize);
        let begun = Instant::now();
        let taken = kind.read(&name, &bytes, scratch.path());
        let time = begun.elapsed().as_micros();
        let memory = peak("self").unwrap_or(0);
        println!("fuzz done {} {time} {memory}", u8::from(taken));
        let _ = std::io::stdout().flush();
    }
}

/// Most memory that a process has had so far in KiB, where the system says it.
fn peak(process: &str) -> Option<u64> {
    let text = fs::read_to_string(format!("/proc/{process}/status")).ok()?;
    let line = text.lines().find(|line| line.starts_with("VmHWM:"))?;
    line.split_whitespace().nth(1)?.parse().ok()
}

/// What was seen of a process.
#[derive(Debug)]
pub struct Watched {
    /// None of one that was ended for its time.
    pub status: Option<ExitStatus>,
    pub time: Duration,
    /// MiB.
    pub memory: u64,
}

/// Waits for a process for at most this long.
pub fn watch(command: &mut Command, most: Duration) -> Watched {
    let begun = Instant::now();
    let mut memory = 0;
    let mut child = command.spawn().expect("the command starts");
    let status = loop {
        memory = memory.max(peak(&child.id().to_string()).unwrap_or(0) / 1024);
        if let Some(status) = child.try_wait().expect("the command is watched") {
            break Some(status);
        }
        if begun.elapsed() > most {
            let _ = child.kill();
            let _ = child.wait();
            break None;
        }
        thread::sleep(Duration::from_millis(4));
    };
    Watched { status, time: begun.elapsed(), memory }
}

/// Lets the command itself answer a mutant: its exit status is 0, 1 or 2, and no number that it prints is none.
fn command(programs: &Programs, plan: Plan, seed: u64, index: usize, tally: &mut Tally) {
    let (name, bytes) = plan.kind.mutant(seed, index);
    let mut random = Random::new(seed, plan.kind as usize + 1, index);
    let verbs: [&[&str]; 4] = [
        &["solve", "--json"],
        &["solve", "--csv", "--stations", "20"],
        &["check"],
        &["stiffness", "--json"],
    ];
    let verb = *random.pick(&verbs);
    let scratch = copied_examples();
    let relative = name.strip_prefix(root().join("examples")).expect("an example");
    let file = scratch.path().join(relative).with_file_name("mutant.toml");
    fs::write(&file, bytes).expect("the mutant is written");
    let out = |name: &str| fs::File::create(scratch.path().join(name)).expect("a file");
    let mut child = limited(&programs.command, plan.memory);
    let own = format!("{}s", plan.time.as_secs_f64() / 2.0);
    let mut arguments = verb.to_vec();
    if verb[0] == "solve" {
        let models = ModelKind::ALL.map(ModelKind::name);
        arguments.extend(["--model", *random.pick(&models)]);
    }
    arguments.extend(["--timeout", &own]);
    child.args(&arguments).arg(&file).stdout(out("stdout")).stderr(out("stderr"));
    let Watched { status, time, memory } = watch(&mut child, plan.time);
    tally.executions += 1;
    tally.worst_time = tally.worst_time.max(time);
    tally.worst_memory = tally.worst_memory.max(memory);
    let read = |name: &str| {
        String::from_utf8_lossy(&fs::read(scratch.path().join(name)).unwrap_or_default())
            .into_owned()
    };
    let (stdout, stderr) = (read("stdout"), read("stderr"));
    // As it is typed beside the examples.
    let mutant = relative.with_file_name("mutant.toml");
    let verb = format!("{} {}", arguments.join(" "), mutant.display());
    match status.map(|status| (status, status.code())) {
        // The command has stopped its own solves in half of that time.
        None => {
            tally.timeouts += 1;
            let what = format!("`{verb}` has not ended in {:?}", plan.time);
            keep(&programs.kept, plan, seed, index, &what, tally);
        }
        Some((_, Some(0))) => {
            tally.taken += 1;
            // JSON has no way to write them, and other texts may quote the file.
            let cells = stdout.split([',', '\n']).filter(|_| verb.contains("--csv"));
            let found = cells.filter(|cell| ["NaN", "inf", "-inf"].contains(cell)).count();
            if found > 0 {
                keep(
                    &programs.kept,
                    plan,
                    seed,
                    index,
                    &format!("`{verb}` prints {found} that are no numbers"),
                    tally,
                );
            }
        }
        Some((_, Some(1))) if stderr.contains("error: ") => {
            tally.unsolved += 1;
            if stderr.contains("(--timeout)") {
                tally.cut += 1;
                // No failure: that the command stops itself is an answer. What is slow is worth a look.
                let what = format!("`{verb}` is stopped after {own}");
                save(&programs.kept, plan, seed, index, &what);
            }
        }
        Some((_, Some(2))) => {}
        Some((status, _)) => {
            let last = stderr.lines().rfind(|line| is_reason(line)).unwrap_or_default();
            keep(
                &programs.kept,
                plan,
                seed,
                index,
                &format!("`{verb}` ends with {status}: {last}"),
                tally,
            );
        }
    }
}

/// The examples in a folder of their own, so that what mutants extend and name is there.
fn copied_examples() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    let mut left: Vec<PathBuf> = vec![root().join("examples")];
    while let Some(from) = left.pop() {
        for entry in fs::read_dir(&from).expect("the examples") {
            let path = entry.expect("an entry").path();
            let to =
                folder.path().join(path.strip_prefix(root().join("examples")).expect("within"));
            if path.is_dir() {
                fs::create_dir(&to).expect("a folder");
                left.push(path);
            } else {
                fs::copy(&path, &to).expect("a copy");
            }
        }
    }
    folder
}
