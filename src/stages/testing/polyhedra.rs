//! Projected hexahedra, voxels, wedges and pyramids of every shape, and what the obvious way says about them.

use glam::{DMat3, DQuat, DVec2, DVec3, Vec2};

use super::Random;
use crate::cells::{CellKind, HEXAHEDRON, PYRAMID, VOXEL, WEDGE};
use crate::stages::fans::polyhedra::ProjectedCorner;

/// The kinds that have cases.
pub(in crate::stages) const KINDS: [&CellKind; 4] = [&HEXAHEDRON, &VOXEL, &WEDGE, &PYRAMID];

/// A cell on the picture: (column, row, inverse depth) of its corners.
#[derive(Clone, Debug)]
pub(in crate::stages) struct Seen {
    pub kind: &'static CellKind,
    pub corners: Vec<DVec3>,
    pub is_positive: bool,
}

/// A positively oriented cell within the cube from −½ to ½.
pub(in crate::stages) fn unit(kind: &CellKind) -> Vec<DVec3> {
    let p = |x: i32, y: i32, z: i32| DVec3::new(x.into(), y.into(), z.into()) - 0.5;
    let around = |z| [p(0, 0, z), p(1, 0, z), p(1, 1, z), p(0, 1, z)];
    match kind.code {
        11 => (0..8).map(|i| p(i & 1, i >> 1 & 1, i >> 2)).collect(),
        12 => [around(0), around(1)].concat(),
        13 => vec![p(0, 0, 0), p(0, 1, 0), p(1, 0, 0), p(0, 0, 1), p(0, 1, 1), p(1, 0, 1)],
        14 => [&around(0)[..], &[DVec3::new(0.0, 0.0, 0.5)]].concat(),
        code => unreachable!("no cell for {code}"),
    }
}

/// What the random cells are like.
#[derive(Clone, Copy, Debug)]
pub(in crate::stages) enum Shape {
    /// Corners of the unit cell moved by up to this.
    Jittered(f64),
    /// The unit cell twisted about its third axis by up to this many radians, and jittered a little.
    Twisted(f64),
    /// Corners anywhere in a cube.
    Anywhere,
    /// Faces of the unit cell tilted and moved by up to this: they stay planar.
    Tilted(f64),
    /// The unit cell, in strong perspective.
    Regular,
    /// Corners of the unit cell moved on a coarse lattice, along parallel rays: full of ties.
    Lattice,
    /// Jittered, with two corners in one place.
    Collapsed(f64),
}

/// Shapes that meet every case, and how many cells of each to take: for each kind 10⁵ and more are whole.
pub(in crate::stages) const SHAPES: [(Shape, usize); 10] = [
    (Shape::Jittered(0.1), 40_000),
    (Shape::Jittered(0.3), 50_000),
    (Shape::Jittered(0.6), 50_000),
    (Shape::Twisted(0.8), 30_000),
    (Shape::Twisted(1.6), 20_000),
    (Shape::Tilted(0.3), 30_000),
    (Shape::Tilted(0.7), 20_000),
    (Shape::Regular, 20_000),
    (Shape::Anywhere, 200_000),
    (Shape::Collapsed(0.3), 20_000),
];

impl Seen {
    /// A cell of one shape, seen from anywhere, half of them in perspective, half of them left-handed.
    pub(in crate::stages) fn random(kind: &'static CellKind, shape: Shape, random: &mut Random) -> Self {
        let mut corners = match shape {
            Shape::Tilted(by) => tilted(kind, by, random),
            _ => unit(kind),
        };
        for corner in &mut corners {
            *corner += match shape {
                Shape::Jittered(by) | Shape::Collapsed(by) => random.point() * by,
                Shape::Twisted(by) => random.point() * (0.1 * by),
                Shape::Lattice => (random.point() * 1.9).round() * 0.25,
                Shape::Anywhere | Shape::Tilted(_) | Shape::Regular => DVec3::ZERO,
            };
        }
        match shape {
            Shape::Twisted(by) => {
                let angle = 2.0 * by * random.unit();
                for corner in &mut corners {
                    *corner = DMat3::from_rotation_z(corner.z * angle) * *corner;
                }
            }
            Shape::Anywhere => corners.fill_with(|| random.point() * 0.5),
            Shape::Collapsed(_) => {
                let any = |random: &mut Random| (random.unit() * kind.corners as f64) as usize;
                let (from, to) = (any(random), any(random));
                corners[from] = corners[to];
            }
            _ => {}
        }
        let is_positive = random.unit() < 0.5;
        if !is_positive {
            for corner in &mut corners {
                corner.x = -corner.x;
            }
        }
        if matches!(shape, Shape::Lattice) {
            // Along one of the lattice's axes: coordinates stay whole, ties stay ties.
            let axis = (3.0 * random.unit()) as usize;
            let turned = corners.iter().map(|p| DVec3::new(p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3]));
            return Self { kind, corners: turned.collect(), is_positive };
        }
        let [a, b, c, d] = std::array::from_fn(|_| random.unit() - 0.5);
        let turn = DMat3::from_quat(DQuat::from_xyzw(a, b, c, d + 1e-9).normalize());
        let parallel = random.unit() < 0.5;
        // Columns to the right, rows down, depth forward is right-handed: positive cells stay positive.
        let depth = 2.5 + 3.0 * random.unit().powi(2);
        let seen = |corner: &DVec3| {
            let p = turn * *corner;
            let w = p.z + depth;
            if parallel {
                DVec3::new(p.x, p.y, -w) * 100.0
            } else {
                DVec3::new(300.0 * p.x / w, 300.0 * p.y / w, 100.0 / w)
            }
        };
        let corners = corners.iter().map(|corner| round(seen(corner))).collect();
        Self { kind, corners, is_positive }
    }

    /// The picture positions.
    pub(in crate::stages) fn xy(&self) -> Vec<Vec2> {
        self.corners.iter().map(|corner| corner.truncate().as_vec2()).collect()
    }

    /// The corners with a field whose q is `q`(x, y, v).
    pub(in crate::stages) fn projected(&self, q: impl Fn(DVec3) -> f64) -> Vec<ProjectedCorner> {
        let corner =
            |&p: &DVec3| ProjectedCorner { position_px: p.truncate().as_vec2(), vq: DVec2::new(p.z, q(p)).as_vec2() };
        self.corners.iter().map(corner).collect()
    }

    /// The picture positions of a face.
    pub(in crate::stages) fn face(&self, face: usize) -> Vec<DVec2> {
        self.kind.faces[face].iter().map(|&corner| self.corners[usize::from(corner)].truncate()).collect()
    }

    /// Areas of the projected faces, positive where they run clockwise.
    pub(in crate::stages) fn face_areas(&self) -> Vec<f64> {
        (0..self.kind.faces.len()).map(|face| polygon_area(&self.face(face))).collect()
    }

    /// Largest distance of two corners on the picture.
    pub(in crate::stages) fn extent(&self) -> f64 {
        let distance = |a: &DVec3| self.corners.iter().map(|b| a.truncate().distance(b.truncate())).fold(0.0, f64::max);
        self.corners.iter().map(distance).fold(0.0, f64::max)
    }
}

/// Narrowed to f32, which is all that a stage gets.
fn round(p: DVec3) -> DVec3 {
    p.as_vec3().as_dvec3()
}

/// Area of a polygon with its sign: positive where it runs clockwise, rows running down.
pub(in crate::stages) fn polygon_area(polygon: &[DVec2]) -> f64 {
    let n = polygon.len();
    0.5 * (0..n).map(|i| (polygon[i] - polygon[0]).perp_dot(polygon[(i + 1) % n] - polygon[0])).sum::<f64>()
}

/// A cell whose faces are those of the unit cell, tilted and moved; a pyramid's go on meeting in its tip.
fn tilted(kind: &CellKind, by: f64, random: &mut Random) -> Vec<DVec3> {
    let unit = unit(kind);
    if kind.code == PYRAMID.code {
        let (tilt, mut corners) = (random.point() * by, unit);
        for corner in &mut corners {
            *corner += random.point() * by;
        }
        for corner in &mut corners[..4] {
            corner.z = tilt.dot(corner.with_z(1.0));
        }
        return corners;
    }
    let planes: Vec<(DVec3, f64)> = kind
        .faces
        .iter()
        .map(|face| {
            let [a, b, c] = [0, 1, 2].map(|i| unit[usize::from(face[i])]);
            let normal = (b - a).cross(c - a).normalize();
            let tilted = (normal + random.point() * by).normalize();
            (tilted, normal.dot(a) + by * (random.unit() - 0.5))
        })
        .collect();
    let corner = |corner: usize| {
        let at: Vec<(DVec3, f64)> = (0..kind.faces.len())
            .filter(|&face| kind.faces[face].contains(&(corner as u8)))
            .map(|face| planes[face])
            .collect();
        let rows = DMat3::from_cols(at[0].0, at[1].0, at[2].0).transpose();
        rows.inverse() * DVec3::new(at[0].1, at[1].1, at[2].1)
    };
    (0..kind.corners).map(corner).collect()
}
