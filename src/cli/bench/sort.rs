//! `bench sort`: CellFast's table 1, the library's sort against ours; and the sorts of views that turn.
//!
//! Keys of 32 random bits with 32-bit indices, as the paper sorts a float with an unsigned long. Of *nearly sorted* ones
//! one in ten thousand stands elsewhere. Every answer is compared with the library's, which is checked itself: keys
//! ascend, and every index is there once.

mod views;

use cellfan::stages::sort::radix::{Pair, index_of, pair, sort, sort_local};
use clap::Args;
use rayon::prelude::*;
use serde::Serialize;
use serde_json::json;

use super::record::{Report, value};
use super::session::Session;
use super::spread::{Spread, measure};
use super::tables::{Table, digits, none};
use super::{Outcome, ensure};
use crate::cli::numbers::{count, grouped};
use crate::cli::progress::Progress;

#[derive(Args)]
pub(super) struct Arguments {
    /// The largest of the sizes, which start at 10,000 and grow tenfold, and of the meshes [default: 100000000; with --quick 100000].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(10_000..))]
    max_keys: Option<u32>,
}

/// A sort of pairs, with memory that it may use.
type Sorter = fn(&mut Vec<Pair>, &mut Vec<Pair>);

/// What is compared.
struct Routine {
    name: &'static str,
    is_ours: bool,
    is_parallel: bool,
    sorter: Sorter,
}

const ROUTINES: [Routine; 4] = [
    Routine { name: "sort_unstable", is_ours: false, is_parallel: false, sorter: |pairs, _| pairs.sort_unstable() },
    Routine { name: "radix::sort_local", is_ours: true, is_parallel: false, sorter: sort_local },
    Routine {
        name: "par_sort_unstable",
        is_ours: false,
        is_parallel: true,
        sorter: |pairs, _| pairs.par_sort_unstable(),
    },
    Routine { name: "radix::sort", is_ours: true, is_parallel: true, sorter: sort },
];

const INPUTS: [&str; 3] = ["random", "sorted", "nearly sorted"];

/// One pair in so many is exchanged with another where the input is nearly sorted; each exchange moves two.
const PAIRS_PER_EXCHANGE: usize = 20_000;

/// Bytes a key: input, answer, work, scratch, and what a merge takes.
const BYTES_PER_KEY: u64 = 5 * size_of::<Pair>() as u64;

/// CellFast (Wittenbrink 1999), table 1: seconds for 10^4 to 10^8 pairs on an HP J5000, PA-RISC 8500 at 440 MHz, one thread.
const PAPER: [(&str, &str, [f64; 5]); 4] = [
    ("qsort", "random", [0.04, 0.48, 5.71, 66.03, 755.56]),
    ("qsort", "sorted", [0.02, 0.24, 2.89, 35.46, 443.94]),
    ("quicksort", "random", [0.01, 0.13, 1.47, 16.26, 165.82]),
    ("quicksort", "sorted", [0.01, 0.05, 0.58, 6.07, 48.96]),
];

#[derive(Serialize)]
struct Row {
    routine: &'static str,
    is_ours: bool,
    threads: usize,
    input: &'static str,
    keys: usize,
    time: Spread,
    ns_per_key: f64,
}

pub(super) fn run(arguments: &Arguments, session: &mut Session) -> Outcome<Report> {
    let max_keys = arguments.max_keys.unwrap_or(if session.is_quick { 100_000 } else { 100_000_000 }) as usize;
    let mut rows = Vec::new();
    let mut sizes = Vec::new();
    let mut last_s = 0.0;
    for keys in (4..10).map(|power| 10_usize.pow(power)).take_while(|&keys| keys <= max_keys) {
        if !session.admits(
            &format!("sorting {}", count(keys as u64, "key")),
            keys as u64 * BYTES_PER_KEY,
            11.0 * last_s,
        ) {
            continue;
        }
        let start = std::time::Instant::now();
        rows.extend(of_size(keys, session)?);
        sizes.push(keys);
        last_s = start.elapsed().as_secs_f64();
    }
    let views = views::run(max_keys as u64, session)?;
    let paper =
        PAPER.map(|(routine, input, seconds)| json!({ "routine": routine, "input": input, "seconds": seconds }));
    Ok(Report {
        benchmark: "sort",
        settings: json!({ "max_keys": max_keys, "bytes_per_pair": size_of::<Pair>(), "pairs_per_exchange": PAIRS_PER_EXCHANGE }),
        results: json!({
            "rows": value(&rows),
            "views": value(&views),
            "paper": { "source": "Wittenbrink 1999, table 1", "machine": "HP J5000, PA-RISC 8500, 440 MHz", "keys": [1e4, 1e5, 1e6, 1e7, 1e8], "rows": paper },
        }),
        tables: vec![times(&rows, &sizes), improvements(&rows, &sizes), views::table(&views)],
    })
}

/// All routines on all inputs of one size.
fn of_size(keys: usize, session: &Session) -> Outcome<Vec<Row>> {
    let runs = session.runs(if keys >= 10_000_000 { 5 } else { 9 });
    let threads = rayon::current_num_threads();
    let routines: Vec<&Routine> = ROUTINES.iter().filter(|routine| threads > 1 || !routine.is_parallel).collect();
    let progress =
        Progress::counting(format!("sorting {}", count(keys as u64, "key")), (INPUTS.len() * routines.len()) as u64);
    let mut random = random();
    let mut input: Vec<Pair> = (0..keys as u32).map(|i| pair(random(), i)).collect();
    let mut expected = input.clone();
    expected.par_sort_unstable();
    ensure(expected.is_sorted() && is_permutation(&expected), || format!("the library's sort of {keys} pairs"))?;
    let mut rows = Vec::new();
    let mut memory = (Vec::with_capacity(keys), Vec::with_capacity(keys));
    for name in INPUTS {
        if name != "random" {
            input.copy_from_slice(&expected);
        }
        if name == "nearly sorted" {
            for _ in 0..keys.div_ceil(PAIRS_PER_EXCHANGE) {
                input.swap(random() as usize % keys, random() as usize % keys);
            }
        }
        for routine in &routines {
            let fill = |(pairs, _): &mut (Vec<Pair>, Vec<Pair>)| {
                pairs.clear();
                pairs.extend_from_slice(&input);
            };
            let time = measure(
                session,
                runs,
                &mut memory,
                fill,
                |(pairs, scratch)| (routine.sorter)(pairs, scratch),
                |(pairs, _)| ensure(*pairs == expected, || format!("{} of {keys} {name} pairs", routine.name)),
            )?;
            rows.push(Row {
                routine: routine.name,
                is_ours: routine.is_ours,
                threads: if routine.is_parallel { threads } else { 1 },
                input: name,
                keys,
                time,
                ns_per_key: time.median_ms * 1e6 / keys as f64,
            });
            progress.step();
        }
    }
    Ok(rows)
}

/// Whether the indices are 0 to n − 1, each once.
fn is_permutation(pairs: &[Pair]) -> bool {
    let mut seen = vec![false; pairs.len()];
    pairs.iter().all(|&pair| seen.get_mut(index_of(pair) as usize).is_some_and(|seen| !std::mem::replace(seen, true)))
}

/// The upper half of a linear congruential generator (Knuth's MMIX), always the same.
fn random() -> impl FnMut() -> u32 {
    let mut state = 0x9e37_79b9_7f4a_7c15_u64;
    move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 32) as u32
    }
}

/// The column of the paper's table for so many keys.
fn column(keys: usize) -> Option<usize> {
    (0..5).find(|&column| keys == 10_usize.pow(4 + column as u32))
}

/// A row for each routine and input, a column for each size, as in the paper.
fn times(rows: &[Row], sizes: &[usize]) -> Table {
    let sizes_text: Vec<String> = sizes.iter().map(|&keys| grouped(keys as u64)).collect();
    let head: Vec<&str> =
        ["routine", "threads", "input"].into_iter().chain(sizes_text.iter().map(String::as_str)).collect();
    let mut table = Table::new("Sorting pairs of key and index: seconds, ± half the distance of the quartiles", &head);
    for (input, routine) in INPUTS.iter().flat_map(|input| ROUTINES.iter().map(move |routine| (input, routine))) {
        let of_size = |&keys: &usize| {
            rows.iter().find(|row| row.routine == routine.name && row.input == *input && row.keys == keys)
        };
        let Some(first) = sizes.first().and_then(of_size) else { continue };
        let cell = |row: Option<&Row>| {
            row.map_or_else(none, |row| format!("{} ± {:.0} %", digits(row.time.median_s()), row.time.percent() / 2.0))
        };
        let name = format!("{}{}", routine.name, if routine.is_ours { " (ours)" } else { "" });
        let cells = sizes.iter().map(|keys| cell(of_size(keys)));
        table.row([name, first.threads.to_string(), (*input).to_owned()].into_iter().chain(cells));
    }
    for (routine, input, seconds) in PAPER {
        let cells = sizes.iter().map(|&keys| column(keys).map_or_else(none, |column| seconds[column].to_string()));
        table.row([format!("{routine} (CellFast)"), "1".to_owned(), input.to_owned()].into_iter().chain(cells));
    }
    table.remark("CellFast: Wittenbrink 1999, table 1, on an HP J5000 (PA-RISC 8500, 440 MHz), where quicksort is the paper's own.");
    table
}

/// How much less time ours takes than the library's on as many threads, as in the paper.
fn improvements(rows: &[Row], sizes: &[usize]) -> Table {
    let sizes_text: Vec<String> = sizes.iter().map(|&keys| grouped(keys as u64)).collect();
    let head: Vec<&str> =
        ["ours", "threads", "input"].into_iter().chain(sizes_text.iter().map(String::as_str)).collect();
    let mut table = Table::new("Time saved against the library's sort on as many threads", &head);
    let saved = |ours: f64, library: f64| format!("{:.0} %", 100.0 * (1.0 - ours / library));
    for ours in ROUTINES.iter().filter(|routine| routine.is_ours) {
        for input in INPUTS {
            let of = |keys: usize, is_wanted: &dyn Fn(&&Row) -> bool| {
                rows.iter().filter(|row| row.keys == keys && row.input == input).find(is_wanted)
            };
            let pair = |&keys: &usize| {
                let mine = of(keys, &|row| row.routine == ours.name)?;
                Some((mine, of(keys, &|row| !row.is_ours && row.threads == mine.threads)?))
            };
            let Some((first, _)) = sizes.first().and_then(pair) else { continue };
            let cells = sizes.iter().map(|keys| {
                pair(keys).map_or_else(none, |(mine, library)| saved(mine.time.median_ms, library.time.median_ms))
            });
            table.row([ours.name.to_owned(), first.threads.to_string(), input.to_owned()].into_iter().chain(cells));
        }
    }
    for (library, quicksort) in [(PAPER[0], PAPER[2]), (PAPER[1], PAPER[3])] {
        let cell =
            |&keys: &usize| column(keys).map_or_else(none, |column| saved(quicksort.2[column], library.2[column]));
        let head = ["quicksort (CellFast)".to_owned(), "1".to_owned(), library.1.to_owned()];
        table.row(head.into_iter().chain(sizes.iter().map(cell)));
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_permutation_has_every_index_once() {
        let pairs = |indices: &[u32]| indices.iter().map(|&i| pair(7, i)).collect::<Vec<_>>();
        assert!(is_permutation(&pairs(&[2, 0, 1])) && is_permutation(&[]));
        assert!(!is_permutation(&pairs(&[0, 1, 1])) && !is_permutation(&pairs(&[0, 1, 3])));
    }

    #[test]
    fn the_paper_says_what_its_times_give() {
        // Its table prints the improvement too: 75, 73, 74, 75, 78 % and 50, 79, 80, 83, 89 %.
        let printed = [[75.0, 73.0, 74.0, 75.0, 78.0], [50.0, 79.0, 80.0, 83.0, 89.0]];
        for (input, printed) in printed.iter().enumerate() {
            for (column, printed) in printed.iter().enumerate() {
                let saved = 100.0 * (1.0 - PAPER[input + 2].2[column] / PAPER[input].2[column]);
                assert!((saved - printed).abs() < 1.0, "{saved} is printed as {printed}");
            }
        }
    }
}
