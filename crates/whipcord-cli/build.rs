//! Embeds the files of `examples/`.
//!
//! This folder is in the root of the repository. `examples` beside this file is a symbolic link to it; packages of this crate
//! and source distributions of the Python package contain a folder instead. In a checkout without symbolic links, as on
//! Windows, the link is a text file, and the script uses the folder in the root.

use std::path::{Path, PathBuf};
use std::{env, fs, io};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    println!("cargo::rerun-if-changed=build.rs");
    let here = PathBuf::from(env::var("CARGO_MANIFEST_DIR")?);
    let places = [here.join("examples"), here.join("..").join("..").join("examples")];
    let folder = places.iter().find(|place| place.is_dir());
    let folder = folder.ok_or_else(|| format!("there is no folder {}", places[0].display()))?;
    let mut files = Vec::new();
    find(folder, "", &mut files)?;
    files.sort();
    let mut list = String::from("&[\n");
    for (name, path) in files {
        list += &format!("Example {{ name: {name:?}, content: include_bytes!({path:?}) }},\n");
    }
    list += "]";
    fs::write(Path::new(&env::var("OUT_DIR")?).join("examples.rs"), list)?;
    Ok(())
}

/// Collects the files of a folder and of its subfolders, with their relative paths.
fn find(folder: &Path, prefix: &str, files: &mut Vec<(String, PathBuf)>) -> io::Result<()> {
    println!("cargo::rerun-if-changed={}", folder.display());
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        let Some(name) = path.file_name().and_then(|name| name.to_str()) else { continue };
        let is_example = Path::new(name)
            .extension()
            .is_some_and(|kind| ["toml", "csv", "stl", "obj"].iter().any(|known| kind == *known));
        let name = format!("{prefix}{name}");
        if path.is_dir() {
            find(&path, &format!("{name}/"), files)?;
        } else if is_example {
            println!("cargo::rerun-if-changed={}", path.display());
            files.push((name, path));
        }
    }
    Ok(())
}
