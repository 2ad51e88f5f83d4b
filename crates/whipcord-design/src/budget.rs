//! What all searches of a design may spend together, so that each design ends, with the best robot so far.

use core::cell::Cell;

use whipcord::Cancel;

/// What ended a design before its searches came to their ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ended {
    /// The solves that may be spent ([`DesignOptions::solves`](crate::DesignOptions::solves)).
    Solves,
    /// The flag that may be set from outside ([`DesignOptions::stop`](crate::DesignOptions::stop)), as where a time is over.
    Stopped,
}

impl Ended {
    /// A name for programs.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Solves => "solves",
            Self::Stopped => "time",
        }
    }
}

/// Solves that are left, and the flag that ends all searches.
#[derive(Debug)]
pub(crate) struct Budget {
    most: usize,
    spent: Cell<usize>,
    stop: Cancel,
    ended: Cell<Option<Ended>>,
}

impl Budget {
    pub const fn new(most: usize, stop: Cancel) -> Self {
        Self { most, spent: Cell::new(0), stop, ended: Cell::new(None) }
    }

    /// Counts solves.
    pub fn spend(&self, solves: usize) {
        self.spent.set(self.spent.get().saturating_add(solves));
    }

    pub const fn spent(&self) -> usize {
        self.spent.get()
    }

    pub const fn left(&self) -> usize {
        self.most.saturating_sub(self.spent.get())
    }

    /// Whether a search has to take the best so far. Who asks has more to try: it is kept what ended the search.
    pub fn is_over(&self) -> bool {
        let now = if self.stop.is_cancelled() {
            Some(Ended::Stopped)
        } else if self.spent.get() >= self.most {
            Some(Ended::Solves)
        } else {
            None
        };
        if now.is_some() && self.ended.get().is_none() {
            self.ended.set(now);
        }
        now.is_some()
    }

    /// The flag that ends a search from outside.
    pub const fn stop(&self) -> &Cancel {
        &self.stop
    }

    /// What ended a search, if anything did.
    pub const fn ended(&self) -> Option<Ended> {
        self.ended.get()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn solves_or_the_flag_end_a_design_and_the_first_is_told() {
        let stop = Cancel::new();
        let budget = Budget::new(10, stop.clone());
        budget.spend(9);
        assert!(!budget.is_over() && budget.ended().is_none() && budget.left() == 1);
        budget.spend(3);
        assert!(budget.is_over() && budget.left() == 0 && budget.spent() == 12);
        stop.cancel();
        assert!(budget.is_over());
        assert_eq!(budget.ended(), Some(Ended::Solves));
    }
}
