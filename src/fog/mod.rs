//! Ground fog: prisms of gas that stand on a terrain (Röttger and Ertl 2003, section 5), at a level of detail that follows the eye.
//!
//! In: two [`HeightMap`]s, of the ground and of how thick the fog on it is. Out, for each view: a [`Landscape`], the triangles of the
//! ground and the prisms on them, without cracks and without popping. It is drawn as any mesh with a surface is: the triangles are
//! opaque ([`geometry`](crate::geometry)), the prisms are cells.
//! To add a profile of the fog's density: a [`Profile`] and its line in `prisms.rs`.

mod detail;
mod flight;
mod height_map;
mod landscape;
mod prisms;
mod terrain;

pub use detail::Detail;
pub use flight::Flight;
pub use height_map::{HeightMap, MapSettings, fog_map, ground_map};
pub use landscape::Landscape;
pub use prisms::Profile;
pub use terrain::Terrain;

#[cfg(test)]
mod tests;
