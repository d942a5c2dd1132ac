//! What a session costs: how long each kind of change takes, what it holds at most, how soon a picture ends that nobody wants.
//!
//! `cargo run --release --no-default-features --example costs -- 1000000 1024` tells costs, the same with `cancel centroid` at the end (or
//! another order) how soon pictures end. The figures of docs/embedding.md come from here.

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

/// How often a picture is cancelled.
const MOMENTS: u32 = 16;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let wanted: f64 = std::env::args().nth(1).unwrap_or("1000000".to_owned()).parse()?;
    let size: u32 = std::env::args().nth(2).unwrap_or("1024".to_owned()).parse()?;
    let (points, corners) = mesh((wanted / 6.0).cbrt().round().max(1.0) as u32);
    let value = |p: &[f32; 3], time: f32| (9.0 * p[0] + time).sin() * (7.0 * p[1]).cos() * (5.0 * p[2] - time).sin();
    let values: Vec<Vec<f32>> =
        [0.0, 1.0].map(|time| points.iter().map(|p| value(p, time)).collect()).into_iter().collect();
    let count = corners.len() / 4;
    println!("{count} tetrahedra, {} points, {size}x{size} pixels", points.len());

    let cells = Cells::OfKind { kind: &TETRAHEDRON, points: Indices::U32(&corners) };
    let mesh = MeshView::new(Positions::F32(&points), cells).with_scalars(Association::Point, Scalars::F32(&values[0]));
    if std::env::args().nth(3).as_deref() == Some("cancel") {
        return cancel(&mesh, size, std::env::args().nth(4).unwrap_or("auto".to_owned()).parse()?);
    }

    let held = || anonymous_bytes().unwrap_or(0) as f64 / count as f64;
    let before = held();
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
    picture(&mut session, "picture", &camera, &options)?;
    println!("    at most {:.1} bytes a cell beside the caller's arrays", peak.get());

    Ok(())
}

/// How soon a picture ends that nobody wants: asked at moments spread over it, of a session that has drawn and of a new one's first.
fn cancel(mesh: &MeshView<'_, '_>, size: u32, sort: SortMethod) -> Result<(), Box<dyn std::error::Error>> {
    let transfer = TransferFunction::constant([1.0, 0.8, 0.6], 2.0)?;
    let options = RenderOptions { sort, ..RenderOptions::default() };
    let mut session = Session::on(Threads::Count(2), mesh)?;
    let camera = Camera::framing(&session.corners_world(), 35.0, 20.0, size, size);
    let start = Instant::now();
    session.render(&camera, &transfer, &options)?;
    let first = start.elapsed();
    let start = Instant::now();
    session.render(&camera.orbited(7.0), &transfer, &options)?;
    let later = start.elapsed();
    println!("in {sort} order: the first picture {:.2} s, another {:.2} s", first.as_secs_f64(), later.as_secs_f64());
    for (what, is_first, whole) in [("a later picture", false, later), ("a session's first", true, first)] {
        let mut late_ms = Vec::new();
        for moment in 0..MOMENTS {
            if is_first {
                session = Session::on(Threads::Count(2), mesh)?;
            }
            let token = session.cancel_token();
            let asked = std::thread::spawn(move || {
                std::thread::sleep(whole.mul_f64((f64::from(moment) + 0.5) / f64::from(MOMENTS + 1)));
                token.cancel();
                Instant::now()
            });
            let result = session.render(&camera.orbited(11.0 * f64::from(moment)), &transfer, &options);
            let ended = Instant::now();
            let asked = asked.join().map_err(|_| "the thread that cancels failed")?;
            match result {
                Err(Error::Cancelled) => late_ms.push(ended.saturating_duration_since(asked).as_secs_f64() * 1e3),
                _ => session.cancel_token().reset(),
            }
        }
        late_ms.sort_by(f64::total_cmp);
        let (median, longest) = (late_ms.get(late_ms.len() / 2), late_ms.last());
        println!("    {what}, cancelled {} times, ends after {median:.1?} ms, {longest:.1?} at most", late_ms.len());
    }
    let rendered = session.render(&camera, &transfer, &options)?;
    println!("    the picture after that has {} cells", rendered.cells.drawn);
    Ok(())
}
