//! Cells that reflect light: what of it they send to the eye, by the gradient of the scalar over each.
//!
//! In: a frame, [`Lighting`]. Out: the [`Reflection`] of a cell when a tile asks for it. A tetrahedron has one gradient; that of a cell with
//! faces of four corners is taken in its middle, where the corners' trilinear map from the unit cube has its mean Jacobian; that of a
//! cube is the octree's. Surface strength is the gradient over the range of values, per mean side of a cell.

use glam::{DMat3, DVec3, Mat3, Vec3};
use rayon::prelude::*;

use super::{CpuMethod, Renderer};
use crate::backends::{Counts, Frame};
use crate::error::{Error, Result};
use crate::image::Image;
use crate::optics::EmissionAbsorption;
use crate::optics::lighting::{Lamps, Lighting, Lit, Reflecting, Reflection};
use crate::profile::Profile;
use crate::stages::CubesInView;

impl Renderer {
    /// Lights cells (tetrahedra, and those with faces of four corners) and cubes in the frames that follow; by footprints on the CPU,
    /// with emission-absorption and the exact integral.
    pub fn set_lighting(&mut self, lighting: Option<Lighting>) {
        self.lighting = lighting;
    }

    /// Whether light can be drawn as it is asked for.
    pub(super) fn check_lighting(&self) -> Result<()> {
        let Some(lighting) = &self.lighting else { return Ok(()) };
        lighting.check_cells(self.options.model, self.options.integral)?;
        let refuse = |option, problem: &str| Err(Error::Option { option, problem: problem.to_owned() });
        #[cfg(feature = "gpu")]
        if self.gpu.is_some() {
            return refuse(
                "--backend gpu",
                "light is reflected on the CPU only; say --backend cpu, or leave --shade out",
            );
        }
        if self.options.cpu_method == CpuMethod::Fans {
            return refuse("--cpu-method", "fans are not lit; use footprints, or leave --shade out");
        }
        Ok(())
    }

    /// Draws light that is emitted and absorbed, and reflected where lights are set.
    pub(super) fn draw_light(
        &mut self,
        frame: &Frame,
        optics: EmissionAbsorption,
        profile: &mut Profile,
    ) -> Result<(Image, Counts)> {
        let Some(lighting) = self.lighting.clone() else { return self.draw_with(frame, &optics, profile) };
        let view = frame.view;
        let lamps = Lamps::new(&lighting, [view.forward, view.step_x, view.step_y]);
        let (low, high) = frame.field.range;
        let per_range = |side: f64| if high > low { (side / (high - low)) as f32 } else { 0.0 };
        if let Some(cubes) = &frame.cubes {
            let grid_from_scene: DMat3 = cubes.scene_from_grid().inverse().matrix3;
            let strength = lighting.has_strength.then(|| per_range(grid_from_scene.determinant().abs().recip().cbrt()));
            // The transpose: a gradient is a covector.
            let surfaces = CubeSurfaces {
                frame,
                cubes: *cubes,
                lamps,
                strength,
                scene_from_steps: grid_from_scene.transpose().as_mat3(),
            };
            return self.draw_with(frame, &Lit { optics, surfaces: &surfaces }, profile);
        }
        let refuse = |problem: &str| Err(Error::Option { option: "--shade", problem: problem.to_owned() });
        if frame.cell_values().is_some() {
            return refuse(
                "values of cells have no gradient in them; use values of points, or --method cubes on a regular grid",
            );
        }
        if !frame.dataset.polyhedra.is_empty() {
            return refuse("prisms and polyhedra are not lit; say --cells tetrahedra, or leave shading out");
        }
        let strength = lighting.has_strength.then(|| per_range(mean_side(frame)));
        let surfaces = CellSurfaces { frame, lamps, strength };
        self.draw_with(frame, &Lit { optics, surfaces: &surfaces }, profile)
    }
}

/// Towards the eye from a place, in scene units.
fn toward_eye(frame: &Frame, from: Vec3) -> Vec3 {
    let view = frame.view;
    let toward = if view.is_perspective { view.eye - from.as_dvec3() } else { -view.forward };
    toward.as_vec3().normalize_or_zero()
}

/// With the strength of the surface, where that counts.
fn reflection(lamps: &Lamps, gradient: Vec3, toward_eye: Vec3, strength: Option<f32>) -> Reflection {
    let reflection = lamps.reflection(gradient, toward_eye);
    let strength = strength.map_or(1.0, |per_gradient| gradient.length() * per_gradient);
    Reflection { strength: if strength.is_finite() { strength } else { 0.0 }, ..reflection }
}

/// The cells of a mesh.
struct CellSurfaces<'a> {
    frame: &'a Frame<'a>,
    lamps: Lamps,
    strength: Option<f32>,
}

impl Reflecting for CellSurfaces<'_> {
    fn of(&self, cell: usize) -> Reflection {
        let (tets, vertices) = (self.frame.dataset.tets.len(), self.frame.vertices);
        let at = |vertex: u32| (Vec3::from(vertices[vertex as usize].position), vertices[vertex as usize].scalar);
        let (gradient, center) = if cell < tets {
            gradient_of_tet(self.frame.dataset.tets.get(cell).map(at))
        } else {
            gradient_of_hexahedron(self.frame.dataset.hexahedra.view().get(cell - tets).map(at))
        };
        reflection(&self.lamps, gradient, toward_eye(self.frame, center), self.strength)
    }
}

/// The gradient that gives these changes of the value along these edges; none where they lie in a plane.
fn gradient(edges: [Vec3; 3], changes: [f32; 3]) -> Vec3 {
    // In double precision: edges of slivers are nearly in a plane.
    let matrix = DMat3::from_cols_array_2d(&edges.map(|edge| edge.as_dvec3().to_array())).transpose();
    let gradient = matrix.inverse() * DVec3::from(changes.map(f64::from));
    let gradient = gradient.as_vec3();
    if gradient.is_finite() { gradient } else { Vec3::ZERO }
}

/// The gradient of a tetrahedron, and its middle.
fn gradient_of_tet(corners: [(Vec3, f32); 4]) -> (Vec3, Vec3) {
    let [(first, value), ..] = corners;
    let [_, b, c, d] = corners;
    let of = gradient([b, c, d].map(|(p, _)| p - first), [b, c, d].map(|(_, s)| s - value));
    (of, corners.iter().map(|(p, _)| *p).sum::<Vec3>() / 4.0)
}

/// The gradient in the middle of a cell with eight corners, in VTK's order, and where that is.
fn gradient_of_hexahedron(corners: [(Vec3, f32); 8]) -> (Vec3, Vec3) {
    /// The corners at the upper end of each axis of the unit cube.
    const UPPER: [[usize; 4]; 3] = [[1, 2, 5, 6], [2, 3, 6, 7], [4, 5, 6, 7]];
    let sign = |axis: usize, corner: usize| if UPPER[axis].contains(&corner) { 0.25 } else { -0.25 };
    let edge = |axis| (0..8).map(|i| corners[i].0 * sign(axis, i)).sum::<Vec3>();
    let change = |axis| (0..8).map(|i| corners[i].1 * sign(axis, i)).sum::<f32>();
    let of = gradient([0, 1, 2].map(edge), [0, 1, 2].map(change));
    (of, corners.iter().map(|(p, _)| *p).sum::<Vec3>() / 8.0)
}

/// The cubic root of the cells' mean volume, in scene units.
fn mean_side(frame: &Frame) -> f64 {
    let dataset = frame.dataset;
    let at = |vertex: u32| Vec3::from(frame.vertices[vertex as usize].position);
    let of_tets = (0..dataset.tets.len()).into_par_iter().map(|cell| {
        let [a, b, c, d] = dataset.tets.get(cell).map(|vertex| at(vertex).as_dvec3());
        (b - a).cross(c - a).dot(d - a).abs() / 6.0
    });
    let hexahedra = dataset.hexahedra.view();
    let of_hexahedra = (0..hexahedra.len()).into_par_iter().map(|cell| {
        let shape = hexahedra.shape(cell);
        if shape.is_absent() { 0.0 } else { shape.volume(hexahedra.get(cell).map(at)) }
    });
    let volume = of_tets.sum::<f64>() + of_hexahedra.sum::<f64>();
    (volume / (dataset.cells() - dataset.hexahedra.absent()).max(1) as f64).cbrt()
}

/// The cubes of a volume.
struct CubeSurfaces<'a> {
    frame: &'a Frame<'a>,
    cubes: CubesInView<'a>,
    lamps: Lamps,
    strength: Option<f32>,
    /// From changes per step of the grid to changes per scene unit.
    scene_from_steps: Mat3,
}

impl Reflecting for CubeSurfaces<'_> {
    fn of(&self, number: usize) -> Reflection {
        let cube = &self.cubes.cubes[number];
        let [low, high] = self.cubes.ends(cube);
        let slope = self.cubes.slopes.map_or([0.0; 3], |slopes| slopes.of(cube));
        let gradient = self.scene_from_steps * Vec3::from(slope);
        let gradient = if gradient.is_finite() { gradient } else { Vec3::ZERO };
        let center = self.cubes.position(0.5 * (low + high));
        reflection(&self.lamps, gradient, toward_eye(self.frame, center), self.strength)
    }
}
