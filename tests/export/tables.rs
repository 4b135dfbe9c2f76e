//! Tables of ensembles as other programs read them, and designs as they make them.

use std::path::Path;

use crate::programs::{python_with, qcar, run};

const CAR: [&str; 6] = [
    "explore",
    "quarter_car",
    "--vary",
    "k_tire=180..220N/mm",
    "--vary",
    "m_wheel=-10%..10%",
];

fn explored(folder: &Path, file: &str, rest: &[&str]) -> String {
    let out = folder.join(file).display().to_string();
    qcar(&[&CAR[..], rest, &["--out", &out]].concat());
    out
}

/// More rows than a group has, and fewer than two: names, types, numbers and groups, bit for bit those of the CSV.
#[test]
fn pyarrow_reads_the_numbers_of_the_csv() {
    let Some(python) = python_with("pyarrow", "tables in Parquet") else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let rest = ["--design", "lhs", "--count", "17000", "--metrics", "modes"];
    let [csv, parquet] = ["sets.csv", "sets.parquet"].map(|file| explored(folder.path(), file, &rest));
    let script = "
import sys, json, struct, pyarrow.parquet, pyarrow.csv
text, table = pyarrow.csv.read_csv(sys.argv[1]), pyarrow.parquet.read_table(sys.argv[2])
assert table.column_names == text.column_names, table.column_names
assert table.num_rows == 17000
bits = lambda column: [struct.pack('<d', float(value)) for value in column.to_pylist()]
for name in table.column_names:
    assert str(table.schema.field(name).type) == 'double'
    assert bits(table[name]) == bits(text[name]), name
meta = pyarrow.parquet.ParquetFile(sys.argv[2]).metadata
assert [meta.row_group(i).num_rows for i in range(meta.num_row_groups)] == [16384, 616]
assert json.loads(table.schema.metadata[b'qcar'])['design'] == 'lhs'
print('agreed')
";
    assert!(run(&python, &["-c", script, &csv, &parquet], folder.path()).contains("agreed"));
}

/// The sequence in as many dimensions as an axle has parameters, by SciPy's own direction numbers.
#[test]
fn scipy_finds_the_points_of_the_sequence() {
    let Some(python) = python_with("scipy", "Sobol's sequence") else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("sets.csv").display().to_string();
    let names = [
        "m_corner",
        "m_wheel",
        "m_tm",
        "m_pwt",
        "k_wheel_z",
        "c_wheel_z",
        "k_tm",
        "c_tm",
        "k_pwt_z",
        "c_pwt_z",
        "k_tire",
        "c_tire",
        "m_half_vehicle",
        "m_wheel_other_axle",
        "k_wheel_x",
        "c_wheel_x",
        "k_pwt_x",
        "c_pwt_x",
    ];
    let vary: Vec<String> = names.iter().map(|name| format!("{name}=-5%..5%")).collect();
    let vary: Vec<&str> = vary.iter().flat_map(|vary| ["--vary", vary]).collect();
    let rest = ["--count", "1024", "--metrics", "modes", "--out", &out];
    qcar(
        &[
            &["explore", "axle_a", "--params", "models/campaigns/axle_a_rig"],
            &vary[..],
            &rest,
        ]
        .concat(),
    );
    let script = "
import sys, csv, json
from scipy.stats import qmc
rows = list(csv.reader(open(sys.argv[1])))
ends = json.load(open(sys.argv[1] + '.design.json'))['varied']
points = qmc.Sobol(len(ends), scramble=False, bits=32).random(1024)
place = {name.split(' [')[0]: at for at, name in enumerate(rows[0])}
for row, point in zip(rows[1:], points):
    for (name, (low, high)), part in zip(ends.items(), point):
        expected = low + (high - low) * part
        assert abs(float(row[place[name]]) - expected) <= 4e-16 * high, (name, row[0])
print('agreed', len(ends))
";
    assert!(run(&python, &["-c", script, &out], folder.path()).contains("agreed 18"));
}
