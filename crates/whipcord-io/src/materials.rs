//! Materials by name: the one table of presets.
//!
//! Values are those at room temperature, for a rod that is bent slowly. The table in `docs/materials.md` is checked against this one.

use whipcord::Material;

/// A material that `material` in `[backbone]` names.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MaterialPreset {
    /// Its name in the robot file.
    pub name: &'static str,
    /// Young's modulus in Pa, along the fibres where there are any.
    pub young_modulus: f64,
    /// Least and greatest Young's modulus in Pa of what is sold under the name.
    pub young_modulus_range: [f64; 2],
    /// Poisson's ratio, or the shear modulus.
    pub shear: Shear,
    /// Density in kg/m³.
    pub density: f64,
    /// Strain up to which it springs back, where that is known.
    pub yield_strain: Option<f64>,
    /// Sources of the values, and remarks.
    pub source: &'static str,
}

/// How a material resists shear.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shear {
    /// Poisson's ratio of an isotropic material.
    PoissonRatio(f64),
    /// Shear modulus in Pa, where it does not follow from Young's modulus: rods with fibres along them.
    Modulus(f64),
}

impl MaterialPreset {
    /// The constants of a backbone of this material. Those that are given beside it take the place of its own; Poisson's ratio
    /// and shear modulus take that of each other, and a mass per length that of the density.
    #[must_use]
    pub(crate) fn beside(&self, given: Material, has_linear_density: bool) -> Material {
        let (ratio, modulus) = match self.shear {
            Shear::PoissonRatio(ratio) => (Some(ratio), None),
            Shear::Modulus(modulus) => (None, Some(modulus)),
        };
        let gives_shear = given.poisson_ratio.is_some() || given.shear_modulus.is_some();
        Material {
            name: Some(self.name),
            young_modulus: given.young_modulus.or(Some(self.young_modulus)),
            poisson_ratio: if gives_shear { given.poisson_ratio } else { ratio },
            shear_modulus: if gives_shear { given.shear_modulus } else { modulus },
            density: given.density.or((!has_linear_density).then_some(self.density)),
            yield_strain: given.yield_strain.or(self.yield_strain),
        }
    }
}

/// All materials that a robot file may name.
#[must_use]
pub const fn materials() -> &'static [MaterialPreset] {
    PRESETS
}

pub(crate) fn preset(name: &str) -> Option<&'static MaterialPreset> {
    PRESETS.iter().find(|preset| preset.name == name)
}

/// The names of all, in the order of the table.
pub(crate) const NAMES: [&str; PRESETS.len()] = {
    let mut names = [""; PRESETS.len()];
    let mut i = 0;
    while i < names.len() {
        names[i] = PRESETS[i].name;
        i += 1;
    }
    names
};

const GPA: f64 = 1e9;
const MPA: f64 = 1e6;
const KPA: f64 = 1e3;

const PRESETS: &[MaterialPreset] = &[
    MaterialPreset {
        name: "nitinol",
        young_modulus: 60.0 * GPA,
        young_modulus_range: [40.0 * GPA, 83.0 * GPA],
        shear: Shear::PoissonRatio(0.33),
        density: 6450.0,
        yield_strain: Some(0.06),
        source: "Superelastic, austenite. Selected Properties of NiTi, Shape Memory Applications Inc.: 83 GPa, 6.45 g/cm³, ν = 0.33, 6 % recovered in 100 cycles; typical values of superelastic wire are 40 to 75 GPa. Linear up to about 1 %; no model describes the plateau beyond.",
    },
    MaterialPreset {
        name: "spring steel",
        young_modulus: 206.0 * GPA,
        young_modulus_range: [196.0 * GPA, 210.0 * GPA],
        shear: Shear::PoissonRatio(0.28),
        density: 7850.0,
        yield_strain: Some(0.006),
        source: "Patented wire, EN 10270-1, with the modulus of EN 13906-1. Typical range of carbon steels; Shigley, table of spring materials, gives 197 to 203 GPa for music wire (ASTM A228). Yield strain: 65 % of a strength of 1.9 GPa over the modulus.",
    },
    MaterialPreset {
        name: "stainless steel",
        young_modulus: 193.0 * GPA,
        young_modulus_range: [180.0 * GPA, 200.0 * GPA],
        shear: Shear::PoissonRatio(0.29),
        density: 8000.0,
        yield_strain: Some(0.001),
        source: "AISI 304 and 316, annealed: ASM Metals Handbook; yield strength 205 MPa, ASTM A240. Wire and tube that are drawn hard bear 0.4 % and more.",
    },
    MaterialPreset {
        name: "titanium grade 5",
        young_modulus: 113.8 * GPA,
        young_modulus_range: [105.0 * GPA, 120.0 * GPA],
        shear: Shear::PoissonRatio(0.342),
        density: 4430.0,
        yield_strain: Some(0.0073),
        source: "Ti-6Al-4V, annealed: data sheet of ASM Aerospace Specification Metals; yield strength 828 MPa, ASTM B348.",
    },
    MaterialPreset {
        name: "aluminium 6061",
        young_modulus: 68.9 * GPA,
        young_modulus_range: [68.0 * GPA, 70.0 * GPA],
        shear: Shear::PoissonRatio(0.33),
        density: 2700.0,
        yield_strain: Some(0.004),
        source: "6061-T6: data sheet of ASM Aerospace Specification Metals; yield strength 276 MPa.",
    },
    MaterialPreset {
        name: "carbon fibre rod",
        young_modulus: 130.0 * GPA,
        young_modulus_range: [110.0 * GPA, 150.0 * GPA],
        shear: Shear::Modulus(4.5 * GPA),
        density: 1500.0,
        yield_strain: Some(0.01),
        source: "Pultruded, fibres of standard modulus, 60 % by volume: data sheet of Goodwinds (134 GPa in tension, 127 GPa in bending, 1.5 g/cm³). Typical shear modulus of unidirectional laminates: 4 to 7 GPa. It breaks and does not yield: below 1 % in compression.",
    },
    MaterialPreset {
        name: "glass fibre rod",
        young_modulus: 40.0 * GPA,
        young_modulus_range: [35.0 * GPA, 45.0 * GPA],
        shear: Shear::Modulus(4.2 * GPA),
        density: 2000.0,
        yield_strain: Some(0.012),
        source: "Pultruded E-glass, 75 % by weight: data sheet of Goodwinds (41 GPa in tension and bending, 2.0 g/cm³; 483 MPa in compression). Typical shear modulus of unidirectional laminates: 3.5 to 4.5 GPa. It breaks and does not yield.",
    },
    MaterialPreset {
        name: "PEEK",
        young_modulus: 3.8 * GPA,
        young_modulus_range: [3.5 * GPA, 4.2 * GPA],
        shear: Shear::PoissonRatio(0.38),
        density: 1300.0,
        yield_strain: Some(0.025),
        source: "Unfilled: data sheets of Victrex 450G (3.7 to 4.0 GPa, 98 MPa at yield, 1.30 g/cm³).",
    },
    MaterialPreset {
        name: "POM",
        young_modulus: 3.0 * GPA,
        young_modulus_range: [2.6 * GPA, 3.2 * GPA],
        shear: Shear::PoissonRatio(0.36),
        density: 1420.0,
        yield_strain: Some(0.022),
        source: "Acetal: data sheets of Delrin 500P (3.1 GPa, 70 MPa at yield, 1.42 g/cm³); copolymers are softer.",
    },
    MaterialPreset {
        name: "PTFE",
        young_modulus: 500.0 * MPA,
        young_modulus_range: [340.0 * MPA, 750.0 * MPA],
        shear: Shear::PoissonRatio(0.46),
        density: 2160.0,
        yield_strain: Some(0.02),
        source: "Unfilled: Teflon PTFE Properties Handbook (bending modulus 340 to 620 MPa, Poisson's ratio 0.46, 2.13 to 2.19 g/cm³); typical values in tension are up to 750 MPa. It creeps under lasting loads.",
    },
    MaterialPreset {
        name: "polyimide",
        young_modulus: 2.5 * GPA,
        young_modulus_range: [2.5 * GPA, 3.5 * GPA],
        shear: Shear::PoissonRatio(0.34),
        density: 1420.0,
        yield_strain: Some(0.03),
        source: "Kapton HN film, data sheet of DuPont (yield point at 3 %); extruded and wound tubes are stiffer.",
    },
    MaterialPreset {
        name: "PA12",
        young_modulus: 1.65 * GPA,
        young_modulus_range: [1.3 * GPA, 1.9 * GPA],
        shear: Shear::PoissonRatio(0.39),
        density: 930.0,
        yield_strain: Some(0.025),
        source: "Laser-sintered nylon 12: data sheet of EOS PA 2200 (1.65 GPa, 48 MPa, 0.93 g/cm³); typical values of other machines are 1.3 to 1.9 GPa.",
    },
    MaterialPreset {
        name: "PLA",
        young_modulus: 3.3 * GPA,
        young_modulus_range: [2.3 * GPA, 3.7 * GPA],
        shear: Shear::PoissonRatio(0.35),
        density: 1240.0,
        yield_strain: Some(0.015),
        source: "Printed solid, along the layers: typical values of filaments (50 to 60 MPa, 1.24 g/cm³).",
    },
    MaterialPreset {
        name: "ABS",
        young_modulus: 2.1 * GPA,
        young_modulus_range: [1.6 * GPA, 2.6 * GPA],
        shear: Shear::PoissonRatio(0.37),
        density: 1050.0,
        yield_strain: Some(0.018),
        source: "Typical values of filaments (1.6 to 2.1 GPa along the layers, 35 to 40 MPa) and of moulding grades (up to 2.6 GPa).",
    },
    MaterialPreset {
        name: "TPU 95A",
        young_modulus: 26.0 * MPA,
        young_modulus_range: [24.0 * MPA, 70.0 * MPA],
        shear: Shear::PoissonRatio(0.48),
        density: 1220.0,
        yield_strain: None,
        source: "Data sheet of NinjaTek Cheetah (26 MPa, 1.22 g/cm³); typical values of others of the same hardness are up to 70 MPa. Nonlinear beyond some 10 %.",
    },
    MaterialPreset {
        name: "TPU 85A",
        young_modulus: 12.0 * MPA,
        young_modulus_range: [10.0 * MPA, 25.0 * MPA],
        shear: Shear::PoissonRatio(0.48),
        density: 1190.0,
        yield_strain: None,
        source: "Data sheet of NinjaTek NinjaFlex (12 MPa, 1.19 g/cm³). Nonlinear beyond some 10 %.",
    },
    MaterialPreset {
        name: "Sylgard 184",
        young_modulus: 2.0 * MPA,
        young_modulus_range: [1.3 * MPA, 3.0 * MPA],
        shear: Shear::PoissonRatio(0.495),
        density: 1030.0,
        yield_strain: None,
        source: "PDMS, 10:1, cured at 100 °C; 1.32 MPa cured at 25 °C, 2.97 MPa at 200 °C: Johnston et al., J. Micromech. Microeng. 24 (2014) 035017. Density: data sheet of Dow.",
    },
    MaterialPreset {
        name: "Dragon Skin 30",
        young_modulus: 593.0 * KPA,
        young_modulus_range: [0.55 * MPA, 1.15 * MPA],
        shear: Shear::PoissonRatio(0.495),
        density: 1080.0,
        yield_strain: None,
        source: "Secant modulus at 100 %, 86 psi, and 1.08 g/cm³: technical bulletin of Smooth-On. The upper end follows from the hardness, Shore 30A, by Gent's formula.",
    },
    MaterialPreset {
        name: "Dragon Skin 10",
        young_modulus: 152.0 * KPA,
        young_modulus_range: [0.14 * MPA, 0.42 * MPA],
        shear: Shear::PoissonRatio(0.495),
        density: 1070.0,
        yield_strain: None,
        source: "Secant modulus at 100 %, 22 psi, and 1.07 g/cm³: technical bulletin of Smooth-On. The upper end follows from the hardness, Shore 10A, by Gent's formula.",
    },
    MaterialPreset {
        name: "Ecoflex 00-30",
        young_modulus: 69.0 * KPA,
        young_modulus_range: [50.0 * KPA, 125.0 * KPA],
        shear: Shear::PoissonRatio(0.495),
        density: 1070.0,
        yield_strain: None,
        source: "Secant modulus at 100 %, 10 psi, and 1.07 g/cm³: technical bulletin of Smooth-On; typical values for small strains are 50 to 125 kPa.",
    },
];
