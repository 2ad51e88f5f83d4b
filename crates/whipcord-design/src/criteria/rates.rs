//! How criteria change with the unknowns of least squares, by the exact derivatives of the core.

use super::{Criteria, by_tension, worst};
use crate::criterion::{Criterion, Quantity};
use crate::error::DesignError;
use crate::unknown::{Unknown, Varied};

/// How the terms of criteria change with each unknown: a row for each term.
#[derive(Clone, Debug, Default)]
pub(crate) struct TermRates {
    pub objectives: Vec<Vec<f64>>,
    pub violations: Vec<Vec<f64>>,
}

impl Criteria {
    /// The rates of the terms of [`Criteria::terms`]; `None` where a criterion has none: tensions that follow from lengths, and models without derivatives. Rates by
    /// unknowns without derivatives are zero.
    pub fn rates(&self, of: Varied<'_>) -> Result<Option<TermRates>, DesignError> {
        let is_known = self.model.has_derivatives(of.robot);
        let is_tension = |of: &Criterion| matches!(of.quantity, Quantity::Tension);
        let has_tensions = of.cases.iter().all(by_tension);
        if self.list.iter().any(|of| if is_tension(of) { !has_tensions } else { !is_known }) {
            return Ok(None);
        }
        let mut terms = TermRates::default();
        for (criterion, scale) in self.list.iter().zip(&self.scales) {
            let (values, rates) = self.value_rates(criterion, of)?;
            let count = values.len().max(1) as f64;
            if let Some(weight) = criterion.weight {
                let factor = weight.sqrt();
                let slope = |value: f64| match criterion.quantity {
                    Quantity::Tension => factor / (scale * count.sqrt()),
                    Quantity::Clearance => {
                        if value < *scale {
                            -factor / scale
                        } else {
                            0.0
                        }
                    }
                    Quantity::Stiffness { .. } => -factor * scale / (value * value * count.sqrt()),
                    Quantity::Workspace => -factor * 2.0 * scale / (scale + value).powi(2),
                };
                let least = worst(criterion, &values);
                let of_clearance = matches!(criterion.quantity, Quantity::Clearance);
                let counts = |value: &f64| !of_clearance || *value == least;
                let rows = values.iter().zip(&rates).filter(|(value, _)| counts(value));
                // Of stations that are as near as one another the first.
                let rows = rows.take(if of_clearance { 1 } else { usize::MAX });
                terms.objectives.extend(rows.map(|(value, rate)| scaled(rate, slope(*value))));
            }
            if let Some(limit) = criterion.limit {
                let slope = |value: f64| match criterion.quantity {
                    Quantity::Tension => 1.0 / limit.max(1e-12 * scale),
                    Quantity::Clearance => -1.0 / scale,
                    Quantity::Stiffness { .. } => -limit / (value * value),
                    Quantity::Workspace => -1.0 / limit,
                };
                let rows = values.iter().zip(&rates);
                terms.violations.extend(rows.map(|(value, rate)| scaled(rate, slope(*value))));
            }
        }
        let mut all = terms.objectives.iter().chain(&terms.violations).flatten();
        Ok(all.all(|rate| rate.is_finite()).then_some(terms))
    }

    /// Values of a criterion in the order of [`Criteria::values`], and of each the rates by the unknowns.
    fn value_rates(
        &self,
        criterion: &Criterion,
        of: Varied<'_>,
    ) -> Result<(Vec<f64>, Vec<Vec<f64>>), DesignError> {
        let mut values = Vec::new();
        let mut rates = Vec::new();
        match criterion.quantity {
            Quantity::Tension => {
                for (number, case) in of.cases.iter().enumerate() {
                    for (place, command) in case.commands.iter().enumerate() {
                        values.push(command.tension.unwrap_or(0.0));
                        let is_own = |unknown: &Unknown| {
                            *unknown == Unknown::Tension { goal: number, cable: place }
                        };
                        let rate = |unknown| if is_own(unknown) { 1.0 } else { 0.0 };
                        rates.push(of.unknowns.iter().map(rate).collect());
                    }
                }
            }
            Quantity::Clearance => {
                for (number, case) in of.cases.iter().enumerate() {
                    if !case.obstacles.is_empty() {
                        let (more, of_more) = self.clearance_rates(number, case, of)?;
                        values.extend(more);
                        rates.extend(of_more);
                    }
                }
            }
            Quantity::Stiffness { disk, direction } => {
                for number in 0..of.cases.len() {
                    let (value, rate) = self.stiffness_rates(number, disk, direction, of)?;
                    values.push(value);
                    rates.push(rate);
                }
            }
            Quantity::Workspace => {
                let (value, rate) = self.volume_rates(of)?;
                values.push(value);
                rates.push(rate);
            }
        }
        Ok((values, rates))
    }
}

fn scaled(rates: &[f64], by: f64) -> Vec<f64> {
    rates.iter().map(|rate| by * rate).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chebyshev;
    use crate::unknown::{applied, parameters};
    use core::f64::consts::PI;
    use whipcord::{
        Actuation, Along, Backbone, Cable, Case, Disks, Form, Material, Model, ModelKind, Obstacle,
        Parameter, Pose, Robot, Routing, Section, Statics as _, Stations, Vec3,
    };

    const LENGTH: f64 = 0.18;

    fn robot() -> Robot {
        let diameters = vec![0.0035, 0.003, 0.0028];
        let outer = Along::At { arc_lengths: vec![0.0, 0.5 * LENGTH, LENGTH], values: diameters };
        let mut backbone = Backbone::new(LENGTH);
        backbone.section = Some(Section::Round { outer, inner: Along::Uniform(0.0) });
        let (young_modulus, poisson_ratio) = (Some(1.1e9), Some(0.3));
        backbone.material = Material { young_modulus, poisson_ratio, ..Material::default() };
        let course = Routing::Polynomial { x: vec![0.007, -0.01], y: vec![0.001, 0.01] };
        let straight = Routing::Straight { angle: 2.0, radius: 0.008 };
        let cables = vec![Cable::new("wound", course), Cable::new("straight", straight)];
        let disks = Disks::equally_spaced(LENGTH, 10, 0.008);
        Robot::new(backbone, disks, cables).unwrap()
    }

    /// Each criterion, as an objective and as a constraint, in a robot that is bent and loaded.
    #[test]
    fn rates_are_those_of_differences() {
        let (robot, mut case) = (robot(), Case::with_tensions(&[2.0, 1.0]));
        case.loads.tip_force = Vec3::new(0.03, 0.02, -0.02);
        let pose = Pose { position: Vec3::new(0.06, 0.05, 0.13), ..Pose::IDENTITY };
        case.obstacles = vec![Obstacle {
            name: "ball".to_owned(),
            form: Form::Sphere { radius: 0.02 },
            pose,
            friction: 0.0,
            movable: None,
        }];
        let cases = [case];
        let course = |axis, node| Unknown::Course { cable: 0, axis, node, nodes: 2 };
        let all = [
            Unknown::Tension { goal: 0, cable: 0 },
            Unknown::Parameter(Parameter::DiameterAt { entry: 1 }),
            Unknown::Parameter(Parameter::YoungModulus),
            course(0, 0),
            course(0, 1),
            course(1, 0),
            course(1, 1),
        ];
        let nodes: Vec<f64> = chebyshev::places(2).map(|part| part * LENGTH).collect();
        let [x, y] = [|s: f64| 0.007 - 0.01 * s, |s: f64| 0.001 + 0.01 * s];
        let values = [2.0, 0.003, 1.1e9, x(nodes[0]), x(nodes[1]), y(nodes[0]), y(nodes[1])];
        let of = |quantity, limit| Criterion { quantity, weight: Some(2.0), limit: Some(limit) };
        let list = [
            of(Quantity::Tension, 3.0),
            of(Quantity::Clearance, 0.02),
            of(Quantity::Stiffness { disk: 9, direction: Some(Vec3::X) }, 10.0),
            of(Quantity::Stiffness { disk: 5, direction: None }, 10.0),
            of(Quantity::Workspace, 1e-4),
        ];
        let model = Model::new(ModelKind::Cosserat, Stations::Disks, Actuation::Tension);
        let ranges = vec![[0.0, 4.0]; 2];
        let criteria = Criteria::new(&list, &model, &robot, &cases, ranges).unwrap();
        let parameters = parameters(&all);
        let (now, moved) = applied(&robot, &cases, &all, &values).unwrap();
        let varied = Varied { robot: &now, cases: &moved, unknowns: &all, parameters: &parameters };
        let rates = criteria.rates(varied).unwrap().unwrap();
        for (column, value) in values.iter().enumerate() {
            let step = 1e-4 * value.abs();
            let side = |by: f64| {
                let mut values = values;
                values[column] += by;
                let (robot, cases) = applied(&robot, &cases, &all, &values).unwrap();
                let solutions: Vec<_> =
                    cases.iter().map(|case| model.solve(&robot, case).unwrap()).collect();
                let terms = criteria.terms(&robot, &cases, &solutions).unwrap();
                [terms.objectives, terms.violations].concat()
            };
            let rows = rates.objectives.iter().chain(&rates.violations);
            let (low, high) = (side(-step), side(step));
            assert_eq!(low.len(), rates.objectives.len() + rates.violations.len());
            for (row, ((low, high), rates)) in low.iter().zip(&high).zip(rows).enumerate() {
                let (difference, rate) = ((high - low) / (2.0 * step), rates[column]);
                let off = (difference - rate).abs();
                let scale = difference.abs() + 1e-3 / value.abs();
                assert!(
                    off < 1e-3 * scale,
                    "{:?}, row {row}: {difference:e} {rate:e}",
                    all[column]
                );
            }
        }
    }

    fn cosserat() -> Model {
        Model::new(ModelKind::Cosserat, Stations::Disks, Actuation::Tension)
    }

    /// The rates of the stiffness of a disk along x.
    fn stiffness_rates(
        robot: &Robot,
        case: &Case,
        unknowns: &[Unknown],
        disk: usize,
    ) -> (f64, Vec<f64>) {
        let (cases, parameters) = ([case.clone()], parameters(unknowns));
        let criteria = Criteria::new(&[], &cosserat(), robot, &cases, Vec::new()).unwrap();
        let varied = Varied { robot, cases: &cases, unknowns, parameters: &parameters };
        criteria.stiffness_rates(0, disk, Some(Vec3::X), varied).unwrap()
    }

    /// A straight rod is a cantilever, 1/k = L³/3EI + L/GA.
    #[test]
    fn a_straight_rod_has_the_rates_of_a_cantilever() {
        let (young_modulus, poisson_ratio, diameter) = (1.1e9, 0.3, 0.003);
        let mut backbone = Backbone::new(LENGTH);
        backbone.section = Some(Section::circle(diameter));
        backbone.material = Material {
            young_modulus: Some(young_modulus),
            poisson_ratio: Some(poisson_ratio),
            ..Material::default()
        };
        let cable = Cable::new("slack", Routing::Straight { angle: 0.0, radius: 0.008 });
        let disks = Disks::equally_spaced(LENGTH, 10, 0.008);
        let robot = Robot::new(backbone, disks, vec![cable]).unwrap();
        let unknowns = [Parameter::Diameter, Parameter::YoungModulus].map(Unknown::Parameter);
        let (value, rates) = stiffness_rates(&robot, &Case::with_tensions(&[0.0]), &unknowns, 9);
        let shear_modulus = young_modulus / (2.0 * (1.0 + poisson_ratio));
        let bending = LENGTH.powi(3) * 64.0 / (3.0 * young_modulus * PI * diameter.powi(4));
        let shear = LENGTH * 4.0 / (shear_modulus * PI * diameter.powi(2));
        let stiffness = 1.0 / (bending + shear);
        let exact = [
            stiffness * stiffness * (4.0 * bending + 2.0 * shear) / diameter,
            stiffness / young_modulus,
        ];
        assert!((value / stiffness - 1.0).abs() < 1e-7, "{value} {stiffness}");
        for (rate, exact) in rates.iter().zip(exact) {
            println!("{:e}", rate / exact - 1.0);
            assert!((rate / exact - 1.0).abs() < 1e-7, "{rate:e} {exact:e}");
        }
    }

    /// Where it is bent and loaded, the rates are those of the stiffness itself, which no difference enters.
    #[test]
    fn a_bent_rod_has_the_rates_of_its_stiffness() {
        let (robot, mut case) = (robot(), Case::with_tensions(&[2.0, 1.0]));
        case.loads.tip_force = Vec3::new(0.03, 0.02, -0.02);
        let unknowns = [
            Unknown::Tension { goal: 0, cable: 0 },
            Unknown::Parameter(Parameter::DiameterAt { entry: 1 }),
            Unknown::Parameter(Parameter::YoungModulus),
        ];
        let values = [2.0, 0.003, 1.1e9];
        for disk in [4, 9] {
            let (_, rates) = stiffness_rates(&robot, &case, &unknowns, disk);
            let criteria =
                Criteria::new(&[], &cosserat(), &robot, &[case.clone()], Vec::new()).unwrap();
            for (column, rate) in rates.iter().enumerate() {
                let stiffness = |part: f64| -> Result<Vec<f64>, DesignError> {
                    let mut values = values;
                    values[column] *= 1.0 + part;
                    let (robot, cases) = applied(&robot, &[case.clone()], &unknowns, &values)?;
                    Ok(vec![criteria.stiffness(&robot, &cases[0], disk, Some(Vec3::X))?])
                };
                let wanted =
                    whipcord_numerics::derivative(stiffness, 0.02).unwrap()[0] / values[column];
                println!("{:e}", rate / wanted - 1.0);
                assert!(
                    (rate / wanted - 1.0).abs() < 1e-6,
                    "{:?}: {rate:e} {wanted:e}",
                    unknowns[column]
                );
            }
        }
    }
}
