//! A section of a robot: what lies between two neighbouring disks.

use whipcord_numerics::{GAUSS_3, Sym3, Vec3};

use super::bend::Bend;
use super::length::Passage;
use super::measure::Measure;
use super::options::{Chord, Objective};
use super::plane::{Jet, Vec2};
use crate::error::SolveError;
use crate::model::ModelKind;
use crate::robot::Robot;

/// What lies between two neighbouring disks.
#[derive(Clone, Debug)]
pub(super) struct Section {
    /// Length l₀ of the backbone.
    pub length: f64,
    pub chord: Chord,
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

    /// `H⁻¹g` and `gᵀH⁻¹g` at the straight shape, with the gradient g of a cable's length and the
    /// Hessian H of the measure: how easily the section gives way to that cable.
    pub fn lever(&self, passage: &Passage) -> (Vec3, f64) {
        let turn = Bend::STRAIGHT.turn();
        let g = passage.length(&turn, self.length, self.chord).gradient;
        let h = self.rest_hessian();
        let scaled = Vec3::new(g.x / h.xx, g.y / h.yy, g.z / h.zz);
        (scaled, g.dot(scaled))
    }

    /// Hessian of the measure at the straight shape, where it is diagonal.
    pub fn rest_hessian(&self) -> Sym3 {
        self.measure(Bend::STRAIGHT).hessian
    }
}

/// The sections of a robot, base first.
pub(super) fn sections(
    robot: &Robot,
    objective: Objective,
    chord: Chord,
) -> Result<Vec<Section>, SolveError> {
    let s = &robot.disks().arc_lengths;
    let ends = cable_ends(robot)?;
    let mut sections = Vec::with_capacity(s.len() - 1);
    for i in 0..s.len() - 1 {
        let length = s[i + 1] - s[i];
        let mut passages = Vec::new();
        for (cable, route) in robot.routes().iter().enumerate() {
            if i < ends[cable] {
                let hole = |disk: usize| {
                    let offset = route.at(s[disk].min(route.end())).offset;
                    Vec2::new(offset.x, offset.y)
                };
                passages.push(Passage::new(cable, length, hole(i), hole(i + 1)));
            }
        }
        let (measure, weight) = measure(robot, objective, &passages, i)?;
        let mut section = Section { length, chord, passages, measure, weight, guess: None };
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

/// A cable whose `gᵀH⁻¹g` is below this many squared section lengths does not decide which way its
/// section bends.
pub(super) const NO_LEVER: f64 = 1e-16;

/// Number of the disk, from 0, at which each cable ends.
fn cable_ends(robot: &Robot) -> Result<Vec<usize>, SolveError> {
    let s = &robot.disks().arc_lengths;
    let slack = 1e-9 * robot.backbone().length;
    let ends = robot.routes().iter().enumerate().map(|(i, route)| {
        s.iter().position(|&at| (at - route.end()).abs() <= slack).ok_or_else(|| {
            SolveError::Unsupported {
                model: ModelKind::FourBar,
                path: format!("cables[{i}].ends_at"),
                what: "a cable that ends between two disks",
                advice: "let it end at a disk, or use cosserat",
            }
        })
    });
    ends.collect()
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
    let nu = robot.backbone().material.poisson_ratio().ok_or_else(|| SolveError::Missing {
        model: ModelKind::FourBar,
        path: "backbone.poisson_ratio".to_owned(),
        advice: "give it (or young_modulus and shear_modulus), or take the objective coupler-angle",
    })?;
    let s = &robot.disks().arc_lengths;
    let relative_length = (s[i + 1] - s[i]) / robot.backbone().length;
    let Some([x, y, z]) = bending_moments(robot, s[i], s[i + 1]) else {
        let weights = [1.0, 1.0, 1.0 / (1.0 + nu)];
        return Ok((Measure::StrainEnergy(weights), 1.0 / relative_length));
    };
    // GJ = E J/(2(1+ν)), which for a circle is EI/(1+ν).
    let weights = [1.0, y / x, z / (2.0 * (1.0 + nu) * x)];
    let reference = reference_moment(robot).unwrap_or(x);
    Ok((Measure::StrainEnergy(weights), x / reference / relative_length))
}

/// The second moment of area to which the sections' weights refer, in m⁴: that about x at the base.
pub(super) fn reference_moment(robot: &Robot) -> Option<f64> {
    Some(robot.backbone().section_at(robot.disks(), 0.0)?.second_moment_x)
}

/// I_x, I_y and J of the part from `a` to `b`, by their mean compliance: what a constant moment
/// would find.
fn bending_moments(robot: &Robot, a: f64, b: f64) -> Option<[f64; 3]> {
    let mut compliance = [0.0; 3];
    for (t, w) in GAUSS_3.nodes.iter().zip(GAUSS_3.weights) {
        let at = robot.backbone().section_at(robot.disks(), a + (b - a) * t)?;
        let stiffness = [at.second_moment_x, at.second_moment_y, at.torsion_constant];
        for k in 0..3 {
            compliance[k] += w / stiffness[k];
        }
    }
    Some(compliance.map(|c| 1.0 / c))
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
