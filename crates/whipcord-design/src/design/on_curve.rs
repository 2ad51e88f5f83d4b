//! What has its own method for one curve: the routing of one cable, the rest curvature and the diameters.

use whipcord::ModelKind;

use super::work::Work;
use crate::error::DesignError;
use crate::pre_bend::rest_curvature_for_curve;
use crate::route::route_for_curve;
use crate::taper::taper_for_curve;
use crate::vary::Vary;

/// Tensions that are tried for a cable, each that which the last one was told to be too small for.
const ROUNDS: usize = 8;

impl Work<'_> {
    /// Takes the closed form for a cable where there is one; whether nothing is left to do for it.
    pub(super) fn closed_form(&mut self, cable: usize) -> Result<bool, DesignError> {
        let Some(curve) = self.curve()? else { return Ok(false) };
        let command = self.cases[0].commands[cable];
        if command.shortening.is_some() && command.tension.is_none() {
            // The tension that a given length makes is that of the answer.
            return Ok(false);
        }
        let is_tension_free = self.tensions().contains(&cable);
        let [least, greatest] = self.tension_range(cable)?;
        let given = self.cases[0].commands[cable].tension.unwrap_or(0.0);
        let mut tension = if given > 0.0 { given } else { least.max(0.1 * greatest) };
        if given <= 0.0 && !is_tension_free {
            let name = self.robot.cables()[cable].name.clone();
            return Err(DesignError::NoTension { name });
        }
        for _ in 0..ROUNDS {
            match route_for_curve(&self.robot, cable, &curve, tension) {
                Ok(route) => {
                    self.robot = route.robot;
                    self.cases[0].commands[cable].tension = Some(tension);
                    let case = &self.cases[0];
                    let others = case.commands.iter().enumerate().filter(|(k, _)| *k != cable);
                    let is_alone = others
                        .map(|(_, command)| command)
                        .all(|command| command.tension == Some(0.0));
                    let is_exact = is_alone
                        && case.loads.is_none()
                        && case.obstacles.is_empty()
                        && self.model.kind() == ModelKind::Cosserat;
                    return Ok(is_exact);
                }
                Err(DesignError::NotAttainable { tension: needed, .. })
                    if is_tension_free && 1.02 * needed <= greatest =>
                {
                    tension = 1.02 * needed;
                }
                Err(error @ DesignError::NotAttainable { .. }) => {
                    // Under loads the cable does not have to bend the backbone alone.
                    let is_alone = self.cases[0].loads.is_none() && self.robot.cables().len() == 1;
                    return if is_alone { Err(error) } else { Ok(false) };
                }
                Err(DesignError::Backbone { .. } | DesignError::NotConverged { .. }) => {
                    return Ok(false);
                }
                Err(error) => return Err(error),
            }
        }
        Ok(false)
    }

    /// Rest curvature or diameters for one curve, if nothing else is left: which of them, and the greatest distance from the curve in m.
    pub(super) fn on_the_curve(
        &mut self,
        rest: &[Vary],
    ) -> Result<Option<(Vary, f64)>, DesignError> {
        let Some(curve) = self.curve()? else { return Ok(None) };
        let is_rod = matches!(self.model.kind(), ModelKind::Cosserat | ModelKind::CosseratDisks);
        let (model, case, places) = (&self.model, &self.cases[0], self.options.places);
        match rest {
            [Vary::RestCurvature] if is_rod => {
                let bent = rest_curvature_for_curve(model, &self.robot, case, &curve, places)?;
                self.robot = bent.robot;
                Ok(Some((Vary::RestCurvature, bent.error)))
            }
            [Vary::Diameters] if is_rod => {
                let range = self.diameter_range();
                match taper_for_curve(model, &self.robot, case, &curve, places, range) {
                    Ok(taper) => {
                        self.robot = taper.robot;
                        Ok(Some((Vary::Diameters, taper.error)))
                    }
                    // What no taper can do least squares may still come near to.
                    Err(DesignError::Curve { .. } | DesignError::NotConverged { .. }) => Ok(None),
                    Err(error) => Err(error),
                }
            }
            _ => Ok(None),
        }
    }
}
