//! Where a robot touches obstacles, for people.

use whipcord::{CableOverlap, Contact, Grasp, Obstacle, Part, Robot, Solution, Vec3};

use crate::quantity::{fixed, fixed_millimetres, newtons, number, percent};
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

/// What the robot exerts on each obstacle that it touches, all contacts together; `None` where it touches none, and where the
/// model knows no forces.
pub fn grasps(solution: &Solution, obstacles: &[Obstacle]) -> Option<Table> {
    let grasps = Grasp::all(solution, obstacles);
    let any_friction = grasps.iter().any(|grasp| grasp.slip_margin.is_some());
    let mut columns = vec![
        ("on", Align::Left),
        ("contacts", Align::Right),
        ("pressed with", Align::Right),
        ("force x, y, z (N)", Align::Right),
        ("moment x, y, z (N·mm)", Align::Right),
    ];
    if any_friction {
        columns.push(("slip margin", Align::Right));
    }
    let mut table = Table::new(columns);
    table.group();
    let mut any = false;
    for grasp in &grasps {
        let (Some(normal), Some(wrench)) = (grasp.normal_force, grasp.wrench) else { continue };
        any = true;
        // Forces that cancel, or whose line passes the reference point, leave rounding.
        let rounding = 1e-9 * normal;
        let exact = |x: f64| if x.abs() > rounding { x } else { 0.0 };
        let numbers =
            |v: Vec3, unit: f64| v.to_array().map(|x| number(exact(x) * unit, 4)).join(", ");
        let mut row = vec![
            obstacles[grasp.obstacle].name.clone(),
            grasp.contacts.to_string(),
            newtons(normal),
            numbers(wrench.force, 1.0),
            numbers(wrench.moment, 1e3),
        ];
        if any_friction {
            row.push(match grasp.slip_margin {
                Some(margin) if grasp.sliding > 0 => {
                    format!("{}, {} of {} slide", percent(margin), grasp.sliding, grasp.contacts)
                }
                Some(margin) => percent(margin),
                None => "–".to_owned(),
            });
        }
        table.row(row);
    }
    any.then_some(table)
}

/// The cables that pass through obstacles, in each span between two disks; `None` where none does.
pub fn cable_overlaps(robot: &Robot, solution: &Solution, obstacles: &[Obstacle]) -> Option<Table> {
    let overlaps = CableOverlap::all(robot, solution, obstacles);
    if overlaps.is_empty() {
        return None;
    }
    let mut table = Table::new(vec![
        ("cable", Align::Left),
        ("passes through", Align::Left),
        ("between disks", Align::Left),
        ("arc length", Align::Right),
        ("at x, y, z (mm)", Align::Right),
        ("depth", Align::Right),
        ("force left out", Align::Right),
    ]);
    table.group();
    for overlap in &overlaps {
        table.row(vec![
            robot.cables()[overlap.cable].name.clone(),
            obstacles[overlap.obstacle].name.clone(),
            format!("{} and {}", overlap.span + 1, overlap.span + 2),
            format!("{} mm", fixed_millimetres(overlap.arc_length, 2)),
            overlap.point.to_array().map(|x| fixed_millimetres(x, 3)).join(", "),
            format!("{} mm", number(overlap.depth * 1e3, 3)),
            overlap.force.map_or_else(|| "–".to_owned(), newtons),
        ]);
    }
    Some(table)
}

/// The movable objects where an answer has them, what carries them, and what is left of their balance; `None` where there are none.
pub fn objects(solution: &Solution, obstacles: &[Obstacle]) -> Option<Table> {
    if solution.objects.is_empty() {
        return None;
    }
    let any_friction = solution.objects.iter().any(|state| state.slip_margin.is_some());
    let mut columns = vec![
        ("object", Align::Left),
        ("at x, y, z (mm)", Align::Right),
        ("moved by", Align::Right),
        ("load x, y, z (N)", Align::Right),
        ("touches", Align::Left),
    ];
    if any_friction {
        columns.push(("slip margin", Align::Right));
    }
    columns.push(("left of balance", Align::Right));
    let mut table = Table::new(columns);
    table.group();
    for state in &solution.objects {
        let Some(obstacle) = obstacles.get(state.obstacle) else { continue };
        let moved = (state.pose.position - obstacle.pose.position).norm();
        let mut touched: Vec<String> = Vec::new();
        let by_robot = solution.contacts.iter().filter(|touch| touch.obstacle == state.obstacle);
        if by_robot.count() > 0 {
            touched.push("the robot".to_owned());
        }
        for touch in &state.contacts {
            if let Some(other) = obstacles.get(touch.obstacle)
                && !touched.contains(&other.name)
            {
                touched.push(other.name.clone());
            }
        }
        let mut row = vec![
            obstacle.name.clone(),
            state.pose.position.to_array().map(|x| fixed_millimetres(x, 3)).join(", "),
            format!("{} mm", fixed_millimetres(moved, 3)),
            state.load.force.to_array().map(|x| number(x, 4)).join(", "),
            touched.join(", "),
        ];
        if any_friction {
            row.push(state.slip_margin.map_or_else(|| "–".to_owned(), percent));
        }
        row.push(newtons(state.imbalance.force.norm()));
        table.row(row);
    }
    Some(table)
}
