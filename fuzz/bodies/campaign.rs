//! Whatever its files contain, a campaign is opened and its runs are read, or it is refused with a message.

use std::fs;
use std::path::Path;

use qcar_runtime::campaign::workbook::Workbook;
use qcar_runtime::campaign::{Campaign, Test};
use qcar_runtime::error::InputError;

/// A campaign of a sweep, a slow curve and a cleat run whose files are all `table.csv`.
pub const MANIFEST: &str = r#"format = 1
name = "bench"
description = "A sweep, a curve and a cleat run"
model = "quarter_car"

[vehicle]
m_corner = "400 kg"

[parameters.k_tire]
value = 2.0e5
unit = "N/m"
range = [1.0e5, 4.0e5]
fit = true

[[channel]]
name = "pad_left_z"
location = "pad"
side = "left"
axis = "z"
quantity = "acceleration"
unit = "m/s^2"

[[channel]]
name = "body_left_z"
location = "body"
side = "left"
axis = "z"
quantity = "acceleration"
unit = "g"

[[run]]
kind = "sweep"
file = "table.csv"
role = "fit"
peak_velocity = 0.1
start_frequency = 0.5
end_frequency = 30.0
spacing = "logarithmic"
sample_rate = 100.0

[[run]]
kind = "bounce"
file = "table.csv"
role = "fit"

[[run]]
kind = "cleat"
file = "table.csv"
role = "held_out"
speed = "30 km/h"
sample_rate = 100.0
cleat = "step"

[[run]]
kind = "dynamic_bounce"
file = "table.csv"
role = "held_out"
peak_velocity = 0.075
amplitude = 0.02

[[road]]
name = "step"
file = "table.csv"
"#;

/// A table that has the columns of every run of the campaign.
pub const TABLE: &str = "time,pad_left_z,body_left_z,displacement,velocity,force,x,z,slope
0.00,0.0,0.1,0.000,0.1,0,0,0,0
0.01,0.5,0.2,0.001,0.1,25,0.5,0,0.1
0.02,-0.5,-0.3,0.002,-0.1,50,1,0.05,0
0.03,0.1,-0.1,0.001,-0.1,30,2,0,0
";

/// Fails if a manifest makes the reader panic.
pub fn survives_campaign(manifest: &[u8]) {
    opened(manifest, TABLE.as_bytes());
}

/// Fails if a table of samples makes the reader panic.
pub fn survives_table(table: &[u8]) {
    opened(MANIFEST.as_bytes(), table);
}

/// Fails if the workbook of a vehicle makes the reader panic.
pub fn survives_workbook(bytes: &[u8]) {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("vehicle.xlsx");
    fs::write(&file, bytes).unwrap();
    told(Workbook::read(&file, None).map(drop));
}

fn opened(manifest: &[u8], table: &[u8]) {
    let folder = tempfile::tempdir().unwrap();
    let put = |name: &str, bytes: &[u8]| fs::write(folder.path().join(name), bytes).unwrap();
    put("campaign.toml", manifest);
    put("table.csv", table);
    told(read(folder.path()));
}

/// Reads a campaign and all of its runs.
fn read(folder: &Path) -> Result<(), InputError> {
    let campaign = Campaign::open(folder)?;
    for run in &campaign.runs {
        told(match run.test {
            Test::Sweep(_) | Test::Cleat { .. } | Test::TimeHistory(_) => campaign.history(run).map(drop),
            Test::Bounce | Test::Longitudinal => campaign.curve(run).map(drop),
            Test::DynamicBounce { .. } => campaign.dynamic_curve(run).map(drop),
            Test::Dynamometer(_) => campaign.force_table(run).map(drop),
        });
    }
    for road in &campaign.roads {
        told(campaign.road(road).map(drop));
    }
    told(campaign.findings().map(drop));
    Ok(())
}

/// Checks that a refusal has a message.
fn told(outcome: Result<(), InputError>) {
    if let Err(error) = outcome {
        assert!(!error.to_string().is_empty());
    }
}
