//! Motors with inertia under their position loops, eqs. (22) to (24) of the page on motion. Each is one equation of motion, coupled to the rod by the tensions of its
//! cables alone: its position at the end of a step is linear in these, and so is what it adds to the lengths that they are held to.

use whipcord::{Motor, MotorDynamics, Robot};

use crate::coefficients::OneStage;
use crate::commands::Commands;
use crate::scheme::Scheme;
use crate::state::MotorMotion;

/// The motors with inertia of a robot, in one stage.
#[derive(Clone, Debug, Default)]
pub(crate) struct Drives {
    pub motors: Vec<MotorStage>,
}

/// A motor in one stage.
#[derive(Clone, Debug)]
pub(crate) struct MotorStage {
    /// Its number in the robot.
    pub motor: usize,
    /// Whether a command drives it.
    pub is_driven: bool,
    dynamics: MotorDynamics,
    /// Greatest torque or force; infinite where there is no limit.
    limit: f64,
    /// Its cables, and by how much it shortens each for 1 rad or 1 m of its own.
    pulls: Vec<(usize, f64)>,
    /// Its position where it shortens no cable.
    offset: f64,
    set_point: f64,
    set_rate: f64,
    /// Position, velocity and integral of the error at the start of the step.
    start: [f64; 3],
    history: [f64; 3],
    /// Whether the integral goes on: not while the torque is at its limit and the error would take it further.
    integrates: bool,
}

/// Position at the end of a step: `at − by · T`, with what the cables take, `T = Σ ∂ℓ/∂θ τ`.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Response {
    at: f64,
    by: f64,
}

/// Values at a stage.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Solved {
    /// Position, velocity and integral of the error.
    values: [f64; 3],
    effort: f64,
}

/// What the motors gain and lose in a step, in J.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct MotorWork {
    /// What the loops give.
    pub control: f64,
    /// What friction takes.
    pub dissipated: f64,
}

impl Drives {
    pub fn new(robot: &Robot) -> Self {
        let motors = robot.motors().iter().enumerate();
        let of = |(motor, of): (usize, &Motor)| {
            let dynamics = of.dynamics?;
            let ratio = of.gear_ratio();
            Some(MotorStage {
                motor,
                is_driven: false,
                dynamics,
                limit: of.limits.effort.unwrap_or(f64::INFINITY),
                pulls: of.cables.iter().map(|of| (of.cable, of.pull() / ratio)).collect(),
                offset: of.offset,
                set_point: 0.0,
                set_rate: 0.0,
                start: [0.0; 3],
                history: [0.0; 3],
                integrates: true,
            })
        };
        Self { motors: motors.filter_map(of).collect() }
    }

    /// Takes up the set-points at a time, and which motors are driven.
    pub fn set(&mut self, commands: &Commands, time: f64) {
        for of in &mut self.motors {
            let course = commands.motors.get(of.motor).and_then(Option::as_ref);
            of.is_driven = course.is_some();
            if let Some(course) = course {
                of.set_point = course.before(time);
                of.set_rate = course.slope_before(time);
            }
        }
    }

    /// The motors with a command, each with its set-point.
    pub fn driven(&self) -> Vec<(usize, f64)> {
        let driven = self.motors.iter().filter(|of| of.is_driven);
        driven.map(|of| (of.motor, of.set_point)).collect()
    }

    /// Where these rest against the tensions of their cables.
    pub fn at_rest(&self, tensions: &[f64]) -> Vec<f64> {
        let driven = self.motors.iter().filter(|of| of.is_driven);
        driven.map(|of| of.at_rest(of.taken(tensions))).collect()
    }

    /// Whether a motor with inertia and a command drives a cable.
    pub fn moves(&self, cable: usize) -> bool {
        let of_cable = |of: &MotorStage| of.pulls.iter().any(|pull| pull.0 == cable);
        self.motors.iter().any(|of| of.is_driven && of_cable(of))
    }

    /// Begins a step from the motors of a state.
    pub fn begin(&mut self, from: &[MotorMotion], method: &OneStage, h: f64) {
        for of in &mut self.motors {
            let from = &from[of.motor];
            of.start = from.values();
            for ((history, value), rate) in of.history.iter_mut().zip(of.start).zip(from.rates) {
                *history = value + method.carried(h) * rate;
            }
            let error = of.set_point - from.position;
            of.integrates = from.effort.abs() < of.limit || from.effort * error <= 0.0;
        }
    }

    /// Adds what the motors do to the lengths of their cables: `target` is called with the place of a cable among those driven by their lengths and what its
    /// length has more, `coupling` with two places and how the tension of the second makes the first one longer.
    pub fn add_lengths(
        &self,
        scheme: &Scheme,
        cables: &[usize],
        tensions: &[f64],
        mut target: impl FnMut(usize, f64),
        mut coupling: impl FnMut(usize, usize, f64),
    ) {
        let place = |cable: usize| cables.iter().position(|of| *of == cable);
        for of in self.motors.iter().filter(|of| of.is_driven) {
            let response = of.response(scheme, of.taken(tensions));
            for &(cable, pull) in &of.pulls {
                let Some(i) = place(cable) else { continue };
                target(i, -pull * (response.at - of.offset));
                for &(other, by) in &of.pulls {
                    if let Some(j) = place(other) {
                        coupling(i, j, pull * by * response.by);
                    }
                }
            }
        }
    }

    /// Completes a step: writes the motors at its end, and returns what they have gained and lost.
    pub fn finish(
        &self,
        to: &mut [MotorMotion],
        method: &OneStage,
        h: f64,
        tensions: &[f64],
    ) -> MotorWork {
        let scheme = method.scheme(h);
        let mut work = MotorWork::default();
        for of in self.motors.iter().filter(|of| of.is_driven) {
            let Solved { values, effort } = of.solve(&scheme, of.taken(tensions));
            work.control += h * effort * values[1];
            work.dissipated += h * of.dynamics.damping * values[1] * values[1];
            let to = &mut to[of.motor];
            let mut ends = [0.0; 3];
            for (k, end) in ends.iter_mut().enumerate() {
                let from = [of.start[k], to.rates[k]];
                [*end, to.rates[k]] = method.end(&scheme, from, of.history[k], values[k]);
            }
            [to.position, to.velocity, to.integral] = ends;
        }
        work
    }

    /// Writes what the loops give at a time, for motors that are there.
    pub fn write_efforts(&mut self, commands: &Commands, time: f64, motors: &mut [MotorMotion]) {
        self.set(commands, time);
        for of in self.motors.iter().filter(|of| of.is_driven) {
            let motor = &mut motors[of.motor];
            motor.effort = of.wanted(motor.values()).clamp(-of.limit, of.limit);
        }
    }

    /// Puts motors in equilibrium with the tensions of their cables; the first one whose loop would need more than its limit, with what it needs.
    pub fn find_equilibrium(
        &self,
        to: &mut [MotorMotion],
        tensions: &[f64],
    ) -> Result<(), (usize, f64)> {
        for of in self.motors.iter().filter(|of| of.is_driven) {
            let taken = of.taken(tensions);
            if taken.abs() > of.limit {
                return Err((of.motor, taken));
            }
            let integral = of.dynamics.integral;
            to[of.motor] = MotorMotion {
                position: of.at_rest(taken),
                effort: taken,
                integral: if integral > 0.0 { taken / integral } else { 0.0 },
                ..MotorMotion::default()
            };
        }
        Ok(())
    }

    /// Adds what derivatives by the motors at the end of a step are by the tension of each cable at its stage, the lengths left as they are.
    pub fn add_by_tensions(
        &self,
        method: &OneStage,
        h: f64,
        tensions: &[f64],
        ends: &[MotorValues],
        out: &mut [f64],
    ) {
        for of in self.motors.iter().filter(|of| of.is_driven) {
            let by_taken = of.by_inputs(method, h, tensions, &ends[of.motor])[TAKEN];
            for &(cable, pull) in &of.pulls {
                out[cable] += pull * by_taken;
            }
        }
    }

    /// Turns derivatives by the motors at the end of a step into those at its start; `lengths` has those by the length that each cable is held to. `set_point`
    /// is called with the number of a motor and the derivatives by its set-point and by the length of the step.
    pub fn pull_back(
        &self,
        method: &OneStage,
        h: f64,
        tensions: &[f64],
        lengths: &[f64],
        motors: &mut [MotorValues],
        mut set_point: impl FnMut(usize, [f64; 2]),
    ) {
        for of in self.motors.iter().filter(|of| of.is_driven) {
            let mut ends = motors[of.motor];
            // What a motor turns further takes from the lengths of its cables.
            ends[0] -= of.pulls.iter().map(|&(cable, pull)| pull * lengths[cable]).sum::<f64>();
            let by = of.by_inputs(method, h, tensions, &ends);
            motors[of.motor].copy_from_slice(&by[..SET_POINT]);
            set_point(of.motor, [by[SET_POINT], by[LENGTH]]);
        }
    }

    /// What the motors at the end of a step change by, for changes at its start, of the set-points, of the length of the step and of the tensions at the stage. Of motors without a
    /// command nothing changes.
    pub fn push_forward(
        &self,
        method: &OneStage,
        h: f64,
        (tensions, changes): (&[f64], &[f64]),
        (set_point, length): (impl Fn(usize) -> f64, f64),
        motors: &mut [MotorValues],
    ) {
        for of in self.motors.iter().filter(|of| of.is_driven) {
            let mut inputs = [0.0; INPUTS];
            inputs[..SET_POINT].copy_from_slice(&motors[of.motor]);
            inputs[SET_POINT] = set_point(of.motor);
            inputs[LENGTH] = length;
            inputs[TAKEN] = of.taken(changes);
            motors[of.motor] = of.linear(method, h, tensions, &inputs);
        }
    }

    /// Adds what changes of the motors at the end of a step are to the length that each cable is held to.
    pub fn add_length_changes(&self, motors: &[MotorValues], out: &mut [f64]) {
        for of in self.motors.iter().filter(|of| of.is_driven) {
            for &(cable, pull) in &of.pulls {
                out[cable] -= pull * motors[of.motor][0];
            }
        }
    }

    /// Adds what derivatives by the motors in equilibrium are by the tension of each cable.
    pub fn add_by_tensions_at_rest(&self, motors: &[MotorValues], out: &mut [f64]) {
        for of in self.motors.iter().filter(|of| of.is_driven) {
            let MotorDynamics { proportional, integral, .. } = of.dynamics;
            let [position, _, of_integral, ..] = motors[of.motor];
            let by_taken =
                if integral > 0.0 { of_integral / integral } else { -position / proportional };
            for &(cable, pull) in &of.pulls {
                out[cable] += pull * by_taken;
            }
        }
    }

    /// What motors in equilibrium change by with the tensions of their cables.
    pub fn push_forward_at_rest(&self, changes: &[f64], motors: &mut [MotorValues]) {
        for of in self.motors.iter().filter(|of| of.is_driven) {
            let MotorDynamics { proportional, integral, .. } = of.dynamics;
            let taken = of.taken(changes);
            motors[of.motor] = if integral > 0.0 {
                [0.0, 0.0, taken / integral, 0.0, 0.0, 0.0]
            } else {
                [-taken / proportional, 0.0, 0.0, 0.0, 0.0, 0.0]
            };
        }
    }

    /// Kinetic energy in J.
    pub fn kinetic(&self, motors: &[MotorMotion]) -> f64 {
        let driven = self.motors.iter().filter(|of| of.is_driven);
        driven.map(|of| 0.5 * of.dynamics.inertia * motors[of.motor].velocity.powi(2)).sum()
    }
}

/// Numbers of a motor, or derivatives by them: position, velocity and integral of the error, and their rates.
pub(crate) type MotorValues = [f64; 6];
/// What a step of a motor is made from: its values, the set-point, what the cables take and the length of the step.
const INPUTS: usize = 9;
const SET_POINT: usize = 6;
const TAKEN: usize = 7;
const LENGTH: usize = 8;

impl MotorStage {
    /// What its values at the end of a step change by with what the step is made from, on this side of the limit. The equations are linear but for a constant torque,
    /// so that they are those of the step for the changes.
    fn linear(
        &self,
        method: &OneStage,
        h: f64,
        tensions: &[f64],
        inputs: &[f64; INPUTS],
    ) -> MotorValues {
        let scheme = method.scheme(h);
        let mut of = self.clone();
        let (_, _, effort) = self.velocity(scheme.g, self.taken(tensions));
        let at = self.solve(&scheme, self.taken(tensions)).values;
        if effort.abs() >= self.limit {
            let MotorDynamics { inertia, damping, .. } = self.dynamics;
            of.dynamics = MotorDynamics { damping, ..MotorDynamics::new(inertia, 0.0) };
        }
        of.limit = f64::INFINITY;
        of.start.copy_from_slice(&inputs[..3]);
        let rates = &inputs[3..6];
        for ((history, value), rate) in of.history.iter_mut().zip(of.start).zip(rates) {
            *history = value + method.carried(h) * rate;
        }
        // The values go from the start to the stage by sums of rates that the length multiplies.
        for (k, history) in of.history.iter_mut().enumerate() {
            *history += (at[k] - self.start[k]) / h * inputs[LENGTH];
        }
        (of.set_point, of.set_rate) = (inputs[SET_POINT], 0.0);
        let Solved { values, .. } = of.solve(&scheme, inputs[TAKEN]);
        let mut out = [0.0; 6];
        for k in 0..3 {
            [out[k], out[3 + k]] =
                method.end(&scheme, [of.start[k], rates[k]], of.history[k], values[k]);
        }
        out
    }

    /// Derivatives by what a step is made from, of a number with these derivatives by its end.
    fn by_inputs(
        &self,
        method: &OneStage,
        h: f64,
        tensions: &[f64],
        ends: &MotorValues,
    ) -> [f64; INPUTS] {
        core::array::from_fn(|k| {
            let mut unit = [0.0; INPUTS];
            unit[k] = 1.0;
            let found = self.linear(method, h, tensions, &unit);
            found.iter().zip(ends).map(|(a, b)| a * b).sum()
        })
    }

    /// What its cables take: a torque or a force.
    fn taken(&self, tensions: &[f64]) -> f64 {
        self.pulls.iter().map(|&(cable, pull)| pull * tensions[cable]).sum()
    }

    /// Where it rests against what its cables take.
    fn at_rest(&self, taken: f64) -> f64 {
        if self.dynamics.integral > 0.0 {
            return self.set_point;
        }
        self.set_point - taken / self.dynamics.proportional
    }

    /// What the loop would give without a limit, for position, velocity and integral.
    fn wanted(&self, [position, velocity, integral]: [f64; 3]) -> f64 {
        let MotorDynamics { proportional, derivative, integral: gain, .. } = self.dynamics;
        proportional * (self.set_point - position)
            + derivative * (self.set_rate - velocity)
            + gain * integral
    }

    /// Torque of the loop where the motor is at its history, and by how much less it is for a velocity of 1.
    fn loop_at(&self, g: f64) -> (f64, f64) {
        let MotorDynamics { proportional, derivative, integral: gain, .. } = self.dynamics;
        let [position, _, integral] = self.history;
        let stiffness = if self.integrates { proportional + g * gain } else { proportional };
        let at =
            stiffness * (self.set_point - position) + derivative * self.set_rate + gain * integral;
        (at, derivative + g * stiffness)
    }

    /// Eq. (23): the velocity at the stage and how much less it is for a torque of 1 taken by the cables, with the torque of the loop.
    fn velocity(&self, g: f64, taken: f64) -> (f64, f64, f64) {
        let MotorDynamics { inertia, damping, .. } = self.dynamics;
        let (push, resistance) = (inertia * self.history[1] / g, inertia / g + damping);
        let (at, less) = self.loop_at(g);
        let free = (push + at - taken) / (resistance + less);
        let effort = at - less * free;
        if effort.abs() <= self.limit {
            return (free, 1.0 / (resistance + less), effort);
        }
        let effort = effort.clamp(-self.limit, self.limit);
        ((push + effort - taken) / resistance, 1.0 / resistance, effort)
    }

    fn response(&self, scheme: &Scheme, taken: f64) -> Response {
        if scheme.inertia == 0.0 {
            let by =
                if self.dynamics.integral > 0.0 { 0.0 } else { 1.0 / self.dynamics.proportional };
            return Response { at: self.set_point, by };
        }
        let g = scheme.g;
        let (velocity, slope, _) = self.velocity(g, taken);
        let by = g * slope / scheme.place;
        // Straight through the end of the step for what the cables take now.
        let stage = self.history[0] + g * velocity;
        let end = self.start[0] + (stage - self.start[0]) / scheme.place;
        Response { at: end + by * taken, by }
    }

    fn solve(&self, scheme: &Scheme, taken: f64) -> Solved {
        let (velocity, _, effort) = self.velocity(scheme.g, taken);
        let position = self.history[0] + scheme.g * velocity;
        let error = if self.integrates { self.set_point - position } else { 0.0 };
        let integral = self.history[2] + scheme.g * error;
        Solved { values: [position, velocity, integral], effort }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stage(limit: f64) -> MotorStage {
        MotorStage {
            motor: 0,
            is_driven: true,
            dynamics: MotorDynamics {
                damping: 0.02,
                derivative: 0.05,
                integral: 2.0,
                ..MotorDynamics::new(1e-3, 0.7)
            },
            limit,
            pulls: vec![(0, 0.01)],
            offset: 0.0,
            set_point: 1.0,
            set_rate: 0.3,
            start: [0.2, -1.0, 0.01],
            history: [0.21, -0.9, 0.012],
            integrates: true,
        }
    }

    /// A stage meets the equation of motion with the torque of the loop, within its limit and at it; the response is the slope of the end by what the cables
    /// take.
    #[test]
    fn a_stage_meets_the_equation_of_motion() {
        let method = OneStage::generalised_alpha(0.5);
        let scheme = method.scheme(2e-3);
        for (limit, taken) in [(f64::INFINITY, 0.4), (0.3, 0.4), (0.3, -0.1), (10.0, 3.0)] {
            let of = stage(limit);
            let Solved { values, effort } = of.solve(&scheme, taken);
            let wanted = of.wanted(values);
            assert!((effort - wanted.clamp(-limit, limit)).abs() < 1e-12, "{effort} {wanted}");
            let acceleration = (values[1] - of.history[1]) / scheme.g;
            let rest = 1e-3 * acceleration - effort + 0.02 * values[1] + taken;
            assert!(rest.abs() < 1e-12, "{rest:e}");
            assert!((values[0] - of.history[0] - scheme.g * values[1]).abs() < 1e-15);
            let end = |taken| {
                method.end(&scheme, [of.start[0], 0.0], 0.0, of.solve(&scheme, taken).values[0])[0]
            };
            let response = of.response(&scheme, taken);
            let slope = (end(taken + 1e-4) - end(taken - 1e-4)) / 2e-4;
            assert!((slope + response.by).abs() < 1e-9, "{slope} {}", response.by);
            assert!((response.at - response.by * taken - end(taken)).abs() < 1e-14);
        }
    }
}
