//! What once got through, by kind; and what is known to break readers elsewhere.

use crate::harness::{self, Ran, alone};
use crate::seeds::{self, Style};
use crate::targets::{self, named};

/// Reads within the reader's limits.
#[track_caller]
fn ran(reader: &str, input: impl AsRef<[u8]>) -> Ran {
    let ran = harness::run(named(reader), input.as_ref());
    assert_eq!(ran.failure, None, "{reader}");
    let len = input.as_ref().len();
    if len > 1 << 16 || ran.peak > 1 << 26 {
        let times = ran.peak as f64 / len as f64;
        println!("{reader}: {} KiB: {times:.1} times in {:.0} ms", len >> 10, ran.duration.as_secs_f64() * 1e3);
    }
    ran
}

/// Refused, by a message that says all of `parts`.
#[track_caller]
fn refused(reader: &str, input: impl AsRef<[u8]>, parts: &[&str]) {
    let message = ran(reader, input).read.expect_err(reader);
    for part in parts {
        assert!(message.contains(part), "{reader}: {part:?} is not in {message:?}");
    }
}

fn vtu(inside: &str) -> String {
    format!("<VTKFile type='UnstructuredGrid'><UnstructuredGrid>{inside}</UnstructuredGrid></VTKFile>")
}

fn vtk(rest: &str) -> String {
    format!("# vtk DataFile Version 3.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\n{rest}")
}

#[test]
fn entities_are_not_expanded() {
    let _alone = alone();
    let laughs = (1..10)
        .map(|i| format!("<!ENTITY l{i} '{}'>", format!("&l{};", i - 1).repeat(10)))
        .collect::<Vec<_>>()
        .concat();
    let bomb = format!("<?xml version='1.0'?><!DOCTYPE a [<!ENTITY l0 'ha'>{laughs}]>");
    let in_attribute = vtu("<Piece NumberOfPoints='&l9;'/>");
    refused("vtu", bomb.clone() + &in_attribute, &["bad attribute", "l9"]);
    let in_text = vtu(
        "<Piece NumberOfPoints='1'><Points><DataArray type='Float32' format='ascii'>&l9; &l9; &l9;</DataArray></Points></Piece>",
    );
    refused("vtu", bomb + &in_text, &["values where 3 are needed"]);
    let file = "<!DOCTYPE a [<!ENTITY e SYSTEM 'file:///etc/passwd'>]>";
    refused("vtu", file.to_owned() + &vtu("<Piece NumberOfPoints='&e;'/>"), &["bad attribute"]);
    refused("vtu", "<!DOCTYPE a [".repeat(10_000), &["XML"]);
}

#[test]
fn depth_is_bounded() {
    let _alone = alone();
    refused("vtu", vtu(&"<a>".repeat(100_000)), &["nested more than 32 deep"]);
    refused("vtu", vtu(&format!("<DataArray>{}", "<a>".repeat(100_000))), &["not well-formed"]);
    for open in ["[", "{\"points\":", "[{\"RGBPoints\":"] {
        refused("transfer-json", open.repeat(100_000), &["transfer function"]);
        refused("camera", open.repeat(100_000), &["camera"]);
    }
}

#[test]
fn messages_are_short() {
    let _alone = alone();
    let long = "a".repeat(100_000);
    refused("vtu", format!("<{long}></{long}b>"), &["…"]);
    refused("vtu", format!("<{long}/>"), &["…", "no VTK XML file"]);
    refused("vtu", vtu(&format!("<Piece NumberOfPoints='1' Name='{long}'/>")), &["holds no <Points>"]);
    refused("pvtu", seeds::pvtu_of(&[&long]), &["no name of a file"]);
    refused("vtk", vtk(&long), &["…", "no section"]);
    refused("vtk", vtk("").replace("UNSTRUCTURED_GRID", &long), &["not supported"]);
    let infinite = seeds::vtk()
        .iter()
        .map(|file| String::from_utf8_lossy(file).into_owned())
        .find(|text| text.contains("a int 1"));
    let infinite = infinite
        .unwrap()
        .replace("a int 1", &format!("{long} float 1"))
        .replace("default\n3 4\n", "default\ninf inf\n");
    refused("draw", infinite, &["…", "no finite value"]);
    refused("transfer-json", format!("{{\"points\": [{{\"{long}\": 0}}]}}"), &["…"]);
    refused("transfer-csv", format!("0 0 0 0 {long}"), &["…", "not a number"]);
    refused("paraview", format!("[{{\"Name\": \"{long}\", \"RGBPoints\": []}}]"), &["…", "has 0 numbers"]);
    refused("camera", format!("{{\"{long}\": 0}}"), &["…"]);
}

/// A container whose directory has `text` in place of `word`; it vouches for it.
fn container_with(word: &str, text: &str) -> Vec<u8> {
    let bytes = seeds::container().swap_remove(0);
    let offset = u64::from_le_bytes(bytes[24..32].try_into().unwrap()) as usize;
    let directory = String::from_utf8(bytes[offset..].to_vec()).unwrap();
    assert!(directory.contains(word));
    let mut changed = [&bytes[..offset], directory.replacen(word, text, 1).as_bytes()].concat();
    targets::vouch(&mut changed);
    changed
}

#[test]
fn containers_are_short_and_harmless_in_what_they_say() {
    let _alone = alone();
    let long = "a".repeat(100_000);
    refused(
        "container",
        container_with("value\",\"association\":\"point", &format!("{long}\",\"association\":\"cell")),
        &["…"],
    );
    refused("container", container_with("\"point\"", &format!("\"{long}\"")), &["…"]);
    refused("container", container_with("\"point\"", "\"\\u001b[2J\""), &["unknown variant"]);
    ran("container", container_with("\"value\"", "\"\\u001b[2J\""));
}

/// Every place of a container's floats in turn, in cells of every kind.
#[test]
fn corners_that_are_nowhere_are_not_drawn() {
    let _alone = alone();
    let word = |bytes: &[u8], at: usize| u64::from_le_bytes(bytes[at..at + 8].try_into().unwrap()) as usize;
    for container in seeds::container().into_iter().skip(3) {
        for at in (64..word(&container, 24).min(1500)).step_by(4) {
            let mut bytes = container.clone();
            bytes[at..at + 4].copy_from_slice(&f32::NAN.to_le_bytes());
            targets::vouch(&mut bytes);
            ran("container", bytes);
        }
    }
}

#[test]
fn nothing_that_a_terminal_obeys_is_said() {
    let _alone = alone();
    for reader in ["vtu", "pvtu", "vtk", "transfer-json", "transfer-csv", "paraview", "camera"] {
        for text in
            ["\u{1b}[2J", "<\u{1b}[2J\u{9b}>", "{\"\u{1b}[2J\": 1}", "[{\"RGBPoints\": [], \"Name\": \"\\u001b[2J\"}]"]
        {
            ran(reader, text);
        }
    }
    ran("vtk", vtk("\u{1b}[2J 1 2"));
    ran("vtk", vtk("POINT_DATA 0\nSCALARS %1b[2J int\n"));
    ran(
        "vtu",
        vtu("<Piece NumberOfPoints='0'><PointData><DataArray type='Int8' Name='&#27;[2J'/></PointData></Piece>"),
    );
    refused("pvtu", seeds::pvtu_of(&["&#27;[2J.vtu"]), &["no name of a file"]);
}

#[test]
fn pieces_do_not_lead_back() {
    let _alone = alone();
    refused("pvtu", seeds::pvtu_of(&["self.pvtu"]), &["self.pvtu", "PUnstructuredGrid"]);
    refused("pvtu", seeds::pvtu_of(&["0.vtu", "1.vtu", "./0.vtu"]), &["an earlier piece"]);
    refused("pvtu", seeds::pvtu_of(&["/dev/zero"]), &["no file"]);
    refused("pvtu", seeds::pvtu_of(&["."]), &["no file"]);
    refused("pvtu", seeds::pvtu_of(&[""]), &["no file"]);
    refused("pvtu", seeds::pvtu_of(&["missing.vtu"]), &["missing.vtu"]);
    refused("pvtu", seeds::pvtu_of(&["a&#0;b"]), &[""]);
}

#[test]
fn bombs_are_refused_before_they_expand() {
    let _alone = alone();
    for (compressor, mebibytes) in
        [("vtkZLibDataCompressor", 20), ("vtkLZ4DataCompressor", 48), ("vtkLZMADataCompressor", 18)]
    {
        let bytes = mebibytes << 20;
        for place in ["inline", "raw"] {
            for block in [bytes, 1 << 20] {
                let style = Style { place, compressor: Some(compressor), wide: true };
                let bomb = seeds::write_zeros(style, bytes, block);
                let ran = ran("vtu", &bomb);
                let message = ran.read.expect_err(compressor);
                assert!(message.contains("64 times the file"), "{compressor}: {message}");
                assert!(ran.peak < 8 * bomb.len() + (1 << 20), "{compressor}: {} for {}", ran.peak, bomb.len());
            }
        }
        // What is not much larger than a small file may be is read.
        let small =
            seeds::write_zeros(Style { place: "raw", compressor: Some(compressor), wide: true }, 3 << 20, 1 << 15);
        assert_eq!(ran("vtu", small).read, Ok(()), "{compressor}");
    }
}

#[test]
fn blocks_of_a_byte_take_no_time() {
    let _alone = alone();
    for compressor in ["vtkZLibDataCompressor", "vtkLZ4DataCompressor", "vtkLZMADataCompressor"] {
        let style = Style { place: "raw", compressor: Some(compressor), wide: false };
        assert_eq!(ran("vtu", seeds::write_zeros(style, 12_000, 1)).read, Ok(()), "{compressor}");
    }
}

#[test]
fn counts_that_lie_are_refused() {
    let _alone = alone();
    for huge in ["18446744073709551615", "9223372036854775807", "6148914691236517206", "4294967296", "1000000000000"] {
        let array = |name: &str| format!("<DataArray type='UInt8' Name='{name}' format='ascii'>0 0 0</DataArray>");
        let points = format!("<Points>{}</Points>", array("Points"));
        refused("vtu", vtu(&format!("<Piece NumberOfPoints='{huge}'>{points}</Piece>")), &["<DataArray>"]);
        let cells = format!("<Cells>{}{}{}</Cells>", array("types"), array("offsets"), array("connectivity"));
        refused("vtu", vtu(&format!("<Piece NumberOfCells='{huge}'>{cells}</Piece>")), &["are needed"]);
        let arrays =
            format!("<PointData><DataArray type='UInt8' NumberOfComponents='{huge}' format='ascii'/></PointData>");
        refused("vtu", vtu(&format!("<Piece NumberOfPoints='1'>{points}{arrays}</Piece>")), &["are needed"]);
        for section in [
            "POINTS N float\n0 0 0\n",
            "CELLS N 3\n0 0 0\n",
            "CELLS 1 N\n0 0 0\n",
            "CELLS N N\nOFFSETS vtktypeint64\n0 0\n",
            "CELL_TYPES N\n10\n",
            "POINT_DATA N\nSCALARS a float\nLOOKUP_TABLE b\n0 0\n",
            "POINT_DATA 1\nSCALARS a float N\nLOOKUP_TABLE b\n0 0\n",
            "POINT_DATA N\nFIELD a 1\nb 1 N string\n0\n",
            "FIELD a N\n",
            "FIELD a 1\nb N N float\n0\n",
            "CELL_DATA N\nVECTORS a bit\n0\n",
            "LOOKUP_TABLE a N\n",
            "POINT_DATA N\n",
        ] {
            let text = vtk(&section.replace('N', huge));
            refused("vtk", &text, &["a.vtk"]);
            refused("vtk", text.replacen("ASCII", "BINARY", 1), &["a.vtk"]);
        }
    }
}

#[test]
fn many_small_things_take_no_time_and_little_memory() {
    let _alone = alone();
    refused("vtu", vtu(&"<a/>".repeat(1 << 20)), &["1048576 elements"]);
    ran("vtu", vtu(&"<a/>".repeat((1 << 20) - 100)));
    let arrays = (0..20_000).map(|i| format!("<DataArray type='Int8' Name='{i}'/>")).collect::<Vec<_>>().concat();
    refused("vtu", vtu(&format!("<Piece><PointData>{arrays}</PointData></Piece>")), &["4096 arrays"]);
    let arrays = (0..20_000).map(|i| format!("SCALARS {i} int\n")).collect::<Vec<_>>().concat();
    refused("vtk", vtk(&format!("POINT_DATA 0\n{arrays}")), &["4096 arrays"]);
    ran("vtu", vtu(&format!("<Piece {}/>", "a='' ".repeat(200_000))));
    ran("vtu", vtu(&"<Piece/>".repeat(100_000)));
    ran("vtk", vtk(&"POINT_DATA 0\n".repeat(100_000)));
    ran("vtk", vtk(&"METADATA\n\n".repeat(100_000)));
    ran("transfer-csv", "0 0 0 0 0\n".repeat(100_000));
    ran("transfer-json", format!("[{}0]", "0,".repeat(500_000)));
    refused("paraview", format!("[{{\"RGBPoints\": [0{}]}}]", ",0".repeat(99_999)), &["at most 4096"]);
    ran("paraview", format!("[{{\"RGBPoints\": [0{0}], \"Points\": [0{0}]}}]", ",0".repeat(4 * 4096 - 1)));
    ran("paraview", wide_map(4096));
}

/// A map of `n` points that alternate, so that none can be left out.
fn wide_map(n: usize) -> String {
    let rows: Vec<String> = (0..n).map(|i| format!("{i},{0},{0},{0}", i % 2)).collect();
    format!("[{{\"RGBPoints\": [{0}], \"Points\": [{0}]}}]", rows.join(","))
}

/// The shortest text and the fewest bytes for each value, point and cell.
#[test]
fn dense_files_take_a_stated_multiple() {
    let _alone = alone();
    let n = 40_000;
    let zeros = "0 ".repeat(3 * n);
    let eights = (1..=n).map(|i| format!("{} ", 8 * i)).collect::<Vec<_>>().concat();
    let corners = "0 1 2 3 4 5 6 7 ".repeat(n);
    let hexahedra = vtu(&format!(
        "<Piece NumberOfPoints='{n}' NumberOfCells='{n}'><Points><DataArray type='Float64' format='ascii'>{zeros}</DataArray></Points>\
         <Cells><DataArray type='UInt8' Name='types' format='ascii'>{}</DataArray><DataArray type='Int64' Name='offsets' format='ascii'>\
         {eights}</DataArray><DataArray type='Int64' Name='connectivity' format='ascii'>{corners}</DataArray></Cells></Piece>",
        "12 ".repeat(n)
    ));
    assert_eq!(ran("vtu", &hexahedra).read, Ok(()));
    let cell: Vec<u8> = (0..8).collect();
    let offsets: Vec<u8> = (1..=n as u32).flat_map(|i| (8 * i).to_le_bytes()).collect();
    let points = (0..8_u8).flat_map(|i| [i & 1, (i >> 1 ^ i) & 1, i >> 2]).collect();
    let arrays = [
        ("'Points'", "UInt8", points),
        ("'types'", "UInt8", vec![12; n]),
        ("'offsets'", "UInt32", offsets),
        ("'connectivity'", "UInt8", cell.repeat(n)),
    ];
    let mut appended = Vec::new();
    let arrays = arrays.map(|(name, kind, bytes): (_, _, Vec<u8>)| {
        let array = format!("<DataArray Name={name} type='{kind}' format='appended' offset='{}'/>", appended.len());
        appended.extend((bytes.len() as u32).to_le_bytes());
        appended.extend(bytes);
        array
    });
    let piece = format!(
        "<Piece NumberOfPoints='8' NumberOfCells='{n}'><Points>{}</Points><Cells>{}</Cells></Piece>",
        arrays[0],
        arrays[1..].concat()
    );
    let raw = vtu(&piece).replace("</VTKFile>", "<AppendedData encoding='raw'>_");
    assert_eq!(ran("vtu", [raw.as_bytes(), &appended].concat()).read, Ok(()));
    let legacy = vtk(&format!(
        "POINTS {n} float\n{zeros}\nCELLS {n} {}\n{}CELL_TYPES {n}\n{}\nPOINT_DATA {n}\nSCALARS a double\nLOOKUP_TABLE b\n{}",
        9 * n,
        "8 0 1 2 3 4 5 6 7\n".repeat(n),
        "12 ".repeat(n),
        "0 ".repeat(n)
    ));
    assert_eq!(ran("vtk", &legacy).read, Ok(()));
    let bits = [
        vtk("POINT_DATA 800000\nSCALARS a bit\nLOOKUP_TABLE b\n").replace("ASCII", "BINARY").into_bytes(),
        vec![0; 100_000],
    ];
    refused("vtk", bits.concat(), &["POINT_DATA"]);
}

/// Points that a few numbers make, and cells without a byte of their own.
#[test]
fn grids_take_a_stated_multiple() {
    let _alone = alone();
    // As many points as a file of this size may have.
    let n = 70;
    let axis = (0..n).map(|i| format!("{i} ")).collect::<Vec<_>>().concat();
    let array = format!("<DataArray type='Float32' format='ascii'>{axis}</DataArray>");
    let extent = format!("0 {0} 0 {0} 0 {0}", n - 1);
    let piece = format!("<Piece Extent='{extent}'><Coordinates>{}</Coordinates></Piece>", array.repeat(3));
    let xml = format!(
        "<VTKFile type='RectilinearGrid'><RectilinearGrid WholeExtent='{extent}'>{piece}</RectilinearGrid></VTKFile>"
    );
    assert_eq!(ran("vtr", &xml).read, Ok(()));
    refused("vtr", xml.replace(&piece, &piece.repeat(3)), &["64 times the file"]);
    let axes = ["X", "Y", "Z"].map(|name| format!("{name}_COORDINATES {n} float\n{axis}\n")).concat();
    let legacy = vtk(&format!("DIMENSIONS {n} {n} {n}\n{axes}")).replace("UNSTRUCTURED", "RECTILINEAR");
    assert_eq!(ran("vtk", &legacy).read, Ok(()));
    // PLOT3D in text: six bytes a point.
    let points = n * n * n / 4;
    let text = format!("{n} {n} {}\n{}", n / 4, "0 ".repeat(3 * n * n * (n / 4)));
    assert!(text.len() > 5 * points);
    assert_eq!(ran("plot3d", text).read, Ok(()));
    // Every piece meets every other.
    let points = "0 ".repeat(3 * 2 * 2 * 2);
    let array = format!("<Points><DataArray type='Int8' format='ascii'>{points}</DataArray></Points>");
    let pieces = (0..10_000)
        .map(|i| format!("<Piece Extent='0 1 {i} {} 0 1'>{array}</Piece>", i + 1))
        .collect::<Vec<_>>()
        .concat();
    let xml = |pieces: &str| {
        format!(
            "<VTKFile type='StructuredGrid'><StructuredGrid WholeExtent='0 1 0 10001 0 1'>{pieces}</StructuredGrid></VTKFile>"
        )
    };
    assert_eq!(ran("vts", xml(&pieces)).read, Ok(()));
    let same = format!("<Piece Extent='0 1 0 1 0 1'>{array}</Piece>").repeat(10_000);
    refused("vts", xml(&same), &["overlap"]);
}

#[test]
fn values_a_hair_apart_have_values_between() {
    let _alone = alone();
    let point = |value: &str| format!("{{\"value\": {value}, \"color\": [1, 0, 1], \"extinction\": 1}}");
    let text = format!("{{\"points\": [{}, {}, {}]}}", point("0"), point("5e-324"), point("1e-323"));
    assert_eq!(ran("transfer-json", text).read, Ok(()));
    let text = "[{\"ColorSpace\": \"Lab\", \"RGBPoints\": [0, 0, 0, 0, 5e-324, 1, 1, 1]}]";
    assert_eq!(ran("paraview", text).read, Ok(()));
}

#[test]
fn cameras_out_of_all_range_are_refused() {
    let _alone = alone();
    for (more, part) in [
        ("\"eye\": [1e308, 0, 0], \"target\": [-1e308, 0, 0]", "below 1e100"),
        ("\"eye\": [0, 0, 0], \"target\": [0, 1e200, 0]", "below 1e100"),
        ("\"eye\": [0, 0, 0], \"target\": [0, 1e-200, 0]", "same point"),
        ("\"eye\": [0, 0, 0], \"target\": [0, 1, 0], \"fov\": 1e-300", "a pixel is"),
        ("\"eye\": [0, 0, 0], \"target\": [0, 1, 0], \"fov\": 5e-324", "a pixel is"),
        ("\"eye\": [0, 0, 0], \"target\": [0, 1, 0], \"orthographic_height\": 1e300", "a pixel is"),
        ("\"eye\": [0, 0, 0], \"target\": [0, 1, 0], \"width\": 4294967295", "32768"),
        ("\"eye\": [0, 0, 0], \"target\": [0, 1, 0], \"width\": 1e3", "invalid type"),
        ("\"eye\": [0, 0, 1e999], \"target\": [0, 1, 0]", "out of range"),
        ("\"eye\": [0, 0, NaN], \"target\": [0, 1, 0]", "expected value"),
    ] {
        refused("camera", format!("{{{more}}}"), &[part]);
    }
}
