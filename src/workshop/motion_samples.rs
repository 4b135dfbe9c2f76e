//! Values of a model's equations of motion and of its outputs at pseudo-random points. Models with the same values are
//! equivalent, whatever their links are called.

use qcar_dsl::about::{Contact, Model};
use qcar_dsl::evaluate::Evaluator;
use qcar_dsl::schedule::Compiled;
use qcar_runtime::random::SplitMix;

/// Enough points to reach each piece of a law: a stop at a gap of about 1 is reached at every fourth.
const POINTS: u64 = 64;
/// Sizes of the states, in turn: within gaps and knees, and far beyond them.
const SIZES: [f64; 2] = [1.0, 10.0];
/// Difference from rounding, relative to the largest value at a point.
const ROUNDING: f64 = 1e-9;

/// The rates of all states and the outputs, on a resting and on a rolling tyre, at each point. On a rig that gives the
/// motion, only the measured force shows a law.
pub struct MotionSamples(Vec<Vec<f64>>);

impl MotionSamples {
    /// The values of compiled models, one after the other.
    pub fn of<'a>(models: impl Iterator<Item = &'a Compiled>) -> Self {
        let sampled = |compiled| {
            let model = Evaluator::new(compiled);
            (0..POINTS).map(|point| values(&model, point)).collect::<Vec<_>>()
        };
        Self(models.flat_map(sampled).collect())
    }

    /// True if all values are the same but for rounding. A value that is not a number is unlike any other.
    pub fn agree_with(&self, other: &Self) -> bool {
        let alike = |(own, other): (&Vec<f64>, &Vec<f64>)| {
            let largest = own.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
            let mut pairs = own.iter().zip(other);
            own.len() == other.len() && pairs.all(|(a, b)| (a - b).abs() <= ROUNDING * largest)
        };
        self.0.iter().zip(&other.0).all(alike)
    }
}

/// The rates and outputs at a point. A parameter has the same value in every model with the same names of parameters.
fn values(model: &dyn Model, point: u64) -> Vec<f64> {
    let about = model.about();
    let mut random = SplitMix::stream(0, point);
    let mut by_name: Vec<usize> = (0..about.parameters.len()).collect();
    by_name.sort_unstable_by_key(|&place| &about.parameters[place].name);
    let mut p = vec![0.0; by_name.len()];
    by_name.into_iter().for_each(|place| p[place] = 0.5 + random.uniform());
    let size = SIZES[point as usize % SIZES.len()];
    let mut signed = |count: usize| -> Vec<f64> { (0..count).map(|_| size * (2.0 * random.uniform() - 1.0)).collect() };
    let u = signed(about.inputs.len());
    let contact = signed(4);
    let x = signed(about.states.len());
    let mut constants = vec![0.0; about.constants];
    model.prepare(&p, &mut constants);
    let mut resting = vec![0.0; x.len() + about.outputs.len()];
    let (rates, outputs) = resting.split_at_mut(x.len());
    model.derivative(&constants, &x, &u, rates);
    model.outputs(&constants, &x, &u, outputs);
    let mut rolling = vec![0.0; resting.len()];
    if about.contact.is_some() {
        let (rates, outputs) = rolling.split_at_mut(x.len());
        let contact = Contact {
            s: contact[0],
            v: contact[1],
            force: [contact[2], contact[3]],
        };
        model.rolling_derivative(&constants, &x, &u, &contact, rates);
        model.rolling_outputs(&constants, &x, &u, &contact, outputs);
    }
    resting.into_iter().chain(rolling).collect()
}
