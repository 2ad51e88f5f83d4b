//! Segments of the backbone.

use whipcord::robot::BackboneSegment;
use whipcord_io::{CaseFile, FileError, describe, parse, toml};

const ROBOT: &str = r#"
[backbone]
length = "180 mm"
diameter = "3 mm"
young_modulus = "1.1 GPa"
poisson_ratio = 0.3
SEGMENTS
[disks]
count = 4
hole_circle_radius = "8 mm"
"#;

fn read(segments: &str) -> Result<CaseFile, FileError> {
    parse(&ROBOT.replace("SEGMENTS", segments), "robot.toml")
}

/// They follow one another from the base to the tip, and are written as they were read.
#[test]
fn they_are_read_and_written() {
    let file = read(
        "[[backbone.segments]]\nname = 'near'\ngroup = 'soft'\nends_at = '50 mm'\nbending_factor = 1.2\n\
         [[backbone.segments]]\nends_at = '90 mm'\ntorsion_factor = 0.5\n\
         [[backbone.segments]]\nname = 'far'\nstarts_at = '100 mm'\nshear_factor = 2\nextension_factor = 3\n\
         [fit]\nparameters = ['backbone.segments[far].bending_factor', 'backbone.segments[*].torsion_factor']\n",
    );
    let file = file.unwrap_or_else(|error| panic!("{error}"));
    let segments = [
        BackboneSegment {
            group: Some("soft".into()),
            bending_factor: 1.2,
            ..BackboneSegment::new("near", [0.0, 0.05])
        },
        BackboneSegment { torsion_factor: 0.5, ..BackboneSegment::new("segment-2", [0.05, 0.09]) },
        BackboneSegment {
            shear_factor: 2.0,
            extension_factor: 3.0,
            ..BackboneSegment::new("far", [0.1, 0.18])
        },
    ];
    assert_eq!(file.robot.backbone().segments, segments);
    let unknowns = file.fit.unwrap().shared;
    assert_eq!(unknowns.iter().map(|of| of.quantities().count()).collect::<Vec<_>>(), [1, 3]);
    let text = toml(&describe(None, &file.robot, &file.case).unwrap());
    let again = parse(&text, "again.toml").unwrap_or_else(|error| panic!("{error}\n{text}"));
    assert_eq!(again.robot.backbone(), file.robot.backbone());
}

#[test]
fn wrong_ones_are_named() {
    for (segments, message) in [
        ("[[backbone.segments]]\nends_at = '200 mm'\n", "`ends_at` of segment 1"),
        (
            "[[backbone.segments]]\nends_at = '90 mm'\n[[backbone.segments]]\nstarts_at = '80 mm'\n",
            "must increase from the base to the tip",
        ),
        (
            "[[backbone.segments]]\nname = 'a'\nends_at = '90 mm'\n[[backbone.segments]]\nname = 'a'\n",
            "already the name",
        ),
        ("[[backbone.segments]]\nbending_factor = 0\n", "bending_factor"),
        ("[[backbone.segments]]\nto = '90 mm'\n", "no key `to`"),
        (
            "[[backbone.segments]]\nname = 'a'\n[fit]\nparameters = ['backbone.segments[b].bending_factor']\n",
            "no backbone.segments are called `b`",
        ),
    ] {
        let error = read(segments).unwrap_err().to_string();
        assert!(error.contains(message), "{message}: {error}");
    }
}
