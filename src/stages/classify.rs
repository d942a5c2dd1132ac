//! `classify`: which of Shirley and Tuchman's projections a tetrahedron has.
//!
//! In: the four projected vertices of a cell, ascending by index, and its orientation bit.
//! Out: [`ProjectionClass`] and the roles of the vertices. Front, back or edge-on is the sign of each face's projected area
//! in that canonical order, so that neighbours decide alike about the face they share. O(1), no branch on coordinates
//! beyond the four signs. Other kinds of cells: [`polyhedra`]; cubes of a
//! regular grid: [`cubes`].
//!
//! Source: CellFast, figure 3 (Shirley and Tuchman 1990).

mod counts;
pub mod cubes;
pub mod polyhedra;

pub use crate::cells::{OPPOSITE_FACES as FACES, OUTWARD_IF_POSITIVE};
pub use counts::{CellClass, ClassCounts};

use glam::Vec2;

/// The projections of a tetrahedron, named by their count of triangles as in CellFast's figure 3.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ProjectionClass {
    /// No face has an area: the cell is seen edge-on and covers nothing.
    EdgeOn,
    /// One vertex inside the triangle of the others: 3 triangles.
    Class1,
    /// A quadrilateral whose diagonals are a front and a back edge: 4 triangles.
    Class2,
    /// One face edge-on, a vertex on the edge of the others' triangle: 2 triangles.
    Class3,
    /// Two faces edge-on, two vertices in one place: 1 triangle.
    Class4,
}

impl ProjectionClass {
    /// All classes, in the order of their numbers.
    pub const ALL: [Self; 5] = [Self::EdgeOn, Self::Class1, Self::Class2, Self::Class3, Self::Class4];

    /// The class's name in STATS.json.
    pub fn name(self) -> &'static str {
        ["edge_on", "class1", "class2", "class3", "class4"][self as usize]
    }

    /// Triangles of its fan.
    pub fn triangles(self) -> usize {
        [0, 3, 4, 2, 1][self as usize]
    }
}

/// A classified cell: `roles` lists its vertices (0 to 3) in the order in which the class uses them.
///
/// - Class 1: the inner vertex, then the outer three. `inner_is_front` where the inner vertex is the nearer one.
/// - Class 2: the two ends of the front edge, then those of the back edge.
/// - Class 3: the vertex on the edge, then that edge's first end, the vertex opposite, the edge's second end.
///   `inner_is_front` where the vertex on the edge is nearer than the edge.
/// - Class 4: the front and the back one of the coinciding vertices, then the other two.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Classified {
    /// The class.
    pub class: ProjectionClass,
    /// The vertices in the order of their roles.
    pub roles: [u8; 4],
    /// Whether the thick vertex belongs to the front faces (classes 1 and 3).
    pub inner_is_front: bool,
}

/// +1 for a front-facing, −1 for a back-facing, 0 for an edge-on face k, for each of the cell's four faces.
#[inline]
pub fn facing(xy: [Vec2; 4], is_positive: bool) -> [i8; 4] {
    std::array::from_fn(|k| {
        let [a, b, c] = FACES[k].map(|i| xy[i]);
        let area = (b - a).perp_dot(c - a);
        // Rows run down: a face whose outward normal comes towards the eye runs clockwise on paper, area > 0 here.
        let sign = i8::from(area < 0.0) - i8::from(area > 0.0);
        if is_positive == OUTWARD_IF_POSITIVE[k] { sign } else { -sign }
    })
}

/// Classifies a cell by its projected vertices.
#[inline]
pub fn classify(xy: [Vec2; 4], is_positive: bool) -> Classified {
    classify_facing(facing(xy, is_positive))
}

/// Classifies a cell by the facing of its four faces (face k is opposite to vertex k).
pub fn classify_facing(facing: [i8; 4]) -> Classified {
    // Gather the faces by facing: `sorted` holds front, then back, then edge-on faces.
    let mut sorted = [0_u8; 4];
    let (mut fronts, mut backs, mut n) = (0, 0, 0);
    for (wanted, count) in [(1, &mut fronts), (-1, &mut backs), (0, &mut 0)] {
        for (face, &sign) in facing.iter().enumerate() {
            if sign == wanted {
                sorted[n] = face as u8;
                n += 1;
                *count += 1;
            }
        }
    }
    let [p, q, r, s] = sorted;
    let (class, roles, inner_is_front) = match (fronts, backs) {
        // One front face covers the three back ones: the vertex opposite to it lies behind it.
        (1, 3) => (ProjectionClass::Class1, [p, q, r, s], false),
        (3, 1) => (ProjectionClass::Class1, [s, p, q, r], true),
        // Front faces p, q meet in the edge of the other two vertices, r s; back faces in p q.
        (2, 2) => (ProjectionClass::Class2, [r, s, p, q], false),
        // One face edge-on, opposite to s: its vertices are on a line, the one between is opposite to the single face.
        (1, 2) => (ProjectionClass::Class3, [p, q, s, r], false),
        (2, 1) => (ProjectionClass::Class3, [r, p, s, q], true),
        // Faces r, s edge-on: vertices p and q coincide; the front face lacks p, so q is in front.
        (1, 1) => (ProjectionClass::Class4, [q, p, r, s], true),
        _ => (ProjectionClass::EdgeOn, [0, 1, 2, 3], false),
    };
    Classified { class, roles, inner_is_front }
}

#[cfg(test)]
mod tests;
