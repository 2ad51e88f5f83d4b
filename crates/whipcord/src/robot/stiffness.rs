use super::along::{Along, Paths};
use super::disks::Disks;
use super::error::{Problem, RobotError};
use super::limits::{BENDING_STIFFNESS, COUPLING, SECTION_STIFFNESS};

/// A section's stiffness by the strains `(v − v*, u − u*)`, in the order shear x, shear y, axial,
/// bending x, bending y, twist: forces in N by pure numbers, moments in N·m by curvatures in 1/m.
pub type StiffnessMatrix = [[f64; 6]; 6];

/// Stiffness of the backbone's cross-sections that is given itself, instead of following from
/// [`super::Section`] and [`super::Material`].
#[derive(Clone, Debug, PartialEq)]
pub enum Stiffness {
    /// Each strain by itself.
    Diagonal {
        /// GA for shear along x and y in N; a backbone that does not shear needs none.
        shear: Option<Along<[f64; 2]>>,
        /// EA in N; a backbone that does not stretch needs none.
        axial: Option<Along<f64>>,
        /// EI about x and y in N·m².
        bending: Along<[f64; 2]>,
        /// GJ in N·m².
        torsion: Along<f64>,
    },
    /// The full matrix, symmetric and positive definite: an anisotropic section, or one whose
    /// centres of shear and tension are not on the axis. What it has in the rows and columns of a
    /// strain that is held is of no effect.
    Matrix(Along<StiffnessMatrix>),
}

/// Names of the six strains, in the order of [`StiffnessMatrix`].
pub(super) const AXES: [&str; 6] =
    ["shear x", "shear y", "axial", "bending x", "bending y", "twist"];

/// Least pivot of a matrix whose diagonal is scaled to 1: below it, rounding decides on the sign.
const LEAST_PIVOT: f64 = 1e-10;
/// How far two entries that should be equal may differ, relative to the diagonal.
const ASYMMETRY: f64 = 1e-9;

const fn within(value: &'static str) -> Paths {
    Paths { value, values: value, places: "backbone.stiffness.at" }
}

const SHEAR: Paths = within("backbone.stiffness.shear");
const AXIAL: Paths = within("backbone.stiffness.axial");
const BENDING: Paths = within("backbone.stiffness.bending");
const TORSION: Paths = within("backbone.stiffness.torsion");
const MATRIX: Paths = within("backbone.stiffness.matrix");

impl Stiffness {
    /// The same along the whole backbone: GA along x and y, EA, EI about x and y, GJ.
    #[must_use]
    pub const fn diagonal(shear: [f64; 2], axial: f64, bending: [f64; 2], torsion: f64) -> Self {
        Self::Diagonal {
            shear: Some(Along::Uniform(shear)),
            axial: Some(Along::Uniform(axial)),
            bending: Along::Uniform(bending),
            torsion: Along::Uniform(torsion),
        }
    }

    /// The matrix at one end of a piece of the backbone inside which nothing jumps; see
    /// [`Along::at_end`]. Zero where a diagonal stiffness is not given.
    #[must_use]
    pub fn at_end(&self, disks: &Disks, arc_length: f64, inside: f64) -> StiffnessMatrix {
        match self {
            Self::Diagonal { shear, axial, bending, torsion } => {
                let pair = |along: &Along<[f64; 2]>| along.at_end(disks, arc_length, inside);
                let one = |along: &Along<f64>| along.at_end(disks, arc_length, inside);
                let [shear_x, shear_y] = shear.as_ref().map_or([0.0; 2], pair);
                let [bending_x, bending_y] = pair(bending);
                let axial = axial.as_ref().map_or(0.0, one);
                let diagonal = [shear_x, shear_y, axial, bending_x, bending_y, one(torsion)];
                core::array::from_fn(|i| {
                    core::array::from_fn(|j| if i == j { diagonal[i] } else { 0.0 })
                })
            }
            Self::Matrix(matrix) => matrix.at_end(disks, arc_length, inside),
        }
    }

    /// Whether it is the same along the whole backbone.
    #[must_use]
    pub fn is_uniform(&self) -> bool {
        match self {
            Self::Diagonal { shear, axial, bending, torsion } => {
                shear.as_ref().is_none_or(Along::is_uniform)
                    && axial.as_ref().is_none_or(Along::is_uniform)
                    && bending.is_uniform()
                    && torsion.is_uniform()
            }
            Self::Matrix(matrix) => matrix.is_uniform(),
        }
    }

    /// Whether any strain is coupled with another one.
    #[must_use]
    pub fn is_coupled(&self) -> bool {
        let beside = |k: &StiffnessMatrix| (0..6).any(|i| (0..6).any(|j| i != j && k[i][j] != 0.0));
        match self {
            Self::Diagonal { .. } => false,
            Self::Matrix(matrix) => matrix.values().iter().any(beside),
        }
    }

    /// Arc lengths besides those of the disks at which its slope, or it itself, jumps.
    pub fn places(&self) -> impl Iterator<Item = f64> + '_ {
        let lists: [&[f64]; 4] = match self {
            Self::Diagonal { shear, axial, bending, torsion } => [
                shear.as_ref().map_or(&[], |along| along.places()),
                axial.as_ref().map_or(&[], |along| along.places()),
                bending.places(),
                torsion.places(),
            ],
            Self::Matrix(matrix) => [matrix.places(), &[], &[], &[]],
        };
        lists.into_iter().flatten().copied()
    }

    /// The same for a robot with other disks.
    #[must_use]
    pub fn apart_from(&self, disks: &Disks) -> Self {
        match self {
            Self::Diagonal { shear, axial, bending, torsion } => Self::Diagonal {
                shear: shear.as_ref().map(|along| along.apart_from(disks)),
                axial: axial.as_ref().map(|along| along.apart_from(disks)),
                bending: bending.apart_from(disks),
                torsion: torsion.apart_from(disks),
            },
            Self::Matrix(matrix) => Self::Matrix(matrix.apart_from(disks)),
        }
    }

    pub(super) fn check(&self, disks: &Disks, length: f64, held: Held) -> Result<(), RobotError> {
        match self {
            Self::Diagonal { shear, axial, bending, torsion } => {
                let forces = |path: &str, k: &[f64; 2]| {
                    SECTION_STIFFNESS.check(&format!("{path}[0]"), k[0])?;
                    SECTION_STIFFNESS.check(&format!("{path}[1]"), k[1])
                };
                let moments = |path: &str, k: &[f64; 2]| {
                    BENDING_STIFFNESS.check(&format!("{path}[0]"), k[0])?;
                    BENDING_STIFFNESS.check(&format!("{path}[1]"), k[1])
                };
                let missing = |paths: Paths, hold| {
                    Err(RobotError::new(paths.value, Problem::StiffnessMissing { hold }))
                };
                match shear {
                    Some(shear) => shear.check(disks, length, SHEAR, forces)?,
                    None if held.shear => {}
                    None => missing(SHEAR, "shearable")?,
                }
                match axial {
                    Some(axial) => axial
                        .check(disks, length, AXIAL, |path, &k| SECTION_STIFFNESS.check(path, k))?,
                    None if held.axial => {}
                    None => missing(AXIAL, "extensible")?,
                }
                bending.check(disks, length, BENDING, moments)?;
                torsion.check(disks, length, TORSION, |path, &k| BENDING_STIFFNESS.check(path, k))
            }
            Self::Matrix(matrix) => {
                matrix.check(disks, length, MATRIX, |path, k| check_matrix(path, k, held))
            }
        }
    }
}

/// Which strains the backbone does not admit.
#[derive(Clone, Copy, Debug)]
pub(super) struct Held {
    pub shear: bool,
    pub axial: bool,
}

fn check_matrix(path: &str, k: &StiffnessMatrix, held: Held) -> Result<(), RobotError> {
    let axes: Vec<usize> =
        (0..6).filter(|&i| !(i < 2 && held.shear || i == 2 && held.axial)).collect();
    for &i in &axes {
        for &j in &axes {
            let path = format!("{path}[{i}][{j}]");
            match (i == j, i < 3) {
                (true, true) => SECTION_STIFFNESS.check(&path, k[i][i])?,
                (true, false) => BENDING_STIFFNESS.check(&path, k[i][i])?,
                (false, _) => COUPLING.check(&path, k[i][j])?,
            }
        }
    }
    let scale = |i: usize, j: usize| (k[i][i] * k[j][j]).sqrt();
    for &i in &axes {
        for &j in axes.iter().filter(|&&j| j < i) {
            if (k[i][j] - k[j][i]).abs() > ASYMMETRY * scale(i, j) {
                let problem =
                    Problem::NotSymmetric { row: i, column: j, value: k[i][j], mirror: k[j][i] };
                return Err(RobotError::new(format!("{path}[{i}][{j}]"), problem));
            }
        }
    }
    // Cholesky's factors of the matrix whose diagonal is scaled to 1.
    let mut factor = vec![vec![0.0; axes.len()]; axes.len()];
    for (m, &i) in axes.iter().enumerate() {
        for (n, &j) in axes.iter().enumerate().take(m + 1) {
            let sum: f64 = (0..n).map(|l| factor[m][l] * factor[n][l]).sum();
            let entry = 0.5 * (k[i][j] + k[j][i]) / scale(i, j) - sum;
            if m != n {
                factor[m][n] = entry / factor[n][n];
            } else if entry >= LEAST_PIVOT {
                factor[m][m] = entry.sqrt();
            } else {
                let problem =
                    Problem::NotPositiveDefinite { axis: AXES[i], pivot: entry * k[i][i] };
                return Err(RobotError::new(format!("{path}[{i}]"), problem));
            }
        }
    }
    Ok(())
}
