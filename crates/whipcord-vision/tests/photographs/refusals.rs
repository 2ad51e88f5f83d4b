//! What is no photograph, or not of a robot.

use std::io::Cursor;

use image::{DynamicImage, GrayImage, ImageFormat, Luma};
use whipcord_vision::detect::{DetectError, Kind, Mask, Search, find};
use whipcord_vision::render::Noise;
use whipcord_vision::{Photo, PhotoError};

use crate::scenes::{Shot, any, found, rms};

#[test]
fn bytes_that_are_no_picture_are_refused() {
    assert_eq!(Photo::decode(&[]), Err(PhotoError::Empty));
    assert_eq!(Photo::decode(b"[backbone]\nlength = 1\n"), Err(PhotoError::NotAnImage));
    let whole = Shot::of(1, 0.0, 0.0).take().photo;
    for bytes in [whole.to_png().unwrap(), whole.to_jpeg().unwrap()] {
        let half = &bytes[..bytes.len() / 2];
        let broken = Photo::decode(half);
        assert!(matches!(broken, Err(PhotoError::Broken { .. })), "{:?}", broken.err());
        assert_eq!(Photo::decode(&bytes).unwrap().width(), 720);
    }
}

/// Pixels in any number of bits and channels become the same light.
#[test]
fn every_kind_of_pixel_is_read() {
    let (width, height) = (7, 37);
    let grey = GrayImage::from_fn(width, height, |x, y| Luma([(20 * x + 3 * y) as u8]));
    let png = |image: DynamicImage| {
        let mut bytes = Cursor::new(Vec::new());
        image.write_to(&mut bytes, ImageFormat::Png).unwrap();
        Photo::decode(&bytes.into_inner()).unwrap()
    };
    let image = DynamicImage::ImageLuma8(grey);
    let expected = png(image.clone());
    assert_eq!((expected.width(), expected.height()), (7, 37));
    for (i, pixel) in expected.pixels().iter().enumerate() {
        // The curve of sRGB above its straight part.
        let level = (20 * (i % 7) + 3 * (i / 7)) as f64 / 255.0;
        let light = if level > 0.05 { ((level + 0.055) / 1.055).powf(2.4) } else { level / 12.92 };
        assert!(
            pixel.iter().all(|&l| (f64::from(l) - light).abs() < 2e-4),
            "{i}: {pixel:?} {light}"
        );
    }
    for other in [
        DynamicImage::ImageRgb8(image.to_rgb8()),
        DynamicImage::ImageRgba8(image.to_rgba8()),
        DynamicImage::ImageLuma16(image.to_luma16()),
        DynamicImage::ImageRgba16(image.to_rgba16()),
    ] {
        let photo = png(other);
        for (a, b) in photo.pixels().iter().flatten().zip(expected.pixels().iter().flatten()) {
            assert!((a - b).abs() < 1e-6, "{a} {b}");
        }
    }
}

#[test]
fn photographs_of_too_many_pixels_are_refused() {
    let side = Photo::LARGEST_SIDE;
    for (width, height) in [(side + 1, 1), (1, side + 1), (10_000, 6_401)] {
        let bytes = vec![0; 3 * width as usize * height as usize];
        let refused = Photo::of_rgb8(width as usize, height as usize, &bytes);
        let most = Photo::MOST_PIXELS;
        assert_eq!(refused, Err(PhotoError::TooLarge { width, height, side, most }));
    }
}

/// What is written is read back to half a step of eight bits.
#[test]
fn light_survives_a_file() {
    let mut photo = Photo::uniform(64, 32, [0.0; 3]);
    for (i, pixel) in photo.pixels_mut().iter_mut().enumerate() {
        *pixel = [i as f32 / 2048.0, 0.5, 1.0 - i as f32 / 2048.0];
    }
    let again = Photo::decode(&photo.to_png().unwrap()).unwrap();
    for (a, b) in photo.pixels().iter().flatten().zip(again.pixels().iter().flatten()) {
        // The sRGB curve is at most 2.275 steep, in steps of 1/255.
        assert!((a - b).abs() <= 0.51 * 2.275 / 255.0, "{a} {b}");
    }
}

#[test]
fn photographs_without_a_robot_are_refused() {
    let empty = |noise| {
        let mut shot = Shot::of(1, 0.0, noise);
        let wall = shot.scene.paint.background;
        let paint = &mut shot.scene.paint;
        (paint.backbone, paint.disks, paint.cables) = (wall, wall, wall);
        // The faces of disks are lighter than their rims.
        shot.scene.disk_radius = 1e-6;
        shot.scene.backbone_diameter = 1e-6;
        shot.take().photo
    };
    for noise in [0.0, 0.03, 0.1] {
        let photo = empty(noise);
        for kind in Kind::ALL {
            let outcome = find(&photo, &any(kind));
            assert!(outcome.is_err(), "{kind:?} {noise}: {outcome:?}");
        }
    }
    let noise = {
        let mut shot = Shot::of(1, 0.0, 0.0);
        shot.scene.noise = Noise { dark: 0.5, bright: 0.5, seed: 3 };
        shot.take().photo
    };
    for kind in Kind::ALL {
        let outcome = find(&noise, &any(kind));
        assert!(outcome.is_err(), "{kind:?}: {:?}", outcome.map(|marks| marks.len()));
    }
}

/// A mask leaves a part of the robot, or nothing, or is of another picture.
#[test]
fn masks_are_obeyed() {
    let rendered = Shot::of(1, 0.0, 0.03).take();
    let mut picture = Photo::uniform(720, 660, [0.0; 3]);
    for (i, pixel) in picture.pixels_mut().iter_mut().enumerate() {
        // All below the fifth disk.
        if i / 720 > 394 {
            *pixel = [1.0; 3];
        }
    }
    let mask = Mask::light_of(&picture);
    let search = Search { mask: Some(&mask), ..any(Kind::Disks) };
    let marks = find(&rendered.photo, &search).unwrap();
    assert!(rms(&marks, &rendered.disks[..4]) < 0.1);
    assert_eq!(found(&rendered.photo, Kind::Disks).len(), 10);

    let black = Mask::light_of(&Photo::uniform(720, 660, [0.0; 3]));
    let search = Search { mask: Some(&black), ..any(Kind::Disks) };
    assert_eq!(find(&rendered.photo, &search), Err(DetectError::EmptyMask));
    let other = Mask::light_of(&Photo::uniform(20, 30, [1.0; 3]));
    let search = Search { mask: Some(&other), ..any(Kind::Disks) };
    let expected = DetectError::MaskSize { mask: [20, 30], photo: [720, 660] };
    assert_eq!(find(&rendered.photo, &search), Err(expected));
}

/// As telephones store what they took on their side.
#[test]
fn a_photograph_on_its_side_is_turned_upright() {
    let (width, height) = (40, 24);
    let left_dark = |i: usize| if i % width < width / 2 { 20 } else { 220 };
    let rgb: Vec<u8> = (0..3 * width * height).map(|i| left_dark(i / 3)).collect();
    let jpeg = Photo::of_rgb8(width, height, &rgb).unwrap().to_jpeg().unwrap();
    // Exif with the one entry "orientation": 6, a quarter clockwise.
    let tiff =
        [&b"Exif\0\0MM\0\x2a\0\0\0\x08\0\x01"[..], b"\x01\x12\0\x03\0\0\0\x01\0\x06\0\0\0\0\0\0"]
            .concat();
    let mut turned = jpeg[..2].to_vec();
    turned.extend([0xff, 0xe1, 0, u8::try_from(tiff.len() + 2).unwrap()]);
    turned.extend(&tiff);
    turned.extend(&jpeg[2..]);

    let (photo, stored) = Photo::decode_upright(turned.clone()).unwrap();
    assert_eq!((photo.width(), photo.height()), (height, width));
    let rgb = photo.to_rgb8();
    assert!(rgb[0] < 60 && rgb[3 * height * (width - 1)] > 180, "dark above, light below");
    assert_ne!(stored, turned);
    let again = Photo::decode_upright(stored.clone()).unwrap();
    assert_eq!((again.0.width(), again.0.height(), again.1), (height, width, stored));
    // What is upright is stored as it is.
    assert_eq!(Photo::decode_upright(jpeg.clone()).unwrap().1, jpeg);
}
