//! `--timeout`: what takes longer ends, with the reason and nothing on standard output.

use std::fs;
use std::time::{Duration, Instant};

use crate::support::{fail, root, succeed};

/// The gripping finger, two metres long: it curls up, and presses ever more disks against the ball.
fn long_finger(folder: &tempfile::TempDir) -> String {
    let text = fs::read_to_string(root().join("examples/contact/gripping-finger.toml")).unwrap();
    let path = folder.path().join("long.toml");
    fs::write(&path, text.replace("length = \"120 mm\"", "length = 2")).unwrap();
    path.to_str().unwrap().to_owned()
}

#[test]
fn a_solve_that_takes_longer_ends() {
    let folder = tempfile::tempdir().unwrap();
    let file = long_finger(&folder);
    let picture = folder.path().join("finger.svg");
    let begun = Instant::now();
    let picture_name = picture.to_str().unwrap();
    let told = fail(1, &["solve", &file, "--timeout", "300 ms", "--plot", picture_name]);
    assert!(begun.elapsed() < Duration::from_secs(20), "{:?}", begun.elapsed());
    for words in [
        "error: whipcord solve was not done after 300ms and was stopped (--timeout): ",
        "long.toml: the solve was cancelled; ",
        "; give it more time, such as --timeout 10min, or --timeout none, or ask for less",
    ] {
        assert!(told.contains(words), "{told}");
    }
    assert!(!picture.exists());
    let out = folder.path().join("bench");
    let out = out.to_str().unwrap();
    for args in [
        &["solve", file.as_str(), "--timeout", "1ms", "--json"][..],
        &["--timeout", "1ms", "solve", file.as_str(), "--trace"],
        // No flag reaches all that it solves: the process ends shortly after.
        &["bench", "--timeout", "1ms", "--out", out],
    ] {
        let told = fail(1, args);
        assert!(told.contains("was not done after 1ms"), "{told}");
    }
}

#[test]
fn without_a_limit_or_with_a_long_one_nothing_changes() {
    let file = "examples/table1/case-3.toml";
    for limit in ["none", "0", "1 h", "100"] {
        assert!(succeed(&["solve", file, "--timeout", limit]).contains("tip"), "{limit}");
    }
    let told = fail(2, &["solve", file, "--timeout", "soon"]);
    assert!(told.contains("give a time such as 30 s"), "{told}");
}

/// The solves of a comparison that were ended have no answers to compare: nothing is written of them.
#[test]
fn a_comparison_that_takes_longer_writes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let file = long_finger(&folder);
    let out = folder.path().join("report");
    let begun = Instant::now();
    let args = ["compare", &file, "--timeout", "300 ms", "--out", out.to_str().unwrap()];
    let told = fail(1, &args);
    assert!(begun.elapsed() < Duration::from_secs(20), "{:?}", begun.elapsed());
    assert!(told.contains("whipcord compare was not done after 300ms"), "{told}");
    assert!(!out.exists());
    let suite = ["compare", "--suite", "routing", "--timeout", "300 ms", "--out"];
    let told = fail(1, &[&suite[..], &[out.to_str().unwrap()]].concat());
    assert!(told.contains("not done after 300ms") && !out.exists(), "{told}");
}

/// Among obstacles a robot whose cables rub has all its steps followed before the first is told: the message names the one that was reached.
#[test]
fn a_solve_of_many_steps_says_how_far_it_came() {
    const STEPS: usize = 20_000;
    let folder = tempfile::tempdir().unwrap();
    let text = fs::read_to_string(root().join("examples/rubbing-finger.toml")).unwrap();
    let robot = text.split("[[steps]]").next().unwrap();
    let wall = "[[obstacles]]\nname = \"wall\"\nkind = \"half-space\"\nposition = [1, 0, 0]\nnormal = [-1, 0, 0]\n";
    let step = |k: usize| format!("[[steps]]\ntension = [\"{} N\"]\n", k as f64 / 1e3);
    let steps: String = (1..=STEPS).map(step).collect();
    let path = folder.path().join("steps.toml");
    fs::write(&path, [robot, wall, &steps].concat()).unwrap();
    let file = path.to_str().unwrap();
    let told = fail(1, &["solve", file, "--model", "cosserat-disks", "--timeout", "3 s"]);
    assert!(told.contains(&format!(" of {STEPS}: the solve was cancelled; ")), "{told}");
    assert!(!told.contains("step 1 of"), "{told}");
}
