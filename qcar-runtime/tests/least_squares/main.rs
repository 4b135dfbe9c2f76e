//! The least-squares solver against published problems: certified estimates and standard errors (NIST Statistical
//! Reference Datasets, nonlinear regression) and the collection of Moré, Garbow & Hillstrom, "Testing unconstrained
//! optimization software", ACM TOMS 7 (1981), with and without bounds.

use nalgebra::DMatrix;
use qcar_runtime::least_squares::information::Information;
use qcar_runtime::least_squares::{Bounds, Options, Outcome, Problem, Stop, minimize};

/// Residuals of one kind, written with a number type that carries derivatives, so that no Jacobian is typed by hand.
struct Functions<F> {
    variables: usize,
    residuals: usize,
    residual: F,
}

/// A value and its derivative along one variable.
#[derive(Clone, Copy)]
struct Dual(f64, f64);

impl From<f64> for Dual {
    fn from(value: f64) -> Self {
        Dual(value, 0.0)
    }
}

impl Dual {
    fn exp(self) -> Self {
        Dual(self.0.exp(), self.0.exp() * self.1)
    }

    fn recip(self) -> Self {
        Dual(1.0 / self.0, -self.1 / (self.0 * self.0))
    }
}

macro_rules! operator {
    ($trait:ident, $method:ident, |$a:ident, $b:ident| $result:expr) => {
        impl<T: Into<Dual>> std::ops::$trait<T> for Dual {
            type Output = Dual;
            fn $method(self, other: T) -> Dual {
                let ($a, $b) = (self, other.into());
                $result
            }
        }
    };
}

operator!(Add, add, |a, b| Dual(a.0 + b.0, a.1 + b.1));
operator!(Sub, sub, |a, b| Dual(a.0 - b.0, a.1 - b.1));
operator!(Mul, mul, |a, b| Dual(a.0 * b.0, a.1 * b.0 + a.0 * b.1));

impl<F: Fn(&[Dual], usize) -> Dual> Problem for Functions<F> {
    fn variables(&self) -> usize {
        self.variables
    }

    fn residuals(&self) -> usize {
        self.residuals
    }

    fn evaluate(&mut self, x: &[f64], residual: &mut [f64], jacobian: &mut [f64]) {
        for column in 0..self.variables {
            let seeded: Vec<Dual> = x
                .iter()
                .enumerate()
                .map(|(k, &value)| Dual(value, f64::from(u8::from(k == column))))
                .collect();
            for row in 0..self.residuals {
                let value = (self.residual)(&seeded, row);
                residual[row] = value.0;
                jacobian[column * self.residuals + row] = value.1;
            }
        }
    }
}

const TIGHT: Options = Options {
    gradient: 1e-12,
    cost: 1e-15,
    step: 1e-12,
    evaluations: 2000,
};

fn solve<F: Fn(&[Dual], usize) -> Dual>(residuals: usize, start: &[f64], bounds: &Bounds, residual: F) -> Outcome {
    minimize(
        &mut Functions {
            variables: start.len(),
            residuals,
            residual,
        },
        start,
        bounds,
        &TIGHT,
    )
}

fn unbounded<F: Fn(&[Dual], usize) -> Dual>(residuals: usize, start: &[f64], residual: F) -> Outcome {
    solve(residuals, start, &Bounds::none(start.len()), residual)
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

#[track_caller]
fn assert_close(actual: &[f64], expected: &[f64], relative: f64) {
    for (actual, expected) in actual.iter().zip(expected) {
        let size = if *expected == 0.0 { 1.0 } else { expected.abs() };
        assert!(
            (actual - expected).abs() <= relative * size,
            "{actual} is not {expected}"
        );
    }
}

/// Every certified figure, from both published starts.
#[track_caller]
fn certified<F>(x: &[f64], y: &[f64], starts: [&[f64]; 2], estimate: &[f64], error: &[f64], model: F)
where
    F: Fn(&[Dual], f64) -> Dual,
{
    for start in starts {
        let outcome = unbounded(x.len(), start, |b, row| model(b, x[row]) - y[row]);
        assert!(
            outcome.stop.converged(),
            "{:?} after {}",
            outcome.stop,
            outcome.evaluations
        );
        assert_close(&outcome.x, estimate, 1e-7);
        assert_close(&standard_errors(&outcome), error, 1e-6);
    }
}

#[test]
fn nist_mgh10() {
    let x: Vec<f64> = (0..16).map(|k| 50.0 + 5.0 * f64::from(k)).collect();
    let y = [
        34780.0, 28610.0, 23650.0, 19630.0, 16370.0, 13720.0, 11540.0, 9744.0, 8261.0, 7030.0, 6005.0, 5147.0, 4427.0,
        3820.0, 3307.0, 2872.0,
    ];
    certified(
        &x,
        &y,
        [&[2.0, 400000.0, 25000.0], &[0.02, 4000.0, 250.0]],
        &[5.6096364710E-03, 6.1813463463E+03, 3.4522363462E+02],
        &[1.5687892471E-04, 2.3309021107E+01, 7.8486103508E-01],
        |b, x| b[0] * (b[1] * (b[2] + x).recip()).exp(),
    );
}

#[test]
fn nist_thurber() {
    let x = [
        -3.067, -2.981, -2.921, -2.912, -2.840, -2.797, -2.702, -2.699, -2.633, -2.481, -2.363, -2.322, -1.501, -1.460,
        -1.274, -1.212, -1.100, -1.046, -0.915, -0.714, -0.566, -0.545, -0.400, -0.309, -0.109, -0.103, 0.010, 0.119,
        0.377, 0.790, 0.963, 1.006, 1.115, 1.572, 1.841, 2.047, 2.200,
    ];
    let y = [
        80.574, 84.248, 87.264, 87.195, 89.076, 89.608, 89.868, 90.101, 92.405, 95.854, 100.696, 101.060, 401.672,
        390.724, 567.534, 635.316, 733.054, 759.087, 894.206, 990.785, 1090.109, 1080.914, 1122.643, 1178.351,
        1260.531, 1273.514, 1288.339, 1327.543, 1353.863, 1414.509, 1425.208, 1421.384, 1442.962, 1464.350, 1468.705,
        1447.894, 1457.628,
    ];
    certified(
        &x,
        &y,
        [
            &[1000.0, 1000.0, 400.0, 40.0, 0.7, 0.3, 0.03],
            &[1300.0, 1500.0, 500.0, 75.0, 1.0, 0.4, 0.05],
        ],
        &[
            1.2881396800E+03,
            1.4910792535E+03,
            5.8323836877E+02,
            7.5416644291E+01,
            9.6629502864E-01,
            3.9797285797E-01,
            4.9727297349E-02,
        ],
        &[
            4.6647963344E+00,
            3.9571156086E+01,
            2.8698696102E+01,
            5.5675370270E+00,
            3.1333340687E-02,
            1.4984928198E-02,
            6.5842344623E-03,
        ],
        |b, x| {
            let above = b[0] + b[1] * x + b[2] * (x * x) + b[3] * (x * x * x);
            let below = b[4] * x + b[5] * (x * x) + b[6] * (x * x * x) + 1.0;
            above * below.recip()
        },
    );
}

#[test]
fn nist_eckerle4() {
    let x = [
        400.0, 405.0, 410.0, 415.0, 420.0, 425.0, 430.0, 435.0, 436.5, 438.0, 439.5, 441.0, 442.5, 444.0, 445.5, 447.0,
        448.5, 450.0, 451.5, 453.0, 454.5, 456.0, 457.5, 459.0, 460.5, 462.0, 463.5, 465.0, 470.0, 475.0, 480.0, 485.0,
        490.0, 495.0, 500.0,
    ];
    let y = [
        0.0001575, 0.0001699, 0.0002350, 0.0003102, 0.0004917, 0.0008710, 0.0017418, 0.0046400, 0.0065895, 0.0097302,
        0.0149002, 0.0237310, 0.0401683, 0.0712559, 0.1264458, 0.2073413, 0.2902366, 0.3445623, 0.3698049, 0.3668534,
        0.3106727, 0.2078154, 0.1164354, 0.0616764, 0.0337200, 0.0194023, 0.0117831, 0.0074357, 0.0022732, 0.0008800,
        0.0004579, 0.0002345, 0.0001586, 0.0001143, 0.0000710,
    ];
    certified(
        &x,
        &y,
        [&[1.0, 10.0, 500.0], &[1.5, 5.0, 450.0]],
        &[1.5543827178E+00, 4.0888321754E+00, 4.5154121844E+02],
        &[1.5408051163E-02, 4.6803020753E-02, 4.6800518816E-02],
        |b, x| {
            let distance = (b[2] - x) * b[1].recip();
            b[0] * b[1].recip() * (distance * distance * -0.5).exp()
        },
    );
}

fn rosenbrock(x: &[Dual], row: usize) -> Dual {
    if row == 0 {
        (x[1] - x[0] * x[0]) * 10.0
    } else {
        x[0] * -1.0 + 1.0
    }
}

#[test]
fn rosenbrock_with_and_without_bounds() {
    let none = f64::INFINITY;
    let usual = [-1.2, 1.0];
    // With y on its bound the slope along x vanishes at the roots of x³ - 1.495 x - 0.005: a minimum on either side.
    let right = 1.2243707487363527;
    let cases = [
        (usual, [-none, -none], [none, none], [1.0, 1.0]),
        (usual, [-none, -1.5], [none, none], [1.0, 1.0]),
        (usual, [-2.0, -1.5], [0.8, none], [0.8, 0.64]),
        (usual, [-2.0, -2.0], [0.5, 3.0], [0.5, 0.25]),
        ([1.5, 2.0], [-none, 1.5], [none, none], [right, 1.5]),
    ];
    for (start, lower, upper, expected) in cases {
        let bounds = Bounds {
            lower: lower.to_vec(),
            upper: upper.to_vec(),
        };
        let outcome = solve(2, &start, &bounds, rosenbrock);
        assert!(outcome.stop.converged(), "{:?}", outcome.stop);
        assert_close(&outcome.x, &expected, 1e-6);
        for k in 0..2 {
            let side = i8::from(expected[k] == upper[k]) - i8::from(expected[k] == lower[k]);
            assert_eq!(outcome.at_bound[k], side, "{expected:?}");
        }
    }
}

#[test]
fn powell_badly_scaled() {
    let outcome = unbounded(2, &[0.0, 1.0], |x, row| match row {
        0 => x[0] * x[1] * 1e4 - 1.0,
        _ => (x[0] * -1.0).exp() + (x[1] * -1.0).exp() - 1.0001,
    });
    assert!(outcome.stop.converged(), "{:?}", outcome.stop);
    assert_close(&outcome.x, &[1.0981593e-5, 9.1061467], 1e-6);
}

#[test]
fn osborne_1() {
    let y = [
        0.844, 0.908, 0.932, 0.936, 0.925, 0.908, 0.881, 0.850, 0.818, 0.784, 0.751, 0.718, 0.685, 0.658, 0.628, 0.603,
        0.580, 0.558, 0.538, 0.522, 0.506, 0.490, 0.478, 0.467, 0.457, 0.448, 0.438, 0.431, 0.424, 0.420, 0.414, 0.411,
        0.406,
    ];
    let outcome = unbounded(y.len(), &[0.5, 1.5, -1.0, 0.01, 0.02], |x, row| {
        let t = -10.0 * row as f64;
        x[0] + x[1] * (x[3] * t).exp() + x[2] * (x[4] * t).exp() - y[row]
    });
    assert!(outcome.stop.converged(), "{:?}", outcome.stop);
    assert_close(&[2.0 * outcome.cost], &[5.46489e-5], 1e-5);
}

#[test]
fn units_do_not_matter() {
    let plain = unbounded(2, &[-1.2, 1.0], rosenbrock);
    // Powers of two, so that not even rounding differs.
    let (large, small) = (f64::powi(2.0, 20), f64::powi(2.0, -30));
    let units = |x: &[Dual]| [x[0] * large.recip(), x[1] * small.recip()];
    let scaled = unbounded(2, &[-1.2 * large, small], |x, row| rosenbrock(&units(x), row));
    assert_eq!(plain.evaluations, scaled.evaluations);
    assert_close(&[scaled.x[0] / large, scaled.x[1] / small], &plain.x, 0.0);
}

#[test]
fn a_variable_that_nothing_depends_on_stays_where_it_started() {
    let outcome = unbounded(2, &[-1.2, 1.0, 7.5], |x, row| rosenbrock(&x[..2], row));
    assert!(outcome.stop.converged());
    assert_eq!(outcome.x[2], 7.5);
}

#[test]
fn a_product_that_cannot_be_told_apart_is_still_fitted() {
    let outcome = unbounded(4, &[1.0, 1.0], |x, row| {
        x[0] * x[1] * (1.0 + row as f64) - 6.0 * (1.0 + row as f64)
    });
    assert!(outcome.stop.converged(), "{:?}", outcome.stop);
    assert_close(&[outcome.x[0] * outcome.x[1]], &[6.0], 1e-8);
}

#[test]
fn values_that_are_not_finite_are_never_a_success() {
    let start = unbounded(1, &[1.0], |x, _| x[0] * f64::NAN);
    assert_eq!(start.stop, Stop::NotFinite);
    // Finite at the start alone: every way down is barred.
    let cliff = unbounded(1, &[1.0], |x, _| if x[0].0 < 1.0 { x[0] * f64::NAN } else { x[0] });
    assert_eq!(cliff.stop, Stop::NotFinite);
}

#[test]
fn running_out_of_evaluations_is_said() {
    let options = Options {
        evaluations: 5,
        ..TIGHT
    };
    let mut problem = Functions {
        variables: 2,
        residuals: 2,
        residual: rosenbrock,
    };
    let outcome = minimize(&mut problem, &[-1.2, 1.0], &Bounds::none(2), &options);
    assert_eq!((outcome.stop, outcome.evaluations), (Stop::Evaluations, 5));
    assert!(!outcome.stop.converged());
}

#[test]
fn the_cost_never_rises_and_the_jacobian_is_that_of_the_optimum() {
    let outcome = unbounded(2, &[-1.2, 1.0], rosenbrock);
    assert!(outcome.cost <= outcome.start_cost);
    let expected = DMatrix::from_row_slice(2, 2, &[-20.0 * outcome.x[0], 10.0, -1.0, 0.0]);
    assert!((outcome.jacobian - expected).norm() < 1e-12);
}
