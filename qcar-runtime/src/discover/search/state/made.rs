//! Evidence, explanations and contenders of given sizes, for tests.

use std::sync::Arc;

use nalgebra::{Complex, DMatrix};

use super::{Contender, State};
use crate::campaign::{Axis, Quantity, Role};
use crate::discover::candidate::{Added, Candidate, Change, ParameterRole, Workshop};
use crate::discover::evidence::means::Means;
use crate::discover::evidence::{Evidence, Kind, Passage, Recordings, Run, Series, Spread, Stimulus};
use crate::discover::explain::{Explanation, Setting};
use crate::discover::gap::Gap;
use crate::discover::nuisance::{Form, Nuisance};
use crate::discover::refit::Refit;
use crate::discover::search::contest::Finalist;
use crate::least_squares::Stop;
use crate::model::{
    About, Contact, Default, Excitation, Model, Output, Parameter, ResponseLayout, ResponseMut, Signal, SignalKind,
};
use crate::response::parameters::Values;
use crate::road::Road;
use crate::transmissibility::Point;
use crate::tyre::{Geometry, Rates, Tyre};

/// What the wheel's travel over the pad's is for a ratio, and the derivative of that.
type Travel = fn(f64) -> [f64; 2];

/// A wheel that moves by a ratio of what the pad does: the least that answers to a sweep. It has the same ratio on another
/// axle, of which nothing is seen.
pub struct Lever(About, Travel);

impl Lever {
    pub fn new() -> Self {
        Lever::of(|ratio| [ratio, 1.0])
    }

    pub fn of(travel: Travel) -> Self {
        let parameter = |name: &'static str, default| Parameter {
            name: name.into(),
            unit: "1".into(),
            doc: "Travel of the wheel over that of the pad".into(),
            default,
            range: None,
            known: false,
        };
        let ratios = vec![
            parameter("ratio", Default::Value(1.0)),
            parameter("ratio_other", Default::Same(0)),
        ];
        let wheel = Output {
            name: "z_wheel_acceleration".into(),
            unit: "m/s^2".into(),
            signal: Signal {
                location: "wheel".into(),
                axis: "z".into(),
                kind: SignalKind::Motion(crate::model::Quantity::Acceleration),
            },
        };
        let pad = Excitation {
            name: "pad".into(),
            axis: "z".into(),
            force: false,
            road: true,
        };
        let layout = ResponseLayout {
            outputs: vec![0].into(),
            jacobian: vec![(0, 0)].into(),
        };
        let about = About {
            name: "lever".into(),
            doc: "A lever".into(),
            parameters: ratios.into(),
            states: Vec::new().into(),
            inputs: Vec::new().into(),
            outputs: vec![wheel].into(),
            excitations: vec![pad].into(),
            channels: Vec::new().into(),
            links: Vec::new().into(),
            masses: Vec::new().into(),
            contact: None,
            constants: 2,
            linear: true,
            matrices: Vec::new().into(),
            sensitivities: Vec::new().into(),
            parameter_jacobian: Vec::new().into(),
            responses: vec![layout].into(),
        };
        Lever(about, travel)
    }

    pub fn values(&self) -> Values {
        Values::resolve(&self.0, &[].into(), &[].into()).expect("it has a default")
    }
}

impl Model for Lever {
    fn about(&self) -> &About {
        &self.0
    }

    fn prepare(&self, p: &[f64], constants: &mut [f64]) {
        constants.copy_from_slice(p);
    }

    fn derivative(&self, _: &[f64], _: &[f64], _: &[f64], _: &mut [f64]) {}

    fn outputs(&self, _: &[f64], _: &[f64], _: &[f64], _: &mut [f64]) {}

    fn matrices(&self, _: &[f64], _: &[f64], _: &[f64], _: &mut [f64]) {}

    fn sensitivities(&self, _: &[f64], _: &[f64], _: &[f64], _: &mut [f64]) {}

    fn parameter_jacobian(&self, _: &[f64], _: &[f64], _: &[f64], _: &mut [f64]) {}

    fn response(&self, _: usize, p: &[f64], omega: &[f64], into: ResponseMut<'_>) {
        let [travel, slope] = (self.1)(p[0]);
        into.im.fill(0.0);
        for (re, omega) in into.re.iter_mut().zip(omega) {
            *re = -travel * omega * omega;
        }
        if let Some((re, im)) = into.jacobian {
            im.fill(0.0);
            for (re, omega) in re.iter_mut().zip(omega) {
                *re = -slope * omega * omega;
            }
        }
    }

    fn rolling_derivative(&self, _: &[f64], _: &[f64], _: &[f64], _: &Contact, _: &mut [f64]) {}
}

/// The lever, which may have another ratio, or whose wheel may have a sensor with another gain.
pub struct Levers(Lever);

impl Levers {
    pub fn new() -> Self {
        Levers(Lever::new())
    }

    pub fn of(travel: Travel) -> Self {
        Levers(Lever::of(travel))
    }
}

impl Workshop for Levers {
    fn model(&self) -> &dyn Model {
        &self.0
    }

    fn candidates(&self) -> Vec<Candidate> {
        let gain = Candidate {
            effect: "gain".into(),
            at: "wheel".into(),
            form: None,
            change: Change::Sensor {
                location: "wheel".into(),
                axis: Some(Axis::Z),
                form: Form::Gain(0),
                parameter: added("gain"),
            },
        };
        vec![candidate("ratio", 1), gain]
    }

    fn laws(&self) -> Vec<Candidate> {
        Vec::new()
    }

    fn with(&self, _: &str, _: &str, _: Option<&str>) -> Option<Box<dyn Workshop>> {
        None
    }
}

fn added(name: &str) -> Added {
    Added {
        name: name.into(),
        effect_name: name.into(),
        start: 1.0,
        range: (0.5, 2.0),
        known: false,
        role: ParameterRole::Other,
    }
}

/// An effect with so many unknowns, the first of which is the ratio.
fn candidate(effect: &str, unknowns: usize) -> Candidate {
    Candidate {
        effect: effect.into(),
        at: "wheel".into(),
        form: None,
        change: Change::Model {
            model: Box::new(Lever::new()),
            parameters: vec![added("ratio"); unknowns],
        },
    }
}

fn point(location: &str) -> Point {
    Point {
        location: location.into(),
        axis: Axis::Z,
        quantity: Quantity::Acceleration,
    }
}

pub fn sweep() -> Stimulus {
    Stimulus::Sweep {
        reference: point("pad"),
        signal: Vec::new(),
        rate: 100.0,
        frequency: Vec::new(),
        amplitude: Vec::new(),
        band: (1.0, 20.0),
    }
}

pub fn history() -> Stimulus {
    Stimulus::History {
        inputs: Recordings {
            start: 0.0,
            samples: 0,
            signals: vec![(point("pad"), Vec::new())],
        },
        rate: 100.0,
        band_limited: true,
        restarts: Vec::new(),
        spread: Spread::default(),
        band: None,
        periodic: false,
    }
}

pub fn ride() -> Stimulus {
    Stimulus::Cleat(Passage {
        road: Road::flat(0.0),
        speed: 10.0,
        tyre: Tyre::new(0.3, 0.02, Geometry::Point, Rates::AtStaticDeflection).expect("it is a tyre"),
        load: 4000.0,
        duration: 1.0,
        means: Means::new(500.0, 0.01),
        most_steps: 1e5,
    })
}

/// Runs, in each of which the wheel was seen to move by `ratio` times what the pad does, at so many frequencies and to a
/// hundredth.
pub fn evidence(ratio: f64, runs: Vec<(Role, Stimulus, usize)>) -> Evidence {
    let series = runs.iter().enumerate().map(|(run, &(.., count))| Series {
        noise: vec![1.0; count],
        least_discrepancy: 0.0,
        run,
        sensor: point("wheel"),
        kind: Kind::Harmonic(1),
        at: (0..count).map(|k| 1.0 + k as f64 / 10.0).collect(),
        value: vec![Complex::from(ratio); count],
        sigma: vec![0.01; count],
    });
    Evidence {
        series: series.collect(),
        runs: runs
            .into_iter()
            .map(|(role, stimulus, _)| run(role, stimulus))
            .collect(),
        two_sided: false,
        notices: Vec::new(),
    }
}

fn run(role: Role, stimulus: Stimulus) -> Run {
    Run {
        name: "run".into(),
        role,
        level: 0.1,
        stimulus,
    }
}

/// Of each of these sweeps.
pub const RESIDUALS: usize = 1000;

/// One sweep that is fitted, and one that is held out.
pub fn two_sweeps() -> Evidence {
    evidence(
        1.0,
        [Role::Fit, Role::HeldOut]
            .map(|role| (role, sweep(), RESIDUALS / 2))
            .to_vec(),
    )
}

/// The explanation of [`two_sweeps`] that leaves this sum of squares.
pub fn with_chi2(chi2: f64) -> Explanation {
    let gap = (chi2 / RESIDUALS as f64).sqrt();
    let nuisance = Nuisance::of(&two_sweeps());
    Explanation {
        named: Vec::new(),
        refit: Refit {
            values: Lever::new().values(),
            side: Lever::new().values(),
            free: Vec::new(),
            estimate: Vec::new(),
            covariance: DMatrix::zeros(0, 0),
            at_bound: Vec::new(),
            coefficients: vec![0.0; nuisance.len()],
            coefficient_stderr: vec![0.0; nuisance.len()],
            nuisance,
            chi2,
            gained: 0.0,
            log_evidence: f64::NAN,
            discrepancy: None,
            centre: Lever::new().values(),
            residuals: RESIDUALS,
            made: 0.0,
            unsteady: Vec::new(),
            evaluations: 1,
            stop: Stop::Cost,
        },
        gap: Gap {
            fit: gap,
            held_out: gap,
            series: vec![gap; 2],
            residuals: vec![vec![gap; RESIDUALS]; 2],
            tiles: Vec::new(),
        },
    }
}

/// The explanation of [`two_sweeps`] that leaves this gap everywhere.
pub fn leaving(gap: f64) -> Explanation {
    with_chi2(RESIDUALS as f64 * gap * gap)
}

/// A lever with this explanation, to which no effect was added.
pub fn state(explanation: Explanation) -> State {
    State {
        workshop: Arc::new(Levers::new()),
        setting: setting(),
        nuisance: explanation.refit.nuisance.clone(),
        taken: Vec::new(),
        explanation,
    }
}

pub fn setting() -> Setting {
    Setting {
        given: Vec::new(),
        vehicle: [].into(),
    }
}

/// An effect of so many unknowns that explains so well.
pub fn contender(effect: &str, unknowns: usize, explanation: Explanation) -> Contender {
    let nuisance = explanation.refit.nuisance.clone();
    let finalist = Finalist {
        entrant: 0,
        score: explanation.refit.chi2 + (RESIDUALS as f64).ln() * unknowns as f64,
        explanation,
    };
    Contender::new(candidate(effect, unknowns), nuisance, finalist)
}
