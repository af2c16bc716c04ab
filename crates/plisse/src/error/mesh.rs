//! Faults of meshes. Vertices, edges, faces and panels are counted from 0.

/// A fault of a mesh: of its connectivity, of its geometry, or of the way its panels are sewn.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MeshError {
    /// There is no face.
    #[error("the mesh has no faces; give a triangle mesh")]
    NoFaces,
    /// A face names a vertex that there is not.
    #[error(
        "face {face} names vertex {vertex}, but there are only {vertex_count} vertices; correct \
         the index"
    )]
    IndexOutOfRange {
        /// The face.
        face: usize,
        /// The vertex that it names.
        vertex: usize,
        /// Number of vertices.
        vertex_count: usize,
    },
    /// A face names a vertex twice.
    #[error("face {face} names vertex {vertex} twice; remove the face")]
    RepeatedVertex {
        /// The face.
        face: usize,
        /// The vertex.
        vertex: usize,
    },
    /// A vertex belongs to no face.
    #[error("vertex {vertex} belongs to no face; remove the isolated vertex")]
    IsolatedVertex {
        /// The vertex.
        vertex: usize,
    },
    /// More than two faces share an edge.
    #[error(
        "edge {}-{} is shared by {} faces (among them {} and {}); split the mesh there so that at \
         most two meet",
        edge[0], edge[1], faces.len(), faces[0], faces[1]
    )]
    NonManifoldEdge {
        /// The edge's vertices, lower first.
        edge: [usize; 2],
        /// All faces on it, ascending; at least three.
        faces: Vec<usize>,
    },
    /// Two faces run along their common edge in the same direction.
    #[error(
        "faces {} and {} disagree about which side is outside (edge {}-{}); flip one of them",
        faces[0], faces[1], edge[0], edge[1]
    )]
    InconsistentOrientation {
        /// The two faces, lower first.
        faces: [usize; 2],
        /// The edge's vertices, lower first.
        edge: [usize; 2],
    },
    /// A vertex has a coordinate that is infinite or not a number.
    #[error(
        "vertex {vertex} is at ({}, {}, {}), which is no point; export the mesh again",
        position[0], position[1], position[2]
    )]
    NotFinite {
        /// The vertex.
        vertex: usize,
        /// Its position.
        position: [f64; 3],
    },
    /// A rest face has no area.
    #[error("face {face} has no area at rest; remove the face or move its corners apart")]
    NoRestArea {
        /// The face.
        face: usize,
    },
    /// A face of a rest shape that was read is flat to within rounding.
    #[error(
        "face {face} (vertices {}, {}, {}) has no area in the rest shape; move its vertices apart \
         or remove the face",
        vertices[0], vertices[1], vertices[2]
    )]
    DegenerateRestFace {
        /// The face.
        face: usize,
        /// Its vertices.
        vertices: [usize; 3],
    },
    /// Faces of a flat panel face the other way than most of its faces.
    #[error(
        "face {}{} is flipped against its panel; reverse its vertex order in both files",
        faces[0], more(faces)
    )]
    FlippedRestFaces {
        /// The faces, ascending; at least one.
        faces: Vec<usize>,
    },
    /// The faces around a vertex have no area, or cancel.
    #[error(
        "the faces around vertex {vertex} of the starting surface have no common normal; move it \
         apart"
    )]
    NoNormal {
        /// The vertex.
        vertex: usize,
    },
    /// A seam names a panel that there is not.
    #[error(
        "{} names a panel that does not exist; there are {panel_count}, counted from 0",
        seam_between(*seam, panels)
    )]
    UnknownPanel {
        /// The seam.
        seam: usize,
        /// The panels that it names.
        panels: [usize; 2],
        /// Number of panels.
        panel_count: usize,
    },
    /// Two vertices of a seam do not follow each other on their panel's boundary.
    #[error(
        "{}: vertices {} and {} of panel {panel} do not follow each other on its boundary; sew \
         along sides only",
        seam_between(*seam, panels), vertices[0], vertices[1]
    )]
    SeamOffBoundary {
        /// The seam.
        seam: usize,
        /// The panels that it joins.
        panels: [usize; 2],
        /// The panel on which it is at fault.
        panel: usize,
        /// The two vertices.
        vertices: [usize; 2],
    },
    /// The two sides of a seam differ in their number of vertices or in length.
    #[error(
        "{} joins {} vertices over {:.6} m to {} vertices over {:.6} m; make both sides equally \
         long (within 1 %) and use one edge length for both panels",
        seam_between(*seam, panels),
        vertex_counts[0], lengths_m[0], vertex_counts[1], lengths_m[1]
    )]
    UnequalSeam {
        /// The seam.
        seam: usize,
        /// The panels that it joins.
        panels: [usize; 2],
        /// Number of vertices on each side.
        vertex_counts: [usize; 2],
        /// Length of each side (m).
        lengths_m: [f64; 2],
    },
    /// Panels are sewn to a surface with only one side.
    #[error(
        "the seams {} make a surface with only one side, like a Möbius strip; reverse a chain of \
         one of them",
        if panels[0] == panels[1] {
            format!("of panel {} with itself", panels[0])
        } else {
            format!("between panels {} and {}", panels[0], panels[1])
        }
    )]
    OneSided {
        /// The two panels, which may be the same.
        panels: [usize; 2],
    },
    /// A rest shape has another number of triangles than the posed mesh.
    #[error(
        "it has {rest_faces} triangles, but {pose} has {pose_faces}; export both from the same \
         mesh, with the same faces in the same order"
    )]
    FaceCountsDiffer {
        /// Number of triangles at rest.
        rest_faces: usize,
        /// The file of the posed mesh.
        pose: String,
        /// Its number of triangles.
        pose_faces: usize,
    },
    /// Faces start inside an obstacle, from where nothing can push them out.
    #[error(
        "faces {} are {depth_m:.3e} m inside obstacle \"{obstacle}\" at vertex {vertex}, {}; move \
         the surface or the obstacle so that they do not meet",
        listed(faces),
        if *held { "held there by a clamp" } else { "too deep inside to be pushed out" }
    )]
    InsideObstacle {
        /// The faces around the vertex.
        faces: Vec<usize>,
        /// The vertex.
        vertex: usize,
        /// Name of the obstacle.
        obstacle: String,
        /// Depth of the vertex inside it (m).
        depth_m: f64,
        /// True if a clamp holds the vertex there.
        held: bool,
    },
    /// A clamp takes a vertex through an obstacle.
    #[error(
        "a clamp takes vertex {vertex} of faces {} through obstacle \"{obstacle}\"; start from a \
         pose on the clamp's side of it",
        listed(faces)
    )]
    ClampThroughObstacle {
        /// The faces around the vertex.
        faces: Vec<usize>,
        /// The vertex.
        vertex: usize,
        /// Name of the obstacle.
        obstacle: String,
    },
    /// The mesh of an obstacle is not that of a solid body.
    #[error("{problem}")]
    Obstacle {
        /// The fault.
        problem: ObstacleError,
    },
    /// Any other fault, as a sentence.
    #[error("{message}")]
    Other {
        /// The fault and its fix.
        message: String,
    },
}

/// A fault of an obstacle's mesh, which must be closed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ObstacleError {
    /// No face has an area.
    #[error("the obstacle has no faces with an area; give a closed triangle mesh")]
    NoFaces,
    /// A vertex is beyond all lengths of this world.
    #[error("vertex {vertex} is farther than 1e6 m from the origin; is the mesh in metres?")]
    TooFar {
        /// The vertex.
        vertex: usize,
    },
    /// More than two faces share an edge.
    #[error(
        "edge {}-{} of the obstacle is shared by {} faces (among them {} and {}); split the mesh \
         there so that two meet",
        edge[0], edge[1], faces.len(), faces[0], faces[1]
    )]
    NonManifoldEdge {
        /// The edge's vertices, lower first.
        edge: [usize; 2],
        /// All faces on it, ascending; at least three.
        faces: Vec<usize>,
    },
    /// Edges have a face on one side only.
    #[error(
        "the obstacle has holes: {} between vertices {} and {}; close the mesh",
        if *count == 1 { "1 open edge,".to_owned() } else { format!("{count} open edges, first") },
        edge[0], edge[1]
    )]
    Holes {
        /// The first open edge's vertices, lower first.
        edge: [usize; 2],
        /// Number of open edges.
        count: usize,
    },
    /// Two faces run along their common edge in the same direction.
    #[error(
        "faces {} and {} of the obstacle disagree about which side is outside (edge {}-{}); flip \
         one of them",
        faces[0], faces[1], edge[0], edge[1]
    )]
    InconsistentOrientation {
        /// The two faces, lower first.
        faces: [usize; 2],
        /// The edge's vertices, lower first.
        edge: [usize; 2],
    },
    /// The mesh is closed, but flat.
    #[error("the obstacle encloses no volume; give a mesh around a solid body")]
    NoVolume,
}

impl From<ObstacleError> for MeshError {
    fn from(problem: ObstacleError) -> Self {
        Self::Obstacle { problem }
    }
}

/// The name of a seam in a sentence.
fn seam_between(seam: usize, panels: &[usize; 2]) -> String {
    format!("seam {seam} (panel {} to panel {})", panels[0], panels[1])
}

/// The number of faces beside the first, in brackets, if there are any.
fn more(faces: &[usize]) -> String {
    match faces.len() {
        0 | 1 => String::new(),
        n => format!(" (and {} more)", n - 1),
    }
}

/// The first six faces, with an ellipsis if there are more.
fn listed(faces: &[usize]) -> String {
    let shown: Vec<String> = faces.iter().take(6).map(ToString::to_string).collect();
    let more = if faces.len() > shown.len() { ", …" } else { "" };
    format!("{}{more}", shown.join(", "))
}
