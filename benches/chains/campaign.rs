//! Campaigns that drive a chain: by a sweep of its road, by any other record of it, over a cleat, and on a K&C rig.

use std::fmt::Write;
use std::fs;
use std::path::Path;

/// Samples of the record, at a rate.
const SAMPLES: usize = 1000;
const RATE: f64 = 500.0;

/// Writes the campaigns `sweep`, `history`, `cleat` and `kc` for the chain in a folder.
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
    put(folder, "campaign.toml", &format!("{}{channels}{run}", head("")));
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
        &format!("{}{}{channel}{run}", head(vehicle), roles(masses)),
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
        &format!("{}{}{channel}{run}", head(""), roles(masses)),
    );
}

fn roles(masses: usize) -> String {
    format!("[roles]\nwheel = \"q1\"\nbody = \"q{masses}\"\n")
}

fn head(vehicle: &str) -> String {
    format!("format = 1\nname = \"chain\"\nmodel = \"../chain.axle\"\n[parameters]\n{vehicle}")
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
