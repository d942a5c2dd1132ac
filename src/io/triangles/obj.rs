//! Wavefront OBJ: positions (`v`, with r g b behind them or not), normals (`vn`) and faces (`f`); all other statements are left.
//!
//! Read here and not by a crate: those at hand name no line, and compute with the indices of a file before they look at them.

use std::collections::HashMap;

use super::super::source::{Source, quote};
use super::add_polygon;
use crate::error::Result;
use crate::geometry::TriangleMesh;
use crate::image::linear_from_srgb;

/// The statements of a file.
#[derive(Default)]
struct Statements {
    positions: Vec<[f64; 3]>,
    /// sRGB, as far as given.
    colors: HashMap<u32, [f32; 3]>,
    normals: Vec<[f32; 3]>,
    mesh: TriangleMesh,
    /// A position with a normal: where it is in the mesh.
    corners: HashMap<(u32, Option<u32>), u32>,
    has_normals: bool,
}

pub(super) fn read(bytes: &[u8], source: Source) -> Result<TriangleMesh> {
    let mut statements = Statements::default();
    for (number, line) in bytes.split(|&byte| byte == b'\n').enumerate() {
        statements.add(line).map_err(|problem| {
            let line = quote(line.trim_ascii());
            source.malformed(format!("line {}", number + 1), format!("{problem}: {line}"))
        })?;
    }
    let Statements { mut mesh, colors, corners, has_normals, .. } = statements;
    if !colors.is_empty() {
        // White where none is given, as programs show it.
        mesh.colors = vec![[1.0; 3]; mesh.positions.len()];
        for ((position, _), corner) in corners {
            if let Some(color) = colors.get(&position) {
                mesh.colors[corner as usize] = color.map(linear_from_srgb);
            }
        }
    }
    if !has_normals {
        mesh.normals = Vec::new();
    }
    Ok(mesh)
}

impl Statements {
    fn add(&mut self, line: &[u8]) -> Result<(), &'static str> {
        let line = line.split(|&byte| byte == b'#').next().unwrap_or_default();
        let Ok(text) = std::str::from_utf8(line) else { return Ok(()) };
        let mut words = text.split_ascii_whitespace();
        let numbers = |words: std::str::SplitAsciiWhitespace| -> Option<Vec<f64>> {
            words.take(8).map(|word| word.parse().ok()).collect()
        };
        match words.next() {
            Some("v") => match numbers(words).as_deref() {
                Some(&[x, y, z] | &[x, y, z, _]) => self.positions.push([x, y, z]),
                Some(&[x, y, z, ref rgb @ ..]) if rgb.len() == 3 => {
                    let color = std::array::from_fn(|k| rgb[k] as f32);
                    if !color.iter().all(|channel: &f32| (0.0..=1.0).contains(channel)) {
                        return Err("a colour runs from 0 to 1");
                    }
                    let position = u32::try_from(self.positions.len()).map_err(|_| "more than 2^32 positions")?;
                    self.colors.insert(position, color);
                    self.positions.push([x, y, z]);
                }
                _ => return Err("a position has three coordinates, and r, g, b"),
            },
            Some("vn") => match numbers(words).as_deref() {
                Some(&[x, y, z]) => self.normals.push([x, y, z].map(|x| x as f32)),
                _ => return Err("a normal has three components"),
            },
            Some("f") => {
                let corners = words.map(|word| self.corner(word)).collect::<Result<Vec<u32>, _>>()?;
                if corners.len() < 3 {
                    return Err("a face has three corners or more");
                }
                add_polygon(&mut self.mesh.triangles, &corners);
            }
            _ => {}
        }
        Ok(())
    }

    /// The vertex of the mesh that `v`, `v/vt`, `v//vn` or `v/vt/vn` names, 1 being the first and −1 the last.
    fn corner(&mut self, word: &str) -> Result<u32, &'static str> {
        let mut parts = word.split('/');
        let index = |part: &str, len: usize| -> Option<u32> {
            let index: i64 = part.parse().ok()?;
            let from_first = if index < 0 { index.checked_add(len as i64)? } else { index - 1 };
            u32::try_from(from_first).ok().filter(|&found| (found as usize) < len)
        };
        let position =
            index(parts.next().unwrap_or_default(), self.positions.len()).ok_or("there is no such position")?;
        let normal = match parts.nth(1).filter(|part| !part.is_empty()) {
            Some(part) => Some(index(part, self.normals.len()).ok_or("there is no such normal")?),
            None => None,
        };
        self.has_normals |= normal.is_some();
        let next = u32::try_from(self.mesh.positions.len()).map_err(|_| "more than 2^32 vertices")?;
        let corner = *self.corners.entry((position, normal)).or_insert(next);
        if corner == next {
            self.mesh.positions.push(self.positions[position as usize]);
            self.mesh.normals.push(normal.map_or([0.0; 3], |normal| self.normals[normal as usize]));
        }
        Ok(corner)
    }
}
