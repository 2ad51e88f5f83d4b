#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::path::PathBuf;

use whipcord::ModelKind;

use super::*;

fn example(name: &str) -> Arc<CaseFile> {
    let path: PathBuf = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples").join(name);
    Arc::new(load(path).unwrap())
}

#[test]
fn frames_say_how_far_what_lies_between_them_is_off() {
    let file = example("table1/case-3.toml");
    let mut told = Vec::new();
    let recording = record(&file, &[], |progress| told.push(progress)).unwrap();
    let recorded = &recording.models[0];
    assert_eq!((recorded.model.as_str(), recording.axes.len()), ("cosserat", 1));
    assert_eq!(recorded.solved, recording.axes[0].len() + 1);
    assert_eq!(recorded.trials.count, TRIALS);
    // Whoever waits for it hears of each solve.
    let all = recorded.solved + TRIALS;
    assert_eq!(told.iter().map(|t| t.done).collect::<Vec<_>>(), (1..=all).collect::<Vec<_>>());
    assert!(told.iter().all(|progress| progress.all == all));
    // One cable, without loads: its strains are smooth in its tension, and there are many frames.
    let length = file.robot.backbone().length;
    assert!(recorded.trials.greatest < 2e-3 * length, "{:?}", recorded.trials);
    assert!(recorded.trials.median <= recorded.trials.greatest && recorded.trials.median > 0.0);
}

#[test]
fn a_model_that_does_not_take_the_robot_is_refused() {
    let error = record(
        &example("two-segment-arm.toml"),
        &[ModelVariant::usual(ModelKind::ConstantCurvature)],
        drop,
    )
    .unwrap_err();
    assert!(error.to_string().contains("constant-curvature"), "{error}");
}

#[test]
fn a_model_that_is_named_twice_is_exported_once() {
    let names = [ModelKind::FourBar, ModelKind::Cosserat, ModelKind::FourBar];
    let file = example("table1/case-3.toml");
    let recording = record(&file, &names.map(ModelVariant::usual), drop).unwrap();
    let models: Vec<_> = recording.models.iter().map(|one| one.model.as_str()).collect();
    assert_eq!(models, ["four-bar", "cosserat"]);
    assert_eq!(recording.scene.initial.models, models);
}

#[test]
fn one_page_has_all_inside_and_nothing_ends_early() {
    let page = Page {
        html: "<html><head><script type=\"module\" src=\"./viewer.js\"></script><link rel=\"stylesheet\" crossorigin href=\"./viewer.css\"></head><body></body></html>",
        script: "const a = '</script>';",
        style: "p { margin: 0 }",
    };
    let text = one_page(page, "{\"title\":\"</script><b>\"}").unwrap();
    assert!(!text.contains("src=") && !text.contains("href="));
    assert_eq!(text.matches("</script").count(), 2);
    assert!(text.contains("<style>p { margin: 0 }</style>"));
    assert!(text.contains("\\u003c/script>\\u003cb>"));
    for (part, what) in
        [("<head>", "<head>"), ("</body>", "</body>"), ("<link", "<link rel=\"stylesheet\"")]
    {
        let html = String::from(page.html).replace(part, "").leak();
        let error = one_page(Page { html, ..page }, "{}").unwrap_err();
        assert!(matches!(error, ViewError::OtherPage { what: found } if found == what), "{error}");
    }
}
