//! An axis: a range, its ticks and where they lie.

use crate::font;
use crate::svg::EXPONENT_SIZE;
use crate::ticks::{self, LogTick};

/// Size of tick labels in px.
pub(crate) const TICK_SIZE: f64 = 11.0;
/// Free space between tick labels in px.
const GAP: f64 = 8.0;
/// Least distance of small ticks without label in px.
const MINOR_GAP: f64 = 4.0;
/// Data nearer to an end of the axis than this part of it get as much room beyond it.
const ROOM: f64 = 0.02;

/// How numbers are laid out along an axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Scale {
    /// Evenly.
    #[default]
    Linear,
    /// By their logarithm; positive numbers only.
    Log,
}

/// What is written at a tick.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct TickLabel {
    pub text: String,
    pub exponent: String,
}

impl TickLabel {
    pub fn plain(text: String) -> Self {
        Self { text, exponent: String::new() }
    }

    pub fn width(&self) -> f64 {
        font::width(&self.text, TICK_SIZE, false)
            + font::width(&self.exponent, EXPONENT_SIZE * TICK_SIZE, false)
    }
}

/// A place on an axis that is marked.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Tick {
    pub value: f64,
    pub label: TickLabel,
}

/// An axis of some length, with round limits and ticks.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Axis {
    scale: Scale,
    low: f64,
    high: f64,
    pub ticks: Vec<Tick>,
    pub minor: Vec<f64>,
}

impl Axis {
    /// An axis over at least this range whose labels fit side by side into `length` px.
    pub fn horizontal(scale: Scale, low: f64, high: f64, length: f64) -> Self {
        let mut most = ticks::MOST;
        loop {
            let mut axis = Self::new(scale, low, high, most);
            if most <= 5 || axis.labels_fit(length) {
                axis.thin_out(length);
                return axis;
            }
            most -= 1;
        }
    }

    /// An axis over at least this range whose labels fit one above the other into `length` px.
    pub fn vertical(scale: Scale, low: f64, high: f64, length: f64) -> Self {
        Self::new(scale, low, high, ((length / 32.0) as usize).clamp(5, ticks::MOST))
    }

    /// An axis of whole numbers with half a unit of room at both ends.
    pub fn counting(first: usize, last: usize, length: f64) -> Self {
        let (low, high) = (first as f64 - 0.5, last as f64 + 0.5);
        let mut axis =
            Self { scale: Scale::Linear, low, high, ticks: Vec::new(), minor: Vec::new() };
        for stride in (0..)
            .flat_map(|k| [1_usize, 2, 5].map(|d| d.saturating_mul(10_usize.saturating_pow(k))))
        {
            // There is no room for more labels than this, so there is no need to make them.
            if ((last - first) / stride) as f64 * GAP > length {
                continue;
            }
            let tick = |k: usize| Tick { value: k as f64, label: TickLabel::plain(k.to_string()) };
            axis.ticks = (first..=last).step_by(stride).map(tick).collect();
            if axis.labels_fit(length) {
                break;
            }
        }
        if ((last - first) as f64) * MINOR_GAP < length {
            axis.minor = (first..=last).map(|k| k as f64).collect();
        }
        axis
    }

    fn new(scale: Scale, low: f64, high: f64, most: usize) -> Self {
        let (ticks, minor) = match scale {
            Scale::Linear => {
                let ticks::Linear { values, decimals } = ticks::linear(low, high, most);
                (values.into_iter().map(|v| linear_tick(v, decimals)).collect::<Vec<_>>(), vec![])
            }
            Scale::Log => {
                let ticks::Logarithmic { values, minor } = ticks::logarithmic(low, high, most);
                let plain = values.iter().all(|t| (-2..=4).contains(&t.exponent));
                (values.into_iter().map(|t| log_tick(t, plain)).collect(), minor)
            }
        };
        let ends = [ticks.first().map_or(low, |t| t.value), ticks.last().map_or(high, |t| t.value)];
        let mut axis = Self { scale, low: ends[0], high: ends[1], ticks, minor };
        axis.make_room(low, high);
        axis
    }

    /// Moves the ends away from data that lie on them, unless the end is zero: columns stand on it.
    fn make_room(&mut self, low: f64, high: f64) {
        let [below, above] = [self.fraction(low), 1.0 - self.fraction(high)];
        let (start, end) = (self.low, self.high);
        let beyond = |from: f64, to: f64| match self.scale {
            Scale::Linear => from - ROOM * (to - from),
            Scale::Log => from * (from / to).powf(ROOM),
        };
        let (lower, upper) = (beyond(start, end), beyond(end, start));
        if below < ROOM && start != 0.0 {
            self.low = lower;
        }
        if above < ROOM && end != 0.0 {
            self.high = upper;
        }
    }

    /// Least and greatest number.
    pub fn limits(&self) -> [f64; 2] {
        [self.low, self.high]
    }

    /// Where a number lies: 0 at the lower end of the axis, 1 at the upper.
    pub fn fraction(&self, value: f64) -> f64 {
        match self.scale {
            Scale::Linear => (value - self.low) / (self.high - self.low),
            Scale::Log => (value / self.low).ln() / (self.high / self.low).ln(),
        }
    }

    /// Width of the widest label in px.
    pub fn label_width(&self) -> f64 {
        self.ticks.iter().map(|t| t.label.width()).fold(0.0, f64::max)
    }

    fn labels_fit(&self, length: f64) -> bool {
        self.ticks.windows(2).all(|pair| {
            let distance = (self.fraction(pair[1].value) - self.fraction(pair[0].value)) * length;
            distance >= 0.5 * (pair[0].label.width() + pair[1].label.width()) + GAP
        })
    }

    /// Keeps every second, every fifth, every tenth tick and so on, until the labels fit.
    fn thin_out(&mut self, length: f64) {
        let all = self.ticks.clone();
        for stride in [2, 5, 10, 20, 50, 100, 200, 500, 1000] {
            if self.labels_fit(length) {
                return;
            }
            self.ticks = all.iter().step_by(stride).cloned().collect();
            self.minor = all.iter().map(|t| t.value).collect();
        }
    }
}

fn linear_tick(value: f64, decimals: usize) -> Tick {
    let text = if value.abs() >= 1e6 || (value != 0.0 && decimals > 5) {
        format!("{value:e}")
    } else {
        format!("{value:.decimals$}")
    };
    Tick { value, label: TickLabel::plain(text.replace('-', "−")) }
}

fn log_tick(tick: LogTick, plain: bool) -> Tick {
    let value = tick.value();
    let label = if plain {
        TickLabel::plain(value.to_string())
    } else {
        let text = if tick.digit == 1 { "10".to_owned() } else { format!("{}·10", tick.digit) };
        TickLabel { text, exponent: tick.exponent.to_string().replace('-', "−") }
    };
    Tick { value, label }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn labels_never_overlap(
            low in -1e4..1e4_f64, width in 1e-3..1e5_f64, length in 150.0..800.0_f64
        ) {
            let axis = Axis::horizontal(Scale::Linear, low, low + width, length);
            prop_assert!(axis.labels_fit(length), "{axis:?}");
            prop_assert!(axis.ticks.len() >= 2);
        }

        #[test]
        fn logarithmic_labels_never_overlap(
            low in -14.0..4.0_f64, width in 0.0..14.0_f64, length in 150.0..800.0_f64
        ) {
            let axis =
                Axis::horizontal(Scale::Log, 10_f64.powf(low), 10_f64.powf(low + width), length);
            prop_assert!(axis.labels_fit(length), "{axis:?}");
        }

        #[test]
        fn counted_labels_never_overlap(last in 2_usize..2000, length in 150.0..800.0_f64) {
            let axis = Axis::counting(1, last, length);
            prop_assert!(axis.labels_fit(length), "{} {length}", axis.ticks.len());
        }
    }

    #[test]
    fn labels_read_well() {
        let labels = |axis: &Axis| -> Vec<String> {
            axis.ticks.iter().map(|t| format!("{}^{}", t.label.text, t.label.exponent)).collect()
        };
        let axis = Axis::vertical(Scale::Linear, -1.0, 0.4, 200.0);
        assert_eq!(labels(&axis), ["−1.0^", "−0.5^", "0.0^", "0.5^"]);
        let axis = Axis::vertical(Scale::Log, 1e-6, 1e-4, 150.0);
        assert_eq!(labels(&axis), ["10^−6", "10^−5", "10^−4"]);
        assert!((axis.fraction(1e-5) - 0.5).abs() < 1e-12);
    }
}
