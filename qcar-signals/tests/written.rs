//! What is written is read again: names, units, times and every bit of the samples.

use std::fs;
use std::io::Write as _;

use flate2::Compression;
use flate2::write::GzEncoder;
use qcar_signals::mat::write::{Array, v5, v73};
use qcar_signals::mdf::write::{Channel, Group, v4};
use qcar_signals::read::read;
use qcar_signals::signal::{Recording, Signal, TimeBase, Value};

fn read_back(name: &str, bytes: &[u8]) -> Recording {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    fs::write(&path, bytes).unwrap();
    read(&path).unwrap_or_else(|error| panic!("{error}"))
}

fn times(signal: &Signal) -> Vec<f64> {
    match &signal.time {
        TimeBase::Even { start, step } => (0..signal.samples.len()).map(|at| start + at as f64 * step).collect(),
        TimeBase::Times(times) => times.to_vec(),
        TimeBase::Uneven { .. } | TimeBase::Unknown => Vec::new(),
    }
}

fn group(name: &str, rate: f64, samples: usize, channels: &[(&str, &str)]) -> Group {
    let wave = |channel: usize| {
        (0..samples)
            .map(|at| (0.37 * (at + channel) as f64).sin() / 3.0)
            .collect()
    };
    let channel = |(place, &(name, unit)): (usize, &(&str, &str))| Channel {
        name: name.into(),
        unit: unit.into(),
        samples: wave(place),
    };
    Group {
        name: name.into(),
        times: (0..samples).map(|at| at as f64 / rate).collect(),
        channels: channels.iter().enumerate().map(channel).collect(),
    }
}

#[test]
fn groups_of_two_rates_come_back_from_mdf() {
    let groups = [
        group("fast", 1000.0, 501, &[("z_body_acceleration", "m/s^2"), ("Kraft", "N")]),
        group("slow", 64.0, 33, &[("ÄÖÜ µ", "°C")]),
        group("empty", 1.0, 0, &[]),
    ];
    let recording = read_back("ride.mf4", &v4("qcar", &groups));
    assert_eq!(recording.format, "MDF 4.10");
    assert_eq!(recording.signals.len(), 3);
    for group in &groups {
        for channel in &group.channels {
            let signal = recording.signals.iter().find(|own| own.name == channel.name).unwrap();
            assert_eq!(signal.unit, channel.unit);
            assert_eq!(signal.source.group, group.name);
            assert_eq!(signal.samples, channel.samples);
            assert_eq!(times(signal).len(), group.times.len());
            for (own, expected) in times(signal).iter().zip(&group.times) {
                // A reader may take times that are even as a start and a step.
                assert!((own - expected).abs() < 1e-12, "{own} and {expected}");
            }
        }
    }
}

#[test]
fn arrays_texts_and_structures_come_back_from_mat() {
    let column = |numbers: &[f64]| Array::column(numbers.to_vec());
    let channel = |name: &str, unit: &str, samples: &[f64]| {
        vec![Array::Text(name.into()), Array::Text(unit.into()), column(samples)]
    };
    let fields = ["Name", "Unit", "Data"].map(String::from).to_vec();
    let capture = Array::fields(vec![
        (
            "X".into(),
            Array::Structs(fields.clone(), vec![channel("time", "s", &[0.0, 0.5, 1.0])]),
        ),
        (
            "Y".into(),
            Array::Structs(
                fields,
                vec![
                    channel("a", "m/s^2", &[1.0, 2.0, 3.0]),
                    channel("f", "N", &[0.1, -0.2, 1e300]),
                ],
            ),
        ),
    ]);
    let variables = [
        ("number".to_string(), Array::number(-0.1)),
        ("text".to_string(), Array::Text("größer µ".into())),
        ("t".to_string(), column(&[0.0, 0.25])),
        ("pair".to_string(), Array::rows(&[vec![1.0, 2.0], vec![3.0, 4.0]], 2)),
        ("none".to_string(), Array::rows(&[], 3)),
        ("ride".to_string(), capture),
    ];
    for file in [v5("a test", &variables).unwrap(), v73(&variables).unwrap()] {
        let recording = read_back("ride.mat", &file);
        let signal = |name: &str| recording.signals.iter().find(|own| own.name == name).unwrap();
        assert_eq!(
            (signal("f").unit.as_str(), &signal("f").samples.to_vec()[..]),
            ("N", &[0.1, -0.2, 1e300][..])
        );
        assert_eq!(times(signal("a")), [0.0, 0.5, 1.0]);
        assert_eq!(signal("pair[:,1]").samples, [2.0, 4.0]);
        let scalar = |name: &str| {
            recording
                .scalars
                .iter()
                .find(|own| own.name == name)
                .map(|own| own.value.clone())
        };
        assert_eq!(scalar("number"), Some(Value::Number(-0.1)));
        assert_eq!(scalar("text"), Some(Value::Text("größer µ".into())));
        assert_eq!(
            recording.passed_over.len(),
            1,
            "the empty array: {:?}",
            recording.passed_over
        );
    }
}

#[test]
fn both_versions_of_mat_name_variables_alike() {
    let number = |name: &str| (name.to_string(), Array::number(1.0));
    let long = "a".repeat(70);
    let given = ["größe", "30kmh", "end", &long, "z.body"].map(number);
    let fields = Array::fields(["1st", "a b"].map(number).to_vec());
    let variables = [&given[..], &[("s".into(), fields)]].concat();
    let cut = "a".repeat(63);
    let names = ["gr__e", "x30kmh", "end_", &cut, "z_body", "x1st", "a_b"];
    // The names of version 7.3 stand as they are in the links of HDF5, those of version 5 in its elements.
    for file in [v5("a test", &variables).unwrap(), v73(&variables).unwrap()] {
        let holds = |name: &str| file.windows(name.len()).any(|own| own == name.as_bytes());
        for name in names {
            assert!(holds(name), "{name} is missing");
        }
        for name in ["größe", "z.body", "a b", &"a".repeat(64)] {
            assert!(!holds(name), "{name} is there");
        }
    }
    let twins = ["a b", "a.b"].map(number);
    let inside = [("s".to_string(), Array::fields(twins.to_vec()))];
    for variables in [&twins[..], &inside] {
        for refused in [v5("a test", variables), v73(variables)] {
            let said = refused.unwrap_err();
            assert!(
                said.contains("`a b` and `a.b`, which would both be called `a_b`"),
                "{said}"
            );
        }
    }
}

#[test]
fn packed_once_is_read_and_packed_twice_is_refused() {
    let packed = |bytes: &[u8]| {
        let mut packer = GzEncoder::new(Vec::new(), Compression::fast());
        packer.write_all(bytes).unwrap();
        packer.finish().unwrap()
    };
    let once = packed(b"time,z [m]\n0,1\n0.1,2\n");
    assert_eq!(read_back("once.csv.gz", &once).signals.len(), 1);
    let folder = tempfile::tempdir().unwrap();
    let twice = folder.path().join("twice.gz");
    fs::write(&twice, packed(&once)).unwrap();
    let said = read(&twice).unwrap_err().to_string();
    assert!(
        said.contains("packed data within packed data") && said.contains("unpack the file once"),
        "{said}"
    );
}
