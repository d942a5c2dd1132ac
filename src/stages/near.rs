//! `near`: cut a cell at the near plane into tetrahedra that lie behind it.
//!
//! In: four corners with view depth. Out: up to three tetrahedra. Only for rasterisers: a footprint's planes are right on
//! both sides of the eye, it needs no cut.

use glam::Vec3;

/// A corner in picture-independent form: position and scalar, both linear along an edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Corner {
    /// Position relative to the dataset's origin.
    pub position: Vec3,
    /// The field's stored value.
    pub scalar: f32,
    /// View depth.
    pub depth: f32,
}

impl Corner {
    /// The point of edge `self`–`other` on depth `near`; the ends in canonical order, so that all cells of an edge agree.
    fn on_plane(&self, other: &Self, near: f32) -> Self {
        let (a, b) = if self.depth < other.depth { (self, other) } else { (other, self) };
        let t = (near - a.depth) / (b.depth - a.depth);
        Self {
            position: a.position + (b.position - a.position) * t,
            scalar: a.scalar + (b.scalar - a.scalar) * t,
            depth: near,
        }
    }
}

/// The part of the tetrahedron at view depth `near` or more, as tetrahedra of the same orientation; how many.
pub fn cut(corners: [Corner; 4], near: f32, out: &mut [[Corner; 4]; 3]) -> usize {
    let kept: CornerSet = corners.iter().enumerate().filter(|(_, c)| c.depth >= near).map(|(i, _)| i).collect();
    match kept.as_slice() {
        [] => 0,
        [_, _, _, _] => {
            out[0] = corners;
            1
        }
        &[i] => {
            out[0] = std::array::from_fn(|k| if k == i { corners[k] } else { corners[i].on_plane(&corners[k], near) });
            1
        }
        // A wedge in both cases: two triangles joined by three edges, cut into three tetrahedra.
        &[i, j] => {
            let [k, l] = others([i, j]);
            let on = |a: usize, b: usize| corners[a].on_plane(&corners[b], near);
            let turned = permutation_is_odd([i, j, k, l]);
            wedge([corners[i], on(i, k), on(i, l)], [corners[j], on(j, k), on(j, l)], turned, out)
        }
        kept => {
            let cut = (0..4).find(|i| !kept.contains(i)).unwrap_or(3);
            let base = [kept[0], kept[1], kept[2]];
            let top = base.map(|i| corners[i].on_plane(&corners[cut], near));
            let turned = permutation_is_odd([base[0], base[1], base[2], cut]);
            wedge(base.map(|i| corners[i]), top, turned, out)
        }
    }
}

type CornerSet = arrayvec::ArrayVec<usize, 4>;

fn others([i, j]: [usize; 2]) -> [usize; 2] {
    let mut rest = (0..4).filter(|&k| k != i && k != j);
    [rest.next().unwrap_or(0), rest.next().unwrap_or(0)]
}

fn permutation_is_odd(p: [usize; 4]) -> bool {
    (0..4).flat_map(|i| (0..i).map(move |j| (j, i))).filter(|&(j, i)| p[j] > p[i]).count() % 2 == 1
}

/// Wedge a0 a1 a2 – b0 b1 b2 with edges a0 b0, a1 b1, a2 b2 as three tetrahedra; `turned` swaps their orientation.
fn wedge(a: [Corner; 3], b: [Corner; 3], turned: bool, out: &mut [[Corner; 4]; 3]) -> usize {
    *out = [[a[0], a[1], a[2], b[0]], [a[1], a[2], b[0], b[1]], [a[2], b[0], b[1], b[2]]];
    if turned {
        for tet in out {
            tet.swap(0, 1);
        }
    }
    3
}

#[cfg(test)]
mod tests {
    use super::*;

    fn volume([a, b, c, d]: [Corner; 4]) -> f32 {
        (b.position - a.position).cross(c.position - a.position).dot(d.position - a.position)
    }

    #[test]
    fn what_is_kept_fills_the_cell_behind_the_plane_and_keeps_its_orientation() {
        let shape =
            [Vec3::new(0.1, 0.2, 0.0), Vec3::new(1.0, 0.1, 0.3), Vec3::new(0.2, 1.1, 0.7), Vec3::new(0.4, 0.3, 1.0)];
        for turn in 0..4 {
            let mut positions = shape;
            positions.rotate_left(turn);
            let corners = positions.map(|position| Corner { position, scalar: position.x, depth: position.z });
            let whole = volume(corners);
            for near in [-1.0, 0.1, 0.5, 0.9, 2.0] {
                let mut out = [corners; 3];
                let n = cut(corners, near, &mut out);
                let kept: f32 = out[..n].iter().map(|tet| volume(*tet)).sum();
                let share = kept / whole;
                // Twin: share of sample points of the cell that lie behind the plane.
                let (mut inside, mut all) = (0, 0);
                let steps = 60;
                for i in 0..steps {
                    for j in 0..steps - i {
                        for k in 0..steps - i - j {
                            let w = [i, j, k, steps - 1 - i - j - k].map(|v| (v as f32 + 0.25) / steps as f32);
                            let z: f32 = (0..4).map(|c| w[c] * corners[c].depth).sum();
                            all += 1;
                            inside += i32::from(z >= near);
                        }
                    }
                }
                assert!((share - inside as f32 / all as f32).abs() < 0.02, "near {near}: {share}");
                for tet in &out[..n] {
                    assert!(volume(*tet) / whole >= 0.0, "orientation");
                    assert!(tet.iter().all(|c| c.depth >= near && (c.scalar - c.position.x).abs() < 1e-6));
                }
            }
        }
    }
}
