//! `cycles`: the fewest relations cut that let every cell be placed, or near to it.
//!
//! In: a graph, and the cells that wait for each other. Out: the graph without some of its relations, and how often a cell was
//! let go before one that comes before it. Where cells wait, some form strongly connected components (Tarjan 1972); in each the
//! cell with the fewest others before it is let go, the nearest of them, and what is left of the component is looked at again.
//! O(relations) for each time that a component falls apart, over its own cells.

use super::LOOK;
use super::graph::{Graph, Relation, farther, nearer, relation};
use crate::control::Control;
use crate::stages::sort::adjacency::Across;

const NONE: u32 = u32::MAX;

/// Cuts all cycles among `cells`, ascending; how many cells were let go. `depth` is a key that orders nearly.
/// Until the end is asked for.
pub(super) fn cut<A: Across>(
    control: &Control,
    graph: &mut Graph<A>,
    cells: Vec<u32>,
    depth: impl Fn(u32) -> u32,
) -> u64 {
    let mut places = vec![NONE; graph.len()];
    let mut into: Vec<Relation> = graph.relations.iter().map(|&r| relation(farther(r), nearer(r))).collect();
    into.sort_unstable();
    let (mut let_go, mut cut_relations) = (0, Vec::new());
    let mut parts = vec![cells];
    while let Some(part) = parts.pop() {
        for component in components(control, graph, &part, &mut places) {
            if control.is_cancelled() {
                return 0;
            }
            let Component { mut cells, before } = component;
            let least = (0..cells.len()).min_by_key(|&i| (before[i], depth(cells[i]), cells[i])).unwrap_or(0);
            let cell = cells.remove(least);
            let neighbours: Vec<u32> = graph.neighbours_before(cell).collect();
            for other in neighbours {
                if cells.binary_search(&other).is_ok() {
                    graph.forget_neighbour(other, cell);
                }
            }
            let start = into.partition_point(|&r| nearer(r) < cell);
            for &r in into[start..].iter().take_while(|&&r| nearer(r) == cell) {
                if cells.binary_search(&farther(r)).is_ok() {
                    cut_relations.push(relation(farther(r), cell));
                }
            }
            let_go += 1;
            parts.push(cells);
        }
    }
    cut_relations.sort_unstable();
    graph.relations.retain(|r| cut_relations.binary_search(r).is_err());
    let_go
}

/// Cells that come before each other, ascending, and how many of each other come right before each.
struct Component {
    cells: Vec<u32>,
    before: Vec<u32>,
}

/// The strongly connected components of more than one cell among `cells`. `places` holds `NONE` for every cell, and does again.
fn components<A: Across>(control: &Control, graph: &Graph<A>, cells: &[u32], places: &mut [u32]) -> Vec<Component> {
    for (place, &cell) in cells.iter().enumerate() {
        places[cell as usize] = place as u32;
    }
    let (mut starts, mut targets) = (vec![0], Vec::new());
    for &cell in cells {
        targets.extend(graph.after(cell).map(|after| places[after as usize]).filter(|&place| place != NONE));
        starts.push(targets.len());
    }
    for &cell in cells {
        places[cell as usize] = NONE;
    }
    if control.is_cancelled() {
        return Vec::new();
    }
    let (component_from_place, count) = strongly_connected(control, &starts, &targets);
    if control.is_cancelled() {
        return Vec::new();
    }
    let mut sizes = vec![0; count];
    for &component in &component_from_place {
        sizes[component as usize] += 1;
    }
    let mut before = vec![0; cells.len()];
    for place in 0..cells.len() {
        for &target in &targets[starts[place]..starts[place + 1]] {
            before[target as usize] += u32::from(component_from_place[place] == component_from_place[target as usize]);
        }
    }
    let mut found: Vec<Component> = Vec::new();
    let mut index_from_component = vec![NONE; count];
    for (place, &component) in component_from_place.iter().enumerate().filter(|&(_, &c)| sizes[c as usize] > 1) {
        let index = &mut index_from_component[component as usize];
        if *index == NONE {
            *index = found.len() as u32;
            found.push(Component { cells: Vec::new(), before: Vec::new() });
        }
        let component = &mut found[*index as usize];
        component.cells.push(cells[place]);
        component.before.push(before[place]);
    }
    found
}

/// The component of each node of a graph in compressed rows, and how many there are. Tarjan's algorithm with a stack of its own.
fn strongly_connected(control: &Control, starts: &[usize], targets: &[u32]) -> (Vec<u32>, usize) {
    let nodes = starts.len() - 1;
    let (mut component_from_node, mut components) = (vec![NONE; nodes], 0);
    // The order in which nodes were found, and the earliest that each reaches.
    let (mut found, mut low) = (vec![NONE; nodes], vec![NONE; nodes]);
    let mut next = 0;
    let (mut open, mut path): (Vec<u32>, Vec<(usize, usize)>) = (Vec::new(), Vec::new());
    for root in 0..nodes {
        if found[root] != NONE || (root % LOOK == 0 && control.is_cancelled()) {
            continue;
        }
        path.push((root, starts[root]));
        while let Some((node, edge)) = path.last_mut() {
            let node = *node;
            if found[node] == NONE {
                (found[node], low[node]) = (next, next);
                next += 1;
                open.push(node as u32);
            }
            if *edge < starts[node + 1] {
                let target = targets[*edge] as usize;
                *edge += 1;
                if found[target] == NONE {
                    path.push((target, starts[target]));
                } else if component_from_node[target] == NONE {
                    low[node] = low[node].min(found[target]);
                }
                continue;
            }
            path.pop();
            if let Some(&(parent, _)) = path.last() {
                low[parent] = low[parent].min(low[node]);
            }
            if low[node] == found[node] {
                while let Some(member) = open.pop() {
                    component_from_node[member as usize] = components as u32;
                    if member as usize == node {
                        break;
                    }
                }
                components += 1;
            }
        }
    }
    (component_from_node, components)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stages::testing::Random;

    #[test]
    fn components_are_those_of_mutual_reach() {
        let mut random = Random::new(5);
        for _ in 0..300 {
            let nodes = 1 + (random.unit() * 30.0) as usize;
            let edges = (random.unit() * 2.5 * nodes as f64) as usize;
            let mut pairs: Vec<(usize, u32)> = (0..edges)
                .map(|_| ((random.unit() * nodes as f64) as usize, (random.unit() * nodes as f64) as u32))
                .collect();
            pairs.sort_unstable();
            let starts: Vec<usize> = (0..=nodes).map(|node| pairs.partition_point(|&(from, _)| from < node)).collect();
            let targets: Vec<u32> = pairs.iter().map(|&(_, to)| to).collect();
            let (component, count) = strongly_connected(&Control::default(), &starts, &targets);
            // The slow twin: who reaches whom, by Warshall.
            let mut reaches = vec![vec![false; nodes]; nodes];
            for (node, reached) in reaches.iter_mut().enumerate() {
                reached[node] = true;
            }
            for &(from, to) in &pairs {
                reaches[from][to as usize] = true;
            }
            for via in 0..nodes {
                for from in 0..nodes {
                    for to in 0..nodes {
                        reaches[from][to] |= reaches[from][via] && reaches[via][to];
                    }
                }
            }
            for a in 0..nodes {
                assert!((component[a] as usize) < count);
                for b in 0..nodes {
                    assert_eq!(component[a] == component[b], reaches[a][b] && reaches[b][a]);
                }
            }
        }
    }
}
