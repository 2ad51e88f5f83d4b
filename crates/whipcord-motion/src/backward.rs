//! Derivatives backwards over the parts of a motion: the stages of each from the last to the first, by their transposed linearisations.

use whipcord_numerics::Twist;

use crate::accurate;
use crate::adjoint::{Factors, NotSolved, StageAdjoint};
use crate::block::{add, dot};
use crate::coefficients::OneStage;
use crate::commands::Commands;
use crate::error::MotionError;
use crate::free_base::BaseTangent;
use crate::gradient::{Costate, Part, Shift, motor_slope, tension_slope};
use crate::iteration::Mechanics;
use crate::options::Method;
use crate::scheme::Scheme;
use crate::simulation::Simulation;
use crate::state::State;

impl Simulation {
    pub(crate) fn part_backwards(
        &mut self,
        (commands, part): (&Commands, &Part),
        adjoint: &mut StageAdjoint,
        costate: &mut Costate,
        factors: &mut Factors,
        (cables, motors): (&mut [f64], &mut [f64]),
    ) -> Result<(), MotionError> {
        self.repeat(commands, part, None)?;
        let of = (commands, part);
        let told = (&mut *cables, &mut *motors);
        let mut length = self.solved_backwards(of, adjoint, costate, factors, told)?;
        let told = (&mut *cables, &mut *motors);
        length += self.places_backwards(of, adjoint, costate, factors, told)?;
        self.length_backwards(of, length, adjoint, costate, factors, (cables, motors))
    }

    /// The part that the solver has solved; the derivative by its length.
    pub(crate) fn solved_backwards(
        &mut self,
        (commands, part): (&Commands, &Part),
        adjoint: &mut StageAdjoint,
        costate: &mut Costate,
        factors: &mut Factors,
        (cables, motors): (&mut [f64], &mut [f64]),
    ) -> Result<f64, MotionError> {
        let fails = |_| MotionError::NoGradient { time: part.before.time };
        let end = part.before.time + part.length;
        let mut shift = Shift { start: 0.0, length: 0.0 };
        shift.add(1.0, core::mem::take(&mut costate.time));
        if let Some([velocity, rate]) = self.loads.led_base(end) {
            // Where it is follows from the time alone.
            let by_base = core::mem::take(&mut costate.base);
            let by_velocity = core::mem::take(&mut costate.velocities[0]);
            shift.add(1.0, dot(&by_base, &velocity) + dot(&by_velocity, &rate));
        }
        // A cable that is driven by its tension ends the step with its command.
        let mut by_cable = vec![0.0; cables.len()];
        for i in 0..cables.len() {
            if !self.is_by_length(commands, i) {
                by_cable[i] = core::mem::take(&mut costate.tensions[i]);
                shift.add(1.0, by_cable[i] * tension_slope(commands, i, end));
            }
        }
        match self.next.diagnostics.method {
            Method::Accurate => {
                let of = (commands, part, &mut shift);
                self.stages_backwards(of, adjoint, costate, factors, &mut by_cable)
            }
            method => {
                let method = part.method(method);
                let of = (commands, part, &method, &mut shift);
                self.one_stage_backwards(of, adjoint, costate, factors, (&mut by_cable, motors))
            }
        }
        .map_err(fails)?;
        for (i, value) in by_cable.into_iter().enumerate() {
            // A length is what the cable has at rest less its shortening.
            let by_length = self.is_by_length(commands, i);
            let value = if by_length { -value } else { value };
            match commands.motor_of(&self.robot, i) {
                None if by_length => {
                    cables[i] += value;
                    shift.add(1.0, value * commands.cables[i].course().slope_before(end));
                }
                None => cables[i] += value,
                // One with inertia has passed its derivative on.
                Some((motor, _)) if self.robot.motors()[motor].dynamics.is_some() => {}
                Some((motor, _)) => costate.outputs[motor] += self.pull(motor, i) * value,
            }
        }
        for motor in 0..costate.outputs.len() {
            if self.drive_moves(commands, part, motor) {
                let output = core::mem::take(&mut costate.outputs[motor]);
                let by_command = output / self.robot.motors()[motor].gear_ratio();
                motors[motor] += by_command;
                shift.add(1.0, by_command * motor_slope(commands, motor, end));
            }
        }
        costate.time = shift.start;
        Ok(shift.length)
    }

    /// The stages of `accurate`.
    fn stages_backwards(
        &mut self,
        (commands, part, shift): (&Commands, &Part, &mut Shift),
        adjoint: &mut StageAdjoint,
        costate: &mut Costate,
        factors: &mut Factors,
        cables: &mut [f64],
    ) -> Result<(), NotSolved> {
        let (nodes, points) = (self.rod.nodes.len(), self.rod.points.len());
        let h = part.length;
        let scheme = Scheme::at_end(accurate::GAMMA * h);
        let inverse = 1.0 / scheme.g;
        let mut velocity_rates: [Vec<Twist>; accurate::STAGES] = Default::default();
        let mut strain_rates = velocity_rates.clone();
        for i in 0..accurate::STAGES {
            velocity_rates[i] = vec![Twist::default(); nodes];
            strain_rates[i] = vec![Twist::default(); points];
        }
        // The rates at the end are those of the last stage.
        velocity_rates[accurate::STAGES - 1] = core::mem::take(&mut costate.velocity_rates);
        strain_rates[accurate::STAGES - 1] = core::mem::take(&mut costate.strain_rates);
        let (mut velocities, mut strains) =
            (core::mem::take(&mut costate.velocities), core::mem::take(&mut costate.strains));
        let mut start_velocities = vec![Twist::default(); nodes];
        let mut start_strains = vec![Twist::default(); points];
        // The pose of a free base is that of the last stage.
        let mut base = costate.base;
        let mut start_base = Twist::default();
        let mut base_rates = [Twist::default(); accurate::STAGES];
        adjoint.stage_tensions.fill(0.0);
        for i in (0..accurate::STAGES).rev() {
            let free = self.put_stage(commands, part, i)?;
            let Self { rod, loads, solver, .. } = &mut *self;
            adjoint.base = core::mem::take(&mut base);
            adjoint.base_by_velocity = free.as_ref().map(BaseTangent::pose_by_velocity);
            adjoint.end_by_velocity = None;
            if let Some(of) = &free {
                let rate = base_rates[i] * inverse;
                velocities[0] = velocities[0] + of.exponent_by_velocity.apply_transposed(&rate);
            }
            add(&mut velocities, &velocity_rates[i], inverse);
            add(&mut strains, &strain_rates[i], inverse);
            adjoint.velocities = velocities;
            adjoint.strains = strains;
            adjoint.pull_back(Mechanics { rod, loads }, solver, &scheme, factors)?;
            add(&mut adjoint.velocities, &velocity_rates[i], -inverse);
            add(&mut adjoint.strains, &strain_rates[i], -inverse);
            shift.length += self.history_by_length(part, &adjoint.velocities, &adjoint.strains);
            let time = part.before.time + accurate::C[i] * h;
            let Self { rod, loads, solver, .. } = &mut *self;
            let by_loads = adjoint.load_rate(Mechanics { rod, loads }, solver, &scheme, time);
            let slopes = adjoint.cables.iter().enumerate();
            let by_tensions: f64 =
                slopes.map(|(j, by)| by * tension_slope(commands, j, time)).sum();
            let by_base = self.led_by_time(adjoint, time);
            shift.add(accurate::C[i], by_loads + by_tensions + by_base);
            add(&mut start_velocities, &adjoint.velocities, 1.0);
            add(&mut start_strains, &adjoint.strains, 1.0);
            for j in 0..i {
                add(&mut velocity_rates[j], &adjoint.velocities, h * accurate::A[i][j]);
                add(&mut strain_rates[j], &adjoint.strains, h * accurate::A[i][j]);
            }
            if let Some(of) = &free {
                start_base = start_base + of.pose_by_start.apply_transposed(&adjoint.base);
                let rate = base_rates[i] * inverse;
                let history = of.pose_by_history().apply_transposed(&adjoint.base)
                    + of.exponent_by_history.apply_transposed(&rate)
                    - rate;
                shift.length += dot(&history, &of.exponent) / h;
                for (rate, a) in base_rates.iter_mut().zip(&accurate::A[i][..i]) {
                    *rate = *rate + history * (h * a);
                }
            }
            for (of, by) in cables.iter_mut().zip(&adjoint.cables) {
                *of += by;
            }
            velocities = vec![Twist::default(); nodes];
            strains = vec![Twist::default(); points];
        }
        (costate.velocities, costate.strains) = (start_velocities, start_strains);
        (costate.velocity_rates, costate.strain_rates) = (velocities, strains);
        costate.base = start_base;
        Ok(())
    }

    /// The stage of `robust`, which the solver has solved.
    fn one_stage_backwards(
        &mut self,
        (commands, part, method, shift): (&Commands, &Part, &OneStage, &mut Shift),
        adjoint: &mut StageAdjoint,
        costate: &mut Costate,
        factors: &mut Factors,
        (cables, motors): (&mut [f64], &mut [f64]),
    ) -> Result<(), NotSolved> {
        let by_length: Vec<bool> =
            (0..cables.len()).map(|i| self.is_by_length(commands, i)).collect();
        // The base moves from the start of the step, once to the stage and once to the end.
        let bases = self.half_bases(part, method)?;
        let Self { rod, loads, solver, .. } = self;
        let h = part.length;
        let scheme = method.scheme(part.length);
        let back = method.backwards(&scheme, part.length);
        let stage_of = |end: &[Twist], rates: &[Twist]| {
            let mut out = vec![Twist::default(); end.len()];
            add(&mut out, end, back.stage_by_end);
            add(&mut out, rates, back.stage_by_rate);
            out
        };
        let start_of = |end: &[Twist], rates: &[Twist], history: &[Twist]| {
            let mut out = history.to_vec();
            add(&mut out, rates, -back.stage_by_rate);
            let mut of_rates = vec![Twist::default(); end.len()];
            add(&mut of_rates, &out, back.carried);
            add(&mut of_rates, rates, back.rate_by_rate);
            add(&mut out, end, 1.0 - back.stage_by_end);
            (out, of_rates)
        };
        let (mut base, mut base_velocity) = (costate.base, Twist::default());
        if let Some([(of_end, g), _]) = &bases {
            let end = core::mem::take(&mut base);
            let by_velocity = of_end.pose_by_velocity().apply_transposed(&end);
            costate.velocities[0] = costate.velocities[0] + by_velocity;
            base = of_end.pose_by_start.apply_transposed(&end);
            let by_history = of_end.pose_by_history().apply_transposed(&end);
            base_velocity = by_history * *g;
            shift.length += dot(&by_history, &of_end.exponent) / h;
        }
        adjoint.base = Twist::default();
        adjoint.base_by_velocity = bases.as_ref().map(|[_, (of, _)]| of.pose_by_velocity());
        adjoint.end_by_velocity =
            bases.as_ref().map(|[(of, _), _]| of.pose_by_velocity().scaled(1.0 / method.place));
        adjoint.stage_tensions.fill(0.0);
        let (drives, tensions) = (&solver.lengths.drives, solver.stage.tensions.clone());
        let by_stage = &mut adjoint.stage_tensions;
        drives.add_by_tensions(method, h, &tensions, &costate.motors, by_stage);
        adjoint.velocities = stage_of(&costate.velocities, &costate.velocity_rates);
        adjoint.strains = stage_of(&costate.strains, &costate.strain_rates);
        adjoint.tensions = core::mem::take(&mut costate.tensions);
        adjoint.beyond = core::mem::take(&mut costate.beyond);
        adjoint.pull_back(Mechanics { rod, loads }, solver, &scheme, factors)?;
        costate.beyond.clone_from(&adjoint.beyond);
        let drives = &solver.lengths.drives;
        let by_lengths = &adjoint.cables;
        let at_stage = method.time(part.before.time, h);
        let found = |motor: usize, [set_point, length]: [f64; 2]| {
            motors[motor] += set_point;
            shift.add(method.place, set_point * motor_slope(commands, motor, at_stage));
            shift.length += length;
        };
        drives.pull_back(method, h, &tensions, by_lengths, &mut costate.motors, found);
        if let Some([(of_end, g_end), _]) = &bases {
            let [start, end] = &adjoint.base_ends;
            base = base + *start + of_end.pose_by_start.apply_transposed(end);
            let by_history = of_end.pose_by_history().apply_transposed(end);
            shift.length += dot(&by_history, &of_end.exponent) / h;
            let carried = 1.0 - 1.0 / method.place;
            let by_velocity = of_end.pose_by_velocity().apply_transposed(end);
            base_velocity = base_velocity + by_history * *g_end + by_velocity * carried;
        }
        if let Some([_, (of_stage, g)]) = &bases {
            let of = &adjoint.base;
            base = base + of_stage.pose_by_start.apply_transposed(of);
            let by_history = of_stage.pose_by_history().apply_transposed(of);
            base_velocity = base_velocity + by_history * *g;
            shift.length += dot(&by_history, &of_stage.exponent) / h;
        }
        let time = method.time(part.before.time, h);
        let of = Mechanics { rod, loads };
        shift.add(method.place, adjoint.load_rate(of, solver, &scheme, time));
        shift.length += adjoint.by_length;
        if bases.is_none() {
            let [start, end] = &adjoint.base_ends;
            for (place, by) in [(0.0, start), (1.0, end)] {
                if let Some([velocity, _]) = loads.led_base(part.before.time + place * h) {
                    shift.add(place, dot(by, &velocity));
                }
            }
        }
        let mut histories = [adjoint.velocities.clone(), adjoint.strains.clone()];
        add(&mut histories[0], &costate.velocity_rates, -back.stage_by_rate);
        add(&mut histories[1], &costate.strain_rates, -back.stage_by_rate);
        let (mut velocities, velocity_rates) =
            start_of(&costate.velocities, &costate.velocity_rates, &adjoint.velocities);
        let (mut strains, strain_rates) =
            start_of(&costate.strains, &costate.strain_rates, &adjoint.strains);
        add(&mut strains, &adjoint.start, 1.0);
        for (i, (of, by)) in cables.iter_mut().zip(&adjoint.cables).enumerate() {
            *of += by;
            if !by_length[i] {
                // By its tension at the stage.
                shift.add(method.place, by * tension_slope(commands, i, time));
            }
        }
        let [of_velocities, of_strains] = &histories;
        shift.length += self.history_by_length(part, of_velocities, of_strains);
        shift.add(method.place, self.led_by_time(adjoint, time));
        velocities[0] = velocities[0] + base_velocity;
        (costate.velocities, costate.strains) = (velocities, strains);
        (costate.velocity_rates, costate.strain_rates) = (velocity_rates, strain_rates);
        costate.tensions.clone_from(&adjoint.tensions);
        costate.base = base;
        Ok(())
    }

    /// The derivative by the time of a stage, which was pulled back last, of what the base is there where it is led.
    fn led_by_time(&self, adjoint: &StageAdjoint, time: f64) -> f64 {
        self.loads.led_base(time).map_or(0.0, |[velocity, rate]| {
            dot(&adjoint.base, &velocity) + dot(&adjoint.led, &rate)
        })
    }

    /// The derivative by the length of a part of what a stage in the solver has from derivatives by its histories: both go from the start to the stage by sums of rates that the length multiplies.
    fn history_by_length(&self, part: &Part, velocities: &[Twist], strains: &[Twist]) -> f64 {
        let (stage, from) = (&self.solver.stage, &part.before);
        let of = |by: &[Twist], at: &[Twist], from: &[Twist]| -> f64 {
            by.iter().zip(at).zip(from).map(|((by, at), from)| dot(by, &(*at - *from))).sum()
        };
        let free = self.loads.first_free()..;
        let (by, at) = (&velocities[free.clone()], &stage.velocities[free.clone()]);
        let sum = of(by, at, &from.velocities[free]) + of(strains, &stage.strains, &from.strains);
        sum / part.length
    }

    /// The equilibrium that the motion starts from, by the factors.
    pub(crate) fn equilibrium_backwards(
        &mut self,
        start: &State,
        adjoint: &mut StageAdjoint,
        costate: &mut Costate,
        factors: &mut Factors,
    ) -> Result<(), MotionError> {
        self.put_equilibrium(start);
        let Self { rod, loads, solver, .. } = self;
        (adjoint.base, adjoint.base_by_velocity) = (Twist::default(), None);
        adjoint.end_by_velocity = None;
        adjoint.stage_tensions.fill(0.0);
        let drives = &solver.lengths.drives;
        drives.add_by_tensions_at_rest(&costate.motors, &mut adjoint.stage_tensions);
        adjoint.velocities.fill(Twist::default());
        adjoint.strains = core::mem::take(&mut costate.strains);
        adjoint.tensions = core::mem::take(&mut costate.tensions);
        if let Some(friction) = &mut solver.friction {
            // The lengths beyond the holes are those of the shape.
            let rows = friction.rows(rod, &Scheme::STATICS, &solver.stage);
            add(&mut adjoint.strains, &rows.by_beyond(&costate.beyond).0, 1.0);
        }
        solver.holds_passages = true;
        let found = adjoint.pull_back(Mechanics { rod, loads }, solver, &Scheme::STATICS, factors);
        solver.holds_passages = false;
        solver.stage.matrix.hold_base(!loads.has_free_base);
        found.map_err(|_| MotionError::NoGradient { time: start.time })?;
        costate.strains = vec![Twist::default(); rod.points.len()];
        Ok(())
    }
}
