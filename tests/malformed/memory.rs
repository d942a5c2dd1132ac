//! What a session allocates: nothing of the caller's arrays in f32 and u32 is copied, and a picture takes few bytes a cell.

use cellfan::cells::TETRAHEDRON;
use cellfan::columns::Association;
use cellfan::generate::{Settings, tets};
use cellfan::session::{Cells, Indices, MeshView, Scalars, Session};
use cellfan::{Camera, Positions, RenderOptions, SortMethod, TransferFunction};

use crate::allocation::here;

#[test]
fn a_session_copies_no_array_in_f32_and_u32_and_takes_few_bytes_a_cell() {
    let mesh = tets(&Settings { cells: 300_000, jitter: 0.2, ..Settings::default() }).unwrap();
    let points: Vec<[f32; 3]> = (0..mesh.points.len()).map(|i| mesh.points.get(i).as_vec3().to_array()).collect();
    let wide: Vec<u64> = mesh.tets.as_flattened().iter().map(|&v| v.into()).collect();
    let corners = mesh.tets.as_flattened();
    let values: Vec<f32> = points.iter().map(|p| p[0] * p[1] + p[2]).collect();
    let of = |indices| {
        let cells = Cells::OfKind { kind: &TETRAHEDRON, points: indices };
        MeshView::new(Positions::F32(&points), cells).with_scalars(Association::Point, Scalars::F32(&values))
    };
    let cells = corners.len() / 4;
    // One thread, so that what it allocates is what all of it takes.
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    pool.install(|| {
        let (mut session, new) = here(|| Session::new(&of(Indices::U32(corners))).unwrap());
        // A record of 16 bytes and a value of 4 for each point, a bit for each cell, a box for each block.
        let kept = 20 * points.len() + cells / 8 + cells / 4096 * 64 + (64 << 10);
        println!("{cells} cells, {} points: keeps {} of {kept} bytes, {new:?}", points.len(), new.held);
        assert!(new.held <= kept as isize && kept < 20 * points.len() + size_of_val(&points[..]));
        assert!(new.largest <= 16 * points.len() && new.largest < size_of_val(corners), "{new:?}");
        // The check can fail.
        let (_, copied) = here(|| Session::new(&of(Indices::U64(&wide))).unwrap());
        assert!(copied.held >= new.held + size_of_val(corners) as isize, "{copied:?}");

        let options = RenderOptions { sort: SortMethod::Centroid, ..RenderOptions::default() };
        let transfer = TransferFunction::constant([1.0; 3], 2.0).unwrap();
        let camera = Camera::framing(&session.corners_world(), 30.0, 20.0, 128, 128);
        let (_, first) = here(|| session.render(&camera, &transfer, &options).unwrap());
        let (_, second) = here(|| {
            session.update_scalars(Association::Point, Scalars::F32(&values)).unwrap();
            session.render(&camera, &transfer, &options).unwrap()
        });
        let a_cell = (new.held + first.peak) as f64 / cells as f64;
        println!("{a_cell:.1} bytes a cell; first {first:?}, with other scalars {second:?}");
        assert!(a_cell <= 48.0, "{a_cell}");
        // A picture, its vertices on screen, values: no bins, no orders.
        assert!(second.peak < first.peak / 2, "{second:?}");
    });
}
