//! Dots and circles.

use whipcord_vision::detect::{Kind, Search, colour, find};

use crate::scenes::{Shot, any, found, rms};

const RED: [u8; 3] = [0xd0, 0x20, 0x20];

#[test]
fn dots_of_the_most_vivid_colour_are_found() {
    for shot in [
        Shot::of(2, 0.0, 0.03).with_markers(RED),
        Shot::of(3, 0.5, 0.03).bent(0.5).with_markers([0x10, 0xa0, 0x30]),
    ] {
        let rendered = shot.take();
        let off = rms(&found(&rendered.photo, Kind::Dots), &rendered.markers);
        assert!(off < 0.3, "{off}");
    }
}

/// Blue dots, larger and more vivid, lie between the red ones.
#[test]
fn dots_of_another_colour_are_left_out() {
    let mut shot = Shot::of(1, 0.0, 0.03).with_markers(RED);
    let blue: Vec<_> = shot
        .scene
        .markers
        .iter()
        .map(|marker| whipcord_vision::render::Marker {
            offset: marker.offset + whipcord::Vec3::new(0.0, 0.012, 0.0),
            radius: 0.0018,
            colour: colour([0x10, 0x20, 0xf0]),
            ..*marker
        })
        .collect();
    shot.scene.markers.extend(blue);
    let rendered = shot.take();
    let search = Search { colour: Some(colour(RED)), ..any(Kind::Dots) };
    let marks = find(&rendered.photo, &search).unwrap();
    let off = rms(&marks, &rendered.markers[..10]);
    assert!(off < 0.3, "{off}");
}

#[test]
fn light_circles_on_a_dark_robot_are_found() {
    let mut shot = Shot::of(4, 0.0, 0.03);
    // Thick disks, so that all of each circle is before its disk.
    shot.scene.disk_thickness = 0.005;
    let rendered = shot.with_markers([240; 3]).take();
    let off = rms(&found(&rendered.photo, Kind::Circles), &rendered.markers);
    assert!(off < 0.3, "{off}");
}

/// The faces of the disks are half as light again as their rims, which draws the circles that lie on both.
#[test]
fn dark_circles_on_a_light_robot_are_found() {
    let mut shot = Shot::of(1, 0.3, 0.03);
    shot.scene.disk_thickness = 0.005;
    let paint = &mut shot.scene.paint;
    (paint.background, paint.disks, paint.backbone) = ([0.1; 3], [0.6; 3], [0.6; 3]);
    let rendered = shot.with_markers([30; 3]).take();
    let off = rms(&found(&rendered.photo, Kind::Circles), &rendered.markers);
    assert!(off < 0.4, "{off}");
}
