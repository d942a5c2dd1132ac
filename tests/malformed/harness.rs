//! One reader against one input, or against as many as its time allows.
//!
//! Panics are caught; a clock in another thread ends the program where a reader does not come back; the allocator says
//! what was held. An input that fails is saved under target/tmp, and its name is in the message.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering::SeqCst};
use std::sync::{Mutex, MutexGuard, Once, PoisonError};
use std::time::{Duration, Instant};

use crate::allocation;
use crate::mutate::Mutator;
use crate::random::Random;
use crate::targets::Target;

/// More failures of one reader tell nothing new.
const ENOUGH: usize = 20;

/// A reader that has not come back after this many of its limits never will.
const PATIENCE: u32 = 10;

/// Only one reader runs at a time: memory is counted for the whole program.
static ONE_AT_A_TIME: Mutex<()> = Mutex::new(());

/// What is being read, for those who find that it fails from outside.
static CURRENT: Mutex<Option<Current>> = Mutex::new(None);

/// Where and why the last panic was.
static PANIC: Mutex<String> = Mutex::new(String::new());

static WATCHERS: Once = Once::new();

struct Current {
    reader: &'static str,
    input: Vec<u8>,
    since: Instant,
    limit: Duration,
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// What came of one input.
pub(crate) struct Ran {
    /// Whether the reader took it; the error where not.
    pub(crate) read: Result<(), String>,
    /// Most bytes held.
    pub(crate) peak: usize,
    pub(crate) duration: Duration,
    /// What the reader may not do and did.
    pub(crate) failure: Option<String>,
}

/// Held by each test from its beginning: what the others allocate would be counted.
pub(crate) fn alone() -> MutexGuard<'static, ()> {
    lock(&ONE_AT_A_TIME)
}

/// Reads `input` and says what that took; the caller is [`alone`].
pub(crate) fn run(target: &'static Target, input: &[u8]) -> Ran {
    let limit = Duration::from_millis(target.limits.millis);
    let ran = run_once(target, input);
    // A machine with other work to do stops anything now and then; a slow reader is slow again.
    if ran.duration > limit { run_once(target, input) } else { ran }
}

fn run_once(target: &'static Target, input: &[u8]) -> Ran {
    WATCHERS.call_once(watch);
    let start = Instant::now();
    let limit = Duration::from_millis(target.limits.millis);
    *lock(&CURRENT) = Some(Current { reader: target.name, input: input.to_vec(), since: start, limit });
    let read = || catch_unwind(AssertUnwindSafe(|| (target.read)(input)));
    let (result, peak) = allocation::peak_of(read);
    *lock(&CURRENT) = None;
    let duration = start.elapsed();
    let most = target.limits.bytes(input.len());
    let (read, failure) = match result {
        Err(_) => (Err("panicked".to_owned()), Some(format!("panicked {}", lock(&PANIC)))),
        Ok(Err(message)) if message.trim().is_empty() || message.len() > LONGEST_MESSAGE => {
            let problem = format!("has an error message of {} bytes", message.len());
            (Err(message), Some(problem))
        }
        Ok(Err(message)) if message.contains(char::is_control) => {
            let problem = format!("has control characters in its message {message:?}");
            (Err(message), Some(problem))
        }
        Ok(read) if peak > most => (read, Some(format!("held {peak} bytes, more than {most}"))),
        Ok(read) if duration > limit => (read, Some(format!("took {duration:?}, more than {limit:?}"))),
        Ok(read) => (read, None),
    };
    Ran { read, peak, duration, failure }
}

/// A message is a line or two, and the longest path that can be opened.
const LONGEST_MESSAGE: usize = 8192;

/// Mutations of the reader's seeds until the time is up; what failed, one line each.
pub(crate) fn fuzz(target: &'static Target, time: Duration, seed: u64) -> Vec<String> {
    let _alone = alone();
    let seeds = (target.seeds)();
    let mut failures = Vec::new();
    for (i, file) in seeds.iter().enumerate() {
        let ran = run(target, file);
        // A refused seed reaches little of the reader.
        let refused = ran.read.err().filter(|_| !target.refuses_seeds);
        failures.extend(ran.failure.or(refused).map(|problem| format!("{}: seed {i}: {problem}", target.name)));
    }
    let mut kinds = Vec::new();
    let mut inputs = 0_u64;
    let mut accepted = 0_u64;
    let (mut slowest, mut most, mut most_ratio) = (Duration::ZERO, 0, 0.0_f64);
    let start = Instant::now();
    while start.elapsed() < time && failures.len() < ENOUGH {
        // Each input has a seed of its own, so that any of them can be made again without those before.
        let mut random = Random::new(seed.wrapping_mul(0x0100_0000_01b3) ^ inputs);
        let input = Mutator { seeds: &seeds, words: target.words }.mutate(&mut random);
        let ran = run(target, &input);
        inputs += 1;
        accepted += u64::from(ran.read.is_ok());
        slowest = slowest.max(ran.duration);
        most = most.max(ran.peak);
        most_ratio = most_ratio.max(ran.peak as f64 / input.len().max(4096) as f64);
        if let Some(problem) = ran.failure {
            // The same place panics again and again.
            let kind = problem.replace(|c: char| c.is_ascii_digit(), "");
            if !kinds.contains(&kind) {
                let saved = save(target.name, &input);
                failures.push(format!("{}: {problem}: {}", target.name, saved.display()));
                kinds.push(kind);
            }
        }
    }
    println!(
        "{}: {inputs} inputs in {:.1} s, {accepted} read, slowest {:.0} ms, most {:.1} MiB ({most_ratio:.0} times its input)",
        target.name,
        start.elapsed().as_secs_f64(),
        slowest.as_secs_f64() * 1e3,
        most as f64 / f64::from(1 << 20),
    );
    failures
}

fn save(reader: &str, input: &[u8]) -> PathBuf {
    let hash = input.iter().fold(0xcbf2_9ce4_8422_2325_u64, |hash, &byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3) // FNV-1a
    });
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("malformed-{reader}-{hash:016x}"));
    std::fs::write(&path, input).unwrap();
    path
}

/// For the allocator, before it refuses: the program may end at once.
pub(crate) fn save_before_abort() {
    static BUSY: AtomicBool = AtomicBool::new(false);
    if !BUSY.swap(true, SeqCst) {
        if let Ok(current) = CURRENT.try_lock()
            && let Some(current) = &*current
        {
            let path = save(current.reader, &current.input);
            eprintln!("{}: a request beyond all limits, refused; the input is {}", current.reader, path.display());
        }
        BUSY.store(false, SeqCst);
    }
}

/// Notes panics in place of printing them, and ends the program where a reader hangs.
fn watch() {
    let before = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |info| {
        // Only readers are expected to; a failed assertion of a test is not theirs.
        if lock(&CURRENT).is_none() {
            return before(info);
        }
        let payload = info.payload();
        let text = payload.downcast_ref::<&str>().copied();
        let message = text.or_else(|| payload.downcast_ref::<String>().map(String::as_str)).unwrap_or_default();
        *lock(&PANIC) = info.location().map_or(String::new(), |at| format!("at {at}: ")) + message;
    }));
    std::thread::spawn(|| {
        loop {
            std::thread::sleep(Duration::from_millis(100));
            if let Some(current) = &*lock(&CURRENT)
                && current.since.elapsed() > current.limit * PATIENCE
            {
                let path = save(current.reader, &current.input);
                eprintln!("{}: did not come back; the input is {}", current.reader, path.display());
                std::process::abort();
            }
        }
    });
}
