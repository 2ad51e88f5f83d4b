//! The shapes that inverse problems start from, in a file that one run keeps for the next.

use std::path::{Path, PathBuf};

use thiserror::Error;
use whipcord::{Pose, UnitQuaternion, Vec3};
use whipcord_inverse::{AtlasRows, InverseError, InverseSolver};

use crate::files;
use crate::output::{Column, Values, columns_to_parquet, write_atomically};
use crate::read::{TableColumn, table_columns};

/// The most columns of an atlas: a robot of a thousand disks.
const MOST_COLUMNS: usize = 4000;

/// The column that says of what robot, model, load and limits an atlas is.
const IDENTITY: &str = "atlas";
/// Names of the orientation of the tip.
const ORIENTATION: [&str; 4] = ["qw", "qx", "qy", "qz"];

/// Name of the column of a command, by its number from 0.
fn command(number: usize) -> String {
    format!("command {}", number + 1)
}

/// Name of a column of the positions of a disk, by its number from 0.
fn position(disk: usize, axis: usize) -> String {
    format!("{} of disk {} [m]", ["x", "y", "z"][axis], disk + 1)
}

/// An atlas as the bytes of a Parquet file, a shape in each row: the commands in N, m or rad, the positions of the disks in m, the last of which is the tip, and its
/// orientation.
#[must_use]
pub fn atlas_to_parquet(atlas: &AtlasRows) -> Vec<u8> {
    let AtlasRows { identity, width, disk_count, commands, tips, disks } = atlas;
    let column = |name: String, values: Vec<f64>| Column { name, values: Values::Numbers(values) };
    let identity = Values::Integers(vec![Some(identity.cast_signed()); tips.len()]);
    let mut columns = vec![Column { name: IDENTITY.to_owned(), values: identity }];
    columns.extend((0..*width).map(|number| {
        let values = commands.chunks_exact(*width).map(|row| row[number]).collect();
        column(command(number), values)
    }));
    for disk in 0..*disk_count {
        columns.extend((0..3).map(|axis| {
            let values = disks.chunks_exact(*disk_count).map(|row| row[disk][axis]).collect();
            column(position(disk, axis), values)
        }));
    }
    columns.extend(ORIENTATION.iter().enumerate().map(|(k, name)| {
        column((*name).to_owned(), tips.iter().map(|tip| tip.rotation.wxyz()[k]).collect())
    }));
    columns_to_parquet(&columns)
}

/// Why a file is not read as an atlas.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum AtlasFileError {
    /// The shapes cannot be computed.
    #[error(transparent)]
    Shapes(#[from] InverseError),
    /// The operating system does not take it.
    #[error("cannot write the atlas {}: {reason}", path.display())]
    Unwritable {
        /// The file.
        path: PathBuf,
        /// What the operating system says.
        reason: String,
    },
    /// The operating system does not give it.
    #[error("cannot read the atlas {}: {reason}", path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// What the operating system says.
        reason: String,
    },
    /// It is something else, which is not to be overwritten.
    #[error(
        "{} is there, but is no atlas ({why}): give another name, or remove the file",
        path.display()
    )]
    NoAtlas {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        why: String,
    },
}

/// Gives a solver the shapes that a file has kept for it. Where there is no file yet, or one of another robot, model, load or limit, they are computed and kept there.
///
/// # Errors
/// [`AtlasFileError`] where the shapes cannot be computed, and where the file is something else, cannot be read or cannot be written.
pub fn start_from_atlas(solver: &mut InverseSolver, path: &Path) -> Result<(), AtlasFileError> {
    if let Some(atlas) = load_atlas(path, solver.atlas_identity())?
        && solver.set_atlas(atlas).is_ok()
    {
        return Ok(());
    }
    let bytes = atlas_to_parquet(solver.atlas()?);
    write_atomically(path, &bytes).map_err(|error| AtlasFileError::Unwritable {
        path: path.to_owned(),
        reason: files::reason(&error),
    })
}

/// The atlas that a file has, if it is the one of this identity ([`whipcord_inverse::InverseSolver::atlas_identity`]); `None` where there is no file yet, or one of another
/// robot, model, load or limit, which may be overwritten.
///
/// # Errors
/// [`AtlasFileError`] where the file cannot be read, and where it is no atlas.
pub fn load_atlas(path: &Path, identity: u64) -> Result<Option<AtlasRows>, AtlasFileError> {
    let no_atlas = |why: String| AtlasFileError::NoAtlas { path: path.to_owned(), why };
    let unreadable = |reason| AtlasFileError::Unreadable { path: path.to_owned(), reason };
    let Some(bytes) = files::read_atlas(path).map_err(unreadable)? else { return Ok(None) };
    let columns = table_columns(bytes, MOST_COLUMNS).map_err(no_atlas)?;
    let found = of_columns(&columns).ok_or_else(|| {
        no_atlas("its columns are not those of an atlas, or a number is missing".to_owned())
    })?;
    Ok((found.identity == identity).then_some(found))
}

fn of_columns(columns: &[(String, TableColumn)]) -> Option<AtlasRows> {
    let values =
        |name: &str| columns.iter().find(|(known, _)| known == name).map(|(_, values)| values);
    let numbers = |name: &str| match values(name)? {
        TableColumn::Numbers(values) => Some(values),
        _ => None,
    };
    let TableColumn::Integers(identities) = values(IDENTITY)? else { return None };
    let first = *identities.first()?;
    if identities.iter().any(|other| *other != first) {
        return None;
    }
    let commands: Vec<&Vec<f64>> = (0..).map_while(|k| numbers(&command(k))).collect();
    let disks: Vec<[&Vec<f64>; 3]> = (0..)
        .map_while(|disk| {
            let [x, y, z] = [0, 1, 2].map(|axis| numbers(&position(disk, axis)));
            Some([x?, y?, z?])
        })
        .collect();
    let [w, i, j, k] = ORIENTATION.map(&numbers);
    let orientation = [w?, i?, j?, k?];
    let count = identities.len();
    let [x, y, z] = *disks.last()?;
    let mut atlas = AtlasRows {
        identity: first.cast_unsigned(),
        width: commands.len(),
        disk_count: disks.len(),
        ..AtlasRows::default()
    };
    for row in 0..count {
        for column in &commands {
            atlas.commands.push(*column.get(row)?);
        }
        for columns in &disks {
            let [x, y, z] = columns.map(|column| column.get(row).copied());
            atlas.disks.push([x?, y?, z?]);
        }
        let position = Vec3::new(*x.get(row)?, *y.get(row)?, *z.get(row)?);
        let [w, i, j, k] = orientation.map(|column| column.get(row).copied());
        let rotation = UnitQuaternion::from_wxyz([w?, i?, j?, k?])?;
        atlas.tips.push(Pose { position, rotation });
    }
    Some(atlas)
}
