//! Geometry: opaque primitives that are drawn into the volume, as lists that are made once a mesh.
//!
//! In: a [`Dataset`](crate::columns::Dataset), and its exterior faces. Out: a [`List`] of the boundary surface ([`surface`]), of the
//! edges of the cells ([`edges`]), of the points that cells use ([`points`]); in scene units, ready for a buffer of a GPU.
//! What is drawn of them, and how, say [`GeometryOptions`]; a [`Layer`] is a list with its looks, as backends draw it.
//! To add geometry (that of another file): a function that makes a [`List`], and its line in `render`.

mod edges;
mod layer;
mod points;
mod style;
mod surface;
#[cfg(test)]
mod tests;
mod used;

pub use edges::edges;
#[cfg(feature = "gpu")]
pub(crate) use layer::AMBIENT;
pub use layer::{Layer, headlight};
pub use points::points;
pub use style::{GeometryOptions, SurfaceFaces};
pub use surface::surface;

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
        Self { primitive, corners }
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

    /// Bytes of memory that it takes, on the processor and on a GPU.
    pub fn bytes(&self) -> u64 {
        size_of_val(&self.corners[..]) as u64
    }
}
