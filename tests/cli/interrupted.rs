//! Runs that are killed: no partial file under the final name, and what is left is removed by the next run.

use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use super::Place;

/// The temporary files in the place.
fn partials(place: &Place) -> Vec<String> {
    place.names().into_iter().filter(|name| name.starts_with(".cellfan-") && name.ends_with(".partial")).collect()
}

/// Starts the program and waits until it has a temporary file.
fn started(place: &Place, arguments: &str) -> Child {
    let before = partials(place).len();
    let mut command: Command = place.command();
    let mut child = command.args(arguments.split_whitespace()).stderr(Stdio::null()).spawn().unwrap();
    let start = Instant::now();
    while partials(place).len() == before {
        assert!(child.try_wait().unwrap().is_none(), "{arguments}: it ended before it was killed");
        assert!(start.elapsed() < Duration::from_secs(60), "{arguments}: it writes nothing");
        std::thread::sleep(Duration::from_millis(1));
    }
    child
}

/// Kills without a chance to clean up (SIGKILL).
fn kill(mut child: Child) {
    child.kill().unwrap();
    child.wait().unwrap();
}

const STACK: &str = "render mesh.vtu --size 200x200 --frames 100000 --orbit 360 -o stack.npy";

#[test]
fn a_killed_run_leaves_no_result_and_the_next_cleans_up() {
    let place = Place::with_mesh();
    let generate = ["generate tets --cells 1500000 -o large.vtu", "generate tets --cells 3000000 -o large.cells"];
    for arguments in [STACK].into_iter().chain(generate) {
        kill(started(&place, arguments));
        let left = partials(&place);
        assert_eq!(left.len(), 1, "{arguments}: {left:?}");
        assert_eq!(place.names().len(), 2, "{arguments}: {:?}", place.names());
        // Any run that writes into the folder, whatever it writes.
        place.render("-o out.png").succeeds();
        assert_eq!(place.names(), ["mesh.vtu", "out.png"], "{arguments}");
        std::fs::remove_file(place.path("out.png")).unwrap();
    }
}

#[test]
fn a_file_that_is_being_written_and_files_of_others_stay() {
    let place = Place::with_mesh();
    place.write(".cellfan-notes.partial", "mine");
    let living = started(&place, STACK);
    let being_written = partials(&place);
    place.render("-o out.png").succeeds();
    assert_eq!(partials(&place), being_written);
    kill(living);
    place.render("-o out.png").succeeds();
    assert_eq!(place.names(), [".cellfan-notes.partial", "mesh.vtu", "out.png"]);
}

#[test]
fn what_was_there_outlives_a_killed_replacement() {
    let place = Place::with_mesh();
    place.write("stack.npy", "old");
    kill(started(&place, STACK));
    assert_eq!(place.read("stack.npy"), b"old");
}
