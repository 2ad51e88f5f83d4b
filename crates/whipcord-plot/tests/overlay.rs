//! Models over a photograph lie where the camera sees them.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking, in its helpers too")]

mod common;

use common::{before, prototype, towards, view};
use resvg::tiny_skia::Pixmap;
use resvg::usvg::roxmltree::Document;
use whipcord::{ModelKind, Pose, Robot, UnitQuaternion, Vec3};
use whipcord_estimation::camera::{Camera, Distortion, Lens, Orthographic, Pinhole};
use whipcord_plot::{
    OverlayOptions, Photograph, PlotError, RobotView, ViewStyle, overlay_figure, png,
};

const SIZE: [u32; 2] = [640, 480];

/// A plain wall.
fn photograph() -> Vec<u8> {
    let svg = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"640\" height=\"480\"><rect width=\"640\" height=\"480\" fill=\"#8090a0\"/></svg>";
    png(svg, 1.0).unwrap()
}

fn robot() -> (Robot, [RobotView; 2]) {
    let robot = prototype(&[4; 10]).unwrap();
    let bent =
        view(&robot, "cosserat", ViewStyle::Model(ModelKind::Cosserat), |_| towards(1.5, 8.0));
    let rest = before(&robot);
    (robot, [rest, bent])
}

/// From the side: y of the world points to the left of the image, z up.
fn side() -> UnitQuaternion {
    let turn = UnitQuaternion::from_wxyz([0.5, -0.5, 0.5, -0.5]).unwrap();
    assert_eq!([Vec3::X, Vec3::Y, Vec3::Z].map(|a| turn.rotate(a)), [-Vec3::Y, -Vec3::Z, Vec3::X]);
    turn
}

fn cameras() -> [Camera; 2] {
    let distortion = Distortion::new(&[-0.1, 0.02, 1e-3, -1e-3]).unwrap();
    let pinhole = Pinhole::new([900.0, 900.0], [320.0, 240.0], distortion).unwrap();
    let far = Pose { position: Vec3::new(-0.5, 0.03, 0.09), rotation: side() };
    let orthographic = Orthographic::new(2000.0, [320.0, 240.0]).unwrap();
    [
        Camera::new(Lens::Pinhole(pinhole), far, Some(SIZE)).unwrap(),
        Camera::new(Lens::Orthographic(orthographic), far, Some(SIZE)).unwrap(),
    ]
}

fn circles(svg: &str) -> Vec<[f64; 2]> {
    let document = Document::parse(svg).unwrap();
    let overlay = document.descendants().find(|n| n.attribute("class") == Some("overlay")).unwrap();
    overlay
        .descendants()
        .filter(|n| n.has_tag_name("circle"))
        .map(|n| ["cx", "cy"].map(|name| n.attribute(name).unwrap().parse().unwrap()))
        .collect()
}

#[test]
fn disks_lie_where_the_camera_sees_them() {
    let (robot, views) = robot();
    let bytes = photograph();
    for camera in cameras() {
        let pixel = |position| camera.project(position).unwrap();
        let measured: Vec<[f64; 2]> = views[1].disks.positions().map(pixel).collect();
        let options = OverlayOptions { measured: measured.clone(), ..Default::default() };
        let photograph = Photograph { bytes: &bytes, size: SIZE };
        let svg = overlay_figure(&robot, &camera, photograph, &views, &options).unwrap();
        // The photograph is 952 px wide, 14 px from the edges.
        let scale = 952.0 / 640.0;
        let found = circles(&svg);
        assert_eq!(found.len(), 10);
        for (at, pixel) in found.iter().zip(&measured) {
            for i in 0..2 {
                assert!(
                    (at[i] - 14.0 - scale * (pixel[i] + 0.5)).abs() < 0.006,
                    "{at:?} {pixel:?}"
                );
            }
        }
        assert_eq!(svg, overlay_figure(&robot, &camera, photograph, &views, &options).unwrap());
        // The photograph is seen where nothing is drawn over it.
        let pixels = Pixmap::decode_png(&png(&svg, 1.0).unwrap()).unwrap();
        let corner = pixels.pixel(20, 20).unwrap();
        assert_eq!((corner.red(), corner.green(), corner.blue()), (0x80, 0x90, 0xa0));
        if let Ok(path) = std::env::var("SHOW") {
            std::fs::write(path, png(&svg, 1.0).unwrap()).unwrap();
        }
    }
}

#[test]
fn what_is_not_in_the_photograph_is_refused() {
    let (robot, views) = robot();
    let bytes = photograph();
    let photograph = Photograph { bytes: &bytes, size: SIZE };
    let options = OverlayOptions::default();
    let [camera, _] = cameras();
    let away = Pose { position: Vec3::new(0.5, 0.0, 0.09), rotation: side() };
    let away = camera.at(away).unwrap();
    let refused = |camera: &Camera, photograph, options: &OverlayOptions| {
        overlay_figure(&robot, camera, photograph, &views, options).unwrap_err()
    };
    let error = refused(&away, photograph, &options);
    assert_eq!(error, PlotError::NotSeen { what: "before actuation".into() });
    assert!(error.to_string().contains("check the camera's pose"), "{error}");
    let text = Photograph { bytes: b"GIF89a", size: SIZE };
    assert_eq!(refused(&camera, text, &options), PlotError::Photograph);
    let lost = OverlayOptions { measured: vec![[f64::NAN, 0.0]], ..OverlayOptions::default() };
    assert!(matches!(refused(&camera, photograph, &lost), PlotError::NotFinite { .. }));
    let empty = Photograph { bytes: &bytes, size: [0, 480] };
    assert!(matches!(refused(&camera, empty, &options), PlotError::Size { .. }));
    let none = overlay_figure(&robot, &camera, photograph, &[], &options);
    assert!(matches!(none, Err(PlotError::Empty { .. })));
}
