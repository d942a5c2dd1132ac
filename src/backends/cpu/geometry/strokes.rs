//! Lines and points: as wide in pixels wherever they are, flat in colour, as near as their middle.

use glam::DVec2;

use super::project::Projected;
use super::{Band, Drawer};

/// A line covers a centre this much farther away than half its width, in pixels: one that runs just between two rows must cover one.
pub(crate) const LINE_SLACK_PX: f32 = 1e-3;

fn half_px(drawer: &Drawer) -> f64 {
    0.5 * f64::from(drawer.layer.width_px) + f64::from(LINE_SLACK_PX)
}

/// The part of a line that may show.
fn clipped(drawer: &Drawer, ends: [[f32; 3]; 2]) -> Option<[Projected; 2]> {
    let [a, b] = ends.map(|end| drawer.projector.project(end));
    drawer.projector.clip(a, b, half_px(drawer) + 1.0)
}

/// Lowest and highest position of a line along y.
pub(super) fn rows_of_line(drawer: &Drawer, ends: [[f32; 3]; 2]) -> Option<[f64; 2]> {
    let [a, b] = clipped(drawer, ends)?.map(|end| end.xy()[1]);
    let half = half_px(drawer);
    Some([a.min(b) - half, a.max(b) + half])
}

/// Draws the pixels whose centres lie within half a width of the line, its ends round.
pub(super) fn draw_line(drawer: &Drawer, ends: [[f32; 3]; 2], band: &mut Band) {
    let Some(ends) = clipped(drawer, ends) else { return };
    let [a, b] = ends.map(|end| DVec2::from_array(end.xy()));
    let [v_a, v_b] = ends.map(|end| drawer.projector.inverse(end.depth));
    let (along, half) = (b - a, half_px(drawer));
    let per_length = along.length_squared();
    let [columns, rows] = band.pixels_in((a.min(b) - half).to_array(), (a.max(b) + half).to_array());
    for y in rows {
        // The columns within reach of this row's part of the line.
        let columns = columns_at(a, along, half, y as f64, &columns);
        for x in columns {
            let from_a = DVec2::new(x as f64, y as f64) - a;
            let t = if per_length > 0.0 { (from_a.dot(along) / per_length).clamp(0.0, 1.0) } else { 0.0 };
            let v = v_a + (v_b - v_a) * t;
            if (from_a - along * t).length_squared() <= half * half && drawer.projector.shows(v) {
                band.put([x, y], v as f32, v as f32, || drawer.layer.color);
            }
        }
    }
}

/// The columns of a row that a line may cover: a long one is looked at where it is, not in all of its box.
fn columns_at(a: DVec2, along: DVec2, half: f64, y: f64, columns: &std::ops::Range<usize>) -> std::ops::Range<usize> {
    if along.y == 0.0 {
        return columns.clone();
    }
    let at = |row: f64| a.x + along.x * ((row - a.y) / along.y).clamp(0.0, 1.0);
    let (one, other) = (at(y - half), at(y + half));
    let clamp = |x: f64| x.clamp(columns.start as f64, columns.end as f64) as usize;
    clamp((one.min(other) - half).floor())..clamp((one.max(other) + half).floor() + 1.0)
}

/// Lowest and highest position of a point along y.
pub(super) fn rows_of_point(drawer: &Drawer, position: [f32; 3]) -> Option<[f64; 2]> {
    let (_, [_, y]) = shown(drawer, position)?;
    let half = 0.5 * f64::from(drawer.layer.width_px);
    Some([y - half, y + half])
}

/// Inverse depth and place of a point that may show.
fn shown(drawer: &Drawer, position: [f32; 3]) -> Option<(f64, [f64; 2])> {
    let at = drawer.projector.project(position);
    let v = drawer.projector.inverse(at.depth);
    drawer.projector.shows(v).then(|| (v, at.xy()))
}

/// Draws the pixels whose centres lie in the square around a point, its left and upper side included: one of side 1 has just one.
pub(super) fn draw_point(drawer: &Drawer, position: [f32; 3], band: &mut Band) {
    let Some((v, [x, y])) = shown(drawer, position) else { return };
    let half = 0.5 * f64::from(drawer.layer.width_px);
    let [columns, rows] = band.pixels_in([x - half, y - half], [x + half, y + half]);
    let is_in = |pixel: usize, center: f64| (-half..half).contains(&(pixel as f64 - center));
    for row in rows.filter(|&row| is_in(row, y)) {
        for column in columns.clone().filter(|&column| is_in(column, x)) {
            band.put([column, row], v as f32, v as f32, || drawer.layer.color);
        }
    }
}
