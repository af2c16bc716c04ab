//! A scene with `[growth]` made ready for [`crate::growth::grow`].

use super::windows::{self, CountWindow, Extent};
use crate::growth::expansion::GrowthTensor;
use crate::growth::maps::SCALAR_MAPS;
use crate::growth::reference::ReferenceOptions;
use crate::growth::{AdaptOptions, GrowingSurface, GrowthAt, GrowthMaps, GrowthOptions};
use crate::mesh::{Chart, Topology, Vec3};
use crate::remesh::MidpointPlacement;
use crate::rest::RestMetric;
use crate::scene::build::{BuiltScene, assemble, place_surface};
use crate::scene::hold::{self, AXES, Grip};
use crate::scene::maps;
use crate::scene::placed::PlacedSurface;
use crate::scene::schema::{
    BandTable, CountTable, GrowthTable, MapTable, Mode, RemeshTable, Scene,
};
use crate::{At, Error, Result};

/// A scene made ready to grow.
#[derive(Clone, Debug)]
pub struct BuiltGrowth {
    /// The surface, with its rest metric before growth, what pushes and what is in its way.
    pub built: BuiltScene,
    /// `[V]` growth and folding of each vertex. Clamps freeze, too.
    pub maps: GrowthMaps,
    /// Mode: by energy or by forces.
    pub mode: Mode,
    /// Options of the solve by energy.
    pub options: GrowthOptions,
    /// Options of the solve by the paper's forces.
    pub reference: ReferenceOptions,
    /// Steps of growth at least, if the scene says so.
    pub steps: Option<usize>,
    /// True if folds cannot pass through each other.
    pub self_contact: bool,
    /// Remeshing while the surface grows; none: the mesh stays as it is.
    pub adapt: Option<AdaptOptions>,
    /// The scene's windows for counts.
    pub(super) counts: Vec<CountTable>,
    /// `[panels]` extents of their coordinates.
    pub(super) extents: Vec<Extent>,
    /// Panel coordinates (m), if some panel is closed.
    pub(super) chart: Option<Chart>,
    /// The same, on the mesh.
    pub(super) windows: Vec<CountWindow>,
}

impl BuiltGrowth {
    /// The growing surface of this scene.
    pub fn surface(&self) -> GrowingSurface {
        let built = &self.built;
        GrowingSurface {
            topology: built.sheet.topology.clone(),
            rest: built.sheet.rest.clone(),
            start: built.start.clone(),
            places: built.start.clone(),
            maps: self.maps.clone(),
            loads: built.loads.clone(),
            obstacles: built.obstacles.clone().into(),
            contact_thickness_m: built.contact_thickness_m,
            self_contact: self.self_contact,
        }
    }

    /// The parts of the growth, one for each step; `steps` at least, else as many as the scene
    /// says.
    pub fn parts(&self, steps: Option<usize>) -> Vec<f64> {
        let most = self.maps.most_growth();
        let mut options = self.options.clone();
        if let Some(steps) = steps.or(self.steps) {
            options.largest_step = most / steps as f64;
        }
        options.parts(most)
    }
}

/// The scene ready to grow. Clamps freeze what they hold.
///
/// # Errors
/// As [`build`](fn@crate::scene::build), but nothing must be held; [`Error::Value`] if the scene
/// does not grow, has a clamp that moves, pressure, a map whose image cannot be read or lies on
/// nothing, an expansion that is none, folds narrower than the mesh can carry, all frozen.
pub fn build_growth(scene: &Scene) -> Result<BuiltGrowth> {
    let Some(table) = &scene.growth else {
        let message = "the scene does not say how it grows; add [growth]";
        return Err(Error::value("growth", message).at(&scene.file));
    };
    grow_unplaced(scene, table).at(&scene.file)
}

fn grow_unplaced(scene: &Scene, table: &GrowthTable) -> Result<BuiltGrowth> {
    if scene.load.pressure_pa != 0.0 {
        return Err(Error::value(
            "load.pressure_pa",
            "a surface that grows feels no pressure; remove it, or give a bias",
        ));
    }
    if let Some(i) =
        scene.clamp.iter().position(|clamp| clamp.move_m != [0.0; 3] || clamp.turn.is_some())
    {
        return Err(Error::value(
            format!("clamp[{i}]"),
            "growth begins where the surface is placed; let the clamp neither move nor turn",
        ));
    }
    let placed = place_surface(scene)?;
    let maps = growth_maps(scene, table, &placed)?;
    let extents: Vec<Extent> = scene.panel.iter().map(windows::extent).collect();
    let windows = windows::windows(&table.count, &extents, &placed)?;
    let chart = placed.chart.clone();
    let mut options = GrowthOptions {
        young_pa: scene.material.young_pa,
        poisson: scene.material.poisson,
        ..GrowthOptions::default()
    };
    options.seed = table.seed.unwrap_or(options.seed);
    options.plasticity = table.plasticity.unwrap_or(options.plasticity);
    options.imperfection = table.imperfection.unwrap_or(options.imperfection);
    options.iteration_limit = table.iteration_limit.unwrap_or(options.iteration_limit);
    let mut reference = ReferenceOptions { seed: options.seed, ..ReferenceOptions::default() };
    reference.levels = table.steps.unwrap_or(reference.levels);
    reference.iteration_limit = table.iteration_limit.unwrap_or(reference.iteration_limit);
    let rest = RestMetric::from_shape(&placed.rest_shape.positions, &placed.rest_shape.faces)
        .at(&scene.file)?;
    let (clamps, loads) = (hold::clamps(scene, &placed)?, hold::loads(scene, &placed)?);
    let built = assemble(scene, placed, rest, clamps, loads)?;
    let grown = BuiltGrowth {
        adapt: table
            .remesh
            .as_ref()
            .map(|remesh| adapt_options(remesh, &built.sheet.topology, &built.start)),
        built,
        maps,
        mode: table.mode.unwrap_or_default(),
        options,
        reference,
        steps: table.steps,
        self_contact: table.self_contact.unwrap_or(true),
        counts: table.count.clone(),
        extents,
        chart,
        windows,
    };
    let surface = grown.surface();
    match &grown.adapt {
        Some(adapt) => adapt.check(&surface, &grown.options)?,
        None => surface.check()?,
    }
    Ok(grown)
}

/// The options of `table` for a scene that starts with this mesh.
fn adapt_options(table: &RemeshTable, topology: &Topology, start: &[Vec3]) -> AdaptOptions {
    let lengths: f64 = topology.edges.iter().map(|&[i, j]| (start[j] - start[i]).norm()).sum();
    let mut options =
        AdaptOptions::new(table.longest_m.unwrap_or(lengths / topology.edge_count() as f64));
    options.edges_per_wave = table.edges_per_wave.unwrap_or(options.edges_per_wave);
    options.finish_edges_per_wave = table
        .finish_edges_per_wave
        .unwrap_or(options.finish_edges_per_wave.max(options.edges_per_wave));
    options.most_vertices = table.most_vertices.unwrap_or(options.most_vertices);
    options.finish_iterations = table.finish_iterations.unwrap_or(options.finish_iterations);
    if table.round_start == Some(true) {
        options.midpoints = MidpointPlacement::Start;
    }
    options
}

/// The maps of `table` on the mesh of `placed`.
fn growth_maps(scene: &Scene, table: &GrowthTable, placed: &PlacedSurface) -> Result<GrowthMaps> {
    // λ takes the place of this value.
    let at = |growth: &GrowthTensor| GrowthAt::new(*growth, f64::NAN);
    let mut vertices: Vec<GrowthAt> =
        maps::expansion(scene, table, placed)?.vertices.iter().map(at).collect();
    for scalar in &SCALAR_MAPS {
        if let Some(map) = table.scalar_map(scalar.name) {
            let values = maps::map(scene, placed, &format!("growth.{}", scalar.name), map)?;
            vertices.iter_mut().zip(values).for_each(|(at, value)| scalar.set(at, value));
        }
    }
    let frozen = frozen(scene, table, placed)?;
    vertices.iter_mut().zip(frozen).for_each(|(at, frozen)| at.frozen = frozen);
    Ok(GrowthMaps { vertices, bands: bands(scene, table, placed)? })
}

/// `[V]` axes that are frozen, by `[[growth.freeze]]` and by clamps.
fn frozen(scene: &Scene, table: &GrowthTable, placed: &PlacedSurface) -> Result<Vec<[bool; 3]>> {
    let mut frozen: Vec<[bool; 3]> = hold::clamps(scene, placed)?
        .targets
        .iter()
        .map(|target| target.map(|held| held.is_some()))
        .collect();
    for (i, freeze) in table.freeze.iter().enumerate() {
        let place = format!("growth.freeze[{i}]");
        let grip = || Grip::new(&place, freeze.side.as_deref(), freeze.near_m, freeze.within_m);
        for v in chosen(scene, placed, &place, freeze.map.as_ref(), grip)? {
            for (axis, letter) in AXES.into_iter().enumerate() {
                frozen[v][axis] |= freeze.axes.contains(letter);
            }
        }
    }
    Ok(frozen)
}

/// The vertices of every `[[growth.band]]`, ascending.
fn bands(scene: &Scene, table: &GrowthTable, placed: &PlacedSurface) -> Result<Vec<Vec<usize>>> {
    let of_band = |(i, band): (usize, &BandTable)| {
        let place = format!("growth.band[{i}]");
        let grip = || Grip::new(&place, band.side.as_deref(), None, band.within_m);
        let mut vertices = chosen(scene, placed, &place, band.map.as_ref(), grip)?;
        vertices.sort_unstable();
        vertices.dedup();
        Ok(vertices)
    };
    table.band.iter().enumerate().map(of_band).collect()
}

/// The vertices where `map` is above one half, or that the grip holds.
fn chosen<'g>(
    scene: &Scene,
    placed: &PlacedSurface,
    place: &str,
    map: Option<&MapTable>,
    grip: impl Fn() -> Result<Grip<'g>>,
) -> Result<Vec<usize>> {
    match map {
        Some(map) => {
            let values = maps::map(scene, placed, &format!("{place}.map"), map)?;
            Ok((0..values.len()).filter(|&v| values[v] > 0.5).collect())
        }
        None => Ok(grip()?.vertices(scene, placed, place)?.into_iter().map(|(v, _)| v).collect()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{build, parse};

    const SCENE: &str = r#"
        title = "sheet"
        [material]
        young_pa = 1e5
        poisson = 0
        thickness_m = 1e-3
        [[panel]]
        name = "p"
        shape = "rectangle"
        width_m = 1
        height_m = 0.5
        edge_length_m = 0.04
        [[clamp]]
        side = "p.left"
        [growth]
        wavelength_m = 0.25
        freeze = [{ side = "p.right", axes = "xz" }]
        [[growth.expansion]]
        factor = { kind = "ramp", low = 1, high = 2, from_m = [0, 0, 0], to_m = [1, 0, 0] }
        direction = [1, 0, 0]
        [[growth.expansion]]
        panel = "p"
        factor = 1.5
        [[growth.count]]
        name = "c"
        panel = "p"
        low_m = [0.1, 0.1]
        high_m = [0.9, 0.4]
    "#;

    fn message(from: &str, to: &str) -> String {
        assert_eq!(SCENE.matches(from).count(), 1, "{from}");
        parse("s.toml", &SCENE.replace(from, to))
            .and_then(|scene| build_growth(&scene))
            .unwrap_err()
            .to_string()
    }

    #[test]
    fn maps_expansions_and_what_is_frozen_are_read() {
        let scene = parse("s.toml", SCENE).unwrap();
        let grown = build_growth(&scene).unwrap();
        for (v, p) in grown.built.start.iter().enumerate() {
            let [most, least] = grown.maps.vertices[v].growth.principal().0;
            assert!(
                (most - 1.5 * (1.0 + p.x)).abs() < 1e-9 && (least - 1.5).abs() < 1e-9,
                "{p}: {most} {least}"
            );
            assert_eq!(
                grown.maps.vertices[v].frozen,
                if p.x == 0.0 { [true; 3] } else { [p.x == 1.0, false, p.x == 1.0] }
            );
        }
        // The same growth drives the base solve.
        let solved = build(&scene).unwrap();
        let asked = grown.surface().asked().unwrap();
        assert_eq!(solved.sheet.rest, asked);
        assert!(grown.parts(Some(40)).len() >= 40 && *grown.parts(None).last().unwrap() == 1.0);
    }

    #[test]
    fn what_cannot_grow_is_told_in_one_sentence() {
        let ramp = "{ kind = \"ramp\", low = 1, high = 2, from_m = [0, 0, 0], to_m = [1, 0, 0] }";
        for (from, to, says) in [
            (
                "wavelength_m = 0.25",
                "wavelength_m = 0.05",
                "growth.wavelength_m: folds 5.000e-2 m apart need edges of",
            ),
            ("wavelength_m = 0.25", "wavelength_m = -1", "give a positive number of metres"),
            (
                "wavelength_m = 0.25",
                "wavelength_m = { kind = \"image\", file = \"none.png\", low = 1, high = 2 }",
                "none.png: reading failed",
            ),
            (
                "wavelength_m = 0.25",
                "wavelength_m = { kind = \"spots\", low = 1, high = 2 }",
                "needs centres_m, radius_m",
            ),
            ("wavelength_m = 0.25", "wavelength_m = 1\nwind = 3", "there is no field wind here"),
            (
                ramp,
                "{ kind = \"ramp\", low = 1, high = 2, size_m = 3 }",
                "this is missing; the kind \"ramp\" needs from_m, to_m",
            ),
            (
                ramp,
                "{ kind = \"slope\", low = 1, high = 2 }",
                "cannot be \"slope\"; give one of ramp, band",
            ),
            (
                ramp,
                "{ kind = \"noise\", low = 1, high = 2, size_m = 1, steep = 3 }",
                "there is no field steep here",
            ),
            (ramp, "{ kind = \"noise\", low = 1 }", "it must have kind, low, high"),
            (ramp, "\"much\"", "give a number, or a table with a kind"),
            (
                "factor = 1.5",
                "factor = -1.5",
                "growth.expansion[1]: the growth at vertex 0 is -1.5",
            ),
            (
                "factor = 1.5",
                "tensor = [1, 2, 1]\ndirection = [1, 0, 0]",
                "not symmetric and positive definite",
            ),
            (
                "factor = 1.5",
                "factor = 2\ntensor = [1, 2, 1]\ndirection = [1, 0, 0]",
                "remove one of them",
            ),
            ("factor = 1.5", "across = 1.5", "say along which direction"),
            ("direction = [1, 0, 0]", "direction = [0, 0, 1]", "does not lie in the surface"),
            ("direction = [1, 0, 0]", "direction = [0, 0, 0]", "no length"),
            (
                "panel = \"p\"\n        factor",
                "panel = \"q\"\n        factor",
                "there is no panel \"q\"",
            ),
            (
                "freeze = [{ side = \"p.right\", axes = \"xz\" }]",
                "freeze = [{ map = 1 }]",
                "every vertex is frozen",
            ),
            ("axes = \"xz\"", "axes = \"w\"", "growth.freeze[0].axes"),
            (
                "side = \"p.right\", axes = \"xz\"",
                "axes = \"xz\"",
                "does not say where; give one of side, near_m, within_m and map",
            ),
            ("side = \"p.left\"", "side = \"p.left\"\nmove_m = [0, 0, 1]", "neither move nor turn"),
            ("high_m = [0.9, 0.4]", "high_m = [9, 9]", "reaches beyond"),
            ("high_m = [0.9, 0.4]", "radius_m = 1", "or centre_m, radius_m and width_m for a ring"),
            (
                "wavelength_m = 0.25",
                "wavelength_m = 0.25\nplasticity = 2",
                "growth.plasticity: 2 is no share",
            ),
            (
                "wavelength_m = 0.25",
                "wavelength_m = 0.005\nremesh = { most_vertices = 9000 }",
                "need about 1",
            ),
            (
                "wavelength_m = 0.25",
                "wavelength_m = 0.25\nremesh = { edges_per_wave = 2 }",
                "carry no folds",
            ),
            (
                "wavelength_m = 0.25",
                "wavelength_m = 0.25\nremesh = { edges_per_wave = 9, finish_edges_per_wave = 8 }",
                "as many or more",
            ),
            (
                "wavelength_m = 0.25",
                "wavelength_m = 0.25\nremesh = { longest_m = 0 }",
                "growth.remesh.longest_m: 0 is no length",
            ),
            (
                "wavelength_m = 0.25",
                "wavelength_m = 0.25\nplasticity = 0.5\nremesh = {}",
                "give one of them only",
            ),
            (
                "wavelength_m = 0.25",
                "wavelength_m = 0.25\nremesh = { finest = 1 }",
                "there is no field finest here",
            ),
        ] {
            let text = message(from, to);
            assert!(
                text.contains(says) && text.starts_with("s.toml, ") && text.contains("; "),
                "{to}: {text}"
            );
        }
        let none = SCENE.split("[growth]").next().unwrap();
        let text = build_growth(&parse("s.toml", none).unwrap()).unwrap_err().to_string();
        assert!(text.contains("does not say how it grows"), "{text}");
    }
}
