//! How the candidates did on several cases together.

use whipcord::CommandDerivatives;

use super::candidate::Candidate;
use super::recommendation::TOLERANCE;
use super::{Answer, CaseBenchmark};
use crate::statistics::median;

/// How a candidate did on several cases. Errors are root mean squares over the disks, relative to the length of
/// the backbone.
#[derive(Clone, Debug, PartialEq)]
pub struct Standing {
    /// Who.
    pub candidate: Candidate,
    /// Number of cases.
    pub of: usize,
    /// Number of those that it answered.
    pub answered: usize,
    /// Number of those whose error is known.
    pub judged: usize,
    /// Number of answers that the robot leaves.
    pub unstable: usize,
    /// Number of cases whose error is at most [`TOLERANCE`].
    pub within: usize,
    /// Median of the errors.
    pub median_error: Option<f64>,
    /// Greatest error.
    pub worst_error: Option<f64>,
    /// The case that it is of.
    pub worst_case: Option<String>,
    /// Median over the cases of the median time of a solve in s.
    pub time: Option<f64>,
    /// Median of the Newton iterations.
    pub iterations: Option<f64>,
    /// Where its derivatives by the commands come from.
    pub derivatives: CommandDerivatives,
    /// Whether it answered every case without section and material that it answered with them.
    pub without_material: bool,
}

impl Standing {
    /// How a candidate did.
    pub fn of(candidate: Candidate, benchmarks: &[&CaseBenchmark]) -> Self {
        let answers: Vec<&Answer> =
            benchmarks.iter().filter_map(|benchmark| benchmark.answer(candidate)).collect();
        let errors: Vec<(f64, &str)> = benchmarks
            .iter()
            .filter_map(|benchmark| Some((benchmark.error(candidate)?, benchmark.title.as_str())))
            .collect();
        let worst = errors.iter().max_by(|a, b| a.0.total_cmp(&b.0));
        let answered = || {
            let entries = benchmarks.iter().flat_map(|benchmark| &benchmark.entries);
            entries.filter(|entry| entry.candidate == candidate && entry.outcome.is_ok())
        };
        Self {
            candidate,
            of: benchmarks.len(),
            answered: answers.len(),
            judged: errors.len(),
            unstable: answers.iter().filter(|answer| answer.is_unstable()).count(),
            within: errors.iter().filter(|(error, _)| *error <= TOLERANCE).count(),
            median_error: some_median(errors.iter().map(|(error, _)| *error).collect()),
            worst_error: worst.map(|(error, _)| *error),
            worst_case: worst.map(|(_, title)| (*title).to_owned()),
            time: some_median(answers.iter().map(|answer| answer.solve.median).collect()),
            iterations: some_median(
                answers.iter().map(|answer| answer.iterations as f64).collect(),
            ),
            derivatives: candidate.kind.command_derivatives(),
            without_material: !answers.is_empty() && answered().all(|entry| entry.without_material),
        }
    }

    /// How each did.
    pub fn of_all(candidates: &[Candidate], benchmarks: &[&CaseBenchmark]) -> Vec<Self> {
        candidates.iter().map(|&candidate| Self::of(candidate, benchmarks)).collect()
    }
}

/// `None` of nothing.
fn some_median(mut values: Vec<f64>) -> Option<f64> {
    (!values.is_empty()).then(|| median(&mut values))
}

/// Two candidates on the cases that both answered and whose errors are known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairwiseComparison {
    /// Number of those cases.
    pub cases: usize,
    /// Median of how many times as long the second takes.
    pub slower: f64,
    /// Median times of both in s.
    pub times: [f64; 2],
    /// Medians of the relative errors of both.
    pub median_errors: [f64; 2],
    /// Greatest relative errors of both.
    pub worst_errors: [f64; 2],
}

impl PairwiseComparison {
    /// `None` where there is no such case.
    pub fn between(a: Candidate, b: Candidate, benchmarks: &[&CaseBenchmark]) -> Option<Self> {
        let both: Vec<[(f64, f64); 2]> = benchmarks
            .iter()
            .filter_map(|benchmark| {
                let of = |who| Some((benchmark.answer(who)?.solve.median, benchmark.error(who)?));
                Some([of(a)?, of(b)?])
            })
            .collect();
        let times = |i: usize| both.iter().map(|pair| pair[i].0).collect::<Vec<_>>();
        let errors = |i: usize| both.iter().map(|pair| pair[i].1).collect::<Vec<_>>();
        let worst = |i: usize| errors(i).into_iter().fold(0.0, f64::max);
        let slower = some_median(both.iter().map(|[a, b]| b.0 / a.0).collect())?;
        Some(Self {
            cases: both.len(),
            slower,
            times: [some_median(times(0))?, some_median(times(1))?],
            median_errors: [some_median(errors(0))?, some_median(errors(1))?],
            worst_errors: [worst(0), worst(1)],
        })
    }
}

#[cfg(test)]
mod tests {
    use whipcord::{Cancel, ModelKind, SolveError};

    use super::*;
    use crate::model_benchmark::candidate::Preset;
    use crate::model_benchmark::reference::{Choice, ReferenceAnswers};
    use crate::model_benchmark::{Commands, Entry, Residual, Subject};
    use crate::timing::Timing;

    const A: Candidate = Candidate { kind: ModelKind::FourBar, preset: Preset::Usual };
    const B: Candidate = Candidate { kind: ModelKind::Cosserat, preset: Preset::Usual };

    /// Of a robot of 2 m: error in m and time of both, `None` where there is no answer.
    fn benchmark(title: &str, results: [Option<(f64, f64)>; 2]) -> CaseBenchmark {
        let example = crate::benchmark::paper::table_1().unwrap().remove(0);
        let subject = Subject {
            title,
            stem: title,
            robot: &example.robot,
            case: &example.case,
            measured: None,
            tags: None,
            known: &[],
        };
        let timing = |median| Timing { median, repeats: 1 };
        let entry = |(candidate, result): (Candidate, Option<(f64, f64)>)| Entry {
            candidate,
            commands: Commands::Case,
            driven_by: String::new(),
            outcome: result
                .map(|(rms, time)| Answer {
                    residual: Ok(Residual { rms, greatest: rms, tip: None, steps: 1, points: 9 }),
                    solve: timing(time),
                    build: timing(0.0),
                    iterations: 3,
                    steps: 1,
                    stable: Some(true),
                    stability_absent: None,
                })
                .ok_or(SolveError::NoLever { cable: String::new(), disk: 1 }),
            without_material: candidate == A,
        };
        let reference = Choice::Model { kind: ModelKind::Cosserat, fine: false };
        CaseBenchmark {
            title: title.to_owned(),
            stem: title.to_owned(),
            sections: 9,
            length: 2.0,
            tags: None,
            among_obstacles: false,
            reference: ReferenceAnswers::new(&subject, reference, &Cancel::default()),
            entries: [A, B].into_iter().zip(results).map(entry).collect(),
        }
    }

    #[test]
    fn errors_are_counted_in_lengths_and_refusals_are_not_forgotten() {
        let benchmarks = [
            benchmark("near", [Some((0.03125, 1.0)), Some((0.001, 4.0))]),
            benchmark("far", [Some((0.125, 3.0)), Some((0.002, 3.0))]),
            benchmark("refused", [None, Some((0.004, 9.0))]),
        ];
        let benchmarks: Vec<&CaseBenchmark> = benchmarks.iter().collect();
        let a = Standing::of(A, &benchmarks);
        assert_eq!((a.of, a.answered, a.judged, a.within), (3, 2, 2, 1));
        assert_eq!((a.median_error, a.worst_error), (Some(0.0390625), Some(0.0625)));
        assert_eq!((a.worst_case.as_deref(), a.time), (Some("far"), Some(2.0)));
        assert!(a.without_material && !Standing::of(B, &benchmarks).without_material);
        // The two are compared on what both answered: 4 and 1 times as long.
        let pairwise_comparison = PairwiseComparison::between(A, B, &benchmarks).unwrap();
        assert_eq!(
            (pairwise_comparison.cases, pairwise_comparison.slower, pairwise_comparison.times),
            (2, 2.5, [2.0, 3.5])
        );
        assert_eq!(pairwise_comparison.worst_errors, [0.0625, 0.001]);
        assert_eq!(PairwiseComparison::between(A, B, &benchmarks[2..]), None);
    }
}
