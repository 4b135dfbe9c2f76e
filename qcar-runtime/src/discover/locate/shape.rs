//! Which kind of law a κ belongs to.

use std::f64::consts::TAU;

use nalgebra::{Complex, DMatrix, DVector};

use super::kappa::{Kappa, KappaRun, Place};

/// The kind of law that a κ belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Shape {
    /// `k + jωc`
    SpringDamper,
    /// `-ω²m`, rigidly or on a spring and damper.
    Mass,
    /// A spring-damper, and beside it one in series.
    Relaxation,
    /// Stiffer or more damped for small amplitudes than for large ones.
    FrictionLike,
    /// Of a sensor: one factor at all frequencies.
    Gain,
    /// Of a sensor: a phase that grows with frequency.
    Delay,
    /// None of these.
    Other,
}

impl Shape {
    /// In words.
    pub fn name(self) -> &'static str {
        match self {
            Shape::SpringDamper => "a spring and damper",
            Shape::Mass => "a mass",
            Shape::Relaxation => "a spring that relaxes",
            Shape::FrictionLike => "like friction",
            Shape::Gain => "a wrong gain",
            Shape::Delay => "a delay",
            Shape::Other => "of another kind",
        }
    }
}

/// A law is of a kind if that accounts for so much of κ,
const ENOUGH: f64 = 0.8;
/// and leaves no more than so many times what the best leaves.
const AS_GOOD: f64 = 1.5;
/// κ depends on the level where the difference between levels is more than this share of it.
const DIFFERS: f64 = 0.5;
/// Least relative uncertainty of κ: a coarse classification.
const COARSE: f64 = 0.05;
/// Natural frequencies (Hz), damping ratios and relaxation frequencies (Hz) that are tried.
const FREQUENCIES: [f64; 13] = [1.0, 1.5, 2.2, 3.3, 4.7, 6.8, 10.0, 12.0, 15.0, 22.0, 33.0, 47.0, 100.0];
const RATIOS: [f64; 3] = [0.05, 0.15, 0.4];

/// The kind of law of a κ.
pub fn shape(kappa: &Kappa) -> Shape {
    if let Some(shape) = over_level(&kappa.runs) {
        return shape;
    }
    let lines = Lines::of(&kappa.runs);
    let shares: Vec<(Shape, f64)> = match kappa.place {
        Place::Sensor(_) => vec![
            (Shape::Gain, lines.share(&[&|_| Complex::ONE])),
            (Shape::Delay, lines.share(&[&|w| Complex::I * w])),
        ],
        Place::Parameter(_) => vec![
            (
                Shape::SpringDamper,
                lines.share(&[&|_| Complex::ONE, &|w| Complex::I * w]),
            ),
            (Shape::Mass, lines.mass()),
            (Shape::Relaxation, lines.relaxation()),
        ],
    };
    let best = shares.iter().map(|(_, share)| *share).fold(0.0, f64::max);
    let like = |(_, share): &&(Shape, f64)| *share > ENOUGH && 1.0 - share <= AS_GOOD * (1.0 - best);
    shares.iter().find(like).map_or(Shape::Other, |(shape, _)| *shape)
}

/// The kind of law of a κ that depends on the level; `None` where it does not.
fn over_level(runs: &[KappaRun]) -> Option<Shape> {
    let by_level = |a: &&KappaRun, b: &&KappaRun| a.level.total_cmp(&b.level);
    let (small, large) = (runs.iter().min_by(by_level)?, runs.iter().max_by(by_level)?);
    let (mut difference, mut all, mut grows) = (0.0, 0.0, 0.0);
    for ((small, large), (a, b)) in small
        .value
        .iter()
        .zip(&large.value)
        .zip(small.sigma.iter().zip(&large.sigma))
    {
        let weight = weight(small.norm().max(large.norm()), a.hypot(*b));
        let change = small - large;
        difference += weight * change.norm_sqr();
        all += weight * (small.norm_sqr() + large.norm_sqr()) / 2.0;
        grows += weight * (change.re + change.im) * change.norm();
    }
    let depends = difference > DIFFERS * all;
    depends.then_some(if grows > 0.0 { Shape::FrictionLike } else { Shape::Other })
}

fn weight(value: f64, sigma: f64) -> f64 {
    sigma.hypot(COARSE * value).powi(-2)
}

/// κ at the lines of all runs: angular frequency, value, weight.
struct Lines(Vec<(f64, Complex<f64>, f64)>);

impl Lines {
    fn of(runs: &[KappaRun]) -> Self {
        let of_run = |run: &KappaRun| {
            let lines = run.frequency.iter().zip(&run.value).zip(&run.sigma);
            let lines = lines.map(|((f, value), sigma)| (TAU * f, *value, weight(value.norm(), *sigma)));
            lines.collect::<Vec<_>>()
        };
        Self(
            runs.iter()
                .flat_map(of_run)
                .filter(|(_, _, weight)| weight.is_finite())
                .collect(),
        )
    }

    /// The share of κ for which the best real combination of some laws accounts.
    fn share(&self, laws: &[&dyn Fn(f64) -> Complex<f64>]) -> f64 {
        let rows = 2 * self.0.len();
        let part = |value: Complex<f64>, row: usize| if row.is_multiple_of(2) { value.re } else { value.im };
        let scaled = |row: usize, of: &dyn Fn(f64, Complex<f64>) -> Complex<f64>| {
            let (w, value, weight) = self.0[row / 2];
            part(of(w, value), row) * weight.sqrt()
        };
        let columns = DMatrix::from_fn(rows, laws.len(), |row, law| scaled(row, &|w, _| laws[law](w)));
        let kappa = DVector::from_fn(rows, |row, _| scaled(row, &|_, value| value));
        let parts = (columns.transpose() * &columns).cholesky();
        let Some(parts) = parts.map(|normal| normal.solve(&(columns.transpose() * &kappa))) else {
            return 0.0;
        };
        1.0 - (&kappa - columns * parts).norm_squared() / kappa.norm_squared()
    }

    /// The same of a mass, on the best of some springs and dampers or on none.
    fn mass(&self) -> f64 {
        let rigid = self.share(&[&|w| Complex::from(-w * w)]);
        let hung = FREQUENCIES.iter().flat_map(|f| RATIOS.map(|ratio| (TAU * f, ratio)));
        let hung = hung.map(|(natural, ratio)| {
            let holds = |w: f64| Complex::new(natural * natural, 2.0 * ratio * natural * w);
            self.share(&[&|w| -w * w * holds(w) / (holds(w) - w * w)])
        });
        hung.fold(rigid, f64::max)
    }

    /// The same of a spring-damper beside a branch that relaxes.
    fn relaxation(&self) -> f64 {
        let of = |f: &f64| {
            let rate = TAU * f;
            let branch = |w: f64| Complex::I * w / Complex::new(rate, w);
            self.share(&[&|_| Complex::ONE, &|w| Complex::I * w, &branch])
        };
        FREQUENCIES.iter().map(of).fold(0.0, f64::max)
    }
}
