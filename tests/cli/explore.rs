//! Ensembles: the same rows however they are computed, and nothing taken for whole that is not.

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::Duration;

use serde_json::Value;

use crate::common::{qcar_in, refused, repository, run_line, succeeds};
use crate::document::{blocks, commands};

const AXLE: &str =
    "explore axle_a --params models/campaigns/axle_a_rig --vary k_tire=180..190N/mm --vary c_wheel_z=-20%..20%";
/// Many rows in little time.
const CAR: &str = "explore quarter_car --vary k_tire=180..220N/mm --vary m_wheel=-10%..10%";

/// Runs a command that must succeed and gives what it has written into `out`.
fn written(folder: &Path, line: &str, out: &str) -> Vec<u8> {
    let ran = run_line(folder, &format!("{line} --out {out}"));
    assert_eq!(ran.status, 0, "qcar {line}\n{}", ran.stderr);
    fs::read(folder.join(out)).unwrap()
}

/// The numbers of a table by column: its heading and its values, NaN where nothing stands.
fn columns(text: &[u8]) -> Vec<(String, Vec<f64>)> {
    let mut lines = std::str::from_utf8(text).unwrap().lines();
    let names = lines.next().unwrap().split(',').map(String::from);
    let rows: Vec<Vec<f64>> = lines
        .map(|line| line.split(',').map(|cell| cell.parse().unwrap_or(f64::NAN)).collect())
        .collect();
    let column = |(place, name)| (name, rows.iter().map(|row| row[place]).collect());
    names.enumerate().map(column).collect()
}

fn column(of: &[(String, Vec<f64>)], name: &str) -> Vec<f64> {
    let found = of.iter().find(|(own, _)| own == name);
    found.unwrap_or_else(|| panic!("no column {name}")).1.clone()
}

#[test]
fn rows_do_not_depend_on_the_number_of_threads() {
    let folder = repository();
    let table = |threads: &str| {
        let line = format!("{AXLE} --design lhs --count 9 --rides 20mm@30km/h,10mm@40km/h --out of_{threads}.csv");
        let ran = Command::new(env!("CARGO_BIN_EXE_qcar"))
            .args(line.split_whitespace())
            .current_dir(folder.path())
            .env("RAYON_NUM_THREADS", threads)
            .output()
            .unwrap();
        assert!(ran.status.success(), "{}", String::from_utf8_lossy(&ran.stderr));
        fs::read(folder.path().join(format!("of_{threads}.csv"))).unwrap()
    };
    let alone = table("1");
    assert_eq!(column(&columns(&alone), "design").len(), 18);
    assert!(alone == table("3"));
}

#[test]
fn parts_make_the_rows_of_the_whole() {
    let folder = repository();
    for design in ["grid --count 3", "lhs --count 10 --seed 4", "sobol --count 10"] {
        let line = format!("{AXLE} --design {design} --metrics peak,modes --rides 20mm@30km/h,30mm@20km/h");
        let kind = design.split(' ').next().unwrap();
        let whole = written(folder.path(), &line, &format!("{kind}.csv"));
        let mut joined: Vec<u8> = Vec::new();
        for part in 1..=4 {
            let text = written(
                folder.path(),
                &format!("{line} --part {part}/4"),
                &format!("{kind}_{part}.csv"),
            );
            let header = text.iter().position(|byte| *byte == b'\n').unwrap() + 1;
            joined.extend(&text[if part == 1 { 0 } else { header }..]);
        }
        assert!(joined == whole, "{design}");
    }
}

/// Wherever the file was cut off, and whatever stands behind the cut.
#[test]
fn a_table_that_was_cut_off_is_continued_to_the_same_bytes() {
    let folder = repository();
    let line = format!("{AXLE} --count 6 --rides 20mm@30km/h,10mm@40km/h --metrics peak");
    let whole = written(folder.path(), &line, "rides.csv");
    let [done, part] = ["rides.csv", "rides.csv.part"].map(|name| folder.path().join(name));
    let header = whole.iter().position(|byte| *byte == b'\n').unwrap() + 1;
    for cut in [0, 5, header, header + 1, whole.len() / 2, whole.len() - 1, whole.len()] {
        for garbage in ["", "4,0,0.0", "\0\0\0\0\n\0\0"] {
            fs::remove_file(&done).unwrap();
            fs::write(&part, [&whole[..cut], garbage.as_bytes()].concat()).unwrap();
            let again = written(folder.path(), &line, "rides.csv");
            assert!(again == whole, "cut at {cut}, then {garbage:?}");
            assert!(!part.exists());
        }
    }
}

#[test]
fn groups_that_were_written_are_kept() {
    let folder = repository();
    let line = format!("{CAR} --count 20000 --metrics modes");
    let whole = written(folder.path(), &line, "sets.parquet");
    let [done, part] = ["sets.parquet", "sets.parquet.part"].map(|name| folder.path().join(name));
    for (cut, kept) in [
        (3, false),
        (1000, false),
        (whole.len() * 9 / 10, true),
        (whole.len() - 1, true),
    ] {
        fs::remove_file(&done).unwrap();
        fs::write(&part, &whole[..cut]).unwrap();
        let ran = run_line(folder.path(), &format!("{line} --out sets.parquet"));
        assert_eq!(ran.status, 0, "{}", ran.stderr);
        assert!(fs::read(&done).unwrap() == whole, "cut at {cut}");
        assert_eq!(
            ran.stdout.contains("16384 of them existed already"),
            kept,
            "{}",
            ran.stdout
        );
    }
}

#[test]
fn a_run_that_was_killed_goes_on() {
    let folder = repository();
    let line = format!("{AXLE} --count 300 --rides 20mm@30km/h --metrics peak");
    let whole = written(folder.path(), &line, "reference.csv");
    let part = folder.path().join("rides.csv.part");
    let mut child = Command::new(env!("CARGO_BIN_EXE_qcar"))
        .args(format!("{line} --out rides.csv").split_whitespace())
        .current_dir(folder.path())
        .stdout(Stdio::null())
        .spawn()
        .unwrap();
    while fs::metadata(&part).map_or(0, |part| part.len()) < whole.len() as u64 / 3
        && child.try_wait().unwrap().is_none()
    {
        sleep(Duration::from_micros(100));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    assert!(written(folder.path(), &line, "rides.csv") == whole);
    let again = run_line(folder.path(), &format!("{line} --out rides.csv"));
    assert!(
        again.stdout.contains("the file was already complete"),
        "{}",
        again.stdout
    );
}

#[test]
fn results_of_something_else_are_refused() {
    let folder = repository();
    let run = |line: &str| run_line(folder.path(), &format!("{line} --out sets.csv"));
    let line = format!("{CAR} --count 8");
    let whole = written(folder.path(), &line, "sets.csv");
    refused(
        &run(&format!("{line} --seed 1")),
        &["sets.csv", "`seed` is 0", "`seed` is 1"],
    );
    refused(
        &run(&format!("{CAR} --count 9")),
        &["`rows` is 8", "`rows` is 9", "choose another file"],
    );
    refused(
        &run(&format!("{line} --set m_corner=410")),
        &["`parameters.m_corner` is ", "`parameters.m_corner` is 410"],
    );
    refused(
        &run(&format!("{line} --units engineering")),
        &["`columns", "[N/m]", "[N/mm]"],
    );
    // A row that this command would not write, at the end of those that it had.
    let [done, part] = ["sets.csv", "sets.csv.part"].map(|name| folder.path().join(name));
    fs::remove_file(&done).unwrap();
    let text = String::from_utf8(whole).unwrap();
    let mut rows: Vec<String> = text.lines().take(4).map(String::from).collect();
    rows[3] = rows[3].replacen("3,", "2,", 1).replace(",0", ",7");
    fs::write(&part, rows.join("\n") + "\n").unwrap();
    refused(&run(&line), &["sets.csv.part", "would not write"]);
    fs::remove_file(&part).unwrap();
    fs::write(&done, "mine\n").unwrap();
    fs::remove_file(folder.path().join("sets.csv.design.json")).unwrap();
    refused(&run(&line), &["sets.csv", "without its .design.json"]);
    assert_eq!(fs::read_to_string(&done).unwrap(), "mine\n");
}

#[test]
fn wishes_are_read_with_care() {
    let folder = repository();
    let cases: &[(&str, &[&str])] = &[
        ("--vary k_tyre=1..2", &["--vary k_tyre", "did you mean `k_tire`?"]),
        (
            "--vary k_tire=2e5..1e5",
            &["200000 to 100000 N/m", "write the lower end first"],
        ),
        ("--vary k_tire=2e5..2e5", &["a lower end below the upper one"]),
        (
            "--vary k_tire=1..2",
            &["--vary k_tire", "for which the model is declared"],
        ),
        (
            "--vary k_tire=1..2N/mm",
            &["found 1 to 2 N/mm, expected values from 50 to 1000 N/mm, for which"],
        ),
        (
            "--vary k_tire=-90%..-80% --units N/mm",
            &["found 22 to 44 N/mm, expected values from 50 to 1000 N/mm"],
        ),
        ("--vary k_tire=3..2N/mm", &["found 3 to 2 N/mm, expected a lower end"]),
        (
            "--vary k_tire=1..2kg",
            &["--vary k_tire", "values in \"kg\"", "\"N/mm\""],
        ),
        ("--vary k_tire=1", &["name=low..high"]),
        ("--vary k_tire=-1%..1% --vary k_tire=-2%..2%", &["the same name twice"]),
        ("--vary k_tire=-1%..1% --rides 20mm", &["HEIGHT@SPEED"]),
        (
            "--vary k_tire=-1%..1% --rides 20@30km/h",
            &["units of both", "20mm@30km/h", "found `20@30km/h`"],
        ),
        ("--vary k_tire=-1%..1% --rides 20mm@30", &["units of both"]),
        ("--vary k_tire=-1%..1% --rides 20mm@30km/h", &["--rides", "no --params"]),
        ("--vary k_tire=-1%..1% --metrics peak", &["--metrics", "add --rides"]),
        ("--vary k_tire=-1%..1% --metrics comfort", &["comfort", "vdv"]),
        (
            "--vary k_tire=-1%..1% --channels pad_to_moon",
            &["`pad_to_moon`", "`pad_to_body`"],
        ),
        ("--vary k_tire=-1%..1% --design posterior", &["a fit to draw from"]),
        ("--vary k_tire=-1%..1% --part 5/4", &["K/N"]),
        ("--vary k_tire=-1%..1% --count 5000000000", &["at most 4294967296 sets"]),
        ("--posterior nowhere.json", &["nowhere.json"]),
        ("", &["--vary"]),
    ];
    for (wish, said) in cases {
        let count = if wish.contains("--count") { "" } else { "--count 2" };
        let ran = run_line(
            folder.path(),
            &format!("explore quarter_car {count} --out sets.csv {wish}"),
        );
        refused(&ran, said);
        assert!(!folder.path().join("sets.csv.part").exists(), "{wish}");
    }
    for (ride, said) in [
        ("20m@30km/h", ["a cleat of 20 m", "the radius of the tyre, 0.35 m"]),
        (
            "20mm@300m/s",
            ["a speed of 300 m/s", "at least 0.5 m/s and at most 100 m/s"],
        ),
    ] {
        let line = format!("{AXLE} --count 2 --rides {ride} --out sets.csv");
        refused(&run_line(folder.path(), &line), &["--rides", said[0], said[1]]);
    }
    let tyre = format!("{AXLE} --vary static_tire_load=-5%..5% --count 2 --rides 20mm@30km/h --out sets.csv");
    refused(
        &run_line(folder.path(), &tyre),
        &["--vary static_tire_load", "vehicle data with --rides"],
    );
    let other = run_line(folder.path(), &format!("{CAR} --count 2 --out sets.txt"));
    refused(&other, &["sets.txt", ".parquet"]);
    let nowhere = run_line(folder.path(), &format!("{CAR} --count 2 --out nowhere/yet/sets.csv"));
    assert_eq!(nowhere.status, 0, "folders are made: {}", nowhere.stderr);
}

/// A wheel heavier than its corner: the rows are there, without metrics, and the reason is told.
#[test]
fn sets_that_are_impossible_have_rows_without_metrics() {
    let folder = repository();
    let line = "explore quarter_car --set m_corner=190 --vary m_wheel=10..190 --design grid --count 3 --metrics modes --out sets.csv";
    let ran = qcar_in(folder.path(), &line.split(' ').collect::<Vec<_>>());
    assert_eq!(ran.status, 0, "{}", ran.stderr);
    for said in ["1 of the rows", "set 2", "`mass body"] {
        assert!(ran.stdout.contains(said), "{}", ran.stdout);
    }
    let table = columns(&fs::read(folder.path().join("sets.csv")).unwrap());
    assert_eq!(column(&table, "failed"), [0.0, 0.0, 1.0]);
    let frequency = column(&table, "mode.1.frequency [Hz]");
    assert!(frequency[0] > 0.0 && frequency[2].is_nan());
}

/// So fast that a sample is longer than the patch: every row is there, and the exit status says that none has metrics.
#[test]
fn a_design_without_any_metrics_is_a_finding() {
    let folder = repository();
    let ran = run_line(
        folder.path(),
        &format!("{AXLE} --count 2 --rides 20mm@300km/h --out rides.csv"),
    );
    assert_eq!(ran.status, 1, "{}{}", ran.stdout, ran.stderr);
    assert!(
        ran.stdout.contains("2 of the rows") && ran.stdout.contains("sample rate"),
        "{}",
        ran.stdout
    );
    assert_eq!(
        fs::read_to_string(folder.path().join("rides.csv"))
            .unwrap()
            .lines()
            .count(),
        3
    );
}

/// Natural frequencies and damping ratios are roots of `|λ²M + λC + K|` of two masses on springs and dampers.
#[test]
fn modes_are_roots_of_the_characteristic_polynomial() {
    let folder = repository();
    let set = "--set m_corner=400 --set k_wheel_z=3e4 --set c_wheel_z=1200 --set c_tire=150";
    let line = format!("{CAR} {set} --design lhs --count 50 --metrics modes");
    let table = columns(&written(folder.path(), &line, "sets.csv"));
    let [k_tire, m_wheel] = ["k_tire [N/m]", "m_wheel [kg]"].map(|name| column(&table, name));
    for mode in 1..=2 {
        let frequency = column(&table, &format!("mode.{mode}.frequency [Hz]"));
        let damping = column(&table, &format!("mode.{mode}.damping"));
        for row in 0..50 {
            let omega = std::f64::consts::TAU * frequency[row];
            let (re, im) = (-damping[row] * omega, omega * (1.0 - damping[row].powi(2)).sqrt());
            let (square, times) = ([re * re - im * im, 2.0 * re * im], |a: [f64; 2], b: [f64; 2]| {
                [a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]]
            });
            let entry = |m: f64, c: f64, k: f64| [m * square[0] + c * re + k, m * square[1] + c * im];
            let body = entry(400.0 - m_wheel[row], 1200.0, 3e4);
            let wheel = entry(m_wheel[row], 1200.0 + 150.0, 3e4 + k_tire[row]);
            let strut = [1200.0 * re + 3e4, 1200.0 * im];
            let (product, coupled) = (times(body, wheel), times(strut, strut));
            let size = product[0].hypot(product[1]).max(coupled[0].hypot(coupled[1]));
            let left = (product[0] - coupled[0]).hypot(product[1] - coupled[1]);
            // Rounding of a frequency by 1e-13 moves the polynomial by some 1e-12 of its terms.
            assert!(left < 1e-9 * size, "row {row}, mode {mode}: {left:e} of {size:e}");
        }
    }
}

/// Peaks and after-shakes over the standard cleats are those that `qcar compare` prints.
#[test]
fn metrics_of_rides_are_those_of_a_comparison() {
    let folder = repository();
    let line = "explore axle_a --params models/campaigns/axle_a_rig --vary k_tire=187000..190000 --design grid --count 2 --rides standard";
    let table = columns(&written(folder.path(), line, "rides.csv"));
    let set = [
        "--params",
        "models/campaigns/axle_a_rig",
        "--set",
        "k_tire=187000",
        "--format",
        "json",
    ];
    let compared: Value =
        serde_json::from_str(&succeeds(&[&["compare", "axle_a", "axle_a"], &set[..]].concat())).unwrap();
    let runs = compared["cleat"]["runs"].as_array().unwrap();
    assert!(runs.len() >= 12 * 4, "{}", runs.len());
    let places = column(&table, "height [m]")
        .into_iter()
        .zip(column(&table, "speed [m/s]"));
    let places: Vec<(f64, f64)> = places.take(12).collect();
    for run in runs {
        let [height, speed] = ["height", "speed"].map(|key| run[key].as_f64().unwrap());
        let place = places.iter().position(|own| *own == (height, speed)).unwrap();
        let (mass, axis) = (run["mass"].as_str().unwrap(), run["axis"].as_str().unwrap());
        for what in ["peak", "after_shake"] {
            let own = column(&table, &format!("{mass}_{axis}.{what} [m/s^2]"))[place];
            let other = run[what]["a"].as_f64().unwrap();
            assert!(
                (own - other).abs() <= 1e-9 * other,
                "{what} of {mass} {axis}: {own}, {other}"
            );
        }
    }
}

/// The summit of a ratio lies no lower than the lines of `qcar frf`, and hardly above the highest of many.
#[test]
fn summits_are_those_of_the_frequency_response() {
    let folder = repository();
    let line = format!("{CAR} --design grid --count 1 --metrics transmissibility");
    let table = columns(&written(folder.path(), &line, "sets.csv"));
    let frequencies = [
        "frf",
        "quarter_car",
        "--frequencies",
        "0.5:50:100000",
        "--format",
        "csv",
    ];
    let response = columns(succeeds(&[&frequencies[..], &["--set", "k_tire=200000"]].concat()).as_bytes());
    let at = column(&response, "frequency [Hz]");
    for channel in ["pad_to_body", "pad_to_wheel", "wheel_to_body"] {
        let [re, im] = ["re", "im"].map(|part| column(&response, &format!("{channel}_{part}")));
        let magnitudes = re.iter().zip(&im).map(|(re, im)| re.hypot(*im));
        let highest = magnitudes.enumerate().max_by(|a, b| a.1.total_cmp(&b.1)).unwrap();
        let [own] = column(&table, &format!("{channel}.peak"))[..] else {
            panic!()
        };
        let [frequency] = column(&table, &format!("{channel}.peak_frequency [Hz]"))[..] else {
            panic!()
        };
        // The highest of 100 000 lines is half a line off the summit at most, which is flat there.
        assert!((own / highest.1 - 1.0).abs() < 1e-7, "{channel}: {own}, {}", highest.1);
        assert!(
            (frequency / at[highest.0] - 1.0).abs() < 2e-4,
            "{channel}: {frequency}, {}",
            at[highest.0]
        );
    }
}

/// Means and deviations of the draws are those of the fit, within five standard errors; what is not estimated stays.
#[test]
fn a_posterior_is_that_of_the_fit() {
    const COUNT: f64 = 4000.0;
    let folder = repository();
    let fit = run_line(
        folder.path(),
        "fit models/campaigns/axle_a_rig --starts 1 --out results",
    );
    assert_eq!(fit.status, 0, "{}", fit.stderr);
    let line = format!(
        "explore axle_a --params models/campaigns/axle_a_rig --posterior results/fit.json --count {COUNT} --metrics modes"
    );
    let table = columns(&written(folder.path(), &line, "draws.csv"));
    let answer: Value =
        serde_json::from_str(&fs::read_to_string(folder.path().join("results/fit.json")).unwrap()).unwrap();
    let mut seen = 0;
    for (name, own) in answer["parameters"].as_object().unwrap() {
        let heading = format!("{name} [{}]", own["unit"].as_str().unwrap());
        let Some(error) = own["stderr"].as_f64() else {
            assert!(table.iter().all(|(column, _)| *column != heading));
            continue;
        };
        let draws = column(&table, &heading);
        let mean = draws.iter().sum::<f64>() / COUNT;
        let deviation = (draws.iter().map(|draw| (draw - mean).powi(2)).sum::<f64>() / COUNT).sqrt();
        let value = own["value"].as_f64().unwrap();
        assert!(
            (mean - value).abs() < 5.0 * error / COUNT.sqrt(),
            "{name}: {mean}, {value}"
        );
        assert!(
            (deviation / error - 1.0).abs() < 5.0 / (2.0 * COUNT).sqrt(),
            "{name}: {deviation}, {error}"
        );
        seen += 1;
    }
    assert!(seen >= 8, "{seen}");
    let other = run_line(
        folder.path(),
        "explore axle_c --posterior results/fit.json --count 2 --out other.csv",
    );
    refused(&other, &["--posterior", "`axle_a`", "`axle_c`"]);
}

#[test]
fn the_commands_of_the_page_run() {
    let folder = repository();
    let blocks = blocks("docs/explore.md");
    let commands: Vec<&str> = blocks.iter().flat_map(commands).collect();
    assert!(commands.len() >= 4, "{commands:?}");
    for command in commands {
        let ran = run_line(folder.path(), command);
        assert_eq!(ran.status, 0, "qcar {command}\n{}", ran.stderr);
    }
}

#[test]
fn one_set_is_one_and_too_many_are_a_number() {
    let folder = repository();
    let line = format!("{CAR} --design grid --count 1 --metrics modes,modes --out one.csv");
    let ran = run_line(folder.path(), &line);
    assert!(
        ran.stdout.contains("1 set of grid, 1 row in one.csv"),
        "{}{}",
        ran.stdout,
        ran.stderr
    );
    let headings = fs::read_to_string(folder.path().join("one.csv")).unwrap();
    let headings = headings.lines().next().unwrap();
    assert_eq!(headings.matches("mode.1.damping").count(), 1, "{headings}");
    let ran = run_line(
        folder.path(),
        &format!("{CAR} --design grid --count 99999999999 --out many.csv"),
    );
    assert_eq!(ran.status, 2);
    assert!(
        ran.stderr.contains("e22 sets") || ran.stderr.contains("e33 sets"),
        "{}",
        ran.stderr
    );
}
