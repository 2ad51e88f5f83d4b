//! The search for the unknowns.

use std::collections::BTreeSet;

use whipcord_numerics::least_squares::{Options, Workspace};

use super::check::check;
use super::error::IdentifyError;
use super::experiment::{Experiment, Unknown};
use super::fewer_rows::fewer_rows;
use super::forward::Forward;
use super::logarithm::Logarithms;
use super::noise;
use super::outcome::Identified;
use super::problem::Problem;
use super::refused_rows::remembers;
use super::rows::{Row, rows, without};
use super::settings::Settings;
use super::starts::best_of;
use super::summary;
use whipcord::robot::Robot;

/// Estimates the unknowns.
///
/// ```
/// use whipcord_estimation::identification::{Experiment, Quantity, Settings, Unknown, identify};
/// use whipcord::{
///     Backbone, Cable, Case, Disks, Material, Model, ModelKind, Parameter, Robot, Routing,
///     Section, Statics, Vec3,
/// };
/// use whipcord_estimation::{Observation, Place, Seen};
/// # let robot = |young: f64| {
/// #     let backbone = Backbone {
/// #         section: Some(Section::circle(0.003)),
/// #         material: Material { young_modulus: Some(young), poisson_ratio: Some(0.3), ..Default::default() },
/// #         ..Backbone::new(0.18)
/// #     };
/// #     let cable = Cable::new("pull", Routing::Straight { angle: 0.0, radius: 0.008 });
/// #     Robot::new(backbone, Disks::equally_spaced(0.18, 10, 0.008), vec![cable])
/// # };
/// // The real robot is stiffer than its file says: 1.3 GPa.
/// let (real, file) = (robot(1.3e9)?, robot(1.1e9)?);
/// let model = Model::new(ModelKind::Cosserat, Default::default(), Default::default());
/// let case = Case::with_tensions(&[3.0]);
/// let seen = model.solve(&real, &case)?;
/// let observations = (0..10).map(|disk| Observation {
///     step: 0,
///     place: Place::Disk(disk),
///     offset: Vec3::ZERO,
///     // Seen to 0.1 mm.
///     seen: Seen::Position(seen.disks.poses[disk].position + Vec3::new(1e-4, 0.0, 0.0) * (-1f64).powi(disk as i32)),
///     deviation: None,
/// });
/// let experiment = Experiment { case, observations: observations.collect(), ..Default::default() };
/// let unknown = Unknown::new(Quantity::Parameter(Parameter::YoungModulus));
/// let found = identify(&file, &[experiment], &[unknown], &Settings::new(model))?;
/// let young = &found.estimates[0];
/// assert!((young.value - 1.3e9).abs() < 5e6);
/// assert!(young.interval.is_some_and(|[low, high]| low < 1.3e9 && 1.3e9 < high));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`IdentifyError`] where the measurements are not enough or contradict robot and case, where an unknown is
/// none of the robot's, and where the model has no answer at the start.
pub fn identify(
    robot: &Robot,
    experiments: &[Experiment],
    unknowns: &[Unknown],
    settings: &Settings,
) -> Result<Identified, IdentifyError> {
    let found = best_of(robot, experiments, unknowns, settings, |unknowns| {
        search(robot, experiments, unknowns, settings)
    });
    // What a search that was broken off says is of no use.
    if settings.model.cancel().is_cancelled() { Err(IdentifyError::Cancelled) } else { found }
}

fn search(
    robot: &Robot,
    experiments: &[Experiment],
    unknowns: &[Unknown],
    settings: &Settings,
) -> Result<Identified, IdentifyError> {
    check(robot, experiments, unknowns, settings)?;
    let (marked, refused) = match fit(robot, experiments, unknowns, settings) {
        Err(IdentifyError::NoAnswerAtStart(_)) if settings.skips => {
            let forward = Forward::new(robot, experiments, unknowns, settings)?;
            let start = forward.start()?;
            forward.marked(&start)
        }
        found => return found,
    };
    let experiments = &marked[..];
    let left_out: BTreeSet<Row> = refused.iter().map(|of| of.row).collect();
    let kept = without(experiments, &left_out);
    if left_out.is_empty() || rows(&kept).is_empty() {
        return fit(robot, experiments, unknowns, settings);
    }
    check(robot, &kept, unknowns, settings)?;
    let mut found = fit(robot, &kept, unknowns, settings)?;
    // The residuals name the observations that were given, and the cases are those that were given.
    let numbers: Vec<Vec<usize>> = (experiments.iter().enumerate())
        .map(|(experiment, of)| {
            let is_kept = |step: usize| !left_out.contains(&Row { experiment, step });
            let all = of.observations.iter().enumerate();
            all.filter(|(_, seen)| is_kept(seen.step)).map(|(i, _)| i).collect()
        })
        .collect();
    for residual in &mut found.residuals {
        residual.observation = numbers[residual.experiment][residual.observation];
    }
    let x: Vec<f64> = found.estimates.iter().map(|estimate| estimate.value).collect();
    let forward = Forward::new(robot, experiments, unknowns, settings)?;
    for (experiment, case) in found.cases.iter_mut().enumerate() {
        let built = forward.built(experiment, &x);
        *case = built.map_err(|reason| IdentifyError::no_answer(experiment, reason))?.1;
    }
    let seen: BTreeSet<Row> = rows(experiments).into_iter().collect();
    found.skipped = refused.into_iter().filter(|of| seen.contains(&of.row)).collect();
    Ok(found)
}

fn fit(
    robot: &Robot,
    experiments: &[Experiment],
    unknowns: &[Unknown],
    settings: &Settings,
) -> Result<Identified, IdentifyError> {
    let mut forward = Forward::new(robot, experiments, unknowns, settings)?;
    let mut x = forward.start()?;
    let scales = forward.scales(&x);
    let mut workspace = Workspace::default();
    let logarithms = Logarithms::new(unknowns, &x);
    let bound = |of: fn(&Unknown) -> f64| {
        unknowns
            .iter()
            .enumerate()
            .map(|(j, unknown)| logarithms.searched(j, of(unknown)))
            .collect()
    };
    let options = Options {
        lower: bound(Unknown::least),
        upper: bound(Unknown::greatest),
        iterations: settings.iterations,
        ..Options::default()
    };
    let coarse = forward.coarse_model(&x);
    let mut problem = Problem::new(&mut forward, &logarithms, &scales, &settings.progress);
    // Rows of a robot that remembers cost far more than others.
    let near = remembers(robot)
        .then(|| fewer_rows(experiments))
        .flatten()
        .and_then(|fewer| estimates_of(robot, &fewer, unknowns, settings))
        .filter(|near| {
            let cost = |x: &[f64]| {
                let searched = problem.searched(x);
                problem.cost(&searched, settings.robustness.loss())
            };
            cost(near).is_some_and(|near| cost(&x).is_none_or(|start| near < start))
        });
    if let Some(near) = near {
        x = near;
    }
    let start = x.clone();
    let mut found = None;
    if let Some(coarse) = coarse {
        let fine = problem.replace_model(coarse);
        let fitted =
            noise::fit(&mut problem, &mut x, &options, settings.robustness, &mut workspace);
        problem.replace_model(fine);
        match fitted.ok().filter(|fitted| fitted.outcome.status.is_converged()) {
            Some(fitted) if problem.confirms(&x, workspace.residuals()) => found = Some(fitted),
            _ => x = start,
        }
    }
    let fitted = match found {
        Some(fitted) => fitted,
        None => noise::fit(&mut problem, &mut x, &options, settings.robustness, &mut workspace)?,
    };
    summary::tell(&forward, &x, (&scales, &logarithms), &fitted, settings, &workspace)
}

/// The estimates that the search finds in these experiments, where it converges and they determine all of them: else it ends far away.
fn estimates_of(
    robot: &Robot,
    experiments: &[Experiment],
    unknowns: &[Unknown],
    settings: &Settings,
) -> Option<Vec<f64>> {
    check(robot, experiments, unknowns, settings).ok()?;
    let found = fit(robot, experiments, unknowns, settings).ok()?;
    let estimates = found.estimates.iter().map(|estimate| estimate.value);
    let is_found = found.status.is_converged() && found.unresolved.is_empty();
    is_found.then(|| estimates.collect())
}
