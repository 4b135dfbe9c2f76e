//! A campaign that `qcar import` begins with the files of a rig, filled in and fitted.

use std::fs;
use std::path::Path;

use qcar_runtime::campaign::Test;

use crate::formats::sweeps;
use crate::writers::{Channel, Group, mdf4, tdms};
use crate::{open, qcar};

fn files(folder: &Path) {
    for (sweep, name) in sweeps().iter().zip(["low.mf4", "middle.mf4", "high.mf4"]) {
        fs::write(folder.join(name), mdf4::file(std::slice::from_ref(sweep))).unwrap();
    }
}

#[test]
fn an_imported_campaign_fits_once_it_is_filled_in() {
    let folder = tempfile::tempdir().unwrap();
    files(folder.path());
    let (status, said) = qcar(
        folder.path(),
        "import low.mf4 middle.mf4 high.mf4 --out rig --model axle_a",
    );
    assert_eq!(status, 0, "{said}");
    for part in [
        "FL_Hub_Acc_Z",
        "wheel_left_z",
        "a logarithmic sweep from 0.5 to 30 Hz at 0.05 m/s",
        "rig/campaign.toml written",
    ] {
        assert!(said.contains(part), "no `{part}` in\n{said}");
    }
    let manifest = folder.path().join("rig/campaign.toml");
    let text = fs::read_to_string(&manifest).unwrap();
    assert!(
        text.contains("source = \"FR_Body_Acc_Z\"\n# in g, as the file says"),
        "{text}"
    );
    assert!(text.contains("file = \"../low.mf4\""), "{text}");
    // What the files cannot say, and the sensor that hangs upside down.
    let known = [
        ("m_corner", 490.9),
        ("m_tm", 5.1),
        ("m_half_vehicle", 1015.0),
        ("m_wheel_other_axle", 36.4),
    ];
    let filled = known.iter().fold(text, |text, (name, value)| {
        text.replace(&format!("# {name} ="), &format!("{name} = {value} #"))
    });
    let filled = filled.replace("source = \"FR_Hub_Acc_Z\"\n", "source = \"FR_Hub_Acc_Z\"\nsign = -1\n");
    fs::write(&manifest, filled).unwrap();
    let (status, said) = qcar(folder.path(), "check rig");
    assert!(status == 0 && said.starts_with("rig: ok\n"), "{said}");
    let (status, said) = qcar(folder.path(), "fit rig --starts 4");
    assert!(status == 0 && said.contains("converged"), "{said}");
}

#[test]
fn sweeps_of_one_recording_become_runs() {
    let folder = tempfile::tempdir().unwrap();
    let all = sweeps();
    let (rate, count) = (all[0].rate, all[0].channels.len());
    let rest = (2.0 * rate) as usize;
    let knocks = (0..rest).map(|at| if at % 400 < 200 { 0.1 } else { -0.1 });
    let joined = |at: usize| {
        let samples = all
            .iter()
            .flat_map(|sweep| std::iter::repeat_n(0.0, rest).chain(sweep.channels[at].samples.iter().copied()));
        let samples = samples.chain(std::iter::repeat_n(0.0, rest)).chain(knocks.clone());
        Channel::new(&all[0].channels[at].name, "g", samples.collect())
    };
    let long = Group::at(rate, (0..count).map(joined).collect());
    fs::write(folder.path().join("long.mf4"), mdf4::file(&[long])).unwrap();
    let (status, said) = qcar(folder.path(), "import long.mf4 --out rig --model axle_a");
    assert_eq!(status, 0, "{said}");
    let campaign = open(&folder.path().join("rig")).unwrap();
    let names: Vec<&str> = campaign.runs.iter().map(|run| run.name.as_str()).collect();
    assert_eq!(
        names,
        ["../long.mf4 part 1", "../long.mf4 part 2", "../long.mf4 part 3"],
        "{said}"
    );
    let words = said.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(words.contains("s: the pad moves but does not sweep"), "{said}");
    let duration = all[0].len() as f64 / rate;
    for (at, (run, level)) in campaign.runs.iter().zip([0.025, 0.05, 0.1]).enumerate() {
        let Test::Sweep(sweep) = &run.test else {
            panic!("{said}")
        };
        assert_eq!(
            (sweep.peak_velocity, sweep.start_frequency, sweep.end_frequency),
            (level, 0.5, 30.0),
            "{said}"
        );
        let (from, to) = (run.window.from.unwrap(), run.window.to.unwrap());
        let begins = 2.0 + at as f64 * (2.0 + duration);
        assert!(
            (from - begins).abs() < 1.5 && (to - begins - duration).abs() < 2.0,
            "{from} {to} {begins}"
        );
    }
}

/// The quarter car moves along z only, so a channel need not name that axis; one that names another is no sensor of it.
#[test]
fn a_channel_without_an_axis_is_along_the_only_axis_of_a_model() {
    let folder = tempfile::tempdir().unwrap();
    let mut sweep = sweeps()[0].clone();
    let names = ["Platen", "Hub", "Body Lateral"];
    for (channel, name) in sweep.channels.iter_mut().zip(names) {
        channel.name = name.to_string();
    }
    sweep.channels.truncate(names.len());
    fs::write(folder.path().join("one.mf4"), mdf4::file(&[sweep])).unwrap();
    let (status, said) = qcar(folder.path(), "import one.mf4 --out rig --model quarter_car");
    let words = said.split_whitespace().collect::<Vec<_>>().join(" ");
    assert_eq!(status, 0, "{said}");
    for part in [
        "pad_centre_z",
        "wheel_centre_z",
        "its name has an axis that the model lacks",
    ] {
        assert!(words.contains(part), "no `{part}` in\n{said}");
    }
    let (_, said) = qcar(folder.path(), "import one.mf4 --out both --model axle_a");
    let words = said.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(words.contains("its name has no axis, x or z"), "{said}");
}

/// Stamps that are late by up to a tenth of a step.
#[test]
fn a_sweep_is_found_between_late_stamps() {
    let folder = tempfile::tempdir().unwrap();
    let even = &sweeps()[0];
    let late = |at: usize| (at as f64 + 0.1 * (at as f64 * 0.618).fract()) / even.rate;
    let group = Group::stamped((0..even.len()).map(late).collect(), even.channels.clone());
    fs::write(folder.path().join("late.mf4"), mdf4::file(&[group])).unwrap();
    let (status, said) = qcar(folder.path(), "import late.mf4 --out rig --model axle_a");
    assert!(
        status == 0 && said.contains("a logarithmic sweep from 0.5 to 30 Hz"),
        "{said}"
    );
    let text = fs::read_to_string(folder.path().join("rig/campaign.toml")).unwrap();
    assert!(
        text.contains("# sample_rate is not given: it follows from the times"),
        "{text}"
    );
    let campaign = open(&folder.path().join("rig")).unwrap();
    let Test::Sweep(sweep) = &campaign.runs[0].test else {
        panic!("{text}")
    };
    assert!(
        (sweep.sample_rate / even.rate - 1.0).abs() < 0.01,
        "{}",
        sweep.sample_rate
    );
}

/// A group that is called `lon`, with sensors along z.
#[test]
fn the_name_of_a_channel_says_more_than_that_of_its_group() {
    let folder = tempfile::tempdir().unwrap();
    let mut file = tdms::file(&sweeps()[0]);
    let places: Vec<usize> = (0..file.len() - 5)
        .filter(|&at| &file[at..at + 5] == b"'rig'")
        .collect();
    assert!(!places.is_empty());
    places
        .iter()
        .for_each(|&at| file[at + 1..at + 4].copy_from_slice(b"lon"));
    fs::write(folder.path().join("lon.tdms"), file).unwrap();
    let (status, said) = qcar(folder.path(), "import lon.tdms --out rig --model axle_a");
    assert!(
        status == 0 && said.contains("body_left_z") && !said.contains("body_left_x"),
        "{said}"
    );
}

#[test]
fn nothing_is_written_over_or_left_half_written() {
    let folder = tempfile::tempdir().unwrap();
    files(folder.path());
    fs::create_dir(folder.path().join("rig")).unwrap();
    let (status, said) = qcar(folder.path(), "import low.mf4 --out rig");
    assert!(status == 2 && said.contains("exists already"), "{said}");
    assert_eq!(fs::read_dir(folder.path().join("rig")).unwrap().count(), 0);
    fs::write(folder.path().join("cut.mf4"), b"MDF     4.10    ").unwrap();
    let (status, said) = qcar(folder.path(), "import low.mf4 cut.mf4 --out other");
    assert!(status == 2 && said.contains("cut.mf4"), "{said}");
    assert!(!folder.path().join("other").exists());
}

#[test]
fn a_workbook_of_a_kinematics_rig_becomes_a_curve() {
    let folder = tempfile::tempdir().unwrap();
    let sample = Path::new(env!("CARGO_MANIFEST_DIR")).join("qcar-signals/tests/samples/table/kc_bounce.xlsx");
    let (status, said) = qcar(folder.path(), &format!("import {} --out kc", sample.display()));
    assert!(
        status == 0 && said.contains("taken for a K&C curve, `Vertical force` over `Wheel travel`"),
        "{said}"
    );
    // Its travel and force need no sensor; what else it has does not belong to the model.
    assert!(
        !said.contains("Wheel travel: no sensor") && !said.contains("Vertical force: no sensor"),
        "{said}"
    );
    let words = said.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(
        words
            .contains("Toe: no sensor, its unit is that of an angle, and no word in its name is an angle of the model")
    );
    let campaign = open(&folder.path().join("kc")).unwrap();
    let curve = campaign.curve(&campaign.runs[0]).unwrap();
    assert_eq!((curve.displacement.len(), curve.displacement[0]), (81, -0.08));
    assert!(curve.force.iter().all(|force| (1632.0..7295.0).contains(force)));
}

#[test]
fn a_file_without_channels_is_no_campaign() {
    let folder = tempfile::tempdir().unwrap();
    let sample = Path::new(env!("CARGO_MANIFEST_DIR"));
    let sample = sample.join("qcar-signals/tests/samples/uff/testlab_151_164_geometry.uff");
    let (status, said) = qcar(folder.path(), &format!("import {} --out rig", sample.display()));
    assert!(status == 2 && said.contains("a file without channels"), "{said}");
    assert!(!folder.path().join("rig").exists());
}

/// A trap whose units are wrong, and files of programs whose units are right.
#[test]
fn units_that_the_samples_contradict_are_named() {
    let samples = Path::new(env!("CARGO_MANIFEST_DIR")).join("qcar-signals/tests/samples");
    let (status, said) = qcar(&samples, "inspect traps/wrong_units.csv");
    assert_eq!(status, 0, "{said}");
    for part in [
        "body_left_z: a mean of 1.00 m/s^2",
        "if it is, give `unit = \"g\"`",
        "spring_travel: -22.915 to 30.915 m",
        "if it is mm, give `unit = \"mm\"`",
        "damper_force: `kp` is an old name of kgf",
        "yaw_rate: `furlong` is no unit that is known",
    ] {
        let unbroken = said.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(unbroken.contains(part), "{part}\n{said}");
    }
    assert!(!said.contains("wheel_left_z: "), "{said}");
    for sound in [
        "mdf/plain_3groups.mf4",
        "mdf/special_text_invalid_bits.mf4",
        "rpc/short_4frames_group.tim",
        "uff/151_164_58_58b.uff",
        "tdms/waveform_2segments.tdms",
        "mat/testlab_v7.mat",
        "mat/dspace_v6.mat",
        "table/kc_bounce.xlsx",
        "crg/slope_banking_krbi.crg",
    ] {
        let (status, said) = qcar(&samples, &format!("inspect {sound}"));
        assert!(status == 0 && !said.contains("units to be checked"), "{sound}\n{said}");
    }
}
