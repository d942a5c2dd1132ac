//! Several pieces as one: their points, and the arrays that all of them have.

use super::numbers;
use super::scratch::Scratch;
use crate::columns::{Array, Points};
use crate::error::Result;

/// The points of all pieces, in single precision where all are.
pub(super) fn points(pieces: &[&Points]) -> Points {
    let single = pieces.iter().map(|&piece| match piece {
        Points::F32(points) => Some(&points[..]),
        Points::F64(_) => None,
    });
    if let Some(parts) = single.collect::<Option<Vec<_>>>() {
        return Points::F32(parts.concat());
    }
    let all = pieces.iter().flat_map(|piece| (0..piece.len()).map(|i| piece.get(i).to_array()));
    Points::F64(all.collect())
}

/// The arrays that every piece has, one piece after the other; a warning names the others.
pub(super) fn arrays(pieces: &[&[Array]], scratch: &Scratch) -> Result<Vec<Array>> {
    let mut arrays = Vec::new();
    for array in pieces.first().copied().unwrap_or_default() {
        let Array { name, association, components, .. } = array;
        let is_same = |found: &&Array| found.name == *name && found.association == *association;
        let same = |piece: &&[Array]| {
            let found = piece.iter().find(is_same)?;
            (found.components == *components).then(|| found.values.clone())
        };
        if let Some(parts) = pieces.iter().map(same).collect::<Option<Vec<_>>>() {
            let values = numbers::concat(&parts.iter().collect::<Vec<_>>(), scratch)?;
            arrays.push(Array { values, ..array.clone() });
        } else {
            tracing::warn!(array = name, "not in every piece, left out");
        }
    }
    Ok(arrays)
}
