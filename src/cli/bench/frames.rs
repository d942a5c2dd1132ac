//! Frames of one scene, every one a new view on an orbit, each checked.

use cellfan::profile::{CellStats, OrderStats, Profile};
use cellfan::{Camera, Dataset, Image, RenderOptions, Renderer, Scene};
use serde::Serialize;

use super::session::Session;
use super::spread::Spread;
use super::{Outcome, ensure};

/// Azimuth and elevation of the first view, in degrees.
const FIRST_VIEW: [f64; 2] = [35.0, 20.0];

/// What frames took and showed.
#[derive(Serialize)]
pub(super) struct Frames {
    /// From a camera to the finished picture in memory.
    pub(super) time: Spread,
    /// Of the last frame.
    #[serde(skip)]
    pub(super) cells: CellStats,
    #[serde(skip)]
    pub(super) order: OrderStats,
    /// The share of the first picture that shows something.
    pub(super) covered_share: f64,
    /// The first picture.
    #[serde(skip)]
    pub(super) first: Image,
    /// The median of each stage.
    pub(super) stages_ms: Profile,
    /// Of each frame that counts.
    #[serde(skip)]
    pub(super) profiles: Vec<Profile>,
}

/// What is drawn, and how often.
pub(super) struct Shots<'a> {
    pub(super) scene: &'a Scene,
    /// What messages call it.
    pub(super) name: &'a str,
    pub(super) size_px: [u32; 2],
    pub(super) options: RenderOptions,
    pub(super) runs: usize,
}

/// The whole mesh, turned by a part of a full turn.
pub(super) fn camera(dataset: &Dataset, [width, height]: [u32; 2], turn: f64) -> Camera {
    let [azimuth, elevation] = FIRST_VIEW;
    Camera::framing(&dataset.corners_world(), azimuth, elevation, width, height).orbited(360.0 * turn)
}

impl Shots<'_> {
    /// Draws them: some that do not count, those that do, and the first view again, which has to give the same picture.
    pub(super) fn draw(&self, session: &Session, renderer: &mut Renderer) -> Outcome<Frames> {
        let Self { scene, size_px, runs, .. } = *self;
        let frames = session.warm_up + runs;
        let view = |frame: usize| camera(scene.dataset(), size_px, frame as f64 / frames as f64);
        let (mut times_ms, mut profiles) = (Vec::new(), Vec::new());
        let mut first = None;
        for frame in 0..frames {
            let rendered = renderer.render(scene, &view(frame))?;
            self.check(&rendered)?;
            if frame >= session.warm_up {
                times_ms.push(rendered.frame_ms);
                profiles.push(rendered.profile);
            }
            first = first.or(Some(rendered.image));
        }
        let again = renderer.render(scene, &view(0))?;
        let first = first.unwrap_or_else(|| again.image.clone());
        let is_same = first.pixels.iter().flatten().zip(again.image.pixels.iter().flatten());
        ensure(is_same.into_iter().all(|(a, b)| a.to_bits() == b.to_bits()), || {
            format!("{}: the first view drawn again gives another picture", self.name)
        })?;
        let covered_share = first.covered(self.miss()) as f64 / first.pixels.len() as f64;
        Ok(Frames {
            time: Spread::of(times_ms),
            cells: again.cells,
            order: again.order,
            covered_share,
            first,
            stages_ms: Profile::median(&profiles),
            profiles,
        })
    }

    fn miss(&self) -> [f32; 4] {
        [if self.options.model == cellfan::Model::Absorption { self.options.output.miss() } else { 0.0 }; 4]
    }

    /// Every cell is accounted for, the picture shows something, and all its values are numbers.
    fn check(&self, rendered: &cellfan::Rendered) -> Outcome {
        let cells = &rendered.cells;
        ensure(cells.accounted() == cells.total, || {
            format!("{}: {} of {} cells are accounted for", self.name, cells.accounted(), cells.total)
        })?;
        let is_shown = rendered.image.covered(self.miss()) > 0 || cells.drawn == 0;
        ensure(is_shown, || format!("{}: nothing shows", self.name))?;
        let is_finite = rendered.image.pixels.iter().flatten().all(|channel| channel.is_finite());
        ensure(is_finite, || format!("{}: a pixel is no number", self.name))
    }
}
