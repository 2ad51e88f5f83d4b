//! What every model can be asked: each cell of the table of `docs/theory/README.md`.

use whipcord::batch::{BatchOptions, Rows, solve_batch};
use whipcord::robot::BendingFriction;
use whipcord::{
    Actuation, Backbone, BranchOptions, Cable, Case, DistributedLoad, Model, ModelKind, Obstacle,
    Parameter, PointLoad, Profile, Robot, Shortening, Solution, SolveError, Stations, Vec3,
};

use crate::common::model_with_forces;
use crate::contact::{among, finger, wall};

const MODELS: [ModelKind; 6] = [
    ModelKind::Cosserat,
    ModelKind::CosseratDisks,
    ModelKind::PiecewiseConstantCurvature,
    ModelKind::PseudoRigidBody,
    ModelKind::FourBar,
    ModelKind::ConstantCurvature,
];

/// The four-bar model is the one with a strain energy.
fn model(kind: ModelKind) -> Model {
    model_with_forces(kind, Stations::default(), Actuation::Natural)
}

fn solve(kind: ModelKind, robot: &Robot, case: &Case) -> Result<Solution, SolveError> {
    model(kind).prepare(robot, &case.loads)?.solve_to_the_end(case).map_err(|(_, error)| error)
}

fn pulled() -> Case {
    Case::with_shortenings(&[Shortening::Length(0.006)])
}

/// The finger with its cable changed.
fn with_cable(change: impl Fn(&mut Cable)) -> Robot {
    let robot = finger(9);
    let mut cables = robot.cables().to_vec();
    change(&mut cables[0]);
    Robot::new(robot.backbone().clone(), robot.disks().clone(), cables).unwrap()
}

fn differs(kind: ModelKind, case: &Case) -> Result<(), SolveError> {
    let robot = finger(9);
    let (with, without) = (solve(kind, &robot, case)?, solve(kind, &robot, &pulled())?);
    let moved = with.disks.tip().position - without.disks.tip().position;
    assert!(moved.norm() > 1e-4, "{kind}: {moved:?}");
    Ok(())
}

fn dead_loads(kind: ModelKind) -> Result<(), SolveError> {
    let mut case = pulled();
    case.loads.tip_force = Vec3::new(0.0, 0.05, 0.0);
    case.loads.points = vec![PointLoad { at: 0.1, force: Vec3::Y * 0.02, ..PointLoad::default() }];
    differs(kind, &case)
}

fn follower_loads(kind: ModelKind) -> Result<(), SolveError> {
    let mut case = pulled();
    case.loads.tip_force = Vec3::new(0.05, 0.02, 0.0);
    case.loads.tip_follower = true;
    differs(kind, &case)
}

fn distributed_loads(kind: ModelKind) -> Result<(), SolveError> {
    let mut case = pulled();
    let (force, moment) = (Vec3::Y * 0.3, Vec3::ZERO);
    let profile = Profile::Constant { from: 0.05, to: 0.15, force, moment };
    case.loads.distributed = vec![DistributedLoad { profile, follower: false }];
    differs(kind, &case)
}

fn tensions(kind: ModelKind) -> Result<(), SolveError> {
    let solution = solve(kind, &finger(9), &Case::with_tensions(&[2.0]))?;
    assert!(solution.disks.tip().position.x > 0.01);
    Ok(())
}

fn lengths_with_slack(kind: ModelKind) -> Result<(), SolveError> {
    let robot = finger(9);
    let mut cables = robot.cables().to_vec();
    let routing = crate::common::straight(180.0);
    cables.push(Cable::new("other", routing));
    let robot = Robot::new(robot.backbone().clone(), robot.disks().clone(), cables).unwrap();
    let case = Case::with_shortenings(&[Shortening::Length(0.006), Shortening::Length(-0.01)]);
    let solution = solve(kind, &robot, &case)?;
    assert!(!solution.cables[0].slack && solution.cables[1].slack);
    Ok(())
}

fn elastic_cables(kind: ModelKind) -> Result<(), SolveError> {
    let robot = with_cable(|cable| cable.axial_stiffness = Some(500.0));
    let solution = solve(kind, &robot, &pulled())?;
    let cable = &solution.cables[0];
    // It is longer than prescribed by what it stretches.
    assert!(cable.initial_length - cable.length < 0.006 - 1e-5);
    Ok(())
}

fn cables_between_disks(kind: ModelKind) -> Result<(), SolveError> {
    let solution = solve(kind, &with_cable(|cable| cable.ends_at = Some(0.131)), &pulled())?;
    assert!(solution.disks.tip().position.x > 0.01);
    Ok(())
}

fn friction_at_holes(kind: ModelKind) -> Result<(), SolveError> {
    let rubbing = with_cable(|cable| cable.friction = Some(0.3));
    let case = Case::with_tensions(&[2.0]);
    let [with, without] = [rubbing, finger(9)].map(|robot| solve(kind, &robot, &case));
    let moved = with?.disks.tip().position.x - without?.disks.tip().position.x;
    assert!(moved < -1e-4, "{moved}");
    Ok(())
}

/// The robot with friction of its backbone against bending.
fn held(plain: &Robot) -> Robot {
    let friction = BendingFriction { yield_moment: [4e-3; 2], yield_stiffness: None };
    let backbone = Backbone { bending_friction: Some(friction), ..plain.backbone().clone() };
    Robot::new(backbone, plain.disks().clone(), plain.cables().to_vec()).unwrap()
}

/// With and without a larger pull before, the tip is not at the same place.
fn depends_on_the_way(
    kind: ModelKind,
    robot: &Robot,
    obstacles: &[Obstacle],
) -> Result<(), SolveError> {
    let way = |tensions: &[f64]| {
        let mut steps: Vec<_> =
            tensions.iter().map(|&t| Case::with_tensions(&[t]).commands).collect();
        let commands = steps.pop().unwrap();
        let obstacles = obstacles.to_vec();
        solve(kind, robot, &Case { commands, before: steps, obstacles, ..Case::default() })
    };
    let [direct, back] = [way(&[1.0])?, way(&[2.0, 1.0])?];
    assert_ne!(direct.plastic_curvature, back.plastic_curvature);
    let moved = direct.disks.tip().position.x - back.disks.tip().position.x;
    assert!(moved < -1e-3, "{moved}");
    Ok(())
}

fn friction_against_bending(kind: ModelKind) -> Result<(), SolveError> {
    depends_on_the_way(kind, &held(&finger(9)), &[])
}

fn both_frictions(kind: ModelKind) -> Result<(), SolveError> {
    let rubbing = with_cable(|cable| cable.friction = Some(0.1));
    depends_on_the_way(kind, &held(&rubbing), &[])
}

fn contact_with_friction_against_bending(kind: ModelKind) -> Result<(), SolveError> {
    depends_on_the_way(kind, &held(&finger(9)), &[wall(0.05)])
}

fn contact_with_both_frictions(kind: ModelKind) -> Result<(), SolveError> {
    let rubbing = with_cable(|cable| cable.friction = Some(0.1));
    depends_on_the_way(kind, &held(&rubbing), &[wall(0.05)])
}

fn stability(kind: ModelKind) -> Result<(), SolveError> {
    let solution = solve(kind, &finger(9), &pulled())?;
    match solution.diagnostics.stable {
        Some(stable) => assert!(stable),
        // There is no other way to say no.
        None => return Err(SolveError::NoDerivatives),
    }
    Ok(())
}

fn branches(kind: ModelKind) -> Result<(), SolveError> {
    let mut case = pulled();
    case.loads.tip_force = Vec3::new(0.0, 0.01, -0.5);
    let mut prepared = model(kind).prepare(&finger(9), &case.loads)?;
    let found = prepared.branches(&case, &BranchOptions::default())?;
    assert!(!found.equilibria.is_empty());
    Ok(())
}

fn touching() -> Case {
    let wall = Obstacle { friction: 0.2, ..wall(0.03) };
    among(pulled(), vec![wall])
}

fn stability_in_contact(kind: ModelKind) -> Result<(), SolveError> {
    let case = among(pulled(), vec![wall(0.05)]);
    let solution = solve(kind, &finger(9), &case)?;
    assert!(!solution.contacts.is_empty());
    assert_eq!(solution.diagnostics.stable, Some(true));
    Ok(())
}

fn contact_with_friction(kind: ModelKind) -> Result<(), SolveError> {
    let solution = solve(kind, &finger(9), &touching())?;
    let contact = &solution.contacts[0];
    assert!(contact.force.unwrap() > 0.0 && contact.friction.unwrap().norm() > 0.0);
    Ok(())
}

fn contact_with_friction_at_holes(kind: ModelKind) -> Result<(), SolveError> {
    let rubbing = with_cable(|cable| cable.friction = Some(0.3));
    let case = among(Case::with_tensions(&[4.0]), vec![wall(0.05)]);
    let [with, without] = [rubbing, finger(9)].map(|robot| solve(kind, &robot, &case));
    let forces = [with?, without?].map(|solution| solution.contacts[0].force.unwrap());
    assert!(forces[0] > 0.0 && forces[0] < 0.99 * forces[1], "{forces:?}");
    Ok(())
}

fn derivatives_of(kind: ModelKind, robot: &Robot, case: &Case) -> Result<(), SolveError> {
    let mut prepared = model(kind).prepare(robot, &case.loads)?;
    let solution = prepared.solve(case, None)?;
    let parameters = [Parameter::YoungModulus, Parameter::Radius { cable: 0 }];
    let derivatives = prepared.linearize(case, &solution, &parameters)?;
    use whipcord::derivatives::{Hold, Place};
    let by_command = derivatives.command(0).twist(Place::Disk(5));
    let by_radius = derivatives.parameter(1, Hold::Commands).twist(Place::Disk(5));
    let compliance = derivatives.compliance(Place::Disk(5), Hold::Commands)?;
    assert!(by_command.linear.norm() > 0.0 && by_radius.linear.norm() > 0.0);
    assert!(compliance.at(1, 1) > 0.0);
    Ok(())
}

fn derivatives(kind: ModelKind) -> Result<(), SolveError> {
    let robot = finger(9);
    assert!(model(kind).has_derivatives(&robot) || kind == ModelKind::ConstantCurvature);
    derivatives_of(kind, &robot, &pulled())
}

fn derivatives_with_friction(kind: ModelKind) -> Result<(), SolveError> {
    let rubbing = with_cable(|cable| cable.friction = Some(0.3));
    derivatives_of(kind, &rubbing, &Case::with_tensions(&[2.0]))
}

fn derivatives_with_friction_against_bending(kind: ModelKind) -> Result<(), SolveError> {
    derivatives_of(kind, &held(&finger(9)), &Case::with_tensions(&[2.0]))
}

fn derivatives_with_friction_against_bending_in_contact(kind: ModelKind) -> Result<(), SolveError> {
    derivatives_of(kind, &held(&finger(9)), &among(Case::with_tensions(&[4.0]), vec![wall(0.05)]))
}

fn derivatives_with_both_frictions(kind: ModelKind) -> Result<(), SolveError> {
    let rubbing = with_cable(|cable| cable.friction = Some(0.3));
    derivatives_of(kind, &held(&rubbing), &Case::with_tensions(&[2.0]))
}

fn derivatives_with_both_frictions_in_contact(kind: ModelKind) -> Result<(), SolveError> {
    let rubbing = with_cable(|cable| cable.friction = Some(0.3));
    derivatives_of(kind, &held(&rubbing), &among(Case::with_tensions(&[4.0]), vec![wall(0.05)]))
}

fn derivatives_in_contact(kind: ModelKind) -> Result<(), SolveError> {
    derivatives_of(kind, &finger(9), &touching())
}

fn derivatives_with_friction_in_contact(kind: ModelKind) -> Result<(), SolveError> {
    let rubbing = with_cable(|cable| cable.friction = Some(0.3));
    derivatives_of(kind, &rubbing, &among(Case::with_tensions(&[4.0]), vec![wall(0.05)]))
}

fn batches(kind: ModelKind) -> Result<(), SolveError> {
    let (robot, case) = (finger(9), pulled());
    let rows = Rows::Shortenings { values: &[0.002, 0.004, 0.006], case: &case };
    let batch = solve_batch(&model(kind), &robot, rows, &BatchOptions::default());
    let batch = batch.unwrap_or_else(|error| panic!("{kind}: {error}"));
    assert!(batch.outcomes().iter().all(Result::is_ok));
    Ok(())
}

type Question = fn(ModelKind) -> Result<(), SolveError>;

const QUESTIONS: [(&str, Question); 26] = [
    ("dead loads", dead_loads),
    ("follower loads", follower_loads),
    ("distributed loads", distributed_loads),
    ("tensions", tensions),
    ("cable lengths with slack", lengths_with_slack),
    ("elastic cables", elastic_cables),
    ("cables that end between disks", cables_between_disks),
    ("friction at holes", friction_at_holes),
    ("friction against bending", friction_against_bending),
    ("friction against bending with friction at holes", both_frictions),
    ("contact with friction against bending", contact_with_friction_against_bending),
    ("contact with friction at holes and against bending", contact_with_both_frictions),
    ("derivatives with friction against bending", derivatives_with_friction_against_bending),
    (
        "derivatives with friction against bending in contact",
        derivatives_with_friction_against_bending_in_contact,
    ),
    ("derivatives with friction at holes and against bending", derivatives_with_both_frictions),
    (
        "derivatives with friction at holes and against bending in contact",
        derivatives_with_both_frictions_in_contact,
    ),
    ("stability", stability),
    ("stability in contact without friction", stability_in_contact),
    ("branches and limit points", branches),
    ("contact with friction", contact_with_friction),
    ("contact with friction at holes", contact_with_friction_at_holes),
    ("derivatives by commands, loads and parameters", derivatives),
    ("derivatives with friction at holes", derivatives_with_friction),
    ("derivatives in contact", derivatives_in_contact),
    ("derivatives with friction at holes in contact", derivatives_with_friction_in_contact),
    ("batches", batches),
];

#[test]
fn the_table_of_capabilities_says_what_is() {
    let page = include_str!("../../../../../docs/theory/README.md");
    let mut wrong = String::new();
    for (name, ask) in QUESTIONS {
        let line = page.lines().find(|line| line.starts_with(&format!("| {name} |")));
        let line = line.unwrap_or_else(|| panic!("the page has no line of {name}"));
        let said: Vec<&str> = line.split('|').skip(2).map(str::trim).take(MODELS.len()).collect();
        let found = MODELS.map(|kind| match ask(kind) {
            Ok(()) => "yes".to_owned(),
            Err(SolveError::Unsupported { .. } | SolveError::Missing { .. }) => "no".to_owned(),
            Err(SolveError::NoDerivatives) if name == "stability" => "no".to_owned(),
            Err(error) => format!("{error}"),
        });
        // A footnote may follow.
        if said.iter().zip(&found).any(|(said, found)| said.split(' ').next() != Some(found)) {
            wrong += &format!("{name}: {found:?}, and the page says {said:?}\n");
        }
    }
    assert!(wrong.is_empty(), "{wrong}");
}
