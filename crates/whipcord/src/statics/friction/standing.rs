//! How the cables stand in their holes at the end of a substep.

use super::holes::{History, Holes};
use super::modes::Mode;
use super::newton::FrictionScratch;
use super::trail::{Standing, SubstepEnd};
use crate::solution::SlipState;
use crate::statics::command::Command;

/// A cable that is so near to sliding, of its grip, or has slid by so little, as a part of what its tension would shorten it by,
/// is about to change.
const NEAR: f64 = 1e-6;

impl Standing {
    /// Of cables that rub nowhere, with these tensions in N.
    pub(crate) fn of_whole_cables(commands: &[Command], tensions: &[f64]) -> Self {
        Self {
            tensions: tensions.to_vec(),
            turns: vec![0.0; tensions.len()],
            slides: vec![Some(-1.0); tensions.len()],
            base: tensions.to_vec(),
            commands: commands.to_vec(),
            fraction: 1.0,
            trigger: None,
            rates: Vec::new(),
            is_about_to_change: false,
        }
    }

    /// At the end of a substep, with the slip state of a passage, which is asked whether its near hole is the base hole of a cable
    /// that is wound up, and with how far the cable slid there in m.
    pub(super) fn new(
        holes: &Holes,
        (commands, fraction): (&[Command], f64),
        (tensions, turns): (&[f64], &[f64]),
        slip_state: impl Fn(usize, bool) -> SlipState,
        slip: impl Fn(usize) -> f64,
        base: &[f64],
    ) -> Self {
        let mut slides = vec![None; tensions.len()];
        let mut is_about_to_change = false;
        for ((cable, place), p) in holes.all() {
            let passages = &holes.of_cable[cable];
            let wound = place == 0 && commands[cable].is_length();
            let incoming = match place.checked_sub(1) {
                Some(before) => tensions[passages[before]],
                None => base[cable],
            };
            let (coefficient, tension) = (holes.coefficients[cable], tensions[p]);
            if coefficient == 0.0 || (incoming <= 0.0 && tension <= 0.0) {
                slides[p] = Some(-1.0);
                continue;
            }
            let grip = coefficient * turns[p];
            let drop = (incoming / tension).ln();
            let at_bound = drop.abs() >= (1.0 - NEAR) * grip;
            slides[p] = match slip_state(p, wound) {
                SlipState::Pulled => Some(-1.0),
                SlipState::Released => Some(1.0),
                // What is wound up keeps its tension below the base within the bounds.
                SlipState::Sticks if wound && at_bound => Some(-drop.signum()),
                SlipState::Sticks => None,
            };
            is_about_to_change |= match slides[p] {
                _ if wound => false,
                Some(_) => slip(p).abs() <= NEAR * holes.compliance * tension.max(incoming),
                None => at_bound,
            };
        }
        let (tensions, turns) = (tensions.to_vec(), turns.to_vec());
        let (base, commands) = (base.to_vec(), commands.to_vec());
        let (trigger, rates) = (None, Vec::new());
        Self {
            tensions,
            turns,
            slides,
            base,
            commands,
            fraction,
            trigger,
            rates,
            is_about_to_change,
        }
    }
}

impl<S: Clone> History<S> {
    /// The end of a substep that was just taken over from the scratch, with how far its commands went, where the holes had come to rest, and
    /// how cables slide in holes if that is not as the scratch has it; `None` before the first.
    pub(super) fn end(
        &self,
        holes: &Holes,
        commands: (&[Command], f64),
        scratch: &FrictionScratch,
        rest: &[f64],
        modes: Option<&[Mode]>,
    ) -> Option<SubstepEnd<S>> {
        let FrictionScratch { tensions, beyond, at, slip_states, .. } = scratch;
        let slip = |p: usize| rest[p] - beyond[p];
        let slip_state = |p: usize, wound: bool| match modes {
            _ if wound => self.slip_states[p],
            Some(modes) => modes[p].slip_state(slip(p)),
            None => slip_states[p],
        };
        let state = (&tensions[..], &at.turns[..]);
        let standing = Standing::new(holes, commands, state, slip_state, slip, &self.base);
        Some(SubstepEnd { shape: self.shape.clone()?, standing, stops: None })
    }
}
