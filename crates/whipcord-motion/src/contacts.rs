//! Contacts of a robot in motion: unilateral at the end of a step, with Coulomb's friction over the step, eqs. (25) and (26) of the page on motion.

use whipcord::contact::body::along;
use whipcord_numerics::{Mat3, Pose, Twist, Vec3};

use crate::block::{Block, dot};
use crate::contact::{Contact, Line, bend, in_section};
use crate::cross_section::{Posed, Station};
use crate::element::POINTS;
use crate::free_base::FreeBase;
use crate::loads::NodeLoad;
use crate::pose;
use crate::rod::Rod;
use crate::scheme::Scheme;
use crate::stage::Stage;
use crate::surroundings::{Hit, Near, Surroundings};

/// All contacts of a step.
#[derive(Clone, Debug, Default)]
pub(crate) struct Contacts {
    pub surroundings: Option<Surroundings>,
    pub list: Vec<Contact>,
    /// Whether the part of a step that is taken may touch something.
    pub touches: bool,
    pub has_free_base: bool,
    /// How the pose of a free base at the end of the step follows from its velocity there, and its velocity at the start.
    pub end_base: Option<(FreeBase, Twist)>,
    /// The round of a step that it is not repeated behind.
    pub last_round: Option<usize>,
    /// Whether friction is left out: of a part of a step that has no answer with it.
    pub is_frictionless: bool,
    /// Pose of the base at the end of the step, and at its start.
    pub base: Pose,
    pub start_base: Pose,
    strains: Vec<Twist>,
    poses: Vec<Pose>,
    start_poses: Vec<Pose>,
    /// What the poses lack while strains and velocities do not go together yet.
    shifts: Vec<Vec3>,
    lack: Vec<Twist>,
    found: Vec<Near>,
}

/// The most contacts of a step: their equations are dense.
pub(crate) const MOST: usize = 48;
/// Overlap that is not mended, as a part of the length.
pub(crate) const OVERLAP: f64 = 1e-5;
/// Overlap that is no impact yet, as a part of the length.
const HIT: f64 = 1e-7;
/// Speed at which overlap is mended, as a part of the length in 1 s.
pub(crate) const OUTWARD: f64 = 0.02;

impl Contacts {
    pub fn new(rod: &Rod, surroundings: Option<Surroundings>) -> Self {
        if surroundings.is_none() {
            return Self::default();
        }
        Self {
            surroundings,
            strains: vec![Twist::default(); rod.points.len()],
            poses: vec![Pose::IDENTITY; rod.nodes.len()],
            start_poses: vec![Pose::IDENTITY; rod.nodes.len()],
            shifts: vec![Vec3::ZERO; rod.nodes.len()],
            lack: vec![Twist::default(); rod.points.len()],
            ..Self::default()
        }
    }

    /// Begins a step from a shape: looks for what is no farther than `within` from an obstacle. What touched before pushes as it did;
    /// `known` is given in the frame of a world in which the base stands at `world` when the motion starts.
    pub fn begin(
        &mut self,
        rod: &Rod,
        base: Pose,
        strains: &[Twist],
        within: f64,
        (known, world): (&[whipcord::solution::Contact], Pose),
    ) {
        let Some(surroundings) = &self.surroundings else { return };
        self.start_base = base;
        pose::nodes(rod, base, strains, &mut self.poses);
        let shape = Posed { rod, strains, poses: &self.poses };
        surroundings.near(&shape, within, OVERLAP * rod.length, &mut self.found);
        self.list.clear();
        for near in &self.found {
            let contact = Contact::new(near, &surroundings.obstacles[near.obstacle], &shape, None);
            self.list.push(contact);
        }
        let back = world.rotation.conjugate();
        for touch in known {
            let radius = 0.02 * rod.length;
            let matches = |contact: &Contact| {
                contact.obstacle == touch.obstacle
                    && contact.member.part == touch.part
                    && (contact.member.arc_length - touch.arc_length).abs() < radius
            };
            let local = |contact: &Contact| {
                let place = world.transform(
                    contact.start.position + contact.nearest.lever(contact.member.body.rounding),
                );
                (place - touch.point).norm()
            };
            let same = self
                .list
                .iter_mut()
                .filter(|contact| matches(contact) && contact.force == 0.0)
                .min_by(|a, b| local(a).total_cmp(&local(b)));
            if let Some(contact) = same {
                contact.force = touch.force.unwrap_or(0.0);
                let traction = back.rotate(touch.friction.unwrap_or_default());
                contact.traction = along(traction, contact.nearest.normal);
                contact.sticks = touch.sticks;
            }
        }
        self.list.sort_by(|a, b| a.nearest.gap.total_cmp(&b.nearest.gap));
        self.list.truncate(MOST);
        if self.is_frictionless {
            self.list.iter_mut().for_each(Contact::leave_friction_out);
        }
    }

    /// Whether what may touch has friction.
    pub fn have_friction(&self) -> bool {
        self.surroundings
            .as_ref()
            .is_some_and(|of| of.obstacles.iter().any(|obstacle| obstacle.friction > 0.0))
    }

    /// Forgets all contacts.
    pub fn clear(&mut self) {
        self.list.clear();
        self.touches = false;
    }

    /// What overlaps at the start of a step of length `h` need not be out at its end.
    pub fn admit_overlap(&mut self, rod: &Rod, h: f64) {
        for contact in &mut self.list {
            contact.least = (contact.start_gap + OUTWARD * rod.length * h).min(0.0);
        }
    }

    /// Looks at all contacts at the end of the step as the stage has it now.
    pub fn refresh(&mut self, rod: &Rod, scheme: &Scheme, stage: &Stage) {
        let Some(surroundings) = &self.surroundings else { return };
        if let Some((free, from)) = &self.end_base {
            self.base = free.pose(scheme.end(*from, stage.velocities[0]));
        }
        for (end, (start, strain)) in
            self.strains.iter_mut().zip(stage.start.iter().zip(&stage.strains))
        {
            *end = scheme.end(*start, *strain);
        }
        pose::nodes(rod, self.base, &self.strains, &mut self.poses);
        let shape = Posed { rod, strains: &self.strains, poses: &self.poses };
        let at_stage = Posed { rod, strains: &stage.strains, poses: &stage.poses };
        for contact in &mut self.list {
            let obstacle = &surroundings.obstacles[contact.obstacle];
            let pose = shape.at(contact.station);
            contact.look(obstacle, &pose);
            contact.slip =
                contact.nearest.slip(&contact.start, &pose, contact.member.body.rounding);
            contact.at_end = pose.rotation;
            contact.centre = pose.position;
            contact.at_stage = at_stage.at(contact.station).rotation;
            contact.bend = bend(obstacle, pose.position + contact.nearest.arm, rod.length);
        }
    }

    /// Strains and poses at the end of the step, as they were looked at last.
    pub fn end(&self) -> (&[Twist], &[Pose]) {
        (&self.strains, &self.poses)
    }

    /// Adds the forces to the residual of a stage, and what they change by to its matrix where that is `fresh`.
    pub fn add_forces(&self, scheme: &Scheme, stage: &mut Stage, fresh: bool) {
        for contact in &self.list {
            if contact.force == 0.0 {
                continue;
            }
            let push = contact.push();
            let e = contact.station.element;
            for (a, f) in contact.shapes.into_iter().enumerate() {
                let node = 2 * e + a;
                stage.residual[node] = stage.residual[node] - push * f;
                if node == 0 {
                    stage.base_force = stage.base_force - push * f;
                }
            }
            if !fresh {
                continue;
            }
            let block = contact.stiffness(scheme);
            for (a, fa) in contact.shapes.into_iter().enumerate() {
                for (b, fb) in contact.shapes.into_iter().enumerate() {
                    stage.matrix.elements[e][a][b].add_scaled(-fa * fb, &block);
                }
            }
        }
    }

    /// Adds to the matrix of a stage what the forces change by with the poses in equilibrium, exactly: also that the place where a disk touches moves along its
    /// rim, of which the iteration of a step does without. By central differences.
    pub fn add_stiffness(&self, rod: &Rod, stage: &mut Stage) {
        /// Displacement as a part of the length, and rotation in rad.
        const STEP: f64 = 1e-5;
        let Some(surroundings) = &self.surroundings else { return };
        let shape = Posed { rod, strains: &stage.strains, poses: &stage.poses };
        for contact in &self.list {
            let pose = shape.at(contact.station);
            let obstacle = &surroundings.obstacles[contact.obstacle];
            let push = |motion: Twist| {
                let pose = pose * Pose::exp(motion);
                let mut moved = *contact;
                moved.look(obstacle, &pose);
                moved.at_stage = pose.rotation;
                moved.push()
            };
            let column = |turns: bool, axis: Vec3| {
                let h = if turns { STEP } else { STEP * rod.length };
                let motion = |by: f64| match turns {
                    true => Twist { linear: Vec3::ZERO, angular: axis * by },
                    false => Twist { linear: axis * by, angular: Vec3::ZERO },
                };
                (push(motion(h)) - push(motion(-h))) * (0.5 / h)
            };
            let [place, turn] =
                [false, true].map(|turns| [Vec3::X, Vec3::Y, Vec3::Z].map(|of| column(turns, of)));
            let forces = |of: [Twist; 3]| {
                let [x, y, z] = of.map(|column| column.linear);
                Mat3::from_columns(x, y, z)
            };
            let moments = |of: [Twist; 3]| {
                let [x, y, z] = of.map(|column| column.angular);
                Mat3::from_columns(x, y, z)
            };
            let block =
                Block { a: forces(place), b: forces(turn), c: moments(place), d: moments(turn) };
            let e = contact.station.element;
            for (a, fa) in contact.shapes.into_iter().enumerate() {
                for (b, fb) in contact.shapes.into_iter().enumerate() {
                    stage.matrix.elements[e][a][b].add_scaled(-fa * fb, &block);
                }
            }
        }
    }

    /// Number of lines of the complementarity problem.
    pub fn lines(&self) -> usize {
        self.list.iter().map(Contact::lines).sum()
    }

    /// Finds how far the poses at the end will still move, since the strains of the stage do not go with its velocities yet.
    pub fn find_shifts(&mut self, rod: &Rod, scheme: &Scheme, stage: &Stage) {
        for (out, lack) in self.lack.iter_mut().zip(&stage.lack) {
            *out = *lack * (1.0 / scheme.place);
        }
        let Self { poses, lack, shifts, .. } = self;
        pose::displacements(rod, poses, lack, |node, _, shift| shifts[node] = shift);
    }

    /// Fills column and row of a line of a contact; returns its gap or slip at the end of the step with what its strains lack.
    pub fn linearise(
        &self,
        scheme: &Scheme,
        contact: usize,
        line: usize,
        column: &mut [Twist],
        row: &mut [Twist],
    ) -> f64 {
        column.fill(Twist::default());
        row.fill(Twist::default());
        let contact = &self.list[contact];
        let Line { direction, lever, value } = contact.line(line);
        let e = contact.station.element;
        let force = in_section(contact.at_stage, direction, lever);
        let motion = in_section(contact.at_end, direction, lever) * (scheme.g / scheme.place);
        let mut shift = Vec3::ZERO;
        if let Some((free, _)) = &self.end_base {
            // A free base moves by a rule of its own, and all sections with it.
            let arm = contact.centre + lever - self.base.position;
            let moved = in_section(self.base.rotation, direction, arm);
            row[0] = moved * ((free.g - scheme.g) / scheme.place);
        }
        for (a, f) in contact.shapes.into_iter().enumerate() {
            column[2 * e + a] = force * -f;
            if self.has_free_base && 2 * e + a == 0 {
                row[0] = row[0] + motion * f;
            }
            if 2 * e + a > 0 {
                row[2 * e + a] = motion * f;
                shift += self.shifts[2 * e + a] * f;
            }
        }
        value + direction.dot(shift)
    }

    /// Power in W of the forces on the robot at a stage.
    pub fn power(&self, stage: &Stage) -> f64 {
        let of = |contact: &Contact| dot(&contact.push(), &contact.velocity(&stage.velocities));
        self.list.iter().filter(|contact| contact.force > 0.0).map(of).sum()
    }

    /// Where an obstacle is hit first on the way between two shapes, each a pose of the base with strains.
    pub fn first_hit(
        &mut self,
        rod: &Rod,
        (from_base, from): (Pose, &[Twist]),
        (to_base, to): (Pose, &[Twist]),
    ) -> Option<Hit> {
        let Self { surroundings: Some(surroundings), poses, start_poses, .. } = self else {
            return None;
        };
        pose::nodes(rod, from_base, from, start_poses);
        pose::nodes(rod, to_base, to, poses);
        let from = Posed { rod, strains: from, poses: start_poses };
        let to = Posed { rod, strains: to, poses };
        surroundings.first_hit(&from, &to, HIT * rod.length)
    }

    /// How deep in m a shape is in an obstacle, and in which.
    pub fn deepest(&mut self, rod: &Rod, base: Pose, strains: &[Twist]) -> Option<(usize, f64)> {
        let surroundings = self.surroundings.as_ref()?;
        pose::nodes(rod, base, strains, &mut self.poses);
        surroundings.deepest(&Posed { rod, strains, poses: &self.poses })
    }

    /// Adds the places that overlap at the end of the step, behind a round of it, though no contact is there; whether there are any.
    pub fn add_overlapping(
        &mut self,
        rod: &Rod,
        start: &[Twist],
        start_base: Pose,
        round: usize,
    ) -> bool {
        let Some(surroundings) = &self.surroundings else { return false };
        let overlap = OVERLAP * rod.length;
        pose::nodes(rod, start_base, start, &mut self.start_poses);
        let shape = Posed { rod, strains: &self.strains, poses: &self.poses };
        surroundings.near(&shape, 0.0, overlap, &mut self.found);
        let before = self.list.len();
        for near in &self.found {
            let is_known = |contact: &Contact| {
                let [dx, dy] = [0, 1].map(|i| contact.nearest.local[i] - near.nearest.local[i]);
                contact.obstacle == near.obstacle
                    && contact.member.part == near.member.part
                    && (contact.member.arc_length - near.member.arc_length).abs()
                        < 1e-3 * rod.length
                    && dx.hypot(dy) <= 0.2 * near.member.body.flat
            };
            if near.nearest.gap >= -overlap
                || self.list.len() >= MOST
                || self.list.iter().any(is_known)
            {
                continue;
            }
            let at_start = Posed { rod, strains: start, poses: &self.start_poses };
            let obstacle = &surroundings.obstacles[near.obstacle];
            let mut contact = Contact::new(near, obstacle, &at_start, Some(round));
            if self.is_frictionless {
                contact.leave_friction_out();
            }
            self.list.push(contact);
        }
        self.list.len() > before
    }

    /// The contacts that push, in a world in which the base stands at `world` when the motion starts.
    pub fn report(&self, world: Pose, rod: &Rod, out: &mut Vec<whipcord::solution::Contact>) {
        out.clear();
        let shape = Posed { rod, strains: &self.strains, poses: &self.poses };
        for contact in self.list.iter().filter(|contact| contact.force > 0.0) {
            let centre = shape.at(contact.station).position;
            let lever = contact.nearest.lever(contact.member.body.rounding);
            out.push(whipcord::solution::Contact {
                obstacle: contact.obstacle,
                part: contact.member.part,
                arc_length: contact.member.arc_length,
                point: world.transform(centre + lever),
                normal: world.rotation.rotate(contact.nearest.normal),
                force: Some(contact.force),
                friction: Some(world.rotation.rotate(contact.traction)),
                sticks: contact.sticks,
                gap: contact.nearest.gap,
            });
        }
        out.sort_by(|a, b| a.arc_length.total_cmp(&b.arc_length));
    }
}

/// Adds the push of a contact to loads on the nodes, in the frame of a base that stands at `world` when the motion starts; `poses` are those of the nodes
/// in the world.
pub(crate) fn add_push(
    rod: &Rod,
    world: Pose,
    poses: &[Pose],
    contact: &whipcord::solution::Contact,
    loads: &mut [NodeLoad],
) {
    let station = Station::at(rod, contact.arc_length);
    let force =
        contact.normal * contact.force.unwrap_or(0.0) + contact.friction.unwrap_or_default();
    let back = world.rotation.conjugate();
    for (a, f) in station.shapes().into_iter().enumerate() {
        let node = POINTS * station.element + a;
        let moment = (contact.point - poses[node].position).cross(force);
        loads[node].force += back.rotate(force) * f;
        loads[node].moment += back.rotate(moment) * f;
    }
}
