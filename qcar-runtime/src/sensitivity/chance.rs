//! Random parameters, drawn from their uncertainty.

use crate::ensemble::Posterior;
use crate::random::SplitMix;
use crate::response::parameters::Values;

/// Distribution of the parameters. Parameters are given by their positions; none is tied to another.
#[derive(Clone, Debug, Default)]
pub struct Chance {
    /// Posterior of a fit, with the positions of its estimates.
    pub fit: Option<(Posterior, Vec<usize>)>,
    /// Parameters with a tolerance: a uniform distribution within this fraction of their values.
    pub tolerances: Vec<(usize, f64)>,
    /// Parameters that change with temperature, by this fraction of their values per kelvin.
    pub per_kelvin: Vec<(usize, f64)>,
    /// Range of the temperature relative to that of the values, K: a uniform distribution, the same temperature for all
    /// parameters.
    pub temperatures: [f64; 2],
}

impl Chance {
    /// True if no parameter is uncertain.
    pub fn is_certain(&self) -> bool {
        self.fit.is_none() && self.tolerances.is_empty() && self.per_kelvin.is_empty()
    }

    /// The parameters of the draw with this number about `values`, which need not be those of the fit: errors are
    /// relative to the value of a parameter.
    pub fn draw(&self, values: &Values, number: u64) -> Values {
        let mut drawn = values.clone();
        if let Some((posterior, places)) = &self.fit {
            let mut found = vec![0.0; places.len()];
            posterior.draw(number, FIT, &mut found);
            for ((&place, found), own) in places.iter().zip(found).zip(posterior.estimates()) {
                // A relative error of zero is not defined.
                let own = if own.value == 0.0 {
                    found
                } else {
                    values.as_slice()[place] * found / own.value
                };
                drawn.set(place, own);
            }
        }
        let mut times = |place: usize, factor: f64| drawn.set(place, drawn.as_slice()[place] * factor);
        let mut random = SplitMix::stream(PARTS, number);
        for (place, part) in &self.tolerances {
            times(*place, 1.0 + part * (2.0 * random.uniform() - 1.0));
        }
        let [low, high] = self.temperatures;
        let kelvin = low + (high - low) * random.uniform();
        for (place, part) in &self.per_kelvin {
            times(*place, 1.0 + part * kelvin);
        }
        drawn
    }
}

/// Seeds of the random numbers for errors of the fit and for tolerances.
const FIT: u64 = 0x66_69_74;
const PARTS: u64 = 0x70_61_72_74;
