//! Workbooks in openpyxl: the template filled in by another program is the campaign that it was filled from, and
//! results are those of the JSON.

use std::fs;
use std::path::Path;
use std::process::Command;

use serde_json::Value;

use crate::programs::{python_with, qcar, run};

const CAMPAIGN: &str = "models/campaigns/axle_a_rig";

/// Values went through decimal fractions of other units, and parameters stand in another order: both move where
/// searches and rides end within their tolerances. Of numbers below one, such as relative errors, it is the difference.
const SEARCHED: f64 = 1e-6;
/// The same of rides, whose signals are held to 1e-3 of their peaks.
const RIDDEN: f64 = 1e-5;

fn path(folder: &Path, name: &str) -> String {
    folder.join(name).to_str().unwrap().to_string()
}

fn link(from: &Path, to: &Path) {
    std::os::unix::fs::symlink(from, to).unwrap();
}

fn json(text: &str) -> Value {
    serde_json::from_str(text).unwrap()
}

/// Every number of one value is that of the other.
fn alike(at: &str, a: &Value, b: &Value, tolerance: f64) {
    match (a, b) {
        (Value::Number(a), Value::Number(b)) => {
            let (a, b) = (a.as_f64().unwrap(), b.as_f64().unwrap());
            assert!((a - b).abs() <= tolerance * a.abs().max(1.0), "{at}: {a} and {b}");
        }
        (Value::Array(a), Value::Array(b)) => {
            assert_eq!(a.len(), b.len(), "{at}");
            a.iter().zip(b).for_each(|(a, b)| alike(at, a, b, tolerance));
        }
        (Value::Object(a), Value::Object(b)) => {
            assert_eq!(a.len(), b.len(), "{at}");
            a.iter()
                .for_each(|(key, own)| alike(&format!("{at}.{key}"), own, &b[key], tolerance));
        }
        _ => assert_eq!(a, b, "{at}"),
    }
}

#[test]
fn a_template_that_openpyxl_fills_in_is_the_campaign() {
    let Some(python) = python_with("openpyxl", "a filled template") else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let (root, folder) = (Path::new(env!("CARGO_MANIFEST_DIR")), folder.path());
    link(&root.join(CAMPAIGN), &folder.join("original"));
    fs::create_dir(folder.join("campaign")).unwrap();
    for part in ["rig", "kc", "cleat"] {
        link(&root.join(CAMPAIGN).join(part), &folder.join("campaign").join(part));
    }
    qcar(&["new", "template", &path(folder, "vehicle.xlsx")]);
    run(
        &python,
        &[root.join("tests/export/workbook/fill.py").to_str().unwrap()],
        folder,
    );
    let filled = path(folder, "campaign");
    let both = |verb: &str| [CAMPAIGN, &filled].map(|campaign| json(&qcar(&[verb, campaign, "--format", "json"])));
    let [original, own] = both("kc");
    alike("kc", &original, &own, SEARCHED);
    let [original, own] = both("fit");
    alike("fit", &original["parameters"], &own["parameters"], SEARCHED);
    let [original, own] = both("simulate");
    alike("simulate", &original["runs"], &own["runs"], RIDDEN);
}

/// Each row: a cell, what is written there, and what the error must say beside sheet and cell.
const WRONG: &[(&str, &str, &[&str])] = &[
    (
        "front.k_tire",
        "'=C20*1000'",
        &[
            "formula `=C20*1000` of `front.k_tire`",
            "no stored result",
            "a number in N/m",
        ],
    ),
    ("front.k_tire", "'stiff'", &["the text `stiff`", "a number in N/m"]),
    (
        "front.k_tire.unit",
        "'N/mmm'",
        &["the unit \"N/mmm\"", "a unit of the kind of N/m, such as \"N/mm\""],
    ),
    (
        "front.k_tire.unit",
        "'N s/m'",
        &["the unit \"N s/m\"", "a unit of the kind of N/m"],
    ),
    ("front.k_tire.unit", "None", &["no unit", "a unit of the kind of N/m"]),
    ("front.k_tire", "None", &["no value", "N/m", "fill in the cell"]),
    (
        "front.r_tire.unit",
        "'kg'",
        &["the unit \"kg\"", "a unit of the kind of m"],
    ),
    (
        "front.c_tire.lower",
        "'=1/2'",
        &["formula `=1/2` of `front.c_tire.lower`"],
    ),
    ("front.c_tire.upper", "0.0", &["0 as a bound of 162", "at least 162"]),
    ("axle", "'middle'", &["the axle `middle`", "front or rear"]),
];

#[test]
fn what_is_wrong_in_a_workbook_is_refused_with_sheet_and_cell() {
    let Some(python) = python_with("openpyxl", "wrong cells of a workbook") else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let (good, bad) = (path(folder.path(), "good.xlsx"), path(folder.path(), "bad.xlsx"));
    qcar(&["new", "template", &good, "--model", "axle_a", "--params", CAMPAIGN]);
    for (name, value, expected) in WRONG {
        let program = format!(
            "import openpyxl\nbook = openpyxl.load_workbook('{good}')\n\
             sheet, at = book.defined_names['{name}'].attr_text.replace('$', '').split('!')\n\
             book[sheet][at].value = {value}\nbook.save('{bad}')\nprint(f'sheet `{{sheet}}`, cell {{at}}', end='')"
        );
        let place = run(&python, &["-c", &program], folder.path());
        let ran = Command::new(env!("CARGO_BIN_EXE_qcar"))
            .args(["frf", "axle_a", "--params", &bad])
            .output()
            .unwrap();
        let said = String::from_utf8(ran.stderr).unwrap();
        assert_eq!(ran.status.code(), Some(2), "{name} = {value}\n{said}");
        for part in [&["bad.xlsx", place.as_str()], *expected].concat() {
            assert!(said.contains(part), "{name} = {value}: no `{part}` in\n{said}");
        }
    }
}

#[test]
fn a_template_with_values_gives_them_back() {
    let folder = tempfile::tempdir().unwrap();
    let response = |params: &str| qcar(&["frf", "axle_a", "--params", params, "--frequencies", "1:20:5"]);
    for units in ["si", "engineering"] {
        let file = path(folder.path(), &format!("{units}.xlsx"));
        qcar(&[
            "new", "template", &file, "--model", "axle_a", "--params", CAMPAIGN, "--units", units,
        ]);
        assert_eq!(response(&file), response(CAMPAIGN), "{units}");
    }
}

#[test]
fn results_in_a_workbook_are_those_of_the_json() {
    let Some(python) = python_with("openpyxl", "workbooks of results") else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let out = path(folder.path(), "fit");
    let fit = json(&qcar(&[
        "fit",
        CAMPAIGN,
        "--out",
        &out,
        "--format",
        "json",
        "--units",
        "engineering",
    ]));
    let program = "
import json, openpyxl
book = openpyxl.load_workbook('fit/results.xlsx')
rows = lambda name: [list(row) for row in book[name].iter_rows(values_only=True)]
print(json.dumps({name: rows(name) for name in book.sheetnames}
                 | {'charts': {name: len(book[name]._charts) for name in book.sheetnames}}))";
    let book = json(&run(&python, &["-c", program], folder.path()));
    let parameters = fit["parameters"].as_object().unwrap();
    let size = |unit: &str| match unit {
        "N/m" => ("N/mm", 1e-3),
        "N s/m" => ("N s/mm", 1e-3),
        "m" => ("mm", 1e3),
        "N" => ("N", 1.0),
        "kg" => ("kg", 1.0),
        _ => ("1", 1.0),
    };
    let rows = &book["Parameters"].as_array().unwrap()[1..];
    assert_eq!(rows.len(), parameters.len());
    for row in rows {
        let own = &parameters[row[0].as_str().unwrap()];
        let (unit, size) = size(own["unit"].as_str().unwrap());
        assert_eq!(row[1], unit, "{row}");
        for (column, key) in [(2, "start"), (3, "value"), (4, "stderr")] {
            let expected = own[key].as_f64().map(|value| value * size);
            let off = |(a, b): (f64, f64)| (a - b).abs() > 1e-12 * b.abs();
            assert_eq!(row[column].as_f64().is_some(), expected.is_some(), "{row}");
            assert!(!row[column].as_f64().zip(expected).is_some_and(off), "{key} of {row}");
        }
    }
    assert_eq!(
        book["Fit"].as_array().unwrap().len(),
        1 + fit["channels"].as_array().unwrap().len()
    );
    let lines = fs::read_to_string(folder.path().join("fit/transmissibility.csv"))
        .unwrap()
        .lines()
        .count();
    assert_eq!(book["Transmissibilities"].as_array().unwrap().len(), lines);
    assert!(
        book["charts"]["Transmissibilities"].as_u64().unwrap() >= 3,
        "{}",
        book["charts"]
    );
}
