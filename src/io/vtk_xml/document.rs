//! The elements of a VTK XML file, without what follows `<AppendedData …>_`, which need not be XML.

use std::borrow::Cow;

use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};

use super::super::source::{Source, quote};
use crate::error::Result;

/// No VTK file nests its elements deeper than seven.
const DEEPEST: usize = 32;

/// A piece has about ten elements and one for each array: enough for tens of thousands of pieces.
const MOST_ELEMENTS: usize = 1 << 20;

/// An element with what it contains.
#[derive(Debug)]
pub(in crate::io) struct Element<'a> {
    pub(in crate::io) name: String,
    attributes: Vec<(String, String)>,
    /// Elements in it; none is kept for a `DataArray` (they describe its range).
    pub(in crate::io) children: Vec<Element<'a>>,
    /// The text directly in it.
    pub(in crate::io) text: Cow<'a, str>,
    /// Where it begins in the file.
    byte: u64,
}

impl<'a> Element<'a> {
    /// The value of attribute `name`.
    pub(in crate::io) fn attribute(&self, name: &str) -> Option<&str> {
        self.attributes.iter().find(|(key, _)| key == name).map(|(_, value)| value.as_str())
    }

    /// The first child element of that name.
    pub(in crate::io) fn child(&self, name: &str) -> Option<&Element<'a>> {
        self.children.iter().find(|child| child.name == name)
    }

    /// The child elements of that name.
    pub(in crate::io) fn children_named<'e>(&'e self, name: &'e str) -> impl Iterator<Item = &'e Element<'a>> {
        self.children.iter().filter(move |child| child.name == name)
    }

    /// The whole number that attribute `name` holds; `default`, if there is one, where it is missing.
    pub(in crate::io) fn count(&self, name: &str, default: Option<usize>, source: Source<'_>) -> Result<usize> {
        let missing = || source.malformed(self.place(), format!("has no attribute {name:?}"));
        let Some(text) = self.attribute(name) else { return default.ok_or_else(missing) };
        text.trim().parse().map_err(|_| {
            source.malformed(self.place(), format!("{name}={} is no whole number", quote(text.as_bytes())))
        })
    }

    /// The element, for a message.
    pub(in crate::io) fn place(&self) -> String {
        match self.attribute("Name") {
            Some(name) => format!("<{}> {} at byte {}", self.name, quote(name.as_bytes()), self.byte),
            None => format!("<{}> at byte {}", self.name, self.byte),
        }
    }
}

/// The XML part of a file, and what stands after `<AppendedData …>_`.
pub(in crate::io) fn split_appended(bytes: &[u8]) -> (&[u8], Option<&[u8]>) {
    const TAG: &[u8] = b"<AppendedData";
    let Some(tag) = bytes.windows(TAG.len()).position(|window| window == TAG) else { return (bytes, None) };
    let Some(length) = bytes[tag..].iter().position(|&byte| byte == b'>') else { return (bytes, None) };
    let (xml, rest) = bytes.split_at(tag + length + 1);
    if xml.ends_with(b"/>") {
        return (bytes, None);
    }
    (xml, rest.trim_ascii_start().strip_prefix(b"_"))
}

/// The root element of `text`; with `open_end`, elements may be open at its end.
pub(in crate::io) fn parse<'a>(text: &'a str, open_end: bool, source: Source<'_>) -> Result<Element<'a>> {
    let mut reader = Reader::from_str(text.trim_start_matches('\u{feff}'));
    let mut open: Vec<Element<'a>> = Vec::new();
    // How deep the reader is inside a child of a DataArray.
    let mut skipped = 0_usize;
    let mut elements = 0_usize;
    loop {
        let byte = reader.buffer_position();
        let at = |byte: u64| format!("byte {byte}");
        let event = reader.read_event().map_err(|error| {
            source.malformed(at(reader.error_position()), format!("is not well-formed XML: {error}"))
        })?;
        elements += usize::from(matches!(event, Event::Start(_) | Event::Empty(_)));
        if elements > MOST_ELEMENTS {
            return Err(source.malformed(at(byte), format!("there are more than {MOST_ELEMENTS} elements")));
        }
        let in_array = open.last().is_some_and(|parent| parent.name == "DataArray" || parent.name == "Array");
        match event {
            Event::Start(_) if in_array => skipped += 1,
            Event::End(_) if skipped > 0 => skipped -= 1,
            Event::Empty(_) if in_array => {}
            Event::Start(tag) => {
                if open.len() == DEEPEST {
                    return Err(source.malformed(at(byte), format!("elements are nested more than {DEEPEST} deep")));
                }
                open.push(element(&tag, byte, source)?);
            }
            Event::Empty(tag) => {
                let element = element(&tag, byte, source)?;
                match open.last_mut() {
                    Some(parent) => parent.children.push(element),
                    None => return Ok(element),
                }
            }
            Event::End(_) => {
                if let Some(root) = close(&mut open) {
                    return Ok(root);
                }
            }
            Event::Text(text) if skipped == 0 => append(open.last_mut(), text.into_inner()),
            Event::CData(text) if skipped == 0 => append(open.last_mut(), text.into_inner()),
            Event::Eof => break,
            _ => {}
        }
    }
    if !open_end && let Some(last) = open.last() {
        return Err(source.malformed(last.place(), "is not closed: the file is truncated"));
    }
    while !open.is_empty() {
        if let Some(root) = close(&mut open) {
            return Ok(root);
        }
    }
    Err(source.malformed("byte 0", "holds no XML element: this is no VTK XML file"))
}

/// Moves the innermost open element into its parent; the root comes back.
fn close<'a>(open: &mut Vec<Element<'a>>) -> Option<Element<'a>> {
    let element = open.pop()?;
    match open.last_mut() {
        Some(parent) => {
            parent.children.push(element);
            None
        }
        None => Some(element),
    }
}

fn append<'a>(element: Option<&mut Element<'a>>, text: Cow<'a, str>) {
    let Some(element) = element else { return };
    if element.text.is_empty() {
        if !text.trim_ascii().is_empty() {
            element.text = text;
        }
    } else {
        element.text.to_mut().push_str(&text);
    }
}

fn element<'a>(tag: &BytesStart<'_>, byte: u64, source: Source<'_>) -> Result<Element<'a>> {
    let name = tag.name().as_ref().to_owned();
    let malformed =
        |problem: String| source.malformed(format!("<{name}> at byte {byte}"), format!("bad attribute: {problem}"));
    let mut attributes = Vec::new();
    // Repeated names are not looked for, which takes quadratic time: the first counts.
    for attribute in tag.attributes().with_checks(false) {
        let attribute = attribute.map_err(|error| malformed(error.to_string()))?;
        let value = quick_xml::escape::unescape(&attribute.value).map_err(|error| malformed(error.to_string()))?;
        attributes.push((attribute.key.as_ref().to_owned(), value.into_owned()));
    }
    Ok(Element { name, attributes, children: Vec::new(), text: Cow::Borrowed(""), byte })
}
