//! What a mesh's cells take to sort: in a new view, and one step of an orbit after another.
//!
//! Pairs come in memory order, in parts, as a frame makes them. Three ways: [`FrameSort`] with what it knows of the view before,
//! `sort` of all of them, and `sort` of all of them in the order of the view before. *Filling* is what it takes to put
//! the pairs where they are sorted from: into buckets where these are foreseen; for the last order, by looking them up. Every answer is
//! compared with the library's.

use cellfan::generate::Kind;
use cellfan::stages::project::scene_vertices;
use cellfan::stages::sort::radix::frames::FrameSort;
use cellfan::stages::sort::radix::{Pair, index_of, pair, sort};
use cellfan::stages::sort::{KeyMaker, SortKey};
use cellfan::stages::{SceneVertex, View};
use cellfan::{Dataset, Result};
use rayon::prelude::*;
use serde::Serialize;

use crate::cli::bench::frames::camera;
use crate::cli::bench::session::Session;
use crate::cli::bench::spread::{Spread, measure};
use crate::cli::bench::subject::Subject;
use crate::cli::bench::tables::{Table, digits, none};
use crate::cli::bench::{Outcome, ensure};
use crate::cli::numbers::{count, grouped};
use crate::cli::progress::Progress;

/// The meshes, and what their cells are sorted by.
const MESHES: [(Kind, u64, SortKey); 4] = [
    (Kind::Delaunay, 100_000, SortKey::Power),
    (Kind::Delaunay, 1_300_000, SortKey::Power),
    (Kind::Tets, 6_000_000, SortKey::Centroid),
    (Kind::Tets, 10_000_000, SortKey::Centroid),
];
/// What generating and sorting take a cell.
const BYTES: u64 = 200;
/// Degrees from the view before.
const STEPS: [f64; 3] = [90.0, 1.0, 3.0];
/// As the parts of a frame.
const PARTS_PER_THREAD: usize = 8;
/// Pairs that come at a time, as those of a block.
const BLOCK: usize = Dataset::BLOCK_CELLS;

#[derive(Serialize)]
pub(super) struct Row {
    mesh: String,
    cells: usize,
    threads: usize,
    degrees: f64,
    way: &'static str,
    filling: Option<Spread>,
    sorting: Spread,
}

impl Row {
    fn total_ms(&self) -> f64 {
        self.sorting.median_ms + self.filling.map_or(0.0, |filling| filling.median_ms)
    }
}

pub(super) fn run(max_cells: u64, session: &mut Session) -> Outcome<Vec<Row>> {
    let mut rows = Vec::new();
    for (kind, cells, key) in MESHES.into_iter().filter(|mesh| mesh.1 <= max_cells) {
        if session.admits(&format!("views of {}", count(cells, "cell")), cells * BYTES, 0.0) {
            let _progress = Progress::running(format!("turning {}", count(cells, "cell")));
            rows.extend(of_mesh(&Subject::generated(kind, cells)?, key, session)?);
        }
    }
    Ok(rows)
}

/// The pairs of a view, in memory order.
fn pairs(dataset: &Dataset, vertices: &[SceneVertex], key: SortKey, degrees: f64) -> Result<Vec<Pair>> {
    let view = View::new(&camera(dataset, [1024; 2], 0.0).orbited(degrees), dataset)?;
    let maker = KeyMaker::new(key, &view, &[]);
    let (mut pairs, cells): (_, Vec<u32>) = (Vec::new(), (0..BLOCK as u32).collect());
    for block in 0..dataset.blocks.len() {
        let (block, mut keys) = (dataset.block(block), Vec::new());
        maker.keys(&block, vertices, &cells[..block.len()], &mut keys);
        pairs.extend(keys.iter().zip(block.base as u32..).map(|(&key, cell)| pair(key, cell)));
    }
    Ok(pairs)
}

fn of_mesh(subject: &Subject, key: SortKey, session: &Session) -> Outcome<Vec<Row>> {
    let Subject { name, dataset, field } = subject;
    let vertices = scene_vertices(dataset, field);
    let now = pairs(dataset, &vertices, key, 0.0)?;
    let mut expected = now.clone();
    expected.par_sort_unstable();
    let check = |found: &Vec<Pair>, way| ensure(*found == expected, || format!("{way}: not the library's order"));
    let runs = session.runs(if now.len() > 2_000_000 { 7 } else { 15 });
    let mut rows = Vec::new();
    let mut push = |degrees, way, filling, sorting| {
        let (mesh, cells, threads) = (name.clone(), now.len(), rayon::current_num_threads());
        rows.push(Row { mesh, cells, threads, degrees, way, filling, sorting });
    };
    for degrees in STEPS {
        let before = pairs(dataset, &vertices, key, degrees)?;
        // A typical depth moves by this share of the range of depths; more is no step.
        let moved = (degrees < 10.0).then(|| degrees.to_radians() * 0.6);
        let mut memory = (FrameSort::default(), Vec::new());
        let last = |(frames, sorted): &mut (FrameSort, Vec<Pair>)| {
            fill(frames, &before, None);
            frames.finish(sorted);
        };
        let filling = measure(session, runs, &mut memory, last, |(frames, _)| fill(frames, &now, moved), |_| Ok(()))?;
        let ready = |memory: &mut (FrameSort, Vec<Pair>)| {
            last(memory);
            fill(&mut memory.0, &now, moved);
        };
        let work = |(frames, sorted): &mut (FrameSort, Vec<Pair>)| frames.finish(sorted);
        let sorting = measure(session, runs, &mut memory, ready, work, |(_, found)| check(found, FRAMES))?;
        push(degrees, FRAMES, Some(filling), sorting);
        drop(memory);

        let work = |(found, scratch): &mut (Vec<Pair>, Vec<Pair>)| sort(found, scratch);
        let check = |way| move |(found, _): &(Vec<Pair>, Vec<Pair>)| check(found, way);
        let mut memory = (Vec::new(), Vec::new());
        if Some(&degrees) == STEPS.first() {
            let ready = |(found, _): &mut (Vec<Pair>, Vec<Pair>)| found.clone_from(&now);
            let sorting = measure(session, runs, &mut memory, ready, work, check(SORT))?;
            push(degrees, SORT, None, sorting);
        }
        let mut order = before;
        order.par_sort_unstable();
        let look_up = |(found, _): &mut (Vec<Pair>, Vec<Pair>)| {
            order.par_iter().map(|&last| now[index_of(last) as usize]).collect_into_vec(found);
        };
        let filling = measure(session, runs, &mut memory, |_| {}, look_up, |_| Ok(()))?;
        let sorting = measure(session, runs, &mut memory, look_up, work, check(LAST_ORDER))?;
        push(degrees, LAST_ORDER, Some(filling), sorting);
    }
    Ok(rows)
}

const FRAMES: &str = "radix::frames";
const SORT: &str = "radix::sort";
const LAST_ORDER: &str = "radix::sort, in the last order";

/// Puts the pairs of a view into parts, on all threads.
fn fill(frames: &mut FrameSort, pairs: &[Pair], moved: Option<f64>) {
    let blocks = pairs.len().div_ceil(BLOCK);
    let of_part = blocks.div_ceil(PARTS_PER_THREAD * rayon::current_num_threads()).max(1) * BLOCK;
    let parts = frames.begin(pairs.len().div_ceil(of_part), moved);
    parts.par_iter_mut().zip(pairs.par_chunks(of_part)).for_each(|(part, pairs)| {
        pairs.chunks(BLOCK).for_each(|block| part.extend(block.iter().copied()));
    });
}

pub(super) fn table(rows: &[Row]) -> Table {
    let head =
        ["cells", "view", "way", "filling, ms", "sorting, ms", "±", "million/s", "against a new view", "with filling"];
    let mut table = Table::new("Sorting the cells of a view", &head);
    for row in rows {
        let is_new = row.degrees >= 10.0;
        let new = |way| rows.iter().find(|new| new.cells == row.cells && new.degrees >= 10.0 && new.way == way);
        let ratio = |of: &dyn Fn(&Row) -> f64| {
            new(row.way).filter(|_| !is_new).map_or_else(none, |new| format!("{:.2}", of(new) / of(row)))
        };
        table.row([
            grouped(row.cells as u64),
            if is_new { "new".to_owned() } else { format!("{}° on", row.degrees) },
            row.way.to_owned(),
            row.filling.map_or_else(none, |filling| digits(filling.median_ms)),
            digits(row.sorting.median_ms),
            format!("{:.0} %", row.sorting.percent() / 2.0),
            digits(row.cells as f64 * 1e-3 / row.sorting.median_ms),
            ratio(&|row| row.sorting.median_ms),
            ratio(&Row::total_ms),
        ]);
    }
    table.remark(
        "The last two columns tell how many times as long a new view takes by the same way, to sort and with filling.",
    );
    table
}
