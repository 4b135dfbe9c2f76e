//! The campaigns that qcar ships, fitted by compiled models: the truth comes back, and what cannot be known is said.

use models::find;
use qcar_runtime::campaign::{Campaign, Truth};
use qcar_runtime::error::InputError;
use qcar_runtime::fit::report::{NoError, ParameterFit};
use qcar_runtime::fit::{Fit, Plan, Setup, measure};
use qcar_runtime::model::Model;
use qcar_runtime::progress::NO_PROGRESS;
use std::path::{Path, PathBuf};

fn folder(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("models/campaigns")
        .join(name)
}

fn model(name: &str) -> &'static dyn Model {
    find(name).expect("qcar ships it").model
}

fn fit(campaign: &str, axle: &str, wanted: Option<&[String]>) -> Result<Fit, InputError> {
    let campaign = Campaign::open(folder(campaign))?;
    let plan = Plan::new(&campaign);
    let levels = measure::levels(&campaign, model(axle).about(), wanted, &Default::default(), NO_PROGRESS)?;
    Ok(Setup::new(model(axle), &plan, &levels)?.fit())
}

fn parameter<'a>(fit: &'a Fit, name: &str) -> &'a ParameterFit {
    fit.parameters.iter().find(|parameter| parameter.name == name).unwrap()
}

#[test]
fn what_is_stated_within_two_percent_is_within_three_of_the_truth() {
    let fit = fit("axle_a_rig", "axle_a", None).unwrap();
    let truth = Truth::read(&folder("axle_a_rig").join("truth.toml")).unwrap();
    assert!(fit.converged);
    let mut determined = 0;
    for (name, truth) in &truth.parameters {
        let found = parameter(&fit, name);
        if let Some(error) = found.relative_stderr {
            let deviation = found.value / truth - 1.0;
            assert!(
                error > 0.02 || deviation.abs() < 0.03,
                "{name} is off by {deviation}, stated {error}"
            );
            assert!(
                deviation.abs() < 3.0 * error,
                "{name} is off by {deviation}, stated {error}"
            );
            determined += usize::from(error <= 0.02);
        }
    }
    assert!(determined >= 6, "only {determined} parameters are well determined");
}

#[test]
fn the_body_is_met_on_every_run_fitted_or_not() {
    let fit = fit("axle_a_rig", "axle_a", None).unwrap();
    let body: Vec<_> = fit
        .channels
        .iter()
        .filter(|channel| channel.name == "pad_to_body")
        .collect();
    assert_eq!(
        body.iter().map(|channel| channel.role).collect::<Vec<_>>(),
        ["fit", "held_out", "fit"]
    );
    for channel in body {
        assert!(
            channel.quality.fit_magnitude > 95.0,
            "{} {}",
            channel.run,
            channel.quality.fit_magnitude
        );
    }
    assert!(
        fit.channels
            .iter()
            .all(|channel| channel.role == "fit" || !channel.fitted)
    );
}

#[test]
fn a_vertical_rig_says_nothing_of_the_longitudinal_parameters() {
    let fit = fit("axle_a_rig", "axle_a", None).unwrap();
    for name in ["k_wheel_x", "c_wheel_x", "k_pwt_x", "c_pwt_x"] {
        let unseen = parameter(&fit, name);
        assert_eq!((unseen.value, unseen.stderr), (unseen.start, None));
        assert_eq!(unseen.why_no_stderr, Some(NoError::NotSeen));
    }
    assert_eq!(parameter(&fit, "k_wheel_x_other").tied_to.as_deref(), Some("k_wheel_x"));
}

#[test]
fn an_electronic_resonator_rings_at_its_published_frequency() {
    let fit = fit("silverbox", "one_mass", None).unwrap();
    let value = |name: &str| parameter(&fit, name).value;
    let (m, c, k) = (value("m_body"), value("c_body"), value("k_body"));
    let frequency = (k / m).sqrt() / std::f64::consts::TAU;
    let damping = c / (2.0 * (k * m).sqrt());
    assert!((frequency - 69.5).abs() < 1.0, "{frequency} Hz");
    assert!((damping - 0.05).abs() < 0.01, "{damping}");
}

#[test]
fn channels_can_be_chosen_by_name() {
    let wanted = ["pad_to_wheel".to_owned(), "pad_to_body".to_owned()];
    let fit = fit("axle_a_rig", "axle_a", Some(&wanted)).unwrap();
    let mut fitted: Vec<&str> = fit
        .channels
        .iter()
        .filter(|c| c.fitted)
        .map(|c| c.name.as_str())
        .collect();
    fitted.dedup();
    assert_eq!(fitted, ["pad_to_wheel", "pad_to_body", "pad_to_wheel", "pad_to_body"]);
    let unknown = self::fit("axle_a_rig", "axle_a", Some(&["pad_to_roof".to_owned()]))
        .unwrap_err()
        .to_string();
    assert!(
        unknown.contains("`pad_to_roof`: found a channel that was not measured"),
        "{unknown}"
    );
    assert!(unknown.contains("`pad`, `wheel`, `body`, `pwt`"), "{unknown}");
}

#[test]
fn a_model_that_does_not_suit_the_campaign_is_refused_with_every_reason() {
    let said = fit("axle_a_rig", "quarter_car", None).unwrap_err().to_string();
    for part in [
        "campaign.toml, `m_pwt`: found this parameter",
        "`k_tm`",
        "`pwt` along z, expected a place of model",
    ] {
        assert!(said.contains(part), "{part}\nis not in\n{said}");
    }
    let said = fit("silverbox", "quarter_car", None).unwrap_err().to_string();
    assert!(said.contains("which excite model `quarter_car`"), "{said}");
}
