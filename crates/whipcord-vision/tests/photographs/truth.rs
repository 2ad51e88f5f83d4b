//! The photographs are what they say they are: checked without the detector.

use whipcord_vision::render::{Blur, Light, Noise};

use crate::scenes::Shot;

/// All black but for white markers, so that the centroid of the light is that of the marker.
#[test]
fn a_marker_lies_where_the_camera_sees_its_centre() {
    for shot in [Shot::of(3, 0.3, 0.0), Shot::of(3, 0.3, 0.0).bent(0.3)] {
        let mut shot = shot.with_markers([255; 3]);
        let black = [0.0; 3];
        let paint = &mut shot.scene.paint;
        (paint.background, paint.backbone, paint.disks, paint.cables) =
            (black, black, black, black);
        shot.scene.light = Light::default();
        for blur in [Blur::default(), Blur { deviation: 1.3, motion: [3.0, -2.0] }] {
            shot.scene.blur = blur;
            let rendered = shot.take();
            for (i, truth) in rendered.markers.iter().enumerate() {
                let (mut mass, mut sums) = (0.0, [0.0; 2]);
                for (k, pixel) in rendered.photo.pixels().iter().enumerate() {
                    let place = [(k % 720) as f64, (k / 720) as f64];
                    if (place[0] - truth[0]).hypot(place[1] - truth[1]) < 11.0 {
                        mass += f64::from(pixel[0]);
                        (0..2).for_each(|c| sums[c] += f64::from(pixel[0]) * place[c]);
                    }
                }
                let off = (sums[0] / mass - truth[0]).hypot(sums[1] / mass - truth[1]);
                assert!(off < 0.02, "marker {i}: {off} px, {blur:?}");
            }
        }
    }
}

/// Parallel projection keeps the middle of a disk the middle of its image. Seen edge-on its image is a bar
/// of the disk's diameter by its thickness, here of the unbent robot.
#[test]
fn a_disk_covers_what_it_should() {
    let mut shot = Shot::of(0, 0.0, 0.0);
    shot.scene.light = Light::default();
    shot.scene.blur = Blur::default();
    shot.scene.backbone_diameter = 1e-6;
    shot.scene.paint.background = [1.0; 3];
    shot.scene.paint.disks = [0.0; 3];
    let rendered = shot.take();
    for truth in &rendered.disks {
        let (mut mass, mut sums) = (0.0, [0.0; 2]);
        for (k, pixel) in rendered.photo.pixels().iter().enumerate() {
            let place = [(k % 720) as f64, (k / 720) as f64];
            if (place[0] - truth[0]).abs() < 40.0 && (place[1] - truth[1]).abs() < 20.0 {
                let dark = f64::from(1.0 - pixel[0]);
                mass += dark;
                (0..2).for_each(|c| sums[c] += dark * place[c]);
            }
        }
        let off = (sums[0] / mass - truth[0]).hypot(sums[1] / mass - truth[1]);
        assert!(off < 0.02, "{off} px");
        // 20 mm by 2 mm at 2.8 pixels for each mm, and a hair of backbone.
        assert!((mass / (56.0 * 5.6) - 1.0).abs() < 2e-3, "{mass}");
    }
}

#[test]
fn the_same_scene_gives_the_same_photograph() {
    let shot = Shot::of(2, 0.5, 0.05);
    let (first, second) = (shot.take(), shot.take());
    assert!(first == second);
    let mut other = Shot::of(2, 0.5, 0.05);
    other.scene.noise = Noise { seed: other.scene.noise.seed + 1, ..other.scene.noise };
    assert!(first.photo != other.take().photo);
}
