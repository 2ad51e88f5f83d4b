//! Where a parameter enters: the explicit change `e` of the section equations, of the force, of the
//! loads between steps and of the cables' lengths, at constant strain and shape.

use whipcord_numerics::{BUTCHER_5, GAUSS_3, Twist, UnitQuaternion, Vec3};

use super::forward::Forcing;
use super::replay::{AXES, Replay};
use crate::case::{Case, Shortening};
use crate::cosserat::grid::{Grid, Layout, SHOOTING_NODES, Step};
use crate::cosserat::loaded::{NODE_OF_STAGE, STAGES};
use crate::cosserat::section::{Stiffness, Strain};
use crate::parameter::{Parameter, StiffnessPart};
use crate::robot::{Robot, RobotError, RouteChange, Routing, SectionProperties};
use crate::shape::Wrench;

/// The robot and case of an answer, as the partial derivatives need them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Setting<'a> {
    pub robot: &'a Robot,
    pub case: &'a Case,
    pub layout: &'a Layout,
    pub grid: &'a Grid,
    pub tensions: &'a [f64],
}

impl Setting<'_> {
    /// From the frame of the dead loads to that of the base.
    fn turn(&self) -> UnitQuaternion {
        self.case.loads.to_base(self.case.base.rotation)
    }

    /// What the robot carries at and beyond the end of step `k`, in kg.
    fn carried_beyond(&self, k: usize) -> f64 {
        let loads = &self.case.loads;
        let places = &self.grid.loads[loads.points.len()..];
        let beyond = loads.masses.iter().zip(places).filter(|(_, place)| **place > k);
        beyond.map(|(mass, _)| mass.mass).sum()
    }
}

/// One parameter, with all that its partial derivatives take.
#[derive(Clone, Debug)]
pub(super) struct Partial {
    parameter: Parameter,
    /// By cables, in the order of the grid.
    routes: Vec<Option<RouteChange>>,
    /// Change of the mass beyond each node; empty where there is none.
    masses: Vec<f64>,
    /// Of the cables' lengths at rest.
    pub rest_lengths: Vec<f64>,
    /// What acts at each stage; empty where nothing does.
    forcing: Vec<Forcing>,
    /// Of the cables' lengths at constant strain.
    pub lengths: Vec<f64>,
    /// The wrench that is added at a node, base frame.
    pub added: Option<(usize, Wrench)>,
    /// Change of the length that each cable is to keep, with its own stretch at its tension.
    pub targets: Vec<f64>,
}

impl Partial {
    /// # Errors
    /// [`RobotError`] when robot and case have no such quantity.
    pub fn new(
        setting: &Setting<'_>,
        replay: &Replay,
        parameter: &Parameter,
    ) -> Result<Self, RobotError> {
        let Setting { robot, case, layout, .. } = *setting;
        exists(robot, case, parameter)?;
        let routes: Vec<_> =
            layout.order.iter().map(|&c| RouteChange::new(robot, c, parameter)).collect();
        let mut partial = Self {
            parameter: *parameter,
            rest_lengths: vec![0.0; routes.len()],
            lengths: vec![0.0; routes.len()],
            routes,
            masses: Vec::new(),
            forcing: Vec::new(),
            added: None,
            targets: Vec::new(),
        };
        if partial.has_mass() {
            partial.masses = mass_changes(setting, parameter);
        }
        partial.change_rest_lengths(setting);
        partial.act(setting, replay);
        partial.added = partial.wrench(setting, replay);
        partial.targets =
            (0..partial.routes.len()).map(|place| partial.target(setting, place)).collect();
        Ok(partial)
    }

    /// What acts at a stage.
    #[inline]
    pub fn forcing(&self, stage: usize) -> Forcing {
        self.forcing.get(stage).copied().unwrap_or_default()
    }

    /// Whether anything acts within a stage.
    pub fn acts(&self) -> bool {
        !self.forcing.is_empty()
    }

    fn wrench(&self, setting: &Setting<'_>, replay: &Replay) -> Option<(usize, Wrench)> {
        let loads = &setting.case.loads;
        let (place, force, moment, follower) = match self.parameter {
            Parameter::TipForce { axis } => {
                (setting.grid.len(), AXES[axis], Vec3::ZERO, loads.tip_follower)
            }
            Parameter::TipMoment { axis } => {
                (setting.grid.len(), Vec3::ZERO, AXES[axis], loads.tip_follower)
            }
            Parameter::PointForce { load, axis } => {
                (setting.grid.loads[load], AXES[axis], Vec3::ZERO, loads.points[load].follower)
            }
            Parameter::PointMoment { load, axis } => {
                (setting.grid.loads[load], Vec3::ZERO, AXES[axis], loads.points[load].follower)
            }
            _ => return None,
        };
        // What is applied to the clamped base bends nothing.
        let ends = replay.ends.get(place.checked_sub(1)?)?;
        let rotation = if follower { ends.pose.rotation } else { setting.turn() };
        let wrench = Wrench { force: rotation.rotate(force), moment: rotation.rotate(moment) };
        Some((place, wrench))
    }

    fn target(&self, setting: &Setting<'_>, place: usize) -> f64 {
        let cable = setting.layout.order[place];
        let rest = self.rest_lengths[place];
        let asked = match setting.case.commands[cable].shortening {
            Some(Shortening::Fraction(fraction)) => rest * (1.0 - fraction),
            _ => rest,
        };
        let stretch = match setting.robot.cables()[cable].axial_stiffness {
            None => 0.0,
            Some(stiffness) => {
                let own = match self.parameter {
                    Parameter::AxialStiffness { cable: c } if c == cable => {
                        -setting.layout.rest_lengths[place] / (stiffness * stiffness)
                    }
                    _ => 0.0,
                };
                own + rest / stiffness
            }
        };
        asked + stretch * setting.tensions[place]
    }

    fn has_mass(&self) -> bool {
        matches!(
            self.parameter,
            Parameter::Density
                | Parameter::LinearDensity
                | Parameter::DiskMass
                | Parameter::Diameter
                | Parameter::DiameterAt { .. }
                | Parameter::InnerDiameter
                | Parameter::Width
                | Parameter::Height
        )
    }

    /// Whether the strain at rest or a course changes.
    fn changes_rest(&self) -> bool {
        matches!(
            self.parameter,
            Parameter::RestCurvature { .. } | Parameter::RestCurvatureAt { .. }
        ) || self.routes.iter().any(Option::is_some)
    }

    /// Rate of the stretch at rest of a cable at an arc length.
    fn rest_stretch(&self, setting: &Setting<'_>, place: usize, s: f64, inside: f64) -> f64 {
        let robot = setting.robot;
        let route = &robot.routes()[setting.layout.order[place]];
        let point = route.at(s);
        let (backbone, disks) = (robot.backbone(), robot.disks());
        let u = backbone.rest_curvature.at_end(disks, s, inside);
        let du = backbone.rest_curvature_change(disks, s, inside, &self.parameter);
        let (dr, d_slope) =
            self.routes[place].as_ref().map_or_else(Default::default, |change| change.at(route, s));
        let tangent = Vec3::Z + u.cross(point.offset) + point.slope;
        let change = du.cross(point.offset) + u.cross(dr) + d_slope;
        tangent.dot(change) / tangent.norm()
    }

    fn change_rest_lengths(&mut self, setting: &Setting<'_>) {
        if !self.changes_rest() {
            return;
        }
        for place in 0..self.rest_lengths.len() {
            self.rest_lengths[place] = self.rest_length_change(setting, place);
        }
    }

    /// By Gauss quadrature in pieces of the steps that are halved until nothing changes.
    fn rest_length_change(&self, setting: &Setting<'_>, place: usize) -> f64 {
        const MAX_HALVINGS: usize = 10;
        let reached = setting.grid.steps.iter().filter(|step| place < step.active);
        let total = |pieces: usize| -> f64 {
            let of_piece = |step: &Step, i: usize| -> f64 {
                let h = step.length / pieces as f64;
                let at = |j: usize| step.start + (i as f64 + GAUSS_3.nodes[j]) * h;
                let stretch = |j: usize| self.rest_stretch(setting, place, at(j), at(j));
                h * (0..3).map(|j| GAUSS_3.weights[j] * stretch(j)).sum::<f64>()
            };
            reached.clone().flat_map(|step| (0..pieces).map(move |i| of_piece(step, i))).sum()
        };
        let mut change = total(1);
        for halvings in 1..=MAX_HALVINGS {
            let finer = total(1 << halvings);
            let moved = (finer - change).abs();
            change = finer;
            if moved <= 1e-12 * change.abs() {
                break;
            }
        }
        change
    }

    /// Forcing of all stages, and the explicit change of lengths.
    fn act(&mut self, setting: &Setting<'_>, replay: &Replay) {
        let Setting { robot, grid, .. } = *setting;
        let acts = self.changes_rest()
            || !self.masses.is_empty()
            || matches!(
                self.parameter,
                Parameter::YoungModulus
                    | Parameter::ShearModulus
                    | Parameter::PoissonRatio
                    | Parameter::StiffnessScale(_)
                    | Parameter::ShearCorrection
                    | Parameter::Stiffness { .. }
                    | Parameter::Gravity { .. }
            );
        if !acts {
            return;
        }
        let mut lengths = self.rest_lengths.clone();
        for (k, step) in grid.steps.iter().enumerate() {
            for i in 0..STAGES {
                let (j, at) = (NODE_OF_STAGE[i], STAGES * k + i);
                let s = step.start + BUTCHER_5.c[i] * step.length;
                let weight = BUTCHER_5.b[i] * step.length;
                let out = self.act_at(setting, replay, (k, j, at), s, weight, &mut lengths);
                self.forcing.push(out);
            }
        }
        // The section at the tip, which belongs to no step.
        let (last, at) = (grid.len() - 1, STAGES * grid.len());
        let tip = robot.backbone().length;
        let out = self.act_at(setting, replay, (last, LAST_NODE, at), tip, 0.0, &mut lengths);
        self.forcing.push(out);
        self.lengths = lengths;
    }

    /// What acts at one stage, given by its step, node and number; adds to the lengths.
    fn act_at(
        &self,
        setting: &Setting<'_>,
        replay: &Replay,
        (k, j, at): (usize, usize, usize),
        s: f64,
        weight: f64,
        lengths: &mut [f64],
    ) -> Forcing {
        let Setting { robot, grid, tensions, .. } = *setting;
        let step = grid.steps[k];
        let (active, inside) = (step.active, step.start + 0.5 * step.length);
        let (node, crossings) = grid.shooting.at(k, j, active);
        let stage = &replay.stages[at];
        let (v, u) = (stage.strain.linear, stage.strain.angular);
        let mut out = Forcing::default();
        let strain = Twist { linear: v - Vec3::Z, angular: u - node.section.rest_curvature };
        if let Parameter::Stiffness { row, column } = self.parameter {
            let wrench = entry_wrench(row, column, strain);
            out.force_balance += wrench.linear;
            out.moment_balance += wrench.angular;
        }
        let present = &node.section.stiffness;
        if let Some(change) = stiffness_change(robot, s, inside, present, &self.parameter) {
            out.force_balance += change.shear.scale(strain.linear);
            out.moment_balance += change.bending.scale(strain.angular);
        }
        let du = robot.backbone().rest_curvature_change(robot.disks(), s, inside, &self.parameter);
        if du != Vec3::ZERO {
            // −K (0, δu*), from the wrench of the strain that the section would have.
            let rest = node.section.rest_strain();
            let moved = Strain { angular: rest.angular + du, ..rest };
            let wrench = node.section.elastic_wrench(&moved);
            out.force_balance -= wrench.linear;
            out.moment_balance -= wrench.angular;
        }
        match self.parameter {
            Parameter::Gravity { axis } => {
                let mass = node.distal_mass + setting.carried_beyond(k);
                out.force = mass * setting.turn().rotate(AXES[axis]);
            }
            _ => {
                if let Some(mass) = self.masses.get(NODES * k + j) {
                    let gravity = setting.case.loads.gravity.unwrap_or_default();
                    out.force = *mass * setting.turn().rotate(gravity);
                }
            }
        }
        let rest_changes = self.changes_rest();
        let pulls = replay.pulls_at(at, tensions.len(), active);
        for (place, (crossing, (pull, stretch))) in crossings.iter().zip(pulls).enumerate() {
            if rest_changes {
                lengths[place] -= weight * self.rest_stretch(setting, place, s, inside);
            }
            let Some(change) = &self.routes[place] else { continue };
            let route = &robot.routes()[setting.layout.order[place]];
            let (dr, d_slope) = change.at(route, s);
            let t = pull.linear;
            let along = u.cross(dr) + d_slope;
            let rate = t.dot(along);
            let turned = (along - rate * t) / *stretch;
            lengths[place] += weight * rate;
            let tension = tensions[place];
            out.force_balance += tension * turned;
            out.moment_balance += tension * (dr.cross(t) + crossing.offset.cross(turned));
        }
        out
    }
}

/// Places of the shooting grid in a step, and the last of them.
const NODES: usize = SHOOTING_NODES.len();
const LAST_NODE: usize = NODES - 1;

/// Refuses a parameter that robot and case do not have.
fn exists(robot: &Robot, case: &Case, parameter: &Parameter) -> Result<(), RobotError> {
    let there = match *parameter {
        Parameter::StiffnessScale(_) => true,
        Parameter::HoleAngle { cable, disk } => robot.cables().get(cable).is_some_and(
            |c| matches!(&c.routing, Routing::Holes { holes, .. } if disk < holes.len()),
        ),
        // The weight of a rod whose density is not given is not known.
        Parameter::Gravity { .. } => {
            robot.backbone().linear_density_at(robot.disks(), 0.0).is_some()
        }
        _ => true,
    };
    if there && parameter.value(robot, case).is_ok() { Ok(()) } else { Err(parameter.absent()) }
}

/// Derivative of the section's stiffness; `None` where it is zero.
fn stiffness_change(
    robot: &Robot,
    s: f64,
    inside: f64,
    present: &Stiffness,
    parameter: &Parameter,
) -> Option<Stiffness> {
    if let Parameter::StiffnessScale(part) = parameter {
        let Stiffness { shear, bending } = present;
        let (mut s, mut b) = (Vec3::ZERO, Vec3::ZERO);
        match part {
            StiffnessPart::Shear => (s.x, s.y) = (shear.x, shear.y),
            StiffnessPart::Extension => s.z = shear.z,
            StiffnessPart::Bending => (b.x, b.y) = (bending.x, bending.y),
            StiffnessPart::Torsion => b.z = bending.z,
        }
        return Some(Stiffness { shear: s, bending: b });
    }
    let backbone = robot.backbone();
    // A stiffness that is given does not follow from section and material.
    if backbone.stiffness.is_some() {
        return None;
    }
    let (material, disks) = (&backbone.material, robot.disks());
    let section = backbone.section.as_ref()?.at_end(disks, s, inside);
    let (young, shear) = (material.young_modulus?, material.shear_modulus()?);
    let correction = backbone.shear_correction;
    let of = |young: f64, shear: f64, p: &SectionProperties| {
        let across = correction * shear * p.area;
        Stiffness {
            shear: Vec3::new(across, across, young * p.area),
            bending: Vec3::new(
                young * p.second_moment_x,
                young * p.second_moment_y,
                shear * p.torsion_constant,
            ),
        }
    };
    Some(match *parameter {
        Parameter::YoungModulus => {
            let follows = if material.shear_modulus.is_none() { shear / young } else { 0.0 };
            of(1.0, follows, &section)
        }
        Parameter::ShearModulus => of(0.0, 1.0, &section),
        Parameter::PoissonRatio => {
            of(0.0, -shear / (1.0 + material.poisson_ratio.unwrap_or(0.0)), &section)
        }
        Parameter::ShearCorrection => {
            let across = shear * section.area;
            Stiffness { shear: Vec3::new(across, across, 0.0), bending: Vec3::ZERO }
        }
        _ => of(young, shear, &backbone.section_change(disks, s, inside, parameter)?),
    })
}

/// What a unit of one entry of a symmetric stiffness exerts on a strain.
fn entry_wrench(row: usize, column: usize, strain: Twist) -> Twist {
    let component = |i: usize| if i < 3 { strain.linear[i] } else { strain.angular[i - 3] };
    let mut wrench = Twist::default();
    let mut add = |i: usize, value: f64| match i {
        0..3 => wrench.linear[i] += value,
        _ => wrench.angular[i - 3] += value,
    };
    add(row, component(column));
    if row != column {
        add(column, component(row));
    }
    wrench
}

/// Change of the mass beyond each node of the shooting grid; so many to a step.
fn mass_changes(setting: &Setting<'_>, parameter: &Parameter) -> Vec<f64> {
    let Setting { robot, grid, .. } = *setting;
    let backbone = robot.backbone();
    let (density, disks) = (backbone.material.density.unwrap_or(0.0), robot.disks());
    let given = backbone.linear_density.is_some();
    let linear = |s: f64| match parameter {
        Parameter::LinearDensity => 1.0,
        Parameter::Density => backbone.section_at(disks, s).map_or(0.0, |p| p.area),
        // A mass per length that is given does not follow from the section.
        _ if given => 0.0,
        _ => backbone.section_change(disks, s, s, parameter).map_or(0.0, |p| density * p.area),
    };
    let between = |from: f64, to: f64| {
        let at = |i: usize| linear(from + GAUSS_3.nodes[i] * (to - from));
        (to - from) * (0..3).map(|i| GAUSS_3.weights[i] * at(i)).sum::<f64>()
    };
    let mut at_nodes = vec![0.0; grid.len() + 1];
    if *parameter == Parameter::DiskMass {
        for &k in &grid.disks {
            at_nodes[k] += 1.0;
        }
    }
    let mut masses = vec![0.0; NODES * grid.len()];
    let mut mass = 0.0;
    for (k, step) in grid.steps.iter().enumerate().rev() {
        mass += at_nodes[k + 1];
        let end = step.start + step.length;
        for (j, &c) in SHOOTING_NODES.iter().enumerate() {
            masses[NODES * k + j] = mass + between(step.start + c * step.length, end);
        }
        mass += between(step.start, end);
    }
    masses
}
