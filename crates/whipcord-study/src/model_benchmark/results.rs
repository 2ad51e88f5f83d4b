//! All benchmarks of a comparison, and what follows from them.

use whipcord::jobs::share;
use whipcord::{Cancel, ModelKind};

use super::candidate::{Candidate, Preset};
use super::recommendation::{Evidence, Finding, MANY_SECTIONS, Many, recommendation};
use super::reference::Choice;
use super::standing::{PairwiseComparison, Standing};
use super::{CaseBenchmark, Subject};
use crate::resample::resample;
use crate::timing;

/// Sections that robots are cut into to see what many of them cost.
const CUT_INTO: usize = 100;
/// How many robots are cut at most: the time of a solve hangs on the sections rather than on the routing.
const CUT: usize = 4;

/// All benchmarks of a comparison.
#[derive(Clone, Debug)]
pub struct Results {
    /// Who took part.
    pub candidates: Vec<Candidate>,
    /// On every case.
    pub benchmarks: Vec<CaseBenchmark>,
    /// On some of the same robots cut into many sections, where none has many of its own.
    pub cut: Vec<CaseBenchmark>,
}

impl Results {
    /// Tries these models and their presets on all cases; `each` is told of every case before it begins. Once the flag is set
    /// solves end and cases are left out, so that what was found says nothing.
    pub fn of(
        subjects: &[Subject],
        kinds: &[ModelKind],
        choice: Choice,
        cancel: &Cancel,
        each: impl Fn(&str) + Sync,
    ) -> Self {
        let candidates = Candidate::of(kinds);
        let budget = timing::budget(subjects.len());
        let mut benchmarks: Vec<Option<CaseBenchmark>> = subjects.iter().map(|_| None).collect();
        let jobs = subjects.iter().zip(&mut benchmarks);
        let solve = |(subject, found): (&Subject, &mut Option<CaseBenchmark>), (): &mut ()| {
            each(subject.title);
            *found = Some(CaseBenchmark::new(subject, &candidates, choice, budget, cancel));
            !cancel.is_cancelled()
        };
        // One thread, or those that there are: none has to be started.
        let _ = share(jobs, timing::threads(subjects.len()), || (), solve);
        let benchmarks: Vec<CaseBenchmark> = benchmarks.into_iter().flatten().collect();
        let cut = if benchmarks.iter().any(|benchmark| benchmark.sections >= MANY_SECTIONS) {
            Vec::new()
        } else {
            each("many sections");
            // What was measured was measured on the robot as it is.
            let choice = if choice == Choice::Measured { Choice::Trusted } else { choice };
            // Among obstacles it is the contacts that take the time.
            let free = subjects.iter().filter(|subject| subject.case.obstacles.is_empty());
            let free = free.take_while(|_| !cancel.is_cancelled());
            let cut = free.filter_map(|subject| {
                let robot = resample(subject.robot, CUT_INTO).ok()?;
                Some(CaseBenchmark::new(
                    &Subject { robot: &robot, measured: None, known: &[], ..*subject },
                    &candidates,
                    choice,
                    timing::budget(CUT),
                    cancel,
                ))
            });
            cut.filter(|benchmark| benchmark.reference.is_ok()).take(CUT).collect()
        };
        Self { candidates, benchmarks, cut }
    }

    /// How each did on all cases that there is a reference for.
    pub fn standings(&self) -> Vec<Standing> {
        Standing::of_all(&self.candidates, &judged(&self.benchmarks))
    }

    /// Which model to use for what.
    pub fn recommendation(&self) -> Vec<Finding> {
        recommendation(&self.evidence())
    }

    fn evidence(&self) -> Evidence {
        // Obstacles, which few models take, and which take their time, are a question of their own where there
        // are robots without.
        let (touching, free): (Vec<&CaseBenchmark>, Vec<&CaseBenchmark>) =
            judged(&self.benchmarks).into_iter().partition(|benchmark| benchmark.among_obstacles);
        let standings =
            |benchmarks: &[&CaseBenchmark]| Standing::of_all(&self.candidates, benchmarks);
        let (benchmarks, touching) =
            if free.is_empty() { (touching, Vec::new()) } else { (free, touching) };
        let mut kinds = benchmarks.iter().map(|benchmark| benchmark.reference.as_ref().ok()?.kind);
        let first = kinds.next().flatten();
        let many = if self.cut.is_empty() {
            benchmarks
                .iter()
                .copied()
                .filter(|benchmark| benchmark.sections >= MANY_SECTIONS)
                .collect()
        } else {
            judged(&self.cut)
        };
        Evidence {
            standings: standings(&benchmarks),
            among_obstacles: (!touching.is_empty()).then(|| standings(&touching)),
            reference: first.filter(|_| kinds.all(|kind| kind == first)),
            pairwise_comparisons: self.pairwise_comparisons(&benchmarks),
            many: many.iter().map(|benchmark| benchmark.sections).min().map(|sections| Many {
                sections,
                standings: standings(&many),
                pairwise_comparisons: self.pairwise_comparisons(&many),
            }),
        }
    }

    /// The paper's two models against each other: the four-bar model as it is, and the Cosserat model in each
    /// preset, first as it is.
    fn pairwise_comparisons(
        &self,
        benchmarks: &[&CaseBenchmark],
    ) -> Vec<(Candidate, PairwiseComparison)> {
        let four_bar = Candidate { kind: ModelKind::FourBar, preset: Preset::Usual };
        let rods = self.candidates.iter().filter(|rod| rod.kind == ModelKind::Cosserat);
        rods.filter_map(|&rod| Some((rod, PairwiseComparison::between(four_bar, rod, benchmarks)?)))
            .collect()
    }
}

/// Those with a reference.
fn judged(benchmarks: &[CaseBenchmark]) -> Vec<&CaseBenchmark> {
    benchmarks.iter().filter(|benchmark| benchmark.reference.is_ok()).collect()
}
