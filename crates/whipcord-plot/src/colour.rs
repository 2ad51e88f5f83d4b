use core::fmt;

use whipcord::ModelKind;

/// An opaque colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Colour {
    /// Red.
    pub red: u8,
    /// Green.
    pub green: u8,
    /// Blue.
    pub blue: u8,
}

/// The colour of each model, in the order of [`ModelKind::ALL`]: those of Okabe and Ito, which all
/// kinds of colour vision tell apart. `colours.ts` of the viewer's page and `plot.py` of the Python
/// package repeat them.
pub const MODELS: [Colour; 6] = [
    Colour::new(0x00, 0x72, 0xb2),
    Colour::new(0xd5, 0x5e, 0x00),
    Colour::new(0x00, 0x9e, 0x73),
    Colour::new(0xcc, 0x79, 0xa7),
    Colour::new(0xe6, 0x9f, 0x00),
    Colour::new(0x56, 0xb4, 0xe9),
];

/// The colours of cables, and of everything else that is no model: none is the colour of a model.
/// Repeated where those of the models are.
pub const CABLES: [Colour; 6] = [
    Colour::new(0xa0, 0x52, 0x2d),
    Colour::new(0x8e, 0x5b, 0xd0),
    Colour::new(0x5c, 0x8f, 0x1f),
    Colour::new(0xee, 0x66, 0x77),
    Colour::new(0x01, 0x66, 0x5e),
    Colour::new(0xc5, 0x1b, 0x7d),
];

impl Colour {
    /// Text and axes.
    pub const INK: Self = Self::new(0x22, 0x22, 0x22);
    /// What is to be seen last: guides, the state before actuation.
    pub const GREY: Self = Self::new(0x8c, 0x8c, 0x8c);
    /// Grid lines.
    pub const GRID: Self = Self::new(0xe4, 0xe4, 0xe4);
    /// Background.
    pub const WHITE: Self = Self::new(0xff, 0xff, 0xff);

    /// The colour of these components.
    #[must_use]
    pub const fn new(red: u8, green: u8, blue: u8) -> Self {
        Self { red, green, blue }
    }

    /// The colour of a model, the same in every picture.
    #[must_use]
    pub fn of_model(kind: ModelKind) -> Self {
        MODELS[place(kind)]
    }

    /// Colour number `index`, from 0, of [`CABLES`], which repeat: for a cable, or for a series that
    /// does not stand for a model.
    #[must_use]
    pub const fn nth(index: usize) -> Self {
        CABLES[index % CABLES.len()]
    }

    /// Its components as light adds up, from 0 to 1: sRGB without its curve.
    #[must_use]
    pub fn linear(self) -> [f32; 3] {
        [self.red, self.green, self.blue].map(|part| {
            let part = f32::from(part) / 255.0;
            if part <= 0.040_45 { part / 12.92 } else { ((part + 0.055) / 1.055).powf(2.4) }
        })
    }

    /// The colour mixed with white: 1 is the colour itself, 0 white.
    #[must_use]
    pub fn tint(self, strength: f64) -> Self {
        let mix = |c: u8| (255.0 - (255.0 - f64::from(c)) * strength.clamp(0.0, 1.0)).round() as u8;
        Self::new(mix(self.red), mix(self.green), mix(self.blue))
    }
}

/// Where a model stands among all.
pub(crate) fn place(kind: ModelKind) -> usize {
    ModelKind::ALL.iter().position(|&other| other == kind).unwrap_or(0)
}

/// `#rgb` where that says it all, else `#rrggbb`.
impl fmt::Display for Colour {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let components = [self.red, self.green, self.blue];
        if components.iter().all(|c| c % 17 == 0) {
            let [r, g, b] = components.map(|c| c / 17);
            write!(f, "#{r:x}{g:x}{b:x}")
        } else {
            let [r, g, b] = components;
            write!(f, "#{r:02x}{g:02x}{b:02x}")
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_are_written_for_svg() {
        assert_eq!(Colour::WHITE.to_string(), "#fff");
        assert_eq!(MODELS[0].to_string(), "#0072b2");
        assert_eq!(Colour::INK.tint(0.0), Colour::WHITE);
        assert_eq!(Colour::INK.tint(1.0), Colour::INK);
    }

    #[test]
    fn every_model_has_a_colour_of_its_own() {
        let all = ModelKind::ALL.map(Colour::of_model);
        assert_eq!(all, MODELS);
        for (i, colour) in all.iter().enumerate() {
            assert!(!all[..i].contains(colour) && !CABLES.contains(colour));
        }
    }

    /// How colours look to those without cones for long, medium and short waves (Machado, Oliveira and Fernandes
    /// 2009), and to all others.
    const SIGHT: [[[f64; 3]; 3]; 4] = [
        [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        [
            [0.152286, 1.052583, -0.204868],
            [0.114503, 0.786281, 0.099216],
            [-0.003882, -0.048116, 1.051998],
        ],
        [
            [0.367322, 0.860646, -0.227968],
            [0.280085, 0.672501, 0.047413],
            [-0.011820, 0.042940, 0.968881],
        ],
        [
            [1.255528, -0.076749, -0.178779],
            [-0.078411, 0.930809, 0.147602],
            [0.004733, 0.691367, 0.303900],
        ],
    ];

    fn times(m: [[f64; 3]; 3], v: [f64; 3]) -> [f64; 3] {
        m.map(|row| row.iter().zip(v).map(|(a, b)| a * b).sum())
    }

    fn linear(of: Colour) -> [f64; 3] {
        [of.red, of.green, of.blue].map(|c| {
            let c = f64::from(c) / 255.0;
            if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
        })
    }

    /// In the space OKLab (Ottosson 2020), where distances are near to those that are seen.
    fn lab(linear: [f64; 3]) -> [f64; 3] {
        let lms = times(
            [
                [0.4122214708, 0.5363325363, 0.0514459929],
                [0.2119034982, 0.6806995451, 0.1073969566],
                [0.0883024619, 0.2817188376, 0.6299787005],
            ],
            linear,
        );
        times(
            [
                [0.2104542553, 0.7936177850, -0.0040720468],
                [1.9779984951, -2.4285922050, 0.4505937099],
                [0.0259040371, 0.7827717662, -0.8086757660],
            ],
            lms.map(|v| v.max(0.0).cbrt()),
        )
    }

    /// The least distance of two of these colours to any of the kinds of sight.
    fn apart(colours: &[Colour]) -> f64 {
        let mut least = f64::INFINITY;
        for sight in SIGHT {
            let seen: Vec<[f64; 3]> =
                colours.iter().map(|&c| lab(times(sight, linear(c)))).collect();
            for (i, a) in seen.iter().enumerate() {
                for b in &seen[..i] {
                    let squares: f64 = (0..3).map(|k| (a[k] - b[k]).powi(2)).sum();
                    least = least.min(squares.sqrt());
                }
            }
        }
        least
    }

    fn contrast(a: Colour, b: Colour) -> f64 {
        let [a, b] = [a, b].map(|colour| {
            let [r, g, b] = linear(colour);
            0.2126 * r + 0.7152 * g + 0.0722 * b + 0.05
        });
        a.max(b) / a.min(b)
    }

    /// A difference of 0.02 is about the least that is seen side by side.
    #[test]
    fn colours_are_told_apart_by_all_kinds_of_colour_vision() {
        assert!(apart(&MODELS) > 0.07, "{}", apart(&MODELS));
        assert!(apart(&CABLES) > 0.05, "{}", apart(&CABLES));
        // Red and green of the same lightness are the pair that must fail.
        assert!(apart(&[Colour::new(0xa0, 0x52, 0x2d), Colour::new(0x60, 0x70, 0x2d)]) < 0.05);
    }

    #[test]
    fn colours_stand_out_on_white_and_on_the_dark_page() {
        let dark = Colour::new(0x15, 0x19, 0x1c);
        for colour in MODELS.into_iter().chain(CABLES) {
            for page in [Colour::WHITE, dark] {
                let contrast = contrast(colour, page);
                assert!(contrast > 2.2, "{colour} on {page}: {contrast}");
            }
        }
    }
}
