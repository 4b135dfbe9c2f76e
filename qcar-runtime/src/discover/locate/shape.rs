//! Classifies κ by its kind of law.

use std::f64::consts::TAU;

use nalgebra::{Complex, DMatrix, DVector};

use super::missing_stiffness::{MissingStiffness, Place, RunStiffness};
use super::same_line::same_line;

/// Kind of law of a κ.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Shape {
    /// A spring and damper, `k + jωc`.
    SpringDamper,
    /// A mass `-ω²m`, rigid or on a spring and damper.
    Mass,
    /// A spring-damper in parallel with a spring and damper in series.
    Relaxation,
    /// Stiffness or damping that decreases with amplitude.
    FrictionLike,
    /// Sensor: one factor at all frequencies.
    Gain,
    /// Sensor: a phase proportional to frequency.
    Delay,
    /// None of these.
    Other,
}

impl Shape {
    /// Plain-text name.
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

/// Smallest share of κ that a kind of law must explain: the same choice as for
/// [`Numbers::explained`](crate::discover::numbers::Numbers::explained).
const LEAST_SHARE: f64 = 0.8;
/// Largest ratio of its residual to that of the best kind, a choice. Of all kinds within it the first one is taken,
/// which has the fewest parameters.
const COMPARABLE: f64 = 1.5;
/// Relative difference between levels beyond which κ counts as level-dependent, a choice.
const LEVEL_DEPENDENT: f64 = 0.5;
/// Smallest relative uncertainty of κ, since the classification is coarse.
const LEAST_UNCERTAINTY: f64 = 0.05;
/// Natural and relaxation frequencies that are tried, Hz: about two in an octave of a rig's band, more around wheel
/// hop.
const FREQUENCIES: [f64; 13] = [1.0, 1.5, 2.2, 3.3, 4.7, 6.8, 10.0, 12.0, 15.0, 22.0, 33.0, 47.0, 100.0];
/// Damping ratios that are tried: a lightly, a moderately and a well damped mount.
const RATIOS: [f64; 3] = [0.05, 0.15, 0.4];

/// Classifies a κ.
pub fn shape(kappa: &MissingStiffness) -> Shape {
    if let Some(shape) = by_level(&kappa.runs) {
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
    let fits = |(_, share): &&(Shape, f64)| *share > LEAST_SHARE && 1.0 - share <= COMPARABLE * (1.0 - best);
    shares.iter().find(fits).map_or(Shape::Other, |(shape, _)| *shape)
}

/// Kind of law of a level-dependent κ; `None` if κ does not depend on the level at the frequencies that both runs have.
fn by_level(runs: &[RunStiffness]) -> Option<Shape> {
    let order = |a: &&RunStiffness, b: &&RunStiffness| a.level.total_cmp(&b.level);
    let (small, large) = (runs.iter().min_by(order)?, runs.iter().max_by(order)?);
    let (mut difference, mut all, mut grows) = (0.0, 0.0, 0.0);
    for (line, frequency) in small.frequency.iter().enumerate() {
        let Some(other) = same_line(&large.frequency, *frequency) else {
            continue;
        };
        let (a, b) = (small.value[line], large.value[other]);
        let weight = weight(a.norm().max(b.norm()), small.sigma[line].hypot(large.sigma[other]));
        let change = a - b;
        difference += weight * change.norm_sqr();
        all += weight * (a.norm_sqr() + b.norm_sqr()) / 2.0;
        grows += weight * (change.re + change.im) * change.norm();
    }
    let depends = difference > LEVEL_DEPENDENT * all;
    depends.then_some(if grows > 0.0 { Shape::FrictionLike } else { Shape::Other })
}

fn weight(value: f64, sigma: f64) -> f64 {
    sigma.hypot(LEAST_UNCERTAINTY * value).powi(-2)
}

/// κ at the lines of all runs: angular frequency in rad/s, value and weight.
struct Lines(Vec<(f64, Complex<f64>, f64)>);

impl Lines {
    fn of(runs: &[RunStiffness]) -> Self {
        let of_run = |run: &RunStiffness| {
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

    /// Share of κ that the best real combination of some laws explains.
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

    /// The same share for a mass, on the best of several springs and dampers or rigid.
    fn mass(&self) -> f64 {
        let rigid = self.share(&[&|w| Complex::from(-w * w)]);
        let mounted = FREQUENCIES.iter().flat_map(|f| RATIOS.map(|ratio| (TAU * f, ratio)));
        let mounted = mounted.map(|(natural, ratio)| {
            let mount = |w: f64| Complex::new(natural * natural, 2.0 * ratio * natural * w);
            self.share(&[&|w| -w * w * mount(w) / (mount(w) - w * w)])
        });
        mounted.fold(rigid, f64::max)
    }

    /// The same share for a spring-damper in parallel with a relaxing branch.
    fn relaxation(&self) -> f64 {
        let of = |f: &f64| {
            let rate = TAU * f;
            let branch = |w: f64| Complex::I * w / Complex::new(rate, w);
            self.share(&[&|_| Complex::ONE, &|w| Complex::I * w, &branch])
        };
        FREQUENCIES.iter().map(of).fold(0.0, f64::max)
    }
}
