//! A robot and its case in words.

use std::path::Path;

use whipcord::case::Piece;
use whipcord::obstacle::Bends;
use whipcord::robot::SectionProperties;
use whipcord::{
    Actuation, Along, Cable, CableCommand, Case, Disks, DistributedLoad, Form, HoleOffset,
    Interpolation, LengthMiss, LoadFrame, Loads, ModelKind, NoStability, Pose, RestCurvature,
    Robot, Routing, Section, Solution, Stiffness, Vec3,
};
use whipcord_io::CaseFile;

use crate::bending_friction;
use crate::motors;
use crate::quantity::{degrees, millimetres, newtons, number, shortening, vector};
use crate::statistics::extent;

/// More steps than this are not listed one by one; only the first few are.
const MOST_STEPS: usize = 20;
const FEW_STEPS: usize = 5;

/// `1 marker`, `2 markers`
pub fn markers(count: usize) -> String {
    format!("{count} marker{}", if count == 1 { "" } else { "s" })
}

/// What is said of markers that fit far better in opposite order.
pub fn reversed(file: &CaseFile) -> String {
    format!("{}: the markers fit far better in opposite order", file.path.display())
}

/// What to do about them.
pub const REVERSED_HELP: &str =
    "check in which order the markers were numbered: disk 1 is the one at the base";

/// What a file says of its robot and case: name and description of each part.
pub fn describe(robot: &Robot, case: &Case) -> Vec<(String, String)> {
    let mut lines = vec![
        ("backbone".to_owned(), backbone(robot)),
        ("stiffness".to_owned(), stiffness(robot)),
        ("disks".to_owned(), disks(robot.disks())),
    ];
    let in_steps = !case.before.is_empty();
    for ((cable, route), command) in robot.cables().iter().zip(robot.routes()).zip(&case.commands) {
        let midway = (route.end() < robot.backbone().length).then(|| route.end());
        let command = (!in_steps).then_some(command);
        lines.push((format!("cable {}", cable.name), cable_words(cable, midway, command)));
    }
    for (number, of_motor) in robot.motors().iter().enumerate() {
        let command = case.motor_command(number).filter(|_| !in_steps);
        lines.push((format!("motor {}", of_motor.name), motors::words(robot, of_motor, command)));
    }
    if in_steps {
        let all = case.before.len() + 1;
        // A log of motors has thousands of rows.
        let shown = if all > MOST_STEPS { FEW_STEPS } else { all };
        for (i, step) in case.single_steps().take(shown).enumerate() {
            let commands: Vec<String> = step.commands.iter().map(command_words).collect();
            lines.push((format!("step {}", i + 1), commands.join("; ")));
        }
        if shown < all {
            lines.push(("steps".to_owned(), format!("{} more, {all} in all", all - shown)));
        }
    }
    lines.push((
        "loads".to_owned(),
        match case.loads_before.is_empty() {
            true => loads(&case.loads),
            false => format!("differ from row to row; in the last one {}", loads(&case.loads)),
        },
    ));
    if case.base != Pose::IDENTITY {
        lines.push(("base".to_owned(), placed(&case.base)));
    }
    for obstacle in &case.obstacles {
        let mut words = format!("{}, {}", form(&obstacle.form), placed(&obstacle.pose));
        if let Some(body) = &obstacle.movable {
            words += &format!(", movable, of {} g", number(1e3 * body.mass, 4));
        }
        lines.push((format!("obstacle {}", obstacle.name), words));
    }
    lines
}

fn form(form: &Form) -> String {
    let by = |v: Vec3| v.to_array().map(millimetres).join(" by ");
    match form {
        Form::HalfSpace => "half-space".to_owned(),
        Form::Sphere { radius } => format!("sphere of radius {}", millimetres(*radius)),
        Form::Capsule { radius, length } => format!(
            "capsule of radius {} about a segment of {}",
            millimetres(*radius),
            millimetres(*length)
        ),
        Form::Box { size } => format!("box of {}", by(*size)),
        Form::Cylinder { radius, length } => format!(
            "cylinder of radius {} and length {}",
            millimetres(*radius),
            millimetres(*length)
        ),
        Form::Pipe(pipe) => {
            let course = match (pipe.points().len(), pipe.bends()) {
                (2, _) => "straight".to_owned(),
                (count, Bends::Smooth) => format!("smooth through {count} points"),
                (count, Bends::Corners) => format!("with corners at {} points", count - 2),
            };
            format!("pipe of radius {}, {course}", millimetres(pipe.radius()))
        }
        Form::Superellipsoid(body) => {
            let [e1, e2] = body.exponents().map(|e| number(e, 4));
            format!("superellipsoid, semi-axes {}, exponents {e1} and {e2}", by(body.semi_axes()))
        }
        Form::Mesh(mesh) => {
            let count = mesh.triangles().len();
            let file = mesh.file().map(|file| Path::new(&file.path));
            let name = file.and_then(Path::file_name).map(|name| name.to_string_lossy());
            let from = name.map_or_else(String::new, |name| format!(" from {name}"));
            format!("mesh of {count} triangles{from}")
        }
    }
}

fn backbone(robot: &Robot) -> String {
    let backbone = robot.backbone();
    let section = match &backbone.section {
        None if backbone.stiffness.is_some() => None,
        None => Some("cross-section not given".to_owned()),
        Some(Section::Round { outer, inner }) => Some(round(outer, inner)),
        Some(Section::Rectangle { width, height }) => {
            let tapered = if width.is_uniform() && height.is_uniform() { "" } else { "tapered " };
            let (width, height) = (lengths(width), lengths(height));
            Some(format!("{tapered}rectangular bar, {width} by {height}"))
        }
    };
    let rest = match &backbone.rest_curvature {
        curvature if curvature.is_zero() => "straight at rest".to_owned(),
        RestCurvature::Uniform(u) => format!("rest curvature {} 1/m", vector(*u)),
        RestCurvature::PerDisk(_) => "rest curvature given at each disk".to_owned(),
        RestCurvature::At { arc_lengths, .. } => {
            format!("rest curvature given at {}", places(arc_lengths.len()))
        }
    };
    let weight = backbone.linear_density.as_ref().map(|along| {
        let (from, to) = along.ends();
        format!("{} g/m", from_to(from * 1e3, to * 1e3))
    });
    let length = Some(format!("{} long", millimetres(backbone.length)));
    let material = backbone.material.name.map(str::to_owned);
    let parts = [length, section, material, Some(rest), weight];
    parts.into_iter().flatten().collect::<Vec<_>>().join(", ")
}

fn places(count: usize) -> String {
    if count == 1 { "1 place".to_owned() } else { format!("{count} places") }
}

fn round(outer: &Along<f64>, inner: &Along<f64>) -> String {
    let solid = inner.values().iter().all(|d| *d == 0.0);
    match (outer.is_uniform() && inner.is_uniform(), solid) {
        (true, true) => format!("solid rod, diameter {}", lengths(outer)),
        (true, false) => format!("tube, diameters {} and {}", lengths(outer), lengths(inner)),
        (false, true) => format!("tapered, diameter {}", lengths(outer)),
        (false, false) => format!("tapered, diameter {}, bore {}", lengths(outer), lengths(inner)),
    }
}

/// A length that may vary: from the base to the tip.
fn lengths(along: &Along<f64>) -> String {
    let (base, tip) = along.ends();
    if along.is_uniform() {
        millimetres(*base)
    } else {
        format!("{} to {}", millimetres(*base), millimetres(*tip))
    }
}

/// Two numbers, or one where they are the same.
fn from_to(a: f64, b: f64) -> String {
    let (a, b) = (number(a, 5), number(b, 5));
    if a == b { a } else { format!("{a} to {b}") }
}

fn stiffness(robot: &Robot) -> String {
    let backbone = robot.backbone();
    let mut parts = match &backbone.stiffness {
        Some(given) => given_stiffness(robot, given),
        None => material_stiffness(robot),
    };
    if backbone.shear_correction != 1.0 {
        parts.push(format!("shear correction {}", number(backbone.shear_correction, 5)));
    }
    parts.extend(bending_friction::of_robot(robot));
    let held = [(backbone.extensible, "does not stretch"), (backbone.shearable, "does not shear")];
    parts.extend(held.iter().filter(|(free, _)| !free).map(|(_, words)| (*words).to_owned()));
    parts.join(", ")
}

fn given_stiffness(robot: &Robot, given: &Stiffness) -> Vec<String> {
    let backbone = robot.backbone();
    let end = |s| given.at_end(robot.disks(), s, s);
    let (base, tip) = (end(0.0), end(backbone.length));
    let range = |name: &str, unit: &str, i: usize| {
        format!("{name} {} {unit}", from_to(base[i][i], tip[i][i]))
    };
    let mut parts = Vec::new();
    if base[3][3] == base[4][4] && tip[3][3] == tip[4][4] {
        parts.push(range("EI", "N·m²", 3));
    } else {
        parts.push(range("EI_x", "N·m²", 3));
        parts.push(range("EI_y", "N·m²", 4));
    }
    parts.push(range("GJ", "N·m²", 5));
    if backbone.extensible {
        parts.push(range("EA", "N", 2));
    }
    if given.is_coupled() {
        parts.push("coupled".to_owned());
    }
    parts
}

fn material_stiffness(robot: &Robot) -> Vec<String> {
    let backbone = robot.backbone();
    let Some(young) = backbone.material.young_modulus else {
        return vec!["Young's modulus not given".to_owned()];
    };
    let at = |s| backbone.section_at(robot.disks(), s);
    let (Some(base), Some(tip)) = (at(0.0), at(backbone.length)) else {
        return vec![format!("E {} Pa", number(young, 5))];
    };
    let range = |name: &str, unit: &str, f: &dyn Fn(&SectionProperties) -> f64| {
        format!("{name} {} {unit}", from_to(f(&base), f(&tip)))
    };
    let mut parts = Vec::new();
    if base.second_moment_x == base.second_moment_y && tip.second_moment_x == tip.second_moment_y {
        parts.push(range("EI", "N·m²", &|p| young * p.second_moment_x));
    } else {
        parts.push(range("EI_x", "N·m²", &|p| young * p.second_moment_x));
        parts.push(range("EI_y", "N·m²", &|p| young * p.second_moment_y));
    }
    match backbone.material.shear_modulus() {
        Some(shear) => parts.push(range("GJ", "N·m²", &|p| shear * p.torsion_constant)),
        None => {
            parts.push("GJ unknown: neither Poisson's ratio nor shear modulus given".to_owned())
        }
    }
    if backbone.extensible {
        parts.push(range("EA", "N", &|p| young * p.area));
    }
    parts
}

fn disks(disks: &Disks) -> String {
    let s = &disks.arc_lengths;
    let pitch = s[s.len() - 1] / (s.len() - 1) as f64;
    if !disks.are_present {
        return format!("none; {} stations, every {}", disks.count(), millimetres(pitch));
    }
    let equal = s.windows(2).all(|w| (w[1] - w[0] - pitch).abs() < 1e-9 * pitch);
    let spacing = if equal {
        format!("every {}", millimetres(pitch))
    } else {
        let at: Vec<String> = s.iter().map(|&x| number(x * 1e3, 5)).collect();
        format!("at {} mm", at.join(", "))
    };
    let holes = disks.holes.map_or(String::new(), |n| format!(", {n} holes"));
    let circle = match extent(&disks.hole_circle_radii) {
        None => String::new(),
        Some((a, b)) if a == b => format!(" on a circle of radius {}", millimetres(a)),
        Some((a, b)) => format!(" on circles of radius {} to {}", millimetres(a), millimetres(b)),
    };
    let mass = if disks.mass > 0.0 {
        format!(", {} g each", number(disks.mass * 1e3, 4))
    } else {
        String::new()
    };
    let rim = match (disks.outer_radius, disks.thickness) {
        (None, None) => String::new(),
        (radius, thickness) => {
            let radius = radius.map(|r| format!("outer radius {}", millimetres(r)));
            let thickness = thickness.map(|t| format!("{} thick", millimetres(t)));
            let parts = [radius, thickness].into_iter().flatten();
            format!(", {}", parts.collect::<Vec<_>>().join(", "))
        }
    };
    format!("{}, {spacing}{holes}{circle}{mass}{rim}", disks.count())
}

fn command_words(command: &CableCommand) -> String {
    let tension = command.tension.map(|tension| format!("tension {}", newtons(tension)));
    let shortening = command.shortening.map(|value| format!("shortening {}", shortening(value)));
    match (tension, shortening) {
        (None, None) => "neither tension nor shortening given".to_owned(),
        (Some(one), None) | (None, Some(one)) => one,
        (Some(tension), Some(shortening)) => format!("{tension}, {shortening}"),
    }
}

fn cable_words(cable: &Cable, ends_midway: Option<f64>, command: Option<&CableCommand>) -> String {
    let mut parts = vec![routing(&cable.routing)];
    let HoleOffset { angle, radius } = cable.hole_offset;
    if angle != 0.0 {
        parts.push(format!("{} beside them", degrees(angle)));
    }
    if radius != 0.0 {
        let side = if radius > 0.0 { "beyond" } else { "within" };
        parts.push(format!("{} {side} their circle", millimetres(radius.abs())));
    }
    if let Some(end) = ends_midway {
        parts.push(format!("ends at {}", millimetres(end)));
    }
    parts.extend(command.map(command_words));
    if let Some(friction) = cable.friction {
        parts.push(format!("friction {}", number(friction, 4)));
    }
    if let Some(stiffness) = cable.axial_stiffness {
        parts.push(format!("axial stiffness {}", newtons(stiffness)));
    }
    parts.join(", ")
}

fn routing(routing: &Routing) -> String {
    let point = |p: &[f64; 2]| format!("({}, {}) mm", number(p[0] * 1e3, 5), number(p[1] * 1e3, 5));
    match routing {
        Routing::Holes { holes, interpolation } => {
            let holes: Vec<String> = holes.iter().map(usize::to_string).collect();
            let name = match interpolation {
                Interpolation::Spline => "spline",
                Interpolation::Pchip => "pchip",
                Interpolation::Fourier => "Fourier series",
            };
            format!("holes {} ({name} between disks)", holes.join("-"))
        }
        Routing::Straight { angle, radius } => {
            format!("straight at {}, {} from the axis", degrees(*angle), millimetres(*radius))
        }
        Routing::Helix { start_angle, turns, radius } => format!(
            "helix of {} turns from {}, {} from the axis",
            number(*turns, 5),
            degrees(*start_angle),
            millimetres(*radius)
        ),
        Routing::Linear { start, end } => {
            format!("linear from {} to {}", point(start), point(end))
        }
        Routing::Polynomial { x, y } => {
            let degree = x.len().max(y.len()).saturating_sub(1);
            format!("polynomial of degree {degree}")
        }
    }
}

fn loads(loads: &Loads) -> String {
    let mut parts = Vec::new();
    if let Some(gravity) = loads.gravity {
        parts.push(format!("gravity {} m/s²", vector(gravity)));
    }
    let follows = if loads.tip_follower { ", turning with the tip" } else { "" };
    if loads.tip_force != Vec3::ZERO {
        parts.push(format!("tip force {} N{follows}", vector(loads.tip_force)));
    }
    if loads.tip_moment != Vec3::ZERO {
        parts.push(format!("tip moment {} N·m{follows}", vector(loads.tip_moment)));
    }
    for point in &loads.points {
        let mut what = Vec::new();
        if point.force != Vec3::ZERO {
            what.push(format!("force {} N", vector(point.force)));
        }
        if point.moment != Vec3::ZERO {
            what.push(format!("moment {} N·m", vector(point.moment)));
        }
        let follows = if point.follower { ", turning with the backbone" } else { "" };
        parts.push(format!("{} at {}{follows}", what.join(" and "), millimetres(point.at)));
    }
    parts.extend(loads.distributed.iter().map(distributed));
    for mass in &loads.masses {
        parts.push(format!("{} g at {}", number(1e3 * mass.mass, 4), millimetres(mass.at)));
    }
    if loads.frame == LoadFrame::World && !loads.is_none() {
        parts.push("in the frame of the world".to_owned());
    }
    if parts.is_empty() { "none".to_owned() } else { parts.join("; ") }
}

fn distributed(load: &DistributedLoad) -> String {
    let mut what = Vec::new();
    let (mut places, mut knots) = ([0.0; 2], 0);
    for (i, piece) in load.profile.pieces().enumerate() {
        if i == 0 {
            places[0] = piece.at[0];
        }
        (places[1], knots) = (piece.at[1], i + 2);
    }
    let ends = |of: fn(&Piece) -> [Vec3; 2], unit: &str| {
        let pieces: Vec<[Vec3; 2]> = load.profile.pieces().map(|piece| of(&piece)).collect();
        let [first, .., last] = pieces.iter().flatten().copied().collect::<Vec<_>>()[..] else {
            return None;
        };
        if pieces.iter().flatten().all(|v| *v == Vec3::ZERO) {
            None
        } else if pieces.iter().flatten().all(|v| *v == first) {
            Some(format!("{} {unit}", vector(first)))
        } else {
            Some(format!("from {} to {} {unit}", vector(first), vector(last)))
        }
    };
    what.extend(ends(|piece| piece.force, "N/m").map(|text| format!("force {text}")));
    what.extend(ends(|piece| piece.moment, "N·m/m").map(|text| format!("moment {text}")));
    let [from, to] = places.map(millimetres);
    let stations = if knots > 2 { format!(" at {knots} stations") } else { String::new() };
    let follows = if load.follower { ", turning with the backbone" } else { "" };
    let what = if what.is_empty() { "nothing".to_owned() } else { what.join(" and ") };
    format!("{what} spread from {from} to {to}{stations}{follows}")
}

fn placed(pose: &Pose) -> String {
    let place = pose.position;
    let mut text = format!("at {}", [place.x, place.y, place.z].map(millimetres).join(", "));
    let turn = pose.rotation.log();
    let angle = turn.norm();
    if angle > 0.0 {
        text += &format!(", turned by {} about {}", degrees(angle), vector(turn / angle));
    }
    text
}

/// What an answer's stability means, where it is to be known.
pub fn instability(solution: &Solution) -> Option<String> {
    let diagnostics = &solution.diagnostics;
    let share = |load: f64| format!("{} % of the load", number(100.0 * load, 3));
    match (
        diagnostics.stability.filter(|_| diagnostics.is_unstable()),
        diagnostics.stability_lost_at,
    ) {
        (Some(least), lost_at) => {
            let buckles =
                lost_at.map_or_else(String::new, |load| format!("; it buckles at {}", share(load)));
            let least = number(least, 3);
            Some(format!("unstable: the robot leaves this shape (stability {least}){buckles}"))
        }
        (None, Some(load)) => {
            // With friction of obstacles only an odd number of unstable directions would be known.
            let touching = diagnostics.stability_absent == Some(NoStability::Touching);
            let kind = if touching { "one" } else { "a stable one" };
            Some(format!(
                "snapped through: at {} the robot leaves the shape it had; this is {kind} beyond",
                share(load)
            ))
        }
        (None, None) => None,
    }
}

/// Of an answer to lengths that contradict each other a little: which cable is longer than prescribed, and by how
/// much. Only four-bar gives such answers.
pub fn compromise(solution: &Solution, case: &Case) -> Option<String> {
    let misses = &solution.diagnostics.length_misses;
    if !misses.is_empty() {
        return Some(format!(
            "least squares: the prescribed cable lengths contradict each other; {}",
            LengthMiss::describe(misses, " is")
        ));
    }
    if solution.model != ModelKind::FourBar || solution.cables.iter().any(|c| c.tension.is_some()) {
        // Where tensions are known the lengths are met, up to what elastic cables stretch.
        return None;
    }
    let least = 1e-6 * solution.shape.arc_length.last()?;
    let excess = solution.cables.iter().zip(&case.commands).filter_map(|(cable, command)| {
        let shortening = command.shortening?.in_metres(cable.initial_length);
        Some((&cable.name, cable.length - (cable.initial_length - shortening)))
    });
    let (name, most) = excess.max_by(|a, b| a.1.total_cmp(&b.1))?;
    (most > least).then(|| {
        let most = millimetres(most);
        format!(
            "compromise: the prescribed cable lengths contradict each other; cable `{name}` is {most} too long"
        )
    })
}

/// What drives a model: the tension or shortening of each cable that it uses.
pub fn driven_by(model: ModelKind, actuation: Actuation, case: &Case) -> String {
    let prefers_tension = match actuation {
        Actuation::Natural => model.natural_actuation() == Actuation::Tension,
        Actuation::Tension => true,
        Actuation::Shortening => false,
    };
    let is_strict = actuation != Actuation::Natural;
    let (mut tensions, mut shortenings) = (Vec::new(), Vec::new());
    for command in &case.commands {
        let tension = command.tension.map(newtons);
        let shortening = command.shortening.map(shortening);
        match (prefers_tension, tension, shortening) {
            (true, Some(value), _) => tensions.push(value),
            (false, _, Some(value)) => shortenings.push(value),
            (true, None, Some(value)) if !is_strict => shortenings.push(value),
            (false, Some(value), None) if !is_strict => tensions.push(value),
            _ => {}
        }
    }
    let list = |name: &str, values: Vec<String>| {
        (!values.is_empty()).then(|| format!("{name} {}", values.join(", ")))
    };
    let parts: Vec<String> = [list("tension", tensions), list("shortening", shortenings)]
        .into_iter()
        .flatten()
        .collect();
    if parts.is_empty() { "loads alone".to_owned() } else { parts.join("; ") }
}
