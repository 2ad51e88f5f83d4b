//! The nearest point of a body of triangles.

use std::collections::HashMap;

use whipcord_numerics::Vec3;

/// Triangles in one leaf of the tree.
const LEAF: usize = 2;

/// A part of a triangle: its face, or one of its edges or corners. Edge i goes from corner i to the next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Part {
    Face,
    Edge(usize),
    Corner(usize),
}

/// The nearest point of a body.
#[derive(Clone, Copy, Debug)]
pub(super) struct Nearest {
    pub point: Vec3,
    pub triangle: usize,
    pub part: Part,
}

/// A box around all triangles below a node of the tree.
#[derive(Clone, Copy, Debug)]
struct Node {
    low: Vec3,
    high: Vec3,
    /// Of a leaf its first triangle in the order of the tree; of others the node of its second half: that of the first
    /// half is the next node.
    first: u32,
    /// Triangles of a leaf; none of others.
    count: u32,
}

impl Node {
    /// Square of the distance of a point from the box.
    fn distance_squared(&self, p: Vec3) -> f64 {
        let beyond = |low: f64, high: f64, x: f64| (low - x).max(x - high).max(0.0);
        Vec3::new(
            beyond(self.low.x, self.high.x, p.x),
            beyond(self.low.y, self.high.y, p.y),
            beyond(self.low.z, self.high.z, p.z),
        )
        .norm_squared()
    }
}

/// Triangles in a tree of boxes, each halved at the middle triangle along its longest side.
#[derive(Clone, Debug)]
pub(super) struct Tree {
    nodes: Vec<Node>,
    order: Vec<u32>,
}

impl Tree {
    pub fn new(vertices: &[Vec3], triangles: &[[u32; 3]]) -> Self {
        let middles: Vec<Vec3> = triangles
            .iter()
            .map(|corners| {
                let [a, b, c] = corners.map(|k| vertices[k as usize]);
                a + b + c
            })
            .collect();
        let mut tree = Self { nodes: Vec::new(), order: (0..triangles.len() as u32).collect() };
        let mut order = core::mem::take(&mut tree.order);
        let corner = |k: u32| vertices[k as usize];
        tree.add(&mut order, 0, &middles, &|triangle| triangles[triangle].map(corner));
        tree.order = order;
        tree
    }

    /// Adds a node for triangles that begin at place `first`, and all nodes below it.
    fn add(
        &mut self,
        order: &mut [u32],
        first: usize,
        middles: &[Vec3],
        corners: &impl Fn(usize) -> [Vec3; 3],
    ) {
        let inner = Vec3::new(f64::INFINITY, f64::INFINITY, f64::INFINITY);
        let (mut low, mut high) = (inner, -inner);
        for corner in order.iter().flat_map(|&k| corners(k as usize)) {
            low = Vec3::new(low.x.min(corner.x), low.y.min(corner.y), low.z.min(corner.z));
            high = Vec3::new(high.x.max(corner.x), high.y.max(corner.y), high.z.max(corner.z));
        }
        let this = self.nodes.len();
        self.nodes.push(Node { low, high, first: first as u32, count: order.len() as u32 });
        if order.len() <= LEAF {
            return;
        }
        let size = (high - low).to_array();
        let axis = (0..3).max_by(|&i, &j| size[i].total_cmp(&size[j])).unwrap_or(0);
        let along = |k: &u32| middles[*k as usize].to_array()[axis];
        let half = order.len() / 2;
        // Of triangles at one place the first is the one of the lower number, so that the tree is the same each time.
        order.select_nth_unstable_by(half, |a, b| along(a).total_cmp(&along(b)).then(a.cmp(b)));
        let (left, right) = order.split_at_mut(half);
        self.add(left, first, middles, corners);
        self.nodes[this].first = self.nodes.len() as u32;
        self.nodes[this].count = 0;
        self.add(right, first + half, middles, corners);
    }

    /// The nearest point of the triangles with these corners, those that the tree was made of.
    pub fn nearest(&self, p: Vec3, corners: impl Fn(usize) -> [Vec3; 3]) -> Nearest {
        let mut best = Nearest { point: p, triangle: 0, part: Part::Face };
        let mut least = f64::INFINITY;
        // Each level leaves one node, and twice the number of triangles has 32 bits.
        let mut waiting = [(0, 0.0); 40];
        let mut left = 1;
        while left > 0 {
            left -= 1;
            let (at, bound) = waiting[left];
            if bound >= least {
                continue;
            }
            let node = &self.nodes[at];
            if node.count > 0 {
                let first = node.first as usize;
                for &triangle in &self.order[first..first + node.count as usize] {
                    let triangle = triangle as usize;
                    let (point, part) = nearest_of_triangle(p, corners(triangle));
                    let distance = (p - point).norm_squared();
                    if distance < least {
                        (least, best) = (distance, Nearest { point, triangle, part });
                    }
                }
            } else {
                let halves = [at + 1, node.first as usize]
                    .map(|child| (child, self.nodes[child].distance_squared(p)));
                let [near, far] =
                    if halves[1].1 < halves[0].1 { [halves[1], halves[0]] } else { halves };
                waiting[left] = far;
                waiting[left + 1] = near;
                left += 2;
            }
        }
        best
    }
}

/// The nearest point of a triangle, by the Voronoi regions of its corners and edges (C. Ericson, Real-time collision
/// detection, 2005, section 5.1.5).
fn nearest_of_triangle(p: Vec3, [a, b, c]: [Vec3; 3]) -> (Vec3, Part) {
    let (ab, ac, bc) = (b - a, c - a, c - b);
    let (ap, bp, cp) = (p - a, p - b, p - c);
    let (ab_ap, ac_ap) = (ab.dot(ap), ac.dot(ap));
    if ab_ap <= 0.0 && ac_ap <= 0.0 {
        return (a, Part::Corner(0));
    }
    let (ab_bp, ac_bp) = (ab.dot(bp), ac.dot(bp));
    if ab_bp >= 0.0 && ac_bp <= ab_bp {
        return (b, Part::Corner(1));
    }
    let (ab_cp, ac_cp) = (ab.dot(cp), ac.dot(cp));
    if ac_cp >= 0.0 && ab_cp <= ac_cp {
        return (c, Part::Corner(2));
    }
    // Products with the normal are more precise than differences of products of the above.
    let normal = ab.cross(ac);
    let of_c = normal.dot(ab.cross(ap));
    if of_c < 0.0 && ab_ap >= 0.0 && ab_bp <= 0.0 {
        return (a + (ab_ap / ab.norm_squared()) * ab, Part::Edge(0));
    }
    let of_b = -normal.dot(ac.cross(cp));
    if of_b < 0.0 && ac_ap >= 0.0 && ac_cp <= 0.0 {
        return (a + (ac_ap / ac.norm_squared()) * ac, Part::Edge(2));
    }
    let of_a = normal.dot(bc.cross(bp));
    if of_a < 0.0 && ac_bp - ab_bp >= 0.0 && ab_cp - ac_cp >= 0.0 {
        return (b + (bc.dot(bp) / bc.norm_squared()) * bc, Part::Edge(1));
    }
    let sum = of_a + of_b + of_c;
    (a + (of_b / sum) * ab + (of_c / sum) * ac, Part::Face)
}

/// Normals of edges and corners that tell the inside from the outside: sums of the normals of the faces that meet there,
/// at a corner weighted by their angles. Not of unit length.
#[derive(Clone, Debug)]
pub(super) struct Pseudonormals {
    pub edges: Vec<[Vec3; 3]>,
    pub corners: Vec<Vec3>,
}

impl Pseudonormals {
    pub fn new(vertices: &[Vec3], triangles: &[[u32; 3]]) -> Self {
        let mut corners = vec![Vec3::ZERO; vertices.len()];
        let mut of_edge: HashMap<[u32; 2], Vec3> = HashMap::with_capacity(2 * triangles.len());
        let edge = |from: u32, to: u32| [from.min(to), from.max(to)];
        for &[a, b, c] in triangles {
            let [at_a, at_b, at_c] = [a, b, c].map(|k| vertices[k as usize]);
            let across = (at_b - at_a).cross(at_c - at_a);
            let normal = across / across.norm();
            let angle = |u: Vec3, v: Vec3| u.cross(v).norm().atan2(u.dot(v));
            corners[a as usize] += angle(at_b - at_a, at_c - at_a) * normal;
            corners[b as usize] += angle(at_a - at_b, at_c - at_b) * normal;
            corners[c as usize] += angle(at_b - at_c, at_a - at_c) * normal;
            for (from, to) in [(a, b), (b, c), (c, a)] {
                *of_edge.entry(edge(from, to)).or_insert(Vec3::ZERO) += normal;
            }
        }
        let of = |from, to| of_edge.get(&edge(from, to)).copied().unwrap_or(Vec3::ZERO);
        let edges = triangles.iter().map(|&[a, b, c]| [of(a, b), of(b, c), of(c, a)]).collect();
        Self { edges, corners }
    }
}
