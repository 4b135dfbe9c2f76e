//! Which dynamic stiffness, added at one place, would explain every channel at once by a rank-one update.
//!
//! A dynamic stiffness κ(ω) added across a link with stretch s and force pair F changes every response by
//! `H' - H = -κ / (1 + κ H(s,F)) · H(y,F) H(s,u)`. All channels share the scalar in front, and what follows it is, up
//! to the unit, the derivative of the response by a parameter of that link, which every model gives. So the parameters
//! of a model are its places, the best scalar of a line is linear least squares, and no refit is needed. `H(s,F)`
//! comes from one finite change of the parameter, by the same formula.

// A straight line through a few complex values.
mod straight;
// The responses of all sensors line by line, and what explains them.
mod lines;
// What κ looks like.
mod shape;

pub use shape::{Shape, shape};

use std::f64::consts::TAU;

use nalgebra::Complex;

use super::observe::{Evidence, Free, Kind, PredictError, Stimulus, predict};
use super::posterior::{Gap, Refit, refit};
use crate::campaign::Role;
use crate::model::Model;
use crate::response::parameters::Values;
use crate::transmissibility::Point;
use lines::{Direction, Lines};

/// Where something may be missing.
#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Place {
    /// Across the link, or at the mass, whose law or inertia this parameter of the model is.
    Parameter(usize),
    /// In a sensor: its signal alone is wrong, by a factor of its own at every frequency.
    Sensor(Point),
}

/// What would have to be there.
#[derive(Clone, Debug, PartialEq)]
pub struct Kappa {
    /// Where.
    pub place: Place,
    /// Share of the squared gap of the first harmonics that the best smooth κ at this place explains, run by run freely:
    /// no effect at this place alone explains more.
    pub ceiling: f64,
    /// The same for the mean κ of all runs: far below `ceiling`, even negative, where κ depends on amplitude.
    pub common: f64,
    /// For each run with first harmonics.
    pub runs: Vec<KappaRun>,
}

/// κ in one run.
#[derive(Clone, Debug, PartialEq)]
pub struct KappaRun {
    /// Place in [`Evidence::runs`].
    pub run: usize,
    /// The level of the run.
    pub level: f64,
    /// Hz.
    pub frequency: Vec<f64>,
    /// The added dynamic stiffness, N/m; of a sensor the factor on its signal, less 1.
    pub value: Vec<Complex<f64>>,
    /// Standard deviation of each.
    pub sigma: Vec<f64>,
}

/// What the sweeps say of where something is missing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sweeps {
    /// The places of the model, the best explanation first; none without sweeps.
    pub places: Vec<Kappa>,
    /// Sum of the squared first harmonics, over their uncertainty, that the model leaves without any of it.
    pub left: f64,
}

/// Uncertainty added to every value before κ is asked for, as its share: a wrong model that is pressed to fit hides its
/// fault in all its parameters.
const TOLERANCE: f64 = 0.1;

impl Sweeps {
    /// Looks for the places that explain what a refitted model leaves of the sweeps.
    ///
    /// # Errors
    /// Where the model lacks what was measured.
    pub fn new(model: &dyn Model, before: &Refit, evidence: &Evidence) -> Result<Self, PredictError> {
        let sweeps = evidence.only(|run| matches!(evidence.runs[run].stimulus, Stimulus::Sweep { .. }));
        if sweeps.of_role(Role::Fit).next().is_none() {
            return Ok(Self::default());
        }
        let eased = refit(model, &before.values, &before.free, &sweeps.tolerant(TOLERANCE))?;
        let base = predict(model, &eased.values, &[], &sweeps, Role::Fit)?;
        Ok(Self {
            left: Lines::new(&eased, &sweeps, &base).left(),
            places: kappa_map(model, &eased, &sweeps)?,
        })
    }

    /// The share of what is left for which a model accounts that leaves this gap; `None` where nothing is left.
    pub fn explained_by(&self, gap: &Gap, evidence: &Evidence) -> Option<f64> {
        let first = evidence
            .of_role(Role::Fit)
            .filter(|(_, series)| series.kind == Kind::Harmonic(1));
        let squares = first
            .flat_map(|(place, _)| &gap.residuals[place])
            .map(|residual| residual * residual);
        // Each part of a complex residual is in units of its own standard deviation.
        (self.left > 0.0).then(|| 1.0 - squares.sum::<f64>() / 2.0 / self.left)
    }
}

/// The finite change of a parameter that shows `H(s,F)`, relative to its value.
const FINITE: f64 = 0.3;

/// κ at every place of the model, the best explanation first.
///
/// Held-out runs are not looked at. The base model is best refitted with some tolerance
/// ([`Evidence::tolerant`]), since a wrong model that is pressed to fit hides its fault in all its parameters.
///
/// # Errors
/// Where the model lacks what was measured.
pub fn kappa_map(model: &dyn Model, refit: &Refit, evidence: &Evidence) -> Result<Vec<Kappa>, PredictError> {
    let places = places(model, &refit.values);
    let base = predict(model, &refit.values, &places, evidence, Role::Fit)?;
    let lines = Lines::new(refit, evidence, &base);
    let mut map = Vec::new();
    for (column, free) in places.iter().enumerate() {
        let mut values = refit.values.clone();
        let change = FINITE * values.as_slice()[free.parameter];
        values.set(free.parameter, values.as_slice()[free.parameter] + change);
        let changed = Lines::new(refit, evidence, &predict(model, &values, &[], evidence, Role::Fit)?);
        let unit = Unit::of(&model.about().parameters[free.parameter].unit);
        let compliance = lines.compliance(column, &changed, change);
        let direction = Direction::Slope(column);
        let of = |f: f64| unit.stiffness(f);
        map.push(lines.kappa(Place::Parameter(free.parameter), &direction, &compliance, of));
    }
    for sensor in lines.sensors() {
        let direction = Direction::Sensor(sensor.clone());
        map.push(lines.kappa(Place::Sensor(sensor), &direction, &lines.rigid(), |_| Complex::ONE));
    }
    // What no channel sees explains nothing.
    map.retain(|kappa| kappa.ceiling > 0.0);
    map.sort_by(|a, b| b.ceiling.total_cmp(&a.ceiling));
    Ok(map)
}

/// The parameters with the unit of a stiffness, a damping or a mass, that are not zero and lead their ties.
fn places(model: &dyn Model, values: &Values) -> Vec<Free> {
    let about = model.about();
    let wanted = |&k: &usize| {
        Unit::of(&about.parameters[k].unit) != Unit::Other && values.leader(k) == k && values.as_slice()[k] != 0.0
    };
    let free = |parameter| Free {
        parameter,
        lower: f64::NEG_INFINITY,
        upper: f64::INFINITY,
    };
    (0..about.parameters.len()).filter(wanted).map(free).collect()
}

/// How a parameter becomes a dynamic stiffness.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Unit {
    Stiffness,
    Damping,
    Mass,
    Other,
}

impl Unit {
    fn of(unit: &str) -> Self {
        match unit {
            "N/m" => Unit::Stiffness,
            "N s/m" | "N*s/m" | "N/(m/s)" => Unit::Damping,
            "kg" => Unit::Mass,
            _ => Unit::Other,
        }
    }

    fn stiffness(self, f: f64) -> Complex<f64> {
        let rate = Complex::new(0.0, TAU * f);
        match self {
            Unit::Damping => rate,
            Unit::Mass => rate * rate,
            Unit::Stiffness | Unit::Other => Complex::ONE,
        }
    }
}
