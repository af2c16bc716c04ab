//! A thin sheet: a triangle mesh, its shape without strain, and its material.

use std::path::Path;

use crate::Result;
use crate::io::garment::{self, RestSource};
use crate::io::obj;
use crate::material::Material;
use crate::mesh::{RestShape, Topology, Vec3};
use crate::rest::RestMetric;
use crate::strain::{FaceStrain, compression_percent, strain};

/// A thin sheet. It never changes; a pose (`[V]` positions, m) lies beside it.
#[derive(Clone, Debug, PartialEq)]
pub struct Sheet {
    /// Connectivity of the V vertices and F faces.
    pub topology: Topology,
    /// The shape without strain; R ≥ V rest vertices.
    pub rest_shape: RestShape,
    /// `[F]` rest metric: that of the rest shape, unless the sheet has grown.
    pub rest: RestMetric,
    /// The material.
    pub material: Material,
}

impl Sheet {
    /// The sheet whose rest shape is the mesh `positions` (`[V]`, m), `faces` (`[F][3]`).
    ///
    /// ```
    /// use plisse::mesh::Vec3;
    /// use plisse::{Material, Sheet};
    ///
    /// let positions = vec![Vec3::zeros(), Vec3::x(), Vec3::y(), Vec3::new(1.0, 1.0, 0.0)];
    /// let faces = vec![[0, 1, 2], [2, 1, 3]];
    /// let sheet = Sheet::from_rest(positions, faces, Material::new(1e6, 0.3, 1e-3)?)?;
    /// assert_eq!((sheet.topology.edge_count(), sheet.rest.area_m2()), (5, 1.0));
    /// # Ok::<(), plisse::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Mesh`](crate::Error::Mesh) for what [`Topology::new`] refuses and for a face
    /// without area.
    pub fn from_rest(
        positions: Vec<Vec3>,
        faces: Vec<[usize; 3]>,
        material: Material,
    ) -> Result<Self> {
        let topology = Topology::new(positions.len(), faces.clone())?;
        Self::with_topology(topology, RestShape { positions, faces }, material)
    }

    /// The sheet with the vertices that `faces` (`[F][3]`) name, and a rest shape with vertices of
    /// its own: panels, which along a seam have two where the sheet has one.
    ///
    /// ```
    /// use plisse::mesh::Vec3;
    /// use plisse::{Material, RestShape, Sheet};
    ///
    /// // Two triangles of one square metre's half each, 1 m apart, sewn along their long sides.
    /// let positions = vec![
    ///     Vec3::zeros(),
    ///     Vec3::x(),
    ///     Vec3::y(),
    ///     Vec3::new(3.0, 1.0, 0.0),
    ///     Vec3::new(2.0, 1.0, 0.0),
    ///     Vec3::new(3.0, 0.0, 0.0),
    /// ];
    /// let rest_shape = RestShape { positions, faces: vec![[0, 1, 2], [3, 4, 5]] };
    /// let faces = vec![[0, 1, 2], [3, 2, 1]];
    /// let sheet = Sheet::sewn(faces, rest_shape, Material::new(1e6, 0.3, 1e-3)?)?;
    /// assert_eq!((sheet.topology.vertex_count, sheet.topology.edge_count()), (4, 5));
    /// # Ok::<(), plisse::Error>(())
    /// ```
    ///
    /// # Errors
    /// As [`Sheet::from_rest`].
    pub fn sewn(faces: Vec<[usize; 3]>, rest_shape: RestShape, material: Material) -> Result<Self> {
        let vertex_count = faces.iter().flatten().max().map_or(0, |&last| last + 1);
        Self::with_topology(Topology::new(vertex_count, faces)?, rest_shape, material)
    }

    /// The sheet of a checked mesh.
    ///
    /// # Errors
    /// [`Error::Mesh`](crate::Error::Mesh) if the rest shape has another number of faces or one
    /// without area.
    pub fn with_topology(
        topology: Topology,
        rest_shape: RestShape,
        material: Material,
    ) -> Result<Self> {
        if rest_shape.faces.len() != topology.face_count() {
            let message = format!(
                "the rest shape has {} faces, but the sheet has {}; give one for each",
                rest_shape.faces.len(),
                topology.face_count()
            );
            return Err(crate::Error::mesh("rest shape", message));
        }
        let rest = RestMetric::from_shape(&rest_shape.positions, &rest_shape.faces)?;
        Ok(Self { topology, rest_shape, rest, material })
    }

    /// The sheet whose rest shape is the mesh in the OBJ file `rest`.
    ///
    /// # Errors
    /// Those of [`obj::read`] and [`Sheet::from_rest`].
    pub fn read(rest: &Path, material: Material) -> Result<Self> {
        let mesh = obj::read(rest)?;
        Self::from_rest(mesh.positions, mesh.faces, material)
    }

    /// The sheet in the OBJ file `pose`, with its rest shape, and its `[V]` positions (m) there.
    ///
    /// # Errors
    /// Those of [`garment::read`].
    pub fn read_posed(
        pose: &Path,
        rest: RestSource<'_>,
        material: Material,
    ) -> Result<(Self, Vec<Vec3>)> {
        let garment = garment::read(pose, rest, 1.0)?;
        Ok((
            Self::with_topology(garment.topology, garment.rest_shape, material)?,
            garment.positions,
        ))
    }

    /// The same sheet with the rest metric `rest`, as after growth.
    pub fn grown(self, rest: RestMetric) -> Self {
        Self { rest, ..self }
    }

    /// `[V]` largest compression (%) of `pose` (`[V]`, m) in the faces around each vertex.
    pub fn compression_percent(&self, pose: &[Vec3]) -> Vec<f64> {
        compression_percent(&self.topology, &self.rest, pose)
    }

    /// `[F]` strain of `pose` (`[V]`, m).
    pub fn strain(&self, pose: &[Vec3]) -> Vec<FaceStrain> {
        strain(&self.topology, &self.rest, pose)
    }
}
