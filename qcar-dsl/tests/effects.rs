//! Every effect that is shipped reads, prints as itself, and compiles at each of its places in each model.

use std::path::{Path, PathBuf};
use std::sync::LazyLock;
use std::thread;

use qcar_dsl::check::Checked;
use qcar_dsl::compile::check;
use qcar_dsl::parse::parse_text;
use qcar_dsl::patch::{Ordinate, ParameterRole, Patch, Patched};
use qcar_dsl::source::Source;

fn models() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../models")
}

fn files(folder: &str) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(models().join(folder)).unwrap();
    let mut files: Vec<_> = entries.map(|entry| entry.unwrap().path()).collect();
    files.sort();
    files
}

fn read(path: &Path) -> Source {
    Source {
        name: path.display().to_string(),
        text: std::fs::read_to_string(path).unwrap(),
    }
}

fn load(from: &str, path: &str) -> Result<Source, String> {
    Ok(read(&Path::new(from).parent().unwrap().join(path)))
}

fn checked(file: &Path) -> Checked {
    check(read(file), &load).unwrap_or_else(|report| panic!("{report}"))
}

fn model(name: &str) -> Checked {
    checked(&models().join(format!("axles/{name}.axle")))
}

fn effect(name: &str) -> Patch {
    let source = read(&models().join(format!("effects/{name}.axle")));
    Patch::read(source).unwrap_or_else(|report| panic!("{report}"))
}

fn patched(patch: &Patch, model: &Checked, place: &str) -> Patched {
    patch
        .apply(model, place, &|_| None)
        .unwrap_or_else(|report| panic!("{}\n{report}", report.sources[0].text))
}

fn effects() -> Vec<Patch> {
    in_folder("effects")
}

fn in_folder(folder: &str) -> Vec<Patch> {
    let read = |file: &PathBuf| Patch::read(read(file)).unwrap_or_else(|report| panic!("{report}"));
    files(folder).iter().map(read).collect()
}

fn law(name: &str) -> Patch {
    let named = |law: &Patch| law.effect().name.text == name;
    in_folder("laws").into_iter().find(named).expect("it is shipped")
}

#[test]
fn every_effect_prints_as_the_same_tree() {
    for file in files("effects").into_iter().chain(files("laws")) {
        let first = parse_text(&read(&file), 0);
        assert!(first.mistakes.is_empty(), "{}", file.display());
        let printed = Source {
            name: "printed".into(),
            text: first.file.to_string(),
        };
        let second = parse_text(&printed, 0);
        assert!(
            second.mistakes.is_empty() && first.file == second.file,
            "{}",
            printed.text
        );
        assert_eq!(second.file.to_string(), printed.text);
    }
}

/// A model with an effect in one of its forms.
struct Candidate {
    effect: String,
    form: Option<String>,
    place: String,
    warnings: String,
}

fn candidates(effects: Vec<Patch>, model: &Checked) -> Vec<Candidate> {
    let candidate = |patched: Patched| Candidate {
        effect: patched.effect,
        form: patched.form,
        place: patched.place,
        warnings: if patched.model.warnings().diagnostics.is_empty() {
            String::new()
        } else {
            patched.model.warnings().to_string()
        },
    };
    let all = effects
        .into_iter()
        .flat_map(|effect| effect.candidates(model, &|_| None));
    all.map(candidate).collect()
}

/// Those of each shipped model by its name: several tests look at them, and they take seconds.
static OF_EFFECTS: LazyLock<Vec<(String, Vec<Candidate>)>> = LazyLock::new(|| {
    let of = |file: PathBuf| {
        let model = checked(&file);
        (model.name.clone(), candidates(effects(), &model))
    };
    // One thread for each model: on one alone this outlasts all tests together.
    thread::scope(|scope| {
        let running: Vec<_> = files("axles")
            .into_iter()
            .map(|file| scope.spawn(move || of(file)))
            .collect();
        running.into_iter().map(|own| own.join().unwrap()).collect()
    })
});

#[test]
fn every_effect_compiles_wherever_it_applies() {
    let of_laws = files("axles").into_iter().map(|file| {
        let model = checked(&file);
        (model.name.clone(), candidates(in_folder("laws"), &model))
    });
    let of_laws: Vec<_> = of_laws.collect();
    for (model, candidates) in OF_EFFECTS.iter().chain(&of_laws) {
        for own in candidates {
            assert!(
                own.warnings.is_empty(),
                "{} at {} of {model}\n{}",
                own.effect,
                own.place,
                own.warnings
            );
        }
    }
}

#[test]
fn a_patched_model_is_a_file_that_reads_well() {
    let patched = patched(&effect("suspended_mass"), &model("axle_c"), "body");
    insta::assert_snapshot!(patched.text("Evidence: none yet."));
}

#[test]
fn laws_apply_at_whatever_has_such_a_term() {
    let model = model("axle_c");
    let places = |name: &str| law(name).places(&model);
    assert_eq!(places("damping_law"), ["damper", "top_mount", "wheel_bushing_x"]);
    assert_eq!(places("elastic_law"), ["spring", "top_mount", "wheel_bushing_x"]);
    assert_eq!(
        places("relaxation_law"),
        ["tire", "spring", "top_mount", "wheel_bushing_x"]
    );
    assert_eq!(places("tire_law"), ["tire"]);
    assert_eq!(places("time_law"), ["damper"]);
    assert_eq!(places("ground_law"), [""; 0]);
    assert_eq!(law("ground_law").places(&self::model("one_mass")), ["body"]);
}

/// At one moment only a combination of its coefficients is seen: time has to go on for all of them.
#[test]
fn a_law_over_time_is_seen_as_time_goes_on() {
    for name in ["time_law", "run_law"] {
        let law = law(name);
        let patched = patched(&law, &model("axle_a"), "damper");
        assert!(patched.model.unseen().is_empty(), "{name}");
        let clock = &patched.parameters[0];
        assert_eq!((clock.role, clock.known), (ParameterRole::Clock, true), "{name}");
        let text = patched.text("");
        assert!(text.contains(&format!("    clock param {}: ", clock.name)), "{text}");
        let without = text.replacen("clock param", "known param", 1);
        let still = Source {
            name: "still.axle".into(),
            text: without,
        };
        let still = check(still, &load).unwrap_or_else(|report| panic!("{report}"));
        assert_eq!(still.unseen().len(), 1, "{name}");
    }
}

/// The points of a curve are numbers, parameters, or products of these; what it is over may be a part of a parameter.
#[test]
fn curves_are_read_from_the_tables_of_a_law() {
    let curves = law("damping_law").curves();
    assert_eq!(curves.len(), 1);
    assert_eq!(
        (curves[0].over.as_str(), curves[0].scale.as_deref()),
        ("v", Some("v_ref"))
    );
    let product = |names: &[&str]| Ordinate::Product(names.iter().map(|name| name.to_string()).collect());
    let points = &curves[0].points;
    assert!(points.contains(&(0.0, Ordinate::Number(1.0))));
    assert!(points.contains(&(0.15, product(&["to_low_rebound"]))));
    assert!(points.contains(&(-0.4, product(&["to_low_compression", "to_half_compression"]))));
    // Standing, the deflection of a tyre is minus its stretch.
    let tire = &law("tire_law").curves()[0];
    assert_eq!((tire.over.as_str(), tire.points[0].0), ("s", -2.0));
    assert!(law("memory_law").curves().is_empty());
}

/// An effect that was found is a file of its own: put into the model again it starts where it was found.
#[test]
fn an_effect_is_written_with_the_values_that_were_found() {
    let model = model("axle_c");
    let first = patched(&law("damping_law"), &model, "damper");
    let mut found = first.parameters.clone();
    for (k, own) in found.iter_mut().enumerate() {
        own.start = own.range.0 + (own.range.1 - own.range.0) * (k as f64 + 1.0) / 20.0;
    }
    let text = law("damping_law").text_at(&found);
    let again = Patch::read(Source {
        name: "found.axle".into(),
        text,
    });
    let again = patched(&again.unwrap_or_else(|report| panic!("{report}")), &model, "damper");
    for (own, found) in again.parameters.iter().zip(&found) {
        assert_eq!(own.name, found.name);
        assert!(
            (own.start / found.start - 1.0).abs() < 0.01,
            "{} is {}",
            own.name,
            own.start
        );
    }
}

/// A cycle is no radian: what is declared in Hz is printed so, of an effect and of the model that holds it.
#[test]
fn a_frequency_keeps_its_unit() {
    let patched = patched(&effect("tire_dynamic_stiffness"), &model("axle_c"), "tire");
    let name = "relaxation_frequency";
    let new = patched.parameters.iter().find(|own| own.name == name).unwrap();
    let held = patched.model.parameters.iter().find(|own| own.name == name).unwrap();
    assert_eq!((new.unit.as_str(), held.unit_name.as_str()), ("Hz", "Hz"));
}

/// Where each effect applies, model by model: what a discovery chooses from.
#[test]
fn the_catalogue_applies_where_it_should() {
    let mut table = String::new();
    for (model, candidates) in OF_EFFECTS.iter() {
        table += &format!("{model}\n");
        for of_effect in candidates.chunk_by(|one, next| one.effect == next.effect) {
            // An effect has a candidate at a place for each of its forms.
            let mut places: Vec<&str> = of_effect.iter().map(|own| own.place.as_str()).collect();
            places.dedup();
            table += &format!("    {}: {}\n", of_effect[0].effect, places.join(", "));
        }
    }
    insta::assert_snapshot!(table);
}

/// A list of places is made from fewer parameter sets and motions than candidates are.
#[test]
fn places_are_those_of_the_candidates() {
    for (model, candidates) in OF_EFFECTS
        .iter()
        .filter(|(model, _)| ["axle_c", "quarter_car"].contains(&model.as_str()))
    {
        let checked = self::model(model);
        for effect in effects() {
            let name = &effect.effect().name.text;
            let own = candidates.iter().filter(|own| own.effect == *name);
            let mut places: Vec<&str> = own.map(|own| own.place.as_str()).collect();
            places.dedup();
            assert_eq!(effect.places(&checked), places, "{name} in {model}");
        }
    }
}

/// What a search cannot find beside an effect: the effects, at their places, that the model allows and a model with the
/// effect refuses in every form. Most replace a term that is gone, or act at the same place in the same way. A mass
/// that is taken from the body fits before the mass above the other axle, and not after it: at the ends of the ranges,
/// the inertance between the two would be larger than what is left. Errors of sensors are left out, since they do not
/// change the model.
#[test]
#[ignore = "every effect beside every other; .ci/run runs it"]
fn what_each_effect_excludes() {
    let base = model("axle_c");
    let changes_model = |effect: &Patch| !effect.effect().name.text.starts_with("sensor_");
    let all: Vec<Patch> = effects().into_iter().filter(changes_model).collect();
    let fits = |model: &Checked| -> Vec<(&Patch, String)> {
        let places = all.iter().map(|effect| (effect, effect.places(model)));
        let each = places.flat_map(|(effect, places)| places.into_iter().map(move |place| (effect, place)));
        each.collect()
    };
    let name = |(effect, place): &(&Patch, String)| format!("{} at {place}", effect.effect().name.text);
    let alone = fits(&base);
    let mut table = String::new();
    for own in &alone {
        let beside: Vec<String> = fits(&patched(own.0, &base, &own.1).model).iter().map(name).collect();
        let others = alone.iter().map(name).filter(|other| *other != name(own));
        let excluded: Vec<String> = others.filter(|other| !beside.contains(other)).collect();
        if !excluded.is_empty() {
            table += &format!("{}\n    {}\n", name(own), excluded.join("\n    "));
        }
    }
    insta::assert_snapshot!(table);
}

#[test]
fn an_effect_is_tried_in_each_form_that_the_model_allows() {
    let friction = effect("coulomb_friction");
    let forms = |name: &str| -> Vec<Option<String>> {
        let candidates = friction.candidates(&model(name), &|_| None);
        candidates.into_iter().map(|patched| patched.form).collect()
    };
    let and_smooth = |forms: &[&str]| -> Vec<Option<String>> {
        let smooth = forms.iter().map(|form| Some(format!("smooth_{form}")));
        let all = forms.iter().map(|form| Some(form.to_string())).chain(smooth);
        all.chain([Some("gradual_in_damper".into())]).collect()
    };
    let (inside, across, beside) = ("in_damper", "across_strut", "between_wheel_and_body");
    assert_eq!(forms("axle_c"), and_smooth(&[inside, across, beside]));
    assert_eq!(forms("axle_c_rigid_tm"), and_smooth(&[inside, beside]));
    assert_eq!(forms("one_mass"), and_smooth(&[inside]));
    assert_eq!(friction.places(&model("axle_c")), ["damper"]);
    assert!(friction.in_form("sideways").is_none());
}

#[test]
fn forms_of_one_name_are_refused() {
    let text = "effect e at link l { \"A\" source \"B\"; shows \"C\";
        form a { \"D\" remove l; } form a { remove l; } }";
    let source = Source {
        name: "e.axle".into(),
        text: text.into(),
    };
    let report = Patch::read(source).unwrap_err().to_string();
    assert!(report.contains("`a` is declared twice in effect `e`"), "{report}");
    assert!(
        report.contains("effect `e` has no sentence that says what its form `a` is"),
        "{report}"
    );
}

/// The model with other names of what moves and of its links; those of laws and parameters stay.
fn renamed(model: &Checked) -> Checked {
    let points = [
        ("body", "cabin"),
        ("wheel", "hub"),
        ("tm", "dome"),
        ("sf", "cradle"),
        ("pwt", "engine"),
        ("pad", "shaker"),
    ];
    let links = [
        ("tire", "pneumatic"),
        ("spring", "coil"),
        ("damper", "shock"),
        ("top_mount", "dome_rubber"),
        ("subframe_mount", "cradle_rubber"),
        ("powertrain_mount", "engine_rubber"),
        ("wheel_bushing_x", "arm_rubber"),
        ("powertrain_mount_x", "engine_rubber_x"),
    ];
    let mut text = String::new();
    let words = model
        .text()
        .split_inclusive(|c: char| !(c.is_alphanumeric() || c == '_'));
    let mut before = String::new();
    for piece in words {
        let word = piece.trim_end_matches(|c: char| !(c.is_alphanumeric() || c == '_'));
        let is_link = before == "link";
        let other = |all: &[(&str, &'static str)]| all.iter().find(|(own, _)| *own == word).map(|(_, other)| *other);
        let new = if is_link { other(&links) } else { other(&points) };
        text += new.unwrap_or(word);
        text += &piece[word.len()..];
        if !word.is_empty() {
            before = word.to_string();
        }
    }
    let name = "renamed.axle".into();
    check(Source { name, text }, &load).unwrap_or_else(|report| panic!("{report}"))
}

/// Effects and their forms.
fn forms(candidates: &[Candidate]) -> Vec<(&str, Option<&str>)> {
    let forms = candidates.iter();
    forms.map(|own| (own.effect.as_str(), own.form.as_deref())).collect()
}

#[test]
fn effects_go_by_what_the_parts_do_not_by_what_they_are_called() {
    for name in ["axle_a", "axle_c", "axle_d", "quarter_car"] {
        let renamed = candidates(effects(), &renamed(&model(name)));
        let mut found = forms(&renamed);
        let (_, usual) = OF_EFFECTS.iter().find(|(model, _)| model == name).unwrap();
        for own in forms(usual) {
            let place = found.iter().position(|other| *other == own);
            found.remove(place.unwrap_or_else(|| panic!("{name} loses {own:?}")));
        }
        // What an effect adds is refused only where the model has something of that name.
        found.retain(|(effect, _)| *effect != "suspended_mass" && *effect != "subframe");
        assert!(found.is_empty(), "{name}: {found:?}");
    }
}

/// A sub-frame takes the place of the point about which the levers turn, if this point is on the body.
#[test]
fn a_pivot_is_where_levers_turn_whatever_its_name() {
    let text = |arms: &str| {
        format!(
            "axle levers {{ param k: N/m = 5e4 in 1e3..1e6; param c: N s/m = 1e3 in 1..1e5; param kt: N/m = 2e5 in 1e4..1e6;
                known param i: 1 = 0.7 in 0.1..2; known param frame_mass: kg = 12 in 1..100;
                direction z {{ road shaker; mass chassis = 400 kg; mass hub = 40 kg; mass frame = frame_mass;
                    point arms = {arms};
                    link mount: chassis - frame {{ spring 2e6 N/m; damper 500 N s/m; }}
                    link tyre: hub - shaker {{ spring kt; }}
                    link coil: chassis - arms - i*(hub - arms) {{ spring k; damper c; }}
                    output chassis.acceleration; }} }}"
        )
    };
    let places = |arms: &str, name: &str| {
        let source = Source {
            name: "levers.axle".into(),
            text: text(arms),
        };
        let checked = check(source, &load).unwrap_or_else(|report| panic!("{report}"));
        effect(name).places(&checked)
    };
    let none: [&str; 0] = [];
    assert_eq!(places("chassis", "subframe"), ["chassis"]);
    assert_eq!(places("chassis", "subframe_pitch"), none);
    assert_eq!(places("frame", "subframe"), none);
    assert_eq!(places("frame", "subframe_pitch"), ["subframe"]);
}

/// The part of a body above the other axle may be the heavier one.
#[test]
fn the_body_stays_that_of_its_wheel_beside_the_other_axle() {
    let with_other = patched(&effect("apparent_mass"), &model("axle_c"), "body").model;
    assert_eq!(effect("body_bending").places(&with_other), ["body"]);
    assert_eq!(effect("drag_to_ground").places(&with_other), ["body", "wheel"]);
}

/// What another effect takes from the body leaves less of it than the inertance of the pitch was computed from.
#[test]
fn a_part_of_a_pitching_body_can_be_a_mass_of_its_own() {
    let value = |name: &str| match name {
        "m_corner" => Some(481.0),
        "m_half_vehicle" => Some(955.9),
        "m_wheel_other_axle" => Some(46.5),
        "m_wheel" => Some(55.3),
        "m_tm" => Some(5.1),
        _ => None,
    };
    let pitching = effect("apparent_mass").apply(&model("axle_c"), "body", &value);
    let pitching = pitching.unwrap().model;
    for name in ["body_bending", "suspended_mass", "subframe"] {
        let both = effect(name).apply(&pitching, "body", &value);
        both.unwrap_or_else(|report| panic!("{name}: {report:?}"));
    }
}

/// Whether a law is linear is decided at pseudo-random motions, of which all may be within its linear travel.
#[test]
fn a_dead_zone_is_seen_beside_any_effect() {
    for (name, place) in [
        ("tire_belt", "tire"),
        ("secondary_resonator", "wheel"),
        ("body_bending", "body"),
    ] {
        let with = patched(&effect(name), &model("axle_c"), place).model;
        let both = patched(&effect("bushing_saturation"), &with, "wheel_bushing_x").model;
        assert!(both.unseen().is_empty(), "{name}");
    }
}

#[test]
fn a_belt_leaves_the_wheel_what_it_was() {
    let with_belt = patched(&effect("tire_belt"), &model("axle_c"), "tire").model;
    assert_eq!(effect("digressive_damper").places(&with_belt), ["damper"]);
    assert_eq!(effect("secondary_resonator").places(&with_belt), ["wheel"]);
    assert_eq!(effect("drag_to_ground").places(&with_belt), ["body", "wheel"]);
}

#[test]
fn ranges_are_measured_by_the_motion_of_the_place() {
    let friction = effect("coulomb_friction");
    let big = |name: &str| match name {
        "z.damper.force_scale" => Some(30e3),
        "z.damper.travel_scale" => Some(0.2),
        _ => None,
    };
    let start = |values| {
        let patched = friction.apply(&model("linear_damper"), "damper", values).unwrap();
        let own = patched.parameters[0].clone();
        (own.start, own.range)
    };
    assert_eq!(start(&big), (1800.0, (30.0, 3e6)));
    assert_eq!(start(&|_| None), (60.0, (1.0, 100e3)));
}

#[test]
fn the_friction_of_an_arm_is_measured_at_the_wheel() {
    let ratio = |name: &str| match name {
        "mr_damper" => Some(0.5),
        "z.damper.force_scale" => Some(2e3),
        _ => None,
    };
    let patched = effect("coulomb_friction")
        .apply(&model("axle_b"), "damper", &ratio)
        .unwrap();
    assert_eq!(patched.parameters[0].start, 0.06 * 0.5 * 2e3);
}

#[test]
fn a_sub_frame_may_carry_the_powertrain_that_hung_on_the_body() {
    let forms = |name: &str| -> Vec<Option<String>> {
        let candidates = effect("subframe").candidates(&model(name), &|_| None);
        candidates.into_iter().map(|patched| patched.form).collect()
    };
    let [bare, carrying] = ["bare", "with_powertrain"].map(|form| Some(form.to_string()));
    assert_eq!(forms("axle_a"), [bare.clone(), carrying]);
    assert_eq!(forms("axle_c"), [bare]);
    let patched = effect("subframe").in_form("with_powertrain").unwrap();
    let text = patched
        .apply(&model("axle_a"), "body", &|_| None)
        .unwrap()
        .model
        .text()
        .to_string();
    for link in ["link powertrain_mount: pwt - sf ", "link powertrain_mount_x: pwt - sf "] {
        assert!(text.contains(link), "{text}");
    }
}

#[test]
fn any_law_of_a_damper_may_stand_on_a_compliant_end() {
    let forms = |name: &str| -> Vec<String> {
        let candidates = effect("series_compliance").candidates(&model(name), &|_| None);
        candidates.into_iter().filter_map(|patched| patched.form).collect()
    };
    assert_eq!(forms("axle_c"), ["linear"]);
    assert_eq!(forms("damper_dyno"), ["any_law"]);
    let digressive = patched(&effect("digressive_damper"), &model("axle_b"), "damper").model;
    let candidates = effect("series_compliance").candidates(&digressive, &|_| None);
    assert_eq!(candidates.len(), 1);
    assert_eq!(candidates[0].form.as_deref(), Some("any_law"));
}

#[test]
fn an_effect_says_where_the_sensors_of_a_mass_stand() {
    let seen =
        |made: &Patched| -> Vec<String> { made.model.outputs.iter().map(|output| output.name.clone()).collect() };
    let pitching = patched(&effect("subframe_pitch"), &model("axle_d"), "subframe");
    for end in ["front", "rear"] {
        let name = format!("z_sf_{end}_acceleration");
        assert!(seen(&pitching).contains(&name), "{:?}", seen(&pitching));
    }
    let text = pitching.text("a test");
    assert!(text.contains("point sf_front = sf + half_length*sf_pitch;"), "{text}");
    assert!(text.contains("point sf_rear = sf - half_length*sf_pitch;"), "{text}");

    let bending = patched(&effect("body_bending"), &model("axle_a"), "body");
    assert!(
        seen(&bending).contains(&"z_body_sensor_acceleration".to_string()),
        "{:?}",
        seen(&bending)
    );
    let nuisances = effects().into_iter().filter(|own| own.effect().nuisance);
    let names: Vec<String> = nuisances.map(|own| own.effect().name.text.clone()).collect();
    assert_eq!(names, ["body_bending"]);
}

/// The mass that hangs is a share of the known mass of the body, which is five times its default.
#[test]
fn an_effect_is_sized_by_known_values_and_the_model_takes_them_as_defaults() {
    let known = |name: &str| (name == "m_body").then_some(5.0);
    let places = effect("suspended_mass").candidates(&model("one_mass"), &known);
    let [own, ..] = places.as_slice() else {
        panic!("{} places", places.len())
    };
    let text = own.text("");
    for line in ["param m_body: kg = 5 in 1e-9..1e6", "param m_pwt: kg = 1 in 0.05..3.5"] {
        assert!(text.contains(line), "expected `{line}` in\n{text}");
    }
}

/// Each point of a curve changes some motion, large or small. The shares of the travel at which the points lie are
/// known parameters, and what a motion must be to reach them differs from model to model.
#[test]
fn every_point_of_a_curve_is_seen_in_every_model() {
    for name in ["one_mass", "quarter_car", "axle_a", "axle_d", "axle_e"] {
        let model = model(name);
        for (law_name, place) in [
            ("elastic_law", "spring"),
            ("damping_law", "damper"),
            ("position_damping_law", "damper"),
        ] {
            let patched = patched(&law(law_name), &model, place);
            assert!(
                patched.model.unseen().is_empty(),
                "{law_name} in {name}: {:?}",
                patched.model.unseen()
            );
        }
    }
}

/// On a test rig without a road, a link may be a suspension as well as a mount.
#[test]
fn without_a_wheel_a_link_is_a_mount_too() {
    let on_rig = model("linear_damper");
    for name in ["hydraulic_mount", "bushing_relaxation", "segmented_polynomial_damper"] {
        assert_eq!(effect(name).places(&on_rig), ["damper"], "{name}");
    }
    assert_eq!(effect("hydraulic_mount").places(&model("quarter_car")), [""; 0]);
}

/// On a test rig without a road, a resonator may sit on any mass that is not the heaviest, whose hidden parts are those of
/// a body.
fn written(text: &str) -> Checked {
    let source = Source {
        name: "written.axle".into(),
        text: text.into(),
    };
    check(source, &load).unwrap_or_else(|report| panic!("{report}"))
}

/// Without a known mass, the accelerations on a shaker show only ratios. An effect adds no further freedom, so a campaign
/// that states one mass determines its parameters too.
#[test]
fn effects_apply_where_the_outputs_show_only_ratios() {
    let text = "axle rig { \"A wheel and a body on a post\"
        param m_wheel: kg = 40 in 5..200; MASS param m_body: kg = 300 in 50..1e3;
        param k: N/m = 2e4 in 1e3..2e5; param c: N s/m = 1500 in 100..2e4; param k_tire: N/m = 2e5 in 2e4..1e6;
        direction z {
            motion post; mass wheel = m_wheel; mass body = m_body;
            link tire: wheel - post { spring k_tire; } link spring: body - wheel { spring k; }
            link damper: body - wheel { damper c; }
            output wheel.acceleration; output body.acceleration;
        } }";
    let [free, known] = ["", "known"].map(|word| written(&text.replace("MASS", word)));
    for patch in effects() {
        assert_eq!(
            patch.places(&free),
            patch.places(&known),
            "{}",
            patch.effect().name.text
        );
    }
    assert_eq!(effect("series_compliance").places(&free), ["damper"]);
}

/// A link may end at a named point of several coordinates, or the sum may stand in its stretch: both are a suspension.
#[test]
fn a_named_point_of_a_pitching_body_is_an_end_of_the_suspension() {
    let text = "axle pitching { \"A body that pitches on one wheel\"
        known param m: kg = 400; known param j: kg m^2 = 500; known param l: m = 1.3;
        param mw: kg = 40 in 10..100; param k: N/m = 25e3 in 1e3..1e5;
        param c: N s/m = 1500 in 1..1e4; param kt: N/m = 2e5 in 5e4..5e5;
        direction z {
            road pad; mass body = m; inertia pitch = j; mass wheel = mw;
            point nose = body + l*pitch;
            link tyre: wheel - pad { spring kt; } link rear: body - l*pitch { spring 20e3 N/m; damper 1e3 N s/m; }
            link front: NOSE - wheel { spring k; damper c; }
            output wheel.acceleration; output nose.acceleration;
        } }";
    for name in ["coulomb_friction", "digressive_damper", "progressive_spring"] {
        let places = ["nose", "body + l*pitch"].map(|nose| effect(name).places(&written(&text.replace("NOSE", nose))));
        assert!(places[0].contains(&"front".to_string()), "{name}: {:?}", places[0]);
        assert_eq!(places[0], places[1], "{name}");
    }
}

/// Two equal tyres under a beam: each wheel has a suspension, and an effect at one strut acts at its own wheel.
const TWO_TYRES: &str = "axle two { \"A beam on two wheels\"
    known param m_b: kg = 800; known param j_b: kg m^2 = 1200; known param a: m = 1.3;
    param m_w: kg = 40 in 10..80; param k: N/m = 25e3 in 1e4..8e4; param c: N s/m = 1500 in 100..5000;
    param kt: N/m = 2e5 in 1e5..4e5;
    direction z {
        road front_pad; road rear_pad;
        mass body = m_b; inertia pitch = j_b; mass front_wheel = m_w; mass rear_wheel = m_w;
        point nose = body + a*pitch; point tail = body - a*pitch;
        link front_tire: front_wheel - front_pad { spring kt; }
        link rear_tire: rear_wheel - rear_pad { spring kt; }
        link front_strut: nose - front_wheel { spring k; damper c; }
        link rear_strut: tail - 0.9*rear_wheel { spring k; damper c; }
        output nose.acceleration; output tail.acceleration; output pitch.acceleration;
        output front_wheel.acceleration; output rear_wheel.acceleration;
    } }";

#[test]
fn every_tyre_has_its_wheel_and_its_suspension() {
    let two = written(TWO_TYRES);
    for name in ["coulomb_friction", "digressive_damper", "progressive_spring", "inerter"] {
        assert_eq!(effect(name).places(&two), ["front_strut", "rear_strut"], "{name}");
    }
    assert_eq!(
        effect("tire_progressive_stiffness").places(&two),
        ["front_tire", "rear_tire"]
    );
    assert_eq!(
        effect("secondary_resonator").places(&two),
        ["front_wheel", "rear_wheel"]
    );
    assert_eq!(
        effect("drag_to_ground").places(&two),
        ["body", "front_wheel", "rear_wheel"]
    );
    assert_eq!(effect("bushing_relaxation").places(&two), Vec::<String>::new());
}

/// A place that an effect does not fit is refused with what it lacks.
#[test]
fn a_refused_place_is_told_what_it_lacks() {
    let two = written(TWO_TYRES);
    let refusal = |name: &str, place: &str| effect(name).apply(&two, place, &|_| None).unwrap_err().to_string();
    let tyre = refusal("coulomb_friction", "rear_tire");
    assert!(
        tyre.contains("it has no damping") && tyre.contains("write `front_strut` or `rear_strut`"),
        "{tyre}"
    );
    let spring = refusal("progressive_spring", "rear_tire");
    assert!(spring.contains("it does not have the role `suspension`"), "{spring}");
    let absent = refusal("coulomb_friction", "rear_shock");
    assert!(absent.contains("does not apply at `rear_shock` of two\n"), "{absent}");
}

/// The friction at the rear strut is between the body and the rear wheel, and is seen through the lever of that strut.
#[test]
fn an_effect_acts_at_the_wheel_of_its_own_tyre() {
    let friction = effect("coulomb_friction");
    let at = |form: &str, place: &str| {
        let patched = patched(&friction.in_form(form).unwrap(), &written(TWO_TYRES), place);
        patched.text("")
    };
    let beside = at("between_wheel_and_body", "rear_strut");
    assert!(beside.contains("link friction: body - rear_wheel"), "{beside}");
    let beside = at("between_wheel_and_body", "front_strut");
    assert!(beside.contains("link friction: body - front_wheel"), "{beside}");
    let inside = at("in_damper", "rear_strut");
    assert!(inside.contains("force = f_dry/0.9;"), "{inside}");
}

const STACK: &str = "axle stack { \"Three masses on a shaker\"
    param m: kg = 1 in 0.1..10 \"Mass\"; param k: N/m = 1e4 in 1..1e6 \"Stiffness\";
    direction z {
        motion shaker; mass low = 3 * m; mass middle = m; mass top = 2 * m;
        link first: low - shaker { spring k; } link second: middle - low { spring k; } link third: top - middle { spring k; }
        output top.acceleration;
    } }";

#[test]
fn without_a_road_a_mass_may_hang_on_any_other() {
    let stack = written(STACK);
    let lying = written(&STACK.replace("direction z", "direction x"));
    let forms = |name: &str, model: &Checked| -> Vec<(String, String)> {
        let candidates = effect(name).candidates(model, &|_| None).into_iter();
        candidates.map(|own| (own.place, own.form.unwrap())).collect()
    };
    let listed = |all: &[(&str, &str)]| -> Vec<(String, String)> {
        all.iter().map(|&(place, form)| (place.into(), form.into())).collect()
    };
    let elsewhere = [
        ("middle", "vertical"),
        ("middle", "soft_fore_and_aft"),
        ("middle", "attached"),
        ("middle", "hardening"),
        ("middle", "attached_hardening"),
        ("top", "vertical"),
        ("top", "soft_fore_and_aft"),
        ("top", "attached"),
        ("top", "hardening"),
        ("top", "attached_hardening"),
    ];
    let on_the_body = [
        ("low", "within_body"),
        ("low", "attached"),
        ("low", "on_stiffening_mounts"),
    ];
    // What an effect does along x is in addition to what it does along the axle's own direction.
    for model in [&stack, &lying] {
        assert_eq!(forms("secondary_resonator", model), listed(&elsewhere));
        assert_eq!(forms("suspended_mass", model), listed(&on_the_body));
    }
    let on_a_car = [
        ("wheel", "vertical"),
        ("wheel", "soft_fore_and_aft"),
        ("wheel", "hardening"),
    ];
    assert_eq!(forms("secondary_resonator", &model("quarter_car")), listed(&on_a_car));
}

#[test]
fn an_attached_resonator_leaves_the_stated_mass_as_it_is() {
    let stack = written(STACK);
    let resonator = effect("secondary_resonator");
    let text = |form: &str| {
        patched(&resonator.in_form(form).unwrap(), &stack, "middle")
            .model
            .text()
            .to_string()
    };
    assert!(
        text("vertical").contains("mass middle = m - m_resonator;"),
        "{}",
        text("vertical")
    );
    assert!(text("attached").contains("mass middle = m;"), "{}", text("attached"));
    // A car is weighed as a whole.
    let attached = resonator.in_form("attached").unwrap();
    let refused = attached.apply(&model("quarter_car"), "wheel", &|_| None).unwrap_err();
    assert!(
        refused.to_string().contains("`wheel` does not have the role `part`"),
        "{refused}"
    );
}
