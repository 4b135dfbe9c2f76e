//! Frequency responses for many parameter sets.

use nalgebra::Complex;
use ndarray::{Array4, Array5, ArrayView2, ArrayViewMut4, Axis};
use qcar::stopping;
use qcar_runtime::model::Model;
use qcar_runtime::response::Response;
use rayon::prelude::*;

/// The response (sets, lines, outputs, excitations) and, if wanted, its derivatives (sets, parameters, lines, outputs,
/// excitations).
pub struct Responses {
    /// Response per m of a motion or N of a force.
    pub value: Array4<Complex<f64>>,
    /// Derivatives, per unit of the parameter.
    pub jacobian: Option<Array5<Complex<f64>>>,
}

/// The response of every output to every excitation at `frequency` (Hz, above zero).
pub fn responses(
    model: &dyn Model,
    sets: ArrayView2<'_, f64>,
    leader: &[usize],
    frequency: &[f64],
    jacobian: bool,
) -> Responses {
    let about = model.about();
    let (lines, outputs, excitations) = (frequency.len(), about.outputs.len(), about.excitations.len());
    let parameters = if jacobian { about.parameters.len() } else { 0 };
    let mut value = Array4::zeros((sets.nrows(), lines, outputs, excitations));
    let mut slopes_of_all = Array5::zeros((sets.nrows(), parameters, lines, outputs, excitations));
    let stop = stopping::of_this_work();
    let work = |((mut value, mut slopes), p): ((_, ArrayViewMut4<'_, _>), ndarray::ArrayView1<'_, f64>)| {
        stopping::here(stop.as_ref());
        one(
            model,
            &p.to_vec(),
            leader,
            frequency,
            &mut value,
            jacobian.then_some(&mut slopes),
        );
    };
    let values = value.axis_chunks_iter_mut(Axis(0), 1).into_par_iter();
    let slopes = slopes_of_all.axis_iter_mut(Axis(0)).into_par_iter();
    values
        .zip(slopes)
        .zip(sets.axis_iter(Axis(0)).into_par_iter())
        .panic_fuse()
        .for_each(work);
    Responses {
        value,
        jacobian: jacobian.then_some(slopes_of_all),
    }
}

/// One set: `value` (1, lines, outputs, excitations), `slopes` (parameters, lines, outputs, excitations).
fn one(
    model: &dyn Model,
    p: &[f64],
    leader: &[usize],
    frequency: &[f64],
    value: &mut ArrayViewMut4<'_, Complex<f64>>,
    mut slopes: Option<&mut ArrayViewMut4<'_, Complex<f64>>>,
) {
    for excitation in 0..model.about().excitations.len() {
        let mut response = Response::new(model, excitation, frequency);
        match slopes {
            Some(_) => response.evaluate(p),
            None => response.evaluate_values(p),
        }
        let outputs: Vec<usize> = response.layout().outputs.iter().map(|&own| own.into()).collect();
        for (row, &output) in outputs.iter().enumerate() {
            let (re, im) = response.row(row);
            for line in 0..frequency.len() {
                value[[0, line, output, excitation]] = Complex::new(re[line], im[line]);
            }
        }
        let Some(slopes) = slopes.as_deref_mut() else {
            continue;
        };
        for (entry, &(row, parameter)) in response.layout().jacobian.iter().enumerate() {
            let (re, im) = response.entry(entry);
            let (output, parameter) = (outputs[usize::from(row)], leader[usize::from(parameter)]);
            for line in 0..frequency.len() {
                slopes[[parameter, line, output, excitation]] += Complex::new(re[line], im[line]);
            }
        }
    }
}
