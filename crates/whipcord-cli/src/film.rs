//! What the films of all verbs have in common: their size, their times, and their formats by the ending of the name.

use std::io::{ErrorKind, Write as _};
use std::path::Path;
use std::process::{self, Child, Command, Stdio};

use whipcord_plot::{FilmFrame, FilmPixels, film, film_pixels};

use whipcord_study::failure::Failure;
use whipcord_study::files;

/// Width of a film in px.
pub const FILM_WIDTH: f64 = 720.0;
/// Direction from which films are seen, in rad: one for all pictures.
pub const AZIMUTH: f64 = -1.0;
/// How long a picture is seen at most, in ms.
const LONGEST: f64 = 10_000.0;

/// The program that encodes WebM.
const ENCODER: &str = "ffmpeg";
/// Pictures of a WebM in a second.
const RATE: u64 = 25;

/// The endings of the names of films: animated PNG and WebM.
pub const ENDINGS: [&str; 2] = ["png", "webm"];

fn is_webm(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("webm"))
}

/// Refuses, before anything is computed, a film that cannot be encoded here.
///
/// # Errors
/// [`Failure::Input`] with what to do instead.
pub fn check(path: &Path) -> Result<(), Failure> {
    if is_webm(path) {
        let version = Command::new(ENCODER).arg("-version").stdout(Stdio::null()).status();
        version.map_err(|error| no_encoder(&error))?;
    }
    Ok(())
}

/// A film in the format of its name.
///
/// # Errors
/// [`Failure::Input`] where a picture cannot be drawn or encoded.
pub fn encoded(path: &Path, frames: &[FilmFrame]) -> Result<Vec<u8>, Failure> {
    let failed = |error| files::plot_failure(path, &error);
    if !is_webm(path) {
        return film(frames).map_err(failed);
    }
    webm(path, &film_pixels(frames).map_err(failed)?, &repeats(frames))
}

/// How often each picture is repeated at [`RATE`], so that it ends at its time.
fn repeats(frames: &[FilmFrame]) -> Vec<u64> {
    let (mut milliseconds, mut shown) = (0, 0);
    let of = |frame: &FilmFrame| {
        milliseconds += u64::from(frame.milliseconds);
        let until = (milliseconds * RATE + 500) / 1000;
        until - std::mem::replace(&mut shown, until)
    };
    frames.iter().map(of).collect()
}

/// Encodes pictures as WebM by the program [`ENCODER`], which gets their pixels through a pipe.
fn webm(path: &Path, film: &FilmPixels, repeats: &[u64]) -> Result<Vec<u8>, Failure> {
    // WebM of a known length needs a file, not a pipe.
    let temporary = std::env::temp_dir().join(format!("whipcord-{}.webm", process::id()));
    let size = format!("{}x{}", film.width, film.height);
    let rate = RATE.to_string();
    let input = ["-f", "rawvideo", "-pix_fmt", "rgb24", "-s", &size, "-r", &rate, "-i", "-"];
    let output = ["-c:v", "libvpx-vp9", "-crf", "30", "-b:v", "0", "-cpu-used", "4"];
    let child = Command::new(ENCODER)
        .args(["-hide_banner", "-loglevel", "error", "-y"])
        .args(input)
        .args(output)
        .args(["-pix_fmt", "yuv420p", "-f", "webm"])
        .arg(&temporary)
        .stdin(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .map_err(|error| no_encoder(&error))?;
    let result = fed(child, film, repeats).and_then(|()| {
        std::fs::read(&temporary).map_err(|error| Failure::path("read", &temporary, &error))
    });
    // Nothing is left behind; that it cannot be removed is no reason to fail.
    let _ = std::fs::remove_file(&temporary);
    result.map_err(|error| match error {
        Failure::Input(text) => Failure::Input(format!("{text}, for {}", path.display())),
        other => other,
    })
}

/// Gives an encoder its pictures and waits for its end.
fn fed(mut child: Child, film: &FilmPixels, repeats: &[u64]) -> Result<(), Failure> {
    let mut written = Ok(());
    if let Some(mut input) = child.stdin.take() {
        let pictures = film.pictures.iter().zip(repeats);
        let mut all = pictures.flat_map(|(picture, &count)| (0..count).map(move |_| picture));
        written = all.try_for_each(|picture| input.write_all(picture));
    }
    let failed = |what: &str| Failure::Input(format!("error: {ENCODER} failed: {what}"));
    let output = child.wait_with_output().map_err(|error| failed(&error.to_string()))?;
    // What the program says is more to the point than that it no longer listens.
    if !output.status.success() {
        return Err(failed(String::from_utf8_lossy(&output.stderr).trim()));
    }
    written.map_err(|error| failed(&error.to_string()))
}

/// The encoder does not start.
fn no_encoder(error: &std::io::Error) -> Failure {
    let reason = match error.kind() {
        ErrorKind::NotFound => "is not on the PATH".to_owned(),
        _ => format!("does not start: {error}"),
    };
    Failure::Input(format!(
        "error: a film as WebM needs the program {ENCODER}, which {reason}\nhelp: install {ENCODER}, or end the name of the film in .png for an animated PNG, which browsers play"
    ))
}

/// So many numbers below `count`, spread evenly, the last among them.
pub fn spread(count: usize, most: usize) -> impl Iterator<Item = usize> {
    let shown = count.min(most);
    (0..shown).map(move |k| match shown {
        1 => count - 1,
        _ => k * (count - 1) / (shown - 1),
    })
}

/// How long each picture is seen in ms, for the times in s at which they begin. The last is seen for a second, before the film begins again.
pub fn durations(times: &[f64]) -> Vec<u16> {
    let ends = times.iter().skip(1).copied().chain(times.last().map(|last| last + 1.0));
    #[expect(
        clippy::cast_sign_loss,
        clippy::cast_possible_truncation,
        reason = "within the limits"
    )]
    let milliseconds = |seconds: f64| (1e3 * seconds).clamp(1.0, LONGEST).round() as u16;
    times.iter().zip(ends).map(|(from, to)| milliseconds(to - from)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_are_repeated_up_to_their_times() {
        let frame = |milliseconds| FilmFrame { svg: String::new(), milliseconds };
        assert_eq!(repeats(&[frame(40), frame(60), frame(20), frame(1000)]), [1, 2, 0, 25]);
        assert!(is_webm(Path::new("a/Film.WebM")) && !is_webm(Path::new("webm.png")));
    }

    #[test]
    fn pictures_are_spread_to_the_last_and_seen_for_their_times() {
        assert_eq!(spread(5, 9).collect::<Vec<_>>(), [0, 1, 2, 3, 4]);
        assert_eq!(spread(9, 3).collect::<Vec<_>>(), [0, 4, 8]);
        assert_eq!(spread(9, 1).collect::<Vec<_>>(), [8]);
        assert_eq!(durations(&[0.0, 0.04, 20.0]), [40, 10_000, 1000]);
    }
}
