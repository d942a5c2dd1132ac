//! The slow twin of cells with faces of four corners or any number: a closed skin of triangles, and every ray against every triangle, in f64.
//!
//! A face is a fan of triangles, two of four corners, from its corner of lowest index in the file. A ray is inside between its first and second
//! crossing, its third and fourth, and so on; s is linear on each triangle and linear along the ray between two crossings.

use std::collections::HashMap;

use cellfan::Dataset;
use cellfan::cells::HEXAHEDRON;
use glam::DVec3;

use crate::reference::{Ray, Segment};

/// A cell as its skin, and the sphere around it.
pub(crate) struct Polyhedron {
    center: DVec3,
    radius_squared: f64,
    triangles: Vec<([DVec3; 3], [f64; 3])>,
    index: usize,
}

/// For each vertex the lowest point of the file at the same place.
pub(crate) fn canonical_from_vertex(dataset: &Dataset) -> Vec<usize> {
    let place = |v: usize| dataset.positions[v].map(|x| (x + 0.0).to_bits());
    let mut lowest: HashMap<_, usize> = HashMap::new();
    for v in 0..dataset.positions.len() {
        let point = dataset.point_tuple(v);
        lowest.entry(place(v)).and_modify(|lowest| *lowest = point.min(*lowest)).or_insert(point);
    }
    (0..dataset.positions.len()).map(|v| lowest[&place(v)]).collect()
}

impl Polyhedron {
    /// The hexahedron with vertices `vertex`.
    pub(crate) fn new(
        index: usize,
        vertex: [u32; 8],
        scalars: [f64; 8],
        dataset: &Dataset,
        canonical_from_vertex: &[usize],
    ) -> Self {
        let p = vertex.map(|v| DVec3::from_array(dataset.positions[v as usize].map(f64::from)));
        let center = p.iter().sum::<DVec3>() / 8.0;
        let radius_squared = p.iter().map(|c| c.distance_squared(center)).fold(0.0, f64::max) * (1.0 + 1e-9);
        let mut triangles = Vec::new();
        for face in HEXAHEDRON.faces {
            let corner = |i: usize| usize::from(face[i % 4]);
            let lowest = (0..4).min_by_key(|&i| canonical_from_vertex[vertex[corner(i)] as usize]).unwrap();
            for i in [1, 2] {
                let of = [corner(lowest), corner(lowest + i), corner(lowest + i + 1)];
                triangles.push((of.map(|i| p[i]), of.map(|i| scalars[i])));
            }
        }
        Self { center, radius_squared, triangles, index }
    }

    /// Polyhedron `cell` of the dataset, with the values `scalar` of its vertices.
    pub(crate) fn of_faces(
        (index, cell): (usize, usize),
        scalar: impl Fn(u32) -> f64,
        dataset: &Dataset,
        canonical_from_vertex: &[usize],
    ) -> Self {
        let at = |v: u32| DVec3::from_array(dataset.positions[v as usize].map(f64::from));
        let polyhedra = dataset.polyhedra.view();
        let corners = polyhedra.corners(cell);
        let center = corners.iter().map(|&v| at(v)).sum::<DVec3>() / corners.len() as f64;
        let radius_squared = corners.iter().map(|&v| at(v).distance_squared(center)).fold(0.0, f64::max) * (1.0 + 1e-9);
        let mut triangles = Vec::new();
        for face in polyhedra.faces(cell) {
            let n = face.around.len();
            let lowest = (0..n).min_by_key(|&i| canonical_from_vertex[face.around[i] as usize]).unwrap();
            for i in 1..n - 1 {
                let of = [lowest, lowest + i, lowest + i + 1].map(|i| face.around[i % n]);
                triangles.push((of.map(at), of.map(&scalar)));
            }
        }
        Self { center, radius_squared, triangles, index }
    }

    /// The parts of a ray in the cell.
    pub(crate) fn meet(&self, ray: Ray, near: f64, far: f64) -> Vec<Segment> {
        let to_center = self.center - ray.origin;
        let foot = to_center.dot(ray.direction) / ray.direction.length_squared();
        if (to_center - ray.direction * foot).length_squared() > self.radius_squared {
            return Vec::new();
        }
        // Relative to a point nearby: Möller and Trumbore, 1997.
        let middle = ray.origin + ray.direction * foot;
        let mut crossings: Vec<(f64, f64)> = Vec::new();
        for ([a, b, c], [s_a, s_b, s_c]) in &self.triangles {
            let (u, v, t) = (*b - *a, *c - *a, middle - *a);
            let normal = ray.direction.cross(v);
            let determinant = u.dot(normal);
            if determinant == 0.0 {
                continue;
            }
            let across = t.cross(u);
            let (x, y) = (t.dot(normal) / determinant, ray.direction.dot(across) / determinant);
            if x >= 0.0 && y >= 0.0 && x + y <= 1.0 {
                let w = foot + v.dot(across) / determinant;
                crossings.push((w, s_a + (s_b - s_a) * x + (s_c - s_a) * y));
            }
        }
        crossings.sort_by(|a, b| a.0.total_cmp(&b.0));
        let part = |two: &[(f64, f64)]| {
            let [(w0, s0), (w1, s1)] = [two[0], *two.get(1)?];
            let w = [w0.max(near), w1.min(far)];
            let s = w.map(|w| s0 + (s1 - s0) * ((w - w0) / (w1 - w0)));
            let length_world = (w[1] - w[0]) * ray.direction.length();
            // Triangles of a face that is not convex overlap: a ray beside it crosses two of them at one depth.
            let least = 1e-9 * self.radius_squared.sqrt() / ray.direction.length();
            (w[1] - w[0] > least).then_some(Segment { w, s, length_world, cell: self.index })
        };
        crossings.chunks(2).filter_map(part).collect()
    }
}
