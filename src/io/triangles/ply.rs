//! PLY: elements of properties that the header declares; of them vertices and faces.

use std::io::Cursor;

use ply_rs_bw::parser::{ParseError, Parser, Reader};
use ply_rs_bw::ply::{ElementDef, Encoding, Property, PropertyAccess, PropertyAccessResult, PropertyType, ScalarType};

use super::super::source::Source;
use super::add_polygon;
use crate::error::{Error, Result};
use crate::geometry::TriangleMesh;
use crate::image::linear_from_srgb;

/// A vertex or a face; of other elements nothing is kept.
#[derive(Default)]
struct Element {
    position: [f64; 3],
    normal: [f32; 3],
    /// sRGB.
    color: [f32; 3],
    /// Corners of a face; a negative one is none.
    corners: Option<Box<[i64]>>,
}

/// The names of properties, and of what they are components.
const POSITION: [&str; 3] = ["x", "y", "z"];
const NORMAL: [&str; 3] = ["nx", "ny", "nz"];
const COLOR: [&str; 3] = ["red", "green", "blue"];
const CORNERS: [&str; 2] = ["vertex_indices", "vertex_index"];

impl PropertyAccess for Element {
    fn new() -> Self {
        Self::default()
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        let component = |names: [&str; 3]| names.iter().position(|known| *known == name);
        if let Some(k) = component(POSITION) {
            let Some(value) = number(&property) else { return PropertyAccessResult::UnsupportedType };
            self.position[k] = value;
        } else if let Some(k) = component(NORMAL) {
            let Some(value) = number(&property) else { return PropertyAccessResult::UnsupportedType };
            self.normal[k] = value as f32;
        } else if let Some(k) = component(COLOR) {
            let Some(value) = intensity(&property) else { return PropertyAccessResult::UnsupportedType };
            self.color[k] = value;
        } else if CORNERS.contains(&name) {
            let Some(corners) = whole_numbers(&property) else { return PropertyAccessResult::UnsupportedType };
            self.corners = Some(corners);
        } else {
            return PropertyAccessResult::Ignored;
        }
        PropertyAccessResult::Set
    }
}

fn number(property: &Property) -> Option<f64> {
    match *property {
        Property::Double(value) => Some(value),
        Property::Int(value) => Some(value.into()),
        Property::UInt(value) => Some(value.into()),
        ref other => other.to_f32_lossy().map(f64::from),
    }
}

/// From 0 to 1: whole numbers by their largest.
fn intensity(property: &Property) -> Option<f32> {
    let largest = match property {
        Property::UChar(_) | Property::Char(_) => 255.0,
        Property::UShort(_) | Property::Short(_) => 65_535.0,
        Property::UInt(_) | Property::Int(_) => 4_294_967_295.0,
        _ => 1.0,
    };
    number(property).map(|value| (value / largest).clamp(0.0, 1.0) as f32)
}

fn whole_numbers(property: &Property) -> Option<Box<[i64]>> {
    fn all<T: Copy + Into<i64>>(values: &[T]) -> Box<[i64]> {
        values.iter().map(|&value| value.into()).collect()
    }
    Some(match property {
        Property::ListChar(values) => all(values),
        Property::ListUChar(values) => all(values),
        Property::ListShort(values) => all(values),
        Property::ListUShort(values) => all(values),
        Property::ListInt(values) => all(values),
        Property::ListUInt(values) => all(values),
        _ => return None,
    })
}

pub(super) fn read(bytes: &[u8], source: Source) -> Result<TriangleMesh> {
    let parser = Parser::<Element>::new();
    let mut reader = Reader::new(Cursor::new(bytes));
    let at_line = |error: &ParseError| error.line().map_or_else(|| "PLY".to_owned(), |line| format!("line {line}"));
    let damaged = |error: ParseError| source.malformed(at_line(&error), error.to_string());
    let header = parser.read_header(&mut reader).map_err(damaged)?;
    let is_text = matches!(header.encoding, Encoding::Ascii);
    let mut mesh = TriangleMesh::default();
    for (name, element) in &header.elements {
        check_length(element, is_text, bytes.len() as u64)
            .map_err(|problem| source.malformed(format!("element {name}"), problem))?;
        let elements = parser.read_payload_for_element(&mut reader, element, &header).map_err(damaged)?;
        match name.as_str() {
            "vertex" => add_vertices(&mut mesh, element, elements, source)?,
            "face" => add_faces(&mut mesh, elements, source)?,
            _ => {}
        }
    }
    Ok(mesh)
}

/// Whether a file is as long as an element says: what is read takes memory in proportion to the file.
fn check_length(element: &ElementDef, is_text: bool, bytes: u64) -> Result<(), String> {
    let size = |scalar: &ScalarType| match scalar {
        _ if is_text => 2,
        ScalarType::Char | ScalarType::UChar => 1,
        ScalarType::Short | ScalarType::UShort => 2,
        ScalarType::Int | ScalarType::UInt | ScalarType::Float => 4,
        ScalarType::Double => 8,
    };
    let least: u64 = element
        .properties
        .iter()
        .map(|(_, property)| match &property.data_type {
            PropertyType::Scalar(scalar) | PropertyType::List(scalar, _) => size(scalar),
        })
        .sum();
    // The last number of a text need not be followed by anything.
    let needed = (element.count as u64).saturating_mul(least).saturating_sub(u64::from(is_text));
    if element.count > 0 && (least == 0 || needed > bytes) {
        return Err(format!(
            "{} of them do not fit into {bytes} bytes; the file is damaged or truncated",
            element.count
        ));
    }
    Ok(())
}

fn add_vertices(mesh: &mut TriangleMesh, element: &ElementDef, vertices: Vec<Element>, source: Source) -> Result<()> {
    let has = |names: [&str; 3]| names.iter().all(|name| element.properties.contains_key(*name));
    if !has(POSITION) {
        return Err(source.malformed("element vertex", "it has no properties x, y and z"));
    }
    if has(NORMAL) {
        mesh.normals = vertices.iter().map(|vertex| vertex.normal).collect();
    }
    if has(COLOR) {
        mesh.colors = vertices.iter().map(|vertex| vertex.color.map(linear_from_srgb)).collect();
    }
    mesh.positions = vertices.into_iter().map(|vertex| vertex.position).collect();
    Ok(())
}

fn add_faces(mesh: &mut TriangleMesh, faces: Vec<Element>, source: Source) -> Result<()> {
    for (i, face) in faces.into_iter().enumerate() {
        let corners = face.corners.unwrap_or_default();
        let corner = |&corner: &i64| {
            let wrong = |_| Error::IndexOutOfRange {
                column: "face",
                cell: i as u64,
                index: corner,
                len: mesh.positions.len() as u64,
            };
            u32::try_from(corner).map_err(wrong)
        };
        let corners: Result<Vec<u32>> = corners.iter().map(corner).collect();
        add_polygon(&mut mesh.triangles, &corners.map_err(|error| error.in_file(source.path))?);
    }
    Ok(())
}
