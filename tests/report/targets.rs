//! The report of targets: all that is promised is drawn, and the measured car lies beside both axles.

use std::fs::File;
use std::io::Read;

use flate2::read::GzDecoder;
use serde_json::Value;

use super::browser::{browser_or_word, look};
use super::studied::Studied;
use super::{OTHER_PAGES, PAGES, check, page, sliders, strings};

/// What of a report of targets is drawn.
const DRAWN: [&str; 3] = ["front", "cut", "ride"];

#[test]
fn targets_are_whole_in_a_browser() {
    are_whole(PAGES);
}

#[test]
#[ignore = "a browser for each of more pages; .ci/run runs it"]
fn targets_are_whole_in_a_browser_in_other_ways() {
    are_whole(OTHER_PAGES);
}

fn are_whole(pages: [(u64, &str); 2]) {
    let Some(browser) = browser_or_word() else { return };
    let page = page(&Studied::targets());
    for (width, theme) in pages {
        let found = look(&browser, &page, width, theme);
        let place = format!("{width} px, {theme}: {found}");
        check(&found, (width, &place), &DRAWN);
        assert_eq!(found["sections"].as_array().unwrap().len(), 6, "{place}");
        let curves: Vec<&str> = strings(&found["legends"]["ride"]);
        for curve in ["measured", "today", "design"] {
            assert!(curves.contains(&curve), "no {curve} in {curves:?} at {place}");
        }
        assert_eq!(found["renamed"], Value::Array(Vec::new()), "{place}");
        sliders::check_design(&found["tried"]);
    }
}

/// Metrics follow a slider by their elasticities, whether the page can compute responses or, as of a nonlinear model,
/// not.
#[test]
fn a_slider_moves_estimates_of_the_targets() {
    let Some(browser) = browser_or_word() else { return };
    let linear = page(&Studied::targets());
    let nonlinear = linear.replace("const PROGRAM = ", "const PROGRAM = null;\nconst UNUSED = ");
    assert_ne!(linear, nonlinear);
    let data = data_of(&linear);
    let (targets, parameters) = (&data["targets"], &data["parameters"]);
    for page in [&linear, &nonlinear] {
        let tried = &look(&browser, page, 1280, "light")["tried"];
        let [before, after, reset] = [0, 1, 2].map(|at| strings(&tried["estimates"][at]));
        assert_eq!(before.len(), targets.as_array().unwrap().len(), "{tried}");
        assert_eq!(before, reset);
        let labels = strings(&tried["labels"]);
        let moved = labels.iter().position(|own| *own == "k_wheel_z").unwrap_or(0);
        let [low, high] = [0, 1].map(|end| parameters[moved]["range"][end].as_f64().unwrap());
        let part = 0.5 * (low + high) / parameters[moved]["design"].as_f64().unwrap();
        for (at, (before, after)) in before.iter().zip(&after).enumerate() {
            let expected = part.powf(data["elasticities"][at][moved].as_f64().unwrap());
            // Both have three digits.
            assert!(
                (shown(after) / shown(before) / expected - 1.0).abs() < 0.01,
                "{before}, {after}"
            );
        }
    }
}

/// Elasticities of the targets of one metric have the mean that the tornado shows.
#[test]
fn elasticities_of_targets_are_those_of_their_metrics() {
    let data = data_of(&page(&Studied::targets()));
    let targets = data["targets"].as_array().unwrap();
    for own in data["sensitivity"].as_array().unwrap() {
        for (k, parameter) in data["parameters"].as_array().unwrap().iter().enumerate() {
            let of = (0..targets.len()).filter(|&at| targets[at]["metric"] == own["metric"]);
            let all: Vec<f64> = of.map(|at| data["elasticities"][at][k].as_f64().unwrap()).collect();
            let mean = all.iter().sum::<f64>() / all.len() as f64;
            let shown = own["elasticities"][parameter["name"].as_str().unwrap()]
                .as_f64()
                .unwrap();
            assert!((mean - shown).abs() < 1e-8, "{own}: {mean}");
        }
    }
}

fn data_of(page: &str) -> Value {
    let data = page.split("id=\"data\">").nth(1).unwrap();
    serde_json::from_str(data.split("</script>").next().unwrap()).unwrap()
}

/// The number before a unit.
fn shown(text: &str) -> f64 {
    let number = text.split('\u{202f}').next().unwrap();
    number.replace('−', "-").parse().unwrap()
}

/// The curves of the measured car are those of the campaign's files, all of a run delayed by the same number of
/// samples, and that delay is the one at which the wheel agrees best with today's axle.
#[test]
fn the_measured_car_lies_beside_both_axles() {
    let data = data_of(&page(&Studied::targets()));
    let rides = data["rides"].as_array().unwrap();
    assert_eq!(rides.len(), 3);
    for ride in rides {
        let run = ride["run"].as_str().unwrap();
        let file = File::open(format!("models/campaigns/axle_a_rig/{run}")).unwrap();
        let mut table = String::new();
        GzDecoder::new(file).read_to_string(&mut table).unwrap();
        let today = |trace: &str| numbers(&trace_of(ride, trace)["today"]);
        let delay = best_delay(&column(&table, "wheel_left_z"), &today("wheel z"));
        for (sensor, trace) in SENSORS {
            let (file, shown) = (column(&table, sensor), numbers(&trace_of(ride, trace)["measured"]));
            assert_eq!(shown.len(), today(trace).len(), "{run}, {sensor}");
            let shift = (-MOST..=MOST).find(|&by| delayed(&file, by, shown.len()) == shown);
            let shift = shift.unwrap_or_else(|| panic!("{run}: {sensor} is not what was measured"));
            assert!(
                (shift - delay).abs() <= 3,
                "{run}, {sensor}: {shift} samples, best {delay}"
            );
        }
        assert_eq!(
            trace_of(ride, "tm z")["measured"],
            Value::Null,
            "{run}: without a sensor"
        );
    }
}

/// Sensors of the campaign, and what they measure.
const SENSORS: [(&str, &str); 6] = [
    ("wheel_left_z", "wheel z"),
    ("body_left_z", "body z"),
    ("pwt_centre_z", "pwt z"),
    ("wheel_left_x", "wheel x"),
    ("body_left_x", "body x"),
    ("pwt_centre_x", "pwt x"),
];

/// Samples by which a record is delayed, at the most.
const MOST: isize = 50;

fn trace_of<'a>(ride: &'a Value, named: &str) -> &'a Value {
    let is = |own: &&Value| format!("{} {}", own["mass"].as_str().unwrap(), own["axis"].as_str().unwrap()) == named;
    ride["traces"].as_array().unwrap().iter().find(is).unwrap()
}

fn numbers(list: &Value) -> Vec<f64> {
    list.as_array()
        .unwrap()
        .iter()
        .map(|own| own.as_f64().unwrap())
        .collect()
}

fn column(table: &str, name: &str) -> Vec<f64> {
    let mut lines = table.lines();
    let place = lines.next().unwrap().split(',').position(|own| own == name).unwrap();
    lines
        .map(|line| line.split(',').nth(place).unwrap().parse().unwrap())
        .collect()
}

/// A record that begins later, at rest outside.
fn delayed(record: &[f64], by: isize, samples: usize) -> Vec<f64> {
    let at = |sample: usize| usize::try_from(sample as isize - by).ok();
    let value = |sample: usize| at(sample).and_then(|sample| record.get(sample).copied());
    (0..samples).map(|sample| value(sample).unwrap_or(0.0)).collect()
}

/// The delay of a record by which it differs least from another, in squares.
fn best_delay(record: &[f64], from: &[f64]) -> isize {
    let difference = |by: isize| -> f64 {
        let record = delayed(record, by, from.len());
        record.iter().zip(from).map(|(a, b)| (a - b).powi(2)).sum()
    };
    let delays = -MOST..=MOST;
    delays.min_by(|a, b| difference(*a).total_cmp(&difference(*b))).unwrap()
}
