//! Where a parameter enters the stiffness of a section.

use whipcord_numerics::{Twist, Vec3};

use crate::parameter::{Parameter, StiffnessPart};
use crate::robot::{Robot, SectionProperties};
use crate::section::Stiffness;

/// Derivative of the section's stiffness; `None` where it is zero.
pub(super) fn stiffness_change(
    robot: &Robot,
    s: f64,
    inside: f64,
    present: &Stiffness,
    parameter: &Parameter,
) -> Option<Stiffness> {
    let backbone = robot.backbone();
    // The section has its stiffness times the factor of its segment.
    let here = backbone.segment_at(inside);
    let factors = here.map_or([1.0; 4], |(_, segment)| segment.stiffness_factors());
    match parameter {
        Parameter::StiffnessScale(part) => return Some(part_of(present, *part)),
        Parameter::SegmentFactor { segment, part } => {
            let factor = factors[*part as usize];
            return here.filter(|(number, _)| number == segment).map(|_| {
                let Stiffness { shear, bending } = part_of(present, *part);
                Stiffness { shear: shear / factor, bending: bending / factor }
            });
        }
        _ => {}
    }
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
        let bending = Vec3::new(
            young * p.second_moment_x,
            young * p.second_moment_y,
            shear * p.torsion_constant,
        );
        times(Vec3::new(across, across, young * p.area), bending, factors)
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
            times(Vec3::new(across, across, 0.0), Vec3::ZERO, factors)
        }
        _ => of(young, shear, &backbone.section_change(disks, s, inside, parameter)?),
    })
}

/// One part of a section's stiffness; zero for an axis that is held, whose strain does not change.
fn part_of(stiffness: &Stiffness, part: StiffnessPart) -> Stiffness {
    let Stiffness { shear, bending } = stiffness;
    let free = |k: f64| if k.is_finite() { k } else { 0.0 };
    let (mut s, mut b) = (Vec3::ZERO, Vec3::ZERO);
    match part {
        StiffnessPart::Shear => (s.x, s.y) = (free(shear.x), free(shear.y)),
        StiffnessPart::Extension => s.z = free(shear.z),
        StiffnessPart::Bending => (b.x, b.y) = (bending.x, bending.y),
        StiffnessPart::Torsion => b.z = bending.z,
    }
    Stiffness { shear: s, bending: b }
}

/// A section's stiffness, or its change, in a segment of the backbone.
fn times(shear: Vec3, bending: Vec3, [ga, ea, ei, gj]: [f64; 4]) -> Stiffness {
    Stiffness {
        shear: Vec3::new(ga * shear.x, ga * shear.y, ea * shear.z),
        bending: Vec3::new(ei * bending.x, ei * bending.y, gj * bending.z),
    }
}

/// What a unit of one entry of a symmetric stiffness exerts on a strain.
pub(super) fn entry_wrench(row: usize, column: usize, strain: Twist) -> Twist {
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
