//! Asks the library whether the robot and the case can be, and finds the place of what cannot.

use whipcord::{
    Backbone, Cable, CableCommand, Case, Disks, Loads, Problem, Robot, RobotError, SolveError,
};

use crate::error::{Diagnostic, FileProblem, Problems};
use crate::node::Node;
use crate::schema::ROOT;

/// The parts of a robot and of a case as the file gives them.
pub(crate) struct Parts {
    pub backbone: Backbone,
    pub disks: Disks,
    pub cables: Vec<Cable>,
    pub commands: Vec<CableCommand>,
    pub loads: Loads,
}

/// The robot and the case of these parts. The library stops at the first quantity that cannot be;
/// a cable that is refused is left out and the rest tried again, so that all of them are reported.
pub(crate) fn assemble(
    parts: Parts,
    document: &Node,
    problems: &mut Problems,
) -> Option<(Robot, Case)> {
    let Parts { backbone, disks, mut cables, mut commands, loads } = parts;
    // Numbers in the file of the cables that are left.
    let mut numbers: Vec<usize> = (0..cables.len()).collect();
    let robot = loop {
        match Robot::new(backbone.clone(), disks.clone(), cables.clone()) {
            Ok(robot) => break robot,
            Err(error) => {
                let refused = cable_of(&error).filter(|&i| i < cables.len());
                report(&error, &numbers, document, problems);
                let i = refused?;
                cables.remove(i);
                commands.remove(i);
                numbers.remove(i);
                if problems.is_full() {
                    return None;
                }
            }
        }
    };
    let mut case = Case { commands, loads };
    while let Err(error) = case.check(&robot) {
        report(&error, &numbers, document, problems);
        let refused = cable_of(&error).and_then(|i| case.commands.get_mut(i))?;
        *refused = CableCommand::default();
        if problems.is_full() {
            return None;
        }
    }
    Some((robot, case))
}

/// The number of the cable that an error is about.
fn cable_of(error: &RobotError) -> Option<usize> {
    let (number, _) = error.path.strip_prefix("cables[")?.split_once(']')?;
    number.parse().ok()
}

fn report(error: &RobotError, numbers: &[usize], document: &Node, problems: &mut Problems) {
    let mut path = error.path.clone();
    if let Some(&number) = cable_of(error).and_then(|i| numbers.get(i))
        && let Some((_, rest)) = path.split_once(']')
    {
        path = format!("cables[{number}]{rest}");
    }
    let mut problem = error.problem.clone();
    let mut related = None;
    if let Problem::DuplicateName { first, .. } = &mut problem {
        *first = numbers.get(*first).copied().unwrap_or(*first);
        let other = document.locate(&format!("cables[{first}].name"));
        related = Some((other.span, "the other one is here"));
    }
    // The library knows only positions; the file may have given their number.
    if path == "disks.count" && document.locate("disks").has("positions") {
        "disks.positions".clone_into(&mut path);
    }
    let place = document.locate(&path);
    problems.push_related(place.span, related, || FileProblem::Physical { path, problem });
}

/// What a model that refuses the robot or the case says, and where that is: at the value, or, where
/// it is missing, at the header of what it belongs to. `None` for what no file says.
pub(crate) fn refusal(error: &SolveError, document: &Node) -> Option<Diagnostic> {
    let (path, problem) = match error.clone() {
        SolveError::Invalid(RobotError { path, problem }) => {
            (path.clone(), FileProblem::Physical { path, problem })
        }
        SolveError::Missing { model, path, advice } => {
            (path.clone(), FileProblem::Needed { model, path, help: advice })
        }
        SolveError::Unsupported { model, path, what, advice } => {
            (path.clone(), FileProblem::NotTaken { model, path, what, help: advice })
        }
        _ => return None,
    };
    ROOT.key(path.split(['.', '[']).next()?)?;
    // A density is missed only by weight.
    let weight = path == "backbone.density" && document.locate("loads").has("gravity");
    let related =
        weight.then(|| (document.locate("loads.gravity").span, "the gravity is given here"));
    Some(Diagnostic { span: document.locate(&path).span, problem, related })
}
