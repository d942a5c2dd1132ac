//! Small meshes, cameras and transfer functions, and the chord of a ray in the unit cube.

use cellfan::columns::{Array, Association, CellCounts, NumericColumn};
use cellfan::generate::{Scheme, Settings, delaunay, tets};
use cellfan::{Camera, ControlPoint, Points, Projection, TetMesh, TransferFunction};
use glam::DVec3;

/// Pseudo-random numbers (`SplitMix64`, Steele 2014), the same on every machine.
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// From 0 to below `end`.
    pub(crate) fn below(&mut self, end: u32) -> u32 {
        (self.next() % u64::from(end)) as u32
    }
}

/// Tetrahedra with the point array `value`.
pub(crate) fn mesh(points: Vec<[f64; 3]>, tets: Vec<[u32; 4]>, values: Vec<f64>) -> TetMesh {
    let count = tets.len() as u32;
    TetMesh {
        points: Points::F64(points),
        tets: tets.into(),
        file_from_tet: (0..count).collect(),
        arrays: vec![Array {
            name: "value".to_owned(),
            association: Association::Point,
            components: 1,
            values: NumericColumn::from(values),
        }],
        counts: CellCounts { in_file: count.into(), ..CellCounts::default() },
    }
}

/// `mesh` with each point moved by `of`, in double precision.
pub(crate) fn moved(mesh: TetMesh, of: impl Fn(DVec3) -> DVec3) -> TetMesh {
    let points = (0..mesh.points.len()).map(|i| of(mesh.points.get(i)).to_array()).collect();
    TetMesh { points: Points::F64(points), ..mesh }
}

/// The unit cube as a grid of tetrahedra.
pub(crate) fn grid(cells: u64, scheme: Scheme, jitter: f64) -> TetMesh {
    tets(&Settings { cells, scheme, jitter, seed: 7, ..Settings::default() }).unwrap()
}

/// The unit cube as a Delaunay mesh of random points.
pub(crate) fn random_delaunay(cells: u64) -> TetMesh {
    delaunay(&Settings { cells, seed: 7, ..Settings::default() }).unwrap()
}

/// A control point of a transfer function.
pub(crate) fn point(value: f64, color: [f64; 3], extinction: f64) -> ControlPoint {
    ControlPoint { value, color, extinction }
}

/// Five points, gentle slopes.
pub(crate) fn smooth() -> TransferFunction {
    TransferFunction::new(vec![
        point(0.0, [0.1, 0.2, 0.9], 0.5),
        point(0.25, [0.1, 0.9, 0.4], 3.0),
        point(0.5, [1.0, 0.8, 0.1], 1.0),
        point(0.75, [0.9, 0.2, 0.1], 6.0),
        point(1.0, [1.0, 1.0, 1.0], 9.0),
    ])
    .unwrap()
}

/// Extinction rises from 0 to 50 per unit within 1 % of the range.
pub(crate) fn steep() -> TransferFunction {
    TransferFunction::new(vec![
        point(0.0, [0.2, 0.3, 1.0], 0.0),
        point(0.5, [0.3, 0.9, 0.5], 0.0),
        point(0.51, [1.0, 0.5, 0.1], 50.0),
        point(1.0, [1.0, 0.9, 0.8], 50.0),
    ])
    .unwrap()
}

/// Discontinuous in colour and extinction.
pub(crate) fn stepped() -> TransferFunction {
    TransferFunction::new(vec![
        point(0.0, [0.1, 0.1, 0.9], 0.3),
        point(0.3, [0.1, 0.5, 0.9], 0.3),
        point(0.3, [0.9, 0.8, 0.1], 4.0),
        point(0.6, [0.9, 0.8, 0.1], 4.0),
        point(0.6, [0.2, 0.9, 0.3], 0.0),
        point(0.8, [0.2, 0.9, 0.3], 1.0),
        point(0.8, [1.0, 0.1, 0.1], 20.0),
        point(1.0, [1.0, 0.1, 0.1], 20.0),
    ])
    .unwrap()
}

/// A camera that shows the whole unit cube.
pub(crate) fn frame_unit_cube(azimuth: f64, elevation: f64, width: u32, height: u32) -> Camera {
    let corners =
        [0, 1, 2, 3, 4, 5, 6, 7].map(|i| DVec3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2)));
    Camera::framing(&corners, azimuth, elevation, width, height)
}

/// Three views of the unit cube: from outside, from inside, and along parallel rays.
pub(crate) fn three_views(width: u32, height: u32) -> [(&'static str, Camera); 3] {
    let outside = frame_unit_cube(37.0, 22.0, width, height);
    let mut inside = frame_unit_cube(-64.0, 11.0, width, height);
    inside.eye = DVec3::new(0.47, 0.53, 0.41);
    inside.target = DVec3::new(0.9, 0.2, 0.7);
    inside.projection = Projection::Perspective { fov_degrees: 70.0 };
    let mut parallel = frame_unit_cube(161.0, -33.0, width, height);
    parallel.projection = Projection::Orthographic { height_world: 1.75 };
    [("outside", outside), ("inside", inside), ("parallel", parallel)]
}

/// The length of the ray of pixel (x, y) in the unit cube grown by `grown` on every side, behind the eye excluded.
pub(crate) fn chord_of_unit_cube(camera: &Camera, x: u32, y: u32, grown: f64) -> f64 {
    chord_of_box(camera, x, y, DVec3::splat(-grown), DVec3::splat(1.0 + grown))
}

/// The length of the ray of pixel (x, y) in a box, behind the eye excluded.
pub(crate) fn chord_of_box(camera: &Camera, x: u32, y: u32, low: DVec3, high: DVec3) -> f64 {
    let ray = camera.frame().unwrap().ray(f64::from(x), f64::from(y));
    let (mut enter, mut leave) = (camera.near.unwrap_or(0.0), camera.far.unwrap_or(f64::INFINITY));
    for axis in 0..3 {
        let (from, step) = (ray.origin[axis], ray.direction[axis]);
        if step == 0.0 {
            if from < low[axis] || from > high[axis] {
                return 0.0;
            }
            continue;
        }
        let (a, b) = ((low[axis] - from) / step, (high[axis] - from) / step);
        (enter, leave) = (enter.max(a.min(b)), leave.min(a.max(b)));
    }
    (leave - enter).max(0.0) * ray.direction.length()
}
