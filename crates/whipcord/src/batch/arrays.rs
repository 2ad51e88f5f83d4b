use super::error::BatchError;
use crate::error::SolveError;
use crate::solution::{Diagnostics, Solution};

/// Where the numbers of a batch go, each array row after row. A row without an answer holds NaN, and its error.
#[derive(Debug)]
pub struct Arrays<'a> {
    /// Rows × stations × 3: positions in m, in the frame that the pose of the base is given in.
    pub positions: &'a mut [f64],
    /// Rows × stations × 4: orientations as quaternions (w, x, y, z).
    pub orientations: &'a mut [f64],
    /// Rows × cables: tensions in N; zero from a model that knows no forces.
    pub tensions: &'a mut [f64],
    /// Rows × cables: lengths in m of the cables' paths inside the robot.
    pub lengths: &'a mut [f64],
}

impl<'a> Arrays<'a> {
    pub(super) fn check(
        &self,
        rows: usize,
        stations: usize,
        cables: usize,
    ) -> Result<(), BatchError> {
        let sizes = [
            ("positions", self.positions.len(), rows * stations * 3),
            ("orientations", self.orientations.len(), rows * stations * 4),
            ("tensions", self.tensions.len(), rows * cables),
            ("lengths", self.lengths.len(), rows * cables),
        ];
        match sizes.into_iter().find(|(_, given, needed)| given != needed) {
            None => Ok(()),
            Some((name, given, needed)) => Err(BatchError::Size { name, given, needed }),
        }
    }

    /// The arrays of the first so many rows, and of the rest.
    pub(super) fn split_at(self, rows: usize, (stations, cables): (usize, usize)) -> (Self, Self) {
        let (positions, positions_after) = self.positions.split_at_mut(rows * stations * 3);
        let (orientations, orientations_after) =
            self.orientations.split_at_mut(rows * stations * 4);
        let (tensions, tensions_after) = self.tensions.split_at_mut(rows * cables);
        let (lengths, lengths_after) = self.lengths.split_at_mut(rows * cables);
        (
            Self { positions, orientations, tensions, lengths },
            Self {
                positions: positions_after,
                orientations: orientations_after,
                tensions: tensions_after,
                lengths: lengths_after,
            },
        )
    }

    /// The arrays of one row.
    pub(super) fn row(&mut self, row: usize, (stations, cables): (usize, usize)) -> Arrays<'_> {
        let of = |width: usize| row * width..(row + 1) * width;
        Arrays {
            positions: &mut self.positions[of(stations * 3)],
            orientations: &mut self.orientations[of(stations * 4)],
            tensions: &mut self.tensions[of(cables)],
            lengths: &mut self.lengths[of(cables)],
        }
    }

    pub(super) fn write(&mut self, row: usize, sizes: (usize, usize), solution: &Solution) {
        let to = self.row(row, sizes);
        let (positions, _) = to.positions.as_chunks_mut::<3>();
        let (orientations, _) = to.orientations.as_chunks_mut::<4>();
        for ((pose, position), orientation) in
            solution.shape.poses.iter().zip(positions).zip(orientations)
        {
            *position = pose.position.to_array();
            *orientation = pose.rotation.wxyz();
        }
        for ((cable, tension), length) in solution.cables.iter().zip(to.tensions).zip(to.lengths) {
            *tension = cable.tension.unwrap_or(0.0);
            *length = cable.length;
        }
    }

    /// A row without an answer holds no numbers that could be taken for one: zero would be a point at the base.
    pub(super) fn clear(&mut self, row: usize, sizes: (usize, usize)) {
        let Arrays { positions, orientations, tensions, lengths } = self.row(row, sizes);
        for array in [positions, orientations, tensions, lengths] {
            array.fill(f64::NAN);
        }
    }
}

/// The answers to a batch, as a structure of arrays. Two are equal that have the same numbers, NaN at the same places.
#[derive(Clone, Debug)]
pub struct Batch {
    arc_lengths: Vec<f64>,
    cables: usize,
    positions: Vec<f64>,
    orientations: Vec<f64>,
    tensions: Vec<f64>,
    lengths: Vec<f64>,
    outcomes: Vec<Result<Solved, SolveError>>,
}

impl PartialEq for Batch {
    fn eq(&self, other: &Self) -> bool {
        let same = |(a, b): (&f64, &f64)| a == b || (a.is_nan() && b.is_nan());
        self.cables == other.cables
            && self.outcomes == other.outcomes
            && [
                (&self.arc_lengths, &other.arc_lengths),
                (&self.positions, &other.positions),
                (&self.orientations, &other.orientations),
                (&self.tensions, &other.tensions),
                (&self.lengths, &other.lengths),
            ]
            .into_iter()
            .all(|(mine, others)| mine.len() == others.len() && mine.iter().zip(others).all(same))
    }
}

/// How a row was solved.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Solved {
    /// Of the solve.
    pub diagnostics: Diagnostics,
    /// Whether the model knows the tensions.
    pub tensions: bool,
}

impl Solved {
    /// Whether the equilibrium is stable; `None` where that is not known ([`Diagnostics::stable`]).
    #[must_use]
    pub fn is_stable(&self) -> Option<bool> {
        self.diagnostics.stable
    }

    /// Whether the answer is an equilibrium that the robot leaves at the slightest disturbance.
    #[must_use]
    pub fn is_unstable(&self) -> bool {
        self.diagnostics.is_unstable()
    }
}

/// The answer of one row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row<'a> {
    /// Stations × 3: positions in m.
    pub positions: &'a [f64],
    /// Stations × 4: orientations (w, x, y, z).
    pub orientations: &'a [f64],
    /// Tension of each cable in N; `None` from a model that knows no forces.
    pub tensions: Option<&'a [f64]>,
    /// Length of each cable's path inside the robot in m.
    pub lengths: &'a [f64],
    /// How it was solved.
    pub diagnostics: &'a Diagnostics,
}

impl Row<'_> {
    /// Position of a station in m.
    ///
    /// # Panics
    /// When there is no such station, as indexing does.
    #[must_use]
    pub fn position(&self, station: usize) -> [f64; 3] {
        let p = &self.positions[3 * station..3 * station + 3];
        [p[0], p[1], p[2]]
    }
}

impl Batch {
    pub(super) fn new(rows: usize, arc_lengths: Vec<f64>, cables: usize) -> Self {
        let stations = arc_lengths.len();
        Self {
            arc_lengths,
            cables,
            positions: vec![0.0; rows * stations * 3],
            orientations: vec![0.0; rows * stations * 4],
            tensions: vec![0.0; rows * cables],
            lengths: vec![0.0; rows * cables],
            outcomes: vec![Ok(Solved::default()); rows],
        }
    }

    pub(super) fn parts(&mut self) -> (Arrays<'_>, &mut [Result<Solved, SolveError>]) {
        let arrays = Arrays {
            positions: &mut self.positions,
            orientations: &mut self.orientations,
            tensions: &mut self.tensions,
            lengths: &mut self.lengths,
        };
        (arrays, &mut self.outcomes)
    }

    /// Number of rows.
    #[must_use]
    pub fn len(&self) -> usize {
        self.outcomes.len()
    }

    /// Whether there is no row.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.outcomes.is_empty()
    }

    /// Arc length of each station in m.
    #[must_use]
    pub fn arc_lengths(&self) -> &[f64] {
        &self.arc_lengths
    }

    /// Rows × stations × 3: positions in m; NaN in a row without an answer.
    #[must_use]
    pub fn positions(&self) -> &[f64] {
        &self.positions
    }

    /// Rows × stations × 4: orientations (w, x, y, z); NaN in a row without an answer.
    #[must_use]
    pub fn orientations(&self) -> &[f64] {
        &self.orientations
    }

    /// Rows × cables: tensions in N; NaN in a row without an answer, zeros where the model knows no
    /// forces ([`Solved::tensions`]).
    #[must_use]
    pub fn tensions(&self) -> &[f64] {
        &self.tensions
    }

    /// Rows × cables: lengths in m; NaN in a row without an answer.
    #[must_use]
    pub fn lengths(&self) -> &[f64] {
        &self.lengths
    }

    /// For each row how it was solved, or why it was not.
    pub fn outcomes(&self) -> &[Result<Solved, SolveError>] {
        &self.outcomes
    }

    /// Numbers of the rows whose answer is an unstable equilibrium, which the robot leaves at the slightest
    /// disturbance. They count as answers.
    pub fn unstable(&self) -> impl Iterator<Item = usize> + '_ {
        let rows = self.outcomes.iter().enumerate();
        rows.filter(|(_, row)| row.as_ref().is_ok_and(Solved::is_unstable)).map(|(row, _)| row)
    }

    /// The answer of a row, or why there is none; `None` when there is no such row.
    #[must_use]
    pub fn row(&self, row: usize) -> Option<Result<Row<'_>, &SolveError>> {
        let outcome = self.outcomes.get(row)?;
        let of = |width: usize| row * width..(row + 1) * width;
        let stations = self.arc_lengths.len();
        Some(outcome.as_ref().map(|solved| Row {
            positions: &self.positions[of(3 * stations)],
            orientations: &self.orientations[of(4 * stations)],
            tensions: solved.tensions.then(|| &self.tensions[of(self.cables)]),
            lengths: &self.lengths[of(self.cables)],
            diagnostics: &solved.diagnostics,
        }))
    }
}
