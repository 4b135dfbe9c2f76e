//! Random parameters, drawn from their uncertainty.

use crate::ensemble::Posterior;
use crate::random::SplitMix;
use crate::response::parameters::Values;

/// What parameters may turn out as, by their places; each leads its ties.
#[derive(Clone, Debug, Default)]
pub struct Chance {
    /// What a fit says, with the places of its estimates.
    pub fit: Option<(Posterior, Vec<usize>)>,
    /// Parts that lie evenly within so much of their values.
    pub tolerances: Vec<(usize, f64)>,
    /// What changes by so much of its value per kelvin,
    pub per_kelvin: Vec<(usize, f64)>,
    /// and how far the temperature, the same for all, is evenly from that for which the values hold, K.
    pub temperatures: [f64; 2],
}

impl Chance {
    /// Whether everything is known.
    pub fn is_certain(&self) -> bool {
        self.fit.is_none() && self.tolerances.is_empty() && self.per_kelvin.is_empty()
    }

    /// The parameters of the draw of a number about `values`, which need not be those of the fit: errors go with a parameter in parts
    /// of its value.
    pub fn draw(&self, values: &Values, number: u64) -> Values {
        let mut drawn = values.clone();
        if let Some((posterior, places)) = &self.fit {
            let mut found = vec![0.0; places.len()];
            posterior.draw(number, FIT, &mut found);
            for ((&place, found), own) in places.iter().zip(found).zip(posterior.estimates()) {
                // Nothing is a part of zero.
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

/// Seeds of what is drawn.
const FIT: u64 = 0x66_69_74;
const PARTS: u64 = 0x70_61_72_74;
