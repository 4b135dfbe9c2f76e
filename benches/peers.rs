//! Compares qcar with other programs on the same work: code written by hand, CasADi's C, Ceres, NumPy and SciPy, and
//! Boost.odeint for rides.
//!
//! `cargo bench --bench peers` builds what it can (g++, libceres-dev, libboost-dev; casadi, numpy and scipy for the
//! Python in `target/python`, else `python3`), reports what is missing, compares the results of each with those of
//! qcar, and times all of them in turn. The fastest round counts, since other programs on the machine have disturbed it
//! least. The other programs report their processor time; qcar is timed by the clock. `docs/benchmarks.md` has the
//! output. The tasks are identical: the vertical chain of axle_d of `benches/subject`, 300 lines, five accelerations
//! over the pad; the fit has qcar's residuals, bounds, starts and tolerances. A ride is that of `benches/cleat` without
//! a record.

// Programs of others.
#[path = "peers/child.rs"]
mod child;
// Their results.
#[path = "peers/judge.rs"]
mod judge;
// Their rides.
#[path = "peers/rides.rs"]
mod rides;

mod cleat;
mod fit;
mod subject;

use std::fs;
use std::hint::black_box;
use std::path::Path;
use std::time::Instant;

use child::Peer;
use qcar_dsl::disk::compile_file;
use qcar_machine::Machine;
use qcar_runtime::fit::Setup;
use qcar_runtime::model::{LANES, Model};
use subject::{MODEL, Sets, Subject};

/// Number of rounds of each task in each way.
const ROUNDS: usize = 100;

/// A way to do a task: its name, the number of results of a run, and a function that gives the seconds of a number of
/// runs.
struct Way<'a> {
    name: String,
    results: usize,
    time: Box<dyn FnMut(usize) -> f64 + 'a>,
}

fn main() {
    let from_disk = compile_file(Path::new(""), "benches/subject/axle_d_z.axle").expect("the model can be read");
    let compiled = from_disk.compiled.expect("the model compiles");
    let (machine, narrow) = (Machine::new(&compiled), Machine::with_avx(&compiled));
    let (peers, missing) = child::all();
    for reason in missing {
        println!("left out: {reason}");
    }
    println!("{}, one thread, the fastest of {ROUNDS} rounds in turn\n", processor());
    println!("| task | by | time | qcar / it | differs from qcar by |\n|---|---|---|---|---|");
    let models: [(&str, &dyn Model); 3] = [
        ("qcar", MODEL),
        ("qcar, from a file", &machine),
        ("qcar, from a file, AVX alone", &narrow),
    ];
    let linear = models.map(|(name, model)| way(name, 1, subject(model, Subject::linearise)));
    let of_sets = |suffix: &'static str, work: fn(&mut Sets)| {
        models.map(|(name, model)| {
            let mut sets = Sets::new(model);
            let work = move || work(black_box(&mut sets));
            way(&format!("{name}, eight sets{suffix}"), LANES, work)
        })
    };
    let sets = of_sets("", |sets| sets.linearise());
    table(
        "A, B, C, D and all Jacobians",
        "matrices",
        20_000,
        linear.into_iter().chain(sets),
        &peers,
    );
    let responses = models.map(|(name, model)| way(name, 1, subject(model, Subject::respond)));
    table(
        "300 lines, 5 channels, Jacobian",
        "response",
        50,
        responses
            .into_iter()
            .chain(of_sets(", four lines at a time", |sets| sets.respond())),
        &peers,
    );
    let (plan, levels) = (fit::plan(), [fit::level()]);
    let setups = models.map(|(name, model)| {
        (
            name,
            Setup::new(model, &plan, &levels).expect("the plan suits the model"),
        )
    });
    let fits = setups.each_ref().map(|(name, setup)| {
        let start = setup.start();
        way(name, 1, move || drop(black_box(setup.local(black_box(&start)))))
    });
    table("fit of 12 parameters", "fit", 1, fits.into_iter(), &peers);
    let axle = models::axle_d::AxleD;
    let rides = [
        way("qcar", 1, rides::alone(&axle)),
        way("qcar, 32 rides abreast", rides::ABREAST, rides::abreast(&axle)),
    ];
    table(
        "cleat run of 1 s without a record",
        "ride",
        1,
        rides.into_iter(),
        &peers,
    );
}

fn subject<'a>(model: &'a dyn Model, work: fn(&mut Subject<'a>)) -> impl FnMut() + 'a {
    let mut subject = Subject::new(model);
    move || work(black_box(&mut subject))
}

/// Time of a function of this program, by the clock: the processor time of a thread is too coarse for short times.
fn way<'a>(name: &str, results: usize, mut work: impl FnMut() + 'a) -> Way<'a> {
    let time = move |count| {
        let start = Instant::now();
        (0..count).for_each(|_| work());
        start.elapsed().as_secs_f64()
    };
    Way {
        name: name.into(),
        results,
        time: Box::new(time),
    }
}

/// The rows of a task, with times relative to the first way.
fn table<'a>(title: &str, task: &'static str, count: usize, own: impl Iterator<Item = Way<'a>>, peers: &'a [Peer]) {
    let others = peers.iter().filter(|peer| peer.tasks.contains(&task));
    let theirs = others.clone().map(|peer| Way {
        name: peer.name.into(),
        results: if task == "matrices" { peer.lanes } else { 1 },
        time: Box::new(move |count| peer.time(task, count)),
    });
    let mut ways: Vec<Way> = own.chain(theirs).collect();
    let mut fastest = vec![f64::MAX; ways.len()];
    for _ in 0..ROUNDS {
        for (way, fastest) in ways.iter_mut().zip(&mut fastest) {
            *fastest = fastest.min((way.time)(count) / (count * way.results) as f64);
        }
    }
    let own = ways.len() - others.clone().count();
    let first = if task == "ride" {
        rides::difference(None)
    } else {
        String::new()
    };
    let differences = std::iter::once(first)
        .chain((1..own).map(|_| String::new()))
        .chain(others.map(|peer| match task {
            "ride" => rides::difference(Some(peer)),
            _ => judge::difference(task, peer),
        }));
    for ((way, time), difference) in ways.iter().zip(&fastest).zip(differences) {
        let ratio = fastest[0] / time;
        println!(
            "| {title} | {} | {} | {ratio:.3} | {difference} |",
            way.name,
            shown(*time)
        );
    }
}

fn shown(seconds: f64) -> String {
    match seconds {
        _ if seconds < 1e-6 => format!("{:.1} ns", 1e9 * seconds),
        _ if seconds < 1e-3 => format!("{:.1} µs", 1e6 * seconds),
        _ => format!("{:.2} ms", 1e3 * seconds),
    }
}

/// The name of the processor, as Linux reports it.
fn processor() -> String {
    let text = fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let line = text.lines().find(|line| line.starts_with("model name"));
    let name = line.and_then(|line| line.split_once(": "));
    name.map_or("a processor without a name".into(), |(_, name)| name.into())
}
