//! Compliance: amplitudes of motion under unit forces.

use std::collections::BTreeMap;

use super::functional::along;
use super::load::{Load, through_load};
use crate::check::Checked;
use crate::derive::complex::Complex;
use crate::derive::elimination::{Factors, Scalar, Symmetric};
use crate::expr::{CoordinateId, Expr, Graph};
use crate::model::CoordinateKind;

/// Largest number of unknowns for which entries are taken from the inverse. It costs about as much as a solution for
/// each output, and all outputs and their adjoints share it. Its cost grows with the square of the number of unknowns,
/// that of a solution linearly.
const FEW_UNKNOWNS: usize = 24;

/// Motions under forces; prescribed coordinates do not move.
pub(super) struct Compliance {
    /// Factors of the impedance of the unknowns.
    factors: Factors<Complex>,
    /// Their coordinates.
    unknowns: Vec<usize>,
    /// Number of coordinates.
    coordinates: usize,
    /// The amplitude of each coordinate for a unit force on each.
    inverse: Option<Vec<Vec<Complex>>>,
    /// True if there are adjoints of outputs.
    adjoints: bool,
}

impl Compliance {
    /// The compliance of the coordinates that are not prescribed, with `adjoints` of so many outputs. Those of many
    /// outputs are taken from the inverse: by symmetry, it costs about as much as a solution for half of the unknowns.
    pub(super) fn of(model: &Checked, g: &mut Graph, impedance: &Symmetric<Complex>, adjoints: usize) -> Self {
        let coordinates = model.coordinates.len();
        let prescribed = |c: usize| {
            let kind = model.coordinates[c].kind;
            matches!(kind, CoordinateKind::Road | CoordinateKind::Motion)
        };
        let unknowns: Vec<usize> = (0..coordinates).filter(|&c| !prescribed(c)).collect();
        let factors = Factors::of(g, impedance.restricted(&unknowns));
        let mut compliance = Compliance {
            factors,
            adjoints: adjoints > 0 || unknowns.len() <= FEW_UNKNOWNS,
            unknowns,
            coordinates,
            inverse: None,
        };
        if compliance.is_small() || 2 * adjoints > compliance.unknowns.len() {
            compliance.inverse = Some(compliance.inverse(g));
        }
        compliance
    }

    fn is_small(&self) -> bool {
        self.unknowns.len() <= FEW_UNKNOWNS
    }

    fn inverse(&self, g: &mut Graph) -> Vec<Vec<Complex>> {
        let inverse = self.factors.inverse(g);
        let mut entries = vec![vec![Complex::zero(g); self.coordinates]; self.coordinates];
        for (row, &i) in self.unknowns.iter().enumerate() {
            for (column, &j) in self.unknowns.iter().enumerate() {
                entries[i][j] = inverse[row][column];
            }
        }
        entries
    }

    /// The inverse, if all amplitudes come from it.
    fn dense(&self) -> Option<&Vec<Vec<Complex>>> {
        self.inverse.as_ref().filter(|_| self.is_small())
    }

    /// True if adjoints are available.
    pub(super) fn has_adjoints(&self) -> bool {
        self.adjoints
    }

    /// The amplitudes of all coordinates under forces.
    pub(super) fn apply(&self, g: &mut Graph, forces: &[(usize, Complex)]) -> Vec<Complex> {
        if let Some(rows) = self.dense() {
            return rows.iter().map(|row| through_load(g, row, forces)).collect();
        }
        let forces: BTreeMap<usize, Complex> = forces.iter().copied().collect();
        let zero = Complex::zero(g);
        let right = self.unknowns.iter().map(|c| forces.get(c).copied().unwrap_or(zero));
        let solution = self.factors.solve(g, right.collect());
        let mut amplitudes = vec![zero; self.coordinates];
        let unknowns = self.unknowns.iter().zip(solution);
        unknowns.for_each(|(&c, amplitude)| amplitudes[c] = amplitude);
        amplitudes
    }

    /// The amplitudes for a unit motion of one coordinate; `forces` are the forces that this motion causes on the
    /// others.
    pub(super) fn moved_by(&self, g: &mut Graph, moved: usize, forces: &Load) -> Vec<Complex> {
        let one = Complex::one(g);
        let Some(rows) = self.dense() else {
            let pushed: Load = forces.iter().map(|&(c, force)| (c, force.neg(g))).collect();
            let mut amplitudes = self.apply(g, &pushed);
            amplitudes[moved] = one;
            return amplitudes;
        };
        let mut amplitudes = Vec::with_capacity(rows.len());
        for (c, row) in rows.iter().enumerate() {
            let start = if c == moved { one } else { Complex::zero(g) };
            amplitudes.push(forces.iter().fold(start, |sum, &(k, force)| {
                let share = row[k].mul(g, force);
                sum.sub(g, share)
            }));
        }
        amplitudes
    }

    /// The response of a combination to a unit force on each coordinate; `None` without adjoints.
    pub(super) fn adjoint(&self, g: &mut Graph, combination: &[(CoordinateId, Expr)]) -> Option<Vec<Complex>> {
        if !self.adjoints {
            return None;
        }
        let Some(rows) = &self.inverse else {
            let one = Complex::one(g);
            let forces = combination
                .iter()
                .map(|&(c, share)| (c.0 as usize, one.scale(g, share)));
            let forces: Load = forces.collect();
            return Some(self.apply(g, &forces));
        };
        Some(rows.iter().map(|row| along(g, combination, row)).collect())
    }
}
