//! Keys of a file that have no effect on any answer, besides those that the robot and the case show by themselves.

use whipcord::case::Profile;
use whipcord::robot::Routing;
use whipcord::{Vec3, Warning};

use crate::case_file::CaseFile;

const LEAVE_OUT: &str = "leave it out";

/// One warning for each key that has no effect beside the others.
pub(super) fn without_effect(file: &CaseFile) -> Vec<Warning> {
    let mut found = Vec::new();
    found.extend(pixel_deviation(file));
    found.extend(holes(file));
    found.extend(frame(file));
    found.extend(yield_strain(file));
    found
}

/// Loads that the file gives as zero. A program that computes its loads may well come to zero.
pub(super) fn zero_loads(file: &CaseFile) -> Vec<Warning> {
    let loads = &file.case.loads;
    let is_zero = |values: &[Vec3]| values.iter().all(|value| *value == Vec3::ZERO);
    let points = loads.points.iter().map(|point| is_zero(&[point.force, point.moment]));
    let points: Vec<bool> = points.collect();
    let distributed = loads.distributed.iter().map(|load| match &load.profile {
        Profile::Constant { force, moment, .. } => is_zero(&[*force, *moment]),
        Profile::Linear { force, moment, .. } => is_zero(force) && is_zero(moment),
    });
    let distributed: Vec<bool> = distributed.collect();
    let given = |list: &str, keys: &[&str], i: usize| {
        let mut paths = keys.iter().map(|key| format!("loads.{list}[{i}].{key}"));
        paths.find(|path| file.document().find(path).is_some())
    };
    let zero = |path: Option<String>, reason| Some(unused(&path?, reason, LEAVE_OUT));
    let mut found = Vec::new();
    for (list, are_zero) in [("point", points), ("distributed", distributed)] {
        let zeros = are_zero.into_iter().enumerate().filter(|(_, is_zero)| *is_zero);
        let paths = zeros.map(|(i, _)| given(list, &["force", "moment"], i));
        found.extend(paths.filter_map(|path| zero(path, "the load is zero")));
    }
    let masses = loads.masses.iter().enumerate().filter(|(_, mass)| mass.mass == 0.0);
    let paths = masses.map(|(i, _)| given("mass", &["mass"], i));
    found.extend(paths.filter_map(|path| zero(path, "the mass is zero")));
    found
}

fn unused(path: &str, reason: &'static str, help: &'static str) -> Warning {
    Warning::UnusedKey { path: path.to_owned(), reason, help }
}

fn pixel_deviation(file: &CaseFile) -> Option<Warning> {
    let measured = file.document().find("measured")?;
    let is_unused = measured.has("pixel_deviation") && !measured.has("cameras");
    is_unused.then(|| {
        let help = "add [[measured.cameras]], or leave it out";
        unused("measured.pixel_deviation", "nothing is measured by a camera", help)
    })
}

/// Holes that no cable runs through. Those of a file that this one extends may be there for others.
fn holes(file: &CaseFile) -> Option<Warning> {
    const HELP: &str = "leave it out, or give a cable `holes` instead of `routing`";
    let document = file.document();
    let (disks, cables) = (document.find("disks")?, document.find("cables")?);
    let is_curve = |routing: &Routing| !matches!(routing, Routing::Holes { .. });
    let robot = &file.robot;
    if robot.cables().is_empty() || !robot.cables().iter().all(|cable| is_curve(&cable.routing)) {
        return None;
    }
    let is_own = disks.find("holes")?.span.file == cables.span.file;
    is_own.then(|| unused("disks.holes", "every cable has a `routing`", HELP))
}

fn frame(file: &CaseFile) -> Option<Warning> {
    file.document().find("loads.frame")?;
    let loads = &file.case.loads;
    let is_without = loads.gravity.is_none()
        && loads.tip_force == Vec3::ZERO
        && loads.tip_moment == Vec3::ZERO
        && loads.points.is_empty()
        && loads.distributed.is_empty();
    is_without.then(|| unused("loads.frame", "there is neither gravity nor a load", LEAVE_OUT))
}

fn yield_strain(file: &CaseFile) -> Option<Warning> {
    let backbone = file.robot.backbone();
    let material = &backbone.material;
    let is_given = material.yield_strain.is_some() && material.name.is_none();
    let is_unused = is_given && backbone.section.is_none();
    is_unused.then(|| {
        let help = "give `diameter` or `section`, or leave it out";
        unused("backbone.yield_strain", "the cross-section is not given", help)
    })
}
