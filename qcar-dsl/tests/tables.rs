//! Tables: the curve of another program, exact derivatives, and the same numbers from every part of the compiler.

use qcar_dsl::check::Checked;
use qcar_dsl::check::check_text;
use qcar_dsl::compile::derive;
use qcar_dsl::diagnostic::Code;
use qcar_dsl::evaluate::Evaluator;
use qcar_dsl::expr::{CoordinateId, Curve, Expr, Graph, Symbol};
use qcar_dsl::show::{Stage, show};
use qcar_dsl::source::Source;
use qcar_model::Model as _;

/// A curve as SciPy 1.17.1 has it: `p = scipy.interpolate.PchipInterpolator(knots, values)`.
struct Recorded {
    knots: &'static [f64],
    values: &'static [f64],
    /// `p(x, 1)` at the first and at the last abscissa.
    ends: [f64; 2],
    /// `x`, `p(x)`, `p(x, 1)` and `p(x, 2)`, at 0.3 and 0.85 of each piece.
    at: &'static [[f64; 4]],
}

#[rustfmt::skip]
const RECORDED: [Recorded; 4] = [
    Recorded {
        knots: &[-1.0, -0.5, -0.2, -0.05, 0.0, 0.05, 0.2, 0.5, 1.0],
        values: &[-2100.0, -1500.0, -1000.0, -400.0, 0.0, 250.0, 520.0, 700.0, 830.0],
        ends: [908.3333333333333, 47.5],
        at: &[
            [-0.85, -1948.195456777996, 1108.785690897184, 1197.5180091683042],
            [-0.575, -1604.4143571954812, 1368.1091601178782, 688.4708578912905],
            [-0.41000000000000003, -1376.221600236833, 1385.3190515918939, 1316.2167738694343],
            [-0.245, -1102.4268946631857, 2098.8595688564737, 7332.7591929739565],
            [-0.155, -869.3948428686543, 3349.073327961321, 20306.20467365027],
            [-0.07250000000000001, -521.1763698630137, 5126.712328767122, 22788.07413376312],
            [-0.035, -291.4787330316742, 8444.524886877827, 110914.02714932122],
            [-0.0075, -52.24615384615382, 7683.981900452489, -166226.24434389133],
            [0.015, 90.1828968903437, 5782.896890343699, -42258.59247135844],
            [0.0425, 225.1326207037643, 3737.049918166939, -106530.2782324059],
            [0.095, 362.64981226533166, 2154.5932415519396, -14598.247809762204],
            [0.1775, 496.34627659574465, 1154.6808510638296, -9642.05256570713],
            [0.29000000000000004, 593.8143652009901, 698.9062831545442, -2438.3354945184474],
            [0.455, 682.3354258517033, 412.82394200165027, -1029.3292467287529],
            [0.65, 754.1572970941885, 338.18552104208413, -421.66132264529057],
            [0.925, 823.1159684994991, 133.8838051102204, -1064.169338677355],
        ],
    },
    Recorded {
        knots: &[0.0, 1.0, 1.5, 3.0, 3.2],
        values: &[0.0, 2.0, 2.0, -1.0, 4.0],
        ends: [3.3333333333333335, 28.176470588235276],
        at: &[
            [0.3, 0.9219999999999999, 2.753333333333333, -2.5333333333333337],
            [0.85, 1.94225, 0.7550000000000001, -4.733333333333333],
            [1.15, 2.0, 0.0, 0.0],
            [1.425, 2.0, 0.0, 0.0],
            [1.95, 1.352, -2.5199999999999996, -3.200000000000001],
            [2.775, -0.8177500000000002, -1.5300000000000011, 5.599999999999998],
            [3.06, -0.27502352941176467, 22.201764705882333, 271.82352941176424],
            [3.17, 3.0855249999999934, 32.2975, -88.26470588235196],
        ],
    },
    Recorded {
        knots: &[-1.0, 0.0, 3.0, 3.5],
        values: &[0.0, 1.0, 40.0, -20.0],
        ends: [0.0, -139.0],
        at: &[
            [-0.7, 0.11362500000000002, 0.7237500000000001, 2.075],
            [-0.15000000000000002, 0.7631406249999999, 1.5246875000000002, 0.8375000000000001],
            [0.8999999999999999, 10.140624999999998, 16.49375, 9.208333333333332],
            [2.55, 37.723984375, 9.567187499999996, -17.604166666666668],
            [3.15, 31.41850000000001, -105.32999999999994, -520.4000000000002],
            [3.425, -8.822937499999973, -156.7825, 146.1999999999996],
        ],
    },
    Recorded {
        knots: &[0.0, 2.0, 3.0],
        values: &[0.0, 0.1, 5.0],
        ends: [0.0, 6.516666666666666],
        at: &[
            [0.6, 0.007603526448362721, 0.026342569269521412, 0.04889168765743074],
            [1.7, 0.06984773299748111, 0.09018136020151134, 0.06717884130982367],
            [2.3, 0.7641792191435762, 4.031275818639797, 10.212283795130148],
            [2.85, 3.998205714735517, 6.769214840470195, -0.2561418975650742],
        ],
    },
];

const X: Symbol = Symbol::Position(CoordinateId(0));

/// The derivatives of a curve of numbers, by order.
fn derivatives(g: &mut Graph, of: &Recorded) -> [Expr; 3] {
    let values = of.values.iter().map(|&value| g.constant(value)).collect();
    let curve = Curve::monotone(g, of.knots, values);
    let x = g.symbol(X);
    [0, 1, 2].map(|order| g.table(order, x, curve.clone()))
}

fn close(found: f64, wanted: f64, size: f64) {
    assert!(
        (found - wanted).abs() <= 1e-12 * (wanted.abs() + size),
        "{found}, not {wanted}"
    );
}

#[test]
fn a_table_is_the_curve_of_another_program() {
    for recorded in &RECORDED {
        let mut g = Graph::default();
        let curve = derivatives(&mut g, recorded);
        let size = recorded
            .values
            .iter()
            .fold(0.0_f64, |size, value| size.max(value.abs()));
        for &[x, value, slope, bend] in recorded.at {
            for (e, wanted) in curve.into_iter().zip([value, slope, bend]) {
                close(g.evaluate(e, &|_| x), wanted, size);
            }
        }
        for (&x, &value) in recorded.knots.iter().zip(recorded.values) {
            close(g.evaluate(curve[0], &|_| x), value, 0.0);
        }
    }
}

#[test]
fn beyond_its_points_a_table_goes_on_with_the_slope_of_the_end() {
    for recorded in &RECORDED {
        let mut g = Graph::default();
        let curve = derivatives(&mut g, recorded);
        let last = recorded.knots.len() - 1;
        for (place, end, step) in [(0, 0, -0.7), (last, 1, 1.3)] {
            let (knot, slope) = (recorded.knots[place], recorded.ends[end]);
            let at = |e| g.evaluate(e, &|_| knot + step);
            close(at(curve[0]), recorded.values[place] + slope * step, slope.abs());
            close(at(curve[1]), slope, slope.abs());
            assert_eq!(at(curve[2]), 0.0);
        }
    }
}

/// A corner with a damper whose curve is stretched by parameters, and a bump stop of numbers.
const CORNER: &str = r#"axle corner {
    "A damper curve with free points"

    param m: kg = 400 in 300..500 "Mass";
    param k: N/m = 20 N/mm in 10 N/mm..40 N/mm "Stiffness";
    param f_rebound: N = 900 N in 500 N..1500 N "Force at 0.5 m/s in rebound";
    param f_fast: N = 1300 N in 1200 N..3 kN "Force at 1.5 m/s in rebound";
    param f_compression: N = 400 N in 100 N..600 N "Force at 0.5 m/s in compression";

    direction z {
        road pad;
        mass body = m;
        link spring: body - pad { spring k; }
        link stop: body - pad { force = table(s, [-60 mm, -30 mm, -20 mm, 0 mm], [-2 kN, -300 N, 0, 0]); }
        link damper: body - pad {
            force = table(v, [-1 m/s, -0.5 m/s, 0, 0.5 m/s, 1.5 m/s],
                          [-1.5 * f_compression, -f_compression, 0, f_rebound, f_fast]);
        }
    }
}"#;

fn read(text: &str) -> Checked {
    let source = Source {
        name: "corner.axle".into(),
        text: text.into(),
    };
    check_text(source, &|_, _| Err(String::new())).unwrap_or_else(|report| panic!("{report}"))
}

const P: [f64; 5] = [400.0, 20e3, 900.0, 1300.0, 400.0];

/// Motions in every piece of both tables, off their points: travel and speed of the body.
const MOTIONS: [[f64; 2]; 6] = [
    [0.012, 0.31],
    [-0.011, 0.83],
    [-0.023, -0.21],
    [-0.041, -0.77],
    [-0.085, -1.4],
    [0.03, 2.2],
];

struct Running(Evaluator);

impl Running {
    fn new() -> Self {
        Running(Evaluator::new(&derive(read(CORNER))))
    }

    fn rates(&self, p: &[f64], x: &[f64; 2]) -> Vec<f64> {
        let about = self.0.about();
        let mut constants = vec![0.0; about.constants];
        self.0.prepare(p, &mut constants);
        let (u, mut dx) = (vec![0.0; about.inputs.len()], vec![0.0; 2]);
        self.0.derivative(&constants, x, &u, &mut dx);
        dx
    }

    fn matrices(&self, p: &[f64], x: &[f64; 2]) -> Vec<f64> {
        let about = self.0.about();
        let (u, mut nonzeros) = (vec![0.0; about.inputs.len()], vec![0.0; about.matrices.len()]);
        self.0.matrices(p, x, &u, &mut nonzeros);
        nonzeros
    }
}

/// The change of a function over a change of one number, by central differences.
fn slope<const N: usize>(at: [f64; N], place: usize, of: impl Fn(&[f64; N]) -> Vec<f64>) -> Vec<f64> {
    let step = 1e-5 * at[place].abs().max(0.01);
    let moved = |by: f64| {
        let mut moved = at;
        moved[place] += by;
        of(&moved)
    };
    let pairs = moved(step).into_iter().zip(moved(-step));
    pairs.map(|(up, down)| (up - down) / (2.0 * step)).collect()
}

fn near(what: &str, found: f64, wanted: f64, size: f64) {
    assert!(
        (found - wanted).abs() <= 1e-6 * (wanted.abs() + size),
        "{what}: {found}, not {wanted}"
    );
}

#[test]
fn the_matrices_are_the_slopes_of_the_equations() {
    let running = Running::new();
    for x in MOTIONS {
        let matrices = running.matrices(&P, &x);
        let by = [0, 1].map(|place| slope(x, place, |x| running.rates(&P, x)));
        for (entry, &found) in running.0.about().matrices.iter().zip(&matrices) {
            if entry.matrix == qcar_model::Matrix::A {
                let wanted = by[usize::from(entry.column)][usize::from(entry.row)];
                near(&format!("{entry:?} at {x:?}"), found, wanted, 1.0);
            }
        }
    }
}

#[test]
fn points_that_are_parameters_have_exact_derivatives() {
    let running = Running::new();
    let about = running.0.about();
    for x in MOTIONS {
        let u = vec![0.0; about.inputs.len()];
        let mut jacobian = vec![0.0; about.parameter_jacobian.len()];
        running.0.parameter_jacobian(&P, &x, &u, &mut jacobian);
        for (&(output, row, parameter), found) in about.parameter_jacobian.iter().zip(jacobian) {
            if !output {
                let wanted = slope(P, parameter.into(), |p| running.rates(p, &x))[usize::from(row)];
                near(
                    &format!("rate {row} by parameter {parameter} at {x:?}"),
                    found,
                    wanted,
                    1e-3,
                );
            }
        }
        let mut sensitivities = vec![0.0; about.sensitivities.len()];
        running.0.sensitivities(&P, &x, &u, &mut sensitivities);
        for ((entry, parameter), found) in about.sensitivities.iter().zip(sensitivities) {
            let place = about.matrices.iter().position(|own| own == entry).unwrap();
            let wanted = slope(P, (*parameter).into(), |p| running.matrices(p, &x))[place];
            near(
                &format!("{entry:?} by parameter {parameter} at {x:?}"),
                found,
                wanted,
                1e-3,
            );
        }
    }
}

#[test]
fn a_table_of_two_points_is_a_straight_line() {
    let line = r#"axle line {
        "A mass on a straight line"
        known param m: kg = 400;
        param f: N = 200 N "Force at 10 mm";
        direction z {
            road pad;
            mass body = m;
            link spring: body - pad { force = table(s, [-10 mm, 10 mm], [-f, f]); }
        }
    }"#;
    let compiled = derive(read(line));
    assert!(compiled.about.linear);
    let entry = compiled
        .about
        .matrices
        .iter()
        .position(|entry| compiled.about.relates(entry) == ("vz_body", "z_body"));
    let mut nonzeros = vec![0.0; compiled.about.matrices.len()];
    let evaluator = Evaluator::new(&compiled);
    evaluator.matrices(
        &[400.0, 200.0],
        &[0.0; 2],
        &vec![0.0; compiled.about.inputs.len()],
        &mut nonzeros,
    );
    close(nonzeros[entry.unwrap()], -20e3 / 400.0, 0.0);
}

#[test]
fn a_table_that_pushes_along_is_refused() {
    let pushing = CORNER.replace("f_rebound, f_fast]", "-f_rebound, -f_fast]");
    let source = Source {
        name: "pushing.axle".into(),
        text: pushing,
    };
    let report = check_text(source, &|_, _| Err(String::new())).unwrap_err();
    let codes: Vec<Code> = report.diagnostics.iter().map(|diagnostic| diagnostic.code).collect();
    assert_eq!(codes, [Code::LawGivesEnergy], "{report}");
}

#[test]
fn a_table_reads_well_at_every_stage() {
    let compiled = derive(read(CORNER));
    for stage in [Stage::Model, Stage::Equations, Stage::Latex] {
        insta::assert_snapshot!(stage.name(), show(&compiled, stage));
    }
    let rust = show(&compiled, Stage::Rust);
    let behind = rust.split("pub fn derivative(constants").nth(1).unwrap();
    insta::assert_snapshot!("derivative", behind.split("pub fn").next().unwrap());
}
