//! The arrows between the crates, and what the mechanics must not reach for.

#![allow(clippy::expect_used, clippy::unwrap_used, reason = "a test fails by panicking")]

mod modules;

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

/// What each crate may depend on, among the crates of the workspace.
const ALLOWED: [(&str, &[&str]); 16] = [
    ("whipcord-numerics", &[]),
    ("whipcord", &["whipcord-numerics"]),
    ("whipcord-estimation", &["whipcord", "whipcord-numerics"]),
    ("whipcord-inverse", &["whipcord", "whipcord-numerics"]),
    ("whipcord-motion", &["whipcord", "whipcord-numerics"]),
    ("whipcord-design", &["whipcord", "whipcord-numerics"]),
    (
        "whipcord-io",
        &[
            "whipcord",
            "whipcord-design",
            "whipcord-estimation",
            "whipcord-inverse",
            "whipcord-motion",
        ],
    ),
    ("whipcord-plot", &["whipcord", "whipcord-estimation", "whipcord-inverse"]),
    ("whipcord-vision", &["whipcord", "whipcord-estimation", "whipcord-numerics"]),
    (
        "whipcord-viewer",
        &[
            "whipcord",
            "whipcord-design",
            "whipcord-estimation",
            "whipcord-inverse",
            "whipcord-io",
            "whipcord-motion",
            "whipcord-plot",
        ],
    ),
    (
        "whipcord-study",
        &["whipcord", "whipcord-estimation", "whipcord-inverse", "whipcord-io", "whipcord-plot"],
    ),
    ("whipcord-c", &["whipcord", "whipcord-inverse", "whipcord-io", "whipcord-motion"]),
    ("whipcord-sweep", &["whipcord", "whipcord-io", "whipcord-numerics"]),
    ("whipcord-export", &["whipcord", "whipcord-motion", "whipcord-numerics", "whipcord-plot"]),
    (
        "whipcord-cli",
        &[
            "whipcord",
            "whipcord-estimation",
            "whipcord-inverse",
            "whipcord-motion",
            "whipcord-design",
            "whipcord-export",
            "whipcord-io",
            "whipcord-plot",
            "whipcord-study",
            "whipcord-sweep",
            "whipcord-vision",
            "whipcord-viewer",
        ],
    ),
    (
        // Of the command line the extension module takes the command itself and the examples in it, no results.
        "whipcord-py",
        &[
            "whipcord",
            "whipcord-estimation",
            "whipcord-inverse",
            "whipcord-motion",
            "whipcord-design",
            "whipcord-export",
            "whipcord-io",
            "whipcord-plot",
            "whipcord-study",
            "whipcord-sweep",
            "whipcord-vision",
            "whipcord-cli",
        ],
    ),
];

/// Modules of the standard library that bind a crate to an operating system.
const FORBIDDEN: [&str; 8] = ["fs", "thread", "time", "net", "process", "env", "path", "os"];

fn workspace_root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn metadata() -> Value {
    let output = Command::new(env!("CARGO"))
        .args(["metadata", "--no-deps", "--offline", "--format-version", "1"])
        .current_dir(workspace_root())
        .output()
        .expect("cargo runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("cargo writes JSON")
}

#[test]
fn dependencies_run_one_way() {
    let metadata = metadata();
    let packages = metadata["packages"].as_array().unwrap();
    let names: BTreeSet<&str> = packages.iter().map(|p| p["name"].as_str().unwrap()).collect();
    let allowed: BTreeMap<_, _> = ALLOWED.into_iter().collect();
    for package in packages {
        let name = package["name"].as_str().unwrap();
        let may = allowed.get(name).unwrap_or_else(|| panic!("say what {name} may depend on"));
        for dependency in package["dependencies"].as_array().unwrap() {
            // What only tests need does not bind who uses the crate.
            if dependency["kind"].as_str() == Some("dev") {
                continue;
            }
            let on = dependency["name"].as_str().unwrap();
            assert!(!names.contains(on) || may.contains(&on), "{name} must not depend on {on}");
        }
    }
}

#[test]
fn the_mechanics_reach_for_no_operating_system() {
    for name in [
        "whipcord-numerics",
        "whipcord",
        "whipcord-estimation",
        "whipcord-inverse",
        "whipcord-motion",
        "whipcord-design",
    ] {
        let mut files = Vec::new();
        rust_files(&workspace_root().join("crates").join(name).join("src"), &mut files);
        assert!(!files.is_empty());
        for file in files {
            let text = std::fs::read_to_string(&file).unwrap();
            for module in FORBIDDEN {
                let found = text.contains(&format!("std::{module}"));
                assert!(!found, "{} uses std::{module}", file.display());
            }
            assert!(!text.contains("use std::{"), "{}: one `use` for each module", file.display());
        }
    }
}

fn rust_files(folder: &Path, files: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            rust_files(&path, files);
        } else if path.extension().is_some_and(|e| e == "rs") {
            files.push(path);
        }
    }
}
