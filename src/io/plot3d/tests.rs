//! Every way of writing a grid and its solution, and what is none.

use super::*;
use crate::error::Error;
use crate::io::{Mesh, StructuredBlock, open_mesh};

/// How a test writes a file.
#[derive(Clone, Copy, Debug)]
#[expect(clippy::struct_excessive_bools, reason = "one for each choice that a writer has")]
struct Way {
    is_text: bool,
    is_big: bool,
    has_marks: bool,
    is_multi: bool,
    is_double: bool,
    has_iblank: bool,
}

fn ways() -> Vec<Way> {
    let bit = |bits: u32, at: u32| bits >> at & 1 == 1;
    let all = (0..64).map(|bits| Way {
        is_text: bit(bits, 0),
        is_big: bit(bits, 1),
        has_marks: bit(bits, 2),
        is_multi: bit(bits, 3),
        is_double: bit(bits, 4),
        has_iblank: bit(bits, 5),
    });
    all.filter(|way| !way.is_text || !(way.is_big || way.has_marks)).collect()
}

impl Way {
    fn blocks(self) -> Vec<[usize; 3]> {
        if self.is_multi { vec![[3, 4, 2], [2, 2, 5]] } else { vec![[3, 4, 2]] }
    }

    fn integer(self, value: i32) -> Vec<u8> {
        match (self.is_text, self.is_big) {
            (true, _) => format!(" {value}\n").into_bytes(),
            (_, true) => value.to_be_bytes().to_vec(),
            (_, false) => value.to_le_bytes().to_vec(),
        }
    }

    fn real(self, value: f64) -> Vec<u8> {
        match (self.is_text, self.is_double, self.is_big) {
            (true, true, _) => format!("{value:.11e} ").replace('e', "D").into_bytes(),
            (true, false, _) => format!("  {value:.6}").into_bytes(),
            (_, true, true) => value.to_be_bytes().to_vec(),
            (_, true, false) => value.to_le_bytes().to_vec(),
            (_, false, true) => (value as f32).to_be_bytes().to_vec(),
            (_, false, false) => (value as f32).to_le_bytes().to_vec(),
        }
    }

    fn record(self, values: impl IntoIterator<Item = Vec<u8>>) -> Vec<u8> {
        let values = values.into_iter().flatten().collect::<Vec<_>>();
        let mark = if self.has_marks { self.integer(values.len() as i32) } else { Vec::new() };
        [mark.clone(), values, mark].concat()
    }

    fn header(self, blocks: &[[usize; 3]]) -> Vec<u8> {
        let count = if self.is_multi { self.record([self.integer(blocks.len() as i32)]) } else { Vec::new() };
        let dims = blocks.as_flattened().iter().map(|&along| self.integer(along as i32));
        [count, self.record(dims)].concat()
    }

    fn grid(self) -> Vec<u8> {
        let mut file = self.header(&self.blocks());
        for (block, dims) in self.blocks().into_iter().enumerate() {
            let n: usize = dims.iter().product();
            let reals = (0..3 * n).map(|i| self.real(coordinate(block, dims, i % n, i / n)));
            let iblank = (0..if self.has_iblank { n } else { 0 }).map(|i| self.integer(visible(i)));
            file.extend(self.record(reals.chain(iblank)));
        }
        file
    }

    fn solution(self) -> Vec<u8> {
        let mut file = self.header(&self.blocks());
        for (block, dims) in self.blocks().into_iter().enumerate() {
            let n: usize = dims.iter().product();
            file.extend(self.record((0..4).map(|i| self.real(f64::from(i)))));
            file.extend(self.record((0..5 * n).map(|i| self.real(value(block, i % n, i / n)))));
        }
        file
    }
}

fn coordinate(block: usize, [ni, nj, _]: [usize; 3], point: usize, axis: usize) -> f64 {
    // 1/7 has as many digits as are printed.
    [point % ni, point / ni % nj, point / ni / nj][axis] as f64 + 10.0 * block as f64 + 1.0 / 7.0
}

fn value(block: usize, point: usize, plane: usize) -> f64 {
    (1000 * block + 100 * plane + point) as f64
}

fn visible(point: usize) -> i32 {
    [1, 1, 1, 0, -2, 1][point.min(5)]
}

fn at(bytes: &[u8], name: &str) -> Result<StructuredMesh> {
    read_plot3d(bytes, Path::new(name))
}

#[test]
fn every_way_of_writing_gives_the_same_mesh() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.xyz");
    for way in ways() {
        std::fs::write(folder.path().join("a.q"), way.solution()).unwrap();
        let mesh = at(&way.grid(), path.to_str().unwrap()).unwrap_or_else(|error| panic!("{way:?}: {error}"));
        let dims: Vec<_> = mesh.blocks().iter().map(StructuredBlock::dims).collect();
        assert_eq!(dims, way.blocks(), "{way:?}");
        assert_eq!(matches!(mesh.points(), Points::F64(_)), way.is_double, "{way:?}");
        let digits = if way.is_text && way.is_double { 1e-9 } else { 1e-6 };
        for (number, block) in mesh.blocks().iter().enumerate() {
            for point in 0..block.points() {
                for (axis, found) in mesh.points().get(block.first_point() + point).to_array().into_iter().enumerate() {
                    let expected = coordinate(number, block.dims(), point, axis);
                    assert!((found - expected).abs() < digits * expected.max(1.0), "{way:?}: {found}, not {expected}");
                }
                let point_of_mesh = block.first_point() + point;
                let [density, momentum, energy] = [0, 1, 2].map(|i| &mesh.arrays()[i].values);
                let found = [
                    density.get(point_of_mesh),
                    momentum.get(3 * point_of_mesh),
                    momentum.get(3 * point_of_mesh + 1),
                    momentum.get(3 * point_of_mesh + 2),
                    energy.get(point_of_mesh),
                ];
                assert_eq!(found, [0, 1, 2, 3, 4].map(|plane| value(number, point, plane)), "{way:?}");
            }
        }
        let found: Vec<_> = mesh.arrays().iter().map(|a| (a.name.as_str(), a.components)).collect();
        let expected = [("Density", 1), ("Momentum", 3), ("StagnationEnergy", 1), ("IBlank", 1), ("vtkGhostType", 1)];
        assert_eq!(found, expected[..if way.has_iblank { 5 } else { 3 }], "{way:?}");
        // Point 3 is a corner of two cells in the first block, of one in the second.
        let ghosts = if way.is_multi { 3 } else { 2 };
        let counts = mesh.into_dataset().unwrap().counts;
        assert_eq!(counts.ghost, if way.has_iblank { ghosts } else { 0 }, "{way:?}");
    }
}

#[test]
fn every_other_length_is_refused() {
    // A grid with IBlank that is cut off before it is one without.
    for way in ways().into_iter().filter(|way| !way.is_text && !way.has_iblank) {
        let whole = way.grid();
        for length in (0..whole.len()).step_by(if whole.len() > 500 { 13 } else { 1 }) {
            let error = at(&whole[..length], "a.xyz").expect_err(&format!("{way:?}: {length}")).to_string();
            // It may be as long as a grid in two dimensions or a solution.
            assert!(error.starts_with("a.xyz: "), "{error}");
        }
        let error = at(&[&whole[..], &[0]].concat(), "a.xyz").unwrap_err().to_string();
        assert!(error.contains("x4x2") && error.contains("followed by something else"), "{way:?}: {error}");
    }
    let text = Way { is_text: true, ..plain() };
    let whole = text.grid();
    let error = at(&[&whole[..], b" 7"].concat(), "a.xyz").unwrap_err().to_string();
    assert!(error.contains("takes 75 numbers, the file has 76"), "{error}");
    let error = at(&whole[..whole.len() - 11], "a.xyz").unwrap_err().to_string();
    assert!(error.contains("the file has 74"), "{error}");
}

fn plain() -> Way {
    Way { is_text: false, is_big: true, has_marks: false, is_multi: false, is_double: false, has_iblank: false }
}

#[test]
fn damage_is_named() {
    for (bytes, expected) in [
        (b"".to_vec(), "its first numbers are no dimensions"),
        (b"3\nwater\nO 0 0 0\nH 0 0 1\nH 0 1 0\n".to_vec(), "its first numbers are no dimensions"),
        (vec![0; 400], "its first numbers are no dimensions"),
        (vec![0xff; 400], "its first numbers are no dimensions"),
        ([0x7f, 0xff, 0xff, 0xff].repeat(100), "its first numbers are no dimensions"),
        (b"2 2 2 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 x 0 0 0 0 0 0 0".to_vec(), "byte 38: \"x\""),
    ] {
        let error = at(&bytes, "a.xyz").unwrap_err();
        assert!(matches!(error, Error::Malformed { .. }) && error.to_string().contains(expected), "{error}");
    }
    // A record mark behind the header, before and after the values.
    let way = Way { has_marks: true, ..plain() };
    let whole = way.grid();
    for mark in [20, whole.len() - 4] {
        let mut damaged = whole.clone();
        damaged[mark + 3] ^= 1;
        let error = at(&damaged, "a.xyz").unwrap_err().to_string();
        assert!(error.contains(&format!("byte {mark}: a record mark says 289 bytes")), "{error}");
    }
}

#[test]
fn two_dimensions_and_solutions_are_refused_by_name() {
    let way = plain();
    for (is_multi, floats) in [(false, 2 * 12), (true, 2 * 12), (false, 3 * 12)] {
        let header: Vec<u8> = [1, 3, 4][usize::from(!is_multi)..].iter().flat_map(|&n| way.integer(n)).collect();
        let error = at(&[header, vec![0; 4 * floats]].concat(), "a.xyz").unwrap_err();
        assert!(error.to_string().contains("two-dimensional"), "{error}");
        assert!(matches!(error, Error::Unsupported { .. }));
    }
    let error = at(&way.solution(), "q.bin").unwrap_err();
    assert!(error.to_string().contains("a PLOT3D solution"), "{error}");
}

#[test]
fn the_solution_is_found_by_the_grids_name() {
    for (grid, solution) in [
        ("a.xyz", "a.q"),
        ("a.x", "a.q"),
        ("A.XYZ", "A.Q"),
        ("a.p3d", "a.q"),
        ("axyz.bin", "aq.bin"),
        ("aXYZ.BIN", "aQ.BIN"),
        ("axyz.x", "aq.x"),
    ] {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join(grid), plain().grid()).unwrap();
        let read = || match open_mesh(&folder.path().join(grid)).unwrap() {
            Mesh::Structured(mesh) => mesh.arrays().len(),
            Mesh::Unstructured(_) | Mesh::Volume(_) => panic!("no blocks"),
        };
        assert_eq!(read(), 0, "{grid}: without a solution");
        std::fs::write(folder.path().join(solution), plain().solution()).unwrap();
        assert_eq!(read(), 3, "{grid}");
    }
    assert_eq!(at(&plain().grid(), "grid.bin").unwrap().arrays().len(), 0);
}

#[test]
fn solutions_of_other_grids_and_damaged_ones_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let (grid, solution) = (folder.path().join("a.xyz"), folder.path().join("a.q"));
    let read = |bytes: &[u8]| {
        std::fs::write(&solution, bytes).unwrap();
        at(&plain().grid(), grid.to_str().unwrap())
    };
    let whole = plain().solution();
    let error = read(&whole[..whole.len() - 1]).unwrap_err().to_string();
    assert!(error.contains("a.q: its 507 bytes") && error.contains("takes 508"), "{error}");
    let other = Way { is_multi: true, ..plain() }.solution();
    let error = read(&other).unwrap_err().to_string();
    assert!(error.contains("2 blocks of 3x4x2, 2x2x5 points, its grid of 1 block of 3x4x2"), "{error}");
    // It need not be written as its grid is, and zeros may follow where it is.
    let double = Way { is_double: true, is_big: false, ..plain() }.solution();
    assert_eq!(read(&double).unwrap().arrays()[0].values.type_name(), "f64");
    let padded = read(&[&whole[..], &[0; 484]].concat()).unwrap();
    assert_eq!(padded.arrays()[2].values.get(23), value(0, 23, 4));
}
