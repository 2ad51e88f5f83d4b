//! MJCF, the format of MuJoCo: bodies, hinges with springs, spatial tendons, actuators, obstacles and keyframes.

mod actuators;
mod bodies;
mod contact;
mod names;
mod obstacles;

use whipcord::{Case, Robot};

use crate::answers::{Answers, weight};
use crate::chain::{Chain, DAMPING_TIME, DENSITY, LINEAR_DENSITY};
use crate::error::ExportError;
use crate::files::{Exported, ExportedFile};
use crate::guides::{Guide, guides};
use crate::job::Job;
use crate::nodal::nodal_loads;
use crate::xml::{Element, check_name, numbers};

use actuators::{Actuators, Applied};
use contact::Contact;
use names::{FORMAT, WORLD_SITE, cable_site, node_site};

/// MuJoCo's parser of XML takes elements nested less than 500 deep.
pub const MOST_BODIES: usize = 490;
/// Greatest time step in s.
const TIME_STEP: f64 = 2e-3;
/// Least time step in s, whatever the damping.
const LEAST_TIME_STEP: f64 = 1e-5;
/// Least mass in kg and moment of inertia in kg·m² of a body: MuJoCo divides by them.
const LEAST_BULK: [f64; 2] = [1e-9, 1e-12];

/// The robot for MuJoCo, with a keyframe for each step of the case.
///
/// # Errors
/// [`ExportError`] for what MuJoCo cannot represent.
pub fn mjcf(job: &Job<'_>, stem: &str) -> Result<Exported, ExportError> {
    let (robot, case, kind) = (job.robot, job.case, job.model.kind());
    check(robot)?;
    let places = job.body_places(FORMAT, MOST_BODIES)?;
    let chain = Chain::new(robot, case, &places, Some(job.damping))?;
    let answers = job.solve(&places)?;
    let held = guides(robot, kind, &places);
    let obstacles = obstacles::of(case)?;
    let loads_of = |case: &Case| -> Vec<Applied> {
        let of_robot = nodal_loads(&case.loads, case.base.rotation, &places).into_iter();
        let of_robot = of_robot.map(|load| Applied {
            name: load.name,
            site: node_site(load.node),
            force: load.force,
            moment: load.moment,
            follower: load.follower,
        });
        of_robot.chain(obstacles.iter().filter_map(|body| body.load(case))).collect()
    };
    let loads = answers.cases.iter().map(loads_of).collect();
    let actuators = Actuators::of(job, &chain, &held, &answers, loads)?;

    let gravity = weight(case);
    let [least_mass, least_inertia] = LEAST_BULK;
    let compiler = Element::new("compiler")
        .with("angle", "radian")
        .with("autolimits", "true")
        .with("boundmass", least_mass)
        .with("boundinertia", least_inertia)
        .with("balanceinertia", "true");
    let time_step = time_step(&chain);
    let contact = (!obstacles.is_empty()).then(|| Contact::with_time_step(time_step));
    let mut option = Element::new("option")
        .with("timestep", numbers(&[time_step]))
        .with("integrator", "implicitfast")
        .with_vector("gravity", gravity);
    if contact.is_some() {
        // Else what friction holds creeps.
        option = option.with("cone", "elliptic").with("impratio", 10);
    }
    let mut world = Element::new("worldbody")
        .and(Element::new("light").with("pos", "0 0 3").with("dir", "0 0 -1"))
        .and(Element::new("site").with("name", WORLD_SITE));
    world.push(bodies::base(robot, case, &chain, &held, contact));
    let mut assets = Element::new("asset");
    for obstacle in &obstacles {
        world.push(obstacle.element());
        assets = assets.and_all(obstacle.mesh());
    }
    let title = if check_name(job.title).is_ok() { job.title } else { "robot" };
    let mut root = Element::new("mujoco").with("model", title);
    let statistic = Element::new("statistic").with("extent", numbers(&[robot.backbone().length]));
    for part in [compiler, option, statistic, bodies::defaults(contact), assets, world] {
        root.push(part);
    }
    root.push(tendons(robot, &held)?);
    root.push(actuators.element());
    root.push(keyframes(job, &chain, &answers, &actuators, &obstacles)?);
    let mut lost = lost(job, &answers);
    lost.extend(softening(&chain, &answers));
    let file = ExportedFile { name: format!("{stem}.xml"), bytes: root.document()? };
    Ok(Exported { files: vec![file], lost })
}

/// Refuses what changes a static answer and has no counterpart.
fn check(robot: &Robot) -> Result<(), ExportError> {
    let refuse =
        |what, path, advice| Err(ExportError::Unsupported { format: FORMAT, what, path, advice });
    for (i, cable) in robot.cables().iter().enumerate() {
        check_name(&cable.name)?;
        if cable.has_friction() {
            return refuse(
                "friction of a cable",
                format!("cables[{i}].friction"),
                "set it to 0, as by --set cables[0].friction=0, to export the robot without it",
            );
        }
    }
    if robot.has_bending_friction() {
        return refuse(
            "friction of the backbone against bending",
            "backbone.yield_moment".to_owned(),
            "export a file without yield_moment and yield_stiffness",
        );
    }
    Ok(())
}

/// Springs are integrated explicitly and dampers implicitly, which is stable below twice the damping time.
fn time_step(chain: &Chain) -> f64 {
    let hinges = chain.joints.iter().flat_map(|joint| joint.hinges());
    let times = hinges.map(|hinge| hinge.damping / hinge.stiffness).filter(|time| *time > 0.0);
    times.fold(TIME_STEP, f64::min).max(LEAST_TIME_STEP)
}

fn tendons(robot: &Robot, held: &[Vec<Guide>]) -> Result<Element, ExportError> {
    let mut tendons = Element::new("tendon");
    for (i, (cable, guides)) in robot.cables().iter().zip(held).enumerate() {
        check_name(&cable.name)?;
        let sites = guides
            .iter()
            .map(|guide| Element::new("site").with("site", cable_site(&cable.name, guide.place)));
        let spatial = Element::new("spatial")
            .with("name", &cable.name)
            .with("width", numbers(&[0.0015 * robot.backbone().length]))
            .with("rgba", bodies::rgba(whipcord_plot::Colour::nth(i)))
            .and_all(sites);
        tendons.push(spatial);
    }
    Ok(tendons)
}

/// The robot at rest, and each step with its shape and its commands.
fn keyframes(
    job: &Job<'_>,
    chain: &Chain,
    answers: &Answers,
    actuators: &Actuators,
    obstacles: &[obstacles::Body<'_>],
) -> Result<Element, ExportError> {
    let mut rest = vec![0.0; 3 * chain.joints.len()];
    rest.extend(obstacles.iter().flat_map(obstacles::Body::position_at_rest));
    let key = |name: String, position: &[f64], controls: &[f64]| {
        let key = Element::new("key").with("name", name).with_numbers("qpos", position);
        if controls.is_empty() { key } else { key.with_numbers("ctrl", controls) }
    };
    let mut keys = Element::new("keyframe");
    keys.push(key("rest".to_owned(), &rest, &actuators.at_rest()));
    for (step, solution) in answers.under_last_weight(job.case) {
        let mut position: Vec<f64> = chain.angles(&solution.shape)?.into_iter().flatten().collect();
        position.extend(obstacles.iter().flat_map(|obstacle| obstacle.position_in(solution)));
        let name =
            if answers.steps.len() > 1 { format!("step-{}", step + 1) } else { CASE.to_owned() };
        keys.push(key(name, &position, &actuators.controls(step)));
    }
    Ok(keys)
}

/// Name of the keyframe of a case in one step.
const CASE: &str = "case";

/// How much softer in bending the chain is than the rod may be before it is said.
const SOFTENING: f64 = 2e-3;

/// Under an axial force N an element of length h that is bent at one place by q comes h q²/4 nearer, one that is bent all along h q²/6:
/// to first order a chain under tensions of τ in sum is softer by τ h/6 beside EI/h.
fn softening(chain: &Chain, answers: &Answers) -> Option<String> {
    let pulled = answers
        .steps
        .iter()
        .map(|solution| solution.cables.iter().filter_map(|cable| cable.tension).sum::<f64>());
    let tension = pulled.fold(0.0, f64::max);
    let ends = chain.nodes.windows(2).map(|pair| pair[1].arc_length - pair[0].arc_length);
    let of_joint =
        |(h, joint): (f64, &crate::chain::Joint)| tension * h / 6.0 / joint.least_bending();
    let share = ends.zip(&chain.joints).map(of_joint).fold(0.0, f64::max);
    if share <= SOFTENING {
        return None;
    }
    let factor = (share / SOFTENING).sqrt().ceil();
    Some(format!(
        "bending within a body: under the tensions of the case the chain is up to {:.2} % softer than the rod; with {factor} times as many bodies (--per-span) this is less than {} %",
        100.0 * share,
        100.0 * SOFTENING,
    ))
}

fn lost(job: &Job<'_>, answers: &Answers) -> Vec<String> {
    let (robot, case) = (job.robot, job.case);
    let backbone = robot.backbone();
    let mut lost = Vec::new();
    let mut say = |applies: bool, text: &str| {
        if applies {
            lost.push(text.to_owned());
        }
    };
    say(
        backbone.extensible || backbone.shearable,
        "stretch and shear of the backbone: the chain bends and twists only",
    );
    say(
        backbone.linear_density.is_none() && backbone.material.density.is_none(),
        &format!(
            "the file gives no density: {DENSITY} kg/m^3 is assumed, or {LINEAR_DENSITY} kg/m without a section; it matters only in motion",
        ),
    );
    say(
        matches!(job.damping, whipcord_motion::Damping::None),
        &format!(
            "the file gives no damping: a damping time of {DAMPING_TIME} s is assumed; it matters only in motion"
        ),
    );
    say(
        !robot.motors().is_empty(),
        "motors: each cable has its own actuator; gear, backlash and pretension are not exported",
    );
    say(
        answers.under_last_weight(case).count() < answers.steps.len(),
        "steps under another gravity or with other masses than the last one: MuJoCo has one of each, and they have no keyframe",
    );
    say(
        !case.obstacles.is_empty(),
        "hard contact and its motion: that of MuJoCo is soft, rims of disks are not rounded, and the joints have armatures so that light bodies do not sink in",
    );
    let is_mesh = |obstacle: &whipcord::Obstacle| matches!(obstacle.form, whipcord::Form::Mesh(_));
    say(case.obstacles.iter().any(is_mesh), "hollows of meshes: MuJoCo takes their convex hull");
    lost
}
