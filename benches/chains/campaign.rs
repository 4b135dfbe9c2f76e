//! Campaigns of a chain: driven by a sweep of its road, by any other record of it, over a cleat, and on a K&C rig; and
//! one that its parameters are fitted to.

use std::f64::consts::TAU;
use std::fmt::Write;
use std::fs;
use std::path::Path;

/// Samples of the record, at a rate.
const SAMPLES: usize = 1000;
const RATE: f64 = 500.0;

/// The masses with sensors in the campaign to be fitted: near the road, since a chain passes little on to its end.
pub const SENSORS: [usize; 3] = [1, 2, 4];

/// Samples of each of its sweeps.
const SWEPT: usize = 10_000;

/// Mass (kg), stiffness (N/m) and damping (N s/m) of each member.
const MEMBER: [f64; 3] = [2.0, 4e3, 30.0];

/// Writes the campaigns `sweep`, `history`, `cleat`, `kc` and `fitted` for the chain in a folder.
pub fn write(folder: &Path, masses: usize) {
    let swept = "peak_velocity = 0.1\nstart_frequency = 0.5\nend_frequency = 19.0\nspacing = \"linear\"\n";
    driven(&folder.join("sweep"), masses, ("sweep", swept));
    driven(
        &folder.join("history"),
        masses,
        ("time_history", "band_limited = true\n"),
    );
    cleat(&folder.join("cleat"), masses);
    kc(&folder.join("kc"), masses);
    fitted(&folder.join("fitted"), masses);
}

/// By a record of its road, as a run of a kind with these keys.
fn driven(folder: &Path, masses: usize, (kind, keys): (&str, &str)) {
    let mut record = "time,road,top\n".to_string();
    for sample in 0..SAMPLES {
        let time = sample as f64 / RATE;
        let road = (30.0 * time * time).sin();
        writeln!(record, "{time},{road},{}", 0.1 * road).expect("a text takes what is written");
    }
    put(folder, "record.csv", &record);
    let channels = [channel("road", "road_below"), channel("top", &format!("q{masses}"))].concat();
    let run =
        format!("[[run]]\nkind = \"{kind}\"\nfile = \"record.csv\"\nrole = \"fit\"\nsample_rate = {RATE}\n{keys}");
    put(
        folder,
        "campaign.toml",
        &format!("{}{channels}{run}", head("chain", "")),
    );
}

fn cleat(folder: &Path, masses: usize) {
    let mut record = "time,wheel\n".to_string();
    for sample in 0..SAMPLES {
        let time = sample as f64 / RATE;
        let shake = (-4.0 * time).exp() * (40.0 * time).sin();
        writeln!(record, "{time},{shake}").expect("a text takes what is written");
    }
    put(folder, "record.csv", &record);
    put(
        folder,
        "road.csv",
        "x,z,slope\n0,0,0\n0.5,0,0.1\n0.6,0.01,-0.1\n0.7,0,0\n40,0,0\n",
    );
    let vehicle = "[vehicle]\nr_tire = 0.33\nstatic_tire_load = 80.0\nstatic_tire_def = 0.02\n";
    let run = format!(
        "[[run]]\nkind = \"cleat\"\nfile = \"record.csv\"\nrole = \"fit\"\nspeed = 8.0\nsample_rate = {RATE}\ncleat = \"bump\"\n\
         [[road]]\nname = \"bump\"\nfile = \"road.csv\"\n"
    );
    let channel = channel("wheel", "q1");
    put(
        folder,
        "campaign.toml",
        &format!("{}{}{channel}{run}", head("chain", vehicle), roles(masses)),
    );
}

/// The lowest mass is moved up and down, the highest is held, and the springs between them are in series.
fn kc(folder: &Path, masses: usize) {
    let stiffness = 4e3 / (masses - 1) as f64;
    let mut curve = "displacement,force\n".to_string();
    for sample in 0..=160_i32 {
        let displacement = 0.02 - 5e-4 * f64::from((sample - 80).abs());
        writeln!(curve, "{displacement},{}", stiffness * displacement).expect("a text takes what is written");
    }
    put(folder, "bounce.csv", &curve);
    let run = "[[run]]\nkind = \"bounce\"\nfile = \"bounce.csv\"\nrole = \"fit\"\n";
    let channel = channel("wheel", "q1");
    put(
        folder,
        "campaign.toml",
        &format!("{}{}{channel}{run}", head("chain", ""), roles(masses)),
    );
}

/// Two sweeps of 20 s with three sensors, and the parameters with which they were simulated.
fn fitted(folder: &Path, masses: usize) {
    let mut manifest = head("few", "");
    for (name, start, unit) in [("k", 3.7e3, "N/m"), ("c", 33.0, "N s/m")] {
        let [low, high] = [0.5, 2.0].map(|factor| factor * start);
        write!(
            manifest,
            "[parameters.{name}]\nvalue = {start:?}\nunit = \"{unit}\"\nfit = true\nrange = [{low:?}, {high:?}]\n"
        )
        .expect("a text takes what is written");
    }
    manifest += "[parameters.m]\nvalue = 2.0\nunit = \"kg\"\nfit = false\n";
    manifest += &channel("road", "road_below");
    manifest.extend(SENSORS.map(|place| channel(&format!("q{place}"), &format!("q{place}"))));
    for (role, level) in [("fit", 0.1), ("held_out", 0.05)] {
        let run = format!(
            "[[run]]\nkind = \"sweep\"\nfile = \"{role}.csv\"\nrole = \"{role}\"\nsample_rate = {RATE}\n\
             peak_velocity = {level}\nstart_frequency = 0.5\nend_frequency = 19.0\nspacing = \"linear\"\n"
        );
        manifest += &run;
        put(folder, &format!("{role}.csv"), &swept(masses, level));
    }
    put(folder, "campaign.toml", &manifest);
    let [m, k, c] = MEMBER;
    put(
        folder,
        "truth.toml",
        &format!("generator = \"Runge and Kutta\"\neffects = []\n[parameters]\nm = {m:?}\nk = {k:?}\nc = {c:?}\n"),
    );
}

/// The record of a sweep from 0.5 to 19 Hz at a peak velocity (m/s) of the road, by Runge and Kutta's method.
fn swept(masses: usize, peak_velocity: f64) -> String {
    let duration = SWEPT as f64 / RATE;
    let [m, k, c] = MEMBER;
    let ground = |time: f64| {
        let rate = TAU * (19.0 - 0.5) / duration;
        let (omega, phase) = (TAU * 0.5 + rate * time, (TAU * 0.5 + rate * time / 2.0) * time);
        time.min(duration - time).min(1.0) * peak_velocity * omega * phase.cos()
    };
    // Positions of the road and the masses, then their velocities.
    let slope = |time: f64, state: &[f64]| -> Vec<f64> {
        let (positions, velocities) = state.split_at(masses + 1);
        let force = |place: usize| {
            let below = place - 1;
            k * (positions[place] - positions[below]) + c * (velocities[place] - velocities[below])
        };
        let above = |place: usize| if place < masses { force(place + 1) } else { 0.0 };
        let accelerations = (1..=masses).map(|place| (above(place) - force(place)) / m);
        let accelerations = std::iter::once(ground(time)).chain(accelerations);
        velocities.iter().copied().chain(accelerations).collect()
    };
    let moved = |state: &[f64], by: f64, slope: &[f64]| -> Vec<f64> {
        state.iter().zip(slope).map(|(own, slope)| own + by * slope).collect()
    };
    let (step, mut state) = (1.0 / RATE, vec![0.0; 2 * (masses + 1)]);
    let mut record = "time,road,q1,q2,q4\n".to_string();
    for sample in 0..SWEPT {
        let time = sample as f64 * step;
        let a = slope(time, &state);
        let [road, one, two, three] = [0, SENSORS[0], SENSORS[1], SENSORS[2]].map(|place| a[masses + 1 + place]);
        writeln!(record, "{time},{road},{one},{two},{three}").expect("a text takes what is written");
        let b = slope(time + step / 2.0, &moved(&state, step / 2.0, &a));
        let c = slope(time + step / 2.0, &moved(&state, step / 2.0, &b));
        let d = slope(time + step, &moved(&state, step, &c));
        let mean = (0..state.len()).map(|place| (a[place] + 2.0 * b[place] + 2.0 * c[place] + d[place]) / 6.0);
        state = moved(&state, step, &mean.collect::<Vec<_>>());
    }
    record
}

fn roles(masses: usize) -> String {
    format!("[roles]\nwheel = \"q1\"\nbody = \"q{masses}\"\n")
}

fn head(model: &str, vehicle: &str) -> String {
    format!("format = 1\nname = \"chain\"\nmodel = \"../{model}.axle\"\n[parameters]\n{vehicle}")
}

fn channel(name: &str, location: &str) -> String {
    format!(
        "[[channel]]\nname = \"{name}\"\nlocation = \"{location}\"\nside = \"left\"\naxis = \"z\"\nquantity = \"acceleration\"\n\
         unit = \"m/s^2\"\n"
    )
}

fn put(folder: &Path, name: &str, text: &str) {
    fs::create_dir_all(folder).expect("the folder is writable");
    fs::write(folder.join(name), text).expect("the folder is writable");
}
