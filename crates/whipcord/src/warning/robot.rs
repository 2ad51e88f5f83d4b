//! Warnings about the robot alone.

use super::geometry::{Extent, is_soft, places};
use super::kinds::{SLENDER, USUAL_LENGTHS, Warning};
use crate::robot::{Along, Robot, Routing, Section};

/// Lengths that are equal but for rounding are equal.
const ROUNDING: f64 = 1e-9;

pub(super) fn warnings(robot: &Robot) -> Vec<Warning> {
    let mut found = Vec::new();
    let length = robot.backbone().length;
    let [least, greatest] = USUAL_LENGTHS;
    if length < least * (1.0 - ROUNDING) || length > greatest * (1.0 + ROUNDING) {
        found.push(Warning::Length { length });
    }
    found.extend(thick(robot));
    found.extend(outside(robot));
    found.extend(inside(robot));
    found.extend(short(robot));
    found.extend(unused(robot));
    found
}

/// The key that gives the cross-section.
fn section_key(section: &Section) -> &'static str {
    match section {
        Section::Round { outer: Along::Uniform(_), .. } => "backbone.diameter",
        Section::Round { .. } => "backbone.diameters",
        Section::Rectangle { .. } => "backbone.section",
    }
}

fn thick(robot: &Robot) -> Option<Warning> {
    let section = robot.backbone().section.as_ref()?;
    let at = |s: f64| Extent::at(section, robot.disks(), s).thickness();
    let thickness = places(robot).into_iter().map(at).fold(0.0, f64::max);
    let length = robot.backbone().length;
    (thickness > SLENDER * length * (1.0 + ROUNDING)).then(|| Warning::ThickBackbone {
        path: section_key(section),
        thickness,
        length,
    })
}

/// Where a cable passes each disk up to its end: number of the disk from 0, x and y.
fn passages(robot: &Robot, cable: usize) -> impl Iterator<Item = (usize, f64, f64)> + '_ {
    let route = &robot.routes()[cable];
    let disks = robot.disks().arc_lengths.iter().enumerate();
    disks.take_while(move |(_, s)| **s <= route.end()).map(move |(i, &s)| {
        let offset = route.at(s).offset;
        (i, offset.x, offset.y)
    })
}

/// The key that says how far from the axis a cable runs.
fn radius_key(robot: &Robot, cable: usize) -> String {
    match robot.cables()[cable].routing {
        Routing::Holes { .. } => "disks.hole_circle_radius".to_owned(),
        _ => format!("cables[{cable}].routing"),
    }
}

/// One for each key that is at fault: cables through holes of the same circle share theirs.
fn outside(robot: &Robot) -> Vec<Warning> {
    let mut found: Vec<(String, Warning)> = Vec::new();
    let Some(radius) = robot.disks().outer_radius else { return Vec::new() };
    for (index, cable) in robot.cables().iter().enumerate() {
        let path = radius_key(robot, index);
        if found.iter().any(|(known, _)| *known == path) {
            continue;
        }
        let beyond =
            passages(robot, index).find(|(_, x, y)| x.hypot(*y) > radius * (1.0 + ROUNDING));
        if let Some((disk, x, y)) = beyond {
            let warning = Warning::OutsideDisk {
                path: path.clone(),
                cable: cable.name.clone(),
                disk: disk + 1,
                distance: x.hypot(y),
                radius,
            };
            found.push((path, warning));
        }
    }
    found.into_iter().map(|(_, warning)| warning).collect()
}

/// Not for a body in which cables run in channels: a soft one, or one without disks.
fn inside(robot: &Robot) -> Vec<Warning> {
    let has_channels = is_soft(robot) || !robot.has_disks();
    let Some(section) = robot.backbone().section.as_ref().filter(|_| !has_channels) else {
        return Vec::new();
    };
    let mut found: Vec<(String, Warning)> = Vec::new();
    for (index, cable) in robot.cables().iter().enumerate() {
        let path = radius_key(robot, index);
        if found.iter().any(|(known, _)| *known == path) {
            continue;
        }
        let within = passages(robot, index).find_map(|(disk, x, y)| {
            let s = robot.disks().arc_lengths[disk];
            let reach = Extent::at(section, robot.disks(), s).reach_around(x, y)?;
            Some((disk, x.hypot(y), reach))
        });
        if let Some((disk, distance, reach)) = within {
            let cable = cable.name.clone();
            let warning = Warning::InsideBackbone {
                path: path.clone(),
                cable,
                disk: disk + 1,
                distance,
                reach,
            };
            found.push((path, warning));
        }
    }
    found.into_iter().map(|(_, warning)| warning).collect()
}

fn short(robot: &Robot) -> Vec<Warning> {
    let disks = robot.disks().count();
    let cables = robot.cables().iter().zip(robot.routes()).enumerate();
    cables
        .filter_map(|(index, (cable, route))| match &cable.routing {
            Routing::Holes { holes, .. } if holes.len() < disks && cable.ends_at.is_none() => {
                Some(Warning::ShortHoleList {
                    index,
                    cable: cable.name.clone(),
                    holes: holes.len(),
                    disks,
                    ends_at: route.end(),
                })
            }
            _ => None,
        })
        .collect()
}

/// Keys of [backbone] that a constraint makes ineffective.
fn unused(robot: &Robot) -> Vec<Warning> {
    use crate::robot::Stiffness::Diagonal;
    const FREE_SHEAR: &str = "leave it out, or leave out `shearable = false`";
    let backbone = robot.backbone();
    let (shear, axial) = match &backbone.stiffness {
        Some(Diagonal { shear, axial, .. }) => (shear.is_some(), axial.is_some()),
        _ => (false, false),
    };
    let unused =
        |path: &str, reason, help| Warning::UnusedKey { path: path.to_owned(), reason, help };
    let mut found = Vec::new();
    if !backbone.shearable && backbone.shear_correction != 1.0 {
        let reason = "the backbone is not shearable";
        found.push(unused("backbone.shear_correction", reason, FREE_SHEAR));
    }
    if !backbone.shearable && shear {
        let reason = "the backbone is not shearable";
        found.push(unused("backbone.stiffness.shear", reason, FREE_SHEAR));
    }
    if !backbone.extensible && axial {
        let reason = "the backbone is not extensible";
        let help = "leave it out, or leave out `extensible = false`";
        found.push(unused("backbone.stiffness.axial", reason, help));
    }
    found
}
