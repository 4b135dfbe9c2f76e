//! Every free motion of a model: its modes, motions that do not oscillate, and motions that grow.
//!
//! The equations of motion are linearised at rest, `dx = A x`. A complex pair of eigenvalues of A is a vibration, a real
//! eigenvalue a motion without oscillation. An overdamped mode has two of these: `λ² + 2 ζ ω λ + ω² = 0` with ζ > 1, so
//! that `ω² = λ₁ λ₂` and `2 ζ ω = -(λ₁ + λ₂)`.

use std::f64::consts::TAU;

use nalgebra::Complex;

use crate::model::{About, Model, StateKind};
use crate::modes::{Part, damping, dynamics, eigenvalues, frequency, is_rigid, shapes, vibrates};
use crate::response::parameters::Values;

/// A free motion.
#[derive(Clone, Debug, PartialEq)]
pub struct FreeMotion {
    /// Kind.
    pub kind: Kind,
    /// Undamped natural frequency, Hz; of an aperiodic motion, its rate `|λ|` over 2π.
    pub frequency: f64,
    /// Damping ratio: below 1 for a vibration, above 1 for an overdamped mode, 1 for an aperiodic motion that decays;
    /// negative if the motion grows.
    pub damping: f64,
    /// Motion of every point; the largest amplitude is 1. Of an overdamped mode, that of its slower part.
    pub shape: Vec<Part>,
}

/// Kinds of free motions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// It oscillates.
    Vibration,
    /// A mode with two real eigenvalues.
    Overdamped,
    /// A single real eigenvalue: that of a law with memory or of a massless point, or one of an overdamped mode whose
    /// other one cannot be told among several.
    Aperiodic,
}

/// The free motions of a model.
#[derive(Clone, Debug, PartialEq)]
pub struct FreeMotions {
    /// Lowest frequency first.
    pub motions: Vec<FreeMotion>,
    /// Number of eigenvalues that are zero: motions that nothing holds, which have no frequency.
    pub rigid: usize,
}

impl FreeMotion {
    /// True if the motion grows.
    pub fn is_unstable(&self) -> bool {
        grows(self.damping)
    }
}

/// Damping ratios above this negative value count as zero: an undamped mode has the errors of its eigenvalue.
const UNDAMPED: f64 = -1e-6;

fn grows(damping: f64) -> bool {
    damping < UNDAMPED
}

/// All free motions of a model at the values of its parameters.
pub fn free_motions(model: &(impl Model + ?Sized), values: &Values) -> FreeMotions {
    let a = dynamics(model, values.as_slice());
    let (rigid, moving): (Vec<_>, Vec<_>) = eigenvalues(&a).into_iter().partition(|root| is_rigid(*root));
    let (vibrating, real): (Vec<_>, Vec<_>) = moving
        .into_iter()
        .filter(|root| vibrates(root) || !vibrates(&root.conj()))
        .partition(vibrates);
    let motions_of = |kind: Kind, roots: &[Complex<f64>]| {
        let shapes = shapes(model, &a, roots);
        let motion = |(root, shape): (&Complex<f64>, Vec<Part>)| FreeMotion {
            kind,
            frequency: frequency(*root),
            damping: damping(*root),
            shape,
        };
        roots.iter().zip(shapes).map(motion).collect::<Vec<_>>()
    };
    let real: Vec<f64> = real.iter().map(|root| root.re).collect();
    let mut motions = motions_of(Kind::Vibration, &vibrating);
    match real[..] {
        [slow, fast] if slow < 0.0 && fast < 0.0 && rigid.is_empty() && has_only_masses(model.about()) => {
            let product = (slow * fast).sqrt();
            let overdamped = motions_of(Kind::Overdamped, &[slow.into()]).into_iter();
            motions.extend(overdamped.map(|slower| FreeMotion {
                frequency: product / TAU,
                damping: -(slow + fast) / (2.0 * product),
                ..slower
            }));
        }
        _ => {
            let roots: Vec<Complex<f64>> = real.iter().map(|root| (*root).into()).collect();
            motions.extend(motions_of(Kind::Aperiodic, &roots));
        }
    }
    motions.sort_by(|one, other| one.frequency.total_cmp(&other.frequency));
    FreeMotions {
        motions,
        rigid: rigid.len(),
    }
}

/// True if every state is the position or velocity of a mass, so that two real eigenvalues beside pairs of complex ones
/// belong to one mode.
fn has_only_masses(about: &About) -> bool {
    let count = |kind: StateKind| about.states.iter().filter(|state| state.kind == kind).count();
    count(StateKind::Inner) == 0 && count(StateKind::Position) == count(StateKind::Velocity)
}

/// States up to which [`growing`] computes the eigenvalues: at this number they take a tenth of a second, and the time
/// grows with its cube.
pub const MOST_STATES: usize = 200;

/// The eigenvalue of the motion that grows fastest, 1/s; `None` if the model is stable, or too large for a check beside
/// other work.
pub fn growing(model: &(impl Model + ?Sized), values: &Values) -> Option<Complex<f64>> {
    if model.about().states.len() > MOST_STATES {
        return None;
    }
    let roots = eigenvalues(&dynamics(model, values.as_slice())).into_iter();
    let growing = roots.filter(|root| !is_rigid(*root) && grows(damping(*root)));
    growing.max_by(|one, other| one.re.total_cmp(&other.re))
}
