//! Cells by kind, with the kinds' names.

use cellfan::cells::{CellClass, Nodes, classify};
use serde::Serialize;

/// How many cells have a code.
#[derive(Serialize)]
pub(super) struct KindCount {
    /// What the code means.
    pub(super) name: String,
    /// VTK's code.
    pub(super) code: u8,
    /// Cells of it.
    pub(super) count: u64,
}

/// The kinds that occur, by ascending code.
pub(super) fn count(cells_by_code: &[u64; 256]) -> Vec<KindCount> {
    (0..=255_u8)
        .zip(*cells_by_code)
        .filter(|&(_, count)| count > 0)
        .map(|(code, count)| KindCount { name: name(code), code, count })
        .collect()
}

/// So many cells of a code.
pub(super) fn of_code((code, count): (u8, u64)) -> KindCount {
    KindCount { name: name(code), code, count }
}

fn name(code: u8) -> String {
    match classify(code) {
        CellClass::Volume { kind, nodes: Nodes::Linear } => kind.name.to_owned(),
        CellClass::Volume { kind, nodes: Nodes::Quadratic(nodes) } => format!("{} with {nodes} nodes", kind.name),
        CellClass::Volume { kind, nodes: Nodes::AnyOrder } => format!("{} of higher order", kind.name),
        CellClass::Unsupported("unknown kind") => format!("unknown kind {code}"),
        CellClass::Unsupported(name) => name.to_owned(),
        CellClass::Polyhedron => "polyhedron".to_owned(),
        CellClass::LowerDimensional => lower_dimensional(code).to_owned(),
    }
}

fn lower_dimensional(code: u8) -> &'static str {
    match code {
        0 => "empty cell",
        1 => "vertex",
        2 => "poly-vertex",
        3 => "line",
        4 => "poly-line",
        5 => "triangle",
        6 => "triangle strip",
        7 => "polygon",
        8 => "pixel",
        9 => "quadrilateral",
        21 | 35 => "curve",
        _ => "curved line or face",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_code_has_a_name_and_is_counted() {
        let mut cells = [1; 256];
        (cells[10], cells[5], cells[11]) = (3, 2, 0);
        let kinds = count(&cells);
        assert_eq!((kinds.len(), kinds.iter().map(|kind| kind.count).sum::<u64>()), (255, 258));
        assert!(kinds.iter().all(|kind| !kind.name.is_empty()));
        let found = kinds.iter().find(|kind| kind.code == 10).unwrap();
        assert_eq!((found.name.as_str(), found.count), ("tetrahedron", 3));
        assert_eq!(name(24), "tetrahedron with 10 nodes");
        assert_eq!(name(42), "polyhedron");
        assert_eq!(name(200), "unknown kind 200");
    }
}
