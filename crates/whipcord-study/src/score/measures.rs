//! Distances of answers from measurements, and what sums them up.

use whipcord::{LengthMiss, Mat3, ModelKind, Pose, UnitQuaternion};
use whipcord_estimation::observation::in_space;
use whipcord_estimation::registration::{Aligned, Alignment, align, nearest_rotation};
use whipcord_io::Measured;

use super::data::{FileScore, MarkerScore, RowScore, Score};
use super::solve::{Answers, SolvedRow, Subject, Unsolved};
use crate::failure::refuses;
use crate::mirrored::{self, mirrored};
use crate::remark::Remark;
use crate::statistics::{median, root_mean_square};

impl FileScore {
    /// Of these answers to the rows of a file.
    pub(super) fn new(subject: &Subject<'_>, model: ModelKind, answers: Answers) -> Self {
        let mut score = Self {
            model,
            rows: Vec::with_capacity(answers.len()),
            markers: Vec::new(),
            motion: None,
            mirrored: None,
            incomparable: None,
            refused: None,
            body_is_estimated: false,
        };
        let mut solved: Vec<(usize, SolvedRow)> = Vec::new();
        for (row, answer) in answers {
            let mut of_row = RowScore {
                row,
                failure: None,
                unstable: false,
                misses: Vec::new(),
                down_weighted: false,
                error: None,
                angle: None,
            };
            match answer {
                Ok(mut answer) => {
                    of_row.unstable = answer.unstable;
                    of_row.misses = core::mem::take(&mut answer.misses);
                    solved.push((row, answer));
                }
                Err(failure) => of_row.failure = Some(failure),
            }
            score.rows.push(of_row);
        }
        let refused = score.rows.iter().map(|row| match &row.failure {
            Some(Unsolved::Failed(error)) if refuses(error) => Some(error),
            _ => None,
        });
        let refused: Option<Vec<_>> = refused.collect();
        score.refused = refused.and_then(|all| all.first().map(|error| (*error).clone()));
        if let Some(measured) = &subject.file.measured {
            score.compare(subject, measured, &solved);
        }
        score
    }

    fn compare(
        &mut self,
        subject: &Subject<'_>,
        measured: &Measured,
        solved: &[(usize, SolvedRow)],
    ) {
        let disks = subject.file.robot.disks();
        let answer = |row: usize| {
            let place = solved.binary_search_by_key(&row, |(row, _)| *row).ok()?;
            Some(&solved[place].1)
        };
        let pose = |row: usize, arc_length: f64| -> Option<Pose> {
            let station = subject.stations.partition_point(|station| *station < arc_length);
            answer(row)?.poses.get(station).copied()
        };
        for (seen, position) in in_space(&measured.observations) {
            let arc_length = seen.place.arc_length(disks);
            let Some(pose) = pose(seen.step, arc_length) else { continue };
            self.markers.push(MarkerScore {
                row: seen.step,
                arc_length,
                measured: position,
                model: pose.transform(seen.offset),
                at_base: arc_length == 0.0,
            });
        }
        let pairs = self.markers.iter().map(|of| ([of.measured, of.model], of.at_base));
        if !self.markers.is_empty() || measured.alignment == Alignment::None {
            match align(pairs, measured.alignment) {
                Ok(Aligned { motion, lowered }) => {
                    self.motion = motion;
                    for row in lowered.into_iter().map(|marker| self.markers[marker].row) {
                        if let Ok(place) = self.rows.binary_search_by_key(&row, |of| of.row) {
                            self.rows[place].down_weighted = true;
                        }
                    }
                }
                Err(why) => {
                    self.incomparable = Some(format!("the measurement cannot be moved: {why}"));
                    self.markers.clear();
                    return;
                }
            }
        }
        if measured.alignment == Alignment::Rigid {
            self.mirrored = mirrored(self.markers.iter().map(|of| [of.measured, of.model]));
        }
        let motion = self.motion.unwrap_or(Pose::IDENTITY);
        for marker in &mut self.markers {
            marker.measured = motion.transform(marker.measured);
        }
        let mut markers = self.markers.as_slice();
        for row in &mut self.rows {
            let start = markers.partition_point(|marker| marker.row < row.row);
            let end = markers.partition_point(|marker| marker.row <= row.row);
            let own = markers[start..end].iter().filter(|marker| !marker.at_base);
            row.error = root_mean_square(own.map(MarkerScore::distance));
            markers = &markers[end..];
        }
        // The rotation of the body in the frame that it is mounted on, as each row has it.
        let in_frame: Vec<(usize, UnitQuaternion)> = measured
            .rotations
            .iter()
            .filter_map(|of| {
                let frame = pose(of.step, of.place.arc_length(disks))?.rotation;
                Some((of.step, frame.conjugate() * (motion.rotation * of.rotation)))
            })
            .collect();
        if in_frame.is_empty() {
            return;
        }
        self.body_is_estimated = measured.body.is_none();
        let body = measured.body.unwrap_or_else(|| {
            let sum =
                |sum: Mat3, (_, rotation): &(usize, UnitQuaternion)| sum + rotation.to_matrix();
            nearest_rotation(&in_frame.iter().fold(Mat3::ZERO, sum))
        });
        for row in &mut self.rows {
            let own = in_frame.iter().filter(|(step, _)| *step == row.row);
            let angles = own.map(|(_, rotation)| {
                let apart = body.conjugate() * *rotation;
                2.0 * apart.v.norm().atan2(apart.w.abs())
            });
            row.angle = root_mean_square(angles);
        }
    }
}

/// What sums up distances or angles.
#[derive(Clone, Debug)]
pub struct Summary {
    /// Rows in which something was measured.
    pub rows: usize,
    /// Rows that are compared.
    pub compared: usize,
    /// Rows of robots that the model does not take.
    pub refused: usize,
    /// Rows without an answer of robots that it takes.
    pub failed: usize,
    /// Rows whose answer is unstable.
    pub unstable: usize,
    /// Rows whose cable lengths contradict each other, which are met in the least-squares sense.
    pub over_determined: usize,
    /// Rows that count less in the rigid motion of the measurement, as they are far off.
    pub down_weighted: usize,
    /// The cable that misses its length most in these rows, and its row.
    pub greatest_miss: Option<Missed>,
    /// Markers that are compared.
    pub markers: usize,
    /// Distances in m.
    pub distances: Option<Measures>,
    /// Distances as parts of the length of the backbone.
    pub relative: Option<Measures>,
    /// Angles in rad.
    pub angles: Option<Measures>,
    /// The row with the greatest error.
    pub worst: Option<Worst>,
    /// Why rows have no answer or are not compared, and how many of them, the most frequent first.
    pub reasons: Vec<(String, usize)>,
}

/// The row with the greatest error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Worst {
    /// Number of the file.
    pub file: usize,
    /// The row, from 0.
    pub row: usize,
    /// Its error in m.
    pub error: f64,
}

/// The cable that misses its length most.
#[derive(Clone, Debug, PartialEq)]
pub struct Missed {
    /// Number of the file.
    pub file: usize,
    /// The row, from 0.
    pub row: usize,
    /// The cable, and how much longer than prescribed it is.
    pub miss: LengthMiss,
}

/// Measures of errors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measures {
    /// Root mean square, over markers.
    pub rms: f64,
    /// Median over rows.
    pub median: f64,
    /// The least error that 95 % of the rows do not exceed.
    pub percentile_95: f64,
    /// The greatest of the rows.
    pub worst: f64,
}

impl Score<'_> {
    /// The warning where the measurement of a file fits every model much better after a reversal of one axis. Of one model alone it is the
    /// model that is wrong.
    pub(super) fn mirrored(&self, file: usize) -> Option<Remark> {
        let compared = self.files[file].iter().filter(|of| !of.markers.is_empty());
        let all: Option<Vec<[f64; 2]>> = compared.map(|of| of.mirrored).collect();
        all?.first().copied().map(mirrored::remark)
    }
}

impl Measures {
    /// Of the errors of single markers and of rows; `None` of none.
    fn of(markers: impl Iterator<Item = f64>, mut rows: Vec<f64>) -> Option<Self> {
        let rms = root_mean_square(markers)?;
        let median = median(&mut rows);
        let worst = *rows.last()?;
        let rank = (rows.len() * 95).div_ceil(100).max(1);
        Some(Self { rms, median, percentile_95: rows[rank - 1], worst })
    }
}

impl Summary {
    /// Over a model on these files.
    pub(super) fn of<'s>(
        score: &Score<'_>,
        files: impl Iterator<Item = (usize, &'s FileScore)>,
    ) -> Self {
        let (mut rows, mut refused, mut failed, mut unstable) = (0, 0, 0, 0);
        let (mut over_determined, mut greatest_miss) = (0, None::<Missed>);
        let mut down_weighted = 0;
        let (mut distances, mut errors) = (Vec::new(), Vec::new());
        let (mut relative, mut relative_errors) = (Vec::new(), Vec::new());
        let mut angles = Vec::new();
        let mut worst: Option<Worst> = None;
        let mut reasons: Vec<(String, String, usize)> = Vec::new();
        let mut count = |reason: String| {
            // Failures that differ in their numbers alone are of one kind.
            let kind: String =
                reason.chars().filter(|c| !c.is_ascii_digit() && !"-.e".contains(*c)).collect();
            match reasons.iter_mut().find(|(known, ..)| *known == kind) {
                Some((.., rows)) => *rows += 1,
                None => reasons.push((kind, reason, 1)),
            }
        };
        for (file, of) in files {
            let length = score.file(file).robot.backbone().length;
            rows += of.rows.len();
            for row in &of.rows {
                unstable += usize::from(row.unstable);
                over_determined += usize::from(!row.misses.is_empty());
                down_weighted += usize::from(row.down_weighted);
                for miss in &row.misses {
                    if greatest_miss.as_ref().is_none_or(|most| miss.excess > most.miss.excess) {
                        greatest_miss = Some(Missed { file, row: row.row, miss: miss.clone() });
                    }
                }
                match (&row.failure, row.error) {
                    (Some(failure), _) => {
                        let counted = if of.refused.is_some() { &mut refused } else { &mut failed };
                        *counted += 1;
                        count(failure.to_string());
                    }
                    (None, Some(error)) => {
                        errors.push(error);
                        relative_errors.push(error / length);
                        if worst.is_none_or(|worst| error > worst.error) {
                            worst = Some(Worst { file, row: row.row, error });
                        }
                    }
                    (None, None) => {
                        if let Some(why) = &of.incomparable {
                            count(why.clone());
                        }
                    }
                }
                angles.extend(row.angle);
            }
            for marker in of.markers.iter().filter(|marker| !marker.at_base) {
                distances.push(marker.distance());
                relative.push(marker.distance() / length);
            }
        }
        reasons.sort_by_key(|(.., rows)| core::cmp::Reverse(*rows));
        Self {
            rows,
            compared: errors.len(),
            refused,
            failed,
            unstable,
            over_determined,
            down_weighted,
            greatest_miss,
            markers: distances.len(),
            distances: Measures::of(distances.into_iter(), errors),
            relative: Measures::of(relative.into_iter(), relative_errors),
            angles: Measures::of(angles.clone().into_iter(), angles),
            worst,
            reasons: reasons.into_iter().map(|(_, reason, rows)| (reason, rows)).collect(),
        }
    }
}

impl core::fmt::Display for Unsolved {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Failed(error) => error.fmt(f),
            Self::NotReached => f.write_str("not reached: too many rows before it have no answer"),
        }
    }
}
