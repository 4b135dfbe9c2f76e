//! Screens candidates without a fit: the gain of each, to first order in all other unknowns.
//!
//! A candidate at given values changes the residuals by `g`. The part of `g` that changes of the other unknowns can
//! reproduce is projected out, and the rest is compared with the projected residual. This is the score test of C. R.
//! Rao (Proc. Cambridge Phil. Soc. 44, 1948) with a finite step. The magnitude of the effect is scaled to its largest
//! gain; its shape parameters are tried on a grid. Fits start where the true gain is largest.

use std::collections::BTreeMap;

use nalgebra::DVector;
use rayon::prelude::*;

use super::assembly::{Assembly, Hypothesis, Place};
use super::tangent::Tangent;
use crate::discover::candidate::{Added, Candidate, Change, ParameterRole};
use crate::discover::noise::Form;
use crate::discover::observe::Evidence;
use crate::discover::posterior::Refit;

/// A candidate with its gain.
pub struct Screened {
    /// Its position among the candidates.
    pub candidate: usize,
    /// Largest gain in log likelihood, to first order.
    pub gain: f64,
    /// Its grid points with the largest gains, best first.
    pub trials: Vec<Trial>,
}

/// A candidate with the start points of its fits, best first.
pub struct Entrant {
    /// Its position among the candidates.
    pub candidate: usize,
    pub starts: Vec<Place>,
}

/// Number of candidates, those with the largest gain, that start from several points. This and the numbers below are
/// choices that limit the time of a search.
pub const WITH_ALL_STARTS: usize = 3;
/// Number of start points of such a candidate. The others have one.
const STARTS: usize = 3;
/// Number of grid points per start at which the true gain is computed: those with the largest gain to first order.
const VERIFIED: usize = 3;
/// Grid of a single shape parameter: shares of the way to its bounds.
const SHAPES: &[f64] = &[0.0, -0.2, 0.2, -0.4, 0.4, -0.6, 0.6, -0.8, 0.8];
/// Grid of each of several shape parameters of a linear model, which is cheap to predict.
const SHAPES_OF_LINEAR: &[f64] = &[0.0, -0.35, 0.35, -0.7, 0.7];
/// Grid of each of several shape parameters of a nonlinear model: all combinations of two, one at a time for more.
const FEW_SHAPES: &[f64] = &[0.0, -0.5, 0.5];
/// Grid of every other free parameter.
const OTHERS: [f64; 2] = [-0.5, 0.5];

/// A fit whose residual the candidates may explain.
pub struct Screening<'a> {
    assembly: &'a Assembly,
    refit: &'a Refit,
    evidence: &'a Evidence,
    /// The fit as a start point.
    here: Place,
    tangent: Tangent,
    /// Gain of the present unknowns and the discrepancy on this evidence, without a candidate.
    without: f64,
}

/// A grid point of a candidate, scaled to its largest gain to first order.
pub struct Trial {
    point: Point,
    /// Change of all other unknowns along with it.
    unknowns: DVector<f64>,
    gain: f64,
}

impl<'a> Screening<'a> {
    /// Screens candidates for a fit to this evidence.
    pub fn new(assembly: &'a Assembly, refit: &'a Refit, evidence: &'a Evidence) -> Self {
        let tangent = Tangent::new(refit, assembly, evidence);
        Self {
            assembly,
            refit,
            evidence,
            here: assembly.hypothesis().place(refit),
            without: tangent.gain_without_candidate(),
            tangent,
        }
    }

    /// All candidates; the largest gain comes first. Leaves out those that cannot be predicted.
    pub fn of(&self, candidates: &[Candidate]) -> Vec<Screened> {
        let screened = |(place, candidate)| self.screened(place, candidate);
        let mut all: Vec<Screened> = candidates.par_iter().enumerate().filter_map(screened).collect();
        all.sort_by(|a, b| b.gain.total_cmp(&a.gain));
        all
    }

    /// `None` if the candidate cannot be predicted, or if the present unknowns can reproduce its change of the
    /// residuals.
    fn screened(&self, place: usize, candidate: &Candidate) -> Option<Screened> {
        let hypothesis = self.assembly.hypothesis_with(candidate)?;
        let tried = grid(candidate).into_par_iter();
        let mut trials: Vec<Trial> = tried
            .filter_map(|point| self.trial(point, &hypothesis, candidate))
            .collect();
        trials.sort_by(|a, b| b.gain.total_cmp(&a.gain));
        trials.truncate(STARTS * VERIFIED);
        Some(Screened {
            candidate: place,
            gain: trials.first()?.gain,
            trials,
        })
    }

    fn trial(&self, point: Point, hypothesis: &Hypothesis<'_>, candidate: &Candidate) -> Option<Trial> {
        let from = point.at(&self.here, hypothesis, candidate);
        let there = hypothesis.residuals_at(&from, self.refit, self.evidence)?;
        let step = self.tangent.step(&there, point.scales(candidate))?;
        let with_discrepancy = self.tangent.gain_to_first_order(&there, &step) - self.without;
        Some(Trial {
            point: Point {
                scale: step.scale,
                ..point
            },
            gain: step.gain.max(with_discrepancy),
            unknowns: step.unknowns,
        })
    }

    /// These candidates with the start points of their fits.
    pub fn with_starts(&self, entering: &[&Screened], candidates: &[Candidate]) -> Vec<Entrant> {
        let entrant = |(rank, own): (usize, &&Screened)| {
            let count = if rank < WITH_ALL_STARTS { STARTS } else { 1 };
            Entrant {
                candidate: own.candidate,
                starts: self.starts(&own.trials, &candidates[own.candidate], count),
            }
        };
        entering.par_iter().enumerate().map(entrant).collect()
    }

    /// The trials with the largest true gain. The first-order gain assumes that all other unknowns change with the
    /// candidate, so a start changes them too if it then gains more.
    fn starts(&self, trials: &[Trial], candidate: &Candidate, count: usize) -> Vec<Place> {
        let Some(hypothesis) = self.assembly.hypothesis_with(candidate) else {
            return Vec::new();
        };
        let start = |trial: &Trial, unknowns: &DVector<f64>| {
            let here = self.here.changed_by(unknowns, self.refit, self.assembly.model());
            let place = trial.point.at(&here, &hypothesis, candidate);
            let residual = hypothesis.residuals_at(&place, self.refit, self.evidence)?;
            Some((place, self.tangent.gain_at(&residual, unknowns)))
        };
        let better = |trial: &Trial| {
            let unchanged = DVector::zeros(trial.unknowns.len());
            let both = [&trial.unknowns, &unchanged].map(|unknowns| start(trial, unknowns));
            both.into_iter().flatten().max_by(|a, b| a.1.total_cmp(&b.1))
        };
        let trials = trials.par_iter().take(count * VERIFIED);
        let mut starts: Vec<(Place, f64)> = trials.filter_map(better).collect();
        starts.sort_by(|a, b| b.1.total_cmp(&a.1));
        starts.into_iter().take(count).map(|(place, _)| place).collect()
    }
}

/// A grid point of a candidate: for each of its parameters, the signed share of the way from its start to a bound.
#[derive(Clone, Debug)]
pub struct Point {
    shifts: Vec<f64>,
    /// Factor on the magnitude.
    scale: f64,
}

impl Point {
    /// The point at which every parameter has its start value.
    pub fn at_start(candidate: &Candidate) -> Self {
        Self {
            shifts: vec![0.0; candidate.parameters().len()],
            scale: 1.0,
        }
    }

    /// The present fit extended by the candidate with the values of this point.
    pub fn at(&self, here: &Place, hypothesis: &Hypothesis<'_>, candidate: &Candidate) -> Place {
        let mut there = here.clone();
        let parameters = candidate.parameters().iter().zip(&self.shifts);
        let scales_force = candidate.parameters().iter().any(is_force_strength);
        let values: BTreeMap<String, f64> = parameters
            .filter(|(own, _)| !own.known)
            .map(|(own, &shift)| (own.name.clone(), self.scaled(own, shifted(own, shift), scales_force)))
            .collect();
        match &candidate.change {
            Change::Sensor { form, parameter, .. } => {
                there.errors.resize(hypothesis.sensor_errors() - 1, 0.0);
                there.errors.push(coefficient(*form, values[&parameter.name]));
            }
            Change::Model { .. } => there.named.extend(values),
        }
        there
    }

    /// A value at the scale of this point. If the strength is a mass, stiffness, damping or force, so that the force of
    /// the effect `scales` with it, all such parameters are scaled too: the effect then keeps its frequencies, travels
    /// and speeds.
    fn scaled(&self, own: &Added, value: f64, scales: bool) -> f64 {
        let scaled = match own.role {
            ParameterRole::Strength { vanishes_at } if vanishes_at.is_infinite() => value / self.scale,
            ParameterRole::Strength { vanishes_at } => vanishes_at + self.scale * (value - vanishes_at),
            _ if scales && own.scales_force => value * self.scale,
            _ => return value,
        };
        scaled.clamp(own.range.0, own.range.1)
    }

    /// Least and largest factor on the magnitude of a candidate within its range; (1, 1) if it has no magnitude.
    fn scales(&self, candidate: &Candidate) -> (f64, f64) {
        let parameters = candidate.parameters().iter().zip(&self.shifts);
        let mut strengths = parameters.filter_map(|(own, &shift)| match own.role {
            ParameterRole::Strength { vanishes_at } => Some((own, shifted(own, shift), vanishes_at)),
            _ => None,
        });
        let Some((own, value, vanishes_at)) = strengths.next() else {
            return (1.0, 1.0);
        };
        let (low, high) = own.range;
        let [a, b] = if vanishes_at.is_infinite() {
            [value / high, value / low]
        } else {
            [low, high].map(|end| (end - vanishes_at) / (value - vanishes_at))
        };
        let (least, most) = (a.min(b), a.max(b));
        if least.is_finite() && most.is_finite() {
            (least, most)
        } else {
            (1.0, 1.0)
        }
    }
}

/// True for a strength to which the forces of its effect are proportional, if all parameters with
/// [`Added::scales_force`] are scaled by the same factor.
fn is_force_strength(own: &Added) -> bool {
    own.role == ParameterRole::Strength { vanishes_at: 0.0 } && own.scales_force
}

/// Coefficient of a sensor error: a delay in s, the logarithm of a gain.
fn coefficient(form: Form, value: f64) -> f64 {
    if form == Form::Delay { value } else { value.ln() }
}

/// Grid points of a candidate: combinations of its shape parameters, and every other free parameter alone.
fn grid(candidate: &Candidate) -> Vec<Point> {
    let parameters = candidate.parameters();
    let is_shape = |own: &&Added| own.role == ParameterRole::Shape && !own.known;
    let is_linear = matches!(&candidate.change, Change::Model { model, .. } if model.about().linear);
    let (of_shape, together) = match (parameters.iter().filter(is_shape).count(), is_linear) {
        (0 | 1, _) => (SHAPES, true),
        (_, true) => (SHAPES_OF_LINEAR, true),
        (2, false) => (FEW_SHAPES, true),
        (_, false) => (FEW_SHAPES, false),
    };
    let start = vec![0.0; parameters.len()];
    let mut points = vec![start.clone()];
    for (k, own) in parameters.iter().enumerate().filter(|(_, own)| !own.known) {
        let shifts = if own.role == ParameterRole::Shape {
            of_shape
        } else {
            &OTHERS
        };
        let moved = |from: &Vec<f64>| {
            let from = from.clone();
            shifts.iter().map(move |&shift| {
                let mut point = from.clone();
                point[k] = shift;
                point
            })
        };
        // Every combination of shapes is tried; any other parameter moves alone.
        let more: Vec<Vec<f64>> = match own.role {
            ParameterRole::Shape if together => points.iter().flat_map(moved).collect(),
            _ => moved(&start).collect(),
        };
        points.extend(more);
    }
    points.sort_by(|a, b| a.partial_cmp(b).expect("shifts are numbers"));
    points.dedup();
    points.into_iter().map(|shifts| Point { shifts, scale: 1.0 }).collect()
}

/// The value at `shift`, from the start (0) to the lower (-1) or upper (1) bound; geometric if the range is positive.
fn shifted(parameter: &Added, shift: f64) -> f64 {
    let (low, high) = parameter.range;
    let end = if shift < 0.0 { low } else { high };
    if low > 0.0 {
        parameter.start * (end / parameter.start).powf(shift.abs())
    } else {
        parameter.start + (end - parameter.start) * shift.abs()
    }
}

#[cfg(test)]
mod tests {
    use super::{Point, is_force_strength};
    use crate::discover::candidate::{Added, ParameterRole};

    fn added(start: f64, role: ParameterRole, scales_force: bool) -> Added {
        Added {
            name: String::new(),
            effect_name: String::new(),
            start,
            range: (1e-3 * start, 1e3 * start),
            known: false,
            role,
            scales_force,
        }
    }

    /// A tenth of a mass on a tenth of its mount has the same frequency and damping ratio, and a gap stays. A ratio as
    /// strength changes nothing else.
    #[test]
    fn a_smaller_effect_keeps_its_frequency_and_its_travel() {
        let point = Point {
            shifts: Vec::new(),
            scale: 0.1,
        };
        let values = |parameters: &[Added]| -> Vec<f64> {
            let scales = parameters.iter().any(is_force_strength);
            let scaled = parameters.iter().map(|own| point.scaled(own, own.start, scales));
            scaled.collect()
        };
        let strength = ParameterRole::Strength { vanishes_at: 0.0 };
        let mass = added(80.0, strength, true);
        let stiffness = added(3e5, ParameterRole::Shape, true);
        let damping = added(500.0, ParameterRole::Other, true);
        let gap = added(0.01, ParameterRole::Shape, false);
        let all = [mass, stiffness.clone(), damping, gap];
        assert_eq!(values(&all), [8.0, 3e4, 50.0, 0.01]);
        let ratio = added(0.5, strength, false);
        assert_eq!(values(&[ratio, stiffness]), [0.05, 3e5]);
    }
}
