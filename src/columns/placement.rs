//! Where a mesh stands: what its positions are relative to, and the curve in space along which its cells are numbered.

use glam::{DVec3, Vec3};

use super::{Bounds, Points};

/// The frame of a mesh.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Placement {
    /// Added to a position, it gives the world position.
    pub(crate) origin: DVec3,
    /// The box around all corners, relative to `origin`.
    pub(crate) bounds: Bounds,
    /// Steps of the Morton curve per unit length.
    steps_per_unit: f32,
}

impl Placement {
    /// For cells whose corners, some of `points`, reach from `low` to `high`.
    pub(crate) fn new(points: &Points, low: DVec3, high: DVec3) -> Self {
        Self::of(matches!(points, Points::F32(_)), low, high)
    }

    /// The same; `is_single` says whether points are in single precision.
    pub(crate) fn of(is_single: bool, low: DVec3, high: DVec3) -> Self {
        let origin = if low.cmple(high).all() { recentre(low, high, is_single) } else { DVec3::ZERO };
        let bounds = Bounds { min: (low - origin).as_vec3(), max: (high - origin).as_vec3() };
        let extent = (bounds.max - bounds.min).max_element().max(f32::MIN_POSITIVE);
        Self { origin, bounds, steps_per_unit: ((1 << 21) - 1) as f32 / extent }
    }

    /// A point of the file as cells use it: re-centred in f64, then narrowed, so that an offset of 10^6 costs no digit.
    #[inline]
    pub(crate) fn position(&self, point: DVec3) -> Vec3 {
        (point - self.origin).as_vec3()
    }

    /// Where a cell stands along the Morton curve.
    #[inline]
    pub(crate) fn key<const N: usize>(&self, corners: [Vec3; N]) -> u64 {
        self.key_of(corners.iter().sum::<Vec3>() * (1.0 / N as f32))
    }

    /// The same of a cell whose middle is `center`.
    #[inline]
    pub(super) fn key_of(&self, center: Vec3) -> u64 {
        let center = (center - self.bounds.min) * self.steps_per_unit;
        morton(center.x as u32, center.y as u32, center.z as u32)
    }
}

/// Single precision input near the origin keeps its bits; everything else is centred.
fn recentre(low: DVec3, high: DVec3, is_single: bool) -> DVec3 {
    let center = (low + high) * 0.5;
    let offset = center.abs().max_element();
    let extent = (high - low).max_element();
    if is_single && offset <= 4.0 * extent { DVec3::ZERO } else { center }
}

/// Sign of (b−a)×(c−a)·(d−a), exact (Shewchuk's adaptive predicate).
pub(crate) fn orientation_of([a, b, c, d]: [Vec3; 4]) -> i8 {
    let coord = |p: Vec3| robust::Coord3D { x: f64::from(p.x), y: f64::from(p.y), z: f64::from(p.z) };
    // Shewchuk's orient3d is positive where d lies below the plane of a, b, c seen counterclockwise.
    let determinant = -robust::orient3d(coord(a), coord(b), coord(c), coord(d));
    i8::from(determinant > 0.0) - i8::from(determinant < 0.0)
}

/// Interleaves the low 21 bits of x, y and z.
fn morton(x: u32, y: u32, z: u32) -> u64 {
    spread(x) | spread(y) << 1 | spread(z) << 2
}

/// Moves bit i to bit 3 i, by halving the groups that stay together.
fn spread(v: u32) -> u64 {
    let mut v = u64::from(v) & 0x1f_ffff;
    v = (v | v << 32) & 0x001f_0000_0000_ffff;
    v = (v | v << 16) & 0x001f_0000_ff00_00ff;
    v = (v | v << 8) & 0x100f_00f0_0f00_f00f;
    v = (v | v << 4) & 0x10c3_0c30_c30c_30c3;
    (v | v << 2) & 0x1249_2492_4924_9249
}

#[cfg(test)]
mod tests {
    use super::morton;

    #[test]
    fn morton_interleaves_bit_by_bit() {
        let slow = |x: u32, y: u32, z: u32| {
            (0..21).fold(0_u64, |key, i| {
                let bit = |v: u32| u64::from(v >> i & 1);
                key | bit(x) << (3 * i) | bit(y) << (3 * i + 1) | bit(z) << (3 * i + 2)
            })
        };
        for (x, y, z) in [(0, 0, 0), (1, 2, 4), (0x1f_ffff, 0, 0x15_5555), (12345, 67890, 999_999)] {
            assert_eq!(morton(x, y, z), slow(x, y, z));
        }
    }
}
