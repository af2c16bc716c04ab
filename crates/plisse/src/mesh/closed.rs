//! Closed surfaces to start from: the sphere and the torus, cut into nearly equal triangles, with a
//! plane chart of each.
//!
//! A chart is what a flat panel's own coordinates are to it: lengths (m) along and across. It is
//! cut where it would meet itself, so its points are more than the vertices; at a sphere's poles it
//! is torn.

use std::collections::BTreeMap;
use std::f64::consts::{PI, TAU};

use super::panel::MAX_VERTICES;
use super::{Vec2, Vec3};
use crate::{Error, Result};

/// A closed surface around the origin. V vertices, F faces, C ≥ V points of its chart.
#[derive(Clone, Debug, PartialEq)]
pub struct Closed {
    /// `[V]` vertices (m).
    pub positions: Vec<Vec3>,
    /// `[F][3]` vertices of each face, counter-clockwise seen from outside.
    pub faces: Vec<[usize; 3]>,
    /// `[C]` points of the chart (m): x around the z axis from the x axis on, y from there on up
    /// (sphere: from the equator; torus: from its outermost circle over the top).
    pub chart: Vec<Vec2>,
    /// `[F][3]` points of each face, corner by corner.
    pub chart_faces: Vec<[usize; 3]>,
}

/// The sphere of `radius_m` (m): an icosahedron, standing on a vertex, whose sides are cut into as
/// many parts as make edges about `edge_length_m` (m) long, blown up.
///
/// # Errors
/// [`Error::Value`] naming the field for: a size that is not a positive number, edges longer than
/// the radius, more than 2 million vertices.
pub fn sphere(radius_m: f64, edge_length_m: f64) -> Result<Closed> {
    check(&[("radius_m", radius_m), ("edge_length_m", edge_length_m)])?;
    no_longer(edge_length_m, radius_m)?;
    // Mean length over the side of the icosahedron in parts, for many parts: √(4π/20·4/√3).
    let parts = ((PI / 5.0 * 4.0 / 3f64.sqrt()).sqrt() * radius_m / edge_length_m).round().max(1.0);
    few_enough(10.0 * parts * parts + 2.0)?;
    let parts = parts as usize;
    let (corners, sides) = icosahedron();
    // A point is known by the corners it lies between and its parts from each.
    let mut number: BTreeMap<[(usize, usize); 3], usize> = BTreeMap::new();
    let (mut positions, mut faces) = (Vec::new(), Vec::new());
    for side in &sides {
        let mut point = |i: usize, j: usize| {
            let mut key = [(side[0], parts - i - j), (side[1], i), (side[2], j)]
                .map(|(c, n)| if n == 0 { (usize::MAX, 0) } else { (c, n) });
            key.sort_unstable();
            *number.entry(key).or_insert_with(|| {
                let between: Vec3 =
                    key.iter().filter(|k| k.1 > 0).map(|&(c, n)| corners[c] * n as f64).sum();
                positions.push(between.normalize() * radius_m);
                positions.len() - 1
            })
        };
        for j in 0..parts {
            for i in 0..parts - j {
                faces.push([point(i, j), point(i + 1, j), point(i, j + 1)]);
                if i + j + 1 < parts {
                    faces.push([point(i + 1, j), point(i + 1, j + 1), point(i, j + 1)]);
                }
            }
        }
    }
    let place_of = |p: &Vec3| {
        let off = p.xy().norm();
        let around = (off > 1e-9 * radius_m).then(|| p.y.atan2(p.x) * radius_m);
        (around, p.z.atan2(off) * radius_m)
    };
    let (chart, chart_faces) =
        unrolled(&positions, &faces, place_of, [TAU * radius_m, f64::INFINITY]);
    Ok(Closed { positions, faces, chart, chart_faces })
}

/// The torus around the z axis whose tube of `tube_radius_m` (m) has its middle on the circle of
/// `radius_m` (m): rows along the large circle, every other one shifted by half an edge, so that
/// triangles are nearly equilateral midway, with edges about `edge_length_m` (m) long there; they
/// are longer outside and shorter inside.
///
/// # Errors
/// [`Error::Value`] naming the field for: a size that is not a positive number, a tube as thick as
/// the circle is wide, edges longer than the tube's radius, more than 2 million vertices.
pub fn torus(radius_m: f64, tube_radius_m: f64, edge_length_m: f64) -> Result<Closed> {
    check(&[
        ("radius_m", radius_m),
        ("tube_radius_m", tube_radius_m),
        ("edge_length_m", edge_length_m),
    ])?;
    if tube_radius_m >= radius_m {
        let message = format!(
            "a tube of {tube_radius_m} m closes the hole of a torus of {radius_m} m; give less \
             than radius_m"
        );
        return Err(Error::value("tube_radius_m", message));
    }
    no_longer(edge_length_m, tube_radius_m)?;
    let columns = (TAU * radius_m / edge_length_m).round().max(3.0);
    // An even number of rows, √3/2 edges apart.
    let rows = 2.0 * (TAU * tube_radius_m / (3f64.sqrt() * edge_length_m)).round().max(2.0);
    few_enough(columns * rows)?;
    let (m, n) = (columns as usize, rows as usize);
    let mut positions = Vec::with_capacity(m * n);
    for j in 0..n {
        for i in 0..m {
            let (sine, cosine) = (TAU * (i as f64 + 0.5 * (j % 2) as f64) / columns).sin_cos();
            let (up, out) = (TAU * j as f64 / rows).sin_cos();
            let off = radius_m + tube_radius_m * out;
            positions.push(Vec3::new(off * cosine, off * sine, tube_radius_m * up));
        }
    }
    let at = |i: usize, j: usize| (j % n) * m + i % m;
    let mut faces = Vec::with_capacity(2 * m * n);
    for j in 0..n {
        for i in 0..m {
            // The quad leans towards where the next row lies.
            faces.extend(if j % 2 == 0 {
                [
                    [at(i, j), at(i + 1, j), at(i, j + 1)],
                    [at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)],
                ]
            } else {
                [
                    [at(i, j), at(i + 1, j), at(i + 1, j + 1)],
                    [at(i, j), at(i + 1, j + 1), at(i, j + 1)],
                ]
            });
        }
    }
    let place_of = |p: &Vec3| {
        (Some(p.y.atan2(p.x) * radius_m), p.z.atan2(p.xy().norm() - radius_m) * tube_radius_m)
    };
    let (chart, chart_faces) =
        unrolled(&positions, &faces, place_of, [TAU * radius_m, TAU * tube_radius_m]);
    Ok(Closed { positions, faces, chart, chart_faces })
}

fn check(sizes: &[(&str, f64)]) -> Result<()> {
    match sizes.iter().find(|(_, size)| !(size.is_finite() && *size > 0.0)) {
        Some((name, size)) => Err(Error::value(
            *name,
            format!("{size} is no length; give a positive number of metres"),
        )),
        None => Ok(()),
    }
}

fn no_longer(edge_length_m: f64, radius_m: f64) -> Result<()> {
    if edge_length_m <= radius_m {
        return Ok(());
    }
    let message = format!(
        "edges of {edge_length_m} m cannot go around a radius of {radius_m} m; give at most the \
         radius"
    );
    Err(Error::value("edge_length_m", message))
}

fn few_enough(vertices: f64) -> Result<()> {
    if vertices <= MAX_VERTICES {
        return Ok(());
    }
    let message = "this makes more than 2 million vertices; ask for a longer edge length";
    Err(Error::value("edge_length_m", message))
}

/// Corners (unit vectors), the first and the last on the z axis, and outward faces.
fn icosahedron() -> ([Vec3; 12], Vec<[usize; 3]>) {
    let (height, off) = (1.0 / 5f64.sqrt(), 2.0 / 5f64.sqrt());
    let corners = std::array::from_fn(|c| match c {
        0 => Vec3::z(),
        11 => -Vec3::z(),
        _ => {
            let (ring, k) = ((c - 1) / 5, (c - 1) % 5);
            let (sine, cosine) = (TAU * (k as f64 + 0.5 * ring as f64) / 5.0).sin_cos();
            Vec3::new(off * cosine, off * sine, if ring == 0 { height } else { -height })
        }
    });
    let (high, low) = (|k: usize| 1 + k % 5, |k: usize| 6 + k % 5);
    let around = |k: usize| {
        [
            [0, high(k), high(k + 1)],
            [high(k), low(k), high(k + 1)],
            [high(k + 1), low(k), low(k + 1)],
            [11, low(k + 1), low(k)],
        ]
    };
    (corners, (0..5).flat_map(around).collect())
}

/// Chart of a surface whose vertex `p` lies at `place_of(p)` (m), where both coordinates begin
/// again after `periods` (m). A vertex without its first coordinate lies, in each face, in the
/// middle of the others.
fn unrolled(
    positions: &[Vec3],
    faces: &[[usize; 3]],
    place_of: impl Fn(&Vec3) -> (Option<f64>, f64),
    periods: [f64; 2],
) -> (Vec<Vec2>, Vec<[usize; 3]>) {
    let places: Vec<(Option<f64>, f64)> = positions.iter().map(place_of).collect();
    // Turns by which `x` must be moved to come nearest to `to`.
    let turns = |x: f64, to: f64, period: f64| {
        if period.is_finite() { ((to - x) / period).round() } else { 0.0 }
    };
    let mut number: BTreeMap<(usize, [i64; 2], usize), usize> = BTreeMap::new();
    let mut chart = Vec::new();
    let mut corner = |key: (usize, [i64; 2], usize), p: Vec2| {
        *number.entry(key).or_insert_with(|| {
            chart.push(p);
            chart.len() - 1
        })
    };
    let mut chart_faces = Vec::with_capacity(faces.len());
    for (f, face) in faces.iter().enumerate() {
        let known: Vec<f64> = face.iter().filter_map(|&v| places[v].0).collect();
        let first = [known.first().copied().unwrap_or(0.0), places[face[0]].1];
        let near = |x: f64, axis: usize| match turns(x, first[axis], periods[axis]) {
            0.0 => x,
            turn => x + turn * periods[axis],
        };
        let middle = known.iter().map(|&x| near(x, 0)).sum::<f64>() / known.len().max(1) as f64;
        let whole =
            face.map(|v| [places[v].0.map_or(middle, |x| near(x, 0)), near(places[v].1, 1)]);
        // The face as a whole, its middle between 0 and one period.
        let shift: [f64; 2] = std::array::from_fn(|axis| {
            let centre = whole.iter().map(|p| p[axis]).sum::<f64>() / 3.0;
            if periods[axis].is_finite() {
                -(centre / periods[axis]).floor() * periods[axis]
            } else {
                0.0
            }
        });
        chart_faces.push([0, 1, 2].map(|k| {
            let p = Vec2::new(whole[k][0] + shift[0], whole[k][1] + shift[1]);
            let (v, around) = (face[k], places[face[k]].0);
            let turn = |x: f64, to: f64, period: f64| turns(x, to, period) as i64;
            let key =
                [turn(around.unwrap_or(p.x), p.x, periods[0]), turn(places[v].1, p.y, periods[1])];
            corner((v, key, if around.is_none() { f + 1 } else { 0 }), p)
        }));
    }
    (chart, chart_faces)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::At;
    use crate::mesh::Topology;

    /// Vertices − edges + faces, after checking that the mesh is closed and the volume inside is
    /// about `volume_m3`.
    fn euler(closed: &Closed, volume_m3: f64, edge_m: f64) -> i64 {
        let topology = Topology::new(closed.positions.len(), closed.faces.clone()).unwrap();
        assert!((0..topology.edge_count()).all(|e| !topology.is_boundary_edge(e)));
        let volume: f64 = closed
            .faces
            .iter()
            .map(|f| f.map(|v| closed.positions[v]))
            .map(|[a, b, c]| a.dot(&b.cross(&c)) / 6.0)
            .sum();
        assert!((volume / volume_m3 - 1.0).abs() < 0.1, "{volume} {volume_m3}");
        for &[i, j] in &topology.edges {
            let length = (closed.positions[i] - closed.positions[j]).norm();
            assert!(length < 2.0 * edge_m && length > 0.5 * edge_m, "{length} {edge_m}");
        }
        topology.vertex_count as i64 - topology.edge_count() as i64 + topology.face_count() as i64
    }

    /// Every face of the chart is turned as it should be, and areas add up to `area_m2`.
    fn check_chart(closed: &Closed, area_m2: f64) {
        assert_eq!(closed.chart_faces.len(), closed.faces.len());
        let area = |f: &[usize; 3]| {
            let [a, b, c] = f.map(|p| closed.chart[p]);
            0.5 * (b - a).perp(&(c - a))
        };
        assert!(closed.chart_faces.iter().all(|f| area(f) > 0.0));
        let whole: f64 = closed.chart_faces.iter().map(area).sum();
        assert!((whole / area_m2 - 1.0).abs() < 0.05, "{whole} {area_m2}");
        // Points stand for one vertex each.
        let mut vertex = vec![usize::MAX; closed.chart.len()];
        for (face, points) in closed.faces.iter().zip(&closed.chart_faces) {
            for k in 0..3 {
                assert!(vertex[points[k]] == usize::MAX || vertex[points[k]] == face[k]);
                vertex[points[k]] = face[k];
            }
        }
        assert!(vertex.iter().all(|&v| v != usize::MAX));
    }

    #[test]
    fn spheres_are_closed_round_and_as_fine_as_asked() {
        for (radius, edge) in [(1.0, 0.9), (1.0, 0.3), (2.0, 0.11), (0.05, 0.01)] {
            let ball = sphere(radius, edge).unwrap();
            let inside = if edge > 0.5 * radius { 0.605 } else { 0.97 } * 4.0 / 3.0
                * PI
                * f64::powi(radius, 3);
            assert_eq!(euler(&ball, inside, edge), 2, "{radius} {edge}");
            assert!(ball.positions.iter().all(|p| (p.norm() / radius - 1.0).abs() < 1e-12));
            if edge < 0.5 * radius {
                // Torn poles leave gaps.
                check_chart(&ball, TAU * radius * (PI * radius - 0.8 * edge));
            }
        }
    }

    #[test]
    fn tori_are_closed_and_as_fine_as_asked() {
        for (radius, tube, edge) in
            [(1.0, 0.3, 0.1), (1.0, 0.4, 0.15), (2.0, 0.1, 0.1), (0.5, 0.2, 0.07)]
        {
            let ring = torus(radius, tube, edge).unwrap();
            let inside =
                2.0 * PI * PI * radius * tube * tube * if edge < tube { 0.95 } else { 0.9 };
            assert_eq!(euler(&ring, inside, edge), 0);
            for p in &ring.positions {
                assert!(
                    (((p.xy().norm() - radius).powi(2) + p.z * p.z).sqrt() / tube - 1.0).abs()
                        < 1e-9
                );
            }
            check_chart(&ring, TAU * radius * TAU * tube);
            assert!(ring.chart.iter().all(|p| p.x > -edge
                && p.x < TAU * radius + edge
                && p.y > -edge
                && p.y < TAU * tube + edge));
        }
    }

    #[test]
    fn sizes_that_are_none_are_named() {
        let says = |closed: Result<Closed>| closed.at("p").unwrap_err().to_string();
        assert!(says(sphere(0.0, 0.1)).starts_with("p.radius_m: 0 is no length"));
        assert!(
            says(sphere(1.0, 2.0)).starts_with("p.edge_length_m: edges of 2 m cannot go around")
        );
        assert!(says(sphere(1.0, 1e-4)).contains("2 million"));
        assert!(
            says(torus(1.0, 1.0, 0.1))
                .starts_with("p.tube_radius_m: a tube of 1 m closes the hole")
        );
        assert!(says(torus(1.0, 0.5, 1e-4)).contains("2 million"));
        assert!(says(torus(1.0, f64::NAN, 0.1)).starts_with("p.tube_radius_m: NaN"));
    }
}
