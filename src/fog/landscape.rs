//! `Landscape`: the triangles of a terrain that a view needs, and the prisms on them.

use glam::DVec3;

use super::prisms::prisms;
use super::terrain::Values;
use super::{Detail, Profile, Terrain};
use crate::columns::CellMesh;
use crate::geometry::TriangleMesh;

/// Triangles of the ground, every edge of two of them or at the border, and the prisms of fog that stand on them.
#[derive(Clone, Debug)]
pub struct Landscape {
    /// Where the points that are drawn are, on the ground.
    pub points: Vec<[f32; 3]>,
    /// How thick the fog is on each.
    pub thickness: Vec<f32>,
    /// Linear RGB of the ground at each, in the light of the sun.
    pub colors: Vec<[f32; 3]>,
    /// Three points each, counterclockwise seen from above.
    pub triangles: Vec<[u32; 3]>,
    /// The fog, with the point array `density`, 0 to 1.
    pub fog: CellMesh,
}

/// A point that has risen as far as the view needs.
#[derive(Clone, Copy)]
struct Vertex {
    /// Where it is in the grid.
    at: [usize; 2],
    values: Values,
    number: u32,
}

/// No number.
const NONE: u32 = u32::MAX;

struct Bisection<'a> {
    terrain: &'a Terrain,
    detail: &'a Detail,
    number_from_point: Vec<u32>,
    points: Vec<[f32; 3]>,
    thickness: Vec<f32>,
    colors: Vec<[f32; 3]>,
    triangles: Vec<[u32; 3]>,
}

impl Landscape {
    pub(super) fn new(terrain: &Terrain, detail: &Detail, profile: Profile) -> Self {
        let side = terrain.side();
        let mut bisection = Bisection {
            terrain,
            detail,
            number_from_point: vec![NONE; side * side],
            points: Vec::new(),
            thickness: Vec::new(),
            colors: Vec::new(),
            triangles: Vec::new(),
        };
        let last = side - 1;
        let corner = |bisection: &mut Bisection, at| bisection.vertex(at, terrain.values(at));
        let [a, b, c, d] = [[0, 0], [last, 0], [last, last], [0, last]].map(|at| corner(&mut bisection, at));
        bisection.triangle([c, a, b]);
        bisection.triangle([a, c, d]);
        let Bisection { points, thickness, colors, triangles, .. } = bisection;
        let fog = prisms(&points, &thickness, &triangles, terrain.thickest_world(), profile);
        Self { points, thickness, colors, triangles, fog }
    }

    /// The ground, seen from `eye`: coloured, not lit again by a lamp at the eye, whose light falls on it at right angles.
    pub fn ground(&self, eye: DVec3) -> TriangleMesh {
        let to_eye = |&point: &[f32; 3]| (eye - DVec3::from_array(point.map(f64::from))).as_vec3().to_array();
        TriangleMesh {
            positions: self.points.iter().map(|point| point.map(f64::from)).collect(),
            triangles: self.triangles.clone(),
            normals: self.points.iter().map(to_eye).collect(),
            colors: self.colors.clone(),
        }
    }
}

impl Bisection<'_> {
    fn vertex(&mut self, at: [usize; 2], values: Values) -> Vertex {
        let number = &mut self.number_from_point[at[0] + self.terrain.side() * at[1]];
        if *number == NONE {
            *number = self.points.len() as u32;
            let [ground, thickness, r, g, b] = values;
            self.points.push(self.terrain.position(at).with_z(ground).as_vec3().to_array());
            self.thickness.push(thickness as f32);
            self.colors.push([r, g, b].map(|channel| channel as f32));
        }
        Vertex { at, values, number: *number }
    }

    /// A triangle: the ends of its longest side, and the corner across from it; split where the view needs the midpoint.
    fn triangle(&mut self, [left, right, apex]: [Vertex; 3]) {
        let sum = [left.at[0] + right.at[0], left.at[1] + right.at[1]];
        let at = sum.map(|c| c / 2);
        let is_smallest = sum.iter().any(|c| c % 2 == 1);
        let risen =
            if is_smallest { 0.0 } else { self.terrain.importance().risen(self.detail, at, self.terrain.position(at)) };
        if risen == 0.0 {
            self.triangles.push([left, right, apex].map(|vertex| vertex.number));
            return;
        }
        let own = self.terrain.values(at);
        let values = std::array::from_fn(|k| {
            // The same for the triangle on the other side of the edge, whose ends are exchanged.
            let without = 0.5 * (left.values[k] + right.values[k]);
            without + risen * (own[k] - without)
        });
        let middle = self.vertex(at, values);
        self.triangle([apex, left, middle]);
        self.triangle([right, apex, middle]);
    }
}
