//! What an export gives: files, and what they lack.

/// A file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ExportedFile {
    /// Its name, in the folder of the export, with `/` before names of files in folders.
    pub name: String,
    /// Its content.
    pub bytes: Vec<u8>,
}

/// An export.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Exported {
    /// The files. The first one is what the other program opens.
    pub files: Vec<ExportedFile>,
    /// What of this robot and case is not in them, in words.
    pub lost: Vec<String>,
}
