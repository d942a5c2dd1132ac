//! `stage/sort`: the radix sort against the library's, the sort of a view turned by a degree, and the keys.

use cellfan::generate::Kind;
use cellfan::stages::project::scene_vertices;
use cellfan::stages::sort::radix::frames::FrameSort;
use cellfan::stages::sort::radix::{Pair, pair, sort, sort_local};
use cellfan::stages::sort::{KeyMaker, SortKey};
use cellfan::stages::{SceneVertex, View};
use criterion::measurement::WallTime;
use criterion::{BatchSize, BenchmarkGroup, Criterion};

use crate::seen::{SIDE_PX, Seen, all_cells, throughput};
use crate::support::Mesh;

type Sorter = fn(&mut Vec<Pair>, &mut Vec<Pair>);

pub(crate) fn bench_sort(criterion: &mut Criterion) {
    const N: u32 = 1 << 20;
    let mut state = 0x9e37_79b9_7f4a_7c15_u64;
    let mut random = move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (state >> 32) as u32
    };
    let shuffled: Vec<Pair> = (0..N).map(|i| pair(random(), i)).collect();
    let mut sorted = shuffled.clone();
    sorted.sort_unstable();
    // One pair in ten thousand has moved.
    let mut nearly = sorted.clone();
    for _ in 0..N / 20_000 {
        nearly.swap(random() as usize % N as usize, random() as usize % N as usize);
    }
    let mut group = criterion.benchmark_group("stage/sort");
    group.sample_size(10);
    throughput(&mut group, N.into(), 32);
    let sorters: [(&str, Sorter); 3] =
        [("sort_local", sort_local), ("sort", sort), ("std_sort_unstable", |pairs, _| pairs.sort_unstable())];
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

    turned(&mut group);

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

/// The cells of a view, new and a degree after another one.
fn turned(group: &mut BenchmarkGroup<WallTime>) {
    let mesh = Mesh::generate(Kind::Tets, 1_000_000);
    let (vertices, every) = (scene_vertices(&mesh.dataset, &mesh.field), all_cells());
    let pairs = |degrees: f64| {
        let view = View::new(&mesh.camera(degrees, SIDE_PX), &mesh.dataset).expect("the camera is valid");
        let (keys, mut out) = (KeyMaker::new(SortKey::Centroid, &view, &[]), Vec::new());
        for block in (0..mesh.dataset.blocks.len()).map(|block| mesh.dataset.block(block)) {
            keys.keys(&block, &vertices, &every[..block.len()], &mut out);
        }
        out.iter().zip(0..).map(|(&key, cell)| pair(key, cell)).collect::<Vec<Pair>>()
    };
    let (last, now) = (pairs(1.0), pairs(0.0));
    let mut expected = now.clone();
    expected.sort_unstable();
    throughput(group, now.len() as u64, 32);
    let fill = |frames: &mut FrameSort, pairs: &[Pair], moved| {
        frames.begin(1, moved).iter_mut().for_each(|part| part.extend(pairs.iter().copied()));
    };
    for (name, moved) in [("new_view", None), ("1_degree_on", Some(0.015))] {
        let mut sorted = Vec::new();
        let ready = || {
            let mut frames = FrameSort::default();
            fill(&mut frames, &last, None);
            frames.finish(&mut Vec::new());
            fill(&mut frames, &now, moved);
            frames
        };
        ready().finish(&mut sorted);
        assert!(sorted == expected, "{name}");
        group.bench_function(format!("frames/{name}"), |b| {
            b.iter_batched_ref(ready, |frames| frames.finish(&mut sorted), BatchSize::LargeInput);
        });
    }
}
