//! Lists of holes, in turn with tensions where these are varied too.

use whipcord::Case;

use super::unknowns::known_of;
use super::work::Work;
use crate::choices::{FixedHole, HoleRules};
use crate::error::DesignError;
use crate::hole_design::{self, HoleDesign, HoleSearchOptions, Proof, Starts};
use crate::problem::Known;
use crate::span_table::is_sequential;
use crate::vary::Vary;

/// Rounds in which holes and tensions are chosen in turn.
const ROUNDS: usize = 8;
/// Tensions that are tried for one cable before the rounds.
const TENSIONS: u32 = 24;
/// The best of these from which holes and tensions are chosen in turn.
const KEPT: usize = 4;
/// The same where every list must be solved as a whole.
const KEPT_OF_WHOLE: usize = 2;
/// Spans that may be looked at for each tension that is compared.
const QUICK: usize = 200_000;
/// The part of the budget that the comparison of tensions may take.
const COMPARED: usize = 2;
/// How often a list that is proven to be the best, and better than that of the beam, gets tensions of its own.
const PROOFS: usize = 3;
/// How much nearer a round must come to go on, as a part of what lists are compared by.
const NEARER: f64 = 2e-4;

impl Work<'_> {
    pub(super) fn holes(
        &mut self,
        cables: &[usize],
        tensions: &[usize],
    ) -> Result<(), DesignError> {
        let rules = self.rules(cables)?;
        let all = &self.options.search;
        // Where every list must be solved as a whole, tensions are compared by the first list of each alone.
        let is_sequential = is_sequential(&self.model, &self.robot, &self.shape_goals()?);
        let search = |work: &Self, (by, starts): (&HoleSearchOptions, Starts)| {
            let goals = work.shape_goals()?;
            let within = (&rules, Some(&work.criteria));
            let by = HoleSearchOptions { solves: by.solves.min(work.budget.left()), ..*by };
            let goals = (&goals[..], work.budget);
            hole_design::search(&work.model, &work.robot, cables, goals, within, (&by, starts))
        };
        let first = HoleSearchOptions { solves: 1, ..*all };
        // Where lists can be proven, tensions are compared by good lists, and only the list that is left is proven to be the best.
        let quick = HoleSearchOptions { nodes: all.nodes.min(QUICK), ..*all };
        let is_scanned = matches!((tensions, &self.cases[..]), ([_], [_]));
        let trial = match (is_sequential, is_scanned) {
            (true, _) if tensions.is_empty() => all,
            (true, _) => &quick,
            (false, true) => &first,
            (false, false) => all,
        };
        let trial = (trial, Starts::All);
        for &cable in tensions {
            let [least, greatest] = self.tension_range(cable)?;
            for case in &mut self.cases {
                let tension = &mut case.commands[cable].tension;
                *tension = tension.map(|tension| tension.clamp(least, greatest));
            }
        }
        // Of each trial the tensions and what the holes make of them.
        let mut trials = Vec::new();
        let mut starts = vec![self.cases.clone()];
        if !is_scanned
            && !tensions.is_empty()
            && let Ok(refined) = self.refined(&unknowns(tensions), 1)
        {
            // The best tensions of the lists that the robot has lead further than those that happen to be given.
            starts.insert(0, refined.cases);
        }
        for cases in starts {
            if !trials.is_empty() && self.budget.is_over() {
                break;
            }
            self.cases = cases;
            let most = match tensions.is_empty() {
                true => trial.0.solves,
                false => trial.0.solves.min(self.budget.left() / COMPARED),
            };
            let part = HoleSearchOptions { solves: most, ..*trial.0 };
            let found = search(self, (&part, trial.1));
            trials.push((self.cases.clone(), found));
        }
        if let ([cable], [_]) = (tensions, &self.cases[..]) {
            let [least, greatest] = self.tension_range(*cable)?;
            // The first trial tells what one takes: of tables of many cables there are fewer.
            let each = self.budget.spent().max(1);
            let room = self.budget.left() / COMPARED / each;
            let count = TENSIONS.min(u32::try_from(room).unwrap_or(u32::MAX));
            for k in 1..=count {
                if self.budget.is_over() {
                    break;
                }
                let part = f64::from(k) / f64::from(count);
                let tension = (part * part * greatest).max(least);
                self.cases[0].commands[*cable].tension = Some(tension);
                trials.push((self.cases.clone(), search(self, trial)));
            }
        }
        let mut refusal = None;
        let mut found = Vec::new();
        for (cases, trial) in trials {
            match trial {
                Ok(design) => found.push((cases, design)),
                Err(error) => {
                    refusal.get_or_insert(error);
                }
            }
        }
        found.sort_by(|a, b| a.1.merit.total_cmp(&b.1.merit));
        let compared = found.len();
        found.truncate(match (tensions.is_empty(), is_sequential) {
            (true, _) => 1,
            (false, true) => KEPT,
            (false, false) => KEPT_OF_WHOLE,
        });
        let in_turn = Known::InTurn { compared, improved: found.len() };
        let mut best: Option<(Vec<Case>, HoleDesign, Option<Known>)> = None;
        for (cases, design) in found {
            if best.is_some() && self.budget.is_over() {
                break;
            }
            self.cases = cases;
            self.robot = design.robot.clone();
            let by = if is_sequential { &quick } else { all };
            let by = |work: &Self| search(work, (by, Starts::Own));
            let ended = self.in_turn(design, tensions, &by)?;
            if best.as_ref().is_none_or(|(_, best, _)| ended.0.merit < best.merit) {
                best = Some((self.cases.clone(), ended.0, ended.1));
            }
        }
        let Some((cases, mut best, mut known)) = best else {
            return Err(refusal.unwrap_or(DesignError::NoPoints));
        };
        (self.cases, self.robot) = (cases, best.robot.clone());
        if is_sequential && !tensions.is_empty() {
            for round in 0..=PROOFS {
                if self.budget.is_over() {
                    break;
                }
                let before = best.merit;
                let nearest = search(self, (all, Starts::Own))?;
                if nearest.merit > before && nearest.proof != Proof::Optimal {
                    break;
                }
                best = nearest;
                self.robot = best.robot.clone();
                if round == PROOFS || best.merit > before * (1.0 - NEARER) {
                    break;
                }
                // The best list of all was not among those of the beam: other tensions may suit it better.
                let by = |work: &Self| search(work, (&quick, Starts::Own));
                let of_tensions;
                (best, of_tensions) = self.in_turn(best, tensions, &by)?;
                known = of_tensions.or(known);
            }
        }
        self.lower_bound = Some(best.lower_bound);
        for cable in cables {
            self.find(Vary::Holes { cable: *cable }, Known::Holes(best.proof));
        }
        // Least squares of the tensions alone know nothing of other holes.
        let known = known.filter(|known| !matches!(known, Known::LeastSquares { .. }));
        let known = match (known, self.budget.ended()) {
            // Nothing comes nearer, whatever was not tried.
            (Some(Known::Met), _) => Known::Met,
            (_, Some(_)) => Known::Budget,
            (known, None) => known.unwrap_or(in_turn),
        };
        for cable in tensions {
            self.find(Vary::Tension { cable: *cable }, known);
        }
        Ok(())
    }

    /// Tensions and holes in turn, until neither comes nearer.
    fn in_turn(
        &mut self,
        mut best: HoleDesign,
        tensions: &[usize],
        search: &impl Fn(&Self) -> Result<HoleDesign, DesignError>,
    ) -> Result<(HoleDesign, Option<Known>), DesignError> {
        let mut known = None;
        let unknowns = unknowns(tensions);
        for _ in 0..ROUNDS {
            if unknowns.is_empty() || self.budget.is_over() {
                break;
            }
            let before = best.merit;
            let refined = self.refined(&unknowns, 1)?;
            let of_tensions = known_of(&refined, self.options.iterations);
            let cases = core::mem::replace(&mut self.cases, refined.cases);
            let next = search(self)?;
            if next.merit >= best.merit {
                self.cases = cases;
                known.get_or_insert(of_tensions);
                break;
            }
            known = Some(of_tensions);
            best = next;
            self.robot = best.robot.clone();
            if best.merit > before * (1.0 - NEARER) {
                break;
            }
        }
        Ok((best, known))
    }

    /// The rules with the fixed holes of the varied cables, by their places among them.
    fn rules(&self, cables: &[usize]) -> Result<HoleRules, DesignError> {
        let rules = &self.options.rules;
        let fixed = rules.fixed.iter().map(|fixed| {
            let place = cables.iter().position(|cable| *cable == fixed.cable);
            let cable = place.ok_or(DesignError::FixedButNotVaried { cable: fixed.cable })?;
            Ok(FixedHole { cable, ..*fixed })
        });
        Ok(HoleRules { fixed: fixed.collect::<Result<_, DesignError>>()?, ..rules.clone() })
    }
}

fn unknowns(tensions: &[usize]) -> Vec<Vary> {
    tensions.iter().map(|&cable| Vary::Tension { cable }).collect()
}
