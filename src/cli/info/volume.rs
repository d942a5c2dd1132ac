//! What `info` says of a volume, without making its points and cells.

use cellfan::columns::{CellCounts, Volume};
use cellfan::{Error, columns};

use super::report::Drawn;

/// The box around all points.
pub(super) fn bounds(volume: &Volume) -> [[f64; 3]; 2] {
    let corners = volume.corners_world();
    let (first, rest) = (corners[0], &corners[1..]);
    let low = rest.iter().fold(first, |low, &corner| low.min(corner));
    let high = rest.iter().fold(first, |high, &corner| high.max(corner));
    [low.to_array(), high.to_array()]
}

/// Whether an array says that some cells are hidden: then they have to be counted.
pub(super) fn hides_cells(volume: &Volume) -> bool {
    volume.arrays.iter().any(|columns::Array { name, .. }| name.starts_with("vtkGhost"))
}

/// All cells are drawn, or none.
pub(super) fn drawn(volume: &Volume) -> (CellCounts, Result<Drawn, String>) {
    let cells = volume.cells() as u64;
    let counts = CellCounts { in_file: cells, ..CellCounts::default() };
    if !volume.has_volume() {
        let counts = CellCounts { lower_dimensional: cells, ..counts };
        let found = format!("{cells} of no volume by their kind (points, lines, faces)");
        return (counts, Err(Error::NoCells { found }.to_string()));
    }
    let (vertices, memory_bytes) = (volume.points() as u64, volume.owned_bytes());
    (counts, Ok(Drawn { tetrahedra: 0, hexahedra: cells, polyhedra: 0, vertices, blocks: 1, memory_bytes }))
}
