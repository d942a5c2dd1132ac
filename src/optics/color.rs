//! In: colours as files and displays hold them. Out: linear RGB, and paths between two colours that look even.
//!
//! sRGB per IEC 61966-2-1 (white D65), CIELAB, and Msh, its polar form (Moreland 2009, "Diverging color maps for scientific
//! visualization").

/// Linear RGB of an sRGB colour, each channel 0 to 1.
///
/// ```
/// # use cellfan::optics::color::linear_from_srgb;
/// assert!((linear_from_srgb([0.5, 0.0, 1.0])[0] - 0.214_041).abs() < 1e-6);
/// ```
pub fn linear_from_srgb(srgb: [f64; 3]) -> [f64; 3] {
    srgb.map(|c| if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) })
}

/// sRGB of a linear RGB colour; what the display cannot show is clamped to 0 to 1.
pub fn srgb_from_linear(linear: [f64; 3]) -> [f64; 3] {
    linear
        .map(|c| if c <= 0.003_130_8 { 12.92 * c } else { 1.055 * c.powf(1.0 / 2.4) - 0.055 })
        .map(|c| c.clamp(0.0, 1.0))
}

/// XYZ of white, as the rows of the matrix below add up.
const WHITE: [f64; 3] = [0.950_456, 1.0, 1.088_754];

const XYZ_FROM_RGB: [[f64; 3]; 3] =
    [[0.412_453, 0.357_580, 0.180_423], [0.212_671, 0.715_160, 0.072_169], [0.019_334, 0.119_193, 0.950_227]];

const RGB_FROM_XYZ: [[f64; 3]; 3] =
    [[3.240_479, -1.537_150, -0.498_535], [-0.969_256, 1.875_992, 0.041_556], [0.055_648, -0.204_043, 1.057_311]];

fn product(matrix: &[[f64; 3]; 3], v: [f64; 3]) -> [f64; 3] {
    matrix.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
}

fn lab_from_srgb(srgb: [f64; 3]) -> [f64; 3] {
    let xyz = product(&XYZ_FROM_RGB, linear_from_srgb(srgb));
    let f = |k: usize| {
        let t = xyz[k] / WHITE[k];
        if t > 0.008_856 { t.cbrt() } else { 7.787 * t + 16.0 / 116.0 }
    };
    [116.0 * f(1) - 16.0, 500.0 * (f(0) - f(1)), 200.0 * (f(1) - f(2))]
}

fn srgb_from_lab([l, a, b]: [f64; 3]) -> [f64; 3] {
    let fy = (l + 16.0) / 116.0;
    let f = [fy + a / 500.0, fy, fy - b / 200.0];
    let xyz = std::array::from_fn(|k| {
        let t = f[k];
        WHITE[k] * if t > 0.206_893 { t * t * t } else { (t - 16.0 / 116.0) / 7.787 }
    });
    srgb_from_linear(product(&RGB_FROM_XYZ, xyz))
}

/// Magnitude, saturation, hue.
fn msh_from_lab([l, a, b]: [f64; 3]) -> [f64; 3] {
    let m = (l * l + a * a + b * b).sqrt();
    let s = if m > 0.0 { (l / m).clamp(-1.0, 1.0).acos() } else { 0.0 };
    [m, s, if s > 0.001 { b.atan2(a) } else { 0.0 }]
}

fn lab_from_msh([m, s, h]: [f64; 3]) -> [f64; 3] {
    [m * s.cos(), m * s.sin() * h.cos(), m * s.sin() * h.sin()]
}

/// The path on which colours between two sRGB colours lie.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Path {
    /// Straight in sRGB.
    Rgb,
    /// Hue the shorter way round, saturation and value straight.
    Hsv,
    /// Straight in CIELAB.
    Lab,
    /// Through white where the hues differ much, evenly bright on both sides (Moreland 2009).
    Diverging,
    /// The first colour all the way.
    Step,
}

/// The sRGB colour at t in 0 to 1 on the path between two sRGB colours.
///
/// ```
/// # use cellfan::optics::color::{Path, between_srgb};
/// let (cool, warm) = ([59.0 / 255.0, 76.0 / 255.0, 192.0 / 255.0], [180.0 / 255.0, 4.0 / 255.0, 38.0 / 255.0]);
/// let white = between_srgb(Path::Diverging, cool, warm, 0.5);
/// assert!(white.iter().all(|c| (c * 255.0 - 221.0).abs() < 1.0)); // published as 221 221 221
/// ```
pub fn between_srgb(path: Path, from: [f64; 3], to: [f64; 3], t: f64) -> [f64; 3] {
    let mix =
        |from: [f64; 3], to: [f64; 3], t: f64| -> [f64; 3] { std::array::from_fn(|k| from[k] * (1.0 - t) + to[k] * t) };
    match path {
        Path::Step => from,
        Path::Rgb => mix(from, to, t),
        Path::Lab => srgb_from_lab(mix(lab_from_srgb(from), lab_from_srgb(to), t)),
        Path::Hsv => {
            let (mut a, mut b) = (hsv_from_rgb(from), hsv_from_rgb(to));
            if a[0] - b[0] > 0.5 {
                b[0] += 1.0;
            } else if b[0] - a[0] > 0.5 {
                a[0] += 1.0;
            }
            rgb_from_hsv(mix(a, b, t))
        }
        Path::Diverging => {
            let (mut a, mut b) = (msh_from_lab(lab_from_srgb(from)), msh_from_lab(lab_from_srgb(to)));
            let mut t = t;
            let turn = (a[2] - b[2]).rem_euclid(std::f64::consts::TAU);
            let angle = turn.min(std::f64::consts::TAU - turn);
            if a[1] > 0.05 && b[1] > 0.05 && angle > std::f64::consts::FRAC_PI_3 {
                // Two saturated colours of different hue meet in white, at least as bright as both.
                let white = [a[0].max(b[0]).max(88.0), 0.0, 0.0];
                if t < 0.5 {
                    b = white;
                    t *= 2.0;
                } else {
                    a = white;
                    t = 2.0 * t - 1.0;
                }
            }
            if a[1] < 0.05 && b[1] > 0.05 {
                a[2] = adjusted_hue(b, a[0]);
            } else if b[1] < 0.05 && a[1] > 0.05 {
                b[2] = adjusted_hue(a, b[0]);
            }
            srgb_from_lab(lab_from_msh(mix(a, b, t)))
        }
    }
}

/// The hue that an unsaturated colour of magnitude `m` takes, so that the path towards a saturated one looks even.
fn adjusted_hue([m_saturated, s, h]: [f64; 3], m: f64) -> f64 {
    if m_saturated >= m {
        return h;
    }
    let spin = s * (m * m - m_saturated * m_saturated).sqrt() / (m_saturated * s.sin());
    if h > -std::f64::consts::FRAC_PI_3 { h + spin } else { h - spin }
}

/// Hue, saturation, value, each 0 to 1.
fn hsv_from_rgb([r, g, b]: [f64; 3]) -> [f64; 3] {
    let (high, low) = (r.max(g).max(b), r.min(g).min(b));
    let chroma = high - low;
    if chroma <= 0.0 {
        return [0.0, 0.0, high];
    }
    let sixth = if high <= r {
        (g - b) / chroma
    } else if high <= g {
        (b - r) / chroma + 2.0
    } else {
        (r - g) / chroma + 4.0
    };
    [(sixth / 6.0).rem_euclid(1.0), chroma / high, high]
}

fn rgb_from_hsv([h, s, v]: [f64; 3]) -> [f64; 3] {
    // Each channel is a trapezium over the hue, a third of a turn apart.
    [5.0, 3.0, 1.0].map(|shift: f64| {
        let k = (shift + 6.0 * h).rem_euclid(6.0);
        v - v * s * k.min(4.0 - k).clamp(0.0, 1.0)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn assert_near(a: [f64; 3], b: [f64; 3], tolerance: f64) {
        assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() <= tolerance), "{a:?} {b:?}");
    }

    #[test]
    fn every_path_starts_and_ends_at_its_colours() {
        let colors = [[0.2, 0.7, 0.1], [0.9, 0.1, 0.4], [1.0, 1.0, 1.0], [0.0, 0.0, 0.0], [0.5, 0.5, 0.5]];
        for path in [Path::Rgb, Path::Hsv, Path::Lab, Path::Diverging] {
            for from in colors {
                for to in colors {
                    assert_near(between_srgb(path, from, to, 0.0), from, 1e-4);
                    assert_near(between_srgb(path, from, to, 1.0), to, 1e-4);
                }
            }
        }
        assert_eq!(between_srgb(Path::Step, colors[0], colors[1], 0.9), colors[0]);
    }

    #[test]
    fn hue_goes_the_shorter_way() {
        let (magenta, yellow) = ([1.0, 0.0, 1.0], [1.0, 1.0, 0.0]);
        assert_near(between_srgb(Path::Hsv, magenta, yellow, 0.5), [1.0, 0.0, 0.0], 1e-12);
    }

    #[test]
    fn srgb_and_linear_undo_each_other() {
        for k in 0..=255 {
            let c = f64::from(k) / 255.0;
            assert_near(srgb_from_linear(linear_from_srgb([c; 3])), [c; 3], 1e-5);
        }
    }
}
