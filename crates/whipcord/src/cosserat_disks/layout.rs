//! The robot cut at its disks: spans of the backbone, and the cables' straight pieces in them.

use core::ops::Range;

use whipcord_numerics::{Pose, magnus_6};

use super::friction::Holes;
use super::repeated_spans::{self, RepeatedSpan};
use super::span::Chord;
use crate::case::Loads;
use crate::derivatives::StraightSpan;
use crate::error::SolveError;
use crate::kind::ModelKind;
use crate::robot::Robot;
use crate::statics::grid::{Grid, Layout};
use crate::statics::passages::{Passage, passages_to_disks};
use crate::statics::scales::Scales;

/// What lies between two neighbouring disks.
#[derive(Clone, Debug)]
pub(super) struct Span {
    /// Arc length of the disk nearer the base in m.
    pub start: f64,
    pub passages: Vec<Passage>,
    /// Number of the first passage among those of all spans.
    pub first: usize,
}

/// What does not depend on how finely the spans are integrated.
#[derive(Clone, Debug)]
pub(super) struct Frame {
    /// The same backbone without cables: what is integrated.
    pub rod: Robot,
    pub layout: Layout,
    pub spans: Vec<Span>,
    /// Hole to hole on the rod at rest, in m, by cable.
    pub rest_lengths: Vec<f64>,
    /// Of all passages on the rod at rest.
    pub rest_chords: Vec<Chord>,
    /// Passages of all spans.
    pub passages: usize,
}

/// Steps from base to tip, and which of them lie in which span.
#[derive(Clone, Debug)]
pub(super) struct Mesh {
    pub grid: Grid,
    pub spans: Vec<Range<usize>>,
    /// For each span an earlier one that it is like.
    pub repeated_spans: Vec<Option<RepeatedSpan>>,
}

impl Frame {
    /// Cuts the robot.
    ///
    /// # Errors
    /// [`SolveError::Unsupported`] when a cable is anchored between two disks, and
    /// [`SolveError::Missing`] when the rod's stiffness is not known.
    pub fn new(robot: &Robot, stations: Vec<f64>, loads: &Loads) -> Result<Self, SolveError> {
        let rod = Robot::new(robot.backbone().clone(), robot.disks().clone(), Vec::new())?;
        let mut spans = Vec::with_capacity(robot.disks().count() - 1);
        let mut count = 0;
        let starts = &robot.disks().arc_lengths;
        for (&start, passages) in
            starts.iter().zip(passages_to_disks(robot, ModelKind::CosseratDisks)?)
        {
            let first = count;
            count += passages.len();
            spans.push(Span { start, first, passages });
        }
        let layout = Layout::new(&rod, stations, loads);
        let (rest_lengths, rest_chords) = (vec![0.0; robot.cables().len()], Vec::new());
        let mut frame = Self { rod, layout, spans, rest_lengths, rest_chords, passages: count };
        frame.rest_chords = frame.chords_at_rest()?;
        let passing = frame.spans.iter().flat_map(|span| &span.passages);
        for (passage, chord) in passing.zip(&frame.rest_chords) {
            frame.rest_lengths[passage.cable] += chord.length;
        }
        Ok(frame)
    }

    /// The frame's mesh with every step halved `halvings` times, of at least `steps` steps.
    pub fn mesh(&self, steps: usize, halvings: usize) -> Result<Mesh, SolveError> {
        let grid = Grid::refined(&self.rod, &self.layout, steps, halvings)
            .map_err(|error| error.of(ModelKind::CosseratDisks))?;
        let spans: Vec<_> = grid.disks.windows(2).map(|pair| pair[0]..pair[1]).collect();
        let repeated_spans = repeated_spans::find(&self.spans, &grid, &spans);
        Ok(Mesh { grid, spans, repeated_spans })
    }

    /// Share of the robot that lies beyond disk `k`, before the next.
    pub fn weight(&self, k: usize) -> f64 {
        let length = self.rod.backbone().length;
        let Some(span) = self.spans.get(k) else { return 0.0 };
        let end = self.spans.get(k + 1).map_or(length, |next| next.start);
        (end - span.start) / length
    }

    /// Scales of the rod.
    pub fn scales(&self, mesh: &Mesh) -> Scales {
        Scales::of(&mesh.grid, self.rod.backbone().length)
    }

    /// The holes with their friction coefficients.
    pub fn holes(&self, robot: &Robot) -> Holes {
        let mut of_cable = vec![Vec::new(); robot.cables().len()];
        for span in &self.spans {
            for (i, passage) in span.passages.iter().enumerate() {
                of_cable[passage.cable].push(span.first + i);
            }
        }
        let mut at_rest = vec![0.0; self.passages];
        for passages in &of_cable {
            let mut beyond = 0.0;
            for &p in passages.iter().rev() {
                beyond += self.rest_chords[p].length;
                at_rest[p] = beyond;
            }
        }
        let cables = robot.cables();
        let mut yielding = vec![0.0; self.passages];
        for (passages, cable) in of_cable.iter().zip(cables) {
            let compliance = cable.axial_stiffness.map_or(0.0, f64::recip);
            for &p in passages {
                yielding[p] = compliance * self.rest_chords[p].length;
            }
        }
        Holes {
            of_cable,
            coefficients: cables.iter().map(|cable| cable.friction.unwrap_or(0.0)).collect(),
            yielding,
            at_rest,
        }
    }

    /// The mesh on which the rod at rest is known.
    pub fn rest_mesh(&self) -> Result<Mesh, SolveError> {
        const HALVINGS: usize = 3;
        self.mesh(1, HALVINGS)
    }

    /// The cables between the disks, on the steps of a mesh.
    pub fn straight_spans(&self, mesh: &Mesh) -> Vec<StraightSpan<'_>> {
        self.spans
            .iter()
            .zip(&mesh.spans)
            .map(|(span, steps)| StraightSpan { steps: steps.clone(), passages: &span.passages })
            .collect()
    }

    /// The chords of all passages on the rod at rest.
    fn chords_at_rest(&self) -> Result<Vec<Chord>, SolveError> {
        let mesh = self.rest_mesh()?;
        let mut chords = Vec::with_capacity(self.passages);
        for (span, steps) in self.spans.iter().zip(&mesh.spans) {
            let pose = steps.clone().fold(Pose::IDENTITY, |pose, k| {
                let h = mesh.grid.steps[k].length;
                let at = |j: usize| mesh.grid.gauss.at(k, j, 0).0.section.rest_strain() * h;
                pose * magnus_6(&[at(0), at(1), at(2)])
            });
            for passage in &span.passages {
                let way = pose.transform(passage.far) - passage.near;
                let length = way.norm();
                chords.push(Chord { along: way * (1.0 / length), length });
            }
        }
        Ok(chords)
    }
}
