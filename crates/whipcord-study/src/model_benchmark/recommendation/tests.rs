use super::*;

const COSSERAT: Candidate = Candidate { kind: ModelKind::Cosserat, preset: Preset::Usual };
const STEPS: Candidate = Candidate { preset: Preset::StepPerSection, ..COSSERAT };
const DISKS: Candidate = Candidate { kind: ModelKind::CosseratDisks, preset: Preset::Usual };
const ARC: Candidate = Candidate { kind: ModelKind::ConstantCurvature, preset: Preset::Usual };
const FOUR_BAR: Candidate = Candidate { kind: ModelKind::FourBar, preset: Preset::Usual };

/// Of one candidate: cases judged of four, greatest error, and time.
fn standing(candidate: Candidate, judged: usize, error: f64, time: f64) -> Standing {
    Standing {
        candidate,
        of: 4,
        answered: judged,
        judged,
        unstable: 0,
        within: if error <= TOLERANCE { judged } else { judged / 2 },
        median_error: (judged > 0).then_some(0.5 * error),
        worst_error: (judged > 0).then_some(error),
        worst_case: None,
        time: (judged > 0).then_some(time),
        iterations: None,
        derivatives: candidate.kind.command_derivatives(),
        without_material: candidate == FOUR_BAR,
    }
}

/// Of a model without derivatives of its own.
fn by_differences(standing: Standing) -> Standing {
    Standing { derivatives: CommandDerivatives::Differences, ..standing }
}

/// Four bars against a rod: how many times as long the rod takes, and the greatest errors of both.
fn pairwise_comparison(slower: f64, worst_errors: [f64; 2]) -> PairwiseComparison {
    let median_errors = worst_errors.map(|error| 0.5 * error);
    PairwiseComparison {
        cases: 4,
        slower,
        times: [4e-6, 4e-6 * slower],
        median_errors,
        worst_errors,
    }
}

fn evidence(standings: Vec<Standing>) -> Evidence {
    Evidence { standings, ..Evidence::default() }
}

fn paper_of(
    pairwise_comparisons: Vec<(Candidate, PairwiseComparison)>,
    many: Option<PairwiseComparison>,
) -> Vec<(Option<bool>, String)> {
    let many = many.map(|pairwise_comparison| Many {
        sections: 100,
        standings: Vec::new(),
        pairwise_comparisons: vec![(COSSERAT, pairwise_comparison)],
    });
    let found = paper(&Evidence { pairwise_comparisons, many, ..Evidence::default() });
    found.into_iter().map(|finding| (finding.confirmed, finding.text)).collect()
}

#[test]
fn nothing_is_said_of_nothing() {
    assert_eq!(recommendation(&Evidence::default()), []);
    assert_eq!(recommendation(&evidence(vec![standing(COSSERAT, 0, 0.0, 0.0)])), []);
}

#[test]
fn control_takes_the_fastest_with_exact_derivatives() {
    let all = vec![
        standing(COSSERAT, 4, 0.009, 12e-6),
        by_differences(standing(ARC, 4, 0.0, 2e-6)),
        standing(FOUR_BAR, 4, 0.016, 4e-6),
    ];
    let found = control(&evidence(all));
    assert_eq!(found.choice, Some(FOUR_BAR));
    assert_eq!(
        found.text,
        "four-bar, driven by cable lengths: 4.0 µs a solve, with exact derivatives, at most 1.6 % of the length from the reference."
    );
}

#[test]
fn control_passes_over_what_is_too_far_off_or_answers_too_little() {
    let all = vec![
        standing(COSSERAT, 4, 0.009, 12e-6),
        standing(STEPS, 3, 0.001, 1e-6),
        standing(FOUR_BAR, 4, 0.03, 4e-6),
    ];
    let found = control(&evidence(all));
    assert_eq!(found.choice, Some(COSSERAT));
    // What it would have been on most cases is told.
    let told =
        "; cosserat, step a section takes 1.0 µs and is within 2 % of the length on 3 of 4 cases.";
    assert!(found.text.ends_with(told), "{}", found.text);
}

#[test]
fn control_makes_do_with_differences() {
    let all = vec![standing(COSSERAT, 4, 0.05, 12e-6), by_differences(standing(ARC, 4, 0.0, 3e-4))];
    let found = control(&evidence(all));
    assert_eq!(found.choice, Some(ARC));
    assert!(found.text.contains("derivatives by differences"), "{}", found.text);
}

#[test]
fn control_says_why_there_is_none() {
    let text = |all| {
        let found = control(&evidence(all));
        assert_eq!(found.choice, None);
        found.text
    };
    let far = text(vec![standing(COSSERAT, 4, 0.05, 1e-6), standing(FOUR_BAR, 4, 0.07, 1e-6)]);
    let expected = "no model is within 2 % of the length and 1.00 ms a solve: the nearest that answers every case, cosserat, is 5 % of the length off.";
    assert_eq!(far, expected);
    // Of those that are near enough, the quickest.
    let slow = text(vec![standing(DISKS, 4, 0.0, 0.3), standing(COSSERAT, 4, 0.01, 0.02)]);
    assert!(slow.ends_with("cosserat is near enough and takes 20.00 ms."), "{slow}");
}

#[test]
fn design_takes_the_nearest_that_knows_forces() {
    let all = vec![
        standing(COSSERAT, 4, 0.009, 12e-6),
        standing(DISKS, 4, 0.005, 3e-4),
        standing(FOUR_BAR, 4, 0.001, 4e-6),
    ];
    let found = design(&evidence(all.clone()));
    assert_eq!(found.choice, Some(DISKS));
    assert!(found.text.contains("the nearest to the reference of those that know forces"));
    let own = Evidence { reference: Some(ModelKind::CosseratDisks), ..evidence(all) };
    assert!(design(&own).text.contains("which the others are measured against"));
}

#[test]
fn design_needs_a_model_that_knows_forces() {
    let found = design(&evidence(vec![standing(FOUR_BAR, 4, 0.001, 4e-6)]));
    assert_eq!(found.choice, None);
    assert!(found.text.contains("section and material"), "{}", found.text);
}

#[test]
fn without_a_material_only_what_needs_none_counts() {
    let near = vec![standing(COSSERAT, 4, 0.0, 12e-6), standing(FOUR_BAR, 3, 0.016, 4e-6)];
    let found = unknown_material(&evidence(near));
    assert_eq!(found.choice, Some(FOUR_BAR));
    assert!(found.text.ends_with("from the reference on the 3 of 4 cases that it takes."));
    let far = vec![standing(COSSERAT, 4, 0.0, 12e-6), standing(FOUR_BAR, 4, 0.03, 4e-6)];
    let found = unknown_material(&evidence(far));
    assert_eq!(found.choice, None);
    assert!(found.text.contains("up to 3 % of the length off: measure the stiffness"));
    let found = unknown_material(&evidence(vec![standing(COSSERAT, 4, 0.0, 12e-6)]));
    assert_eq!(found.choice, None);
    assert!(found.text.starts_with("no model takes this robot without"));
}

#[test]
fn many_sections_take_the_fastest_that_is_near_enough() {
    let many = |standings| Many { sections: 100, standings, pairwise_comparisons: Vec::new() };
    let all = vec![
        standing(COSSERAT, 4, 1e-4, 60e-6),
        standing(STEPS, 4, 1e-4, 20e-6),
        standing(FOUR_BAR, 4, 0.01, 40e-6),
    ];
    let found = many_sections(&many(all));
    assert_eq!(found.choice, Some(STEPS));
    let expected = "with 100 of them cosserat, step a section: 20.0 µs a solve, at most 0.01 % of the length from the reference; four-bar takes 40.0 µs.";
    assert_eq!(found.text, expected);
    let found = many_sections(&many(vec![standing(FOUR_BAR, 4, 0.1, 40e-6)]));
    assert_eq!(found.choice, None);
    assert!(found.text.starts_with("with 100 sections no model"));
}

#[test]
fn obstacles_are_a_question_of_their_own() {
    let strain = Candidate { preset: Preset::StrainEnergy, ..FOUR_BAR };
    let free = vec![standing(COSSERAT, 4, 0.03, 12e-6), standing(DISKS, 4, 0.0, 3e-4)];
    let touching = vec![
        standing(COSSERAT, 4, 1e-4, 0.04),
        standing(STEPS, 4, 1e-4, 0.03),
        standing(DISKS, 0, 0.0, 0.0),
        standing(FOUR_BAR, 0, 0.0, 0.0),
        standing(strain, 4, 0.015, 2e-3),
    ];
    let all = Evidence { among_obstacles: Some(touching), ..evidence(free) };
    let found = recommendation(&all);
    // A model that knows no contact is not passed over where nothing is in the way.
    assert_eq!((found[0].choice, found[1].choice), (Some(DISKS), Some(DISKS)));
    let last = found.last().unwrap();
    assert_eq!((last.topic, last.choice), (Topic::Obstacles, Some(strain)));
    let expected = "in 4 cases four-bar, strain energy: 2.00 ms a solve, at most 1.5 % of the length from the reference; cosserat takes 40.00 ms, cosserat, step a section takes 30.00 ms.";
    assert_eq!(last.text, expected);
}

#[test]
fn the_paper_is_confirmed_where_its_figures_are() {
    let found = paper_of(
        vec![(COSSERAT, pairwise_comparison(4.6, [0.0117 * 0.99, 0.0116]))],
        Some(pairwise_comparison(0.5, [0.0; 2])),
    );
    assert_eq!(found.iter().map(|(confirmed, _)| *confirmed).collect::<Vec<_>>(), [Some(true); 3]);
    assert!(
        found[0]
            .1
            .contains("confirmed: four-bar takes 4.0 µs, cosserat 18.4 µs, 4.6 times as long")
    );
    assert!(found[2].1.ends_with("with 100 of them cosserat takes 2.0 µs and four-bar 4.0 µs."));
    // Without robots of many sections nothing is said of them, and without four bars nothing at all.
    assert_eq!(paper_of(vec![(COSSERAT, pairwise_comparison(4.6, [0.01; 2]))], None).len(), 2);
    assert_eq!(paper_of(Vec::new(), None), []);
}

#[test]
fn the_paper_is_refuted_by_each_claim_alone() {
    let confirmed = |pairwise_comparisons, many| {
        paper_of(pairwise_comparisons, many)
            .into_iter()
            .map(|(confirmed, _)| confirmed == Some(true))
            .collect::<Vec<_>>()
    };
    let one = |slower, error| vec![(COSSERAT, pairwise_comparison(slower, [error, 0.01]))];
    assert_eq!(confirmed(one(1.9, 0.01), None), [false, true]);
    assert_eq!(confirmed(one(2.1, 0.012), None), [true, false]);
    assert_eq!(
        confirmed(one(2.1, 0.01), Some(pairwise_comparison(1.1, [0.0; 2]))),
        [true, true, false]
    );
}

#[test]
fn four_bars_are_not_faster_than_a_rod_that_is_as_near_and_quicker() {
    let with = |steps: PairwiseComparison| {
        paper_of(vec![(COSSERAT, pairwise_comparison(3.0, [0.01, 0.005])), (STEPS, steps)], None)
            .remove(0)
    };
    let (confirmed, text) = with(pairwise_comparison(0.5, [0.01, 0.006]));
    assert_eq!(confirmed, Some(false));
    assert!(
        text.contains("; but cosserat, step a section takes 2.0 µs where four-bar takes 4.0 µs"),
        "{text}"
    );
    // One that is farther off is no rival.
    let (confirmed, text) = with(pairwise_comparison(0.5, [0.01, 0.02]));
    assert_eq!(confirmed, Some(true));
    assert!(!text.contains("step a section"), "{text}");
    // One that is as near and slow enough is told and changes nothing.
    let (confirmed, text) = with(pairwise_comparison(2.5, [0.01, 0.006]));
    assert_eq!(confirmed, Some(true));
    assert!(text.contains("; and cosserat, step a section"), "{text}");
}
