//! The fans and strips of Max 2006, sections 3 and 4, as an independent check of the triangles that are found here, and as
//! printed where they are wrong: the area test has to see that.

use super::*;

/// A case as the paper gives it.
struct Printed {
    name: &'static str,
    /// New vertices from 8 on, as edges that cross.
    new: &'static [[[usize; 2]; 2]],
    fans: &'static [&'static [usize]],
    strips: &'static [&'static [usize]],
}

const PRINTED: [Printed; 8] = [
    Printed {
        name: "count1",
        new: &[[[7, 4], [0, 1]], [[7, 6], [1, 2]]],
        fans: &[&[8, 1, 5, 4, 0, 3, 7, 1], &[9, 7, 3, 2, 6, 5, 1, 7]],
        strips: &[],
    },
    Printed {
        name: "count1_a",
        new: &[[[7, 4], [1, 2]], [[7, 6], [1, 2]], [[7, 4], [1, 5]]],
        fans: &[&[9, 6, 2, 3, 7, 8, 10, 5, 6], &[8, 7, 3, 0, 1], &[10, 8, 1, 0, 4, 5]],
        strips: &[],
    },
    Printed {
        name: "count1_b",
        new: &[[[7, 4], [0, 1]], [[7, 6], [0, 1]], [[7, 6], [1, 5]]],
        fans: &[&[10, 5, 6, 2, 1, 9, 8, 4, 5], &[9, 1, 2, 3, 7], &[8, 9, 7, 3, 0, 4]],
        strips: &[],
    },
    Printed {
        name: "count1_c",
        new: &[[[7, 4], [1, 2]], [[7, 6], [1, 2]], [[1, 2], [4, 0]]],
        fans: &[&[9, 2, 3, 7, 8, 4, 5, 6, 2], &[10, 7, 3, 0, 1, 5, 4, 8, 7]],
        strips: &[],
    },
    // V10 is printed as V2V6 ∩ V1V5.
    Printed {
        name: "count1_d",
        new: &[[[7, 4], [0, 1]], [[7, 6], [0, 1]], [[0, 1], [2, 6]]],
        fans: &[&[8, 4, 0, 3, 7, 9, 6, 5, 4], &[10, 6, 9, 7, 3, 2, 1, 5, 6]],
        strips: &[],
    },
    Printed { name: "count4", new: &[], fans: &[&[4, 0, 3, 7, 6, 5, 1, 0], &[6, 7, 3, 2, 1, 5]], strips: &[] },
    Printed {
        name: "count2",
        new: &[[[7, 4], [0, 1]], [[6, 5], [0, 1]]],
        fans: &[&[7, 8, 0, 3, 2, 6, 9, 8]],
        strips: &[&[0, 4, 8, 5, 9, 1, 6, 2]],
    },
    // The strip is printed as …, 10, 4, 3, 9, 2.
    Printed {
        name: "count0",
        new: &[[[0, 3], [1, 6]], [[0, 3], [2, 5]], [[4, 7], [2, 5]], [[4, 7], [1, 6]]],
        fans: &[&[8, 0, 1, 2, 9, 10, 11, 7, 0]],
        strips: &[&[7, 6, 11, 5, 10, 4, 9, 3, 2]],
    },
];

const MISPRINTS: [Printed; 2] = [
    Printed { new: &[[[7, 4], [0, 1]], [[7, 6], [0, 1]], [[2, 6], [1, 5]]], ..PRINTED[4] },
    Printed { strips: &[&[7, 6, 11, 5, 10, 4, 3, 9, 2]], ..PRINTED[7] },
];

impl Printed {
    fn triangles(&self) -> Vec<[usize; 3]> {
        let fans = self.fans.iter().flat_map(|fan| fan[1..].windows(2).map(|ring| [fan[0], ring[0], ring[1]]));
        let strips = self.strips.iter().flat_map(|strip| strip.windows(3).map(|of| [of[0], of[1], of[2]]));
        fans.chain(strips).collect()
    }

    /// The area of the case's triangles on a cell's corners in standard numbering.
    fn area(&self, mut p: Vec<DVec2>) -> f64 {
        for &[[a, b], [c, d]] in self.new {
            let t = area(p[c], p[d], p[a]) / (area(p[c], p[d], p[a]) - area(p[c], p[d], p[b]));
            p.push(p[a].lerp(p[b], t));
        }
        self.triangles().iter().map(|of| polygon_area(&of.map(|i| p[i])).abs()).sum()
    }
}

#[test]
fn the_papers_triangles_pass_the_area_test_and_its_misprints_fail_it() {
    let mut random = Random::new(15);
    let mut checked = BTreeMap::<&str, usize>::new();
    for _ in 0..100_000 {
        let seen = Seen::random(&HEXAHEDRON, Shape::Jittered(0.4), &mut random);
        let Some(placed) = placed(&seen) else { continue };
        let corner = |&corner: &u8| seen.corners[usize::from(corner)].truncate();
        let standard: Vec<DVec2> = placed.renumbering.corner_from_standard.iter().map(corner).collect();
        let name = placed.case.name;
        let relative = |printed: &Printed| (printed.area(standard.clone()) / half_of_faces(&seen) - 1.0).abs();
        let right = PRINTED.iter().find(|printed| printed.name == name).unwrap();
        assert!(relative(right) < 1e-6, "{name}: {} of {seen:?}", relative(right));
        for wrong in MISPRINTS.iter().filter(|printed| printed.name == name) {
            assert!(relative(wrong) > 1e-6, "{name} as printed: {} of {seen:?}", relative(wrong));
        }
        *checked.entry(name).or_default() += 1;
    }
    assert_eq!(checked.len(), PRINTED.len(), "{checked:?}");
}

#[test]
fn the_crossings_are_the_papers_new_vertices() {
    let sorted = |[[a, b], [c, d]]: [[usize; 2]; 2]| {
        let mut edges = [[a.min(b), a.max(b)], [c.min(d), c.max(d)]];
        edges.sort_unstable();
        edges
    };
    for case in Projections::of(&HEXAHEDRON).unwrap().cases() {
        let printed = PRINTED.iter().find(|printed| printed.name == case.name).unwrap();
        let of_case = |crossing: &Crossing| sorted([crossing.lid, crossing.bowl].map(|edge| edge.map(usize::from)));
        let mut found: Vec<_> = case.crossings.iter().map(of_case).collect();
        let mut expected: Vec<_> = printed.new.iter().map(|&edges| sorted(edges)).collect();
        found.sort_unstable();
        expected.sort_unstable();
        assert_eq!(found, expected, "{}", case.name);
        assert_eq!(case.triangles.len(), printed.triangles().len(), "{}", case.name);
    }
}
