//! Programs that do the same work: they are built here, and get commands on their standard input.

use std::cell::RefCell;
use std::fs;
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

use crate::rides;
use crate::subject::{MODEL, Subject};

/// The folder in which they are built.
const FOLDER: &str = "target/peers";

/// Compiler options for speed, but without fused multiplication and addition, as in qcar.
const FLAGS: [&str; 4] = ["-std=c++20", "-O3", "-march=native", "-ffp-contract=off"];

/// A running program that waits for commands.
pub struct Peer {
    pub name: &'static str,
    /// Its task.
    pub tasks: &'static [&'static str],
    /// Number of parameter sets that it computes together.
    pub lanes: usize,
    talk: RefCell<Talk>,
}

struct Talk {
    child: Child,
    to: ChildStdin,
    from: BufReader<ChildStdout>,
}

/// The programs that could be built, and why others could not.
pub fn all() -> (Vec<Peer>, Vec<String>) {
    fs::create_dir_all(FOLDER).expect("a folder in target");
    let all = &["matrices", "response", "fit"];
    let built = [
        cpp("hand", PEERS, &[], &[]).and_then(|program| start("by hand", all, 1, program, &subject())),
        cpp("wide", PEERS, &["-DWIDE"], &[])
            .and_then(|program| start("by hand, eight at once", all, 8, program, &subject())),
        casadi().and_then(|program| start("CasADi's C", &all[..2], 1, program, &subject())),
        cpp(
            "ceres",
            PEERS,
            &["-DCERES", "-I/usr/include/eigen3"],
            &["-lceres", "-lglog"],
        )
        .and_then(|program| start("Ceres", &all[2..], 1, program, &subject())),
        scipy().and_then(|program| start("NumPy and SciPy", &all[1..], 1, program, &subject())),
        cpp("ride", RIDE, &[], &[]).and_then(|program| start("by hand", &["ride"], 1, program, &rides::told())),
        cpp("odeint", RIDE, &["-DODEINT"], &[])
            .and_then(|program| start("Boost.odeint", &["ride"], 1, program, &rides::told())),
    ];
    let (mut peers, mut missing) = (Vec::new(), Vec::new());
    for peer in built {
        match peer {
            Ok(peer) => peers.push(peer),
            Err(reason) => missing.push(reason),
        }
    }
    (peers, missing)
}

/// The texts of the programs in C++.
const PEERS: &str = "benches/peers/peers.cpp";
const RIDE: &str = "benches/peers/ride.cpp";

fn cpp(name: &str, source: &str, flags: &[&str], last: &[&str]) -> Result<Command, String> {
    let program = Path::new(FOLDER).join(name);
    let mut compiler = Command::new("g++");
    compiler.args(FLAGS).args(flags).arg(source).args(last);
    run(compiler.arg("-o").arg(&program), name)?;
    Ok(Command::new(program))
}

/// CasADi's generated C, compiled separately.
fn casadi() -> Result<Command, String> {
    run(
        Command::new(python()).args(["benches/peers/casadi_model.py", FOLDER]),
        "casadi",
    )?;
    let [code, object] = ["casadi_model.c", "casadi_model.o"].map(|file| Path::new(FOLDER).join(file));
    let mut compiler = Command::new("gcc");
    run(
        compiler.args(&FLAGS[1..]).arg("-c").arg(code).arg("-o").arg(&object),
        "casadi",
    )?;
    let object = object.display().to_string();
    cpp("casadi", PEERS, &["-DCASADI", &format!("-I{FOLDER}")], &[&object])
}

fn scipy() -> Result<Command, String> {
    run(Command::new(python()).args(["-c", "import numpy, scipy"]), "scipy")?;
    let mut program = Command::new(python());
    program
        .arg("benches/peers/scipy_fit.py")
        .env("OPENBLAS_NUM_THREADS", "1");
    Ok(program)
}

/// The Python of the tests, if it exists.
fn python() -> PathBuf {
    let own = Path::new("target/python/bin/python");
    if own.exists() { own.into() } else { "python3".into() }
}

fn run(command: &mut Command, name: &str) -> Result<(), String> {
    let output = command.output().map_err(|error| format!("{name}: {error}"))?;
    let text = String::from_utf8_lossy(&output.stderr);
    let reason = text.lines().find(|line| line.contains("rror")).unwrap_or("it failed");
    if output.status.success() {
        Ok(())
    } else {
        Err(format!("{name}: {reason}"))
    }
}

/// The parameters of the subject, as text for the programs.
fn subject() -> Vec<String> {
    let parameters = MODEL.about().parameters.iter().zip(Subject::new(MODEL).p);
    parameters
        .map(|(parameter, value)| format!("set {} {value:?}", parameter.name))
        .collect()
}

/// Starts a program and sends it the data of its task.
fn start(
    name: &'static str,
    tasks: &'static [&'static str],
    lanes: usize,
    mut program: Command,
    told: &[String],
) -> Result<Peer, String> {
    let child = program.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn();
    let mut child = child.map_err(|error| format!("{name}: {error}"))?;
    let (to, from) = (
        child.stdin.take().expect("a pipe"),
        child.stdout.take().expect("a pipe"),
    );
    let mut talk = Talk {
        child,
        to,
        from: BufReader::new(from),
    };
    told.iter().for_each(|line| talk.say(line));
    Ok(Peer {
        name,
        tasks,
        lanes,
        talk: RefCell::new(talk),
    })
}

impl Peer {
    /// Sends it further data.
    pub fn tell(&self, line: &str) {
        self.talk.borrow_mut().say(line);
    }

    /// Seconds of processor time for `count` runs.
    pub fn time(&self, task: &str, count: usize) -> f64 {
        let mut talk = self.talk.borrow_mut();
        talk.say(&format!("time {task} {count}"));
        talk.line().parse().expect("a time")
    }

    /// Its results as words, line by line.
    pub fn shown(&self, task: &str) -> Vec<Vec<String>> {
        let mut talk = self.talk.borrow_mut();
        talk.say(&format!("show {task}"));
        let lines = std::iter::from_fn(|| Some(talk.line()).filter(|line| line != "end"));
        lines.map(|line| line.split(' ').map(String::from).collect()).collect()
    }
}

impl Talk {
    fn say(&mut self, line: &str) {
        writeln!(self.to, "{line}")
            .and_then(|()| self.to.flush())
            .expect("it listens");
    }

    fn line(&mut self) -> String {
        let mut line = String::new();
        let read = self.from.read_line(&mut line).expect("it answers");
        assert!(read > 0, "it has stopped");
        line.trim_end().into()
    }
}

impl Drop for Talk {
    fn drop(&mut self) {
        // The program is no longer needed; an error means that it has already ended.
        let _ = self.child.kill().and_then(|()| self.child.wait());
    }
}
