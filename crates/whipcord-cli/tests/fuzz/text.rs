//! Damage to texts and bytes of any kind.

use crate::random::Random;

/// Values that programs stumble over.
const EXTREMES: [&str; 16] = [
    "0",
    "-0.0",
    "-1",
    "1",
    "nan",
    "inf",
    "-inf",
    "1e308",
    "-1e308",
    "1e-320",
    "9223372036854775807",
    "-9223372036854775808",
    "4294967296",
    "99999999999999999999999",
    "1e-9",
    "1e9",
];

/// Another number in place of this one: mostly near it, where `mild`.
pub fn number(old: &str, mild: bool, random: &mut Random) -> String {
    let Ok(value) = old.parse::<f64>() else { return (*random.pick(&EXTREMES)).to_owned() };
    if let Ok(whole) = old.parse::<i64>()
        && (mild || random.chance(30))
    {
        return whole.saturating_add(*random.pick(&[-1, 1, 1, 2])).to_string();
    }
    if mild {
        return format!("{:?}", value * (0.5 + random.unit()));
    }
    match random.below(4) {
        0 => format!("{:?}", value * 10_f64.powi(random.below(25) as i32 - 12)),
        1 => format!("{:?}", -value),
        2 => format!("{:?}", value * (1.0 + f64::EPSILON)),
        _ => (*random.pick(&EXTREMES)).to_owned(),
    }
}

/// The text with some of its numbers changed.
pub fn numbers(text: &str, mild: bool, random: &mut Random) -> String {
    let is_digit = |c: char| c.is_ascii_digit();
    let is_part = |c: char| c.is_ascii_digit() || "+-.eE".contains(c);
    let starts: Vec<usize> = text
        .char_indices()
        .filter(|&(at, c)| {
            let before = text[..at].chars().next_back();
            (is_digit(c) || c == '-') && before.is_none_or(|b| !is_part(b) && !b.is_alphanumeric())
        })
        .map(|(at, _)| at)
        .collect();
    if starts.is_empty() {
        return if mild { text.to_owned() } else { text.to_owned() + &number("", false, random) };
    }
    let mut chosen: Vec<usize> =
        (0..1 + random.below(if mild { 1 } else { 3 })).map(|_| *random.pick(&starts)).collect();
    chosen.sort_unstable();
    chosen.dedup();
    let mut out = text.to_owned();
    for at in chosen.into_iter().rev() {
        let end = text[at..].find(|c| !is_part(c)).map_or(text.len(), |length| at + length);
        out.replace_range(at..end, &number(&text[at..end], mild, random));
    }
    out
}

/// The text with a line left out, repeated or put elsewhere, or a value of a line.
pub fn lines(text: &str, separator: char, random: &mut Random) -> String {
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    let at = random.below(lines.len());
    if lines.is_empty() {
        return String::new();
    }
    match random.below(5) {
        0 => drop(lines.remove(at)),
        1 => {
            let times = *random.pick(&[1, 2, 50, 2000]);
            let line = lines[at].clone();
            lines.splice(at..at, std::iter::repeat_n(line, times));
        }
        2 => {
            let other = random.below(lines.len());
            lines.swap(at, other);
        }
        _ => {
            let mut cells: Vec<&str> = lines[at].split(separator).collect();
            let (from, to) = (random.below(cells.len()), random.below(cells.len()));
            match random.below(3) {
                0 => cells.swap(from, to),
                1 => cells[to] = cells[from],
                _ => {
                    cells[to] =
                        *random.pick(&["", "x", "\"", "1;2", "é", "\u{feff}", "1e400", "# "])
                }
            }
            lines[at] = cells.join(&separator.to_string());
        }
    }
    lines.join("\n") + "\n"
}

/// Bytes flipped, cut out, repeated, or overwritten by numbers of extreme size.
pub fn bytes(bytes: &mut Vec<u8>, random: &mut Random) {
    if bytes.is_empty() {
        return;
    }
    let at = random.below(bytes.len());
    let end = (at + 1 + random.below(64)).min(bytes.len());
    match random.below(8) {
        0 => bytes.truncate(at),
        1 => drop(bytes.drain(at..end)),
        2 => {
            let piece = bytes[at..end].repeat(1 + random.below(20));
            bytes.splice(at..at, piece);
        }
        3 | 4 => {
            let extreme =
                *random.pick(&[0, 1, 0x7f, 0x80, 0xff, 0x7fff_ffff, 0x8000_0000, u32::MAX]);
            let word =
                if random.chance(50) { extreme.to_le_bytes() } else { extreme.to_be_bytes() };
            for (byte, new) in bytes[at..].iter_mut().zip(word) {
                *byte = new;
            }
        }
        _ => bytes[at] ^= 1 << random.below(8),
    }
}

/// Numbers of four bytes, least byte first, changed mildly: one of them wherever it occurs, or all scaled, in records of `size`
/// bytes that begin at `from`, each with its numbers at `range`.
pub fn floats(
    bytes: &mut [u8],
    from: usize,
    size: usize,
    range: core::ops::Range<usize>,
    random: &mut Random,
) {
    let Some(records) = bytes.get_mut(from..) else { return };
    let numbers: Vec<[u8; 4]> = records
        .chunks_exact(size)
        .flat_map(|record| record[range.clone()].as_chunks::<4>().0.to_vec())
        .collect();
    if numbers.is_empty() {
        return;
    }
    let (chosen, all) = (*random.pick(&numbers), random.chance(30));
    let factor = (0.5 + random.unit()) as f32;
    let shift = if f32::from_le_bytes(chosen) == 0.0 { factor } else { 0.0 };
    for record in records.chunks_exact_mut(size) {
        for number in record[range.clone()].as_chunks_mut::<4>().0 {
            if all || *number == chosen {
                *number = (f32::from_le_bytes(*number) * factor + shift).to_le_bytes();
            }
        }
    }
}

/// One number of the lines that begin with `keyword` changed mildly wherever it occurs in them, or all of them scaled.
pub fn coordinates(text: &str, keyword: &str, random: &mut Random) -> String {
    let is_chosen = |line: &&str| line.split_whitespace().next() == Some(keyword);
    let all: Vec<&str> =
        text.lines().filter(is_chosen).flat_map(|line| line.split_whitespace().skip(1)).collect();
    if all.is_empty() {
        return text.to_owned();
    }
    let (chosen, every) = (*random.pick(&all), random.chance(30));
    let factor = 0.5 + random.unit();
    let changed = |word: &str| match word.parse::<f64>() {
        Ok(0.0) if !every => format!("{factor:?}"),
        Ok(value) => format!("{:?}", value * factor),
        Err(_) => word.to_owned(),
    };
    let line = |line: &str| {
        if !is_chosen(&line) {
            return line.to_owned() + "\n";
        }
        let words = line
            .split_whitespace()
            .skip(1)
            .map(|word| if every || word == chosen { changed(word) } else { word.to_owned() });
        format!("{keyword} {}\n", words.collect::<Vec<_>>().join(" "))
    };
    text.lines().map(line).collect()
}
