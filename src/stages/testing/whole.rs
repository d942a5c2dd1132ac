//! Meshes of whole cells in the cube from −1 to 1, listed, mixed and in blocks, and rays through their skins in f64.

use glam::{DVec3, Vec3};

use super::Random;
use crate::cells::{HEXAHEDRON, PYRAMID, hexahedron_of, split};
use crate::columns::{CellCounts, CellMesh, Dataset, Points, StructuredCells};
use crate::stages::classify::FACES;
use crate::stages::{SceneVertex, View};

/// Points and cells of all kinds.
#[derive(Clone, Default)]
pub(in crate::stages) struct Cells {
    pub points: Vec<DVec3>,
    pub tets: Vec<[u32; 4]>,
    pub hexahedra: Vec<[u32; 8]>,
}

impl Cells {
    /// A grid of `n` cells each way; `place` moves the points of the cube.
    pub(in crate::stages) fn grid(n: [u32; 3], mut place: impl FnMut(DVec3) -> DVec3) -> Self {
        let [ni, nj, nk] = n.map(|n| n + 1);
        let all = (0..nk).flat_map(|k| (0..nj).flat_map(move |j| (0..ni).map(move |i| [i, j, k])));
        let at = |ijk: [u32; 3]| DVec3::from_array([0, 1, 2].map(|axis| f64::from(ijk[axis]) / f64::from(n[axis])));
        let points = all.clone().map(|ijk| place(at(ijk) * 2.0 - 1.0)).collect();
        let index = |i: u32, j: u32, k: u32| i + ni * (j + nj * k);
        let cells = all.filter(|&[i, j, k]| i < n[0] && j < n[1] && k < n[2]).map(|[i, j, k]| {
            let around = |k: u32| [index(i, j, k), index(i + 1, j, k), index(i + 1, j + 1, k), index(i, j + 1, k)];
            let ([a, b, c, d], [e, f, g, h]) = (around(k), around(k + 1));
            [a, b, c, d, e, f, g, h]
        });
        Self { points, tets: Vec::new(), hexahedra: cells.collect() }
    }

    /// A grid whose points are moved by up to `jitter` of a cell.
    pub(in crate::stages) fn jittered(n: u32, jitter: f64, random: &mut Random) -> Self {
        Self::grid([n; 3], |p| p + random.point() * (jitter / f64::from(n)))
    }

    /// Cuts hexahedra into pyramids around a point of their own, some of these into two tetrahedra; or into two wedges; or into
    /// tetrahedra; or leaves them.
    pub(in crate::stages) fn mixed(self, random: &mut Random) -> Self {
        let mut mixed = Self { points: self.points, ..Self::default() };
        for corners in self.hexahedra {
            let [a, b, c, d, e, f, g, h] = corners;
            match (random.unit() * 4.0) as u32 {
                0 => mixed.hexahedra.push(corners),
                1 => mixed.hexahedra.extend([[a, b, c, c, e, f, g, g], [a, c, d, d, e, g, h, h]]),
                2 => {
                    let middle = mixed.points.len() as u32;
                    mixed.points.push(corners.iter().map(|&v| mixed.points[v as usize]).sum::<DVec3>() / 8.0);
                    for (i, face) in HEXAHEDRON.faces.iter().enumerate() {
                        // Seen from the middle a face runs the other way.
                        let base = [3, 2, 1, 0].map(|k: usize| corners[usize::from(face[k])]);
                        let pyramid = [base[0], base[1], base[2], base[3], middle];
                        if i % 3 == 0 {
                            split(&PYRAMID, &pyramid, |v| v, |tet| mixed.tets.push(tet));
                        } else if let Some(numbers) = hexahedron_of(&PYRAMID) {
                            mixed.hexahedra.push(numbers.map(|k| pyramid[k]));
                        }
                    }
                }
                _ => split(&HEXAHEDRON, &corners, |v| v, |tet| mixed.tets.push(tet)),
            }
        }
        mixed
    }

    /// Without the hexahedra whose middle is not one that `is_kept`.
    pub(in crate::stages) fn part(mut self, is_kept: impl Fn(DVec3) -> bool) -> Self {
        let points = &self.points;
        self.hexahedra.retain(|cell| is_kept(cell.iter().map(|&v| points[v as usize]).sum::<DVec3>() / 8.0));
        self
    }

    pub(in crate::stages) fn dataset(self) -> Dataset {
        let (tets, hexahedra) = (self.tets.len() as u32, self.hexahedra.len() as u32);
        Dataset::from_cells(CellMesh {
            points: Points::F64(self.points.iter().map(DVec3::to_array).collect()),
            tets: self.tets.into(),
            file_from_tet: (0..tets).collect(),
            hexahedra: self.hexahedra.into(),
            file_from_hexahedron: (tets..tets + hexahedra).collect(),
            arrays: Vec::new(),
            counts: CellCounts::default(),
            ..CellMesh::empty()
        })
        .unwrap()
    }
}

/// Structured blocks of `dims` points that stand where `place` moves those of the cube; some cells hidden.
pub(in crate::stages) fn blocks(
    dims: &[[usize; 3]],
    mut place: impl FnMut(usize, DVec3) -> DVec3,
    is_hidden: impl FnMut(usize) -> bool,
) -> Dataset {
    let (mut points, mut cells) = (Vec::new(), 0);
    for (block, dims) in dims.iter().enumerate() {
        let n = dims.map(|points| points as u32 - 1);
        points.extend(Cells::grid(n, |p| place(block, p)).points.iter().map(DVec3::to_array));
        cells += n.iter().product::<u32>();
    }
    Dataset::from_structured(StructuredCells {
        dims: dims.to_vec(),
        points: Points::F64(points),
        hidden: (0..cells as usize).map(is_hidden).collect(),
        arrays: Vec::new(),
        counts: CellCounts::default(),
    })
    .unwrap()
}

/// View depths between which a ray lies in a cell, from the view's near plane on: between the first and the second crossing of its
/// skin, the third and the fourth, and so on.
pub(in crate::stages) fn parts_in_cell(
    dataset: &Dataset,
    vertices: &[SceneVertex],
    view: &View,
    (origin, direction): (DVec3, DVec3),
    cell: usize,
) -> Vec<(f64, f64)> {
    let corner = |v: u32| Vec3::from_array(vertices[v as usize].position).as_dvec3();
    let mut crossings = Vec::new();
    for [a, b, c] in skin(dataset, cell) {
        // Möller and Trumbore 1997.
        let [a, b, c] = [a, b, c].map(corner);
        let (u, v, t) = (b - a, c - a, origin - a);
        let (normal, across) = (direction.cross(v), t.cross(u));
        let determinant = u.dot(normal);
        let (x, y) = (t.dot(normal) / determinant, direction.dot(across) / determinant);
        if determinant != 0.0 && x >= 0.0 && y >= 0.0 && x + y <= 1.0 {
            crossings.push(v.dot(across) / determinant);
        }
    }
    crossings.sort_by(f64::total_cmp);
    let parts = crossings.chunks_exact(2).map(|two| (two[0].max(view.near.into()), two[1]));
    parts.filter(|(enter, leave)| enter < leave).collect()
}

/// The vertices of all triangles around a cell.
fn skin(dataset: &Dataset, cell: usize) -> Vec<[u32; 3]> {
    let Some(cell) = cell.checked_sub(dataset.tets.len()) else {
        let tet = dataset.tets.get(cell);
        return FACES.map(|face| face.map(|i| tet[i])).to_vec();
    };
    let hexahedra = dataset.hexahedra.view();
    let (vertex, shape) = (hexahedra.get(cell), hexahedra.shape(cell));
    if shape.is_absent() {
        return Vec::new();
    }
    (0..6).flat_map(|face| shape.triangles(face)).map(|triangle| triangle.map(|i| vertex[usize::from(i)])).collect()
}
