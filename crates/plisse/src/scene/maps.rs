//! From tables to one number, one direction or one expansion for each vertex.

use std::path::Path;

use super::placed::PlacedSurface;
use super::schema::{
    AxisKind, DirectionTable, ExpansionTable, GrowthTable, MapKind, MapTable, ProcedureTable, Scene,
};
use crate::growth::{DirectionField, Expansion, ProceduralMap};
use crate::mesh::Chart;
use crate::mesh::islands::side_by_side;
use crate::mesh::{Mat2, Vec2, Vec3};
use crate::{Error, Result};

/// The procedure of a checked `table`; `None` for an image, for panels and for an attribute.
pub(super) fn procedure(table: &ProcedureTable) -> Option<ProceduralMap> {
    let point = |p: Option<[f64; 3]>| Vec3::from(p.unwrap_or_default());
    let (centre, axis, seed) = (point(table.centre_m), point(table.axis), table.seed.unwrap_or(1));
    let length = |x: Option<f64>| x.unwrap_or_default();
    let (radius_m, width_m, soft_m, size_m) =
        (length(table.radius_m), length(table.width_m), length(table.soft_m), length(table.size_m));
    Some(match table.kind {
        MapKind::Ramp => ProceduralMap::Ramp { from: point(table.from_m), to: point(table.to_m) },
        MapKind::Band => {
            ProceduralMap::Band { centre, normal: point(table.normal), width_m, soft_m }
        }
        MapKind::Ring => ProceduralMap::Ring { centre, axis, radius_m, width_m, soft_m },
        MapKind::Radial => ProceduralMap::Radial { centre, axis, radius_m },
        MapKind::Spots => ProceduralMap::Spots {
            centres: table.centres_m.iter().flatten().map(|c| Vec3::from(*c)).collect(),
            radius_m,
        },
        MapKind::Noise => ProceduralMap::Noise { size_m, seed },
        MapKind::Fractal => {
            ProceduralMap::Fractal { size_m, octaves: table.octaves.unwrap_or_default(), seed }
        }
        MapKind::Image | MapKind::Panels | MapKind::Attribute => return None,
    })
}

/// `[V]` values of the map that `place` has.
pub(super) fn map(
    scene: &Scene,
    placed: &PlacedSurface,
    place: &str,
    map: &MapTable,
) -> Result<Vec<f64>> {
    let table = match map {
        MapTable::Number(value) => return Ok(vec![*value; placed.start.len()]),
        MapTable::ProceduralMap(table) => table,
    };
    if let Some(procedure) = procedure(table) {
        return Ok(procedure.map(&placed.start, table.low, table.high));
    }
    let shares = match (&table.file, &table.shares) {
        _ if table.kind == MapKind::Attribute => {
            attribute(placed, &format!("{place}.name"), table.name.as_deref().unwrap_or_default())?
                .to_vec()
        }
        (Some(file), _) => image_shares(placed, place, &scene.beside(file))?,
        (None, shares) => {
            let of_panel = |p: usize| {
                shares.as_ref().and_then(|shares| shares.get(p)).copied().unwrap_or_default()
            };
            let faces = placed
                .panels
                .iter()
                .enumerate()
                .flat_map(|(p, panel)| panel.faces.clone().map(move |f| (f, p)));
            mean_of_corners(
                placed,
                faces.flat_map(|(f, p)| placed.topology.faces[f].map(|v| (v, of_panel(p)))),
            )
        }
    };
    Ok(shares.into_iter().map(|share| table.low + (table.high - table.low) * share).collect())
}

/// `[V]` what the mesh says about each vertex under this name.
fn attribute<'a>(placed: &'a PlacedSurface, field: &str, name: &str) -> Result<&'a [f64]> {
    if let Some((_, values)) = placed.attributes.iter().find(|(own, _)| own == name) {
        return Ok(values);
    }
    if placed.attributes.is_empty() {
        let message = format!(
            "there is no attribute \"{name}\": vertices have none; start from an OBJ with colours \
             or a PLY file with values"
        );
        return Err(Error::value(field, message));
    }
    let names: Vec<&str> = placed.attributes.iter().map(|(own, _)| own.as_str()).collect();
    Err(Error::value(
        field,
        format!("the mesh has no attribute \"{name}\"; it has {}", names.join(", ")),
    ))
}

/// `[V]` mean of the values given for each vertex; 0 where there is none.
fn mean_of_corners(placed: &PlacedSurface, values: impl Iterator<Item = (usize, f64)>) -> Vec<f64> {
    let mut sums = vec![(0.0, 0.0); placed.start.len()];
    for (v, value) in values {
        sums[v].0 += value;
        sums[v].1 += 1.0;
    }
    sums.into_iter().map(|(sum, count): (f64, f64)| sum / count.max(1.0)).collect()
}

/// `[V]` values (0 to 1) of the first channel of a PNG file, through the texture coordinates; the
/// mean where a seam meets.
fn image_shares(placed: &PlacedSurface, place: &str, path: &Path) -> Result<Vec<f64>> {
    let field = format!("{place}.file");
    let bytes = crate::io::disk::read(path)
        .map_err(|source| Error::value(&field, Error::reading(path, source).to_string()))?;
    let image = Grey::new(&bytes).map_err(|what| {
        Error::value(
            &field,
            format!("{} is no readable PNG ({what}); save it as PNG, grey or RGB", path.display()),
        )
    })?;
    let chart = match &placed.texture {
        Some(chart) => chart.clone(),
        None if !placed.panels.is_empty() => {
            let rest = &placed.rest_shape;
            let flat: Vec<Vec2> = rest.positions.iter().map(|p| p.xy()).collect();
            Chart { points: side_by_side(&flat, &rest.faces), faces: rest.faces.clone() }
        }
        None => {
            let message = "the mesh has no texture coordinates (vt), by which the image would lie \
                on it; export them, or use another kind";
            return Err(Error::value(field, message));
        }
    };
    let each = placed.topology.faces.iter().zip(&chart.faces);
    Ok(mean_of_corners(
        placed,
        each.flat_map(|(face, uv)| (0..3).map(|k| (face[k], image.at(&chart.points[uv[k]])))),
    ))
}

/// First channel of an image, 0 to 1 as the numbers stand in the file.
struct Grey {
    width: usize,
    height: usize,
    values: Vec<f64>,
}

impl Grey {
    fn new(bytes: &[u8]) -> std::result::Result<Self, String> {
        let mut decoder = png::Decoder::new(std::io::Cursor::new(bytes));
        decoder.set_transformations(png::Transformations::EXPAND);
        let mut reader = decoder.read_info().map_err(|e| e.to_string())?;
        let mut data = vec![0; reader.output_buffer_size().ok_or("too large")?];
        let info = reader.next_frame(&mut data).map_err(|e| e.to_string())?;
        let wide = info.bit_depth == png::BitDepth::Sixteen;
        let step = info.color_type.samples() * if wide { 2 } else { 1 };
        let value = |pixel: &[u8]| {
            if wide {
                f64::from(u16::from_be_bytes([pixel[0], pixel[1]])) / 65535.0
            } else {
                f64::from(pixel[0]) / 255.0
            }
        };
        let (width, height) = (info.width as usize, info.height as usize);
        Ok(Self {
            width,
            height,
            values: data.chunks_exact(step).take(width * height).map(value).collect(),
        })
    }

    /// At a texture coordinate (v up), joined linearly between pixel centres, held at the rims.
    fn at(&self, uv: &Vec2) -> f64 {
        let place = |t: f64, count: usize| {
            let x = (t * count as f64 - 0.5).clamp(0.0, (count - 1) as f64);
            let low = x.floor();
            (low as usize, (low as usize + 1).min(count - 1), x - low)
        };
        let ((left, right, s), (top, bottom, t)) =
            (place(uv.x, self.width), place(1.0 - uv.y, self.height));
        let row = |y: usize| {
            self.values[y * self.width + left] * (1.0 - s) + self.values[y * self.width + right] * s
        };
        row(top) * (1.0 - t) + row(bottom) * t
    }
}

/// All expansions of the scene, one after the other.
pub(super) fn expansion(
    scene: &Scene,
    table: &GrowthTable,
    placed: &PlacedSurface,
) -> Result<Expansion> {
    let mut whole = Expansion::none(&placed.topology, &placed.start)?;
    for (i, one) in table.expansion.iter().enumerate() {
        whole = whole.then(&single(scene, placed, &format!("growth.expansion[{i}]"), one)?);
    }
    Ok(whole)
}

fn single(
    scene: &Scene,
    placed: &PlacedSurface,
    place: &str,
    table: &ExpansionTable,
) -> Result<Expansion> {
    let n = placed.start.len();
    let within = match table
        .panel
        .as_ref()
        .and_then(|name| placed.panels.iter().find(|panel| panel.name == *name))
    {
        Some(panel) => {
            let mut within = vec![false; n];
            panel
                .faces
                .clone()
                .flat_map(|f| placed.topology.faces[f])
                .for_each(|v| within[v] = true);
            within
        }
        None => vec![true; n],
    };
    let factors = |name: &str, table: &Option<MapTable>| {
        table
            .as_ref()
            .map_or(Ok(vec![1.0; n]), |table| map(scene, placed, &format!("{place}.{name}"), table))
    };
    let mut factor = factors("factor", &table.factor)?;
    let mut across = factors("across", &table.across)?;
    for v in (0..n).filter(|&v| !within[v]) {
        (factor[v], across[v]) = (1.0, 1.0);
    }
    let (topology, start) = (&placed.topology, &placed.start);
    let Some(direction) = &table.direction else {
        return Expansion::from_factors(topology, start, &factor)
            .map_err(|error| error.about(place));
    };
    let directions = directions(placed, place, direction)?;
    let tensor: Option<Vec<Vec<f64>>> = match &table.tensor {
        Some(maps) => Some(
            maps.iter()
                .map(|own| map(scene, placed, &format!("{place}.tensor"), own))
                .collect::<Result<_>>()?,
        ),
        None => None,
    };
    let form = |v: usize| match &tensor {
        Some(t) if within[v] => Mat2::new(t[0][v], t[1][v], t[1][v], t[2][v]),
        Some(_) => Mat2::identity(),
        // A factor below 0 has a square, too; it must be seen to be wrong.
        None => Mat2::new(factor[v] * factor[v].abs(), 0.0, 0.0, across[v] * across[v].abs()),
    };
    let forms: Vec<Mat2> = (0..n).map(form).collect();
    Expansion::from_tensors(topology, start, &directions, &forms)
        .map_err(|error| error.about(place))
}

/// `[V]` directions, of any length.
fn directions(placed: &PlacedSurface, place: &str, table: &DirectionTable) -> Result<Vec<Vec3>> {
    let course = match table {
        DirectionTable::Fixed(direction) => DirectionField::Fixed(Vec3::from(*direction)),
        DirectionTable::Axis(table) => {
            let (centre, axis) =
                (Vec3::from(table.centre_m), Vec3::from(table.axis.unwrap_or_default()));
            match table.kind {
                AxisKind::Around => DirectionField::Around { centre, axis },
                AxisKind::Outward => DirectionField::Outward { centre, axis },
                AxisKind::Attribute => {
                    let field = format!("{place}.direction.names");
                    let names = table.names.clone().unwrap_or_default();
                    let [x, y, z] = [0, 1, 2].map(|axis| attribute(placed, &field, &names[axis]));
                    let (x, y, z) = (x?, y?, z?);
                    return Ok((0..x.len()).map(|v| Vec3::new(x[v], y[v], z[v])).collect());
                }
            }
        }
    };
    Ok(placed.start.iter().map(|p| course.at(p)).collect())
}
