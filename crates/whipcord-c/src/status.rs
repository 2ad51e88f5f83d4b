//! How a call ended, and the message of the last failure.

#![allow(unsafe_code, reason = "a name for the linker is an unsafe attribute")]

use core::cell::RefCell;
use core::ffi::c_char;
use core::panic::AssertUnwindSafe;
use std::borrow::Cow;
use std::ffi::CString;
use std::panic::catch_unwind;

use whipcord::SolveError;
use whipcord_inverse::InverseError;
use whipcord_motion::MotionError;

/// How a call ended.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// As asked.
    Ok = 0,
    /// A pointer that must not be NULL is.
    NullPointer = 1,
    /// A number or a name that cannot be, such as a NaN, a negative tension or a model that there is not.
    InvalidArgument = 2,
    /// An array has not the length that is needed.
    WrongLength = 3,
    /// A text is not UTF-8.
    NotUtf8 = 4,
    /// The robot file cannot be read or used: the message has the line and the remedy.
    File = 5,
    /// The model or the motion cannot take the robot or the case.
    Refused = 6,
    /// No solution was found; the one before, if there was one, is kept.
    NoSolution = 7,
    /// The budget is spent. The solution is the best shape so far.
    BudgetSpent = 8,
    /// What is asked for is not there: nothing has been solved yet, or the model does not compute it.
    Unavailable = 9,
    /// An error in the library. The handle must be freed and not be used otherwise.
    Internal = 10,
}

/// Why a call failed.
#[derive(Clone, Debug)]
pub struct Failure {
    /// The kind.
    pub status: Status,
    /// In words.
    pub message: Cow<'static, str>,
}

impl Failure {
    pub(crate) fn new(status: Status, message: impl Into<Cow<'static, str>>) -> Self {
        Self { status, message: message.into() }
    }

    /// A handle or an array that is NULL.
    pub(crate) fn null(what: &str) -> Self {
        Self::new(Status::NullPointer, format!("{what} is NULL"))
    }

    /// What a solve fails with, in these words.
    pub(crate) fn of_solve(error: &SolveError, words: String) -> Self {
        let status = match error {
            SolveError::Invalid(_) => Status::InvalidArgument,
            SolveError::Missing { .. } | SolveError::Unsupported { .. } => Status::Refused,
            _ => Status::NoSolution,
        };
        Self::new(status, words)
    }

    /// What a motion fails with, in these words.
    pub(crate) fn of_motion(error: &MotionError, words: String) -> Self {
        let status = match error {
            MotionError::Invalid(_) | MotionError::Option { .. } | MotionError::Count { .. } => {
                Status::InvalidArgument
            }
            MotionError::Missing { .. } | MotionError::Unsupported { .. } => Status::Refused,
            _ => Status::NoSolution,
        };
        Self::new(status, words)
    }
}

impl From<InverseError> for Failure {
    fn from(error: InverseError) -> Self {
        let words = error.to_string();
        match error {
            InverseError::Solve(error) | InverseError::NoStart(error) => {
                Self::of_solve(&error, words)
            }
            InverseError::NoActuators | InverseError::NoMotors => Self::new(Status::Refused, words),
            InverseError::NoSolves | InverseError::Atlas(_) => Self::new(Status::NoSolution, words),
            _ => Self::new(Status::InvalidArgument, words),
        }
    }
}

thread_local! {
    static LAST: RefCell<CString> = RefCell::new(CString::default());
}

/// Does what a function of the interface does: what fails leaves its message, and no panic gets into the caller's code.
pub(crate) fn guard(work: impl FnOnce() -> Result<(), Failure>) -> Status {
    // A panic means that the state of a handle is not to be relied on, which the status says.
    let failure = match catch_unwind(AssertUnwindSafe(work)) {
        Ok(Ok(())) => return Status::Ok,
        Ok(Err(failure)) => failure,
        Err(_) => Failure::new(
            Status::Internal,
            "an error in the library: free the handle, and report what was called",
        ),
    };
    remember(&failure.message);
    failure.status
}

/// Does what a function without a status does.
pub(crate) fn guarded<T>(otherwise: T, work: impl FnOnce() -> T) -> T {
    catch_unwind(AssertUnwindSafe(work)).unwrap_or(otherwise)
}

fn remember(message: &str) {
    let message = c_text(message);
    // A thread that ends has no message any more.
    let _ = LAST.try_with(|last| last.replace(message));
}

/// A text for C, which ends at its first zero: those within are replaced.
pub(crate) fn c_text(text: &str) -> CString {
    CString::new(text.replace('\0', "\u{FFFD}")).unwrap_or_default()
}

/// Why the last call that failed in this thread did, in UTF-8; the empty text if none has failed. It is valid until the next call that fails in this thread.
// SAFETY: no other symbol has this name.
#[unsafe(no_mangle)]
pub extern "C" fn whipcord_last_error() -> *const c_char {
    LAST.try_with(|last| last.borrow().as_ptr()).unwrap_or(c"".as_ptr())
}
