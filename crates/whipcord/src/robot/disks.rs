use whipcord_numerics::{Vec3, equally_spaced};

use super::error::{Problem, RobotError};
use super::limits::{COORDINATE, LEAST_PITCH, LENGTH, MASS, MOST_DISKS, check_count};

/// The perforated disks, base disk first; or none, of a body in whose channels the cables run ([`Disks::none`]).
#[derive(Clone, Debug, PartialEq)]
pub struct Disks {
    /// Arc length of each disk in m; the first is 0 and the last the backbone's length. Where there are no disks these are the
    /// stations that stand for them where answers are given.
    pub arc_lengths: Vec<f64>,
    /// Whether there are disks at these arc lengths.
    pub are_present: bool,
    /// Radius in m of the circle on which each disk's holes lie; empty when the disks have none.
    pub hole_circle_radii: Vec<f64>,
    /// Number of holes of each disk, equally spaced, hole 1 on the x axis.
    pub holes: Option<usize>,
    /// Mass of each disk in kg.
    pub mass: f64,
    /// Outer radius of the disks in m; that of its hole circle for each of them where none is given.
    /// It matters only where there are obstacles.
    pub outer_radius: Option<f64>,
    /// Thickness of the disks in m, whose rims are rounded with half of it; a tenth of the outer
    /// radius where none is given. It matters only where there are obstacles, but is never more than the distance of two
    /// disks or twice the radius of one.
    pub thickness: Option<f64>,
}

impl Disks {
    /// Massless disks at equal distances along a backbone of length `length`, with holes on a
    /// circle of radius `hole_circle_radius`.
    #[must_use]
    pub fn equally_spaced(length: f64, count: usize, hole_circle_radius: f64) -> Self {
        Self {
            arc_lengths: equally_spaced(0.0, length, count).collect(),
            are_present: true,
            hole_circle_radii: vec![hole_circle_radius; count],
            holes: None,
            mass: 0.0,
            outer_radius: None,
            thickness: None,
        }
    }

    /// No disks on a backbone of length `length`, and [`Self::STATIONS`] equally spaced stations instead. Cables then have a curve for
    /// their routing, and nothing is given by a list with one value for each disk. Models of robots that consist of disks refuse
    /// such a robot.
    #[must_use]
    pub fn none(length: f64) -> Self {
        let stations = Self::equally_spaced(length, Self::STATIONS, 0.0);
        Self { are_present: false, hole_circle_radii: Vec::new(), ..stations }
    }

    /// The same disks with this many equally spaced holes.
    #[must_use]
    pub fn with_holes(self, holes: usize) -> Self {
        Self { holes: Some(holes), ..self }
    }

    /// Number of stations of a body without disks, both ends included.
    pub const STATIONS: usize = 21;

    /// Number of disks, or of the stations that stand for them.
    #[must_use]
    pub fn count(&self) -> usize {
        self.arc_lengths.len()
    }

    /// Radius in m of the rim of a disk; 0 where neither it nor the hole circle is given, and where there is no disk.
    #[must_use]
    pub fn rim_radius(&self, disk: usize) -> f64 {
        if !self.are_present {
            return 0.0;
        }
        let circle = self.hole_circle_radii.get(disk).copied().unwrap_or(0.0);
        self.outer_radius.unwrap_or(circle)
    }

    /// Moments of inertia in kg·m² of a disk as a cylinder of this mass in kg, radius and thickness in m, about axes through its
    /// middle: across it twice, then along its axis.
    #[must_use]
    pub fn moments_of_inertia(mass: f64, radius: f64, thickness: f64) -> Vec3 {
        let across = mass * (0.25 * radius * radius + thickness * thickness / 12.0);
        Vec3::new(across, across, 0.5 * mass * radius * radius)
    }

    /// The section an arc length lies in, counted from 0, and the fraction of it that lies behind.
    #[must_use]
    pub fn locate(&self, arc_length: f64) -> (usize, f64) {
        let s = &self.arc_lengths;
        let i = s[1..s.len() - 1].partition_point(|&x| x <= arc_length);
        (i, (arc_length - s[i]) / (s[i + 1] - s[i]))
    }

    pub(super) fn check(&self, length: f64) -> Result<(), RobotError> {
        let s = &self.arc_lengths;
        if s.len() < 2 {
            return Err(RobotError::new(
                "disks.count",
                Problem::TooFew { given: s.len(), least: 2 },
            ));
        }
        check_count("disks.count", s.len(), MOST_DISKS)?;
        for (i, &value) in s.iter().enumerate() {
            let path = format!("disks.positions[{i}]");
            COORDINATE.check(&path, value)?;
            if i > 0 && value <= s[i - 1] {
                let problem = Problem::NotIncreasing { value, previous: s[i - 1] };
                return Err(RobotError::new(path, problem));
            }
            if i > 0 && value - s[i - 1] < LEAST_PITCH {
                let problem = Problem::TooClose { pitch: value - s[i - 1], least: LEAST_PITCH };
                return Err(RobotError::new(path, problem));
            }
        }
        for (i, expected) in [(0, 0.0), (s.len() - 1, length)] {
            // Positions written in millimetres differ from the length by rounding.
            if (s[i] - expected).abs() > 1e-12 * length {
                let problem = Problem::NotAtEnd { value: s[i], expected };
                return Err(RobotError::new(format!("disks.positions[{i}]"), problem));
            }
        }
        if !self.hole_circle_radii.is_empty() && self.hole_circle_radii.len() != s.len() {
            let problem = Problem::Count { given: self.hole_circle_radii.len(), expected: s.len() };
            return Err(RobotError::new("disks.hole_circle_radius", problem));
        }
        for (i, &radius) in self.hole_circle_radii.iter().enumerate() {
            LENGTH.check(&format!("disks.hole_circle_radius[{i}]"), radius)?;
        }
        if self.holes == Some(0) {
            return Err(RobotError::new("disks.holes", Problem::NotPositive { value: 0.0 }));
        }
        for (path, length) in
            [("disks.outer_radius", self.outer_radius), ("disks.thickness", self.thickness)]
        {
            length.map_or(Ok(()), |length| LENGTH.check(path, length))?;
        }
        MASS.check("disks.mass", self.mass)
    }

    /// Disks do not reach into one another, and half of the thickness, which rounds the rim, is no more than the radius, which is
    /// at least that of the backbone at the arc length of the disk.
    pub(super) fn check_thickness(
        &self,
        backbone_radius: impl Fn(f64) -> f64,
    ) -> Result<(), RobotError> {
        // Numbers written in millimetres differ by rounding.
        const ROUNDING: f64 = 1e-9;
        let Some(thickness) = self.thickness else { return Ok(()) };
        let refused = |problem| Err(RobotError::new("disks.thickness", problem));
        for (first, pair) in self.arc_lengths.windows(2).enumerate() {
            let spacing = pair[1] - pair[0];
            if thickness > spacing * (1.0 + ROUNDING) {
                return refused(Problem::ThickerThanSpacing { thickness, spacing, first });
            }
        }
        for (disk, &arc_length) in self.arc_lengths.iter().enumerate() {
            let radius = self.rim_radius(disk).max(backbone_radius(arc_length));
            if radius > 0.0 && thickness > 2.0 * radius * (1.0 + ROUNDING) {
                return refused(Problem::ThickerThanWide { thickness, radius, disk });
            }
        }
        Ok(())
    }

    /// Sets the first and the last disk, whose positions may differ from the ends of the backbone by rounding, exactly there.
    pub(super) fn snap_to_ends(&mut self, length: f64) {
        if let [first, .., last] = &mut self.arc_lengths[..] {
            (*first, *last) = (0.0, length);
        }
    }
}
