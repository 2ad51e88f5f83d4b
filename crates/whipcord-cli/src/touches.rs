//! Where a robot touches obstacles, for people.

use whipcord::{Obstacle, Part, Solution};

use crate::quantity::{fixed, fixed_millimetres, newtons, number};
use crate::table::{Align, Table};

/// All places where an answer touches the obstacles of its case; `None` where it touches none.
pub fn table(solution: &Solution, obstacles: &[Obstacle]) -> Option<Table> {
    if solution.touches.is_empty() {
        return None;
    }
    let mut table = Table::new([
        ("touches", Align::Left),
        ("with", Align::Left),
        ("arc length", Align::Right),
        ("at x, y, z (mm)", Align::Right),
        ("normal", Align::Right),
        ("force", Align::Right),
        ("gap", Align::Right),
    ]);
    table.group();
    for touch in &solution.touches {
        let part = match touch.part {
            Part::Backbone => "the backbone".to_owned(),
            Part::Disk(disk) => format!("disk {}", disk + 1),
        };
        let name = obstacles.get(touch.obstacle).map(|obstacle| obstacle.name.clone());
        table.row(vec![
            name.unwrap_or_else(|| format!("obstacle {}", touch.obstacle + 1)),
            part,
            format!("{} mm", fixed_millimetres(touch.arc_length, 2)),
            touch.point.to_array().map(|x| fixed_millimetres(x, 3)).join(", "),
            touch.normal.to_array().map(|x| fixed(x, 3)).join(", "),
            touch.force.map_or_else(|| "–".to_owned(), newtons),
            format!("{} mm", number(touch.gap * 1e3, 2)),
        ]);
    }
    Some(table)
}
