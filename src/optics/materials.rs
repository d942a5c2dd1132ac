//! In: materials, each with the values that it has where it is alone. Out: how much of each a value stands for, and a transfer function.
//!
//! The probabilistic classifier of Drebin, Carpenter and Hanrahan (*Volume Rendering*, 1988) in its piecewise linear form: a value between
//! those of two neighbouring materials is a mixture of these two, whose parts change linearly from one to the other. A mixture's extinction
//! and light are the sums of those of its parts, each by its percentage; so its colour is weighted by extinction too, and what is
//! transparent lends no colour.

use super::transfer::{ControlPoint, TransferFunction, problem};
use crate::error::Result;

/// Control points between two materials whose colours differ: the colour of a mixture is a ratio, not a line.
const STEPS: usize = 32;

/// A material as values tell it.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// What it is called.
    pub name: String,
    /// The lowest and the highest value at which it is alone.
    pub values: [f64; 2],
    /// Linear RGB.
    pub color: [f64; 3],
    /// Per world unit length.
    pub extinction: f64,
}

/// The share of each material at a value; they add up to 1. Materials must ascend.
///
/// ```
/// # use cellfan::optics::materials::{Material, percentages};
/// let material = |name: &str, values, extinction| Material { name: name.into(), values, color: [1.0; 3], extinction };
/// let materials = [material("air", [0.0, 20.0], 0.0), material("bone", [60.0, 255.0], 3.0)];
/// assert_eq!(percentages(&materials, 30.0), [0.75, 0.25]);
/// ```
pub fn percentages(materials: &[Material], value: f64) -> Vec<f64> {
    let mut shares = vec![0.0; materials.len()];
    let after = materials.iter().position(|material| value < material.values[0]).unwrap_or(materials.len());
    match (after.checked_sub(1), materials.get(after)) {
        (None, None) => {}
        (None, Some(_)) => shares[0] = 1.0,
        (Some(before), Some(next)) if value > materials[before].values[1] => {
            let from = materials[before].values[1];
            let share = (value - from) / (next.values[0] - from);
            (shares[before], shares[after]) = (1.0 - share, share);
        }
        (Some(before), _) => shares[before] = 1.0,
    }
    shares
}

impl TransferFunction {
    /// The transfer function of materials, in ascending order of their values.
    ///
    /// ```
    /// # use cellfan::{TransferFunction, optics::materials::Material};
    /// let fat = Material { name: "fat".into(), values: [10.0, 20.0], color: [1.0, 0.0, 0.0], extinction: 1.0 };
    /// let bone = Material { name: "bone".into(), values: [30.0, 40.0], color: [0.0, 0.0, 1.0], extinction: 3.0 };
    /// let half = TransferFunction::from_materials(&[fat, bone])?.eval(25.0);
    /// // Half of each: a quarter of the light is the fat's.
    /// assert_eq!((half.extinction, half.color), (2.0, [0.25, 0.0, 0.75]));
    /// # Ok::<(), cellfan::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::TransferFunction`](crate::Error::TransferFunction) where there is no material, one overlaps the next, or as [`TransferFunction::new`].
    pub fn from_materials(materials: &[Material]) -> Result<Self> {
        if materials.is_empty() {
            return Err(problem("there are no materials; at least one is needed"));
        }
        let mut points = Vec::new();
        for (i, material) in materials.iter().enumerate() {
            let [from, to] = material.values;
            if from.is_nan() || to.is_nan() || from > to {
                return Err(problem(format!(
                    "material {:?} runs from {from} to {to}; \"from\" must not be above \"to\"",
                    material.name
                )));
            }
            if let Some(before) = i.checked_sub(1).map(|before| &materials[before]) {
                if before.values[1] > from {
                    let problem_of = format!(
                        "materials {:?} and {:?} overlap; their values must ascend",
                        before.name, material.name
                    );
                    return Err(problem(problem_of));
                }
                points.extend((1..STEPS).map(|step| mixture(before, material, step as f64 / STEPS as f64)));
            }
            points.extend([from, to].map(|value| ControlPoint {
                value,
                color: material.color,
                extinction: material.extinction,
            }));
        }
        Self::new(points)
    }
}

/// What is between two materials.
fn mixture(before: &Material, after: &Material, share: f64) -> ControlPoint {
    let parts = [(1.0 - share) * before.extinction, share * after.extinction];
    let extinction = parts[0] + parts[1];
    let of_after = if extinction > 0.0 { parts[1] / extinction } else { share };
    ControlPoint {
        value: before.values[1] * (1.0 - share) + after.values[0] * share,
        color: std::array::from_fn(|c| before.color[c] * (1.0 - of_after) + after.color[c] * of_after),
        extinction,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn three() -> Vec<Material> {
        let material =
            |name: &str, values, color, extinction| Material { name: name.into(), values, color, extinction };
        vec![
            material("air", [0.0, 10.0], [0.0; 3], 0.0),
            material("skin", [20.0, 20.0], [1.0, 0.5, 0.2], 0.5),
            material("bone", [60.0, 100.0], [1.0; 3], 4.0),
        ]
    }

    #[test]
    fn percentages_add_up_and_change_from_one_to_the_next() {
        let materials = three();
        for n in -10..130 {
            let value = f64::from(n);
            let shares = percentages(&materials, value);
            assert!((shares.iter().sum::<f64>() - 1.0).abs() < 1e-12, "{value}: {shares:?}");
            assert!(shares.iter().filter(|&&share| share > 0.0).count() <= 2);
            // Extinction is their sum; light is at the control points.
            let looks = TransferFunction::from_materials(&materials).unwrap().eval(value);
            let extinction: f64 =
                shares.iter().zip(&materials).map(|(share, material)| share * material.extinction).sum();
            assert!((looks.extinction - extinction).abs() < 1e-12, "{value}");
            for c in 0..3 {
                let light: f64 =
                    shares.iter().zip(&materials).map(|(share, m)| share * m.extinction * m.color[c]).sum();
                assert!((looks.extinction * looks.color[c] - light).abs() < 0.02, "{value}: {looks:?} for {light}");
            }
        }
    }

    #[test]
    fn materials_must_ascend() {
        let mut materials = three();
        materials.swap(0, 2);
        assert!(TransferFunction::from_materials(&materials).unwrap_err().to_string().contains("overlap"));
        materials[0].values = [3.0, 1.0];
        assert!(TransferFunction::from_materials(&materials).is_err());
        assert!(TransferFunction::from_materials(&[]).is_err());
    }
}
