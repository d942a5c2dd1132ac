//! From positions to the picture, in f64, homogeneous: linear in position, so that lines are cut before anything is divided.

use glam::DVec3;

use crate::stages::View;

/// A position on its way to the picture: x·w and y·w in pixels and w, where w is the depth (parallel rays: 1); and the depth.
#[derive(Clone, Copy, Debug)]
pub(super) struct Projected {
    pub(super) xw: f64,
    pub(super) yw: f64,
    pub(super) w: f64,
    pub(super) depth: f64,
}

impl Projected {
    /// The point at share `t` of the way to `other`.
    pub(super) fn toward(self, other: Self, t: f64) -> Self {
        let mix = |a: f64, b: f64| a + (b - a) * t;
        Self {
            xw: mix(self.xw, other.xw),
            yw: mix(self.yw, other.yw),
            w: mix(self.w, other.w),
            depth: mix(self.depth, other.depth),
        }
    }

    /// The place in the picture, pixel centres at whole numbers.
    pub(super) fn xy(self) -> [f64; 2] {
        [self.xw / self.w, self.yw / self.w]
    }
}

/// The map of one view.
#[derive(Clone, Copy, Debug)]
pub(super) struct Projector {
    pub(super) is_perspective: bool,
    pub(super) eye: DVec3,
    pub(super) forward: DVec3,
    pub(super) corner: DVec3,
    pub(super) step_x: DVec3,
    pub(super) step_y: DVec3,
    to_x: DVec3,
    to_y: DVec3,
    center: [f64; 2],
    pub(super) size_px: [u32; 2],
    pub(super) near: f64,
    /// Inverse depths of the far and the near plane.
    pub(super) v_range: [f64; 2],
}

impl Projector {
    pub(super) fn new(view: &View) -> Self {
        let scale = |step: DVec3| step / step.length_squared();
        let (to_x, to_y) = (scale(view.step_x), scale(view.step_y));
        let (v_far, v_near) = view.inverse_depth_range();
        Self {
            is_perspective: view.is_perspective,
            eye: view.eye,
            forward: view.forward,
            corner: view.corner,
            step_x: view.step_x,
            step_y: view.step_y,
            to_x,
            to_y,
            center: [-view.corner.dot(to_x), -view.corner.dot(to_y)],
            size_px: view.size_px,
            near: view.near.into(),
            v_range: [v_far.into(), v_near.into()],
        }
    }

    pub(super) fn project(&self, position: [f32; 3]) -> Projected {
        let p = DVec3::from_array(position.map(f64::from)) - self.eye;
        let depth = p.dot(self.forward);
        let w = if self.is_perspective { depth } else { 1.0 };
        let [x, y] = self.center;
        Projected { xw: p.dot(self.to_x) + x * w, yw: p.dot(self.to_y) + y * w, w, depth }
    }

    /// Inverse depth of `depth`.
    pub(super) fn inverse(&self, depth: f64) -> f64 {
        if self.is_perspective { 1.0 / depth } else { -depth }
    }

    /// Whether an inverse depth lies between the near and the far plane.
    pub(super) fn shows(&self, v: f64) -> bool {
        (self.v_range[0]..=self.v_range[1]).contains(&v)
    }

    /// The part of the line a–b that lies behind the near plane and not farther than `margin` pixels outside the picture; none where there
    /// is no such part.
    pub(super) fn clip(&self, a: Projected, b: Projected, margin: f64) -> Option<[Projected; 2]> {
        let [width, height] = self.size_px.map(f64::from);
        let (mut start, mut end) = (0.0_f64, 1.0_f64);
        let sides = |p: Projected| {
            let near = p.depth - self.near;
            let (x, y) = (p.xw + margin * p.w, p.yw + margin * p.w);
            [near, x, (width + 2.0 * margin) * p.w - x, y, (height + 2.0 * margin) * p.w - y]
        };
        for (from, to) in sides(a).into_iter().zip(sides(b)) {
            if from < 0.0 && to < 0.0 {
                return None;
            }
            if from < 0.0 {
                start = start.max(from / (from - to));
            } else if to < 0.0 {
                end = end.min(from / (from - to));
            }
        }
        (start <= end).then(|| [a.toward(b, start), a.toward(b, end)])
    }
}
