//! Runs the blind matrix: makes campaigns, runs `qcar discover` on each, and prints how often its answer is right.
//!
//! `matrix [OPTION]…` runs cases and appends a line for each to a file; `matrix --table FILE` prints Markdown tables of
//! all lines in that file.

use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

use qcar_blind::matrix::{Case, Kind, cases};
use qcar_blind::outcome::{HEADER, Outcome, Place};
use qcar_blind::tables::tables;

const USAGE: &str = "matrix [OPTION]... | matrix --table FILE
  --qcar PATH     the program that answers; the one beside this is the default
  --seeds 1,2     draws; 1 is the default
  --kinds A,B     Single, Clean, Outside, Pair, FastClean, HardwareClean, HardwareSingle,
                  Minimal, OtherLaw; all are the default
  --only WORD     the cases with a word in their names, or of a kind
  --part K/N      every N-th of them, from the K-th on
  --jobs N        so many searches at once, each with one thread
  --out FILE      adds a line for each case
  --resume        leaves out the cases that FILE has, unless their search failed
  --keep FOLDER   leaves the campaigns there, and takes those that are there
  --found-is-separable yes
                  takes an effect that was named right for separable, and computes the limit of the others alone: that takes twice as
                  long as a search
  --perturb A,B   searches each case again with each of these assumed numbers (discover/numbers.rs) 30 % lower and higher,
                  and counts the answers that change";

/// The file in a kept campaign's folder that holds the strength of its hidden effects.
const STRENGTH: &str = "strength.txt";

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("{message}\nusage: {USAGE}");
            ExitCode::from(2)
        }
    }
}

/// The options of the command line.
struct Options {
    qcar: PathBuf,
    seeds: Vec<u64>,
    kinds: Vec<Kind>,
    only: String,
    part: (usize, usize),
    jobs: usize,
    out: Option<PathBuf>,
    resume: bool,
    keep: Option<PathBuf>,
    perturb: Vec<String>,
    found_is_separable: bool,
}

fn run() -> Result<(), String> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    if let [word, file] = &words[..]
        && word == "--table"
    {
        print!("{}", tables(&read(Path::new(file))?));
        return Ok(());
    }
    let options = options(words)?;
    if !options.perturb.is_empty() {
        return perturb(&options);
    }
    let mut outcomes = match &options.out {
        Some(out) if options.resume && out.exists() => read(out)?,
        _ => Vec::new(),
    };
    outcomes.retain(|outcome| outcome.verdict != "failed");
    let is_new = |case: &Case| !outcomes.iter().any(|outcome| outcome.case == case.name);
    let cases: Vec<Case> = wanted(&options).into_iter().filter(is_new).collect();
    outcomes.extend(answer_all(&options, &cases)?);
    print!("\n{}", tables(&outcomes));
    Ok(())
}

fn options(words: Vec<String>) -> Result<Options, String> {
    let mut options = Options {
        qcar: beside_this()?,
        seeds: vec![1],
        kinds: Kind::ALL.to_vec(),
        only: String::new(),
        part: (1, 1),
        jobs: 1,
        out: None,
        resume: false,
        keep: None,
        perturb: Vec::new(),
        found_is_separable: false,
    };
    let mut words = words.into_iter();
    while let Some(word) = words.next() {
        if word == "--resume" {
            options.resume = true;
            continue;
        }
        let value = words.next().ok_or(format!("{word} needs a value"))?;
        match word.as_str() {
            "--qcar" => options.qcar = value.into(),
            "--seeds" => options.seeds = value.split(',').map(number).collect::<Result<_, _>>()?,
            "--kinds" => options.kinds = value.split(',').map(kind).collect::<Result<_, _>>()?,
            "--only" => options.only = value,
            "--part" => options.part = part(&value)?,
            "--jobs" => options.jobs = number(&value)?,
            "--keep" => options.keep = Some(value.into()),
            "--found-is-separable" => options.found_is_separable = value == "yes",
            "--perturb" => options.perturb = value.split(',').map(str::to_owned).collect(),
            "--out" => options.out = Some(value.into()),
            _ => return Err(format!("what is {word}?")),
        }
    }
    Ok(options)
}

fn number<T: std::str::FromStr>(text: &str) -> Result<T, String> {
    text.parse().map_err(|_| format!("{text} is no number"))
}

fn kind(text: &str) -> Result<Kind, String> {
    Kind::named(text).ok_or(format!("there is no kind {text}, but {:?}", Kind::ALL))
}

fn part(text: &str) -> Result<(usize, usize), String> {
    let (part, of) = text.split_once('/').ok_or(format!("--part {text}: K/N is expected"))?;
    let (part, of) = (number(part)?, number(of)?);
    if !(1..=of).contains(&part) {
        return Err(format!("--part {text}: K counts from 1 to N"));
    }
    Ok((part, of))
}

/// The `qcar` binary in the folder of this one.
fn beside_this() -> Result<PathBuf, String> {
    let this = std::env::current_exe().map_err(|e| e.to_string())?;
    Ok(this.with_file_name("qcar"))
}

/// The lines of a file. If a case has several lines, the last one counts.
fn read(path: &Path) -> Result<Vec<Outcome>, String> {
    let text = fs::read_to_string(path).map_err(|e| at(path, e))?;
    let lines = text.lines().filter(|line| *line != HEADER);
    let mut outcomes: Vec<Outcome> = Vec::new();
    for line in lines {
        let outcome = Outcome::parse(line).map_err(|e| at(path, e))?;
        outcomes.retain(|earlier| earlier.case != outcome.case);
        outcomes.push(outcome);
    }
    Ok(outcomes)
}

fn at(path: &Path, error: impl std::fmt::Display) -> String {
    format!("{}: {error}", path.display())
}

fn wanted(options: &Options) -> Vec<Case> {
    let all = options.seeds.iter().flat_map(|&seed| cases(seed));
    let of_kind = all.filter(|case| options.kinds.contains(&case.kind));
    let wanted = of_kind.filter(|case| case.name.contains(&options.only) || format!("{:?}", case.kind) == options.only);
    let (part, of) = options.part;
    wanted.skip(part - 1).step_by(of).collect()
}

/// Each job takes the next case that no other job has taken.
fn answer_all(options: &Options, cases: &[Case]) -> Result<Vec<Outcome>, String> {
    let (next, outcomes) = (AtomicUsize::new(0), Mutex::new(Vec::new()));
    let job = || {
        while let Some(case) = cases.get(next.fetch_add(1, Ordering::Relaxed)) {
            let outcome = answer(options, case, None)?;
            let mut outcomes = outcomes.lock().map_err(|e| e.to_string())?;
            println!("{}", outcome.line());
            if let Some(out) = &options.out {
                add_line(out, &outcome).map_err(|e| at(out, e))?;
            }
            outcomes.push(outcome);
        }
        Ok(())
    };
    thread::scope(|scope| {
        let jobs: Vec<_> = (0..options.jobs.max(1)).map(|_| scope.spawn(job)).collect();
        let ends = jobs
            .into_iter()
            .map(|job| job.join().map_err(|_| "a job panicked".to_owned())?);
        ends.collect::<Result<Vec<()>, String>>()
    })?;
    outcomes.into_inner().map_err(|e| e.to_string())
}

fn add_line(out: &Path, outcome: &Outcome) -> std::io::Result<()> {
    let is_new = !out.exists();
    let mut file = fs::OpenOptions::new().create(true).append(true).open(out)?;
    if is_new {
        writeln!(file, "{HEADER}")?;
    }
    writeln!(file, "{}", outcome.line())
}

/// How each answer depends on each assumed number: prints the answers that change and counts them.
fn perturb(options: &Options) -> Result<(), String> {
    let (mut changed, mut all) = (0, 0);
    for case in wanted(options) {
        let usual = answer(options, &case, None)?;
        for (name, factor) in options.perturb.iter().flat_map(|name| [(name, 0.7), (name, 1.3)]) {
            let other = answer(options, &case, Some(&format!("{name}={factor}")))?;
            all += 1;
            if (&other.verdict, &other.named, &other.alike) != (&usual.verdict, &usual.named, &usual.alike) {
                changed += 1;
                println!(
                    "{}: {name} times {factor}: {}, was {}",
                    case.name,
                    told(&other),
                    told(&usual)
                );
            }
        }
        println!("{}: {changed} of {all} answers changed so far", case.name);
    }
    Ok(())
}

/// The verdict and the names of the effects.
fn told(outcome: &Outcome) -> String {
    let names = outcome.named.iter().chain(&outcome.alike).map(Place::words);
    format!("{} {}", outcome.verdict, names.collect::<Vec<_>>().join(" "))
}

fn answer(options: &Options, case: &Case, assume: Option<&str>) -> Result<Outcome, String> {
    let passing = tempfile::tempdir().map_err(|e| e.to_string())?;
    let keep = options.keep.as_deref().unwrap_or(passing.path());
    let folder = keep.join(case.name.replace([' ', '/', ':'], "_"));
    make_once(case, &folder)?;
    let mut command = Command::new(&options.qcar);
    command.arg("discover").arg(&folder).args(["--format", "json"]);
    if let Some(assume) = assume {
        command.args(["--assume", assume]);
    }
    if options.jobs > 1 {
        command.env("RAYON_NUM_THREADS", "1");
    }
    let output = command.output();
    let output = output.map_err(|e| format!("{}; build it first: cargo build --release", at(&options.qcar, e)))?;
    if !output.status.success() {
        let words = String::from_utf8_lossy(&output.stderr);
        eprintln!("{}: {}: {words}", case.name, output.status);
        return Ok(Outcome::failed(case, strength(case, &folder)?));
    }
    let answer = serde_json::from_slice(&output.stdout).map_err(|e| format!("{}: {e}", case.name))?;
    let found = Outcome::new(case, &answer, f64::INFINITY);
    if options.found_is_separable && found.is_right() {
        return Ok(found);
    }
    Ok(Outcome::new(case, &answer, strength(case, &folder)?))
}

/// Makes a campaign unless its folder exists. The folder appears only when the campaign is complete.
fn make_once(case: &Case, folder: &Path) -> Result<(), String> {
    if folder.exists() {
        return Ok(());
    }
    // A campaign has the name of its folder.
    let making = folder
        .with_file_name("making")
        .join(folder.file_name().unwrap_or_default());
    if making.exists() {
        fs::remove_dir_all(&making).map_err(|e| at(&making, e))?;
    }
    qcar_blind::make(case.order.clone(), &making)?;
    fs::rename(&making, folder).map_err(|e| at(folder, e))
}

/// The strength of the effects that a campaign hides, in units of the noise.
fn strength(case: &Case, folder: &Path) -> Result<f64, String> {
    let file = folder.join(STRENGTH);
    if let Ok(text) = fs::read_to_string(&file) {
        return number(&text);
    }
    let strength = qcar_blind::strength(case.order.clone())?;
    fs::write(&file, strength.to_string()).map_err(|e| at(&file, e))?;
    Ok(strength)
}
