//! `classify` for hexahedra, voxels, wedges and pyramids: how a cell's projection is divided into triangles.
//!
//! In: the projected corners of a cell, and whether it is positively oriented. Out: [`Projection`]: a [`Case`], the
//! renumbering that brings the cell to the case's standard numbering, and which side is the front; or that the cell is to
//! be drawn as tetrahedra.
//! To add a kind: its representatives in `cases.rs`, found by the test that lists all there can be, and its line in
//! `table.rs`.
//!
//! Source: Max 2006, section 2. The paper looks for faces that contain corners; here the same cases are told by which faces
//! run counterclockwise on the picture and, for at most two inner corners, on which side of the inner edges opposite they
//! lie. All signs are exact for the coordinates given (Shewchuk 1997), so that they never contradict each other.

mod cases;
mod overlay;
mod renumber;
mod sides;
mod table;

use arrayvec::ArrayVec;
use glam::{DVec2, Vec2};

pub use cases::{Case, Inner};
pub use overlay::Crossing;
pub use renumber::Renumbering;
pub use table::Projections;

use table::Entry;

use crate::cells::CellKind;

/// The corners of each face, counterclockwise seen from outside.
type Faces = &'static [&'static [u8]];

/// What a cell looks like on the picture.
#[derive(Clone, Copy, Debug)]
pub enum Projection {
    /// One of the cases.
    Whole(Placed),
    /// No face has an area: the cell is seen edge-on and covers nothing.
    EdgeOn,
    /// A face is concave or crosses itself on the picture, so that a ray may meet the cell twice: to be drawn as
    /// tetrahedra.
    Split,
}

/// A cell in the standard numbering of its case.
#[derive(Clone, Copy, Debug)]
pub struct Placed {
    /// The cell's kind.
    pub kind: &'static CellKind,
    /// The case.
    pub case: &'static Case,
    /// Which of the cell's corners and faces are the standard ones.
    pub renumbering: &'static Renumbering,
    /// Whether the case's lid is in front of its bowl.
    pub lid_is_front: bool,
}

/// How a face runs on the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Turn {
    Clockwise,
    Counterclockwise,
    /// It has no area.
    EdgeOn,
    /// Concave, or crossing itself.
    Bad,
}

impl Projections {
    /// Classifies a cell by its projected corners, all of which lie before the eye.
    ///
    /// A face without an area goes to the side where no triangle is turned over, a corner on an edge opposite to either face
    /// there: what is drawn is the same.
    ///
    /// # Panics
    /// If there are fewer corners than the kind has.
    ///
    /// ```
    /// # use cellfan::{cells::VOXEL, stages::classify::polyhedra::{Projection, Projections}};
    /// // Seen from above, the lower face of a frustum contains the upper one.
    /// let corner = |i: usize| glam::Vec2::new((i & 1) as f32, (i >> 1 & 1) as f32) - 0.5;
    /// let xy: [_; 8] = std::array::from_fn(|i| if i < 4 { 3.0 * corner(i) } else { corner(i) });
    /// let Some(Projection::Whole(placed)) = Projections::of(&VOXEL).map(|table| table.classify(&xy, true)) else { panic!() };
    /// assert_eq!((placed.case.name, placed.case.triangles.len()), ("count4", 10));
    /// ```
    #[inline]
    pub fn classify(&'static self, xy: &[Vec2], is_positive: bool) -> Projection {
        let xy = &xy[..self.kind.corners];
        let (mut counterclockwise, mut edge_on) = (0_u8, 0_u8);
        for (face, corners) in self.kind.faces.iter().enumerate() {
            match turn(xy, corners) {
                Turn::Counterclockwise => counterclockwise |= 1 << face,
                Turn::EdgeOn => edge_on |= 1 << face,
                Turn::Clockwise => {}
                Turn::Bad => return Projection::Split,
            }
        }
        if counterclockwise == 0 {
            return Projection::EdgeOn;
        }
        let entry = match edge_on {
            0 => self.entry(xy, counterclockwise),
            _ => self.entry_with_edge_on(xy, counterclockwise, edge_on),
        };
        let Some(entry) = entry else { return Projection::Split };
        Projection::Whole(Placed {
            kind: self.kind,
            case: &self.cases()[entry.case],
            renumbering: &entry.renumbering,
            // A face that is counterclockwise seen from outside is so on the picture where it is in front.
            lid_is_front: entry.lid_is_counterclockwise == is_positive,
        })
    }

    /// The entry of a cell whose faces with set bits run counterclockwise.
    #[inline]
    fn entry(&self, xy: &[Vec2], counterclockwise: u8) -> Option<&Entry> {
        let pattern = self.pattern(counterclockwise)?;
        let mut places = [0; 2];
        for (place, seeker) in places.iter_mut().zip(&pattern.seekers) {
            let at = |corner: u8| xy[usize::from(corner)];
            let is_inside = |[a, b]: &[u8; 2]| orientation(at(*a), at(*b), at(seeker.corner)) >= 0.0;
            let last = seeker.candidates.len() - 1;
            let found = seeker.candidates[..last].iter().position(|candidate| candidate.edges.iter().all(is_inside));
            *place = found.unwrap_or(last);
        }
        pattern.entry(places)
    }

    /// The same for a cell with faces that have no area: they go to that side where the triangles lie flat.
    #[cold]
    fn entry_with_edge_on(&self, xy: &[Vec2], counterclockwise: u8, edge_on: u8) -> Option<&Entry> {
        let next = |some: &u8| Some(some.wrapping_sub(edge_on) & edge_on).filter(|&some| some != 0);
        let mut subsets = std::iter::successors(Some(0), next);
        subsets.find_map(|some| self.entry(xy, counterclockwise | some).filter(|entry| self.lies_flat(xy, entry)))
    }

    /// Whether no triangle of the entry is turned over.
    fn lies_flat(&self, xy: &[Vec2], entry: &Entry) -> bool {
        let Case { inner, crossings, triangles, .. } = &self.cases()[entry.case];
        let standard = entry.renumbering.corner_from_standard.iter().take(inner.len());
        let mut p: ArrayVec<DVec2, { Case::VERTICES_MAX }> =
            standard.map(|&corner| xy[usize::from(corner)].as_dvec2()).collect();
        for Crossing { lid, bowl } in crossings {
            let [lid, bowl] = [lid, bowl].map(|edge| edge.map(|corner| p[usize::from(corner)]));
            p.push(lid[0].lerp(lid[1], share_to_crossing(lid, bowl)));
        }
        let area = |triangle: &[u8; 3]| {
            let [a, b, c] = triangle.map(|vertex| p[usize::from(vertex)]);
            (b - a).perp_dot(c - a)
        };
        // They run as the lid does. A crossing is rounded to some 10⁻¹⁵ of the cell's extent.
        let run = if entry.lid_is_counterclockwise { -1.0 } else { 1.0 };
        let least = triangles.iter().map(|of| run * area(of)).fold(0.0, f64::min);
        least >= -1e-12 * triangles.iter().map(|of| area(of).abs()).sum::<f64>()
    }
}

/// How far along an edge it crosses another, from 0 at its first end to 1.
///
/// The ends a, b lie on different sides of c d, at distances as the areas of c d a and c d b, so the share
/// A(c d a) / (A(c d a) − A(c d b)) subtracts nothing that is alike. Edges on one line cross in the middle of what they have
/// in common.
#[inline]
pub fn share_to_crossing([a, b]: [DVec2; 2], [c, d]: [DVec2; 2]) -> f64 {
    let [of_a, of_b] = [a, b].map(|end| (d - c).perp_dot(end - c));
    if of_a == 0.0 && of_b == 0.0 {
        let share = |p: DVec2| ((p - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
        return if a == b { 0.0 } else { 0.5 * (share(c) + share(d)) };
    }
    (of_a / (of_a - of_b)).clamp(0.0, 1.0)
}

/// Twice the area of the triangle a b c with its sign, which is exact: positive where it runs clockwise on the picture, whose
/// rows run down.
#[inline]
fn orientation(a: Vec2, b: Vec2, c: Vec2) -> f64 {
    let [a, b, c] = [a, b, c].map(|p| robust::Coord { x: f64::from(p.x), y: f64::from(p.y) });
    robust::orient2d(a, b, c)
}

/// How a face runs on the picture.
#[inline]
fn turn(xy: &[Vec2], face: &[u8]) -> Turn {
    let at = |corner: u8| xy[usize::from(corner)];
    match *face {
        [a, b, c] => match orientation(at(a), at(b), at(c)) {
            area if area > 0.0 => Turn::Clockwise,
            area if area < 0.0 => Turn::Counterclockwise,
            _ => Turn::EdgeOn,
        },
        [a, b, c, d] => turn_of_quadrilateral([at(a), at(b), at(c), at(d)]),
        _ => Turn::Bad,
    }
}

/// A quadrilateral is convex if it turns the same way at all its corners.
#[inline]
fn turn_of_quadrilateral(corners: [Vec2; 4]) -> Turn {
    let p = corners.map(Vec2::as_dvec2);
    let sides: [DVec2; 4] = std::array::from_fn(|i| p[(i + 1) % 4] - p[i]);
    let turns: [f64; 4] = std::array::from_fn(|i| sides[i].perp_dot(sides[(i + 1) % 4]));
    let (least, most) = turns.into_iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), t| (a.min(t), b.max(t)));
    let longest = sides.into_iter().map(|side| side.abs().max_element()).fold(0.0, f64::max);
    // Each product of two rounded differences is off by 3·2⁻⁵³ of itself, their difference by one more: 8·2⁻⁵³ in all.
    let uncertain = 1e-15 * longest * longest;
    if least > uncertain {
        Turn::Clockwise
    } else if most < -uncertain {
        Turn::Counterclockwise
    } else if least < -uncertain && most > uncertain {
        Turn::Bad
    } else {
        exact_turn_of_quadrilateral(corners)
    }
}

/// The same where the sign of some turn is not certain.
#[cold]
fn exact_turn_of_quadrilateral(corners: [Vec2; 4]) -> Turn {
    let turns: [f64; 4] = std::array::from_fn(|i| orientation(corners[i], corners[(i + 1) % 4], corners[(i + 2) % 4]));
    match (turns.iter().any(|&turn| turn > 0.0), turns.iter().any(|&turn| turn < 0.0)) {
        (true, true) => Turn::Bad,
        (true, false) => Turn::Clockwise,
        (false, true) => Turn::Counterclockwise,
        (false, false) if runs_back_and_forth(corners) => Turn::Bad,
        (false, false) => Turn::EdgeOn,
    }
}

/// Whether a quadrilateral on a line turns round four times, which no convex one does that is turned edge-on.
fn runs_back_and_forth(corners: [Vec2; 4]) -> bool {
    let [a, b, c, d] = corners;
    let extent = corners.iter().fold(Vec2::ZERO, |most, &p| most.max((p - a).abs()));
    let along = |p: Vec2| if extent.x > extent.y { p.x } else { p.y };
    let [a, b, c, d] = [a, b, c, d].map(along);
    a.max(c) < b.min(d) || b.max(d) < a.min(c)
}

#[cfg(test)]
mod tests;
