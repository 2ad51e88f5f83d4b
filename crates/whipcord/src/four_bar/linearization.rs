//! Exact derivatives of an answer by lengths, tensions, loads and parameters, where the strain energy decides on it: of eqs. (14)
//! to (16).
//!
//! What a parameter changes at constant coordinates and tensions is differentiated by differences of the equations.

use whipcord_numerics::Vec3;

use super::FourBar;
use super::bend::Bend;
use super::contact_response::{ContactResponse, Load};
use super::derivatives::contradiction;
use super::length::Passage;
use super::solve::Workspace;
use crate::case::{Case, Shortening};
use crate::contact::Holding;
use crate::derivatives::{
    CoordinateCable, CoordinateDerivatives, Equations, KnownPlaces, LinearSystem, ParameterChange,
    SolvedCoordinates,
};
use crate::error::SolveError;
use crate::kind::ModelKind;
use crate::parameter::Parameter;
use crate::robot::Robot;
use crate::shape::{Solution, Wrench};
use crate::statics::command::Command;

/// Coordinates of a section.
const COORDINATES: usize = 3;

impl FourBar {
    /// Whether it knows how an answer changes with loads and parameters: where the strain energy decides where sections bend, the
    /// whole length of a cable is prescribed, and the robot's stiffness is given.
    #[must_use]
    pub fn has_linearization(&self) -> bool {
        self.newtons().is_ok()
    }

    /// [`Self::solve`], with the derivatives of the answer: by the shortenings, by tensions, by loads at any place, and by these
    /// parameters.
    ///
    /// # Errors
    /// As [`Self::solve`]; [`SolveError::Unsupported`] without a strain energy that decides on the shape, of lengths that
    /// contradict each other, and for so many sections and stations that their equations, which are dense, take too much memory;
    /// [`SolveError::Invalid`] for a parameter that robot and case do not have, and [`SolveError::NoDerivatives`] where the robot
    /// is about to buckle.
    pub fn solve_and_linearize(
        &self,
        case: &Case,
        warm_start: Option<&Solution>,
        parameters: &[Parameter],
        workspace: &mut Workspace,
    ) -> Result<(Solution, CoordinateDerivatives), SolveError> {
        let scale = self.newtons().map_err(|unknown| SolveError::Unsupported {
            model: ModelKind::FourBar,
            path: "a request for derivatives by loads and parameters".to_owned(),
            what: unknown.reason(),
            advice: unknown.advice(),
        })?;
        if !case.obstacles.is_empty() {
            let found = self.linearize_in_contact(case, warm_start, parameters, workspace);
            return workspace.several.meter.checked(found);
        }
        let mut solution = Solution::empty(ModelKind::FourBar);
        let compromise = self.solve_and_tell(case, workspace, &mut solution);
        if workspace.several.meter.checked(compromise)? {
            return Err(contradiction());
        }
        let bends = workspace.joints.iter().map(|joint| joint.bend()).collect();
        let tension = |cable: &crate::CableState| cable.tension.unwrap_or(0.0) / scale;
        let at = ContactResponse::at(bends, solution.cables.iter().map(tension).collect());
        let derivatives = self.linearize(at, &[], case, &Holding::default(), parameters)?;
        Ok((solution, derivatives))
    }

    /// The derivatives of the answer at which the sections stand under these wrenches.
    pub(super) fn linearize(
        &self,
        mut at: ContactResponse,
        loads: &[Load],
        case: &Case,
        holding: &Holding,
        parameters: &[Parameter],
    ) -> Result<CoordinateDerivatives, SolveError> {
        let scale = self.tension_scale.unwrap_or(1.0);
        let n = COORDINATES * self.sections.len();
        let known = [&self.stations[..], &self.robot.disks().arc_lengths, &holding.places];
        let known = KnownPlaces::new(ModelKind::FourBar, n, known)?;
        // No cable is to be held by the equations themselves.
        let free = vec![f64::INFINITY; case.commands.len()];
        at.linearise(&self.sections, &free, loads).map_err(|_| SolveError::NoDerivatives)?;
        let places: Vec<Load> = known
            .arc_lengths
            .iter()
            .map(|&s| {
                let (section, part) = self.locate(s);
                Load { section, part, wrench: Wrench::default() }
            })
            .collect();
        let mut inverse = at.inverse();
        inverse.iter_mut().for_each(|entry| *entry /= scale);
        let base = at_base(&at.jacobian_of(&self.sections, loads), loads, scale, &inverse, n);
        let tensions: Vec<f64> = at.multipliers.iter().map(|pull| scale * pull).collect();
        let system = LinearSystem {
            coordinates: n,
            inverse,
            lengths: at.arms().concat(),
            base,
            jacobian: at.jacobian_of(&self.sections, &places),
            positions: places
                .iter()
                .map(|place| at.pose_at(&self.sections, place.section, place.part).position)
                .collect(),
        };
        let parameters = parameters
            .iter()
            .map(|parameter| self.by_parameter(parameter, case, &at.bends, &tensions))
            .collect::<Result<Vec<_>, _>>()?;
        let cable = |&tension: &f64| CoordinateCable {
            // Lengths drive it.
            command: Command::Length { target: 0.0, compliance: 0.0 },
            is_taut: tension > 0.0,
            compliance: 0.0,
        };
        let solved = SolvedCoordinates {
            system,
            places: known,
            cables: tensions.iter().map(cable).collect(),
            parameters,
            length: self.robot.backbone().length,
        };
        let change = holding.is_about_to_change;
        CoordinateDerivatives::of(solved, change, |compliance| holding.gain(compliance))
    }

    /// How the equations change with a parameter at these coordinates and tensions.
    fn by_parameter(
        &self,
        parameter: &Parameter,
        case: &Case,
        bends: &[Bend],
        tensions: &[f64],
    ) -> Result<ParameterChange, SolveError> {
        parameter.check(&self.robot, case)?;
        if parameter.is_load() {
            return Err(SolveError::Unsupported {
                model: ModelKind::FourBar,
                path: parameter.to_string(),
                what: "a load as a parameter",
                advice: "it takes no loads: ask for the motion with a wrench on a place, or use cosserat",
            });
        }
        let moment = self.tension_scale.unwrap_or(1.0);
        let scale = parameter.scale(&self.robot, case, moment);
        ParameterChange::by_differences(scale, |by| {
            Ok(self.changed(parameter, case, by)?.equations(case, bends, tensions))
        })
    }

    /// The model of the robot with a parameter changed by this.
    fn changed(&self, parameter: &Parameter, case: &Case, by: f64) -> Result<Self, SolveError> {
        match *parameter {
            Parameter::StiffnessScale(part) => {
                let mut model = self.clone();
                for section in &mut model.sections {
                    section.stiffen(part, 1.0 + by);
                }
                Ok(model)
            }
            Parameter::HoleAngle { cable, disk } => {
                let mut model = self.clone();
                let (sin, cos) = by.sin_cos();
                for (k, section) in model.sections.iter_mut().enumerate() {
                    let (length, chord, rest) = (section.length, section.chord, section.rest);
                    for passage in section.passages.iter_mut().filter(|p| p.cable == cable) {
                        let turned = |disk_here: usize, hole: super::plane::Vec2| {
                            if disk_here == disk { hole.turned(cos, sin) } else { hole }
                        };
                        let (from, to) = (turned(k, passage.from), turned(k + 1, passage.to));
                        *passage = Passage::new(cable, length, from, to, passage.part)
                            .at_rest(rest, length, chord);
                    }
                }
                Ok(model)
            }
            _ => {
                let (robot, _): (Robot, Case) = parameter.moved(&self.robot, case, by)?;
                Self::new(&robot, &self.options)
            }
        }
    }

    /// The equations without the wrenches of contacts, which no parameter changes.
    fn equations(&self, case: &Case, bends: &[Bend], tensions: &[f64]) -> Equations {
        let scale = self.tension_scale.unwrap_or(1.0);
        let mut residuals = Vec::with_capacity(COORDINATES * bends.len());
        let mut lengths = vec![0.0; tensions.len()];
        let mut rest = vec![0.0; tensions.len()];
        for (section, &bend) in self.sections.iter().zip(bends) {
            let mut residual: Vec3 = section.measure(bend).gradient * scale;
            let turn = bend.turn();
            for passage in &section.passages {
                let length = passage.length(&turn, section.length, section.chord);
                lengths[passage.cable] += length.value;
                rest[passage.cable] += passage.initial;
                residual += length.gradient * tensions[passage.cable];
            }
            residuals.extend(<[f64; 3]>::from(residual));
        }
        let target = |(rest, command): (f64, &crate::CableCommand)| match command.shortening {
            Some(Shortening::Fraction(fraction)) => rest * (1.0 - fraction),
            _ => rest,
        };
        let targets = rest.into_iter().zip(&case.commands).map(target).collect();
        Equations { residuals, lengths, targets, base: Wrench::default() }
    }
}

/// How what these wrenches exert on the base changes with a unit of each of `n` generalised forces, of the motions of their places
/// by coordinates.
fn at_base(motions: &[f64], loads: &[Load], scale: f64, inverse: &[f64], n: usize) -> Vec<f64> {
    let mut base = vec![0.0; 6 * n];
    for (load, rows) in loads.iter().zip(motions.chunks_exact(6 * n)) {
        let force = load.wrench.force * scale;
        for j in 0..n {
            let moved = Vec3::new(rows[j], rows[n + j], rows[2 * n + j]);
            let moment = moved.cross(force);
            for (axis, by) in <[f64; 3]>::from(moment).into_iter().enumerate() {
                let to = &mut base[(3 + axis) * n..(4 + axis) * n];
                to.iter_mut().zip(&inverse[j * n..(j + 1) * n]).for_each(|(sum, x)| *sum += by * x);
            }
        }
    }
    base
}
