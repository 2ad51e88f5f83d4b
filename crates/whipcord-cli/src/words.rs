//! A robot and its case in words.

use whipcord::robot::SectionProperties;
use whipcord::{
    Cable, CableCommand, Case, Disks, Drive, Interpolation, Loads, ModelKind, RestCurvature, Robot,
    Routing, Section, Solution, Vec3,
};

use crate::quantity::{degrees, millimetres, newtons, number, shortening, vector};

/// What a file says of its robot and case: name and description of each part.
pub fn describe(robot: &Robot, case: &Case) -> Vec<(String, String)> {
    let mut lines = vec![
        ("backbone".to_owned(), backbone(robot)),
        ("stiffness".to_owned(), stiffness(robot)),
        ("disks".to_owned(), disks(robot.disks())),
    ];
    for ((cable, route), command) in robot.cables().iter().zip(robot.routes()).zip(&case.commands) {
        let midway = (route.end() < robot.backbone().length).then(|| route.end());
        lines.push((format!("cable {}", cable.name), cable_words(cable, midway, command)));
    }
    lines.push(("loads".to_owned(), loads(&case.loads)));
    lines
}

fn backbone(robot: &Robot) -> String {
    let backbone = robot.backbone();
    let section = match &backbone.section {
        None => "cross-section not given".to_owned(),
        Some(Section::Circle { diameter }) => {
            format!("solid rod, diameter {}", millimetres(*diameter))
        }
        Some(Section::Tube { outer, inner }) => {
            format!("tube, diameters {} and {}", millimetres(*outer), millimetres(*inner))
        }
        Some(Section::Rectangle { width, height }) => {
            format!("rectangular bar, {} by {}", millimetres(*width), millimetres(*height))
        }
        Some(Section::Taper { outer, inner }) => {
            let ends = [outer.first(), outer.last()].map(|d| d.copied().unwrap_or_default());
            let bore = if *inner > 0.0 {
                format!(", bore {}", millimetres(*inner))
            } else {
                String::new()
            };
            format!("tapered, diameter {} to {}{bore}", millimetres(ends[0]), millimetres(ends[1]))
        }
    };
    let rest = match &backbone.rest_curvature {
        curvature if curvature.is_zero() => "straight at rest".to_owned(),
        RestCurvature::Uniform(u) => format!("rest curvature {} 1/m", vector(*u)),
        RestCurvature::PerDisk(_) => "rest curvature given at each disk".to_owned(),
    };
    format!("{} long, {section}, {rest}", millimetres(backbone.length))
}

fn stiffness(robot: &Robot) -> String {
    let backbone = robot.backbone();
    let Some(young) = backbone.material.young_modulus else {
        return "Young's modulus not given".to_owned();
    };
    let at = |s| backbone.section_at(robot.disks(), s);
    let (Some(base), Some(tip)) = (at(0.0), at(backbone.length)) else {
        return format!("E {} Pa", number(young, 5));
    };
    let range = |name: &str, unit: &str, f: &dyn Fn(&SectionProperties) -> f64| {
        let (a, b) = (number(f(&base), 5), number(f(&tip), 5));
        if a == b { format!("{name} {a} {unit}") } else { format!("{name} {a} to {b} {unit}") }
    };
    let mut parts = Vec::new();
    if base.second_moment_x == base.second_moment_y {
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
    parts.push(range("EA", "N", &|p| young * p.area));
    parts.join(", ")
}

fn disks(disks: &Disks) -> String {
    let s = &disks.arc_lengths;
    let pitch = s[s.len() - 1] / (s.len() - 1) as f64;
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
    format!("{}, {spacing}{holes}{circle}{mass}", disks.count())
}

fn extent(values: &[f64]) -> Option<(f64, f64)> {
    let least = values.iter().copied().reduce(f64::min)?;
    let greatest = values.iter().copied().reduce(f64::max)?;
    Some((least, greatest))
}

fn cable_words(cable: &Cable, ends_midway: Option<f64>, command: &CableCommand) -> String {
    let mut parts = vec![routing(&cable.routing)];
    if let Some(end) = ends_midway {
        parts.push(format!("ends at {}", millimetres(end)));
    }
    if let Some(tension) = command.tension {
        parts.push(format!("tension {}", newtons(tension)));
    }
    if let Some(value) = command.shortening {
        parts.push(format!("shortening {}", shortening(value)));
    }
    if command.tension.is_none() && command.shortening.is_none() {
        parts.push("neither tension nor shortening given".to_owned());
    }
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
    if parts.is_empty() { "none".to_owned() } else { parts.join("; ") }
}

/// What an answer's stability means, where it is to be known.
pub fn instability(solution: &Solution) -> Option<String> {
    let diagnostics = &solution.diagnostics;
    let least = diagnostics.stability.filter(|_| diagnostics.is_unstable())?;
    Some(format!("unstable: the robot leaves this shape (stability {})", number(least, 3)))
}

/// What drives a model: the tension or shortening of each cable that it uses.
pub fn driven_by(model: ModelKind, drive: Drive, case: &Case) -> String {
    let prefers_tension = match drive {
        Drive::Natural => model == ModelKind::Cosserat,
        Drive::Tension => true,
        Drive::Shortening => false,
    };
    let is_strict = drive != Drive::Natural;
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
