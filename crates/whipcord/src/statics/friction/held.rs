//! The tensions of all passages while something else changes.
//!
//! In the cases that hold at the end of a substep, the equations of the holes are smooth. Their derivatives by the tensions `T` of all
//! passages and the tensions `τ` below the base, with how lengths `ℓ` and angles `φ` of the passages change with `T`, are
//!
//! ```text
//! δTᵢ − f δTᵢ₋₁ − f s μ Tᵢ₋₁ δφᵢ = f s φᵢ Tᵢ₋₁ δμ,   f = e^(s μ φᵢ)          where the cable slides            (4)
//! Σ_{k≥i} (δℓₖ − yₖ δTₖ) = δDᵢ(before) + Σ_{k≥i} Tₖ δyₖ,   yₖ = ℓₖ⁰/EA      where it sticks                 (5)
//! ```
//!
//! with `s = −1` where it slides towards the base and 1 where it slides towards the tip, and with `T₀ = τ`. Of a cable whose
//! tension is held `δτ` is given, of one whose length is held `δ(D₁ − T₁ c)` with the compliance `c` outside the robot.

use whipcord_numerics::dot;

use super::carried::Carried;
use super::holes::Holes;
use super::trail::{Standing, Trigger};
use crate::statics::hold::{Critical, Hold, LeastSystem, REGULARISATION};

/// The holes of an answer, in the cases that hold there.
#[derive(Clone, Debug)]
pub(crate) struct HeldHoles {
    holes: Holes,
    standing: Standing,
    /// How the lengths of all passages change with their tensions, and below how the angles do; by rows.
    by_tension: Vec<f64>,
    /// What is held of each cable, and the equations; what is held alike has the same.
    systems: Vec<(Vec<Held>, LeastSystem)>,
    of_hold: [usize; 3],
}

/// What is held of a cable at the base.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Held {
    Tension,
    Length,
}

/// What something changes in the equations of the holes at constant shape and tensions; shorter lists leave the others at zero.
#[derive(Clone, Debug, Default)]
pub(crate) struct HoleChange {
    /// Of the command of each cable: of its tension, or of the unstretched length inside the robot.
    pub commands: Vec<f64>,
    /// Of the tension of each cable, where tensions are held, and of the length, where lengths are.
    pub tensions: Vec<f64>,
    pub targets: Vec<f64>,
    /// Of the state of the holes before the substep.
    pub before: Carried,
    /// Of the friction coefficient of each cable.
    pub friction: Vec<f64>,
    /// Of `ℓ⁰/EA` of every passage, and of the compliance of each cable outside the robot.
    pub yielding: Vec<f64>,
    pub outside: Vec<f64>,
}

/// What a parameter or a command of the step changes in the equations of the holes by itself; shorter lists leave the others at zero.
#[derive(Clone, Debug, Default)]
pub(crate) struct HoleSource {
    /// Of the command of each cable at the end of the step, and of the length of each where that is held.
    pub commands: Vec<f64>,
    pub targets: Vec<f64>,
    /// Of the friction coefficient of each cable.
    pub friction: Vec<f64>,
    /// Of `ℓ⁰/EA` of every passage, and of its length at rest.
    pub yielding: Vec<f64>,
    pub rest: Vec<f64>,
    /// Of the compliance of each cable outside the robot.
    pub outside: Vec<f64>,
}

fn entry(list: &[f64], i: usize) -> f64 {
    list.get(i).copied().unwrap_or(0.0)
}

impl HoleSource {
    /// The command of a cable of the step: its tension in N, or its shortening in m.
    pub fn command(cable: usize, is_length: bool) -> Self {
        let mut commands = vec![0.0; cable + 1];
        commands[cable] = if is_length { -1.0 } else { 1.0 };
        Self { commands, ..Self::default() }
    }

    /// Of commands that are a part of the way from others, by which the parameter changes this.
    pub fn between(mut self, before: &Self, part: f64) -> Self {
        for (command, before) in self.commands.iter_mut().zip(&before.commands) {
            *command = before + part * (*command - before);
        }
        self
    }

    /// How the state of the robot at rest changes.
    pub fn at_rest(&self, holes: &Holes) -> Carried {
        let rest: Vec<f64> = (0..holes.count()).map(|p| entry(&self.rest, p)).collect();
        let beyond = holes.beyond(&rest, &vec![0.0; rest.len()]);
        let at_drive = holes.of_cable.iter().map(|passages| beyond[passages[0]]).collect();
        Carried { beyond, at_drive, ..Carried::default() }
    }
}

impl HeldHoles {
    /// For what is held in these ways. `by_tension` has the changes of the outputs with the tension of a passage: the lengths of all passages, then
    /// their angles, which are none of cables that rub nowhere.
    pub fn new<'a>(
        holes: &Holes,
        standing: &Standing,
        holds: &[Hold],
        by_tension: impl Fn(usize) -> &'a [f64],
    ) -> Result<Self, Critical> {
        let n = holes.count();
        let mut held = Self {
            holes: holes.clone(),
            standing: standing.clone(),
            by_tension: (0..2 * n * n).map(|k| entry(by_tension(k % n), k / n)).collect(),
            systems: Vec::new(),
            of_hold: [0; 3],
        };
        for &hold in holds {
            let number = Self::number(hold);
            let of: Vec<Held> = (0..holes.of_cable.len()).map(|c| held.at_base(hold, c)).collect();
            let known = held.systems.iter().position(|(other, _)| *other == of);
            held.of_hold[number] = match known {
                Some(known) => known,
                None => {
                    let system = held.system(&of)?;
                    held.systems.push((of, system));
                    held.systems.len() - 1
                }
            };
        }
        Ok(held)
    }

    /// Whether any cable rubs.
    pub fn rub(&self) -> bool {
        self.holes.rub()
    }

    /// How many passages there are.
    pub fn passages(&self) -> usize {
        self.holes.count()
    }

    /// The passages of a cable.
    pub fn of_cable(&self, cable: usize) -> &[usize] {
        &self.holes.of_cable[cable]
    }

    pub const fn is_about_to_change(&self) -> bool {
        self.standing.is_about_to_change
    }

    fn at_base(&self, hold: Hold, cable: usize) -> Held {
        let is_taut = match self.standing.trigger {
            Some(Trigger::Taut { cable: of }) if of == cable => false,
            Some(Trigger::Slack { cable: of }) if of == cable => true,
            _ => self.standing.tensions[self.holes.of_cable[cable][0]] > 0.0,
        };
        let is_length = match hold {
            Hold::Commands => self.standing.commands[cable].is_length(),
            Hold::Tensions => false,
            Hold::Lengths => true,
        };
        if is_length && is_taut { Held::Length } else { Held::Tension }
    }

    /// The tension of a passage before the near hole of the passage at a place of a cable, by its number among the unknowns.
    fn incoming(&self, (cable, place): (usize, usize)) -> (usize, f64) {
        match place.checked_sub(1) {
            Some(before) => {
                let before = self.holes.of_cable[cable][before];
                (before, self.standing.tensions[before])
            }
            None => (self.holes.count() + cable, self.standing.base[cable]),
        }
    }

    /// The row of a hole: that of the passage behind it, but of the base hole of a cable whose length is held, which that of the passage
    /// keeps, that of the tension below the base.
    fn row_of_hole(&self, of: &[Held], (cable, place): (usize, usize), p: usize) -> usize {
        if place == 0 && of[cable] == Held::Length { self.holes.count() + cable } else { p }
    }

    /// The row of what is held of a cable.
    fn row_of_base(&self, of: &[Held], cable: usize) -> usize {
        match of[cable] {
            Held::Tension => self.holes.count() + cable,
            Held::Length => self.holes.of_cable[cable][0],
        }
    }

    /// The equations where these are held.
    fn system(&self, of: &[Held]) -> Result<LeastSystem, Critical> {
        let Self { holes, standing, by_tension, .. } = self;
        let (n, kappa) = (holes.count(), holes.compliance);
        let size = n + holes.of_cable.len();
        let mut matrix = vec![0.0; size * size];
        let mut keeps_length = vec![false; size];
        let mut keep = |row: usize, passages: &[usize], matrix: &mut Vec<f64>| {
            keeps_length[row] = true;
            let row = &mut matrix[row * size..][..size];
            for &k in passages {
                for (entry, by) in row.iter_mut().zip(&by_tension[k * n..(k + 1) * n]) {
                    *entry += by;
                }
                row[k] -= holes.yielding[k];
            }
        };
        for ((cable, place), p) in holes.all() {
            let (incoming, tension) = self.incoming((cable, place));
            let row_of_hole = self.row_of_hole(of, (cable, place), p);
            match standing.slides[p] {
                Some(sign) => {
                    let coefficient = sign * holes.coefficients[cable];
                    let factor = (coefficient * standing.turns[p]).exp();
                    let row = &mut matrix[row_of_hole * size..][..size];
                    let weight = -kappa * factor * coefficient * tension;
                    for (entry, by) in row.iter_mut().zip(&by_tension[(n + p) * n..][..n]) {
                        *entry = weight * by;
                    }
                    row[p] += kappa;
                    row[incoming] -= kappa * factor;
                }
                // Its length is what is held at the base: the tension there stays.
                None if place == 0 && of[cable] == Held::Length => {
                    matrix[row_of_hole * size + incoming] = kappa;
                }
                None => keep(row_of_hole, &holes.of_cable[cable][place..], &mut matrix),
            }
        }
        for (cable, passages) in holes.of_cable.iter().enumerate() {
            let row = self.row_of_base(of, cable);
            match of[cable] {
                Held::Tension => matrix[row * size + row] = kappa,
                Held::Length => {
                    keep(row, passages, &mut matrix);
                    matrix[row * size + passages[0]] -= holes.outside[cable];
                }
            }
        }
        let greatest = by_tension[..n * n].iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        // Pieces that stick may hold one another at their lengths. The row of each is that of its first piece.
        let regular = |row: usize| if keeps_length[row] { -REGULARISATION * greatest } else { 0.0 };
        LeastSystem::new(size, matrix, regular)
    }

    const fn number(hold: Hold) -> usize {
        match hold {
            Hold::Commands => 0,
            Hold::Tensions => 1,
            Hold::Lengths => 2,
        }
    }

    fn of(&self, hold: Hold) -> &(Vec<Held>, LeastSystem) {
        &self.systems[self.of_hold[Self::number(hold)]]
    }

    /// The right-hand side of the equations, for what changes lengths and angles at constant tensions by `outputs`.
    fn right(&self, hold: Hold, outputs: &[f64], change: &HoleChange) -> Vec<f64> {
        let Self { holes, standing, .. } = self;
        let (n, kappa) = (holes.count(), holes.compliance);
        let mut right = vec![0.0; n + holes.of_cable.len()];
        let of = &self.of(hold).0;
        let kept = |passages: &[usize]| -> f64 {
            let own =
                |&k: &usize| standing.tensions[k] * entry(&change.yielding, k) - entry(outputs, k);
            passages.iter().map(own).sum()
        };
        for ((cable, place), p) in holes.all() {
            let (_, tension) = self.incoming((cable, place));
            right[self.row_of_hole(of, (cable, place), p)] = match standing.slides[p] {
                Some(sign) => {
                    let (mu, turn) = (sign * holes.coefficients[cable], standing.turns[p]);
                    let grown =
                        mu * entry(outputs, n + p) + sign * turn * entry(&change.friction, cable);
                    kappa * (mu * turn).exp() * tension * grown
                }
                None if place == 0 && of[cable] == Held::Length => {
                    kappa * entry(&change.before.base, cable)
                }
                None => entry(&change.before.beyond, p) + kept(&holes.of_cable[cable][place..]),
            };
        }
        for (cable, passages) in holes.of_cable.iter().enumerate() {
            let given = match (hold, of[cable]) {
                (Hold::Commands, Held::Length) => &change.commands,
                (_, Held::Length) => &change.targets,
                // Of a slack cable whose length is given nothing pulls.
                (Hold::Commands, _) if standing.commands[cable].is_length() => &[][..],
                (Hold::Commands, Held::Tension) => &change.commands,
                (_, Held::Tension) => &change.tensions,
            };
            right[self.row_of_base(of, cable)] = match of[cable] {
                Held::Length => {
                    let gives = standing.tensions[passages[0]] * entry(&change.outside, cable);
                    entry(given, cable) + kept(passages) + gives
                }
                Held::Tension => kappa * entry(given, cable),
            };
        }
        right
    }

    /// The changes of the tensions of all passages, and after them of the tensions below the base, that go with what changes lengths and
    /// angles at constant tensions by `outputs`, and the equations of the holes by `change`.
    pub fn tensions(&self, hold: Hold, outputs: &[f64], change: &HoleChange) -> Vec<f64> {
        self.of(hold).1.solve(&self.right(hold, outputs, change))
    }

    /// The way back: what each equation is worth, where the unknowns of [`Self::tensions`] are worth this.
    pub fn pull_back(&self, hold: Hold, worth: &[f64]) -> Vec<f64> {
        self.of(hold).1.solve_transposed(worth)
    }

    /// What the outputs are worth, where the equations are worth this.
    pub fn worth_of_outputs(&self, hold: Hold, equations: &[f64]) -> Vec<f64> {
        let Self { holes, standing, .. } = self;
        let n = holes.count();
        let of = &self.of(hold).0;
        let mut worth = vec![0.0; 2 * n];
        let keep = |passages: &[usize], row: usize, worth: &mut [f64]| {
            passages.iter().for_each(|&k| worth[k] -= equations[row]);
        };
        for ((cable, place), p) in holes.all() {
            let row = self.row_of_hole(of, (cable, place), p);
            match standing.slides[p] {
                Some(sign) => {
                    let mu = sign * holes.coefficients[cable];
                    let (_, tension) = self.incoming((cable, place));
                    let factor = (mu * standing.turns[p]).exp();
                    worth[n + p] += holes.compliance * factor * tension * mu * equations[row];
                }
                None if place == 0 && of[cable] == Held::Length => {}
                None => keep(&holes.of_cable[cable][place..], row, &mut worth),
            }
        }
        for (cable, passages) in holes.of_cable.iter().enumerate() {
            if of[cable] == Held::Length {
                keep(passages, self.row_of_base(of, cable), &mut worth);
            }
        }
        worth
    }

    /// What a change of the equations of the holes is worth.
    pub fn worth_of(&self, hold: Hold, equations: &[f64], change: &HoleChange) -> f64 {
        dot(&self.right(hold, &[], change), equations)
    }

    /// What goes on to the next substep, where tensions have changed so, and the lengths at constant tensions so.
    pub fn carry(&self, outputs: &[f64], tensions: &[f64], change: &HoleChange) -> Carried {
        let (n, standing) = (self.holes.count(), &self.standing);
        let by = |k: usize| dot(&self.by_tension[k * n..(k + 1) * n], tensions);
        let lengths: Vec<f64> = (0..n)
            .map(|k| entry(outputs, k) + by(k) - standing.tensions[k] * entry(&change.yielding, k))
            .collect();
        let beyond = self.holes.beyond(&lengths, &tensions[..n]);
        let at_drive = |(cable, passages): (usize, &Vec<usize>)| {
            let gives = standing.tensions[passages[0]] * entry(&change.outside, cable);
            self.holes.at_drive(cable, &beyond, &tensions[..n]) - gives
        };
        let at_drive = self.holes.of_cable.iter().enumerate().map(at_drive).collect();
        Carried { beyond, base: tensions[n..].to_vec(), at_drive, places: Vec::new() }
    }

    /// How `Dᵢ` change at the event that decides when the commands are here, of these changes of [`Self::carry`] at constant commands,
    /// with how tensions change, and lengths and angles at constant tensions.
    pub fn shift_to_event(
        &self,
        carried: &mut Carried,
        outputs: &[f64],
        tensions: &[f64],
        change: &HoleChange,
    ) {
        let Some(trigger) = self.standing.trigger else { return };
        let with_time =
            HoleChange { commands: self.standing.rates.clone(), ..HoleChange::default() };
        let rates = self.tensions(Hold::Commands, &[], &with_time);
        let moving = self.carry(&[], &rates, &with_time);
        let rate = self.distance(trigger, (&[], &rates), &moving, &with_time);
        let by = -self.distance(trigger, (outputs, tensions), carried, change) / rate;
        if by.is_finite() {
            carried.beyond.iter_mut().zip(&moving.beyond).for_each(|(x, rate)| *x += by * rate);
        }
    }

    /// How what is zero at an event changes.
    fn distance(
        &self,
        trigger: Trigger,
        (outputs, tensions): (&[f64], &[f64]),
        carried: &Carried,
        change: &HoleChange,
    ) -> f64 {
        let Self { holes, standing, by_tension, .. } = self;
        let n = holes.count();
        match trigger {
            Trigger::Slides { cable, place, sign } => {
                let p = holes.of_cable[cable][place];
                let (before, incoming) = self.incoming((cable, place));
                let (mu, turn) = (sign * holes.coefficients[cable], standing.turns[p]);
                let turned = entry(outputs, n + p)
                    + dot(&by_tension[(n + p) * n..(n + p + 1) * n], tensions);
                let grown = mu * turned + sign * turn * entry(&change.friction, cable);
                tensions[p] - (mu * turn).exp() * (tensions[before] + incoming * grown)
            }
            Trigger::Slack { cable } => tensions[holes.of_cable[cable][0]],
            Trigger::Taut { cable } => {
                entry(&carried.at_drive, cable) - entry(&change.commands, cable)
            }
        }
    }

    /// What a source changes in the equations of the holes, where it has changed the state before the substep so.
    pub fn change(&self, source: &HoleSource, before: &Carried) -> HoleChange {
        let fraction = self.standing.fraction;
        let start = |cable: usize| match self.standing.commands[cable].is_length() {
            true => entry(&before.at_drive, cable),
            false => entry(&before.base, cable),
        };
        let command =
            |c: usize| fraction * entry(&source.commands, c) + (1.0 - fraction) * start(c);
        HoleChange {
            commands: (0..self.holes.of_cable.len()).map(command).collect(),
            tensions: Vec::new(),
            targets: source.targets.clone(),
            before: before.clone(),
            friction: source.friction.clone(),
            yielding: source.yielding.clone(),
            outside: source.outside.clone(),
        }
    }
}
