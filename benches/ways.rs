//! Compares the ways to run a model: generated code, machine code of a file that is read, and the interpreter.
//!
//! Each task runs in each way in turn, round by round. The table has the fastest round of each and its ratio to
//! generated code; other programs on the machine disturb both equally. `docs/benchmarks.md` has the output.

mod cleat;
mod fit;
mod subject;

use std::hint::black_box;
use std::path::Path;
use std::time::{Duration, Instant};

use qcar_dsl::disk::compile_file;
use qcar_dsl::evaluate::Evaluator;
use qcar_dsl::schedule::Compiled;
use qcar_machine::Machine;
use qcar_runtime::fit::Setup;
use qcar_runtime::model::{Contact, LANES, Model, ResponseMut};
use qcar_runtime::simulate::{Car, Settings, end_of_ride, ride};
use subject::{MODEL, Sets, Subject};

/// Number of rounds of each task in each way.
const ROUNDS: usize = 300;

/// The timed tasks.
type Work<'a> = Box<dyn FnMut() + 'a>;

fn main() {
    let [axle_d_z, axle_d] = ["benches/subject/axle_d_z.axle", "models/axles/axle_d.axle"].map(compiled);
    translation("axle_d, vertical", &axle_d_z);
    translation("axle_d", &axle_d);
    println!("| task | generated | machine code | ratio | interpreted | ratio |\n|---|---|---|---|---|---|");
    let (machine, interpreted) = (Machine::new(&axle_d_z), Evaluator::new(&axle_d_z));
    let ways: [&dyn Model; 3] = [MODEL, &machine, &interpreted];
    row("A, B, C, D and all Jacobians", 2000, ways.map(linearise));
    row("the same of eight sets", 500, ways.map(linearise_sets));
    row("300 lines, 5 channels, Jacobian", 10, ways.map(respond));
    row(
        "the same of eight sets, four lines at a time",
        2,
        ways.map(respond_sets),
    );
    row("equations of motion", 10_000, ways.map(move_once));
    let (plan, levels) = (fit::plan(), [fit::level()]);
    let setups = ways.map(|model| Setup::new(model, &plan, &levels).expect("the plan suits the model"));
    let fits = setups.each_ref().map(|setup| -> Work<'_> {
        let start = setup.start();
        Box::new(move || drop(black_box(setup.local(black_box(&start)))))
    });
    row("fit of 12 parameters", 1, fits);
    let (machine, interpreted) = (Machine::new(&axle_d), Evaluator::new(&axle_d));
    let parameters = cleat::parameters();
    for (task, recorded) in [
        ("cleat run without a record", false),
        ("cleat run with its record", true),
    ] {
        let generated = ride_on(cleat::car(&parameters), recorded);
        let [machine, interpreted] =
            [&machine as &dyn Model, &interpreted].map(|model| ride_on(cleat::on_tyre(model, &parameters), recorded));
        row(task, 1, [generated, machine, interpreted]);
    }
}

fn compiled(file: &str) -> Compiled {
    let from_disk = compile_file(Path::new(""), file).expect("the model can be read");
    from_disk.compiled.expect("the model compiles")
}

/// Prints the time until all programs of a model have run once, and until the interpreter can begin.
fn translation(name: &str, compiled: &Compiled) {
    let first = (0..20).map(|_| {
        let machine = Machine::new(compiled);
        let start = Instant::now();
        everything(&machine);
        let whole = start.elapsed();
        let again = Instant::now();
        everything(&machine);
        whole.saturating_sub(again.elapsed())
    });
    let first = first.min().unwrap_or_default();
    let ordered = (0..20).map(|_| {
        let start = Instant::now();
        black_box(Evaluator::new(compiled));
        start.elapsed()
    });
    let ordered = ordered.min().unwrap_or_default();
    println!("{name}: all programs translated in {first:.1?}, ordered for the interpreter in {ordered:.1?}");
}

/// Each function of a model once, at one point, for sets and over lines.
fn everything(model: &dyn Model) {
    let about = model.about();
    let room = |length: usize| vec![1.0; length];
    let rows = |length: usize| vec![[1.0; LANES]; length];
    let (p, x, u) = (
        room(about.parameters.len()),
        room(about.states.len()),
        room(about.inputs.len()),
    );
    let (mut constants, mut dx, mut y) = (room(about.constants), room(x.len()), room(about.outputs.len()));
    model.prepare(&p, &mut constants);
    model.derivative(&constants, &x, &u, &mut dx);
    model.outputs(&constants, &x, &u, &mut y);
    model.matrices(&p, &x, &u, &mut room(about.matrices.len()));
    model.sensitivities(&p, &x, &u, &mut room(about.sensitivities.len()));
    model.parameter_jacobian(&p, &x, &u, &mut room(about.parameter_jacobian.len()));
    let contact = Contact::default();
    model.rolling_derivative(&constants, &x, &u, &contact, &mut dx);
    model.rolling_outputs(&constants, &x, &u, &contact, &mut y);
    let (ps, xs, us) = (rows(p.len()), rows(x.len()), rows(u.len()));
    model.prepare_sets(&ps, &mut rows(about.constants));
    let of_sets = rows(about.constants);
    model.derivative_sets(&rows(about.constants), &xs, &us, &mut rows(x.len()));
    model.matrices_sets(&ps, &xs, &us, &mut rows(about.matrices.len()));
    model.sensitivities_sets(&ps, &xs, &us, &mut rows(about.sensitivities.len()));
    for (excitation, layout) in about.responses.iter().enumerate() {
        for wanted in [false, true] {
            let [n, m] = [layout.outputs.len(), layout.jacobian.len()].map(|rows| LANES * rows);
            let (re, im, d_re, d_im) = (&mut room(n)[..], &mut room(n)[..], &mut room(m)[..], &mut room(m)[..]);
            let jacobian = wanted.then_some((d_re, d_im));
            model.response(excitation, &constants, &[1.0; LANES], ResponseMut { re, im, jacobian });
            model.response_sets(excitation, &of_sets, &[1.0], wanted, &mut rows(layout.rows(wanted)));
        }
    }
}

fn linearise(model: &dyn Model) -> Work<'_> {
    let mut subject = Subject::new(model);
    Box::new(move || black_box(&mut subject).linearise())
}

fn linearise_sets(model: &dyn Model) -> Work<'_> {
    let mut sets = Sets::new(model);
    Box::new(move || black_box(&mut sets).linearise())
}

fn respond(model: &dyn Model) -> Work<'_> {
    let mut subject = Subject::new(model);
    Box::new(move || black_box(&mut subject).respond())
}

fn respond_sets(model: &dyn Model) -> Work<'_> {
    let mut sets = Sets::new(model);
    Box::new(move || black_box(&mut sets).respond())
}

fn move_once(model: &dyn Model) -> Work<'_> {
    let subject = Subject::new(model);
    let mut dx = vec![0.0; subject.x.len()];
    Box::new(move || {
        model.derivative(
            black_box(&subject.constants),
            &subject.x,
            &subject.u,
            black_box(&mut dx),
        )
    })
}

fn ride_on<'a, M: Model + ?Sized>(car: Car<'a, M>, recorded: bool) -> Work<'a> {
    let road = cleat::cleat(0.03);
    Box::new(move || {
        let (drive, settings) = (cleat::drive(&road, 30.0 / 3.6), Settings::default());
        if recorded {
            drop(black_box(ride(&car, &drive, &settings).expect("it rides")));
        } else {
            black_box(end_of_ride(&car, &drive, &settings).expect("it rides"));
        }
    })
}

/// Times a task in each way, `count` times in a round.
fn row(task: &str, times: u32, mut ways: [Work; 3]) {
    let mut fastest = [Duration::MAX; 3];
    for _ in 0..ROUNDS {
        for (work, fastest) in ways.iter_mut().zip(&mut fastest) {
            let start = Instant::now();
            (0..times).for_each(|_| work());
            *fastest = start.elapsed().min(*fastest);
        }
    }
    let [generated, machine, interpreted] = fastest.map(|time| time.as_secs_f64() / f64::from(times) * 1e6);
    let (ours, theirs) = (machine / generated, interpreted / generated);
    println!("| {task} | {generated:.4} µs | {machine:.4} µs | {ours:.2} | {interpreted:.4} µs | {theirs:.2} |");
}
