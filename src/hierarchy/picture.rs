//! A rule that bounds the error of the picture, not of the samples.
//!
//! Light I runs along a ray with dI = κ (c − I) dt, I between 0 and C (the brightest colour, at least 1). With a node's samples
//! replaced by their mean, κ' and c' in it, the difference D of both lights obeys
//! dD = [κ' (c' − I) − κ (c − I)] dt − κ' D dt, and what is in brackets is at most g = C max |κ − κ'| + κ' max |c − c'| over the values
//! in the node. So |D| at the eye is at most ∫ g T' dt, T' being the transmittance from there to the eye. Where
//! g ≤ ½ E (1/L + κ'), L the longest way of a ray of this view through the volume, that is at most
//! ½ E (∫ T'/L dt + ∫ κ' T' dt) ≤ E. The first half lets thin fog be coarse, the second what is dense: it hides itself.
//! Opacity is light of colour 1; emission has κ' = 0 in the last term; an absorption picture is e^-τ, whose error is at most τ's.
//! Of maximum intensity, the largest mean and the largest sample of a ray share a node, or one lies between the other's: g = max
//! |c − c'| ≤ E/2 will do.

use glam::DVec3;

use super::level::Node;
use super::select::Accept;
use crate::camera::Frame;
use crate::columns::CubeGrid;
use crate::optics::{LinearPiece, Model, Pieces};

/// Nodes by whose means no channel of a pixel changes by more than a bound, if all nodes of a picture are such.
///
/// It is the bound of exact integrals; colours above 1 count as what they are.
#[derive(Clone, Copy, Debug)]
pub struct WithinPicture<'a> {
    pieces: &'a Pieces,
    model: Model,
    error: f32,
    per_length: f32,
    brightest: f32,
}

impl<'a> WithinPicture<'a> {
    /// Bounds the error of each channel by `error`; `longest_world` is the longest way of a ray through the volume.
    pub fn new(pieces: &'a Pieces, model: Model, error: f64, longest_world: f64) -> Self {
        let ends = pieces.as_slice().iter().enumerate().flat_map(|(k, piece)| {
            let ends = [pieces.start_of(k), pieces.end_of(k)].into_iter().filter(|end| end.is_finite());
            ends.flat_map(|end| piece.color_at(end)).chain(piece.color)
        });
        let brightest = ends.fold(1.0, f32::max);
        // Rounded towards the safe side.
        let per_length = (longest_world.recip() * (1.0 - 1e-6)) as f32;
        Self { pieces, model, error: error as f32, per_length, brightest }
    }

    /// Extinction and colour of a value.
    #[inline]
    fn at(&self, s: f32) -> (f32, [f32; 3]) {
        let piece = self.pieces.piece(self.pieces.piece_of(s));
        (piece.extinction_at(s).max(0.0), piece.color_at(s))
    }

    /// The largest differences of extinction and colour of values from `low` to `high` from given ones: on each piece at an end.
    #[inline]
    fn largest_differences(&self, [low, high]: [f32; 2], (extinction, color): (f32, [f32; 3])) -> [f32; 2] {
        let mut largest = [0.0_f32; 2];
        for k in self.pieces.piece_of(low)..=self.pieces.piece_of(high) {
            let piece = self.pieces.piece(k);
            for s in [low.max(self.pieces.start_of(k)), high.min(self.pieces.end_of(k))] {
                let of_color = piece.color_at(s);
                let by_channel = (0..3).map(|c| (of_color[c] - color[c]).abs()).fold(0.0, f32::max);
                largest =
                    [largest[0].max((piece.extinction_at(s).max(0.0) - extinction).abs()), largest[1].max(by_channel)];
            }
        }
        largest
    }
}

impl Accept for WithinPicture<'_> {
    fn accepts(&self, node: &Node) -> bool {
        if node.mean.is_nan() {
            return false;
        }
        let (extinction, color) = self.at(node.mean);
        let [of_extinction, of_color] = self.largest_differences([node.min, node.max], (extinction, color));
        if self.model == Model::Mip {
            return of_color <= 0.5 * self.error;
        }
        let is_dimmed = self.model == Model::EmissionAbsorption;
        let weight = 0.5 * self.error * (self.per_length + if is_dimmed { extinction } else { 0.0 });
        self.brightest * of_extinction + extinction * of_color <= weight
    }
}

/// The longest way, in world units, that a ray of this view can have through the cubes of `grid`; at most their diagonal.
///
/// A ray is between the planes at both ends of an axis for their distance over the cosine of the angle between them. The smallest
/// cosine of all rays of the picture is at one of its corners, if they all cross the planes the same way.
pub fn longest_chord_world(grid: &CubeGrid, frame: &Frame) -> f64 {
    let corners = grid.corners_world();
    let farthest = |from: DVec3| corners.iter().map(|corner| corner.distance(from)).fold(0.0, f64::max);
    let diagonal = corners.iter().map(|&corner| farthest(corner)).fold(0.0, f64::max);
    let [width, height] = frame.size_px.map(f64::from);
    let of_picture = [(0.0, 0.0), (width, 0.0), (0.0, height), (width, height)];
    let directions = of_picture.map(|(x, y)| frame.ray(x - 0.5, y - 0.5).direction.normalize());
    let to_grid = grid.lattice.grid_from_world().matrix3;
    let along = |axis: usize| {
        let steps = directions.map(|direction| (to_grid * direction)[axis]);
        let is_one_way = steps.iter().all(|&step| step > 0.0) || steps.iter().all(|&step| step < 0.0);
        let least = steps.iter().map(|step| step.abs()).fold(f64::INFINITY, f64::min);
        if is_one_way { f64::from(grid.dims[axis]) / least } else { f64::INFINITY }
    };
    (0..3).map(along).fold(diagonal, f64::min)
}
