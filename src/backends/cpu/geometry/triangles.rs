//! Triangles: covered by their edges, as near as their plane, lit from the eye.

use arrayvec::ArrayVec;
use glam::{DVec2, DVec3};

use super::looks::CornerLooks;
use super::project::{Projected, Projector};
use super::{Band, Drawer, SETBACK};
use crate::geometry::{SurfaceFaces, headlight};

/// A triangle cut at the near plane has one corner more.
type Polygon = ArrayVec<Projected, 4>;

/// What of a triangle lies behind the near plane; along parallel rays fragments are looked at instead.
fn polygon(projector: &Projector, corners: [Projected; 3]) -> Polygon {
    let is_behind = |p: &Projected| !projector.is_perspective || p.depth >= projector.near;
    let mut polygon = Polygon::new();
    for i in 0..3 {
        let (a, b) = (corners[i], corners[(i + 1) % 3]);
        if is_behind(&a) {
            polygon.push(a);
        }
        if is_behind(&a) != is_behind(&b) {
            // From the same end whichever way the edge runs: neighbours agree.
            let (in_front, behind) = if is_behind(&a) { (b, a) } else { (a, b) };
            let t = (projector.near - in_front.depth) / (behind.depth - in_front.depth);
            let on_plane = in_front.toward(behind, t);
            // Four corners are the most, whatever rounding says.
            let _ = polygon.try_push(on_plane);
        }
    }
    polygon
}

/// Lowest and highest position of a triangle along y.
pub(super) fn rows(projector: &Projector, corners: [[f32; 3]; 3]) -> Option<[f64; 2]> {
    let polygon = polygon(projector, corners.map(|corner| projector.project(corner)));
    let rows = polygon.iter().map(|p| p.xy()[1]);
    rows.fold(None, |range, y| Some(range.map_or([y, y], |[low, high]: [f64; 2]| [low.min(y), high.max(y)])))
}

/// The plane of a triangle as one view sees it.
struct Plane {
    /// Inverse depth at pixel (0, 0), per column, per row.
    v: [f64; 3],
    /// Smallest and largest of the triangle.
    range: [f64; 2],
    /// Unit normal, counterclockwise outwards.
    normal: DVec3,
    /// Whether it faces away from the eye.
    is_back: bool,
}

impl Plane {
    /// None of a triangle without area, or seen edge-on: it covers nothing.
    fn new(projector: &Projector, corners: [[f32; 3]; 3], projected: [Projected; 3]) -> Option<Self> {
        let [a, b, c] = corners.map(|corner| DVec3::from_array(corner.map(f64::from)));
        let normal = (b - a).cross(c - a).normalize_or_zero();
        let Projector { eye, forward, corner, step_x, step_y, .. } = *projector;
        // Perspective: 1/w = n·d / n·(a − e). Parallel rays: −w = n·(o − a) / n·f.
        let (height, first) = if projector.is_perspective {
            (normal.dot(a - eye), normal.dot(forward + corner))
        } else {
            (normal.dot(forward), normal.dot(eye + corner - a))
        };
        if height == 0.0 || !height.is_finite() {
            return None;
        }
        let v = [first, normal.dot(step_x), normal.dot(step_y)].map(|term| term / height);
        let depths = projected.map(|p| p.depth);
        let mut range = [f64::INFINITY, f64::NEG_INFINITY];
        for &depth in depths.iter().filter(|&&depth| !projector.is_perspective || depth >= projector.near) {
            let at_corner = projector.inverse(depth);
            range = [range[0].min(at_corner), range[1].max(at_corner)];
        }
        if projector.is_perspective && depths.iter().any(|&depth| depth < projector.near) {
            range[1] = projector.v_range[1];
        }
        Some(Self { v, range, normal, is_back: height > 0.0 })
    }
}

/// Draws a triangle into the rows of a band, in the colours of its corners or of the layer.
pub(super) fn draw(drawer: &Drawer, corners: [[f32; 3]; 3], looks: Option<&CornerLooks>, band: &mut Band) {
    let projector = drawer.projector;
    let projected = corners.map(|corner| projector.project(corner));
    let polygon = polygon(projector, projected);
    let Some(plane) = Plane::new(projector, corners, projected) else { return };
    if drawer.layer.faces == SurfaceFaces::Back && !plane.is_back {
        return;
    }
    let at: ArrayVec<DVec2, 4> = polygon.iter().map(|p| DVec2::from_array(p.xy())).collect();
    for i in 2..at.len() {
        fill([at[0], at[i - 1], at[i]], drawer, (&plane, looks), band);
    }
}

/// Draws the pixels whose centres a triangle of the picture covers; a centre on an edge belongs to the triangle below it or to the right.
fn fill(p: [DVec2; 3], drawer: &Drawer, (plane, looks): (&Plane, Option<&CornerLooks>), band: &mut Band) {
    let area = (p[1] - p[0]).perp_dot(p[2] - p[0]);
    if area == 0.0 || !area.is_finite() {
        return;
    }
    let p = if area > 0.0 { p } else { [p[0], p[2], p[1]] };
    let low = p[0].min(p[1]).min(p[2]);
    let high = p[0].max(p[1]).max(p[2]);
    let [columns, rows] = band.pixels_in(low.to_array(), high.to_array());
    let Projector { is_perspective, eye, forward, corner, step_x, step_y, .. } = *drawer.projector;
    let [v0, v_x, v_y] = plane.v;
    let slope = drawer.setback_px * (v_x.abs() + v_y.abs());
    for y in rows {
        for x in columns.clone() {
            let at = DVec2::new(x as f64, y as f64);
            let is_inside = (0..3).all(|i| {
                let (a, b) = (p[i], p[(i + 1) % 3]);
                let (edge, side) = (b - a, (b - a).perp_dot(at - a));
                side > 0.0 || (side == 0.0 && (edge.y < 0.0 || (edge.y == 0.0 && edge.x > 0.0)))
            });
            let v = (v0 + v_x * at.x + v_y * at.y).clamp(plane.range[0], plane.range[1]);
            if !is_inside || !drawer.projector.shows(v) {
                continue;
            }
            let setback = if drawer.setback_px > 0.0 {
                // No farther back than its farthest corner, and a little.
                let least = if is_perspective { v } else { 1.0 } * f64::from(SETBACK);
                (v - slope).max(plane.range[0]) - least
            } else {
                v
            };
            band.put([x, y], v as f32, setback as f32, || {
                let aside = corner + step_x * at.x + step_y * at.y;
                let ray = if is_perspective { (forward + aside).normalize_or_zero() } else { forward };
                let point = if is_perspective { eye + (forward + aside) / v } else { eye + aside - forward * v };
                let (color, normal) = looks.map_or((None, None), |looks| looks.at(point, plane.normal));
                let light = headlight(normal.unwrap_or(plane.normal).dot(ray) as f32);
                color.unwrap_or(drawer.layer.color).map(|channel| channel * light)
            });
        }
    }
}
