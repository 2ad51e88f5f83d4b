//! Warnings with their places in the file.

mod bare_numbers;
mod motor_rates;
mod unused_keys;

use whipcord::warning::{of_answer, of_case, of_spacing};
use whipcord::{Model, ModelKind, Robot, Solution, Warning};

use crate::case_file::CaseFile;
use crate::materials::preset;
use crate::read::Motion;
use crate::source::{Position, Span};

use bare_numbers::bare_numbers;
use motor_rates::motor_rates;

/// A warning about a file, or about an answer to what it asks.
#[derive(Clone, Debug, PartialEq)]
pub struct FileWarning {
    /// Cause and remedy.
    pub warning: Warning,
    /// Where; `None` where no key is at fault.
    pub span: Option<Span>,
    /// Which answer it is about, where there are several.
    pub answer: Option<AnswerOf>,
    /// How many more answers have a warning of the same code.
    pub more: usize,
}

/// One of several answers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AnswerOf {
    /// The model, where there are answers of several.
    pub model: Option<ModelKind>,
    /// The step, from 1, where the case has several.
    pub step: Option<usize>,
}

impl FileWarning {
    /// What it says, and of which answer.
    #[must_use]
    pub fn message(&self) -> String {
        let text = self.warning.to_string();
        let mut parts = Vec::new();
        if let Some(AnswerOf { model, step }) = self.answer {
            parts.extend(model.map(|model| model.to_string()));
            parts.extend(step.map(|step| format!("step {step}")));
        }
        match self.more {
            0 => {}
            1 => parts.push("and 1 more answer".to_owned()),
            more => parts.push(format!("and {more} more answers")),
        }
        if parts.is_empty() { text } else { format!("{text} ({})", parts.join(", ")) }
    }

    /// Path, line and column of its place.
    #[must_use]
    pub fn place(&self, file: &CaseFile) -> Option<(String, Position)> {
        let span = self.span?;
        let source = file.sources().get(span.file)?;
        Some((source.name(), source.position(span.start)))
    }
}

/// A Young's modulus without a unit below this many Pa is softer than most rubbers.
const SOFTER_THAN_RUBBER: f64 = 1e6;
/// No backbone is made of anything softer, in Pa.
const SOFTER_THAN_ANYTHING: f64 = 1e4;

/// Whether a mass has no effect, as in statics without gravity.
fn is_unused_mass(warning: &Warning) -> bool {
    let Warning::UnusedKey { path, .. } = warning else { return false };
    matches!(path.as_str(), "backbone.density" | "backbone.linear_density" | "disks.mass")
        || path.starts_with("loads.mass")
}

impl CaseFile {
    /// Warnings about this file, in the order of the file.
    #[must_use]
    pub fn warnings(&self) -> Vec<FileWarning> {
        self.warnings_with(SOFTER_THAN_RUBBER, unused_keys::zero_loads(self))
    }

    /// The same for a robot that moves: its masses have an effect without gravity, too.
    #[must_use]
    pub fn warnings_in_motion(&self) -> Vec<FileWarning> {
        let mut all = self.warnings();
        all.retain(|of| !is_unused_mass(&of.warning));
        all
    }

    /// The same where a program wrote the file and took the units away, as Python does: a modulus that may have had one is not
    /// doubted, and neither is a load that was computed to be zero.
    #[must_use]
    pub fn warnings_in_si(&self) -> Vec<FileWarning> {
        let mut all = self.warnings_with(SOFTER_THAN_ANYTHING, Vec::new());
        all.iter_mut().for_each(|warning| warning.span = None);
        all
    }

    fn warnings_with(&self, softest: f64, zero_loads: Vec<Warning>) -> Vec<FileWarning> {
        let mut all = bare_numbers(self.document(), self.softest(softest));
        let bare: Vec<String> = all.iter().filter_map(Warning::path).collect();
        let of_case = of_case(&self.robot, &self.case).into_iter();
        // What a unit explains needs no second explanation.
        all.extend(of_case.filter(|warning| match warning {
            Warning::Length { .. }
            | Warning::ThickBackbone { .. }
            | Warning::OutsideDisk { .. }
            | Warning::InsideBackbone { .. } => bare.iter().all(|path| path.ends_with("_modulus")),
            _ => self.motion == Motion::default() || !is_unused_mass(warning),
        }));
        all.extend(unused_keys::without_effect(self));
        all.extend(zero_loads);
        all.extend(motor_rates(self));
        let mut all: Vec<FileWarning> =
            all.into_iter().map(|warning| self.placed(warning)).collect();
        all.sort_by_key(|warning| warning.span);
        all
    }

    /// The modulus in Pa below which a bare number looks like megapascals: beside the name of a soft material a far lower one.
    fn softest(&self, usual: f64) -> f64 {
        const FAR_BELOW: f64 = 1e-2;
        let named = self.robot.backbone().material.name.and_then(preset);
        named.map_or(usual, |preset| usual.min(FAR_BELOW * preset.young_modulus))
    }

    /// Warnings about these answers to the case: each kind once, with the first answer
    /// that shows it and the number of the others.
    #[must_use]
    pub fn answer_warnings<'a>(
        &self,
        answers: impl IntoIterator<Item = (Option<AnswerOf>, &'a Solution)>,
    ) -> Vec<FileWarning> {
        self.answer_warnings_for(&self.robot, answers)
    }

    /// The same for answers of another robot than the file's, such as one with estimated parameters.
    #[must_use]
    pub fn answer_warnings_for<'a>(
        &self,
        robot: &Robot,
        answers: impl IntoIterator<Item = (Option<AnswerOf>, &'a Solution)>,
    ) -> Vec<FileWarning> {
        let mut all: Vec<FileWarning> = Vec::new();
        for (answer, solution) in answers {
            for warning in of_answer(robot, &self.case, solution) {
                match all.iter_mut().find(|known| known.warning.code() == warning.code()) {
                    Some(known) => known.more += 1,
                    None => all.push(FileWarning { answer, ..self.placed(warning) }),
                }
            }
        }
        all
    }

    /// Whether the spacing of the disks changes the answer of this model to the case. It costs a solve where the model is
    /// `cosserat-disks` and the robot a soft body, and nothing elsewhere.
    #[must_use]
    pub fn spacing_warning(&self, model: &Model, answer: &Solution) -> Option<FileWarning> {
        of_spacing(model, &self.robot, &self.case, answer).map(|warning| self.placed(warning))
    }

    fn placed(&self, warning: Warning) -> FileWarning {
        let span = warning.path().map(|path| self.document().locate(&path).span);
        FileWarning { warning, span, answer: None, more: 0 }
    }
}
