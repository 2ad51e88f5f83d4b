//! How the mass that a section carries changes with a parameter.

use whipcord_numerics::GAUSS_3;

use super::setting::Setting;
use crate::parameter::Parameter;

/// Change of the mass at and beyond the end of each step; empty where there is none.
#[derive(Clone, Debug, Default)]
pub(super) struct MassChange(Vec<f64>);

impl MassChange {
    pub fn new(setting: &Setting<'_>, parameter: &Parameter) -> Self {
        let weighs = matches!(
            parameter,
            Parameter::Density
                | Parameter::LinearDensity
                | Parameter::DiskMass
                | Parameter::Diameter
                | Parameter::DiameterAt { .. }
                | Parameter::InnerDiameter
                | Parameter::Width
                | Parameter::Height
        );
        if !weighs {
            return Self::default();
        }
        let grid = setting.grid;
        let mut at_nodes = vec![0.0; grid.len() + 1];
        if *parameter == Parameter::DiskMass {
            for &k in &grid.disks {
                at_nodes[k] += 1.0;
            }
        }
        let mut masses = vec![0.0; grid.len()];
        let mut mass = 0.0;
        for (k, step) in grid.steps.iter().enumerate().rev() {
            mass += at_nodes[k + 1];
            masses[k] = mass;
            mass += between(setting, parameter, step.start, step.start + step.length);
        }
        Self(masses)
    }

    pub fn any(&self) -> bool {
        !self.0.is_empty()
    }

    /// Change of the mass beyond a place of step `k`.
    pub fn beyond(&self, setting: &Setting<'_>, parameter: &Parameter, k: usize, s: f64) -> f64 {
        let step = &setting.grid.steps[k];
        self.0[k] + between(setting, parameter, s, step.start + step.length)
    }
}

/// Change of the mass per length at an arc length.
fn density_change(setting: &Setting<'_>, parameter: &Parameter, s: f64) -> f64 {
    let backbone = setting.robot.backbone();
    let disks = setting.robot.disks();
    match parameter {
        Parameter::LinearDensity => 1.0,
        Parameter::Density => backbone.section_at(disks, s).map_or(0.0, |p| p.area),
        // A mass per length that is given does not follow from the section.
        _ if backbone.linear_density.is_some() => 0.0,
        _ => {
            let density = backbone.material.density.unwrap_or(0.0);
            backbone.section_change(disks, s, s, parameter).map_or(0.0, |p| density * p.area)
        }
    }
}

fn between(setting: &Setting<'_>, parameter: &Parameter, from: f64, to: f64) -> f64 {
    let at = |i: usize| density_change(setting, parameter, from + GAUSS_3.nodes[i] * (to - from));
    (to - from) * (0..3).map(|i| GAUSS_3.weights[i] * at(i)).sum::<f64>()
}
