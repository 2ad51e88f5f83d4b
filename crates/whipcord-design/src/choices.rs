//! Which holes the cables of a design may go through.

use whipcord::{Robot, Routing};

use crate::error::DesignError;

/// A hole that a cable goes through in any case.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FixedHole {
    /// Which of the varied cables, by its place in the list of them.
    pub cable: usize,
    /// Disk, from 0.
    pub disk: usize,
    /// Hole, from 1.
    pub hole: usize,
}

/// What can be manufactured.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct HoleRules {
    /// Holes by which a cable may move from a disk to the next, either way; `None` does not limit it.
    pub largest_jump: Option<usize>,
    /// Holes that are given.
    pub fixed: Vec<FixedHole>,
    /// Whether no two cables may share a hole, with those that are not varied where these have lists of holes.
    pub are_distinct: bool,
    /// Whether the varied cables must not cross one another between two disks.
    pub do_not_cross: bool,
}

/// Varied cables that are not chosen together with others.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Apart<'a> {
    /// Those whose lists the robot has already: the others must not cross them where rules say so.
    pub held: &'a [usize],
    /// Those that are chosen afterwards, whose holes do not count yet.
    pub later: &'a [usize],
}

/// The combined choices of all varied cables at one disk, by numbers in mixed radix, and which of them the rules allow.
#[derive(Clone, Debug)]
pub(crate) struct Choices {
    pub holes: usize,
    pub cables: Vec<usize>,
    /// Number of combinations at a disk.
    pub count: usize,
    /// By disks: which combinations are allowed.
    allowed: Vec<Vec<usize>>,
    /// From each combination to which at the next disk.
    next: Vec<Vec<usize>>,
    /// Of each combination the number of its first pair with one of the next disk: pairs count on through [`Self::next`].
    first_pairs: Vec<usize>,
    /// By cables that must not be crossed: their holes from 0 at the disks.
    held: Vec<Vec<usize>>,
}

/// Combinations of holes at a disk that are looked at.
const MOST: usize = 2_000;

impl Choices {
    pub fn new(robot: &Robot, cables: &[usize], rules: &HoleRules) -> Result<Self, DesignError> {
        Self::beside(robot, cables, rules, Apart::default())
    }

    /// Those of some of the varied cables, beside the others.
    pub fn beside(
        robot: &Robot,
        cables: &[usize],
        rules: &HoleRules,
        apart: Apart<'_>,
    ) -> Result<Self, DesignError> {
        let holes = robot.disks().holes.filter(|holes| *holes > 0).ok_or(DesignError::NoHoles)?;
        let disks = robot.disks().count();
        if cables.is_empty() {
            return Err(DesignError::NoCables);
        }
        for (place, &cable) in cables.iter().enumerate() {
            if cable >= robot.cables().len() || cables[..place].contains(&cable) {
                let cables = robot.cables().len();
                return Err(DesignError::NoSuchCable { cable, cables });
            }
        }
        for &FixedHole { cable, disk, hole } in &rules.fixed {
            if cable >= cables.len() || disk >= disks || hole == 0 || hole > holes {
                return Err(DesignError::NoSuchHole { hole, disk, holes, disks });
            }
        }
        let power = u32::try_from(cables.len()).unwrap_or(u32::MAX);
        let count = holes.checked_pow(power).filter(|count| *count <= MOST);
        let Some(count) = count else {
            return Err(DesignError::TooManySpans {
                spans: holes.saturating_pow(power.saturating_mul(2)),
                most: MOST,
            });
        };
        let mut choices = Self {
            holes,
            cables: cables.to_vec(),
            count,
            allowed: Vec::new(),
            next: Vec::new(),
            first_pairs: Vec::new(),
            held: match rules.do_not_cross {
                true => apart.held.iter().filter_map(|of| listed(robot, *of)).collect(),
                false => Vec::new(),
            },
        };
        choices.allowed = (0..disks)
            .map(|disk| {
                let taken = choices.taken(robot, disk, apart.later);
                (0..count).filter(|&choice| choices.allows(choice, disk, rules, &taken)).collect()
            })
            .collect();
        if let Some(disk) = choices.allowed.iter().position(Vec::is_empty) {
            return Err(DesignError::NoChoice { disk });
        }
        choices.next = (0..count)
            .map(|from| (0..count).filter(|&to| choices.may_follow(from, to, rules)).collect())
            .collect();
        let mut pairs = 0;
        for next in &choices.next {
            choices.first_pairs.push(pairs);
            pairs += next.len();
        }
        Ok(choices)
    }

    /// The hole of one of the cables in a combination, from 0.
    pub const fn hole(&self, choice: usize, place: usize) -> usize {
        let mut rest = choice;
        let mut k = 0;
        while k < place {
            rest /= self.holes;
            k += 1;
        }
        rest % self.holes
    }

    /// The combination of these holes, from 0.
    pub fn combined(&self, hole: impl Fn(usize) -> usize) -> usize {
        (0..self.cables.len()).rev().fold(0, |sum, place| sum * self.holes + hole(place))
    }

    /// What may be chosen at a disk.
    pub fn at(&self, disk: usize) -> &[usize] {
        &self.allowed[disk]
    }

    /// The combination with each cable so many holes on, counter-clockwise.
    pub fn rotated(&self, choice: usize, by: usize) -> usize {
        self.combined(|place| (self.hole(choice, place) + by) % self.holes)
    }

    /// What may be chosen at a disk behind this at the disk before.
    pub fn after(&self, choice: usize, disk: usize) -> impl Iterator<Item = usize> + '_ {
        self.pairs_after(choice, disk).map(|(_, next)| next)
    }

    /// The same, each behind the number of the pair.
    pub fn pairs_after(
        &self,
        choice: usize,
        disk: usize,
    ) -> impl Iterator<Item = (usize, usize)> + '_ {
        let allowed = &self.allowed[disk];
        let is_free = allowed.len() == self.count;
        let first = self.first_pairs[choice];
        let next = self.next[choice].iter().enumerate();
        next.map(move |(number, &next)| (first + number, next))
            .filter(move |(_, next)| is_free || allowed.binary_search(next).is_ok())
            .filter(move |(_, next)| !self.crosses_held(choice, *next, disk))
    }

    /// What may follow a combination by the rules of neighbouring disks alone, with the number of the first pair: pairs count on.
    pub fn followers(&self, choice: usize) -> (usize, &[usize]) {
        (self.first_pairs[choice], &self.next[choice])
    }

    /// The number of a pair of combinations, if the second may follow the first.
    pub fn pair(&self, from: usize, to: usize) -> Option<usize> {
        self.next[from].binary_search(&to).ok().map(|number| self.first_pairs[from] + number)
    }

    /// Pairs of combinations that follow one another.
    pub fn pairs(&self) -> usize {
        self.next.iter().map(Vec::len).sum()
    }

    /// The disk at which the rules leave no way on, if there is one.
    pub fn dead_end(&self) -> Option<usize> {
        let mut reachable = self.allowed[0].clone();
        for disk in 1..self.allowed.len() {
            let mut next: Vec<usize> =
                reachable.iter().flat_map(|&choice| self.after(choice, disk)).collect();
            next.sort_unstable();
            next.dedup();
            if next.is_empty() {
                return Some(disk);
            }
            reachable = next;
        }
        None
    }

    /// The list that the robot has, where its varied cables have one that the rules allow.
    pub fn own_list(&self, robot: &Robot) -> Option<Vec<usize>> {
        let lists: Vec<Vec<usize>> =
            self.cables.iter().map(|cable| listed(robot, *cable)).collect::<Option<_>>()?;
        let at = |disk: usize| {
            let holes: Option<Vec<usize>> =
                lists.iter().map(|list| list.get(disk).copied()).collect();
            holes.map(|holes| self.combined(|place| holes[place]))
        };
        let list: Vec<usize> = (0..robot.disks().count()).map(at).collect::<Option<_>>()?;
        self.allows_list(&list).then_some(list)
    }

    /// Whether the rules allow a list of combinations.
    pub fn allows_list(&self, list: &[usize]) -> bool {
        let is_first = list.first().is_none_or(|first| self.at(0).binary_search(first).is_ok());
        let mut pairs = list.windows(2).enumerate();
        is_first && pairs.all(|(k, pair)| self.after(pair[0], k + 1).any(|next| next == pair[1]))
    }

    /// Holes of other cables, from 0, but of those that are chosen afterwards.
    fn taken(&self, robot: &Robot, disk: usize, later: &[usize]) -> Vec<usize> {
        let others = 0..robot.cables().len();
        let others = others.filter(|of| !self.cables.contains(of) && !later.contains(of));
        others.filter_map(|cable| listed(robot, cable)?.get(disk).copied()).collect()
    }

    fn allows(&self, choice: usize, disk: usize, rules: &HoleRules, taken: &[usize]) -> bool {
        let places = 0..self.cables.len();
        let keeps = |fixed: &FixedHole| {
            fixed.disk != disk || self.hole(choice, fixed.cable) == fixed.hole - 1
        };
        let is_apart = |place: usize| {
            let hole = self.hole(choice, place);
            !taken.contains(&hole) && (0..place).all(|other| self.hole(choice, other) != hole)
        };
        rules.fixed.iter().all(keeps) && (!rules.are_distinct || places.clone().all(is_apart))
    }

    fn may_follow(&self, from: usize, to: usize, rules: &HoleRules) -> bool {
        let jump = |place: usize| self.jump(self.hole(from, place), self.hole(to, place));
        let places = 0..self.cables.len();
        let is_near =
            |place| rules.largest_jump.is_none_or(|largest| jump(place).unsigned_abs() <= largest);
        if !places.clone().all(is_near) {
            return false;
        }
        !rules.do_not_cross
            || places.clone().all(|b| (0..b).all(|a| !self.crosses(from, to, (a, b))))
    }

    /// Holes from one to another the shorter way, positive counter-clockwise.
    pub fn jump(&self, from: usize, to: usize) -> isize {
        let ahead = (to + self.holes - from) % self.holes;
        let (ahead, holes) = (ahead.cast_signed(), self.holes.cast_signed());
        if 2 * ahead > holes { ahead - holes } else { ahead }
    }

    /// Whether two cables change sides between two disks.
    fn crosses(&self, from: usize, to: usize, (a, b): (usize, usize)) -> bool {
        let way = |place| [self.hole(from, place), self.hole(to, place)];
        self.ways_cross(way(a), way(b))
    }

    /// Whether a cable crosses one that is held, before a disk.
    fn crosses_held(&self, from: usize, to: usize, disk: usize) -> bool {
        let ways =
            self.held.iter().filter_map(|list| Some([*list.get(disk - 1)?, *list.get(disk)?]));
        ways.into_iter().any(|held| {
            let mut places = 0..self.cables.len();
            places.any(|of| self.ways_cross([self.hole(from, of), self.hole(to, of)], held))
        })
    }

    /// Whether ways from a hole to one of the next disk change sides.
    fn ways_cross(&self, [start_a, end_a]: [usize; 2], [start_b, end_b]: [usize; 2]) -> bool {
        let apart = ((start_b + self.holes - start_a) % self.holes).cast_signed();
        let then = apart + self.jump(start_b, end_b) - self.jump(start_a, end_a);
        let holes = self.holes.cast_signed();
        // Cables in one hole cross where they leave it apart from one another only by choice of the designer.
        apart != 0 && (then <= 0 || then >= holes)
    }
}

/// The holes of a cable from 0, where it has a list of them.
fn listed(robot: &Robot, cable: usize) -> Option<Vec<usize>> {
    match &robot.cables().get(cable)?.routing {
        Routing::Holes { holes, .. } => Some(holes.iter().map(|hole| hole - 1).collect()),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use whipcord::{Backbone, Cable, Disks};

    fn robot(cables: usize) -> Robot {
        let cable = |k: usize| Cable::new(format!("{k}"), Routing::holes(vec![1 + k; 3]));
        let disks = Disks::equally_spaced(0.1, 3, 0.008).with_holes(12);
        Robot::new(Backbone::new(0.1), disks, (0..cables).map(cable).collect()).unwrap()
    }

    #[test]
    fn jumps_take_the_shorter_way() {
        let choices = Choices::new(&robot(1), &[0], &HoleRules::default()).unwrap();
        assert_eq!(choices.jump(11, 1), 2);
        assert_eq!(choices.jump(1, 11), -2);
        assert_eq!(choices.jump(0, 6), 6);
        let rules = HoleRules { largest_jump: Some(2), ..HoleRules::default() };
        let choices = Choices::new(&robot(1), &[0], &rules).unwrap();
        assert_eq!(choices.after(11, 1).collect::<Vec<_>>(), [0, 1, 9, 10, 11]);
        assert_eq!(choices.pairs(), 12 * 5);
    }

    #[test]
    fn cables_that_change_sides_cross() {
        let rules = HoleRules { do_not_cross: true, ..HoleRules::default() };
        let choices = Choices::new(&robot(2), &[0, 1], &rules).unwrap();
        let of = |a: usize, b: usize| choices.combined(|place| [a, b][place]);
        let follows = |from, to| choices.after(from, 1).any(|next| next == to);
        assert!(follows(of(0, 3), of(2, 4)));
        assert!(!follows(of(0, 3), of(4, 3)));
        assert!(!follows(of(0, 3), of(0, 0)));
        // Round the other side.
        assert!(!follows(of(0, 10), of(10, 10)) && follows(of(0, 10), of(11, 10)));
    }

    #[test]
    fn rules_that_leave_nothing_are_found() {
        let fixed = |disk, hole| FixedHole { cable: 0, disk, hole };
        let rules = HoleRules {
            largest_jump: Some(1),
            fixed: vec![fixed(0, 1), fixed(2, 7)],
            ..HoleRules::default()
        };
        let choices = Choices::new(&robot(1), &[0], &rules).unwrap();
        assert_eq!(choices.dead_end(), Some(2));
        // The hole of a cable that stays.
        let rules =
            HoleRules { are_distinct: true, fixed: vec![fixed(1, 2)], ..HoleRules::default() };
        let refused = Choices::new(&robot(2), &[0], &rules);
        assert!(matches!(refused, Err(DesignError::NoChoice { disk: 1 })));
    }

    #[test]
    fn cables_that_are_held_are_not_crossed_and_those_to_come_do_not_count() {
        let robot = robot(2);
        let rules = HoleRules { do_not_cross: true, are_distinct: true, ..HoleRules::default() };
        // The other one is straight through hole 2.
        let held = Apart { held: &[1], later: &[] };
        let choices = Choices::beside(&robot, &[0], &rules, held).unwrap();
        let follows = |choices: &Choices, from, to| choices.after(from, 1).any(|next| next == to);
        assert!(follows(&choices, 0, 11) && !follows(&choices, 0, 2) && !follows(&choices, 0, 1));
        assert!(choices.own_list(&robot).is_some() && !choices.allows_list(&[0, 2, 2]));
        let later = Apart { held: &[], later: &[1] };
        let choices = Choices::beside(&robot, &[0], &rules, later).unwrap();
        assert!(follows(&choices, 0, 2) && follows(&choices, 0, 1));
    }
}
