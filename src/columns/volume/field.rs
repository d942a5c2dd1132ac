//! `VolumeField`: one scalar of a volume, in place and in its own type.

use rayon::prelude::*;

use super::Volume;
use crate::columns::array::{Sample, SliceVisitor};
use crate::columns::field::{select, unusable};
use crate::columns::{Association, Component, FieldSelection, NumericColumn};
use crate::error::Result;

/// One scalar per point or per cell of a volume. Values are widened where they are read; nothing is copied.
#[derive(Clone, Debug)]
pub struct VolumeField {
    /// What it is called, component included.
    pub name: String,
    /// Per point or per cell.
    pub association: Association,
    /// Values along i, j and k: the volume's points, or its cells.
    pub dims: [usize; 3],
    /// The array's values, `components` a tuple.
    pub values: NumericColumn,
    /// Values a tuple.
    pub components: usize,
    /// Which of them is the scalar.
    pub component: Component,
    /// Smallest and largest finite value.
    pub range: (f64, f64),
    /// Values that are not finite.
    pub invalid: u64,
}

impl Volume {
    /// The scalar of the selected array.
    ///
    /// # Errors
    /// [`Error::UnknownArray`](crate::Error::UnknownArray); [`Error::UnusableArray`](crate::Error::UnusableArray) where no value is finite or
    /// the component does not exist.
    pub fn field(&self, selection: &FieldSelection) -> Result<VolumeField> {
        let (_, array) = select(&self.arrays, selection)?;
        let name = match selection.component {
            Component::Magnitude => array.name.clone(),
            Component::Index(index) => format!("{}[{index}]", array.name),
        };
        let association = array.association;
        let field = VolumeField {
            name,
            association,
            dims: if association == Association::Cell { self.cell_dims() } else { self.dims },
            values: array.values.clone(),
            components: array.components,
            component: selection.component,
            range: (0.0, 0.0),
            invalid: 0,
        };
        let (range, invalid) = field.visit(Range);
        if range.0 > range.1 {
            return Err(unusable(array, "it has no finite value; choose another array".to_owned()));
        }
        Ok(VolumeField { range, invalid, ..field })
    }

    /// The scalar of a volume without an array: the same value in each cell.
    pub fn homogeneous_field(&self) -> VolumeField {
        VolumeField {
            name: "homogeneous".to_owned(),
            association: Association::Cell,
            dims: self.cell_dims(),
            values: vec![0_u8; self.cells()].into(),
            components: 1,
            component: Component::Magnitude,
            range: (0.0, 0.0),
            invalid: 0,
        }
    }
}

/// The scalars of a field as a function of their number, in the type of the array: what hot loops read.
///
/// Scalar arrays are read as they are; of tuples, a component or the Euclidean norm.
#[derive(Clone, Copy, Debug)]
pub struct Samples<'a, T> {
    values: &'a [T],
    components: usize,
    component: Component,
}

impl<'a, T: Sample> Samples<'a, T> {
    /// The values themselves, where each is a scalar.
    pub fn scalars(&self) -> Option<&'a [T]> {
        (self.components == 1).then_some(self.values)
    }

    /// Scalar `i`, widened to double precision.
    ///
    /// # Panics
    /// If there is none.
    #[inline]
    pub fn get(&self, i: usize) -> f64 {
        if self.components == 1 {
            return match self.component {
                Component::Magnitude | Component::Index(_) => self.values[i].widened(),
            };
        }
        let tuple = &self.values[i * self.components..][..self.components];
        match self.component {
            Component::Index(index) => tuple[index].widened(),
            Component::Magnitude => tuple.iter().map(|value| value.widened().powi(2)).sum::<f64>().sqrt(),
        }
    }

    /// Scalar `i`, narrowed to single precision.
    ///
    /// # Panics
    /// If there is none.
    #[inline]
    pub fn get_f32(&self, i: usize) -> f32 {
        if self.components == 1 { self.values[i].narrowed() } else { self.get(i) as f32 }
    }

    /// How many scalars there are.
    pub fn len(&self) -> usize {
        self.values.len() / self.components.max(1)
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// Work on the scalars of a field, compiled for each numeric type.
pub trait SampleVisitor {
    /// What it gives.
    type Output;

    /// Does it.
    fn visit<T: Sample>(self, samples: Samples<'_, T>) -> Self::Output;
}

struct Sliced<'a, V> {
    field: &'a VolumeField,
    visitor: V,
}

impl<V: SampleVisitor> SliceVisitor for Sliced<'_, V> {
    type Output = V::Output;

    fn visit<T: Sample>(self, values: &[T]) -> V::Output {
        let VolumeField { components, component, .. } = *self.field;
        self.visitor.visit(Samples { values, components, component })
    }
}

impl VolumeField {
    /// Does `visitor`'s work on the scalars in the type of the array.
    pub fn visit<V: SampleVisitor>(&self, visitor: V) -> V::Output {
        self.values.visit(Sliced { field: self, visitor })
    }

    /// How many values there are.
    pub fn len(&self) -> usize {
        self.dims.iter().product()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Where value (i, j, k) stands.
    #[inline]
    pub fn index(&self, [i, j, k]: [usize; 3]) -> usize {
        i + self.dims[0] * (j + self.dims[1] * k)
    }
}

/// Smallest and largest finite value, and how many are not finite.
struct Range;

impl SampleVisitor for Range {
    type Output = ((f64, f64), u64);

    fn visit<T: Sample>(self, samples: Samples<'_, T>) -> Self::Output {
        const RUN: usize = 1 << 16;
        let of_run = |run: usize| {
            let mut found = (f64::INFINITY, f64::NEG_INFINITY, 0);
            for i in run * RUN..samples.len().min((run + 1) * RUN) {
                let value = samples.get(i);
                if value.is_finite() {
                    found = (found.0.min(value), found.1.max(value), found.2);
                } else {
                    found.2 += 1;
                }
            }
            found
        };
        let nothing = || (f64::INFINITY, f64::NEG_INFINITY, 0);
        let (low, high, invalid) = (0..samples.len().div_ceil(RUN))
            .into_par_iter()
            .map(of_run)
            .reduce(nothing, |a, b| (a.0.min(b.0), a.1.max(b.1), a.2 + b.2));
        ((low, high), invalid)
    }
}

#[cfg(test)]
mod tests {
    use super::super::Lattice;
    use super::*;
    use crate::columns::Array;

    fn volume(components: usize, values: NumericColumn) -> Volume {
        let array = Array { name: "v".into(), association: Association::Point, components, values };
        Volume::new([2, 2, 1], Lattice::default(), vec![array]).unwrap()
    }

    #[test]
    fn values_are_read_in_their_own_type() {
        let field = volume(1, vec![3_i16, -7, 0, 9].into()).field(&FieldSelection::parse("v", &[])).unwrap();
        assert_eq!((field.range, field.invalid, field.values.type_name()), ((-7.0, 9.0), 0, "i16"));
        assert_eq!((field.len(), field.index([1, 1, 0])), (4, 3));
    }

    #[test]
    fn vectors_are_read_by_magnitude_or_component_and_what_is_not_finite_is_counted() {
        let volume = volume(2, vec![3.0_f32, 4.0, 0.0, 1.0, f32::NAN, 0.0, 5.0, 12.0].into());
        let of = |text| volume.field(&FieldSelection::parse(text, &[])).unwrap();
        assert_eq!((of("v").range, of("v").invalid), ((1.0, 13.0), 1));
        assert_eq!((of("v[1]").range, of("v[1]").invalid, of("v[1]").name), ((0.0, 12.0), 0, "v[1]".to_owned()));
        assert!(volume.field(&FieldSelection::parse("v[2]", &[])).is_err());
    }
}
