//! The subject of a document: a model with its welded vertices, built in or read from a file,
//! perhaps the start of a scene.

use std::path::PathBuf;
use std::sync::Arc;

use plisse::scene::{BuiltScene, Scene, build, build_growth, parse};
use plisse::{Error, Result};
use plisse_live::model::{Model, Vertices};
use plisse_live::weld::{WeldedMesh, fill_normals, vertex_normals};
use plisse_live::{Vec2, Vec3, models, wavelength};

/// Distance under which vertices are welded, as a share of the model's size.
const TOLERANCE: f32 = 1e-5;

/// The origin of a subject.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Source {
    /// A built-in model, one of [`models::NAMES`].
    Own(String),
    /// A file.
    File(PathBuf),
}

impl Source {
    /// Name without folders and extension.
    pub fn stem(&self) -> String {
        match self {
            Self::Own(name) => name.clone(),
            Self::File(path) => path
                .file_stem()
                .map_or_else(|| "model".into(), |s| s.to_string_lossy().into_owned()),
        }
    }
}

/// A scene, with its text.
#[derive(Clone, Debug)]
pub struct SceneText {
    /// The file's text, with the edits.
    pub text: String,
    /// The scene in it.
    pub scene: Scene,
    /// The built scene, ready for the solvers.
    pub built: Arc<BuiltScene>,
}

/// A model that is worked on. It never changes.
#[derive(Clone, Debug)]
pub struct Subject {
    /// Its origin.
    pub source: Source,
    /// The model as it is drawn.
    pub model: Model,
    /// The mesh that is simulated and painted.
    pub welded: WeldedMesh,
    /// The scene that it came from, if any.
    pub scene: Option<SceneText>,
    /// The reader's notes on what it ignored or repaired, one sentence each.
    pub notes: Vec<String>,
    /// Diagonal of the rest pose's bounding box (m).
    pub(crate) size_m: f32,
}

impl Subject {
    /// The built-in model `name`.
    ///
    /// # Errors
    /// [`Error::Value`] for a name that is none of [`models::NAMES`].
    pub fn own(name: &str) -> Result<Self> {
        let model = models::by_name(name)?.ok_or_else(|| {
            let known = models::NAMES.join(", ");
            Error::value(
                "model",
                format!("there is no model called \"{name}\"; give one of {known}"),
            )
        })?;
        Ok(Self::new(Source::Own(name.to_owned()), model))
    }

    /// The subject of a model.
    pub fn new(source: Source, mut model: Model) -> Self {
        let welded = WeldedMesh::new(&model, TOLERANCE);
        fill_normals(&mut model, &welded);
        let size_m = diagonal_m(&welded);
        Self { source, notes: model.notes.clone(), model, welded, scene: None, size_m }
    }

    /// The start of the scene in `text`, which came from `path`.
    ///
    /// # Errors
    /// As [`parse`] and [`build()`].
    pub fn scene(path: PathBuf, text: String) -> Result<Self> {
        let scene = parse(&path, &text)?;
        let built = ready(&scene)?;
        let notes = built.notes.clone();
        let (model, welded) = start_of(&built);
        let scene = SceneText { text, scene, built: Arc::new(built) };
        let size_m = diagonal_m(&welded);
        Ok(Self { source: Source::File(path), model, welded, scene: Some(scene), notes, size_m })
    }

    /// `[U]` wavelengths (m) that the model's vertex colours ask for, or one for all.
    pub fn own_wavelength_m(&self, wavelength_m: f32) -> Vec<f32> {
        wavelength::per_vertex(&self.welded, wavelength_m, self.model.wavelength_share.as_deref())
    }

    /// Size of the rest pose (m): the diagonal of its bounding box.
    pub fn size_m(&self) -> f32 {
        self.size_m
    }
}

fn diagonal_m(welded: &WeldedMesh) -> f32 {
    let [low, high] = bounds(&welded.vertices.positions);
    (high - low).norm().max(1e-6)
}

/// The built scene; one that only grows needs no clamps.
///
/// # Errors
/// As [`build()`].
pub fn ready(scene: &Scene) -> Result<BuiltScene> {
    build(scene).or_else(|error| match &scene.growth {
        Some(_) => build_growth(scene).map(|grown| grown.built),
        None => Err(error),
    })
}

/// Lowest and highest corner of the finite `positions`; zeros if there are none.
pub fn bounds(positions: &[Vec3]) -> [Vec3; 2] {
    let finite = || positions.iter().filter(|p| p.iter().all(|x| x.is_finite()));
    let low = finite().fold(Vec3::repeat(f32::INFINITY), |a, p| a.inf(p));
    let high = finite().fold(Vec3::repeat(f32::NEG_INFINITY), |a, p| a.sup(p));
    if low.x <= high.x { [low, high] } else { [Vec3::zeros(); 2] }
}

/// A position of a scene (z up) in the window's axes (y up).
pub fn shown(p: &plisse::mesh::Vec3) -> Vec3 {
    Vec3::new(p.x as f32, p.z as f32, -p.y as f32)
}

/// The inverse of [`shown`].
pub fn unshown(p: &Vec3) -> plisse::mesh::Vec3 {
    plisse::mesh::Vec3::new(f64::from(p.x), -f64::from(p.z), f64::from(p.y))
}

/// The start of a scene as a model, with the scene's own vertices: panels that touch are not
/// welded.
fn start_of(built: &BuiltScene) -> (Model, WeldedMesh) {
    let positions: Vec<Vec3> = built.start.iter().map(shown).collect();
    let faces: Vec<[u32; 3]> =
        built.sheet.topology.faces.iter().map(|f| f.map(|v| v as u32)).collect();
    let mut model = Model::rigid(
        &built.title,
        positions.clone(),
        vec![Vec2::zeros(); positions.len()],
        faces.clone(),
    );
    model.draw.normals = vertex_normals(&positions, &faces);
    let welded = one_to_one(&model);
    (model, welded)
}

/// The welded mesh of a model whose vertices are not welded.
pub fn one_to_one(model: &Model) -> WeldedMesh {
    let count = model.draw.positions.len();
    let mut pairs: Vec<[u32; 2]> = Vec::with_capacity(6 * model.faces.len());
    for face in &model.faces {
        for k in 0..3 {
            let (i, j) = (face[k], face[(k + 1) % 3]);
            pairs.extend([[i, j], [j, i]]);
        }
    }
    pairs.sort_unstable();
    pairs.dedup();
    let mut starts = vec![0u32; count + 1];
    pairs.iter().for_each(|pair| starts[pair[0] as usize + 1] += 1);
    (0..count).for_each(|v| starts[v + 1] += starts[v]);
    WeldedMesh {
        vertices: Vertices { ..model.draw.clone() },
        vertex_of_draw: (0..count as u32).collect(),
        faces: model.faces.clone(),
        starts,
        neighbours: pairs.iter().map(|p| p[1]).collect(),
    }
}
