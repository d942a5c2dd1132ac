//! Colours and normals of the corners of a triangle, between them: linear on it, by areas.

use glam::DVec3;

use crate::geometry::List;

/// What a triangle looks like at its corners.
pub(super) struct CornerLooks {
    corners: [DVec3; 3],
    colors: Option<[DVec3; 3]>,
    normals: Option<[DVec3; 3]>,
}

impl CornerLooks {
    /// Those of triangle `i`; none where the list has none.
    pub(super) fn of(list: &List, i: usize) -> Option<Self> {
        let looks = list.looks()?;
        let three = |each: &[[f32; 3]]| -> Option<[DVec3; 3]> {
            let three: [[f32; 3]; 3] = each.get(3 * i..3 * i + 3)?.try_into().ok()?;
            Some(three.map(|value| DVec3::from_array(value.map(f64::from))))
        };
        let corners = three(list.corners())?;
        Some(Self { corners, colors: three(&looks.colors), normals: three(&looks.normals) })
    }

    /// Colour and unit normal at a point of the triangle, whose own normal is `normal`; none where corners have none.
    pub(super) fn at(&self, point: DVec3, normal: DVec3) -> (Option<[f32; 3]>, Option<DVec3>) {
        let [a, b, c] = self.corners;
        let area = |p: DVec3, q: DVec3| normal.dot((q - p).cross(point - p)).max(0.0);
        let shares = [area(b, c), area(c, a), area(a, b)];
        let all: f64 = shares.iter().sum();
        let between = |values: [DVec3; 3]| {
            let sum: DVec3 = values.into_iter().zip(shares).map(|(value, share)| value * share).sum();
            if all > 0.0 { sum / all } else { values[0] }
        };
        let color = self.colors.map(|colors| between(colors).as_vec3().to_array());
        let normal = self.normals.map(|normals| between(normals).normalize_or(normal));
        (color, normal)
    }
}
