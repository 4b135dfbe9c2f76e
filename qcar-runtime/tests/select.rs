//! What a search answers on evidence in closed form, with a catalogue of masses on mounts that are told apart by their
//! ranges.

use nalgebra::Complex;
use qcar_runtime::campaign::{Axis, Role};
use qcar_runtime::discover::Evidence;
use qcar_runtime::discover::answer::{Discovery, Verdict};
use qcar_runtime::discover::candidate::{Added, Candidate, Change, ParameterRole, Workshop};
use qcar_runtime::discover::noise::Form;
use qcar_runtime::discover::observe::{Kind, Series, signal_of};
use qcar_runtime::discover::posterior::{Given, Misfit, Setting};
use qcar_runtime::discover::select::discover;
use qcar_runtime::model::Model;
use qcar_runtime::response::parameters::Values;
use qcar_runtime::response::ratio::ratio;
use qcar_runtime::transmissibility::logarithmic;

use crate::support::random::Random;
use crate::support::strut::{Parts, Strut};
use crate::support::swept::{self, point};

const STRENGTH: ParameterRole = ParameterRole::Strength { vanishes_at: 0.0 };

const PLAIN: Parts = Parts {
    powertrain: false,
    friction: false,
};
const WITH_MASS: Parts = Parts {
    powertrain: true,
    ..PLAIN
};
/// Of the axle and of what hangs on its body: mass, stiffness and damping of the mount.
const TRUTH: [f64; 12] = [
    400.0, 42.0, 6.0, 25e3, 1500.0, 600e3, 900.0, 240e3, 160.0, 70.0, 250e3, 600.0,
];
const NOISE: f64 = 0.004;
/// Relative error of a measurement that no model explains.
const ERROR: f64 = 0.1;

/// A mass on a mount at the body, by the ranges of the mass and of the mount's stiffness. If both ends of the latter are
/// [`STIFF`], it is known.
#[derive(Clone)]
struct Hanging {
    name: &'static str,
    mass: (f64, f64),
    stiffness: (f64, f64),
}

/// Known stiffness of a mount, N/m.
const STIFF: f64 = 300e3;

impl Hanging {
    fn new(name: &'static str, mass: (f64, f64)) -> Self {
        let stiffness = (20e3, 2e6);
        Self { name, mass, stiffness }
    }
}

/// A strut axle and the masses that may be missing on it; a delay of the body's sensor may be there as a nuisance.
struct Bench {
    model: Strut,
    masses: Vec<Hanging>,
    /// What stands for a learned law: a mass without a name.
    laws: Vec<Hanging>,
    delays: bool,
}

impl Workshop for Bench {
    fn model(&self) -> &dyn Model {
        &self.model
    }

    fn candidates(&self) -> Vec<Candidate> {
        let delay = self.delays.then(delayed).into_iter();
        self.masses.iter().map(hanging).chain(delay).collect()
    }

    fn candidates_of(&self, effect: &str) -> Vec<Candidate> {
        let all = self.candidates().into_iter();
        all.filter(|own| own.effect == effect).collect()
    }

    fn laws(&self) -> Vec<Candidate> {
        self.laws.iter().map(hanging).collect()
    }

    fn with(&self, effect: &str, _: &str, _: Option<&str>) -> Option<Box<dyn Workshop>> {
        let known = self.masses.iter().chain(&self.laws).any(|own| own.name == effect);
        known.then(|| {
            Box::new(Bench {
                model: Strut::new(WITH_MASS),
                masses: Vec::new(),
                laws: Vec::new(),
                delays: self.delays,
            }) as Box<dyn Workshop>
        })
    }
}

fn added(name: &str, start: f64, range: (f64, f64), role: ParameterRole) -> Added {
    Added {
        name: name.into(),
        effect_name: name.into(),
        start,
        range,
        known: false,
        role,
        scales_force: false,
    }
}

fn hanging(of: &Hanging) -> Candidate {
    Candidate {
        effect: of.name.into(),
        at: "body".into(),
        form: None,
        nuisance: false,
        change: Change::Model {
            model: Box::new(Strut::new(WITH_MASS)),
            parameters: vec![
                added("m_pwt", (of.mass.0 * of.mass.1).sqrt(), of.mass, STRENGTH),
                Added {
                    known: of.stiffness == (STIFF, STIFF),
                    ..added(
                        "k_pwt_z",
                        (of.stiffness.0 * of.stiffness.1).sqrt(),
                        of.stiffness,
                        ParameterRole::Shape,
                    )
                },
                added("c_pwt_z", 500.0, (50.0, 5e3), ParameterRole::Shape),
            ],
        },
    }
}

fn delayed() -> Candidate {
    Candidate {
        effect: "late".into(),
        at: "body".into(),
        form: None,
        nuisance: true,
        change: Change::Sensor {
            location: "body".into(),
            axis: Some(Axis::Z),
            form: Form::Delay,
            parameter: added("delay", 1e-3, (-20e-3, 20e-3), STRENGTH),
        },
    }
}

/// Sweeps of the axle with a mass on its body, whose body's sensor is late (s), at these levels.
fn evidence(late: f64, levels: &[(f64, Role)]) -> Evidence {
    let model = Strut::new(WITH_MASS);
    let about = model.about();
    let named = about.parameters.iter().map(|own| own.name.to_string());
    let values = Values::resolve(about, &named.zip(TRUTH).collect(), &Default::default()).expect("all are given");
    let frequency = logarithmic(0.6, 28.0, 60);
    let mut random = Random(7);
    let (mut runs, mut series) = (Vec::new(), Vec::new());
    for (run, (level, role)) in levels.iter().copied().enumerate() {
        runs.push(swept::run(run, level, role, &frequency));
        for location in ["wheel", "body"] {
            let [numerator, denominator] = [location, "pad"].map(|own| signal_of(about, &point(own)));
            let exact = ratio(&model, &values, 0, &numerator, &denominator, &frequency).expect("it has the sensors");
            let delay = if location == "body" { late } else { 0.0 };
            let value = exact.value.iter().zip(&frequency).map(|(h, &f)| {
                let noise = Complex::new(random.normal(), random.normal()) * NOISE / std::f64::consts::SQRT_2;
                h * Complex::from_polar(1.0, -std::f64::consts::TAU * f * delay) * (1.0 + noise)
            });
            let value: Vec<Complex<f64>> = value.collect();
            series.push(Series {
                noise: vec![NOISE; value.len()],
                least_discrepancy: 0.0,
                run,
                sensor: point(location),
                kind: Kind::Harmonic(1),
                at: frequency.clone(),
                sigma: value.iter().map(|h| NOISE * h.norm()).collect(),
                value,
            });
        }
    }
    swept::evidence(runs, series)
}

const LEVELS: [(f64, Role); 3] = [(0.025, Role::Fit), (0.05, Role::Fit), (0.1, Role::HeldOut)];

/// Starts a fifth off, with all but the known masses free.
fn answer(masses: Vec<Hanging>, delays: bool, evidence: &Evidence) -> Discovery {
    let bench = Bench {
        model: Strut::new(PLAIN),
        masses,
        laws: Vec::new(),
        delays,
    };
    answer_of(bench, evidence)
}

fn answer_of(bench: Bench, evidence: &Evidence) -> Discovery {
    let model = Strut::new(PLAIN);
    let given = model.about().parameters.iter().zip(TRUTH).enumerate();
    let given = given.map(|(k, (own, truth))| Given {
        name: own.name.to_string(),
        value: if k == 0 || k == 2 { truth } else { 1.2 * truth },
        range: (k != 0 && k != 2).then_some((0.3 * truth, 3.0 * truth)),
    });
    let setting = Setting {
        given: given.collect(),
        vehicle: [("k_pwt_z".to_owned(), STIFF)].into(),
    };
    discover(Box::new(bench), &setting, &mut evidence.clone(), &|_| ()).expect("the model has the sensors")
}

#[test]
fn an_effect_whose_magnitude_stands_at_its_end_is_no_answer() {
    let light = Hanging::new("light", (5.0, 40.0));
    let heavy = Hanging::new("heavy", (20.0, 200.0));
    let judged = evidence(0.0, &LEVELS);
    let unjudged = evidence(0.0, &LEVELS[..2]);
    for evidence in [&judged, &unjudged] {
        let unknown = answer(vec![light.clone()], false, evidence);
        assert_eq!(unknown.verdict, Verdict::Unknown);
        let candidate = &unknown.candidates[0];
        assert!(
            candidate.effect == "light" && candidate.explained > Some(0.5),
            "{candidate:?}"
        );
    }
    let found = answer(vec![light, heavy], false, &judged);
    assert_eq!(found.verdict, Verdict::Found);
    assert_eq!(found.findings[0].effect, "heavy");
}

/// The held-out run has an error that the fitted ones lack, smooth over frequency. The mass explains most of the residual
/// of the base model all the same, which has an error in every run.
#[test]
fn an_error_of_the_held_out_run_does_not_withdraw_what_explains_most_of_it() {
    let mut evidence = evidence(0.0, &LEVELS);
    for series in evidence.series.iter_mut().filter(|series| series.run == 2) {
        for (value, frequency) in series.value.iter_mut().zip(&series.at) {
            *value *= 1.0 + ERROR * frequency.ln().sin();
        }
    }
    let found = answer(vec![Hanging::new("right", (20.0, 200.0))], false, &evidence);
    let explained = found.candidates[0].explained.expect("the base model leaves a residual");
    assert!((0.8..0.95).contains(&explained), "{explained}");
    assert_eq!(found.verdict, Verdict::Found);
    assert_eq!(found.findings[0].effect, "right");
}

/// With its mount at the soft end of the range, still too stiff, the mass explains most. It sends a parameter of the
/// model to its bound for that, and leaves more than noise.
#[test]
fn an_effect_that_takes_the_place_of_a_parameter_is_no_answer() {
    let stiff = Hanging {
        stiffness: (300e3, 2e6),
        ..Hanging::new("stiff", (20.0, 200.0))
    };
    let unknown = answer(vec![stiff], false, &evidence(0.0, &LEVELS));
    assert_eq!(unknown.verdict, Verdict::Unknown);
    let candidate = &unknown.candidates[0];
    assert!(
        candidate.effect == "stiff" && candidate.explained > Some(0.5),
        "{candidate:?}"
    );
}

/// With a sensor that is 3 ms late, the mass of 70 kg looks lighter than 69.4 kg until the delay is in the model.
#[test]
fn what_a_nuisance_had_hidden_is_found_once_it_is_fitted() {
    let [light, right] =
        [("light", (60.0, 69.4)), ("right", (69.6, 80.0))].map(|(name, mass)| Hanging::new(name, mass));
    let both = [light, right];
    let late = evidence(3e-3, &LEVELS);
    let misled = answer(both.to_vec(), false, &late);
    assert_eq!(misled.findings[0].effect, "light");
    let found = answer(both.to_vec(), true, &late);
    assert_eq!(found.verdict, Verdict::Found);
    assert_eq!(found.findings[0].effect, "right");
    let (_, delay, error) = found.nuisances[1][0].parameters[0];
    assert!((delay - 3e-3).abs() < 3.0 * error, "{delay} ± {error} s");
}

/// A model that was fitted with the right sign shows the sensor that has the wrong one.
#[test]
fn a_reversed_sensor_is_named() {
    let right = evidence(0.0, &LEVELS);
    let fitted = answer(vec![Hanging::new("right", (69.6, 80.0))], false, &right)
        .after
        .refit;
    let mut reversed = right.clone();
    let of_body = reversed.series.iter_mut().filter(|own| own.sensor == point("body"));
    of_body
        .flat_map(|own| &mut own.value)
        .for_each(|value| *value = -*value);
    let named = |evidence: &Evidence| -> Vec<String> {
        let misfit = Misfit::of(&Strut::new(WITH_MASS), &fitted, evidence).expect("the model has the sensors");
        let sensors = misfit.reversed_sensors(evidence);
        sensors.iter().map(|own| own.sensor.location.clone()).collect()
    };
    assert_eq!(named(&right), [] as [&str; 0]);
    assert_eq!(named(&reversed), ["body"]);
}

/// The law explains more than the base model, and less than either member of the class.
#[test]
fn a_law_takes_the_place_of_a_class_only_where_it_explains_more_than_its_members() {
    let [one, other, law] = [("one", (20.0, 200.0)), ("other", (20.0, 200.0)), ("law", (5.0, 40.0))]
        .map(|(name, mass)| Hanging::new(name, mass));
    let bench = Bench {
        model: Strut::new(PLAIN),
        masses: vec![one, other],
        laws: vec![law],
        delays: false,
    };
    let class = answer_of(bench, &evidence(0.0, &LEVELS));
    assert_eq!(class.verdict, Verdict::Class);
    let (certain, alternatives) = class.certain_and_alternatives();
    assert!(certain.is_empty());
    assert_eq!(alternatives.iter().map(|own| own.len()).collect::<Vec<_>>(), [1, 1]);
    assert!(class.learned.is_none());
}

/// A mount that is too stiff explains most of the mass. The noise of the held-out runs hides what is missing, so the
/// fitted runs judge: they confirm the name, and a law that fits a little better does not replace it.
#[test]
fn the_fitted_runs_confirm_a_name_where_held_out_runs_show_nothing() {
    let mut evidence = evidence(0.0, &LEVELS);
    for series in evidence.series.iter_mut().filter(|series| series.run == 2) {
        let larger = |noise: &mut f64| *noise *= 60.0;
        series.sigma.iter_mut().chain(&mut series.noise).for_each(larger);
    }
    let stiff = Hanging {
        stiffness: (STIFF, STIFF),
        ..Hanging::new("stiff", (20.0, 200.0))
    };
    let bench = Bench {
        model: Strut::new(PLAIN),
        masses: vec![stiff],
        laws: vec![Hanging::new("law", (20.0, 200.0))],
        delays: false,
    };
    let found = answer_of(bench, &evidence);
    assert_eq!(found.verdict, Verdict::Found);
    assert_eq!(found.findings[0].effect, "stiff");
    assert!(found.findings[0].explained > Some(0.95), "{:?}", found.findings[0]);
}
