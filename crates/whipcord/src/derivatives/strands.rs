//! Pieces of cable that have a tension of their own.
//!
//! Without friction that is every cable. A cable that rubs has a strand for every span or step, which the derivatives call a link; and beside
//! the lengths of the strands the angles by which the cables turn on the way to each of them are outputs.

use crate::statics::grid::SHOOTING_NODES;

/// Places along a step at which tensions are known: those of the shooting grid.
pub(crate) const PLACES: usize = SHOOTING_NODES.len();
/// A step has the tension of so many strands of a cable.
pub(super) const NEAR: usize = 3;

/// How the tension of a cable in a step comes about of those of strands near it; `usize::MAX` is none.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Share {
    pub strands: [usize; NEAR],
    /// By strands, then places.
    pub weights: [[f64; PLACES]; NEAR],
}

impl Share {
    /// Of one strand with this profile.
    pub fn own(strand: usize, profile: [f64; PLACES]) -> Self {
        let mut share = Self { strands: [usize::MAX; NEAR], weights: [[0.0; PLACES]; NEAR] };
        (share.strands[0], share.weights[0]) = (strand, profile);
        share
    }
}

/// Which strand each cable is in each link.
#[derive(Clone, Debug, Default)]
pub(crate) struct Strands {
    cables: usize,
    count: usize,
    /// Of cables that rub, by links, then cables; `usize::MAX` where the cable has ended. Empty where none rubs.
    of: Vec<usize>,
    /// The cable of each strand, where any rubs.
    cable_of: Vec<usize>,
    /// Where the tension varies within a link: by links, then cables.
    shares: Vec<Share>,
}

impl Strands {
    /// A strand for each cable.
    pub fn of_cables(cables: usize) -> Self {
        Self { cables, count: cables, ..Self::default() }
    }

    /// So many strands of cables that rub, by links.
    pub fn of_links(
        cables: usize,
        count: usize,
        links: usize,
        of: impl Fn(usize, usize) -> Option<usize>,
    ) -> Self {
        let cable_of = vec![0; count];
        let mut strands = Self { cables, count, cable_of, ..Self::default() };
        for link in 0..links {
            for cable in 0..cables {
                let strand = of(link, cable);
                if let Some(strand) = strand {
                    strands.cable_of[strand] = cable;
                }
                strands.of.push(strand.unwrap_or(usize::MAX));
            }
        }
        strands
    }

    /// The same, where the tensions within a link are these shares of those of strands.
    pub fn with_shares(self, shares: Vec<Share>) -> Self {
        Self { shares, ..self }
    }

    /// Whether any cable rubs.
    pub const fn rub(&self) -> bool {
        !self.of.is_empty()
    }

    pub const fn cables(&self) -> usize {
        self.cables
    }

    pub const fn count(&self) -> usize {
        self.count
    }

    /// The strand of a cable in a link.
    pub fn at(&self, link: usize, cable: usize) -> Option<usize> {
        if !self.rub() {
            return Some(cable);
        }
        self.of.get(link * self.cables + cable).copied().filter(|&strand| strand != usize::MAX)
    }

    /// How many inputs of a link are tensions.
    pub const fn inputs(&self) -> usize {
        if self.shares.is_empty() { self.cables } else { NEAR * self.cables }
    }

    /// The input of a link that is the tension of a strand.
    pub fn input(&self, link: usize, strand: usize) -> Option<usize> {
        let cable = self.cable_of.get(strand).copied().unwrap_or(strand);
        if self.shares.is_empty() {
            return (self.at(link, cable) == Some(strand)).then_some(cable);
        }
        let share = self.shares.get(link * self.cables + cable)?;
        let near = share.strands.iter().position(|&near| near == strand)?;
        Some(NEAR * cable + near)
    }

    /// The tension of a cable at a place of a link, of those of all strands.
    pub fn tension(&self, (link, cable): (usize, usize), place: usize, of: &[f64]) -> f64 {
        let Some(share) = self.shares.get(link * self.cables + cable) else {
            return self.at(link, cable).map_or(0.0, |strand| of[strand]);
        };
        let near = share.strands.iter().zip(&share.weights);
        near.filter_map(|(&strand, weights)| Some(of.get(strand)? * weights[place])).sum()
    }

    /// The weights of the inputs of a link at a place; none where they are 1.
    pub fn add_weights(&self, link: usize, place: usize, weights: &mut Vec<f64>) {
        let of_link = self.shares.iter().skip(link * self.cables).take(self.cables);
        weights.extend(of_link.flat_map(|share| share.weights.map(|by_place| by_place[place])));
    }

    /// How many outputs a link has: the lengths of the cables, and where they rub what it adds to their angles at its start and at its
    /// end.
    pub const fn rows(&self) -> usize {
        if self.rub() { 3 * self.cables } else { self.cables }
    }

    /// How many outputs there are: the lengths of the strands, and where cables rub their angles.
    pub const fn outputs(&self) -> usize {
        if self.rub() { 2 * self.count } else { self.count }
    }

    /// The output to which a link adds one of its own.
    pub fn output(&self, link: usize, row: usize) -> Option<usize> {
        let cable = row % self.cables.max(1);
        match row / self.cables.max(1) {
            0 => self.at(link, cable),
            1 => Some(self.count + self.at(link, cable)?),
            // A cable that rubs nowhere is one strand in all links, and its angle is none.
            _ => Some(self.count + self.at(link + 1, cable)?),
        }
    }
}
