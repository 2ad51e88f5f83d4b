//! What a model says of itself: what drives it by nature, and how it differentiates by that.

use crate::common::{paper_robot, straight};
use whipcord::kinematics::DerivativeMethod;
use whipcord::{
    Actuation, CableCommand, Case, CommandDerivatives, Differentiable, Model, ModelKind, Shape,
    Shortening, Statics, Stations,
};

/// A straight cable whose tension and shortening contradict each other, so that it shows which of them counts.
#[test]
fn each_is_driven_by_what_it_says() {
    let robot = paper_robot(vec![straight(0.0)]);
    let command = CableCommand { tension: Some(1.0), shortening: Some(Shortening::Fraction(0.05)) };
    let case = Case { commands: vec![command], ..Case::default() };
    for kind in ModelKind::ALL {
        let solve = |actuation| -> Option<Shape> {
            Some(Model::new(kind, Stations::Disks, actuation).solve(&robot, &case).ok()?.disks)
        };
        let natural = solve(Actuation::Natural).unwrap();
        assert_ne!(kind.natural_actuation(), Actuation::Natural);
        assert_eq!(solve(kind.natural_actuation()).as_ref(), Some(&natural), "{kind}");
        let other = match kind.natural_actuation() {
            Actuation::Shortening => Actuation::Tension,
            Actuation::Natural | Actuation::Tension => Actuation::Shortening,
        };
        assert!(solve(other).is_none_or(|shape| shape.rms_distance(&natural) > 1e-3), "{kind}");
    }
}

#[test]
fn derivatives_come_from_where_each_says() {
    let robot = paper_robot(vec![straight(0.0)]);
    for kind in ModelKind::ALL {
        let model = Model::new(kind, Stations::Disks, Actuation::Natural);
        let Ok((_, local)) = model.solve_at(&robot, &Case::with_tensions(&[1.0]), 0.09) else {
            // It is driven by shortenings.
            assert_eq!(kind, ModelKind::FourBar);
            continue;
        };
        let exact = local.method == DerivativeMethod::Exact;
        assert_eq!(exact, kind.command_derivatives() == CommandDerivatives::Exact, "{kind}");
    }
}
