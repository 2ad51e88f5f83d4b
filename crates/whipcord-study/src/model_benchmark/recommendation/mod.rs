//! Which model to use, in words, from what was measured of them.
//!
//! Nothing here names a robot: the rules below pick by figures, and the figures stand in the sentences. What a
//! model knows (derivatives, forces) it says itself, and whether it needs a material was tried.

#[cfg(test)]
mod tests;

use whipcord::{Actuation, CommandDerivatives, ModelKind};

use super::candidate::{Candidate, Preset};
use super::standing::{PairwiseComparison, Standing};
use crate::quantity::number;
use crate::timing::duration;

/// A model that is off by more than this share of the length does not describe the robot: twice what the paper
/// found between its models and photographs of its robots ([`PAPER_ERROR`]), and what calibrated models of
/// continuum robots are commonly off by.
pub const TOLERANCE: f64 = 0.02;

/// A solve within a control loop takes no longer: a loop of 1 kHz has this much for everything.
pub const CONTROL_TIME: f64 = 1e-3;

/// The paper's greatest RMS error, 2.1 mm, over the length of its robots, 180 mm: what it calls accurate.
pub const PAPER_ERROR: f64 = 2.1 / 180.0;

/// The paper's "significantly faster" is 2.20 s against 10.07 s; a factor below this one would be lost beside
/// what else a control loop does.
pub const SIGNIFICANT: f64 = 2.0;

/// From so many sections on the paper would rather use the Cosserat model.
pub const MANY_SECTIONS: usize = 50;

/// What a sentence is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Topic {
    /// Which model to control the robot with.
    Control,
    /// Which model to design it with.
    Design,
    /// Which model when the material is not known.
    UnknownMaterial,
    /// Which model when there are many sections.
    ManySections,
    /// Which model among obstacles.
    Obstacles,
    /// Whether the paper's conclusion holds.
    Paper,
}

impl Topic {
    /// In tables for programs.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Control => "control",
            Self::Design => "design",
            Self::UnknownMaterial => "unknown-material",
            Self::ManySections => "many-sections",
            Self::Obstacles => "obstacles",
            Self::Paper => "paper",
        }
    }

    /// At the head of its sentence.
    pub const fn words(self) -> &'static str {
        match self {
            Self::Control => "Control",
            Self::Design => "Design",
            Self::UnknownMaterial => "Material unknown",
            Self::ManySections => "Many sections",
            Self::Obstacles => "Obstacles",
            Self::Paper => "The paper's conclusion",
        }
    }
}

/// One sentence or two of a recommendation.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// What it is about.
    pub topic: Topic,
    /// The model to use, where there is one.
    pub choice: Option<Candidate>,
    /// Of the paper's conclusion: whether it was confirmed, where that could be tried.
    pub confirmed: Option<bool>,
    /// In words, with the figures.
    pub text: String,
}

/// What a recommendation is derived from.
#[derive(Clone, Debug, Default)]
pub struct Evidence {
    /// How each candidate did on the cases that there is a reference for: on those without obstacles, where there
    /// are any.
    pub standings: Vec<Standing>,
    /// How each did among obstacles, where others are without.
    pub among_obstacles: Option<Vec<Standing>>,
    /// The model that is the reference, where one alone is.
    pub reference: Option<ModelKind>,
    /// The four-bar model against each of the Cosserat model's presets.
    pub pairwise_comparisons: Vec<(Candidate, PairwiseComparison)>,
    /// The same robots with many sections.
    pub many: Option<Many>,
}

/// How the candidates did with many sections.
#[derive(Clone, Debug)]
pub struct Many {
    /// Least number of sections.
    pub sections: usize,
    /// How each did.
    pub standings: Vec<Standing>,
    /// The four-bar model against each of the Cosserat model's presets.
    pub pairwise_comparisons: Vec<(Candidate, PairwiseComparison)>,
}

/// What to use for what; nothing where no model has an error to be judged by.
pub fn recommendation(evidence: &Evidence) -> Vec<Finding> {
    if evidence.standings.iter().all(|standing| standing.judged == 0) {
        return Vec::new();
    }
    let mut findings = vec![control(evidence), design(evidence), unknown_material(evidence)];
    findings.extend(evidence.many.as_ref().map(many_sections));
    findings.extend(evidence.among_obstacles.as_deref().map(obstacles));
    findings.extend(paper(evidence));
    findings
}

/// `1.2 % of the length`; no more digits than the eye wants.
fn share(error: f64) -> String {
    format!("{} % of the length", number(1e2 * error, 2))
}

fn found(topic: Topic, standing: &Standing, text: String) -> Finding {
    Finding { topic, choice: Some(standing.candidate), confirmed: None, text }
}

fn none(topic: Topic, text: String) -> Finding {
    Finding { topic, choice: None, confirmed: None, text }
}

/// Of some, those judged on as many cases as any of them.
fn complete<'a>(
    some: impl Iterator<Item = &'a Standing> + Clone,
) -> impl Iterator<Item = &'a Standing> + Clone {
    let most = some.clone().map(|standing| standing.judged).max().unwrap_or(0);
    some.filter(move |standing| standing.judged == most && most > 0)
}

fn worst(standing: &Standing) -> f64 {
    standing.worst_error.unwrap_or(f64::INFINITY)
}

fn time(standing: &Standing) -> f64 {
    standing.time.unwrap_or(f64::INFINITY)
}

fn least<'a>(
    standings: impl Iterator<Item = &'a Standing>,
    by: impl Fn(&Standing) -> f64,
) -> Option<&'a Standing> {
    standings.min_by(|a, b| by(a).total_cmp(&by(b)))
}

/// The fastest that is near enough to the reference and knows its derivatives exactly; without one, by differences.
fn control(evidence: &Evidence) -> Finding {
    let fit = |derivatives| {
        let near = complete(evidence.standings.iter()).filter(|s| worst(s) <= TOLERANCE);
        let quick = near.filter(|s| time(s) <= CONTROL_TIME);
        least(quick.filter(move |s| s.derivatives == derivatives), time)
    };
    let exact = fit(CommandDerivatives::Exact);
    let Some(best) = exact.or_else(|| fit(CommandDerivatives::Differences)) else {
        let all = complete(evidence.standings.iter());
        let near = all.clone().filter(|s| worst(s) <= TOLERANCE);
        let why = match (least(near, time), least(all, worst)) {
            (Some(quickest), _) => format!(
                "{} is near enough and takes {}",
                quickest.candidate,
                duration(time(quickest))
            ),
            (None, Some(nearest)) => format!(
                "the nearest that answers every case, {}, is {} off",
                nearest.candidate,
                share(worst(nearest))
            ),
            (None, None) => "none answers every case".to_owned(),
        };
        return none(
            Topic::Control,
            format!(
                "no model is within {} and {} a solve: {why}.",
                share(TOLERANCE),
                duration(CONTROL_TIME)
            ),
        );
    };
    let derivatives = match best.derivatives {
        CommandDerivatives::Exact => "with exact derivatives",
        CommandDerivatives::Differences => {
            "with derivatives by differences, a solve or two more for each cable"
        }
    };
    let driven = match best.candidate.kind.natural_actuation() {
        Actuation::Shortening => "driven by cable lengths",
        Actuation::Natural | Actuation::Tension => "driven by tensions or lengths",
    };
    let mut text = format!(
        "{}, {driven}: {} a solve, {derivatives}, at most {} from the reference",
        best.candidate,
        duration(time(best)),
        share(worst(best))
    );
    // Where it is not the fastest, that is for the sake of some cases.
    let partly = evidence.standings.iter().filter(|s| s.within > 0 && s.within < s.of);
    if let Some(other) = partly.filter(|s| time(s) < time(best)).max_by_key(|s| s.within) {
        text += &format!(
            "; {} takes {} and is within {} on {} of {} cases",
            other.candidate,
            duration(time(other)),
            share(TOLERANCE),
            other.within,
            other.of
        );
    }
    found(Topic::Control, best, text + ".")
}

/// The nearest of those that know forces: what is designed are stiffness, tensions and what is carried.
fn design(evidence: &Evidence) -> Finding {
    let knows_forces = |s: &&Standing| s.candidate.kind.natural_actuation() == Actuation::Tension;
    let able = complete(evidence.standings.iter().filter(knows_forces));
    let Some(best) = least(able.clone(), worst) else {
        return none(
            Topic::Design,
            "no model that knows forces answers: give the backbone's section and material.".into(),
        );
    };
    let (off, took) = (share(worst(best)), duration(time(best)));
    let mut text = if evidence.reference == Some(best.candidate.kind) {
        format!(
            "{}, which the others are measured against: it knows forces, loads and stiffness; {took} a solve, {off} from its own exact answer",
            best.candidate
        )
    } else {
        format!(
            "{}, the nearest to the reference of those that know forces, loads and stiffness: at most {off} off, {took} a solve",
            best.candidate
        )
    };
    if best.derivatives != CommandDerivatives::Exact {
        let exact = able.filter(|s| s.derivatives == CommandDerivatives::Exact);
        if let Some(other) = least(exact, worst) {
            text += &format!(
                "; of those with exact derivatives {} is the nearest: at most {} off, {} a solve",
                other.candidate,
                share(worst(other)),
                duration(time(other))
            );
        }
    }
    found(Topic::Design, best, text + ".")
}

/// The nearest of those that answer without section and material.
fn unknown_material(evidence: &Evidence) -> Finding {
    let able = evidence.standings.iter().filter(|s| s.without_material);
    let Some(best) = least(complete(able), worst) else {
        return none(
            Topic::UnknownMaterial,
            "no model takes this robot without section and material: measure its stiffness (`whipcord fit`).".into(),
        );
    };
    let part = if best.judged < best.of {
        format!(" on the {} of {} cases that it takes", best.judged, best.of)
    } else {
        String::new()
    };
    let (candidate, off) = (best.candidate, share(worst(best)));
    if worst(best) <= TOLERANCE {
        let text = format!(
            "{candidate}, driven by cable lengths: it needs the geometry alone, and is at most {off} from the reference{part}."
        );
        return found(Topic::UnknownMaterial, best, text);
    }
    none(
        Topic::UnknownMaterial,
        format!(
            "of those that need the geometry alone {candidate} is the nearest, but up to {off} off{part}: measure the stiffness (`whipcord fit`)."
        ),
    )
}

/// The fastest that is near enough with many sections, beside the other models as they are.
fn many_sections(many: &Many) -> Finding {
    let (of_them, sections) = (format!("with {} of them", many.sections), many.sections);
    let usual = |s: &Standing| s.candidate.preset == Preset::Usual;
    fastest(
        Topic::ManySections,
        &many.standings,
        &of_them,
        &format!("with {sections} sections"),
        usual,
    )
}

/// The fastest that is near enough among obstacles, beside the others that know contact.
fn obstacles(standings: &[Standing]) -> Finding {
    let cases = standings.first().map_or(0, |standing| standing.of);
    let those = if cases == 1 { "in the 1 case".to_owned() } else { format!("in {cases} cases") };
    fastest(Topic::Obstacles, standings, &those, "among obstacles", |_| true)
}

/// The fastest that is near enough, beside some others; what its figures are of stands before them.
fn fastest(
    topic: Topic,
    standings: &[Standing],
    before: &str,
    place: &str,
    others: impl Fn(&Standing) -> bool,
) -> Finding {
    let near = complete(standings.iter()).filter(|s| worst(s) <= TOLERANCE);
    let Some(best) = least(near, time) else {
        let text =
            format!("{place} no model that answers every case is within {}.", share(TOLERANCE));
        return none(topic, text);
    };
    let (candidate, took) = (best.candidate, duration(time(best)));
    let others: Vec<String> = complete(standings.iter())
        .filter(|s| s.candidate.kind != candidate.kind && others(s))
        .map(|s| format!("{} takes {}", s.candidate, duration(time(s))))
        .collect();
    let others = if others.is_empty() { String::new() } else { format!("; {}", others.join(", ")) };
    let off = share(worst(best));
    let text =
        format!("{before} {candidate}: {took} a solve, at most {off} from the reference{others}.");
    found(topic, best, text)
}

/// "Faster", "accurate enough", "beyond 50 sections rather the Cosserat model": each claim by the figures.
fn paper(evidence: &Evidence) -> Vec<Finding> {
    let Some((usual, pairwise_comparison)) = evidence.pairwise_comparisons.first() else {
        return Vec::new();
    };
    let mut findings = vec![
        faster(*usual, pairwise_comparison, &evidence.pairwise_comparisons),
        accurate(pairwise_comparison, evidence.reference),
    ];
    findings.extend(evidence.many.as_ref().and_then(beyond));
    findings
}

fn claim(confirmed: bool, claim: &str, figures: &str) -> Finding {
    let outcome = if confirmed { "confirmed" } else { "refuted" };
    let text = format!("{claim}: {outcome}: {figures}.");
    Finding { topic: Topic::Paper, choice: None, confirmed: Some(confirmed), text }
}

/// Faster than the Cosserat model, and than each preset of it that is no farther from the reference: for the accuracy
/// of four bars a rod need not be solved to 1e-9.
fn faster(
    usual: Candidate,
    pairwise_comparison: &PairwiseComparison,
    pairwise_comparisons: &[(Candidate, PairwiseComparison)],
) -> Finding {
    let error = pairwise_comparison.worst_errors[0];
    let no_farther = pairwise_comparisons
        .iter()
        .filter(|(_, pairwise_comparison)| pairwise_comparison.worst_errors[1] <= error);
    let rival = no_farther.min_by(|a, b| a.1.slower.total_cmp(&b.1.slower));
    let confirmed = pairwise_comparison.slower >= SIGNIFICANT
        && rival.is_none_or(|(_, pairwise_comparison)| pairwise_comparison.slower >= SIGNIFICANT);
    let [ours, theirs] = pairwise_comparison.times.map(duration);
    let mut figures = format!(
        "four-bar takes {ours}, {usual} {theirs}, {} times as long",
        number(pairwise_comparison.slower, 2)
    );
    if let Some((rod, rival)) = rival.filter(|(rod, _)| *rod != usual) {
        let times = [rival.times[1], rival.times[0]].map(duration);
        let [of_rod, of_four_bar] = [rival.worst_errors[1], rival.worst_errors[0]].map(share);
        let word =
            if !confirmed && pairwise_comparison.slower >= SIGNIFICANT { "but" } else { "and" };
        figures += &format!(
            "; {word} {rod} takes {} where four-bar takes {}, and is no farther off: at most {of_rod}, not {of_four_bar}",
            times[0], times[1]
        );
    }
    claim(confirmed, "the optimisation-based model is significantly faster", &figures)
}

fn accurate(pairwise_comparison: &PairwiseComparison, reference: Option<ModelKind>) -> Finding {
    let both = |i: usize| {
        let (median, worst) = (
            share(pairwise_comparison.median_errors[i]),
            share(pairwise_comparison.worst_errors[i]),
        );
        if pairwise_comparison.cases == 1 {
            format!("{worst} off")
        } else {
            format!("{median} off, at most {worst}")
        }
    };
    let lengths = if reference.is_some() { ", given the reference's cable lengths," } else { "" };
    let cases = match pairwise_comparison.cases {
        1 => "on 1 case".to_owned(),
        n => format!("on {n} cases"),
    };
    let figures = format!(
        "{cases} four-bar{lengths} is {}; cosserat {}; the paper's own errors reach {}",
        both(0),
        both(1),
        share(PAPER_ERROR)
    );
    claim(
        pairwise_comparison.worst_errors[0] <= PAPER_ERROR,
        "its accuracy is comparable",
        &figures,
    )
}

fn beyond(many: &Many) -> Option<Finding> {
    let (rod, pairwise_comparison) =
        many.pairwise_comparisons.iter().min_by(|a, b| a.1.slower.total_cmp(&b.1.slower))?;
    let [ours, theirs] = pairwise_comparison.times.map(duration);
    let figures =
        format!("with {} of them {rod} takes {theirs} and four-bar {ours}", many.sections);
    let claimed = format!("beyond {MANY_SECTIONS} sections rather the Cosserat model");
    Some(claim(pairwise_comparison.slower < 1.0, &claimed, &figures))
}
