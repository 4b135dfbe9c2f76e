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
use crate::discover::candidate::{Added, Candidate, Change, ParameterRole};
use crate::discover::evidence::Evidence;
use crate::discover::nuisance::Form;
use crate::discover::predict::PredictError;
use crate::discover::refit::Refit;

/// A candidate with the places from which it should be fitted.
pub struct Prospect {
    /// Its place among the candidates.
    pub candidate: usize,
    /// Where fits should begin, the best first, with what each would gain in the logarithm of the likelihood.
    pub starts: Vec<(Place, f64)>,
}

impl Prospect {
    /// What the best start would gain.
    pub fn gain(&self) -> f64 {
        self.starts.first().map_or(0.0, |start| start.1)
    }
}

/// Starts of a candidate that are fitted.
const STARTS: usize = 3;
/// How far a strength may be scaled at once: beyond, the response is not linear in it any more.
const SCALED: (f64, f64) = (0.1, 10.0);
/// How far towards the ends of their ranges shapes are tried.
const SHAPES: [f64; 5] = [0.0, -0.4, 0.4, -0.8, 0.8];
/// The same of anything else.
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
    let tangent = Tangent::new(refit.linearised(assembly.model(), evidence));
    let all = candidates.par_iter().enumerate().filter_map(|(place, candidate)| {
        let hypothesis = assembly.hypothesis_with(candidate)?;
        let tried = grid(candidate).into_par_iter().filter_map(|point| {
            let from = point.at(&here, &hypothesis, candidate);
            let values = hypothesis.values(&from.named).ok()?;
            let there = refit.residuals_of(hypothesis.model(), &values, &from.errors, assembly.model(), evidence)?;
            let (scale, gain) = tangent.gain(&there, point.scalable(candidate))?;
            Some((point.scaled(candidate, scale).at(&here, &hypothesis, candidate), gain))
        });
        let mut starts: Vec<(Place, f64)> = tried.collect();
        starts.sort_by(|a, b| b.1.total_cmp(&a.1));
        starts.truncate(STARTS);
        (!starts.is_empty()).then_some(Prospect {
            candidate: place,
            starts,
        })
    });
    let mut all: Vec<Prospect> = all.collect();
    all.sort_by(|a, b| b.gain().total_cmp(&a.gain()));
    Ok(all)
}

/// The present fit, linearised: residuals and what all unknowns could imitate.
struct Tangent {
    residual: DVector<f64>,
    jacobian: DMatrix<f64>,
    hessian: Option<Cholesky<f64, Dyn>>,
    /// Jᵀr.
    gradient: DVector<f64>,
}

impl Tangent {
    fn new((residual, jacobian): (DVector<f64>, DMatrix<f64>)) -> Self {
        Self {
            hessian: jacobian.tr_mul(&jacobian).cholesky(),
            gradient: jacobian.tr_mul(&residual),
            residual,
            jacobian,
        }
    }

    /// The factor by which a change of the residuals of the data would have to be scaled, where it may be, to gain most, and
    /// what it then gains in half the sum of squares.
    fn gain(&self, there: &DVector<f64>, scalable: bool) -> Option<(f64, f64)> {
        let data = there.len();
        let change = there - self.residual.rows(0, data);
        let along = self.jacobian.rows(0, data).tr_mul(&change);
        let imitated = self.hessian.as_ref()?.solve(&along);
        let cross = self.residual.rows(0, data).dot(&change) - self.gradient.dot(&imitated);
        let square = change.norm_squared() - along.dot(&imitated);
        if !(square > f64::EPSILON * change.norm_squared()) {
            return None;
        }
        let scale = if scalable {
            (-cross / square).clamp(SCALED.0, SCALED.1)
        } else {
            1.0
        };
        let gain = -scale * cross - scale * scale * square / 2.0;
        gain.is_finite().then_some((scale, gain))
    }
}

/// How far each parameter of a candidate is towards the ends of its range: by place among its parameters.
#[derive(Clone, Debug)]
struct Point {
    shifts: Vec<f64>,
    /// Factor of the strength.
    scale: f64,
}

impl Point {
    /// The place in which the candidate stands at this point beside the present fit.
    fn at(&self, here: &Place, hypothesis: &Hypothesis<'_>, candidate: &Candidate) -> Place {
        let mut there = here.clone();
        let parameters = candidate.parameters().iter().zip(&self.shifts);
        let values: BTreeMap<String, f64> = parameters
            .filter(|(own, _)| !own.known)
            .map(|(own, &shift)| (own.name.clone(), self.strengthened(own, towards(own, shift))))
            .collect();
        if let Change::Sensor { form, parameter, .. } = &candidate.change {
            let value = values[&parameter.name];
            there.errors.resize(hypothesis.sensor_errors() - 1, 0.0);
            there.errors.push(if *form == Form::Delay { value } else { value.ln() });
        } else {
            there.named.extend(values);
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

    fn scalable(&self, candidate: &Candidate) -> bool {
        let is_strength = |own: &Added| matches!(own.role, ParameterRole::Strength { .. });
        candidate.parameters().iter().any(is_strength) && !candidate.is_sensor()
    }

    fn scaled(&self, _candidate: &Candidate, scale: f64) -> Self {
        Self { scale, ..self.clone() }
    }
}

/// Where a candidate is tried: its shapes over a grid, each at two strengths, and everything else towards either end alone.
fn grid(candidate: &Candidate) -> Vec<Point> {
    let parameters = candidate.parameters();
    let start = vec![0.0; parameters.len()];
    let mut points = vec![start.clone()];
    for (k, own) in parameters.iter().enumerate().filter(|(_, own)| !own.known) {
        let shifts: &[f64] = if own.role == ParameterRole::Shape {
            &SHAPES
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
            ParameterRole::Shape => points.iter().flat_map(moved).collect(),
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
