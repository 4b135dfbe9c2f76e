//! Transmissibilities come out as the exact frequency response of the system that made the record, with an honest
//! variance; what a record cannot tell is refused.
//!
//! The records are made by fine integration of modal equations whose response is known in closed form.

use std::f64::consts::TAU;
use std::path::PathBuf;

use nalgebra::Complex;
use qcar_runtime::campaign::{Axis, Channel, History, Quantity, Recording, Side, Spacing, Sweep, Test};
use qcar_runtime::transmissibility::{
    Estimator, Options, Point, Transmissibility, logarithmic, points, signal, transmissibilities,
};

const RATE: f64 = 1000.0;
/// Of a sweep with its quiet parts, s.
const SECONDS: f64 = 43.0;

/// Modes in parallel, each `gain (2ζωs + ω²) / (s² + 2ζωs + ω²)`: what a spring and damper pass on.
struct Modes(Vec<(f64, f64, f64)>);

impl Modes {
    /// A body at 1.2 Hz of the given damping ratio, a wheel at 11 Hz and a light powertrain at 8 Hz.
    fn vehicle(damping: f64) -> Modes {
        Modes(vec![(1.2, damping, 1.0), (11.0, 0.1, -0.7), (8.0, 0.05, 0.2)])
    }

    fn response(&self, f: f64) -> Complex<f64> {
        let s = Complex::new(0.0, TAU * f);
        let mode = |&(f, damping, gain): &(f64, f64, f64)| {
            let w = TAU * f;
            let passed = s * (2.0 * damping * w) + w * w;
            passed * gain / (s * s + passed)
        };
        self.0.iter().map(mode).sum()
    }

    /// Integrates by Runge-Kutta, eight steps a sample.
    fn simulate(&self, input: impl Fn(f64) -> f64, samples: usize, rate: f64) -> Vec<f64> {
        let h = 1.0 / (8.0 * rate);
        let mut states = vec![[0.0; 2]; self.0.len()];
        let mut output = Vec::new();
        for k in 0..samples {
            output.push(self.output(&states));
            for step in 0..8 {
                let t = k as f64 / rate + f64::from(step) * h;
                let u = [input(t), input(t + h / 2.0), input(t + h * (1.0 - 1e-9))];
                states
                    .iter_mut()
                    .zip(&self.0)
                    .for_each(|(x, mode)| *x = runge_kutta(*x, *mode, u, h));
            }
        }
        output
    }

    fn output(&self, states: &[[f64; 2]]) -> f64 {
        let mode = |((f, damping, gain), x): (&(f64, f64, f64), &[f64; 2])| {
            let w = TAU * f;
            gain * (2.0 * damping * w * x[1] + w * w * x[0])
        };
        self.0.iter().zip(states).map(mode).sum()
    }
}

fn runge_kutta(x: [f64; 2], (f, damping, _): (f64, f64, f64), u: [f64; 3], h: f64) -> [f64; 2] {
    let w = TAU * f;
    let rate = |x: [f64; 2], u: f64| [x[1], u - 2.0 * damping * w * x[1] - w * w * x[0]];
    let ahead = |k: [f64; 2], h: f64| [x[0] + h * k[0], x[1] + h * k[1]];
    let k1 = rate(x, u[0]);
    let k2 = rate(ahead(k1, h / 2.0), u[1]);
    let k3 = rate(ahead(k2, h / 2.0), u[1]);
    let k4 = rate(ahead(k3, h), u[2]);
    std::array::from_fn(|i| x[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]))
}

/// Acceleration of a logarithmic sweep of constant peak velocity from 0.5 to 30 Hz, at rest for 1 s before and after.
fn sweep(t: f64, peak_velocity: f64) -> f64 {
    let (t, last) = (t - 1.0, SECONDS - 2.0);
    if !(0.0..=last).contains(&t) {
        return 0.0;
    }
    let growth = 60f64.ln() / last;
    let frequency = 0.5 * (growth * t).exp();
    let fade = (t / 0.2).min((last - t) / 0.2).min(1.0);
    TAU * frequency * peak_velocity * fade * (TAU * (frequency - 0.5) / growth).cos()
}

fn sweep_record(peak_velocity: f64) -> Vec<f64> {
    let samples = (SECONDS * RATE) as usize;
    (0..samples).map(|k| sweep(k as f64 / RATE, peak_velocity)).collect()
}

/// Normal deviates from a seed (xorshift and Box-Muller).
struct Noise(u64);

impl Noise {
    fn uniform(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    fn normal(&mut self) -> f64 {
        (-2.0 * self.uniform().max(f64::MIN_POSITIVE).ln()).sqrt() * (TAU * self.uniform()).cos()
    }

    fn added(&mut self, samples: &[f64], deviation: f64) -> Vec<f64> {
        samples.iter().map(|x| x + deviation * self.normal()).collect()
    }
}

fn point(location: &str) -> Point {
    Point::new(location, Axis::Z, Quantity::Acceleration)
}

fn channel(location: &str, side: Side) -> Channel {
    let name = format!("{location}_{side:?}_z").to_lowercase();
    Channel {
        name,
        location: location.into(),
        side,
        axis: Axis::Z,
        quantity: Quantity::Acceleration,
        turns: false,
    }
}

fn history(test: Test, signals: Vec<(Channel, Vec<f64>)>) -> History {
    let sample_rate = test.sample_rate().unwrap();
    History {
        file: PathBuf::from("run.csv"),
        test,
        start: 0.0,
        sample_rate,
        signals,
    }
}

fn sweep_test() -> Test {
    sweep_of(0.1)
}

fn sweep_of(peak_velocity: f64) -> Test {
    let spacing = Spacing::Logarithmic;
    let sweep = Sweep {
        peak_velocity,
        start_frequency: 0.5,
        end_frequency: 30.0,
        spacing,
        sample_rate: RATE,
    };
    Test::Sweep(sweep)
}

/// A sweep with centre sensors `pad` and `body`.
fn record(pad: Vec<f64>, body: Vec<f64>) -> History {
    history(
        sweep_test(),
        vec![
            (channel("pad", Side::Centre), pad),
            (channel("body", Side::Centre), body),
        ],
    )
}

fn estimate(history: &History, from: &str, to: &str, options: &Options) -> Transmissibility {
    let pair = (point(from), point(to));
    transmissibilities(history, &point("pad"), &[pair], options)
        .unwrap()
        .remove(0)
}

/// Largest relative error of the magnitude and largest error of the phase in degrees between two frequencies.
fn worst(measured: &Transmissibility, band: (f64, f64), truth: impl Fn(f64) -> Complex<f64>) -> (f64, f64) {
    let lines = measured
        .frequency
        .iter()
        .zip(&measured.value)
        .filter(|(f, _)| (band.0..=band.1).contains(*f));
    lines.fold((0.0, 0.0), |(magnitude, phase), (f, value)| {
        let ratio = value / truth(*f);
        (
            f64::max(magnitude, (ratio.norm() - 1.0).abs()),
            f64::max(phase, ratio.arg().abs().to_degrees()),
        )
    })
}

#[test]
fn a_sweep_gives_the_exact_response_of_lightly_damped_modes() {
    for damping in [0.25, 0.1] {
        let modes = Modes::vehicle(damping);
        let pad = sweep_record(0.1);
        let body = modes.simulate(|t| sweep(t, 0.1), pad.len(), RATE);
        let measured = estimate(&record(pad, body), "pad", "body", &Options::default());
        assert_eq!(
            (measured.frequency.len(), measured.frequency[0], measured.frequency[299]),
            (300, 0.5, 30.0)
        );
        let (magnitude, phase) = worst(&measured, (0.7, 30.0), |f| modes.response(f));
        assert!(
            magnitude < 2e-3 && phase < 0.2,
            "damping {damping}: {magnitude} {phase}"
        );
        assert!(
            worst(&measured, (0.5, 0.7), |f| modes.response(f)).0 < 3e-3,
            "where the sweep fades in"
        );
        assert!(measured.coherence.iter().all(|c| *c > 0.9999));
    }
}

#[test]
fn segment_averages_of_a_sweep_are_biased() {
    let modes = Modes::vehicle(0.1);
    let pad = sweep_record(0.1);
    let body = modes.simulate(|t| sweep(t, 0.1), pad.len(), RATE);
    let options = Options {
        estimator: Estimator::welch(4.0, RATE),
        frequencies: None,
    };
    let measured = estimate(&record(pad, body), "pad", "body", &options);
    assert!(
        worst(&measured, (1.0, 1.4), |f| modes.response(f)).0 > 0.04,
        "why sweeps are estimated locally"
    );
}

#[test]
fn a_channel_between_two_masses_is_the_ratio_of_their_responses() {
    let (body, wheel) = (Modes::vehicle(0.25), Modes(vec![(10.5, 0.15, 1.0)]));
    let pad = sweep_record(0.1);
    let mut history = record(pad.clone(), body.simulate(|t| sweep(t, 0.1), pad.len(), RATE));
    let wheel_signal = wheel.simulate(|t| sweep(t, 0.1), pad.len(), RATE);
    history.signals.push((channel("wheel", Side::Centre), wheel_signal));
    let measured = estimate(&history, "wheel", "body", &Options::default());
    let (magnitude, phase) = worst(&measured, (0.7, 30.0), |f| body.response(f) / wheel.response(f));
    assert!(magnitude < 2e-3 && phase < 0.2, "{magnitude} {phase}");
}

/// Mean of `|error|² / variance` over many records and the lines of a band: 1 for an honest variance.
fn normalised_error(records: &[Transmissibility], band: (f64, f64), truth: impl Fn(f64) -> Complex<f64>) -> f64 {
    let errors = records.iter().flat_map(|record| {
        let lines = record.frequency.iter().zip(record.value.iter().zip(&record.variance));
        lines
            .filter(|(f, _)| (band.0..=band.1).contains(*f))
            .map(|(f, (value, variance))| (value - truth(*f)).norm_sqr() / variance)
    });
    let errors: Vec<f64> = errors.collect();
    errors.iter().sum::<f64>() / errors.len() as f64
}

#[test]
fn the_variance_is_that_of_the_errors() {
    let (body, wheel) = (Modes::vehicle(0.25), Modes(vec![(10.5, 0.15, 1.0)]));
    let pad = sweep_record(0.025);
    let body_signal = body.simulate(|t| sweep(t, 0.025), pad.len(), RATE);
    let wheel_signal = wheel.simulate(|t| sweep(t, 0.025), pad.len(), RATE);
    let mut noise = Noise(88_172_645_463_325_252);
    let pairs = [(point("pad"), point("body")), (point("wheel"), point("body"))];
    let options = Options {
        frequencies: Some(logarithmic(0.5, 30.0, 60)),
        ..Options::default()
    };
    let mut measured = [Vec::new(), Vec::new()];
    for _ in 0..24 {
        let mut history = record(pad.clone(), noise.added(&body_signal, 0.02));
        history.test = sweep_of(0.025);
        history
            .signals
            .push((channel("wheel", Side::Centre), noise.added(&wheel_signal, 0.02)));
        let both = transmissibilities(&history, &point("pad"), &pairs, &options).unwrap();
        measured.iter_mut().zip(both).for_each(|(all, one)| all.push(one));
    }
    for band in [(0.5, 1.0), (1.0, 3.0), (3.0, 7.0), (7.0, 15.0), (15.0, 30.0)] {
        for (records, truth) in measured
            .iter()
            .zip([&(|f| body.response(f)) as &dyn Fn(f64) -> Complex<f64>, &|f| {
                body.response(f) / wheel.response(f)
            }])
        {
            let ratio = normalised_error(records, band, truth);
            assert!(
                (0.7..1.4).contains(&ratio),
                "{} in {band:?} Hz: {ratio}",
                records[0].from
            );
        }
    }
}

#[test]
fn sides_are_averaged_to_the_virtual_centre() {
    let history = history(
        sweep_test(),
        vec![
            (channel("pad", Side::Left), vec![1.0, 2.0, 3.0]),
            (channel("pad", Side::Right), vec![3.0, 2.0, 0.0]),
            (channel("sf", Side::Front), vec![1.0, 0.0, 0.0]),
            (channel("sf", Side::Rear), vec![0.0, 1.0, 0.0]),
            (channel("pwt", Side::Centre), vec![4.0, 5.0, 6.0]),
        ],
    );
    assert_eq!(points(&history), [point("pad"), point("sf"), point("pwt")]);
    assert_eq!(signal(&history, &point("pad")).unwrap(), [2.0, 2.0, 1.5]);
    assert_eq!(signal(&history, &point("sf")).unwrap(), [0.5, 0.5, 0.0]);
    assert_eq!(signal(&history, &point("pwt")).unwrap(), [4.0, 5.0, 6.0]);
}

#[test]
fn uneven_pads_give_the_response_of_the_centre() {
    let modes = Modes::vehicle(0.25);
    let pad = sweep_record(0.1);
    let body = modes.simulate(|t| sweep(t, 0.1), pad.len(), RATE);
    let scaled = |signal: &[f64], factor: f64| signal.iter().map(|x| x * factor).collect::<Vec<_>>();
    let history = history(
        sweep_test(),
        vec![
            (channel("pad", Side::Left), scaled(&pad, 1.1)),
            (channel("pad", Side::Right), scaled(&pad, 0.9)),
            (channel("body", Side::Left), scaled(&body, 1.02)),
            (channel("body", Side::Right), scaled(&body, 0.98)),
        ],
    );
    let measured = estimate(&history, "pad", "body", &Options::default());
    assert!(worst(&measured, (0.7, 30.0), |f| modes.response(f)).0 < 2e-3);
}

/// A random force that is held between samples, and the response to it, on a system with a mode at 20 Hz.
fn held(band_limited: bool, rate: f64) -> (Modes, History) {
    let modes = Modes(vec![(20.0, 0.05, 1.0)]);
    let mut noise = Noise(4_101_842_887_655_102_017);
    let force: Vec<f64> = (0..20_000).map(|_| noise.normal()).collect();
    let response = modes.simulate(|t| force[(t * rate) as usize], force.len(), rate);
    let test = Test::TimeHistory(Recording {
        sample_rate: rate,
        band_limited,
        band: None,
        periodic: false,
    });
    (
        modes,
        history(
            test,
            vec![
                (channel("pad", Side::Centre), force),
                (channel("body", Side::Centre), response),
            ],
        ),
    )
}

#[test]
fn a_held_input_is_released() {
    let (modes, history) = held(false, 500.0);
    let options = Options {
        frequencies: Some(logarithmic(2.0, 60.0, 100)),
        ..Options::default()
    };
    let measured = estimate(&history, "pad", "body", &options);
    let (magnitude, phase) = worst(&measured, (2.0, 60.0), |f| modes.response(f));
    assert!(magnitude < 0.03 && phase < 2.0, "{magnitude} {phase}");
    let (_, history) = held(true, 500.0);
    let taken_as_smooth = estimate(&history, "pad", "body", &options);
    assert!(
        worst(&taken_as_smooth, (40.0, 60.0), |f| modes.response(f)).1 > 10.0,
        "half a sample late"
    );
}

#[test]
fn averages_over_random_excitation_are_right_and_know_their_variance() {
    let modes = Modes(vec![(20.0, 0.2, 1.0)]);
    let (rate, samples) = (200.0, 20_000);
    let mut noise = Noise(2_685_821_657_736_338_717);
    let options = Options {
        estimator: Estimator::welch(5.0, rate),
        frequencies: Some(vec![2.0, 60.0]),
    };
    let mut measured = Vec::new();
    for _ in 0..6 {
        let mut tones = Tones::new(&mut noise, 70.0, 200);
        tones.1 = (2.0 / 200f64).sqrt();
        let pad: Vec<f64> = (0..samples).map(|k| tones.at(k as f64 / rate)).collect();
        let clean: Vec<f64> = (0..samples).map(|k| tones.through(&modes, k as f64 / rate)).collect();
        let test = Test::TimeHistory(Recording {
            sample_rate: rate,
            band_limited: true,
            band: None,
            periodic: false,
        });
        let body = noise.added(&clean, 0.5);
        let history = history(
            test,
            vec![
                (channel("pad", Side::Centre), pad),
                (channel("body", Side::Centre), body),
            ],
        );
        measured.push(estimate(&history, "pad", "body", &options));
    }
    let ratio = normalised_error(&measured, (2.0, 60.0), |f| modes.response(f));
    assert!((0.7..1.5).contains(&ratio), "{ratio}");
}

/// Many sines of random frequency and phase: a random signal whose response is known exactly.
struct Tones(Vec<(f64, f64)>, f64);

impl Tones {
    fn new(noise: &mut Noise, highest: f64, count: usize) -> Tones {
        Tones(
            (0..count)
                .map(|_| (highest * noise.uniform(), TAU * noise.uniform()))
                .collect(),
            1.0,
        )
    }

    fn at(&self, t: f64) -> f64 {
        self.0
            .iter()
            .map(|(f, phase)| self.1 * (TAU * f * t + phase).cos())
            .sum()
    }

    fn through(&self, modes: &Modes, t: f64) -> f64 {
        let tone = |(f, phase): &(f64, f64)| (modes.response(*f) * Complex::from_polar(self.1, TAU * f * t + phase)).re;
        self.0.iter().map(tone).sum()
    }
}

/// Of both laws, declared as either; noise of a hundredth of the signal does no harm.
#[test]
fn a_sweep_of_the_other_law_is_refused() {
    let linear = |k: usize| {
        let (t, last) = (k as f64 / RATE, SECONDS);
        let frequency = 0.5 + 29.5 * t / last;
        TAU * frequency * 0.1 * (TAU * (0.5 * t + 0.5 * 29.5 * t * t / last)).cos()
    };
    let linear: Vec<f64> = (0..(SECONDS * RATE) as usize).map(linear).collect();
    let mut noise = Noise(7);
    let records = [
        (Spacing::Logarithmic, noise.added(&sweep_record(0.1), 0.05)),
        (Spacing::Linear, noise.added(&linear, 0.1)),
    ];
    for (true_law, pad) in &records {
        for declared in [Spacing::Logarithmic, Spacing::Linear] {
            let mut history = record(pad.clone(), pad.clone());
            let Test::Sweep(sweep) = &mut history.test else {
                panic!("it is a sweep")
            };
            sweep.spacing = declared;
            let pair = (point("pad"), point("body"));
            let found = transmissibilities(&history, &point("pad"), &[pair], &Options::default());
            let words = |law: Spacing| format!("spacing = \"{}\"", format!("{law:?}").to_lowercase());
            match (declared == *true_law, found) {
                (true, found) => drop(found.unwrap()),
                (false, found) => {
                    let said = found.unwrap_err().to_string();
                    assert!(
                        said.contains(&format!("expected `{}`; write `{}`", words(declared), words(*true_law))),
                        "{said}"
                    );
                }
            }
        }
    }
}

#[test]
fn what_a_record_cannot_tell_is_refused() {
    let pad = sweep_record(0.1);
    let refusal = |history: &History, options: &Options| {
        let pair = (point("pad"), point("body"));
        transmissibilities(history, &point("pad"), &[pair], options)
            .unwrap_err()
            .to_string()
    };
    let cut = |seconds: f64| {
        let samples = (seconds * RATE) as usize;
        record(pad[..samples].to_vec(), pad[..samples].to_vec())
    };
    let all = Options::default();
    assert!(refusal(&cut(30.0), &all).contains("expected a sweep to `end_frequency = 30`"));
    let late = record(pad[20_000..].to_vec(), pad[20_000..].to_vec());
    assert!(refusal(&late, &all).contains("expected a sweep from `start_frequency = 0.5`"));
    assert!(refusal(&record(vec![0.0; 11_000], vec![1.0; 11_000]), &all).contains("found a signal that is zero"));
    let in_g: Vec<f64> = pad.iter().map(|a| a / 9.81).collect();
    let said = refusal(&record(in_g, pad.clone()), &all);
    assert!(
        said.contains("found a peak velocity of 9.9") && said.contains("`peak_velocity = 0.1`"),
        "{said}"
    );
    let dead = record(pad.clone(), vec![0.2; pad.len()]);
    assert!(refusal(&dead, &all).contains("found a signal that never changes"));
    let mut without_body = cut(43.0);
    without_body.signals.pop();
    let said = refusal(&without_body, &all);
    assert!(
        said.contains("`body z acceleration`: found no such channel, expected pad z acceleration"),
        "{said}"
    );
    let asking = |frequencies: &[f64]| Options {
        frequencies: Some(frequencies.to_vec()),
        ..Options::default()
    };
    let said = refusal(&cut(0.2), &all);
    assert!(
        said.contains("found a record of 0.2 s, which is too short, expected at least 10.0 s for 0.5 Hz"),
        "{said}"
    );
    assert!(refusal(&cut(43.0), &asking(&[1.0, 600.0])).contains("half the sample rate"));
    assert!(refusal(&cut(43.0), &asking(&[2.0, 1.0])).contains("increasing"));
    assert!(refusal(&cut(43.0), &asking(&[0.01, 1.0])).contains("a record of 43.0 s"));
    assert!(refusal(&cut(43.0), &asking(&[])).contains("found no frequency"));
    let long = Options {
        estimator: Estimator::welch(60.0, RATE),
        frequencies: None,
    };
    assert!(refusal(&cut(43.0), &long).contains("a record of 43.0 s"));
}
