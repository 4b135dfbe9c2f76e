//! What a study was made from: the campaign's runs and sensors, and the settings.

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
    /// What was odd, as sentences.
    notices: Vec<String>,
    settings: Settings,
    version: &'static str,
    seconds: f64,
}

#[derive(Serialize)]
struct Sensor {
    name: String,
    location: String,
    axis: &'static str,
    quantity: &'static str,
}

#[derive(Serialize)]
struct Listed {
    file: String,
    role: &'static str,
    kind: &'static str,
    /// How it was driven.
    drive: String,
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
        axis: channel.axis.name(),
        quantity: channel.quantity.name(),
    };
    of.channels.iter().map(sensor).collect()
}

fn listed(run: &Run) -> Listed {
    let (kind, drive) = match &run.test {
        Test::Sweep(sweep) => (
            "sweep",
            format!(
                "{} m/s peak, {} to {} Hz",
                sweep.peak_velocity, sweep.start_frequency, sweep.end_frequency
            ),
        ),
        Test::Bounce => ("bounce", "quasi-static cycle".into()),
        Test::DynamicBounce {
            peak_velocity,
            amplitude,
        } => ("dynamic bounce", format!("{peak_velocity} m/s peak, {amplitude} m")),
        Test::Longitudinal => ("longitudinal", "quasi-static cycle".into()),
        Test::Cleat { speed, cleat, .. } => ("cleat", format!("{:.1} km/h over {cleat}", 3.6 * speed)),
        Test::TimeHistory(recording) => ("time history", format!("{} Hz", recording.sample_rate)),
    };
    Listed {
        file: run.file.clone(),
        role: if run.role == Role::Fit { "fit" } else { "held_out" },
        kind,
        drive,
    }
}
