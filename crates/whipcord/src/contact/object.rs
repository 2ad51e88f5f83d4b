//! Movable objects: rigid bodies whose pose is unknown, under their weight, the contacts and what else acts on them.

use std::sync::Arc;

use whipcord_numerics::{Pose, UnitQuaternion, Vec3};

use super::features::Features;
use super::friction::Grip;
use super::model::Compliant;
use super::object_pair::ObjectPair;
use super::pair::Pair;
use super::pairs::Pairs;
use super::scene::Scene;
use crate::case::Case;
use crate::shape::Wrench;
use crate::solution::{ObjectState, Solution};

/// All movable objects of a scene, and their contacts with obstacles and with one another.
#[derive(Clone, Debug, Default)]
pub(super) struct Objects {
    pub list: Vec<Object>,
    pub near: Vec<ObjectPair>,
    /// What of each obstacle can touch another.
    pub features: Arc<[Features]>,
    /// Whether they are held where they are, as fixed obstacles.
    pub are_held: bool,
    /// Stiffness in N/m that a step of Newton's method gives each of them, so that what nothing determines stays.
    stiffness: f64,
    /// A force in N that counts as little.
    least: f64,
}

/// One movable object.
#[derive(Clone, Copy, Debug)]
pub(super) struct Object {
    /// Of its obstacle.
    pub number: usize,
    /// Centre of mass in the frame of the obstacle.
    centre: Vec3,
    /// Radius in m of a ball about the centre of mass that it fits in.
    pub reach: f64,
    /// Frame at its centre of mass, as the base sees it.
    pub pose: Pose,
    /// What acts on it but contacts, at its centre of mass.
    load: Wrench,
    /// What held it when it was released, and how much of that is left.
    holding: Wrench,
    pub held: f64,
    /// What is left of its balance.
    pub imbalance: Wrench,
    /// Sum of all forces on it, without direction.
    forces: f64,
    /// Where it was when the step on the way began.
    pub began: Pose,
}

/// The stiffness of a step, relative to that of the robot.
const STIFFNESS: f64 = 1e-3;
/// Forces below this part of those that bend the robot are little.
const LITTLE: f64 = 1e-3;
/// An object that moves farther than this many lengths of the robot in one step on the way is not held.
const LOST: f64 = 2.0;

impl Object {
    /// The frame of its obstacle.
    fn obstacle_pose(&self) -> Pose {
        self.pose * Pose { position: -self.centre, ..Pose::IDENTITY }
    }

    fn add(&mut self, force: Vec3, point: Vec3) {
        self.imbalance.force += force;
        self.imbalance.moment += (point - self.pose.position).cross(force);
        self.forces += force.norm();
    }

    /// What is left of its balance, relative to the forces on it.
    fn lack(&self, least: f64) -> f64 {
        let Wrench { force, moment } = self.imbalance;
        (force.norm() + moment.norm() / self.reach) / (self.forces + least)
    }
}

impl Objects {
    /// Of a case, where its file or a known answer has them.
    pub fn new(case: &Case, answer: Option<&Solution>, force_scale: f64, length: f64) -> Self {
        let to_base = case.base.inverse();
        let mut list = Vec::new();
        for (number, obstacle) in case.obstacles.iter().enumerate() {
            let Some(body) = &obstacle.movable else { continue };
            let known = answer
                .and_then(|answer| answer.objects.iter().find(|state| state.obstacle == number));
            let placed = known.map_or(obstacle.pose, |state| state.pose);
            let centre = body.center_of_mass;
            let pose = to_base * placed * Pose { position: centre, ..Pose::IDENTITY };
            list.push(Object {
                number,
                centre,
                reach: obstacle.form.reach_about(centre),
                pose,
                load: Wrench::default(),
                holding: Wrench::default(),
                held: 0.0,
                imbalance: Wrench::default(),
                forces: 0.0,
                began: pose,
            });
        }
        let features = if list.is_empty() {
            Arc::default()
        } else {
            let of = |obstacle: &crate::obstacle::Obstacle| {
                let centre = obstacle.movable.map_or(Vec3::ZERO, |body| body.center_of_mass);
                Features::new(&obstacle.form, centre)
            };
            case.obstacles.iter().map(of).collect()
        };
        Self {
            list,
            near: Vec::new(),
            features,
            are_held: false,
            stiffness: STIFFNESS * force_scale / length,
            least: LITTLE * force_scale,
        }
    }

    /// How many there are whose pose is unknown now.
    pub fn count(&self) -> usize {
        if self.are_held { 0 } else { self.list.len() }
    }

    /// The one that an obstacle is, if its pose is unknown now.
    pub fn of(&self, number: usize) -> Option<usize> {
        if self.are_held {
            return None;
        }
        self.list.iter().position(|object| object.number == number)
    }

    /// Frame at the centre of an obstacle.
    pub fn pose_of(&self, number: usize, scene: &Scene) -> Pose {
        match self.list.iter().find(|object| object.number == number) {
            Some(object) => object.pose,
            None => scene.get(number).pose,
        }
    }

    /// Puts all obstacles of the scene to where the objects are.
    pub fn place(&self, scene: &mut Scene) {
        for object in &self.list {
            scene.place(object.number, object.obstacle_pose());
        }
    }

    /// What acts on them besides contacts on the way: their weight by the loads of this case, and this part of their own loads.
    pub fn load(&mut self, case: &Case, asked: &Case, part: f64, held: f64) {
        let turn = case.loads.to_base(case.base.rotation);
        for object in &mut self.list {
            let Some(body) = &asked.obstacles[object.number].movable else { continue };
            let gravity = case.loads.gravity.unwrap_or(Vec3::ZERO);
            object.load = Wrench {
                force: turn.rotate(gravity * body.mass + body.force * part),
                moment: turn.rotate(body.moment * part),
            };
            object.held = held;
        }
    }

    /// What is left of the balance of each, where robot and objects are.
    pub fn balance(&mut self, pairs: &Pairs, model: &impl Compliant) {
        for object in &mut self.list {
            let Object { load, holding, held, .. } = *object;
            object.imbalance = load;
            object.imbalance.add(held, &holding);
            object.forces = load.force.norm()
                + load.moment.norm() / object.reach
                + held * (holding.force.norm() + holding.moment.norm() / object.reach);
        }
        for pair in &pairs.near {
            let on = self.list.iter_mut().find(|object| object.number == pair.obstacle);
            let Some(object) = on.filter(|_| pair.force > 0.0) else { continue };
            let lever = pair.nearest.lever(pair.member.body.rounding);
            let point = model.pose(pair.member.arc_length).position + lever;
            object.add(-pair.total(), point);
        }
        for pair in &self.near {
            if pair.force <= 0.0 {
                continue;
            }
            let total = pair.total();
            for (number, force) in [(pair.owner, total), (pair.other, -total)] {
                let on = self.list.iter_mut().find(|object| object.number == number);
                if let Some(object) = on {
                    object.add(force, pair.point);
                }
            }
        }
    }

    /// From now on what holds them where they are is a force that can be taken away.
    pub fn release(&mut self) {
        for object in &mut self.list {
            object.holding =
                Wrench { force: -object.imbalance.force, moment: -object.imbalance.moment };
        }
        self.are_held = false;
    }

    /// Whether a part is left of what held them when they were released.
    pub fn are_held_in_part(&self) -> bool {
        self.list.iter().any(|object| object.held > 0.0)
    }

    /// The one that was held with most, and with what.
    pub fn most_held(&self) -> Option<(&Object, Wrench)> {
        let of = |object: &Object| {
            object.holding.force.norm() + object.holding.moment.norm() / object.reach
        };
        let most = self.list.iter().max_by(|a, b| of(a).total_cmp(&of(b)));
        most.map(|object| (object, object.holding))
    }

    /// The one whose balance lacks most, and by how much relative to the forces on it.
    pub fn least_balanced(&self) -> Option<(&Object, f64)> {
        if self.are_held {
            return None;
        }
        let lacks = self.list.iter().map(|object| (object, object.lack(self.least)));
        lacks.max_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// The one that has moved so far that nothing holds it, in a scene of this length.
    pub fn lost(&self, length: f64) -> Option<&Object> {
        if self.are_held {
            return None;
        }
        let far = |object: &&Object| {
            let moved = (object.pose.position - object.began.position).norm();
            moved > LOST * (length + object.reach)
        };
        self.list.iter().find(far)
    }

    /// How one moves with a wrench in a step, by axes.
    pub fn compliance(&self, object: usize) -> [f64; 6] {
        let reach = self.list[object].reach;
        let (straight, turning) = (1.0 / self.stiffness, 1.0 / (self.stiffness * reach * reach));
        core::array::from_fn(|a| if a < 3 { straight } else { turning })
    }

    /// The part of a step that no object goes farther in than it may without meeting what is not looked at yet.
    pub fn part_of_step(
        &self,
        motions: &[f64],
        (model, pairs): (&impl Compliant, &Pairs),
        scene: &Scene,
        near: f64,
    ) -> f64 {
        let mut part = 1.0_f64;
        for (object, motion) in self.list.iter().zip(motions.chunks_exact(6)) {
            let [shift, turn] = [0, 3].map(|i| motion[i].hypot(motion[i + 1]).hypot(motion[i + 2]));
            let way = shift + turn * object.reach;
            if turn > 0.3 {
                part = part.min(0.3 / turn);
            }
            if way <= near {
                continue;
            }
            let mut room = f64::INFINITY;
            for (number, obstacle) in scene.iter() {
                let touches = |pair: &ObjectPair| {
                    [(pair.owner, pair.other), (pair.other, pair.owner)]
                        .contains(&(object.number, number))
                };
                if number != object.number && !self.near.iter().any(touches) {
                    let apart = obstacle.surface(object.pose.position).distance - object.reach;
                    let apart = if apart > near { apart } else { self.gap(object, number, scene) };
                    room = room.min(apart);
                }
            }
            room = room.min(pairs.room(model, object.number, scene.get(object.number)));
            part = part.min(room.max(0.5 * near) / way);
        }
        part
    }

    /// Moves them by a part of a step.
    pub fn advance(&mut self, motions: &[f64], part: f64, scene: &mut Scene) {
        for (object, motion) in self.list.iter_mut().zip(motions.chunks_exact(6)) {
            let [shift, turn] = [0, 3].map(|i| Vec3::new(motion[i], motion[i + 1], motion[i + 2]));
            object.pose.position += shift * part;
            object.pose.rotation = UnitQuaternion::exp(turn * part) * object.pose.rotation;
        }
        self.place(scene);
    }

    /// A step on the way begins.
    pub fn begin_step(&mut self, scene: &Scene) {
        for object in &mut self.list {
            object.began = object.pose;
        }
        for k in 0..self.near.len() {
            let from = self.pose_of(self.near[k].owner, scene);
            if let Some(grip) = &mut self.near[k].grip {
                grip.from = from;
            }
        }
    }

    /// The poses of an answer, and what is left of the balance.
    pub fn states(&self, pairs: &Pairs, base: &Pose) -> Vec<ObjectState> {
        let margin = |number: usize| {
            let robot = pairs.near.iter().filter(|pair| pair.obstacle == number);
            let own = self.near.iter().filter(|pair| [pair.owner, pair.other].contains(&number));
            let all =
                robot.map(|pair| (pair.force, pair.grip)).chain(own.map(|p| (p.force, p.grip)));
            let touching = all.filter(|&(force, _)| force > 0.0);
            let of = |(force, grip): (f64, Option<Grip>)| {
                let grip = grip?;
                Some((1.0 - grip.traction.norm() / (grip.coefficient * force)).clamp(0.0, 1.0))
            };
            touching.filter_map(of).min_by(f64::total_cmp)
        };
        let of = |object: &Object| {
            let turned = |wrench: Wrench| Wrench {
                force: base.rotation.rotate(wrench.force),
                moment: base.rotation.rotate(wrench.moment),
            };
            ObjectState {
                obstacle: object.number,
                pose: *base * object.obstacle_pose(),
                center_of_mass: base.transform(object.pose.position),
                load: turned(object.load),
                imbalance: turned(object.imbalance),
                slip_margin: margin(object.number),
                contacts: self.contacts_of(object.number, base),
            }
        };
        self.list.iter().map(of).collect()
    }
}

impl Pair {
    /// The force on the robot in N.
    pub fn total(&self) -> Vec3 {
        self.nearest.normal * self.force + self.grip.map_or(Vec3::ZERO, |grip| grip.traction)
    }
}
