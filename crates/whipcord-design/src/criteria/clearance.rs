//! How far a robot keeps clear of the obstacles of a case, and how that changes.

use whipcord::derivatives::Place;
use whipcord::{Case, Robot, RobotError, Solution, Statics as _, Stations, Vec3};

use super::Criteria;
use crate::error::DesignError;
use crate::unknown::{Unknown, Varied};

/// Stations at which the clearance is taken.
const STATIONS: usize = 41;

/// A place of the robot that is to keep clear.
struct Watched {
    place: Place,
    at: Vec3,
    /// How far from there its surface is.
    radius: f64,
}

impl Watched {
    /// Distance of the surface from the nearest obstacle, and the direction away from that; infinite without obstacles.
    fn gap(&self, case: &Case) -> (f64, Vec3) {
        let surfaces = case.obstacles.iter().map(|obstacle| obstacle.surface(self.at));
        let nearest = surfaces.min_by(|a, b| a.distance.total_cmp(&b.distance));
        nearest.map_or((f64::INFINITY, Vec3::ZERO), |surface| {
            (surface.distance - self.radius, surface.normal)
        })
    }
}

fn stations(robot: &Robot) -> Vec<f64> {
    whipcord::equally_spaced(0.0, robot.backbone().length, STATIONS).collect()
}

/// The case without what the robot is to keep clear of, because a shape in contact touches.
fn without_contact(case: &Case) -> Case {
    Case { obstacles: Vec::new(), ..case.clone() }
}

/// Stations of the backbone with its surface, then disks with their rims.
fn watched(robot: &Robot, stations: &[f64], solution: &Solution) -> Vec<Watched> {
    let (backbone, disks) = (robot.backbone(), robot.disks());
    let along = stations.iter().zip(&solution.shape.poses).enumerate();
    let along = along.map(|(station, (s, pose))| Watched {
        place: Place::Station(station),
        at: pose.position,
        radius: backbone.outer_radius_at(disks, *s),
    });
    let rims = solution.disks.poses.iter().enumerate().map(|(disk, pose)| Watched {
        place: Place::Disk(disk),
        at: pose.position,
        radius: disks.rim_radius(disk),
    });
    along.chain(rims).collect()
}

impl Criteria {
    /// Distance of each station and of each rim from the nearest obstacle, for the shape without contact.
    pub(super) fn clearances(&self, robot: &Robot, case: &Case) -> Result<Vec<f64>, DesignError> {
        let stations = stations(robot);
        let model = self.model.at(Stations::At(stations.clone()));
        let solution = model.solve(robot, &without_contact(case))?;
        let watched = watched(robot, &stations, &solution);
        Ok(watched.iter().map(|of| of.gap(case).0).collect())
    }

    /// The same with the rates of each by the unknowns: places move along the normals of the obstacles.
    pub(super) fn clearance_rates(
        &self,
        number: usize,
        case: &Case,
        of: Varied<'_>,
    ) -> Result<(Vec<f64>, Vec<Vec<f64>>), DesignError> {
        let stations = stations(of.robot);
        let free = without_contact(case);
        let model = self.model.at(Stations::At(stations.clone()));
        let mut prepared = model.prepare(of.robot, &free.loads)?;
        let (solution, derivatives) =
            prepared.solve_with_derivatives(&free, None, of.parameters)?;
        let watched = watched(of.robot, &stations, &solution);
        let (values, normals): (Vec<f64>, Vec<Vec3>) =
            watched.iter().map(|of| of.gap(case)).unzip();
        let mut rates = vec![vec![0.0; of.unknowns.len()]; watched.len()];
        let at: Vec<Place> = watched.iter().map(|of| of.place).collect();
        let length = of.robot.backbone().length;
        for (column, unknown) in of.unknowns.iter().enumerate() {
            let derivatives = (&derivatives, of.parameters);
            let velocities = unknown.velocities(number, &free, length, derivatives, &at);
            // Those of rims do not change.
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
