//! Loads on paper: arrows, combs, weights, and which way gravity pulls.

use whipcord::Vec3;

use crate::acting::{Acting, Kind};
use crate::colour::Colour;
use crate::legend::{Entry, Swatch};
use crate::marker::{self, Marker};
use crate::projection::Projection;
use crate::svg::{Fill, Point, Stroke, Svg};

/// Length of the longest arrow of single forces, of moments, and of the teeth of a comb, relative
/// to the extent of the robot.
const FORCE: f64 = 0.2;
const MOMENT: f64 = 0.15;
const COMB: f64 = 0.1;
/// No arrow is shorter than this part of the longest of its kind.
const SHORTEST: f64 = 0.3;
/// Length of the arrow of gravity in px.
const GRAVITY: f64 = 26.0;
/// Its distance from the corner that it is drawn in, in px.
const CORNER: f64 = 20.0;
/// Teeth of a comb are no closer than this in px.
const TEETH: f64 = 9.0;
/// An arrow that is shorter than this in px points to the viewer or away.
const END_ON: f64 = 4.0;

/// Colour of loads, and of gravity.
const LOAD: Colour = Colour::INK;
const WEIGHT: Colour = Colour::GREY;

/// How an arrow is drawn.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ArrowLook {
    pub colour: Colour,
    pub width: f64,
    /// One for forces, two for moments, which turn about the arrow as a right-handed screw.
    pub heads: u8,
    /// Of a load that follows the body.
    pub hollow: bool,
}

#[derive(Clone, Debug)]
struct Arrow {
    tail: Vec3,
    head: Vec3,
    look: ArrowLook,
}

#[derive(Clone, Debug)]
struct Comb {
    /// Places on the backbone and beside it.
    teeth: Vec<(Vec3, Vec3)>,
    look: ArrowLook,
}

/// Loads in the size in which they are drawn.
#[derive(Clone, Debug, Default)]
pub(crate) struct LoadMarks {
    arrows: Vec<Arrow>,
    combs: Vec<Comb>,
    masses: Vec<Vec3>,
    gravity: Option<Vec3>,
}

impl ArrowLook {
    const fn of(kind: Kind, follows: bool, width: f64) -> Self {
        let heads = match kind {
            Kind::Force => 1,
            Kind::Moment => 2,
        };
        Self { colour: LOAD, width, heads, hollow: follows }
    }

    const fn single(kind: Kind, follows: bool) -> Self {
        Self::of(kind, follows, 1.8)
    }

    const fn tooth(kind: Kind, follows: bool) -> Self {
        Self::of(kind, follows, 0.9)
    }

    const GRAVITY: Self = Self { colour: WEIGHT, width: 1.8, heads: 1, hollow: false };
}

impl LoadMarks {
    /// For a robot of this extent in m.
    pub fn new(acting: &Acting, extent: f64) -> Self {
        let arrows = acting.single.iter().map(|load| {
            let longest = extent * if load.kind == Kind::Force { FORCE } else { MOMENT };
            let size = load.vector.norm();
            let share = (size / acting.largest_single(load.kind)).max(SHORTEST);
            let reach = load.vector / size * (longest * share);
            let (tail, head) =
                if load.presses { (load.at - reach, load.at) } else { (load.at, load.at + reach) };
            Arrow { tail, head, look: ArrowLook::single(load.kind, load.follows) }
        });
        let combs = acting.spread.iter().map(|load| {
            let scale = COMB * extent / acting.largest_spread(load.kind);
            let tooth = |&(at, vector): &(Vec3, Vec3)| (at, at - vector * scale);
            Comb {
                teeth: load.places.iter().map(tooth).collect(),
                look: ArrowLook::tooth(load.kind, load.follows),
            }
        });
        Self {
            arrows: arrows.collect(),
            combs: combs.collect(),
            masses: acting.masses.iter().map(|mass| mass.at).collect(),
            gravity: acting.gravity.map(|g| g / g.norm()),
        }
    }

    /// Points that span what is drawn of them.
    pub fn outline(&self) -> impl Iterator<Item = Vec3> + '_ {
        let arrows = self.arrows.iter().flat_map(|arrow| [arrow.tail, arrow.head]);
        arrows.chain(self.combs.iter().flat_map(|comb| comb.teeth.iter().map(|tooth| tooth.1)))
    }

    /// What the marks mean and how large the loads are.
    pub fn legend(acting: &Acting) -> Vec<Entry> {
        let entry = |label: String, swatch| Entry { label, swatches: vec![swatch] };
        let words = |words: String, follows| {
            if follows { format!("{words}, follows the body") } else { words }
        };
        let single = acting.single_kinds().map(|(kind, follows, text)| {
            entry(words(text, follows), Swatch::Arrow(ArrowLook::single(kind, follows)))
        });
        let spread = acting.spread_kinds().map(|(kind, follows, text)| {
            entry(words(text, follows), Swatch::Comb(ArrowLook::tooth(kind, follows)))
        });
        let masses = acting
            .masses_in_words()
            .map(|text| entry(text, Swatch::Marker(Marker::Square, Fill::new(LOAD), None)));
        let gravity = acting.gravity.map(|g| {
            let label = format!("gravity {} m/s²", crate::unit::digits(g.norm()));
            entry(label, Swatch::Arrow(ArrowLook::GRAVITY))
        });
        single.chain(spread).chain(masses).chain(gravity).collect()
    }

    /// Draws all but gravity over the robot.
    pub fn draw(&self, svg: &mut Svg, view: &Projection) {
        if self.arrows.is_empty() && self.combs.is_empty() && self.masses.is_empty() {
            return;
        }
        svg.open("loads");
        for comb in &self.combs {
            comb.draw(svg, view);
        }
        for &at in &self.masses {
            let rim = Some(Stroke::new(Colour::WHITE, 0.8));
            marker::draw(svg, Marker::Square, view.place(at), 4.5, Fill::new(LOAD), rim);
        }
        for arrow in &self.arrows {
            let towards = view.depth(arrow.head) - view.depth(arrow.tail);
            draw_arrow(svg, view.place(arrow.tail), view.place(arrow.head), towards, arrow.look);
        }
        svg.close();
    }

    /// Draws which way gravity pulls, around this place.
    pub fn draw_gravity(&self, svg: &mut Svg, view: &Projection, [x, y]: Point) {
        let Some(direction) = self.gravity else { return };
        let [right, up] = view.plane(direction).map(|c| 0.5 * GRAVITY * c);
        svg.open("gravity");
        let towards = view.depth(direction);
        draw_arrow(svg, [x - right, y + up], [x + right, y - up], towards, ArrowLook::GRAVITY);
        svg.close();
    }

    /// The same in the corner of a box that is farthest from all points of the robot.
    pub fn draw_gravity_in(
        &self,
        svg: &mut Svg,
        view: &Projection,
        ([left, top], [width, height]): (Point, Point),
        points: &[Vec3],
    ) {
        if self.gravity.is_none() {
            return;
        }
        let corner = |right: bool, below: bool| {
            let x = if right { left + width - CORNER } else { left + CORNER };
            let y = if below { top + height - CORNER } else { top + CORNER };
            [x, y]
        };
        let corners = [(true, false), (false, false), (true, true), (false, true)];
        let places: Vec<Point> = points.iter().map(|&p| view.place(p)).collect();
        let room = |[x, y]: Point| {
            let distances = places.iter().map(|p| (p[0] - x).hypot(p[1] - y));
            distances.fold(f64::INFINITY, f64::min)
        };
        let freest = corners
            .map(|(right, below)| corner(right, below))
            .into_iter()
            .max_by(|&a, &b| room(a).total_cmp(&room(b)));
        if let Some(at) = freest {
            self.draw_gravity(svg, view, at);
        }
    }
}

impl Comb {
    fn draw(&self, svg: &mut Svg, view: &Projection) {
        let backs: Vec<Point> = self.teeth.iter().map(|tooth| view.place(tooth.1)).collect();
        let stroke = Stroke::new(self.look.colour, self.look.width);
        svg.polyline(&backs, stroke, "comb");
        let mut last: Option<Point> = None;
        for (i, &(foot, back)) in self.teeth.iter().enumerate() {
            let (head, tail) = (view.place(foot), view.place(back));
            let far = last.is_none_or(|p| (p[0] - head[0]).hypot(p[1] - head[1]) >= TEETH);
            if !far && i + 1 < self.teeth.len() || foot == back {
                continue;
            }
            last = Some(head);
            draw_arrow(svg, tail, head, view.depth(foot) - view.depth(back), self.look);
        }
    }
}

/// An arrow, or its point or its feathers in a circle where it is seen end-on.
pub(crate) fn draw_arrow(svg: &mut Svg, tail: Point, head: Point, towards: f64, look: ArrowLook) {
    let (dx, dy) = (head[0] - tail[0], head[1] - tail[1]);
    let length = dx.hypot(dy);
    let stroke = Stroke::new(look.colour, look.width);
    if length < END_ON {
        let [x, y] = head;
        let r = if look.width > 1.0 { 4.5 } else { 2.4 };
        let rim = Stroke::new(look.colour, 0.6 * look.width);
        svg.circle(head, r, Some(Fill::new(Colour::WHITE)), Some(rim));
        if towards >= 0.0 {
            svg.circle(head, 0.35 * r, Some(Fill::new(look.colour)), None);
        } else {
            let d = 0.7 * r;
            svg.line([x - d, y - d], [x + d, y + d], rim);
            svg.line([x - d, y + d], [x + d, y - d], rim);
        }
        return;
    }
    let (ux, uy) = (dx / length, dy / length);
    let size = (3.0 + 2.8 * look.width).min(0.7 * length / f64::from(look.heads));
    let heads = f64::from(look.heads) * size;
    svg.line(tail, [head[0] - heads * ux, head[1] - heads * uy], stroke);
    for k in 0..look.heads {
        let back = f64::from(k) * size;
        let tip = [head[0] - back * ux, head[1] - back * uy];
        let base = [tip[0] - size * ux, tip[1] - size * uy];
        let half = 0.38 * size;
        let corners = [
            tip,
            [base[0] - half * uy, base[1] + half * ux],
            [base[0] + half * uy, base[1] - half * ux],
        ];
        let rim = Stroke::new(look.colour, 0.5 * look.width);
        let fill = if look.hollow { Colour::WHITE } else { look.colour };
        svg.polygon(&corners, Some(Fill::new(fill)), Some(rim));
    }
}
