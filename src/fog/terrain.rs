//! `Terrain`: ground and fog over a square of the world.

use glam::{DVec2, DVec3};

use rayon::prelude::*;

use super::detail::Importance;
use super::{Detail, HeightMap, Landscape, Profile};
use crate::error::{Error, Result};
use crate::generate::noise::smoothstep;

/// Ground and the fog on it, over the square from (0, 0) to (`side_world`, `side_world`); +z is up.
///
/// ```
/// use cellfan::fog::{Detail, HeightMap, Profile, Terrain};
/// let ground = HeightMap::sample(33, |at| at.x)?;
/// let fog = HeightMap::sample(33, |at| (1.0 - at.x) * 0.5)?;
/// let terrain = Terrain::new(&ground, &fog, 10.0, [1.0, 0.2])?;
/// let full = terrain.landscape(&Detail::Full, Profile::Emission);
/// assert_eq!(full.triangles.len(), 2 * 32 * 32);
/// // Seen from afar a slope is two triangles.
/// let far = Detail::Tolerance { eye: [5.0, 5.0, 500.0].into(), px_per_unit: 500.0, tolerance_px: 1.0 };
/// assert_eq!(terrain.landscape(&far, Profile::Emission).triangles.len(), 2);
/// # Ok::<(), cellfan::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Terrain {
    side: usize,
    side_world: f64,
    /// Heights of the ground, in world units.
    ground: Vec<f32>,
    /// How thick the fog is on it.
    fog: Vec<f32>,
    thickest: f32,
    /// Linear RGB of the ground in the light of the sun.
    colors: Vec<[f32; 3]>,
    importance: Importance,
}

/// What is known at a point: ground, thickness of the fog, colour of the ground.
pub(super) type Values = [f64; 5];

impl Terrain {
    /// Maps of heights from 0 to 1, which are `scales_world` high: of the ground, of the fog on it. The fog's map takes the ground's
    /// points.
    ///
    /// # Errors
    /// [`Error::Option`] where a size is not positive or there is no fog anywhere; [`Error::OutOfMemory`].
    pub fn new(ground: &HeightMap, fog: &HeightMap, side_world: f64, scales_world: [f64; 2]) -> Result<Self> {
        for (option, size) in [("--side", side_world), ("--relief", scales_world[0]), ("--fog-height", scales_world[1])]
        {
            if !(size.is_finite() && size > 0.0) {
                return Err(Error::Option { option, problem: format!("{size} is not a length above 0") });
            }
        }
        let side = ground.side();
        let fog = fog.resampled(side)?;
        let scaled = |map: &HeightMap, scale: f64| -> Vec<f32> {
            map.heights().iter().map(|&height| (f64::from(height) * scale) as f32).collect()
        };
        let (ground, fog) = (scaled(ground, scales_world[0]), scaled(&fog, scales_world[1]));
        let thickest = fog.iter().fold(0.0_f32, |most, &thick| most.max(thick));
        if !(thickest > 0.0 && fog.iter().all(|&thick| thick >= 0.0)) {
            let problem = "the fog is nowhere thicker than 0; give a map with some light pixels".to_owned();
            return Err(Error::Option { option: "--fog-map", problem });
        }
        let top: Vec<f32> = ground.iter().zip(&fog).map(|(ground, fog)| ground + fog).collect();
        let spacing = side_world / (side - 1) as f64;
        let position =
            |i: usize| DVec3::new((i % side) as f64 * spacing, (i / side) as f64 * spacing, f64::from(ground[i]));
        let importance = Importance::new(side, position, &[&ground, &top]);
        let colors = colors(side, spacing, scales_world[0], &ground);
        Ok(Self { side, side_world, ground, fog, thickest, colors, importance })
    }

    /// Points a side.
    pub fn side(&self) -> usize {
        self.side
    }

    /// The side of the square.
    pub fn side_world(&self) -> f64 {
        self.side_world
    }

    /// The thickest fog.
    pub fn thickest_world(&self) -> f32 {
        self.thickest
    }

    /// What is known at point (x, y) of the grid.
    #[inline]
    pub(super) fn values(&self, [x, y]: [usize; 2]) -> Values {
        let i = x + self.side * y;
        let [r, g, b] = self.colors[i].map(f64::from);
        [self.ground[i].into(), self.fog[i].into(), r, g, b]
    }

    /// Where point (x, y) of the grid is, on the ground.
    #[inline]
    pub(super) fn position(&self, at: [usize; 2]) -> DVec3 {
        let spacing = self.side_world / (self.side - 1) as f64;
        DVec3::new(at[0] as f64 * spacing, at[1] as f64 * spacing, self.values(at)[0])
    }

    pub(super) fn importance(&self) -> &Importance {
        &self.importance
    }

    /// Ground and thickness of the fog at a place of the world, bilinear between points.
    pub fn heights_at(&self, x: f64, y: f64) -> [f64; 2] {
        let cells = self.side - 1;
        let scaled = (DVec2::new(x, y) / self.side_world).clamp(DVec2::ZERO, DVec2::ONE) * cells as f64;
        let [i, j] = [(scaled.x as usize).min(cells - 1), (scaled.y as usize).min(cells - 1)];
        let [tx, ty] = [scaled.x - i as f64, scaled.y - j as f64];
        std::array::from_fn(|k| {
            let of = |i, j| self.values([i, j])[k];
            (of(i, j) * (1.0 - tx) + of(i + 1, j) * tx) * (1.0 - ty)
                + (of(i, j + 1) * (1.0 - tx) + of(i + 1, j + 1) * tx) * ty
        })
    }

    /// The triangles and prisms that a view needs.
    pub fn landscape(&self, detail: &Detail, profile: Profile) -> Landscape {
        Landscape::new(self, detail, profile)
    }
}

/// Where the sun stands.
const SUN: DVec3 = DVec3::new(-0.5, 0.35, 0.6);

/// What meadows, rock and snow reflect, linear RGB.
const ALBEDOS: [[f64; 3]; 3] = [[0.10, 0.16, 0.05], [0.22, 0.19, 0.16], [0.75, 0.78, 0.82]];

/// Ground in the sun: meadows below, rock where it is steep, snow above.
fn colors(side: usize, spacing: f64, relief: f64, ground: &[f32]) -> Vec<[f32; 3]> {
    let sun = SUN.normalize();
    let height = |x: usize, y: usize| f64::from(ground[x + side * y]);
    let slope = |from: f64, to: f64, steps: usize| (to - from) / (spacing * steps as f64);
    let color = |i: usize| {
        let [x, y] = [i % side, i / side];
        let ends = |c: usize| [c.saturating_sub(1), (c + 1).min(side - 1)];
        let ([west, east], [south, north]) = (ends(x), ends(y));
        let along_x = slope(height(west, y), height(east, y), east - west);
        let along_y = slope(height(x, south), height(x, north), north - south);
        let normal = DVec3::new(-along_x, -along_y, 1.0).normalize();
        let rock = 1.0 - smoothstep(0.75, 0.92, normal.z);
        let snow = smoothstep(0.55, 0.7, f64::from(ground[i]) / relief) * (1.0 - 0.6 * rock);
        let [meadow, stone, white] = ALBEDOS.map(DVec3::from);
        let albedo = meadow.lerp(stone, rock).lerp(white, snow);
        (albedo * (0.3 + 1.1 * normal.dot(sun).max(0.0))).as_vec3().to_array()
    };
    (0..side * side).into_par_iter().map(color).collect()
}
