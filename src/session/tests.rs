//! The token is looked at every few milliseconds of a thread's work, whatever is drawn in whichever order.

use std::sync::Arc;
use std::time::Duration;

use super::{Cells, Indices, MeshView, Scalars, Session, Threads};
use crate::camera::Camera;
use crate::cells::TETRAHEDRON;
use crate::columns::{Association, Positions};
use crate::control::looks;
use crate::generate::{Settings, tets};
use crate::optics::{Model, TransferFunction};
use crate::render::{RenderOptions, Rendered};
use crate::stages::sort::SortMethod;

/// Beside other tests, with checks of arithmetic on, work takes longer than the 5 ms at most that it takes by itself; a pass over all
/// cells that did not look would take far more.
const MOST: Duration = Duration::from_millis(20);

#[test]
fn threads_look_at_the_token_between_pieces_of_work() {
    let mesh = tets(&Settings { cells: 600_000, jitter: 0.2, ..Settings::default() }).unwrap();
    let points: Vec<[f32; 3]> = (0..mesh.points.len()).map(|i| mesh.points.get(i).as_vec3().to_array()).collect();
    let values: Vec<f32> = points.iter().map(|p| (9.0 * p[0]).sin() * (7.0 * p[1]).cos() * p[2]).collect();
    let cells = Cells::OfKind { kind: &TETRAHEDRON, points: Indices::U32(mesh.tets.as_flattened()) };
    let mesh = MeshView::new(Positions::F32(&points), cells).with_scalars(Association::Point, Scalars::F32(&values));
    let pool = Arc::new(rayon::ThreadPoolBuilder::new().num_threads(2).build().unwrap());
    let mut session = Session::on(Threads::Pool(Arc::clone(&pool)), &mesh).unwrap();
    let transfer = TransferFunction::constant([1.0, 0.5, 0.2], 0.5).unwrap();
    // Few tiles, so that each holds very many cells.
    let camera = Camera::framing(&session.corners_world(), 35.0, 20.0, 64, 64);
    let options = |model, sort, memory_bytes| RenderOptions { model, sort, memory_bytes, ..RenderOptions::default() };
    let light = Model::EmissionAbsorption;
    let render = |session: &mut Session<'_>, camera: &Camera, options: &RenderOptions, what: &str| -> Rendered {
        pool.broadcast(|_| looks::watch());
        let rendered = session.render(camera, &transfer, options).unwrap();
        let of_threads = pool.broadcast(|_| looks::longest());
        for (longest, at) in of_threads {
            println!("{what}: {longest:?} before {at}");
            assert!(longest < MOST, "{what}: a thread worked for {longest:?} before it looked at {at}");
        }
        rendered
    };
    for (nth, (options, what)) in [
        (options(light, SortMethod::Auto, None), "exact"),
        (options(light, SortMethod::Centroid, None), "centroid"),
        (options(Model::Emission, SortMethod::Auto, Some(1 << 30)), "bands of rows"),
        (options(light, SortMethod::Topological, None), "topological"),
    ]
    .into_iter()
    .enumerate()
    {
        let camera = camera.orbited(20.0 * nth as f64);
        render(&mut session, &camera, &options, what);
        if nth == 0 {
            session.update_scalars(Association::Point, Scalars::F32(&values[..])).unwrap();
            let rendered = render(&mut session, &camera, &options, "other scalars");
            assert!(rendered.profile.get("sort").is_none());
        }
    }
}

/// The clock runs, and only where it is asked to.
#[test]
fn work_between_looks_is_measured() {
    let work = || {
        let control = crate::control::Control::default();
        assert!(!control.is_cancelled());
        let sum = (0..30_000_000_u64).fold(1, |sum, i| std::hint::black_box(sum ^ i));
        assert!(sum != 0 && !control.is_cancelled());
    };
    work();
    assert_eq!(looks::longest().0, Duration::ZERO);
    looks::watch();
    work();
    let (longest, at) = looks::longest();
    assert!(longest > Duration::from_millis(1) && at.file() == file!(), "{longest:?} {at}");
}
