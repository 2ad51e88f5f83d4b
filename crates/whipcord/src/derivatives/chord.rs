//! A cable that runs straight from hole to hole: what it exerts and how long it is, once its ends have moved, (d6) of [`super::spans`].

use whipcord_numerics::Vec3;

use super::effect::Effect;

/// A cable between two disks at the answer, base frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct Chord {
    pub cable: usize,
    pub tension: f64,
    pub length: f64,
    /// The kept node of its span where it ends, and whether it is anchored there.
    pub end: usize,
    pub is_anchored: bool,
    /// `t`, `a` and `b`.
    pub along: Vec3,
    pub near: Vec3,
    pub far: Vec3,
    /// How the angles in the near and in the far hole change with the direction, where cables rub there.
    pub turns: [Vec3; 2],
}

/// What a chord adds to the outputs of its span: to the length of its cable, and to the angles in its near and far hole.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Stretched {
    pub length: f64,
    pub turns: [f64; 2],
}

impl Stretched {
    /// Adds it to the outputs of a span with so many cables; to those that are asked for.
    pub fn add_to(&self, cable: usize, cables: usize, outputs: &mut [f64]) {
        let [near, far] = self.turns;
        for (row, by) in [self.length, near, far].into_iter().enumerate() {
            if let Some(output) = outputs.get_mut(row * cables + cable) {
                *output += by;
            }
        }
    }
}

/// Changes that what acts on a chord's ends and in it makes at constant direction.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ChordChange {
    pub tension: f64,
    /// Of the holes, base frame.
    pub near: Vec3,
    pub far: Vec3,
}

/// What a chord exerts: force, and moments at its ends.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Pull {
    pub force: Vec3,
    pub near: Vec3,
    pub far: Vec3,
}

/// What the chords of a span exert at the near and at the far disk: force and moment.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Pulls {
    pub near: [Vec3; 2],
    pub far: [Vec3; 2],
}

impl Chord {
    /// The change of what it exerts once its end has moved so against the near disk, (d6), and that of its length.
    pub fn respond(&self, near_turn: Vec3, end: &Effect, change: ChordChange) -> (Pull, Stretched) {
        let Self { along: t, near: a, far: b, tension, .. } = *self;
        let (da, db) = (near_turn.cross(a) + change.near, end.turn.cross(b) + change.far);
        let way = end.shift + db - da;
        let longer = t.dot(way);
        let turned = way - t * longer;
        let force = change.tension * t + turned * (tension / self.length);
        let near = a.cross(force) + tension * da.cross(t);
        let turns = self.turns.map(|slope| slope.dot(turned) / self.length);
        let stretched = Stretched { length: longer, turns };
        (Pull { force, near, far: b.cross(force) + tension * db.cross(t) }, stretched)
    }
}
