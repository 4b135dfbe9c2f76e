//! Ratios as complex numbers, for people and for other programs.

use std::collections::BTreeMap;

use super::Response;
use super::parameters::Values;
use super::signal::{SignalError, Term, locate};
use crate::model::{About, Model, Signal};
use nalgebra::Complex;

/// A ratio of two signals over frequency.
#[derive(Clone, Debug, PartialEq)]
pub struct Ratio {
    /// A value for each frequency.
    pub value: Vec<Complex<f64>>,
    /// Position of each parameter on which the ratio depends and that is not tied to another, with a derivative for
    /// each frequency.
    pub jacobian: Vec<(usize, Vec<Complex<f64>>)>,
}

/// The ratio of two signals when `excitation` alone acts, at `frequency` (Hz, above zero), with its derivatives.
///
/// # Errors
/// Fails if the model cannot give one of the signals.
pub fn ratio<M: Model + ?Sized>(
    model: &M,
    values: &Values,
    excitation: usize,
    numerator: &Signal,
    denominator: &Signal,
    frequency: &[f64],
) -> Result<Ratio, SignalError> {
    Ratios::with_derivatives(model, values).ratio(excitation, [numerator, denominator], frequency)
}

/// Ratios of a model at parameter values. A response has all signals of the model, so it is evaluated once for all
/// ratios that are asked for in turn under one excitation at the same frequencies.
pub struct Ratios<'a, M: ?Sized> {
    model: &'a M,
    values: &'a Values,
    with_derivatives: bool,
    last: Option<Evaluated<'a, M>>,
}

/// A response that has been evaluated at these frequencies, Hz.
struct Evaluated<'a, M: ?Sized> {
    frequency: Vec<f64>,
    response: Response<'a, M>,
}

impl<'a, M: Model + ?Sized> Ratios<'a, M> {
    /// Ratios without derivatives.
    pub fn new(model: &'a M, values: &'a Values) -> Self {
        Self {
            model,
            values,
            with_derivatives: false,
            last: None,
        }
    }

    /// Ratios with derivatives by the parameters.
    pub fn with_derivatives(model: &'a M, values: &'a Values) -> Self {
        Self {
            with_derivatives: true,
            ..Self::new(model, values)
        }
    }

    /// The description of the model.
    pub fn about(&self) -> &'a About {
        self.model.about()
    }

    /// The ratio of two signals when `excitation` alone acts, at `frequency` (Hz, above zero).
    ///
    /// # Errors
    /// Fails if the model cannot give one of the signals.
    pub fn ratio(
        &mut self,
        excitation: usize,
        [numerator, denominator]: [&Signal; 2],
        frequency: &[f64],
    ) -> Result<Ratio, SignalError> {
        let is_same = |last: &Evaluated<'_, M>| last.response.excitation == excitation && last.frequency == frequency;
        let last = match self.last.take().filter(is_same) {
            Some(last) => last,
            None => self.evaluated(excitation, frequency),
        };
        let ratio = between(&last.response, self.values, numerator, denominator);
        self.last = Some(last);
        ratio
    }

    fn evaluated(&self, excitation: usize, frequency: &[f64]) -> Evaluated<'a, M> {
        let mut response = Response::new(self.model, excitation, frequency);
        if self.with_derivatives {
            response.evaluate(self.values.as_slice());
        } else {
            response.evaluate_values(self.values.as_slice());
        }
        Evaluated {
            frequency: frequency.to_vec(),
            response,
        }
    }
}

/// The ratio of two signals of an evaluated response; without derivatives if the response has none.
///
/// # Errors
/// Fails as [`ratio`] does.
pub fn between<M: Model + ?Sized>(
    response: &Response<'_, M>,
    values: &Values,
    numerator: &Signal,
    denominator: &Signal,
) -> Result<Ratio, SignalError> {
    let find = |signal| locate(response.model.about(), response.layout(), response.excitation, signal);
    let (above, below) = (find(numerator)?, find(denominator)?);
    let (n, d) = (signal(response, above), signal(response, below));
    let value: Vec<_> = n.iter().zip(&d).map(|(n, d)| n / d).collect();
    let leaders = (0..values.as_slice().len()).filter(|&k| response.has_jacobian() && values.leader(k) == k);
    let (above, below) = (slopes(response, above, values), slopes(response, below, values));
    let jacobian = leaders.filter_map(|leader| {
        let (dn, dd) = (above.get(&leader), below.get(&leader));
        (dn.is_some() || dd.is_some()).then(|| {
            let at = |slope: Option<&Vec<Complex<f64>>>, line: usize| slope.map_or(Complex::default(), |s| s[line]);
            (
                leader,
                (0..value.len())
                    .map(|i| (at(dn, i) - value[i] * at(dd, i)) / d[i])
                    .collect(),
            )
        })
    });
    Ok(Ratio {
        jacobian: jacobian.collect(),
        value,
    })
}

fn signal<M: Model + ?Sized>(response: &Response<'_, M>, term: Term) -> Vec<Complex<f64>> {
    let values = match term.row {
        Some(row) => pairs(response.row(row)),
        None => vec![Complex::from(1.0); response.omega().len()],
    };
    differentiate(values, term.power, response.omega())
}

/// The derivatives of a signal, each along a leading parameter together with those tied to it. Parameters on which the
/// signal does not depend are left out.
fn slopes<M: Model + ?Sized>(
    response: &Response<'_, M>,
    term: Term,
    values: &Values,
) -> BTreeMap<usize, Vec<Complex<f64>>> {
    let mut totals: BTreeMap<usize, Vec<Complex<f64>>> = BTreeMap::new();
    if !response.has_jacobian() {
        return totals;
    }
    for (entry, &(row, parameter)) in response.layout().jacobian.iter().enumerate() {
        if term.row != Some(usize::from(row)) {
            continue;
        }
        let total = totals
            .entry(values.leader(usize::from(parameter)))
            .or_insert_with(|| vec![Complex::default(); response.omega().len()]);
        for (sum, value) in total.iter_mut().zip(pairs(response.entry(entry))) {
            *sum += value;
        }
    }
    let turned = totals
        .into_iter()
        .map(|(leader, total)| (leader, differentiate(total, term.power, response.omega())));
    turned.collect()
}

fn pairs((re, im): (&[f64], &[f64])) -> Vec<Complex<f64>> {
    re.iter().zip(im).map(|(&re, &im)| Complex::new(re, im)).collect()
}

fn differentiate(values: Vec<Complex<f64>>, power: i32, omega: &[f64]) -> Vec<Complex<f64>> {
    values
        .iter()
        .zip(omega)
        .map(|(value, &omega)| value * Complex::new(0.0, omega).powi(power))
        .collect()
}
