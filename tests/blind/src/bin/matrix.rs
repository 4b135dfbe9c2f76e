//! Runs the blind matrix: makes campaigns, lets `qcar discover` answer, and prints how often it is right.
//!
//! `matrix [--qcar PATH] [--seeds 1,2] [--only WORD] [--part K/N] [--keep FOLDER] [--out FILE]` runs cases, leaves their
//! campaigns in FOLDER, and adds a line for each to FILE; `matrix --table FILE` prints the Markdown table of all lines in it.

use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

use qcar_blind::matrix::{Case, cases};
use qcar_blind::outcome::{Outcome, table};

const USAGE: &str = "matrix [--qcar PATH] [--seeds 1,2] [--only WORD] [--part K/N] [--keep FOLDER] [--out FILE] | \
                     matrix --table FILE";

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("{message}\nusage: {USAGE}");
            ExitCode::from(2)
        }
    }
}

/// What is asked for.
struct Asked {
    qcar: PathBuf,
    seeds: Vec<u64>,
    only: String,
    part: (usize, usize),
    keep: Option<PathBuf>,
    out: Option<PathBuf>,
}

fn run() -> Result<(), String> {
    let mut asked = Asked {
        qcar: beside_this()?,
        seeds: vec![1],
        only: String::new(),
        part: (1, 1),
        keep: None,
        out: None,
    };
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        let value = words.next().ok_or(format!("{word} needs a value"))?;
        match word.as_str() {
            "--qcar" => asked.qcar = value.into(),
            "--seeds" => asked.seeds = value.split(',').map(number).collect::<Result<_, _>>()?,
            "--only" => asked.only = value,
            "--part" => {
                let (part, of) = value.split_once('/').ok_or("--part is K/N")?;
                asked.part = (number(part)?, number(of)?);
                if !(1..=asked.part.1).contains(&asked.part.0) {
                    return Err(format!("--part {value}: K counts from 1 to N"));
                }
            }
            "--keep" => asked.keep = Some(value.into()),
            "--out" => asked.out = Some(value.into()),
            "--table" => {
                print!("{}", table(&read(Path::new(&value))?));
                return Ok(());
            }
            _ => return Err(format!("what is {word}?")),
        }
    }
    let all = asked.seeds.iter().flat_map(|&seed| cases(seed));
    let wanted = all.filter(|case| case.name.contains(&asked.only) || format!("{:?}", case.kind) == asked.only);
    let (part, of) = asked.part;
    let mut outcomes = Vec::new();
    for case in wanted.skip(part - 1).step_by(of) {
        let outcome = answer(&asked.qcar, &case, asked.keep.as_deref())?;
        println!("{}", outcome.line());
        if let Some(out) = &asked.out {
            let file = fs::OpenOptions::new().create(true).append(true).open(out);
            let mut file = file.map_err(|e| format!("{}: {e}", out.display()))?;
            writeln!(file, "{}", outcome.line()).map_err(|e| format!("{}: {e}", out.display()))?;
        }
        outcomes.push(outcome);
    }
    print!("\n{}", table(&outcomes));
    Ok(())
}

fn number<T: std::str::FromStr>(text: &str) -> Result<T, String> {
    text.parse().map_err(|_| format!("{text} is no number"))
}

/// The binary that was built beside this one.
fn beside_this() -> Result<PathBuf, String> {
    let this = std::env::current_exe().map_err(|e| e.to_string())?;
    Ok(this.with_file_name("qcar"))
}

fn read(path: &Path) -> Result<Vec<Outcome>, String> {
    let text = fs::read_to_string(path).map_err(|e| format!("{}: {e}", path.display()))?;
    text.lines().map(Outcome::parse).collect()
}

fn answer(qcar: &Path, case: &Case, keep: Option<&Path>) -> Result<Outcome, String> {
    let passing = tempfile::tempdir().map_err(|e| e.to_string())?;
    let folder = keep.map_or(passing.path().into(), |keep| {
        keep.join(case.name.replace([' ', '/'], "_"))
    });
    qcar_blind::make(case.order.clone(), &folder)?;
    let mut command = Command::new(qcar);
    command.arg("discover").arg(&folder).args(["--format", "json"]);
    let output = command.output();
    let output = output.map_err(|e| format!("{}: {e}; build it first: cargo build --release", qcar.display()))?;
    if !output.status.success() {
        return Err(format!("{}: {}", case.name, String::from_utf8_lossy(&output.stderr)));
    }
    let answer = serde_json::from_slice(&output.stdout).map_err(|e| format!("{}: {e}", case.name))?;
    Ok(Outcome::new(case, &answer, qcar_blind::strength(case.order.clone())?))
}
