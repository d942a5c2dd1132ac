//! Bands whose extinctions are arrays: a field each, and cell arrays four a pass.
//!
//! In: a dataset and its fields. Out: what [`bands`](super::bands) draws of them.

use crate::columns::{Association, Dataset, Field};
use crate::error::{Error, Result};
use crate::optics::band_pieces::BANDS_PER_PASS;
use crate::optics::{BandColumn, BandPoint, BandTable};
use crate::stages::SceneVertex;
use crate::stages::project::scene_vertices;

/// All bands of a scene.
#[derive(Clone, Debug)]
pub(super) struct BandArrays {
    /// In their order.
    pub(super) each: Vec<BandArray>,
    /// Those that one pass can draw with others.
    pub(super) cell_passes: Vec<CellPass>,
}

/// A band whose extinction is an array.
#[derive(Clone, Debug)]
pub(super) struct BandArray {
    pub(super) field: Field,
    /// Where the array is point data; cell data goes with the scene's own.
    pub(super) vertices: Option<Vec<SceneVertex>>,
    /// Extinction is the value.
    pub(super) table: BandTable,
}

/// Two to four arrays of cell data that are drawn in one pass.
#[derive(Clone, Debug)]
pub(super) struct CellPass {
    /// Their places among all bands.
    pub(super) bands: Vec<usize>,
    /// The largest extinction in each cell, which tells whether any of the bands shows there.
    pub(super) largest: Field,
    /// Extinction is the value.
    pub(super) table: BandTable,
}

impl BandArrays {
    /// Checks names and values.
    ///
    /// # Errors
    /// [`Error::Bands`] where there is none or two have one name, [`Error::UnusableArray`] where a value is negative.
    pub(super) fn new(dataset: &Dataset, fields: Vec<Field>) -> Result<Self> {
        let names: Vec<String> = fields.iter().map(|field| field.name.clone()).collect();
        BandTable::new(names, vec![BandPoint { value: 0.0, extinctions: vec![0.0; fields.len()] }])?;
        let of_field = |field: Field| {
            let vertices = (field.association == Association::Point).then(|| scene_vertices(dataset, &field));
            Ok(BandArray { table: identity(&field)?, vertices, field })
        };
        let each: Vec<BandArray> = fields.into_iter().map(of_field).collect::<Result<_>>()?;

        // A cell that an array has no number for is left out, and counted, in a pass of this array's own.
        let is_whole = |array: &BandArray| array.field.association == Association::Cell && array.field.invalid == 0;
        let cells: Vec<usize> = (0..each.len()).filter(|&band| is_whole(&each[band])).collect();
        let several = cells.chunks(BANDS_PER_PASS).filter(|bands| bands.len() > 1);
        let cell_passes = several.map(|bands| CellPass::new(dataset, &each, bands)).collect::<Result<_>>()?;
        Ok(Self { each, cell_passes })
    }

    /// Bytes of memory that they take; columns that are used in place count nothing.
    pub(super) fn owned_bytes(&self) -> u64 {
        let of_field = |field: &Field| size_of_val(&field.values[..]) + size_of_val(&field.block_ranges[..]);
        let of_array = |BandArray { field, vertices, .. }: &BandArray| {
            of_field(field) + size_of_val(vertices.as_deref().unwrap_or_default())
        };
        let arrays = self.each.iter().map(of_array);
        arrays.chain(self.cell_passes.iter().map(|pass| of_field(&pass.largest))).sum::<usize>() as u64
    }
}

impl BandArray {
    /// The band's extinctions, where the array is cell data.
    pub(super) fn column(&self) -> BandColumn<'_> {
        BandColumn { values: &self.field.values, offset: self.field.offset }
    }
}

impl CellPass {
    fn new(dataset: &Dataset, each: &[BandArray], bands: &[usize]) -> Result<Self> {
        let fields: Vec<&Field> = bands.iter().map(|&band| &each[band].field).collect();
        let names: Vec<&str> = fields.iter().map(|field| field.name.as_str()).collect();
        let largest = dataset.largest_of_cells(names.join(", "), &fields);
        Ok(Self { bands: bands.to_vec(), table: identity(&largest)?, largest })
    }
}

/// Extinction that is the value itself, 0 for what is as good as 0.
fn identity(field: &Field) -> Result<BandTable> {
    let (low, high) = field.range;
    if low < 0.0 || high > f64::from(f32::MAX) {
        let problem = format!("its values run from {low} to {high}; an extinction must be 0 or more, and finite");
        return Err(Error::UnusableArray { name: field.name.clone(), problem });
    }
    // A step to the least number that is not subnormal: below it nothing shows, and cells of 0 are left out.
    let least = f64::from(f32::MIN_POSITIVE);
    let point = |value: f64, extinction: f64| BandPoint { value, extinctions: vec![extinction] };
    let high = high.max(least);
    BandTable::new(vec![field.name.clone()], vec![point(least, 0.0), point(least, least), point(high, high)])
}
