//! Geometry: opaque primitives that are drawn into the volume, as lists that are made once a mesh.
//!
//! In: a [`Dataset`](crate::columns::Dataset), and its exterior faces; triangles of other files ([`TriangleMesh`]). Out: a [`List`] of the
//! boundary surface ([`surface`]), of the edges of the cells ([`edges`]), of the points that cells use ([`points`]), of the triangles
//! ([`triangles`]); in scene units, ready for a buffer of a GPU.
//! What is drawn of the mesh, and how, say [`GeometryOptions`]; a [`Layer`] is a list with its looks, as backends draw it.
//! To add geometry: a function that makes a [`List`], and its line in `render`.

mod edges;
mod layer;
mod points;
mod style;
mod surface;
#[cfg(test)]
mod tests;
mod triangle_mesh;
mod used;

use glam::Vec3;
use rayon::prelude::*;

use crate::columns::Bounds;

pub use edges::edges;
#[cfg(feature = "gpu")]
pub(crate) use layer::AMBIENT;
pub use layer::{Layer, headlight};
pub use points::points;
pub use style::{GeometryOptions, SurfaceFaces};
pub use surface::surface;
pub(crate) use triangle_mesh::triangles_around;
pub use triangle_mesh::{TriangleMesh, triangles};

/// What a list holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Primitive {
    /// Three corners each, counterclockwise seen from outside.
    Triangles,
    /// Two ends each.
    Lines,
    /// One each.
    Points,
}

impl Primitive {
    /// How many corners each has.
    pub fn corners(self) -> usize {
        match self {
            Self::Triangles => 3,
            Self::Lines => 2,
            Self::Points => 1,
        }
    }
}

/// Primitives of one kind, corner by corner: positions in scene units, relative to
/// [`Dataset::origin`](crate::columns::Dataset::origin).
#[derive(Clone, Debug, PartialEq)]
pub struct List {
    primitive: Primitive,
    corners: Vec<[f32; 3]>,
    /// Of each corner, or none.
    looks: Option<Looks>,
    bounds: Bounds,
}

/// How the corners of triangles look, one value for each; or none of a kind.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Looks {
    /// Linear RGB, instead of the layer's.
    pub colors: Vec<[f32; 3]>,
    /// Normals, of any length, instead of that of the triangle.
    pub normals: Vec<[f32; 3]>,
}

impl List {
    /// The primitives that `corners` make; what is left over of the last one is no primitive.
    ///
    /// ```
    /// # use cellfan::geometry::{List, Primitive};
    /// let list = List::new(Primitive::Lines, vec![[0.0; 3], [1.0; 3], [2.0; 3]]);
    /// assert_eq!((list.len(), list.bytes()), (1, 24));
    /// ```
    pub fn new(primitive: Primitive, mut corners: Vec<[f32; 3]>) -> Self {
        corners.truncate(corners.len() / primitive.corners() * primitive.corners());
        let boxes = corners.par_iter().fold(|| Bounds::EMPTY, |bounds, &corner| bounds.include(Vec3::from(corner)));
        let bounds = boxes.reduce(|| Bounds::EMPTY, Bounds::union);
        Self { primitive, corners, looks: None, bounds }
    }

    /// Triangles whose corners have colours, normals or both; lines and points are flat.
    ///
    /// # Panics
    /// Where there are some, and not one for each corner.
    #[must_use]
    pub fn with_looks(self, looks: Looks) -> Self {
        let corners = self.corners.len();
        assert!([&looks.colors, &looks.normals].iter().all(|each| each.is_empty() || each.len() == corners), "looks");
        let has_any = self.primitive == Primitive::Triangles && !(looks.colors.is_empty() && looks.normals.is_empty());
        Self { looks: has_any.then_some(looks), ..self }
    }

    /// What they are.
    pub fn primitive(&self) -> Primitive {
        self.primitive
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.corners.len() / self.primitive.corners()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.corners.is_empty()
    }

    /// All corners.
    pub fn corners(&self) -> &[[f32; 3]] {
        &self.corners
    }

    /// How the corners look, where they have looks of their own.
    pub fn looks(&self) -> Option<&Looks> {
        self.looks.as_ref()
    }

    /// The box around them, in scene units.
    pub fn bounds(&self) -> Bounds {
        self.bounds
    }

    /// Bytes of memory that it takes, on the processor and on a GPU.
    pub fn bytes(&self) -> u64 {
        let looks = self.looks.as_ref().map_or(0, |looks| looks.colors.len() + looks.normals.len());
        ((self.corners.len() + looks) * size_of::<[f32; 3]>()) as u64
    }
}
