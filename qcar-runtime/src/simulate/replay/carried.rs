//! States that move along where a record restarts.
//!
//! A restart sets the measured position and velocity of a mass that nothing holds. What is fastened to the mass moves
//! along as a rigid body, so that no force between them changes.

use nalgebra::{DMatrix, DVector};

use crate::matrices::dynamics;
use crate::model::{About, Model, State, StateKind};

/// Relative rounding error of a motion that causes no force.
const ROUNDING: f64 = 1e-9;

/// For each state that a restart sets, the states that move along with their factors.
pub struct Carried(Vec<Vec<(usize, f64)>>);

impl Carried {
    /// What moves along with the states that are `set`, for a value of each parameter.
    pub fn new(model: &dyn Model, p: &[f64], set: &[usize]) -> Self {
        let about = model.about();
        let mut carried = vec![Vec::new(); about.states.len()];
        if set.is_empty() {
            return Self(carried);
        }
        let a = dynamics(model, p);
        for &state in set
            .iter()
            .filter(|&&state| about.states[state].kind == StateKind::Position)
        {
            let along = along(about, &a, state, set);
            if let Some(velocity) = velocity_of(about, state) {
                let pairs = along
                    .iter()
                    .filter_map(|&(other, by)| Some((velocity_of(about, other)?, by)));
                carried[velocity] = pairs.collect();
            }
            carried[state] = along;
        }
        Self(carried)
    }

    /// What moves along with a state.
    pub fn with(&self, state: usize) -> &[(usize, f64)] {
        &self.0[state]
    }
}

/// The motion of the positions that are not set with which a change of a position causes no force; empty if nothing is
/// fastened to the mass, or if something holds it.
fn along(about: &About, a: &DMatrix<f64>, state: usize, set: &[usize]) -> Vec<(usize, f64)> {
    let is_free = |other: &usize| about.states[*other].kind == StateKind::Position && !set.contains(other);
    let free: Vec<usize> = (0..about.states.len()).filter(is_free).collect();
    let force: DVector<f64> = a.column(state).into_owned();
    if free.is_empty() || force.norm() == 0.0 {
        return Vec::new();
    }
    let others = a.select_columns(&free);
    let svd = others.clone().svd(true, true);
    let Ok(motion) = svd.solve(&-&force, ROUNDING * svd.singular_values.max()) else {
        return Vec::new();
    };
    let is_rigid = (others * &motion + &force).norm() <= ROUNDING.sqrt() * force.norm();
    let moves = |(_, by): &(usize, f64)| is_rigid && by.abs() > ROUNDING.sqrt();
    free.into_iter().zip(motion.iter().copied()).filter(moves).collect()
}

fn velocity_of(about: &About, position: usize) -> Option<usize> {
    let own = &about.states[position];
    let is_its =
        |other: &State| other.kind == StateKind::Velocity && other.location == own.location && other.axis == own.axis;
    about.states.iter().position(is_its)
}
