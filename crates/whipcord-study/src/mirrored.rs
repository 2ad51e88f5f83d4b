//! Whether measurements were given in a left-handed frame, or with two columns swapped.

use whipcord::Vec3;
use whipcord_estimation::registration::register_robustly;

use crate::quantity::millimetres;
use crate::remark::Remark;

/// Root mean square distances in m that the best rigid motion leaves of pairs of measured and model points, and of the same after one axis of
/// the measurement is reversed, where that is much the better of the two. Points in a plane fit as well either way.
pub(crate) fn mirrored(pairs: impl Iterator<Item = [Vec3; 2]>) -> Option<[f64; 2]> {
    /// What a mirror leaves of the distance; noise and a wrong stiffness do not change it by as much.
    const MUCH: f64 = 0.5;
    let direct: Vec<[Vec3; 2]> = pairs.collect();
    let mirror =
        |&[measured, model]: &[Vec3; 2]| [Vec3::new(-measured.x, measured.y, measured.z), model];
    let reversed: Vec<[Vec3; 2]> = direct.iter().map(mirror).collect();
    let [whole, rest] =
        [register_robustly(&direct).ok()?.0.rms, register_robustly(&reversed).ok()?.0.rms];
    (rest < MUCH * whole).then_some([whole, rest])
}

/// The warning where a measurement is mirrored.
pub(crate) fn remark([whole, rest]: [f64; 2]) -> Remark {
    Remark {
        code: "mirrored-frame",
        message: format!(
            "the measurement fits with {} RMS if one of its axes is reversed, instead of {}: its frame is left-handed, or two columns are swapped",
            millimetres(rest),
            millimetres(whole)
        ),
        help: "name two columns of the table the other way round, or negate one, so that its frame is right-handed",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points() -> Vec<Vec3> {
        let at = |k: usize| {
            let t = k as f64;
            Vec3::new(0.05 * t.sin(), 0.04 * (1.7 * t).cos(), 0.15 + 0.02 * (0.6 * t).sin())
        };
        (0..30).map(at).collect()
    }

    /// The measurement is turned, moved and 1 mm off.
    fn pairs(seen: impl Fn(Vec3) -> Vec3) -> Vec<[Vec3; 2]> {
        let off = |k: usize| Vec3::new(0.0, 1e-3 * (3.1 * k as f64).sin(), 0.0);
        points().into_iter().enumerate().map(|(k, model)| [seen(model) + off(k), model]).collect()
    }

    #[test]
    fn a_left_handed_frame_is_seen() {
        let moved = Vec3::new(0.3, -0.2, 0.9);
        let right = pairs(|p| Vec3::new(p.y, -p.x, p.z) + moved);
        assert_eq!(mirrored(right.into_iter()), None);
        // Two columns are swapped.
        let left = pairs(|p| Vec3::new(p.y, p.x, p.z) + moved);
        let [whole, rest] = mirrored(left.into_iter()).unwrap();
        assert!(rest < 1e-3 && whole > 0.01, "{whole} {rest}");
        // In a plane there is no difference.
        let flat = pairs(|p| Vec3::new(p.y, p.x, p.z));
        let flat =
            flat.into_iter().map(|[_, p]| [Vec3::new(0.0, p.z, p.x), Vec3::new(p.x, 0.0, p.z)]);
        assert_eq!(mirrored(flat), None);
    }
}
