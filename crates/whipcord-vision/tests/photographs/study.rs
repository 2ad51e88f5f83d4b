//! Recall, precision and error against noise.

use whipcord_vision::detect::Kind;

use crate::scenes::{Shot, found, misses};

/// What was found in several photographs.
#[derive(Default)]
struct Tally {
    there: usize,
    found: usize,
    right: usize,
    squares: f64,
}

impl Tally {
    fn recall(&self) -> f64 {
        self.right as f64 / self.there as f64
    }

    /// 1 where nothing was found.
    fn precision(&self) -> f64 {
        self.right as f64 / self.found.max(1) as f64 + if self.found == 0 { 1.0 } else { 0.0 }
    }

    fn rms(&self) -> f64 {
        (self.squares / self.right.max(1) as f64).sqrt()
    }

    fn count(&mut self, shot: &Shot, kind: Kind) {
        let rendered = shot.take();
        let truth = if kind == Kind::Disks { &rendered.disks } else { &rendered.markers };
        let marks = found(&rendered.photo, kind);
        let misses: Vec<f64> = misses(&marks, truth).into_iter().flatten().collect();
        self.there += truth.len();
        self.found += marks.len();
        self.right += misses.len();
        self.squares += misses.iter().map(|d| d * d).sum::<f64>();
    }
}

/// Photographs of a kind under noise of this deviation: each case from several sides, every other one through a
/// lens that bends.
fn tally(kind: Kind, noise: f64, cases: &[usize], azimuths: &[f64]) -> Tally {
    let mut tally = Tally::default();
    for &case in cases {
        for (i, &azimuth) in azimuths.iter().enumerate() {
            let shot = Shot::of(case, azimuth, noise);
            let mut shot = if i % 2 == 1 { shot.bent(azimuth) } else { shot };
            match kind {
                Kind::Disks => {}
                Kind::Dots => shot = shot.with_markers([0xd0, 0x20, 0x20]),
                Kind::Circles => {
                    shot.scene.disk_thickness = 0.005;
                    shot = shot.with_markers([240; 3]);
                }
            }
            tally.count(&shot, kind);
        }
    }
    tally
}

/// The table of `docs/theory/photographs.md`:
/// `cargo test --release -p whipcord-vision --test photographs -- --ignored --nocapture against_noise`
#[test]
#[ignore = "takes minutes"]
fn recall_and_precision_against_noise() {
    println!("| noise | kind | recall | precision | RMS in pixels |\n|---|---|---|---|---|");
    for noise in [0.0, 0.01, 0.03, 0.06, 0.1, 0.15, 0.2] {
        for kind in Kind::ALL {
            let tally = tally(kind, noise, &[1, 2, 3, 4], &[0.0, 0.1, -0.2, 0.3]);
            println!(
                "| {} % | {} | {:.3} | {:.3} | {:.3} |",
                100.0 * noise,
                kind.name(),
                tally.recall(),
                tally.precision(),
                tally.rms()
            );
        }
    }
}

/// A few of the study's photographs.
#[test]
fn noise_costs_recall_before_precision() {
    for (kind, noise, recall, rms) in [
        (Kind::Disks, 0.0, 1.0, 0.15),
        (Kind::Disks, 0.06, 1.0, 0.3),
        (Kind::Dots, 0.06, 0.95, 0.3),
        (Kind::Circles, 0.06, 0.9, 0.3),
    ] {
        let tally = tally(kind, noise, &[1, 4], &[0.0, 0.1]);
        let (found, precise) = (tally.recall(), tally.precision());
        assert!(found >= recall, "{kind:?} {noise}: recall {found}");
        assert!(precise >= 0.97, "{kind:?} {noise}: precision {precise}");
        assert!(tally.rms() < rms, "{kind:?} {noise}: {}", tally.rms());
    }
}
