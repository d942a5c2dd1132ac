//! One stage at a time: `stage/<stage>`, and `optics/integral`; inputs are made outside the timer, where each
//! stage also runs once and its answer is checked.
//!
//! All but `sort` on large inputs, and its `topological`, run on one thread. Kernels are timed for the instruction set that the benchmark is
//! compiled for; the CPU backend chooses at run time. Bytes are those a stage reads and writes, once each.

mod support;

use std::hint::black_box;

use cellfan::cells::HEXAHEDRON;
use cellfan::columns::{BlockView, CellCounts, CellMesh, Dataset, Neighbours, Points, StructuredCells};
use cellfan::generate::Kind;
use cellfan::optics::integral::segment_weights_average;
use cellfan::optics::{CullTable, LANES, Pieces, SegmentWeights, segment_weights, segment_weights_thin};
use cellfan::stages::classify::classify;
use cellfan::stages::classify::polyhedra::{Placed, Projection, Projections};
use cellfan::stages::cull::{Culled, cull};
use cellfan::stages::fans::polyhedra::{CellFans, ProjectedCorner};
use cellfan::stages::fans::{self, Faces, Fan, FanInput, FanStyle, PlanesFor};
use cellfan::stages::footprints::planes::{Batch, Corners, TileRays};
use cellfan::stages::footprints::{PixelBox, PixelBoxes};
use cellfan::stages::project::{project, scene_vertices};
use cellfan::stages::sort::adjacency::Adjacency;
use cellfan::stages::sort::check::check_order;
use cellfan::stages::sort::radix::{Pair, pair, sort, sort_coherent, sort_local};
use cellfan::stages::sort::topological::{Layers, Topological};
use cellfan::stages::sort::{KeyMaker, SortKey};
use cellfan::stages::{SceneVertex, ScreenVertex, View};
use cellfan::{Camera, Model};
use criterion::measurement::WallTime;
use criterion::{BatchSize, BenchmarkGroup, Criterion, Throughput, criterion_group, criterion_main};
use glam::{DVec2, DVec3, UVec3, Vec2};

use support::{Mesh, TRANSPARENT_BELOW, transfer};

const CELLS: u64 = 100_000;
const SIDE_PX: u32 = 512;

type Sorter = fn(&mut Vec<Pair>, &mut Vec<Pair>);
type Kernel = fn(f32, f32) -> SegmentWeights;

/// A mesh in one view, projected.
struct Seen {
    mesh: Mesh,
    view: View,
    vertices: Vec<SceneVertex>,
    screen: Vec<ScreenVertex>,
}

impl Seen {
    fn new(kind: Kind) -> Self {
        let mesh = Mesh::generate(kind, CELLS);
        let view = View::new(&mesh.camera(0.0, SIDE_PX), &mesh.dataset).expect("the camera is valid");
        let vertices = scene_vertices(&mesh.dataset, &mesh.field);
        let mut screen = Vec::new();
        project(&view, &vertices, &mut screen);
        Self { mesh, view, vertices, screen }
    }

    fn cells(&self) -> u64 {
        self.mesh.dataset.tets.len() as u64
    }

    fn blocks(&self) -> impl Iterator<Item = BlockView<'_>> {
        (0..self.mesh.dataset.blocks.len()).map(|block| self.mesh.dataset.block(block))
    }

    /// Calls `f` with every block and the list of its cells.
    fn each_block(&self, cell_from_visible: &[u32], mut f: impl FnMut(&BlockView, &[u32])) {
        for block in self.blocks() {
            f(&block, &cell_from_visible[..block.len()]);
        }
    }
}

fn all_cells() -> Vec<u32> {
    (0..cellfan::Dataset::BLOCK_CELLS as u32).collect()
}

fn throughput(group: &mut BenchmarkGroup<WallTime>, elements: u64, bytes_each: usize) {
    group.throughput(Throughput::ElementsAndBytes { elements, bytes: elements * bytes_each as u64 });
}

fn bench_project(criterion: &mut Criterion) {
    let seen = Seen::new(Kind::Tets);
    let pool = rayon_of_one();
    let mut group = criterion.benchmark_group("stage/project");
    throughput(&mut group, seen.vertices.len() as u64, 32);
    let mut screen = Vec::new();
    let mut stage = || pool.install(|| project(&seen.view, black_box(&seen.vertices), &mut screen));
    stage();
    group.bench_function("vertices", |b| b.iter(&mut stage));
    let frame = seen.mesh.camera(0.0, SIDE_PX).frame().expect("the camera is valid");
    for (at, position) in screen.iter().zip(seen.mesh.dataset.positions.iter()).step_by(997) {
        let exact = frame.pixel(glam::Vec3::from_array(*position).as_dvec3() + seen.mesh.dataset.origin);
        assert!((at.xy().as_dvec2() - exact).length() < 1e-3, "{at:?} is not {exact}");
    }
}

fn bench_cull(criterion: &mut Criterion) {
    let seen = Seen::new(Kind::Tets);
    let pieces: Pieces = transfer().pieces(seen.mesh.field.offset);
    let table = CullTable::new(&pieces, Model::EmissionAbsorption);
    let mut group = criterion.benchmark_group("stage/cull");
    throughput(&mut group, seen.cells(), 32);
    let mut visible = Vec::new();
    let mut stage = || {
        let (mut transparent, mut shown) = (0, 0);
        for block in seen.blocks() {
            visible.clear();
            let Culled { transparent: dropped, invalid: _ } =
                cull(&block, &seen.mesh.field, &seen.screen, (&pieces, &table), &mut visible);
            transparent += dropped;
            shown += visible.len() as u64;
        }
        (transparent, shown)
    };
    let (transparent, shown) = stage();
    group.bench_function("tets", |b| b.iter(&mut stage));
    let largest = |tet: &[u32; 4]| tet.map(|v| seen.vertices[v as usize].scalar).into_iter().fold(f32::MIN, f32::max);
    let low = seen.mesh.dataset.tets.iter().filter(|tet| f64::from(largest(tet)) < TRANSPARENT_BELOW).count() as u64;
    assert_eq!((transparent, transparent + shown), (low, seen.cells()));
    assert!(low > 0 && shown > 0, "a test of culling needs both kinds of cells");
}

fn bench_classify(criterion: &mut Criterion) {
    let seen = Seen::new(Kind::Delaunay);
    let (tets, positive) = (&seen.mesh.dataset.tets, &seen.mesh.dataset.positive);
    let mut group = criterion.benchmark_group("stage/classify");
    throughput(&mut group, seen.cells(), 16 + 4 * size_of::<ScreenVertex>());
    let stage = || {
        let mut by_class = [0_u64; 5];
        for (cell, tet) in tets.iter().enumerate() {
            let xy = tet.map(|v| seen.screen[v as usize].xy());
            by_class[classify(xy, positive.get(cell)).class as usize] += 1;
        }
        by_class
    };
    let by_class = stage();
    group.bench_function("delaunay", |b| b.iter(stage));
    assert_eq!(by_class.iter().sum::<u64>(), seen.cells());
    // Random cells have one inner vertex or a quadrilateral; the others are exceptions.
    assert!(by_class[1] > seen.cells() / 10 && by_class[2] > seen.cells() / 10, "{by_class:?}");
}

/// Boxes of a grid with moved corners, seen in perspective: the projected corners of each, and those of a field on them.
struct Boxes {
    xy: Vec<[Vec2; 8]>,
    corners: Vec<[ProjectedCorner; 8]>,
}

impl Boxes {
    const SIDE: u32 = 48;

    /// Where corner `at` stands in the unit cube; each coordinate is moved by up to `jitter` boxes, by a hash.
    fn position(at: UVec3, jitter: f64) -> DVec3 {
        let hash = (at.x * 73 + at.y * 179 + at.z * 283).wrapping_mul(0x9e37_79b9);
        let moved = [0, 10, 20].map(|shift| f64::from(hash >> shift & 0x3ff) / 1023.0 - 0.5);
        (at.as_dvec3() + 2.0 * jitter * DVec3::from_array(moved)) / f64::from(Self::SIDE)
    }

    fn new() -> Self {
        let camera = Camera::looking_at(DVec3::new(3.0, -2.2, 1.6), DVec3::splat(0.5), SIDE_PX, SIDE_PX);
        let frame = camera.frame().expect("the camera is valid");
        let vertex = |at: UVec3| {
            let position = Self::position(at, 0.1);
            let v = 1.0 / frame.depth(position);
            ProjectedCorner {
                position_px: frame.pixel(position).as_vec2(),
                vq: DVec2::new(v, position.x * v).as_vec2(),
            }
        };
        let around = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]];
        let cell = |i: u32| UVec3::new(i % Self::SIDE, i / Self::SIDE % Self::SIDE, i / Self::SIDE.pow(2));
        let corners = |i| around.map(|corner| vertex(cell(i) + UVec3::from_array(corner)));
        let corners: Vec<_> = (0..Self::SIDE.pow(3)).map(corners).collect();
        Self { xy: corners.iter().map(|of| of.map(|corner| corner.position_px)).collect(), corners }
    }
}

fn bench_hexahedra(criterion: &mut Criterion) {
    let boxes = Boxes::new();
    let cells = boxes.xy.len() as u64;
    let table = Projections::of(&HEXAHEDRON).expect("hexahedra have a table");
    let classify = || boxes.xy.iter().map(|xy| table.classify(black_box(xy), true));
    let whole: Vec<(usize, Placed)> = (0..)
        .zip(classify())
        .filter_map(|(cell, projection)| match projection {
            Projection::Whole(placed) => Some((cell, placed)),
            Projection::EdgeOn | Projection::Split => None,
        })
        .collect();
    assert!(whole.len() as u64 > cells / 4, "{} of {cells} boxes are whole", whole.len());
    let mut by_case = vec![0_u64; table.cases().len()];
    for (_, placed) in &whole {
        by_case[placed.case.index] += 1;
    }
    assert!(by_case.iter().filter(|&&cells| cells > 0).count() >= 3, "{by_case:?}");

    let mut group = criterion.benchmark_group("stage/classify");
    throughput(&mut group, cells, 8 * size_of::<Vec2>());
    group.bench_function("hexahedra", |b| {
        b.iter(|| classify().filter(|projection| matches!(projection, Projection::Whole(_))).count());
    });
    group.finish();

    let mut group = criterion.benchmark_group("stage/fans");
    throughput(&mut group, whole.len() as u64, 8 * size_of::<ProjectedCorner>() + size_of::<CellFans>());
    let fans = || whole.iter().map(|(cell, placed)| CellFans::new(black_box(placed), &boxes.corners[*cell], 0));
    group.bench_function("hexahedra", |b| b.iter(|| fans().for_each(|fans| drop(black_box(fans)))));
    group.finish();

    // Each ray that enters leaves once: the triangles of a cell cover half the area of its projected faces.
    let area = |polygon: &[Vec2]| {
        let from = |p: Vec2| (p - polygon[0]).as_dvec2();
        0.5 * polygon[1..].windows(2).map(|side| from(side[0]).perp_dot(from(side[1]))).sum::<f64>().abs()
    };
    for ((cell, _), fans) in whole.iter().zip(fans()) {
        let at = |vertex: u8| Vec2::from_array(fans.vertices[usize::from(vertex)].position_px);
        let of_fans: f64 = fans.triangles.iter().map(|triangle| area(&triangle.map(at))).sum();
        let corner = |corner: &u8| boxes.xy[*cell][usize::from(*corner)];
        let faces = HEXAHEDRON.faces.iter().map(|face| area(&face.iter().map(corner).collect::<Vec<_>>()));
        let faces: f64 = faces.sum();
        assert!((2.0 * of_fans / faces - 1.0).abs() < 1e-4, "cell {cell}: {of_fans} px², its faces {faces}");
    }
}

fn bench_sort(criterion: &mut Criterion) {
    const N: u32 = 1 << 20;
    let mut state = 0x9e37_79b9_7f4a_7c15_u64;
    let mut random = move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (state >> 32) as u32
    };
    let shuffled: Vec<Pair> = (0..N).map(|i| pair(random(), i)).collect();
    let mut sorted = shuffled.clone();
    sorted.sort_unstable();
    // A view turned a little: one pair in ten thousand has moved.
    let mut nearly = sorted.clone();
    for _ in 0..N / 20_000 {
        nearly.swap(random() as usize % N as usize, random() as usize % N as usize);
    }
    let mut group = criterion.benchmark_group("stage/sort");
    group.sample_size(10);
    throughput(&mut group, N.into(), 64);
    let sorters: [(&str, Sorter); 4] = [
        ("sort_local", sort_local),
        ("sort", sort),
        ("sort_coherent", sort_coherent),
        ("std_sort_unstable", |pairs, _| pairs.sort_unstable()),
    ];
    for (input, pairs) in [("random", &shuffled), ("sorted", &sorted), ("nearly_sorted", &nearly)] {
        for (name, sorter) in sorters {
            let mut scratch = Vec::new();
            let mut answer = pairs.clone();
            sorter(&mut answer, &mut scratch);
            assert!(answer == sorted, "{name} of {input} pairs");
            group.bench_function(format!("{name}/{input}"), |b| {
                b.iter_batched_ref(|| pairs.clone(), |pairs| sorter(pairs, &mut scratch), BatchSize::LargeInput);
            });
        }
    }

    let seen = Seen::new(Kind::Delaunay);
    let every = all_cells();
    throughput(&mut group, seen.cells(), 16 + 4 * size_of::<SceneVertex>() + 4);
    for key in [SortKey::Centroid, SortKey::Power] {
        let keys = KeyMaker::new(key, &seen.view, &[]);
        let mut out: Vec<u32> = Vec::new();
        let mut stage = || {
            out.clear();
            seen.each_block(&every, |block, cells| keys.keys(block, &seen.vertices, cells, &mut out));
        };
        stage();
        group.bench_function(format!("keys/{}", key.name()), |b| b.iter(&mut stage));
        assert_eq!(out.len() as u64, seen.cells());
        let nearest = |i: &usize| seen.mesh.dataset.tets.get(*i).map(|v| seen.screen[v as usize].depth);
        let by_key = |i: &usize| out[*i];
        let (first, last) = ((0..out.len()).min_by_key(by_key), (0..out.len()).max_by_key(by_key));
        let depth = |cell: Option<usize>| cell.map_or(0.0, |i| nearest(&i).into_iter().fold(f32::INFINITY, f32::min));
        assert!(depth(first) < depth(last), "the smallest key is nearer than the largest");
    }
}

fn bench_topological(criterion: &mut Criterion) {
    let seen = Seen::new(Kind::Delaunay);
    let dataset = &seen.mesh.dataset;
    let mut group = criterion.benchmark_group("stage/sort/topological");
    group.sample_size(20);
    throughput(&mut group, seen.cells(), 16 + 16);
    group.bench_function("adjacency", |b| b.iter(|| Adjacency::new(black_box(dataset))));
    let adjacency = Adjacency::new(dataset);
    // All faces have two sides but for those of the hull, which are few.
    let sides = adjacency.neighbours_from_tet().iter().flatten().filter(|&&other| other != Adjacency::NONE).count();
    assert!(sides % 2 == 0 && sides + adjacency.exterior().len() == 4 * dataset.tets.len());
    assert!(adjacency.exterior().len() < sides / 10);
    // As from a container: compared with the cells, not made.
    let stored = Dataset { adjacency: Some(Neighbours::new(dataset)), ..dataset.clone() };
    group.bench_function("adjacency/stored", |b| b.iter(|| Adjacency::new(black_box(&stored))));
    assert!(Adjacency::new(&stored).is_stored() && !adjacency.is_stored());

    throughput(&mut group, seen.cells(), 64);
    let mut topological = Topological::default();
    let mut stage = || topological.order(dataset, &adjacency, &seen.vertices, &seen.view);
    let Layers { cycles, layers, .. } = stage();
    group.bench_function("order", |b| b.iter(&mut stage));
    let order = topological.layer_from_cell().iter().zip(0..).map(|(&layer, cell)| pair(layer, cell));
    let mut order: Vec<Pair> = order.collect();
    order.sort_unstable();
    let check = check_order(dataset, &seen.vertices, &seen.view, &order);
    assert_eq!((cycles, check.misordered, order.len() as u64), (0, 0, seen.cells()));
    assert!(layers > 100 && check.pairs > seen.cells());
}

/// Tetrahedra like this; there are no other cells.
fn style(planes_for: PlanesFor) -> FanStyle {
    FanStyle { planes_for, faces: Faces::Exact }
}

/// The boxes as one structured block.
fn block_of_boxes() -> StructuredCells {
    let side = Boxes::SIDE + 1;
    let at = |i: u32| UVec3::new(i % side, i / side % side, i / side.pow(2));
    let cells = u64::from(Boxes::SIDE.pow(3));
    StructuredCells {
        dims: vec![[side as usize; 3]],
        points: Points::F64((0..side.pow(3)).map(|i| Boxes::position(at(i), 0.02).to_array()).collect()),
        hidden: (0..cells).map(|_| false).collect(),
        arrays: Vec::new(),
        counts: CellCounts { in_file: cells, ..CellCounts::default() },
    }
}

/// The same, each box with its corners.
fn listed_boxes(block: &StructuredCells) -> CellMesh {
    let (side, cells) = (Boxes::SIDE, Boxes::SIDE.pow(3));
    let corners = |cell: u32| {
        let row = side + 1;
        let first = cell % side + row * (cell / side % side) + row * row * (cell / side.pow(2));
        [0, 1, row + 1, row].map(|step| first + step)
    };
    let hexahedron = |cell: u32| {
        let [a, b, c, d] = corners(cell);
        let above = |v: u32| v + (side + 1).pow(2);
        [a, b, c, d, above(a), above(b), above(c), above(d)]
    };
    CellMesh {
        points: block.points.clone(),
        tets: Vec::new().into(),
        file_from_tet: Vec::new().into(),
        hexahedra: (0..cells).map(hexahedron).collect(),
        file_from_hexahedron: (0..cells).collect(),
        arrays: Vec::new(),
        counts: block.counts,
    }
}

fn bench_topological_hexahedra(criterion: &mut Criterion) {
    let block = block_of_boxes();
    let listed = Dataset::from_cells(listed_boxes(&block)).expect("the boxes are valid");
    let structured = Dataset::from_structured(block).expect("the boxes are valid");
    let mut group = criterion.benchmark_group("stage/sort/topological/hexahedra");
    group.sample_size(20);
    for (name, dataset) in [("listed", &listed), ("block", &structured)] {
        let camera = Camera::framing(&dataset.corners_world(), 30.0, 20.0, SIDE_PX, SIDE_PX);
        let view = View::new(&camera, dataset).expect("the camera is valid");
        let vertices = scene_vertices(dataset, &dataset.homogeneous_field());
        let (cells, stored) = (dataset.cells() as u64, if name == "listed" { 24 } else { 0 });
        throughput(&mut group, cells, 32 + stored);
        group.bench_function(format!("{name}/adjacency"), |b| b.iter(|| Adjacency::new(black_box(dataset))));
        let adjacency = Adjacency::new(dataset);
        assert_eq!(adjacency.exterior().len() as u32, 6 * Boxes::SIDE.pow(2));

        throughput(&mut group, cells, 32 + stored + 16);
        let mut topological = Topological::default();
        let mut stage = || topological.order(dataset, &adjacency, &vertices, &view);
        let Layers { cycles, layers, .. } = stage();
        group.bench_function(format!("{name}/order"), |b| b.iter(&mut stage));
        let order = topological.layer_from_cell().iter().zip(0..).map(|(&layer, cell)| pair(layer, cell));
        let mut order: Vec<Pair> = order.collect();
        order.sort_unstable();
        let check = check_order(dataset, &vertices, &view, &order);
        assert_eq!((cycles, check.misordered), (0, 0));
        assert!(layers > 100 && check.pairs > 2 * cells);
    }
}

fn bench_fans(criterion: &mut Criterion) {
    let seen = Seen::new(Kind::Delaunay);
    let input =
        FanInput::new(&seen.view, &seen.mesh.dataset, &seen.vertices, &seen.screen, None, style(PlanesFor::NearCells));
    let cells: Vec<u32> = (0..seen.cells() as u32).collect();
    let mut group = criterion.benchmark_group("stage/fans");
    let mut memory = vec![Fan::default(); fans::count(&input, &cells)];
    throughput(&mut group, seen.cells(), 16 + 4 * size_of::<ScreenVertex>() + size_of::<Fan>());
    let mut stage = || fans::write(&input, &cells, &mut &mut memory[..]);
    stage();
    group.bench_function("write", |b| b.iter(&mut stage));
    let planes =
        FanInput::new(&seen.view, &seen.mesh.dataset, &seen.vertices, &seen.screen, None, style(PlanesFor::AllCells));
    let mut as_planes = memory.clone();
    let mut stage = || fans::write(&planes, &cells, &mut &mut as_planes[..]);
    stage();
    group.bench_function("planes", |b| b.iter(&mut stage));
    // Their values are told from those of fans by a range that runs down; slivers have fans.
    let is_planes = |fan: &&Fan| fan.s_range[0] > fan.s_range[1];
    let share = as_planes.iter().filter(is_planes).count() as f64 / cells.len() as f64;
    assert!(share > 0.9, "{share} of the cells are planes");

    // Each ray that enters leaves once: fans cover half the area of the projected faces.
    let area = |[a, b, c]: [glam::Vec2; 3]| 0.5 * f64::from((b - a).perp_dot(c - a).abs());
    let xy = |fan: &Fan, i: u16| glam::Vec2::from_array(fan.vertex(i).0);
    let of_fan = |fan: &Fan| Fan::TRIANGLES.map(|triangle| area(triangle.map(|i| xy(fan, i)))).iter().sum::<f64>();
    let of_fans: f64 = memory.iter().map(of_fan).sum();
    let faces: f64 = seen
        .mesh
        .dataset
        .tets
        .iter()
        .map(|tet| {
            let [a, b, c, d] = tet.map(|v| seen.screen[v as usize].xy());
            0.5 * [[b, c, d], [a, c, d], [a, b, d], [a, b, c]].map(area).iter().sum::<f64>()
        })
        .sum();
    assert!((of_fans / faces - 1.0).abs() < 1e-4, "fans cover {of_fans} px², half the faces {faces}");
}

fn bench_footprints(criterion: &mut Criterion) {
    let seen = Seen::new(Kind::Tets);
    let every = all_cells();
    let mut group = criterion.benchmark_group("stage/footprints");
    throughput(&mut group, seen.cells(), 16 + 4 * size_of::<ScreenVertex>() + 12);
    let boxes = PixelBoxes::new(&seen.view);
    let (mut drawn, mut areas): (Vec<u32>, Vec<PixelBox>) = (Vec::new(), Vec::new());
    let mut stage = || {
        drawn.clear();
        areas.clear();
        seen.each_block(&every, |block, cells| {
            boxes.of_cells(block, &seen.vertices, &seen.screen, cells, &mut drawn, &mut areas);
        });
    };
    stage();
    group.bench_function("boxes", |b| b.iter(&mut stage));
    // The mesh is in view and its cells are some pixels wide: all but slivers between pixel centres have a box, and
    // the boxes cover what their cells do, a sixth of it or so.
    assert!(drawn.len() == areas.len() && drawn.len() as u64 > seen.cells() / 2);
    let pixels: f64 = areas.iter().map(|a| f64::from(a.x1 - a.x0) * f64::from(a.y1 - a.y0)).sum();
    let covered: f64 = seen
        .mesh
        .dataset
        .tets
        .iter()
        .map(|tet| {
            let [a, b, c, d] = tet.map(|v| seen.screen[v as usize].xy());
            let area = |a: glam::Vec2, b: glam::Vec2, c: glam::Vec2| f64::from((b - a).perp_dot(c - a).abs());
            0.25 * (area(a, b, c) + area(a, b, d) + area(a, c, d) + area(b, c, d))
        })
        .sum();
    assert!(pixels > covered && pixels < 10.0 * covered, "boxes of {pixels} px for cells of {covered} px");

    let rays = TileRays::new(&seen.view, SIDE_PX / 2, SIDE_PX / 2, 32);
    let dataset = &seen.mesh.dataset;
    let (mut corners, mut batch) = (Corners::<LANES>::default(), Batch::default());
    throughput(&mut group, seen.cells(), 16 + 4 * size_of::<SceneVertex>() + size_of::<Batch>() / LANES);
    let tets: Vec<[u32; 4]> = dataset.tets.iter().collect();
    let mut stage = || {
        let mut sum = 0.0_f64;
        for (chunk, cells) in tets.chunks(LANES).enumerate() {
            for (lane, &tet) in cells.iter().enumerate() {
                corners.set(lane, tet, &seen.vertices, dataset.positive.get(chunk * LANES + lane));
            }
            black_box(&mut batch).set_up(&rays, &corners);
            sum += batch.v_max[..cells.len()].iter().map(|&v| f64::from(v)).sum::<f64>();
        }
        sum
    };
    let sum = stage();
    group.bench_function("planes", |b| b.iter(&mut stage));
    let nearest = |tet: &[u32; 4]| tet.iter().fold(f32::INFINITY, |w, &v| w.min(seen.screen[v as usize].depth));
    let expected: f64 = dataset.tets.iter().map(|tet| 1.0 / f64::from(nearest(&tet))).sum();
    assert!((sum / expected - 1.0).abs() < 1e-5, "{sum} is not {expected}");
}

fn bench_integral(criterion: &mut Criterion) {
    const N: usize = 1 << 14;
    let depth = |i: usize, largest: f32| (i * 7919 % N) as f32 / N as f32 * largest;
    let mut group = criterion.benchmark_group("optics/integral");
    throughput(&mut group, N as u64, 20);
    // Function pointers would not inline: a macro makes a loop of each kernel.
    macro_rules! kernel {
        ($name:literal, $kernel:path, $largest:expr, $tolerance:expr) => {
            let _: Kernel = $kernel;
            let x: Vec<f32> = (0..N).map(|i| depth(i, $largest)).collect();
            let y: Vec<f32> = (0..N).map(|i| depth(N - i, $largest)).collect();
            let mut out = [vec![0.0_f32; N], vec![0.0; N], vec![0.0; N]];
            let mut stage = || {
                let [w0, w1, t] = &mut out;
                for ((((&x, &y), w0), w1), t) in black_box(&x).iter().zip(&y).zip(w0).zip(w1).zip(t) {
                    let weights = $kernel(x, y);
                    (*w0, *w1, *t) = (weights.w0, weights.w1, weights.transmittance);
                }
            };
            stage();
            group.bench_function($name, |b| b.iter(&mut stage));
            for i in 0..N {
                let exact = (-0.5 * (f64::from(x[i]) + f64::from(y[i]))).exp();
                assert!((f64::from(out[2][i]) - exact).abs() < $tolerance, "T({}, {})", x[i], y[i]);
                assert!((f64::from(out[0][i] + out[1][i]) - (1.0 - exact)).abs() < $tolerance);
            }
        };
    }
    kernel!("thin", segment_weights_thin, 2.0, 1e-6);
    kernel!("any_depth", segment_weights, 20.0, 1e-6);
    kernel!("average", segment_weights_average, 20.0, 1e-6);
}

/// A pool of one thread, for stages that spread over all there are.
fn rayon_of_one() -> rayon::ThreadPool {
    rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("one thread can be had")
}

criterion_group!(
    benches,
    bench_project,
    bench_cull,
    bench_classify,
    bench_hexahedra,
    bench_sort,
    bench_topological,
    bench_topological_hexahedra,
    bench_fans,
    bench_footprints,
    bench_integral
);
criterion_main!(benches);
