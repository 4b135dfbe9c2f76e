//! Resonances that lie between the lines of a response.

use qcar_runtime::free_motions::MOST_STATES;
use qcar_runtime::model::Model;
use qcar_runtime::modes::frequencies;
use qcar_runtime::response::parameters::Values;

use crate::table::number;
use crate::units;

/// Distance of a peak from the nearest line, in halves of its width at half its power, from which it counts as missed: a
/// line reads a third of its height there.
const MISSED: f64 = 3.0;

/// A sentence for modes whose peaks lie between the lines (Hz, ascending) of a response, which reads a fraction of their
/// heights; `None` if there are none, or if the model has too many states for this check.
pub fn missed(model: &dyn Model, values: &Values, lines: &[f64]) -> Option<String> {
    if model.about().states.len() > MOST_STATES {
        return None;
    }
    let is_missed = |(frequency, damping): &(f64, f64)| {
        let right = lines.partition_point(|line| line < frequency);
        let sides = right.checked_sub(1).zip(lines.get(right));
        sides.is_some_and(|(left, right)| {
            let nearest = (frequency - lines[left]).min(right - frequency);
            *damping >= 0.0 && nearest > MISSED * damping * frequency
        })
    };
    let modes = frequencies(model, values).into_iter().filter(is_missed);
    let modes: Vec<String> = modes
        .map(|(frequency, damping)| {
            let frequency = units::with_unit(&number(units::value(frequency, "Hz"), 5), "Hz");
            format!("{frequency} (damping ratio {})", number(damping, 2))
        })
        .collect();
    (!modes.is_empty()).then(|| {
        format!(
            "the peak of a mode at {} is narrower than the distance of the lines, which miss its height: choose lines around \
             it",
            modes.join(" and of one at ")
        )
    })
}
