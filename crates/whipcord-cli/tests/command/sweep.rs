//! `whipcord sweep`.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::thread;
use std::time::{Duration, Instant};

use serde_json::Value;

use crate::support::{Scratch, command, fail, settings, succeed};

const THREE: &str = "examples/three-cable-segment.toml";

/// Names of the parts in a folder, which may not exist yet.
fn names(folder: &Path) -> Vec<String> {
    let Ok(entries) = fs::read_dir(folder) else { return Vec::new() };
    let all = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap());
    all.filter(|name| name.ends_with(".parquet")).collect()
}

fn parts(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let with_bytes = |name: String| {
        let bytes = fs::read(folder.join(&name)).unwrap();
        (name, bytes)
    };
    names(folder).into_iter().map(with_bytes).collect()
}

#[test]
fn a_grid_is_written_with_its_manifest() {
    let scratch = Scratch::new();
    let out = scratch.file("out");
    let vary = ["--vary", "cables.a.tension=0 N:3 N:4", "--vary", "cables.b.tension=0 N,2 N"];
    let args =
        [&["sweep", THREE], &vary[..], &["--outputs", "tip,stability", "--out", &out]].concat();
    settings(Some(scratch.path())).bind(|| insta::assert_snapshot!("sweep", succeed(&args)));
    let manifest = fs::read_to_string(scratch.path().join("out/manifest.json")).unwrap();
    let manifest: Value = serde_json::from_str(&manifest).unwrap();
    assert_eq!(manifest["rows"], 8);
    assert_eq!(manifest["columns"][1], "cables.a.tension [N]");
    let again = fail(2, &args);
    assert!(again.contains("--resume"), "{again}");
    let json: Value =
        serde_json::from_str(&succeed(&[&args[..], &["--resume", "--json"]].concat())).unwrap();
    assert_eq!(json["kept_parts"], 1);
}

#[test]
fn a_table_gives_the_rows() {
    let scratch = Scratch::new();
    let table = scratch.file("rows.csv");
    fs::write(&table, "cables.a.tension [N],cables.b.tension [N]\n1,2\n0.5,x\n").unwrap();
    let out = scratch.file("out");
    let args = ["sweep", THREE, "--table", &table, "--out", &out];
    let message = fail(2, &args);
    assert!(
        message.contains("rows.csv:3:5") && message.contains("`x` is no finite number"),
        "{message}"
    );
    fs::write(&table, "cables.a.tension [N],cables.b.tension [N]\n1,2\n0.5,1\n").unwrap();
    assert!(succeed(&args).starts_with("2 rows in 1 parts"));
}

#[test]
fn what_is_wrong_with_the_arguments_is_said() {
    let scratch = Scratch::new();
    let out = scratch.file("out");
    let with = |more: &[&str]| fail(2, &[&["sweep", THREE, "--out", &out], more].concat());
    assert!(with(&[]).contains("nothing varies"));
    assert!(with(&["--vary", "cables.a.tension"]).contains("PATH=FIRST:LAST:COUNT"));
    assert!(with(&["--vary", "cables.a.tension=0 N:1 N"]).contains("--samples"));
    assert!(with(&["--vary", "cables.z.tension=0 N:1 N:2"]).contains("cables.z.tension"));
    assert!(
        with(&["--vary", "cables.a.tension=0 N:1 N:2", "--shard", "3/2"])
            .contains("no shard 3 of 2")
    );
    assert!(
        with(&["--vary", "cables.a.tension=0 N:1 N:2", "--outputs", "colour"]).contains("jacobian")
    );
}

/// A process that is killed leaves whole parts, and the rest is made up for.
#[test]
fn a_process_that_is_killed_leaves_whole_parts() {
    let scratch = Scratch::new();
    let (out, whole) = (scratch.file("killed"), scratch.file("whole"));
    let args = |out| {
        let vary = ["--vary", "cables.a.tension=0 N:3 N", "--vary", "cables.b.tension=0 N:3 N"];
        let more =
            ["--samples", "4000", "--sampling", "sobol", "--rows-per-part", "50", "--out", out];
        [&["sweep", THREE], &vary[..], &more[..]].concat()
    };
    succeed(&args(&whole));
    let folder = scratch.path().join("killed");
    let mut child = command(&args(&out)).spawn().unwrap();
    let begun = Instant::now();
    // Threads write parts in any order.
    while names(&folder).len() < 3 {
        assert!(begun.elapsed() < Duration::from_secs(60), "no three parts were written");
        thread::sleep(Duration::from_millis(1));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    let whole = parts(&scratch.path().join("whole"));
    let left = parts(&folder);
    assert!(left.len() >= 3);
    assert!(left.iter().all(|(name, bytes)| whole[name] == *bytes));
    succeed(&[&args(&out)[..], &["--resume"]].concat());
    assert_eq!(parts(&folder), whole);
}
