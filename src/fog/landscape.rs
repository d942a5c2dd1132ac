//! `Landscape`: the triangles of a terrain that a view needs, and the prisms on them.

use super::prisms::prisms;
use super::{Detail, Profile, Terrain};
use crate::columns::CellMesh;

/// Triangles of the ground, every edge of two of them or at the border, and the prisms of fog that stand on them.
#[derive(Clone, Debug)]
pub struct Landscape {
    /// Where the points that are drawn are, on the ground.
    pub points: Vec<[f32; 3]>,
    /// How thick the fog is on each.
    pub thickness: Vec<f32>,
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
    /// Ground and thickness of the fog.
    heights: [f64; 2],
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
            triangles: Vec::new(),
        };
        let last = side - 1;
        let corner = |bisection: &mut Bisection, at| bisection.vertex(at, terrain.heights(at));
        let [a, b, c, d] = [[0, 0], [last, 0], [last, last], [0, last]].map(|at| corner(&mut bisection, at));
        bisection.triangle([c, a, b]);
        bisection.triangle([a, c, d]);
        let Bisection { points, thickness, triangles, .. } = bisection;
        let fog = prisms(&points, &thickness, &triangles, terrain.thickest_world(), profile);
        Self { points, thickness, triangles, fog }
    }
}

impl Bisection<'_> {
    fn vertex(&mut self, at: [usize; 2], heights: [f64; 2]) -> Vertex {
        let number = &mut self.number_from_point[at[0] + self.terrain.side() * at[1]];
        if *number == NONE {
            *number = self.points.len() as u32;
            let place = self.terrain.position(at).with_z(heights[0]);
            self.points.push(place.as_vec3().to_array());
            self.thickness.push(heights[1] as f32);
        }
        Vertex { at, heights, number: *number }
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
        let own = self.terrain.heights(at);
        let heights = std::array::from_fn(|k| {
            // The same for the triangle on the other side of the edge, whose ends are exchanged.
            let without = 0.5 * (left.heights[k] + right.heights[k]);
            without + risen * (own[k] - without)
        });
        let middle = self.vertex(at, heights);
        self.triangle([apex, left, middle]);
        self.triangle([right, apex, middle]);
    }
}
