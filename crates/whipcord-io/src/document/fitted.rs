//! The text of a robot file with other numbers in it.

use std::path::{Component, Path, PathBuf};

use whipcord::{Case, Robot, UnitQuaternion, Vec3};
use whipcord_estimation::Observation;
use whipcord_motion::Initial;

use super::describe::{Inexpressible, describe};
use super::{Item, Table, describe_goal, describe_motion, toml};
use crate::case_file::{CaseFile, parse};
use crate::node::{Node, Value};
use crate::read::{DesignShape, Goal};
use crate::source::Span;
use crate::units::with_number;

/// A robot file that says what was fitted.
#[derive(Clone, Debug, PartialEq)]
pub struct FittedFile {
    /// Its text.
    pub text: String,
    /// Whether it is the text of the old file with other numbers, units and comments kept; else it is
    /// written anew and has only robot, case, target and limits.
    pub keeps_text: bool,
}

/// How what was measured sits on the robot, beside what the file says of it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Mounting {
    /// Added to where the markers are in the frames of their places, in m.
    pub offset: Vec3,
    /// The rotation of the tracked body in the frame of its place, where it was estimated.
    pub body: Option<UnitQuaternion>,
}

impl From<Vec3> for Mounting {
    fn from(offset: Vec3) -> Self {
        Self { offset, body: None }
    }
}

/// What only a table of commands says.
pub const LOADS_OF_ROWS: &str =
    "loads that differ from step to step, as the rows of its table have them";

/// How near a number that is read again must be to the one that was written.
const NEAR: f64 = 1e-9;

impl CaseFile {
    /// The text of this file with the numbers of another robot and case, for the folder it goes to: where
    /// the numbers stand in this file they are changed in place, in their units; where they stand in one that it
    /// extends, a table is laid over that; else the file is written anew. `[measured]` gets the mounting.
    ///
    /// # Errors
    /// [`Inexpressible`] for what no robot file can say.
    pub fn with_numbers_of(
        &self,
        robot: &Robot,
        case: &Case,
        mounting: impl Into<Mounting>,
        folder: &Path,
    ) -> Result<FittedFile, Inexpressible> {
        let mounting = mounting.into();
        let new = describe(None, robot, case)?;
        let old = describe(None, &self.robot, &self.case)?;
        if let Some(text) = self.edited(&old, &new, mounting, folder) {
            // The proof of the text is in reading it, where the files are that it names.
            let name = folder.join("fitted.toml");
            let again = parse(&text, &name).ok().filter(|again| self.is_moved(again, mounting));
            let again = again.and_then(|again| describe(None, &again.robot, &again.case).ok());
            if again.is_some_and(|again| is_near(&Item::Table(again), &Item::Table(new.clone()))) {
                return Ok(FittedFile { text, keeps_text: true });
            }
        }
        if !case.loads_before.is_empty() {
            let what = LOADS_OF_ROWS;
            return Err(Inexpressible { what });
        }
        let mut file = Table::default();
        file.insert("title", self.title.as_str());
        file.entries.extend(new.entries);
        let table = self.goal.table.as_ref();
        let table =
            table.map(|path| relative(path, folder).map_or_else(|| path.clone(), PathBuf::from));
        let mut goal = Goal { table, ..self.goal.clone() };
        for target in &mut goal.design.targets {
            if let DesignShape::Points(_, path) | DesignShape::Path(_, path) = &mut target.shape
                && let Some(near) = relative(path, folder)
            {
                *path = PathBuf::from(near);
            }
        }
        describe_goal(&goal, &mut file);
        describe_motion(&self.motion, robot, &mut file)?;
        Ok(FittedFile { text: toml(&file), keeps_text: false })
    }

    /// The text of this file with the numbers in which the two differ changed, and the paths it names seen from
    /// another folder; `None` where it has no place for one of them.
    fn edited(
        &self,
        old: &Table,
        new: &Table,
        mounting: Mounting,
        folder: &Path,
    ) -> Option<String> {
        let (mut edits, mut added) = (Vec::new(), Table::default());
        if mounting.offset != Vec3::ZERO {
            self.move_markers(mounting.offset, &mut edits)?;
        }
        if let Some(body) = mounting.body {
            self.turn_body(body, &mut edits)?;
        }
        for (key, item) in &new.entries {
            match old.get(key) {
                Some(before) => {
                    let mut own = Vec::new();
                    match self.differ(key, before, item, &mut own) {
                        Some(()) => edits.append(&mut own),
                        // It stands in a file that this one extends, over which its own table is laid.
                        None => added.insert(key, changed(before, item)),
                    }
                }
                None if self.document().find(key).is_none() => added.insert(key, item.clone()),
                None => return None,
            }
        }
        if !old.entries.iter().all(|(key, _)| new.get(key).is_some()) {
            return None;
        }
        let cameras = (0..).map(|i| format!("measured.cameras[{i}].file"));
        let cameras = cameras.take_while(|path| self.document().find(path).is_some());
        let meshes = (0..self.case.obstacles.len()).map(|k| format!("obstacles[{k}].file"));
        let meshes = meshes.filter(|path| self.document().find(path).is_some());
        let over_time = (0..).map(|k| format!("motion.commands[{k}]"));
        let over_time = over_time.take_while(|path| self.document().find(path).is_some());
        let over_time = over_time.map(|path| format!("{path}.csv"));
        let files = ["extends", "commands.table", "measured.disks", "measured.table"];
        let files = files.into_iter().chain(["target.shape", "target.path", "motion.base.csv"]);
        let state = matches!(self.motion.initial, Some(Initial::State(_)));
        let files = files.chain(state.then_some("motion.initial"));
        let files = files.map(str::to_owned);
        let shapes = 0..self.goal.design.targets.len();
        let shapes =
            shapes.flat_map(|k| ["shape", "path"].map(|key| format!("design.targets[{k}].{key}")));
        for path in files.chain(shapes).chain(cameras).chain(meshes).chain(over_time) {
            if let Some(Node { span, value: Value::Text(named) }) = self.document().find(&path)
                && span.file == 0
            {
                let target = self.path.parent().unwrap_or(Path::new("")).join(named);
                edits.push((*span, quoted(&relative(&target, folder)?)));
            }
        }
        let mut text = self.text()?.to_owned();
        edits.sort_by_key(|(span, _)| core::cmp::Reverse(span.start));
        for (span, value) in edits {
            text.replace_range(
                text.get(span.start..span.end).map(|_| span.start..span.end)?,
                &value,
            );
        }
        if !added.is_empty() {
            text = format!("{}\n\n{}", text.trim_end(), toml(&added));
        }
        Some(text)
    }

    /// Whether the markers and the tracked body of another file are mounted beside those of this one like that.
    fn is_moved(&self, other: &Self, Mounting { offset, body }: Mounting) -> bool {
        let mounted = other.measured.as_ref().and_then(|measured| measured.body);
        let apart = |(body, mounted): (UnitQuaternion, UnitQuaternion)| {
            (body.conjugate() * mounted).log().norm()
        };
        if body.is_some() && body.zip(mounted).map(apart).is_none_or(|angle| angle > NEAR) {
            return false;
        }
        let all = |file: &Self| file.measured.iter().flat_map(|m| m.observations.clone()).collect();
        let (own, others): (Vec<_>, Vec<_>) = (all(self), all(other));
        let apart = |(own, other): (&Observation, &Observation)| {
            (other.offset - own.offset - offset).norm()
        };
        own.len() == others.len()
            && own.iter().zip(&others).all(|pair| apart(pair) <= NEAR * (1.0 + offset.norm()))
    }

    /// Adds an offset to that of `[measured]`; `None` where it is not in this file.
    fn move_markers(&self, offset: Vec3, edits: &mut Vec<(Span, String)>) -> Option<()> {
        let numbers = |v: Vec3| Item::List(v.to_array().map(Item::Number).to_vec());
        if self.document().find("measured.offset").is_some() {
            let before = self.measured.as_ref()?.observations.first()?.offset;
            return self.differ(
                "measured.offset",
                &numbers(before),
                &numbers(before + offset),
                edits,
            );
        }
        let [x, y, z] = offset.to_array().map(short);
        self.add_to_measured(&format!("offset = [{x}, {y}, {z}]"), edits)
    }

    /// Sets the rotation of the tracked body in `[measured]`; `None` where it is not in this file.
    fn turn_body(&self, body: UnitQuaternion, edits: &mut Vec<(Span, String)>) -> Option<()> {
        let [w, x, y, z] = body.wxyz().map(short);
        let orientation = format!("[{w}, {x}, {y}, {z}]");
        if let Some(node) = self.document().find("measured.orientation") {
            edits.push((Some(node.span).filter(|span| span.file == 0)?, orientation));
            return Some(());
        }
        let Some(node) = self.document().find("measured.rotation") else {
            return self.add_to_measured(&format!("orientation = {orientation}"), edits);
        };
        let span = Some(node.span).filter(|span| span.file == 0)?;
        self.text()?.get(span.start..span.end).filter(|text| text.starts_with('{'))?;
        let turn = body.log();
        let angle = turn.norm();
        let axis = if angle > 0.0 { turn * (1.0 / angle) } else { Vec3::new(0.0, 0.0, 1.0) };
        let [x, y, z] = axis.to_array().map(short);
        edits.push((span, format!("{{ axis = [{x}, {y}, {z}], angle = {} }}", short(angle))));
        Some(())
    }

    /// Adds a line behind the header of `[measured]`; `None` where that is not in this file.
    fn add_to_measured(&self, line: &str, edits: &mut Vec<(Span, String)>) -> Option<()> {
        let header = self.document().find("measured").filter(|node| node.span.file == 0)?.span;
        self.text()?.get(header.start..header.end).filter(|text| text.starts_with('['))?;
        edits.push((Span { start: header.end, ..header }, format!("\n{line}")));
        Some(())
    }

    /// Whether this is a number that the file gives by the name of the material alone.
    fn is_of_material(&self, path: &str) -> bool {
        let name = self.document().find("backbone.material");
        path.starts_with("backbone.")
            && name.is_some_and(|name| name.span.file == 0)
            && self.document().find(path).is_none()
    }

    /// Where the numbers differ, and what is to stand there.
    fn differ(
        &self,
        path: &str,
        old: &Item,
        new: &Item,
        edits: &mut Vec<(Span, String)>,
    ) -> Option<()> {
        match (old, new) {
            _ if old == new => Some(()),
            (Item::Table(a), Item::Table(b)) if keys(a).eq(keys(b)) => {
                a.entries.iter().zip(&b.entries).try_for_each(|((key, a), (_, b))| {
                    let dot = if path.is_empty() { "" } else { "." };
                    self.differ(&format!("{path}{dot}{key}"), a, b, edits)
                })
            }
            (Item::Table(a), Item::Table(b)) if keys(a).all(|key| b.get(key).is_some()) => {
                let mut lines = String::new();
                for (key, item) in &b.entries {
                    match (a.get(key), item) {
                        (Some(before), _) => {
                            self.differ(&format!("{path}.{key}"), before, item, edits)?;
                        }
                        (None, Item::Number(_)) => {
                            let own = format!("{path}.{key}");
                            match self.document().find(&own) {
                                // The file says that it is zero, as it would be without that.
                                Some(_) => self.differ(&own, &Item::Number(0.0), item, edits)?,
                                None => lines += &format!("\n{key} = {}", short(in_si(item)?)),
                            }
                        }
                        (None, Item::Table(_) | Item::List(_))
                            if self.document().find(&format!("{path}.{key}")).is_none() =>
                        {
                            lines += &format!("\n{key} = {}", super::text::inline(item));
                        }
                        (None, _) => return None,
                    }
                }
                if lines.is_empty() {
                    return Some(());
                }
                // What the file does not say yet stands behind the header of the table.
                let header = self.document().find(path).filter(|node| node.span.file == 0)?.span;
                self.text()?.get(header.start..header.end).filter(|text| text.starts_with('['))?;
                edits.push((Span { start: header.end, ..header }, lines));
                Some(())
            }
            (Item::List(_), Item::List(b)) if b.iter().all(|of| matches!(of, Item::Integer(_))) => {
                let node = self.document().find(path).filter(|node| node.span.file == 0)?;
                if !matches!(node.value, Value::List(_)) {
                    return None;
                }
                edits.push((node.span, super::text::inline(new)));
                Some(())
            }
            (Item::List(a), Item::List(b)) if a.len() == b.len() => {
                // One number may stand for a list of the same ones, which stay the same.
                if let Some(node) = self.document().find(path)
                    && !matches!(node.value, Value::List(_))
                {
                    let uniform =
                        b.iter().all(|each| *each == b[0]) && a.iter().all(|each| *each == a[0]);
                    return if uniform { self.differ(path, &a[0], &b[0], edits) } else { None };
                }
                a.iter()
                    .zip(b)
                    .enumerate()
                    .try_for_each(|(i, (a, b))| self.differ(&format!("{path}[{i}]"), a, b, edits))
            }
            (Item::Number(_), Item::Number(_)) if self.is_of_material(path) => {
                let name = self.document().find("backbone.material")?;
                let (_, key) = path.rsplit_once('.')?;
                let end = Span { start: name.span.end, ..name.span };
                edits.push((end, format!("\n{key} = {}", short(in_si(new)?))));
                Some(())
            }
            (Item::Number(_) | Item::Text(_), Item::Number(_) | Item::Text(_)) => {
                let node = self.document().find(path).filter(|node| node.span.file == 0)?;
                let written = match &node.value {
                    Value::Text(text) => quoted(&with_number(text, in_si(new)?)?),
                    Value::Integer(_) | Value::Number(_) => short(in_si(new)?),
                    _ => return None,
                };
                edits.push((node.span, written));
                Some(())
            }
            _ => None,
        }
    }
}

/// What a table has to say when it is laid over the old one: the entries that differ. Lists are replaced whole.
fn changed(old: &Item, new: &Item) -> Item {
    match (old, new) {
        (Item::Table(a), Item::Table(b)) if keys(a).eq(keys(b)) => {
            let entries = a.entries.iter().zip(&b.entries).filter(|(a, b)| a != b);
            let entries = entries.map(|((key, a), (_, b))| (key.clone(), changed(a, b)));
            Item::Table(Table { entries: entries.collect() })
        }
        _ => new.clone(),
    }
}

fn keys(table: &Table) -> impl Iterator<Item = &str> {
    table.entries.iter().map(|(key, _)| key.as_str())
}

/// The number in SI of a number, or of a share in per cent.
fn in_si(item: &Item) -> Option<f64> {
    match item {
        Item::Number(number) => Some(*number),
        Item::Text(text) => {
            crate::units::parse_quantity(text, &crate::Dimension::ALL).ok().map(|(value, _)| value)
        }
        _ => None,
    }
}

/// A number with as many digits as matter, as TOML has numbers.
pub(crate) fn short(value: f64) -> String {
    let rounded: f64 = format!("{value:.10e}").parse().unwrap_or(value);
    format!("{rounded:?}")
}

fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('\\', "\\\\").replace('"', "\\\""))
}

/// A path as it is seen from a folder; as it is from the root where the two have nothing in common.
fn relative(target: &Path, folder: &Path) -> Option<String> {
    let real = |path: &Path| {
        let path = if path.as_os_str().is_empty() { Path::new(".") } else { path };
        path.canonicalize().ok()
    };
    let (target, folder) = (real(target)?, real(folder)?);
    let (mut to, mut from) = (target.components().peekable(), folder.components().peekable());
    while to.peek().is_some() && to.peek() == from.peek() {
        to.next();
        from.next();
    }
    let up = from.map(|_| Component::ParentDir);
    let path: PathBuf = up.chain(to).collect();
    Some(path.to_str()?.replace('\\', "/"))
}

/// Whether two trees say the same, numbers to within what is written of them.
fn is_near(a: &Item, b: &Item) -> bool {
    match (a, b) {
        (Item::Table(a), Item::Table(b)) => {
            keys(a).eq(keys(b))
                && a.entries.iter().zip(&b.entries).all(|((_, a), (_, b))| is_near(a, b))
        }
        (Item::List(a), Item::List(b)) => {
            a.len() == b.len() && a.iter().zip(b).all(|(a, b)| is_near(a, b))
        }
        _ if a == b => true,
        _ => match (in_si(a), in_si(b)) {
            (Some(a), Some(b)) => (a - b).abs() <= NEAR * a.abs().max(b.abs()),
            _ => false,
        },
    }
}
