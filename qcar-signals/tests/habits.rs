//! Habits of other programs: structures of MATLAB, stamps of loggers, texts in place of numbers. The samples hold 50
//! values at 500 Hz: `front` counts in steps of 0.25, `rear` of -0.5.

use std::path::Path;

use qcar_signals::read::{read, recognise};
use qcar_signals::signal::{Recording, TimeBase, Value};

fn sample(name: &str) -> Recording {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/samples").join(name);
    read(&path).unwrap_or_else(|error| panic!("{error}"))
}

fn fault(name: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/samples").join(name);
    read(&path).unwrap_err().to_string()
}

/// A channel has these values at 500 Hz.
fn holds(recording: &Recording, name: &str, step: f64) {
    let signal = recording.signal(name).unwrap_or_else(|fault| panic!("{fault}"));
    let expected: Vec<f64> = (0..50).map(|at| step * f64::from(at)).collect();
    assert_eq!(signal.samples, expected, "{name}");
    let TimeBase::Times(times) = &signal.time else {
        panic!("{name}: {:?}", signal.time)
    };
    for (at, time) in times.iter().enumerate() {
        let expected = at as f64 / 500.0;
        assert!((time - expected).abs() < 1e-12, "{name}: {time} s, not {expected} s");
    }
}

fn passed_over(recording: &Recording) -> Vec<(&str, &str)> {
    let passed = recording.passed_over.iter();
    passed
        .map(|passed| (passed.name.as_str(), passed.why.as_str()))
        .collect()
}

#[test]
fn structures_with_a_vector_of_times_are_groups() {
    let recording = sample("mat/scipy_structures.mat");
    let expected = [
        ("data/front", 0.25),
        ("data/rear", -0.5),
        ("data.deeper/spring", -0.25),
        ("ts/Data", 0.25),
        ("out/front", 0.25),
        ("out/signals(2)[:,0]", 0.25),
        ("out/signals(2)[:,1]", -0.5),
    ];
    assert_eq!(recording.signals.len(), expected.len());
    for (name, step) in expected {
        holds(&recording, name, step);
    }
    let [(name, why)] = passed_over(&recording)[..] else {
        panic!("{:?}", recording.passed_over)
    };
    assert!(name == "settings" && why.contains("without a vector of times"), "{why}");
}

/// What SciPy reads of both: version 4 by SciPy, and by MATLAB 4.2 in big-endian order.
#[test]
fn version_4_of_mat_has_its_values_texts_and_orders() {
    let recording = sample("mat/scipy_v4.mat");
    assert_eq!(recording.format, "MAT 4");
    let scalars: Vec<_> = recording
        .scalars
        .iter()
        .map(|own| (&*own.name, own.value.clone()))
        .collect();
    let expected = [("v_car", Value::Number(8.25)), ("driver", Value::Text("grose".into()))];
    assert_eq!(scalars, expected);
    assert_eq!(passed_over(&recording), [("z", "complex numbers")]);
    let recording = sample("mat/matlab42_big_endian_v4.mat");
    let column = |name: &str| recording.signal(name).unwrap().samples.to_vec();
    assert_eq!(column("a[:,0]"), [1.0, 2.0, 3.0]);
    assert_eq!(column("a[:,1]"), [2.0, 0.0, 0.0]);
    let theta: Vec<f64> = (0..9).map(|at| f64::from(at) * std::f64::consts::FRAC_PI_4).collect();
    assert_eq!(column("theta"), theta);
}

#[test]
fn datasets_without_values_are_passed_over() {
    let recording = sample("mat/h5py_odd.h5");
    holds(&recording, "front", 0.25);
    let expected = [
        ("empty", "an empty array"),
        ("lzf", "data packed by another filter than Deflate"),
        ("unwritten", "data that were never written"),
        ("unwritten_chunks", "data that were never written"),
    ];
    assert_eq!(passed_over(&recording), expected);
    assert_eq!(recording.signals.len(), 1);
}

#[test]
fn time_stamps_of_tdms_are_the_times_of_their_group() {
    for name in ["tdms/time_stamps.tdms", "tdms/big_endian_time_stamps.tdms"] {
        holds(&sample(name), "front", 0.25);
    }
    // 25 samples later than the other group.
    let recording = sample("tdms/time_stamps.tdms");
    let rear = recording.signal("rear").unwrap();
    let TimeBase::Times(times) = &rear.time else {
        panic!("{:?}", rear.time)
    };
    assert_eq!((times.len(), rear.samples.len()), (25, 25));
    assert!(
        (times[0] - 0.05).abs() < 1e-12 && (times[24] - 0.098).abs() < 1e-12,
        "{times:?}"
    );
    assert_eq!(recording.signals.len(), 2);
}

#[test]
fn a_channel_of_times_may_have_its_unit_in_its_name() {
    let recording = sample("tdms/time_with_unit.tdms");
    holds(&recording, "front", 0.25);
    assert_eq!(recording.signals.len(), 1);
}

#[test]
fn dates_of_a_workbook_are_times() {
    // From 23:59:59.99 of 28 February on.
    let recording = sample("table/openpyxl_dates.xlsx");
    holds(&recording, "Weg", 0.25);
    assert_eq!(recording.signals[0].unit, "mm");
}

#[test]
fn numbers_as_texts_and_formulas_without_results_are_named() {
    let recording = sample("table/openpyxl_texts.xlsx");
    assert!(recording.signals.is_empty());
    let passed = &recording.passed_over[0];
    assert_eq!(passed.place.to_string(), "sheet `Rig`, cell A2");
    assert!(passed.why.contains("numbers as texts, such as `0,0`"), "{}", passed.why);
    let fault = fault("table/openpyxl_formulas.xlsx");
    for part in ["sheet `Rig`, cell C2", "channel `sum`", "`=A2+B2` without a result"] {
        assert!(fault.contains(part), "{fault}");
    }
}

/// The first and last time of the channel `a`.
fn times_of(table: &str) -> (f64, f64) {
    let recording = recognise(table.as_bytes()).unwrap_or_else(|fault| panic!("{table}: {fault}"));
    let signal = recording.signal("a").unwrap_or_else(|fault| panic!("{table}: {fault}"));
    match &signal.time {
        TimeBase::Times(times) => (times[0], times[times.len() - 1]),
        other => panic!("{table}: {other:?}"),
    }
}

#[test]
fn stamps_of_a_text_are_times_since_the_first() {
    for table in [
        "Time;a\n23:59:58.000;1\n23:59:59.500;2\n",
        "Zeitstempel;a\n2026-02-28 23:59:59,25;1\n2026-03-01 00:00:00,75;2\n",
        "Datum;Uhrzeit;a\n28.02.2026;10:00:00,0;1,5\n28.02.2026;10:00:01,5;2,5\n",
        "a,logged\n1,2026-11-26T08:00:00Z\n2,2026-11-26T08:00:01.5Z\n",
    ] {
        assert_eq!(times_of(table), (0.0, 1.5), "{table}");
    }
    // Over midnight a clock without a date falls.
    let fault = recognise(b"Time;a\n23:59:59;1\n00:00:01;2\n").unwrap_err().to_string();
    assert!(
        fault.contains("line 3, column `Time`") && fault.contains("never decrease"),
        "{fault}"
    );
    let fault = recognise(b"Time;a\n10:00:00;1\n10:00:01;2\nlate;3\n")
        .unwrap_err()
        .to_string();
    for part in ["line 4, column `Time`", "`late`", "12:30:05.25"] {
        assert!(fault.contains(part), "{fault}");
    }
}

#[test]
fn a_row_of_another_length_is_named_beside_the_longest() {
    let fault = recognise(b"t,a,b\n0,1,2\n0.1,2\n0.2,3,4\n0.3,4,5,6\n").unwrap_err();
    let fault = fault.to_string();
    assert!(
        fault.contains("line 2: found 3 columns, expected 4 columns as in line 5"),
        "{fault}"
    );
}

#[test]
fn exponents_of_fortran_are_read() {
    let recording = recognise(b"  t  a\n 0.0D+00 1.5D-03\n 1.0D-03 -2.5D+01\n").unwrap();
    assert_eq!(recording.signal("a").unwrap().samples, vec![1.5e-3, -25.0]);
}
