//! How criteria change with the unknowns of least squares, by the exact derivatives of the core.
//!
//! Clearances change with the places of the stations, along the normals of the obstacles. A workspace changes with the places of the tip, whose sensitivities are pulled back to all
//! parameters at once. The compliance along a force changes by a quantity as the motion by that quantity changes along the force: of second derivatives only the one along the force is a difference,
//! so that two solves with derivatives serve all unknowns.

use whipcord::batch::{BatchOptions, Gradients, Sensitivities, pull_back_batch, solve_batch};
use whipcord::derivatives::Place;
use whipcord::{
    Case, LoadFrame, Parameter, PointLoad, Robot, RobotError, SolveError, Stations, Vec3,
};

use super::{Criteria, STATIONS, by_tension, worst};
use crate::chebyshev;
use crate::criterion::{Criterion, Quantity, WORKSPACE_RADIUS};
use crate::error::DesignError;
use crate::soft_volume::soft_volume_slopes;
use crate::unknown::Unknown;

/// What the robot of some unknowns is, and by what it is differentiated.
#[derive(Clone, Copy)]
pub(crate) struct Varied<'a> {
    pub robot: &'a Robot,
    pub cases: &'a [Case],
    pub unknowns: &'a [Unknown],
    /// Those of the core that the unknowns need.
    pub parameters: &'a [Parameter],
}

/// How the terms of criteria change with each unknown: a row for each term.
#[derive(Clone, Debug, Default)]
pub(crate) struct TermRates {
    pub objectives: Vec<Vec<f64>>,
    pub violations: Vec<Vec<f64>>,
}

/// How far the force along which a compliance is differentiated moves its disk, as a part of the length.
const MOVED: f64 = 1e-3;

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

    fn clearance_rates(
        &self,
        number: usize,
        case: &Case,
        of: Varied<'_>,
    ) -> Result<(Vec<f64>, Vec<Vec<f64>>), DesignError> {
        let (backbone, disks) = (of.robot.backbone(), of.robot.disks());
        let stations: Vec<f64> = whipcord::equally_spaced(0.0, backbone.length, STATIONS).collect();
        let free = Case { obstacles: Vec::new(), ..case.clone() };
        let model = self.model.at(Stations::At(stations.clone()));
        let mut prepared = model.prepare(of.robot, &free.loads)?;
        let (solution, derivatives) =
            prepared.solve_with_derivatives(&free, None, of.parameters)?;
        let along = stations.iter().enumerate();
        let along = along.map(|(station, s)| {
            let radius = backbone.outer_radius_at(disks, *s);
            (Place::Station(station), solution.shape.poses[station].position, radius)
        });
        let rims = solution.disks.poses.iter().enumerate();
        let rims =
            rims.map(|(disk, pose)| (Place::Disk(disk), pose.position, disks.rim_radius(disk)));
        let places: Vec<(Place, Vec3, f64)> = along.chain(rims).collect();
        let mut values = Vec::with_capacity(places.len());
        let mut normals = Vec::with_capacity(places.len());
        for (_, at, radius) in &places {
            let nearest = case.obstacles.iter().map(|obstacle| obstacle.surface(*at));
            let nearest = nearest.min_by(|a, b| a.distance.total_cmp(&b.distance));
            values.push(nearest.map_or(f64::INFINITY, |surface| surface.distance - radius));
            normals.push(nearest.map_or(Vec3::ZERO, |surface| surface.normal));
        }
        let mut rates = vec![vec![0.0; of.unknowns.len()]; places.len()];
        let at: Vec<Place> = places.iter().map(|(place, ..)| *place).collect();
        for (column, unknown) in of.unknowns.iter().enumerate() {
            let derivatives = (&derivatives, of.parameters);
            let velocities = unknown.velocities(number, &free, backbone.length, derivatives, &at);
            let radii = radius_rates(unknown, of, &stations)?;
            let radii = radii.into_iter().chain(core::iter::repeat(0.0));
            for (((rates, velocity), normal), radius) in
                rates.iter_mut().zip(&velocities).zip(&normals).zip(radii)
            {
                rates[column] = normal.dot(*velocity) - radius;
            }
        }
        Ok((values, rates))
    }

    fn stiffness_rates(
        &self,
        number: usize,
        disk: usize,
        direction: Option<Vec3>,
        of: Varied<'_>,
    ) -> Result<(f64, Vec<f64>), DesignError> {
        let case = &of.cases[number];
        let (stiffness, n) = self.stiffness_along(of.robot, case, disk, direction)?;
        let length = of.robot.backbone().length;
        let force = MOVED * length * stiffness;
        let base = case.base.rotation;
        let side = |force: f64| -> Result<Vec<f64>, SolveError> {
            let force = match case.loads.frame {
                LoadFrame::Base => base.conjugate().rotate(n) * force,
                LoadFrame::World => n * force,
            };
            let mut pushed = case.clone();
            let at = of.robot.disks().arc_lengths[disk];
            pushed.loads.points.push(PointLoad { at, force, ..PointLoad::default() });
            let mut prepared = self.model.prepare(of.robot, &pushed.loads)?;
            let (_, derivatives) = prepared.solve_with_derivatives(&pushed, None, of.parameters)?;
            let derivatives = (&derivatives, of.parameters);
            let speed = |unknown: &Unknown| {
                let at = [Place::Disk(disk)];
                unknown.velocities(number, &pushed, length, derivatives, &at)[0].dot(n)
            };
            Ok(of.unknowns.iter().map(speed).collect())
        };
        let (pulled, pushed) = (side(-force)?, side(force)?);
        let rate = |(pulled, pushed): (f64, f64)| {
            let of_compliance = (pushed - pulled) / (2.0 * force);
            -stiffness * stiffness * of_compliance
        };
        Ok((stiffness, pulled.into_iter().zip(pushed).map(rate).collect()))
    }

    fn volume_rates(&self, of: Varied<'_>) -> Result<(f64, Vec<f64>), DesignError> {
        let (robot, case) = (of.robot, &of.cases[0]);
        let length = robot.backbone().length;
        let commands = self.sampled_commands();
        let rows = super::rows_of(&commands, case);
        let model = self.model.at(Stations::At(vec![length]));
        let batch = solve_batch(&model, robot, rows, &BatchOptions::default())?;
        let tips: Vec<Option<Vec3>> = (0..batch.len())
            .map(|row| batch.row(row)?.ok().map(|row| Vec3::from(row.position(0))))
            .collect();
        let known = tips.iter().flatten().copied();
        let (volume, slopes) = soft_volume_slopes(known, WORKSPACE_RADIUS * length);
        let mut slopes = slopes.into_iter();
        let mut positions = Vec::with_capacity(3 * tips.len());
        for tip in &tips {
            let slope = tip.and_then(|_| slopes.next()).unwrap_or(Vec3::ZERO);
            positions.extend(slope.to_array());
        }
        let count = of.parameters.len();
        let mut by_commands = vec![0.0; commands.len()];
        let mut by_parameters = vec![0.0; count * tips.len()];
        let sensitivities = Sensitivities { positions: &positions, ..Sensitivities::default() };
        let gradients = Gradients { commands: &mut by_commands, parameters: &mut by_parameters };
        let options = BatchOptions::default();
        pull_back_batch(&model, robot, rows, of.parameters, &options, sensitivities, gradients)?;
        let mut sums = vec![0.0; count];
        for row in by_parameters.chunks(count.max(1)) {
            sums.iter_mut().zip(row).for_each(|(sum, of)| *sum += of);
        }
        let by = |parameter: Parameter| {
            of.parameters.iter().position(|known| *known == parameter).map_or(0.0, |k| sums[k])
        };
        // The commands of a workspace are its own, whatever the tensions of the targets are.
        let rate = |unknown: &Unknown| match *unknown {
            Unknown::Tension { .. } | Unknown::DiskPosition { .. } => 0.0,
            Unknown::Parameter(parameter) => by(parameter),
            Unknown::Course { cable, axis, node, nodes } => {
                let powers = chebyshev::of_node(node, nodes, length).into_iter().enumerate();
                let of =
                    |(power, factor)| factor * by(Parameter::Coefficient { cable, axis, power });
                powers.map(of).sum()
            }
        };
        Ok((volume, of.unknowns.iter().map(rate).collect()))
    }
}

fn scaled(rates: &[f64], by: f64) -> Vec<f64> {
    rates.iter().map(|rate| by * rate).collect()
}

/// How fast the surface of the backbone moves away from its axis at some arc lengths. Radii are linear in the diameters, so that a difference is exact.
fn radius_rates(
    unknown: &Unknown,
    of: Varied<'_>,
    stations: &[f64],
) -> Result<Vec<f64>, RobotError> {
    let Unknown::Parameter(parameter) = unknown else { return Ok(vec![0.0; stations.len()]) };
    let case = &of.cases[0];
    let value = parameter.value(of.robot, case)?;
    let step = 1e-3 * value.abs();
    if step == 0.0 {
        return Ok(vec![0.0; stations.len()]);
    }
    let radii = |value: f64| -> Result<Vec<f64>, RobotError> {
        let (robot, _) = parameter.changed_to(of.robot, case, value)?;
        let radius = |s: &f64| robot.backbone().outer_radius_at(robot.disks(), *s);
        Ok(stations.iter().map(radius).collect())
    };
    let sides = radii(value - step)?.into_iter().zip(radii(value + step)?);
    Ok(sides.map(|(low, high)| (high - low) / (2.0 * step)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::unknown::{applied, parameters};
    use whipcord::{
        Actuation, Along, Backbone, Cable, Disks, Form, Material, Model, ModelKind, Obstacle, Pose,
        Routing, Section, Statics as _,
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
}
