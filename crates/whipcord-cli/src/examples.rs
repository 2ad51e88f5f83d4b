//! The files of `examples/`, embedded in the program.

/// An example file.
#[derive(Clone, Copy, Debug)]
pub struct Example {
    /// Its path in the folder, with slashes.
    pub name: &'static str,
    /// Its content.
    pub content: &'static [u8],
}

/// All example files in alphabetical order: robot files, and the meshes that they name.
pub static EXAMPLES: &[Example] = include!(concat!(env!("OUT_DIR"), "/examples.rs"));

impl Example {
    /// The title of a robot file; `None` for other files.
    pub fn title(&self) -> Option<&'static str> {
        let text = core::str::from_utf8(self.content).ok()?;
        text.lines().find_map(|line| line.strip_prefix("title = \"")?.strip_suffix('"'))
    }
}
