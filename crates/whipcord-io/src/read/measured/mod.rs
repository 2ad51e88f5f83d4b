use std::path::PathBuf;

use whipcord::Vec3;
use whipcord::robot::limits::COORDINATE;

use crate::error::{FileProblem, Problems};
use crate::files;
use crate::source::{Sources, Span, quoted};

/// Where the disks of the real robot were.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Measured {
    /// The disks that were measured, in ascending order.
    pub disks: Vec<MeasuredDisk>,
    /// The file they were read from.
    pub path: PathBuf,
}

/// Where one disk was.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeasuredDisk {
    /// Number of the disk, from 1.
    pub disk: usize,
    /// Position of its centre in m, in the base frame.
    pub position: Vec3,
}

const COLUMNS: [&str; 4] = ["disk", "x", "y", "z"];

/// Reads the CSV file that stands at `named` in a robot file, for a robot of `count` disks.
pub(crate) fn read(
    path: &str,
    named: Span,
    count: Option<usize>,
    sources: &mut Sources,
    problems: &mut Problems,
) -> Option<Measured> {
    let path = sources.resolve(named.file, path);
    let (file, text) = files::read_named(&path, named, sources, problems)?;
    let mut table = Table { file, columns: None, disks: Vec::new(), count, problems };
    let mut start = 0;
    for line in text.split_inclusive('\n') {
        table.line(line, start);
        start += line.len();
    }
    let Table { columns, mut disks, .. } = table;
    if columns.is_none() || disks.is_empty() {
        // Lines that were refused have been reported.
        if problems.is_empty() {
            problems.push(Span::new(file, 0, 0), || problem("the file has no rows", HEADER));
        }
        return None;
    }
    disks.sort_by_key(|(disk, _)| disk.disk);
    Some(Measured { disks: disks.into_iter().map(|(disk, _)| disk).collect(), path })
}

const HEADER: &str =
    "the first line names the columns, `disk,x,y,z`; then one line per disk, positions in m";

struct Table<'a> {
    file: usize,
    /// Which of [`COLUMNS`] each column is.
    columns: Option<Vec<usize>>,
    disks: Vec<(MeasuredDisk, Span)>,
    count: Option<usize>,
    problems: &'a mut Problems,
}

fn problem(message: impl Into<String>, help: &'static str) -> FileProblem {
    FileProblem::Measured { message: message.into(), help }
}

impl Table<'_> {
    fn line(&mut self, line: &str, start: usize) {
        let content = line.trim_end().trim_start_matches('\u{feff}');
        if content.trim().is_empty() || content.trim_start().starts_with('#') {
            return;
        }
        let mut at = start + line.find(content).unwrap_or(0);
        let mut cells = Vec::new();
        for cell in content.split(',') {
            let text = cell.trim();
            let begin = at + (cell.len() - cell.trim_start().len());
            cells.push((text, Span::new(self.file, begin, begin + text.len())));
            at += cell.len() + 1;
        }
        let whole = Span::new(self.file, start, start + line.trim_end().len());
        match self.columns.clone() {
            None => self.header(&cells, whole),
            Some(columns) => self.row(&columns, &cells, whole),
        }
    }

    fn header(&mut self, cells: &[(&str, Span)], whole: Span) {
        let find = |name: &str| COLUMNS.iter().position(|column| *column == name);
        let columns: Vec<usize> = cells.iter().filter_map(|(text, _)| find(text)).collect();
        if columns.is_empty() {
            self.problems.push(whole, || problem("this line must name the columns", HEADER));
        }
        for (text, span) in cells {
            if !columns.is_empty() && find(text).is_none() {
                let message = format!("there is no column `{}`", quoted(text));
                self.problems.push(*span, || problem(message, HEADER));
            }
        }
        let complete = (0..COLUMNS.len())
            .all(|wanted| columns.iter().filter(|&&column| column == wanted).count() == 1);
        if columns.len() == cells.len() && !complete {
            let message = "the columns must be `disk`, `x`, `y` and `z`, each once";
            self.problems.push(whole, || problem(message, HEADER));
        }
        self.columns = Some(if complete { columns } else { Vec::new() });
    }

    fn row(&mut self, columns: &[usize], cells: &[(&str, Span)], whole: Span) {
        if columns.is_empty() {
            return;
        }
        if cells.len() != columns.len() {
            let message = format!("this line has {} values, not {}", cells.len(), columns.len());
            self.problems.push(whole, || problem(message, HEADER));
            return;
        }
        let mut values = [None; COLUMNS.len()];
        let mut disk_span = whole;
        for (&column, &(text, span)) in columns.iter().zip(cells) {
            if column == 0 {
                disk_span = span;
            }
            let number = text.parse::<f64>().ok().filter(|number| number.is_finite());
            if number.is_none() {
                let message = format!("`{}` is not a finite number", quoted(text));
                let help = "write positions as plain numbers in m, with a decimal point";
                self.problems.push(span, || problem(message, help));
            }
            if let Some(problem) = number.filter(|_| column > 0).and_then(|n| COORDINATE.problem(n))
            {
                let message = format!("a position {problem}");
                let help = "write positions as plain numbers in m, with a decimal point";
                self.problems.push(span, || self::problem(message, help));
                continue;
            }
            values[column] = number;
        }
        let [Some(disk), Some(x), Some(y), Some(z)] = values else { return };
        let most = self.count.unwrap_or(usize::MAX);
        if disk.fract() != 0.0 || disk < 1.0 || disk > most as f64 {
            let message = match self.count {
                Some(count) => format!("there is no disk {disk}: the robot has disks 1 to {count}"),
                None => format!("there is no disk {disk}"),
            };
            let help = "disks are numbered from 1, the base disk";
            self.problems.push(disk_span, || problem(message, help));
            return;
        }
        let disk = MeasuredDisk { disk: disk as usize, position: Vec3::new(x, y, z) };
        if let Some((_, first)) = self.disks.iter().find(|(other, _)| other.disk == disk.disk) {
            let related = Some((*first, "it is first given here"));
            let message = format!("disk {} is given twice", disk.disk);
            let help = "give each disk one line";
            self.problems.push_related(disk_span, related, || problem(message, help));
            return;
        }
        self.disks.push((disk, disk_span));
    }
}
