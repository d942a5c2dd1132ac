//! What a session costs: how long each kind of change takes, what it holds at most, how soon a picture ends that nobody wants.
//!
//! `cargo run --release --no-default-features --example costs -- 1000000`. The figures of docs/embedding.md come from here.

use std::cell::Cell;
use std::time::{Duration, Instant};

use cellfan::cells::TETRAHEDRON;
use cellfan::columns::Association;
use cellfan::profile::anonymous_bytes;
use cellfan::session::{Cells, Indices, MeshView, Scalars, Session, Threads};
use cellfan::{Camera, Error, Positions, RenderOptions, SortMethod, TransferFunction};

/// Six tetrahedra in each box of a bent grid with `side` boxes along each axis: points, corners.
fn mesh(side: u32) -> (Vec<[f32; 3]>, Vec<u32>) {
    let along = side + 1;
    let point = |i: u32, j: u32, k: u32| i + along * (j + along * k);
    let mut points = Vec::with_capacity((along * along * along) as usize);
    let mut corners = Vec::with_capacity((side * side * side) as usize * 24);
    for n in 0..along * along * along {
        let [x, y, z] = [n % along, n / along % along, n / (along * along)].map(|c| c as f32 / side as f32);
        points.push([x + 0.1 * (5.0 * y).sin(), y + 0.1 * (4.0 * z).cos(), z + 0.05 * (6.0 * x).sin()]);
    }
    for n in 0..side * side * side {
        let at = [n % side, n / side % side, n / (side * side)];
        for order in [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]] {
            let mut at = at;
            corners.push(point(at[0], at[1], at[2]));
            for axis in order {
                at[axis] += 1;
                corners.push(point(at[0], at[1], at[2]));
            }
        }
    }
    (points, corners)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let wanted: f64 = std::env::args().nth(1).unwrap_or("1000000".to_owned()).parse()?;
    let size: u32 = std::env::args().nth(2).unwrap_or("1024".to_owned()).parse()?;
    let (points, corners) = mesh((wanted / 6.0).cbrt().round().max(1.0) as u32);
    let value = |p: &[f32; 3], time: f32| (9.0 * p[0] + time).sin() * (7.0 * p[1]).cos() * (5.0 * p[2] - time).sin();
    let values: Vec<Vec<f32>> =
        [0.0, 1.0].map(|time| points.iter().map(|p| value(p, time)).collect()).into_iter().collect();
    let count = corners.len() / 4;
    println!("{count} tetrahedra, {} points, {size}x{size} pixels", points.len());

    let held = || anonymous_bytes().unwrap_or(0) as f64 / count as f64;
    let before = held();
    let cells = Cells::OfKind { kind: &TETRAHEDRON, points: Indices::U32(&corners) };
    let mesh = MeshView::new(Positions::F32(&points), cells).with_scalars(Association::Point, Scalars::F32(&values[0]));
    let timed = |what: &str, start: Instant| {
        let elapsed = start.elapsed();
        println!("{what:46} {:9.1} ms   {:5.1} bytes a cell", elapsed.as_secs_f64() * 1e3, held() - before);
        elapsed
    };
    let start = Instant::now();
    let mut session = Session::on(Threads::Count(2), &mesh)?;
    let new = timed("Session::on", start);
    let transfer = TransferFunction::constant([1.0, 0.8, 0.6], 2.0)?;
    let options = RenderOptions { sort: SortMethod::Centroid, ..RenderOptions::default() };
    let camera = Camera::framing(&session.corners_world(), 35.0, 20.0, size, size);
    let turned = camera.orbited(7.0);
    let peak = Cell::new(0.0_f64);
    let picture = |session: &mut Session<'_>, what: &str, camera: &Camera, options: &RenderOptions| {
        let start = Instant::now();
        let rendered = session.render(camera, &transfer, options)?;
        let seen = rendered.profile.peak_anonymous_bytes().unwrap_or(0) as f64 / count as f64 - before;
        peak.set(peak.get().max(seen));
        Ok::<Duration, Error>(timed(what, start))
    };
    let first = picture(&mut session, "first picture", &camera, &options)?;
    let second = picture(&mut session, "another view", &turned, &options)?;
    println!(
        "    the first picture with its session takes {:.2} times the second",
        (new + first).as_secs_f64() / second.as_secs_f64()
    );
    for step in [1, 0] {
        let start = Instant::now();
        session.update_scalars(Association::Point, Scalars::F32(&values[step]))?;
        timed("update_scalars", start);
        picture(&mut session, "picture from the same place", &turned, &options)?;
    }
    picture(&mut session, "another view", &camera, &options)?;
    picture(&mut session, "another view in exact order", &turned, &RenderOptions::default())?;
    let start = Instant::now();
    session.update_positions(Positions::F32(&points))?;
    timed("update_positions", start);
    picture(&mut session, "picture", &camera, &options)?;
    let start = Instant::now();
    session.update_topology(&mesh)?;
    timed("update_topology", start);
    let whole = picture(&mut session, "picture", &camera, &options)?;
    println!("    at most {:.1} bytes a cell beside the caller's arrays", peak.get());

    // Cancelled at eleven moments of a picture, of the whole mesh and of a new session's first.
    let mut longest = [Duration::ZERO; 2];
    for (nth, longest) in longest.iter_mut().enumerate() {
        for moment in 0..11 {
            if nth == 1 {
                session = Session::on(Threads::Count(2), &mesh)?;
            }
            let token = session.cancel_token();
            let asked = std::thread::spawn(move || {
                std::thread::sleep(whole.mul_f64((f64::from(moment) + 0.5) / 12.0));
                token.cancel();
                Instant::now()
            });
            let result = session.render(if moment % 2 == 0 { &camera } else { &turned }, &transfer, &options);
            let ended = Instant::now();
            let asked = asked.join().map_err(|_| "the thread that cancels failed")?;
            if let Err(Error::Cancelled) = result {
                *longest = (*longest).max(ended.saturating_duration_since(asked));
            } else {
                session.cancel_token().reset();
            }
        }
    }
    let [later, of_first] = longest.map(|longest| longest.as_secs_f64() * 1e3);
    println!("    a cancelled picture ends within {later:.1} ms, the first of a session within {of_first:.1} ms");
    picture(&mut session, "picture after that", &camera, &options)?;
    Ok(())
}
