//! `stage/sort`: the radix sort against the library's, and the keys.

use cellfan::generate::Kind;
use cellfan::stages::SceneVertex;
use cellfan::stages::sort::radix::{Pair, pair, sort, sort_coherent, sort_local};
use cellfan::stages::sort::{KeyMaker, SortKey};
use criterion::{BatchSize, Criterion};

use crate::seen::{Seen, all_cells, throughput};

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
