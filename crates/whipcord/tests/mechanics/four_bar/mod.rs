//! The four-bar model against definitions, closed forms and independent minimisations.

mod at_a_place;
mod derivatives;
mod equilibrium;
mod free_lengths;
mod many_sections;
mod one_cable;
mod oracle;
mod pre_bent;
mod refusals;
mod several_cables;
mod symmetries;
mod table1;

use whipcord::four_bar::{FourBar, Options, Workspace};
use whipcord::{
    Backbone, Cable, Case, Disks, Material, Robot, Routing, Section, Shortening, Solution,
    SolveError,
};

/// A robot of the paper's material on these disks.
fn robot(disks: &[f64], routings: Vec<Routing>) -> Robot {
    let length = disks[disks.len() - 1];
    let material =
        Material { young_modulus: Some(1.1e9), poisson_ratio: Some(0.3), ..Material::default() };
    let section = Some(Section::circle(0.003));
    let backbone = Backbone { material, section, ..Backbone::new(length) };
    let disks = Disks {
        arc_lengths: disks.to_vec(),
        are_present: true,
        hole_circle_radii: vec![0.008; disks.len()],
        holes: Some(12),
        mass: 0.0,
        outer_radius: None,
        thickness: None,
    };
    let cable = |(i, routing)| Cable::new(format!("cable {i}"), routing);
    Robot::new(backbone, disks, routings.into_iter().enumerate().map(cable).collect()).unwrap()
}

fn equal_disks(length: f64, sections: usize) -> Vec<f64> {
    let mut disks: Vec<f64> = (0..=sections).map(|i| length * i as f64 / sections as f64).collect();
    disks[sections] = length;
    disks
}

/// Shortenings in m.
fn try_solve(
    robot: &Robot,
    options: &Options,
    shortenings: &[f64],
) -> Result<Solution, SolveError> {
    let shortenings: Vec<_> = shortenings.iter().map(|&s| Shortening::Length(s)).collect();
    let case = Case::with_shortenings(&shortenings);
    FourBar::new(robot, options)?.solve(&case, None, &mut Workspace::default())
}

fn solve(robot: &Robot, options: &Options, shortenings: &[f64]) -> Solution {
    try_solve(robot, options, shortenings).unwrap()
}
