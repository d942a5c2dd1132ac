//! Structured grids.

use std::path::Path;

use super::{Seeds, shared};

pub(crate) const PLOT3D_WORDS: &[&str] = &[
    "2 2 2\n",
    "1\n2 2 2\n",
    "3 3\n",
    "1.5D+03",
    "nan",
    "*",
    "\0\0\0\u{2}",
    "\u{2}\0\0\0",
    "\0\0\0\u{c}",
    "\u{4}\0\0\0",
    "\0\0\0\u{1}",
];

/// Where point `point` of `dims` points lies along `axis`.
fn coordinate([ni, nj, _]: [usize; 3], point: usize, axis: usize) -> usize {
    [point % ni, point / ni % nj, point / ni / nj][axis]
}

pub(crate) fn vts() -> Seeds {
    let piece = |first: usize, dims: [usize; 3]| {
        let [i, j, k] = dims.map(|n| n - 1);
        let points: Vec<String> = (0..dims.iter().product::<usize>())
            .map(|p| {
                format!("{} {} {}", first + coordinate(dims, p, 0), coordinate(dims, p, 1), coordinate(dims, p, 2))
            })
            .collect();
        format!(
            "<Piece Extent='{first} {} 0 {j} 0 {k}'><PointData/><CellData><DataArray type='UInt8' Name='vtkGhostType' \
             format='ascii'>{}</DataArray></CellData>\n<Points><DataArray type='Float32' NumberOfComponents='3' \
             format='ascii'>{}</DataArray></Points></Piece>\n",
            first + i,
            "0 ".repeat(i.max(1) * j.max(1) * k.max(1)),
            points.join(" ")
        )
    };
    let file = |pieces: &str| {
        format!(
            "<?xml version='1.0'?>\n<VTKFile type='StructuredGrid' byte_order='LittleEndian'>\n<StructuredGrid \
             WholeExtent='0 9 0 2 0 2'>\n{pieces}</StructuredGrid></VTKFile>\n"
        )
        .into_bytes()
    };
    let mut seeds = vec![
        file(&piece(0, [3, 3, 3])),
        file(&(piece(0, [4, 3, 2]) + &piece(2, [4, 3, 3]) + &piece(5, [2, 2, 2]))),
        file(&piece(1, [3, 3, 1])),
        file(""),
    ];
    seeds
        .extend(shared(&["vts"], 20_000).into_iter().filter(|file| cellfan::io::read_vts(file, Path::new("")).is_ok()));
    seeds
}

pub(crate) fn vtr() -> Seeds {
    let axis = |values: &str| format!("<DataArray type='Float64' format='ascii'>{values}</DataArray>\n");
    let file = format!(
        "<?xml version='1.0'?>\n<VTKFile type='RectilinearGrid' byte_order='LittleEndian'>\n<RectilinearGrid \
         WholeExtent='-1 1 0 1 3 5'>\n<Piece Extent='-1 1 0 1 3 5'>\n<CellData><DataArray type='Int16' Name='c' \
         format='ascii'>1 2 3 4</DataArray></CellData>\n<Coordinates>\n{}{}{}</Coordinates></Piece></RectilinearGrid></VTKFile>\n",
        axis("0 1 3"),
        axis("5 6"),
        axis("-1 0 0.5")
    );
    let mut seeds = vec![file.into_bytes()];
    seeds.extend(shared(&["vtr"], 20_000));
    seeds
}

/// Legacy files of both kinds.
pub(super) fn legacy() -> Seeds {
    let dims = [3, 2, 2];
    let points: Vec<String> =
        (0..12).map(|p| [0, 1, 2].map(|axis| coordinate(dims, p, axis).to_string()).join(" ")).collect();
    let head = "# vtk DataFile Version 3.0\na title\nASCII\nDATASET";
    let data = "CELL_DATA 2\nSCALARS a int 1\nLOOKUP_TABLE default\n3 4\n";
    let curved = format!(
        "{head} STRUCTURED_GRID\nDIMENSIONS 3 2 2\nPOINTS 12 float\n{}\nBLANKING 12 unsigned_char\n1 1 1 1 1 1 1 1 0 1 1 1\n{data}",
        points.join("\n")
    );
    let axes = format!(
        "{head} RECTILINEAR_GRID\nDIMENSIONS 3 2 2\nX_COORDINATES 3 float\n0 1 2\nY_COORDINATES 2 double\n0 1\n\
         Z_COORDINATES 2 int\n0 1\n{data}"
    );
    vec![curved.into_bytes(), axes.into_bytes()]
}

/// How a seed is written: text, or big-endian with or without record marks.
#[derive(Clone, Copy, PartialEq)]
enum Form {
    Text,
    Raw,
    Marked,
}

impl Form {
    fn record(self, integers: &[usize], reals: &[f32], more: &[usize]) -> Vec<u8> {
        let text = |word: String| (word + "\n").into_bytes();
        let integer = |&n: &usize| {
            if self == Self::Text { text(n.to_string()) } else { (n as u32).to_be_bytes().to_vec() }
        };
        let real = |x: &f32| if self == Self::Text { text(format!("{x:.6e}")) } else { x.to_be_bytes().to_vec() };
        let values: Vec<u8> = integers
            .iter()
            .flat_map(integer)
            .chain(reals.iter().flat_map(real))
            .chain(more.iter().flat_map(integer))
            .collect();
        let mark = if self == Self::Marked { (values.len() as u32).to_be_bytes().to_vec() } else { Vec::new() };
        [mark.clone(), values, mark].concat()
    }

    fn header(self, dims: &[[usize; 3]]) -> Vec<u8> {
        let count = if dims.len() == 1 { Vec::new() } else { self.record(&[dims.len()], &[], &[]) };
        [count, self.record(dims.as_flattened(), &[], &[])].concat()
    }
}

const ONE: &[[usize; 3]] = &[[3, 2, 2]];
const TWO: &[[usize; 3]] = &[[3, 2, 2], [2, 2, 2]];

/// Grids; the first is that of the solutions.
pub(crate) fn plot3d() -> Seeds {
    let write = |form: Form, dims: &[[usize; 3]], has_iblank: bool| {
        let blocks = dims.iter().flat_map(|&dims| {
            let n: usize = dims.iter().product();
            let reals: Vec<f32> = (0..3 * n).map(|i| coordinate(dims, i % n, i / n) as f32).collect();
            let iblank: Vec<usize> = (0..if has_iblank { n } else { 0 }).map(|i| usize::from(i != 4)).collect();
            form.record(&[], &reals, &iblank)
        });
        form.header(dims).into_iter().chain(blocks).collect::<Vec<u8>>()
    };
    let forms = [Form::Raw, Form::Marked, Form::Text];
    let one = forms.iter().flat_map(|&form| [write(form, ONE, false), write(form, TWO, true)]);
    one.collect()
}

/// Solutions of the first grid.
pub(crate) fn plot3d_solution() -> Seeds {
    let write = |form: Form| {
        let values: Vec<f32> = (0..5 * 12).map(|i| i as f32).collect();
        [form.header(ONE), form.record(&[], &[0.5; 4], &[]), form.record(&[], &values, &[])].concat()
    };
    [Form::Raw, Form::Marked, Form::Text].map(write).to_vec()
}
