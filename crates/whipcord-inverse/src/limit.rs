//! Limits of an answer that are not bounds of single unknowns, as constraints with their derivatives.

use whipcord::derivatives::Place;
use whipcord::{Drive, Obstacle, Robot, Solution};

use crate::actuator::{Actuator, Actuators};
use crate::evaluation::Evaluation;
use crate::forward::Forward;
use crate::limits::Limits;
use crate::linear::Linear;

/// A limit that an answer can meet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Limit {
    /// The least command of an actuator, by its number.
    LeastCommand(usize),
    /// The greatest command of an actuator, by its number.
    GreatestCommand(usize),
    /// The least tension of a cable.
    LeastTension(usize),
    /// The greatest tension of a cable.
    GreatestTension(usize),
    /// The least shortening of a cable.
    LeastShortening(usize),
    /// The greatest shortening of a cable.
    GreatestShortening(usize),
    /// The torque of a motor, or the force of a linear drive.
    Effort(usize),
    /// The clearance from an obstacle, by its number.
    Clearance(usize),
}

/// A number of an answer that is limited.
#[derive(Clone, Copy, Debug)]
enum Quantity {
    Tension(usize),
    Shortening(usize),
    Effort(usize),
}

/// A constraint `factor × quantity ≤ greatest` of an answer.
#[derive(Clone, Copy, Debug)]
struct Constraint {
    limit: Limit,
    quantity: Quantity,
    factor: f64,
    greatest: f64,
    /// What a violation is relative to.
    range: f64,
}

/// All constraints of an inverse problem.
#[derive(Clone, Debug, Default)]
pub(crate) struct Constraints {
    list: Vec<Constraint>,
    clearance: Option<Clearance>,
}

/// Keeps the cross-sections of the disks, and of the places between them, at a distance from obstacles.
#[derive(Clone, Debug)]
pub(crate) struct Clearance {
    pub obstacles: Vec<Obstacle>,
    /// In m.
    pub margin: f64,
    /// Radius in m of the cross-section at each station.
    pub radii: Vec<f64>,
    /// What a violation is relative to, in m.
    pub range: f64,
}

/// Part of a range that constraints are kept inside of their limits, so that rounding violates none.
const INSIDE: f64 = 1e-7;

impl Constraints {
    /// `asked` has the bounds of the values of the actuators, which are constraints where the unknowns are tensions.
    pub fn new(
        robot: &Robot,
        actuators: &Actuators,
        asked: &[[f64; 2]],
        limits: &Limits,
        knows_tensions: bool,
        clearance: Option<Clearance>,
    ) -> Self {
        let mut list = Vec::new();
        let mut both =
            |quantity: Quantity, factor: f64, [least, greatest]: [f64; 2], limits: [Limit; 2]| {
                let range = match (least.is_finite(), greatest.is_finite()) {
                    (true, true) if greatest > least => greatest - least,
                    (_, true) => greatest.abs(),
                    _ => least.abs(),
                };
                let range = if range > 0.0 && range.is_finite() { range } else { 1.0 };
                if least.is_finite() {
                    let (factor, greatest) = (-factor, -least);
                    list.push(Constraint { limit: limits[0], quantity, factor, greatest, range });
                }
                if greatest.is_finite() {
                    list.push(Constraint { limit: limits[1], quantity, factor, greatest, range });
                }
            };
        for (cable, of) in limits.cables.iter().enumerate() {
            if knows_tensions && !actuators.asked.contains(&Actuator::Tension(cable)) {
                // No tension is negative.
                let least = if of.tension[0] > 0.0 { of.tension[0] } else { f64::NEG_INFINITY };
                let limits = [Limit::LeastTension(cable), Limit::GreatestTension(cable)];
                both(Quantity::Tension(cable), 1.0, [least, of.tension[1]], limits);
            }
            if !actuators.asked.contains(&Actuator::Shortening(cable)) {
                let limits = [Limit::LeastShortening(cable), Limit::GreatestShortening(cable)];
                both(Quantity::Shortening(cable), 1.0, of.shortening, limits);
            }
        }
        if !actuators.are_direct() {
            for (number, (actuator, bounds)) in actuators.asked.iter().zip(asked).enumerate() {
                let limits = [Limit::LeastCommand(number), Limit::GreatestCommand(number)];
                for (cable, rate) in actuator.cables(robot) {
                    let quantity = match actuator {
                        Actuator::Tension(_) => continue,
                        Actuator::Shortening(_) | Actuator::Motor(_) => Quantity::Shortening(cable),
                    };
                    both(quantity, 1.0 / rate, *bounds, limits);
                }
            }
        }
        if knows_tensions {
            for (number, motor) in robot.motors().iter().enumerate() {
                if let Some(greatest) = motor.limits.effort {
                    let limits = [Limit::Effort(number); 2];
                    both(Quantity::Effort(number), 1.0, [-greatest, greatest], limits);
                }
            }
        }
        Self { list, clearance }
    }

    /// The places whose motions they depend on, by stations.
    pub fn places(&self) -> Vec<Place> {
        let stations = self.clearance.as_ref().map_or(0, |clearance| clearance.radii.len());
        (0..stations).map(Place::Station).collect()
    }

    /// Writes slacks and rates of an evaluation whose motions of [`Self::places`] begin at `first`.
    pub fn linearize(
        &self,
        robot: &Robot,
        evaluation: &Evaluation,
        first: usize,
        into: &mut Linear,
    ) {
        into.slack.clear();
        into.rows.clear();
        for constraint in &self.list {
            let Some(slack) = constraint.slack(robot, evaluation) else { continue };
            into.slack.push(slack - INSIDE);
            let rates =
                (0..evaluation.rates.motions.len()).map(|k| constraint.rate(robot, evaluation, k));
            into.rows.extend(rates);
        }
        let Some(clearance) = &self.clearance else { return };
        for (station, _, distance, normal) in clearance.nearest(&evaluation.solution) {
            into.slack.push(distance / clearance.range - INSIDE);
            for motions in &evaluation.rates.motions {
                let rate = normal.dot(motions[first + station].linear);
                into.rows.push(-rate / clearance.range);
            }
        }
    }

    /// The limits that an answer meets: those of the constraints, and the bounds of the unknowns.
    pub fn met(
        &self,
        forward: &Forward,
        evaluation: &Evaluation,
        unknowns: &[f64],
        bounds: &[[f64; 2]],
    ) -> Vec<Limit> {
        let (mut met, _) = self.active(forward.robot(), evaluation);
        for (k, (x, [least, greatest])) in unknowns.iter().zip(bounds).enumerate() {
            let near = 1e-9 * forward.scales[k];
            let limits = match forward.actuators.list[k] {
                Actuator::Tension(cable) if !forward.actuators.are_direct() => {
                    [Limit::LeastTension(cable), Limit::GreatestTension(cable)]
                }
                _ => [Limit::LeastCommand(k), Limit::GreatestCommand(k)],
            };
            let limit = if x - least <= near {
                limits[0]
            } else if greatest - x <= near {
                limits[1]
            } else {
                continue;
            };
            if !met.contains(&limit) {
                met.push(limit);
            }
        }
        met
    }

    /// The limits that an answer meets by its constraints, and whether it exceeds one.
    pub fn active(&self, robot: &Robot, evaluation: &Evaluation) -> (Vec<Limit>, bool) {
        const ACTIVE: f64 = 1e-6;
        let mut active = Vec::new();
        let mut is_exceeded = false;
        let mut note = |limit: Limit, slack: f64| {
            is_exceeded |= slack < 0.0;
            if slack <= ACTIVE && !active.contains(&limit) {
                active.push(limit);
            }
        };
        for constraint in &self.list {
            if let Some(slack) = constraint.slack(robot, evaluation) {
                note(constraint.limit, slack);
            }
        }
        if let Some(clearance) = &self.clearance {
            for (_, obstacle, distance, _) in clearance.nearest(&evaluation.solution) {
                note(Limit::Clearance(obstacle), distance / clearance.range);
            }
        }
        (active, is_exceeded)
    }

    /// The least distance from an obstacle beyond the margin in m.
    pub fn least_clearance(&self, solution: &Solution) -> Option<f64> {
        let clearance = self.clearance.as_ref()?;
        let distances = clearance.nearest(solution).map(|(_, _, distance, _)| distance);
        distances.min_by(f64::total_cmp).map(|least| least + clearance.margin)
    }
}

impl Clearance {
    /// For each station its nearest obstacle: station, obstacle, distance beyond the margin and the normal of the obstacle.
    fn nearest<'a>(
        &'a self,
        solution: &'a Solution,
    ) -> impl Iterator<Item = (usize, usize, f64, whipcord::Vec3)> + 'a {
        self.radii.iter().zip(&solution.shape.poses).enumerate().filter_map(
            |(station, (radius, pose))| {
                let of = |(number, obstacle): (usize, &Obstacle)| {
                    let surface = obstacle.surface(pose.position);
                    (station, number, surface.distance - radius - self.margin, surface.normal)
                };
                let all = self.obstacles.iter().enumerate().map(of);
                all.min_by(|a, b| a.2.total_cmp(&b.2))
            },
        )
    }
}

impl Constraint {
    /// What is left of the range; `None` of a model that does not know the quantity.
    fn slack(&self, robot: &Robot, evaluation: &Evaluation) -> Option<f64> {
        let value = match self.quantity {
            Quantity::Tension(cable) => evaluation.tensions[cable],
            Quantity::Shortening(cable) => Some(evaluation.shortenings[cable]),
            Quantity::Effort(motor) => {
                robot.motors()[motor].effort(|cable| evaluation.tensions[cable])
            }
        };
        value.map(|value| (self.greatest - self.factor * value) / self.range)
    }

    /// The rate at which an unknown uses it up.
    fn rate(&self, robot: &Robot, evaluation: &Evaluation, unknown: usize) -> f64 {
        let tensions = &evaluation.rates.tension_rates[unknown];
        let rate = match self.quantity {
            Quantity::Tension(cable) => tensions[cable],
            Quantity::Shortening(cable) => evaluation.rates.shortening_rates[unknown][cable],
            Quantity::Effort(motor) => {
                robot.motors()[motor].effort(|cable| Some(tensions[cable])).unwrap_or(0.0)
            }
        };
        self.factor * rate / self.range
    }
}

impl Limit {
    /// As in JSON.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::LeastCommand(_) => "least_command",
            Self::GreatestCommand(_) => "greatest_command",
            Self::LeastTension(_) => "least_tension",
            Self::GreatestTension(_) => "greatest_tension",
            Self::LeastShortening(_) => "least_shortening",
            Self::GreatestShortening(_) => "greatest_shortening",
            Self::Effort(_) => "effort",
            Self::Clearance(_) => "clearance",
        }
    }

    /// The number of its actuator, cable, motor or obstacle.
    #[must_use]
    pub const fn of(self) -> usize {
        match self {
            Self::LeastCommand(of)
            | Self::GreatestCommand(of)
            | Self::LeastTension(of)
            | Self::GreatestTension(of)
            | Self::LeastShortening(of)
            | Self::GreatestShortening(of)
            | Self::Effort(of)
            | Self::Clearance(of) => of,
        }
    }

    /// In words, with the names of the robot.
    #[must_use]
    pub fn words(self, robot: &Robot, actuators: &[Actuator]) -> String {
        let cable = |cable: usize| &robot.cables()[cable].name;
        let command = |number: usize| match actuators[number] {
            Actuator::Tension(of) => format!("tension of cable {}", cable(of)),
            Actuator::Shortening(of) => format!("shortening of cable {}", cable(of)),
            Actuator::Motor(of) => {
                let motor = &robot.motors()[of];
                format!("{} of motor {}", motor.drive.keys().command, motor.name)
            }
        };
        match self {
            Self::LeastCommand(number) => format!("least {}", command(number)),
            Self::GreatestCommand(number) => format!("greatest {}", command(number)),
            Self::LeastTension(of) => format!("least tension of cable {}", cable(of)),
            Self::GreatestTension(of) => format!("greatest tension of cable {}", cable(of)),
            Self::LeastShortening(of) => format!("least shortening of cable {}", cable(of)),
            Self::GreatestShortening(of) => format!("greatest shortening of cable {}", cable(of)),
            Self::Effort(of) => {
                let motor = &robot.motors()[of];
                let what = match motor.drive {
                    Drive::Spool { .. } => "torque",
                    Drive::Linear => "force",
                };
                format!("{what} of motor {}", motor.name)
            }
            Self::Clearance(obstacle) => format!("clearance from obstacle {}", obstacle + 1),
        }
    }
}
