//! Sweeps: data sets of many shapes of one robot, whose commands, loads or other keys of its file vary.
//!
//! A [`Plan`] numbers all rows; the values of each follow from its number ([`Sampling`]), so that parts of the data set can be made in any
//! order, by any number of processes on any number of machines ([`RunOptions::shard`]), to the same bits. [`run`] writes each part
//! whole or not at all, as a Parquet file, beside a manifest that says what the data set is.
//!
//! Rows that vary commands and loads alone are solved in batches ([`whipcord::batch`]). For any other key the file is read again with it,
//! as `--set` of the command line does. A row without an answer has nulls for numbers and says why in the column `error`.
//!
//! ```
//! use whipcord::{Actuation, Model, ModelKind, Stations};
//! use whipcord_sweep::{Output, Plan, Question, RunOptions, Sampling, run};
//!
//! let text = r#"
//! [backbone]
//! length = "100 mm"
//! diameter = "1 mm"
//! young_modulus = "60 GPa"
//! poisson_ratio = 0.3
//! [disks]
//! count = 6
//! outer_radius = "8 mm"
//! [[cables]]
//! name = "pull"
//! routing = { kind = "straight", angle = "0 deg", radius = "5 mm" }
//! tension = "1 N"
//! "#;
//! let file = whipcord_io::parse(text, "robot.toml")?;
//! let model = Model::new(ModelKind::Cosserat, Stations::Disks, Actuation::Natural);
//! let question = Question {
//!     axes: vec!["cables.pull.tension=0 N:2 N:5".parse()?, "backbone.diameter=1 mm,1.2 mm".parse()?],
//!     sampling: Sampling::Grid,
//!     outputs: vec![Output::Tip],
//!     rows_per_part: None,
//! };
//! let plan = Plan::new(&file, &model, &question)?;
//! assert_eq!(plan.rows(), 10);
//! let folder = tempfile::tempdir()?;
//! let summary = run(&plan, folder.path(), &RunOptions::default())?;
//! assert_eq!((summary.rows, summary.failed), (10, 0));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod axis;
mod error;
mod manifest;
mod outputs;
mod permutation;
mod plan;
mod run;
mod samples;
mod setter;
mod solve;

pub use axis::{Axis, AxisError, AxisValues};
pub use error::SweepError;
pub use manifest::MANIFEST;
pub use outputs::{Output, UnknownOutput};
pub use plan::{Plan, Question};
pub use run::{RunOptions, Summary, part_name, run};
pub use samples::{MOST_ROWS, Sampling};
