//! A block of boxes in coordinates u, v, w from 0 to 1, bent into any form and cut into cells.

use glam::DVec3;
use rayon::prelude::*;

use super::{CellShape, PhenomenonSettings};
use crate::columns::{Array, Association, CellCounts, CellMesh, NumericColumn, Points};
use crate::error::{Error, Result};
use crate::generate::settings::check_len;

/// Tetrahedra of a box around its main diagonal: one for each order of the axes. Corner c has x = bit 0, y = bit 1, z = bit 2 of c.
const TETRAHEDRA: [[u8; 4]; 6] = [[0, 1, 3, 7], [0, 3, 2, 7], [0, 2, 6, 7], [0, 6, 4, 7], [0, 4, 5, 7], [0, 5, 1, 7]];

/// Wedges of a box, upright, as hexahedra that repeat two corners (see [`hexahedron_of`](crate::cells::hexahedron_of)).
const PRISMS: [[u8; 8]; 2] = [[0, 1, 3, 3, 4, 5, 7, 7], [0, 3, 2, 2, 4, 7, 6, 6]];

/// The box itself, in VTK's order.
const HEXAHEDRON: [u8; 8] = [0, 1, 3, 2, 4, 5, 7, 6];

/// Boxes along u, v and w.
pub(super) struct Block {
    boxes: [usize; 3],
    /// Whether u = 1 is u = 0 again.
    is_ring: bool,
    shape: CellShape,
}

impl Block {
    /// The fewest boxes in the proportion of `parts` that give the cells wanted.
    pub(super) fn new(settings: &PhenomenonSettings, parts: [f64; 3], is_ring: bool) -> Result<Self> {
        let per_box = match settings.shape {
            CellShape::Tetrahedra => 6,
            CellShape::Prisms => 2,
            CellShape::Hexahedra => 1,
        };
        let least = if is_ring { 3 } else { 1 };
        let scaled = |scale: f64| {
            let mut boxes = parts.map(|part| (part * scale).round().max(1.0) as usize);
            boxes[0] = boxes[0].max(least);
            boxes
        };
        let wanted = settings.cells.div_ceil(per_box);
        let count = |boxes: [usize; 3]| boxes.iter().map(|&n| n as u128).product::<u128>();
        let scale = (wanted as f64 / parts.iter().product::<f64>()).cbrt();
        // Rounding may leave too few: grow by less than a box a side at a time.
        let step = 0.25 / parts.iter().fold(0.0_f64, |most, &part| most.max(part));
        let boxes =
            (0..1_000).map(|i| scaled(scale + f64::from(i) * step)).find(|&boxes| count(boxes) >= u128::from(wanted));
        let Some(boxes) = boxes else {
            return Err(Error::TooLarge { column: "cells", len: settings.cells, limit: u64::from(u32::MAX) - 1 });
        };
        check_len("cells", count(boxes) * u128::from(per_box))?;
        check_len("points", boxes.iter().map(|&n| n as u128 + 1).product())?;
        Ok(Self { boxes, is_ring, shape: settings.shape })
    }

    /// The cells, with points and their emission as functions of u, v, w; cells without emission at any corner are left out.
    pub(super) fn mesh(&self, point: impl Fn(DVec3) -> (DVec3, f64) + Sync) -> CellMesh {
        let [nu, nv, nw] = self.boxes;
        let [pu, pv, pw] = self.points();
        let made: Vec<(DVec3, f64)> = (0..pu * pv * pw)
            .into_par_iter()
            .map(|i| {
                let [i, j, k] = [i % pu, i / pu % pv, i / (pu * pv)];
                point(DVec3::new(i as f64 / nu as f64, j as f64 / nv as f64, k as f64 / nw as f64))
            })
            .collect();
        let value: Vec<f32> = made.iter().map(|&(_, value)| value as f32).collect();
        let points = made.into_iter().map(|(p, _)| p.as_vec3().to_array()).collect();

        let glows = |cell: &[u32]| cell.iter().any(|&v| value[v as usize] > 0.0);
        let mean = |cell: &[u32]| cell.iter().map(|&v| value[v as usize]).sum::<f32>() / cell.len() as f32;
        let corners = (0..nu * nv * nw).map(|b| self.corners([b % nu, b / nu % nv, b / (nu * nv)]));
        let (mut tets, mut hexahedra) = (Vec::new(), Vec::new());
        for corners in corners {
            let pick = |c: u8| corners[usize::from(c)];
            match self.shape {
                CellShape::Tetrahedra => tets.extend(TETRAHEDRA.map(|t| t.map(pick)).iter().filter(|t| glows(&t[..]))),
                CellShape::Prisms => hexahedra.extend(PRISMS.map(|p| p.map(pick)).iter().filter(|p| glows(&p[..]))),
                CellShape::Hexahedra => hexahedra.extend(Some(HEXAHEDRON.map(pick)).filter(|h| glows(&h[..]))),
            }
        }
        let cell_value: Vec<f32> =
            tets.iter().map(|t: &[u32; 4]| mean(t)).chain(hexahedra.iter().map(|h: &[u32; 8]| mean(h))).collect();
        let array = |name: &str, association, values: Vec<f32>| Array {
            name: name.to_owned(),
            association,
            components: 1,
            values: NumericColumn::from(values),
        };
        let cells = cell_value.len();
        CellMesh {
            points: Points::F32(points),
            file_from_tet: (0..tets.len() as u32).collect(),
            file_from_hexahedron: (0..hexahedra.len() as u32).collect(),
            tets: tets.into(),
            hexahedra: hexahedra.into(),
            arrays: vec![array("value", Association::Point, value), array("cell_value", Association::Cell, cell_value)],
            counts: CellCounts { in_file: cells as u64, ..CellCounts::default() },
            ..CellMesh::empty()
        }
    }

    /// Points along u, v and w.
    fn points(&self) -> [usize; 3] {
        let [nu, nv, nw] = self.boxes;
        [if self.is_ring { nu } else { nu + 1 }, nv + 1, nw + 1]
    }

    /// The points at the corners of a box.
    fn corners(&self, [i, j, k]: [usize; 3]) -> [u32; 8] {
        let [pu, pv, _] = self.points();
        std::array::from_fn(|c| {
            let at = [(i + (c & 1)) % pu, j + (c >> 1 & 1), k + (c >> 2)];
            (at[0] + pu * (at[1] + pv * at[2])) as u32
        })
    }
}

/// The square [−1, 1]² on the unit disc, its sides on the circle: no box collapses at the middle.
pub(super) fn disc_from_square(x: f64, y: f64) -> [f64; 2] {
    [x * (1.0 - y * y / 2.0).sqrt(), y * (1.0 - x * x / 2.0).sqrt()]
}
