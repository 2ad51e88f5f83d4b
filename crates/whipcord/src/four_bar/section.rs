//! A section of a robot: what lies between two neighbouring disks.

use whipcord_numerics::{GAUSS_3, Jet, Sym3, Vec3};

use super::bend::Bend;
use super::length::Passage;
use super::measure::Measure;
use super::options::{Chord, Objective};
use super::plane::Vec2;
use crate::error::SolveError;
use crate::kind::ModelKind;
use crate::robot::Robot;

/// What lies between two neighbouring disks.
#[derive(Clone, Debug)]
pub(super) struct Section {
    /// Length l₀ of the backbone.
    pub length: f64,
    pub chord: Chord,
    /// How it stands before actuation.
    pub rest: Bend,
    /// The cables that pass.
    pub passages: Vec<Passage>,
    measure: Measure,
    /// Factor of the measure: what this section weighs beside the others, eq. (5).
    weight: f64,
    /// For a section with one cable, the direction of eq. (7), by unit of length, and the
    /// multiplier that goes with it; `None` when the cable has no lever arm.
    pub guess: Option<(Vec3, f64)>,
}

impl Section {
    /// What is minimised, times the section's weight.
    #[inline]
    pub fn measure(&self, bend: Bend) -> Jet {
        self.measure.at(&bend.turn()) * self.weight
    }

    /// What is minimised, and half the squared length of the only cable.
    #[inline]
    pub fn with_one(&self, passage: &Passage, bend: Bend) -> (Jet, Jet) {
        let turn = bend.turn();
        let half = passage.half_square(&turn, self.length, self.chord);
        (self.measure.at(&turn) * self.weight, half)
    }

    /// `H⁻¹g` and `gᵀH⁻¹g` at rest, with the gradient g of a cable's length and the
    /// Hessian H of the measure: how easily the section gives way to that cable.
    pub fn lever(&self, passage: &Passage) -> (Vec3, f64) {
        let g = passage.length(&self.rest.turn(), self.length, self.chord).gradient;
        // The measure is least at rest, and grows with every coordinate.
        let scaled = self.rest_hessian().ldlt().map_or(Vec3::ZERO, |h| h.solve(g));
        (scaled, g.dot(scaled))
    }

    /// Hessian of the measure at rest.
    pub fn rest_hessian(&self) -> Sym3 {
        self.measure(self.rest).hessian
    }
}

/// The sections of a robot, base first.
pub(super) fn sections(
    robot: &Robot,
    objective: Objective,
    chord: Chord,
) -> Result<Vec<Section>, SolveError> {
    let s = &robot.disks().arc_lengths;
    let ends = endings(robot);
    let mut sections = Vec::with_capacity(s.len() - 1);
    for i in 0..s.len() - 1 {
        let length = s[i + 1] - s[i];
        let (rotation, way) = robot.backbone().rest_rotation(robot.disks(), s[i], s[i + 1]);
        let rest = Bend::of(rotation).filter(|_| way < core::f64::consts::PI);
        let rest = rest.ok_or_else(turned_over)?;
        let mut passages = Vec::new();
        for (cable, route) in robot.routes().iter().enumerate() {
            let Ending { sections: whole, part } = ends[cable];
            let part = if i < whole { 1.0 } else { part };
            if i <= whole && part > 0.0 {
                let hole = |disk: usize| {
                    let offset = route.at(s[disk].min(route.end())).offset;
                    Vec2::new(offset.x, offset.y)
                };
                let passage = Passage::new(cable, length, hole(i), hole(i + 1), part);
                passages.push(passage.at_rest(rest, length, chord));
            }
        }
        let (measure, weight) = measure(robot, objective, &passages, i)?;
        let measure = if rest == Bend::STRAIGHT { measure } else { measure.from(rotation) };
        let mut section = Section { length, chord, rest, passages, measure, weight, guess: None };
        if let [passage] = section.passages[..] {
            let (scaled, lever) = section.lever(&passage);
            if lever > NO_LEVER * length * length {
                section.guess = Some((scaled * (1.0 / lever), -1.0 / lever));
            }
        }
        sections.push(section);
    }
    Ok(sections)
}

fn turned_over() -> SolveError {
    SolveError::Unsupported {
        model: ModelKind::FourBar,
        path: "backbone.rest_curvature".to_owned(),
        what: "a section that turns by half a turn or more at rest",
        advice: "put more disks on it, or use cosserat",
    }
}

/// A cable whose `gᵀH⁻¹g` is below this many squared section lengths does not decide which way its
/// section bends.
pub(super) const NO_LEVER: f64 = 1e-16;

/// Where a cable ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Ending {
    /// How many sections it passes whole,
    pub sections: usize,
    /// and the fraction of the next; 0 for a cable that ends at a disk.
    pub part: f64,
}

/// Where each cable ends.
pub(super) fn endings(robot: &Robot) -> Vec<Ending> {
    let s = &robot.disks().arc_lengths;
    let slack = 1e-9 * robot.backbone().length;
    let of = |end: f64| match s.iter().position(|&at| (at - end).abs() <= slack) {
        Some(sections) => Ending { sections, part: 0.0 },
        None => {
            let (sections, part) = robot.disks().locate(end);
            Ending { sections, part }
        }
    };
    robot.routes().iter().map(|route| of(route.end())).collect()
}

/// The measure of section `i` and its weight.
fn measure(
    robot: &Robot,
    objective: Objective,
    passages: &[Passage],
    i: usize,
) -> Result<(Measure, f64), SolveError> {
    if objective != Objective::StrainEnergy {
        let mut directions: Vec<Vec2> = passages.iter().map(direction).collect();
        if directions.is_empty() {
            directions.push(Vec2::X);
        }
        return Ok((Measure::CouplerAngle(directions), 1.0));
    }
    let s = &robot.disks().arc_lengths;
    let relative_length = (s[i + 1] - s[i]) / robot.backbone().length;
    let Some([x, y, z]) = stiffness(robot, s[i], s[i + 1])? else {
        let weights = [1.0, 1.0, 1.0 / (1.0 + poisson_ratio(robot)?)];
        return Ok((Measure::StrainEnergy(weights), 1.0 / relative_length));
    };
    let weights = [1.0, y / x, z / x];
    let reference = reference_stiffness(robot)?.unwrap_or(x);
    Ok((Measure::StrainEnergy(weights), x / reference / relative_length))
}

pub(super) fn poisson_ratio(robot: &Robot) -> Result<f64, SolveError> {
    robot.backbone().material.poisson_ratio().ok_or_else(|| SolveError::Missing {
        model: ModelKind::FourBar,
        path: "backbone.poisson_ratio".to_owned(),
        advice: "give it (or young_modulus and shear_modulus), or take the objective coupler-angle",
    })
}

/// The bending stiffness to which the sections' weights refer: EI about x at the base, by unit of
/// [`modulus`]. `None` where no section is given.
pub(super) fn reference_stiffness(robot: &Robot) -> Result<Option<f64>, SolveError> {
    Ok(stiffness_at(robot, 0.0, 0.5 * robot.disks().arc_lengths[1])?.map(|[x, ..]| x))
}

/// What [`reference_stiffness`] is to be multiplied by: Young's modulus, where the stiffness is that
/// of a material.
pub(super) fn modulus(robot: &Robot) -> Option<f64> {
    match robot.backbone().stiffness {
        Some(_) => Some(1.0),
        None => robot.backbone().material.young_modulus,
    }
}

/// EI about x and y and GJ by unit of [`modulus`]: given, or of the section, whose
/// `GJ = E J/(2(1+ν))`.
fn stiffness_at(robot: &Robot, at: f64, inside: f64) -> Result<Option<[f64; 3]>, SolveError> {
    let backbone = robot.backbone();
    let [bending_factor, torsion_factor] = (backbone.segment_at(inside))
        .map_or([1.0; 2], |(_, segment)| [segment.bending_factor, segment.torsion_factor]);
    let multiplied =
        |[x, y, twist]: [f64; 3]| [bending_factor * x, bending_factor * y, torsion_factor * twist];
    if let Some(given) = &backbone.stiffness {
        let k = given.at_end(robot.disks(), at, inside);
        return Ok(Some(multiplied([k[3][3], k[4][4], k[5][5]])));
    }
    let Some(section) = &backbone.section else { return Ok(None) };
    let area = section.at_end(robot.disks(), at, inside);
    let torsion = area.torsion_constant / (2.0 * (1.0 + poisson_ratio(robot)?));
    Ok(Some(multiplied([area.second_moment_x, area.second_moment_y, torsion])))
}

/// The same of the part from `a` to `b`, by its mean compliance: what a constant moment would find.
/// Between the places where it is given the stiffness is smooth.
fn stiffness(robot: &Robot, a: f64, b: f64) -> Result<Option<[f64; 3]>, SolveError> {
    let mut places = robot.backbone().places();
    places.retain(|s| a < *s && *s < b);
    places.extend([a, b]);
    places.sort_by(f64::total_cmp);
    let mut compliance = [0.0; 3];
    for piece in places.windows(2) {
        let part = (piece[1] - piece[0]) / (b - a);
        for (t, w) in GAUSS_3.nodes.iter().zip(GAUSS_3.weights) {
            let s = piece[0] + (piece[1] - piece[0]) * t;
            let Some(at) = stiffness_at(robot, s, s)? else { return Ok(None) };
            for k in 0..3 {
                compliance[k] += part * w / at[k];
            }
        }
    }
    Ok(Some(compliance.map(|c| 1.0 / c)))
}

/// Direction of a cable's hole in the upper disk: where that is at the centre, of the hole in the
/// lower disk.
fn direction(passage: &Passage) -> Vec2 {
    for hole in [passage.to, passage.from] {
        let radius = hole.norm();
        if radius > 1e-9 * passage.initial {
            return hole * (1.0 / radius);
        }
    }
    Vec2::X
}
