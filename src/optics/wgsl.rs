//! The constants of the integrals as WGSL declarations, so that shaders and processor compute with the same digits.

use std::fmt::Write;

use super::attenuation::{
    DEPTH_LIMIT, FALLING_BOTTOM, FALLING_SHIFT, FALLING_TOP, Q0, Q1, Q2, Q3, Q4, Q5, RISING_BOTTOM, RISING_SHIFT,
    RISING_TOP, THIN_LIMIT,
};
use super::exp::{EXP_TAIL, LN_2_HIGH, LN_2_LOW, ONE_MINUS_TAIL, UNDERFLOW};
use super::integral::VERY_THIN_LIMIT;

/// One declaration a line, under the names that they have in Rust.
pub(crate) fn constants() -> String {
    let mut text = String::new();
    let scalars = [
        ("DEPTH_LIMIT", DEPTH_LIMIT),
        ("FALLING_SHIFT", FALLING_SHIFT),
        ("LARGEST", f32::MAX),
        ("LN_2_HIGH", LN_2_HIGH),
        ("LN_2_LOW", LN_2_LOW),
        ("LOG2_E", std::f32::consts::LOG2_E),
        ("Q5", Q5),
        ("RISING_SHIFT", RISING_SHIFT),
        ("THIN_LIMIT", THIN_LIMIT),
        ("UNDERFLOW", UNDERFLOW),
        ("VERY_THIN_LIMIT", VERY_THIN_LIMIT),
    ];
    let arrays: [(&str, &[f32]); 11] = [
        ("EXP_TAIL", &EXP_TAIL),
        ("FALLING_BOTTOM", &FALLING_BOTTOM),
        ("FALLING_TOP", &FALLING_TOP),
        ("ONE_MINUS_TAIL", &ONE_MINUS_TAIL),
        ("Q0", &Q0),
        ("Q1", &Q1),
        ("Q2", &Q2),
        ("Q3", &Q3),
        ("Q4", &Q4),
        ("RISING_BOTTOM", &RISING_BOTTOM),
        ("RISING_TOP", &RISING_TOP),
    ];
    // The shortest digits that give back every bit; writing to a string cannot fail.
    for (name, value) in scalars {
        let _ = writeln!(text, "const {name}: f32 = {value:?};");
    }
    for (name, values) in arrays {
        let list: Vec<String> = values.iter().map(|value| format!("{value:?}")).collect();
        let _ = writeln!(text, "const {name} = array<f32, {}>({});", values.len(), list.join(", "));
    }
    text
}
