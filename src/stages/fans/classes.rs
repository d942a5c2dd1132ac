//! The fan of a classified tetrahedron: its thick vertex and the ring around it (CellFast, figure 3).

use glam::Vec2;

use super::{Fan, RingVertex};
use crate::stages::classify::{Classified, ProjectionClass};

/// A projected vertex with what is interpolated over the picture.
#[derive(Clone, Copy, Debug)]
pub(super) struct Projected {
    pub(super) xy: Vec2,
    pub(super) v: f32,
    pub(super) q: f32,
}

impl Projected {
    /// The point of the segment to `other` at `t`; on the picture everything is affine.
    fn lerp(self, other: Self, t: f32) -> Self {
        Self {
            xy: self.xy + (other.xy - self.xy) * t,
            v: self.v + (other.v - self.v) * t,
            q: self.q + (other.q - self.q) * t,
        }
    }
}

fn thin(p: Projected) -> RingVertex {
    RingVertex { position_px: p.xy.to_array(), vq: [p.v, p.q] }
}

/// The thick vertex and its ring.
#[inline]
pub(super) fn fan(classified: Classified, projected: [Projected; 4], s_range: [f32; 2]) -> Fan {
    let Classified { class, roles, inner_is_front } = classified;
    let [a, b, c, d] = roles.map(|role| projected[role as usize]);
    let fan = |xy: Vec2, front: Projected, back: Projected, ring: [Projected; 4]| Fan {
        thick_px: xy.to_array(),
        s_range,
        front: [front.v, front.q],
        back: [back.v, back.q],
        ring: ring.map(thin),
    };
    let in_order = |inner: Projected, outer: Projected| if inner_is_front { (inner, outer) } else { (outer, inner) };
    match class {
        ProjectionClass::EdgeOn => Fan::default(),
        // a lies inside b c d: the other side of the cell there is a point of that face.
        ProjectionClass::Class1 => {
            let (q, r, s) = (c.xy - b.xy, d.xy - b.xy, a.xy - b.xy);
            let area = q.perp_dot(r);
            let (u, t) = (s.perp_dot(r) / area, q.perp_dot(s) / area);
            let face = Projected {
                xy: a.xy,
                v: b.v + (c.v - b.v) * u + (d.v - b.v) * t,
                q: b.q + (c.q - b.q) * u + (d.q - b.q) * t,
            };
            let (front, back) = in_order(a, face);
            fan(a.xy, front, back, [b, c, d, b])
        }
        // Front edge a b and back edge c d cross: a + t (b − a) = c + u (d − c), by Cramer.
        ProjectionClass::Class2 => {
            let (ab, cd, ac) = (b.xy - a.xy, d.xy - c.xy, c.xy - a.xy);
            let area = ab.perp_dot(cd);
            let (t, u) = (ac.perp_dot(cd) / area, ac.perp_dot(ab) / area);
            let (front, back) = (a.lerp(b, t), c.lerp(d, u));
            fan(front.xy, front, back, [a, c, b, d])
        }
        // a lies on edge b d.
        ProjectionClass::Class3 => {
            let bd = d.xy - b.xy;
            let t = (a.xy - b.xy).dot(bd) / bd.length_squared();
            let (front, back) = in_order(a, b.lerp(d, t));
            fan(a.xy, front, back, [b, c, d, a])
        }
        // a lies in front of b.
        ProjectionClass::Class4 => fan(a.xy, a, b, [c, d, a, a]),
    }
}
