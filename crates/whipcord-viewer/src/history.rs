//! What another program has shown, as far as it is kept for pages that are opened later.

use std::collections::VecDeque;
use std::sync::Arc;

use crate::protocol::Shown;

/// How much of it is kept: at usual numbers of stations some ten MB.
const MOST: usize = 1000;

/// The latest of what has been shown, in its order.
#[derive(Debug, Default)]
pub struct History(VecDeque<Arc<Shown>>);

impl History {
    /// Adds what is shown now, and drops the oldest where there is too much.
    pub fn push(&mut self, shown: Shown) {
        if self.0.len() == MOST {
            self.0.pop_front();
        }
        self.0.push_back(Arc::new(shown));
    }

    /// What is shown now.
    #[must_use]
    pub fn latest(&self) -> Option<Arc<Shown>> {
        self.0.back().cloned()
    }

    /// All that is kept.
    #[must_use]
    pub fn all(&self) -> Vec<Arc<Shown>> {
        self.0.iter().cloned().collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_oldest_is_dropped_where_there_is_too_much() {
        let mut history = History::default();
        assert!(history.latest().is_none() && history.all().is_empty());
        for k in 0..MOST + 3 {
            history.push(Shown { time: k as f64, shapes: Vec::new(), measured: Vec::new() });
        }
        let all = history.all();
        assert_eq!((all.len(), all[0].time), (MOST, 3.0));
        assert_eq!(history.latest().map(|last| last.time), Some((MOST + 2) as f64));
    }
}
