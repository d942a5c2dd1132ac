//! The overlay: how lid and bowl lie over each other on the picture, found from topology alone.
//!
//! Lid and bowl both cover the outline, each point once, with convex faces. A region of the picture is what a face of the
//! lid and a face of the bowl have in common; it is convex, as both are, and entry and exit depth are affine on it. Its
//! sides are pieces of edges, so regions need no coordinates: it is enough to know through which faces of the other side
//! each edge runs, its *track*. Edges are straight and faces convex, therefore a track
//!
//! - starts in a face in or at which the edge starts, and never comes to another one of these,
//! - ends in the first face in or at which the edge ends,
//! - visits no face twice, and crosses no edge that has an end in common with its own.
//!
//! The tracks of the lid's edges and those of the bowl's must speak of the same crossings. Given the face in which each
//! inner corner lies, at most one choice of tracks does (the tests try them all).

use std::collections::{BTreeMap, BTreeSet};

use super::sides::Sides;

/// An edge of the lid and an edge of the bowl that cross on the picture, by their corners.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Crossing {
    /// The edge between two faces of the lid.
    pub lid: [u8; 2],
    /// The edge between two faces of the bowl.
    pub bowl: [u8; 2],
}

/// The regions of a cell as triangles; their vertices are the corners, then the crossings.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Overlay {
    pub crossings: Vec<Crossing>,
    pub triangles: Vec<[u8; 3]>,
}

/// The faces of the other side through which an edge runs, and the edges that it crosses between them.
#[derive(Clone)]
struct Track {
    faces: Vec<u8>,
    crossed: Vec<[u8; 2]>,
}

impl Overlay {
    /// The overlay of a cell whose inner corners lie in the faces that `inside` names as (corner, face), both in the
    /// cell's numbering; `None` if no projection is like that.
    pub(super) fn new(sides: Sides, inside: &[(u8, u8)]) -> Option<Self> {
        let edges = [true, false].map(|lid| sides.inner_edges(lid));
        let [of_lid, of_bowl] = [(0, false), (1, true)].map(|(side, through_lid)| {
            choices(edges[side].iter().map(|edge| tracks(sides, inside, edge.ends, through_lid)).collect())
        });
        let crossings = |side: usize, tracks: &[Track]| -> BTreeSet<Crossing> {
            let of_edge = |(i, track): (usize, &Track)| {
                let ends = edges[side][i].ends;
                let cross = move |other| match side {
                    0 => Crossing { lid: ends, bowl: other },
                    _ => Crossing { lid: other, bowl: ends },
                };
                track.crossed.iter().map(move |&other| cross(other)).collect::<Vec<_>>()
            };
            tracks.iter().enumerate().flat_map(of_edge).collect()
        };
        let pairs = of_lid.iter().flat_map(|lid| of_bowl.iter().map(move |bowl| [lid, bowl]));
        let mut agreeing = pairs.filter(|[lid, bowl]| crossings(0, lid) == crossings(1, bowl));
        let (Some(tracks), None) = (agreeing.next(), agreeing.next()) else { return None };
        let crossings: Vec<Crossing> = crossings(0, tracks[0]).into_iter().collect();

        // The pieces of edges around each region, running as the lid's face does: (lid's face, bowl's face) → [from, to].
        let mut around: BTreeMap<[u8; 2], Vec<[u8; 2]>> = BTreeMap::new();
        for edge in sides.outline() {
            around.entry(edge.faces).or_default().push(edge.ends);
        }
        for side in 0..2 {
            for (edge, track) in edges[side].iter().zip(tracks[side]) {
                let node = |other: &[u8; 2]| {
                    let is_this = |crossing: &Crossing| match side {
                        0 => crossing.lid == edge.ends && crossing.bowl == *other,
                        _ => crossing.bowl == edge.ends && crossing.lid == *other,
                    };
                    crossings.iter().position(is_this).map(|i| sides.corners() + i as u8)
                };
                let mut nodes = vec![edge.ends[0]];
                nodes.extend(track.crossed.iter().filter_map(node));
                nodes.push(edge.ends[1]);
                for (piece, &through) in nodes.windows(2).zip(&track.faces) {
                    let ([a, b], [f, g]) = ([piece[0], piece[1]], edge.faces);
                    // Seen on the picture the bowl's faces run the other way.
                    let pieces = if side == 0 {
                        [([f, through], [a, b]), ([g, through], [b, a])]
                    } else {
                        [([through, f], [b, a]), ([through, g], [a, b])]
                    };
                    for (region, piece) in pieces {
                        around.entry(region).or_default().push(piece);
                    }
                }
            }
        }
        let mut triangles = Vec::new();
        for pieces in around.into_values() {
            triangles.extend(fan(sides, &polygon(pieces)?));
        }
        Some(Self { crossings, triangles })
    }
}

/// The tracks that an edge can have through the lid, or through the bowl.
fn tracks(sides: Sides, inside: &[(u8, u8)], [a, b]: [u8; 2], lid: bool) -> Vec<Track> {
    let at = |corner: u8| -> Vec<u8> {
        match inside.iter().find(|(inner, _)| *inner == corner) {
            Some(&(_, face)) => vec![face],
            None => sides.faces_at(corner, lid).collect(),
        }
    };
    let (start, end) = (at(a), at(b));
    let between = sides.inner_edges(lid);
    let mut found = Vec::new();
    let mut open: Vec<Track> = start.iter().map(|&face| Track { faces: vec![face], crossed: Vec::new() }).collect();
    while let Some(track) = open.pop() {
        let Some(&here) = track.faces.last() else { continue };
        if end.contains(&here) {
            found.push(track);
            continue;
        }
        for edge in &between {
            let [f, g] = edge.faces;
            let next = if here == f { g } else { f };
            let leaves = edge.faces.contains(&here) && !edge.ends.contains(&a) && !edge.ends.contains(&b);
            if leaves && !track.faces.contains(&next) && !start.contains(&next) {
                let mut longer = track.clone();
                longer.faces.push(next);
                longer.crossed.push(edge.ends);
                open.push(longer);
            }
        }
    }
    found
}

/// Every way to choose one track for each edge.
fn choices(tracks_of_edges: Vec<Vec<Track>>) -> Vec<Vec<Track>> {
    let mut choices = vec![Vec::new()];
    for tracks in tracks_of_edges {
        let with = |chosen: &Vec<Track>| -> Vec<Vec<Track>> {
            tracks.iter().map(|track| [&chosen[..], std::slice::from_ref(track)].concat()).collect()
        };
        choices = choices.iter().flat_map(with).collect();
    }
    choices
}

/// Joins directed pieces to the one polygon that they bound.
fn polygon(mut pieces: Vec<[u8; 2]>) -> Option<Vec<u8>> {
    let [first, mut at] = pieces.pop()?;
    let mut polygon = vec![first];
    while at != first {
        polygon.push(at);
        let next = pieces.iter().position(|piece| piece[0] == at)?;
        at = pieces.swap_remove(next)[1];
    }
    pieces.is_empty().then_some(polygon)
}

/// A convex polygon as triangles around its first crossing, or else its first inner corner.
fn fan(sides: Sides, polygon: &[u8]) -> Vec<[u8; 3]> {
    let n = polygon.len();
    let rank = |node: u8| match node {
        _ if node >= sides.corners() => 0,
        _ if sides.inner(node).is_some() => 1,
        _ => 2,
    };
    let thick = (0..n).min_by_key(|&i| (rank(polygon[i]), polygon[i])).unwrap_or_default();
    let at = |i: usize| polygon[(thick + i) % n];
    (1..n - 1).map(|i| [at(0), at(i), at(i + 1)]).collect()
}
