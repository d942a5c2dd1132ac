//! Curvilinear hexahedra like those of Max 2006: half a ball that swelled (figure 13), half a twisted cylindrical shell (figure 14).

use std::f64::consts::PI;

use cellfan::Points;
use cellfan::io::StructuredMesh;
use glam::DVec3;

/// Cells of half a ball along radius, from pole to pole and around: 141,960, the paper's number, with neighbours' sides in proportion.
const HALF_BALL: [f64; 3] = [42.0, 65.0, 52.0];

/// Cells of the half shell across, around and along: the paper's 300.
const HALF_SHELL: [usize; 3] = [2, 15, 10];

/// How far the shell is twisted over its length, in radians: non-planar faces, as in figure 14.
const TWIST: f64 = 0.6;

/// Half a ball in about `cells` cells, its surface in waves. At the centre and at the axis corners coincide.
pub(super) fn half_ball(cells: u64) -> cellfan::Result<StructuredMesh> {
    let scale = (cells as f64 / HALF_BALL.iter().product::<f64>()).cbrt();
    let boxes = HALF_BALL.map(|n| (n * scale).round().max(2.0) as usize);
    block(boxes, |[r, p, a]| {
        let (polar, azimuth) = (PI * p, PI * a);
        // The poles lie on the axis, to the bit.
        let aside = if p <= 0.0 || p >= 1.0 { 0.0 } else { polar.sin() };
        let swelled = r * (1.0 + 0.06 * r * (5.0 * polar).sin() * (4.0 * azimuth).cos());
        swelled * DVec3::new(aside * azimuth.cos(), aside * azimuth.sin(), polar.cos())
    })
}

/// Half a cylindrical shell of 300 cells, twisted.
pub(super) fn half_shell() -> cellfan::Result<StructuredMesh> {
    block(HALF_SHELL, |[r, a, z]| {
        let (radius, angle) = (0.6 + 0.4 * r, PI * a + TWIST * z);
        DVec3::new(radius * angle.cos(), radius * angle.sin(), 1.5 * z)
    })
}

/// A block of so many boxes; `place` moves the points of the unit cube.
fn block(boxes: [usize; 3], place: impl Fn([f64; 3]) -> DVec3) -> cellfan::Result<StructuredMesh> {
    let dims = boxes.map(|n| n + 1);
    let point = |i: usize| {
        let at = [i % dims[0], i / dims[0] % dims[1], i / (dims[0] * dims[1])];
        place([0, 1, 2].map(|axis| at[axis] as f64 / boxes[axis] as f64)).to_array()
    };
    let points = (0..dims.iter().product()).map(point).collect();
    StructuredMesh::new(&[dims], Points::F64(points), Vec::new())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn they_have_as_many_cells_as_the_papers() {
        assert_eq!(half_ball(141_960).unwrap().cells(), 141_960);
        assert_eq!(half_shell().unwrap().cells(), 300);
        let few = half_ball(1000).unwrap().cells();
        assert!((700..1400).contains(&few), "{few}");
    }

    #[test]
    fn half_a_ball_has_nearly_its_volume() {
        let dataset = half_ball(20_000).unwrap().into_whole_dataset().unwrap();
        let volume: f64 = (0..dataset.cells()).map(|cell| dataset.volume_world(cell)).sum();
        assert!((volume / (2.0 / 3.0 * PI) - 1.0).abs() < 0.1, "{volume}");
    }
}
