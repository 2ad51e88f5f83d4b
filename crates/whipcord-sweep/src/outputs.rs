//! What a data set holds of each answer.

use core::fmt;
use core::str::FromStr;

use whipcord::batch::{Batch, Solved};
use whipcord::derivatives::Place;
use whipcord::{Case, Linearization, Robot, Solution};

/// A group of columns.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Output {
    /// Position and orientation of the tip.
    Tip,
    /// Positions of all disks.
    Disks,
    /// Tensions of the cables.
    Tensions,
    /// Lengths of the cables inside the robot.
    Lengths,
    /// Whether the equilibrium is stable.
    Stability,
    /// Motion of the tip with the command of each cable.
    Jacobian,
}

impl Output {
    /// All of them.
    pub const ALL: [Self; 6] =
        [Self::Tip, Self::Disks, Self::Tensions, Self::Lengths, Self::Stability, Self::Jacobian];

    /// Its name.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Tip => "tip",
            Self::Disks => "disks",
            Self::Tensions => "tensions",
            Self::Lengths => "lengths",
            Self::Stability => "stability",
            Self::Jacobian => "jacobian",
        }
    }
}

/// No output has this name.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "`{0}` is no output: the outputs are tip, disks, tensions, lengths, stability and jacobian"
)]
pub struct UnknownOutput(pub String);

impl FromStr for Output {
    type Err = UnknownOutput;

    fn from_str(name: &str) -> Result<Self, UnknownOutput> {
        let found = Self::ALL.into_iter().find(|output| output.name() == name);
        found.ok_or_else(|| UnknownOutput(name.to_owned()))
    }
}

impl fmt::Display for Output {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// The columns of numbers that the outputs have for a robot.
#[derive(Clone, Debug)]
pub(crate) struct Columns {
    outputs: Vec<Output>,
    disks: usize,
    cables: usize,
    names: Vec<String>,
}

/// Of a pose and of a motion.
const POSE: [&str; 7] =
    ["tip_x [m]", "tip_y [m]", "tip_z [m]", "tip_qw", "tip_qx", "tip_qy", "tip_qz"];
const MOTION: [(&str, &str); 6] =
    [("x", "m"), ("y", "m"), ("z", "m"), ("rx", "rad"), ("ry", "rad"), ("rz", "rad")];

impl Columns {
    /// `is_tension` says whether the command of a cable is its tension in N; else it is its shortening in m.
    pub fn new(robot: &Robot, outputs: &[Output], is_tension: impl Fn(usize) -> bool) -> Self {
        let mut outputs = outputs.to_vec();
        outputs.sort_unstable();
        outputs.dedup();
        let cables: Vec<&str> = robot.cables().iter().map(|cable| cable.name.as_str()).collect();
        let disks = robot.disks().count();
        let mut names = Vec::new();
        for output in &outputs {
            match output {
                Output::Tip => names.extend(POSE.map(str::to_owned)),
                Output::Disks => names.extend(
                    (0..disks).flat_map(|k| ["x", "y", "z"].map(|c| format!("disk_{k}_{c} [m]"))),
                ),
                Output::Tensions => {
                    names.extend(cables.iter().map(|name| format!("{name}_tension [N]")));
                }
                Output::Lengths => {
                    names.extend(cables.iter().map(|name| format!("{name}_length [m]")));
                }
                Output::Stability => {}
                Output::Jacobian => {
                    names.extend(cables.iter().enumerate().flat_map(|(cable, name)| {
                        let by = if is_tension(cable) { "N" } else { "m" };
                        MOTION.map(|(c, unit)| format!("{name}_jacobian_{c} [{unit}/{by}]"))
                    }));
                }
            }
        }
        Self { outputs, disks, cables: cables.len(), names }
    }

    pub fn names(&self) -> &[String] {
        &self.names
    }

    pub fn outputs(&self) -> &[Output] {
        &self.outputs
    }

    pub fn has(&self, output: Output) -> bool {
        self.outputs.contains(&output)
    }

    /// Writes the numbers of a batch to the columns, each row to its place in them. The last station of the batch is the tip; where
    /// disks are asked for, its stations are the disks.
    pub fn write(&self, batch: &Batch, place: impl Fn(usize) -> usize, columns: &mut [Vec<f64>]) {
        let stations = batch.arc_lengths().len();
        let tip = stations.saturating_sub(1);
        let (positions, orientations) = (batch.positions(), batch.orientations());
        let knows_tensions = |solved: &Solved| solved.tensions;
        let mut columns = columns.iter_mut();
        // Of an array by rows with so many numbers each, those at a place of each row.
        let mut column = |array: &[f64], width: usize, at: usize| {
            if let Some(column) = columns.next() {
                for (row, value) in array.iter().skip(at).step_by(width).enumerate() {
                    column[place(row)] = *value;
                }
            }
        };
        for output in &self.outputs {
            match output {
                Output::Tip => {
                    (0..3).for_each(|k| column(positions, 3 * stations, 3 * tip + k));
                    (0..4).for_each(|k| column(orientations, 4 * stations, 4 * tip + k));
                }
                Output::Disks => {
                    (0..3 * stations).for_each(|k| column(positions, 3 * stations, k));
                }
                Output::Tensions => {
                    let known = batch.outcomes().iter().flatten().all(knows_tensions);
                    let tensions = if known { batch.tensions() } else { &[] };
                    (0..self.cables).for_each(|k| column(tensions, self.cables, k));
                }
                Output::Lengths => {
                    (0..self.cables).for_each(|k| column(batch.lengths(), self.cables, k));
                }
                Output::Stability | Output::Jacobian => {}
            }
        }
    }

    /// Adds the numbers of an answer. `None` where it is that of a robot with another number of disks or cables than the columns are for.
    pub fn push_solution(
        &self,
        case: &Case,
        solution: &Solution,
        rates: Option<&Linearization>,
        out: &mut Vec<f64>,
    ) -> Option<()> {
        let poses = &solution.disks.poses;
        let tip = solution.disks.tip();
        let has_disks = self.has(Output::Disks);
        if solution.cables.len() != self.cables || (has_disks && poses.len() != self.disks) {
            return None;
        }
        for output in &self.outputs {
            match output {
                Output::Tip => {
                    out.extend(tip.position.to_array());
                    out.extend(tip.rotation.wxyz());
                }
                Output::Disks => out.extend(poses.iter().flat_map(|pose| pose.position.to_array())),
                Output::Tensions => out
                    .extend(solution.cables.iter().map(|cable| cable.tension.unwrap_or(f64::NAN))),
                Output::Lengths => out.extend(solution.cables.iter().map(|cable| cable.length)),
                Output::Stability => {}
                Output::Jacobian => {
                    let turn = case.base.rotation;
                    for change in rates?.commands() {
                        let of = change.twist(Place::Tip);
                        out.extend(turn.rotate(of.linear).to_array());
                        out.extend(turn.rotate(of.angular).to_array());
                    }
                }
            }
        }
        Some(())
    }
}
