//! One campaign of the repository, its sweeps written in every format, gives the same fit from each.

use std::fs;
use std::path::Path;
use std::process::Command;
use std::sync::LazyLock;

use qcar_runtime::campaign::{Campaign, Test};
use serde_json::Value;

use crate::writers::{Channel, Group, mat5, mat73, mdf3, mdf4, rpc, tables, tdms, uff};

const ORIGINAL: &str = "models/campaigns/axle_a_rig";
const G: f64 = 9.80665;

/// What the rig calls its sensors; a sensor that hangs upside down records the negative.
const NAMES: [(&str, &str, f64); 7] = [
    ("pad_left_z", "FL_Pad_Acc_Z", 1.0),
    ("pad_right_z", "FR_Pad_Acc_Z", 1.0),
    ("wheel_left_z", "FL_Hub_Acc_Z", 1.0),
    ("wheel_right_z", "FR_Hub_Acc_Z", -1.0),
    ("body_left_z", "FL_Body_Acc_Z", 1.0),
    ("body_right_z", "FR_Body_Acc_Z", 1.0),
    ("pwt_centre_z", "Engine_Acc_Z", 1.0),
];

/// The mapping that the campaigns of all formats share.
pub fn mapping() -> String {
    let section = |(name, source, sign): &(&str, &str, f64)| {
        let (location, rest) = name.split_once('_').unwrap();
        let side = rest.trim_end_matches("_z");
        // A pattern means the only channel that fits it.
        let source = source.replace("Engine", "*gine");
        format!(
            "[[channel]]\nname = \"{name}\"\nlocation = \"{location}\"\nside = \"{side}\"\naxis = \"z\"\n\
             quantity = \"acceleration\"\nsource = \"{source}\"\nunit = \"g\"\nsign = {sign}\n\n"
        )
    };
    NAMES.iter().map(section).collect()
}

/// The sweeps of the original in g, each with its number in the names of files: read once for all tests.
pub fn sweeps() -> &'static [Group] {
    static SWEEPS: LazyLock<Vec<Group>> = LazyLock::new(read_sweeps);
    &SWEEPS
}

fn read_sweeps() -> Vec<Group> {
    let campaign = Campaign::open(ORIGINAL).unwrap();
    let sweeps = campaign.runs.iter().filter(|run| matches!(run.test, Test::Sweep(_)));
    sweeps
        .map(|run| {
            let history = campaign.history(run).unwrap();
            let channel = |(name, source, sign): &(&str, &str, f64)| {
                let samples = history.signal(name).unwrap().iter().map(|value| sign * value / G);
                Channel::new(source, "g", samples.collect())
            };
            Group::at(history.sample_rate, NAMES.iter().map(channel).collect())
        })
        .collect()
}

/// A campaign with these files as its sweeps. No rate is stated: it is that of the files.
pub fn campaign(folder: &Path, ending: &str, file: impl Fn(&Group) -> Vec<u8>) {
    let original = fs::read_to_string(Path::new(ORIGINAL).join("campaign.toml")).unwrap();
    let head = original.split("[[channel]]").next().unwrap();
    let mut text = head.replace("[vehicle]", "mapping = \"../rig.toml\"\n\n[vehicle]");
    let levels = [("0.025", "fit"), ("0.05", "held_out"), ("0.1", "fit")];
    for (number, ((velocity, role), sweep)) in levels.iter().zip(sweeps()).enumerate() {
        fs::write(folder.join(format!("sweep_{number}.{ending}")), file(sweep)).unwrap();
        text += &format!(
            "[[run]]\nkind = \"sweep\"\nfile = \"sweep_{number}.{ending}\"\nrole = \"{role}\"\npeak_velocity = {velocity}\n\
             start_frequency = 0.5\nend_frequency = 30.0\nspacing = \"logarithmic\"\n\n"
        );
    }
    fs::write(folder.join("campaign.toml"), text).unwrap();
}

/// Name, value and standard error of each parameter that was fitted.
type Fitted = Vec<(String, f64, f64)>;

fn fitted(folder: &Path) -> Fitted {
    let arguments = ["fit", folder.to_str().unwrap(), "--starts", "1", "--format", "json"];
    let output = Command::new(env!("CARGO_BIN_EXE_qcar"))
        .args(arguments)
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let result: Value = serde_json::from_slice(&output.stdout).unwrap();
    let parameters = result["parameters"].as_object().unwrap().iter();
    let fitted =
        parameters.filter_map(|(name, own)| Some((name.clone(), own["value"].as_f64()?, own["stderr"].as_f64()?)));
    fitted.collect()
}

/// The fit of a campaign in some format.
fn fit_of(ending: &str, file: impl Fn(&Group) -> Vec<u8>) -> Fitted {
    let folder = tempfile::tempdir().unwrap();
    let own = folder.path().join(ending);
    fs::create_dir(&own).unwrap();
    fs::write(folder.path().join("rig.toml"), mapping()).unwrap();
    campaign(&own, ending, file);
    fitted(&own)
}

/// The fit of the original without its other runs, whose K&C curves give starts: made once for all formats.
static PLAIN: LazyLock<Fitted> = LazyLock::new(|| {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("rig")).unwrap();
    let text = fs::read_to_string(Path::new(ORIGINAL).join("campaign.toml")).unwrap();
    let sweeps = text.split("[[run]]\nkind = \"bounce\"").next().unwrap();
    fs::write(folder.path().join("campaign.toml"), sweeps).unwrap();
    for entry in fs::read_dir(Path::new(ORIGINAL).join("rig")).unwrap().flatten() {
        fs::copy(entry.path(), folder.path().join("rig").join(entry.file_name())).unwrap();
    }
    fitted(folder.path())
});

/// Values in g are rounded once more than those in m/s^2, by 1e-16; the search ends where its own limit of 1e-9 or less
/// has been reached, from the same start.
const SAME: f64 = 1e-9;

fn same(ending: &str, file: impl Fn(&Group) -> Vec<u8>) {
    let own = fit_of(ending, file);
    assert!(own.len() >= 8 && own.len() == PLAIN.len(), "{own:?} {:?}", *PLAIN);
    for ((name, value, _), (same_name, original, _)) in own.iter().zip(&*PLAIN) {
        assert_eq!(name, same_name);
        assert!(
            (value / original - 1.0).abs() < SAME,
            "{ending}: {name} is {value}, not {original}"
        );
    }
}

#[test]
fn mdf4_gives_the_same_fit() {
    same("mf4", |group| mdf4::file(std::slice::from_ref(group)));
}

#[test]
fn mdf3_gives_the_same_fit() {
    same("mdf", mdf3::file);
}

#[test]
fn uff_58_gives_the_same_fit() {
    same("uff", uff::file);
}

#[test]
fn uff_58b_gives_the_same_fit() {
    same("uff", uff::binary);
}

#[test]
fn mat_5_gives_the_same_fit() {
    same("mat", mat5::file);
}

#[test]
fn mat_7_3_gives_the_same_fit() {
    same("mat", mat73::file);
}

#[test]
fn tdms_gives_the_same_fit() {
    same("tdms", tdms::file);
}

#[test]
fn a_text_of_another_dialect_gives_the_same_fit() {
    same("csv", tables::text);
}

#[test]
fn a_workbook_gives_the_same_fit() {
    same("xlsx", tables::workbook);
}

/// Short integers round to 1 in 65504 of a channel's range, which over 40 000 samples is far below the noise of the
/// sensors: no parameter moves by more than a fifth of its standard error.
#[test]
fn rpc_gives_the_same_fit_within_its_rounding() {
    let own = fit_of("rsp", rpc::file);
    assert_eq!(own.len(), PLAIN.len());
    for ((name, value, _), (_, original, error)) in own.iter().zip(&*PLAIN) {
        assert!(
            (value - original).abs() < 0.2 * error,
            "{name} is {value}, not {original} ± {error}"
        );
    }
}

/// A group with other samples in each channel.
fn with_samples(group: &Group, samples: impl Fn(&Channel) -> Vec<f64>) -> Group {
    let channel = |own: &Channel| Channel::new(&own.name, &own.unit, samples(own));
    Group::at(group.rate, group.channels.iter().map(channel).collect())
}

/// Checks that RPC III gives the same fit as MAT, which holds the samples in full as RPC III rounds them.
fn same_as_rounded(rpc: impl Fn(&Group) -> Vec<u8>, rounded: impl Fn(&Group) -> Group) {
    let own = fit_of("rsp", rpc);
    let other = fit_of("mat", |group| mat5::file(&rounded(group)));
    assert!(own.len() >= 8 && own.len() == other.len(), "{own:?} {other:?}");
    for ((name, value, _), (_, same, _)) in own.into_iter().zip(other) {
        assert!((value / same - 1.0).abs() < SAME, "{name} is {value}, not {same}");
    }
}

#[test]
fn rpc_of_short_integers_gives_the_same_fit_as_its_samples_in_another_file() {
    let rounded = |own: &Channel| {
        let step = rpc::step(own);
        own.samples.iter().map(|value| (value / step).round() * step).collect()
    };
    same_as_rounded(rpc::file, |group| with_samples(group, rounded));
}

#[test]
fn rpc_of_floats_gives_the_same_fit_as_its_samples_in_another_file() {
    let rounded = |own: &Channel| own.samples.iter().map(|value| f64::from(*value as f32)).collect();
    same_as_rounded(rpc::floats, |group| with_samples(group, rounded));
}
