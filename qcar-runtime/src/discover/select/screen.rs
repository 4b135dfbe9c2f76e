//! Candidates without a fit: what each would gain, to first order in all other unknowns.
//!
//! A candidate at some values changes the predicted residuals by `g`. What the other unknowns of the fit could imitate is
//! projected out (the score test of C. R. Rao, Proc. Cambridge Phil. Soc. 44, 1948, with a step of finite size), and
//! what is left of `g` is held against what is left of the residuals. The effect's strength is scaled to where it gains most;
//! its shapes are tried over a grid.

use std::collections::BTreeMap;

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};
use rayon::prelude::*;

use super::assembly::{Assembly, Hypothesis, Place};
use crate::campaign::Role;
use crate::discover::candidate::{Added, Candidate, Change, ParameterRole};
use crate::discover::noise::{Discrepancy, Form};
use crate::discover::observe::{Evidence, PredictError};
use crate::discover::posterior::Refit;

/// A candidate with the places from which it should be fitted.
pub struct Prospect {
    /// Its place among the candidates.
    pub candidate: usize,
    /// Where fits should begin, the best first, with what each would gain in the logarithm of the likelihood.
    pub starts: Vec<(Place, f64)>,
    /// Another start, of which the screening knows nothing.
    pub afresh: Option<Place>,
}

impl Prospect {
    /// Begins from a place too, with the usual values of the candidate.
    pub fn start_from(&mut self, place: &Place, assembly: &Assembly, candidate: &Candidate) {
        let hypothesis = assembly.hypothesis_with(candidate);
        self.afresh = hypothesis.map(|own| Point::usual(candidate).at(place, &own, candidate));
    }

    /// What the best start would gain.
    pub fn gain(&self) -> f64 {
        self.starts.first().map_or(0.0, |start| start.1)
    }
}

/// Starts of a candidate that are fitted.
const STARTS: usize = 3;
/// How far towards the ends of their ranges a single shape is tried,
const SHAPES: &[f64] = &[0.0, -0.2, 0.2, -0.4, 0.4, -0.6, 0.6, -0.8, 0.8];
/// each of two or more of a linear model, which costs little,
const SHAPES_OF_LINEAR: &[f64] = &[0.0, -0.35, 0.35, -0.7, 0.7];
/// each of two of any other, and each of more, one after the other,
const FEW_SHAPES: &[f64] = &[0.0, -0.5, 0.5];
/// and anything else.
const OTHERS: [f64; 2] = [-0.5, 0.5];

/// All candidates, those that would gain most first.
///
/// # Errors
/// Where a parameter of the present model has no value.
pub fn screen(
    assembly: &Assembly,
    candidates: &[Candidate],
    refit: &Refit,
    evidence: &Evidence,
) -> Result<Vec<Prospect>, PredictError> {
    let here = assembly.hypothesis().place(refit);
    let tangent = Tangent::new(refit, assembly, evidence);
    let alone = tangent.gain_alone();
    let all = candidates.par_iter().enumerate().filter_map(|(place, candidate)| {
        let hypothesis = assembly.hypothesis_with(candidate)?;
        let tried = grid(candidate).into_par_iter().filter_map(|point| {
            let from = point.at(&here, &hypothesis, candidate);
            let values = hypothesis.values(&from.named).ok()?;
            let (nuisance, coefficients) = hypothesis.nuisance_at(refit, &from);
            let nuisance = (nuisance, coefficients.as_slice());
            let there = refit.residuals_of(hypothesis.model(), &values, nuisance, assembly.model(), evidence)?;
            let step = tangent.step(&there, point.scales(candidate))?;
            let scaled = Point {
                scale: step.scale,
                ..point
            };
            let gain = step.gain.max(tangent.gain_with_discrepancy(&there, &step) - alone);
            Some((scaled.at(&here, &hypothesis, candidate), gain))
        });
        let mut starts: Vec<(Place, f64)> = tried.collect();
        starts.sort_by(|a, b| b.1.total_cmp(&a.1));
        starts.truncate(STARTS);
        (!starts.is_empty()).then_some(Prospect {
            candidate: place,
            starts,
            afresh: None,
        })
    });
    let mut all: Vec<Prospect> = all.collect();
    all.sort_by(|a, b| b.gain().total_cmp(&a.gain()));
    Ok(all)
}

/// The present fit, linearised: residuals, and what all unknowns could imitate.
pub struct Tangent {
    /// In units of the noise, those of the priors behind those of the data.
    residual: DVector<f64>,
    jacobian: DMatrix<f64>,
    /// The same, independent by the discrepancy.
    white: DVector<f64>,
    white_jacobian: DMatrix<f64>,
    hessian: Option<Cholesky<f64, Dyn>>,
    /// Jᵀr of these.
    gradient: DVector<f64>,
    /// As it is.
    discrepancy: Discrepancy,
    /// Minus the logarithm of the posterior density.
    cost: f64,
    data: usize,
}

/// The best step along a candidate.
struct Step {
    /// Factor of its change of the residuals.
    scale: f64,
    /// How all unknowns follow it.
    unknowns: DVector<f64>,
    /// What it gains in half the sum of squares.
    gain: f64,
}

impl Tangent {
    /// Of a fit.
    pub fn new(refit: &Refit, assembly: &Assembly, evidence: &Evidence) -> Self {
        let (residual, jacobian) = refit.linearised(assembly.model(), evidence);
        let known = refit
            .discrepancy_of(evidence)
            .unwrap_or_else(|| Discrepancy::of(evidence, Role::Fit));
        let (mut white, mut white_jacobian) = (residual.clone(), jacobian.clone());
        known.whiten(white.as_mut_slice());
        white_jacobian
            .column_iter_mut()
            .for_each(|mut column| known.whiten(column.as_mut_slice()));
        Self {
            data: evidence.of_role(Role::Fit).map(|(_, series)| series.residuals()).sum(),
            hessian: white_jacobian.tr_mul(&white_jacobian).cholesky(),
            gradient: white_jacobian.tr_mul(&white),
            cost: known.cost() + white.norm_squared() / 2.0,
            discrepancy: known,
            residual,
            jacobian,
            white,
            white_jacobian,
        }
    }

    /// The step along a change of the residuals of the data, within limits of its factor, that gains most while the
    /// discrepancy stays what it is.
    fn step(&self, there: &DVector<f64>, (least, most): (f64, f64)) -> Option<Step> {
        let mut change = there - self.residual.rows(0, self.data);
        self.discrepancy.whiten(change.as_mut_slice());
        let along = self.white_jacobian.rows(0, self.data).tr_mul(&change);
        let hessian = self.hessian.as_ref()?;
        let imitated = hessian.solve(&along);
        let cross = self.white.rows(0, self.data).dot(&change) - self.gradient.dot(&imitated);
        let square = change.norm_squared() - along.dot(&imitated);
        if square.is_nan() || square <= f64::EPSILON * change.norm_squared() {
            return None;
        }
        let scale = (-cross / square).clamp(least, most);
        let gain = -scale * cross - scale * scale * square / 2.0;
        let unknowns = -hessian.solve(&(&self.gradient + scale * along));
        gain.is_finite().then_some(Step { scale, unknowns, gain })
    }

    /// The sum of squares of a change of the residuals of the data that nothing else can imitate.
    pub fn trace(&self, there: &DVector<f64>) -> Option<f64> {
        let mut change = there - self.residual.rows(0, self.data);
        self.discrepancy.whiten(change.as_mut_slice());
        let along = self.white_jacobian.rows(0, self.data).tr_mul(&change);
        let imitated = self.hessian.as_ref()?.solve(&along);
        Some(change.norm_squared() - along.dot(&imitated))
    }

    /// What the present unknowns and the discrepancy gain by themselves on this part of the evidence.
    fn gain_alone(&self) -> f64 {
        let Some(hessian) = &self.hessian else { return 0.0 };
        let stay = Step {
            scale: 0.0,
            unknowns: -hessian.solve(&self.gradient),
            gain: 0.0,
        };
        let here = self.residual.rows(0, self.data).into_owned();
        self.gain_with_discrepancy(&here, &stay).max(0.0)
    }

    /// What a step gains in the logarithm of the posterior density, where the discrepancy becomes what is then left.
    fn gain_with_discrepancy(&self, there: &DVector<f64>, step: &Step) -> f64 {
        let mut left = &self.residual + &self.jacobian * &step.unknowns;
        let change = there - self.residual.rows(0, self.data);
        left.rows_mut(0, self.data).axpy(step.scale, &change, 1.0);
        if !left.iter().all(|value| value.is_finite()) {
            return f64::NEG_INFINITY;
        }
        let mut discrepancy = self.discrepancy.clone();
        discrepancy.learn(left.as_slice());
        discrepancy.whiten(left.as_mut_slice());
        self.cost - discrepancy.cost() - left.norm_squared() / 2.0
    }
}

/// How far each parameter of a candidate is towards the ends of its range: by place among its parameters.
#[derive(Clone, Debug)]
pub struct Point {
    shifts: Vec<f64>,
    /// Factor of the strength.
    scale: f64,
}

impl Point {
    /// The start of every parameter.
    pub fn usual(candidate: &Candidate) -> Self {
        Self {
            shifts: vec![0.0; candidate.parameters().len()],
            scale: 1.0,
        }
    }

    /// The place in which the candidate stands at this point beside the present fit.
    pub fn at(&self, here: &Place, hypothesis: &Hypothesis<'_>, candidate: &Candidate) -> Place {
        let mut there = here.clone();
        let parameters = candidate.parameters().iter().zip(&self.shifts);
        let values: BTreeMap<String, f64> = parameters
            .filter(|(own, _)| !own.known)
            .map(|(own, &shift)| (own.name.clone(), self.strengthened(own, towards(own, shift))))
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

    fn strengthened(&self, own: &Added, value: f64) -> f64 {
        let ParameterRole::Strength { vanishes_at } = own.role else {
            return value;
        };
        let scaled = if vanishes_at.is_infinite() {
            value / self.scale
        } else {
            vanishes_at + self.scale * (value - vanishes_at)
        };
        scaled.clamp(own.range.0, own.range.1)
    }

    /// By what factors the strength of a candidate may be scaled within its range; of one without, none.
    fn scales(&self, candidate: &Candidate) -> (f64, f64) {
        let parameters = candidate.parameters().iter().zip(&self.shifts);
        let mut strengths = parameters.filter_map(|(own, &shift)| match own.role {
            ParameterRole::Strength { vanishes_at } => Some((own, towards(own, shift), vanishes_at)),
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

/// The coefficient of a sensor's error: of a gain its logarithm.
fn coefficient(form: Form, value: f64) -> f64 {
    if form == Form::Delay { value } else { value.ln() }
}

/// Where a candidate is tried: its shapes over a grid, and everything else towards either end alone.
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
        // Shapes go with everything; anything else moves alone.
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

/// A value on the way from the start (0) to the lower (-1) or the upper end (1) of the range, by ratio where it can be.
fn towards(parameter: &Added, shift: f64) -> f64 {
    let (low, high) = parameter.range;
    let end = if shift < 0.0 { low } else { high };
    if low > 0.0 {
        parameter.start * (end / parameter.start).powf(shift.abs())
    } else {
        parameter.start + (end - parameter.start) * shift.abs()
    }
}
