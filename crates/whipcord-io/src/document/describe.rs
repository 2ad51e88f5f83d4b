//! A robot and a case as the tables of a file.

use thiserror::Error;
use whipcord::robot::{BackboneSegment, StiffnessMatrix};
use whipcord::{
    Along, Backbone, Cable, CableCommand, Case, Disks, DistributedLoad, Interpolation, LoadFrame,
    Loads, Material, PointLoad, Pose, Profile, RestCurvature, Robot, Routing, Section, Shortening,
    Stiffness, UnitQuaternion, Vec3,
};

use super::obstacle::obstacle;
use super::{Item, Table};
use crate::materials::preset;
use crate::units::percent;

/// What a robot file has no words for; a robot that was read from one has nothing of the kind.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("a robot file cannot say {what}")]
pub struct Inexpressible {
    /// What.
    pub what: &'static str,
}

/// The entries of a file that describes this robot and this case: read again, it gives the same robot
/// and the same case to the last bit.
///
/// # Errors
/// [`Inexpressible`] for what only a program can put together.
pub fn describe(title: Option<&str>, robot: &Robot, case: &Case) -> Result<Table, Inexpressible> {
    let mut file = Table::default();
    file.insert_some("title", title);
    file.insert("backbone", backbone(robot.backbone())?);
    if robot.has_disks() {
        file.insert("disks", disks(robot.disks(), robot.backbone().length));
    }
    if !are_driven_by_motors(robot, case) {
        let what = "that a motor has commands and gives a cable another length than these: fit `motors[…].angle_offset`, `spool_radius` or `gear_ratio` instead of an offset or a gain of the cable, or command the cables themselves";
        return Err(Inexpressible { what });
    }
    let in_steps = !case.before.is_empty();
    let cables = robot.cables().iter().enumerate().map(|(i, cable)| {
        let own = if in_steps { None } else { case.commands.get(i) };
        self::cable(cable, own.map(|own| undriven(robot, i, case.motors.last(), own)).as_ref())
    });
    let cables: Vec<Table> = cables.collect();
    if !cables.is_empty() {
        file.insert("cables", cables);
    }
    if !robot.motors().is_empty() {
        let names: Vec<&str> = robot.cables().iter().map(|cable| cable.name.as_str()).collect();
        let own = |i: usize| if in_steps { None } else { case.motor_command(i) };
        let motors = robot.motors().iter().enumerate();
        let motors: Vec<Table> =
            motors.map(|(i, motor)| super::motor::motor(motor, &names, own(i))).collect();
        file.insert("motors", motors);
    }
    if case.base != Pose::IDENTITY {
        file.insert("base", placed(Table::default(), &case.base));
    }
    if case.loads != Loads::default() {
        file.insert("loads", loads(&case.loads)?);
    }
    if !case.obstacles.is_empty() {
        let obstacles = case.obstacles.iter().map(obstacle);
        file.insert("obstacles", obstacles.collect::<Result<Vec<_>, _>>()?);
    }
    if case.independent {
        let mut commands = Table::default();
        commands.insert("each", "independent");
        file.insert("commands", commands);
    }
    if in_steps {
        let steps = case.before.iter().chain([&case.commands]).enumerate();
        let earlier = case.motors.len().saturating_sub(case.before.len() + 1);
        let step = |(k, step): (usize, &Vec<CableCommand>)| {
            self::step(robot, step, case.motors.get(earlier + k))
        };
        file.insert("steps", steps.map(step).collect::<Result<Vec<_>, _>>()?);
    }
    Ok(file)
}

/// One value, a list with one for each disk, or a table of both.
fn along<T: Clone>(along: &Along<T>) -> Item
where
    Item: From<T>,
{
    match along {
        Along::Uniform(value) => value.clone().into(),
        Along::PerDisk(values) => values.clone().into(),
        Along::At { arc_lengths, values } => {
            let mut table = Table::default();
            table.insert("at", arc_lengths.clone());
            table.insert("values", values.clone());
            table.into()
        }
    }
}

/// Quantities of one table that share their places, which stand in its `at`.
struct Shared<'a> {
    table: Table,
    at: Option<&'a [f64]>,
    has_lists: bool,
}

const MIXED: Inexpressible =
    Inexpressible { what: "that quantities of one table are given at different places" };

impl<'a> Shared<'a> {
    fn new() -> Self {
        Self { table: Table::default(), at: None, has_lists: false }
    }

    fn insert<T: Clone>(&mut self, key: &str, given: &'a Along<T>) -> Result<(), Inexpressible>
    where
        Item: From<T>,
    {
        match given {
            Along::Uniform(value) => self.table.insert(key, value.clone()),
            Along::PerDisk(values) => {
                self.has_lists = true;
                self.table.insert(key, values.clone());
            }
            Along::At { arc_lengths, values } => {
                if self.at.is_some_and(|at| at != arc_lengths.as_slice()) {
                    return Err(MIXED);
                }
                self.at = Some(arc_lengths);
                self.table.insert(key, values.clone());
            }
        }
        Ok(())
    }

    fn finish(mut self) -> Result<Table, Inexpressible> {
        match self.at {
            Some(_) if self.has_lists => return Err(MIXED),
            Some(at) => self.table.entries.insert(0, ("at".to_owned(), at.to_vec().into())),
            None => {}
        }
        Ok(self.table)
    }
}

fn backbone(backbone: &Backbone) -> Result<Table, Inexpressible> {
    let mut table = Table::default();
    table.insert("length", backbone.length);
    match &backbone.section {
        None => {}
        Some(Section::Round { outer, inner }) => {
            let key = if outer.is_uniform() { "diameter" } else { "diameters" };
            table.insert(key, along(outer));
            if *inner != Along::Uniform(0.0) {
                table.insert("inner_diameter", along(inner));
            }
        }
        Some(Section::Rectangle { width, height }) => {
            let mut bar = Shared::new();
            bar.insert("width", width)?;
            bar.insert("height", height)?;
            table.insert("section", bar.finish()?);
        }
    }
    let material = &backbone.material;
    table.insert_some("material", name_of(backbone));
    table.insert_some("young_modulus", material.young_modulus);
    table.insert_some("poisson_ratio", material.poisson_ratio);
    table.insert_some("shear_modulus", material.shear_modulus);
    if backbone.shear_correction != 1.0 {
        table.insert("shear_correction", backbone.shear_correction);
    }
    if let Some(given) = &backbone.stiffness {
        table.insert("stiffness", stiffness(given)?);
    }
    if !backbone.segments.is_empty() {
        let segments: Vec<Item> =
            backbone.segments.iter().map(|of| Item::Table(segment(of))).collect();
        table.insert("segments", Item::List(segments));
    }
    table.insert_some("density", material.density);
    table.insert_some("yield_strain", material.yield_strain);
    table.insert_some("linear_density", backbone.linear_density.as_ref().map(along));
    if let Some(friction) = &backbone.bending_friction {
        table.insert("yield_moment", friction.yield_moment);
        table.insert_some("yield_stiffness", friction.yield_stiffness);
    }
    if backbone.rest_curvature != RestCurvature::default() {
        table.insert("rest_curvature", along(&backbone.rest_curvature));
    }
    for (key, free) in [("extensible", backbone.extensible), ("shearable", backbone.shearable)] {
        if !free {
            table.insert(key, false);
        }
    }
    Ok(table)
}

fn segment(segment: &BackboneSegment) -> Table {
    let mut table = Table::default();
    table.insert("name", segment.name.as_str());
    table.insert_some("group", segment.group.as_deref());
    table.insert("starts_at", segment.range[0]);
    table.insert("ends_at", segment.range[1]);
    let [shear, extension, bending, torsion] = segment.stiffness_factors();
    for (key, factor) in [
        ("bending_factor", bending),
        ("torsion_factor", torsion),
        ("extension_factor", extension),
        ("shear_factor", shear),
    ] {
        if factor != 1.0 {
            table.insert(key, factor);
        }
    }
    table
}

/// The name of the material, where its constants are read again as they are beside that name.
fn name_of(backbone: &Backbone) -> Option<&'static str> {
    let material = backbone.material;
    let preset = preset(material.name?).filter(|_| backbone.stiffness.is_none())?;
    let given = Material { name: None, ..material };
    let again = preset.beside(given, backbone.linear_density.is_some());
    (again == material).then_some(preset.name)
}

fn stiffness(stiffness: &Stiffness) -> Result<Table, Inexpressible> {
    let mut table = Shared::new();
    match stiffness {
        Stiffness::Matrix(matrix) => {
            let rows = matrix.map(|k: &StiffnessMatrix| k.map(|row| row.to_vec()).to_vec());
            let rows: &Along<Vec<Vec<f64>>> = &rows;
            let mut own = Shared::new();
            own.insert("matrix", rows)?;
            return own.finish();
        }
        Stiffness::Diagonal { shear, axial, bending, torsion } => {
            if let Some(shear) = shear {
                table.insert("shear", shear)?;
            }
            if let Some(axial) = axial {
                table.insert("axial", axial)?;
            }
            table.insert("bending", bending)?;
            table.insert("torsion", torsion)?;
        }
    }
    table.finish()
}

fn disks(disks: &Disks, length: f64) -> Table {
    let mut table = Table::default();
    let count = disks.count();
    if disks.arc_lengths == Disks::equally_spaced(length, count, 0.0).arc_lengths {
        table.insert("count", count);
    } else {
        table.insert("positions", disks.arc_lengths.clone());
    }
    match disks.hole_circle_radii.as_slice() {
        [] => {}
        [first, rest @ ..] if rest.iter().all(|radius| radius == first) => {
            table.insert("hole_circle_radius", *first);
        }
        radii => table.insert("hole_circle_radius", radii.to_vec()),
    }
    table.insert_some("holes", disks.holes);
    if disks.mass != 0.0 {
        table.insert("mass", disks.mass);
    }
    table.insert_some("outer_radius", disks.outer_radius);
    table.insert_some("thickness", disks.thickness);
    table
}

fn cable(cable: &Cable, command: Option<&CableCommand>) -> Table {
    let mut table = Table::default();
    table.insert("name", cable.name.as_str());
    table.insert_some("group", cable.group.as_deref());
    match &cable.routing {
        Routing::Holes { holes, interpolation } => {
            table.insert("holes", holes.clone());
            let name = match interpolation {
                Interpolation::Spline => None,
                Interpolation::Pchip => Some("pchip"),
                Interpolation::Fourier => Some("fourier"),
            };
            table.insert_some("interpolation", name);
            let of = cable.hole_offset;
            for (key, value) in [("hole_angle_offset", of.angle), ("hole_radius_offset", of.radius)]
            {
                table.insert_some(key, (value != 0.0).then_some(value));
            }
        }
        curve => table.insert("routing", routing(curve)),
    }
    table.insert_some("ends_at", cable.ends_at);
    table.insert_some("friction", cable.friction);
    table.insert_some("axial_stiffness", cable.axial_stiffness);
    if let Some(command) = command {
        table.insert_some("tension", command.tension);
        table.insert_some("shortening", command.shortening.map(shortening));
    }
    table
}

fn routing(routing: &Routing) -> Table {
    let mut table = Table::default();
    match routing {
        Routing::Holes { holes, .. } => table.insert("holes", holes.clone()),
        Routing::Straight { angle, radius } => {
            table.insert("kind", "straight");
            table.insert("angle", *angle);
            table.insert("radius", *radius);
        }
        Routing::Helix { start_angle, turns, radius } => {
            table.insert("kind", "helix");
            table.insert("start_angle", *start_angle);
            table.insert("turns", *turns);
            table.insert("radius", *radius);
        }
        Routing::Linear { start, end } => {
            table.insert("kind", "linear");
            table.insert("start", *start);
            table.insert("end", *end);
        }
        Routing::Polynomial { x, y } => {
            table.insert("kind", "polynomial");
            table.insert("x", x.clone());
            table.insert("y", y.clone());
        }
    }
    table
}

pub(super) fn shortening(shortening: Shortening) -> Item {
    match shortening {
        Shortening::Length(length) => Item::Number(length),
        Shortening::Fraction(fraction) => Item::Text(percent(fraction)),
    }
}

/// Whether the cables of motors that have commands are told what these make of them.
fn are_driven_by_motors(robot: &Robot, case: &Case) -> bool {
    const ROUNDING: f64 = 1e-12;
    let mut driven = case.clone();
    if case.motors.is_empty() || driven.drive(robot).is_err() {
        return true;
    }
    let steps = |case: &'_ Case| -> Vec<CableCommand> {
        case.before.iter().chain([&case.commands]).flatten().copied().collect()
    };
    let [given, driven] = [case, &driven].map(steps);
    given.iter().zip(&driven).all(|(given, driven)| match (given.shortening, driven.shortening) {
        (Some(Shortening::Length(a)), Some(Shortening::Length(b))) => (a - b).abs() <= ROUNDING,
        (given, driven) => given == driven,
    })
}

/// The command of a cable without the shortening that its motor gives it.
fn undriven(
    robot: &Robot,
    cable: usize,
    motors: Option<&Vec<Option<f64>>>,
    command: &CableCommand,
) -> CableCommand {
    let motor = robot.motor_of(cable);
    let driven = motor.and_then(|motor| *motors?.get(motor)?).is_some();
    CableCommand { shortening: command.shortening.filter(|_| !driven), ..*command }
}

fn step(
    robot: &Robot,
    commands: &[CableCommand],
    motors: Option<&Vec<Option<f64>>>,
) -> Result<Table, Inexpressible> {
    /// Nothing of a kind for any cable, or something for each.
    fn all<T>(values: Vec<Option<T>>) -> Result<Option<Vec<T>>, Inexpressible> {
        if values.iter().all(Option::is_none) {
            return Ok(None);
        }
        let all: Option<Vec<T>> = values.into_iter().collect();
        let what = "a step that drives some cables by their tension and others by their shortening";
        all.map(Some).ok_or(Inexpressible { what })
    }
    let own = commands.iter().enumerate();
    let commands: Vec<CableCommand> =
        own.map(|(cable, command)| undriven(robot, cable, motors, command)).collect();
    let mut table = Table::default();
    let tensions = commands.iter().map(|command| command.tension).collect();
    let shortenings = commands.iter().map(|command| command.shortening.map(shortening)).collect();
    table.insert_some("tension", all(tensions)?);
    table.insert_some("shortening", all(shortenings)?);
    table.insert_some("motors", all(motors.cloned().unwrap_or_default())?);
    Ok(table)
}

/// The table with where a thing is.
pub(super) fn placed(mut table: Table, pose: &Pose) -> Table {
    if pose.position != Vec3::ZERO {
        table.insert("position", pose.position);
    }
    if pose.rotation != UnitQuaternion::IDENTITY {
        table.insert("orientation", pose.rotation.wxyz());
    }
    table
}

pub(super) fn loads(loads: &Loads) -> Result<Table, Inexpressible> {
    let mut table = Table::default();
    if loads.frame == LoadFrame::World {
        table.insert("frame", "world");
    }
    table.insert_some("gravity", loads.gravity);
    let some = |vector: Vec3| (vector != Vec3::ZERO).then_some(vector);
    table.insert_some("tip_force", some(loads.tip_force));
    table.insert_some("tip_moment", some(loads.tip_moment));
    if loads.tip_follower {
        table.insert("follower", true);
    }
    if !loads.points.is_empty() {
        table.insert("point", loads.points.iter().map(point).collect::<Vec<_>>());
    }
    if !loads.distributed.is_empty() {
        let spread = loads.distributed.iter().map(distributed);
        table.insert("distributed", spread.collect::<Result<Vec<_>, _>>()?);
    }
    if !loads.masses.is_empty() {
        let masses = loads.masses.iter().map(|mass| {
            let mut table = Table::default();
            table.insert("at", mass.at);
            table.insert("mass", mass.mass);
            table
        });
        table.insert("mass", masses.collect::<Vec<_>>());
    }
    Ok(table)
}

fn point(point: &PointLoad) -> Table {
    let mut table = Table::default();
    table.insert("at", point.at);
    table.insert("force", point.force);
    if point.moment != Vec3::ZERO {
        table.insert("moment", point.moment);
    }
    if point.follower {
        table.insert("follower", true);
    }
    table
}

fn distributed(load: &DistributedLoad) -> Result<Table, Inexpressible> {
    let mut table = Table::default();
    match &load.profile {
        Profile::Constant { from, to, force, moment } => {
            table.insert("from", *from);
            table.insert("to", *to);
            table.insert("force", *force);
            if *moment != Vec3::ZERO {
                table.insert("moment", *moment);
            }
        }
        Profile::Linear { at, force, moment } => {
            table.insert("at", at.clone());
            for (key, values) in [("force", force), ("moment", moment)] {
                if !values.is_empty() {
                    table.insert(key, values.clone());
                }
            }
            if force.is_empty() && moment.is_empty() {
                return Err(Inexpressible {
                    what: "a distributed load of neither force nor moment",
                });
            }
        }
    }
    if load.follower {
        table.insert("follower", true);
    }
    Ok(table)
}
