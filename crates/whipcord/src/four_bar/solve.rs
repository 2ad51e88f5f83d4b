//! From a case to a solution: lengths shared out, sections solved and stacked.

use core::slice;

use whipcord_numerics::Pose;

use super::as_printed::{self, Unsolvable};
use super::bend::Bend;
use super::joint::Joint;
use super::model::FourBar;
use super::one_cable;
use super::options::{Conflicts, LengthRule, Objective};
use super::refusal;
use super::several::{Ending, Several};
use super::workspace::{Found, LOOSE, Workspace};
use crate::case::Case;
use crate::error::SolveError;
use crate::kind::ModelKind;
use crate::solution::{CableState, Diagnostics, NoStability, Solution};
use crate::stations::Stations;

/// What the diagnostics report.
#[derive(Clone, Copy, Debug, Default)]
struct Tally {
    iterations: usize,
    /// Largest difference from a prescribed length in m.
    residual: f64,
    /// Whether some lengths were met in the least-squares sense only.
    compromise: bool,
}

/// Whole lengths are met to this under the length rule `free`, relative to the length of the backbone.
pub(super) const MET: f64 = 1e-8;

impl FourBar {
    /// Writes the answer; whether it is a compromise of lengths that contradict each other.
    pub(super) fn solve_and_tell(
        &self,
        case: &Case,
        workspace: &mut Workspace,
        solution: &mut Solution,
    ) -> Result<bool, SolveError> {
        refusal::case(&self.robot, &self.options, case, false)?;
        let count = self.initial_lengths.len();
        workspace.targets.clear();
        for (command, &initial) in case.commands.iter().zip(&self.initial_lengths) {
            let shortening = command.shortening.map_or(0.0, |s| s.in_metres(initial));
            workspace.targets.push(initial - shortening);
        }
        workspace.cables.clear();
        workspace.cables.resize(count, Found::default());
        workspace.multipliers.clear();
        workspace.multipliers.resize(count, 0.0);
        workspace.joints.clear();
        workspace.pulls.clear();
        workspace.several.meter.start(&self.options.cancel, self.options.budget);
        let tally = match self.options.lengths {
            LengthRule::Proportional | LengthRule::Equal => self.each_section(workspace)?,
            LengthRule::Free => self.all_sections(workspace)?,
        };
        self.write(case.base, workspace, tally, solution);
        Ok(tally.compromise)
    }

    /// Every section with its own lengths.
    fn each_section(&self, workspace: &mut Workspace) -> Result<Tally, SolveError> {
        let mut tally = Tally::default();
        let Workspace {
            targets, section_targets, multipliers, cables, joints, pulls, several, ..
        } = workspace;
        section_targets.clear();
        section_targets.resize(targets.len(), f64::INFINITY);
        for (index, section) in self.sections.iter().enumerate() {
            if several.meter.has_ended() {
                return Err(several.meter.end());
            }
            section_targets.fill(f64::INFINITY);
            multipliers.fill(0.0);
            let mut pulled = false;
            for passage in &section.passages {
                let target = self.share(passage.cable, passage.initial, targets[passage.cable]);
                section_targets[passage.cable] = target;
                pulled |= target < passage.initial;
            }
            let joint = if self.options.objective == Objective::AsPrinted {
                self.printed_section(index, section_targets)?
            } else if pulled {
                Joint::Bend(self.section(
                    index,
                    section_targets,
                    multipliers,
                    several,
                    &mut tally,
                )?)
            } else {
                Joint::Bend(section.rest)
            };
            joints.push(joint);
            for (i, length) in joint.lengths(section) {
                let (found, target) = (&mut cables[i], section_targets[i]);
                found.length += length;
                // How much of a metre of the whole cable falls to this section.
                let part = match self.options.lengths {
                    LengthRule::Equal => 1.0 / self.passages[i] as f64,
                    LengthRule::Proportional | LengthRule::Free => target / targets[i],
                };
                found.multiplier += part * multipliers[i];
                pulls.push(multipliers[i]);
                found.binds |= length >= target * (1.0 - LOOSE);
                tally.count(length, target, multipliers[i]);
            }
        }
        Ok(tally)
    }

    /// Length prescribed in a section for a cable that is prescribed `target` in all.
    pub(super) fn share(&self, cable: usize, initial: f64, target: f64) -> f64 {
        let whole = self.initial_lengths[cable];
        match self.options.lengths {
            LengthRule::Equal => initial + (target - whole) / self.passages[cable] as f64,
            LengthRule::Proportional | LengthRule::Free => initial * (target / whole),
        }
    }

    /// One section in which some cable pulls.
    fn section(
        &self,
        index: usize,
        targets: &[f64],
        multipliers: &mut [f64],
        several: &mut Several,
        tally: &mut Tally,
    ) -> Result<Bend, SolveError> {
        let section = &self.sections[index];
        if let [passage] = section.passages[..] {
            if section.guess.is_none() {
                return Err(self.no_lever(passage.cable, index));
            }
            if let Some(solved) = one_cable::solve(section, targets[passage.cable]) {
                multipliers[passage.cable] = solved.multiplier;
                tally.iterations += solved.iterations;
                return Ok(solved.bend);
            }
        }
        let group = slice::from_ref(section);
        let ending = several.solve(group, targets);
        tally.iterations += several.iterations;
        multipliers.copy_from_slice(&several.multipliers);
        let bend = several.bends[0];
        if ending == Ending::Missed {
            let (worst, excess) = several.worst(targets);
            if several.only_one_pulls() {
                let (shortest, longest) = several.range(group, targets, worst);
                return Err(SolveError::SectionOutOfReach {
                    cable: self.name(worst),
                    disk: index + 1,
                    requested: targets[worst],
                    shortest,
                    longest,
                });
            }
            if !several.is_tolerable(group, targets) {
                return Err(self.conflict((worst, excess), index, index + 1));
            }
            tally.compromise = true;
        }
        Ok(bend)
    }

    /// One section by the printed equations.
    fn printed_section(&self, index: usize, targets: &[f64]) -> Result<Joint, SolveError> {
        let section = &self.sections[index];
        let Some(passage) = section.passages.first() else {
            return Ok(Joint::Bend(Bend::STRAIGHT));
        };
        let requested = targets[passage.cable];
        match as_printed::solve(section.length, passage, requested) {
            Ok(pose) => Ok(Joint::Link(pose)),
            Err(Unsolvable::Centre) => Err(self.no_lever(passage.cable, index)),
            Err(Unsolvable::Length(shortest, longest)) => Err(SolveError::SectionOutOfReach {
                cable: self.name(passage.cable),
                disk: index + 1,
                requested,
                shortest,
                longest,
            }),
        }
    }

    /// All sections together, with only the total lengths prescribed.
    fn all_sections(&self, workspace: &mut Workspace) -> Result<Tally, SolveError> {
        let mut tally = Tally::default();
        let Workspace { targets, cables, joints, pulls, several, .. } = workspace;
        if targets.iter().zip(&self.initial_lengths).all(|(target, initial)| target >= initial) {
            joints.extend(self.sections.iter().map(|section| Joint::Bend(section.rest)));
        } else {
            let ending = several.solve(&self.sections, targets);
            tally.iterations = several.iterations;
            joints.extend(several.bends.iter().map(|&bend| Joint::Bend(bend)));
            for (found, &multiplier) in cables.iter_mut().zip(&several.multipliers) {
                found.multiplier = multiplier;
            }
            if ending == Ending::Missed {
                let (worst, excess) = several.worst(targets);
                if several.only_one_pulls() {
                    let (shortest, longest) = several.range(&self.sections, targets, worst);
                    return Err(SolveError::UnreachableLength {
                        cable: self.name(worst),
                        requested: longest - targets[worst],
                        reachable: longest - shortest,
                    });
                }
                let is_answer = match self.options.conflicts {
                    Conflicts::Refuse => {
                        several.is_met(targets, MET * self.robot.backbone().length)
                    }
                    Conflicts::Compromise => several.is_tolerable(&self.sections, targets),
                };
                if !is_answer {
                    return Err(self.conflict((worst, excess), 0, self.sections.len()));
                }
                tally.compromise = true;
            }
        }
        for (section, &joint) in self.sections.iter().zip(&*joints) {
            for (i, length) in joint.lengths(section) {
                cables[i].length += length;
                pulls.push(cables[i].multiplier);
            }
        }
        tally.count_cables(cables, targets);
        Ok(tally)
    }

    fn conflict(&self, (worst, excess): (usize, f64), first: usize, last: usize) -> SolveError {
        SolveError::CablesConflict {
            cable: self.name(worst),
            first_disk: first + 1,
            last_disk: last + 1,
            excess,
        }
    }

    fn no_lever(&self, cable: usize, section: usize) -> SolveError {
        SolveError::NoLever { cable: self.name(cable), disk: section + 1 }
    }

    fn name(&self, cable: usize) -> String {
        self.robot.cables()[cable].name.clone()
    }

    /// Stacks the sections and gathers what became of the cables.
    fn write(&self, base: Pose, workspace: &Workspace, tally: Tally, solution: &mut Solution) {
        let joints = &workspace.joints;
        let mut pose = Pose::IDENTITY;
        let ends = joints.iter().zip(&self.sections).map(|(joint, section)| {
            pose = pose * joint.pose(section);
            pose
        });
        let at = &self.robot.disks().arc_lengths;
        // Relative to the base until the stations between them are known.
        solution.disks.set(at, core::iter::once(Pose::IDENTITY).chain(ends), Pose::IDENTITY);
        let disks = &solution.disks.poses;
        let between = |&s: &f64| {
            let (i, t) = self.robot.disks().locate(s);
            disks[i] * joints[i].pose_at(t, &self.sections[i])
        };
        match self.options.stations {
            Stations::Disks => solution.shape.set(at, disks.iter().copied(), base),
            Stations::Equal(_) | Stations::At(_) => {
                solution.shape.set(&self.stations, self.stations.iter().map(between), base);
            }
        }
        solution.disks.turn(base);
        let scale = if tally.compromise { None } else { self.tension_scale };
        let cables = self.robot.cables();
        solution.cables.resize_with(cables.len(), CableState::default);
        for (i, (state, found)) in solution.cables.iter_mut().zip(&workspace.cables).enumerate() {
            state.rename(&cables[i].name);
            state.tension = scale.map(|scale| scale * found.multiplier);
            (state.length, state.initial_length) = (found.length, self.initial_lengths[i]);
            state.slack = !found.binds;
            state.span_tensions.clear();
            state.slip_states.clear();
        }
        solution.model = ModelKind::FourBar;
        solution.base_wrench = None;
        solution.contacts.clear();
        solution.internal.clear();
        solution.objects.clear();
        solution.diagnostics = Diagnostics {
            iterations: tally.iterations,
            residual: tally.residual / self.robot.backbone().length,
            stability_absent: Some(NoStability::NoEnergy),
            steps: self.sections.len(),
            ..Diagnostics::default()
        };
    }
}

impl Tally {
    /// Counts the whole lengths of the cables, and notes which bind.
    fn count_cables(&mut self, cables: &mut [Found], targets: &[f64]) {
        for (found, &target) in cables.iter_mut().zip(targets) {
            found.binds = found.length >= target * (1.0 - LOOSE);
            self.count(found.length, target, found.multiplier);
        }
    }

    fn count(&mut self, length: f64, target: f64, multiplier: f64) {
        let excess = length - target;
        let miss = if multiplier > 0.0 { excess.abs() } else { excess.max(0.0) };
        self.residual = self.residual.max(miss);
    }
}
