//! From lists of faces to [`Polyhedra`]: each cell's skin, cells in spatial order, each face once.

use std::hash::{BuildHasher, BuildHasherDefault, DefaultHasher};

use glam::Vec3;
use rayon::prelude::*;

use super::skin::{Flaw, Skin};
use super::{FaceLists, Most, Polyhedra, PolyhedraColumns};
use crate::columns::Placement;
use crate::error::{Error, Result};

/// Polyhedra of a file, checked, in spatial order.
#[derive(Default)]
pub(crate) struct Built {
    skins: Vec<Skin>,
    /// The file's cell of each.
    pub(crate) file_from_cell: Vec<u32>,
    /// Cells whose faces ran the other way.
    pub(crate) mirrored: u64,
    /// Cells without volume, which are left out.
    pub(crate) flat: u64,
}

impl Built {
    /// Checks the cells of `lists`, the file's cells `file_from`, whose points are all there.
    ///
    /// # Errors
    /// [`Error::OpenCell`].
    pub(crate) fn new(
        lists: &FaceLists,
        file_from: &[u32],
        canonical: &[u32],
        position: impl Fn(u32) -> Vec3 + Sync,
        placement: &Placement,
    ) -> Result<Self> {
        let skin = |cell: usize| match Skin::new(lists.faces(cell), |point| canonical[point as usize], &position) {
            Ok(skin) => {
                let (mut sum, mut points) = (Vec3::ZERO, 0.0);
                for &point in skin.faces.iter().flatten() {
                    sum += position(point);
                    points += 1.0;
                }
                Ok(Some((placement.key_of(sum / points), cell as u32, skin)))
            }
            Err(Flaw::Flat) => Ok(None),
            Err(Flaw::Open(edge)) => Err(Error::OpenCell { cell: file_from[cell].into(), edge }),
        };
        let found: Vec<Result<Option<(u64, u32, Skin)>>> = (0..lists.cells()).into_par_iter().map(skin).collect();
        let mut skins = Vec::with_capacity(found.len());
        let mut flat = 0;
        for skin in found {
            match skin? {
                Some(skin) => skins.push(skin),
                None => flat += 1,
            }
        }
        skins.par_sort_unstable_by_key(|&(key, cell, _)| (key, cell));
        let mirrored = skins.iter().filter(|(.., skin)| skin.is_mirrored).count() as u64;
        let file_from_cell = skins.iter().map(|&(_, cell, _)| file_from[cell as usize]).collect();
        Ok(Self { skins: skins.into_iter().map(|(.., skin)| skin).collect(), file_from_cell, mirrored, flat })
    }

    /// How many cells there are.
    pub(crate) fn len(&self) -> usize {
        self.skins.len()
    }

    /// The points of all cells, in their order; those of several faces more than once.
    pub(crate) fn points(&self) -> impl Iterator<Item = u32> {
        self.skins.iter().flat_map(|skin| skin.faces.iter().flatten().copied())
    }

    /// The cells as columns, points numbered by `vertex`, faces compared by `canonical` points.
    ///
    /// # Errors
    /// [`Error::TooLarge`].
    pub(crate) fn finish(self, vertex: impl Fn(u32) -> u32, canonical: &[u32]) -> Result<Polyhedra> {
        let faces: Vec<&Vec<u32>> = self.skins.iter().flat_map(|skin| &skin.faces).collect();
        let len = self.skins.iter().flat_map(|skin| &skin.faces).map(|face| face.len() as u64).sum();
        let limit = u64::from(u32::MAX) / 2;
        if len > limit {
            return Err(Error::TooLarge { column: "corners of the faces of polyhedra", len, limit });
        }
        let side_from_listed = shared(&faces, canonical);

        let (mut face_starts, mut around) = (vec![0], Vec::new());
        let mut number_from_first = vec![u32::MAX; faces.len()];
        for (listed, face) in faces.iter().enumerate().filter(|&(i, _)| side_from_listed[i] as usize / 2 == i) {
            number_from_first[listed] = face_starts.len() as u32 - 1;
            around.extend(face.iter().map(|&point| vertex(point)));
            face_starts.push(around.len() as u32);
        }
        let (mut starts, mut sides, mut corners) = (vec![[0; 2]], Vec::with_capacity(faces.len()), Vec::new());
        let mut most = Most::default();
        for skin in &self.skins {
            let mut of_cell: Vec<u32> = skin.faces.iter().flatten().map(|&point| vertex(point)).collect();
            let around = of_cell.len();
            of_cell.sort_unstable();
            of_cell.dedup();
            most = most.max(Most::of_cell(skin.faces.len(), of_cell.len(), around));
            corners.append(&mut of_cell);
            for _ in &skin.faces {
                let side = side_from_listed[sides.len()];
                sides.push(number_from_first[side as usize / 2] << 1 | side & 1);
            }
            starts.push([sides.len() as u32, corners.len() as u32]);
        }
        let (starts, sides, corners) = (starts.into(), sides.into(), corners.into());
        let (face_starts, around) = (face_starts.into(), around.into());
        Ok(Polyhedra { columns: PolyhedraColumns { starts, sides, corners, face_starts, around }, most })
    }
}

/// Faces in one place that run the same way and are compared with another.
const MOST_WAITING: usize = 8;

/// For each face twice the number of the first like it, and 1 where that runs the other way.
///
/// Faces of equal hash are compared: those of one name that run opposite ways are one face.
fn shared(faces: &[&Vec<u32>], canonical: &[u32]) -> Vec<u32> {
    let name = |face: &[u32]| -> Vec<u32> { face.iter().map(|&point| canonical[point as usize]).collect() };
    let hasher = BuildHasherDefault::<DefaultHasher>::default();
    let mut by_hash: Vec<(u64, u32)> = faces
        .par_iter()
        .enumerate()
        .map(|(i, face)| {
            let mut points = name(face);
            points.sort_unstable();
            (hasher.hash_one(points), i as u32)
        })
        .collect();
    by_hash.par_sort_unstable();
    let mut sides: Vec<u32> = (0..faces.len() as u32).map(|i| 2 * i).collect();
    for run in by_hash.chunk_by(|a, b| a.0 == b.0).filter(|run| run.len() > 1) {
        let mut waiting: Vec<(u32, Vec<u32>)> = Vec::new();
        for &(_, i) in run {
            let own = name(faces[i as usize]);
            // From the lowest point on, the other way round.
            let mut behind = own.clone();
            behind[1..].reverse();
            // More than two cells at a face are a fault of the mesh; few are looked at.
            let recent = waiting.len().saturating_sub(MOST_WAITING)..waiting.len();
            match recent.rev().find(|&first| waiting[first].1 == behind) {
                Some(first) => sides[i as usize] = 2 * waiting.swap_remove(first).0 + 1,
                None => waiting.push((i, own)),
            }
        }
    }
    sides
}
