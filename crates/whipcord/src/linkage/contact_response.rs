//! How the chain moves with the wrenches of contacts, and with the step that is left: eqs. (12) to (14).

use whipcord_numerics::{Pose, Twist};

use super::Linkage;
use super::chain::Chain;
use super::holes_in_contact::HolesInContact;
use super::pivots::positive_pivots;
use super::places::Places;
use super::task::Task;
use crate::contact::LoadedPlaces;
use crate::error::SolveError;
use crate::statics::command::{Command, LENGTH_REGULARISATION};
use crate::statics::hold::{HeldCables, Hold};

/// The linearised chain. The coordinates' part of it is left in the chain's memory.
#[derive(Clone, Debug, Default)]
pub(super) struct ContactResponse {
    loaded: LoadedPlaces<f64>,
    /// How every place moves with the step that is left, then with each component on each place.
    twists: Vec<Twist>,
    /// How the tension of every cable changes with these.
    tensions: Vec<f64>,
    /// Whether an even number of directions is unstable while the wrenches stay as they are.
    pub stands: bool,
    length_by_tension: Vec<f64>,
    pivots: Vec<f64>,
    work: Vec<f64>,
}

/// How the cables are driven, and the cables that are held at their lengths.
#[derive(Clone, Copy, Debug)]
pub(super) struct DrivenCables<'a> {
    pub commands: &'a [Command],
    pub is_active: &'a [bool],
}

impl ContactResponse {
    /// Linearises the chain where it was evaluated last, whose disks are these, with wrenches at these arc lengths in m.
    pub fn linearise(
        &mut self,
        model: &Linkage,
        (task, chain): (&Task<'_>, &mut Chain),
        cables: DrivenCables<'_>,
        disks: &[Pose],
        pushes: &[f64],
    ) -> Result<(), SolveError> {
        let Self { loaded, twists, tensions, length_by_tension, pivots, work, .. } = self;
        loaded.set(pushes);
        let places = Places::new(model, &chain.q, disks, loaded.places());
        chain.linearise(task);
        let negative = chain
            .eliminate_with_wrenches(task, &places.unit_wrenches())
            .ok_or(SolveError::NoDerivatives)?;
        chain.length_by_tension(task, length_by_tension);
        let count = task.tensions.len();
        let by_tension = |i: usize, j: usize| length_by_tension[i * count + j];
        let DrivenCables { commands, is_active } = cables;
        let compliance = |i: usize| match commands[i] {
            Command::Length { compliance, .. } => compliance,
            Command::Tension(_) => 0.0,
        };
        let held =
            HeldCables::new(count, by_tension, compliance, |i| is_active[i], |i| is_active[i])
                .map_err(|_| SolveError::NoDerivatives)?;
        // The signs of H, and those of the held cables, eq. (14).
        let greatest = (0..count).map(|i| by_tension(i, i).abs()).fold(0.0, f64::max);
        let of_cable = |i: usize| (i, compliance(i) + LENGTH_REGULARISATION * greatest);
        let bordered: Vec<(usize, f64)> =
            (0..count).filter(|&i| is_active[i]).map(of_cable).collect();
        let positive =
            positive_pivots(bordered.iter().copied(), |i, j| -by_tension(i, j), pivots, work)
                .ok_or(SolveError::NoDerivatives)?;
        self.stands = (negative + bordered.len() - positive).is_multiple_of(2);
        tensions.clear();
        twists.clear();
        let at = loaded.places().len();
        for side in 0..=6 * at {
            let response = if side == 0 { 0 } else { count + side };
            let lengths = chain.lengths_by(task, response);
            let start = tensions.len();
            // Cables that go slack lose their tension in the step that is left.
            tensions.extend((0..count).map(|i| match commands[i] {
                Command::Length { .. } if side == 0 && !is_active[i] => -task.tensions[i],
                _ => 0.0,
            }));
            let own = &mut tensions[start..];
            let right: Vec<f64> = (0..count)
                .map(|i| {
                    let released: f64 = (0..count).map(|j| by_tension(i, j) * own[j]).sum();
                    let slack = match side {
                        0 => commands[i].slackness(task.tensions[i], chain.lengths[i]),
                        _ => 0.0,
                    };
                    slack - lengths[i] - released
                })
                .collect();
            let changes = held.tensions(Hold::Commands, &right);
            own.iter_mut().zip(changes).for_each(|(tension, change)| *tension += change);
            places.twists(chain, task, response, twists);
        }
        add_cables(&places, (task, chain), tensions, twists);
        Ok(())
    }

    /// The same of a chain whose cables rub: with the tensions of all passages, which the equations of the holes decide on.
    pub fn linearise_rubbing(
        &mut self,
        model: &Linkage,
        (task, chain): (&Task<'_>, &mut Chain),
        (holes, commands): (&mut HolesInContact<'_>, &[Command]),
        disks: &[Pose],
        pushes: &[f64],
    ) -> Result<(), SolveError> {
        let Self { loaded, twists, tensions, .. } = self;
        loaded.set(pushes);
        let places = Places::new(model, &chain.q, disks, loaded.places());
        chain.linearise(task);
        let negative = chain
            .eliminate_with_wrenches(task, &places.unit_wrenches())
            .ok_or(SolveError::NoDerivatives)?;
        let wrenches = 6 * loaded.places().len();
        holes.linearise(task, chain, commands, wrenches).ok_or(SolveError::NoDerivatives)?;
        self.stands = negative.is_multiple_of(2) != holes.is_odd();
        tensions.clear();
        twists.clear();
        let count = task.tensions.len();
        for (k, column) in holes.columns().iter().enumerate() {
            tensions.extend_from_slice(column);
            let side = if k == 0 { 0 } else { count + k };
            places.twists(chain, task, side, twists);
        }
        add_cables(&places, (task, chain), tensions, twists);
        Ok(())
    }

    /// How the cross-sections of the pushes move with each component of each of them, by rows, and how with the step that
    /// is left, eq. (13).
    pub fn compliance(&self, compliance: &mut Vec<f64>, drift: &mut Vec<f64>) {
        compliance.clear();
        drift.clear();
        let at = self.loaded.places().len();
        let twist = |side: usize, place: usize| self.twists[side * at + place];
        self.loaded.compliance(
            |wrench, place| twist(1 + wrench, place),
            |place| twist(0, place),
            compliance,
            drift,
        );
    }

    /// Takes a part of the step that is left, with what changes of the wrenches do, or less: coordinates and tensions. The part
    /// that it has taken.
    pub fn advance(
        &self,
        chain: &mut Chain,
        tensions: &mut [f64],
        changes: &[[f64; 6]],
        part: f64,
    ) -> f64 {
        let count = tensions.len();
        let totals = self.loaded.totals(changes);
        let mut pulls = vec![0.0; count];
        for (weight, own) in [1.0].iter().chain(&totals).zip(self.tensions.chunks(count.max(1))) {
            pulls.iter_mut().zip(own).for_each(|(sum, own)| *sum += weight * own);
        }
        let part = chain.advance(&weights(&pulls, &totals), part);
        for (tension, pull) in tensions.iter_mut().zip(&pulls) {
            *tension = (*tension + part * pull).max(0.0);
        }
        part
    }

    /// The same of a chain whose cables rub.
    pub fn advance_rubbing(
        &self,
        chain: &mut Chain,
        (holes, commands): (&mut HolesInContact<'_>, &[Command]),
        changes: &[[f64; 6]],
        part: f64,
    ) -> f64 {
        let totals = self.loaded.totals(changes);
        let pulls = holes.follow(commands, &totals);
        let part = chain.advance(&weights(&pulls, &totals), part);
        holes.advance(&pulls, part);
        part
    }
}

/// The step, the tensions of the cables, the components of the wrenches: as the chain has them.
fn weights(pulls: &[f64], totals: &[f64]) -> Vec<f64> {
    [1.0].iter().chain(pulls).chain(totals).copied().collect()
}

/// Adds to each motion the part of the cables, whose tensions change like this with it.
fn add_cables(
    places: &Places<'_>,
    (task, chain): (&Task<'_>, &Chain),
    tensions: &[f64],
    twists: &mut [Twist],
) {
    let count = task.tensions.len();
    let at = twists.len() * count / tensions.len().max(1);
    let mut by_cable = Vec::with_capacity(at);
    for cable in 0..count {
        by_cable.clear();
        places.twists(chain, task, 1 + cable, &mut by_cable);
        for (own, moved) in tensions.chunks(count).zip(twists.chunks_mut(at.max(1))) {
            for (sum, by) in moved.iter_mut().zip(&by_cable) {
                *sum = *sum + *by * own[cable];
            }
        }
    }
}
