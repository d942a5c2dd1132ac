//! Cubes: the two fans of each class, in the room of four fans; those across the near plane or far outside the picture as tetrahedra.
//!
//! In: a cube, its value. Out: a [`CaseFan`], or tetrahedra, farthest first.
//! Entry and exit: at the outline they are one. Everywhere else, corners inside the outline and crossings A and B alike, a ray enters
//! through the face f0 that is seen best, or an edge of it, and leaves through the opposite face, or an edge of that: it crosses the
//! slab between the two. From the eye, both depths have one ratio for all rays, that of the distances of the two planes; parallel
//! rays have one length. So no edges need be intersected on the picture, and no case is degenerate.
//!
//! Source: Schussman and Max 2001, sections 4, 5 and 7, figures 4 to 6; the edges of A and B are left to these.

use arrayvec::ArrayVec;
use glam::{DVec3, Vec2, Vec3};

use super::cases::PARTS_MAX;
use super::polyhedra::{CellFans, FanVertex};
use super::tetrahedra::Tet;
use super::{CaseFan, Fan, FanInput, FanSlot, Writer, is_far_outside};
use crate::camera::Region;
use crate::columns::{Cube, GridEye, HexShape};
use crate::stages::classify::CellClass;
use crate::stages::classify::cubes::{ClassifiedCube, CubeClass, classify};
use crate::stages::cubes::{CubesInView, corner_between};
use crate::stages::{SceneVertex, ScreenVertex, View};

/// The fans of a class, in its standard view; vertices A and B are 8 and 9.
struct Template {
    triangles: &'static [[u8; 3]],
    /// Corners inside the outline.
    thick: &'static [u8],
    /// The edge of the face that is seen best, and that of the opposite face, which cross at A and at B.
    crossings: &'static [[[u8; 2]; 2]],
}

const A: u8 = 8;
const B: u8 = 9;

/// How a list of vertices is cut into triangles, as in OpenGL.
enum Run {
    Fan(&'static [u8]),
    Strip(&'static [u8]),
}

/// The triangles of two runs.
const fn triangles<const N: usize>(runs: &[Run; 2]) -> [[u8; 3]; N] {
    let mut triangles = [[0; 3]; N];
    let (mut count, mut run) = (0, 0);
    while run < 2 {
        let (vertices, is_fan) = match runs[run] {
            Run::Fan(vertices) => (vertices, true),
            Run::Strip(vertices) => (vertices, false),
        };
        let mut i = 2;
        while i < vertices.len() {
            triangles[count] = [vertices[if is_fan { 0 } else { i - 2 }], vertices[i - 1], vertices[i]];
            count += 1;
            i += 1;
        }
        run += 1;
    }
    assert!(count == N, "two runs have as many triangles");
    triangles
}

static ONE: [[u8; 3]; CubeClass::One.triangles()] =
    triangles(&[Run::Fan(&[2, 3, 7, 6, 4, 0, 3]), Run::Fan(&[1, 3, 0, 4, 5, 7, 3])]);
static TWO: [[u8; 3]; CubeClass::Two.triangles()] =
    triangles(&[Run::Fan(&[1, 7, 3, B, A, 4, 5, 7]), Run::Strip(&[7, 3, 6, B, 2, A, 0, 4])]);
static THREE_A: [[u8; 3]; CubeClass::Two.triangles()] =
    triangles(&[Run::Fan(&[A, 6, 2, 0, 4, 5, 1, B, 6]), Run::Fan(&[B, 1, 5, 7, 3, 2, 6])]);
static THREE_B: [[u8; 3]; CubeClass::Two.triangles()] =
    triangles(&[Run::Fan(&[A, 6, B, 1, 0, 4, 5, 7, 6]), Run::Fan(&[B, 6, 7, 3, 2, 0, 1])]);

static TEMPLATES: [Template; 4] = [
    Template { triangles: &ONE, thick: &[0, 1, 2, 3], crossings: &[] },
    Template { triangles: &TWO, thick: &[1, 3], crossings: &[[[4, 6], [0, 1]], [[4, 6], [2, 3]]] },
    Template { triangles: &THREE_A, thick: &[1, 6], crossings: &[[[4, 6], [0, 1]], [[6, 7], [1, 3]]] },
    Template { triangles: &THREE_B, thick: &[1, 6], crossings: &[[[4, 6], [1, 5]], [[2, 6], [1, 3]]] },
];

/// The way of rays between the face that is seen best and the opposite one.
struct Slab {
    axis: usize,
    /// Along the axis: where rays enter and where they leave.
    enter: f64,
    /// Depth of entry over depth of exit, from the eye; along parallel rays exit less entry.
    depth: f64,
    eye: GridEye,
}

impl Slab {
    fn new(face: u8, [low, high]: [DVec3; 2], eye: GridEye) -> Self {
        let axis = usize::from(face / 2);
        let (enter, leave) = if face.is_multiple_of(2) { (low[axis], high[axis]) } else { (high[axis], low[axis]) };
        let depth = match eye {
            GridEye::At(eye) => (enter - eye[axis]) / (leave - eye[axis]),
            GridEye::Along(direction) => (enter - leave) / direction[axis],
        };
        Self { axis, enter, depth, eye }
    }

    /// The inverse depth of entry from that of exit.
    fn enter_v(&self, leave: f32) -> f32 {
        let leave = f64::from(leave);
        (match self.eye {
            GridEye::At(_) => leave / self.depth,
            GridEye::Along(_) => leave + self.depth,
        }) as f32
    }

    /// The inverse depth of exit from that of entry.
    fn leave_v(&self, enter: f32) -> f32 {
        let enter = f64::from(enter);
        (match self.eye {
            GridEye::At(_) => enter * self.depth,
            GridEye::Along(_) => enter - self.depth,
        }) as f32
    }

    /// Where the ray to a point of the opposite face enters.
    fn entry_of(&self, exit: DVec3) -> DVec3 {
        match self.eye {
            GridEye::At(eye) => eye + (exit - eye) * self.depth,
            GridEye::Along(direction) => exit + direction * self.depth,
        }
    }
}

/// What is drawn of a cube.
pub(super) enum DrawnCube {
    /// Nothing: it lies beside the picture.
    Outside,
    /// The fans of its class.
    Fans(CubeClass, Box<CaseFan>),
    /// Tetrahedra, farthest first, and their vertices.
    Parts(Box<CubeParts>),
}

/// A cube as tetrahedra.
pub(super) struct CubeParts {
    vertices: [SceneVertex; 8],
    screen: [ScreenVertex; 8],
    tets: ArrayVec<Tet, PARTS_MAX>,
}

impl<'a> FanInput<'a> {
    /// With cubes instead of the dataset's cells.
    #[must_use]
    pub fn with_cubes(self, cubes: CubesInView<'a>) -> Self {
        let corners = cubes.outline(&self.projection).map(screen_vertex);
        // What lies within these corners is no nearer to the eye, and no farther outside.
        let has_near_cells = corners.iter().any(|corner| self.is_near_corner(corner));
        Self { cubes: Some(cubes), has_near_cells, ..self }
    }

    fn is_near_corner(&self, corner: &ScreenVertex) -> bool {
        // Cases and parts may differ in a bit: regions have those of the whole.
        corner.depth < self.view.near || is_far_outside(Region::whole(self.view.size_px), corner)
    }

    /// What is drawn of a cube.
    pub(super) fn of_cube(&self, cubes: &CubesInView, cube: &Cube) -> DrawnCube {
        let ends = cubes.ends(cube);
        let corners = cubes.corners(ends);
        let seen = corners.map(|corner| screen_vertex(self.projection.project(corner)));
        let is_near = self.has_near_cells && seen.iter().any(|corner| self.is_near_corner(corner));
        if !is_near && is_beside(self.view, &seen) {
            return DrawnCube::Outside;
        }
        let Some(classified) = classify(cubes.eye.beyond_faces(ends)).filter(|_| !is_near) else {
            return DrawnCube::Parts(Box::new(self.parts_of_cube(corners, seen, cube.value)));
        };
        let fans = fans_of(self, cubes, &classified, ends, (&seen, cube.value));
        DrawnCube::Fans(classified.class, Box::new(CaseFan::new(&fans, [cube.value; 2])))
    }

    /// The tetrahedra of a cube.
    fn parts_of_cube(&self, corners: [Vec3; 8], seen: [ScreenVertex; 8], value: f32) -> CubeParts {
        /// The corner at each corner of a hexahedron, in VTK's order.
        const HEXAHEDRON: [usize; 8] = [0, 1, 3, 2, 4, 5, 7, 6];
        let numbers: [u32; 8] = std::array::from_fn(|i| i as u32);
        let vertices = HEXAHEDRON.map(|i| SceneVertex { position: corners[i].to_array(), scalar: value });
        let screen = HEXAHEDRON.map(|i| seen[i]);
        let shape = HexShape::new(HEXAHEDRON.map(|i| corners[i]), numbers);
        let numbers = if shape.is_mirrored() { HexShape::mirrored(numbers) } else { numbers };
        let outer: FanInput = *self;
        let tets =
            FanInput { vertices: &vertices, screen: &screen, cubes: None, ..outer }.parts(numbers, shape, Some(value));
        CubeParts { vertices, screen, tets }
    }
}

impl<S: FanSlot> Writer<'_, '_, S> {
    pub(super) fn put_cube(&mut self, cubes: &CubesInView, cube: &Cube) {
        match self.input.of_cube(cubes, cube) {
            DrawnCube::Outside => {
                self.by_class.add(CellClass::EDGE_ON);
                self.put(&[Fan::default(); CaseFan::FANS]);
            }
            DrawnCube::Fans(class, fan) => {
                self.by_class.add(class.into());
                self.put(&bytemuck::cast::<_, [Fan; CaseFan::FANS]>(*fan));
            }
            DrawnCube::Parts(parts) => {
                self.by_class.add(CellClass::SPLIT);
                let CubeParts { vertices, screen, tets } = &*parts;
                let outer: FanInput = *self.input;
                let input = FanInput { vertices, screen, cubes: None, ..outer };
                tets.iter().for_each(|tet| self.put_fans(input.of_tet(tet)));
            }
        }
    }
}

impl FanInput<'_> {
    /// How many records a cube has.
    pub(super) fn records_of_cube(&self, cubes: &CubesInView, cube: &Cube) -> usize {
        match self.of_cube(cubes, cube) {
            DrawnCube::Outside | DrawnCube::Fans(..) => 1,
            DrawnCube::Parts(parts) => {
                let CubeParts { vertices, screen, tets } = &*parts;
                let outer: FanInput = *self;
                let input = FanInput { vertices, screen, cubes: None, ..outer };
                tets.iter().map(|tet| input.fans_of(tet)).sum()
            }
        }
    }
}

fn screen_vertex(p: Vec3) -> ScreenVertex {
    ScreenVertex { x_px: p.x, y_px: p.y, depth: p.z, scalar: 0.0 }
}

/// Whether all corners lie beside the same edge of what is drawn.
fn is_beside(view: &View, corners: &[ScreenVertex; 8]) -> bool {
    let Region { x0, y0, x1, y1 } = view.region;
    let pad = view.pad_px();
    let all = |is_beyond: &dyn Fn(&ScreenVertex) -> bool| corners.iter().all(is_beyond);
    all(&|corner| corner.x_px < x0 as f32 - pad)
        || all(&|corner| corner.x_px > x1 as f32 + pad)
        || all(&|corner| corner.y_px < y0 as f32 - pad)
        || all(&|corner| corner.y_px > y1 as f32 + pad)
}

/// The vertices and triangles of a classified cube.
#[expect(clippy::float_cmp, reason = "corners share coordinates bit for bit")]
fn fans_of(
    input: &FanInput,
    cubes: &CubesInView,
    classified: &ClassifiedCube,
    ends: [DVec3; 2],
    (seen, value): (&[ScreenVertex; 8], f32),
) -> CellFans {
    let view = input.view;
    let template = &TEMPLATES[classified.class as usize];
    let slab = Slab::new(classified.face, ends, cubes.eye);
    let standard = classified.corner_from_standard;
    let corner_at = |standard_corner: u8| corner_between(ends, usize::from(standard[usize::from(standard_corner)]));
    let vq = |v: f32| [v, if view.is_perspective { value * v } else { value }];
    let mut vertices: ArrayVec<FanVertex, _> = (0..8_u8)
        .map(|i| {
            let corner = &seen[usize::from(standard[usize::from(i)])];
            let v = view.inverse_depth(corner.depth);
            let is_in_front = corner_at(i)[slab.axis] == slab.enter;
            let (front, back) = match template.thick.contains(&i) {
                false => (v, v),
                true if is_in_front => (v, slab.leave_v(v)),
                true => (slab.enter_v(v), v),
            };
            FanVertex { position_px: corner.xy().to_array(), front: vq(front), back: vq(back) }
        })
        .collect();
    for &[front_edge, back_edge] in template.crossings {
        // The two are at right angles. The front edge gives the crossing's place on the back edge's axis, and so the other way
        // round, on the slab's near and far side.
        let [p, q] = front_edge.map(corner_at);
        let [r, _] = back_edge.map(corner_at);
        let entry_of_back_edge = slab.entry_of(r);
        let crossing = DVec3::from_array(std::array::from_fn(|axis| {
            if axis == slab.axis || p[axis] == q[axis] { p[axis] } else { entry_of_back_edge[axis] }
        }));
        let at = input.projection.project(cubes.position(crossing));
        let v = view.inverse_depth(at.z);
        let position_px = Vec2::new(at.x, at.y).to_array();
        vertices.push(FanVertex { position_px, front: vq(v), back: vq(slab.leave_v(v)) });
    }
    CellFans { vertices, triangles: template.triangles }
}

#[cfg(test)]
mod tests;
