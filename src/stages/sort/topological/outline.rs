//! The triangles of faces as they lie in the picture.

use std::ops::Range;

use arrayvec::ArrayVec;
use glam::{DVec3, Vec3};

use super::exterior::SQUARE;
use super::graph::Sides;
use super::triangle::Triangle;
use crate::columns::Dataset;
use crate::stages::footprints::{PixelBox, PixelBoxes};
use crate::stages::sort::Toward;
use crate::stages::sort::adjacency::Face;
use crate::stages::sort::faces::triangles;
use crate::stages::sort::side::side_of_eye;
use crate::stages::{SceneVertex, View};

/// A triangle of a face of a cell.
#[derive(Clone, Copy, Debug)]
pub(super) struct Outline {
    pub(super) cell: u32,
    /// Its vertices, counterclockwise seen from outside the cell.
    corners: [u32; 3],
    pub(super) pixels: PixelBox,
    /// Inverse depths where it is farthest and nearest.
    pub(super) v_range: [f32; 2],
    /// Rays leave the cell here; else they enter it.
    pub(super) is_exit: bool,
}

impl Outline {
    /// The bands of rows that it touches.
    pub(super) fn bands(&self) -> Range<usize> {
        self.pixels.y0 as usize / SQUARE..(self.pixels.y1 as usize).div_ceil(SQUARE)
    }
}

/// What faces are seen with.
#[derive(Clone, Copy)]
pub(super) struct Seen<'a> {
    pub(super) dataset: &'a Dataset,
    pub(super) sides_from_cell: &'a [Sides],
    pub(super) vertices: &'a [SceneVertex],
    pub(super) view: &'a View,
}

impl Seen<'_> {
    /// The outlines of the triangles of a face that are not edge-on and may be met.
    pub(super) fn outlines(&self, boxes: &PixelBoxes, face: Face) -> ArrayVec<Outline, 2> {
        let Sides { before, after } = self.sides_from_cell[face.cell as usize];
        if (before | after) >> face.index & 1 == 0 {
            return ArrayVec::new();
        }
        let toward = Toward::new(self.view);
        let outline = |corners: [u32; 3]| {
            let side = side_of_eye(self.positions(corners).map(Vec3::as_dvec3), toward);
            let (pixels, [nearest, farthest]) = boxes.of_triangle(self.positions(corners).map(|p| p.to_array()))?;
            let v_range = [farthest, nearest].map(|depth| self.view.inverse_depth(depth));
            (side != 0.0).then_some(Outline { cell: face.cell, corners, pixels, v_range, is_exit: side < 0.0 })
        };
        triangles(self.dataset, face.cell as usize, face.index as usize).into_iter().filter_map(outline).collect()
    }

    /// The triangle as rays meet it.
    pub(super) fn triangle(&self, outline: &Outline) -> Triangle {
        let corners: [DVec3; 3] = self.positions(outline.corners).map(|p| p.as_dvec3() - self.view.eye);
        // The normal points outwards, and rays leave along with it.
        Triangle::new(self.view, corners, outline.is_exit)
    }

    /// The inverse depth of the near plane, up to which a ray meets something.
    pub(super) fn v_near(&self) -> f64 {
        f64::from(self.view.inverse_depth(self.view.near))
    }

    fn positions(&self, corners: [u32; 3]) -> [Vec3; 3] {
        corners.map(|v| Vec3::from_array(self.vertices[v as usize].position))
    }
}
