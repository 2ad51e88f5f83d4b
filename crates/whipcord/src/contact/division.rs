//! How finely the way to a step of actuation is divided where cables rub in their holes.
//!
//! What a hole or a contact remembers is that of the last part of the way. A part may therefore change the commands by no more than a
//! part of what they have been: that, and not the number of steps of actuation, says how much a part may miss.

use crate::case::CableCommand;

/// The longest part of a way from rest: what sticks at its end has its length beyond the hole from where it began.
pub(super) const FROM_REST: f64 = 1.0 / 32.0;
/// Commands below this part of the greatest of all cables need no accuracy of their own.
const SLIGHT: f64 = 1e-2;
/// Numbers of parts are powers of two, and so much greater than they need be at least: the division of a step by a round part of the
/// commands then stays as it is while they change a little, and its answer changes as its derivatives say.
const CLEAR: f64 = 1.19;

/// The greatest commands of a way so far, in N and in m.
#[derive(Debug, Default)]
pub(super) struct Commanded {
    last: Vec<[f64; 2]>,
    greatest: Vec<[f64; 2]>,
}

impl Commanded {
    /// The longest part of the step of actuation to these commands, of cables of these lengths in m before actuation, as a part of that step.
    pub fn longest_part(&mut self, commands: &[CableCommand], initial: &[f64]) -> f64 {
        let to: Vec<[f64; 2]> = commands.iter().zip(initial).map(amounts).collect();
        self.last.resize(to.len(), [0.0; 2]);
        self.greatest.resize(to.len(), [0.0; 2]);
        for (greatest, to) in self.greatest.iter_mut().zip(&to) {
            *greatest = [0, 1].map(|kind| greatest[kind].max(to[kind].abs()));
        }
        let least = [0, 1].map(|kind| {
            let all = self.greatest.iter().map(|greatest| greatest[kind]);
            SLIGHT * all.fold(0.0, f64::max)
        });
        let mut part: f64 = 0.0;
        for ((last, to), greatest) in self.last.iter().zip(&to).zip(&self.greatest) {
            for kind in [0, 1] {
                let (change, of) = ((to[kind] - last[kind]).abs(), greatest[kind].max(least[kind]));
                if change > 0.0 {
                    part = part.max(change / of);
                }
            }
        }
        self.last = to;
        let parts = (CLEAR * part / FROM_REST).log2().ceil().exp2();
        parts.clamp(1.0, 1.0 / FROM_REST).recip()
    }
}

/// Tension in N and shortening in m.
fn amounts((command, &initial): (&CableCommand, &f64)) -> [f64; 2] {
    let shortening = command.shortening.map_or(0.0, |shortening| shortening.in_metres(initial));
    [command.tension.unwrap_or(0.0), shortening]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::case::{Case, Shortening};

    /// The number of parts of each step of two cables.
    fn parts(steps: &[[f64; 2]]) -> Vec<f64> {
        let mut commanded = Commanded::default();
        let parts_of = |tensions: &[f64; 2]| {
            let commands = Case::with_tensions(tensions).commands;
            commanded.longest_part(&commands, &[1.0; 2]).recip()
        };
        steps.iter().map(parts_of).collect()
    }

    #[test]
    fn a_step_has_as_many_parts_as_it_changes_of_the_greatest_commands() {
        assert_eq!(parts(&[[8.0, 0.0]]), [32.0]);
        // Half, a quarter and a hundredth of what it was, and all of it again.
        assert_eq!(
            parts(&[[8.0, 0.0], [4.0, 0.0], [2.0, 0.0], [1.92, 0.0], [1.92, 0.0], [-6.0, 0.0]]),
            [32.0, 32.0, 16.0, 1.0, 1.0, 32.0]
        );
        // A cable that pulls less than the other has parts of its own, down to a hundredth of it.
        assert_eq!(
            parts(&[[8.0, 0.0], [8.0, 1.0], [8.0, 1.1], [8.0, 1.1], [8.1, 1.1]]),
            [32.0, 32.0, 4.0, 1.0, 1.0]
        );
        assert_eq!(parts(&[[8.0, 0.0], [8.0, 1e-3]]), [32.0, 1.0]);
        assert_eq!(parts(&[[0.0, 0.0]]), [1.0]);
    }

    #[test]
    fn no_part_is_longer_than_that_of_a_step_from_rest() {
        let mut commanded = Commanded::default();
        let (mut last, mut greatest, mut sum) = (0.0_f64, 0.0_f64, 0.0);
        for k in 1..=512 {
            let fraction = f64::from(k) / 512.0 + 0.3 * (f64::from(k) / 20.0).sin();
            let shortening = Some(Shortening::Fraction(fraction));
            let commands = [CableCommand { tension: None, shortening }];
            let longest = commanded.longest_part(&commands, &[0.2]);
            greatest = greatest.max(fraction.abs());
            assert!(longest * (fraction - last).abs() <= FROM_REST * greatest, "{k}: {longest}");
            last = fraction;
            sum += longest.recip();
        }
        // That of 512 steps from rest would be 16384.
        assert!(sum < 1500.0, "{sum}");
    }
}
