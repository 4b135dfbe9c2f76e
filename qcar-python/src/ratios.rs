//! The named ratios of a model, such as transmissibilities, for many parameter sets.

use std::collections::BTreeMap;

use nalgebra::Complex;
use ndarray::{Array3, Array4, ArrayView1, ArrayView2, s};
use qcar::catalogue::Loaded;
use qcar::stopping;
use qcar::verbs::frf::excitation;
use qcar_runtime::model::{About, Channel};
use qcar_runtime::response::Response;
use qcar_runtime::response::parameters::Values;
use qcar_runtime::response::ratio::{Ratio, between};
use rayon::prelude::*;

/// The ratios (sets, lines, channels) and, if wanted, their derivatives (sets, parameters, lines, channels).
pub struct Ratios {
    /// Ratios, in the unit of the numerator over that of the denominator.
    pub value: Array3<Complex<f64>>,
    /// Derivatives, per unit of the parameter.
    pub jacobian: Option<Array4<Complex<f64>>>,
}

/// Every channel of a model at `frequency` (Hz, above zero).
///
/// # Errors
/// Fails if a channel has no excitation, or if the model cannot give its signals.
pub fn ratios(
    model: &Loaded,
    sets: ArrayView2<'_, f64>,
    leader: &[usize],
    frequency: &[f64],
    jacobian: bool,
) -> Result<Ratios, String> {
    let about = model.about();
    let (lines, channels) = (frequency.len(), about.channels.len());
    let parameters = if jacobian { about.parameters.len() } else { 0 };
    let rows: Vec<Vec<f64>> = sets.rows().into_iter().map(|row| row.to_vec()).collect();
    let stop = stopping::of_this_work();
    let of_set = |p: &Vec<f64>| {
        stopping::here(stop.as_ref());
        one(model, &values(about, p, leader), frequency, jacobian)
    };
    let found = rows.par_iter().map(of_set).panic_fuse();
    let found: Vec<Vec<Ratio>> = found.collect::<Result<_, _>>()?;
    let mut value = Array3::zeros((rows.len(), lines, channels));
    let mut slopes = Array4::zeros((rows.len(), parameters, lines, channels));
    for (set, of_set) in found.iter().enumerate() {
        for (channel, ratio) in of_set.iter().enumerate() {
            value
                .slice_mut(s![set, .., channel])
                .assign(&ArrayView1::from(&ratio.value));
            for (parameter, slope) in &ratio.jacobian {
                slopes
                    .slice_mut(s![set, *parameter, .., channel])
                    .assign(&ArrayView1::from(slope));
            }
        }
    }
    Ok(Ratios {
        value,
        jacobian: jacobian.then_some(slopes),
    })
}

/// The channels of one set. Each excitation is evaluated once for all of its channels.
fn one(model: &Loaded, values: &Values, frequency: &[f64], jacobian: bool) -> Result<Vec<Ratio>, String> {
    let about = model.about();
    let mut evaluated = BTreeMap::new();
    let channel = |channel: &Channel| {
        let excitation = excitation(about, channel).map_err(|failure| failure.to_string())?;
        let response = evaluated.entry(excitation).or_insert_with(|| {
            let mut response = Response::new(&**model, excitation, frequency);
            match jacobian {
                true => response.evaluate(values.as_slice()),
                false => response.evaluate_values(values.as_slice()),
            }
            response
        });
        let ratio = between(response, values, &channel.numerator, &channel.denominator);
        ratio.map_err(|error| format!("channel `{}`: {error}", channel.name))
    };
    about.channels.iter().map(channel).collect()
}

/// A parameter set with its ties; tied parameters are not given.
fn values(about: &About, p: &[f64], leader: &[usize]) -> Values {
    let own = (0..p.len()).filter(|&k| leader[k] == k);
    let given = own.map(|k| (about.parameters[k].name.to_string(), p[k])).collect();
    Values::resolve(about, &given, &BTreeMap::new()).expect("the set was resolved before")
}
