//! Actuators: cables that are pulled or wound up, and loads.

use whipcord::{Actuation, CableCommand, ModelKind, Pose, Vec3};

use super::names::{FORMAT, WORLD_SITE};
use crate::answers::Answers;
use crate::chain::Chain;
use crate::error::ExportError;
use crate::guides::Guide;
use crate::job::Job;
use crate::xml::{Element, numbers};

/// A cable takes this many times the greatest tension of the case,
const TENSION_RANGE: f64 = 10.0;
/// and at least so much, in N.
const LEAST_TENSION_RANGE: f64 = 10.0;
/// Stiffness of a cable that does not stretch, relative to that of the bending backbone, `EI/(L r²)`: it is about as much as time
/// steps of a tenth of the damping time take.
const STIFF: f64 = 50.0;
/// Force limit in N of a cable that is driven by its length.
const FORCE_LIMIT: f64 = 1e6;

/// What drives a cable.
#[derive(Clone, Debug)]
enum Drive {
    /// Its tension in N, at most this much.
    Tension { most: f64 },
    /// Its length without tension in m.
    Length {
        /// In N/m.
        stiffness: f64,
        /// In N·s/m.
        damping: f64,
        /// At rest, in m.
        rest: f64,
    },
}

/// A force and a moment at a site.
#[derive(Clone, Debug, PartialEq)]
pub struct Applied {
    /// What it is called.
    pub name: String,
    /// Where it acts.
    pub site: String,
    /// In N: in the world, or in the frame of the site where it follows it.
    pub force: Vec3,
    /// In N·m, in the same frame.
    pub moment: Vec3,
    /// Whether both turn with the site.
    pub follower: bool,
}

/// All actuators, in the order of MuJoCo's controls.
#[derive(Clone, Debug)]
pub struct Actuators {
    cables: Vec<(String, Drive)>,
    loads: Vec<Applied>,
    /// Of the cables, for each step.
    commands: Vec<Vec<f64>>,
    /// Which part of each load acts, for each step.
    parts: Vec<Vec<f64>>,
}

impl Applied {
    /// The number that makes this load, times it, another one; `None` where there is none.
    fn part_in(&self, other: &Self) -> Option<f64> {
        if (&self.name, &self.site, self.follower) != (&other.name, &other.site, other.follower) {
            return None;
        }
        let numbers = |load: &Self| [load.force.to_array(), load.moment.to_array()].concat();
        let (mine, others) = (numbers(self), numbers(other));
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let part = dot(&mine, &others) / dot(&mine, &mine);
        let rest: Vec<f64> = mine.iter().zip(&others).map(|(a, b)| b - part * a).collect();
        let greatest = others.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        // Forces in N and moments in N·m beside one another: as a part of the greatest number all is rounding.
        rest.iter().all(|x| x.abs() <= 1e-12 * greatest).then_some(part)
    }
}

/// The loads of all steps, the last step's with their names, and which part of each acts in each step. A load of an earlier step
/// that is no part of one with its name has an actuator of its own.
fn merged(of_steps: Vec<Vec<Applied>>) -> (Vec<Applied>, Vec<Vec<f64>>) {
    let mut loads = of_steps.last().cloned().unwrap_or_default();
    // Of each load the name that it has in its step.
    let mut known = loads.clone();
    let mut parts = Vec::new();
    for (step, of_step) in of_steps.iter().enumerate() {
        let mut of_loads = vec![0.0; loads.len()];
        for load in of_step {
            let found = known.iter().enumerate().find_map(|(k, of)| Some((k, of.part_in(load)?)));
            if let Some((k, part)) = found {
                of_loads[k] = part;
            } else {
                known.push(load.clone());
                loads.push(Applied {
                    name: format!("{}:step-{}", load.name, step + 1),
                    ..load.clone()
                });
                of_loads.push(1.0);
            }
        }
        parts.push(of_loads);
    }
    parts.iter_mut().for_each(|of_loads| of_loads.resize(loads.len(), 0.0));
    (loads, parts)
}

impl Actuators {
    /// Those of a robot.
    ///
    /// # Errors
    /// [`ExportError::NoTensions`] for an answer without tensions.
    pub fn of(
        job: &Job<'_>,
        chain: &Chain,
        held: &[Vec<Guide>],
        answers: &Answers,
        loads_of_steps: Vec<Vec<Applied>>,
    ) -> Result<Self, ExportError> {
        let (robot, model) = (job.robot, job.model);
        let (mut loads, parts) = merged(loads_of_steps);
        let tension = |step: usize, cable: usize| {
            let known = answers.steps[step].cables.get(cable).and_then(|cable| cable.tension);
            let model = model.kind().name();
            known.ok_or(ExportError::NoTensions { format: FORMAT, model })
        };
        let of_step = |solution: &whipcord::Solution| -> Result<Vec<Pose>, ExportError> {
            Ok(chain.poses(job.case.base, &chain.angles(&solution.shape)?))
        };
        let poses = answers.steps.iter().map(of_step).collect::<Result<Vec<_>, _>>()?;
        let at_rest: Vec<Pose> = chain.nodes.iter().map(|node| node.rest).collect();
        let mut cables = Vec::new();
        let mut commands = vec![Vec::new(); answers.steps.len()];
        for (i, cable) in robot.cables().iter().enumerate() {
            let mut tensions = Vec::new();
            for step in 0..answers.steps.len() {
                tensions.push(tension(step, i)?);
            }
            let greatest = tensions.iter().copied().fold(0.0, f64::max);
            let is_by_length = answers
                .cases
                .iter()
                .any(|case| by_length(model.kind(), model.actuation(), &case.commands[i]));
            let drive = if is_by_length {
                let rest = length(&at_rest, &held[i]);
                let stiffness = stiffness(job, chain, i, &held[i], rest);
                let damping = stiffness * damping_time(chain);
                Drive::Length { stiffness, damping, rest }
            } else {
                Drive::Tension { most: (TENSION_RANGE * greatest).max(LEAST_TENSION_RANGE) }
            };
            for (step, of_step) in commands.iter_mut().enumerate() {
                of_step.push(match drive {
                    Drive::Tension { .. } => tensions[step],
                    Drive::Length { stiffness, rest, .. } => {
                        let state = &answers.steps[step].cables[i];
                        let given = answers.cases[step].commands[i].shortening;
                        match given.filter(|_| state.slack) {
                            Some(given) => rest - given.in_metres(state.initial_length),
                            // That the backbone gets shorter and the cable longer is in it.
                            None => length(&poses[step], &held[i]) - tensions[step] / stiffness,
                        }
                    }
                });
            }
            cables.push((cable.name.clone(), drive));
        }
        for load in &mut loads {
            // A cable may have the name of a load.
            while robot.cables().iter().any(|cable| cable.name == load.name) {
                load.name.push('_');
            }
        }
        Ok(Self { cables, loads, commands, parts })
    }

    /// Controls of the robot at rest: no tensions, cables as long as they are, no loads.
    pub fn at_rest(&self) -> Vec<f64> {
        let of_cable = |(_, drive): &(String, Drive)| match drive {
            Drive::Tension { .. } => 0.0,
            Drive::Length { rest, .. } => *rest,
        };
        let mut controls: Vec<f64> = self.cables.iter().map(of_cable).collect();
        controls.resize(self.cables.len() + self.loads.len(), 0.0);
        controls
    }

    /// Controls of a step: commands of the cables, and which part of each load acts.
    pub fn controls(&self, step: usize) -> Vec<f64> {
        [&self.commands[step][..], &self.parts[step]].concat()
    }

    /// The section of the file.
    pub fn element(&self) -> Element {
        let mut section = Element::new("actuator");
        for (name, drive) in &self.cables {
            section.push(match drive {
                Drive::Tension { most } => Element::new("motor")
                    .with("name", name)
                    .with("tendon", name)
                    // A positive force of an actuator makes a tendon longer.
                    .with("gear", "-1")
                    .with("ctrlrange", numbers(&[0.0, *most])),
                Drive::Length { stiffness, damping, rest } => Element::new("position")
                    .with("name", name)
                    .with("tendon", name)
                    .with_numbers("kp", &[*stiffness])
                    .with_numbers("kv", &[*damping])
                    .with("ctrlrange", numbers(&[0.0, 2.0 * rest]))
                    .with("forcerange", numbers(&[-FORCE_LIMIT, 0.0])),
            });
        }
        for load in &self.loads {
            let gear: Vec<f64> =
                load.force.to_array().into_iter().chain(load.moment.to_array()).collect();
            let motor = Element::new("motor")
                .with("name", &load.name)
                .with("site", &load.site)
                .with_numbers("gear", &gear);
            section.push(if load.follower { motor } else { motor.with("refsite", WORLD_SITE) });
        }
        section
    }
}

/// Whether a cable is driven by its length.
fn by_length(model: ModelKind, actuation: Actuation, command: &CableCommand) -> bool {
    match (actuation, model.natural_actuation()) {
        (Actuation::Tension, _) => false,
        (Actuation::Shortening, _) => true,
        (Actuation::Natural, Actuation::Shortening) => {
            command.shortening.is_some() || command.tension.is_none()
        }
        (Actuation::Natural, _) => command.tension.is_none(),
    }
}

/// Length in m of a cable on a chain with these poses.
fn length(poses: &[Pose], guides: &[Guide]) -> f64 {
    let at = |guide: &Guide| poses[guide.place].transform(guide.offset);
    guides.windows(2).map(|pair| (at(&pair[1]) - at(&pair[0])).norm()).sum()
}

fn damping_time(chain: &Chain) -> f64 {
    let hinges = chain.joints.iter().flat_map(|joint| joint.hinges());
    hinges.map(|hinge| hinge.damping / hinge.stiffness).fold(0.0, f64::max)
}

/// Stiffness of a cable in N/m: its own where it stretches.
fn stiffness(job: &Job<'_>, chain: &Chain, cable: usize, guides: &[Guide], rest: f64) -> f64 {
    if job.robot.is_elastic(cable) {
        return 1.0 / job.robot.cable_compliance(cable, rest);
    }
    let length = job.robot.backbone().length;
    let reach = guides.iter().map(|guide| guide.offset.norm()).fold(0.01 * length, f64::max);
    // That of all joints in a row, times the length.
    let yields: f64 = chain.joints.iter().map(|joint| 1.0 / joint.least_stiffness()).sum();
    STIFF / (yields * reach * reach)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn load(name: &str, force: Vec3) -> Applied {
        let (name, site) = (name.to_owned(), "node:3".to_owned());
        Applied { name, site, force, moment: Vec3::ZERO, follower: false }
    }

    #[test]
    fn loads_that_grow_have_one_actuator_and_others_their_own() {
        let steps = vec![
            vec![load("load:tip", Vec3::X * 0.5)],
            vec![],
            vec![load("load:tip", Vec3::Y * 2.0), load("load:point-1", Vec3::Z)],
            vec![load("load:tip", Vec3::Y * 3.0)],
            vec![load("load:tip", Vec3::X * 2.0)],
        ];
        let (loads, parts) = merged(steps);
        let names: Vec<&str> = loads.iter().map(|load| load.name.as_str()).collect();
        assert_eq!(names, ["load:tip", "load:tip:step-3", "load:point-1:step-3"]);
        let expected =
            [[0.25, 0.0, 0.0], [0.0; 3], [0.0, 1.0, 1.0], [0.0, 1.5, 0.0], [1.0, 0.0, 0.0]];
        assert_eq!(parts, expected);
    }
}
