//! Holes for a shape that was sketched in the page.

use std::sync::Arc;

use whipcord::{Cancel, Model, Routing, Stations, Vec3};
use whipcord_design::{DesignGoal, DesignOptions, TargetShape, Vary, design as solve};
use whipcord_io::CaseFile;

use crate::background::Tell;
use crate::bench::Bench;
use crate::holes::with_holes;
use crate::protocol::{Command, DesignRequest, Designed, Slider, ToPage};
use crate::scene::sliders;

/// Looks for holes and tells of them; nothing where it was cancelled.
pub fn design(file: &Arc<CaseFile>, asked: &DesignRequest, cancel: &Cancel, tell: &Tell) {
    let id = asked.request.id;
    let message = match found(file, asked, cancel) {
        _ if cancel.is_cancelled() => return,
        Ok(designed) => ToPage::Designed(designed),
        Err(message) => ToPage::NoDesign { id, message },
    };
    // A page that has gone hears nothing.
    let _ = tell.blocking_send(message);
}

fn found(file: &Arc<CaseFile>, asked: &DesignRequest, cancel: &Cancel) -> Result<Designed, String> {
    let DesignRequest { request, cable, places, .. } = asked;
    let file = with_holes(file, &request.holes)?;
    let case = Bench::new(Arc::clone(&file)).case(request)?;
    let (disks, cables) = (file.robot.disks().count(), file.robot.cables().len());
    if places.len() != disks - 1 || *cable >= cables {
        let given = places.len();
        return Err(format!("{given} places are given for {} disks: reload the page", disks - 1));
    }
    let all = sliders(&file.robot, &file.case);
    let own = all.iter().position(|slider| *slider == Slider::Cable(*cable));
    let is_pulled = own.is_some_and(|k| matches!(request.commands[k], Command::Tension(_)));
    let mut vary = vec![Vary::Holes { cable: *cable }];
    if asked.tension && is_pulled {
        vary.push(Vary::Tension { cable: *cable });
    }
    let points = places.iter().enumerate().map(|(k, place)| (k + 1, Vec3::from(*place)));
    let goal = DesignGoal { case, target: TargetShape::Points(points.collect()), weight: 1.0 };
    let model = Model::new(Vary::usual_model(&vary), Stations::Disks, whipcord::Actuation::Natural);
    let limits = |cable: usize| {
        let goal = &file.goal;
        goal.own.get(cable).and_then(|own| own.tension).or(goal.all.tension)
    };
    let tensions = (0..cables).map(limits).collect();
    let options = DesignOptions { tensions, ..DesignOptions::default() };
    let model = model.cancelled_by(cancel);
    let found = solve(&model, &file.robot, &[goal], &vary, &options);
    let found = found.map_err(|error| error.to_string())?;
    let Routing::Holes { holes, .. } = &found.robot.cables()[*cable].routing else {
        return Err("the design has no holes".to_owned());
    };
    let mut commands = request.commands.clone();
    if let (Some(own), Some(tension)) = (own, found.goals[0].case.commands[*cable].tension)
        && vary.len() > 1
    {
        commands[own] = Command::Tension(tension);
    }
    Ok(Designed {
        id: request.id,
        holes: holes.clone(),
        commands,
        error: found.error,
        largest: found.largest,
        proven: found.findings.first().is_some_and(|finding| finding.known.is_proven()),
    })
}
