//! One triangle of a face against the rays of pixel centres, in f64.
//!
//! Symbols as in `footprints`: a ray is e + w·d(x, y), along parallel rays e + o(x, y) + w·f; a, b, c are the triangle's corners
//! relative to the eye e. It is met where d·(a×b), d·(b×c) and d·(c×a) have the sign of a·(b×c): also with corners behind the eye.
//! Both triangles at an edge compute its term from the same corners, and an edge run the other way has the same term with the other
//! sign, to the bit: a ray that passes the edge meets one of them.

use std::ops::Range;

use glam::DVec3;

use crate::stages::View;
use crate::stages::footprints::PixelBox;

/// An affine function of the picture position.
#[derive(Clone, Copy, Debug)]
struct Affine {
    c: f64,
    x: f64,
    y: f64,
}

impl Affine {
    /// `normal·d(x, y) + more`, or for parallel rays `normal·o(x, y) + more`.
    fn new(view: &View, normal: DVec3, more: f64) -> Self {
        let first = if view.is_perspective { view.forward + view.corner } else { view.corner };
        Self { c: normal.dot(first) + more, x: normal.dot(view.step_x), y: normal.dot(view.step_y) }
    }

    fn at(&self, x: f64, y: f64) -> f64 {
        self.c + self.x * x + self.y * y
    }

    /// Whether it is positive; where it is 0, a little to the right, or below.
    fn is_positive(&self, x: f64, y: f64) -> bool {
        let value = self.at(x, y);
        value > 0.0 || (value == 0.0 && (self.x > 0.0 || (self.x == 0.0 && self.y > 0.0)))
    }
}

/// A face in the picture.
#[derive(Clone, Copy, Debug)]
pub(super) struct Triangle {
    edges: [Affine; 3],
    /// The sign that each edge's term has inside.
    is_positive: [bool; 3],
    plane: Affine,
    /// The face's inverse depths where it is farthest and nearest; a plane seen all but edge-on is rounded beyond them.
    v_range: [f64; 2],
}

impl Triangle {
    /// The face with corners a, b, c relative to the eye, whose normal (b−a)×(c−a) runs along with rays or against them.
    pub(super) fn new(view: &View, [a, b, c]: [DVec3; 3], normal_is_along: bool) -> Self {
        let edge = |p: DVec3, q: DVec3| {
            if view.is_perspective {
                Affine::new(view, p.cross(q), 0.0)
            } else {
                // (p−o)×(q−o)·f, the twice projected area.
                Affine::new(view, (p - q).cross(view.forward), p.cross(q).dot(view.forward))
            }
        };
        let normal = (b - a).cross(c - a);
        let (across, more) =
            if view.is_perspective { (normal.dot(a), 0.0) } else { (normal.dot(view.forward), -normal.dot(a)) };
        let plane = Affine::new(view, normal, more);
        let plane = Affine { c: plane.c / across, x: plane.x / across, y: plane.y / across };
        let depths = [a, b, c].map(|p| p.dot(view.forward));
        let (nearest, farthest) =
            (depths.into_iter().fold(f64::MAX, f64::min), depths.into_iter().fold(f64::MIN, f64::max));
        let v_range = match (view.is_perspective, nearest > 0.0) {
            (false, _) => [-farthest, -nearest],
            (true, true) => [farthest.recip(), nearest.recip()],
            (true, false) => [farthest.recip(), f64::INFINITY],
        };
        // The last edge runs from a to c, against the way round.
        let is_positive = [normal_is_along, normal_is_along, !normal_is_along];
        Self { edges: [edge(a, b), edge(b, c), edge(a, c)], is_positive, plane, v_range }
    }

    /// Calls `met` with the column and the inverse depth of each pixel centre of a row that the face covers.
    pub(super) fn for_each_in_row(&self, y: usize, columns: Range<usize>, mut met: impl FnMut(usize, f64)) {
        let row = y as f64;
        for column in columns {
            let x = column as f64;
            let is_met =
                self.edges.iter().zip(self.is_positive).all(|(edge, wanted)| edge.is_positive(x, row) == wanted);
            if is_met {
                met(column, self.plane.at(x, row).max(self.v_range[0]).min(self.v_range[1]));
            }
        }
    }

    /// How many of the rays of `pixels` meet it beyond the near plane, at an inverse depth up to `v_near`.
    pub(super) fn count(&self, pixels: PixelBox, v_near: f64) -> u64 {
        let mut count = 0;
        for y in pixels.y0..pixels.y1 {
            let columns = pixels.x0.into()..pixels.x1.into();
            self.for_each_in_row(y.into(), columns, |_, v| count += u64::from(v <= v_near));
        }
        count
    }
}
