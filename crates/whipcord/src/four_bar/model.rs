//! The four-bar model of one robot: its sections, and the chain of them that is in equilibrium with forces.

use super::equilibrium;
use super::options::{Objective, Options};
use super::refusal;
use super::section::{self, Section};
use crate::budget::Budget;
use crate::cancel::Cancel;
use crate::error::SolveError;
use crate::linkage::Linkage;
use crate::robot::Robot;
use crate::statics::options::StabilityAnalysis;

/// The four-bar model of one robot.
///
/// It is geometric: driven by how much each cable is shortened, blind to loads and, unless the length rule is `free`, to
/// friction (which changes tensions, not prescribed lengths), and without forces in its answer,
/// but for the tensions that the strain-energy objective yields. With that objective, the length rule `free` and a given
/// stiffness its sections are a chain in equilibrium, which also takes tensions, loads and elastic cables. Cables only pull: one that is
/// prescribed to be longer than its path is slack. Under the length rule `free` every other cable
/// has the prescribed length to 10⁻⁸ of the backbone's, or the solve is refused; when the lengths that
/// another rule gives a section contradict each other by little,
/// the answer is the least-squares one, and [`Diagnostics::residual`](crate::Diagnostics::residual)
/// is the largest difference from a prescribed length, relative to the length of the backbone.
///
/// ```
/// use whipcord::four_bar::{FourBar, Options, Workspace};
/// use whipcord::{Backbone, Cable, Case, Disks, Robot, Routing, Shortening};
///
/// // One section of 20 mm, a straight cable at 8 mm, shortened by 1 mm.
/// let cable = Cable::new("pull", Routing::Straight { angle: 0.0, radius: 0.008 });
/// let disks = Disks::equally_spaced(0.02, 2, 0.008);
/// let robot = Robot::new(Backbone::new(0.02), disks, vec![cable])?;
/// let model = FourBar::new(&robot, &Options::default())?;
/// let case = Case::with_shortenings(&[Shortening::Length(0.001)]);
/// let solution = model.solve(&case, None, &mut Workspace::default())?;
/// let bend = solution.shape.tip().rotation.log().norm();
/// assert!((bend - 2.0 * f64::asin(0.001 / 0.016)).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct FourBar {
    pub(super) robot: Robot,
    pub(super) options: Options,
    pub(super) sections: Vec<Section>,
    /// Initial length of each cable in m.
    pub(super) initial_lengths: Vec<f64>,
    /// Number of sections each cable passes.
    pub(super) passages: Vec<usize>,
    /// Tension in N of a multiplier of 1 rad²/m, eq. (10), where it is known.
    pub(super) tension_scale: Option<f64>,
    /// Arc lengths of the stations in m.
    pub(super) stations: Vec<f64>,
    /// The same sections in equilibrium with forces, where the strain energy decides on the shape.
    pub(super) chain: Option<Linkage>,
}

impl FourBar {
    /// The model of a robot.
    ///
    /// # Errors
    /// [`SolveError::Unsupported`] for what a geometric model cannot take (without strain energy and stiffness elastic cables and
    /// tension as the command, and more with the objective `as-printed`), and
    /// [`SolveError::Missing`] when the strain-energy objective finds no Poisson's ratio.
    pub fn new(robot: &Robot, options: &Options) -> Result<Self, SolveError> {
        refusal::robot(robot, options)?;
        options.stations.check(robot)?;
        let sections = section::sections(robot, options.objective, options.chord)?;
        let mut initial_lengths = vec![0.0; robot.cables().len()];
        let mut passages = vec![0; robot.cables().len()];
        for passage in sections.iter().flat_map(|section| &section.passages) {
            initial_lengths[passage.cable] += passage.initial;
            passages[passage.cable] += 1;
        }
        let tension_scale = if options.objective == Objective::StrainEnergy {
            let reference = section::reference_stiffness(robot)?;
            let stiffness = section::modulus(robot).zip(reference).map(|(e, i)| e * i);
            stiffness.map(|stiffness| stiffness / (2.0 * robot.backbone().length))
        } else {
            None
        };
        let chain = equilibrium::chain(robot, options)?;
        Ok(Self {
            robot: robot.clone(),
            options: options.clone(),
            chain,
            sections,
            initial_lengths,
            passages,
            tension_scale,
            stations: options.stations.arc_lengths(robot),
        })
    }

    /// The robot this model was built for.
    #[must_use]
    pub fn robot(&self) -> &Robot {
        &self.robot
    }

    pub(crate) const fn set_budget(&mut self, budget: Budget) {
        self.options.budget = budget;
        if let Some(chain) = &mut self.chain {
            chain.set_budget(budget);
        }
    }

    pub(crate) fn set_cancel(&mut self, cancel: &Cancel) {
        self.options.cancel.clone_from(cancel);
        if let Some(chain) = &mut self.chain {
            chain.set_cancel(cancel);
        }
    }

    /// What is asked of the stability of answers; `None` where no energy decides on them.
    pub(crate) fn stability_mut(&mut self) -> Option<&mut StabilityAnalysis> {
        self.chain.as_mut().map(Linkage::stability_mut)
    }

    /// Arc lengths of the stations in m.
    #[must_use]
    pub fn stations(&self) -> &[f64] {
        &self.stations
    }

    /// Whether it knows how an answer changes with loads and parameters: where the strain energy decides where sections bend, the
    /// whole length of a cable is prescribed, and the robot's stiffness is given.
    #[must_use]
    pub fn has_linearization(&self) -> bool {
        self.chain.as_ref().is_some_and(Linkage::knows_forces)
    }
}
