//! Warnings about files and answers.

use whipcord::{Model, ModelKind, Solution};
use whipcord_io::{AnswerOf, CaseFile, FileWarning};

/// The answers of a model to a case: those to all steps, in order.
pub type Answered<'a> = (Model, Vec<&'a Solution>);

/// Warnings about the answers of one model.
pub fn about_answers(file: &CaseFile, answered: &Answered<'_>) -> Vec<FileWarning> {
    let mut all = file.answer_warnings(numbered(&answered.1, None));
    all.extend(about_spacing(file, answered));
    all
}

/// Warnings about a file and about the answers of several models to what it asks, each kind with the first model that shows it.
pub fn about_file_and_answers(file: &CaseFile, of: &[Answered<'_>]) -> Vec<FileWarning> {
    let mut all = file.warnings();
    let answers = of.iter().flat_map(|(model, answers)| numbered(answers, Some(model.kind())));
    all.extend(file.answer_warnings(answers));
    all.extend(of.iter().filter_map(|answered| about_spacing(file, answered)));
    all
}

/// The answers with the model and, where there are several, the number of their step.
fn numbered<'a>(
    answers: &[&'a Solution],
    model: Option<ModelKind>,
) -> impl Iterator<Item = (Option<AnswerOf>, &'a Solution)> {
    let several = answers.len() > 1;
    answers.iter().enumerate().map(move |(n, solution)| {
        let step = several.then_some(n + 1);
        let of = (model.is_some() || several).then_some(AnswerOf { model, step });
        (of, *solution)
    })
}

/// What half the spacing of the disks changes after the last step.
fn about_spacing(file: &CaseFile, (model, answers): &Answered<'_>) -> Option<FileWarning> {
    file.spacing_warning(model, answers.last()?)
}
