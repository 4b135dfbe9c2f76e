//! Which of two sensors, one on each side of the car, has the gain error that a search found in their mean.

use qcar_dsl::patch::{Signal, SignalChange};
use qcar_runtime::campaign::{Campaign, Channel, History, Quantity, Side};
use qcar_runtime::discover::answer::Finding;
use qcar_runtime::mean::{mean, mean_square};

use crate::table::number;

/// A sensor's error is that of one side if it is this many times the other's. A choice.
const CLEARLY: f64 = 2.0;

/// A sentence for an error of a sensor's gain, if the signals of both sides show which sensor has it. A search compares
/// the mean of the two with the model.
pub(super) fn wrong_side(finding: &Finding, error: &SignalChange, campaign: &Campaign) -> Option<String> {
    if error.kind != Signal::Gain {
        return None;
    }
    let (_, gain, _) = finding.parameters.iter().find(|(name, ..)| *name == error.parameter)?;
    let is_it = |channel: &Channel| channel.location == error.location && channel.axis.name() == error.axis;
    // A K&C curve is no record.
    let histories = campaign.runs.iter().filter_map(|run| campaign.history(run).ok());
    let (channel, [left, right]) = levels(histories, is_it)?;
    let factors = [left, right].map(|level| gain * 2.0 * level / (left + right));
    let errors = factors.map(|factor| (factor - 1.0).abs());
    let side = match errors {
        [left, right] if left > CLEARLY * right => Side::Left,
        [left, right] if right > CLEARLY * left => Side::Right,
        _ => return None,
    };
    let [left, right] = factors.map(|factor| number(factor, 4));
    Some(format!(
        "{}_{}: compared with the model, the left sensor reads {left} times the true value and the right one {right} times: \
         check the {} one",
        channel.location,
        channel.axis.name(),
        side.name()
    ))
}

/// RMS of the sensors of both sides, without their offsets, over all runs that recorded both, of the first quantity
/// that has both sides.
fn levels(histories: impl Iterator<Item = History>, is_it: impl Fn(&Channel) -> bool) -> Option<(Channel, [f64; 2])> {
    let mut found: Option<(Channel, [f64; 2])> = None;
    for history in histories {
        let of_side = |side: Side, quantity: Option<Quantity>| {
            history.signals.iter().find(|(own, _)| {
                own.side == side && is_it(own) && quantity.is_none_or(|quantity| quantity == own.quantity)
            })
        };
        let quantity = found.as_ref().map(|(channel, _)| channel.quantity);
        let Some((left, left_samples)) = of_side(Side::Left, quantity) else {
            continue;
        };
        let Some((_, right_samples)) = of_side(Side::Right, Some(left.quantity)) else {
            continue;
        };
        let squares = [left_samples, right_samples].map(|samples| {
            let offset = mean(samples);
            mean_square(samples.iter().map(|sample| sample - offset))
        });
        let (_, sums) = found.get_or_insert((left.clone(), [0.0; 2]));
        (0..2).for_each(|side| sums[side] += squares[side]);
    }
    found.map(|(channel, sums)| (channel, sums.map(f64::sqrt)))
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    /// A sweep whose left sensor reads more than the right one by this factor, and has an offset.
    fn campaign(folder: &std::path::Path, factor: f64) -> Campaign {
        let channel = |name: &str, location: &str, side: &str| {
            format!(
                "[[channel]]\nname = \"{name}\"\nlocation = \"{location}\"\nside = \"{side}\"\naxis = \"z\"\n\
                 quantity = \"acceleration\"\nunit = \"m/s^2\"\n"
            )
        };
        let channels =
            channel("pad_z", "pad", "centre") + &channel("a", "wheel", "left") + &channel("b", "wheel", "right");
        let run = "[[run]]\nkind = \"sweep\"\nfile = \"sweep.csv\"\nrole = \"fit\"\npeak_velocity = 0.1\n\
                   start_frequency = 1.0\nend_frequency = 20.0\nspacing = \"logarithmic\"\nsample_rate = 100.0\n";
        let head = "format = 1\nname = \"sides\"\nmodel = \"quarter_car\"\n";
        fs::write(folder.join("campaign.toml"), format!("{head}{channels}{run}")).unwrap();
        let row = |k: usize| {
            let reading = (k as f64).sin();
            format!(
                "{:.2},{reading},{},{reading}\n",
                0.01 * k as f64,
                0.5 + factor * reading
            )
        };
        let rows: String = (0..200).map(row).collect();
        fs::write(folder.join("sweep.csv"), format!("time,pad_z,a,b\n{rows}")).unwrap();
        Campaign::open(folder).unwrap()
    }

    fn said(factor: f64, gain: f64) -> Option<String> {
        let folder = tempfile::tempdir().unwrap();
        let finding = Finding {
            effect: "sensor_gain".into(),
            at: "wheel".into(),
            form: None,
            alternative: None,
            parameters: vec![("gain".into(), gain, 0.01)],
            evidence: 30.0,
            explained: None,
            rivals: Vec::new(),
        };
        let error = SignalChange {
            location: "wheel".into(),
            axis: "z".into(),
            kind: Signal::Gain,
            parameter: "gain".into(),
        };
        wrong_side(&finding, &error, &campaign(folder.path(), factor))
    }

    /// The mean of a sensor that reads 12 % too much and a right one is 6 % too large. If both read 6 % too much, neither
    /// is the wrong one.
    #[test]
    fn the_sensor_that_differs_from_the_model_is_named() {
        let left = said(1.12, 1.06).unwrap();
        assert!(
            left.contains("the left sensor reads 1.12 times") && left.ends_with("check the left one"),
            "{left}"
        );
        let right = said(1.0 / 0.9, 0.95).unwrap();
        assert!(
            right.contains("the right one 0.9 times") && right.ends_with("check the right one"),
            "{right}"
        );
        assert_eq!(said(1.0, 1.06), None);
    }
}
