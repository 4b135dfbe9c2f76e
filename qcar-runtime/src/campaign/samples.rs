//! Flaws of the samples of a channel.

use qcar_signals::health::{Flaw, FlawKind, flaws};
use qcar_signals::resample::Grid;

use super::contents::{Quantity, Role, Run, Test};
use super::finding::Finding;
use crate::shown::{rounded, shown};

/// Flaws of the samples of a sensor in a run; `unit` is its SI unit.
pub(super) fn of_samples(run: &Run, (channel, unit): (&str, &str), samples: &[f64], grid: Grid) -> Vec<Finding> {
    let steady = [false, true]
        .map(|turns| Quantity::Acceleration.unit_of(turns))
        .contains(&unit);
    let finding = |flaw: &Flaw| Finding {
        run: run.name.clone(),
        channel: channel.into(),
        span: (grid.time(flaw.samples.0), grid.time(flaw.samples.1)),
        what: description(flaw, unit),
        fatal: matches!((&flaw.kind, &run.test), (FlawKind::Dead(_), Test::Sweep(_))) && run.role == Role::Fit,
    };
    flaws(samples, steady).iter().map(finding).collect()
}

fn description(flaw: &Flaw, unit: &str) -> String {
    let (count, short) = (flaw.count, |value: f64| shown(rounded(value, 4), unit));
    match flaw.kind {
        FlawKind::Dead(0.0) => "every sample is 0: the channel is dead, or there was nothing to measure".into(),
        FlawKind::Dead(value) => format!("every sample is {}: the channel is dead", shown(value, unit)),
        FlawKind::Clipped(value) => format!(
            "{count} samples are cut off at {}: the channel is clipped",
            short(value)
        ),
        FlawKind::Spike(value) if count == 1 => format!("a spike to {}", short(value)),
        FlawKind::Spike(value) => format!("{count} spikes, the largest to {}", short(value)),
        FlawKind::Drift(drift) => format!("the mean drifts by {}", short(drift)),
    }
}
