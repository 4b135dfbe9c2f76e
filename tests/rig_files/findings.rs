//! What is wrong with measured samples is said before any fit: flaws are put into the sweeps of a campaign and found.

use std::fs;

use crate::formats::{campaign, mapping, sweeps};
use crate::writers::{Group, mdf4};
use crate::{channel, folder, open, qcar};

/// The notices of the campaign whose low sweep has been spoiled.
fn notices(spoil: impl Fn(&mut Group)) -> Vec<String> {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("rig.toml"), mapping()).unwrap();
    let own = folder.path().join("own");
    fs::create_dir(&own).unwrap();
    campaign(&own, "mf4", |sweep| mdf4::file(std::slice::from_ref(sweep)));
    let mut low = sweeps()[0].clone();
    spoil(&mut low);
    fs::write(own.join("sweep_0.mf4"), mdf4::file(&[low])).unwrap();
    open(&own).unwrap().notices
}

/// The samples of a channel.
fn samples<'a>(group: &'a mut Group, name: &str) -> &'a mut Vec<f64> {
    let channel = group.channels.iter_mut().find(|channel| channel.name == name);
    &mut channel.unwrap().samples
}

fn only(notices: &[String], parts: &[&str]) {
    assert_eq!(notices.len(), 1, "{notices:#?}");
    for part in parts {
        assert!(notices[0].contains(part), "no `{part}` in {}", notices[0]);
    }
}

#[test]
fn a_sound_campaign_says_nothing() {
    assert_eq!(notices(|_| ()), [] as [&str; 0]);
}

#[test]
fn flaws_come_with_run_channel_and_time() {
    let clip = |sweep: &mut Group| {
        samples(sweep, "FL_Body_Acc_Z")
            .iter_mut()
            .for_each(|value| *value = value.min(0.04))
    };
    only(
        &notices(clip),
        &[
            "sweep_0.mf4, `body_left_z`",
            "cut off at 0.392",
            "m/s^2: the channel is clipped",
        ],
    );
    let spike = |sweep: &mut Group| samples(sweep, "FL_Body_Acc_Z")[20_000] = 3.0;
    only(
        &notices(spike),
        &["sweep_0.mf4, `body_left_z`, 20.000 s: a spike to 29.4"],
    );
    let drift = |sweep: &mut Group| {
        samples(sweep, "FL_Body_Acc_Z")
            .iter_mut()
            .enumerate()
            .for_each(|(k, value)| *value += 1e-6 * k as f64)
    };
    only(
        &notices(drift),
        &["sweep_0.mf4, `body_left_z`, 0.000 s to 43.250 s: the mean drifts by 0.42"],
    );
}

#[test]
fn a_sensor_that_hangs_upside_down_is_said() {
    let turn = |sweep: &mut Group| {
        samples(sweep, "FL_Hub_Acc_Z")
            .iter_mut()
            .for_each(|value| *value = -*value)
    };
    only(
        &notices(turn),
        &["sweep_0.mf4, `wheel_left_z`", "moves against `wheel_right_z`", "`sign`"],
    );
}

/// The rig's file has g; one channel was recorded in m/s^2.
#[test]
fn a_sensor_in_another_unit_than_its_other_side_is_said() {
    let scale = |sweep: &mut Group| {
        samples(sweep, "FL_Hub_Acc_Z")
            .iter_mut()
            .for_each(|value| *value *= 9.80665)
    };
    only(
        &notices(scale),
        &[
            "sweep_0.mf4, `wheel_left_z`",
            "times as large as `wheel_right_z`, which moves alike",
            "`unit` or `scale`",
        ],
    );
}

#[test]
fn sensors_that_were_swapped_are_said() {
    let swap = |sweep: &mut Group| {
        let hub = samples(sweep, "FL_Hub_Acc_Z").clone();
        let body = std::mem::replace(samples(sweep, "FL_Body_Acc_Z"), hub);
        *samples(sweep, "FL_Hub_Acc_Z") = body;
    };
    only(
        &notices(swap),
        &[
            "`wheel_left_z`",
            "resembles `body_right_z` more than `wheel_right_z`",
            "`body_left_z`",
            "seem to be swapped",
        ],
    );
}

#[test]
fn a_channel_that_one_run_lacks_is_said() {
    let lose = |sweep: &mut Group| sweep.channels.retain(|channel| channel.name != "FL_Body_Acc_Z");
    only(
        &notices(lose),
        &[
            "sweep_0.mf4, channel `FL_Body_Acc_Z`",
            "`body_left_z`",
            "other runs of the kind have it",
        ],
    );
}

#[test]
fn a_fit_says_it_too() {
    says_it_too("fit own --starts 1");
}

#[test]
#[ignore = "a whole search; .ci/run runs it"]
fn a_search_says_it_too() {
    says_it_too("discover own --format json");
}

fn says_it_too(verb: &str) {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("rig.toml"), mapping()).unwrap();
    let own = folder.path().join("own");
    fs::create_dir(&own).unwrap();
    campaign(&own, "mf4", |sweep| mdf4::file(std::slice::from_ref(sweep)));
    let mut low = sweeps()[0].clone();
    samples(&mut low, "FL_Body_Acc_Z")[20_000] = 3.0;
    fs::write(own.join("sweep_0.mf4"), mdf4::file(&[low])).unwrap();
    // A search of the spoiled sweep alone takes a fraction of the time.
    let manifest = own.join("campaign.toml");
    let text = fs::read_to_string(&manifest).unwrap();
    let runs: Vec<&str> = text.split("[[run]]").take(2).collect();
    fs::write(manifest, runs.join("[[run]]")).unwrap();
    let (status, said) = qcar(folder.path(), verb);
    assert!(
        status < 2 && said.contains("sweep_0.mf4, `body_left_z`, 20.000 s: a spike"),
        "{verb}: {said}"
    );
}

/// A campaign of plain tables is read as ever; only `check` looks at what its samples show.
#[test]
fn plain_tables_are_checked_too() {
    let keys = "unit = \"m/s^2\"";
    let sweep = "[[run]]\nkind = \"sweep\"\nfile = \"rig.csv\"\nrole = \"fit\"\npeak_velocity = 0.1\nstart_frequency = 1\n\
                 end_frequency = 10\nspacing = \"linear\"\nsample_rate = 100\n";
    for (constant, flaw) in [
        ("0.5", "every sample is 0.5 m/s^2: the channel is dead"),
        (
            "0.0",
            "every sample is 0: the channel is dead, or there was nothing to measure",
        ),
    ] {
        let row = |k: i32| {
            format!(
                "{:.2},{:.5},{constant}\n",
                f64::from(k) / 100.0,
                (0.3 * f64::from(k)).sin()
            )
        };
        let table = "time,pad_left_z,body_left_z\n".to_string() + &(0..500).map(row).collect::<String>();
        let folder = folder(
            &(channel("pad", keys) + &channel("body", keys) + sweep),
            ("rig.csv", table.as_bytes()),
        );
        assert_eq!(open(folder.path()).unwrap().notices, [] as [&str; 0]);
        let (status, said) = qcar(folder.path(), "check .");
        assert_eq!(status, 1, "{said}");
        assert!(said.starts_with(".: cannot be fitted\n"), "{said}");
        assert!(
            said.contains(&format!("rig.csv, `body_left_z`, 0.000 s to 4.990 s: {flaw}")),
            "{said}"
        );
    }
}

/// Gravity of 1 m/s^2 and as it is, and a wheel that travels by metres.
#[test]
fn units_that_samples_contradict_are_said() {
    let keys = "unit = \"m/s^2\"";
    let wheel = channel("wheel", "unit = \"m\"").replace("acceleration", "displacement");
    let sweep = "[[run]]\nkind = \"sweep\"\nfile = \"rig.csv\"\nrole = \"fit\"\npeak_velocity = 0.1\nstart_frequency = 1\n\
                 end_frequency = 10\nspacing = \"linear\"\nsample_rate = 100\n";
    let said = |mean: f64, travel: f64| {
        let rows = (0..500).map(|k| {
            let (time, swing) = (f64::from(k) / 100.0, (0.3 * f64::from(k)).sin());
            format!("{time:.2},{swing:.5},{:.5},{:.5}\n", mean + 0.1 * swing, travel * swing)
        });
        let table = "time,pad_left_z,body_left_z,wheel_left_z\n".to_string() + &rows.collect::<String>();
        let sections = channel("pad", keys) + &channel("body", keys) + &wheel + sweep;
        qcar(folder(&sections, ("rig.csv", table.as_bytes())).path(), "check .").1
    };
    let (sound, doubtful) = (said(0.0, 0.012), said(1.0, 12.0));
    let gravity = "rig.csv, `body_left_z`: a mean of -9.810 m/s^2 is that of gravity";
    assert!(said(-9.81, 0.012).contains(gravity) && !said(8.0, 0.012).contains("gravity"));
    assert!(!sound.contains("unit"), "{sound}");
    for part in [
        "rig.csv, `body_left_z`: a mean of 1.00 m/s^2 is that of a sensor at rest in g",
        "rig.csv, `wheel_left_z`: -12.000 to 12.000 m is more than a part of a car travels",
    ] {
        assert!(doubtful.contains(part), "no `{part}` in {doubtful}");
    }
}
