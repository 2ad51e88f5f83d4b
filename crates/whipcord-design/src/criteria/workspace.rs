//! The volume that the tip gets to, and how that changes.

use whipcord::batch::{BatchOptions, Gradients, Rows, Sensitivities, pull_back_batch, solve_batch};
use whipcord::{Case, Parameter, Robot, Stations, Vec3};
use whipcord_numerics::random::SplitMix64;

use super::{Criteria, by_tension};
use crate::chebyshev;
use crate::criterion::WORKSPACE_RADIUS;
use crate::error::DesignError;
use crate::soft_volume::{soft_volume, soft_volume_slopes};
use crate::unknown::{Unknown, Varied};

impl Criteria {
    /// Commands all over their ranges, row after row.
    fn sampled_commands(&self) -> Vec<f64> {
        let mut random = SplitMix64::of(1, 0);
        (0..self.commands)
            .flat_map(|_| &self.ranges)
            .map(|[least, greatest]| least + (greatest - least) * random.next_part())
            .collect()
    }

    /// Volume of the places of the tip with commands all over their ranges, under the loads of a case.
    pub(super) fn volume(&self, robot: &Robot, case: &Case) -> Result<f64, DesignError> {
        let commands = self.sampled_commands();
        let model = self.model.at(Stations::At(vec![robot.backbone().length]));
        let rows = rows_of(&commands, case);
        let batch = solve_batch(&model, robot, rows, &BatchOptions::default())?;
        let tips = (0..batch.len()).filter_map(|row| {
            let row = batch.row(row)?.ok()?;
            Some(Vec3::from(row.position(0)))
        });
        Ok(soft_volume(tips, WORKSPACE_RADIUS * robot.backbone().length))
    }

    /// A volume and its rates by the unknowns: the sensitivities of the places of the tip are pulled back to all parameters at once.
    pub(super) fn volume_rates(&self, of: Varied<'_>) -> Result<(f64, Vec<f64>), DesignError> {
        let (robot, case) = (of.robot, &of.cases[0]);
        let length = robot.backbone().length;
        let commands = self.sampled_commands();
        let rows = rows_of(&commands, case);
        let model = self.model.at(Stations::At(vec![length]));
        let batch = solve_batch(&model, robot, rows, &BatchOptions::default())?;
        let tips: Vec<Option<Vec3>> = (0..batch.len())
            .map(|row| batch.row(row)?.ok().map(|row| Vec3::from(row.position(0))))
            .collect();
        let known = tips.iter().flatten().copied();
        let (volume, slopes) = soft_volume_slopes(known, WORKSPACE_RADIUS * length);
        let mut slopes = slopes.into_iter();
        let mut positions = Vec::with_capacity(3 * tips.len());
        for tip in &tips {
            let slope = tip.and_then(|_| slopes.next()).unwrap_or(Vec3::ZERO);
            positions.extend(slope.to_array());
        }
        let count = of.parameters.len();
        let mut by_commands = vec![0.0; commands.len()];
        let mut by_parameters = vec![0.0; count * tips.len()];
        let sensitivities = Sensitivities { positions: &positions, ..Sensitivities::default() };
        let gradients = Gradients { commands: &mut by_commands, parameters: &mut by_parameters };
        let options = BatchOptions::default();
        pull_back_batch(&model, robot, rows, of.parameters, &options, sensitivities, gradients)?;
        let mut sums = vec![0.0; count];
        for row in by_parameters.chunks(count.max(1)) {
            sums.iter_mut().zip(row).for_each(|(sum, of)| *sum += of);
        }
        let by = |parameter: Parameter| {
            of.parameters.iter().position(|known| *known == parameter).map_or(0.0, |k| sums[k])
        };
        // The commands of a workspace are its own, whatever the tensions of the targets are.
        let rate = |unknown: &Unknown| match *unknown {
            Unknown::Tension { .. } | Unknown::DiskPosition { .. } => 0.0,
            Unknown::Parameter(parameter) => by(parameter),
            Unknown::Course { cable, axis, node, nodes } => {
                let powers = chebyshev::of_node(node, nodes, length).into_iter().enumerate();
                let of =
                    |(power, factor)| factor * by(Parameter::Coefficient { cable, axis, power });
                powers.map(of).sum()
            }
        };
        Ok((volume, of.unknowns.iter().map(rate).collect()))
    }
}

/// Rows of tensions or shortenings, as the case has them.
fn rows_of<'a>(values: &'a [f64], case: &'a Case) -> Rows<'a> {
    match by_tension(case) {
        true => Rows::Tensions { values, case },
        false => Rows::Shortenings { values, case },
    }
}
