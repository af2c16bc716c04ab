//! Preparation of meshes that were read: checks of the geometry that name the vertex or face at
//! fault, and the weld of vertices that a file keeps twice along its seams.

use super::Vec3;
use super::topology::faces_around;
use crate::Result;
use crate::error::MeshError;

/// Area of the flattest rest triangle allowed, relative to the square of its longest edge.
const LEAST_RELATIVE_AREA: f64 = 1e-10;
/// A rest shape is flat if its extent along z is at most this part of its size.
const FLATNESS: f64 = 1e-9;

/// Checks that all coordinates are finite.
///
/// # Errors
/// [`MeshError::NotFinite`] naming the first vertex with a coordinate that is infinite or not a
/// number.
pub fn check_finite(positions: &[Vec3]) -> Result<()> {
    match positions.iter().position(|p| !p.iter().all(|x| x.is_finite())) {
        None => Ok(()),
        Some(vertex) => {
            Err(MeshError::NotFinite { vertex, position: positions[vertex].into() }.into())
        }
    }
}

/// Checks that rest triangles can have a metric: `positions` (m) are the rest vertices, `faces`
/// (`[F][3]`) must name existing ones.
///
/// In a flat rest shape (constant z), all faces of a panel, that is of a piece connected through
/// shared rest edges, must face one way. Pieces without any boundary, such as a pillow pressed
/// flat, face both ways and are exempt.
///
/// # Errors
/// [`MeshError::DegenerateRestFace`] for a face whose area is zero (below 1e-10 of its longest edge
/// squared), [`MeshError::FlippedRestFaces`] for those flipped against the majority of their panel.
pub fn check_rest_faces(positions: &[Vec3], faces: &[[usize; 3]]) -> Result<()> {
    for (face, &vertices) in faces.iter().enumerate() {
        let [a, b, c] = vertices.map(|v| positions[v]);
        let longest_squared =
            (b - a).norm_squared().max((c - b).norm_squared()).max((a - c).norm_squared());
        let area = 0.5 * (b - a).cross(&(c - a)).norm();
        if area.is_nan() || area <= LEAST_RELATIVE_AREA * longest_squared {
            return Err(MeshError::DegenerateRestFace { face, vertices }.into());
        }
    }
    if is_flat(positions) { check_panel_orientation(positions, faces) } else { Ok(()) }
}

/// A mesh without double vertices along its seams.
#[derive(Clone, Debug, PartialEq)]
pub struct Welded {
    /// `[V]` vertices (m), numbered by the lowest input vertex in each, without gaps.
    pub positions: Vec<Vec3>,
    /// `[F][3]` vertices of each face, in the order of the input.
    pub faces: Vec<[usize; 3]>,
    /// `[input V]` welded vertex for each input vertex.
    pub vertex_of_input: Vec<usize>,
}

/// Merges vertices at exactly the same position (bit for bit, save that -0 is 0) if they lie on
/// boundary edges, as files with texture coordinates keep them along seams. Two corners of one face
/// are never merged, and inner vertices never: faces that a pose has crushed to nothing stay.
/// Without anything to merge, the mesh comes back as it was.
///
/// # Panics
/// If a face names a vertex that does not exist.
pub fn weld(positions: &[Vec3], faces: &[[usize; 3]]) -> Welded {
    let mut at_place: Vec<([u64; 3], usize)> = boundary_vertices(positions.len(), faces)
        .into_iter()
        .map(|v| ([positions[v].x, positions[v].y, positions[v].z].map(|x| (x + 0.0).to_bits()), v))
        .collect();
    at_place.sort_unstable();

    let around = faces_around(positions.len(), faces);
    // Lowest input vertex of the cluster that each vertex was merged into.
    let mut lowest: Vec<usize> = (0..positions.len()).collect();
    for group in at_place.chunk_by(|a, b| a.0 == b.0) {
        let mut clusters: Vec<usize> = Vec::new();
        for &(_, v) in group {
            let shares_face = |cluster: usize| {
                around[v].iter().any(|&f| faces[f].iter().any(|&u| u != v && lowest[u] == cluster))
            };
            match clusters.iter().find(|&&cluster| !shares_face(cluster)) {
                Some(&cluster) => lowest[v] = cluster,
                None => clusters.push(v),
            }
        }
    }
    let mut welded = Welded {
        positions: Vec::new(),
        faces: Vec::new(),
        vertex_of_input: vec![0; positions.len()],
    };
    for v in 0..positions.len() {
        if lowest[v] == v {
            welded.vertex_of_input[v] = welded.positions.len();
            welded.positions.push(positions[v]);
        } else {
            welded.vertex_of_input[v] = welded.vertex_of_input[lowest[v]];
        }
    }
    welded.faces = faces.iter().map(|face| face.map(|v| welded.vertex_of_input[v])).collect();
    welded
}

/// Every side of every face as (edge with the lower vertex first, face), sorted: equal edges are
/// neighbours.
fn sorted_sides(faces: &[[usize; 3]]) -> Vec<([usize; 2], usize)> {
    let mut sides = Vec::with_capacity(3 * faces.len());
    for (f, face) in faces.iter().enumerate() {
        for k in 0..3 {
            let (i, j) = (face[k], face[(k + 1) % 3]);
            sides.push(([i.min(j), i.max(j)], f));
        }
    }
    sides.sort_unstable();
    sides
}

/// Ends of the edges that only one face has, ascending.
fn boundary_vertices(vertex_count: usize, faces: &[[usize; 3]]) -> Vec<usize> {
    let mut on_boundary = vec![false; vertex_count];
    for same in sorted_sides(faces).chunk_by(|a, b| a.0 == b.0).filter(|same| same.len() == 1) {
        on_boundary[same[0].0[0]] = true;
        on_boundary[same[0].0[1]] = true;
    }
    (0..vertex_count).filter(|&v| on_boundary[v]).collect()
}

fn is_flat(positions: &[Vec3]) -> bool {
    let Some(&first) = positions.first() else { return false };
    let (lower, upper) = positions.iter().fold((first, first), |(l, u), p| (l.inf(p), u.sup(p)));
    let extent = upper - lower;
    extent.z <= FLATNESS * extent.x.max(extent.y)
}

fn check_panel_orientation(positions: &[Vec3], faces: &[[usize; 3]]) -> Result<()> {
    let sides = sorted_sides(faces);
    // Lowest face of the panel of each face.
    let mut root: Vec<usize> = (0..faces.len()).collect();
    let find = |root: &mut [usize], mut f: usize| {
        while root[f] != f {
            root[f] = root[root[f]];
            f = root[f];
        }
        f
    };
    for same in sides.chunk_by(|a, b| a.0 == b.0) {
        for other in &same[1..] {
            let (f, g) = (find(&mut root, same[0].1), find(&mut root, other.1));
            root[f.max(g)] = f.min(g);
        }
    }
    let panel: Vec<usize> = (0..faces.len()).map(|f| find(&mut root, f)).collect();
    let mut has_boundary = vec![false; faces.len()];
    for same in sides.chunk_by(|a, b| a.0 == b.0).filter(|same| same.len() == 1) {
        has_boundary[panel[same[0].1]] = true;
    }
    let upwards = |f: usize| {
        let [a, b, c] = faces[f].map(|v| positions[v].xy());
        (b - a).perp(&(c - a)) > 0.0
    };
    // Faces up minus faces down; at a tie, the panel's lowest face decides.
    let mut balance = vec![0i64; faces.len()];
    for f in 0..faces.len() {
        balance[panel[f]] += if upwards(f) { 1 } else { -1 };
    }
    let is_flipped = |f: usize| {
        let p = panel[f];
        has_boundary[p] && upwards(f) != if balance[p] == 0 { upwards(p) } else { balance[p] > 0 }
    };
    let faces: Vec<usize> = (0..faces.len()).filter(|&f| is_flipped(f)).collect();
    if faces.is_empty() { Ok(()) } else { Err(MeshError::FlippedRestFaces { faces }.into()) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::At;

    fn points(p: &[[f64; 3]]) -> Vec<Vec3> {
        p.iter().map(|&p| Vec3::from(p)).collect()
    }

    /// A row of `n` unit squares, two counter-clockwise faces each; vertices 2k and 2k+1 at x = k.
    fn strip(n: usize) -> (Vec<Vec3>, Vec<[usize; 3]>) {
        let positions =
            (0..=n).flat_map(|k| [0.0, 1.0].map(|y| Vec3::new(k as f64, y, 0.0))).collect();
        let faces = (0..n)
            .flat_map(|k| [[2 * k, 2 * k + 2, 2 * k + 1], [2 * k + 1, 2 * k + 2, 2 * k + 3]])
            .collect();
        (positions, faces)
    }

    #[test]
    fn points_that_are_none_are_named() {
        let (mut positions, _) = strip(2);
        assert!(check_finite(&positions).is_ok());
        for bad in [f64::NAN, f64::INFINITY] {
            positions[3].y = bad;
            assert!(
                check_finite(&positions)
                    .at("m.obj")
                    .unwrap_err()
                    .to_string()
                    .starts_with("m.obj: vertex 3 is at")
            );
        }
    }

    #[test]
    fn triangles_without_area_are_named_at_any_scale() {
        let (positions, mut faces) = strip(3);
        for scale in [1e-12, 1.0, 1e12] {
            let scaled: Vec<Vec3> = positions.iter().map(|p| p * scale).collect();
            assert!(check_rest_faces(&scaled, &faces).is_ok());
        }
        faces.push([0, 2, 4]);
        assert!(
            check_rest_faces(&positions, &faces)
                .unwrap_err()
                .to_string()
                .contains("face 6 (vertices 0, 2, 4)")
        );
        let dot = points(&[[1.0, 1.0, 1.0]; 3]);
        assert!(check_rest_faces(&dot, &[[0, 1, 2]]).is_err());
        let thin = |height| points(&[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.5, 0.0, height]]);
        assert!(check_rest_faces(&thin(1e-9), &[[0, 1, 2]]).is_ok());
        assert!(check_rest_faces(&thin(1e-10), &[[0, 1, 2]]).is_err());
    }

    #[test]
    fn flipped_faces_are_those_against_their_own_panel() {
        let (positions, mut faces) = strip(4);
        let flip = |faces: &mut Vec<[usize; 3]>, f: usize| faces[f].swap(1, 2);
        flip(&mut faces, 3);
        let message = check_rest_faces(&positions, &faces).at("m").unwrap_err().to_string();
        assert_eq!(
            message,
            "m: face 3 is flipped against its panel; reverse its vertex order in both files"
        );
        flip(&mut faces, 5);
        assert!(
            check_rest_faces(&positions, &faces)
                .unwrap_err()
                .to_string()
                .contains("face 3 (and 1 more)")
        );
        // A whole panel may face down, if it shares no edge with those that face up.
        let (positions, mut faces) = strip(2);
        let count = positions.len();
        for f in 0..4 {
            faces.push([faces[f][0] + count, faces[f][2] + count, faces[f][1] + count]);
        }
        let both: Vec<Vec3> = positions
            .iter()
            .copied()
            .chain(positions.iter().map(|p| p + Vec3::new(9.0, 0.0, 0.0)))
            .collect();
        assert!(check_rest_faces(&both, &faces).is_ok());
        flip(&mut faces, 6);
        assert!(
            check_rest_faces(&both, &faces).unwrap_err().to_string().contains("face 6 is flipped")
        );
        // Without a plane there is no up.
        let mut bent = both;
        bent[0].z = 0.1;
        assert!(check_rest_faces(&bent, &faces).is_ok());
    }

    #[test]
    fn a_flat_pillow_may_face_both_ways() {
        let (positions, mut faces) = strip(1);
        // A back with its own diagonal.
        faces.extend([[0, 1, 3], [0, 3, 2]]);
        assert!(check_rest_faces(&positions, &faces).is_ok());
        faces.pop();
        assert!(check_rest_faces(&positions, &faces).is_err());
    }

    #[test]
    fn a_mesh_cut_into_pieces_is_welded_back() {
        let (positions, faces) = strip(5);
        // Faces 0..6 keep their vertices, the others get their own copies.
        let mut cut = positions.clone();
        let mut copy_of = vec![usize::MAX; positions.len()];
        let cut_faces: Vec<[usize; 3]> = faces
            .iter()
            .enumerate()
            .map(|(f, face)| {
                face.map(|v| {
                    if f < 6 {
                        return v;
                    }
                    if copy_of[v] == usize::MAX {
                        copy_of[v] = cut.len();
                        cut.push(positions[v]);
                    }
                    copy_of[v]
                })
            })
            .collect();
        // Vertices that no face uses any more stay as they are: they are on no boundary edge.
        let welded = weld(&cut, &cut_faces);
        assert_eq!(welded.positions.len(), cut.len() - 2);
        assert_eq!(welded.faces[..6], faces[..6]);
        assert_eq!(welded.faces[6][0], faces[6][0]);
        for (face, before) in welded.faces.iter().zip(&faces) {
            assert_eq!(face.map(|v| welded.positions[v]), before.map(|v| positions[v]));
        }
        let inner_edges = sorted_sides(&welded.faces)
            .chunk_by(|a, b| a.0 == b.0)
            .filter(|same| same.len() == 2)
            .count();
        assert_eq!(inner_edges, 9);
    }

    #[test]
    fn welding_is_the_identity_where_nothing_is_double() {
        let (mut positions, faces) = strip(4);
        let same = |positions: &[Vec3]| {
            let welded = weld(positions, &faces);
            let identity: Vec<usize> = (0..positions.len()).collect();
            (
                welded.positions == positions,
                welded.faces == faces,
                welded.vertex_of_input == identity,
            )
        };
        assert_eq!(same(&positions), (true, true, true));
        // A collapsed face keeps its corners apart.
        positions[2] = positions[0];
        assert_eq!(same(&positions), (true, true, true));
        // The last bit counts, the sign of zero does not.
        positions[8] = Vec3::new(f64::EPSILON, 0.0, 0.0);
        assert_eq!(same(&positions), (true, true, true));
        positions[8] = Vec3::new(-0.0, 0.0, 0.0);
        assert_eq!(weld(&positions, &faces).vertex_of_input, [0, 1, 2, 3, 4, 5, 6, 7, 0, 8]);
    }

    #[test]
    fn inner_vertices_are_never_welded() {
        // Two fans around inner vertices 0 and 5 at the same point.
        let ring = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]];
        let mut p = vec![[0.0; 3]];
        p.extend(ring);
        p.push([0.0; 3]);
        p.extend(ring.map(|[x, y, _]| [2.0 * x, 2.0 * y, 0.0]));
        let fan =
            |centre: usize| (0..4).map(move |k| [centre, centre + 1 + k, centre + 1 + (k + 1) % 4]);
        let faces: Vec<[usize; 3]> = fan(0).chain(fan(5)).collect();
        assert_eq!(weld(&points(&p), &faces).positions.len(), 10);
        // With one face less around each, both centres are on boundary edges.
        let open: Vec<[usize; 3]> = fan(0).take(3).chain(fan(5).take(3)).collect();
        assert_eq!(weld(&points(&p), &open).positions.len(), 9);
    }
}
