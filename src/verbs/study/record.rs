//! Inputs of a study: runs and sensors of the campaign, and settings.

use qcar_runtime::campaign::{Campaign, Role, Run, Test};
use qcar_runtime::fit::Plan;
use serde::Serialize;

use super::gather::Study;

/// The record.
#[derive(Serialize)]
pub struct Record {
    description: String,
    model_doc: String,
    vehicle: Vec<(String, f64)>,
    sensors: Vec<Sensor>,
    runs: Vec<Listed>,
    /// Notices, as sentences.
    notices: Vec<String>,
    settings: Settings,
    version: &'static str,
    seconds: f64,
}

#[derive(Serialize)]
struct Sensor {
    name: String,
    location: String,
    axis: String,
    quantity: &'static str,
}

#[derive(Serialize)]
struct Listed {
    file: String,
    role: &'static str,
    kind: &'static str,
    /// Excitation of the run.
    drive: Vec<Drive>,
}

/// A property of a run's excitation.
#[derive(Serialize)]
struct Drive {
    what: String,
    value: f64,
    unit: &'static str,
}

#[derive(Serialize)]
struct Settings {
    starts: usize,
    /// Relative standard deviation of a sensor's gain.
    gain_error: f64,
}

/// The record of a study.
pub fn record(of: &Study) -> Record {
    let campaign = &of.fitted.campaign;
    let plan = Plan::new(campaign);
    let notices = campaign.notices.iter().chain(&of.answer.evidence.notices);
    Record {
        description: campaign.description.clone(),
        model_doc: of.fitted.model.about().doc.to_string(),
        vehicle: campaign.vehicle.clone(),
        sensors: sensors(campaign),
        runs: campaign.runs.iter().map(listed).collect(),
        notices: notices.cloned().collect(),
        settings: Settings {
            starts: of.fitted.fit.starts,
            gain_error: plan.gain_error,
        },
        version: env!("CARGO_PKG_VERSION"),
        seconds: of.seconds,
    }
}

fn sensors(of: &Campaign) -> Vec<Sensor> {
    let sensor = |channel: &qcar_runtime::campaign::Channel| Sensor {
        name: channel.name.clone(),
        location: channel.location.clone(),
        axis: channel.axis.name().into(),
        quantity: channel.quantity.name(),
    };
    of.channels.iter().map(sensor).collect()
}

fn listed(run: &Run) -> Listed {
    let (kind, drive) = match &run.test {
        Test::Sweep(sweep) => (
            "sweep",
            vec![
                drive("peak", sweep.peak_velocity, "m/s"),
                drive("from", sweep.start_frequency, "Hz"),
                drive("to", sweep.end_frequency, "Hz"),
            ],
        ),
        Test::Bounce => ("quasi-static bounce", Vec::new()),
        Test::DynamicBounce {
            peak_velocity,
            amplitude,
        } => (
            "dynamic bounce",
            vec![
                drive("peak", *peak_velocity, "m/s"),
                drive("amplitude", *amplitude, "m"),
            ],
        ),
        Test::Longitudinal => ("quasi-static longitudinal", Vec::new()),
        Test::Cleat { speed, cleat, .. } => ("cleat", vec![drive(&format!("over {cleat} at"), 3.6 * speed, "km/h")]),
        Test::Dynamometer(test) => ("dynamometer", vec![drive("amplitude", test.amplitude, "m")]),
        Test::TimeHistory(recording) => ("time history", vec![drive("sampled at", recording.sample_rate, "Hz")]),
    };
    Listed {
        file: run.name.clone(),
        role: if run.role == Role::Fit { "fit" } else { "held_out" },
        kind,
        drive,
    }
}

fn drive(what: &str, value: f64, unit: &'static str) -> Drive {
    Drive {
        what: what.into(),
        value,
        unit,
    }
}
