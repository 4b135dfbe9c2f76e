//! The C99 of a model, compiled by gcc without a warning, gives the evaluator's bits: on random parameters, states and
//! inputs, for every shipped model, every operation of the language and every mechanism.

use std::fs;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Stdio};

use qcar_dsl::c::{self, motion_kinks};
use qcar_dsl::disk::compile_file;
use qcar_dsl::evaluate::Evaluator;
use qcar_dsl::schedule::Compiled;
use qcar_runtime::model::{About, Contact, Model as _, ResponseMut};

/// No operations are fused, so every operation rounds as in the evaluator.
const FLAGS: [&str; 7] = [
    "-std=c99",
    "-Wall",
    "-Wextra",
    "-Werror",
    "-pedantic",
    "-O2",
    "-ffp-contract=off",
];

/// Points at which a model is compared.
const POINTS: usize = 40;

#[test]
fn shipped_models_give_the_same_bits_in_c() {
    let files: Vec<String> = models::all().iter().map(|shipped| shipped.file.to_string()).collect();
    assert!(files.len() >= 16);
    compare_all(&files);
}

#[test]
fn every_operation_and_every_law_gives_the_same_bits_in_c() {
    let files = fs::read_dir("tests/zoo").unwrap().map(|entry| entry.unwrap().path());
    let files: Vec<String> = files.map(|path| path.to_str().unwrap().to_string()).collect();
    assert!(files.iter().any(|file| file.ends_with("laws.axle")));
    compare_all(&files);
}

fn compare_all(files: &[String]) {
    if Command::new("gcc").arg("--version").output().is_err() {
        // Written directly, since the test harness captures standard output.
        let mut out = std::io::stderr();
        writeln!(
            out,
            "not checked: generated C, since gcc is absent (apt-get install gcc)"
        )
        .unwrap();
        return;
    }
    for file in files {
        let compiled = compile_file(Path::new(""), file).unwrap().compiled.unwrap();
        compare(file, &compiled);
    }
}

fn compare(file: &str, compiled: &Compiled) {
    let folder = tempfile::tempdir().unwrap();
    let program = built(compiled, folder.path());
    let points: Vec<Point> = (0..POINTS)
        .map(|point| Point::random(&compiled.about, point as u64))
        .collect();
    let given: Vec<u8> = points
        .iter()
        .flat_map(|point| point.numbers())
        .flat_map(f64::to_le_bytes)
        .collect();
    let mut child = Command::new(program)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut stdin = child.stdin.take().unwrap();
    let writer = std::thread::spawn(move || stdin.write_all(&given).unwrap());
    let output = child.wait_with_output().unwrap();
    writer.join().unwrap();
    assert!(output.status.success());
    let (numbers, rest) = output.stdout.as_chunks::<8>();
    assert!(rest.is_empty());
    let in_c: Vec<f64> = numbers.iter().map(|&bytes| f64::from_le_bytes(bytes)).collect();
    let evaluator = Evaluator::new(compiled);
    let kinks = motion_kinks(compiled).outputs.len();
    let mut expected = Vec::new();
    for point in &points {
        point.evaluate(&evaluator, &mut expected);
    }
    assert_eq!(in_c.len(), expected.len() + POINTS * kinks, "{file}");
    let each = expected.len() / POINTS;
    for (point, found) in in_c.chunks_exact(each + kinks).enumerate() {
        for (place, (a, b)) in found.iter().zip(&expected[point * each..][..each]).enumerate() {
            let equal = a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan());
            assert!(
                equal,
                "{file}, point {point}, value {place}: {a:e} in C, {b:e} in the evaluator"
            );
        }
    }
}

/// The arguments of a function.
struct Point {
    p: Vec<f64>,
    x: Vec<f64>,
    u: Vec<f64>,
    omega: f64,
    contact: [f64; 4],
}

impl Point {
    fn random(about: &About, seed: u64) -> Point {
        let mut state = seed
            .wrapping_mul(0x9e37_79b9_7f4a_7c15)
            .wrapping_add(0x1234_5678_9abc_def1);
        // Steele, Lea, Flood: splitmix64, 2014; from -1 to 1.
        let mut next = || {
            state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
            let a = (state ^ (state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            let b = (a ^ (a >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
            ((b ^ (b >> 31)) >> 11) as f64 / (1u64 << 52) as f64 - 1.0
        };
        Point {
            p: about.parameters.iter().map(|_| 10f64.powf(2.0 * next())).collect(),
            x: about.states.iter().map(|_| next()).collect(),
            u: about.inputs.iter().map(|_| next()).collect(),
            omega: 50.0 + 49.0 * next(),
            contact: [next(), next(), next(), next()],
        }
    }

    fn numbers(&self) -> Vec<f64> {
        [&self.p[..], &self.x, &self.u, &[self.omega], &self.contact].concat()
    }

    /// The output of the C program, without the kinks.
    fn evaluate(&self, evaluator: &Evaluator, into: &mut Vec<f64>) {
        let about = evaluator.about();
        let Point { p, x, u, .. } = self;
        let mut constants = vec![0.0; about.constants];
        evaluator.prepare(p, &mut constants);
        let mut write = |length: usize, compute: &dyn Fn(&mut [f64])| {
            let from = into.len();
            into.resize(from + length, 0.0);
            compute(&mut into[from..]);
        };
        write(about.states.len(), &|to| evaluator.derivative(&constants, x, u, to));
        write(about.outputs.len(), &|to| evaluator.outputs(&constants, x, u, to));
        write(about.matrices.len(), &|to| evaluator.matrices(p, x, u, to));
        write(about.sensitivities.len(), &|to| evaluator.sensitivities(p, x, u, to));
        write(about.parameter_jacobian.len(), &|to| {
            evaluator.parameter_jacobian(p, x, u, to)
        });
        for (excitation, layout) in about.responses.iter().enumerate() {
            let (n, m) = (layout.outputs.len(), layout.jacobian.len());
            let respond = |to: &mut [f64], jacobian: bool| {
                let (re, rest) = to.split_at_mut(n);
                let (im, rest) = rest.split_at_mut(n);
                let slopes = rest.split_at_mut(if jacobian { m } else { 0 });
                let jacobian = jacobian.then_some(slopes);
                evaluator.response(excitation, &constants, &[self.omega], ResponseMut { re, im, jacobian });
            };
            write(2 * n, &|to| respond(to, false));
            write(2 * (n + m), &|to| respond(to, true));
        }
        if about.contact.is_some() {
            let [s, v, z, along] = self.contact;
            let contact = Contact {
                s,
                v,
                force: [z, along],
            };
            write(1, &|to| to[0] = evaluator.contact_force(&constants, x, s, v));
            write(about.states.len(), &|to| {
                evaluator.rolling_derivative(&constants, x, u, &contact, to)
            });
            write(about.outputs.len(), &|to| {
                evaluator.rolling_outputs(&constants, x, u, &contact, to)
            });
        }
    }
}

/// Compiles a model with a program that reads points and writes the results of each function.
fn built(compiled: &Compiled, folder: &Path) -> std::path::PathBuf {
    let about = &compiled.about;
    let values = vec![1.0; about.parameters.len()];
    let c::Sources { header, source } = c::sources(compiled, &values, "model");
    fs::write(folder.join("model.h"), header).unwrap();
    fs::write(folder.join("model.c"), source).unwrap();
    fs::write(folder.join("main.c"), main(about)).unwrap();
    let files = ["main.c", "model.c", "-o", "program", "-lm"];
    let output = Command::new("gcc")
        .args(FLAGS)
        .args(files)
        .current_dir(folder)
        .output()
        .unwrap();
    assert!(
        output.status.success(),
        "{}\n{}",
        about.name,
        String::from_utf8_lossy(&output.stderr)
    );
    folder.join("program")
}

fn main(about: &About) -> String {
    let name = &about.name;
    let mut calls = format!(
        "{name}_derivative(constants, x, u, out); write(STATES);
        {name}_outputs(constants, x, u, out); write(OUTPUTS);
        {name}_matrices(p, x, u, out); write(MATRICES);
        {name}_sensitivities(p, x, u, out); write(SENSITIVITIES);
        {name}_parameter_jacobian(p, x, u, out); write(PARAMETER_JACOBIAN);\n"
    );
    for (excitation, layout) in about.excitations.iter().zip(about.responses.iter()) {
        let function = format!("{name}_response_{}_{}", excitation.axis, excitation.name);
        let (n, m) = (layout.outputs.len(), layout.jacobian.len());
        calls += &format!(
            "{function}(constants, *omega, out); fwrite(out, 8, {}, stdout);\n",
            2 * n
        );
        calls += &format!(
            "{function}_jacobian(constants, *omega, out); fwrite(out, 8, {}, stdout);\n",
            2 * (n + m)
        );
    }
    if about.contact.is_some() {
        calls += &format!(
            "{name}_contact contact; memcpy(&contact, tyre, sizeof contact);
            {name}_contact_force(constants, x, contact.s, contact.v, out); fwrite(out, 8, 1, stdout);
            {name}_rolling_derivative(constants, x, u, contact, out); write(STATES);
            {name}_rolling_outputs(constants, x, u, contact, out); write(OUTPUTS);\n"
        );
    }
    let upper = name.to_uppercase();
    format!(
        "#include \"model.h\"
#include <stdio.h>
#include <string.h>
#define write(what) fwrite(out, 8, {upper}_##what, stdout)
static double out[{upper}_SENSITIVITIES + {upper}_MATRICES + {upper}_PARAMETER_JACOBIAN + {upper}_LONGEST_RESPONSE + 1000];
static double given[{upper}_PARAMETERS + {upper}_STATES + {upper}_INPUTS + 5], constants[{upper}_CONSTANTS + 1];
int main(void)
{{
    const double *p = given, *x = p + {upper}_PARAMETERS, *u = x + {upper}_STATES;
    const double *omega = u + {upper}_INPUTS, *tyre = omega + 1;
    while (fread(given, sizeof given, 1, stdin) == 1) {{
        (void)tyre;
        {name}_prepare(p, constants);
        {calls}
        {name}_kinks(constants, x, u, out); write(KINKS);
    }}
    return 0;
}}
"
    )
}
