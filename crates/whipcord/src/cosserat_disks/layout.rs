//! The robot cut at its disks: spans of the backbone, and the cables' straight pieces in them.

use core::ops::Range;

use whipcord_numerics::{Pose, magnus_6};

use super::between_disks::Span;
use super::chord::Chord;
use super::repeated_spans::{self, RepeatedSpan};
use crate::case::Loads;
use crate::derivatives::{StraightSpan, Strands};
use crate::error::SolveError;
use crate::kind::ModelKind;
use crate::robot::Robot;
use crate::statics::friction::Holes;
use crate::statics::grid::{Grid, Layout};
use crate::statics::passages::{Anchor, passages};
use crate::statics::plastic_curvature::PlasticCurvature;
use crate::statics::scales::Scales;

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
    /// The passages that are anchored between two disks, by their numbers in their spans; from the base on.
    anchored: Vec<usize>,
    /// Pairs of an anchor and a passage of its span.
    pub anchor_rows: usize,
}

/// Steps from base to tip, and which of them lie in which span.
#[derive(Clone, Debug)]
pub(super) struct Mesh {
    pub grid: Grid,
    pub spans: Vec<Range<usize>>,
    /// For each span an earlier one that it is like.
    pub repeated_spans: Vec<Option<RepeatedSpan>>,
    /// The anchors between disks, from the base on.
    pub anchors: Vec<Anchor>,
}

impl Mesh {
    /// The anchors of a span.
    #[inline]
    pub fn anchors_of(&self, span: &Span) -> &[Anchor] {
        &self.anchors[span.anchors.clone()]
    }
}

impl Frame {
    /// Cuts the robot.
    ///
    /// # Errors
    /// [`SolveError::Missing`] when the rod's stiffness is not known.
    pub fn new(robot: &Robot, stations: Vec<f64>, loads: &Loads) -> Result<Self, SolveError> {
        let rod = Robot::new(robot.backbone().clone(), robot.disks().clone(), Vec::new())?;
        let mut spans = Vec::with_capacity(robot.disks().count() - 1);
        let (mut count, mut anchor_rows) = (0, 0);
        let (mut anchored, mut places) = (Vec::new(), Vec::new());
        let ends = &robot.disks().arc_lengths;
        for (ends, passages) in ends.windows(2).zip(passages(robot)) {
            let first_anchor = anchored.len();
            let inside = (0..passages.len()).filter(|&i| passages[i].is_anchored_inside());
            anchored.extend(inside);
            anchored[first_anchor..]
                .sort_by(|&a, &b| passages[a].reach.total_cmp(&passages[b].reach));
            let place = |&i: &usize| robot.routes()[passages[i].cable].end();
            places.extend(anchored[first_anchor..].iter().map(place));
            let anchors = first_anchor..anchored.len();
            let (first, rows) = (count, anchor_rows);
            count += passages.len();
            anchor_rows += anchors.len() * passages.len();
            spans.push(Span { start: ends[0], first, passages, anchors, anchor_rows: rows });
        }
        let layout = Layout::with_anchors(&rod, stations, loads, places);
        let mut frame = Self {
            rod,
            layout,
            spans,
            rest_lengths: vec![0.0; robot.cables().len()],
            rest_chords: Vec::new(),
            passages: count,
            anchored,
            anchor_rows,
        };
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
        let places = self.anchored.iter().zip(&grid.anchors);
        let anchors = places.map(|(&passage, &node)| Anchor { passage, node }).collect();
        Ok(Mesh { grid, spans, repeated_spans, anchors })
    }

    /// Gives a mesh the plastic curvature that earlier steps of actuation left.
    pub fn set_plastic(&self, mesh: &mut Mesh, plastic: &PlasticCurvature) {
        mesh.grid.set_plastic(plastic);
        mesh.repeated_spans = repeated_spans::find(&self.spans, &mesh.grid, &mesh.spans);
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

    /// By how much a tension of 1 N shortens a cable, in m: its order of magnitude.
    pub fn compliance(&self, mesh: &Mesh) -> f64 {
        let length = self.rod.backbone().length;
        let lever = (self.spans.iter())
            .flat_map(|span| &span.passages)
            .map(|passage| passage.near.norm())
            .fold(1e-3 * length, f64::max);
        lever * lever / (self.scales(mesh).force * length)
    }

    /// The holes with their friction coefficients.
    pub fn holes(&self, robot: &Robot, mesh: &Mesh) -> Holes {
        let passages = self.spans.iter().flat_map(|span| &span.passages);
        let pieces = passages.zip(&self.rest_chords).map(|(p, chord)| (p.cable, chord.length));
        let length = self.rod.backbone().length;
        Holes::new(robot, pieces, length, self.compliance(mesh))
    }

    /// The mesh on which the rod at rest is known.
    pub fn rest_mesh(&self) -> Result<Mesh, SolveError> {
        const HALVINGS: usize = 3;
        self.mesh(1, HALVINGS)
    }

    /// The passages as strands of the cables, from span to span.
    pub fn strands(&self, holes: &Holes) -> Strands {
        let strand = |link: usize, cable: usize| {
            let span = self.spans.get(link)?;
            let place = span.passages.iter().position(|passage| passage.cable == cable)?;
            Some(span.first + place)
        };
        Strands::of_links(holes.of_cable.len(), holes.count(), self.spans.len(), strand)
    }

    /// The cables between the disks, on the steps of a mesh.
    pub fn straight_spans<'a>(&'a self, mesh: &'a Mesh) -> impl Iterator<Item = StraightSpan<'a>> {
        self.spans.iter().zip(&mesh.spans).map(|(span, steps)| StraightSpan {
            steps: steps.clone(),
            passages: &span.passages,
            anchors: mesh.anchors_of(span),
            tensions: None,
        })
    }

    /// The chords of all passages on the rod at rest.
    fn chords_at_rest(&self) -> Result<Vec<Chord>, SolveError> {
        let mesh = match self.rod.backbone().rest_curvature.is_zero() {
            // One step is as exact as many where the rod is straight.
            true => self.mesh(1, 0)?,
            false => self.rest_mesh()?,
        };
        let mut chords = Vec::with_capacity(self.passages);
        for (span, steps) in self.spans.iter().zip(&mesh.spans) {
            let first = chords.len();
            chords.resize(first + span.passages.len(), Chord::default());
            let mut anchors = mesh.anchors_of(span).iter().peekable();
            let mut pose = Pose::IDENTITY;
            for k in steps.clone() {
                let h = mesh.grid.steps[k].length;
                let at = |j: usize| mesh.grid.gauss.at(k, j, 0).0.section.rest_strain() * h;
                pose = pose * magnus_6(&[at(0), at(1), at(2)]);
                while let Some(anchor) = anchors.next_if(|anchor| anchor.node == k + 1) {
                    let passage = &span.passages[anchor.passage];
                    chords[first + anchor.passage] = Chord::between(passage, &pose);
                }
            }
            for (passage, chord) in span.passages.iter().zip(&mut chords[first..]) {
                if !passage.is_anchored_inside() {
                    *chord = Chord::between(passage, &pose);
                }
            }
        }
        Ok(chords)
    }
}
