//! From base to tip, or not at all.

use whipcord_vision::detect::{Base, DetectError, Expected, Mark, in_order};

fn marks(pixels: &[[f64; 2]]) -> Vec<Mark> {
    let mark = |(i, &pixel): (usize, &[f64; 2])| Mark {
        pixel,
        radius: 5.0,
        axis: [1.0, 0.0],
        confidence: 1.0 - 0.01 * i as f64,
    };
    pixels.iter().enumerate().map(mark).collect()
}

fn pixels(marks: &[Mark]) -> Vec<[f64; 2]> {
    marks.iter().map(|mark| mark.pixel).collect()
}

/// Most of a circle, from the bottom counter-clockwise: the tip comes near the base.
fn curled() -> Vec<[f64; 2]> {
    (0..12)
        .map(|i| 0.45 * f64::from(i))
        .map(|a| [500.0 + 200.0 * a.sin(), 500.0 + 200.0 * a.cos()])
        .collect()
}

/// In an order that has nothing to do with the robot.
fn shuffled(row: &[[f64; 2]]) -> Vec<Mark> {
    let mut all = marks(row);
    (0..all.len()).for_each(|i| all.swap(i, (7 * i + 3) % row.len()));
    all
}

#[test]
fn a_curled_robot_is_followed_from_its_base() {
    let row = curled();
    for (base, reversed) in [
        (Base::Bottom, false),
        (Base::Near(row[0]), false),
        (Base::Near(row[11]), true),
        (Base::Top, true),
        (Base::Left, true),
        (Base::Right, false),
    ] {
        let expected = Expected { count: Some(12), base: Some(base), places: None };
        let mut found = pixels(&in_order(&shuffled(&row), &expected).unwrap());
        if reversed {
            found.reverse();
        }
        assert_eq!(found, row, "{base:?}");
    }
}

#[test]
fn ends_that_cannot_be_told_apart_are_refused() {
    let row: Vec<[f64; 2]> = (0..6).map(|i| [100.0 + 50.0 * f64::from(i), 300.0]).collect();
    for base in [None, Some(Base::Top), Some(Base::Near([225.0, 900.0]))] {
        let expected = Expected { count: Some(6), base, places: None };
        let error = in_order(&shuffled(&row), &expected).unwrap_err();
        assert_eq!(error, DetectError::AmbiguousBase { ends: [row[0], row[5]] }, "{base:?}");
    }
}

#[test]
fn a_mirrored_order_is_noticed() {
    // Disks that stand closer towards the tip.
    let places = [0.0, 0.05, 0.09, 0.12, 0.14, 0.15];
    let row: Vec<[f64; 2]> = places.iter().map(|s| [100.0 + 4000.0 * s, 300.0]).collect();
    let expected = |base| Expected { count: Some(6), base, places: Some(&places) };
    for base in [Some(Base::Left), None] {
        let found = in_order(&shuffled(&row), &expected(base)).unwrap();
        assert_eq!(pixels(&found), row, "{base:?}");
    }
    match in_order(&shuffled(&row), &expected(Some(Base::Right))) {
        Err(DetectError::Mirrored { base, forward, reversed }) => {
            assert_eq!(base, row[5]);
            assert!(reversed < 1e-9 && forward > 0.5, "{forward} {reversed}");
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn too_many_and_too_few_are_refused() {
    let row: Vec<[f64; 2]> = (0..6).map(|i| [100.0 + 50.0 * f64::from(i), 300.0]).collect();
    let expected = |count| Expected { count: Some(count), base: Some(Base::Left), places: None };
    let error = in_order(&marks(&row), &expected(5)).unwrap_err();
    let least_sure = vec![row[5]];
    assert_eq!(error, DetectError::TooMany { found: row.clone(), expected: 5, least_sure });
    let without: Vec<_> = row.iter().copied().filter(|p| *p != row[3]).collect();
    let error = in_order(&shuffled(&without), &expected(6)).unwrap_err();
    let words = "5 were found where there must be 6: at (100, 300), (150, 300), (200, 300), (300, 300), \
                 (350, 300); one seems to be missing between (200, 300) and (300, 300)";
    assert_eq!(error.to_string(), words);
    assert_eq!(error, DetectError::TooFew { found: without.clone(), expected: 6, gaps: vec![3] });
    // Where the base is, is not needed for that; and what stands in an even row lacks nothing between.
    let anywhere = |count| Expected { count: Some(count), ..Expected::default() };
    let error = in_order(&shuffled(&without), &anywhere(6)).unwrap_err().to_string();
    let gap = ["(200, 300) and (300, 300)", "(300, 300) and (200, 300)"];
    assert!(gap.iter().any(|gap| error.ends_with(&format!("missing between {gap}"))), "{error}");
    let error = in_order(&shuffled(&row), &anywhere(8)).unwrap_err().to_string();
    assert!(!error.contains("missing"), "{error}");
    // Without a count, a gap is one as well.
    let expected = Expected { base: Some(Base::Left), ..Expected::default() };
    let error = in_order(&shuffled(&without), &expected).unwrap_err();
    assert_eq!(error, DetectError::Gap { found: without, gaps: vec![3] });
}

#[test]
fn what_branches_is_no_row() {
    let mut row: Vec<[f64; 2]> = (0..7).map(|i| [100.0 + 50.0 * f64::from(i), 300.0]).collect();
    row.push([250.0, 345.0]);
    row.push([250.0, 390.0]);
    let expected = Expected { base: Some(Base::Left), ..Expected::default() };
    match in_order(&shuffled(&row), &expected) {
        Err(DetectError::NoRow { found, at }) => {
            assert_eq!((found.len(), at), (9, [250.0, 300.0]));
        }
        other => panic!("{other:?}"),
    }
}
