//! Changes of a recorded motion with what made it, section "Gradients" of the page on motion: the linearised stages of its steps, forwards. The transpose of
//! [`crate::gradient`].

use whipcord_numerics::{Twist, Vec3};

use crate::accurate;
use crate::adjoint::{Factors, NotSolved};
use crate::block::add;
use crate::coefficients::OneStage;
use crate::commands::Commands;
use crate::error::{MotionError, count};
use crate::free_base::BaseTangent;
use crate::gradient::{
    Costate as Change, Gradient, Part, Record, Seed, Shift, motor_slope, tension_slope,
};
use crate::iteration::Mechanics;
use crate::options::Method;
use crate::pose;
use crate::scheme::Scheme;
use crate::simulation::Simulation;
use crate::state::State;
use crate::tangent::StageTangent;

impl Simulation {
    /// What the states of a recorded motion change by, for changes of commands, start and properties of the robot: the product of the Jacobian with a direction, where
    /// [`Self::gradient`] is that of its transpose. Each number of the direction stands where the gradient has the derivative by it, and each number of the changes where
    /// a seed has the weight of it; an empty list stands for zeros. A change of the strains to start from does nothing to a motion that starts in equilibrium. The state of
    /// the simulation stays what it is.
    ///
    /// # Errors
    /// [`MotionError::Count`] where the direction does not fit the record, [`MotionError::NoGradient`] where the linearisation of a step is singular,
    /// [`MotionError::NotSmooth`] where the robot grazes an obstacle.
    pub fn tangent(
        &mut self,
        record: &Record,
        direction: &Gradient,
    ) -> Result<Vec<Seed>, MotionError> {
        let steps = record.commands.len();
        let (nodes, points) = (self.rod.nodes.len(), self.rod.points.len());
        for (what, given, expected) in [
            ("steps of cables of a direction", direction.cables.len(), steps),
            ("steps of motors of a direction", direction.motors.len(), steps),
            ("velocities of a direction", direction.velocities.len(), nodes),
            ("strains of a direction", direction.strains.len(), points),
        ] {
            if given != 0 {
                count(what, given, expected)?;
            }
        }
        let (cables, motors) = (self.rod.cables.len(), self.robot.motors().len());
        for step in &direction.cables {
            count("cables of a direction", step.len(), cables)?;
        }
        for step in &direction.motors {
            count("motors of a direction", step.len(), motors)?;
        }
        let kept = self.state.clone();
        let found = self.forwards(record, direction);
        self.state.copy_from(&kept);
        found
    }

    fn forwards(
        &mut self,
        record: &Record,
        direction: &Gradient,
    ) -> Result<Vec<Seed>, MotionError> {
        let (cables, motors) = (self.rod.cables.len(), self.robot.motors().len());
        let mut tangent = StageTangent::new(&self.rod);
        let mut change = self.costate();
        if !direction.velocities.is_empty() {
            change.velocities.copy_from_slice(&direction.velocities);
        }
        if !self.loads.has_free_base {
            change.velocities[0] = Twist::default();
        }
        let Some(start) = record.states.first() else { return Ok(Vec::new()) };
        if record.start_follows() {
            self.equilibrium_forwards(start, &mut tangent, &mut change, &direction.factors)?;
        } else if !record.from_equilibrium && !direction.strains.is_empty() {
            change.strains.copy_from_slice(&direction.strains);
        }
        let mut changes = vec![self.change_of(start, &change)];
        let (still, held) = (vec![0.0; cables], vec![0.0; motors]);
        for (k, parts) in record.parts.iter().enumerate() {
            let of_cables = direction.cables.get(k).unwrap_or(&still);
            let of_motors = direction.motors.get(k).unwrap_or(&held);
            for part in parts {
                let of = (&record.commands[k], part);
                let told = (of_cables.as_slice(), of_motors.as_slice());
                self.part_forwards(of, told, &mut tangent, &mut change, &direction.factors)?;
            }
            changes.push(self.change_of(&record.states[k + 1], &change));
        }
        Ok(changes)
    }

    /// What a state changes by, in the world.
    fn change_of(&mut self, state: &State, change: &Change) -> Seed {
        let Self { rod, solver, base, .. } = self;
        let poses = &mut solver.stage.poses;
        pose::nodes(rod, state.base, &state.strains, poses);
        let mut seed = Seed {
            positions: vec![Vec3::ZERO; poses.len()],
            turns: vec![Vec3::ZERO; poses.len()],
            velocities: change.velocities.clone(),
            strains: change.strains.clone(),
        };
        let changes = (change.base, change.strains.as_slice());
        pose::exact_displacements(rod, &state.strains, poses, changes, |a, turn, shift| {
            seed.positions[a] = base.rotation.rotate(shift);
            seed.turns[a] = base.rotation.rotate(turn);
        });
        seed
    }

    fn part_forwards(
        &mut self,
        of: (&Commands, &Part),
        told: (&[f64], &[f64]),
        tangent: &mut StageTangent,
        change: &mut Change,
        factors: &Factors,
    ) -> Result<(), MotionError> {
        let length = self.length_forwards(of, told, tangent, change, factors)?;
        self.places_forwards(of, length, told, tangent, change, factors)?;
        self.solved_forwards(of, length, told, tangent, change, factors)
    }

    /// The part that the solver has solved, whose length changes by `length`.
    pub(crate) fn solved_forwards(
        &mut self,
        (commands, part): (&Commands, &Part),
        length: f64,
        (cables, motors): (&[f64], &[f64]),
        tangent: &mut StageTangent,
        change: &mut Change,
        factors: &Factors,
    ) -> Result<(), MotionError> {
        let fails = || MotionError::NoGradient { time: part.before.time };
        let shift = Shift { start: change.time, length };
        let end = part.before.time + part.length;
        for (motor, output) in change.outputs.iter_mut().enumerate() {
            if self.drive_moves(commands, part, motor) {
                let later = motor_slope(commands, motor, end) * shift.at(1.0);
                *output = (motors[motor] + later) / self.robot.motors()[motor].gear_ratio();
            }
        }
        for i in 0..cables.len() {
            let shortening = match commands.motor_of(&self.robot, i) {
                None => cables[i] + commands.cables[i].course().slope_before(end) * shift.at(1.0),
                // Those with inertia turn by what they are told and by the motion.
                Some((motor, _)) if self.robot.motors()[motor].dynamics.is_some() => 0.0,
                Some((motor, _)) => self.pull(motor, i) * change.outputs[motor],
            };
            tangent.cables[i] =
                if self.is_by_length(commands, i) { -shortening } else { cables[i] };
        }
        match self.next.diagnostics.method {
            Method::Accurate => {
                let of = (commands, part, shift);
                self.stages_forwards(of, cables, tangent, change, factors)
            }
            _ => {
                let method = part.method(self.next.diagnostics.method);
                let of = (commands, part, &method, shift);
                self.one_stage_forwards(of, (cables, motors), tangent, change, factors)
            }
        }
        .map_err(|_| fails())?;
        for i in 0..cables.len() {
            if !self.is_by_length(commands, i) {
                change.tensions[i] = cables[i] + tension_slope(commands, i, end) * shift.at(1.0);
            }
        }
        change.time = shift.at(1.0);
        if let Some([velocity, rate]) = self.loads.led_base(end) {
            // Where it is follows from the time alone.
            change.base = velocity * change.time;
            change.velocities[0] = rate * change.time;
        }
        Ok(())
    }

    /// The stages of `accurate`.
    fn stages_forwards(
        &mut self,
        (commands, part, shift): (&Commands, &Part, Shift),
        cables: &[f64],
        tangent: &mut StageTangent,
        change: &mut Change,
        factors: &Factors,
    ) -> Result<(), NotSolved> {
        let h = part.length;
        tangent.length = shift.length;
        let scheme = Scheme::at_end(accurate::GAMMA * h);
        let inverse = 1.0 / scheme.g;
        let mut velocity_rates: Vec<Vec<Twist>> = Vec::with_capacity(accurate::STAGES);
        let mut strain_rates: Vec<Vec<Twist>> = Vec::with_capacity(accurate::STAGES);
        let mut base_rates = Vec::with_capacity(accurate::STAGES);
        let mut base = change.base;
        for i in 0..accurate::STAGES {
            let free = self.put_stage(commands, part, i)?;
            let time = part.before.time + accurate::C[i] * h;
            tangent.time = [time, shift.at(accurate::C[i])];
            for (j, (out, by)) in tangent.cables.iter_mut().zip(cables).enumerate() {
                *out = by + tension_slope(commands, j, time) * tangent.time[1];
            }
            let history = |from: &[Twist], rates: &[Vec<Twist>]| {
                let mut out = from.to_vec();
                for (rate, a) in rates.iter().zip(&accurate::A[i]) {
                    add(&mut out, rate, h * a);
                }
                out
            };
            let mut velocities = history(&change.velocities, &velocity_rates);
            let mut strains = history(&change.strains, &strain_rates);
            self.add_to_histories(part, shift.length, &mut velocities, &mut strains);
            tangent.velocities.copy_from_slice(&velocities);
            tangent.strains.copy_from_slice(&strains);
            tangent.start.copy_from_slice(&change.strains);
            tangent.base_by_velocity = free.as_ref().map(BaseTangent::pose_by_velocity);
            let weighted = base_rates.iter().zip(&accurate::A[i]);
            let exponent = weighted
                .fold(Twist::default(), |sum, (rate, a): (&Twist, _)| sum + *rate * (h * a));
            let longer = free.as_ref().map_or(Twist::default(), |of| of.exponent);
            let exponent = exponent + longer * (shift.length / h);
            let known = free.as_ref().map_or(Twist::default(), |of| {
                of.pose_by_start.apply(&change.base) + of.pose_by_history().apply(&exponent)
            });
            tangent.base = known;
            tangent.end_by_velocity = None;
            tangent.base_ends = [Twist::default(); 2];
            self.lead(tangent);
            let Self { rod, loads, solver, .. } = self;
            tangent.push_forward(Mechanics { rod, loads }, solver, &scheme, factors)?;
            if let Some(of) = &free {
                let velocity = tangent.velocities[0];
                base = known + of.pose_by_velocity().apply(&velocity);
                let moved = of.exponent_by_history.apply(&exponent)
                    + of.exponent_by_velocity.apply(&velocity);
                base_rates.push((moved - exponent) * inverse);
            }
            let rates = |now: &[Twist], history: &[Twist]| -> Vec<Twist> {
                now.iter().zip(history).map(|(a, b)| (*a - *b) * inverse).collect()
            };
            velocity_rates.push(rates(&tangent.velocities, &velocities));
            strain_rates.push(rates(&tangent.strains, &strains));
        }
        change.velocities.copy_from_slice(&tangent.velocities);
        change.strains.copy_from_slice(&tangent.strains);
        change.velocity_rates = velocity_rates.pop().unwrap_or_default();
        change.strain_rates = strain_rates.pop().unwrap_or_default();
        change.base = base;
        Ok(())
    }

    /// A step by a method with one stage, which the solver has solved.
    fn one_stage_forwards(
        &mut self,
        (commands, part, method, shift): (&Commands, &Part, &OneStage, Shift),
        (cables, motors): (&[f64], &[f64]),
        tangent: &mut StageTangent,
        change: &mut Change,
        factors: &Factors,
    ) -> Result<(), NotSolved> {
        let h = part.length;
        let scheme = method.scheme(h);
        let back = method.backwards(&scheme, h);
        let bases = self.half_bases(part, method)?;
        let history = |from: &[Twist], rates: &[Twist]| {
            let mut out = from.to_vec();
            add(&mut out, rates, back.carried);
            out
        };
        let mut velocities = history(&change.velocities, &change.velocity_rates);
        let mut strains = history(&change.strains, &change.strain_rates);
        self.add_to_histories(part, shift.length, &mut velocities, &mut strains);
        let time = method.time(part.before.time, h);
        (tangent.time, tangent.length) = ([time, shift.at(method.place)], shift.length);
        for (i, out) in tangent.cables.iter_mut().enumerate() {
            if !self.is_by_length(commands, i) {
                *out = cables[i] + tension_slope(commands, i, time) * shift.at(method.place);
            }
        }
        tangent.velocities.copy_from_slice(&velocities);
        tangent.strains.copy_from_slice(&strains);
        tangent.start.copy_from_slice(&change.strains);
        tangent.tensions.copy_from_slice(&change.tensions);
        tangent.base_by_velocity = bases.as_ref().map(|[_, (of, _)]| of.pose_by_velocity());
        let start_velocity = change.velocities[0];
        let known = |(of, g): &(BaseTangent, f64)| {
            let history = start_velocity * *g + of.exponent * (shift.length / h);
            of.pose_by_start.apply(&change.base) + of.pose_by_history().apply(&history)
        };
        tangent.base = bases.as_ref().map_or(Twist::default(), |[_, of]| known(of));
        tangent.end_by_velocity =
            bases.as_ref().map(|[(of, _), _]| of.pose_by_velocity().scaled(1.0 / method.place));
        let carried = 1.0 - 1.0 / method.place;
        let end = bases.as_ref().map_or(Twist::default(), |[of, _]| {
            known(of) + of.0.pose_by_velocity().apply(&(start_velocity * carried))
        });
        tangent.base_ends = [change.base, end];
        self.lead(tangent);
        if let Some([velocity, _]) = self.loads.led_base(part.before.time + h) {
            tangent.base_ends[1] = velocity * shift.at(1.0);
        }
        let Self { rod, loads, solver, .. } = self;
        // Where the motors come to if the tensions stay, then what these make of it.
        let tensions = solver.stage.tensions.clone();
        let still = vec![0.0; tensions.len()];
        let mut free = change.motors.clone();
        let set_point = |motor: usize| {
            motors[motor] + motor_slope(commands, motor, time) * shift.at(method.place)
        };
        let drives = &solver.lengths.drives;
        drives.push_forward(method, h, (&tensions, &still), (&set_point, shift.length), &mut free);
        drives.add_length_changes(&free, &mut tangent.cables);
        tangent.beyond.clone_from(&change.beyond);
        tangent.push_forward(Mechanics { rod, loads }, solver, &scheme, factors)?;
        change.beyond.clone_from(&tangent.beyond);
        let changes = (tensions.as_slice(), tangent.stage_tensions.as_slice());
        let drives = &solver.lengths.drives;
        drives.push_forward(method, h, changes, (set_point, shift.length), &mut change.motors);
        let end = |of: &mut [Twist], rates: &mut [Twist], at: &[Twist], history: &[Twist]| {
            for j in 0..of.len() {
                let by_stage = (at[j] - history[j]) * back.stage_by_rate;
                rates[j] = rates[j] * back.rate_by_rate + by_stage;
                of[j] = of[j] + (at[j] - of[j]) * back.stage_by_end;
            }
        };
        let of_base = bases.as_ref().map(|[of, _]| (known(of), of.0.pose_by_velocity()));
        end(&mut change.velocities, &mut change.velocity_rates, &tangent.velocities, &velocities);
        end(&mut change.strains, &mut change.strain_rates, &tangent.strains, &strains);
        if let Some((known, by_velocity)) = of_base {
            change.base = known + by_velocity.apply(&change.velocities[0]);
        }
        change.tensions.copy_from_slice(&tangent.tensions);
        Ok(())
    }

    /// What a base that is led changes by at a stage that is later.
    fn lead(&self, tangent: &mut StageTangent) {
        let [time, later] = tangent.time;
        tangent.led = Twist::default();
        if let Some([velocity, rate]) = self.loads.led_base(time) {
            (tangent.base, tangent.led) = (velocity * later, rate * later);
        }
    }

    /// Adds what the histories of a stage in the solver change by with the length of its part: both go from the start to the stage by sums of rates that the length multiplies.
    fn add_to_histories(
        &self,
        part: &Part,
        length: f64,
        velocities: &mut [Twist],
        strains: &mut [Twist],
    ) {
        let (stage, from, factor) = (&self.solver.stage, &part.before, length / part.length);
        let of = |out: &mut [Twist], at: &[Twist], from: &[Twist]| {
            add(out, at, factor);
            add(out, from, -factor);
        };
        let free = self.loads.first_free()..;
        let (out, at) = (&mut velocities[free.clone()], &stage.velocities[free.clone()]);
        of(out, at, &from.velocities[free]);
        of(strains, &stage.strains, &from.strains);
    }

    /// The equilibrium that the motion starts from, by the factors.
    fn equilibrium_forwards(
        &mut self,
        start: &State,
        tangent: &mut StageTangent,
        change: &mut Change,
        factors: &Factors,
    ) -> Result<(), MotionError> {
        self.put_equilibrium(start);
        (tangent.time, tangent.length) = ([0.0; 2], 0.0);
        (tangent.base_ends, tangent.led) = ([Twist::default(); 2], Twist::default());
        let Self { rod, loads, solver, .. } = self;
        solver.holds_passages = true;
        let found =
            tangent.push_forward(Mechanics { rod, loads }, solver, &Scheme::STATICS, factors);
        solver.holds_passages = false;
        solver.stage.matrix.hold_base(!loads.has_free_base);
        found.map_err(|_| MotionError::NoGradient { time: start.time })?;
        change.strains.copy_from_slice(&tangent.strains);
        change.tensions.copy_from_slice(&tangent.tensions);
        if let Some(friction) = &mut solver.friction {
            let rows = friction.rows(rod, &Scheme::STATICS, &solver.stage);
            change.beyond = rows.beyond_changes(&change.strains, &change.beyond);
        }
        let drives = &solver.lengths.drives;
        drives.push_forward_at_rest(&tangent.stage_tensions, &mut change.motors);
        Ok(())
    }
}
