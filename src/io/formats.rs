//! The table of formats: those that are read, and those that are known and refused by name.

use std::path::Path;

use super::collection::{read_pvd_in, read_vtm_in};
use super::mapping::Mapped;
use super::nrrd::read_nrrd_in;
use super::openfoam::read_openfoam_in;
use super::plot3d::read_plot3d_in;
use super::pvtu::read_pvtu_in;
use super::vti::{read_pvti_in, read_vti_in};
use super::vtk_legacy::read_vtk_in;
use super::vtu::read_vtu_in;
use super::{Mesh, Scratch, vts};
use crate::error::{Error, Result};

/// A format that is read.
#[derive(Debug)]
pub struct Format {
    /// What it is called.
    pub name: &'static str,
    /// Extensions of its files, in lower case.
    pub extensions: &'static [&'static str],
    /// Whether a file that begins like this is of the format, whatever it is called.
    pub recognises: fn(&[u8]) -> bool,
    /// Reads the bytes of a file with a name; its columns go where the scratch says.
    pub read: fn(&[u8], &Path, &Scratch) -> Result<Mesh>,
}

/// A format that is known and not read.
#[derive(Debug)]
pub struct Refused {
    /// What it is called.
    pub name: &'static str,
    /// Extensions of its files, in lower case.
    pub extensions: &'static [&'static str],
    /// How its files begin; empty where they may begin with anything.
    pub magic: &'static [u8],
    /// What to do instead.
    pub advice: &'static str,
}

/// How many bytes at the beginning of a file decide on its format.
pub const HEAD_BYTES: usize = 4096;

/// The formats that are read.
pub const READ: &[Format] = &[
    Format {
        name: "VTK XML unstructured grid",
        extensions: &["vtu"],
        recognises: |bytes| xml_type(bytes).is_some_and(|kind| kind == b"UnstructuredGrid"),
        read: |bytes, path, scratch| read_vtu_in(bytes, path, scratch).map(Mesh::from),
    },
    Format {
        name: "VTK XML parallel unstructured grid",
        extensions: &["pvtu"],
        recognises: |bytes| xml_type(bytes).is_some_and(|kind| kind == b"PUnstructuredGrid"),
        read: |bytes, path, scratch| read_pvtu_in(bytes, path, scratch).map(Mesh::from),
    },
    Format {
        name: "VTK XML structured grid",
        extensions: &["vts"],
        recognises: |bytes| xml_type(bytes).is_some_and(|kind| kind == b"StructuredGrid"),
        read: |bytes, path, scratch| vts::read_file(bytes, path, &vts::STRUCTURED, scratch).map(Mesh::from),
    },
    Format {
        name: "VTK XML parallel structured grid",
        extensions: &["pvts"],
        recognises: |bytes| xml_type(bytes).is_some_and(|kind| kind == b"PStructuredGrid"),
        read: |bytes, path, scratch| vts::read_parallel(bytes, path, &vts::STRUCTURED, scratch).map(Mesh::from),
    },
    Format {
        name: "VTK XML rectilinear grid",
        extensions: &["vtr"],
        recognises: |bytes| xml_type(bytes).is_some_and(|kind| kind == b"RectilinearGrid"),
        read: |bytes, path, scratch| vts::read_file(bytes, path, &vts::RECTILINEAR, scratch).map(Mesh::from),
    },
    Format {
        name: "VTK XML parallel rectilinear grid",
        extensions: &["pvtr"],
        recognises: |bytes| xml_type(bytes).is_some_and(|kind| kind == b"PRectilinearGrid"),
        read: |bytes, path, scratch| vts::read_parallel(bytes, path, &vts::RECTILINEAR, scratch).map(Mesh::from),
    },
    Format {
        name: "VTK XML image",
        extensions: &["vti"],
        recognises: |bytes| xml_type(bytes).is_some_and(|kind| kind == b"ImageData"),
        read: |bytes, path, scratch| read_vti_in(bytes, None, path, scratch).map(Mesh::from),
    },
    Format {
        name: "VTK XML parallel image",
        extensions: &["pvti"],
        recognises: |bytes| xml_type(bytes).is_some_and(|kind| kind == b"PImageData"),
        read: |bytes, path, scratch| read_pvti_in(bytes, path, scratch).map(Mesh::from),
    },
    Format {
        name: "VTK XML multi-block",
        extensions: &["vtm"],
        recognises: |bytes| xml_type(bytes).is_some_and(|kind| kind == b"vtkMultiBlockDataSet"),
        read: read_vtm_in,
    },
    Format {
        name: "VTK collection",
        extensions: &["pvd"],
        recognises: |bytes| xml_type(bytes).is_some_and(|kind| kind == b"Collection"),
        read: read_pvd_in,
    },
    Format {
        name: "VTK legacy",
        extensions: &["vtk"],
        recognises: |bytes| bytes.starts_with(b"# vtk DataFile"),
        read: read_vtk_in,
    },
    Format {
        name: "NRRD",
        extensions: &["nrrd", "nhdr"],
        recognises: |bytes| bytes.starts_with(b"NRRD000"),
        read: |bytes, path, scratch| read_nrrd_in(bytes, None, path, scratch).map(Mesh::from),
    },
    Format {
        name: "PLOT3D",
        extensions: &["xyz", "x", "p3d", "bin"],
        // It begins with numbers, as anything may.
        recognises: |_| false,
        read: |bytes, path, scratch| read_plot3d_in(bytes, path, scratch).map(Mesh::from),
    },
    Format {
        name: "OpenFOAM",
        extensions: &["foam"],
        // It is empty, and stands in the folder of the case.
        recognises: |_| false,
        read: |_, path, scratch| {
            let folder = path.parent().unwrap_or(path);
            read_openfoam_in(folder, scratch).map(Mesh::from)
        },
    },
];

const TO_VTU: &str = "convert it to .vtu, for example with ParaView or meshio";
const VOLUME: &str = "convert it to NRRD or a VTK image (.vti), for example with 3D Slicer or ParaView";

const fn refused(name: &'static str, extensions: &'static [&'static str], advice: &'static str) -> Refused {
    Refused { name, extensions, magic: b"", advice }
}

/// The formats that are refused by name.
pub const REFUSED: &[Refused] = &[
    Refused { magic: b"\x1f\x8b", ..refused("gzip-compressed data", &[], "uncompress it first (gunzip)") },
    Refused { magic: b"PK\x03\x04", ..refused("a zip archive", &["zip"], "unpack it first") },
    Refused { magic: b"CDF\x01", ..refused("Exodus II (NetCDF)", &["ex2", "exo", "exii", "e", "g", "gen"], TO_VTU) },
    Refused { magic: b"CDF\x02", ..refused("NetCDF", &["nc", "ncdf"], TO_VTU) },
    refused("CGNS", &["cgns"], TO_VTU),
    refused("VTKHDF", &["vtkhdf"], TO_VTU),
    Refused { magic: b"\x89HDF", ..refused("HDF5", &["h5", "hdf", "hdf5"], TO_VTU) },
    refused("NIfTI", &["nii"], VOLUME),
    refused("a VolVis volume (SLC)", &["slc"], VOLUME),
    refused("a MetaImage volume", &["mhd", "mha"], VOLUME),
    refused(
        "a raw volume without its sizes",
        &["raw"],
        "say how its samples stand in it (--raw 256x256x110:u8), or give a NRRD header (.nhdr) that names it",
    ),
    refused("a VTK XML surface", &["vtp", "pvtp"], "cellfan draws cells with a volume"),
    refused("a VTK partitioned collection", &["vtpc", "vtpd"], "give the files it names, all of them"),
    refused("a PLOT3D solution", &["q"], "name its grid: a solution beside it is found by its name"),
    Refused { magic: b"$MeshFormat", ..refused("Gmsh", &["msh"], TO_VTU) },
    Refused { magic: b"MeshVersionFormatted", ..refused("Medit", &["mesh", "meshb"], TO_VTU) },
    refused("OFF", &["off"], TO_VTU),
    refused("Abaqus", &["inp"], TO_VTU),
    refused("Ensight", &["case"], TO_VTU),
    refused("XDMF", &["xdmf", "xmf"], TO_VTU),
    refused("TetGen", &["node", "ele"], TO_VTU),
    refused("a SCIRun field", &["fld"], TO_VTU),
    refused("a Spark98 pack file", &["pack"], TO_VTU),
    refused(
        "a surface",
        &["stl", "obj", "ply"],
        "cellfan draws cells with a volume, and surfaces beside them (--mesh)",
    ),
];

/// Reads a file that is mapped.
pub(super) type ReadMapped = fn(&Mapped, &Path, &Scratch) -> Result<Mesh>;

/// What reads files of a format whose arrays are used in place where they stand as memory has them.
pub(super) fn in_place(format: &Format) -> Option<ReadMapped> {
    match format.name {
        "NRRD" => Some(|file, path, scratch| read_nrrd_in(file.bytes(), Some(file), path, scratch).map(Mesh::from)),
        "VTK XML image" => {
            Some(|file, path, scratch| read_vti_in(file.bytes(), Some(file), path, scratch).map(Mesh::from))
        }
        _ => None,
    }
}

/// The format of a file: by how it begins, else by its extension.
///
/// # Errors
/// [`Error::Unsupported`] with the format's name, if it has one, and what to do.
///
/// ```
/// # use cellfan::io::formats::find;
/// assert_eq!(find(b"# vtk DataFile Version 3.0", "any.name".as_ref()).unwrap().name, "VTK legacy");
/// assert!(find(b"", "can.ex2".as_ref()).unwrap_err().to_string().contains("Exodus"));
/// ```
pub fn find(bytes: &[u8], path: &Path) -> Result<&'static Format> {
    let extension_of = |path: &Path| path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    let extension = match extension_of(path).as_str() {
        // mesh.nii.gz is called by what is in it.
        "gz" => extension_of(path.file_stem().unwrap_or_default().as_ref()),
        extension => extension.to_owned(),
    };
    let refuse = |format: &Refused| {
        let (what, advice) = (format.name.to_owned(), format.advice.to_owned());
        Error::Unsupported { path: path.to_owned(), what, advice }
    };
    if let Some(format) = READ.iter().find(|format| (format.recognises)(bytes)) {
        return Ok(format);
    }
    let begins = |format: &&Refused| !format.magic.is_empty() && bytes.starts_with(format.magic);
    let is_called = |format: &&Refused| format.extensions.contains(&extension.as_str());
    if let Some(format) = REFUSED.iter().find(is_called) {
        return Err(refuse(format));
    }
    if let Some(format) = REFUSED.iter().find(begins) {
        return Err(refuse(format));
    }
    if let Some(format) = READ.iter().find(|format| format.extensions.contains(&extension.as_str())) {
        return Ok(format);
    }
    let known: Vec<String> = READ.iter().map(|f| format!("{} (.{})", f.name, f.extensions.join(", ."))).collect();
    let what = "a file that is no mesh by its first bytes or its extension".to_owned();
    Err(Error::Unsupported { path: path.to_owned(), what, advice: format!("give one of: {}", known.join(", ")) })
}

/// The `type` of the `VTKFile` element near the beginning of a file.
fn xml_type(bytes: &[u8]) -> Option<&[u8]> {
    let head = &bytes[..bytes.len().min(HEAD_BYTES)];
    let after = |text: &[u8], what: &[u8]| text.windows(what.len()).position(|window| window == what);
    let tag = &head[after(head, b"<VTKFile")?..];
    let tag = &tag[..tag.iter().position(|&byte| byte == b'>')?];
    let value = tag[after(tag, b"type=")? + 5..].trim_ascii_start();
    let (&quote, value) = value.split_first()?;
    Some(&value[..value.iter().position(|&byte| byte == quote)?])
}
