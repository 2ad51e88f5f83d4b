use whipcord_numerics::{Mat3, Twist, Vec3};

/// Principal values of a symmetric 3×3 matrix, ascending, and their directions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PrincipalAxes {
    /// Values, ascending.
    pub values: [f64; 3],
    /// Unit vectors; each points to the side on which its largest component is positive.
    pub directions: [Vec3; 3],
}

/// How well cables move a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dexterity {
    /// `√det(J Jᵀ)` of the translations: the volume, but for a constant, that commands of unit size
    /// cover (Yoshikawa, Int. J. Robotics Research 4, 1985); where there are fewer than three
    /// cables, the area or length, `√det(Jᵀ J)`.
    pub manipulability: f64,
    /// Directions in which the place can be moved: the rank of J.
    pub directions: usize,
    /// Greatest over least singular value of J among those directions; 1 where all are alike, `None`
    /// where nothing moves.
    pub condition: Option<f64>,
    /// Singular values, descending, and directions of motion. Beyond [`Dexterity::directions`] they
    /// are what rounding leaves.
    pub singular: [(f64, Vec3); 3],
}

impl Dexterity {
    /// The directions in which the place can be moved, with how far a command of unit size moves it,
    /// most first.
    pub fn motions(&self) -> impl Iterator<Item = (f64, Vec3)> {
        self.singular.into_iter().take(self.directions)
    }

    /// How far a command of unit size moves the place at least; 0 where nothing moves it.
    #[must_use]
    pub fn least_motion(&self) -> f64 {
        self.motions().last().map_or(0.0, |(size, _)| size)
    }
}

/// Below this part of the greatest singular value a direction does not count as one of motion. The
/// singular values are roots of the eigenvalues of J Jᵀ, whose rounding leaves a few times 1e-8 where
/// there is no motion at all.
const NO_MOTION: f64 = 1e-6;

/// Principal axes of the symmetric part of a matrix, such as a translational compliance.
#[must_use]
pub fn principal_axes(matrix: &Mat3) -> PrincipalAxes {
    let (values, directions) = ((*matrix + matrix.transpose()) * 0.5).symmetric_eigen();
    PrincipalAxes { values, directions: directions.map(oriented) }
}

/// How well commands move a place, from its Jacobian: the translations of its columns.
#[must_use]
pub fn dexterity(jacobian: &[Twist]) -> Dexterity {
    let mut gram = Mat3::ZERO;
    for column in jacobian {
        gram += Mat3::outer(column.linear, column.linear);
    }
    let axes = principal_axes(&gram);
    let value = |i: usize| axes.values[2 - i].max(0.0).sqrt();
    let singular = [0, 1, 2].map(|i| (value(i), axes.directions[2 - i]));
    let most = jacobian.len().min(3);
    let moves = |s: f64| s > NO_MOTION * singular[0].0 && s > 0.0;
    let directions = singular[..most].iter().filter(|(s, _)| moves(*s)).count();
    let manipulability = if jacobian.is_empty() || directions < most {
        0.0
    } else {
        singular[..most].iter().map(|(s, _)| s).product()
    };
    let condition = directions.checked_sub(1).map(|last| singular[0].0 / singular[last].0);
    Dexterity { manipulability, directions, condition, singular }
}

fn oriented(v: Vec3) -> Vec3 {
    let largest = (0..3).fold(0, |a, i| if v[i].abs() > v[a].abs() + 1e-9 { i } else { a });
    if v[largest] < 0.0 { -v } else { v }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_are_those_of_the_ellipsoid() {
        let (a, b) = (Vec3::new(0.6, 0.8, 0.0), Vec3::new(-0.8, 0.6, 0.0));
        let matrix =
            Mat3::outer(a, a) * 3.0 + Mat3::outer(b, b) * 2.0 + Mat3::outer(Vec3::Z, Vec3::Z);
        let axes = principal_axes(&matrix);
        for (value, expected) in axes.values.iter().zip([1.0, 2.0, 3.0]) {
            assert!((value - expected).abs() < 1e-14);
        }
        for (direction, expected) in axes.directions.iter().zip([Vec3::Z, -b, a]) {
            assert!((*direction - expected).norm() < 1e-14, "{direction:?}");
        }
    }

    #[test]
    fn manipulability_is_a_volume_an_area_or_a_length() {
        let column = |x, y, z| Twist { linear: Vec3::new(x, y, z), angular: Vec3::X };
        let columns = [column(2.0, 0.0, 0.0), column(0.0, 3.0, 0.0), column(0.0, 0.0, 0.5)];
        let all = dexterity(&columns);
        assert!((all.manipulability - 3.0).abs() < 1e-14);
        assert!((all.condition.unwrap() - 6.0).abs() < 1e-13);
        assert!((dexterity(&columns[..2]).manipulability - 6.0).abs() < 1e-14);
        assert_eq!(dexterity(&columns[..1]).condition, Some(1.0));
        let flat = dexterity(&[columns[0], columns[1], column(1.0, 1.0, 0.0)]);
        assert_eq!((flat.manipulability, flat.directions), (0.0, 2));
        assert_eq!(dexterity(&[]).condition, None);
    }

    #[test]
    fn rounding_is_no_direction_of_motion() {
        for degree in 0..360 {
            let (sin, cos) = f64::from(degree).to_radians().sin_cos();
            let column = |along: f64, z: f64| Twist {
                linear: Vec3::new(along * cos, along * sin, z),
                angular: Vec3::ZERO,
            };
            let flat = dexterity(&[column(0.31, 0.07), column(-0.17, 0.05), column(-0.14, 0.11)]);
            assert_eq!((flat.directions, flat.manipulability), (2, 0.0), "turned by {degree}°");
            // In the plane: 0.31·0.05 + 0.17·0.07 and so on, squared, by Cauchy and Binet.
            let areas: [f64; 3] = [0.0274, 0.0439, -0.0117];
            let area = areas.iter().map(|a| a * a).sum::<f64>().sqrt();
            let product = flat.singular[0].0 * flat.singular[1].0;
            assert!((product / area - 1.0).abs() < 1e-12, "turned by {degree}°: {product}");
        }
    }
}
