//! All 27 nonlinear regressions of NIST's Statistical Reference Datasets, from both starts. The files are those of
//! NIST: what is certified, the starts and the data are read from them, and only the models are written here.

use std::f64::consts::PI;
use std::fs;
use std::path::{Path, PathBuf};

use qcar_runtime::least_squares::Outcome;
use qcar_runtime::least_squares::information::Information;

use super::dual::Dual;
use super::unbounded;

/// Response over one or two predictors.
type Model = fn(&[Dual], &[f64]) -> Dual;

/// The models, in the words of the files.
const MODELS: [(&str, Model); 27] = [
    ("Bennett5", |b, x| b[0] * (b[1] + x[0]).powf(-1.0 / b[2])),
    ("BoxBOD", saturation),
    ("Chwirut1", ultrasonic),
    ("Chwirut2", ultrasonic),
    ("DanWood", |b, x| b[0] * Dual::from(x[0]).powf(b[1])),
    ("ENSO", |b, x| {
        let year = 2.0 * PI * x[0] / 12.0;
        let cycle = |period: Dual, cosine: Dual, sine: Dual| {
            let angle = 2.0 * PI * x[0] / period;
            cosine * angle.cos() + sine * angle.sin()
        };
        b[0] + b[1] * year.cos() + b[2] * year.sin() + cycle(b[3], b[4], b[5]) + cycle(b[6], b[7], b[8])
    }),
    ("Eckerle4", |b, x| {
        b[0] / b[1] * (-0.5 * square((x[0] - b[2]) / b[1])).exp()
    }),
    ("Gauss1", two_peaks),
    ("Gauss2", two_peaks),
    ("Gauss3", two_peaks),
    ("Hahn1", cubic_by_cubic),
    ("Kirby2", |b, x| {
        (b[0] + b[1] * x[0] + b[2] * x[0] * x[0]) / (1.0 + b[3] * x[0] + b[4] * x[0] * x[0])
    }),
    ("Lanczos1", three_decays),
    ("Lanczos2", three_decays),
    ("Lanczos3", three_decays),
    ("MGH09", |b, x| {
        let square = x[0] * x[0];
        b[0] * (square + x[0] * b[1]) / (square + x[0] * b[2] + b[3])
    }),
    ("MGH10", |b, x| b[0] * (b[1] / (x[0] + b[2])).exp()),
    ("MGH17", |b, x| {
        b[0] + b[1] * (-x[0] * b[3]).exp() + b[2] * (-x[0] * b[4]).exp()
    }),
    ("Misra1a", saturation),
    ("Misra1b", |b, x| b[0] * (1.0 - 1.0 / square(1.0 + b[1] * x[0] / 2.0))),
    ("Misra1c", |b, x| b[0] * (1.0 - (1.0 + 2.0 * b[1] * x[0]).powf(-0.5))),
    ("Misra1d", |b, x| b[0] * b[1] * x[0] / (1.0 + b[1] * x[0])),
    ("Nelson", |b, x| b[0] - b[1] * x[0] * (-b[2] * x[1]).exp()),
    ("Rat42", |b, x| b[0] / (1.0 + (b[1] - b[2] * x[0]).exp())),
    ("Rat43", |b, x| {
        b[0] / (1.0 + (b[1] - b[2] * x[0]).exp()).powf(1.0 / b[3])
    }),
    ("Roszman1", |b, x| {
        b[0] - b[1] * x[0] - (b[2] / (x[0] - b[3])).atan() / PI
    }),
    ("Thurber", cubic_by_cubic),
];

fn square(value: Dual) -> Dual {
    value * value
}

fn saturation(b: &[Dual], x: &[f64]) -> Dual {
    b[0] * (1.0 - (-b[1] * x[0]).exp())
}

fn ultrasonic(b: &[Dual], x: &[f64]) -> Dual {
    (-b[0] * x[0]).exp() / (b[1] + b[2] * x[0])
}

fn two_peaks(b: &[Dual], x: &[f64]) -> Dual {
    let peak = |height: Dual, at: Dual, width: Dual| height * (-square((x[0] - at) / width)).exp();
    b[0] * (-b[1] * x[0]).exp() + peak(b[2], b[3], b[4]) + peak(b[5], b[6], b[7])
}

fn three_decays(b: &[Dual], x: &[f64]) -> Dual {
    let decay = |height: Dual, rate: Dual| height * (-rate * x[0]).exp();
    decay(b[0], b[1]) + decay(b[2], b[3]) + decay(b[4], b[5])
}

fn cubic_by_cubic(b: &[Dual], x: &[f64]) -> Dual {
    let x = x[0];
    (b[0] + b[1] * x + b[2] * x * x + b[3] * x * x * x) / (1.0 + b[4] * x + b[5] * x * x + b[6] * x * x * x)
}

/// What a file of NIST says.
struct Certified {
    starts: [Vec<f64>; 2],
    estimate: Vec<f64>,
    error: Vec<f64>,
    /// Of the residuals.
    sum_of_squares: f64,
    /// Response, then predictors.
    rows: Vec<Vec<f64>>,
}

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("least_squares/nist")
}

fn numbers(text: &str) -> Vec<f64> {
    text.split_whitespace().map(|word| word.parse().unwrap()).collect()
}

fn certified(name: &str) -> Certified {
    let text = fs::read_to_string(folder().join(name).with_extension("dat")).unwrap();
    let (head, data) = text.rsplit_once("Data:").unwrap();
    let of_parameters = head
        .lines()
        .filter_map(|line| line.split_once(" =").filter(|_| line.starts_with("  b")));
    let table: Vec<Vec<f64>> = of_parameters.map(|(_, values)| numbers(values)).collect();
    let column = |at: usize| table.iter().map(|row| row[at]).collect();
    let sum_of_squares = head.split_once("Residual Sum of Squares:").unwrap().1;
    Certified {
        starts: [column(0), column(1)],
        estimate: column(2),
        error: column(3),
        sum_of_squares: numbers(sum_of_squares.lines().next().unwrap())[0],
        rows: data
            .lines()
            .skip(1)
            .map(numbers)
            .filter(|row| !row.is_empty())
            .collect(),
    }
}

/// The residuals of a model; Nelson's response is the logarithm of what was measured.
fn residual<'a>(name: &str, model: Model, rows: &'a [Vec<f64>]) -> impl Fn(&[Dual], usize) -> Dual + 'a {
    let logarithmic = name == "Nelson";
    move |b, at| {
        let (response, predictors) = rows[at].split_first().unwrap();
        let response = if logarithmic { response.ln() } else { *response };
        model(b, predictors) - response
    }
}

/// Standard errors of an ordinary regression.
fn standard_errors(outcome: &Outcome) -> Vec<f64> {
    let (rows, columns) = outcome.jacobian.shape();
    let information = Information::new(&outcome.jacobian, &vec![true; columns]);
    let variance = 2.0 * outcome.cost / (rows - columns) as f64;
    (0..columns)
        .map(|k| (variance * information.inverse()[(k, k)]).sqrt())
        .collect()
}

/// Correct digits of the worst value: the negative logarithm of the relative error.
fn digits(values: &[f64], certified: &[f64]) -> f64 {
    let each = values
        .iter()
        .zip(certified)
        .map(|(value, certified)| -((value - certified) / certified).abs().log10());
    each.fold(f64::INFINITY, f64::min)
}

#[test]
fn every_file_has_its_model() {
    let mut files: Vec<String> = fs::read_dir(folder())
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "dat"))
        .map(|path| path.file_stem().unwrap().to_str().unwrap().to_string())
        .collect();
    files.sort();
    assert_eq!(files, MODELS.map(|(name, _)| name.to_string()));
}

/// Its data obey the model to the 14 digits that they have. What is left of them, and the standard errors, are rounding
/// errors.
const EXACT: &str = "Lanczos1";

/// A number in a file or a term of a model that is wrong changes it. Both are certified to eleven digits, of which
/// rounding and the estimate's last digit cost one.
#[test]
fn the_sum_of_squares_at_the_certified_estimate_is_the_certified_one() {
    for (name, model) in MODELS {
        let certified = certified(name);
        let b: Vec<Dual> = certified.estimate.iter().map(|&value| value.into()).collect();
        let residual = residual(name, model, &certified.rows);
        let squares = (0..certified.rows.len()).map(|at| residual(&b, at).0.powi(2));
        let squares: f64 = squares.sum();
        if name == EXACT {
            assert!(squares < 1e-20, "{squares}");
        } else {
            let found = digits(&[squares], &[certified.sum_of_squares]);
            assert!(found > 9.5, "{name}: {found:.1} digits");
        }
    }
}

/// To six digits, as solvers are compared by these data; most have eight or more.
#[test]
fn all_54_fits_have_the_certified_values() {
    for (name, model) in MODELS {
        let certified = certified(name);
        for start in &certified.starts {
            let outcome = unbounded(certified.rows.len(), start, residual(name, model, &certified.rows));
            let estimate = digits(&outcome.x, &certified.estimate);
            let error = digits(&standard_errors(&outcome), &certified.error);
            assert!(outcome.stop.converged(), "{name} from {start:?}: {:?}", outcome.stop);
            assert!(
                estimate > 6.0,
                "{name} from {start:?}: estimates to {estimate:.1} digits"
            );
            assert!(
                name == EXACT || error > 6.0,
                "{name} from {start:?}: errors to {error:.1} digits"
            );
        }
    }
}
