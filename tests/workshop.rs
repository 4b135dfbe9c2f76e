//! What a discovery is given to choose from.

use std::collections::BTreeMap;
use std::fs;
use std::sync::Arc;

use qcar::catalogue::compiled;
use qcar::effects;
use qcar::workshop::Bench;
use qcar_dsl::check::Checked;
use qcar_dsl::source::Source;
use qcar_runtime::campaign::{Campaign, Role};
use qcar_runtime::discover::candidate::Workshop;
use qcar_runtime::discover::observe::predict;
use qcar_runtime::discover::{Evidence, Free};
use qcar_runtime::response::parameters::Values;

fn candidates(model: Checked, effect: &str) -> Vec<(String, Option<String>)> {
    let mut catalogue = effects::catalogue().map_err(|_| "the catalogue reads").unwrap();
    // Forms are compared with those of the same effect only, so the others need not be compiled.
    catalogue.effects.retain(|own| own.effect().name.text == effect);
    let bench = Bench::new(model, Arc::new(catalogue), Arc::new(BTreeMap::new()));
    let all = bench.candidates().into_iter();
    let own = all.filter(|candidate| candidate.effect == effect);
    own.map(|candidate| (candidate.at, candidate.form)).collect()
}

fn forms(model: &str, effect: &str) -> Vec<String> {
    let model = compiled(model).map_err(|_| "the model compiles").unwrap().model;
    let all = candidates(model, effect).into_iter();
    all.filter_map(|(_, form)| form).collect()
}

/// Past a strut on the upright, friction is friction between wheel and body: the same is not tried twice.
#[test]
fn forms_that_come_to_the_same_are_tried_once() {
    let (inside, across, beside) = ("in_damper", "across_strut", "between_wheel_and_body");
    let of = |forms: &[&str]| -> Vec<String> {
        let smooth = forms.iter().map(|form| format!("smooth_{form}"));
        let all = forms.iter().map(|form| form.to_string()).chain(smooth);
        all.chain(["gradual_in_damper".into()]).collect()
    };
    assert_eq!(forms("axle_c", "coulomb_friction"), of(&[inside, across]));
    assert_eq!(forms("axle_d", "coulomb_friction"), of(&[inside, across, beside]));
}

/// On a post without a road, the tyre is a link like any other. Friction between wheel and body is that of the damper,
/// and must not be named at the tyre.
#[test]
fn a_form_that_is_equivalent_at_another_place_is_not_tried() {
    let text = "
axle on_a_post {
    known param m: kg = 300; param m_wheel: kg = 40 in 5..200; param k: N/m = 2e4 in 1e3..2e5;
    param c: N s/m = 1500 in 100..2e4; param k_tire: N/m = 2e5 in 2e4..1e6; param c_tire: N s/m = 100 in 1..5e3;
    direction z {
        motion post;
        mass wheel = m_wheel;
        mass body = m;
        link tire: wheel - post { spring k_tire; damper c_tire; }
        link spring: body - wheel { spring k; }
        link damper: body - wheel { damper c; }
        output wheel.acceleration;
        output body.acceleration;
    }
}";
    let source = Source {
        name: "on_a_post.axle".into(),
        text: text.into(),
    };
    let model = qcar_dsl::compile::check(source, &|_, _| Err("one file".into())).unwrap();
    let expected = [
        ("tire", "in_damper"),
        ("tire", "across_strut"),
        ("tire", "smooth_in_damper"),
        ("tire", "smooth_across_strut"),
        ("tire", "gradual_in_damper"),
        ("damper", "in_damper"),
        ("damper", "smooth_in_damper"),
        ("damper", "gradual_in_damper"),
    ];
    let expected = expected.map(|(at, form)| (at.to_string(), Some(form.to_string())));
    assert_eq!(candidates(model, "coulomb_friction"), expected);
}

/// A stop in rebound does nothing where one in compression acts: they are never the same, whatever else is in the model.
#[test]
fn stops_of_either_side_are_both_tried() {
    for model in ["one_mass", "quarter_car", "axle_a", "axle_b", "axle_c", "axle_d"] {
        let all = forms(model, "bump_stop");
        for form in [
            "in_compression",
            "progressive_in_compression",
            "in_rebound",
            "both_ways",
        ] {
            assert!(all.iter().any(|own| own == form), "{model}: {all:?}");
        }
    }
}

/// On a rig that gives the motion of the rod, a model has no states: its laws show in the measured force alone.
#[test]
fn the_laws_of_a_damper_on_a_rig_are_all_tried() {
    for (effect, expected) in [
        ("segmented_polynomial_damper", vec!["parabolas", "slopes", "powers"]),
        ("digressive_damper", vec!["gradual", "blow_off", "two_slopes"]),
        (
            "bump_stop",
            vec![
                "in_compression",
                "progressive_in_compression",
                "exponential_in_compression",
                "in_rebound",
                "progressive_in_rebound",
                "both_ways",
            ],
        ),
    ] {
        assert_eq!(forms("linear_damper", effect), expected);
    }
}

/// A damper whose seals slip within a stroke, beside a parameter that is tied to another.
const SEALED: &str = "
axle sealed {
    param c: N s/m = 3000 in 100..9000;
    param c_same: N s/m = c;
    param v_0: m/s = 0.2 in 0.02..3;
    param f_seal: N = 90 in 5..300;
    param k_seal: N/m = 9 N/mm in 1 N/mm..200 N/mm;
    direction z {
        motion wheel;
        mass body = 390 kg;
        link spring: body - wheel { spring 25 N/mm; }
        link damper: body - wheel {
            force = (0.7*c + 0.3*c_same)*v/(1 + abs(v)/v_0);
            state f: N;
            rate f = k_seal*v - k_seal*abs(v)*f/f_seal;
            force = f;
        }
        output body.acceleration;
    }
}";

/// The sensitivity of a force through its states is the limit of differences of the force, to 1e-6 of it.
#[test]
fn slopes_of_a_link_alone_are_limits_of_differences() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("sealed.axle"), SEALED).unwrap();
    fs::write(
        folder.path().join("damper.csv"),
        "velocity,force\n0.05,90\n-0.05,-90\n0.3,300\n-0.3,-300\n1.05,700\n",
    )
    .unwrap();
    let text = "format = 1\nname = \"bench\"\nmodel = \"./sealed.axle\"\n\n[[run]]\nkind = \"dynamometer\"\nfile = \"damper.csv\"\n\
                role = \"fit\"\nlink = \"damper\"\namplitude = 0.008\nuncertainty = 1\n";
    fs::write(folder.path().join("campaign.toml"), text).unwrap();
    let campaign = Campaign::open(folder.path()).unwrap();
    let bench = Bench::of_campaign(&campaign, None)
        .map_err(|_| "the model compiles")
        .unwrap();
    let (model, about) = (bench.model(), bench.model().about());
    let evidence = Evidence::from_campaign(&campaign, about).unwrap();
    let values = Values::resolve(about, &BTreeMap::new(), &BTreeMap::new()).unwrap();
    let free: Vec<Free> = ["c", "v_0", "f_seal", "k_seal"]
        .map(|name| Free {
            parameter: about.parameters.iter().position(|own| own.name == name).unwrap(),
            lower: 0.0,
            upper: f64::INFINITY,
        })
        .to_vec();
    let forces = |values: &Values, free: &[Free]| predict(model, values, free, &evidence, Role::Fit).unwrap().remove(0);
    let own = forces(&values, &free);
    for (slopes, free) in own.slopes.iter().zip(&free) {
        let size = values.as_slice()[free.parameter];
        let moved = |part: f64| {
            let mut moved = values.clone();
            moved.set(free.parameter, size * (1.0 + part));
            forces(&moved, &[]).value
        };
        let (up, down) = (moved(1e-3), moved(-1e-3));
        for (k, slope) in slopes.iter().enumerate() {
            let difference = (up[k].re - down[k].re) / 2e-3;
            let scale = own.value[k].re.abs();
            // The third derivative adds a part of 1e-6.
            assert!(
                (slope.re * size - difference).abs() < 1e-6 * scale,
                "{k}: {} and {difference}",
                slope.re * size
            );
        }
    }
}

/// The model declares its constant force as known, and offers one as an effect. A campaign that fits the declared one
/// would find both in every combination.
#[test]
fn a_constant_force_that_is_fitted_is_no_effect() {
    let offers = |fit: bool| {
        let folder = tempfile::tempdir().unwrap();
        let parameter = |name: &str, unit: &str, fit: bool| {
            format!("[parameters.{name}]\nvalue = 1.0\nunit = \"{unit}\"\nrange = [0.1, 10.0]\nfit = {fit}\n")
        };
        let parameters = [("m_body", "kg"), ("c_body", "N s/m"), ("k_body", "N/m")];
        let mut text = "format = 1\nname = \"mass\"\nmodel = \"one_mass\"\n".to_owned();
        text.extend(parameters.map(|(name, unit)| parameter(name, unit, true)));
        text += &parameter("f_offset", "N", fit);
        text += "[[channel]]\nname = \"body\"\nlocation = \"body\"\nside = \"centre\"\naxis = \"z\"\n\
                 quantity = \"displacement\"\nunit = \"m\"\n[[run]]\nkind = \"time_history\"\nfile = \"run.csv\"\n\
                 role = \"fit\"\nsample_rate = 10.0\nband_limited = true\n";
        fs::write(folder.path().join("run.csv"), "time,body\n0,0\n0.1,1\n").unwrap();
        fs::write(folder.path().join("campaign.toml"), text).unwrap();
        let campaign = Campaign::open(folder.path()).unwrap();
        let bench = Bench::of_campaign(&campaign, None)
            .map_err(|_| "the model compiles")
            .unwrap();
        bench.candidates().iter().any(|own| own.effect == "offset_force")
    };
    assert!(offers(false));
    assert!(!offers(true));
}
