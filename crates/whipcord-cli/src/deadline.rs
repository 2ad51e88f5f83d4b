//! `--timeout`: the time that a verb may take.
//!
//! The library reads no clock: a thread of its own sets the flag that its solves look at when the time is over. What looks at no
//! flag, such as the decoding of a photograph, is ended with the process shortly after. Either way nothing goes to standard output.
//! A verb whose searches have a best answer at any time is told to take that first, and has as long again for what is left to do with it.

use std::io::{self, Write as _};
use std::process;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::Duration;

use whipcord::Cancel;
use whipcord_io::{Dimension, QuantityError, parse_quantity};
use whipcord_study::failure::Failure;

/// What ends a verb that does not answer the flag: so long after it.
const GRACE: Duration = Duration::from_secs(1);
/// What a verb that is told to take its best answer has for the rest beside as long again.
const REST: Duration = Duration::from_secs(10);
/// Exit status of a verb whose time is over.
const EXPIRED: i32 = 1;

/// The flag of the verb that runs.
static CURRENT: Mutex<Option<Cancel>> = Mutex::new(None);
/// The flag by which its searches are told to take the best so far.
static SEARCH: Mutex<Option<Cancel>> = Mutex::new(None);

/// How long a verb may take.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Limit {
    /// As long as it takes.
    None,
    /// No longer than this.
    After(Duration),
}

/// A limit as it is written on the command line: `30 s`, `500 ms`, `2 min`, `1 h`; a bare number is in seconds; 0 and `none` are
/// no limit.
pub fn limit(text: &str) -> Result<Limit, String> {
    const HELP: &str =
        "give a time such as 30 s, 500 ms, 2 min or 1 h (a bare number is in seconds), or none";
    let text = text.trim();
    if text == "none" {
        return Ok(Limit::None);
    }
    let time = |text: &str| parse_quantity(text, &[Dimension::Time]);
    let found = match time(text) {
        Err(QuantityError::NoUnit(_)) => time(&format!("{text} s")),
        found => found,
    };
    let (seconds, _) = found.map_err(|error| format!("{error}: {HELP}"))?;
    if seconds == 0.0 {
        return Ok(Limit::None);
    }
    if seconds < 0.0 {
        return Err(format!("a time limit cannot be negative: {HELP}"));
    }
    let after = Duration::try_from_secs_f64(seconds).ok().filter(|after| !after.is_zero());
    after.map(Limit::After).ok_or_else(|| HELP.to_owned())
}

/// The flag that ends the solves of the verb that runs when its time is over.
pub fn cancel() -> Cancel {
    lock(&CURRENT).clone().unwrap_or_default()
}

/// The flag that ends the searches of the verb that runs with the best so far, when its time is over.
pub fn end_of_search() -> Cancel {
    lock(&SEARCH).clone().unwrap_or_default()
}

/// What happens to a verb whose time is over.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Over {
    /// It has no answer.
    NoAnswer,
    /// Its searches take the best so far.
    BestSoFar,
}

/// How far a verb is.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Progress {
    Running,
    Expired,
    Done,
}

/// The time of one verb.
#[derive(Debug)]
pub struct Deadline {
    verb: &'static str,
    after: Option<Duration>,
    progress: Arc<(Mutex<Progress>, Condvar)>,
}

impl Deadline {
    /// Begins the time of a verb.
    pub fn start(verb: &'static str, limit: Limit, over: Over) -> Self {
        let progress = Arc::new((Mutex::new(Progress::Running), Condvar::new()));
        let after = match limit {
            Limit::None => None,
            Limit::After(after) => Some(after),
        };
        let flag = Cancel::new();
        *lock(&CURRENT) = Some(flag.clone());
        let search = Cancel::new();
        *lock(&SEARCH) = Some(search.clone());
        // Until the search ends, and until the verb does.
        let times = after.map(|after| match over {
            Over::NoAnswer => (None, after),
            Over::BestSoFar => (Some(after), after.saturating_mul(2).saturating_add(REST)),
        });
        if let Some((first, last)) = times {
            let shared = Arc::clone(&progress);
            // Without the thread there is no limit; the verb does its work all the same.
            let _ = thread::Builder::new().spawn(move || {
                if let Some(first) = first {
                    let (progress, told) = &*shared;
                    if *wait(progress, told, first, Progress::Running) != Progress::Running {
                        return;
                    }
                    search.cancel();
                }
                watch(verb, last.saturating_sub(first.unwrap_or_default()), last, &flag, &shared);
            });
        }
        Self { verb, after: times.map(|(_, last)| last), progress }
    }

    /// What came of the verb; that its time was over, if it was.
    pub fn end(&self, outcome: Result<String, Failure>) -> Result<String, Failure> {
        let (progress, told) = &*self.progress;
        let before = core::mem::replace(&mut *lock(progress), Progress::Done);
        told.notify_all();
        match (before, self.after) {
            (Progress::Expired, Some(after)) => {
                let far = match &outcome {
                    Err(Failure::Solve(message)) => message.strip_prefix("error: "),
                    _ => None,
                };
                Err(Failure::Solve(message(self.verb, after, far)))
            }
            _ => outcome,
        }
    }
}

/// Waits until the verb is done or what is left of its time is over.
fn watch(
    verb: &str,
    left: Duration,
    after: Duration,
    flag: &Cancel,
    shared: &(Mutex<Progress>, Condvar),
) {
    let (progress, told) = shared;
    let mut now = wait(progress, told, left, Progress::Running);
    if *now != Progress::Running {
        return;
    }
    *now = Progress::Expired;
    drop(now);
    flag.cancel();
    let now = wait(progress, told, GRACE, Progress::Expired);
    if *now == Progress::Expired {
        // The lock is held to the end: nothing is printed meanwhile.
        // When standard error is gone, the exit status still tells.
        let _ = writeln!(io::stderr(), "{}", message(verb, after, None));
        whipcord_io::remove_unfinished();
        process::exit(EXPIRED);
    }
}

fn wait<'a>(
    progress: &'a Mutex<Progress>,
    told: &Condvar,
    time: Duration,
    as_long_as: Progress,
) -> MutexGuard<'a, Progress> {
    let waited = told.wait_timeout_while(lock(progress), time, |now| *now == as_long_as);
    waited.unwrap_or_else(PoisonError::into_inner).0
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// What standard error says; `far` is how far a solve came.
fn message(verb: &str, after: Duration, far: Option<&str>) -> String {
    let far = far.map_or_else(String::new, |far| format!(": {far}"));
    format!(
        "error: whipcord {verb} was not done after {after:?} and was stopped (--timeout){far}; give it more time, such as \
         --timeout 10min, or --timeout none, or ask for less"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_have_units() {
        let after = |seconds| Ok(Limit::After(Duration::from_secs_f64(seconds)));
        for (text, expected) in [
            ("30 s", after(30.0)),
            ("30s", after(30.0)),
            ("30", after(30.0)),
            ("1e-3", after(1e-3)),
            ("500 ms", after(0.5)),
            ("2min", after(120.0)),
            ("1.5 h", after(5400.0)),
            ("0", Ok(Limit::None)),
            ("none", Ok(Limit::None)),
        ] {
            assert_eq!(limit(text), expected, "{text}");
        }
        for text in ["", "s", "-1", "3 days", "nan", "inf", "1e300 h", "1e-12"] {
            assert!(limit(text).is_err(), "{text}");
        }
    }
}
