//! Fits of nonlinear laws to records of a car that is simulated here, by laws written by hand: true values lie within
//! two standard errors as often as these say.

use std::array;
use std::f64::consts::TAU;
use std::fmt::Write;
use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::common::succeeds;

/// A wheel on a tyre, a body on it, and an engine in the body. The damper stands in a slot.
const CAR: &str = "axle car {
    \"A body on a wheel on a tyre, and an engine in its mount\"
    known param m_body: kg = 360 kg in 50..2000 \"Body\";
    known param m_wheel: kg = 40 kg in 5..200 \"Wheel\";
    known param m_engine: kg = 60 kg in 5..200 \"Engine\";
    known param c_tire: N s/m = 150 in 5..5e3 \"Damping of the tyre\";
    param k_tire: N/m = 220 N/mm in 50 N/mm..1 kN/mm \"Stiffness of the tyre\";
    param k_spring: N/m = 25 N/mm in 5 N/mm..200 N/mm \"Spring\";
    param k_mount: N/m = 150 N/mm in 20 N/mm..1 kN/mm \"Mount\";
    param c_mount: N s/m = 300 in 10..5e3 \"Its damping\";
    PARAMETERS
    direction z {
        road pad;
        mass body = m_body;
        mass wheel = m_wheel;
        mass engine = m_engine;
        link tire: wheel - pad { spring k_tire; damper c_tire; }
        link spring: body - wheel { spring k_spring; }
        link damper: body - wheel { DAMPER; }
        link mount: engine - body { spring k_mount; damper c_mount; }
        channel pad_to_body = body.acceleration / pad.acceleration;
        channel pad_to_wheel = wheel.acceleration / pad.acceleration;
        channel pad_to_engine = engine.acceleration / pad.acceleration;
    }
}
";
const LINEAR: (&str, &str) = (
    "param c_damper: N s/m = 1500 in 50..20e3 \"Damper\";",
    "damper c_damper",
);

/// A curve with points to be found, of which the outermost are as many times the next.
const TABLE: (&str, &str) = (
    "param f_out_low: N = 200 in 20..800 \"Force at 0.1 m/s in rebound\";
    param f_out: N = 700 in 100..2000 \"Force at 0.4 m/s in rebound\";
    param f_in_low: N = 200 in 20..800 \"Force at 0.1 m/s in compression\";
    param f_in: N = 700 in 100..2000 \"Force at 0.4 m/s in compression\";",
    "force = table(v, [-1 m/s, -0.4 m/s, -0.1 m/s, 0, 0.1 m/s, 0.4 m/s, 1 m/s],
            [-1.7*f_in, -f_in, -f_in_low, 0, f_out_low, f_out, 1.9*f_out])",
);

/// True values of what every car has.
const CAR_TRUTH: [(&str, f64); 4] = [
    ("k_tire", K_TIRE),
    ("k_spring", K_SPRING),
    ("k_mount", K_MOUNT),
    ("c_mount", C_MOUNT),
];
const K_TIRE: f64 = 205e3;
const K_SPRING: f64 = 28e3;
const K_MOUNT: f64 = 170e3;
const C_MOUNT: f64 = 260.0;
const C_DAMPER: f64 = 1700.0;

/// Hz, and s.
const RATE: f64 = 400.0;
const SECONDS: f64 = 4.0;
/// Levels of the two records.
const LEVELS: [f64; 2] = [0.5, 1.5];
/// Standard deviation of the noise of accelerometers, m/s².
const NOISE: f64 = 0.05;
/// Standard deviation of a sensor's gain error: the calibration that the fit assumes (`SENSOR` in
/// `discover/noise/calibration.rs`).
const GAIN: f64 = 0.007;
/// Noise and gain errors are drawn so often.
const DRAWS: u64 = 6;

/// Stretch and its rate.
type Motion = [f64; 2];

/// The force of the suspension, and that of the mount with the rates of two inner states.
struct Laws {
    suspension: fn(Motion) -> f64,
    mount: fn(Motion, [f64; 2]) -> (f64, [f64; 2]),
}

fn linear_suspension([s, v]: Motion) -> f64 {
    K_SPRING * s + C_DAMPER * v
}

fn linear_mount([s, v]: Motion, _: [f64; 2]) -> (f64, [f64; 2]) {
    (K_MOUNT * s + C_MOUNT * v, [0.0; 2])
}

fn suspended_by(suspension: fn(Motion) -> f64) -> Laws {
    Laws {
        suspension,
        mount: linear_mount,
    }
}

#[test]
fn a_bump_stop() {
    let laws = suspended_by(|[s, v]| linear_suspension([s, v]) + 90e3 * (s + 0.012).min(0.0));
    covers(
        LINEAR,
        Some("bump_stop --at spring"),
        &laws,
        &[("c_damper", C_DAMPER), ("gap", 0.012), ("k_stop", 90e3)],
    );
}

#[test]
fn a_progressive_spring() {
    let laws = suspended_by(|[s, v]| linear_suspension([s, v]) + K_SPRING * 0.9 / 3.0 * s.powi(3) / 0.04_f64.powi(2));
    covers(
        LINEAR,
        Some("progressive_spring --at spring"),
        &laws,
        &[("c_damper", C_DAMPER), ("rate_increase_at_40mm", 0.9)],
    );
}

#[test]
fn a_digressive_damper() {
    let laws = suspended_by(|[s, v]| K_SPRING * s + 2600.0 * v / (1.0 + v.abs() / 0.25));
    covers(
        LINEAR,
        Some("digressive_damper --at damper"),
        &laws,
        &[("c0", 2600.0), ("v0", 0.25)],
    );
}

/// The mean of both coefficients is that of the linear damper.
#[test]
fn an_asymmetric_damper() {
    let laws = suspended_by(|[s, v]| {
        let compression = 2.0 * C_DAMPER / 3.2;
        K_SPRING * s + if v > 0.0 { 2.2 * compression } else { compression } * v
    });
    covers(
        LINEAR,
        Some("asymmetric_damper --at damper"),
        &laws,
        &[("c_damper", C_DAMPER), ("rebound_over_compression", 2.2)],
    );
}

#[test]
fn a_curve_through_points() {
    let laws = suspended_by(|[s, v]| K_SPRING * s + curve(v));
    covers(
        TABLE,
        None,
        &laws,
        &[
            ("f_out_low", 330.0),
            ("f_out", 800.0),
            ("f_in_low", 210.0),
            ("f_in", 520.0),
        ],
    );
}

/// Fluid of 38 kg in a track, beside the rubber. This law is linear, so that all runs have to be asked for.
#[test]
fn a_hydraulic_mount() {
    let laws = Laws {
        suspension: linear_suspension,
        mount: |[s, v], [fluid, speed]| {
            let pressed = 110e3 * (s - fluid);
            let flow = [speed, (pressed - 450.0 * speed) / 38.0];
            (linear_mount([s, v], [0.0; 2]).0 + pressed, flow)
        },
    };
    covers(
        LINEAR,
        Some("hydraulic_mount --at mount"),
        &laws,
        &[
            ("c_damper", C_DAMPER),
            ("k_volume", 110e3),
            ("inertance", 38.0),
            ("c_track", 450.0),
        ],
    );
}

/// Fits a model with an effect to each draw, and compares how far values are off with what the fit says of that. Of
/// normal errors one in twenty is beyond two standard errors; those of one fit go together.
fn covers((parameters, damper): (&str, &str), effect: Option<&str>, laws: &Laws, hidden: &[(&str, f64)]) {
    let folder = tempfile::tempdir().unwrap();
    let [plain, model] = ["plain.axle", "model.axle"].map(|name| folder.path().join(name));
    let text = CAR.replace("PARAMETERS", parameters).replace("DAMPER", damper);
    fs::write(&plain, &text).unwrap();
    match effect {
        None => fs::write(&model, &text).unwrap(),
        Some(effect) => {
            let paths = [plain.to_str().unwrap(), model.to_str().unwrap()];
            let line: Vec<&str> = effect.split(' ').collect();
            succeeds(&[&["patch", paths[0]], &line[..], &["--out", paths[1]]].concat());
        }
    }
    let records = LEVELS.map(|level| simulated(laws, level));
    let mut off = Vec::new();
    for draw in 0..DRAWS {
        campaign(folder.path(), &records, draw);
        let line = ["fit", folder.path().to_str().unwrap(), "--all-runs", "--starts", "2"];
        let fit: Value = serde_json::from_str(&succeeds(&[&line[..], &["--format", "json"]].concat())).unwrap();
        for (name, truth) in CAR_TRUTH.iter().chain(hidden) {
            let own = &fit["parameters"][name];
            let [value, error] = ["value", "stderr"].map(|key| own[key].as_f64().unwrap_or(f64::NAN));
            println!("{draw}: {name} = {value} ± {error}, truth {truth}");
            assert!(error < 0.1 * truth, "{name}: {own}");
            off.push((value - truth) / error);
        }
    }
    let beyond = off.iter().filter(|off| off.abs() > 2.0).count();
    let size = (off.iter().map(|off| off * off).sum::<f64>() / off.len() as f64).sqrt();
    println!("{beyond} of {} are beyond two standard errors; RMS {size}", off.len());
    assert!(beyond * 8 <= off.len(), "{off:?}");
    assert!((0.4..1.4).contains(&size), "{size} of {off:?}");
}

/// The pad's displacement and velocity.
fn pad(level: f64, t: f64) -> [f64; 2] {
    // Hz, m, rad.
    const TONES: [[f64; 3]; 8] = [
        [0.6, 0.020, 0.3],
        [1.1, 0.014, 1.7],
        [1.7, 0.010, 4.0],
        [2.9, 0.005, 2.2],
        [5.3, 0.0025, 5.1],
        [8.7, 0.0014, 0.9],
        [12.1, 0.0008, 3.3],
        [16.3, 0.0005, 2.6],
    ];
    let tones = TONES.map(|[hertz, size, phase]| {
        let (sin, cos) = (TAU * hertz * t + phase).sin_cos();
        [size * (sin - phase.sin()), size * TAU * hertz * cos]
    });
    [0, 1].map(|k| level * tones.iter().map(|tone| tone[k]).sum::<f64>())
}

/// At every sample the pad's displacement and the accelerations of body, wheel and engine, by Runge and Kutta's method
/// in steps of a tenth of a sample.
fn simulated(laws: &Laws, level: f64) -> Vec<[f64; 4]> {
    const FINER: usize = 10;
    let rates = |t: f64, [body, v_body, wheel, v_wheel, engine, v_engine, a, b]: [f64; 8]| {
        let [pad, v_pad] = pad(level, t);
        let suspension = (laws.suspension)([body - wheel, v_body - v_wheel]);
        let (mount, inner) = (laws.mount)([engine - body, v_engine - v_body], [a, b]);
        let tire = K_TIRE * (wheel - pad) + 150.0 * (v_wheel - v_pad);
        let of_body = (mount - suspension) / 360.0;
        let of_wheel = (suspension - tire) / 40.0;
        [
            v_body,
            of_body,
            v_wheel,
            of_wheel,
            v_engine,
            -mount / 60.0,
            inner[0],
            inner[1],
        ]
    };
    let add = |x: [f64; 8], k: [f64; 8], h: f64| array::from_fn(|i| x[i] + h * k[i]);
    let h = 1.0 / (RATE * FINER as f64);
    let (mut x, mut samples) = ([0.0; 8], Vec::new());
    for step in 0..(SECONDS * RATE) as usize * FINER {
        let t = step as f64 * h;
        let a = rates(t, x);
        if step % FINER == 0 {
            samples.push([pad(level, t)[0], a[1], a[3], a[5]]);
        }
        let b = rates(t + h / 2.0, add(x, a, h / 2.0));
        let c = rates(t + h / 2.0, add(x, b, h / 2.0));
        let d = rates(t + h, add(x, c, h));
        x = array::from_fn(|i| x[i] + h / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]));
    }
    samples
}

/// The damper's curve: the monotone cubic of Fritsch and Butland with the slopes of Moler at its ends, straight beyond.
fn curve(speed: f64) -> f64 {
    const X: [f64; 7] = [-1.0, -0.4, -0.1, 0.0, 0.1, 0.4, 1.0];
    const Y: [f64; 7] = [-1.7 * 520.0, -520.0, -210.0, 0.0, 330.0, 800.0, 1.9 * 800.0];
    const LAST: usize = X.len() - 1;
    let width = |k: usize| X[k + 1] - X[k];
    let secant = |k: usize| (Y[k + 1] - Y[k]) / width(k);
    // No point here is so far off that the end would have to be less steep than its parabola.
    let end = |k: usize, next: usize| secant(k) + (secant(k) - secant(next)) * width(k) / (width(k) + width(next));
    let slope = |k: usize| match k {
        0 => end(0, 1),
        LAST => end(LAST - 1, LAST - 2),
        _ => {
            let [before, after] = [2.0 * width(k) + width(k - 1), width(k) + 2.0 * width(k - 1)];
            (before + after) / (before / secant(k - 1) + after / secant(k))
        }
    };
    let beyond = |k: usize| Y[k] + slope(k) * (speed - X[k]);
    match (0..LAST).rfind(|&k| X[k] <= speed) {
        None => beyond(0),
        Some(_) if speed >= X[LAST] => beyond(LAST),
        Some(k) => {
            let piece = width(k);
            let t = (speed - X[k]) / piece;
            let [from, to] = [k, k + 1].map(|end| piece * slope(end));
            let rise = t * t * (3.0 - 2.0 * t);
            (1.0 - rise) * Y[k] + rise * Y[k + 1] + t * (1.0 - t) * ((1.0 - t) * from - t * to)
        }
    }
}

/// Writes the records with noise and gain errors of their own for each draw. A sensor has one gain in both records.
fn campaign(folder: &Path, records: &[Vec<[f64; 4]>], draw: u64) {
    const CHANNELS: [(&str, &str, &str); 4] = [
        ("pad", "displacement", "m"),
        ("body", "acceleration", "m/s^2"),
        ("wheel", "acceleration", "m/s^2"),
        ("engine", "acceleration", "m/s^2"),
    ];
    let mut text = String::from("format = 1\nname = \"c\"\nmodel = \"./model.axle\"\n\n");
    for (name, start, unit) in [
        ("k_tire", 220e3, "N/m"),
        ("k_spring", 25e3, "N/m"),
        ("k_mount", 150e3, "N/m"),
        ("c_mount", 300.0, "N s/m"),
    ] {
        let range = [0.25 * start, 4.0 * start];
        let _ = write!(
            text,
            "[parameters.{name}]\nvalue = {start:?}\nunit = \"{unit}\"\nrange = {range:?}\nfit = true\n\n"
        );
    }
    for (name, quantity, unit) in CHANNELS {
        let _ = write!(
            text,
            "[[channel]]\nname = \"{name}\"\nlocation = \"{name}\"\nside = \"centre\"\naxis = \"z\"\nquantity = \"{quantity}\"\nunit = \"{unit}\"\n\n"
        );
    }
    let mut normal = normals(draw);
    let gains: [f64; 4] = array::from_fn(|_| (GAIN * normal()).exp());
    for (place, record) in records.iter().enumerate() {
        let file = format!("run_{place}.csv");
        let _ = write!(
            text,
            "[[run]]\nkind = \"time_history\"\nfile = \"{file}\"\nrole = \"fit\"\nsample_rate = {RATE}\nband_limited = true\n\n"
        );
        let mut table = String::from("time,pad,body,wheel,engine\n");
        for (sample, own) in record.iter().enumerate() {
            let [pad, accelerations @ ..]: [f64; 4] = array::from_fn(|k| gains[k] * own[k]);
            let [body, wheel, engine] = accelerations.map(|own| own + NOISE * normal());
            let _ = writeln!(table, "{},{pad},{body},{wheel},{engine}", sample as f64 / RATE);
        }
        fs::write(folder.join(file), table).unwrap();
    }
    fs::write(folder.join("campaign.toml"), text).unwrap();
}

/// Normal deviates by the method of Box and Muller.
fn normals(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ 0x2545_f491_4f6c_dd1d;
    let mut even = move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    move || {
        let (size, turn) = (1.0 - even(), even());
        (-2.0 * size.ln()).sqrt() * (TAU * turn).cos()
    }
}
