//! Structures and enumerations of the header. Enumerations come in as numbers, since C lets any number be one.

use std::ffi::c_void;

use super::guard::{Failure, argument};
use crate::optics::Model;
use crate::stages::sort::SortMethod;

/// The type of the values of a slice.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CellfanType {
    /// int8_t
    I8 = 1,
    /// uint8_t
    U8 = 2,
    /// int16_t
    I16 = 3,
    /// uint16_t
    U16 = 4,
    /// int32_t
    I32 = 5,
    /// uint32_t
    U32 = 6,
    /// int64_t
    I64 = 7,
    /// uint64_t
    U64 = 8,
    /// float
    F32 = 9,
    /// double
    F64 = 10,
}

/// What scalars belong to.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CellfanAssociation {
    /// One a point.
    Points = 0,
    /// One a cell.
    Cells = 1,
}

/// What a pixel holds.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CellfanModel {
    /// Light and opacity, premultiplied.
    EmissionAbsorption = 0,
    /// Transmitted intensity of four bands; a miss is 1.
    Absorption = 1,
    /// Light alone.
    Emission = 2,
    /// The colour of the largest value.
    Mip = 3,
}

/// How cells are put in order.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CellfanSort {
    /// The cheapest that is exact.
    Auto = 0,
    /// The order of the cells in memory.
    None = 1,
    /// Distance of the centroid.
    Centroid = 2,
    /// Power distance to the circumsphere.
    Power = 3,
    /// By the graph of shared faces.
    Topological = 4,
    /// Every fragment checked.
    Exact = 5,
}

/// `len` values of `type` from `data` on; no values where `data` is null and `len` 0.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct CellfanSlice {
    /// The first value; aligned for its type.
    pub data: *const c_void,
    /// How many values.
    pub len: usize,
    /// A CellfanType.
    pub r#type: u32,
}

/// A mesh. Clear it (`CellfanMesh mesh = {0};`), then set what it has.
///
/// Structured where `dims` are set: as many points along i, j and k, i fastest, and no connectivity. Of several kinds where `types`
/// are set, as VTK's unstructured grids. Of one kind otherwise.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct CellfanMesh {
    /// x, y, z of one point after the other, float or double; where `y` and `z` are set, x alone.
    pub positions: CellfanSlice,
    /// y of all points, of the type of `positions`.
    pub y: CellfanSlice,
    /// z of all points.
    pub z: CellfanSlice,
    /// The points of one cell after the other, from 0, in VTK's order: uint32_t, int32_t, uint64_t or int64_t.
    pub connectivity: CellfanSlice,
    /// Where all cells are of one kind, VTK's code of it: 10 tetrahedra, 11 voxels, 12 hexahedra, 13 wedges, 14 pyramids.
    pub kind: u32,
    /// VTK's code of each cell, uint8_t.
    pub types: CellfanSlice,
    /// With `types`: where in `connectivity` each cell begins, and the end; one more than there are cells, of a type of `connectivity`.
    pub offsets: CellfanSlice,
    /// Points along i, j and k; 0 where the mesh is not structured.
    pub dims: [usize; 3],
    /// What is drawn, of any type; none draws the mesh homogeneous.
    pub scalars: CellfanSlice,
    /// A CellfanAssociation: what the scalars belong to.
    pub association: u32,
}

/// A camera in world coordinates; pixel (x, y) runs right and down.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CellfanCamera {
    /// Where the eye is.
    pub eye: [f64; 3],
    /// The point in the middle of the picture.
    pub target: [f64; 3],
    /// Up in the picture.
    pub up: [f64; 3],
    /// Vertical field of view in degrees; 0 for parallel rays.
    pub fov_degrees: f64,
    /// What the picture's height covers with parallel rays, in world units.
    pub height_world: f64,
    /// In pixels.
    pub width: u32,
    /// In pixels.
    pub height: u32,
    /// Nothing nearer than this view depth is drawn; 0 for the default, a millionth of the mesh's diagonal.
    pub near: f64,
    /// Nothing farther than this is drawn; 0 for no limit.
    pub far: f64,
}

/// A point of a transfer function, which is linear between points; values ascend.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CellfanControlPoint {
    /// The scalar.
    pub value: f64,
    /// Linear red, green, blue.
    pub color: [f64; 3],
    /// Extinction per world unit length.
    pub extinction: f64,
}

/// What to draw. All 0 is the default.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CellfanOptions {
    /// A CellfanModel.
    pub model: u32,
    /// A CellfanSort.
    pub sort: u32,
    /// What the session and a picture may hold in bytes, arrays of the caller's aside; 0 for any amount.
    pub memory_bytes: u64,
}

/// What a picture took.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CellfanStats {
    /// Cells that were drawn.
    pub drawn: u64,
    /// Cells without extinction.
    pub culled_transparent: u64,
    /// Cells outside of the picture.
    pub culled_outside: u64,
    /// Cells with a value that is not finite.
    pub invalid: u64,
    /// Cells without volume.
    pub degenerate: u64,
    /// 1 where the order of cells is exact in every pixel.
    pub is_exact: u32,
    /// Wall time in milliseconds.
    pub frame_ms: f64,
}

/// Called with the share of a picture that is done, from 0 to 1, and `user`: by one thread at a time, which need not be the one that
/// draws. It may call cellfan_session_cancel(); it must return, and throw nothing.
pub type CellfanProgress = Option<extern "C" fn(share: f64, user: *mut c_void)>;

/// The member of an enumeration that `number` stands for.
macro_rules! one_of {
    ($name:ident, $number:expr, $what:expr, $($variant:ident => $value:expr),*) => {
        match $number {
            $(n if n == $name::$variant as u32 => Ok($value),)*
            n => Err(argument(format!("{}: {n} is no {}", $what, stringify!($name)))),
        }
    };
}
pub(super) use one_of;

pub(super) fn model(number: u32) -> Result<Model, Failure> {
    one_of!(CellfanModel, number, "model", EmissionAbsorption => Model::EmissionAbsorption, Absorption => Model::Absorption,
        Emission => Model::Emission, Mip => Model::Mip)
}

pub(super) fn sort(number: u32) -> Result<SortMethod, Failure> {
    one_of!(CellfanSort, number, "sort", Auto => SortMethod::Auto, None => SortMethod::None, Centroid => SortMethod::Centroid,
        Power => SortMethod::Power, Topological => SortMethod::Topological, Exact => SortMethod::Exact)
}
