//! Why there is no answer.

use thiserror::Error;

use whipcord_numerics::Vec3;

use crate::format::{Round, millimetres, newtons, share, significant};
use crate::insertion_stop::InsertionStop;
use crate::kind::ModelKind;
use crate::length_miss::LengthMiss;
use crate::robot::{RobotError, in_words};
use crate::solution::Part;

/// Why a model gives no answer.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum SolveError {
    /// A quantity of the case cannot be, or does not fit the robot.
    #[error(transparent)]
    Invalid(#[from] RobotError),

    /// The model needs a quantity that the robot or the case does not give.
    #[error("the {model} model needs {}: {advice}", in_words(path))]
    Missing {
        /// The model.
        model: ModelKind,
        /// Which quantity, in the terms of the robot file.
        path: String,
        /// What to do.
        advice: &'static str,
    },

    /// The model cannot take a part of the robot or of the case.
    #[error("the {model} model cannot take {} ({what}): {advice}", in_words(path))]
    Unsupported {
        /// The model.
        model: ModelKind,
        /// Which part, in the terms of the robot file.
        path: String,
        /// What it is.
        what: &'static str,
        /// What to do.
        advice: &'static str,
    },

    /// The cables wind the section up so far that one of them has no length left in it.
    #[error(
        "the section at arc length {} folds: under {} cable `{cable}` has no length left there; the last load that converged is {} of the given one; pull the cable less, or stiffen the backbone",
        millimetres(*arc_length, Round::Nearest), newtons(*tension), share(*last_load)
    )]
    SectionFolds {
        /// Name of the cable.
        cable: String,
        /// Where, in m.
        arc_length: f64,
        /// Tension of that cable in N.
        tension: f64,
        /// Fraction of what was given up to which equilibrium was found, from 0 to 1: of the
        /// tensions when those alone fold the section, of the step of actuation with hole friction, of the way among
        /// obstacles, else of the loads.
        last_load: f64,
    },

    /// A prescribed cable length that no tension reaches.
    #[error(
        "cable `{cable}` cannot be shortened by {}: the greatest shortening that can be reached here is {}; prescribe no more than that",
        millimetres(*requested, Round::Nearest), millimetres(*reachable, Round::Down)
    )]
    UnreachableLength {
        /// Name of the cable.
        cable: String,
        /// Shortening asked for in m.
        requested: f64,
        /// Greatest shortening that can be reached in m, with the other cables as they are.
        reachable: f64,
    },

    /// Cable lengths that cannot be had together, whatever pulls at the cables: a backbone that does not get
    /// shorter, say, has no shape in which a cable and its antagonist are both shortened.
    #[error(
        "the prescribed cable lengths contradict one another: at the best compromise {}; shorten each by that much less, drive one of them by its tension, give the cables their axial stiffness or their motors a stiffness, or ask for the least-squares answer",
        LengthMiss::describe(misses, " is still")
    )]
    ContradictoryLengths {
        /// The cables that contradict one another, two or more, and how each misses its length.
        misses: Vec<LengthMiss>,
    },

    /// A section that cannot be bent so far that its cable gets as short as prescribed.
    #[error(
        "between disks {disk} and {next_disk} cable `{cable}` cannot be {} long: that section takes lengths from {} to {}; shorten the cable less",
        millimetres(*requested, Round::Nearest), millimetres(*shortest, Round::Up), millimetres(*longest, Round::Down),
        next_disk = disk + 1
    )]
    SectionOutOfReach {
        /// Name of the cable.
        cable: String,
        /// Number of the section's lower disk; the base disk is 1.
        disk: usize,
        /// Length prescribed there in m.
        requested: f64,
        /// Least length in m that the section takes, with the other cables as they are.
        shortest: f64,
        /// Length in m in the straight section; a cable prescribed to be longer is slack.
        longest: f64,
    },

    /// Cables whose lengths contradict each other by more than a least-squares answer can hide.
    #[error(
        "between disks {first_disk} and {last_disk} the prescribed cable lengths contradict each other: at the best compromise cable `{cable}` is still {} too long; shorten its antagonists less",
        millimetres(*excess, Round::Nearest)
    )]
    CablesConflict {
        /// Name of the cable that is farthest from its length.
        cable: String,
        /// Number of the disk where the conflict begins; the base disk is 1.
        first_disk: usize,
        /// Number of the disk where it ends.
        last_disk: usize,
        /// Length of that cable beyond the prescribed one in m.
        excess: f64,
    },

    /// A cable that does not decide which way its section bends.
    #[error(
        "between disks {disk} and {next_disk} cable `{cable}` has no lever arm (it runs through or across the centre), so shortening it bends the section no way in particular; move its holes outwards to one side",
        next_disk = disk + 1
    )]
    NoLever {
        /// Name of the cable.
        cable: String,
        /// Number of the section's lower disk; the base disk is 1.
        disk: usize,
    },

    /// The robot buckles or snaps before all of the load acts, and no equilibrium under all of it was
    /// found on the path from there.
    #[error(
        "the robot loses its stability at {} of the given load, and from there no equilibrium under all of it was found in {iterations} iterations: apply less load, or brace the robot with other tensions",
        share(*load)
    )]
    Buckled {
        /// Fraction of the given load, from 0 to 1.
        load: f64,
        /// Newton iterations spent.
        iterations: usize,
    },

    /// The iteration stopped before the equations were met.
    #[error(
        "no equilibrium was found: residual {} after {iterations} iterations; the last load that converged is {} of the given one; {advice}",
        significant(*residual, 3, Round::Nearest), share(*last_load)
    )]
    NotConverged {
        /// Newton iterations spent.
        iterations: usize,
        /// What is left of the equations, relative to their scale.
        residual: f64,
        /// Fraction of the given load up to which equilibrium was found, from 0 to 1; with hole friction,
        /// of the step of actuation, and among obstacles of the way.
        last_load: f64,
        /// What to do.
        advice: &'static str,
    },

    /// The solve was ended from outside ([`Cancel`](crate::Cancel)).
    #[error("the solve was cancelled; {}", how_far(*last_load))]
    Cancelled {
        /// Fraction of what was given up to which equilibrium was found, from 0 to 1, where it is known.
        last_load: Option<f64>,
    },

    /// Tensions that give the prescribed cable lengths were searched for in vain.
    #[error(
        "no tensions were found that give all of the prescribed cable lengths: shorten the cables less, or drive one of them by its tension"
    )]
    TensionsNotFound,

    /// An answer that a small change of load or command changes without bound.
    #[error(
        "the answer has no derivatives: the robot is about to buckle, and a small change moves it without bound; change a load or a command a little"
    )]
    NoDerivatives,

    /// An answer whose cables come to rest in their holes on a way that is not known well enough.
    #[error(
        "the answer has no derivatives: no equilibrium is found where a cable comes to rest in a hole within a step of actuation; divide the step into several, or change a command a little"
    )]
    NoDerivativesOfRest,

    /// The estimated error does not fall below the tolerance.
    #[error(
        "the discretisation error is still {} with {steps} steps, above the tolerance of {}: relax the tolerance, or smooth the routing",
        millimetres(*error, Round::Nearest), millimetres(*tolerance, Round::Nearest)
    )]
    StepsTooCoarse {
        /// Estimated error of a position in m.
        error: f64,
        /// Tolerance in m.
        tolerance: f64,
        /// Steps used.
        steps: usize,
    },

    /// An obstacle that overlaps the robot before anything acts.
    #[error(
        "the obstacle `{obstacle}` overlaps {} of the robot at rest by {}: move the obstacle or the robot's base{}",
        part_in_words(*part, *arc_length), millimetres(*depth, Round::Nearest), axis_in_words(*axis)
    )]
    ObstacleInTheWay {
        /// Name of the obstacle.
        obstacle: String,
        /// The part of the robot that overlaps it most.
        part: Part,
        /// Arc length in m of its cross-section.
        arc_length: f64,
        /// How far they overlap in m.
        depth: f64,
        /// Direction of the obstacle's axis in the frame of the robot's base, where it is a cylinder or a
        /// capsule.
        axis: Option<Vec3>,
    },

    /// The budget of the solve is spent ([`crate::Budget`]).
    #[error(
        "the budget of the solve is spent after {iterations} iterations and {integration_steps} integration steps; {}; allow it more iterations (`max_iterations` in Python, `--max-iterations` of the commands that have it), a coarser tolerance, or a start nearby",
        how_far(*last_load)
    )]
    BudgetSpent {
        /// Newton iterations.
        iterations: usize,
        /// Integration steps of all shapes that were tried.
        integration_steps: usize,
        /// Part of the load or of the step up to which equilibrium was found, from 0 to 1, where it is known.
        last_load: Option<f64>,
    },

    /// A movable object that overlaps an obstacle, or another object, where the robot is at rest.
    #[error(
        "`{object}` and `{obstacle}` overlap by {} before anything moves, and one of them is a movable object: move it away by as much, or make it smaller",
        millimetres(*depth, Round::Up)
    )]
    ObjectOverlaps {
        /// Name of one.
        object: String,
        /// Name of the other.
        obstacle: String,
        /// Depth in m.
        depth: f64,
    },

    /// A robot that cannot be inserted into a pipe as far as its base stands.
    #[error(
        "the robot was inserted into pipe `{pipe}` by only {} of its {} ({}): {why}; make the bore wider, its bends gentler, or the disks smaller, thinner or fewer",
        millimetres(*inserted, Round::Nearest), millimetres(*length, Round::Nearest), share(*inserted / *length)
    )]
    NotInserted {
        /// Name of the pipe.
        pipe: String,
        /// How far the robot was inserted, in m: its length less what its base is still away from its place.
        inserted: f64,
        /// Length of the robot in m.
        length: f64,
        /// Why it gets no farther.
        why: InsertionStop,
    },

    /// A robot that its obstacles let get only a part of the way.
    #[error(
        "{}an equilibrium was found only up to {} of the change of actuation and loads: {why}",
        against(touching), share(*reached)
    )]
    Obstructed {
        /// Part of the way, from 0 to 1, that was found.
        reached: f64,
        /// Names of the obstacles that it touches there.
        touching: Vec<String>,
        /// Why it gets no farther.
        why: Obstruction,
    },
}

/// Why a robot gets no farther among its obstacles.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum Obstruction {
    /// The model has no answer under the pushes of the obstacles.
    #[error("{0}")]
    Model(Box<SolveError>),
    /// The contacts cannot hold: beyond, nothing keeps the robot from slipping off, or with friction from jamming.
    #[error(
        "beyond this point the contact forces cannot hold the robot, and it slides off the obstacle: lower the tensions or the loads, move or extend the obstacle, or set its `friction`"
    )]
    Slips,
    /// However little it goes on, it leaps.
    #[error(
        "beyond this point it jumps to a distant shape; pull the cables in other steps, or less"
    )]
    Leaps,
    /// The search took more iterations than a solve may spend on the whole way.
    #[error(
        "there the search was given up after {iterations} iterations, with {contacts} contacts (residual {}): check the units of length and tension, pull the cables less or in several `[[steps]]`, make obstacles less narrow or less bent, or take away those that are not needed",
        significant(*residual, 3, Round::Nearest)
    )]
    BudgetSpent {
        /// Iterations on the whole way.
        iterations: usize,
        /// What was left of the conditions of contact, relative to length and forces of the robot.
        residual: f64,
        /// Contacts and parts close to an obstacle at the end.
        contacts: usize,
    },
    /// More parts of the robot are close to obstacles than can be solved together.
    #[error(
        "there {contacts} of its parts are close to obstacles, and at most {most} can be solved together: take away obstacles that are not needed, or give the robot fewer disks"
    )]
    TooManyContacts {
        /// Contacts and parts close to an obstacle.
        contacts: usize,
        /// The most of them for this robot.
        most: usize,
    },
    /// A disk without clearance in a pipe wedges.
    #[error(
        "disk {} fits pipe `{obstacle}` with a clearance of {} around it: where contact tilts a disk without clearance, it wedges, and its contact forces grow without bound; make the bore wider, or the disk smaller, by {}",
        disk + 1, millimetres(*clearance, Round::Nearest), millimetres(*enough, Round::Up)
    )]
    NoClearance {
        /// Name of the pipe.
        obstacle: String,
        /// Number of the disk, from 0.
        disk: usize,
        /// Radius of the bore less that of the disk, in m.
        clearance: f64,
        /// A clearance in m that is enough.
        enough: f64,
    },
    /// Nothing balances what acts on a movable object.
    #[error(
        "movable object `{object}` is not held: no contact balances a force of {} and a moment of {} N·m on it; put it where the robot or a fixed obstacle carries it, press harder, or give the object and what carries it more `friction`",
        newtons(*force), significant(*moment, 3, Round::Nearest)
    )]
    NotHeld {
        /// Name of the object.
        object: String,
        /// What is left of the balance of forces in N.
        force: f64,
        /// What is left of the balance of moments about its centre of mass in N·m.
        moment: f64,
    },
    /// The robot loses its equilibrium without obstacles, too, and is stable in no shape that was found.
    #[error(
        "the tensions and loads are more than the robot bears: without obstacles, too, it has no stable shape{}; pull the cables less, or stiffen the backbone",
        lost_at.map_or_else(String::new, |at| format!(" beyond {} of them", share(at)))
    )]
    NoneAlone {
        /// Part of tensions and loads, from 0 to 1, at which it loses its equilibrium without obstacles, where that is known.
        lost_at: Option<f64>,
    },
    /// The iteration stopped before the conditions of contact were met.
    #[error(
        "beyond this point no contact equilibrium without overlap was found (residual {}): check the units of length and tension, pull the cables or load the robot less, or, where an obstacle has edges or is a mesh, give it a smoother surface",
        significant(*residual, 3, Round::Nearest)
    )]
    NotConverged {
        /// What is left of the conditions, relative to length and forces of the robot.
        residual: f64,
    },
}

fn how_far(last_load: Option<f64>) -> String {
    match last_load {
        Some(load) if load > 0.0 => {
            format!("the last equilibrium is at {} of the load or step of actuation", share(load))
        }
        _ => "no part of the load or step of actuation had an equilibrium yet".to_owned(),
    }
}

fn part_in_words(part: Part, arc_length: f64) -> String {
    match part {
        Part::Disk(k) => format!("disk {}", k + 1),
        Part::Backbone => {
            format!("the backbone at arc length {}", millimetres(arc_length, Round::Nearest))
        }
    }
}

/// What the axis of an obstacle may have to do with its overlap.
fn axis_in_words(axis: Option<Vec3>) -> String {
    const PARALLEL: f64 = 0.9;
    let Some(axis) = axis else { return String::new() };
    if axis.z.abs() > PARALLEL {
        return "; its axis is parallel to z, as the axis of the base is: to put it across the robot, turn it with `rotation = { axis = [0, 1, 0], angle = \"90 deg\" }` along x, or with `axis = [1, 0, 0]` along y".to_owned();
    }
    let [x, y, z] = axis.to_array().map(|c| (c * 1e3).round() / 1e3 + 0.0);
    format!(
        "; its axis has the direction ({x}, {y}, {z}) in the frame of the base, whose z axis is that of the backbone"
    )
}

fn against(touching: &[String]) -> String {
    if touching.is_empty() {
        return String::new();
    }
    let names: Vec<String> = touching.iter().map(|name| format!("`{name}`")).collect();
    format!("in contact with {}, ", names.join(" and "))
}

impl SolveError {
    /// The error of what models share, in the name of this one.
    pub(crate) fn of(self, model: ModelKind) -> Self {
        match self {
            Self::Missing { path, advice, .. } => Self::Missing { model, path, advice },
            Self::Unsupported { path, what, advice, .. } => {
                Self::Unsupported { model, path, what, advice }
            }
            other => other,
        }
    }

    /// The error of a place of a way to the answer, where an equilibrium was found up to this part of the way.
    pub(crate) fn on_way(mut self, reached: f64) -> Self {
        match &mut self {
            Self::NotConverged { last_load, .. }
            | Self::SectionFolds { last_load, .. }
            | Self::Buckled { load: last_load, .. } => *last_load = reached,
            Self::Cancelled { last_load } | Self::BudgetSpent { last_load, .. } => {
                *last_load = Some(reached);
            }
            _ => {}
        }
        self
    }

    /// Whether obstacles are what keeps the robot from the answer, and a solve of less than its budget ended there.
    pub(crate) const fn is_obstruction(&self) -> bool {
        !matches!(
            self,
            Self::Cancelled { .. }
                | Self::BudgetSpent { .. }
                | Self::ObjectOverlaps { .. }
                | Self::ObstacleInTheWay { .. }
                | Self::Obstructed { why: Obstruction::BudgetSpent { .. }, .. }
                | Self::NotInserted { why: InsertionStop::BudgetSpent { .. }, .. }
        )
    }

    /// Fraction of what was given up to which equilibrium was found, from 0 to 1, where it is known.
    pub(crate) const fn last_load(&self) -> Option<f64> {
        match *self {
            Self::Cancelled { last_load } | Self::BudgetSpent { last_load, .. } => last_load,
            Self::NotConverged { last_load, .. } | Self::SectionFolds { last_load, .. } => {
                Some(last_load)
            }
            Self::Buckled { load, .. } => Some(load),
            Self::Obstructed { reached, .. } => Some(reached),
            Self::NotInserted { .. } => Some(0.0),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn people_read_millimetres_and_newtons() {
        let cable = || "pull".to_owned();
        let errors = [
            SolveError::SectionFolds {
                cable: cable(),
                arc_length: 0.18,
                tension: 1e6,
                last_load: 6.8e-5,
            },
            SolveError::UnreachableLength {
                cable: cable(),
                requested: 0.180_858_7,
                reachable: 0.019_999_999,
            },
            SolveError::SectionOutOfReach {
                cable: cable(),
                disk: 3,
                requested: 0.0,
                shortest: 0.001_234_561,
                longest: 0.02,
            },
            SolveError::CablesConflict {
                cable: cable(),
                first_disk: 1,
                last_disk: 2,
                excess: 0.002_5,
            },
            SolveError::ContradictoryLengths {
                misses: [("left", 0.002), ("right", 0.001), ("top", 0.000_5)]
                    .map(|(cable, excess)| LengthMiss { cable: cable.to_owned(), excess })
                    .to_vec(),
            },
            SolveError::NotConverged {
                iterations: 30,
                residual: 0.012_345,
                last_load: 0.999_99,
                advice: "load it less",
            },
            SolveError::Buckled { load: 0.621_98, iterations: 120 },
            SolveError::StepsTooCoarse { error: 2e-9, tolerance: 1.8e-10, steps: 4096 },
        ];
        let texts: Vec<String> = errors.iter().map(ToString::to_string).collect();
        for (text, words) in texts.iter().zip([
            "at arc length 180 mm folds: under 1000000 N cable `pull` has no length left there; the last load that converged is 0.000068 of",
            "shortened by 180.859 mm: the greatest shortening that can be reached here is 19.9999 mm",
            "between disks 3 and 4 cable `pull` cannot be 0 mm long: that section takes lengths from 1.23457 mm to 20 mm;",
            "still 2.5 mm too long",
            "compromise cable `left` is still 2 mm too long, cable `right` 1 mm and cable `top` 0.5 mm;",
            "residual 0.0123 after 30 iterations; the last load that converged is 0.999 of the given one; load it less",
            "loses its stability at 0.621 of the given load",
            "still 2e-6 mm with 4096 steps, above the tolerance of 1.8e-7 mm",
        ]) {
            assert!(text.contains(words), "{text}");
        }
    }

    /// What a robot that slides off a wall is told makes sense for a wall.
    #[test]
    fn a_robot_that_nothing_holds_is_told_why() {
        let error = SolveError::Obstructed {
            reached: 0.25,
            touching: vec!["obstacle-1".to_owned()],
            why: Obstruction::Slips,
        };
        let text = error.to_string();
        for words in [
            "in contact with `obstacle-1`, an equilibrium was found only up to 0.25 of",
            "the contact forces cannot hold the robot, and it slides off the obstacle",
            "lower the tensions or the loads, move or extend the obstacle, or set its `friction`",
        ] {
            assert!(text.contains(words), "{text}");
        }
        assert!(!text.contains("enclose"), "{text}");
    }
}
