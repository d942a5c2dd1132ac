//! Header and directory: what a container says of its columns, checked before any of them is used.

use std::path::Path;

use serde::{Deserialize, Serialize};
use twox_hash::XxHash3_64;

use super::octree::LatticeEntry;
use super::write::Written;
use crate::columns::{ArrayHead, Association, CellCounts, Dataset, HEX_FACES, HexShape, StructuredBlock, TET_FACES};
use crate::error::{Error, Result, presentable};

/// How a container begins; what text-mode transfers change is in it.
pub const MAGIC: [u8; 8] = *b"\x89CELLS\r\n";

/// The versions: of tetrahedra alone, with cells of four-cornered faces, and with polyhedra.
pub(super) const VERSIONS: [u32; 3] = [1, 2, 3];

/// Columns begin at multiples of this.
pub(super) const ALIGNMENT: u64 = 64;

pub(super) const HEADER_BYTES: usize = 64;

/// No directory is longer: a hundred thousand arrays fit.
const DIRECTORY_BYTES_MAX: u64 = 1 << 26;

/// The first 64 bytes, little-endian.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Header {
    pub(super) version: u32,
    /// Length of the file.
    pub(super) file_bytes: u64,
    pub(super) directory_offset: u64,
    pub(super) directory_bytes: u64,
    pub(super) directory_checksum: u64,
}

impl Header {
    pub(super) fn to_bytes(self) -> [u8; HEADER_BYTES] {
        let mut bytes = [0; HEADER_BYTES];
        bytes[..8].copy_from_slice(&MAGIC);
        bytes[8..12].copy_from_slice(&self.version.to_le_bytes());
        let fields = [self.file_bytes, self.directory_offset, self.directory_bytes, self.directory_checksum];
        for (to, field) in bytes[16..48].chunks_exact_mut(8).zip(fields) {
            to.copy_from_slice(&field.to_le_bytes());
        }
        bytes
    }

    fn from_bytes(bytes: &[u8]) -> std::result::Result<Self, String> {
        let header: &[u8; HEADER_BYTES] =
            bytes.first_chunk().ok_or_else(|| format!("{} bytes are less than a header", bytes.len()))?;
        if header[..8] != MAGIC {
            return Err("it does not begin as a container does".to_owned());
        }
        let word = |at: usize| u64::from_le_bytes(std::array::from_fn(|i| header[at + i]));
        let version = word(8) as u32;
        if !VERSIONS.contains(&version) {
            let [first, .., last] = VERSIONS;
            return Err(format!(
                "version {version}; this program reads {first} to {last}; write it again with convert"
            ));
        }
        let fields = [word(16), word(24), word(32), word(40)];
        let [file_bytes, directory_offset, directory_bytes, directory_checksum] = fields;
        Ok(Self { version, file_bytes, directory_offset, directory_bytes, directory_checksum })
    }
}

/// A run of bytes and their XXH3-64.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Span {
    pub(super) offset: u64,
    pub(super) bytes: u64,
    #[serde(with = "hexadecimal")]
    pub(super) xxh3: u64,
}

/// 64 bits as 16 digits: JSON readers in other languages keep 53.
mod hexadecimal {
    use serde::{Deserialize, Deserializer, Serializer, de::Error};

    #[expect(clippy::trivially_copy_pass_by_ref, reason = "serde passes a reference")]
    pub(super) fn serialize<S: Serializer>(value: &u64, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(&format!("{value:016x}"))
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<u64, D::Error> {
        u64::from_str_radix(&String::deserialize(deserializer)?, 16).map_err(D::Error::custom)
    }
}

/// A column: its name, where it is, and the length it must have, where that is known.
pub(super) type ColumnSpan = (String, Span, Option<u64>);

/// What the columns are, as JSON in the file.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Directory {
    pub(super) cell_kind: String,
    pub(super) cells: u64,
    pub(super) vertices: u64,
    pub(super) cells_per_block: u64,
    pub(super) origin: [f64; 3],
    pub(super) counts: CellCounts,
    pub(super) positions: Span,
    pub(super) orientation: Span,
    pub(super) tetrahedra: Span,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) hexahedra: Option<HexahedraEntry>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) polyhedra: Option<PolyhedraEntry>,
    pub(super) block_ids: Span,
    pub(super) block_bounds: Span,
    /// Which cells lie across the faces of tetrahedra.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) adjacency: Option<Span>,
    pub(super) arrays: Vec<ArrayEntry>,
    /// Where the points are that make a regular grid, and the octrees over its arrays.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) lattice: Option<LatticeEntry>,
}

/// Cells with faces of four corners.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct HexahedraEntry {
    pub(super) cells: u64,
    /// Of these, how many are numbered and not drawn.
    pub(super) absent: u64,
    /// Of these, how many repeat their corners as a wedge does.
    pub(super) wedges: u64,
    /// And as a pyramid does.
    pub(super) pyramids: u64,
    /// Where they are listed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) corners: Option<Span>,
    /// Where structured blocks imply them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) blocks: Option<Span>,
    pub(super) shapes: Span,
    /// Which cells lie across their faces, where they are listed and the file says it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) adjacency: Option<Span>,
}

/// Cells with any faces.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct PolyhedraEntry {
    pub(super) cells: u64,
    /// Faces of theirs, those of two cells counted once.
    pub(super) faces: u64,
    pub(super) starts: Span,
    pub(super) sides: Span,
    pub(super) corners: Span,
    pub(super) face_starts: Span,
    pub(super) around: Span,
}

/// A named array.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct ArrayEntry {
    pub(super) name: String,
    pub(super) association: Association,
    pub(super) components: u64,
    pub(super) number_type: String,
    pub(super) values: Span,
    /// Of the value or magnitude, then, where there are several, of each component.
    pub(super) ranges: Vec<RangeEntry>,
}

impl ArrayEntry {
    /// An array whose values are written, without ranges.
    pub(super) fn new(head: ArrayHead, values: Span) -> Self {
        Self {
            name: head.name,
            association: head.association,
            components: head.components as u64,
            number_type: head.type_name.to_owned(),
            values,
            ranges: Vec::new(),
        }
    }
}

/// What is known of one scalar.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct RangeEntry {
    /// Absent where no value is finite.
    pub(super) range: Option<[f64; 2]>,
    pub(super) invalid_cells: u64,
    pub(super) block_ranges: Span,
}

impl Directory {
    /// `cell_kind` where all cells are tetrahedra, the files of version 1.
    pub(super) const TETRAHEDRON: &str = "tetrahedron";
    /// `cell_kind` where there are others.
    pub(super) const MIXED: &str = "mixed";

    /// The version of a file with this directory.
    pub(super) fn version(&self) -> u32 {
        match (&self.hexahedra, &self.polyhedra) {
            (None, None) => VERSIONS[0],
            (Some(_), None) => VERSIONS[1],
            (_, Some(_)) => VERSIONS[2],
        }
    }

    /// How many tetrahedra, hexahedra and polyhedra there are.
    pub(super) fn by_kind(&self) -> [u64; 3] {
        let hexahedra = self.hexahedra.as_ref().map_or(0, |hexahedra| hexahedra.cells);
        let polyhedra = self.polyhedra.map_or(0, |polyhedra| polyhedra.cells);
        [self.cells - hexahedra - polyhedra, hexahedra, polyhedra]
    }

    /// What is told of the file.
    pub(super) fn written(&self, file_bytes: u64, narrow_blocks: (u64, u64)) -> Written {
        let absent = self.hexahedra.as_ref().map_or(0, |hexahedra| hexahedra.absent);
        let cells = self.cells - absent;
        Written { cells, vertices: self.vertices, file_bytes, narrow_blocks, counts: self.counts }
    }

    /// Finds the directory of a container and checks everything that can be checked without its columns.
    pub(super) fn read(bytes: &[u8], path: &Path) -> Result<Self> {
        let malformed = |place: &str, problem: String| Error::Malformed {
            path: path.to_owned(),
            place: presentable(place.to_owned()),
            problem: presentable(problem),
        };
        let header = Header::from_bytes(bytes).map_err(|problem| malformed("header", problem))?;
        let len = bytes.len() as u64;
        if header.file_bytes != len {
            let problem = format!("the file has {len} bytes, not the {} it was written with", header.file_bytes);
            return Err(malformed("header", problem + "; copy or write it again"));
        }
        let end = header.directory_offset.checked_add(header.directory_bytes);
        if header.directory_bytes > DIRECTORY_BYTES_MAX || end.is_none_or(|end| end > len) {
            return Err(malformed("header", "the directory lies outside the file".to_owned()));
        }
        let text = &bytes[header.directory_offset as usize..][..header.directory_bytes as usize];
        if XxHash3_64::oneshot(text) != header.directory_checksum {
            return Err(malformed("directory", "its checksum is wrong; the file is damaged".to_owned()));
        }
        let directory: Self =
            serde_json::from_slice(text).map_err(|error| malformed("directory", error.to_string()))?;
        directory.check(len, header.version).map_err(|(place, problem)| malformed(&place, problem))?;
        Ok(directory)
    }

    /// Numbers that 32 bits hold, columns of the right length that lie in the file, aligned, without overlap.
    fn check(&self, file_bytes: u64, version: u32) -> std::result::Result<(), (String, String)> {
        let directory = |problem: String| ("directory".to_owned(), problem);
        let kind = if self.version() == VERSIONS[0] { Self::TETRAHEDRON } else { Self::MIXED };
        if self.cell_kind != kind || self.version() != version {
            return Err(directory(format!("cells of kind {:?}, where version {version} has others", self.cell_kind)));
        }
        let limit = u64::from(u32::MAX) - 1;
        if self.cells == 0 || self.cells > limit || self.vertices == 0 || self.vertices > limit {
            return Err(directory(format!("{} cells of {} vertices; 1 to {limit} each", self.cells, self.vertices)));
        }
        if let Some(HexahedraEntry { cells, absent, wedges, pyramids, .. }) = self.hexahedra
            && (cells == 0
                || cells > self.cells
                || absent > cells
                || wedges.checked_add(pyramids).is_none_or(|of_kind| of_kind > cells))
        {
            let of = format!("{absent} absent, {wedges} wedges, {pyramids} pyramids");
            return Err(directory(format!("{cells} hexahedra ({of}) among {} cells", self.cells)));
        }
        if let Some(PolyhedraEntry { cells, faces, .. }) = self.polyhedra {
            let others = self.hexahedra.as_ref().map_or(0, |hexahedra| hexahedra.cells);
            if cells == 0 || cells > self.cells - others || faces > u64::from(u32::MAX) / 2 {
                return Err(directory(format!("{cells} polyhedra of {faces} faces among {} cells", self.cells)));
            }
            if self.adjacency.is_some() {
                return Err(("column adjacency".to_owned(), "beside polyhedra, whose faces imply it".to_owned()));
            }
        }
        if self.cells_per_block != Dataset::BLOCK_CELLS as u64 {
            let problem =
                format!("blocks of {} cells; this version reads {}", self.cells_per_block, Dataset::BLOCK_CELLS);
            return Err(directory(problem));
        }
        // Sums of a few of them must not overflow.
        if self.counts.all().iter().any(|&count| count > 1 << 53) {
            return Err(directory("counts of more cells than a file can hold".to_owned()));
        }
        if !self.origin.iter().all(|x| x.is_finite()) {
            return Err(directory("the origin is not finite".to_owned()));
        }
        let mut spans = self.spans()?;
        for (name, span, expected) in &spans {
            let place = || format!("column {name}");
            if expected.is_some_and(|expected| expected != span.bytes) {
                let problem = format!("{} bytes where {} are needed", span.bytes, expected.unwrap_or_default());
                return Err((place(), problem));
            }
            if !span.offset.is_multiple_of(ALIGNMENT) {
                return Err((place(), format!("it begins at byte {}, no multiple of {ALIGNMENT}", span.offset)));
            }
            if span.offset.checked_add(span.bytes).is_none_or(|end| end > file_bytes) || span.offset < ALIGNMENT {
                return Err((place(), "it lies outside the file".to_owned()));
            }
        }
        spans.sort_by_key(|(_, span, _)| (span.offset, span.bytes));
        for two in spans.windows(2) {
            if two[0].1.offset + two[0].1.bytes > two[1].1.offset {
                return Err((format!("column {}", two[1].0), format!("it overlaps with {}", two[0].0)));
            }
        }
        Ok(())
    }

    /// Every column.
    pub(super) fn spans(&self) -> std::result::Result<Vec<ColumnSpan>, (String, String)> {
        let [tets, hexahedra, polyhedra] = self.by_kind();
        let [of_tets, of_hexahedra, of_polyhedra] = self.by_kind().map(|cells| cells.div_ceil(self.cells_per_block));
        let blocks = of_tets + of_hexahedra + of_polyhedra;
        let mut spans = vec![
            ("positions".to_owned(), self.positions, Some(self.vertices * 12)),
            ("orientation".to_owned(), self.orientation, Some(tets.div_ceil(64) * 8)),
            ("tetrahedra".to_owned(), self.tetrahedra, None),
            ("block_ids".to_owned(), self.block_ids, Some(of_tets * 8)),
            ("block_bounds".to_owned(), self.block_bounds, Some(blocks * 24)),
        ];
        if let Some(entry) = &self.hexahedra {
            let wrong = |problem: &str| Err(("hexahedra".to_owned(), problem.to_owned()));
            let size_of_shape = size_of::<HexShape>() as u64;
            spans.push(("shapes".to_owned(), entry.shapes, Some(hexahedra * size_of_shape)));
            match (entry.corners, entry.blocks) {
                (Some(corners), None) => spans.push(("corners".to_owned(), corners, Some(hexahedra * 32))),
                (None, Some(blocks))
                    if tets + polyhedra > 0 || blocks.bytes % size_of::<StructuredBlock>() as u64 != 0 =>
                {
                    return wrong("blocks beside other cells, or a part of a block");
                }
                (None, Some(blocks)) => spans.push(("structured blocks".to_owned(), blocks, None)),
                _ => return wrong("either corners or blocks say where they are"),
            }
            let adjacency = |problem: &str| Err(("column adjacency".to_owned(), problem.to_owned()));
            match (self.adjacency, entry.adjacency, entry.blocks) {
                (None, None, _) | (Some(_), Some(_), None) => {}
                (.., Some(_)) => return adjacency("structured blocks imply it"),
                _ => return adjacency("it is there for cells of one kind and not of the other"),
            }
        }
        if let Some(PolyhedraEntry { faces, starts, sides, corners, face_starts, around, .. }) = self.polyhedra {
            let columns = [
                ("starts of polyhedra", starts, Some((polyhedra + 1) * 8)),
                ("faces of polyhedra", sides, None),
                ("corners of polyhedra", corners, None),
                ("starts of faces", face_starts, Some((faces + 1) * 4)),
                ("corners of faces", around, None),
            ];
            spans.extend(columns.map(|(name, span, bytes)| (name.to_owned(), span, bytes)));
        }
        let of_hexahedra = self.hexahedra.as_ref().and_then(|entry| entry.adjacency);
        let neighbours = [
            ("adjacency", self.adjacency, tets * size_of::<[u32; TET_FACES]>() as u64),
            ("adjacency of hexahedra", of_hexahedra, hexahedra * size_of::<[u32; HEX_FACES]>() as u64),
        ];
        spans.extend(
            neighbours.into_iter().filter_map(|(name, span, bytes)| Some((name.to_owned(), span?, Some(bytes)))),
        );
        for array in &self.arrays {
            let wrong = |problem: &str| (format!("array {:?}", array.name), problem.to_owned());
            let size = size_of_number(&array.number_type).ok_or_else(|| wrong("numbers of an unknown type"))?;
            let tuples = match array.association {
                Association::Point => self.vertices,
                Association::Cell => self.cells,
            };
            let bytes = tuples.checked_mul(array.components).and_then(|values| values.checked_mul(size));
            if array.components == 0 || bytes.is_none() {
                return Err(wrong("an impossible number of components"));
            }
            spans.push((format!("array {:?}", array.name), array.values, bytes));
            let known = if array.components == 1 { 1 } else { array.components.saturating_add(1) };
            if array.ranges.len() as u64 > known {
                return Err(wrong("more ranges than components"));
            }
            for (i, range) in array.ranges.iter().enumerate() {
                if range.range.is_some_and(|[low, high]| !(low <= high && low.is_finite() && high.is_finite())) {
                    return Err(wrong("a range that is none"));
                }
                spans.push((format!("ranges {i} of {:?}", array.name), range.block_ranges, Some(blocks * 16)));
            }
        }
        if let Some(lattice) = &self.lattice {
            spans.extend(lattice.spans(self)?);
        }
        Ok(spans)
    }
}

/// Bytes of a number.
fn size_of_number(number_type: &str) -> Option<u64> {
    match number_type {
        "i8" | "u8" => Some(1),
        "i16" | "u16" => Some(2),
        "i32" | "u32" | "f32" => Some(4),
        "i64" | "u64" | "f64" => Some(8),
        _ => None,
    }
}
