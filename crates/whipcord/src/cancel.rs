//! A flag that ends a solve from outside.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::error::SolveError;

/// A flag that ends a running solve: the iterations of every model look at it.
///
/// A clone is the same flag. It is part of a model's options ([`Model::cancelled_by`](crate::Model::cancelled_by)) and can be
/// set from another thread; the solve then ends with [`SolveError::Cancelled`], and so does
/// each row of a [batch](crate::batch) that is not solved. It cannot be taken back: another solve takes another flag. As long
/// as it is not set, it changes no answer. This library reads no clock; who has a deadline sets the flag when it has passed.
///
/// ```
/// use whipcord::{Backbone, Cancel, Case, Disks, Model, ModelKind, Robot, SolveError, Statics};
/// # let robot = Robot::new(Backbone::new(0.1), Disks::equally_spaced(0.1, 5, 0.008), vec![])?;
/// let cancel = Cancel::new();
/// let model = Model::new(ModelKind::FourBar, Default::default(), Default::default()).cancelled_by(&cancel);
/// assert!(model.solve(&robot, &Case::default()).is_ok());
/// cancel.cancel();
/// let error = model.solve(&robot, &Case::default()).unwrap_err();
/// assert!(matches!(error, SolveError::Cancelled { .. }));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct Cancel(Option<Arc<AtomicBool>>);

/// The flag is no part of what is computed: options that differ by nothing else are equal.
impl PartialEq for Cancel {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl Eq for Cancel {}

impl Cancel {
    /// A flag that can be set. That of [`Default`] cannot, and ends nothing.
    #[must_use]
    pub fn new() -> Self {
        Self(Some(Arc::default()))
    }

    /// Sets the flag.
    pub fn cancel(&self) {
        if let Some(flag) = &self.0 {
            flag.store(true, Ordering::Relaxed);
        }
    }

    /// Whether it is set.
    #[must_use]
    pub fn is_cancelled(&self) -> bool {
        self.0.as_ref().is_some_and(|flag| flag.load(Ordering::Relaxed))
    }

    /// What came of a solve; once the flag is set, that it was cancelled, whatever the iterations that it broke off made of it.
    pub(crate) fn checked<T>(&self, outcome: Result<T, SolveError>) -> Result<T, SolveError> {
        if !self.is_cancelled() {
            return outcome;
        }
        let last_load = outcome.err().and_then(|error| error.last_load());
        Err(SolveError::Cancelled { last_load })
    }
}
