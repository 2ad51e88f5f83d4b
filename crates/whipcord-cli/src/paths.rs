//! The ways to an answer and what lies beside it: iterations and branches.

use whipcord::cosserat::{Cosserat, TraceEvent, Workspace};
use whipcord::cosserat_disks::{self, CosseratDisks};
use whipcord::{
    BranchOptions, Branches, Case, CriticalKind, Diagnostics, Equilibrium, Model, SolveError,
};
use whipcord_io::CaseFile;

use whipcord_study::failure::Failure;
use whipcord_study::quantity::{fixed_millimetres, number};
use whipcord_study::style::Style;
use whipcord_study::table::{Align, Table};

/// The iterations of one solve, whether it finds an answer or not: from cold, or for the last of several
/// steps from where the one before left the robot.
///
/// # Errors
/// [`Failure`] where the model has no such iterations or does not take the robot, or where a step before
/// has no answer.
pub fn trace(model: &Model, file: &CaseFile) -> Result<Vec<TraceEvent>, Failure> {
    let CaseFile { robot, case, .. } = file;
    let one_before = case.before.len().checked_sub(1).filter(|_| !case.independent);
    let one_before = one_before.and_then(|step| case.step(step));
    let to = |case: Case| {
        let mut prepared = model.prepare(robot, &case.loads).map_err(|error| (0, error))?;
        prepared.solve_to_the_end(&case)
    };
    let left = one_before.map(to).transpose();
    let left = left.map_err(|(step, error)| Failure::from_step(file, &error, step))?;
    let left = left.as_ref();
    let refused = |error: SolveError| Failure::from_solve(file, &error);
    Ok(match model {
        Model::Cosserat(options) => {
            let model = Cosserat::new(robot, &case.loads, options).map_err(refused)?;
            model.solve_traced(case, left, &mut Workspace::default()).1
        }
        Model::CosseratDisks(options) => {
            let model = CosseratDisks::new(robot, &case.loads, options).map_err(refused)?;
            model.solve_traced(case, left, &mut cosserat_disks::Workspace::default()).1
        }
        Model::FourBar(_)
        | Model::ConstantCurvature(_)
        | Model::PiecewiseConstantCurvature(_)
        | Model::PseudoRigidBody(_) => {
            return Err(Failure::Input(format!(
                "error: --trace is for the models cosserat and cosserat-disks, and {} keeps no record of its \
                 iterations: leave out --trace, or choose --model cosserat",
                model.kind()
            )));
        }
    })
}

/// All equilibria on the path from no load and on the branches off it.
///
/// # Errors
/// [`Failure`] where the model knows of no branches, or finds no shape.
pub fn branches(model: &Model, file: &CaseFile) -> Result<Branches, Failure> {
    let found = model
        .prepare(&file.robot, &file.case.loads)
        .and_then(|mut prepared| prepared.branches(&file.case, &BranchOptions::default()));
    found.map_err(|error| Failure::from_solve(file, &error))
}

/// The iterations for people, one to a line.
pub fn trace_text(events: &[TraceEvent], style: Style) -> String {
    if events.is_empty() {
        return String::from(
            "no iterations on the robot as a whole: without load, and with the tensions given, every section \
             is solved by itself\n",
        );
    }
    let mut table = Table::new([
        ("stage", Align::Left),
        ("steps", Align::Right),
        ("load", Align::Right),
        ("iteration", Align::Right),
        ("residual", Align::Right),
        ("step", Align::Right),
        ("tensions", Align::Left),
    ]);
    let mut before = None;
    for event in events {
        if before != Some((event.stage, event.steps)) {
            table.group();
            before = Some((event.stage, event.steps));
        }
        let tensions: Vec<String> = event.tensions.iter().map(|&t| number(t, 4)).collect();
        table.row(vec![
            event.stage.name().to_owned(),
            event.steps.to_string(),
            number(event.load, 4),
            event.iteration.to_string(),
            format!("{:.1e}", event.residual),
            number(event.step, 3),
            if tensions.is_empty() { String::new() } else { format!("{} N", tensions.join(", ")) },
        ]);
    }
    table.text(style)
}

/// The branches for people.
pub fn branches_text(branches: &Branches, style: Style) -> String {
    let mut table = Table::new([
        ("branch", Align::Left),
        ("tip", Align::Left),
        ("stability", Align::Right),
        ("", Align::Left),
    ]);
    table.group();
    for equilibrium in &branches.equilibria {
        let [x, y, z] =
            equilibrium.solution.disks.tip().position.to_array().map(|c| fixed_millimetres(c, 3));
        let stability = equilibrium.solution.diagnostics.stability;
        table.row(vec![
            equilibrium.branch.map_or_else(|| String::from("none"), |b| b.to_string()),
            format!("({x}, {y}, {z}) mm"),
            stability.map_or_else(|| String::from("–"), |least| number(settled(least), 3)),
            recommendation(equilibrium).to_owned(),
        ]);
    }
    let mut text = format!("{}\n", style.heading("equilibria under all of the load"));
    text += &table.text(style);
    for point in &branches.critical_points {
        let what = match &point.kind {
            CriticalKind::Limit => String::from("the load turns back"),
            CriticalKind::CableSlackens => {
                String::from("a cable goes slack or taut, and stability changes")
            }
            CriticalKind::Bifurcation(others) if others.is_empty() => {
                String::from("branches part that were not followed")
            }
            CriticalKind::Bifurcation(others) => {
                let others: Vec<String> = others.iter().map(usize::to_string).collect();
                format!("branches {} part", others.join(" and "))
            }
        };
        let share = number(point.load * 100.0, 5);
        text += &format!("at {share} % of the load on branch {}: {what}\n", point.branch);
    }
    if !branches.complete {
        text += "not every branch was followed to its end: there may be more\n";
    }
    text
}

/// A stability that counts as zero is zero.
fn settled(least: f64) -> f64 {
    if least.abs() <= Diagnostics::NEUTRAL { 0.0 } else { least }
}

fn recommendation(equilibrium: &Equilibrium) -> &'static str {
    let neutral = |least: f64| settled(least) == 0.0;
    match equilibrium.stable {
        Some(true) if equilibrium.solution.diagnostics.stability.is_some_and(neutral) => {
            "stable but for one direction, in which it is neutral"
        }
        Some(true) => "stable",
        Some(false) => "unstable",
        None => "stability not defined under loads that follow the backbone",
    }
}
