//! Embeds the page where it has been built.

use std::path::Path;
use std::{env, fs};

/// The files of the page, as `npm run build` makes them.
const FILES: [&str; 3] = ["index.html", "viewer.js", "viewer.css"];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = Path::new(&env::var("CARGO_MANIFEST_DIR")?).join("page/dist");
    println!("cargo::rerun-if-changed=page/dist");
    println!("cargo::rerun-if-changed=build.rs");
    let [html, script, style] = FILES.map(|name| folder.join(name));
    let page = if html.is_file() && script.is_file() && style.is_file() {
        format!(
            "Some(Page {{ html: include_str!({html:?}), script: include_str!({script:?}), style: include_str!({style:?}) }})"
        )
    } else {
        "None".to_owned()
    };
    fs::write(Path::new(&env::var("OUT_DIR")?).join("page.rs"), page)?;
    Ok(())
}
