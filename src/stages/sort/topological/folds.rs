//! `folds`: which of two cells comes first where the face between them is seen from both sides.
//!
//! In: cells, their adjacency and sides, the view. Out: relations, and how many faces ask for both. Such a face is folded: its two
//! triangles overlap on the picture, rays leave a cell through one and enter it again through the other. A triangle asks for its
//! relation where the ray of some pixel centre meets it. Where both do, neither order of the two cells is right at every pixel; the
//! triangle that more rays meet has its way.
//!
//! O(hexahedra + pixels of such faces), in parallel.

use rayon::prelude::*;

use super::graph::{Relation, relation};
use super::outline::{Outline, Seen};
use crate::control::Control;
use crate::stages::footprints::PixelBoxes;
use crate::stages::sort::adjacency::{Across, Adjacency, Face};

/// Appends what such faces relate to `relations`, which stay ascending, each once; how many faces ask for both orders.
/// Until the end is asked for.
pub(super) fn relations(control: &Control, seen: Seen, adjacency: &Adjacency, relations: &mut Vec<Relation>) -> u64 {
    let (rows, boxes) = (adjacency.rows(seen.dataset), PixelBoxes::new(seen.view));
    let v_near = seen.v_near();
    let related = |cell: u32, k: usize, other: u32| {
        let rays_met = |outline: &Outline| seen.triangle(outline).count(outline.pixels, v_near);
        let (mut exits, mut entries) = (0, 0);
        for outline in seen.outlines(&boxes, Face { cell, index: k as u32 }) {
            let rays = if outline.is_exit { &mut exits } else { &mut entries };
            *rays += rays_met(&outline);
        }
        let kept = if exits >= entries { relation(cell, other) } else { relation(other, cell) };
        (exits + entries > 0).then_some((kept, exits > 0 && entries > 0))
    };
    let first = seen.dataset.tets.len() as u32;
    let found: Vec<(Relation, bool)> = (first..seen.dataset.cells() as u32)
        .into_par_iter()
        .filter(|&cell| seen.sides_from_cell[cell as usize].both() != 0 && !control.is_cancelled())
        .flat_map_iter(|cell| {
            let across = rows.across(cell, seen.sides_from_cell[cell as usize].both());
            // Each such face once; both its cells are hexahedra.
            let pairs = across.filter(move |&(_, other)| other != Adjacency::NONE && cell < other);
            pairs.filter_map(move |(k, other)| related(cell, k, other))
        })
        .collect();
    if !found.is_empty() {
        relations.extend(found.iter().map(|&(relation, _)| relation));
        relations.par_sort_unstable();
        relations.dedup();
    }
    found.iter().filter(|&&(_, asks_for_both)| asks_for_both).count() as u64
}
