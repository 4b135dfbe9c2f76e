//! Simulated rides as text, JSON and CSV.

use std::fmt::Write;
use std::path::Path;

use qcar_runtime::campaign::Campaign;
use qcar_runtime::compare::Summary;
use qcar_runtime::error::InputError;
use qcar_runtime::model::About;
use qcar_runtime::simulate::Ride;
use serde::Serialize;

use super::compared::{Compared, Difference};
use super::{Cleat, Loaded};
use crate::files::put;
use crate::json;
use crate::table::{Table, number};

#[derive(Serialize)]
struct Result<'a> {
    campaign: &'a str,
    model: &'a str,
    at_start: &'a [String],
    #[serde(flatten)]
    compared: &'a Compared,
}

pub(super) fn json(campaign: &Campaign, model: &Loaded, of: &Compared, guessed: &[String]) -> String {
    json::line(&Result {
        campaign: &campaign.name,
        model: &model.about().name,
        at_start: guessed,
        compared: of,
    })
}

pub(super) fn text(of: &Compared, guessed: &[String]) -> String {
    let mut runs = Table::new([
        "run",
        "role",
        "mass",
        "axis",
        "peak",
        "peak_error_%",
        "after_shake",
        "after_shake_error_%",
    ]);
    for d in &of.runs {
        let numbers = [
            number(d.measured_peak, 4),
            percent(d.peak_error),
            number(d.measured_after_shake, 3),
            percent(d.after_shake_error),
        ];
        let place = [d.run.clone(), d.role.into(), d.mass.clone(), d.axis.into()];
        runs.row(place.into_iter().chain(numbers).collect());
    }
    let mut sizes = Table::new([
        "mass_axis",
        "peak_median_%",
        "peak_worst_%",
        "after_shake_median_%",
        "after_shake_worst_%",
    ]);
    for (name, size) in &of.summary {
        let cells = [size.peak, size.after_shake].into_iter().flat_map(median_and_worst);
        sizes.row(std::iter::once(name.clone()).chain(cells).collect());
    }
    let notices: String = of.notices.iter().map(|notice| format!("\nnote: {notice}\n")).collect();
    format!("{}\n{}{notices}{}", runs.text(), sizes.text(), note(guessed))
}

fn note(guessed: &[String]) -> String {
    match guessed {
        [] => String::new(),
        names => format!(
            "\nnote: at the campaign's start values: {}; what depends on them is as good as these. `qcar discover --out` \
             finds those that cleat runs with the role fit determine\n",
            names.join(", ")
        ),
    }
}

fn median_and_worst(of: Option<Summary>) -> [String; 2] {
    of.map_or(["-".into(), "-".into()], |s| [percent(s.median), percent(s.worst)])
}

fn percent(part: f64) -> String {
    if part.is_finite() {
        format!("{:.1}", 100.0 * part)
    } else {
        "-".into()
    }
}

/// The errors, a row for each run, mass and axis.
pub(crate) fn csv(of: &Compared) -> String {
    let head = "run,role,mass,axis,measured_peak,simulated_peak,peak_error,\
                measured_after_shake,simulated_after_shake,after_shake_error\n";
    let row = |d: &Difference| {
        let Difference {
            run, role, mass, axis, ..
        } = d;
        let peaks = format!("{},{},{}", d.measured_peak, d.simulated_peak, d.peak_error);
        let shakes = format!(
            "{},{},{}",
            d.measured_after_shake, d.simulated_after_shake, d.after_shake_error
        );
        format!("{run},{role},{mass},{axis},{peaks},{shakes}\n")
    };
    head.to_string() + &of.runs.iter().map(row).collect::<String>()
}

/// A CSV for each run: time, the outputs of the model, the tyre's forces and contact area.
///
/// # Errors
/// A folder that cannot be written to.
pub(crate) fn histories(
    about: &About,
    cleats: &[Cleat],
    rides: &[Ride],
    folder: &Path,
) -> std::result::Result<(), InputError> {
    for (cleat, ride) in cleats.iter().zip(rides) {
        let stem = Path::new(&cleat.run.file)
            .file_name()
            .and_then(|name| name.to_str())
            .unwrap_or("run");
        let stem = stem.trim_end_matches(".gz").trim_end_matches(".csv");
        put(folder, &format!("{stem}.csv"), &history(about, ride))?;
    }
    Ok(())
}

fn history(about: &About, ride: &Ride) -> String {
    let names: String = about.outputs.iter().map(|output| format!(",{}", output.name)).collect();
    let mut out = format!("time{names},tire_force_z,tire_force_x,contact_area\n");
    for (at, time) in ride.time.iter().enumerate() {
        let outputs: String = ride.outputs.iter().map(|output| format!(",{}", output[at])).collect();
        let [force_z, force_x] = [ride.force[0][at], ride.force[1][at]];
        let _ = writeln!(out, "{time}{outputs},{force_z},{force_x},{}", ride.area[at]);
    }
    out
}
