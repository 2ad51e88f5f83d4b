//! Segments of the backbone: the same as a stiffness that steps, and derivatives by their factors.

use super::{Tested, check_parameters, options};
use crate::common::{distance, helix, paper_backbone, paper_disks, straight};
use whipcord::robot::BackboneSegment;
use whipcord::section::material_stiffness;
use whipcord::{Along, Backbone, Cable, Case, Robot, Stiffness, Vec3};

const FACTORS: [[f64; 2]; 2] = [[0.7, 1.2], [1.6, 0.8]];
/// Where the second segment begins: not at a disk.
const STEP: f64 = 0.075;

fn robot_of(backbone: Backbone) -> Robot {
    let cables = [straight(20.0), helix(120.0, 0.4)];
    let cables = cables.into_iter().enumerate().map(|(i, of)| Cable::new(format!("c{i}"), of));
    Robot::new(backbone, paper_disks(), cables.collect()).unwrap()
}

fn with_segments() -> Robot {
    let segment = |(name, range, [bending_factor, torsion_factor]): (&str, _, [f64; 2])| {
        BackboneSegment { bending_factor, torsion_factor, ..BackboneSegment::new(name, range) }
    };
    let length = paper_backbone().length;
    let named = [("near", [0.0, STEP], FACTORS[0]), ("far", [STEP, length], FACTORS[1])];
    robot_of(Backbone { segments: named.map(segment).to_vec(), ..paper_backbone() })
}

fn case() -> Case {
    let mut case = Case::with_tensions(&[1.5, 0.9]);
    case.loads.tip_force = Vec3::new(0.05, -0.03, 0.02);
    case
}

fn as_a_stiffness_that_steps(tested: Tested) {
    let plain = robot_of(paper_backbone());
    let Stiffness::Diagonal { shear, axial, bending, torsion } =
        material_stiffness(&plain).unwrap()
    else {
        panic!("a material has no coupled stiffness");
    };
    let (ei, gj) = (bending.values()[0], torsion.values()[0]);
    let [[a, b], [c, d]] = FACTORS;
    let places = vec![STEP, STEP];
    let stepped = Stiffness::Diagonal {
        shear,
        axial,
        bending: Along::At {
            arc_lengths: places.clone(),
            values: vec![ei.map(|k| a * k), ei.map(|k| c * k)],
        },
        torsion: Along::At { arc_lengths: places, values: vec![b * gj, d * gj] },
    };
    let stepped = robot_of(Backbone {
        stiffness: Some(stepped),
        material: Default::default(),
        ..paper_backbone()
    });
    let options = options(tested, &case());
    let solve = |robot: &Robot| tested.solve(robot, &case(), &options, None).unwrap();
    let (own, other) = (solve(&with_segments()), solve(&stepped));
    assert!(distance(&own, &other) < 1e-9, "{:e}", distance(&own, &other));
    let without = solve(&plain);
    assert!(distance(&own, &without) > 1e-3, "segments change nothing");
}

fn derivatives_by_factors(tested: Tested) {
    let mut failures = String::new();
    check_parameters(tested, &with_segments(), &case(), &mut failures);
    // Also where the factors are 1, so that the rod is the same all along.
    let neutral = [("near", [0.0, STEP]), ("far", [STEP, 0.15])];
    let neutral = neutral.map(|(name, range)| BackboneSegment::new(name, range)).to_vec();
    let robot = robot_of(Backbone { segments: neutral, ..paper_backbone() });
    check_parameters(tested, &robot, &case(), &mut failures);
    assert!(failures.is_empty(), "{failures}");
}

for_every_model!(as_a_stiffness_that_steps, derivatives_by_factors);
