//! A single cable whose zero or angle explains much of the errors.

use std::num::NonZero;

use whipcord::{Actuation, Cancel, Model, ModelKind, Robot, Stations};
use whipcord_estimation::identification::{self, Experiment, Settings};
use whipcord_estimation::registration::Alignment;
use whipcord_io::CaseFile;

use crate::fitting::remarks::stands_out;
use crate::remark::Remark;

/// Robots that remember are solved row by row: of more rows it is left to `fit`.
const MOST_IN_ORDER: usize = 200;

/// The warning where the zero or the angle of a single cable of the robot of these files stands out by a model. Of files with several
/// robots, or of which each was measured in a frame of its own, nothing is said.
pub(super) fn single_cable(
    cases: &[&CaseFile],
    model: ModelKind,
    threads: Option<NonZero<usize>>,
    cancel: &Cancel,
) -> Option<Remark> {
    let robot = &cases.first()?.robot;
    let experiments: Vec<Experiment> =
        cases.iter().map(|case| case.experiment()).collect::<Option<_>>()?;
    let is_one = experiments.len() == 1
        || (cases.iter().all(|case| is_same(&case.robot, robot))
            && experiments.iter().all(|of| of.alignment == Alignment::None));
    let rows: usize = experiments.iter().map(|of| of.case.before.len() + 1).sum();
    if !is_one || (robot.has_history() && rows > MOST_IN_ORDER) {
        return None;
    }
    let model = Model::new(model, Stations::Disks, Actuation::Natural).cancelled_by(cancel);
    let settings = Settings { threads, ..Settings::new(model) };
    let found = identification::single_cable(robot, &experiments, &settings).ok()??;
    stands_out(&found, robot)
}

fn is_same(a: &Robot, b: &Robot) -> bool {
    a.backbone() == b.backbone()
        && a.disks() == b.disks()
        && a.cables() == b.cables()
        && a.motors() == b.motors()
}
