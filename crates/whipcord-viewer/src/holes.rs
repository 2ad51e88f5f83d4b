//! Lists of holes that the page chooses in place of those of the file.

use std::sync::Arc;

use whipcord::{Robot, Routing};
use whipcord_io::CaseFile;

/// The holes of each cable from the base on, from 1; `None` for those of the file. An empty list of cables is the file.
pub type Holes = Vec<Option<Vec<usize>>>;

/// The file with these holes.
///
/// # Errors
/// Why the robot cannot have them.
pub fn with_holes(
    file: &Arc<CaseFile>,
    holes: &[Option<Vec<usize>>],
) -> Result<Arc<CaseFile>, String> {
    if holes.iter().all(Option::is_none) {
        return Ok(Arc::clone(file));
    }
    let robot = &file.robot;
    if holes.len() != robot.cables().len() {
        let (given, cables) = (holes.len(), robot.cables().len());
        return Err(format!("holes of {given} cables are given for {cables}: reload the page"));
    }
    let mut cables = robot.cables().to_vec();
    for (cable, list) in cables.iter_mut().zip(holes) {
        let Some(list) = list else { continue };
        let Routing::Holes { holes, .. } = &mut cable.routing else {
            return Err(format!("cable `{}` does not go through holes", cable.name));
        };
        holes.clone_from(list);
    }
    let changed = Robot::new(robot.backbone().clone(), robot.disks().clone(), cables)
        .and_then(|changed| changed.with_motors(robot.motors().to_vec()))
        .map_err(|error| error.to_string())?;
    let mut file = CaseFile::clone(file);
    file.robot = changed;
    Ok(Arc::new(file))
}

/// The holes of a robot's cables; `None` for a cable that goes through none.
pub fn holes_of(robot: &Robot) -> Holes {
    let list = |routing: &Routing| match routing {
        Routing::Holes { holes, .. } => Some(holes.clone()),
        _ => None,
    };
    robot.cables().iter().map(|cable| list(&cable.routing)).collect()
}
