//! Cases that the program brings along to try models on.

mod contact;
mod routing;

use whipcord::{Case, Robot, RobotError};
use whipcord_io::{Inexpressible, describe, toml};

use crate::model_benchmark::{LoadKind, Subject, Tags};
use crate::quantity::degrees;
use crate::table::{Align, Table};

/// A suite of cases.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Suite {
    /// Straight, helical, S-shaped, converging and crossing cables; 5 to 100 sections; bent by 30° to 270°;
    /// without and with a load; against a wall, a ball and in a pipe
    Routing,
}

/// A case of a suite.
#[derive(Clone, Debug)]
pub struct SuiteCase {
    /// What its file is called.
    pub stem: String,
    /// For people.
    pub title: String,
    /// The robot.
    pub robot: Robot,
    /// What is asked of it.
    pub case: Case,
    /// What it stands for.
    pub tags: Tags,
}

impl Suite {
    /// All suites.
    pub const ALL: [Self; 1] = [Self::Routing];

    /// The name on the command line and in Python.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Routing => "routing",
        }
    }

    /// What it contains.
    #[must_use]
    pub const fn description(self) -> &'static str {
        match self {
            Self::Routing => {
                "Straight, helical, S-shaped, converging and crossing cables; 5 to 100 sections; bent by 30° to 270°; without and with a load; against a wall, a ball and in a pipe"
            }
        }
    }

    /// The suite of this name.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|suite| suite.name() == name)
    }

    /// Its cases.
    ///
    /// # Errors
    /// None: the numbers are valid, as a test shows.
    pub fn cases(self) -> Result<Vec<SuiteCase>, RobotError> {
        match self {
            Self::Routing => {
                let mut cases = routing::cases()?;
                cases.extend(contact::cases()?);
                Ok(cases)
            }
        }
    }
}

impl SuiteCase {
    /// As the models are tried on it.
    pub fn subject(&self) -> Subject<'_> {
        Subject {
            title: &self.title,
            stem: &self.stem,
            robot: &self.robot,
            case: &self.case,
            measured: None,
            tags: Some(self.tags),
            known: &[],
        }
    }

    /// As a robot file.
    ///
    /// # Errors
    /// None: what a suite is made of can be written, as a test shows.
    pub fn file(&self) -> Result<String, Inexpressible> {
        Ok(toml(&describe(Some(&self.title), &self.robot, &self.case)?))
    }
}

/// Those whose names contain one of these texts, without any all of them; `None` where there is none.
pub fn only(mut cases: Vec<SuiteCase>, texts: &[String]) -> Option<Vec<SuiteCase>> {
    if !texts.is_empty() {
        cases.retain(|case| texts.iter().any(|text| case.stem.contains(text)));
    }
    (!cases.is_empty()).then_some(cases)
}

/// What the cases are, one to a line.
pub fn list(cases: &[SuiteCase]) -> Table {
    let mut table = Table::new([
        ("case", Align::Left),
        ("routing", Align::Left),
        ("sections", Align::Right),
        ("bending", Align::Right),
        ("load or obstacle", Align::Left),
    ]);
    table.group();
    for case in cases {
        table.row(vec![
            case.stem.clone(),
            case.tags.routing.to_owned(),
            (case.robot.disks().count() - 1).to_string(),
            degrees(case.tags.bending),
            match case.tags.load_kind {
                LoadKind::None => String::new(),
                load_kind => load_kind.name().to_owned(),
            },
        ]);
    }
    table
}
