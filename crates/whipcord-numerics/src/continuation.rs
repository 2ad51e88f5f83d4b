//! Continuation: from 0 to 1 in steps that adapt.

/// Sizes of the steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContinuationSteps {
    /// The first.
    pub first: f64,
    /// The least: where a shorter one would be needed, the continuation ends.
    pub least: f64,
    /// What a step grows by after an easy one.
    pub growth: f64,
    /// No step is longer after one was missed for the first time.
    pub after_miss: f64,
}

/// A step that did not get there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Missed<E> {
    /// Why.
    pub reason: E,
    /// Whether no shorter one is to be tried.
    pub is_last: bool,
}

/// Where a continuation ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ended<E> {
    /// The parameter that was reached last.
    pub reached: f64,
    /// Why the next step did not get there.
    pub reason: E,
}

/// Leads something from 0 to 1. `attempt` goes from what it reached last, which it keeps itself, to this value of the parameter, and
/// says whether that was easy; a step that was missed is halved.
///
/// # Errors
/// [`Ended`] where no step leads on.
pub fn continuation<E>(
    steps: &ContinuationSteps,
    mut attempt: impl FnMut(f64) -> Result<bool, Missed<E>>,
) -> Result<(), Ended<E>> {
    let (mut reached, mut step) = (0.0, steps.first);
    loop {
        let next = f64::min(reached + step, 1.0);
        match attempt(next) {
            Ok(_) if next >= 1.0 => return Ok(()),
            Ok(is_easy) => {
                reached = next;
                if is_easy {
                    step *= steps.growth;
                }
            }
            Err(Missed { reason, is_last }) => {
                step = f64::min(0.5 * step, steps.after_miss);
                if step < steps.least || is_last {
                    return Err(Ended { reached, reason });
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STEPS: ContinuationSteps =
        ContinuationSteps { first: 0.25, least: 1e-3, growth: 2.0, after_miss: f64::INFINITY };

    #[test]
    fn easy_steps_grow_and_missed_ones_are_halved() {
        let mut tried = Vec::new();
        let ended = continuation(&STEPS, |at| {
            tried.push(at);
            if tried.len() == 3 { Err(Missed { reason: (), is_last: false }) } else { Ok(true) }
        });
        assert_eq!(ended, Ok(()));
        // A miss at 1 halves the step that was to lead beyond it.
        assert_eq!(tried, [0.25, 0.75, 1.0, 1.0]);
        let mut tried = Vec::new();
        let hard = ContinuationSteps { first: 1.0, after_miss: 0.25, ..STEPS };
        let ended = continuation(&hard, |at| {
            tried.push(at);
            if at == 1.0 && tried.len() == 1 {
                return Err(Missed { reason: (), is_last: false });
            }
            Ok(false)
        });
        assert_eq!(ended, Ok(()));
        assert_eq!(tried, [1.0, 0.25, 0.5, 0.75, 1.0]);
    }

    #[test]
    fn it_ends_short_of_what_cannot_be_reached() {
        let ended = continuation(&STEPS, |at| {
            if at > 0.6 { Err(Missed { reason: at, is_last: false }) } else { Ok(true) }
        });
        assert!(ended.is_err_and(|e| 0.599 <= e.reached && e.reached <= 0.6 && e.reason > 0.6));
        let mut attempts = 0;
        let ended: Result<(), _> = continuation(&STEPS, |_| {
            attempts += 1;
            Err(Missed { reason: (), is_last: true })
        });
        assert!(ended.is_err_and(|ended| ended.reached == 0.0) && attempts == 1);
    }
}
