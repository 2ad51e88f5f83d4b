//! Robots that lean against a wall, close round a ball, and stick out of a pipe.

use whipcord::obstacle::{Bends, Form, Obstacle, Pipe};
use whipcord::{Disks, Pose, Robot, RobotError, Routing, UnitQuaternion, Vec3};

use super::SuiteCase;
use super::routing::{LENGTH, RADIUS, pulled, robot};
use crate::model_benchmark::{LoadKind, Tags};

/// Numbers of sections: the paper's, and as many as tell how models tend to the rod.
const SECTIONS: [usize; 2] = [9, 20];
/// Bending in degrees by which the cable alone would bend the robot. Bent much farther, it slips off the ball.
const BENDING: [f64; 2] = [30.0, 90.0];
/// Radius of the disks in m: as far as material stands round the holes.
const OUTER_RADIUS: f64 = 0.01;

/// What stands in the way: none of it touches the straight robot, all of it the bent one.
fn obstacle(load_kind: LoadKind) -> Result<Option<Obstacle>, RobotError> {
    let (form, position, rotation) = match load_kind {
        LoadKind::None | LoadKind::TipForce => return Ok(None),
        // A plane across the way of the upper half, whose normal points back at the robot.
        LoadKind::Wall => {
            let towards = UnitQuaternion::exp(Vec3::new(0.0, -core::f64::consts::FRAC_PI_2, 0.0));
            (Form::HalfSpace, Vec3::new(0.25 * LENGTH, 0.0, 0.0), towards)
        }
        // Beside the middle, a little off the plane in which the robot bends.
        LoadKind::Ball => (
            Form::Sphere { radius: 0.03 },
            Vec3::new(0.044, 0.0, 0.5 * LENGTH),
            UnitQuaternion::IDENTITY,
        ),
        // Along the lower half, with as much room as the disks are thick.
        LoadKind::Pipe => {
            let points = [0.0, 0.25, 0.5].map(|part| Vec3::new(0.0, 0.0, part * LENGTH));
            let pipe = Pipe::new(1.4 * OUTER_RADIUS, &points, Bends::Smooth)?;
            (Form::Pipe(pipe), Vec3::ZERO, UnitQuaternion::IDENTITY)
        }
    };
    let name = load_kind.name().to_owned();
    Ok(Some(Obstacle {
        name,
        form,
        pose: Pose { position, rotation },
        friction: 0.0,
        movable: None,
    }))
}

pub(super) fn cases() -> Result<Vec<SuiteCase>, RobotError> {
    let straight = vec![Routing::Straight { angle: 0.0, radius: RADIUS }];
    let mut cases = Vec::new();
    for load_kind in [LoadKind::Wall, LoadKind::Ball, LoadKind::Pipe] {
        for sections in SECTIONS {
            let robot = with_disks(&robot(sections, &straight)?)?;
            for degrees in BENDING {
                let bending = f64::to_radians(degrees);
                let mut case = pulled(&robot, bending);
                case.obstacles.extend(obstacle(load_kind)?);
                let name = load_kind.name();
                cases.push(SuiteCase {
                    stem: format!("{name}-{sections}-{degrees:.0}"),
                    title: format!("{name}, {sections} sections, {degrees:.0}°"),
                    robot: robot.clone(),
                    case,
                    tags: Tags { routing: "straight", bending, load_kind },
                });
            }
        }
    }
    Ok(cases)
}

/// The robot with disks that have a size.
fn with_disks(robot: &Robot) -> Result<Robot, RobotError> {
    let disks = Disks { outer_radius: Some(OUTER_RADIUS), ..robot.disks().clone() };
    Robot::new(robot.backbone().clone(), disks, robot.cables().to_vec())
}
