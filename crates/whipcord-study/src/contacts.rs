//! Where a robot touches obstacles, for people.

use whipcord::{Contact, Obstacle, Part, Solution};

use crate::quantity::{fixed, fixed_millimetres, newtons, number};
use crate::table::{Align, Table};

/// All places where an answer touches the obstacles of its case; `None` where it touches none.
pub fn table(solution: &Solution, obstacles: &[Obstacle]) -> Option<Table> {
    if solution.contacts.is_empty() {
        return None;
    }
    let has_friction =
        |contact: &Contact| obstacles.get(contact.obstacle).is_some_and(|it| it.friction > 0.0);
    let any_friction = solution.contacts.iter().any(has_friction);
    let mut columns = vec![
        ("touches", Align::Left),
        ("with", Align::Left),
        ("arc length", Align::Right),
        ("at x, y, z (mm)", Align::Right),
        ("normal", Align::Right),
        ("force", Align::Right),
    ];
    if any_friction {
        columns.push(("friction", Align::Right));
    }
    columns.push(("gap", Align::Right));
    let mut table = Table::new(columns);
    table.group();
    for touch in &solution.contacts {
        let part = match touch.part {
            Part::Backbone => "the backbone".to_owned(),
            Part::Disk(disk) => format!("disk {}", disk + 1),
        };
        let name = obstacles.get(touch.obstacle).map(|obstacle| obstacle.name.clone());
        let mut row = vec![
            name.unwrap_or_else(|| format!("obstacle {}", touch.obstacle + 1)),
            part,
            format!("{} mm", fixed_millimetres(touch.arc_length, 2)),
            touch.point.to_array().map(|x| fixed_millimetres(x, 3)).join(", "),
            touch.normal.to_array().map(|x| fixed(x, 3)).join(", "),
            touch.force.map_or_else(|| "–".to_owned(), newtons),
        ];
        if any_friction {
            let does = if touch.sticks { "sticks" } else { "slides" };
            row.push(match touch.friction.filter(|_| has_friction(touch)) {
                Some(friction) => format!("{}, {does}", newtons(friction.norm())),
                None => "–".to_owned(),
            });
        }
        row.push(format!("{} mm", number(touch.gap * 1e3, 2)));
        table.row(row);
    }
    Some(table)
}
