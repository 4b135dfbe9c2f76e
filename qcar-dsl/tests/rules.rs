//! What the rules of structure, outputs and identifiability accept and refuse, case by case.

use qcar_dsl::compile::check;
use qcar_dsl::diagnostic::Code::{self, *};
use qcar_dsl::source::Source;

/// The codes that a model earns, in the order of the text; none where it is accepted without a word.
fn codes(text: &str) -> Vec<Code> {
    let source = Source {
        name: "case.axle".to_string(),
        text: text.to_string(),
    };
    let report = match check(source, &|_, _| Err("no files".to_string())) {
        Ok(checked) => checked.warnings().clone(),
        Err(report) => report,
    };
    report.diagnostics.iter().map(|diagnostic| diagnostic.code).collect()
}

#[track_caller]
fn earns(direction: &str, expected: &[Code]) {
    let parameters = "known param m: kg = 1; known param k: N/m = 1; known param c: N s/m = 1; known param r: 1 = 1;";
    let used = "let used = m*k*c*r;";
    let text = format!("axle case {{ {parameters} {used} direction z {{ {direction} }} output z.a.position; }}");
    let found: Vec<Code> = codes(&text).into_iter().filter(|code| *code != UnusedLet).collect();
    assert_eq!(found, expected, "{direction}");
}

#[test]
fn masses_are_held_or_float_as_a_whole() {
    let held = "road p; mass a = m; link l: a - p { spring k; }";
    earns(held, &[]);
    earns("mass a = m; force f on a; link ground: a { spring k; }", &[]);
    earns("mass a = m; mass b = m; force f on a; link l: a - b { spring k; }", &[]);
    earns(
        "gravity g; mass a = m; mass b = m; force f on a; link l: a - b { spring k; }",
        &[MassNotHeld],
    );
    earns(
        "road p; mass a = m; mass b = m; link l: a - p { spring k; }",
        &[MassNotHeld],
    );
    earns(
        "road p; mass a = m; mass b = m; link l: a - p { spring k; } link n: a - b { damper c; }",
        &[],
    );
    earns(
        "mass a = m; mass b = m; mass d = m; force f on a; link l: a - b { spring k; }",
        &[MassNotHeld],
    );
    earns("mass a = m; force f on a;", &[]);
}

#[test]
fn gravity_needs_a_spring() {
    let on = |law: &str| format!("road p; gravity g; mass a = m; link l: a - p {{ {law} }}");
    earns(&on("spring k;"), &[]);
    earns(&on("damper c;"), &[MassSinks]);
    earns(&on("force = k*max(s + 1 m, 0);"), &[]);
    earns(&on("state f: N; rate f = k*v - k/c*f; force = f;"), &[MassSinks]);
    earns(&on("state f: N; rate f = k*v; force = f;"), &[]);
    earns(
        &format!(
            "road p; gravity g; mass a = m; node n; {}",
            "link l: a - n { spring k; } link q: n - p { damper c; }"
        ),
        &[MassSinks],
    );
}

#[test]
fn levers_hold_as_far_as_they_reach() {
    earns(
        "road p; mass a = m; mass b = m; link l: a - p { spring k; } link arm: a - r*b { spring k; }",
        &[],
    );
    earns(
        "road p; mass a = m; inertia t = 1 kg m^2; link l: a + 1 m*t - p { spring k; }",
        &[MassNotHeld],
    );
    let two = "link l: a + 1 m*t - p { spring k; } link n: a - 1 m*t - p { spring k; }";
    earns(&format!("road p; mass a = m; inertia t = 1 kg m^2; {two}"), &[]);
}

#[test]
fn nodes_are_solved_where_they_can_be() {
    let chain = |upper: &str, lower: &str| {
        let links = format!("link u: a - n {{ {upper} }} link l: n - p {{ {lower} }}");
        format!("road p; mass a = m; node n; link rest: a - p {{ spring k; damper c; }} {links}")
    };
    earns(&chain("spring k;", "spring k;"), &[]);
    earns(&chain("damper c;", "spring k;"), &[]);
    earns(&chain("damper c;", "damper c;"), &[]);
    earns(&chain("inerter m;", "spring k;"), &[]);
    earns(&chain("damper c;", "force = k*s*abs(s)/1 m;"), &[]);
    earns(&chain("spring k;", "force = k*s*abs(s)/1 m;"), &[NodeNonlinear]);
    earns(&chain("spring k;", "force = c*v*abs(v)/1 m/s;"), &[NodeNonlinear]);
    earns(
        "road p; mass a = m; node n; link l: a - p { spring k; }",
        &[NodeNotAttached],
    );
    let strut = |upper: &str| {
        let links = format!("link u: a - n {{ {upper} }} link d: n - q {{ damper c; }} link l: q - p {{ spring k; }}");
        format!("road p; mass a = m; node n; node q; {links}")
    };
    earns(&strut("spring k;"), &[]);
    earns(&strut("force = k*s*abs(s)/1 m;"), &[NodeNonlinear]);
    let unheld = "link x: a - p { spring k; } link y: n - q { damper c; }";
    earns(&format!("road p; mass a = m; node n; node q; {unheld}"), &[NodesFloat]);
    let lever = "link x: a - p { spring k; } link y: n - 2*q { damper c; } link z: q - p { spring k; }";
    earns(&format!("road p; mass a = m; node n; node q; {lever}"), &[NodesFloat]);
    let floating = "link x: a - p { spring k; } link y: n - q { spring k; }";
    earns(
        &format!("road p; mass a = m; node n; node q; {floating}"),
        &[NodesFloat],
    );
}

#[test]
fn dampers_take_energy() {
    let law = |law: &str| format!("road p; mass a = m; link l: a - p {{ spring k; {law} }}");
    earns(&law("damper c;"), &[]);
    earns(&law("damper -c;"), &[NegativeDamping]);
    earns(&law("inerter -m;"), &[NegativeDamping]);
    earns(&law("force = c*v*(1 + (v/1 m/s)^2);"), &[]);
    earns(&law("force = c*v*(1 - (v/1 m/s)^2);"), &[LawGivesEnergy]);
    earns(&law("force = if v > 0 { 2*c*v } else { c*v };"), &[]);
    earns(&law("force = 10 N*sign(v);"), &[]);
    earns(&law("force = 10 N;"), &[]);
    earns(&law("force = k*s - c*v;"), &[LawGivesEnergy]);
}

#[test]
fn inner_states_take_more_than_they_give() {
    let law = |law: &str| format!("road p; mass a = m; link l: a - p {{ spring k; state f: N; {law} force = f; }}");
    earns(&law("rate f = k*v - k/c*f;"), &[]);
    earns(&law("rate f = k*v + k/c*f;"), &[LawGivesEnergy]);
    earns(&law("rate f = -k*v - k/c*f;"), &[LawGivesEnergy]);
    earns(&law("rate f = k*v - k*abs(v)*f/10 N;"), &[]);
    earns(&law("damper 2*c; rate f = -k*v - k/c*f;"), &[]);
}

#[test]
fn a_spring_beside_a_spring_is_one_spring() {
    let second = |link: &str| format!("road p; mass a = m; link l: a - p {{ spring k; }} link n: {link}");
    earns(&second("a - p { damper c; }"), &[]);
    earns(&second("a - p { spring k; }"), &[DuplicateLink]);
    earns(&second("p - a { damper c; spring k; }"), &[DuplicateLink]);
    earns(&second("r*a - p { spring k; }"), &[]);
}

/// A body on a wheel on a tyre, its law and its parameters to be estimated.
fn sees(parameters: &str, law: &str, expected: &[Code]) {
    let known = "known param m: kg = 5; param m_w: kg = 1; param k_t: N/m = 1;";
    let links = format!("link t: wheel - p {{ spring k_t; }} link l: body - wheel {{ {law} }}");
    let masses = "road p; mass body = m - m_w; mass wheel = m_w;";
    assert_eq!(
        codes(&format!(
            "axle case {{ {known} {parameters} direction z {{ {masses} {links} }} }}"
        )),
        expected,
        "{law}"
    );
}

#[test]
fn parameters_are_told_apart_where_the_outputs_can() {
    let two = "param a: N/m = 1; param b: N/m = 2;";
    let law = "param a: N/m = 1; param f: N = 1;";
    sees("param k: N/m = 1; param c: N s/m = 1;", "spring k; damper c;", &[]);
    sees(two, "spring a + b;", &[OnlyInCombination]);
    sees(two, "spring sqrt(a*b);", &[OnlyInCombination]);
    sees(two, "spring a; force = b*s*(s/1 m)^2;", &[]);
    sees("param k: N/m = 1; known param q: N/m = 1;", "spring k + q;", &[]);
    // A stop, friction and a preload: none of their parameters needs to change a slope.
    sees(
        "param k: N/m = 1; param gap: m = 0.02 in 0.01..0.05;",
        "spring k; force = 9*k*min(s + gap, 0);",
        &[],
    );
    sees(law, "spring a; force = f*sign(v);", &[]);
    sees(law, "spring a; force = f*tanh(v/1 mm/s);", &[]);
    // A relaxing branch: its stiffness and damping, but not the size of its inner state.
    let maxwell = "state z: N; rate z = a*v - g*z; force = z;";
    sees("param a: N/m = 1; param g: 1/s = 1;", maxwell, &[]);
}

#[test]
fn the_size_of_an_inner_state_is_seen_by_nobody() {
    let parameters = "param a: 1 = 1; param b: 1/s = 1; param e: N/m = 1;";
    sees(
        parameters,
        "state z: m; rate z = a*v - b*z; force = e*z;",
        &[OnlyInCombination],
    );
}

/// On a shaker, accelerations show the ratios of masses, stiffnesses and damping alone, whatever the size of the ranges
/// and whatever the law.
#[test]
fn accelerations_on_a_shaker_show_ratios_alone() {
    let of_law = |law: &str| {
        codes(&format!(
            "axle case {{ param m_a: kg = 10 in 0.1..1e3; param m_b: kg = 5 in 0.1..1e3;
            param k_a: N/m = 1e5 in 1..1e9; param c_a: N s/m = 100 in 0.1..1e6;
            param k_b: N/m = 5e4 in 1..1e9; param c_b: N s/m = 50 in 0.1..1e6; param q: N/m^3 = 1e7 in 1..1e12;
            direction z {{ motion p; mass a = m_a; mass b = m_b; link l: a - p {{ spring k_a; damper c_a; }}
            link n: b - a {{ spring k_b; damper c_b; force = {law}; }}
            output a.acceleration; output b.acceleration; }} }}"
        ))
    };
    assert_eq!(of_law("q*(1 m)^2*s"), [OnlyInCombination]);
    assert_eq!(of_law("q*s^3"), [OnlyInCombination]);
    // A known force shows them all.
    assert_eq!(of_law("q*s^3 + 9 N*tanh(v/1 m/s)"), []);
}

/// The mean of a position shows one constant force, or the sum of several at the same place.
#[test]
fn constant_forces_at_the_same_place_are_one() {
    let of_forces = |one: &str, other: &str| {
        codes(&format!(
            "axle case {{ param k: N/m = 1; param f: N = 0 in -1..1; param g: N = 0 in -1..1;
            direction z {{ mass a = 1 kg; mass b = 1 kg; force p on a; link l: a {{ spring k; {one} }}
            link n: b {{ spring k; {other} }} output a.position; output b.position; }} }}"
        ))
    };
    assert_eq!(of_forces("force = f;", "force = g;"), []);
    assert_eq!(of_forces("force = f - g;", ""), [OnlyInCombination]);
}

#[test]
fn a_dyno_sees_its_own_law() {
    let dyno = |law: &str| {
        format!(
            "axle case {{ param c: N s/m = 1; param w: m/s = 1; direction z {{ motion r; link d: r {{ {law} }} output d.force; }} }}"
        )
    };
    assert_eq!(codes(&dyno("force = c*v/(1 + abs(v)/w);")), []);
    assert_eq!(codes(&dyno("force = c*w*(v/w);")), [ParameterUndetermined]);
}

#[test]
fn a_byte_order_mark_is_no_mistake() {
    let text = "\u{feff}axle case { known param m: kg = 1; direction z { mass a = m; force f on a; } }";
    assert_eq!(codes(text), []);
}

#[test]
fn a_channel_shows_what_it_compares() {
    let text = "axle case { known param k: N/m = 1; direction z { road p; mass a = 1 kg; node n; force f on a;
        link u: a - n { spring k; } link l: n - p { spring k; damper 1 N s/m; }
        output a.velocity;
        channel lag = n.position / a.position; channel load = l.force / p.position; channel reach = a.position / f.force; } }";
    let source = Source {
        name: "case.axle".to_string(),
        text: text.to_string(),
    };
    let checked = check(source, &|_, _| Err("no files".to_string())).unwrap();
    let names: Vec<&str> = checked.outputs.iter().map(|output| output.name.as_str()).collect();
    assert_eq!(names, ["z_a_velocity", "z_n_position", "z_l_force"]);
}

#[test]
fn hints_say_what_to_write() {
    let hint = |text: &str| {
        let source = Source {
            name: "case.axle".to_string(),
            text: text.to_string(),
        };
        let report = check(source, &|_, _| Err("no files".to_string())).unwrap_err();
        report.diagnostics[0].hint.clone()
    };
    assert!(hint("axle case { param k: N/m = 3 in 3..3; }").contains("`= 3`"));
    assert!(hint("axle case {\n/// Stiffness\n}").contains("`// …`"));
}

/// A mistake in a declaration is told there, and not at each use again.
#[test]
fn one_mistake_is_told_once() {
    let sound = "element stop(k: N/m, tau: s) { state f: N; rate f = k*v - f/tau; force = f; }
        axle case {
            known param m: kg = 1; known param k: N/m = 1; known param c: N s/m = 1; known param j: kg m^2 = 1;
            known param arm: m = 1; known param area: m^2 = 1; known param tau: s = 1;
            let twice = 2*k;
            direction z {
                road p; mass a = m; mass b = m; inertia pitch = j; node n;
                point nose = a;
                force f on b;
                link tire: b - p { spring k; damper c; stop(k, tau); }
                link strut: a - b { spring twice; damper c; stop(k, tau); }
                link lever: arm*pitch - b { spring k; }
                link roll: pitch { spring k*area; damper c*area; }
                link upper: n - a { spring k; }
                link lower: n - b { damper c; }
                output nose.acceleration; output b.acceleration; output strut.force; output tire.force;
                channel over = a.acceleration / p.acceleration;
            }
        }";
    assert_eq!(codes(sound), [], "the model without a mistake");
    let cases = [
        ("known param k: N/m", "known param k: N/mx", UnknownUnit),
        ("known param k: N/m", "known param kk: N/m", UnknownName),
        (
            "known param tau: s",
            "known param k: N/m = 2; known param tau: s",
            DuplicateName,
        ),
        ("mass b = m;", "mass b = m; inertia b = j;", DuplicateName),
        ("known param k:", "known parm k:", Expected),
        ("let twice = 2*k;", "let twice = 2 + k;", UnitsDiffer),
        ("let twice = 2*k;", "let twice = sqrt(-1)*k;", NotFinite),
        ("let twice = 2*k;", "let double = 2*k;", UnknownName),
        ("element stop", "element stopp", UnknownElement),
        ("state f: N;", "state f: Nx;", UnknownUnit),
        ("rate f = k*v", "rate f = kk*v", UnknownName),
        ("rate f = k*v", "rate f = k*s", UnitsDiffer),
        ("force = f;", "force = f*tau;", WrongUnit),
        ("road p;", "", UnknownName),
        ("road p;", "raod p;", UnknownStatement),
        ("mass a = m;", "mass a = k;", WrongUnit),
        ("mass a = m;", "mass aa = m;", UnknownName),
        ("mass b = m;", "", UnknownName),
        ("inertia pitch = j;", "inertia pich = j;", UnknownName),
        ("inertia pitch = j;", "inertia pitch = m;", WrongUnit),
        ("node n;", "", UnknownName),
        ("link strut:", "link strutt:", UnknownName),
        ("link strut: a - b", "link strut: a - j", StretchHasConstant),
        ("direction z {", "directon z {", UnknownStatement),
    ];
    for (right, wrong, expected) in cases {
        assert!(sound.contains(right), "{right}");
        let found = codes(&sound.replacen(right, wrong, 1));
        assert_eq!(found, [expected], "`{wrong}` in place of `{right}`");
    }
}
