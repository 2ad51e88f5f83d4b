//! The first iterate of a search from a shape whose first and second derivatives are known: the minimum of what they foretell.

use whipcord::derivatives::Place;

use crate::descent::{Control, FIRST_DAMPING, LARGEST_RADIUS, Problem, Region, Workspace};
use crate::evaluation::Evaluation;
use crate::rate_changes::{Foretold, RateChanges};
use crate::search::Search;

/// Steps to where derivatives lead, and the last one, in changes that bend the robot by half a turn.
const STEPS: usize = 5;
const LAST_STEP: f64 = 1e-3;
/// How far second derivatives hold, likewise.
const FAR: f64 = 0.5;

/// Where the first and second derivatives lead from unknowns with their evaluation, and what the second ones add to the residuals there over the square of the way, as in
/// [`Control::curvature`]. `None` where they lead nowhere.
pub(crate) fn led(
    (unknowns, evaluation, rate_changes): (&[f64], &Evaluation, &RateChanges),
    places: &[Place],
    search: &Search<'_>,
    control: &Control<'_>,
    workspace: &mut Workspace,
) -> Option<(Vec<f64>, f64)> {
    let first = search.linearize(evaluation);
    let near = |((x, scale), [least, greatest]): ((&f64, &f64), &[f64; 2])| {
        [least.max(x - FAR * scale), greatest.min(x + FAR * scale)]
    };
    let ways = unknowns.iter().zip(control.scales).zip(control.bounds);
    let bounds: Vec<[f64; 2]> = ways.map(near).collect();
    let control = &Control { bounds: &bounds, ..*control };
    let region = Region { damping: FIRST_DAMPING, radius: LARGEST_RADIUS };
    let (mut to, mut linear) = (unknowns.to_vec(), first.clone());
    let mut changes = vec![0.0; to.len()];
    let mut foretold = Foretold::default();
    for _ in 0..STEPS {
        let penalty = linear.penalty();
        workspace.step(&linear, &[], &to, control, region, penalty).ok()?;
        let mut size = 0.0_f64;
        for (k, (x, d)) in to.iter_mut().zip(workspace.last_step()).enumerate() {
            let [least, greatest] = bounds[k];
            *x = (*x + d * control.scales[k]).max(least).min(greatest);
            changes[k] = *x - unknowns[k];
            size = size.max(d.abs());
        }
        rate_changes.foretell(evaluation, places, &changes, &mut foretold);
        search.foretell(&foretold, &mut linear);
        for (slack, (at_first, row)) in linear
            .slack
            .iter_mut()
            .zip(first.slack.iter().zip(first.rows.chunks_exact(changes.len())))
        {
            *slack = at_first - row.iter().zip(&changes).map(|(a, d)| a * d).sum::<f64>();
        }
        if size < LAST_STEP {
            break;
        }
    }
    let far = changes.iter().zip(control.scales);
    let far = far.fold(0.0_f64, |most, (change, scale)| most.max((change / scale).abs()));
    if far == 0.0 || linear.cost() >= first.cost() {
        return None;
    }
    let rows = first.jacobian.chunks_exact(changes.len());
    let beyond = rows.zip(first.residual.iter().zip(&linear.residual)).map(|(row, (r, next))| {
        next - r - row.iter().zip(&changes).map(|(j, d)| j * d).sum::<f64>()
    });
    let beyond = beyond.map(|part| part * part).sum::<f64>().sqrt();
    Some((to, beyond / (far * far)))
}
