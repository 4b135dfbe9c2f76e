//! The residuals of a model: where they are, which place explains them, and what changed in the model.

use qcar_dsl::difference::{Difference, difference};
use qcar_runtime::campaign::Test;
use qcar_runtime::discover::MissingStiffness;
use qcar_runtime::discover::observe::Kind;
use qcar_runtime::discover::posterior::Tile;
use serde::Serialize;

use super::gather::Study;
use crate::report::rounded::{curve, rounded};
use crate::verbs::discover::places::{Site, sites};

/// A part of the residual.
#[derive(Serialize)]
pub struct Patch {
    channel: String,
    /// Kind: `harmonic`, `time`, `passage`, `travel`, `width` or `cycle`.
    kind: &'static str,
    harmonic: Option<usize>,
    /// Position: Hz for a harmonic, m for a travel, otherwise s.
    span: (f64, f64),
    /// File of the run.
    run: String,
    /// Level in the unit of the run: m/s for a sweep.
    level: f64,
    /// Speed over an obstacle, m/s.
    speed: Option<f64>,
    /// RMS of the normalised residuals.
    strength: f64,
}

/// Missing dynamic stiffness at a place.
#[derive(Serialize)]
pub struct Explanation {
    /// Name of the place.
    place: String,
    sensor: bool,
    /// Share of the squared residual that a κ free in every run explains, and that a common κ explains.
    ceiling: f64,
    common: f64,
    runs: Vec<Stiffness>,
}

/// κ in one run.
#[derive(Serialize)]
struct Stiffness {
    level: f64,
    /// Frequencies, Hz.
    frequency: Vec<f64>,
    /// κ, N/m; without unit for a sensor.
    real: Vec<f64>,
    imaginary: Vec<f64>,
    sigma: Vec<f64>,
}

/// All parts, largest first.
pub fn patches(of: &Study, tiles: &[Tile]) -> Vec<Patch> {
    let patch = |tile: &Tile| Patch {
        run: of.answer.evidence.runs[tile.run].name.clone(),
        speed: speed(of, &of.answer.evidence.runs[tile.run].name),
        channel: format!("{} {}", tile.sensor.place(), tile.sensor.axis.name()),
        kind: match tile.kind {
            Kind::Harmonic(_) => "harmonic",
            Kind::Time => "time",
            Kind::Passage => "passage",
            Kind::Travel => "travel",
            Kind::Width => "width",
            Kind::Speed => "speed",
            Kind::Cycle(_) => "cycle",
        },
        harmonic: tile.kind.order(),
        span: (rounded(tile.span.0), rounded(tile.span.1)),
        level: tile.level,
        strength: rounded(tile.strength),
    };
    tiles.iter().map(patch).collect()
}

/// Speed of a run over an obstacle, m/s; `None` for other runs.
fn speed(of: &Study, file: &str) -> Option<f64> {
    let run = of.fitted.campaign.runs.iter().find(|run| run.name == file)?;
    match &run.test {
        Test::Cleat { speed, .. } => Some(*speed),
        _ => None,
    }
}

/// A parameter in the search and its value with the findings.
#[derive(Serialize)]
pub struct Refitted {
    name: String,
    value: f64,
    /// Standard error; `None` if it was not fitted or is not determined.
    stderr: Option<f64>,
}

/// The parameters of the extended model; none if no effect was found.
pub fn refitted(of: &Study) -> Vec<Refitted> {
    let Some(after) = &of.after else { return Vec::new() };
    let explanation = &of.answer.discovery.after;
    let errors = explanation.refit.stderr();
    let error = |place: usize| {
        let free = explanation.refit.free.iter().position(|free| free.parameter == place)?;
        Some(errors[free]).filter(|error| error.is_finite())
    };
    let parameters = after.model.about().parameters.iter().enumerate();
    let refitted = parameters.map(|(place, parameter)| Refitted {
        name: parameter.name.to_string(),
        value: after.values.as_slice()[place],
        stderr: error(place),
    });
    refitted.collect()
}

/// Number of places whose κ is shown.
const SHOWN: usize = 8;

/// The places that explain the residuals of the sweeps best; empty without sweeps.
pub fn explanations(of: &Study) -> Vec<Explanation> {
    let explanation = |(site, kappa): (Site, &MissingStiffness)| Explanation {
        place: site.name(),
        sensor: site.sensor.is_some(),
        ceiling: rounded(kappa.ceiling),
        common: rounded(kappa.common),
        runs: kappa.runs.iter().map(stiffness).collect(),
    };
    sites(&of.answer).into_iter().take(SHOWN).map(explanation).collect()
}

fn stiffness(of: &qcar_runtime::discover::locate::RunStiffness) -> Stiffness {
    Stiffness {
        level: of.level,
        frequency: curve(of.frequency.iter().copied()),
        real: curve(of.value.iter().map(|value| value.re)),
        imaginary: curve(of.value.iter().map(|value| value.im)),
        sigma: curve(of.sigma.iter().copied()),
    }
}

/// Differences of the extended model.
pub fn changes(of: &Study) -> Option<Difference> {
    of.after
        .as_ref()
        .map(|after| difference(&of.compiled.model, &after.compiled.model))
}
