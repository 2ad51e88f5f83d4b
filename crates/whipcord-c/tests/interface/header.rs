//! The header is that of the sources.

use std::path::{Path, PathBuf};

fn folder() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

/// The header that the sources give, in the order in which they are read by people.
fn generated() -> String {
    let config = cbindgen::Config::from_file(folder().join("cbindgen.toml")).unwrap();
    let mut builder = cbindgen::Builder::new().with_config(config);
    for name in [
        "version",
        "status",
        "values",
        "robot",
        "robot_abi",
        "solver",
        "solver_abi",
        "reach",
        "reach_abi",
        "simulation",
        "simulation_abi",
    ] {
        builder = builder.with_src(folder().join("src").join(name).with_extension("rs"));
    }
    let mut text = Vec::new();
    builder.generate().unwrap().write(&mut text);
    // Variants get the name of their type, but not its ending.
    String::from_utf8(text).unwrap().replace("_T_", "_")
}

#[test]
fn the_header_is_that_of_the_sources() {
    let path = folder().join("include/whipcord.h");
    let generated = generated();
    if std::env::var_os("UPDATE_HEADER").is_some() {
        std::fs::write(&path, &generated).unwrap();
    }
    let kept = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(
        kept == generated,
        "the header is out of date: UPDATE_HEADER=1 cargo test -p whipcord-c --release"
    );
}

#[test]
fn every_function_is_in_the_header() {
    let header = generated();
    let mut count = 0;
    for file in std::fs::read_dir(folder().join("src")).unwrap() {
        let text = std::fs::read_to_string(file.unwrap().path()).unwrap();
        for line in text.lines().filter(|line| line.contains("extern \"C\" fn")) {
            let name = line.split("fn ").nth(1).unwrap().split('(').next().unwrap();
            assert!(header.contains(&format!(" {name}(")) || header.contains(&format!("*{name}(")));
            count += 1;
        }
    }
    assert!(count > 40, "{count}");
}

#[test]
fn the_name_of_the_library_has_the_version_of_the_interface() {
    let text = std::fs::read_to_string(Path::new(&folder()).join("build.rs")).unwrap();
    assert!(text.contains(&format!("libwhipcord.so.{}\"", whipcord_c::ABI_VERSION)));
}
