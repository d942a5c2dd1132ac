//! The rooms of the library: who may use whom, where unsafe code is, how long a file is.
//!
//! Rule: rooms stand in tiers (`TIERS`, the first lowest). A file names a room of another tier only if that tier is
//! lower, and a room of its own tier only if the pair stands in `WITHIN`. `lib.rs` re-exports everything; test code at a
//! file's end or in a `tests` file may use anything.

use std::path::{Path, PathBuf};

/// DESIGN, "Rooms"; `atomic` (files that appear whole) is below everything that writes files, `memory` (asked for before
/// it is taken) below everything whose size a user chooses.
const TIERS: &[&[&str]] = &[
    &["error", "profile", "image", "camera", "atomic", "memory"],
    &["columns", "cells", "optics"],
    &["io", "stages", "hierarchy", "generate", "geometry"],
    &["backends", "depth_planes"],
    &["render"],
    &["cli", "capi", "main"],
];

/// Pairs (user, used) within a tier: errors are everyone's, files are written through `atomic`, and columns know the faces
/// of the kinds of cells; a mesh's surface is its faces without a neighbour, which a sort finds too, and those of other files are read; a profile
/// says which part of a picture a camera took, and a z-buffer holds the matrices of its camera.
const WITHIN: &[(&str, &str)] = &[
    ("profile", "error"),
    ("image", "error"),
    ("camera", "error"),
    ("atomic", "error"),
    ("memory", "error"),
    ("image", "memory"),
    ("image", "camera"),
    ("profile", "atomic"),
    ("profile", "memory"),
    ("profile", "camera"),
    ("image", "atomic"),
    ("columns", "cells"),
    ("geometry", "stages"),
    ("io", "geometry"),
    ("main", "cli"),
];

/// Names that the crate's root re-exports, with the rooms they come from.
const REEXPORTED: &[(&str, &str)] = &[
    ("Camera", "camera"),
    ("Projection", "camera"),
    ("Region", "camera"),
    ("Dataset", "columns"),
    ("Field", "columns"),
    ("FieldSelection", "columns"),
    ("Points", "columns"),
    ("TetMesh", "columns"),
    ("Error", "error"),
    ("Result", "error"),
    ("Image", "image"),
    ("ControlPoint", "optics"),
    ("Integral", "optics"),
    ("Model", "optics"),
    ("TransferFunction", "optics"),
    ("CpuMethod", "render"),
    ("RenderOptions", "render"),
    ("Rendered", "render"),
    ("Renderer", "render"),
    ("Scene", "render"),
    ("SortMethod", "stages"),
];

/// Lines a file may have.
const LONGEST: usize = 450;

fn tier_of(room: &str) -> Option<usize> {
    TIERS.iter().position(|rooms| rooms.contains(&room))
}

/// The room a file of `src` belongs to: its folder, or its name at the top.
fn room_of(path: &Path) -> String {
    let first = path.iter().next().unwrap_or_default().to_string_lossy();
    first.trim_end_matches(".rs").to_owned()
}

fn is_test(path: &Path) -> bool {
    path.iter().any(|part| part == "tests" || part == "tests.rs")
}

/// Source without comments, and without the module of unit tests that ends a file.
fn code_of(text: &str) -> String {
    let mut code = String::new();
    for line in text.lines() {
        let opens_tests = line.trim() == "mod tests {" || line.ends_with(" mod tests {");
        if opens_tests && code.trim_end().ends_with(']') {
            break; // #[cfg(test)] or #[expect(…)] before it
        }
        let uncommented = line.split_once("//").map_or(line, |(before, _)| before);
        code.push_str(uncommented);
        code.push('\n');
    }
    code
}

/// The rooms that the code names after `prefix`, as `prefixX` or in the braces of `prefix{X, Y}`.
fn rooms_named(code: &str, prefix: &str) -> Vec<String> {
    let name = |text: &str| -> String { text.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect() };
    let mut names = Vec::new();
    for (at, _) in code.match_indices(prefix) {
        let preceding = code[..at].chars().next_back();
        if preceding.is_some_and(|c| c.is_alphanumeric() || c == '_' || c == ':') {
            continue; // part of a longer word or path
        }
        let rest = &code[at + prefix.len()..];
        let Some(group) = rest.strip_prefix('{') else {
            names.push(name(rest));
            continue;
        };
        let (mut depth, mut item) = (0, String::new());
        for c in group.chars() {
            match c {
                '{' => depth += 1,
                '}' if depth == 0 => break,
                '}' => depth -= 1,
                ',' if depth == 0 => names.push(name(std::mem::take(&mut item).trim())),
                _ if depth == 0 => item.push(c),
                _ => {}
            }
        }
        names.push(name(item.trim()));
    }
    names.into_iter().filter(|name| !name.is_empty()).collect()
}

/// What is wrong with one file of `src`; `path` is relative to it.
fn problems(path: &Path, text: &str) -> Vec<String> {
    let mut problems = Vec::new();
    let mut complain = |problem: String| problems.push(format!("{}: {problem}", path.display()));
    let lines = text.lines().count();
    if lines > LONGEST {
        complain(format!("{lines} lines; a file holds one concept in at most {LONGEST}"));
    }
    if path.file_name().is_some_and(|name| name == "mod.rs") && !text.starts_with("//! ") {
        complain("a room opens with //! and what comes in and goes out".to_owned());
    }
    let code = code_of(text);
    let words = code.split(|c: char| !(c.is_alphanumeric() || c == '_'));
    let has_unsafe = words.clone().any(|word| word == "unsafe");
    let head: String = text.lines().take_while(|line| !line.starts_with("use ") && !line.contains("fn ")).collect();
    let says_why = head.contains("#![expect(unsafe_code, reason = ")
        || (head.contains("#![expect(") && head.contains("unsafe_code,") && head.contains("reason = "));
    if has_unsafe && !says_why {
        complain("unsafe code in a file that does not open with #![expect(unsafe_code, reason = …)]".to_owned());
    }

    let room = room_of(path);
    if room == "lib" || is_test(path) {
        return problems;
    }
    let Some(tier) = tier_of(&room) else {
        complain(format!("{room:?} stands in no tier"));
        return problems;
    };
    let mut used = rooms_named(&code, "crate::");
    if room == "main" || room == "cli" {
        used.extend(rooms_named(&code, "cellfan::"));
    }
    for name in used {
        let used = REEXPORTED.iter().find(|(item, _)| *item == name).map_or(name.as_str(), |(_, room)| room);
        match tier_of(used) {
            _ if used == room => {}
            Some(below) if below < tier => {}
            Some(same) if same == tier && WITHIN.contains(&(room.as_str(), used)) => {}
            Some(same) if same == tier => complain(format!("{room} may not use {used}, which stands beside it")),
            Some(_) => complain(format!("{room} may not use {used}, which stands above it")),
            None => complain(format!("crate::{name} is in no tier and no re-export known here")),
        }
    }
    problems
}

fn files_below(folder: &Path, files: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            files_below(&path, files);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            files.push(path);
        }
    }
}

#[test]
fn rooms_use_only_what_is_below_them() {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut files = Vec::new();
    files_below(&src, &mut files);
    assert!(files.len() > 50, "{} files in src", files.len());
    let found: Vec<String> = files
        .iter()
        .flat_map(|path| problems(path.strip_prefix(&src).unwrap(), &std::fs::read_to_string(path).unwrap()))
        .collect();
    assert!(found.is_empty(), "\n{}", found.join("\n"));
}

/// The checker complains about bad files, and only about them.
#[test]
fn the_checker_can_complain() {
    let complaint = |path: &str, text: &str| problems(Path::new(path), text).join("; ");
    let bad = [
        ("columns/build.rs", "use crate::stages::View;\n", "columns may not use stages, which stands above it"),
        ("cells/split.rs", "use crate::columns::Field;\n", "cells may not use columns, which stands beside it"),
        (
            "camera.rs",
            "use crate::{\n    error::Error,\n    columns::{Dataset, Field},\n};\n",
            "camera may not use columns",
        ),
        ("stages/cull.rs", "fn f(r: &crate::Renderer) {}\n", "stages may not use render"),
        ("image/npy.rs", "fn f() -> crate::Dataset {}\n", "image may not use columns"),
        ("io/mod.rs", "//! In.\nuse crate::generate::grid;\n", "io may not use generate, which stands beside it"),
        ("shaders/mod.rs", "//! In.\n", "\"shaders\" stands in no tier"),
        ("io/mod.rs", "use crate::columns;\n", "a room opens with //!"),
        ("render.rs", "use crate::error::Error;\nfn f() { unsafe { g() } }\n", "unsafe code in a file"),
        ("render.rs", "fn f() {}\n#![expect(unsafe_code, reason = \"late\")]\nunsafe fn g() {}\n", "unsafe code"),
        ("render.rs", &"\n".repeat(LONGEST + 1), "451 lines"),
        ("error.rs", "mod tests {}\nuse crate::unknown::X;\n", "crate::unknown is in no tier"),
    ];
    for (path, text, expected) in bad {
        let found = complaint(path, text);
        assert!(found.contains(expected), "{path}: {found:?} for {expected:?}");
    }
    let good = [
        (
            "stages/cull.rs",
            "//! Like crate::render, unsafe.\nuse crate::columns::{Field, Dataset};\nuse crate::stages::View;\n",
        ),
        ("image/png.rs", "use crate::atomic::write_atomically;\nuse crate::{Error, Result};\n"),
        ("columns/mod.rs", "//! In.\n#[cfg(test)]\nmod tests {\n    use crate::render::Scene;\n}\n"),
        ("columns/build/tests.rs", "use crate::io::open;\n"),
        ("lib.rs", "pub use render::Renderer;\n"),
        ("io/mapping.rs", "//! A map.\n#![expect(unsafe_code, reason = \"mmap\")]\nunsafe fn f() {}\n"),
        ("render.rs", &"\n".repeat(LONGEST)),
    ];
    for (path, text) in good {
        assert_eq!(complaint(path, text), "", "{path}");
    }
}
