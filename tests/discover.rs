//! What is missing is named, and nothing is invented, on campaigns that a second simulator makes.

#[path = "support/studied.rs"]
mod studied;
#[path = "support/swept.rs"]
mod swept;

use std::fs;
use std::path::Path;
use std::process::Command;
use std::sync::LazyLock;

use qcar_blind::hardware::Flaw;
use qcar_blind::hidden::Hidden;
use qcar_blind::matrix::cases;
use qcar_blind::programme::Programme;
use qcar_blind::{Order, make};
use qcar_runtime::discover::numbers::Numbers;
use serde_json::Value;
use studied::Studied;
use swept::{swept, two_sensors};

/// Runs `qcar discover` on a campaign.
pub fn discover(campaign: &Path, out: Option<&Path>) -> Value {
    let out = out.map(|out| ["--out", out.to_str().expect("a path of letters")]);
    discover_with(campaign, out.as_ref().map_or(&[], |out| out))
}

/// The same with further arguments.
fn discover_with(campaign: &Path, arguments: &[&str]) -> Value {
    let mut command = Command::new(env!("CARGO_BIN_EXE_qcar"));
    command
        .arg("discover")
        .arg(campaign)
        .args(["--format", "json"])
        .args(arguments);
    let output = command.output().expect("qcar runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("JSON")
}

/// The first effect has these parameters, within 15 %.
fn assert_near(answer: &Value, truth: &[(&str, f64)]) {
    for (name, value) in truth {
        let found = answer["effects"][0]["parameters"][name].as_f64().expect("a number");
        assert!((found / value - 1.0).abs() < 0.15, "{name} is {found}, not {value}");
    }
}

#[test]
fn what_is_left_of_a_clean_campaign_is_noise() {
    let answer = studied("axle_a_rig");
    assert_eq!(answer["verdict"], "none");
    assert_eq!(answer["effects"], Value::Array(Vec::new()));
    assert_eq!(answer["places"], Value::Array(Vec::new()));
}

/// A low-pass filter delays a sensor and damps it by a few percent, and the catalogue has only delays. An absorber of the
/// wheel whose parameters nothing determines would explain the rest, and is not named.
#[test]
fn a_low_pass_filter_is_a_delay_and_nothing_else() {
    let campaign = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/low_pass");
    let answer = discover(&campaign, None);
    let effects = answer["effects"].as_array().expect("a list");
    assert_eq!(effects.len(), 2, "{answer}");
    assert!(effects.iter().all(|own| own["name"] == "sensor_delay"), "{answer}");
}

/// Half of the size from which on an effect is said to be seen is not named, and twice that size is.
#[test]
fn an_effect_is_seen_from_the_size_on_that_is_told() {
    let with = |c_drag: f64| {
        of_short_sweeps(
            "c",
            SEED_OF_CLEAN,
            Hidden::new("drag_to_ground", "body", &[("c_drag", c_drag)]),
        )
    };
    let (_, clean) = &*CLEAN;
    assert_eq!(clean["verdict"], "none");
    let visible = clean["visible"].as_array().expect("effects");
    let drag = visible
        .iter()
        .find(|own| own["name"] == "drag_to_ground" && own["at"] == "body")
        .expect("it applies to every body");
    let number = |value: &Value| value.as_f64().expect("a number");
    let limit = number(&drag["usual"]["c_drag"]) / number(&drag["times_the_limit"]);
    assert_eq!(with(0.5 * limit)["verdict"], "none");
    let seen = with(2.0 * limit);
    assert_eq!(seen["effects"][0]["name"], "drag_to_ground", "{seen}");
}

const SEED_OF_CLEAN: u64 = 31;

/// A campaign of short sweeps in which nothing is hidden, and the answer to it: made once for several tests.
static CLEAN: LazyLock<(Order, Value)> = LazyLock::new(|| {
    let order = short_sweeps("c", SEED_OF_CLEAN, vec![]);
    let answer = answer_to(order.clone());
    (order, answer)
});

/// What a study of a shipped campaign has found.
fn studied(campaign: &str) -> Value {
    answer_of(&Studied::new(campaign))
}

fn answer_of(study: &Studied) -> Value {
    let text = fs::read_to_string(study.folder.join("study.json"));
    let text = text.unwrap_or_else(|error| panic!("no result ({error}) of {}", study.said));
    let result: Value = serde_json::from_str(&text).expect("JSON");
    result["discover"].clone()
}

fn measured(name: &str) -> Value {
    let campaigns = Path::new(env!("CARGO_MANIFEST_DIR")).join("models/campaigns");
    discover(&campaigns.join(name), None)
}

/// Half of each record, which takes a third of the time: the answer is that to the whole records.
#[test]
fn dry_friction_is_named_in_a_real_drive() {
    let folder = tempfile::tempdir().expect("a folder");
    let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("models/campaigns/emps");
    for run in ["first.csv.gz", "second.csv.gz"] {
        fs::copy(shipped.join(run), folder.path().join(run)).expect("a record");
    }
    let manifest = fs::read_to_string(shipped.join("campaign.toml")).expect("it is shipped");
    let parts: Vec<&str> = manifest.split("[[run]]").collect();
    let [head, first, second] = parts[..] else {
        panic!("two runs: {manifest}")
    };
    let half = |run: &str, from: f64| format!("[[run]]{}\nfrom = {from:?}\nto = {:?}\n\n", run.trim_end(), from + 6.2);
    let halves = [head.to_owned(), half(first, 0.0), half(second, 12.471)].concat();
    fs::write(folder.path().join("campaign.toml"), halves).expect("a manifest");
    is_published_friction(&discover(folder.path(), None));
}

#[test]
#[ignore = "a whole search; .ci/run runs it"]
fn dry_friction_is_estimated_well_in_a_real_drive() {
    let error = is_published_friction(&measured("emps"));
    assert!(error < 1.0, "{error} N");
}

/// Published: Fc 20.39 N (Janot, Gautier and Brunot 2019). The standard error, in N.
fn is_published_friction(answer: &Value) -> f64 {
    assert_eq!(answer["verdict"], "found", "{answer}");
    let effects = answer["effects"].as_array().expect("effects");
    assert_eq!(effects.len(), 1, "{answer}");
    assert_eq!(effects[0]["name"], "coulomb_friction", "{answer}");
    let [friction, error] = ["parameters", "stderr"].map(|of| effects[0][of]["f_coulomb"].as_f64().expect("a number"));
    assert!((friction - 20.39).abs() < 2.0 * error, "{friction} ± {error} N");
    let held_out = answer["gap"]["held_out"]["after"].as_f64().expect("a number");
    assert!(held_out < 1.0, "{held_out}");
    error
}

/// The force of a magnetorheological damper saturates at low speed, as friction does, and a spring in series gives it
/// memory. The record reaches 68 mm/s.
#[test]
#[ignore = "a whole search; .ci/run runs it"]
fn a_saturating_force_with_memory_is_named_in_a_real_damper() {
    let answer = studied("mr_damper");
    assert_eq!(answer["verdict"], "found", "{answer}");
    let effects = answer["effects"].as_array().expect("effects");
    assert_eq!(effects.len(), 1, "{answer}");
    assert_eq!(effects[0]["name"], "compliant_digressive_damper", "{answer}");
    let speed = effects[0]["parameters"]["v0"].as_f64().expect("a number");
    assert!(speed < 0.0068, "{speed} m/s");
    let left = answer["left"][0]["after_percent"].as_f64().expect("a number");
    assert!(left < 12.0, "{left} %");
}

/// Fitted to one record of a band that slips, and judged on others at another frequency and another tension.
#[test]
#[ignore = "a whole search; .ci/run runs it"]
fn friction_with_memory_and_backlash_is_named_in_a_real_device() {
    let answer = measured("friction_damper");
    assert_eq!(answer["verdict"], "found", "{answer}");
    let effect = &answer["effects"][0];
    assert_eq!(effect["name"], "elasto_slip_friction", "{answer}");
    assert_eq!(effect["form"], "with_backlash", "{answer}");
    let left = answer["left"][0]["after_percent"].as_f64().expect("a number");
    assert!(left < 20.0, "{left} %");
}

/// With the damper bolted to the body nothing is left to move on the K&C rig.
#[test]
#[ignore = "a whole search; .ci/run runs it"]
fn a_top_mount_that_the_model_lacks_is_found() {
    let folder = tempfile::tempdir().expect("a folder");
    let campaign = folder.path().join("campaign");
    let truth = [("m_tm", 5.0), ("k_tm", 450e3), ("c_tm", 700.0)];
    let order = Order {
        programme: Programme::fast(),
        cleats: false,
        effects: vec![Hidden::new("top_mount", "damper", &truth)],
        ..Order::clean("c", 23)
    };
    make(order, &campaign).expect("a campaign");
    let answer = discover(&campaign, None);
    assert_eq!(answer["verdict"], "found", "{answer}");
    assert_eq!(answer["effects"][0]["name"], "top_mount");
    assert_eq!(answer["effects"][0]["at"], "damper");
    let of_ceiling = answer["effects"][0]["evidence"]["of_ceiling"].as_f64();
    assert!(of_ceiling.is_some_and(|share| share > 0.8), "{answer}");
    // Bolted on, the damper stands where the spring does.
    let best = &answer["places"][0];
    assert!(best["at"] == "damper" || best["at"] == "spring", "{best}");
    assert!(best["explains"].as_f64().is_some_and(|share| share > 0.8), "{best}");
    assert_near(&answer, &truth);
}

/// A light mass on a stiff mount is nearly a spring: it is told from one only once it is fitted to all runs together,
/// which takes its three parameters more steps than that one.
#[test]
#[ignore = "a whole search; .ci/run runs it"]
fn a_light_top_mount_is_told_from_a_spring_in_series() {
    let folder = tempfile::tempdir().expect("a folder");
    let campaign = folder.path().join("campaign");
    let truth = [("m_tm", 3.0), ("k_tm", 800e3), ("c_tm", 900.0)];
    let order = Order {
        effects: vec![Hidden::new("top_mount", "damper", &truth)],
        ..Order::clean("c", 2000)
    };
    make(order, &campaign).expect("a campaign");
    let answer = discover(&campaign, None);
    assert_eq!(answer["verdict"], "found", "{answer}");
    assert_eq!(answer["effects"][0]["name"], "top_mount");
    assert_near(&answer, &truth[..2]);
    let rivals = answer["effects"][0]["rivals"].as_array().expect("rivals");
    assert!(
        rivals.iter().all(|rival| rival["behind"].as_f64() > Some(0.0)),
        "{answer}"
    );
}

/// Its law has a kink where the damper turns, at which no step of a search is sure to help.
#[test]
#[ignore = "a whole search; .ci/run runs it"]
fn a_damper_that_is_harder_in_rebound_is_found() {
    let folder = tempfile::tempdir().expect("a folder");
    let campaign = folder.path().join("campaign");
    let order = Order {
        programme: Programme::fast(),
        cleats: false,
        effects: vec![Hidden::new(
            "asymmetric_damper",
            "damper",
            &[("rebound_over_compression", 1.6)],
        )],
        ..Order::clean("c", 24)
    };
    make(order, &campaign).expect("a campaign");
    let answer = discover(&campaign, None);
    assert_eq!(answer["verdict"], "found", "{answer}");
    assert_eq!(answer["effects"][0]["name"], "asymmetric_damper");
    assert_eq!(answer["effects"][0]["at"], "damper");
    let found = answer["effects"][0]["parameters"]["rebound_over_compression"]
        .as_f64()
        .expect("a number");
    assert!((found / 1.6 - 1.0).abs() < 0.05, "{found}");
}

/// A fit of a model that brings its effect along, which the campaign knows nothing of.
#[test]
fn a_model_that_has_the_effect_already_lacks_nothing() {
    let folder = tempfile::tempdir().expect("a folder");
    let [campaign, model] = ["campaign", "patched.axle"].map(|name| folder.path().join(name));
    let mass = [
        ("m_pwt", 70.0),
        ("k_pwt_z", 280e3),
        ("c_pwt_z", 500.0),
        ("k_pwt_x", 3e5),
        ("c_pwt_x", 400.0),
    ];
    make(
        short_sweeps("c", 22, vec![Hidden::new("suspended_mass", "body", &mass)]),
        &campaign,
    )
    .expect("a campaign");
    let patch = ["patch", "axle_c", "suspended_mass", "--at", "body", "--out"];
    let patched = Command::new(env!("CARGO_BIN_EXE_qcar"))
        .args(patch)
        .arg(&model)
        .output();
    assert!(patched.expect("qcar runs").status.success());
    let answer = discover_with(&campaign, &["--model", model.to_str().expect("a path of letters")]);
    assert_eq!(answer["verdict"], "none", "{answer}");
    assert!(answer["gap"]["held_out"]["before"].as_f64() < Some(1.5), "{answer}");
}

#[test]
#[ignore = "a whole search; .ci/run runs it"]
fn a_powertrain_without_a_sensor_is_found_and_the_model_with_it_compiles() {
    let folder = tempfile::tempdir().expect("a folder");
    let (campaign, out) = (folder.path().join("campaign"), folder.path().join("out"));
    let truth = [
        ("m_pwt", 70.0),
        ("k_pwt_z", 280e3),
        ("c_pwt_z", 500.0),
        ("k_pwt_x", 3e5),
        ("c_pwt_x", 400.0),
    ];
    let hidden = Hidden::new("suspended_mass", "body", &truth);
    let order = Order {
        programme: Programme::fast(),
        cleats: false,
        effects: vec![hidden],
        ..Order::clean("c", 22)
    };
    make(order, &campaign).expect("a campaign");

    let answer = discover(&campaign, Some(&out));
    assert_eq!(answer["verdict"], "found", "{answer}");
    assert_eq!(answer["effects"][0]["name"], "suspended_mass");
    assert_eq!(answer["effects"][0]["at"], "body");
    assert_near(&answer, &truth[..3]);
    let gap = |role: &str, when: &str| answer["gap"][role][when].as_f64().expect("a number");
    assert!(
        gap("held_out", "before") > 10.0 && gap("held_out", "after") < 1.5,
        "{answer}"
    );
    let model = answer["model_file"].as_str().expect("a file");
    qcar::catalogue::compiled(model).unwrap_or_else(|failure| panic!("{failure:?}"));
}

/// The distance of the axles scales the pitch angle alone, which nothing shows: it stays what it is given as.
#[test]
fn what_is_known_of_an_effect_is_not_estimated() {
    let folder = tempfile::tempdir().expect("a folder");
    let campaign = folder.path().join("campaign");
    let truth = [
        ("wheelbase", 2.7),
        ("dynamic_index", 0.8),
        ("k_wheel_z_other", 24e3),
        ("c_wheel_z_other", 1500.0),
    ];
    let order = Order {
        programme: two_short_sweeps(),
        cleats: false,
        effects: vec![Hidden::new("apparent_mass", "body", &truth)],
        ..Order::clean("c", 25)
    };
    make(order, &campaign).expect("a campaign");
    let answer = discover(&campaign, None);
    assert_eq!(answer["effects"][0]["name"], "apparent_mass", "{answer}");
    assert_eq!(answer["effects"][0]["parameters"]["wheelbase"], 2.7);
    assert_eq!(answer["effects"][0]["stderr"]["wheelbase"], 0.0);
    assert_near(&answer, &truth);
}

/// All that it changes is less than noise, line by line: only together do the lines tell of it.
#[test]
#[ignore = "a whole search; .ci/run runs it"]
fn a_faint_effect_is_found() {
    let folder = tempfile::tempdir().expect("a folder");
    let campaign = folder.path().join("campaign");
    let truth = [("k_maxwell", 120e3), ("relaxation_frequency", 8.0)];
    let order = Order {
        cleats: false,
        noise: 0.12,
        effects: vec![Hidden::new("bushing_relaxation", "top_mount", &truth)],
        ..Order::clean("c", 1030)
    };
    make(order, &campaign).expect("a campaign");
    let answer = discover(&campaign, None);
    for role in ["fit", "held_out"] {
        let before = answer["gap"][role]["before"].as_f64();
        assert!(before.is_some_and(|gap| gap < 1.2), "{role}: {before:?}");
    }
    are_at_the_mount(
        &answer,
        "top_mount",
        "class",
        &["bushing_relaxation", "hydraulic_mount"],
    );
}

/// The rig sees nothing of its longitudinal mounts, so that a first look at the rig must not move them.
#[test]
#[ignore = "a whole search; .ci/run runs it"]
fn a_light_mass_on_mounts_is_found_in_sweeps_and_rides_together() {
    let folder = tempfile::tempdir().expect("a folder");
    let campaign = folder.path().join("campaign");
    let truth = [
        ("m_pwt", 25.0),
        ("k_pwt_z", 90e3),
        ("c_pwt_z", 300.0),
        ("k_pwt_x", 100e3),
        ("c_pwt_x", 300.0),
    ];
    let order = Order {
        programme: Programme::fast(),
        effects: vec![Hidden::new("suspended_mass", "body", &truth)],
        ..Order::clean("a", 1004)
    };
    make(order, &campaign).expect("a campaign");
    let answer = discover(&campaign, None);
    assert_eq!(answer["verdict"], "found", "{answer}");
    assert_eq!(answer["effects"][0]["name"], "suspended_mass");
    assert_near(&answer, &truth);
}

/// The mass alone fits with a mount more than twice too stiff. From there, the fluid of the mount has a first-order gain
/// below the threshold of the screening.
#[test]
#[ignore = "a whole search; .ci/run runs it"]
fn a_second_effect_is_found_where_the_parameters_beside_the_first_are_far_off() {
    let mass = [
        ("m_pwt", 51.4),
        ("k_pwt_z", 228e3),
        ("c_pwt_z", 603.0),
        ("k_pwt_x", 245e3),
        ("c_pwt_x", 472.0),
    ];
    let mount = [("k_volume", 300e3), ("inertance", 59.5), ("c_track", 535.0)];
    let mut programme = two_short_sweeps();
    programme.cleats.truncate(2);
    let [mount, mass] = found_in_pair(
        102_300,
        programme,
        [
            Hidden::new("suspended_mass", "body", &mass),
            Hidden::new("hydraulic_mount", "powertrain_mount", &mount),
        ],
    );
    assert_eq!([&mount["name"], &mount["at"]], ["hydraulic_mount", "powertrain_mount"]);
    assert_eq!([&mass["name"], &mass["at"]], ["suspended_mass", "body"]);
}

/// Alone, the resonator fits better with a soft mount fore and aft. Beside the mass above the other axle, which it
/// hides, it moves with the wheel.
#[test]
#[ignore = "a whole search; .ci/run runs it"]
fn the_form_of_an_effect_is_chosen_again_beside_another() {
    let resonator = [("m_resonator", 5.2), ("k_resonator", 65e3), ("zeta_resonator", 0.0305)];
    let other_axle = [
        ("wheelbase", 2.7),
        ("dynamic_index", 0.63),
        ("k_wheel_z_other", 27.7e3),
        ("c_wheel_z_other", 1690.0),
    ];
    let [other, resonator] = found_in_pair(
        102_307,
        Programme::fast(),
        [
            Hidden::new("secondary_resonator", "wheel", &resonator),
            Hidden::new("apparent_mass", "body", &other_axle),
        ],
    );
    assert_eq!(other["name"], "apparent_mass");
    assert_eq!(resonator["name"], "secondary_resonator");
    assert_eq!(resonator["form"], "vertical");
}

/// The cleat runs that are held out show the friction and do not reach the stop, which only the K&C curves do.
#[test]
#[ignore = "a whole search; .ci/run runs it"]
fn a_stop_that_only_fitted_runs_reach_is_found_beside_a_friction_that_all_runs_show() {
    let friction = [("f_coulomb", 70.0), ("k_presliding", 700e3)];
    let stop = [("gap", 0.05), ("k_stop", 60e3)];
    let [stop, friction] = found_in_pair(
        13,
        Programme::fast(),
        [
            Hidden::new("coulomb_friction", "damper", &friction),
            Hidden::new("bump_stop", "spring", &stop),
        ],
    );
    assert_eq!([&stop["name"], &stop["at"]], ["bump_stop", "spring"]);
    assert_eq!([&friction["name"], &friction["at"]], ["coulomb_friction", "damper"]);
}

/// With the play alone, the fitted stiffness of the powertrain's mount is 50 % too high. From there, the fit with the
/// fluid in the mount ends in a local minimum; from the given values it does not.
#[test]
#[ignore = "a whole search; .ci/run runs it"]
fn a_fluid_in_a_mount_is_found_beside_the_free_play_of_a_damper() {
    let case = of_case(151, "free_play@damper and hydraulic_mount@powertrain_mount 3 seed 151");
    let [play, mount] = two_named(Order {
        programme: Programme::fast(),
        ..case
    });
    assert_eq!([&play["name"], &play["at"]], ["free_play", "damper"]);
    assert_eq!([&mount["name"], &mount["at"]], ["hydraulic_mount", "powertrain_mount"]);
}

/// The damper alone leaves no more than noise in the held-out runs, but the drag makes them more probable by the odds.
/// This short campaign cannot tell it from sliding friction.
#[test]
#[ignore = "a whole search; .ci/run runs it"]
fn a_small_effect_that_all_runs_show_together_is_found_beside_a_large_one() {
    let case = of_case(151, "drag_to_ground@wheel and asymmetric_damper@damper 5 seed 151");
    let answer = answer_to(Order {
        programme: Programme::fast(),
        ..case
    });
    assert_eq!(answer["verdict"], "class", "{answer}");
    let effects = answer["effects"].as_array().expect("effects");
    let named: Vec<_> = effects.iter().map(|own| [&own["name"], &own["at"]]).collect();
    let expected = [
        ["asymmetric_damper", "damper"],
        ["drag_to_ground", "wheel"],
        ["sliding_friction", "wheel"],
    ];
    assert_eq!(named, expected, "{answer}");
}

/// The two effects that are named, sorted by name, in a campaign with two hidden ones.
fn found_in_pair(seed: u64, programme: Programme, effects: [Hidden; 2]) -> [Value; 2] {
    two_named(Order {
        programme,
        effects: effects.into(),
        ..Order::clean("c", seed)
    })
}

/// The two effects that are named, sorted by name.
fn two_named(order: Order) -> [Value; 2] {
    let answer = answer_to(order);
    assert_eq!(answer["verdict"], "found", "{answer}");
    let mut found = answer["effects"].as_array().expect("a list").clone();
    found.sort_by_key(|own| own["name"].to_string());
    found.try_into().unwrap_or_else(|_| panic!("not two: {answer}"))
}

/// The manifest of such a campaign, changed.
fn edit(folder: &Path, change: impl Fn(&str) -> String) {
    let file = folder.join("campaign.toml");
    let text = fs::read_to_string(&file).expect("it was written");
    fs::write(file, change(&text)).expect("it is there");
}

/// The first run alone.
fn one_run(manifest: &str) -> String {
    manifest.split("[[run]]").take(2).collect::<Vec<_>>().join("[[run]]")
}

/// What is said of a campaign that `discover` refuses.
fn refusal(campaign: &Path) -> String {
    let mut command = Command::new(env!("CARGO_BIN_EXE_qcar"));
    let output = command.arg("discover").arg(campaign).output().expect("qcar runs");
    assert_eq!(output.status.code(), Some(2));
    String::from_utf8(output.stderr).expect("text")
}

/// Uniform numbers by a linear congruence.
pub fn noise() -> impl FnMut() -> f64 {
    let mut state = 11_u64;
    move || {
        state = state
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (state >> 11) as f64 / (1u64 << 53) as f64 - 0.5
    }
}

/// A spring that is far stiffer than its sample rate follows gives no number: that is no answer.
#[test]
fn a_model_that_gives_no_number_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let model = folder.path().join("stiff.axle");
    let text = "axle stiff {
    \"A drive with a spring that no step follows\"
    param m_body: kg = 100 in 0.1..1e5 \"Mass\";
    param c_body: N s/m = 200 in 0.01..1e6 \"Drag\";
    known param f_offset: N = 0 in -1e4..1e4 \"Offset\";
    direction x {
        mass body = m_body;
        force motor on body;
        link damper: body {
            damper c_body;
            force = f_offset + (1e15 N/m) * s;
        }
        output body.position;
    }
}
";
    fs::write(&model, text).expect("a model file");
    let campaign = Path::new(env!("CARGO_MANIFEST_DIR")).join("models/campaigns/emps");
    let mut command = Command::new(env!("CARGO_BIN_EXE_qcar"));
    let output = command
        .arg("discover")
        .arg(campaign)
        .arg("--model")
        .arg(&model)
        .output();
    let output = output.expect("qcar runs");
    assert_eq!(
        output.status.code(),
        Some(2),
        "{}",
        String::from_utf8_lossy(&output.stdout)
    );
    let words = String::from_utf8_lossy(&output.stderr);
    assert!(words.contains("no finite response"), "{words}");
}

#[test]
fn pure_noise_says_nothing() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut noise = noise();
    swept(folder.path(), &mut |_, _| noise());
    let refusal = refusal(folder.path());
    assert!(
        refusal.contains("nothing but noise") && refusal.contains("no run that says anything"),
        "{refusal}"
    );
}

/// A sensor that is dead is left out, and nothing is made up to explain it.
#[test]
fn a_sensor_that_shows_noise_is_left_out() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut noise = noise();
    swept(folder.path(), &mut |name, value| {
        if name.starts_with("body") { noise() } else { value }
    });
    edit(folder.path(), one_run);
    let answer = discover(folder.path(), None);
    assert_eq!(answer["verdict"], "none", "{answer}");
    let notices = answer["notices"].to_string();
    assert!(notices.contains("`body` shows nothing but noise"), "{notices}");
}

#[test]
fn one_run_alone_and_none_held_out_are_enough_for_an_answer() {
    let folder = tempfile::tempdir().expect("a folder");
    swept(folder.path(), &mut |_, value| value);
    edit(folder.path(), one_run);
    lacks_nothing_and_holds_out_nothing(folder.path());
    edit(folder.path(), |text| text.replace("\"fit\"", "\"held_out\""));
    assert!(refusal(folder.path()).contains("no run may be fitted"));
}

#[test]
#[ignore = "a whole search; .ci/run runs it"]
fn several_runs_and_none_held_out_are_enough_for_an_answer() {
    let folder = tempfile::tempdir().expect("a folder");
    swept(folder.path(), &mut |_, value| value);
    edit(folder.path(), |text| text.replace("\"held_out\"", "\"fit\""));
    lacks_nothing_and_holds_out_nothing(folder.path());
}

fn lacks_nothing_and_holds_out_nothing(campaign: &Path) {
    let answer = discover(campaign, None);
    assert_eq!(answer["verdict"], "none", "{answer}");
    assert_eq!(answer["gap"]["held_out"]["before"], Value::Null);
}

/// The left wheel's sensor shows three times what the right one does, so that their mean is twice what the wheel did.
#[test]
#[ignore = "a whole search; .ci/run runs it"]
fn sensors_that_contradict_each_other_are_no_effect_of_the_axle() {
    let folder = tempfile::tempdir().expect("a folder");
    swept(folder.path(), &mut |name, value| {
        if name == "wheel_left_z" { 3.0 * value } else { value }
    });
    let answer = discover(folder.path(), None);
    assert_eq!(answer["verdict"], "found", "{answer}");
    assert_eq!(answer["effects"].as_array().map(Vec::len), Some(1));
    assert_eq!(
        [&answer["effects"][0]["name"], &answer["effects"][0]["at"]],
        ["sensor_gain", "wheel"]
    );
    assert_near(&answer, &[("gain", 2.0)]);
    let best = &answer["places"][0];
    assert_eq!(
        [&best["at"], &best["sensor"], &best["shape"]],
        ["wheel", "z", "gain"],
        "{best}"
    );
}

/// Nobody can say whether the wheel's sensor shows too much or the pad's too little.
#[test]
fn two_sensors_of_which_one_is_wrong_are_a_class() {
    let answer = answer_of(&two_sensors());
    assert_eq!(answer["verdict"], "class", "{answer}");
    let effects = answer["effects"].as_array().expect("effects");
    let text = |value: &Value| value.as_str().expect("a text").to_owned();
    let mut members: Vec<_> = effects
        .iter()
        .map(|own| (text(&own["name"]), text(&own["at"])))
        .collect();
    members.sort();
    assert_eq!(
        members,
        ["pad", "wheel"].map(|at| ("sensor_gain".to_owned(), at.to_owned()))
    );
    for effect in effects {
        assert_eq!(effect["one_of"], true, "{effect}");
        let mut rivals = effect["rivals"].as_array().expect("rivals").iter();
        assert!(rivals.all(|rival| rival["effect"] != "sensor_gain"), "{effect}");
    }
    assert_eq!(answer["model_file"], Value::Null);
}

/// A sweep passes its frequencies one after the other, so that what fades while it runs looks like what depends on
/// frequency.
#[test]
#[ignore = "a whole search; .ci/run runs it"]
fn a_damper_that_fades_gets_a_law_over_the_run() {
    let folder = tempfile::tempdir().expect("a folder");
    let campaign = folder.path().join("campaign");
    let order = Order {
        cleats: false,
        effects: vec![Hidden::new("damper_fade", "damper", &[("share", 0.4)])],
        ..Order::clean("c", 1031)
    };
    make(order, &campaign).expect("a campaign");
    let answer = discover(&campaign, None);
    assert_eq!(answer["verdict"], "unknown", "{answer}");
    let learned = &answer["learned"];
    assert_eq!(learned["at"], "damper", "{learned}");
    assert!(learned["explained"].as_f64() > Some(0.8), "{learned}");
    // Every sweep takes 42.25 s, so a law over seconds and one over the part of the run can say the same. The beginning
    // is left out: below the body's resonance the damper hardly counts.
    let law = &learned["laws"][0];
    let hidden = |time: f64| 1.0 - 0.4 * time / 42.25;
    let (middle, expected) = match law["name"].as_str() {
        Some("time_law") => ("to_medium", hidden(30.0) / hidden(10.0)),
        Some("run_law") => ("to_two_thirds", hidden(28.2) / hidden(14.1)),
        other => panic!("a law over time, not {other:?}"),
    };
    let found = law["parameters"][middle].as_f64().expect("its middle");
    assert!((found / expected - 1.0).abs() < 0.05, "{found} for {expected}");
    let words = law["words"].as_str().expect("a sentence");
    assert!(
        words.starts_with("it changes from 1 at the start of a run to"),
        "{words}"
    );
    assert!(!words.contains("after 100"), "no run takes so long: {words}");
}

/// A damper that depends on its travel, which the catalogue has in no form: nothing is named, and a law is learned that
/// stands for it.
#[test]
fn a_law_is_learned_where_the_catalogue_has_none() {
    let folder = tempfile::tempdir().expect("a folder");
    let (campaign, out) = (folder.path().join("campaign"), folder.path().join("out"));
    let hidden = Hidden::new("position_damper", "damper", &[("travel", 0.01)]);
    make(short_sweeps("c", 4711, vec![hidden]), &campaign).expect("a campaign");
    let answer = discover(&campaign, Some(&out));
    assert_eq!(answer["verdict"], "unknown", "{answer}");
    let learned = &answer["learned"];
    assert_eq!(learned["at"], "damper", "{learned}");
    assert!(learned["explained"].as_f64() > Some(0.8), "{learned}");
    let words = learned["laws"][0]["words"].as_str().expect("a sentence");
    assert!(
        words.starts_with("over the travel it changes from 1 at rest to "),
        "{words}"
    );
    // The effect file applies to the model of the campaign as any other does, and the model with it compiles.
    let effect = learned["laws"][0]["effect_file"].as_str().expect("a file");
    let model = learned["model_file"].as_str().expect("a file");
    for arguments in [&["patch", "axle_c", effect, "--at", "damper"][..], &["check", model]] {
        let output = Command::new(env!("CARGO_BIN_EXE_qcar")).args(arguments).output();
        let output = output.expect("qcar runs");
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    }
}

/// A cubic term, where the catalogue's forms are exponential or begin beyond a linear travel.
#[test]
#[ignore = "a whole search; .ci/run runs it"]
fn a_top_mount_that_stiffens_is_named() {
    let hidden = Hidden::new("cubic_top_mount", "top_mount", &[("k3", 1e12)]);
    let answer = of_short_sweeps("c", 4711, hidden);
    assert_eq!(answer["verdict"], "found", "{answer}");
    let named = answer["effects"].as_array().expect("effects");
    assert_eq!(named.len(), 1, "{answer}");
    assert_eq!(
        [&named[0]["name"], &named[0]["at"]],
        ["bushing_saturation", "top_mount"]
    );
    assert!(named[0]["evidence"]["gap_closed"].as_f64() > Some(0.95), "{answer}");
}

/// Its natural frequency grows with the level, so that a resonator with a constant stiffness explains only a part of it.
#[test]
#[ignore = "a whole search; .ci/run runs it"]
fn a_resonator_on_a_hardening_spring_is_named() {
    let truth = [
        ("m_resonator", 5.0),
        ("k_resonator", 22e3),
        ("zeta_resonator", 0.0528),
        ("k3", 3e9),
    ];
    let answer = of_short_sweeps("c", 4712, Hidden::new("cubic_resonator", "wheel", &truth));
    assert_eq!(answer["verdict"], "found", "{answer}");
    let named = answer["effects"].as_array().expect("effects");
    assert_eq!(named.len(), 1, "{answer}");
    let own = &named[0];
    assert_eq!([&own["name"], &own["at"]], ["secondary_resonator", "wheel"]);
    assert_eq!(own["form"], "hardening");
}

/// The answer to short sweeps and K&C curves of an axle with an effect.
fn of_short_sweeps(axle: &str, seed: u64, effect: Hidden) -> Value {
    answer_to(short_sweeps(axle, seed, vec![effect]))
}

/// A campaign of short sweeps and K&C curves.
fn short_sweeps(axle: &str, seed: u64, effects: Vec<Hidden>) -> Order {
    Order {
        cleats: false,
        programme: two_short_sweeps(),
        effects,
        ..Order::clean(axle, seed)
    }
}

/// The answer to a case of the blind matrix.
fn of_matrix(seed: u64, name: &str) -> Value {
    answer_to(of_case(seed, name))
}

fn of_case(seed: u64, name: &str) -> Order {
    let case = cases(seed).into_iter().find(|case| case.name == name);
    case.expect("a case of the matrix").order
}

fn answer_to(order: Order) -> Value {
    let folder = tempfile::tempdir().expect("a folder");
    let campaign = folder.path().join("campaign");
    make(order, &campaign).expect("a campaign");
    discover(&campaign, None)
}

/// Cleat runs alone, whose base fit ends far off with the tyre at its bound: no candidate gains anything to first order
/// there.
#[test]
#[ignore = "a whole search; .ci/run runs it"]
fn a_mass_is_found_from_the_start_values_where_the_base_fit_is_far_off() {
    let answer = of_matrix(51, "cleats alone: suspended_mass@subframe 18 seed 51");
    assert_eq!(answer["verdict"], "found", "{answer}");
    assert_eq!(answer["effects"][0]["name"], "suspended_mass", "{answer}");
    assert_eq!(answer["effects"][0]["at"], "subframe", "{answer}");
    assert!(answer["gap"]["held_out"]["after"].as_f64() < Some(1.1), "{answer}");
}

/// Every sensor's gain changes by 4 % over the band, with the phase that belongs to it. With curves held to the 1 % of
/// data sheets, a sub-frame and a hydraulic mount are named with certainty.
#[test]
#[ignore = "a whole search; .ci/run runs it"]
fn inaccurate_sensors_are_no_effect_and_a_notice_says_so() {
    let answer = answer_to(with_three_sweeps(of_case(85, "hardware a3 Calibration alone seed 85")));
    assert_eq!(answer["verdict"], "none", "{answer}");
    let notices = answer["notices"].to_string();
    assert!(
        notices.contains("the gains of the sensors seem to change by"),
        "{notices}"
    );
}

/// Calibration curves of another form than the model's leave no more than noise. A compliant damper end beside them
/// gains 3.2 in log evidence, which other ranges of the effects had made 8.5. It takes cleat runs: without them, a class of
/// two effects is named whether probabilities are bagged or not. That resampling decides is a test of `probability.rs`.
#[test]
#[ignore = "a whole search; .ci/run runs it"]
fn no_effect_is_named_for_calibration_curves_of_another_form() {
    let answer = of_matrix(101, "hardware d3 Calibration alone seed 101");
    assert_eq!(answer["effects"], Value::Array(Vec::new()), "{answer}");
}

/// The tyre rolls over a tandem of cams. Dynamic stiffness of the tyre explains most of that with its relaxation
/// frequency and the tyre's damping at the ends of their ranges. Short rides do not show it.
#[test]
#[ignore = "a whole search; .ci/run runs it"]
fn an_effect_that_takes_the_place_of_a_parameter_is_no_answer() {
    let answer = of_matrix(102, "hardware a9 Tyre alone seed 102");
    assert_eq!(answer["verdict"], "unknown", "{answer}");
}

/// With all flaws of the hardware together, a resonator on the wheel is more probable than nothing by far. But all of that
/// comes from the cleat runs along x, where the tyre obeys another law than the model's, and the sensors would have to
/// be wrong by 11 %.
#[test]
#[ignore = "a whole search; .ci/run runs it"]
fn an_effect_that_only_the_tyre_along_one_axis_shows_is_no_answer() {
    let answer = of_matrix(103, "hardware d25 together fast seed 103");
    assert_eq!(answer["verdict"], "unknown", "{answer}");
}

/// The curves of such sensors can imitate much of a drag on the body. It is named, since it is judged with the sensors
/// that it needs. Three sweeps of 20 s show it.
#[test]
#[ignore = "a whole search; .ci/run runs it"]
fn an_effect_that_inaccurate_sensors_could_imitate_is_found() {
    let answer = answer_to(with_three_sweeps(of_case(82, "hardware drag_to_ground@body seed 82")));
    assert_eq!(answer["verdict"], "found", "{answer}");
    assert_eq!(answer["effects"][0]["name"], "drag_to_ground", "{answer}");
    assert_eq!(answer["effects"][0]["at"], "body", "{answer}");
}

/// On hardware with flaws, a learned law has a larger evidence than a relaxing bushing and a hydraulic mount, which
/// explain as much of the residual. Resampled data do not bear that out, so the two stay the answer. Three sweeps of 20
/// s show it.
#[test]
#[ignore = "a whole search; .ci/run runs it"]
fn a_law_takes_the_place_of_names_only_if_resampled_data_prefer_it() {
    let answer = answer_to(with_three_sweeps(bushing_on_hardware()));
    are_at_the_mount(
        &answer,
        "powertrain_mount",
        "class",
        &["bushing_relaxation", "hydraulic_mount"],
    );
}

/// A model without effects takes the sensors for 16 times as inaccurate as data sheets say, and then predicts the
/// held-out runs as well as the relaxing bushing. With the same sensors it does not, which two short sweeps show.
#[test]
fn a_base_model_is_compared_with_the_same_sensors() {
    let answer = answer_to(Order {
        cleats: false,
        programme: two_short_sweeps(),
        ..of_case(99, "hardware bushing_relaxation@top_mount seed 99")
    });
    assert_eq!(answer["effects"][0]["name"], "bushing_relaxation", "{answer}");
    // With sensors of its own, the base model leaves 1.0.
    assert!(answer["gap"]["held_out"]["before"].as_f64() > Some(3.0), "{answer}");
}

/// The whole campaign of the test above, where such sensors would dismiss the effect.
#[test]
#[ignore = "a whole search; .ci/run runs it"]
fn inaccurate_sensors_of_the_base_model_do_not_dismiss_an_effect() {
    let answer = of_matrix(99, "hardware bushing_relaxation@top_mount seed 99");
    are_at_the_mount(
        &answer,
        "top_mount",
        "class",
        &["bushing_relaxation", "hydraulic_mount"],
    );
}

/// Without the body's bending, a hydraulic mount explains more of the residuals than the compliant end of the damper.
#[test]
#[ignore = "a whole search; .ci/run runs it"]
fn an_effect_that_the_bending_of_the_body_hides_is_found() {
    let hidden = of_case(99, "hardware series_compliance@damper seed 99");
    let answer = answer_to(with_three_sweeps(hidden));
    assert_eq!(answer["verdict"], "found", "{answer}");
    assert_eq!(answer["effects"][0]["name"], "series_compliance", "{answer}");
    assert_eq!(answer["nuisances"][0]["name"], "body_bending", "{answer}");
}

/// The campaign with three sweeps of 20 s instead of all its sweeps and cleat runs.
fn with_three_sweeps(order: Order) -> Order {
    let mut programme = Programme::full();
    programme.sweeps.retain(|sweep| [25, 50, 100].contains(&sweep.level));
    programme.sweeps.iter_mut().for_each(|sweep| sweep.seconds = 20.0);
    Order {
        programme,
        cleats: false,
        ..order
    }
}

/// The whole campaign too: a law at the same place that explains little more replaces neither of them. The bushing,
/// which is what is hidden, comes first. The test with three sweeps is
/// `a_law_takes_the_place_of_names_only_if_resampled_data_prefer_it`.
#[test]
#[ignore = "a whole search; .ci/run runs it"]
fn names_stand_where_a_law_at_their_place_explains_little_more() {
    let answer = answer_to(bushing_on_hardware());
    are_at_the_mount(
        &answer,
        "powertrain_mount",
        "class",
        &["bushing_relaxation", "hydraulic_mount"],
    );
    assert_eq!(answer["candidates"][0]["effect"], "bushing_relaxation", "{answer}");
}

/// A relaxing bushing at the powertrain's mount, on hardware with flaws.
fn bushing_on_hardware() -> Order {
    of_case(61, "hardware bushing_relaxation@powertrain_mount seed 61")
}

/// Asserts the verdict and the effects, all at the powertrain's mount.
fn are_at_the_mount(answer: &Value, mount: &str, verdict: &str, expected: &[&str]) {
    assert_eq!(answer["verdict"], verdict, "{answer}");
    let effects = answer["effects"].as_array().expect("effects");
    let mut names: Vec<&str> = effects.iter().filter_map(|own| own["name"].as_str()).collect();
    names.sort_unstable();
    assert_eq!(names, expected, "{answer}");
    assert!(effects.iter().all(|own| own["at"] == mount), "{answer}");
}

/// The rubber of a powertrain's mount sticks and slips, in another form than the catalogue's.
#[test]
#[ignore = "a whole search; .ci/run runs it"]
fn friction_within_the_rubber_of_a_mount_is_found() {
    let answer = of_short_sweeps("a", 4714, slipping_rubber());
    are_at_the_mount(&answer, "powertrain_mount", "found", &["bushing_friction"]);
    let explained = answer["effects"][0]["evidence"]["gap_closed"].as_f64();
    assert!(explained > Some(0.9), "{answer}");
}

/// Without the powertrain and the friction of its mounts the model is far off, and a sub-frame of 50 kg, the end of its
/// range, seems as good as the powertrain. The search from the least-squares fit tells them apart.
#[test]
#[ignore = "a whole search; .ci/run runs it"]
fn a_powertrain_on_mounts_with_friction_is_found() {
    let powertrain = [
        ("m_pwt", 68.0),
        ("k_pwt_z", 190e3),
        ("c_pwt_z", 420.0),
        ("k_pwt_x", 320e3),
        ("c_pwt_x", 650.0),
    ];
    let hidden = vec![Hidden::new("suspended_mass", "body", &powertrain), slipping_rubber()];
    let answer = answer_to(short_sweeps("c", 4715, hidden));
    assert_eq!(answer["verdict"], "found", "{answer}");
    let effects = answer["effects"].as_array().expect("effects");
    let found: Vec<_> = effects.iter().map(|own| [&own["name"], &own["at"]]).collect();
    let hidden = [["suspended_mass", "body"], ["bushing_friction", "powertrain_mount"]];
    assert_eq!(found, hidden, "{answer}");
}

fn slipping_rubber() -> Hidden {
    let slips = [("f_slip", 60.0), ("k_stick", 200e3)];
    Hidden::new("rubber_slip", "powertrain_mount", &slips)
}

/// The stop acts over the last 12 mm of the K&C curve, far beyond the travel of the sweeps.
#[test]
#[ignore = "a whole search; .ci/run runs it"]
fn a_stop_at_the_end_of_a_kc_curve_is_found() {
    let stop = [("gap", 0.068), ("k_stop", 200e3)];
    let answer = of_short_sweeps("a", 1041, Hidden::new("bump_stop", "spring", &stop));
    assert_eq!(answer["verdict"], "found", "{answer}");
    assert_eq!(answer["effects"][0]["name"], "bump_stop", "{answer}");
    assert_eq!(answer["effects"][0]["at"], "spring", "{answer}");
    assert_near(&answer, &stop);
}

/// The held-out runs do not reach the stop, so they do not judge it, although the pad's distortion leaves 1.25 standard
/// deviations there. A fit to a large discrepancy ends with a gap that is 3 mm too large, five standard errors.
#[test]
#[ignore = "a whole search; .ci/run runs it"]
fn a_stop_that_only_the_kc_curve_reaches_is_estimated_well() {
    let stop = [("gap", 0.045), ("k_stop", 120e3)];
    let answer = answer_to(Order {
        programme: Programme::fast(),
        effects: vec![Hidden::new("bump_stop", "spring", &stop)],
        flaws: vec![Flaw::Pad],
        ..Order::clean("c", 5)
    });
    assert_eq!(answer["verdict"], "found", "{answer}");
    assert_eq!(answer["partly_explained"], false, "{answer}");
    let effect = &answer["effects"][0];
    assert_eq!([&effect["name"], &effect["at"]], ["bump_stop", "spring"], "{answer}");
    for (name, truth) in stop {
        let [value, error] = ["parameters", "stderr"].map(|key| effect[key][name].as_f64().unwrap());
        assert!(
            (value - truth).abs() < 3.0 * error,
            "{name}: {value} ± {error}, not {truth}"
        );
    }
}

/// K&C curves reach three times the travel of the sweeps. The rate of this spring is 1.7 times that at rest at the end
/// of the sweeps, and 19 times at the end of the K&C curves. A second bounce curve judges.
#[test]
#[ignore = "a whole search; .ci/run runs it"]
fn a_spring_that_grows_exponentially_is_named_by_kc_curves() {
    let folder = tempfile::tempdir().expect("a folder");
    let campaign = folder.path().join("campaign");
    let order = Order {
        cleats: false,
        programme: two_short_sweeps(),
        ..hardening_spring()
    };
    make(order, &campaign).expect("a campaign");
    fs::copy(campaign.join("kc/bounce.csv"), campaign.join("kc/again.csv")).expect("a curve");
    edit(&campaign, |text| {
        let judge = "[[run]]\nkind = \"bounce\"\nfile = \"kc/again.csv\"\nrole = \"held_out\"\n";
        format!("{text}\n{judge}")
    });
    is_exponential_spring(&discover(&campaign, None));
}

#[test]
#[ignore = "a whole search; .ci/run runs it"]
fn a_spring_that_grows_exponentially_is_named_in_a_whole_campaign() {
    is_exponential_spring(&answer_to(hardening_spring()));
}

fn hardening_spring() -> Order {
    of_case(61, "sinh_spring@spring 0 seed 61")
}

fn is_exponential_spring(answer: &Value) {
    assert_eq!(answer["verdict"], "found", "{answer}");
    assert_eq!(answer["effects"].as_array().map(Vec::len), Some(1), "{answer}");
    let effect = &answer["effects"][0];
    let [name, form] = ["name", "form"].map(|of| effect[of].as_str().expect("a name"));
    assert_eq!((name, form), ("progressive_spring", "exponential"), "{answer}");
}

/// A stop with a check valve damps in one direction of travel: the law of the damper says where it acts, and on which
/// stroke.
#[test]
#[ignore = "a whole search; .ci/run runs it"]
fn a_law_of_the_travel_knows_a_check_valve() {
    let stop = [("gap", 0.006), ("c_per_metre", 600e3)];
    let answer = of_short_sweeps("a", 4713, Hidden::new("hydraulic_stop", "damper", &stop));
    assert_eq!(answer["verdict"], "unknown", "{answer}");
    let learned = &answer["learned"];
    assert_eq!(learned["laws"][0]["name"], "position_damping_law", "{learned}");
    assert_eq!(learned["at"], "damper", "{learned}");
    assert!(learned["explained"].as_f64() > Some(0.8), "{learned}");
    let returning = learned["laws"][0]["parameters"]["return_share"].as_f64();
    assert!(returning < Some(0.2), "{learned}");
    let words = learned["laws"][0]["words"].as_str().expect("a sentence");
    assert!(words.contains("return_share = "), "{words}");
}

/// A drag that grows with the square of the speed: the catalogue's linear one is certain and closes little of the gap.
#[test]
#[ignore = "a whole search; .ci/run runs it"]
fn a_law_is_learned_between_a_mass_and_the_ground() {
    let answer = of_short_sweeps("c", 4712, Hidden::new("quadratic_drag", "body", &[("c2", 2500.0)]));
    assert_eq!(answer["verdict"], "unknown", "{answer}");
    let learned = &answer["learned"];
    assert_eq!(learned["laws"][0]["name"], "drag_law", "{learned}");
    assert_eq!(learned["at"], "body", "{learned}");
    assert!(learned["explained"].as_f64() > Some(0.8), "{learned}");
}

/// What a search assumes that no data give decides no answer: with all numbers 30 % less, it stays the same.
#[test]
fn no_answer_hangs_on_a_number() {
    let (order, usual) = &*CLEAN;
    let all_low = screening().pop().expect("the last way");
    stays(order, usual, &[all_low]);
}

/// The same in eight ways, 30 % more or less, in which each two numbers meet in every combination.
#[test]
#[ignore = "nine searches; .ci/run runs it"]
fn no_answer_hangs_on_a_number_in_any_combination() {
    let mount = [("k_maxwell", 250e3), ("relaxation_frequency", 10.0)];
    let hidden = vec![Hidden::new("bushing_relaxation", "top_mount", &mount)];
    hangs_on_no_number(2002, hidden, &screening());
}

#[test]
#[ignore = "18 searches like those of the test above; .ci/run runs it"]
fn no_answer_to_other_campaigns_hangs_on_a_number() {
    let friction = [("f_coulomb", 60.0), ("k_presliding", 600e3)];
    hangs_on_no_number(2000, vec![], &screening());
    hangs_on_no_number(
        2001,
        vec![Hidden::new("coulomb_friction", "damper", &friction)],
        &screening(),
    );
}

fn hangs_on_no_number(seed: u64, effects: Vec<Hidden>, ways: &[String]) {
    let order = short_sweeps("c", seed, effects);
    stays(&order, &answer_to(order.clone()), ways);
}

/// Asserts that an answer is also given with these numbers assumed.
fn stays(order: &Order, usual: &Value, ways: &[String]) {
    let folder = tempfile::tempdir().expect("a folder");
    let campaign = folder.path().join("campaign");
    make(order.clone(), &campaign).expect("a campaign");
    for assumed in ways {
        let other = names(&discover_with(&campaign, &["--assume", assumed]));
        assert_eq!(
            other,
            names(usual),
            "the campaign of seed {} with {assumed}",
            order.seed
        );
    }
}

/// Of the fast programme the two harder sweeps, cut to eight seconds: one is fitted, one judges.
fn two_short_sweeps() -> Programme {
    let mut programme = Programme::fast();
    programme.sweeps.remove(0);
    programme.sweeps[0].role = "held_out";
    programme.sweeps.iter_mut().for_each(|sweep| sweep.seconds = 8.0);
    programme
}

/// The screening design of Plackett and Burman (Biometrika 33, 1946) for seven factors: seven turns of a row, and all
/// of them low.
fn screening() -> Vec<String> {
    const ROW: [f64; Numbers::NAMES.len()] = [1.3, 1.3, 1.3, 0.7, 1.3, 0.7, 0.7];
    let assumed = |factors: &[f64]| {
        let parts = Numbers::NAMES.iter().zip(factors);
        let parts: Vec<String> = parts.map(|(name, factor)| format!("{name}={factor}")).collect();
        parts.join(",")
    };
    let turned = |by: usize| {
        let mut row = ROW;
        row.rotate_right(by);
        assumed(&row)
    };
    (0..ROW.len()).map(turned).chain([assumed(&[0.7; ROW.len()])]).collect()
}

/// The verdict, and the effects that are given a name.
fn names(answer: &Value) -> (Value, Vec<(Value, Value)>) {
    let effects = answer["effects"].as_array().cloned().unwrap_or_default();
    let name = |own: &Value| (own["name"].clone(), own["at"].clone());
    (answer["verdict"].clone(), effects.iter().map(name).collect())
}

/// A mass on a spring and a damper under a force of three sines, whose record was wired the wrong way round.
#[test]
fn a_force_that_was_recorded_upside_down_is_named() {
    let folder = tempfile::tempdir().expect("a folder");
    write_held("acceleration", folder.path());
    let answer = discover(folder.path(), None);
    assert_eq!(answer["verdict"], "found", "{answer}");
    assert_eq!(names(&answer).1, [("input_gain".into(), "motor".into())], "{answer}");
    let effect = &answer["effects"][0];
    let [gain, error] = ["parameters", "stderr"].map(|of| effect[of]["input_gain"].as_f64().expect("a number"));
    assert!((gain + 1.0).abs() < 3.0 * error && error < 0.02, "{gain} ± {error}");
}

#[test]
fn an_output_that_the_model_lacks_is_named_with_its_quantity() {
    let folder = tempfile::tempdir().expect("a folder");
    write_held("position", folder.path());
    let mut command = Command::new(env!("CARGO_BIN_EXE_qcar"));
    let output = command.arg("discover").arg(folder.path()).output().expect("qcar runs");
    let told = String::from_utf8_lossy(&output.stderr);
    assert!(!output.status.success(), "{told}");
    assert!(
        told.contains("add `output body.acceleration;`"),
        "it names what was measured: {told}"
    );
}

/// A campaign with the acceleration of a held mass, and a model of it that outputs a quantity.
fn write_held(quantity: &str, folder: &Path) {
    let model = "axle held {
    \"A mass held by a spring and a damper\"
    known param m_body: kg = 2 in 0.1..100 \"Mass\";
    param k_body: N/m = 700 in 50..5000 \"Stiffness\";
    param c_body: N s/m = 7 in 0.5..100 \"Damping\";
    direction z {
        mass body = m_body;
        force motor on body;
        link held: body { spring k_body; damper c_body; }
        output body.QUANTITY;
    }
}
"
    .replace("QUANTITY", quantity);
    let mut manifest = "format = 1\nname = \"held\"\nmodel = \"held.axle\"\n
[[channel]]\nname = \"force\"\nlocation = \"motor\"\nside = \"centre\"\naxis = \"z\"\nquantity = \"force\"\nunit = \"N\"\n
[[channel]]\nname = \"body\"\nlocation = \"body\"\nside = \"centre\"\naxis = \"z\"\nquantity = \"acceleration\"\nunit = \"m/s^2\"\n
[parameters.k_body]\nvalue = 700.0\nunit = \"N/m\"\nfit = true\nrange = [50.0, 5000.0]\n
[parameters.c_body]\nvalue = 7.0\nunit = \"N s/m\"\nfit = true\nrange = [0.5, 100.0]\n"
        .to_owned();
    let mut noise = noise();
    for (role, phase) in [("fit", 0.0), ("held_out", 1.0)] {
        manifest += &format!(
            "\n[[run]]\nkind = \"time_history\"\nfile = \"{role}.csv\"\nrole = \"{role}\"\nsample_rate = 200.0\nband_limited = true\n"
        );
        fs::write(folder.join(format!("{role}.csv")), upside_down(phase, &mut noise)).expect("a record");
    }
    fs::write(folder.join("held.axle"), model).expect("a model");
    fs::write(folder.join("campaign.toml"), manifest).expect("a manifest");
}

/// 2 kg on 800 N/m and 6 N s/m, by Runge and Kutta's method; the force is written with the wrong sign.
fn upside_down(phase: f64, noise: &mut impl FnMut() -> f64) -> String {
    let force = |t: f64| -> f64 {
        let sines = [(1.1, 9.0), (3.3, 8.0), (6.7, 12.0)];
        sines
            .iter()
            .map(|(f, size)| size * (std::f64::consts::TAU * f * t + phase * f).sin())
            .sum()
    };
    let rate = |t: f64, [x, v]: [f64; 2]| [v, (force(t) - 800.0 * x - 6.0 * v) / 2.0];
    let (h, mut y, mut text) = (1e-3, [0.0; 2], "time,force,body\n".to_owned());
    for k in 0..10_000 {
        let t = f64::from(k) * h;
        if k % 5 == 0 {
            let body = rate(t, y)[1] + 0.2 * noise();
            text += &format!("{t:.3},{},{body}\n", -force(t));
        }
        let moved = |by: f64, slope: [f64; 2]| [y[0] + by * slope[0], y[1] + by * slope[1]];
        let a = rate(t, y);
        let b = rate(t + h / 2.0, moved(h / 2.0, a));
        let c = rate(t + h / 2.0, moved(h / 2.0, b));
        let d = rate(t + h, moved(h, c));
        y = [0, 1].map(|i| y[i] + h / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]));
    }
    text
}
