//! The manifest of a data set: what it is of, and how it was made.

use std::path::Path;
use std::{fs, io};

use serde_json::{Value, json};
use sha2::{Digest, Sha256};
use whipcord::Cancel;
use whipcord_io::{describe, toml, write_atomically};

use crate::error::SweepError;
use crate::plan::Plan;
use crate::samples::Sampling;

/// The name of the manifest in the folder of a data set.
pub const MANIFEST: &str = "manifest.json";
/// The version of the format of manifest and parts.
const FORMAT: u64 = 1;

impl Plan {
    /// The manifest.
    #[must_use]
    pub fn manifest(&self) -> Value {
        let axes = self.samples.axes().iter();
        let sampling = self.samples.sampling();
        let table = match sampling {
            Sampling::Table { values } => {
                let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
                Some(hash(&bytes))
            }
            _ => None,
        };
        let file = &self.file;
        let robot = match describe(Some(&file.title), &file.robot, &file.case) {
            Ok(described) => toml(&described),
            // What a robot file cannot express, such as a backbone from a program, has no text.
            Err(_) => format!("{:?}", self.file.robot),
        };
        let mut manifest = json!({
            "format": "whipcord sweep",
            "format_version": FORMAT,
            "version": env!("CARGO_PKG_VERSION"),
            "title": self.file.title,
            "model": self.model.kind().name(),
            "model_options": format!("{:?}", self.model.cancelled_by(&Cancel::default())),
            "robot": robot,
            "vary": axes.map(ToString::to_string).collect::<Vec<_>>(),
            "sampling": sampling.name(),
            "seed": sampling.seed(),
            "table_sha256": table,
            "outputs": self.columns.outputs().iter().map(|of| of.name()).collect::<Vec<_>>(),
            "columns": self.column_names(),
            "rows": self.rows(),
            "rows_per_part": self.rows_per_part(),
            "parts": self.parts(),
        });
        manifest["sha256"] = hash(manifest.to_string().as_bytes()).into();
        manifest
    }
}

fn hash(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect()
}

/// Writes the manifest to a folder, or finds that the folder is for this data set; says whether it was there.
///
/// # Errors
/// [`SweepError::Another`] where it is for another one.
pub(crate) fn claim(folder: &Path, manifest: &Value) -> Result<bool, SweepError> {
    let path = folder.join(MANIFEST);
    let write = |source| SweepError::Write { path: path.clone(), source };
    let text = match fs::read_to_string(&path) {
        Ok(text) => text,
        Err(error) if error.kind() == io::ErrorKind::NotFound => {
            write_atomically(&path, format!("{manifest:#}\n").as_bytes()).map_err(write)?;
            return Ok(false);
        }
        Err(error) => return Err(write(error)),
    };
    let known: Value = serde_json::from_str(&text)
        .map_err(|error| SweepError::Manifest { path: path.clone(), reason: error.to_string() })?;
    let keys = manifest.as_object().into_iter().flat_map(|object| object.keys());
    let differs: Vec<&str> = keys
        .filter(|key| *key != "sha256" && known.get(key.as_str()) != manifest.get(key.as_str()))
        .map(String::as_str)
        .collect();
    if differs.is_empty() {
        return Ok(true);
    }
    Err(SweepError::Another { folder: folder.to_owned(), differs: differs.join(", ") })
}
