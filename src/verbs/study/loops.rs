//! Slow K&C cycles, for figures.

use qcar_runtime::campaign::{Campaign, Run, Test};
use serde::Serialize;

use super::gather::Study;
use crate::report::rounded::curve;

/// A cycle of force over displacement.
#[derive(Serialize)]
pub struct Loop {
    test: &'static str,
    /// Displacement, m.
    displacement: Vec<f64>,
    /// Force, N.
    force: Vec<f64>,
}

/// Number of points of a figure.
const MOST: usize = 400;

/// The cycles of a study with gradients.
pub fn loops(of: &Study) -> Vec<Loop> {
    let campaign = &of.fitted.campaign;
    let cycles = campaign.runs.iter().filter_map(|run| match run.test {
        Test::Bounce => cycle(campaign, run, "bounce"),
        Test::Longitudinal => cycle(campaign, run, "longitudinal"),
        _ => None,
    });
    cycles.collect()
}

fn cycle(campaign: &Campaign, run: &Run, test: &'static str) -> Option<Loop> {
    // Unreadable files have been refused with their gradients.
    let measured = campaign.curve(run).ok()?;
    let step = measured.force.len().div_ceil(MOST);
    let thinned = |values: Vec<f64>| curve(values.into_iter().step_by(step));
    Some(Loop {
        test,
        displacement: thinned(measured.displacement),
        force: thinned(measured.force),
    })
}
