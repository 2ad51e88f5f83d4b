use core::fmt;

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

/// The colours of Okabe and Ito that stand out on white, in the order in which neighbours differ
/// most to all kinds of colour vision, and after them two of Tol's for figures that need more.
pub const PALETTE: [Colour; 8] = [
    Colour::new(0x00, 0x72, 0xb2),
    Colour::new(0xd5, 0x5e, 0x00),
    Colour::new(0x00, 0x9e, 0x73),
    Colour::new(0xcc, 0x79, 0xa7),
    Colour::new(0xe6, 0x9f, 0x00),
    Colour::new(0x56, 0xb4, 0xe9),
    Colour::new(0x88, 0x22, 0x55),
    Colour::new(0x99, 0x99, 0x33),
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

    /// Colour number `index`, from 0, of [`PALETTE`], which repeats.
    #[must_use]
    pub const fn nth(index: usize) -> Self {
        PALETTE[index % PALETTE.len()]
    }

    /// The colour mixed with white: 1 is the colour itself, 0 white.
    #[must_use]
    pub fn tint(self, strength: f64) -> Self {
        let mix = |c: u8| (255.0 - (255.0 - f64::from(c)) * strength.clamp(0.0, 1.0)).round() as u8;
        Self::new(mix(self.red), mix(self.green), mix(self.blue))
    }
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
        assert_eq!(PALETTE[0].to_string(), "#0072b2");
        assert_eq!(Colour::INK.tint(0.0), Colour::WHITE);
        assert_eq!(Colour::INK.tint(1.0), Colour::INK);
    }
}
