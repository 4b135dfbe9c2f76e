//! A fit to the model's own response.

use crate::subject::{MODEL, Subject, frequency};
use nalgebra::Complex;
use qcar_runtime::campaign::{Parameter, Role};
use qcar_runtime::fit::{Level, Observation, Plan, Weighting};

/// Twelve parameters are free, from starts 20 % off.
pub fn plan() -> Plan {
    let subject = Subject::new(MODEL);
    let parameter = |(about, &value): (&qcar_runtime::model::Parameter, &f64)| Parameter {
        name: about.name.to_string(),
        value: if about.known { value } else { 1.2 * value },
        unit: about.unit.to_string(),
        range: (!about.known).then_some((0.5 * value, 2.0 * value)),
        fit: !about.known,
        comment: String::new(),
    };
    Plan {
        source: "benches".into(),
        parameters: MODEL.about().parameters.iter().zip(&subject.p).map(parameter).collect(),
        vehicle: Default::default(),
        channels: Default::default(),
        weighting: Weighting::Thesis,
        starts: 1,
        seed: 0,
        gain_error: 0.0,
    }
}

/// The model's own response as a measurement.
pub fn level() -> Level {
    let mut subject = Subject::new(MODEL);
    subject.respond();
    let about = MODEL.about();
    let of_pad = about
        .channels
        .iter()
        .filter(|channel| channel.denominator.location == "pad");
    let observations = of_pad.map(|channel| {
        let output = about
            .outputs
            .iter()
            .position(|output| output.signal == channel.numerator);
        let output = output.expect("every numerator is an output");
        let row = about.responses[0]
            .outputs
            .iter()
            .position(|&responds| usize::from(responds) == output);
        let row = row.expect("every output responds to the pad");
        observation(channel.clone(), &subject, row)
    });
    Level {
        name: "model".into(),
        role: Role::Fit,
        excitation: 0,
        observations: observations.collect(),
    }
}

/// The acceleration over that of the pad, which is `-ω²` for a unit of displacement.
fn observation(channel: qcar_runtime::model::Channel, subject: &Subject, row: usize) -> Observation {
    let value = |(line, omega): (usize, &f64)| {
        let at = row * subject.omega.len() + line;
        Complex::new(subject.response[0][at], subject.response[1][at]) / -(omega * omega)
    };
    Observation {
        channel,
        fitted: true,
        frequency: (0..subject.omega.len()).map(frequency).collect(),
        value: subject.omega.iter().enumerate().map(value).collect(),
        relative_variance: vec![0.0; subject.omega.len()],
        coherence: vec![1.0; subject.omega.len()],
        band: (0.5, 30.0),
        sensors: (1, 1),
        differences: Vec::new(),
    }
}
