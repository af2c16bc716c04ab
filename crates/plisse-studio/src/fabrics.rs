//! Named fabrics and films, with the source of their constants.

/// A fabric or film.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fabric {
    /// Name in the window.
    pub name: &'static str,
    /// Young's modulus (Pa).
    pub young_pa: f64,
    /// Poisson's ratio.
    pub poisson: f64,
    /// Thickness (m).
    pub thickness_m: f64,
    /// Density (kg/m³).
    pub density_kg_m3: f64,
    /// Source of the constants, and of those that are from elsewhere.
    pub source: &'static str,
}

/// All fabrics and films.
pub const FABRICS: [Fabric; 6] = [
    Fabric {
        name: "Soft cloth, 1 mm",
        young_pa: 1e5,
        poisson: 0.3,
        thickness_m: 1e-3,
        density_kg_m3: 200.0,
        source: "the cloth of the drapes of Chen et al. 2021, section 6.1",
    },
    Fabric {
        name: "Rubbery sheet, 0.1 mm",
        young_pa: 1e6,
        poisson: 0.5,
        thickness_m: 1e-4,
        density_kg_m3: 1100.0,
        source: "the stretched sheet of Chen et al. 2021, section 6.4; the density is that of \
            rubber, about 1100 kg/m³, not from there",
    },
    Fabric {
        name: "Soft plastic, 0.1 mm",
        young_pa: 1e7,
        poisson: 0.44,
        thickness_m: 1e-4,
        density_kg_m3: 920.0,
        source: "the twisted cylinder of Chen et al. 2021, section 6.2; the density is that of \
            polyethylene, about 920 kg/m³, not from there",
    },
    Fabric {
        name: "Polyimide film (as sheared), 25 µm",
        young_pa: 3.5e9,
        poisson: 0.31,
        thickness_m: 25e-6,
        density_kg_m3: 1420.0,
        source: "the sheared rectangle of Wong & Pellegrino 2006, as in scene 03; the density is \
            that of the next",
    },
    Fabric {
        name: "Kapton HN polyimide, 25 µm",
        young_pa: 2.5e9,
        poisson: 0.34,
        thickness_m: 25e-6,
        density_kg_m3: 1420.0,
        source: "DuPont, Kapton HN technical data sheet: tensile modulus 2.5 GPa at 23 °C, \
            Poisson's ratio 0.34, 1.42 g/cm³",
    },
    Fabric {
        name: "Mylar A polyester, 23 µm",
        young_pa: 4.8e9,
        poisson: 0.38,
        thickness_m: 23e-6,
        density_kg_m3: 1390.0,
        source: "DuPont Teijin Films, Mylar Physical-Thermal Properties (H-37232-3): 490 kg/mm² \
            along the machine, 0.38, 1.39 g/cm³",
    },
];
