//! Writes a campaign folder in the measurement campaign format, version 1.

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::fs;
use std::io::Write as _;
use std::path::Path;

use flate2::Compression;
use flate2::write::GzEncoder;

use crate::axle::{Axle, GRAVITY, Layout, Mount};
use crate::cleat::{self, Track};
use crate::corner::Corner;
use crate::hardware::Hardware;
use crate::hidden::{Hidden, Laws};
use crate::kc;
use crate::programme::Programme;
use crate::random::Random;
use crate::rig::{self, Motion, RATE, Sweep};
use crate::road::{Road, SPACING};
use crate::sensor::Sensor;

/// All that determines a campaign.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Name of the campaign. With `seed` it seeds everything random in it.
    pub name: String,
    /// The model that the engineer starts from.
    pub model: String,
    /// The hidden effects: in the simulated car, not in the engineer's model.
    pub effects: Vec<Hidden>,
    /// Seed.
    pub seed: u64,
    /// Standard deviation of a sensor's gain error.
    pub systematic: f64,
    /// Noise of the rig's accelerometers, m/s².
    pub noise: f64,
    /// Parameters of the model with the relative error of their start value; 0 means known.
    pub parameters: Vec<(String, f64, f64)>,
    /// The runs of the campaign.
    pub programme: Programme,
    /// Flaws of car, rig and sensors that no model describes.
    pub hardware: Hardware,
}

/// Noise of the accelerometers on the track, m/s².
pub const TRACK_NOISE: f64 = 0.06;
/// Writes the campaign to a folder.
pub fn write(plan: &Plan, axle: &Axle, folder: &Path) -> std::io::Result<()> {
    let laws = Laws::of(&plan.effects).on(&plan.hardware);
    let right = axle.other_side(plan.seed, &plan.hardware);
    for part in ["rig", "kc", "cleat", "road"] {
        fs::create_dir_all(folder.join(part))?;
    }
    let (corner, mirror) = (
        Corner { axle, laws: &laws },
        Corner {
            axle: &right,
            laws: &laws,
        },
    );
    let mut toml = head(plan, axle);
    write_sweeps(plan, &corner, &mirror, folder, &mut toml)?;
    if !plan.programme.kc.is_empty() {
        write_kc(plan, &corner, folder, &mut toml)?;
    }
    write_cleats(plan, &corner, folder, &mut toml)?;
    fs::write(folder.join("campaign.toml"), toml)?;
    fs::write(folder.join("truth.toml"), truth(plan))
}

fn head(plan: &Plan, a: &Axle) -> String {
    let mut text = format!(
        "format = 1\nname = \"{}\"\ndescription = \"Synthetic: a second simulator with its own integrator and tyre.\"\n\
         model = \"{}\"\n\n[vehicle]\nm_corner = {:.1}\nm_half_vehicle = {:.1}\nm_wheel_other_axle = {:.1}\n\
         r_tire = {:.4}\nstatic_tire_load = {:.1}\nstatic_tire_def = {:.5}\ngravity = {GRAVITY}\n",
        plan.name,
        plan.model,
        a.m_corner,
        a.m_half_vehicle,
        a.m_wheel_other_axle,
        a.r_tire,
        a.static_load(),
        a.static_tire_def
    );
    let mut random = Random::new(plan.seed, "start values");
    for (name, value, off) in &plan.parameters {
        let start = value * (1.0 + off * random.uniform(-1.0, 1.0));
        let (low, high) = if name.starts_with('c') { (0.2, 5.0) } else { (0.5, 2.0) };
        let _ = write!(
            text,
            "\n[parameters.{name}]\nvalue = {start:.6e}\nunit = \"{}\"\nrange = [{:.6e}, {:.6e}]\nfit = {}\n",
            unit(name),
            start * low,
            start * high,
            *off > 0.0
        );
    }
    for (name, location, side, axis) in channels(plan) {
        let _ = write!(
            text,
            "\n[[channel]]\nname = \"{name}\"\nlocation = \"{location}\"\nside = \"{side}\"\naxis = \"{axis}\"\n\
             quantity = \"acceleration\"\nunit = \"m/s^2\"\n"
        );
    }
    text
}

fn unit(parameter: &str) -> &'static str {
    match parameter.as_bytes()[0] {
        b'k' => "N/m",
        b'c' => "N s/m",
        b'm' if parameter.starts_with("mr_") => "1",
        _ => "kg",
    }
}

/// Sub-frame and powertrain carry sensors only if the engineer's model has these masses.
fn sees(plan: &Plan, parameter: &str) -> bool {
    plan.parameters.iter().any(|(name, ..)| name == parameter)
}

/// Name, location, side and axis of a sensor.
type Channel = (&'static str, &'static str, &'static str, &'static str);

fn channels(plan: &Plan) -> Vec<Channel> {
    let (swept, driven) = (!plan.programme.sweeps.is_empty(), !plan.programme.cleats.is_empty());
    let (subframe, powertrain) = (sees(plan, "m_sf"), sees(plan, "m_pwt"));
    let body = plan.programme.body_sensor;
    let all: [(Channel, bool); 13] = [
        (("pad_left_z", "pad", "left", "z"), swept),
        (("pad_right_z", "pad", "right", "z"), swept),
        (("wheel_left_z", "wheel", "left", "z"), true),
        (("wheel_right_z", "wheel", "right", "z"), swept),
        (("body_left_z", "body", "left", "z"), body),
        (("body_right_z", "body", "right", "z"), body && swept),
        (("sf_front_z", "sf", "front", "z"), subframe),
        (("sf_rear_z", "sf", "rear", "z"), subframe),
        (("pwt_centre_z", "pwt", "centre", "z"), powertrain),
        (("wheel_left_x", "wheel", "left", "x"), driven),
        (("body_left_x", "body", "left", "x"), driven && body),
        (("sf_front_x", "sf", "front", "x"), driven && subframe),
        (("pwt_centre_x", "pwt", "centre", "x"), driven && powertrain),
    ];
    let there = all.into_iter().filter(|(_, there)| *there);
    there.map(|(channel, _)| channel).collect()
}

fn write_sweeps(plan: &Plan, left: &Corner, right: &Corner, folder: &Path, toml: &mut String) -> std::io::Result<()> {
    for run in &plan.programme.sweeps {
        let sweep = Sweep::new(run, plan.hardware.pad());
        let (here, there) = (rig::run(left, &sweep), rig::run(right, &sweep));
        let file = format!("rig/sweep_{:03}.csv.gz", run.level);
        let columns: Vec<(&str, Vec<f64>)> = channels(plan)
            .into_iter()
            .filter(|channel| channel.3 == "z")
            .map(|(name, location, side, _)| {
                let motion = rig_motion(if side == "right" { &there } else { &here }, location, side);
                (name, record(plan, name, location, plan.noise, run.level, motion))
            })
            .collect();
        write_history(&folder.join(&file), &columns)?;
        let _ = write!(
            toml,
            "\n[[run]]\nkind = \"sweep\"\nfile = \"{file}\"\nrole = \"{}\"\npeak_velocity = {}\n\
             start_frequency = {:?}\nend_frequency = {:?}\nspacing = \"logarithmic\"\nsample_rate = {RATE:?}\n",
            run.role, sweep.peak_velocity, run.from, run.to
        );
    }
    Ok(())
}

fn rig_motion<'a>(motion: &'a Motion, location: &str, side: &str) -> &'a [f64] {
    match (location, side) {
        ("pad", _) => &motion.pad,
        ("wheel", _) => &motion.wheel,
        ("body", _) => &motion.body,
        ("sf", "front") => &motion.sf_front,
        ("sf", _) => &motion.sf_rear,
        _ => &motion.pwt,
    }
}

/// A sensor's gain error is the same in every run; its noise differs from run to run.
fn record(plan: &Plan, name: &str, location: &str, noise: f64, run: u32, motion: &[f64]) -> Vec<f64> {
    let errors = (plan.systematic, noise);
    let sensor = Sensor::new(name, location, errors, &plan.effects, &plan.hardware, plan.seed);
    sensor.record(motion, RATE, plan.seed, run)
}

fn write_kc(plan: &Plan, corner: &Corner, folder: &Path, toml: &mut String) -> std::io::Result<()> {
    let mut random = Random::new(plan.seed, "K&C");
    let mut run = |kind: &str, file: &str, extra: &str| {
        let _ = write!(
            toml,
            "\n[[run]]\nkind = \"{kind}\"\nfile = \"{file}\"\nrole = \"fit\"\n{extra}"
        );
    };
    write_rows(
        &folder.join("kc/bounce.csv"),
        "displacement,force",
        &kc::bounce(corner, 0.08, &mut random),
    )?;
    run("bounce", "kc/bounce.csv", "");
    for &level in &plan.programme.kc {
        let velocity = f64::from(level) / 1000.0;
        let rows = kc::dynamic_bounce(corner, 0.02, velocity, &mut random);
        let file = format!("kc/dynamic_bounce_{level:03}.csv");
        write_rows(&folder.join(&file), "time,displacement,velocity,force", &rows)?;
        run(
            "dynamic_bounce",
            &file,
            &format!("peak_velocity = {velocity}\namplitude = 0.02\n"),
        );
    }
    let rows = kc::longitudinal(corner, &mut random);
    write_rows(&folder.join("kc/longitudinal.csv"), "displacement,force", &rows)?;
    run("longitudinal", "kc/longitudinal.csv", "");
    Ok(())
}

fn write_cleats(plan: &Plan, corner: &Corner, folder: &Path, toml: &mut String) -> std::io::Result<()> {
    let heights: BTreeSet<u32> = plan.programme.cleats.iter().map(|run| run.height).collect();
    for height in heights {
        let road = Road::cleat(f64::from(height) / 1000.0);
        write_road(&folder.join(format!("road/cleat_{height}.csv")), &road)?;
        let _ = write!(
            toml,
            "\n[[road]]\nname = \"cleat_{height}\"\nfile = \"road/cleat_{height}.csv\"\n"
        );
    }
    for run in &plan.programme.cleats {
        let number = run.stream();
        let track = cleat::run(corner, run, plan.hardware.jitter(number));
        let file = format!("cleat/v{:.0}_h{}.csv", run.speed, run.height);
        let columns: Vec<(&str, Vec<f64>)> = channels(plan)
            .into_iter()
            .filter(|&(_, location, side, _)| location != "pad" && side != "right")
            .map(|(name, location, side, axis)| {
                let motion = seen_across(&track, (location, side), axis, plan.hardware.cross_axis(name));
                (name, record(plan, name, location, TRACK_NOISE, number, &motion))
            })
            .collect();
        write_history(&folder.join(&file), &columns)?;
        let _ = write!(
            toml,
            "\n[[run]]\nkind = \"cleat\"\nfile = \"{file}\"\nrole = \"{}\"\nspeed = {:.7}\n\
             sample_rate = {RATE:?}\ncleat = \"cleat_{}\"\n",
            run.role,
            run.speed / 3.6,
            run.height
        );
    }
    Ok(())
}

/// The signal of a sensor that is slightly sensitive to the other axis. On the rig nothing moves along x.
fn seen_across(track: &Track, place: (&str, &str), axis: &str, sensitivity: f64) -> Vec<f64> {
    let across = track_motion(track, place, if axis == "z" { "x" } else { "z" });
    let along = track_motion(track, place, axis);
    along.iter().zip(across).map(|(a, b)| a + sensitivity * b).collect()
}

fn track_motion<'a>(track: &'a Track, (location, side): (&str, &str), axis: &str) -> &'a [f64] {
    match (location, axis) {
        ("sf", "z") if side == "front" => &track.sf_front_z,
        ("wheel", "z") => &track.wheel_z,
        ("body", "z") => &track.body_z,
        ("sf", "z") => &track.sf_rear_z,
        ("pwt", "z") => &track.pwt_z,
        ("wheel", _) => &track.wheel_x,
        ("body", _) => &track.body_x,
        ("sf", _) => &track.sf_x,
        _ => &track.pwt_x,
    }
}

fn write_history(path: &Path, columns: &[(&str, Vec<f64>)]) -> std::io::Result<()> {
    let mut text = String::from("time");
    for (name, _) in columns {
        let _ = write!(text, ",{name}");
    }
    text.push('\n');
    for i in 0..columns[0].1.len() {
        let _ = write!(text, "{:.3}", i as f64 / RATE);
        for (_, values) in columns {
            let _ = write!(text, ",{:.3}", values[i]);
        }
        text.push('\n');
    }
    write_text(path, &text)
}

fn write_rows<const N: usize>(path: &Path, header: &str, rows: &[[f64; N]]) -> std::io::Result<()> {
    let mut text = format!("{header}\n");
    for row in rows {
        let cells: Vec<String> = row.iter().map(|value| format!("{value:.6}")).collect();
        let _ = writeln!(text, "{}", cells.join(","));
    }
    write_text(path, &text)
}

fn write_road(path: &Path, road: &Road) -> std::io::Result<()> {
    let rows: Vec<[f64; 3]> = (0..road.z.len())
        .map(|i| [i as f64 * SPACING, road.z[i], road.slope[i]])
        .collect();
    write_rows(path, "x,z,slope", &rows)
}

fn write_text(path: &Path, text: &str) -> std::io::Result<()> {
    let file = fs::File::create(path)?;
    if path.extension().is_some_and(|extension| extension == "gz") {
        let mut gz = GzEncoder::new(file, Compression::fast());
        gz.write_all(text.as_bytes())?;
        gz.finish().map(|_| ())
    } else {
        let mut file = file;
        file.write_all(text.as_bytes())
    }
}

fn truth(plan: &Plan) -> String {
    let mut text = format!("generator = \"qcar-blind, seed {}\"\neffects = [\n", plan.seed);
    for effect in &plan.effects {
        let parameters: Vec<String> = effect
            .parameters
            .iter()
            .map(|(name, value)| format!("{name} = {value:?}"))
            .collect();
        let _ = writeln!(
            text,
            "  {{ name = \"{}\", at = \"{}\", parameters = {{ {} }} }},",
            effect.name,
            effect.at,
            parameters.join(", ")
        );
    }
    text.push_str("]\n\n[parameters]\n");
    for (name, value, _) in &plan.parameters {
        let _ = writeln!(text, "{name} = {value:?}");
    }
    text
}

/// The parameters of the engineer's model of an axle, each with its true value and the largest relative error of its
/// start value.
pub fn parameters(a: &Axle, model: Layout) -> Vec<(String, f64, f64)> {
    let mut all = vec![("m_wheel", a.m_wheel, 0.3)];
    if model.top_mount {
        all.push(("m_tm", a.m_tm, 0.0));
    }
    if model.subframe {
        all.push(("m_sf", a.m_sf, 0.0));
    }
    if model.powertrain != Mount::None {
        all.push(("m_pwt", a.m_pwt, 0.3));
    }
    all.extend([("k_wheel_z", a.k_wheel_z, 0.2), ("c_wheel_z", a.c_wheel_z, 0.3)]);
    if model.top_mount {
        all.extend([("k_tm", a.k_tm, 0.3), ("c_tm", a.c_tm, 0.3)]);
    }
    if model.subframe {
        all.extend([("k_sf_z", a.k_sf_z, 0.3), ("c_sf_z", a.c_sf_z, 0.3)]);
    }
    if model.powertrain != Mount::None {
        all.extend([("k_pwt_z", a.k_pwt_z, 0.25), ("c_pwt_z", a.c_pwt_z, 0.3)]);
    }
    if model.subframe {
        all.extend([("mr_spring", a.mr_spring, 0.0), ("mr_damper", a.mr_damper, 0.0)]);
    }
    all.extend([("k_wheel_x", a.k_wheel_x, 0.2), ("c_wheel_x", a.c_wheel_x, 0.3)]);
    if model.subframe {
        all.extend([("k_sf_x", a.k_sf_x, 0.2), ("c_sf_x", a.c_sf_x, 0.3)]);
    }
    if model.powertrain != Mount::None {
        all.extend([("k_pwt_x", a.k_pwt_x, 0.2), ("c_pwt_x", a.c_pwt_x, 0.3)]);
    }
    all.extend([("k_tire", a.k_tire, 0.25), ("c_tire", a.c_tire, 0.3)]);
    all.into_iter()
        .map(|(name, value, off)| (name.to_owned(), value, off))
        .collect()
}

/// The parameters that a fit may change.
pub fn moving(plan: &Plan) -> impl Iterator<Item = &str> {
    plan.parameters
        .iter()
        .filter(|(_, _, off)| *off > 0.0)
        .map(|(name, ..)| name.as_str())
}

/// A parameter of an axle by its name.
pub fn value<'a>(a: &'a mut Axle, name: &str) -> &'a mut f64 {
    match name {
        "m_wheel" => &mut a.m_wheel,
        "m_pwt" => &mut a.m_pwt,
        "k_wheel_z" => &mut a.k_wheel_z,
        "c_wheel_z" => &mut a.c_wheel_z,
        "k_tm" => &mut a.k_tm,
        "c_tm" => &mut a.c_tm,
        "k_sf_z" => &mut a.k_sf_z,
        "c_sf_z" => &mut a.c_sf_z,
        "k_pwt_z" => &mut a.k_pwt_z,
        "c_pwt_z" => &mut a.c_pwt_z,
        "k_wheel_x" => &mut a.k_wheel_x,
        "c_wheel_x" => &mut a.c_wheel_x,
        "k_sf_x" => &mut a.k_sf_x,
        "c_sf_x" => &mut a.c_sf_x,
        "k_pwt_x" => &mut a.k_pwt_x,
        "c_pwt_x" => &mut a.c_pwt_x,
        "k_tire" => &mut a.k_tire,
        "c_tire" => &mut a.c_tire,
        _ => panic!("{name} is no parameter that a fit changes"),
    }
}
