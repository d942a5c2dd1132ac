//! `buckyball`: the electron density of C60 as a Gaussian at each of its atoms.
//!
//! The atoms are the corners of a truncated icosahedron: (0, ±1, ±3φ), (±1, ±(2 + φ), ±2φ) and (±φ, ±2, ±(2φ + 1)) with
//! cyclic exchanges of the axes, where φ is the golden ratio; its 90 edges, the bonds, have length 2.

use glam::DVec3;

use super::field::{Field, sample};
use super::grid::grid;
use super::settings::Settings;
use crate::columns::TetMesh;
use crate::error::Result;

/// C60 in the unit cube: a centre (½, ½, ½), all atoms at radius [`Buckyball::RADIUS`].
#[derive(Clone, Debug)]
pub struct Buckyball {
    /// Positions of the 60 atoms.
    pub atoms: Vec<DVec3>,
    /// Length of its 90 bonds.
    pub bond: f64,
}

impl Buckyball {
    /// Distance of every atom from the centre; four standard deviations of a Gaussian then end inside of the cube.
    pub const RADIUS: f64 = 0.3;
    /// Standard deviation of an atom's Gaussian, in bonds: the middle of a bond has 0.69 of the density of an atom.
    pub const SIGMA_PER_BOND: f64 = 0.35;

    /// The atoms of the molecule.
    ///
    /// ```
    /// # use cellfan::generate::Buckyball;
    /// let c60 = Buckyball::new();
    /// assert_eq!(c60.atoms.len(), 60);
    /// assert!((c60.bond - 0.3 * 0.403_548).abs() < 1e-6); // edge over circumradius of a truncated icosahedron
    /// ```
    pub fn new() -> Self {
        let phi = f64::midpoint(1.0, 5.0_f64.sqrt());
        let scale = Self::RADIUS / (9.0 * phi + 10.0).sqrt();
        let mut atoms = Vec::with_capacity(60);
        for [x, y, z] in [[0.0, 1.0, 3.0 * phi], [1.0, 2.0 + phi, 2.0 * phi], [phi, 2.0, 2.0 * phi + 1.0]] {
            for p in [DVec3::new(x, y, z), DVec3::new(y, z, x), DVec3::new(z, x, y)] {
                for signs in 0..8 {
                    let negative = [signs & 1 != 0, signs & 2 != 0, signs & 4 != 0];
                    if (0..3).any(|axis| negative[axis] && p[axis] == 0.0) {
                        continue; // −0 is the same atom
                    }
                    let corner = DVec3::from_array(std::array::from_fn(|i| if negative[i] { -p[i] } else { p[i] }));
                    atoms.push(DVec3::splat(0.5) + corner * scale);
                }
            }
        }
        Self { atoms, bond: 2.0 * scale }
    }

    /// The density at `p`: the sum of exp(−d²/2σ²) over the atoms; about 1 at an atom, 0 far away.
    pub fn density(&self, p: DVec3) -> f64 {
        let sigma = Self::SIGMA_PER_BOND * self.bond;
        self.atoms.iter().map(|&atom| libm::exp(-atom.distance_squared(p) / (2.0 * sigma * sigma))).sum()
    }
}

impl Default for Buckyball {
    fn default() -> Self {
        Self::new()
    }
}

/// The electron density of C60 on a grid of the unit cube in tetrahedra.
///
/// # Errors
/// As [`super::generate`].
pub fn buckyball(settings: &Settings) -> Result<TetMesh> {
    let grid = grid(settings)?;
    Ok(sample(grid.points, grid.tets, field()))
}

/// The density over the unit cube.
pub(super) fn field() -> Field {
    let molecule = Buckyball::new();
    Box::new(move |p| molecule.density(p))
}

#[cfg(test)]
mod tests {
    use super::Buckyball;

    #[test]
    fn molecule_has_60_atoms_and_90_equal_bonds_three_at_each_atom() {
        let c60 = Buckyball::new();
        assert_eq!(c60.atoms.len(), 60);
        let mut bonds_of_atom = [0; 60];
        for (i, &a) in c60.atoms.iter().enumerate() {
            assert!((a.distance(glam::DVec3::splat(0.5)) - Buckyball::RADIUS).abs() < 1e-15);
            for (j, &b) in c60.atoms.iter().enumerate().skip(i + 1) {
                let length = a.distance(b);
                assert!(length > c60.bond * (1.0 - 1e-12), "atoms {i} and {j} are closer than a bond: {length}");
                if length < c60.bond * 1.2 {
                    assert!((length - c60.bond).abs() < 1e-14, "{length}");
                    bonds_of_atom[i] += 1;
                    bonds_of_atom[j] += 1;
                }
            }
        }
        assert_eq!(bonds_of_atom, [3; 60]);
    }

    #[test]
    fn density_is_that_of_an_atom_and_its_three_neighbours_and_fades_at_the_cube() {
        let c60 = Buckyball::new();
        let tail = (-0.5 / Buckyball::SIGMA_PER_BOND.powi(2)).exp();
        let at_atom = c60.density(c60.atoms[17]);
        assert!((at_atom - 1.0 - 3.0 * tail).abs() < 1e-3, "{at_atom}");
        assert!(c60.density(glam::DVec3::new(0.0, 0.5, 0.5)) < 1e-4);
    }
}
