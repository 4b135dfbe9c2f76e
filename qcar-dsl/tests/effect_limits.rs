//! An effect of no strength changes nothing, and an effect's law is what its parameters say, measured on the equations.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use qcar_dsl::check::Checked;
use qcar_dsl::check::check_text;
use qcar_dsl::compile::derive;
use qcar_dsl::evaluate::Evaluator;
use qcar_dsl::patch::{NewParameter, ParameterRole, Patch, Patched};
use qcar_dsl::source::Source;
use qcar_model::{Contact, Model as _, ResponseMut};

fn read(path: &Path) -> Source {
    let text = std::fs::read_to_string(path).unwrap();
    let name = path.display().to_string();
    Source { name, text }
}

fn models() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../models")
}

fn model(name: &str) -> Checked {
    let load = |from: &str, path: &str| Ok(read(&Path::new(from).parent().unwrap().join(path)));
    check_text(read(&models().join(format!("axles/{name}.axle"))), &load).unwrap_or_else(|report| panic!("{report}"))
}

fn patch(effect: &str) -> Patch {
    Patch::read(read(&models().join(format!("effects/{effect}.axle")))).unwrap()
}

fn effects() -> Vec<Patch> {
    let files = std::fs::read_dir(models().join("effects")).unwrap();
    let mut files: Vec<_> = files.map(|entry| entry.unwrap().path()).collect();
    files.sort();
    files.iter().map(|file| Patch::read(read(file)).unwrap()).collect()
}

fn made(model: &Checked, patch: &Patch, place: &str) -> Checked {
    patch
        .apply(model, place, &value)
        .unwrap_or_else(|report| panic!("{report}"))
        .model
}

fn patched(model: &Checked, effect: &str, place: &str) -> Checked {
    made(model, &patch(effect), place)
}

fn in_form(model: &Checked, effect: &str, form: &str, place: &str) -> Checked {
    made(model, &patch(effect).in_form(form).unwrap(), place)
}

/// Parameters of a car.
fn value(name: &str) -> Option<f64> {
    let known = [
        ("m_corner", 430.0),
        ("m_wheel", 42.0),
        ("m_tm", 3.0),
        ("m_sf", 15.0),
        ("m_pwt", 60.0),
        ("m_half_vehicle", 840.0),
        ("m_wheel_other_axle", 40.0),
        ("k_wheel_z", 26e3),
        ("c_wheel_z", 1900.0),
        ("mr_spring", 0.7),
        ("mr_damper", 0.8),
        ("k_tm", 6e5),
        ("c_tm", 900.0),
        ("k_sf_z", 2e6),
        ("c_sf_z", 1500.0),
        ("k_pwt_z", 3e5),
        ("c_pwt_z", 600.0),
        ("k_tire", 230e3),
        ("c_tire", 150.0),
        ("static_tire_load", 4300.0),
        ("static_tire_def", 0.019),
        ("k_wheel_x", 4e5),
        ("c_wheel_x", 900.0),
        ("k_wheel_x_other", 4e5),
        ("c_wheel_x_other", 900.0),
        ("k_sf_x", 2e6),
        ("c_sf_x", 1500.0),
        ("k_pwt_x", 3e5),
        ("c_pwt_x", 600.0),
        ("m_body", 2.0),
        ("c_body", 3.0),
        ("k_body", 50.0),
        ("f_offset", 0.0),
    ];
    known.iter().find(|(own, _)| *own == name).map(|(_, value)| *value)
}

/// A compiled model at given parameters: those of the effect first, then those of the car.
struct Running {
    evaluator: Evaluator,
    constants: Vec<f64>,
}

impl Running {
    fn new(model: &Checked, of_effect: &[(&str, f64)]) -> Running {
        let evaluator = Evaluator::new(&derive(model.clone()));
        let given = |name: &str| of_effect.iter().find(|(own, _)| *own == name).map(|(_, value)| *value);
        let value = |name: &str| {
            given(name)
                .or_else(|| value(name))
                .unwrap_or_else(|| panic!("no value of {name}"))
        };
        let p: Vec<f64> = evaluator
            .about()
            .parameters
            .iter()
            .map(|parameter| value(&parameter.name))
            .collect();
        let mut constants = vec![0.0; evaluator.about().constants];
        evaluator.prepare(&p, &mut constants);
        Running { evaluator, constants }
    }

    /// The rate of each state with the given values; what is not given is zero.
    fn rates(&self, state: &dyn Fn(&str) -> f64, rolling: bool) -> Vec<(String, f64)> {
        let about = self.evaluator.about();
        let x: Vec<f64> = about.states.iter().map(|own| state(&own.name)).collect();
        let u: Vec<f64> = about.inputs.iter().map(|own| state(&own.name)).collect();
        let mut dx = vec![0.0; x.len()];
        match rolling {
            false => self.evaluator.derivative(&self.constants, &x, &u, &mut dx),
            true => dx.fill(
                self.evaluator
                    .contact_force(&self.constants, &x, state("s"), state("v")),
            ),
        }
        about.states.iter().map(|own| own.name.to_string()).zip(dx).collect()
    }

    /// What each output answers to each excitation at some frequencies: real and imaginary parts.
    fn responses(&self) -> Vec<(String, Vec<f64>)> {
        let omega = [1.0, 6.0, 11.0, 17.0, 30.0].map(|hz| std::f64::consts::TAU * hz);
        let about = self.evaluator.about();
        let mut all = Vec::new();
        for (excitation, layout) in about.responses.iter().enumerate() {
            let mut re = vec![0.0; layout.outputs.len() * omega.len()];
            let mut im = re.clone();
            self.evaluator.response(
                excitation,
                &self.constants,
                &omega,
                ResponseMut {
                    re: &mut re,
                    im: &mut im,
                    jacobian: None,
                },
            );
            let parts = re.chunks(omega.len()).zip(im.chunks(omega.len()));
            for (output, (re, im)) in layout.outputs.iter().zip(parts) {
                let name = &about.outputs[usize::from(*output)].name;
                all.push((
                    format!("{name} over {}", about.excitations[excitation].name),
                    [re, im].concat(),
                ));
            }
        }
        all
    }

    fn rate(&self, of: &str, state: &dyn Fn(&str) -> f64) -> f64 {
        self.rates(state, false)
            .into_iter()
            .find(|(own, _)| own == of)
            .unwrap()
            .1
    }
}

/// Some motion, the same for every name that two models share. A part that an effect has split off moves with its
/// whole.
fn motion(name: &str) -> f64 {
    let whole = [
        ("z_belt", "z_wheel"),
        ("z_resonator", "z_wheel"),
        ("x_pwt", "x_body"),
        ("z_pwt", "z_body"),
    ];
    let (speed, place) = if let Some(rest) = name.strip_prefix('v') {
        (true, rest)
    } else {
        (false, name)
    };
    let place = whole
        .iter()
        .find(|(part, _)| *part == place)
        .map_or(place, |(_, whole)| whole);
    let moves = [
        "z_body", "z_wheel", "z_tm", "z_sf", "z_pad", "x_body", "x_wheel", "x_sf",
    ]
    .iter()
    .position(|own| *own == place);
    let Some(number) = moves else { return 0.0 };
    let number = number as f64 + if speed { 10.0 } else { 0.0 };
    (if speed { 0.3 } else { 0.01 }) * (1.0 + 1.7 * number).sin()
}

/// The values of an effect's parameters at which its strength leaves nothing of it; `None` where it has no strength.
fn vanished(patched: &Patched, nearly: bool) -> Option<Vec<(&str, f64)>> {
    vanishes_at(patched)?;
    let value = |own: &NewParameter| match own.role {
        ParameterRole::Strength { vanishes_at } if vanishes_at.is_infinite() => 1e8 * own.start,
        ParameterRole::Strength { vanishes_at: 0.0 } if nearly => 1e-6 * own.start,
        ParameterRole::Strength { vanishes_at } => vanishes_at,
        _ => beside(patched, own),
    };
    let new = patched.parameters.iter().filter(|own| own.is_new);
    Some(new.map(|own| (own.name.as_str(), value(own))).collect())
}

fn vanishes_at(patched: &Patched) -> Option<f64> {
    patched.parameters.iter().find_map(|own| match own.role {
        ParameterRole::Strength { vanishes_at } => Some(vanishes_at),
        _ => None,
    })
}

/// What another parameter is where nothing is left: one in the place of a coefficient of the model is what that is, at
/// the wheel, and one of a second part leaves nothing of that.
fn beside(patched: &Patched, own: &NewParameter) -> f64 {
    match (patched.effect.as_str(), own.effect_name.as_str()) {
        (_, "c0" | "c_rebound" | "c_compression") => 1900.0,
        ("sliding_friction", "c_slide") => 0.0,
        _ => own.start,
    }
}

/// Rates of the base model's states are the same, standing and rolling.
fn same_rates(what: &str, without: &Running, with: &Running) -> Result<(), String> {
    for rolling in [false, true] {
        let state = |name: &str| match (name, rolling) {
            ("s", _) => -0.025,
            ("v", _) => 0.4,
            _ => motion(name),
        };
        let after = with.rates(&state, rolling);
        for (own, rate) in without.rates(&state, rolling) {
            let found = after.iter().find(|(other, _)| *other == own).unwrap().1;
            let apart = (rate - found).abs();
            if apart.is_nan() || apart > 1e-6 * (1.0 + rate.abs()) {
                return Err(format!("{what}: the rate of {own} is {found}, not {rate}"));
            }
        }
    }
    Ok(())
}

/// Responses of the base model's outputs are the same, compared with the largest of their kind.
fn same_responses(what: &str, without: &Running, with: &Running) {
    for (own, response) in without.responses() {
        let after = with.responses();
        let found = &after.iter().find(|(other, _)| *other == own).unwrap().1;
        let largest = response.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
        for (value, found) in response.iter().zip(found) {
            let off = (value - found).abs();
            assert!(off <= 1e-4 * largest, "{what}: {own} answers by {found}, not {value}");
        }
    }
}

/// What is infinitely stiff or heavy takes the motion of its neighbour over time; so responses say whether it vanishes.
/// The force of a damper on a compliant end is a state, in a model without responses: a test of its own measures it.
#[test]
fn an_effect_vanishes_with_its_strength() {
    let mut vanishing = BTreeSet::new();
    for name in ["axle_a", "axle_c_rigid_tm", "axle_d"] {
        let base = model(name);
        let without = Running::new(&base, &[]);
        for patched in effects().iter().flat_map(|effect| effect.candidates(&base, &value)) {
            let what = format!("{} {:?} at {} of {name}", patched.effect, patched.form, patched.place);
            let Some(exactly) = vanished(&patched, false) else {
                continue;
            };
            vanishing.insert(patched.effect.clone());
            if patched.effect == "compliant_digressive_damper" {
                continue;
            }
            let with = Running::new(&patched.model, &exactly);
            if with.evaluator.about().linear && vanishes_at(&patched) == Some(f64::INFINITY) {
                same_responses(&what, &without, &with);
                continue;
            }
            let nearly = || Running::new(&patched.model, &vanished(&patched, true).unwrap());
            let same = same_rates(&what, &without, &with).or_else(|_| same_rates(&what, &without, &nearly()));
            same.unwrap_or_else(|difference| panic!("{difference}"));
        }
    }
    let all: BTreeSet<String> = effects()
        .iter()
        .map(|effect| effect.effect().name.text.clone())
        .collect();
    let without_strength: Vec<&String> = all.difference(&vanishing).collect();
    assert_eq!(
        without_strength,
        ["backlash", "offset_force", "spring_to_ground", "subframe", "unbalance"],
        "these vanish nowhere, or apply nowhere"
    );
}

/// Effect, model, place, and the parameters at which nothing is changed.
type Case = (&'static str, &'static str, &'static str, &'static [(&'static str, f64)]);

/// Where several parameters together leave nothing, or the axles have no place for an effect.
const NOTHING: [Case; 3] = [
    ("offset_force", "one_mass", "body", &[("f_unbalanced", 0.0)]),
    (
        "segmented_polynomial_damper",
        "axle_d",
        "damper",
        &[
            ("c_rebound", 1900.0),
            ("q_rebound", 0.0),
            ("c_compression", 1900.0),
            ("q_compression", 0.0),
            ("v_knee", 0.1),
            ("slope_beyond", 1.0),
            ("v_open", 0.1),
            ("exponent", 1.0),
        ],
    ),
    (
        "subframe_pitch",
        "axle_d",
        "subframe",
        &[
            ("inertia", 1.0),
            ("half_length", 0.3),
            ("front_share", 0.5),
            ("arm_offset", 0.0),
        ],
    ),
];

#[test]
fn an_effect_without_what_it_adds_changes_nothing() {
    for (effect, name, place, parameters) in &NOTHING {
        let base = model(name);
        let without = Running::new(&base, &[]);
        let forms = patch(effect).candidates(&base, &value).into_iter();
        for form in forms.filter(|form| form.place == *place) {
            let with = Running::new(&form.model, parameters);
            same_rates(effect, &without, &with).unwrap_or_else(|difference| panic!("{difference}"));
        }
    }
}

/// The slope of a force over something that moves, by central differences.
fn slope(force: impl Fn(f64) -> f64, at: f64) -> f64 {
    let step = 1e-6;
    (force(at + step) - force(at - step)) / (2.0 * step)
}

/// The force on the body of a model whose wheel is at a place and speed, while all else rests.
fn on_body(running: &Running, mass: f64, z: f64, v: f64) -> f64 {
    let state = |name: &str| match name {
        "z_wheel" => z,
        "vz_wheel" => v,
        _ => 0.0,
    };
    mass * running.rate("vz_body", &state)
}

/// Of axle_b_rigid_tm, where spring and damper act on the body through levers.
const BODY: f64 = 430.0 - 42.0 - 60.0;

#[test]
fn a_progressive_spring_has_its_rate_at_40_mm_of_wheel_travel() {
    let forms = [
        ("both_ways", 1.5),
        ("both_ways_evenly", 1.5),
        ("in_compression", 1.0),
        ("throughout", 0.5),
    ];
    for (form, in_rebound) in forms {
        let model = in_form(&model("axle_b_rigid_tm"), "progressive_spring", form, "spring");
        let running = Running::new(&model, &[("rate_increase_at_40mm", 0.5)]);
        // The wheel at 40 mm of compression, at rest, and at 40 mm of rebound.
        for (travel, expected) in [(0.04, 1.5), (0.0, 1.0), (-0.04, in_rebound)] {
            let rate = slope(|z| on_body(&running, BODY, z, 0.0), travel);
            assert!(
                (rate / (expected * 26e3) - 1.0).abs() < 1e-4,
                "{form} at {travel} m: {rate}"
            );
        }
    }
}

/// The rate is `k cosh(s / s0)`, and `s0` = 2 mm / sqrt(2 * 0.5) = 2 mm.
#[test]
fn an_exponential_bushing_has_a_rate_that_grows_with_the_hyperbolic_cosine() {
    let model = in_form(
        &model("axle_b_rigid_tm"),
        "bushing_saturation",
        "exponential",
        "wheel_bushing_x",
    );
    let running = Running::new(&model, &[("rate_increase_at_2mm", 0.5)]);
    let on_wheel = |x: f64| 42.0 * running.rate("vx_wheel", &|name| if name == "x_wheel" { x } else { 0.0 });
    for travel in [0.0, 1e-6, 0.002, -0.004] {
        let rate = -slope(on_wheel, travel);
        let expected = 4e5 * (travel / 0.002_f64).cosh();
        assert!(
            (rate / expected - 1.0).abs() < 1e-6,
            "at {travel} m: {rate}, not {expected}"
        );
    }
}

/// A free swing obeys `a = -2 zeta omega v`, with `omega = sqrt(k / m)`, at zero extension.
#[test]
fn a_resonator_has_the_damping_ratio_that_it_is_given() {
    let (mass, stiffness, ratio) = (4.0, 1e5, 0.3);
    let known = [
        ("m_resonator", mass),
        ("k_resonator", stiffness),
        ("zeta_resonator", ratio),
        ("s_resonator", 1e-3),
    ];
    for form in ["vertical", "hardening"] {
        let model = in_form(&model("axle_c"), "secondary_resonator", form, "wheel");
        let rate = Running::new(&model, &known).rate("vz_resonator", &|name| match name {
            "vz_resonator" => 0.01,
            _ => 0.0,
        });
        let expected = -2.0 * ratio * f64::sqrt(stiffness / mass) * 0.01;
        assert!((rate / expected - 1.0).abs() < 1e-9, "{form}: {rate}, not {expected}");
    }
}

/// The force is `k s (1 + (s / s0)^2)`: twice `k s0` at `s0`, and ten times at twice that travel.
#[test]
fn a_mass_on_rubber_feels_twice_the_force_at_the_travel_of_the_rubber() {
    let (mass, stiffness, s0) = (8.0, 2e5, 1.5e-3);
    let machine = "axle machine {
        \"Two masses on a shaker\"
        param m_body: kg = 2 in 0.1..10 \"Mass\";
        param k_body: N/m = 50 in 1..1e6 \"Stiffness\";
        direction z {
            motion shaker;
            mass low = 3 * m_body;
            mass part = m_body;
            link first: low - shaker { spring k_body; }
            link second: part - low { spring k_body; }
            output part.acceleration;
        }
    }";
    let source = Source {
        name: "machine.axle".into(),
        text: machine.into(),
    };
    let none = |_: &str, path: &str| Err(format!("no {path}"));
    let machine = check_text(source, &none).unwrap_or_else(|report| panic!("{report}"));
    let car = model("axle_c");
    let cases = [
        (
            &machine,
            ("secondary_resonator", "attached_hardening", "part"),
            ["m_resonator", "k_resonator", "zeta_resonator", "s_resonator"],
            "resonator",
        ),
        (
            &car,
            ("secondary_resonator", "hardening", "wheel"),
            ["m_resonator", "k_resonator", "zeta_resonator", "s_resonator"],
            "resonator",
        ),
        (
            &car,
            ("suspended_mass", "on_stiffening_mounts", "body"),
            ["m_pwt", "k_pwt_z", "c_pwt_z", "s_pwt"],
            "pwt",
        ),
    ];
    for (base, (effect, form, place), names, part) in cases {
        let model = in_form(base, effect, form, place);
        let values = [mass, stiffness, 0.0, s0];
        let known: Vec<(&str, f64)> = names.into_iter().zip(values).collect();
        let running = Running::new(&model, &known);
        let force = |z: f64| {
            -mass
                * running.rate(&format!("vz_{part}"), &|name| {
                    if name == format!("z_{part}") { z } else { 0.0 }
                })
        };
        for (travel, times) in [(1e-3 * s0, 1e-3), (s0, 2.0), (-s0, -2.0), (2.0 * s0, 10.0)] {
            let expected = times * stiffness * s0;
            assert!(
                (force(travel) / expected - 1.0).abs() < 2e-6,
                "{effect} {form} at {travel} m: {}, not {expected}",
                force(travel)
            );
        }
    }
}

#[test]
fn a_digressive_damper_begins_with_c0_and_tends_to_the_force_of_v0_at_the_wheel() {
    for (form, share_at_v0) in [("gradual", 0.5), ("blow_off", 1f64.tanh())] {
        let model = in_form(&model("axle_b_rigid_tm"), "digressive_damper", form, "damper");
        let running = Running::new(&model, &[("c0", 3000.0), ("v0", 0.5)]);
        for (speed, share) in [(1e-4, 2e-4), (0.5, share_at_v0), (5e3, 1.0)] {
            let force = on_body(&running, BODY, 0.0, speed);
            assert!(
                (force / (3000.0 * 0.5 * share) - 1.0).abs() < 1e-3,
                "{form} at {speed} m/s: {force}"
            );
        }
    }
}

#[test]
fn a_segmented_damper_has_a_slope_of_its_own_beyond_the_knee() {
    let model = in_form(
        &model("axle_b_rigid_tm"),
        "segmented_polynomial_damper",
        "slopes",
        "damper",
    );
    let of_effect = [
        ("c_rebound", 2000.0),
        ("c_compression", 1000.0),
        ("v_knee", 0.2),
        ("slope_beyond", 0.25),
    ];
    let running = Running::new(&model, &of_effect);
    // The wheel falls in rebound.
    for (speed, damping) in [(-0.1, 2000.0), (-0.5, 500.0), (0.1, 1000.0), (0.5, 250.0)] {
        let found = slope(|v| on_body(&running, BODY, 0.0, v), speed);
        assert!((found / damping - 1.0).abs() < 1e-6, "{found} at {speed} m/s");
    }
}

#[test]
fn a_damper_with_play_acts_beyond_the_play_alone() {
    let model = in_form(&model("axle_b_rigid_tm"), "free_play", "centred", "damper");
    let running = Running::new(&model, &[("gap", 4e-3)]);
    for (travel, damping) in [(-5e-3, 1900.0), (0.0, 0.0), (1e-3, 0.0), (5e-3, 1900.0)] {
        let found = slope(|v| on_body(&running, BODY, travel, v), 0.3);
        assert!((found - damping).abs() < 0.02 * 1900.0, "{found} at {travel} m");
    }
}

#[test]
fn lost_motion_moves_the_damper_at_the_wheel_s_speed_once_it_is_taken_up() {
    let model = in_form(&model("axle_b_rigid_tm"), "free_play", "lost_motion", "damper");
    let running = Running::new(&model, &[("gap", 4e-3), ("k_joint", 1e6)]);
    // The wheel rises: the damper lies behind by half of the play and by what the joint gives under c v, or within the
    // play.
    let speed = 0.4;
    for (behind, moves) in [(2e-3 + 1900.0 * speed / 1e6, 1.0), (1e-3, 0.0), (-1e-3, 0.0)] {
        for way in [-1.0, 1.0] {
            let state = |name: &str| match name {
                "vz_wheel" => way * speed,
                "z_damper_s_damper" => way * behind,
                _ => 0.0,
            };
            let follows = -way * running.rate("z_damper_s_damper", &state) / speed;
            assert!((follows - moves).abs() < 0.02, "{follows} with {behind} m behind");
            let force = way * BODY * running.rate("vz_body", &state) / (1900.0 * speed);
            assert!((force - moves).abs() < 0.02, "{force} with {behind} m behind");
        }
    }
}

#[test]
fn a_belt_that_moves_in_one_direction_leaves_the_road_s_push_along_the_other_to_the_wheel() {
    for (form, pushed) in [("in_plane", "vx_belt"), ("vertical", "vx_wheel")] {
        let belt = [("m_belt", 7.0), ("k_sidewall", 1e6), ("c_sidewall", 200.0)];
        let running = Running::new(&in_form(&model("axle_c"), "tire_belt", form, "tire"), &belt);
        let about = running.evaluator.about();
        let (x, u) = (vec![0.0; about.states.len()], vec![0.0; about.inputs.len()]);
        let contact = Contact {
            force: [0.0, 100.0],
            ..Contact::default()
        };
        let mut dx = x.clone();
        running
            .evaluator
            .rolling_derivative(&running.constants, &x, &u, &contact, &mut dx);
        let place = about.states.iter().position(|state| state.name == pushed).unwrap();
        let mass = if form == "vertical" { 42.0 } else { 7.0 };
        assert!((mass * dx[place] - 100.0).abs() < 1e-9, "{form}: {}", dx[place]);
    }
}

#[test]
fn dry_friction_reaches_its_level_at_the_wheel() {
    let model = patched(&model("axle_b_rigid_tm"), "coulomb_friction", "damper");
    let running = Running::new(&model, &[("f_coulomb", 80.0), ("k_presliding", 5e5)]);
    // Rebound: the wheel falls, the damper stretches, and the friction that has built up no longer grows.
    let state = |name: &str| match name {
        "vz_wheel" => -0.2,
        "z_damper_f_dry" => 80.0,
        _ => 0.0,
    };
    assert!(running.rate("z_damper_f_dry", &state).abs() < 1e-6);
    let force = BODY * running.rate("vz_body", &state);
    assert!((force - (-1900.0 * 0.2 - 80.0)).abs() < 1e-9 * force.abs(), "{force}");
}

#[test]
fn a_progressive_tyre_has_its_tangent_at_twice_the_static_deflection() {
    let model = patched(&model("axle_c"), "tire_progressive_stiffness", "tire");
    let running = Running::new(&model, &[("tangent_increase_at_twice_static", 0.4)]);
    let static_def = 0.019;
    // Standing, from the static deflection; the wheel moves down on a pad that rests.
    let on_wheel = |z: f64| {
        let state = |name: &str| if name == "z_wheel" { z } else { 0.0 };
        // All but the tyre is linear.
        -42.0 * running.rate("vz_wheel", &state) - 26e3 * z
    };
    for (z, tangent) in [(0.0, 230e3), (-static_def, 1.4 * 230e3)] {
        let found = slope(on_wheel, z);
        assert!((found / tangent - 1.0).abs() < 1e-6, "{found} at {z}");
    }
    // Rolling, the whole deflection: nothing at first contact, and the static load where it stood.
    let force = |s: f64| running.rates(&|name| if name == "s" { s } else { 0.0 }, true)[0].1;
    assert!(force(0.0).abs() < 1e-9);
    assert!(
        (force(-static_def).abs() - 4300.0).abs() < 1e-6,
        "{}",
        force(-static_def)
    );
}

#[test]
fn a_tyre_that_stiffens_beyond_its_static_deflection_is_as_it_was_below() {
    let axle = model("axle_c");
    let stiffer = in_form(&axle, "tire_progressive_stiffness", "rolling_beyond_static", "tire");
    let of = |increase: f64| Running::new(&stiffer, &[("tangent_increase_at_twice_static", increase)]);
    let (plain, stiffer) = (of(0.0), of(0.4));
    let force = |of: &Running, s: f64| of.rates(&|name| if name == "s" { s } else { 0.0 }, true)[0].1;
    let added = |deflection: f64| (force(&stiffer, -deflection) - force(&plain, -deflection)).abs();
    let static_def = 0.019;
    assert_eq!(added(0.5 * static_def), 0.0);
    let tangent = slope(added, 2.0 * static_def);
    assert!((tangent / (0.4 * 230e3) - 1.0).abs() < 1e-6, "{tangent}");
}

#[test]
fn a_rigid_body_over_two_axles_has_its_own_pitch_inertia() {
    let model = patched(&model("axle_c_rigid_tm"), "apparent_mass", "body");
    let index = 0.8;
    let parameters = [
        ("wheelbase", 2.7),
        ("dynamic_index", index),
        ("k_wheel_z_other", 3e4),
        ("c_wheel_z_other", 2e3),
    ];
    let running = Running::new(&model, &parameters);
    // A force on the front end alone, from a wheel that is held 10 mm high; mass matrix of heave and pitch by hand.
    let state = |name: &str| if name == "z_wheel" { 0.01 } else { 0.0 };
    let (front, rear) = (430.0 - 42.0, 840.0 - 430.0 - 40.0);
    let (total, force) = (front + rear, 26e3 * 0.01);
    let (a, b) = (2.7 * rear / total, 2.7 * front / total);
    let inertia = index * total * a * b;
    let (heave, pitch) = (force / total, force * a / inertia);
    let (front_wanted, rear_wanted) = (heave + a * pitch, heave - b * pitch);
    for (name, wanted) in [("vz_body", front_wanted), ("vz_body_other", rear_wanted)] {
        let found = running.rate(name, &state);
        assert!(
            (found - wanted).abs() < 1e-9 * front_wanted.abs(),
            "{name}: {found}, not {wanted}"
        );
    }
}

#[test]
fn friction_across_the_strut_leaves_the_top_mount_alone() {
    let base = model("axle_b");
    let strut = in_form(&base, "coulomb_friction", "across_strut", "damper");
    let running = Running::new(&strut, &[("f_coulomb", 100.0), ("k_presliding", 1e5)]);
    let slipping = |name: &str| match name {
        "z_friction_f_dry" => 100.0,
        _ => 0.0,
    };
    assert_eq!(running.rate("vz_tm", &slipping), 0.0);
    let on_wheel = 42.0 * running.rate("vz_wheel", &slipping);
    assert!((on_wheel - 100.0).abs() < 1e-9, "{on_wheel}");
    // Whatever the top mount does, the friction sees the travel of the wheel.
    let moving = |name: &str| match name {
        "vz_wheel" => -0.2,
        "vz_tm" => 0.7,
        _ => 0.0,
    };
    let rate = running.rate("z_friction_f_dry", &moving);
    assert!((rate - 1e5 * 0.2).abs() < 1e-9 * rate, "{rate}");
}

#[test]
fn friction_beside_all_levers_leaves_arms_and_top_mount_alone() {
    let beside = in_form(&model("axle_d"), "coulomb_friction", "between_wheel_and_body", "damper");
    let running = Running::new(&beside, &[("f_coulomb", 100.0), ("k_presliding", 1e5)]);
    let slipping = |name: &str| match name {
        "z_friction_f_dry" => 100.0,
        _ => 0.0,
    };
    let on_wheel = 42.0 * running.rate("vz_wheel", &slipping);
    assert!((on_wheel - 100.0).abs() < 1e-9, "{on_wheel}");
    for at_rest in ["vz_tm", "vz_sf"] {
        assert_eq!(running.rate(at_rest, &slipping), 0.0, "{at_rest}");
    }
}

/// Beside the strut it adds its inertance to wheel and body as they move against each other, whatever the top mount
/// does.
#[test]
fn an_inerter_between_wheel_and_body_leaves_the_top_mount_alone() {
    let base = model("axle_b");
    let plain = Running::new(&base, &[]);
    let beside = in_form(&base, "inerter", "between_wheel_and_body", "damper");
    let inertance = 20.0;
    let running = Running::new(&beside, &[("inertance", inertance)]);
    let rates = |of: &Running| ["vz_tm", "vz_body", "vz_wheel"].map(|name| of.rate(name, &motion));
    let ([tm, body, wheel], [tm_before, body_before, wheel_before]) = (rates(&running), rates(&plain));
    assert!((tm - tm_before).abs() < 1e-9 * tm.abs(), "{tm}, not {tm_before}");
    let force = inertance * (body - wheel);
    // The top mount's mass is none of the body's.
    for (mass, found, before, push) in [
        (42.0, wheel, wheel_before, force),
        (BODY - 3.0, body, body_before, -force),
    ] {
        assert!(
            (mass * (found - before) - push).abs() < 1e-9 * force.abs(),
            "{} N, not {push}",
            mass * (found - before)
        );
    }
}

/// Turned about, the sub-frame pitches the other way, and all else moves as it did.
#[test]
fn a_pitching_sub_frame_that_is_turned_about_moves_alike() {
    let pitching = patched(&model("axle_d"), "subframe_pitch", "subframe");
    let turned = |front_share, arm_offset| {
        let own = [
            ("inertia", 1.3),
            ("half_length", 0.3),
            ("front_share", front_share),
            ("arm_offset", arm_offset),
        ];
        Running::new(&pitching, &own)
    };
    let pitched = |way: f64| {
        move |name: &str| match name {
            "z_sf_pitch" => way * 0.02,
            "vz_sf_pitch" => way * 0.3,
            _ => motion(name),
        }
    };
    let (ahead, behind) = (turned(0.7, 0.1), turned(0.3, -0.1));
    let rates = ahead.rates(&pitched(1.0), false);
    let pitch = rates.iter().find(|(name, _)| name == "vz_sf_pitch").unwrap().1;
    assert!(pitch.abs() > 1.0, "{pitch}");
    for ((name, rate), (_, other)) in rates.iter().zip(behind.rates(&pitched(-1.0), false)) {
        let expected = if name.ends_with("sf_pitch") { -rate } else { *rate };
        assert!(
            (other - expected).abs() <= 1e-9 * rate.abs(),
            "{name}: {other}, not {expected}"
        );
    }
    let other_way = behind.rate("vz_sf_pitch", &pitched(1.0));
    assert!((other_way + pitch).abs() > 1e-3 * pitch.abs(), "it is not even");
}

#[test]
fn a_tyre_that_relaxes_while_rolling_stands_as_it_was() {
    let tyre = in_form(&model("axle_c"), "tire_dynamic_stiffness", "rolling", "tire");
    let running = Running::new(&tyre, &[("stiffness_ratio", 2.0), ("relaxation_frequency", 10.0)]);
    let relaxing = |name: &str| match name {
        "z_tire_f_relax" => 50.0,
        _ => 0.0,
    };
    assert_eq!(running.rate("vz_wheel", &relaxing), 0.0);
    assert_eq!(running.rates(&relaxing, true)[0].1, 50.0);
}

/// The inner states of a law at the damper of axle_b_rigid_tm after the wheel has moved at constant speeds (m/s), each
/// for a time (s): the classical Runge-Kutta method on what the compiled model says of their rates alone.
fn driven(running: &Running, legs: &[(f64, f64)]) -> Vec<(String, f64)> {
    let mut inner: Vec<(String, f64)> = running
        .rates(&|_| 0.0, false)
        .into_iter()
        .filter(|(name, _)| name.starts_with("z_damper_"))
        .map(|(name, _)| (name, 0.0))
        .collect();
    let mut travel = 0.0;
    for &(speed, time) in legs {
        let steps = 4000;
        let dt = time / f64::from(steps);
        let rates = |inner: &[(String, f64)], travel: f64| -> Vec<f64> {
            let state = |name: &str| match name {
                // Rebound stretches the damper.
                "z_wheel" => -travel,
                "vz_wheel" => -speed,
                _ => inner
                    .iter()
                    .find(|(own, _)| own == name)
                    .map_or(0.0, |(_, value)| *value),
            };
            let all = running.rates(&state, false);
            let of = |name: &str| all.iter().find(|(own, _)| own == name).unwrap().1;
            inner.iter().map(|(name, _)| of(name)).collect()
        };
        let moved = |inner: &[(String, f64)], rate: &[f64], h: f64| -> Vec<(String, f64)> {
            inner
                .iter()
                .zip(rate)
                .map(|((name, x), r)| (name.clone(), x + h * r))
                .collect()
        };
        for _ in 0..steps {
            let a = rates(&inner, travel);
            let b = rates(&moved(&inner, &a, dt / 2.0), travel + speed * dt / 2.0);
            let c = rates(&moved(&inner, &b, dt / 2.0), travel + speed * dt / 2.0);
            let d = rates(&moved(&inner, &c, dt), travel + speed * dt);
            let mean: Vec<f64> = (0..a.len())
                .map(|k| (a[k] + 2.0 * b[k] + 2.0 * c[k] + d[k]) / 6.0)
                .collect();
            inner = moved(&inner, &mean, dt);
            travel += speed * dt;
        }
    }
    inner
}

/// The resisting force at the wheel of a law that has these inner states, all else at rest.
fn of_states(running: &Running, inner: &[(String, f64)]) -> f64 {
    let state = |name: &str| {
        inner
            .iter()
            .find(|(own, _)| own == name)
            .map_or(0.0, |(_, value)| *value)
    };
    -BODY * running.rate("vz_body", &state)
}

/// Virgin loading of a rounded Jenkins element is F tanh(k x / F), its unloading straight down to no force.
#[test]
fn an_elasto_slip_stack_loads_as_its_elements_do_and_unloads_along_its_stiffness() {
    let model = in_form(&model("axle_b_rigid_tm"), "elasto_slip_friction", "stack", "damper");
    let (f_slip, k, spread) = (900.0, 6e5, 0.9);
    let running = Running::new(&model, &[("f_slip", f_slip), ("k_stick", k), ("spread", spread)]);
    let elements = [1.0 - 2.0 / 3.0 * spread, 1.0, 1.0 + 2.0 / 3.0 * spread].map(|level| level * f_slip / 3.0);
    let (there, back) = (2e-3, 0.2e-3);
    let loaded = elements.map(|level| level * (k / 3.0 * there / level).tanh());
    let found = of_states(&running, &driven(&running, &[(0.1, there / 0.1)]));
    let wanted: f64 = loaded.iter().sum();
    assert!((found / wanted - 1.0).abs() < 1e-6, "{found}, not {wanted}");
    // The weakest element is past zero by then and loads the other way.
    let unloaded = elements.iter().zip(loaded).map(|(level, from)| {
        let left = from - k / 3.0 * back;
        if left > 0.0 {
            left
        } else {
            level * (left / level).tanh()
        }
    });
    let wanted: f64 = unloaded.sum();
    let found = of_states(&running, &driven(&running, &[(0.1, there / 0.1), (-0.1, back / 0.1)]));
    assert!((found / wanted - 1.0).abs() < 1e-5, "{found}, not {wanted}");
}

/// Each third of a mount's friction slips at its own level, and sticks again when the motion reverses.
#[test]
fn friction_in_a_mount_slips_at_its_levels_and_sticks_after_a_reversal() {
    let model = patched(&model("axle_a"), "bushing_friction", "powertrain_mount");
    let (f_slip, k, spread) = (90.0, 2e5, 0.6);
    let running = Running::new(
        &model,
        &[("f_rubber", f_slip), ("k_rubber", k), ("rubber_spread", spread)],
    );
    let levels = [0.6, 1.0, 1.4].map(|level| level * f_slip / 3.0);
    let rates = |loaded: f64, speed: f64| {
        let state = |name: &str| match name {
            "z_powertrain_mount_f_1" => loaded * levels[0],
            "z_powertrain_mount_f_2" => loaded * levels[1],
            "z_powertrain_mount_f_3" => loaded * levels[2],
            "vz_pwt" => speed,
            _ => 0.0,
        };
        let all = running.rates(&state, false);
        let of = |wanted: &str| all.iter().find(|(name, _)| name == wanted).expect("it is a state").1;
        let elements = [1, 2, 3].map(|k| of(&format!("z_powertrain_mount_f_{k}")));
        (elements, of("vz_pwt"))
    };
    let near = |found: [f64; 3], wanted: f64| found.iter().all(|own| (own - wanted).abs() < 1e-9 * k);
    let (slips, sticks, starts) = (rates(1.0, 0.1), rates(1.0, -0.1), rates(0.0, 0.1));
    assert!(near(slips.0, 0.0), "{slips:?}");
    assert!(near(sticks.0, -0.1 * k / 3.0), "{sticks:?}");
    assert!(near(starts.0, 0.1 * k / 3.0), "{starts:?}");
    let holds = rates(1.0, 0.0).1 * 60.0;
    assert!((holds + f_slip).abs() < 1e-9 * f_slip, "{holds} N on the powertrain");
}

#[test]
fn backlash_holds_nothing_for_its_gap_after_each_turn() {
    let model = in_form(
        &model("axle_b_rigid_tm"),
        "elasto_slip_friction",
        "with_backlash",
        "damper",
    );
    let (f_slip, k, gap) = (900.0, 6e6, 4e-3);
    let running = Running::new(
        &model,
        &[("f_slip", f_slip), ("k_stick", k), ("spread", 0.0), ("gap", gap)],
    );
    // So fast that the creep in the gap is nothing.
    let after = |legs: &[f64]| {
        let legs: Vec<(f64, f64)> = legs.iter().map(|&s| (s.signum() * 10.0, s.abs() / 10.0)).collect();
        of_states(&running, &driven(&running, &legs))
    };
    let wanted = f_slip * (k * 1e-4 / f_slip).tanh();
    let found = after(&[gap / 2.0 + 1e-4]);
    assert!((found / wanted - 1.0).abs() < 1e-3, "{found}, not {wanted}");
    let elastic = f_slip / k;
    assert!(after(&[8e-3, -elastic - 0.5 * gap]).abs() < 1e-3 * f_slip);
    let other_way = after(&[8e-3, -elastic - gap - 1e-3]);
    assert!((other_way / f_slip + 1.0).abs() < 1e-2, "{other_way}");
}

/// A spring in series with c0 v/(1 + v/v0): at constant speed the valves' force, for small forces Maxwell's element.
#[test]
fn a_compliant_digressive_damper_is_its_valves_when_slow_and_its_spring_when_fast() {
    let model = patched(&model("axle_b_rigid_tm"), "compliant_digressive_damper", "damper");
    let (c0, v0, k) = (3000.0, 0.5, 4e5);
    let running = Running::new(&model, &[("c0", c0), ("v0", v0), ("k_series", k)]);
    for speed in [0.05, 0.5, 2.0] {
        let wanted = c0 * speed / (1.0 + speed / v0);
        let found = of_states(&running, &driven(&running, &[(speed, 0.5)]));
        assert!((found / wanted - 1.0).abs() < 1e-6, "{found} at {speed} m/s");
    }
    let (speed, time) = (1e-4, 5e-3);
    let wanted = c0 * speed * (1.0 - (-k / c0 * time).exp());
    let found = of_states(&running, &driven(&running, &[(speed, time)]));
    assert!((found / wanted - 1.0).abs() < 1e-3, "{found}, not {wanted}");
}

/// The same with two slopes: beyond the knee, the force grows by the second one with the speed.
#[test]
fn a_compliant_damper_with_two_slopes_is_its_valves_when_slow_and_its_spring_when_fast() {
    let model = in_form(
        &model("axle_b_rigid_tm"),
        "compliant_digressive_damper",
        "slopes",
        "damper",
    );
    let (rebound, compression, knee, beyond, k) = (3000.0, 2000.0, 0.3, 0.25, 4e5);
    let values = [
        ("c_rebound", rebound),
        ("c_compression", compression),
        ("v_knee", knee),
        ("slope_beyond", beyond),
        ("k_series", k),
    ];
    let running = Running::new(&model, &values);
    for speed in [-1.2, -0.2, 0.05, 0.3, 1.2_f64] {
        let c = if speed > 0.0 { rebound } else { compression };
        let past = (speed.abs() - knee).max(0.0);
        let wanted = c * speed.signum() * (speed.abs() - (1.0 - beyond) * past);
        let found = of_states(&running, &driven(&running, &[(speed, 0.5)]));
        assert!(
            (found / wanted - 1.0).abs() < 1e-6,
            "{found} at {speed} m/s, not {wanted}"
        );
    }
    let (speed, time) = (1e-4, 5e-3);
    let wanted = rebound * speed * (1.0 - (-k / rebound * time).exp());
    let found = of_states(&running, &driven(&running, &[(speed, time)]));
    assert!((found / wanted - 1.0).abs() < 1e-6, "{found}, not {wanted}");
}

#[test]
fn a_part_that_slides_is_held_by_friction_and_by_drag() {
    let model = patched(&model("axle_c"), "sliding_friction", "wheel");
    let running = Running::new(&model, &[("f_slide", 30.0), ("c_slide", 70.0), ("k_stick", 1e5)]);
    let without = Running::new(&model, &[("f_slide", 30.0), ("c_slide", 0.0), ("k_stick", 1e5)]);
    let sliding = |force: f64| {
        move |name: &str| match name {
            "vz_wheel" => 0.4,
            "z_sliding_f_dry" => force,
            _ => 0.0,
        }
    };
    assert!(running.rate("z_sliding_f_dry", &sliding(30.0)).abs() < 1e-6);
    let on_wheel = 42.0 * (running.rate("vz_wheel", &sliding(30.0)) - without.rate("vz_wheel", &sliding(0.0)));
    assert!((on_wheel + 30.0 + 70.0 * 0.4).abs() < 1e-9, "{on_wheel}");
}

#[test]
fn an_offset_force_pushes_along_the_direction() {
    let model = patched(&model("one_mass"), "offset_force", "body");
    let running = Running::new(&model, &[("f_unbalanced", 6.0)]);
    assert!((running.rate("vz_body", &|_| 0.0) - 3.0).abs() < 1e-12);
}

/// Tread and sidewalls in series, loaded slowly, are the tyre that was measured: on the rig its stiffness, rolling its
/// load at the static deflection, and the slope there.
#[test]
fn a_belt_leaves_the_static_curve_of_the_tyre() {
    let base = model("axle_c");
    let whole = Running::new(&base, &[]);
    let sidewalls = 9e5;
    let own = [("m_belt", 7.0), ("k_sidewall", sidewalls), ("c_sidewall", 200.0)];
    for form in ["in_plane", "vertical"] {
        let tread = Running::new(&in_form(&base, "tire_belt", form, "tire"), &own);
        let force = |of: &Running, s: f64| of.rates(&|name| if name == "s" { s } else { 0.0 }, true)[0].1;
        // The deflection of the tread under the static load, by bisection.
        let (mut low, mut high) = (0.0, 0.019);
        for _ in 0..60 {
            let middle = (low + high) / 2.0;
            if -force(&tread, -middle) > 4300.0 {
                high = middle
            } else {
                low = middle
            }
        }
        let deflection = low + 4300.0 / sidewalls;
        assert!((deflection - 0.019).abs() < 1e-9, "{form}: {deflection}");
        let in_series = 1.0 / (1.0 / slope(|s| force(&tread, s), -low) + 1.0 / sidewalls);
        let wanted = slope(|s| force(&whole, s), -0.019);
        assert!(
            (in_series / wanted - 1.0).abs() < 1e-6,
            "{form}: {in_series}, not {wanted}"
        );
        let on_belt = |z: f64| 7.0 * tread.rate("vz_belt", &|name| if name == "z_pad" { z } else { 0.0 });
        let standing = slope(on_belt, 0.0);
        let in_series = 1.0 / (1.0 / standing + 1.0 / sidewalls);
        assert!((in_series / 230e3 - 1.0).abs() < 1e-6, "{form}: {in_series}");
    }
}

/// Two parts on a shaft or spring, to ground by a bearing or guide. `{kg}` and others are units.
const TWO_PARTS: &str = "axle two_parts {
    known param m_1: {kg} = 10 in 1..100; known param m_2: {kg} = 30 in 1..100;
    param k: {N/m} = 2e4 in 100..1e6; param c: {N s/m} = 100 in 1..1e4; param c_b: {N s/m} = 20 in 1..1e4;
    direction z {
        {mass} one = m_1; {mass} two = m_2;
        force push on one;
        link shaft: two - one { spring k; damper c; }
        link bearing: two { damper c_b; }
        output one.acceleration; output two.acceleration;
    }
}";

fn two_parts(units: [(&str, &str); 4]) -> Checked {
    let text = units.iter().fold(TWO_PARTS.to_string(), |text, (key, unit)| {
        text.replace(&format!("{{{key}}}"), unit)
    });
    let name = "two_parts.axle".to_string();
    check_text(Source { name, text }, &|_, path| Err(format!("no {path}"))).unwrap_or_else(|report| panic!("{report}"))
}

/// A part that turns obeys the laws of one that moves, in other units: every effect has the same places, forms,
/// parameters and equations.
#[test]
fn effects_on_angles_are_those_on_lengths() {
    let moves = two_parts([("kg", "kg"), ("N/m", "N/m"), ("N s/m", "N s/m"), ("mass", "mass")]);
    let turns = two_parts([
        ("kg", "kg m^2"),
        ("N/m", "N m/rad"),
        ("N s/m", "N m s/rad"),
        ("mass", "inertia"),
    ]);
    let laws = std::fs::read_dir(models().join("laws")).unwrap();
    let laws = laws.map(|entry| Patch::read(read(&entry.unwrap().path())).unwrap());
    let mut places = BTreeSet::new();
    // The weight of an unbalance is a sine of the angle itself.
    let of_both = effects()
        .into_iter()
        .filter(|own| own.effect().name.text != "unbalance");
    for patch in of_both.chain(laws) {
        let [moving, turning] = [&moves, &turns].map(|model| patch.candidates(model, &|_| None));
        let labels = |all: &[Patched]| -> Vec<_> {
            let label = |own: &Patched| (own.effect.clone(), own.place.clone(), own.form.clone());
            all.iter().map(label).collect()
        };
        assert_eq!(labels(&moving), labels(&turning));
        for (moving, turning) in moving.iter().zip(&turning) {
            places.insert((moving.effect.clone(), moving.place.clone()));
            let (name, of) = (&moving.model.name, |own: &NewParameter| {
                (own.name.clone(), own.start, own.range)
            });
            let [own, other] = [moving, turning].map(|own| own.parameters.iter().map(of).collect::<Vec<_>>());
            assert_eq!(own, other, "{name}");
            assert_eq!(rates_at_starts(moving), rates_at_starts(turning), "{name}");
        }
    }
    for (effect, place) in [
        ("coulomb_friction", "bearing"),
        ("progressive_spring", "shaft"),
        ("suspended_mass", "two"),
        ("spring_to_ground", "one"),
        ("elastic_law", "shaft"),
        ("drag_law", "one"),
    ] {
        assert!(
            places.contains(&(effect.into(), place.into())),
            "{effect} at {place}: {places:?}"
        );
    }
}

/// The rates of a patched model at the starts of its parameters, in a motion that its names give.
fn rates_at_starts(of: &Patched) -> Vec<(String, f64)> {
    let starts = of.model.parameters.iter().map(|own| {
        let new = of.parameters.iter().find(|new| new.name == own.name);
        let default = match own.default {
            qcar_dsl::model::Default::Value(value) => Some(value),
            _ => None,
        };
        let start = new.map(|new| new.start).or(default);
        (
            own.name.as_str(),
            start.unwrap_or_else(|| panic!("no value of {}", own.name)),
        )
    });
    let letters = |name: &str| name.bytes().map(u32::from).sum::<u32>();
    let moving = |name: &str| 0.01 * (f64::from(letters(name) % 13) - 6.0);
    Running::new(&of.model, &starts.collect::<Vec<_>>()).rates(&moving, false)
}
