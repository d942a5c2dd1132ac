//! Small good files of every format, in every encoding; real ones besides, where `CELLFAN_DATA` names them.

mod grids;
mod opaque;
mod volumes;
mod vtu;

use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use crate::common::data_folder;

pub(crate) use grids::{PLOT3D_WORDS, plot3d, plot3d_solution, vtr, vts};
pub(crate) use opaque::{EXR_WORDS, OBJ_WORDS, PLY_WORDS, STL_WORDS, depth_images, obj, ply, stl};
pub(crate) use volumes::{NRRD_WORDS, RAW_WORDS, nrrd, nrrd_path, raw, vti};
pub(crate) use vtu::{Style, write_zeros};

/// Files in memory.
pub(crate) type Seeds = Vec<Vec<u8>>;

pub(crate) const XML_WORDS: &[&str] = &[
    "ascii",
    "binary",
    "appended",
    "raw",
    "base64",
    "Float32",
    "Float64",
    "Int8",
    "UInt8",
    "Int64",
    "UInt64",
    "String",
    "UInt32",
    "BigEndian",
    "LittleEndian",
    "vtkZLibDataCompressor",
    "vtkLZ4DataCompressor",
    "vtkLZMADataCompressor",
    "NumberOfComponents='0'",
    "NumberOfPoints",
    "offset='0'",
    "DataArray",
    "Piece",
    "Points",
    "types",
    "offsets",
    "connectivity",
    "vtkGhostType",
    "<!DOCTYPE a [<!ENTITY b 'cccccccccc'><!ENTITY d '&b;&b;&b;&b;'>]>",
    "<!DOCTYPE a [<!ENTITY e SYSTEM 'file:///etc/passwd'>]>",
    "&d;",
    "&e;",
    "&#65;",
    "<![CDATA[",
    "]]>",
    "<!--",
    "-->",
    "<?a",
    "<AppendedData encoding='raw'>_",
    "</VTKFile>",
    "PUnstructuredGrid",
    "UnstructuredGrid",
    "StructuredGrid",
    "RectilinearGrid",
    "WholeExtent='0 1 0 1 0 1'",
    "Extent='0 1 0 2 0 2'",
    "Extent='0 -1 0 -1 0 -1'",
    "Coordinates",
    "ImageData",
    "Origin='1e308 inf 0'",
    "Spacing='0 nan 1'",
    "Direction='1 0 0 1 0 0 0 0 1'",
    "vtkMultiBlockDataSet",
    "Collection",
    "Block",
    "DataSet",
    "timestep='-1e999'",
    "file='self.vtm'",
    "file='self.pvd'",
    "file='0.vtu'",
    "file='1.vts'",
    "file='../../../../dev/zero'",
    "file=''",
    "Source='self.pvtu'",
    "Source='0.vtu'",
    "Source='../../../../dev/zero'",
    "Source=''",
];

pub(crate) const VTK_WORDS: &[&str] = &[
    "ASCII",
    "BINARY",
    "DATASET",
    "UNSTRUCTURED_GRID",
    "STRUCTURED_GRID",
    "RECTILINEAR_GRID",
    "STRUCTURED_POINTS",
    "SPACING 0 nan 1\n",
    "ASPECT_RATIO",
    "ORIGIN 1e308 inf 0\n",
    "DIMENSIONS",
    "X_COORDINATES",
    "BLANKING",
    "POINTS",
    "CELLS",
    "CELL_TYPES",
    "OFFSETS",
    "CONNECTIVITY",
    "POINT_DATA",
    "CELL_DATA",
    "FIELD",
    "SCALARS",
    "LOOKUP_TABLE",
    "COLOR_SCALARS",
    "TEXTURE_COORDINATES",
    "VECTORS",
    "TENSORS",
    "NULL_ARRAY",
    "METADATA",
    "bit",
    "string",
    "vtktypeint64",
    "vtkIdType",
    "double",
    "unsigned_char",
    "FIELD a 18446744073709551615\n",
    "POINT_DATA 0\n",
];

pub(crate) const JSON_WORDS: &[&str] = &[
    "null",
    "true",
    "[]",
    "{}",
    "\"\"",
    "\"points\"",
    "\"value\":",
    "\"opacity\": 1,",
    "\"extinction\": 0,",
    "\"unit_distance\": 0,",
    "\"RGBPoints\"",
    "\"Points\"",
    "\"HSV\"",
    "\"Lab\"",
    "\"Step\"",
    "\"Diverging\"",
    "\"near\": 1,",
    "\"far\": 2,",
    "\"orthographic_height\": 1e-300,",
    "\"width\": 32768,",
    "\\ud800",
];

pub(crate) const CSV_WORDS: &[&str] = &["#", ";", "\t", "value,r,g,b,extinction\n", "0 0 0 0 0\n", "\r\n", "\u{feff}"];

fn bytes<const N: usize>(texts: [&str; N]) -> Seeds {
    texts.map(|text| text.as_bytes().to_vec()).to_vec()
}

/// Files of the shared data with one of these extensions, smaller than `largest`.
fn shared(extensions: &[&str], largest: u64) -> Seeds {
    let Some(root) = data_folder("the mutation of files") else { return Vec::new() };
    let mut paths = Vec::new();
    files_below(&root, &mut paths);
    paths.sort();
    let fits = |path: &Path| {
        path.extension().is_some_and(|found| extensions.iter().any(|extension| found == *extension))
            && path.metadata().is_ok_and(|file| file.len() <= largest)
    };
    paths.into_iter().filter(|path| fits(path)).map(|path| std::fs::read(path).unwrap()).collect()
}

fn files_below(folder: &Path, paths: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() { files_below(&path, paths) } else { paths.push(path) }
    }
}

pub(crate) fn vtu() -> Seeds {
    let mut seeds: Seeds = Style::all().into_iter().map(vtu::write).collect();
    seeds.extend(shared(&["vtu"], 4096).into_iter().filter(|file| cellfan::io::read_vtu(file, Path::new("")).is_ok()));
    seeds
}

/// A pyramid, a hexagonal prism and a cube, the first and the last as polyhedra: in streams, in lists, in a `.vtk`.
pub(crate) fn polyhedra() -> Seeds {
    let cube = "6 4 5 9 8 4 4 6 7 11 10 4 5 6 10 9 4 8 11 7 4 4 5 4 7 6 4 8 9 10 11";
    let pyramid = "5 4 0 3 2 1 3 0 1 10 3 1 2 10 3 2 3 10 3 3 0 10";
    let prism = "0 1 2 3 4 5 6 7 8 9 10 11";
    let points = "0 0 0 1 0 0 1.5 1 0 1 2 0 0 2 0 -1 1 0 0 0 1 1 0 1 1.5 1 1 1 2 1 0 2 1 -1 1 1";
    let array = |name: &str, kind: &str, values: &str| {
        format!("<DataArray type='{kind}' Name='{name}' format='ascii'>{values}</DataArray>")
    };
    let vtu = |faces: String| {
        format!(
            "<VTKFile type='UnstructuredGrid'><UnstructuredGrid><Piece NumberOfPoints='12' NumberOfCells='3'><Points>\
             <DataArray type='Float32' NumberOfComponents='3' format='ascii'>{points}</DataArray></Points><Cells>{}{}{}{faces}</Cells>\
             <CellData>{}</CellData></Piece></UnstructuredGrid></VTKFile>",
            array("connectivity", "Int64", &format!("0 1 2 3 10 {prism} 4 5 6 7 8 9 10 11")),
            array("offsets", "Int64", "5 17 25"),
            array("types", "UInt8", "42 16 42"),
            array("a", "Float32", "1 2 3"),
        )
        .into_bytes()
    };
    let streams = array("faces", "Int64", &format!("{pyramid} {cube}")) + &array("faceoffsets", "Int64", "22 -1 53");
    let of_cube = "5 9 8 4 6 7 11 10 5 6 10 9 8 11 7 4 5 4 7 6 8 9 10 11";
    let lists = array("face_connectivity", "Int64", &format!("0 3 2 1 0 1 10 1 2 10 2 3 10 3 0 10 {of_cube}"))
        + &array("face_offsets", "Int64", "4 7 10 13 16 20 24 28 32 36 40")
        + &array("polyhedron_to_faces", "Int64", "0 1 2 3 4 5 6 7 8 9 10")
        + &array("polyhedron_offsets", "Int64", "5 5 11");
    let legacy = format!(
        "# vtk DataFile Version 3.0\na title\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 12 float\n{points}\n\
         CELLS 3 68\n22 {pyramid}\n12 {prism}\n31 {cube}\nCELL_TYPES 3\n42 16 42\nCELL_DATA 3\nSCALARS a float 1\n\
         LOOKUP_TABLE default\n1 2 3\n"
    );
    vec![vtu(streams), vtu(lists), legacy.into_bytes()]
}

/// What parts the files of a case, and their names.
pub(crate) const FOAM_END: &str = "\n// the next file\n";
pub(crate) const FOAM_FILES: [&str; 5] = [
    "constant/polyMesh/points",
    "constant/polyMesh/faces",
    "constant/polyMesh/owner",
    "constant/polyMesh/neighbour",
    "0/p",
];

pub(crate) const FOAM_WORDS: &[&str] = &[
    FOAM_END,
    "FoamFile{format ascii; class faceList;}",
    "format binary;",
    "class faceCompactList;",
    "arch \"LSB;label=64;scalar=32\";",
    "internalField uniform 1;",
    "nonuniform List<scalar> 2(",
    "4(0 1 2 3)",
    "999999999{0}",
    "/*",
    "*/",
    "-1",
    "{",
    "}",
];

/// Two tetrahedra with a face in common.
pub(crate) fn openfoam() -> Seeds {
    let file = |class: &str, body: &str| format!("FoamFile{{version 2.0; format ascii; class {class};}}\n{body}");
    let faces = "7(3(1 2 3) 3(0 2 1) 3(0 1 3) 3(0 3 2) 3(1 2 4) 3(2 3 4) 3(3 1 4))";
    let of = |field: &str| {
        let files = [
            file("vectorField", "5((0 0 0)(1 0 0)(0 1 0)(0 0 1)(1 1 1))"),
            file("faceList", faces),
            file("labelList", "7(0 0 0 0 1 1 1)"),
            file("labelList", "1{1} // a comment"),
            file("volScalarField", field),
        ];
        files.join(FOAM_END).into_bytes()
    };
    vec![
        of(
            "dimensions [0 0 0 0 0 0 0]; internalField nonuniform List<scalar> 2(1.5 2);\nboundaryField { a { type b; } }",
        ),
        of("internalField uniform 3;"),
    ]
}

/// A folder with pieces for `.pvtu` files, one for all tests of this program.
pub(crate) fn pieces() -> &'static Path {
    static FOLDER: OnceLock<PathBuf> = OnceLock::new();
    FOLDER.get_or_init(|| {
        let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("pieces-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        for (i, style) in Style::all().into_iter().step_by(5).enumerate() {
            std::fs::write(folder.join(format!("{i}.vtu")), vtu::write(style)).unwrap();
        }
        for (i, grid) in grids::vts().into_iter().enumerate() {
            std::fs::write(folder.join(format!("{i}.vts")), grid).unwrap();
        }
        std::fs::write(folder.join("self.pvtu"), pvtu_of(&["self.pvtu"])).unwrap();
        std::fs::write(folder.join("self.vtm"), multi_block(&["0.vtu", "self.vtm"])).unwrap();
        std::fs::write(folder.join("self.pvd"), collection(&["0.vtu", "self.pvd"])).unwrap();
        std::fs::write(folder.join("good.vtm"), multi_block(&["0.vtu", "1.vtu"])).unwrap();
        folder
    })
}

pub(crate) fn pvtu_of(pieces: &[&str]) -> Vec<u8> {
    let pieces = pieces.iter().map(|piece| format!("<Piece Source='{piece}'/>\n")).collect::<Vec<_>>().concat();
    format!(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"PUnstructuredGrid\" version=\"0.1\">\n<PUnstructuredGrid GhostLevel=\"0\">\n\
         <PPoints>\n<PDataArray type=\"Float32\" NumberOfComponents=\"3\"/></PPoints>\n{pieces}</PUnstructuredGrid>\n</VTKFile>\n"
    )
    .into_bytes()
}

pub(crate) fn pvtu() -> Seeds {
    pieces();
    vec![pvtu_of(&["0.vtu"]), pvtu_of(&["0.vtu", "1.vtu", "2.vtu"]), pvtu_of(&["./1.vtu", "3.vtu"]), pvtu_of(&[])]
}

fn data_sets(files: &[&str]) -> String {
    let one = |(i, file): (usize, &&str)| {
        format!("<DataSet index=\"{i}\" timestep=\"{}\" part=\"{i}\" file=\"{file}\"/>\n", i / 2)
    };
    files.iter().enumerate().map(one).collect::<Vec<_>>().concat()
}

fn multi_block(files: &[&str]) -> Vec<u8> {
    let (first, rest) = files.split_at(files.len() / 2);
    format!(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"vtkMultiBlockDataSet\" version=\"1.0\">\n<vtkMultiBlockDataSet>\n{}\
         <Block index=\"1\" name=\"b\">\n<Piece index=\"0\">\n{}</Piece>\n<DataSet index=\"1\"/>\n</Block>\n\
         </vtkMultiBlockDataSet>\n</VTKFile>\n",
        data_sets(first),
        data_sets(rest)
    )
    .into_bytes()
}

fn collection(files: &[&str]) -> Vec<u8> {
    let files = data_sets(files);
    format!("<VTKFile type=\"Collection\" version=\"0.1\">\n<Collection>\n{files}</Collection>\n</VTKFile>\n")
        .into_bytes()
}

pub(crate) fn vtm() -> Seeds {
    pieces();
    vec![multi_block(&["0.vtu", "0.vts"]), multi_block(&["1.vtu", "./2.vtu", "wall.vtp", "1.vts"]), multi_block(&[])]
}

pub(crate) fn pvd() -> Seeds {
    pieces();
    vec![collection(&["0.vtu", "1.vtu", "none.vtu"]), collection(&["good.vtm", "0.vts"]), collection(&[])]
}

pub(crate) fn vtk() -> Seeds {
    let head = |kind: &str, version: &str| {
        format!("# vtk DataFile Version {version}\na title\n{kind}\nDATASET UNSTRUCTURED_GRID\n")
    };
    let text = head("ASCII", "3.0")
        + "POINTS 5 float\n0 0 0 1 0 0\n0 1 0 0 0 1 1 1 1\nMETADATA\nINFORMATION 0\n\nCELLS 2 10\n4 0 1 2 3\n4 1 2 3 4\n\
           CELL_TYPES 2\n10 10\nCELL_DATA 2\nSCALARS a int 1\nLOOKUP_TABLE default\n3 4\nLOOKUP_TABLE t 2\n0 0 0 1 1 1 1 1\n\
           POINT_DATA 5\nVECTORS v%20w double\n1 2 3 4 5 6 7 8 9 10 11 12 13 14 nan\nFIELD f 3\nb 1 5 float\n1 2 3 4 5\n\
           NULL_ARRAY\ns 1 5 string\na\nb\nc\nd\ne\nCOLOR_SCALARS c 1\n0 0 0 0 1\nTEXTURE_COORDINATES t 2 float\n1 2 3 4 5 6 7 8 9 0\n";
    let new = head("ASCII", "5.1")
        + "FIELD FieldData 1\ntime 1 1 double\n0.5\nPOINTS 5 double\n0 0 0 1 0 0 0 1 0 0 0 1 1 1 1\nCELLS 3 8\nOFFSETS vtktypeint64\n\
           0 4 8\nCONNECTIVITY vtktypeint64\n0 1 2 3 1 2 3 4\nCELL_TYPES 2\n10 10\nPOINT_DATA 5\nSCALARS s bit\nLOOKUP_TABLE default\n1 0 1 0 1\n";
    let mut binary = head("BINARY", "3.0").into_bytes();
    let mut section = |title: &str, values: Vec<u8>| {
        binary.extend(title.bytes().chain([b'\n']).chain(values).chain([b'\n']));
    };
    let words = |values: &[u32]| values.iter().flat_map(|value| value.to_be_bytes()).collect::<Vec<u8>>();
    let points: Vec<u32> = [0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1].map(|c: u8| f32::from(c).to_bits()).to_vec();
    section("POINTS 5 float", words(&points));
    section("CELLS 2 10", words(&[4, 0, 1, 2, 3, 4, 1, 2, 3, 4]));
    section("CELL_TYPES 2", words(&[10, 10]));
    section("POINT_DATA 5\nSCALARS b bit 1\nLOOKUP_TABLE default", vec![0b1010_1000]);
    section("FIELD f 2\ns 1 5 string", b"\xc1a\xc1b\xc0\xc1d\xc3abc".to_vec());
    section("g 1 5 short", vec![0, 1, 0, 2, 0, 3, 0, 4, 0, 5]);
    let mut seeds = vec![text.into_bytes(), new.into_bytes(), binary];
    seeds.extend(grids::legacy());
    seeds.push(volumes::legacy());
    seeds.extend(shared(&["vtk"], 8192).into_iter().filter(|file| cellfan::io::read_vtk(file, Path::new("")).is_ok()));
    seeds
}

pub(crate) fn transfer_json() -> Seeds {
    bytes([
        r#"{"points": [{"value": 0, "color": [1, 0.5, 0], "extinction": 3}, {"value": 1.5, "color": [0, 0, 1], "extinction": 0}]}"#,
        r#"{"points": [{"value": -1e3, "color": [1, 1, 1], "opacity": 0.25}, {"value": -1e3, "color": [1, 1, 1], "opacity": 1}], "unit_distance": 2}"#,
    ])
}

pub(crate) fn bands_json() -> Seeds {
    bytes([
        r#"{"bands": ["soft", "hard"], "points": [{"value": 0, "extinctions": [0, 1]}, {"value": 1.5, "extinctions": [3, 0.5]}]}"#,
        r#"{"points": [{"value": -1e3, "extinctions": [1, 2, 3, 4, 5]}]}"#,
    ])
}

pub(crate) fn transfer_csv() -> Seeds {
    let many = (0..150)
        .map(|i| format!("{i}\t{}\t0.5\t1\t{}\n", f64::from(i) / 150.0, i * i % 7))
        .collect::<Vec<_>>()
        .concat();
    bytes(["# fog\nvalue,r,g,b,extinction\n0, 1, 1, 1, 0 # low\n2; 1; 1; 1; 4\n2 0 0 0 8\n", "0 1 1 1 1\n", &many])
}

pub(crate) fn paraview() -> Seeds {
    bytes([
        r#"[{"ColorSpace": "Diverging", "Name": "a", "NanColor": [1, 0, 0], "RGBPoints": [-1, 0.2, 0.3, 0.7, 0, 0.9, 0.9, 0.9, 1, 0.7, 0, 0.1]}]"#,
        r#"{"ColorSpace": "HSV", "RGBPoints": [0, 1, 0, 0, 1, 0, 0, 1], "Points": [0, 0, 0.5, 0, 0.5, 0.25, 0.1, 1, 1, 1, 0.75, 0.5]}"#,
        r#"[{"Creator": "x"}, {"ColorSpace": "Step", "RGBPoints": [3, 0, 0, 0, 3, 1, 1, 1], "Points": [2, 1, 0.5, 0]}]"#,
        r#"[{"ColorSpace": "Lab", "RGBPoints": [1e-300, 0, 0, 0, 1e300, 1, 1, 1]}]"#,
    ])
}

pub(crate) fn camera() -> Seeds {
    bytes([
        r#"{"eye": [3, -4, 2.5], "target": [0.5, 0, 0.25], "up": [0, 0, 1], "fov": 30, "width": 512, "height": 256, "near": 0.1, "far": 100}"#,
        r#"{"eye": [1e6, 0, 0], "target": [1e6, 1, 0], "orthographic_height": 2.5}"#,
        r#"{"eye": [0, 0, 5], "target": [0, 0, 0]}"#,
    ])
}

/// Files of the shared data of any format, and one of each kind made here.
pub(crate) fn real() -> Seeds {
    let mut seeds = shared(&["vtu", "vtk", "vti", "vtr", "vts", "xyz", "nhdr", "slc", "pvtu", "gen", "exo"], 60_000);
    seeds.extend(vtk());
    seeds.extend(vtu());
    seeds.extend(pvtu());
    seeds.extend(vtm());
    seeds
}

/// Containers of generated meshes, with and without neighbours, of whole cells, listed with neighbours and structured, and of polyhedra.
pub(crate) fn container() -> Seeds {
    use cellfan::generate::{Kind, Settings, generate};
    use cellfan::io::container::{WriteOptions, write, write_structured};
    use cellfan::io::{Scratch, WholeCells, read_mesh};
    let path = pieces().join("seed.cells");
    let kinds = [(Kind::Tets, 40, false), (Kind::Delaunay, 100, true), (Kind::Orbital, 5000, false)];
    let one = |(kind, cells, adjacency)| {
        let mesh = generate(kind, &Settings { cells, ..Settings::default() }).unwrap();
        write(&mesh, &path, &WriteOptions { adjacency, ..WriteOptions::default() }, &|_, _, _| {}).unwrap();
        std::fs::read(&path).unwrap()
    };
    let mut seeds = kinds.map(one).to_vec();
    let grids = vts().into_iter().zip(std::iter::repeat("a.vts")).chain(std::iter::once((mixed_vtk(), "a.vtk")));
    seeds.extend(grids.filter_map(|(file, name)| {
        let written = match read_mesh(&file, Path::new(name)).ok()?.into_whole_in(&Scratch::memory()).ok()? {
            WholeCells::Listed(cells) => {
                write(&cells, &path, &WriteOptions { adjacency: true, ..WriteOptions::default() }, &|_, _, _| {})
            }
            WholeCells::Structured(cells) => write_structured(cells, &path, &|_, _, _| {}),
        };
        written.ok().map(|_| std::fs::read(&path).unwrap())
    }));
    for file in polyhedra() {
        let mesh = read_mesh(&file, Path::new(if file.starts_with(b"#") { "a.vtk" } else { "a.vtu" })).unwrap();
        let Ok(WholeCells::Listed(cells)) = mesh.into_whole_in(&Scratch::memory()) else { continue };
        write(&cells, &path, &WriteOptions::default(), &|_, _, _| {}).unwrap();
        seeds.push(std::fs::read(&path).unwrap());
    }
    assert!(seeds.len() > kinds.len() + 2, "containers of whole cells are among them");
    seeds
}

/// A hexahedron, a wedge on its right, a pyramid on top and a tetrahedron beside that.
fn mixed_vtk() -> Vec<u8> {
    b"# vtk DataFile Version 3.0\na title\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 12 float\n\
      0 0 0 1 0 0 1 1 0.1 0 1 0 0 0 1 1 0.1 1 1 1 1 0 1 1 2 0 0 2 0 1 0.5 0.5 2 2 2 2\n\
      CELLS 4 26\n8 0 1 2 3 4 5 6 7\n6 1 8 2 5 9 6\n5 4 5 6 7 10\n4 5 6 10 11\nCELL_TYPES 4\n12 13 14 10\n\
      CELL_DATA 4\nSCALARS a float 1\nLOOKUP_TABLE default\n1 2 3 4\n\
      POINT_DATA 12\nSCALARS b double 1\nLOOKUP_TABLE default\n0 1 2 3 4 5 6 7 8 9 10 11\n"
        .to_vec()
}
