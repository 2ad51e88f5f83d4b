//! What friction makes of the tension of cables, for people.

use whipcord::{CableState, SlipState, Solution};

use whipcord_study::quantity::newtons;
use whipcord_study::table::{Align, Table};

/// Tension at both ends of every cable that rubs, and what it does in the holes of the disks: by step
/// where there are several. `None` where no cable rubs.
pub fn table<'a>(steps: impl ExactSizeIterator<Item = &'a Solution>) -> Option<Table> {
    let several = steps.len() > 1;
    let mut columns = vec![
        ("rubbing cable", Align::Left),
        ("at the base", Align::Right),
        ("at its end", Align::Right),
        ("in the holes of", Align::Left),
    ];
    if several {
        columns.insert(0, ("step", Align::Right));
    }
    let mut table = Table::new(columns);
    table.group();
    let mut any = false;
    for (i, solution) in steps.enumerate() {
        for cable in &solution.cables {
            let (Some(base), Some(&end)) = (cable.tension, cable.span_tensions.last()) else {
                continue;
            };
            any = true;
            // Friction holds a share of what pulls: of nothing it holds nothing, up to rounding.
            let (end, holes) =
                if base == 0.0 { (0.0, "slack".to_owned()) } else { (end, holes(cable)) };
            let mut row = vec![cable.name.clone(), newtons(base), newtons(end), holes];
            if several {
                row.insert(0, (i + 1).to_string());
            }
            table.row(row);
        }
    }
    any.then_some(table)
}

/// As in `disks 1–3 pulled, 4–9 stick`.
fn holes(cable: &CableState) -> String {
    let mut parts = Vec::new();
    let mut first = 0;
    for run in cable.slip_states.chunk_by(|a, b| a == b) {
        let (from, to) = (first + 1, first + run.len());
        let disks = if from == to { from.to_string() } else { format!("{from}–{to}") };
        let what = match run[0] {
            SlipState::Pulled => "pulled",
            SlipState::Released => "released",
            SlipState::Sticks => "sticking",
        };
        parts.push(format!("{disks} {what}"));
        first = to;
    }
    let word = if cable.slip_states.len() == 1 { "disk" } else { "disks" };
    format!("{word} {}", parts.join(", "))
}
