//! How a robot moves over time, as tables of a file.

use whipcord::{LoadFrame, Loads, ModelKind, Robot, Twist};
use whipcord_motion::{BaseMotion, Course, Damping, Drag, Initial, Method, Start, StartRates};

use super::describe::loads;
use super::{Inexpressible, Item, Table};
use crate::read::{CableCourse, Motion};

/// Adds the tables `[motion]` and `[backbone.damping]` to a file of this robot: read again, it says the same. What a table of its own says over
/// time is written in the file itself.
///
/// # Errors
/// [`Inexpressible`] for loads that only a program can put together.
pub fn describe_motion(
    motion: &Motion,
    robot: &Robot,
    file: &mut Table,
) -> Result<(), Inexpressible> {
    let mut damping = Table::default();
    match &motion.damping {
        Damping::None => {}
        Damping::Time(time) => damping.insert("time", *time),
        Damping::Matrix(matrix) => damping.insert("matrix", matrix.to_vec()),
    }
    let backbone = file.entries.iter_mut().find(|(name, _)| name == "backbone");
    if let Some((_, Item::Table(backbone))) = backbone.filter(|_| !damping.is_empty()) {
        backbone.insert("damping", damping);
    }
    let mut table = Table::default();
    table.insert_some("duration", motion.duration);
    table.insert_some("step", motion.step);
    table.insert_some("model", motion.model.map(ModelKind::name));
    table.insert_some("method", motion.method.map(Method::name));
    table.insert_some("tolerance", motion.tolerance);
    table.insert_some("initial", motion.initial.as_ref().map(initial));
    table.insert_some("elements", motion.elements);
    if motion.drag != Drag::default() {
        let mut drag = Table::default();
        drag.insert("across", motion.drag.across);
        drag.insert("along", motion.drag.along);
        table.insert("drag", drag);
    }
    if let Some(BaseMotion { velocity, angular_velocity }) = &motion.base {
        let mut base = Table::default();
        base.insert("velocity", Item::List(velocity.iter().map(course).collect()));
        base.insert("angular_velocity", Item::List(angular_velocity.iter().map(course).collect()));
        table.insert("base", base);
    }
    if motion.has_free_base {
        let mut base = Table::default();
        base.insert("free", true);
        table.insert("base", base);
    }
    if let Some(every) = motion.every {
        let mut output = Table::default();
        output.insert("every", every);
        table.insert("output", output);
    }
    let commands = commands(motion, robot);
    if !commands.is_empty() {
        table.insert("commands", commands);
    }
    let mut over_time = Vec::new();
    for of in &motion.loads {
        let mut table = Table::default();
        // The factor has rows, also where it is constant.
        let constant = || Item::List(vec![[0.0, of.factor.before(0.0)].into()]);
        table.insert("factor", of.factor.rows().map_or_else(constant, |_| course(&of.factor)));
        // They are in the frame of [loads].
        let of = Loads { frame: LoadFrame::Base, ..of.loads.clone() };
        table.entries.extend(loads(&of)?.entries);
        over_time.push(table);
    }
    if !over_time.is_empty() {
        table.insert("loads", over_time);
    }
    if !table.is_empty() {
        file.insert("motion", table);
    }
    Ok(())
}

/// Where a motion starts; a state that was read from a file is written out.
fn initial(initial: &Initial) -> Item {
    let start = match initial {
        Initial::Equilibrium => return "equilibrium".into(),
        Initial::Rest => return "rest".into(),
        Initial::State(start) => &**start,
    };
    let Start { velocities, strains, tensions, motor_outputs, motors, .. } = start;
    let six = |of: &Twist| [of.linear.to_array(), of.angular.to_array()].concat();
    let rows = |twists: &[Twist]| twists.iter().map(six).collect::<Vec<_>>();
    let threes = |motors: &[[f64; 3]]| motors.iter().map(|of| of.to_vec()).collect::<Vec<_>>();
    let mut table = Table::default();
    table.insert("strains", rows(strains));
    table.insert("velocities", rows(velocities));
    for (key, values) in [("tensions", tensions), ("motor_outputs", motor_outputs)] {
        if !values.is_empty() {
            table.insert(key, values.clone());
        }
    }
    if !motors.is_empty() {
        table.insert("motors", threes(motors));
    }
    let passages =
        [("passage_tensions", &start.passage_tensions), ("lengths_beyond", &start.lengths_beyond)];
    for (key, values) in passages.into_iter().filter(|(_, values)| !values.is_empty()) {
        table.insert(key, values.clone());
    }
    if let Some(of) = &start.rates {
        let StartRates { velocities, strains, motors, step, commands, loads } = of;
        let mut rates = Table::default();
        rates.insert("velocities", rows(velocities));
        rates.insert("strains", rows(strains));
        if !motors.is_empty() {
            rates.insert("motors", threes(motors));
        }
        rates.insert("step", *step);
        if !commands.is_empty() {
            rates.insert("commands", commands.clone());
        }
        rates.insert("loads", loads.to_vec());
        table.insert("rates", rates);
    }
    table.into()
}

fn commands(motion: &Motion, robot: &Robot) -> Vec<Table> {
    let mut commands = Vec::new();
    for (cable, told) in &motion.cables {
        let Some(cable) = robot.cables().get(*cable) else { continue };
        let mut table = Table::default();
        table.insert("cable", cable.name.as_str());
        match told {
            CableCourse::Tension(told) => table.insert("tension", course(told)),
            CableCourse::Shortening(told) => table.insert("shortening", course(told)),
            CableCourse::Fraction(told) => table.insert("shortening", fraction(told)),
        }
        commands.push(table);
    }
    for (motor, told) in &motion.motors {
        let Some(motor) = robot.motors().get(*motor) else { continue };
        let mut table = Table::default();
        table.insert("motor", motor.name.as_str());
        table.insert(motor.drive.keys().command, course(told));
        commands.push(table);
    }
    commands
}

/// A number, or rows of time and value.
fn course(course: &Course) -> Item {
    rows(course, &Item::Number)
}

/// The same in per cent.
fn fraction(course: &Course) -> Item {
    rows(course, &|value| Item::Text(crate::units::percent(value)))
}

fn rows(course: &Course, item: &dyn Fn(f64) -> Item) -> Item {
    let Some((times, values)) = course.rows() else { return item(course.before(0.0)) };
    let row = |(time, value): (&f64, &f64)| Item::List(vec![Item::Number(*time), item(*value)]);
    Item::List(times.iter().zip(values).map(row).collect())
}
