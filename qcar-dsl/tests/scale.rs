//! What the compiler makes of a chain of masses grows no faster than its length to the power of 1.2. Expressions,
//! operations and bytes are counted: no clock is asked.

#[path = "../examples/chain.rs"]
#[allow(dead_code, reason = "the example measures times")]
mod chain;

use qcar_dsl::c;
use qcar_dsl::check::check_text;
use qcar_dsl::compile::{check, derive_wanted};
use qcar_dsl::patch::Patch;
use qcar_dsl::response::Wanted;
use qcar_dsl::schedule::Compiled;
use qcar_dsl::show::{Stage, show};
use qcar_dsl::source::Source;

fn compiled(masses: usize, own: bool, wanted: Wanted) -> Compiled {
    let checked = check_text(chain::source(masses, own), &|_, _| Err(String::new()));
    derive_wanted(checked.unwrap_or_else(|report| panic!("{report}")), wanted)
}

/// Everything that can be counted, by its name.
fn counts(of: &Compiled, shown: &[Stage]) -> Vec<(String, usize)> {
    let programs = &of.programs;
    let response = &programs.responses[0];
    let counted = [
        ("derivative", &programs.derivative),
        ("outputs", &programs.outputs),
        ("matrices", &programs.matrices),
        ("sensitivities", &programs.sensitivities),
        ("parameter Jacobian", &programs.parameter_jacobian),
        ("response", &response.value),
        ("response with Jacobian", &response.with_jacobian),
        ("prepare", &programs.prepare),
    ];
    let operations = counted.map(|(name, program)| (name.to_string(), program.ops.len()));
    let texts = shown
        .iter()
        .map(|&stage| (stage.name().to_string(), show(of, stage).len()));
    let all = operations.into_iter().chain(texts);
    all.chain([("expressions".to_string(), of.graph.size())]).collect()
}

fn grows_as_the_length(own: bool, wanted: Wanted, shown: &[Stage]) {
    grow_as_the_length(|masses| counts(&compiled(masses, own, wanted), shown));
}

/// What is counted for a number of masses, by its name.
fn grow_as_the_length(counted: impl Fn(usize) -> Vec<(String, usize)>) {
    for lengths in [(10, 80), (40, 80)] {
        let most = (lengths.1 as f64 / lengths.0 as f64).powf(1.2);
        for ((what, few), (_, many)) in counted(lengths.0).into_iter().zip(counted(lengths.1)) {
            let grown = many as f64 / few as f64;
            assert!(grown <= most, "{what} of {lengths:?} masses: {few} and {many}");
        }
    }
}

/// With parameters that all members share, all of it, and the Jacobian of every output too.
#[test]
fn a_chain_of_equal_members_grows_as_its_length() {
    grows_as_the_length(false, Wanted::Jacobian, &Stage::ALL);
}

/// With parameters of each member, a Jacobian of every output has entries as the square of the length. Where none is
/// wanted, nothing grows so.
#[test]
fn a_chain_of_many_parameters_grows_as_its_length_without_its_jacobian() {
    let shown = Stage::ALL.into_iter().filter(|stage| *stage != Stage::Rust);
    grows_as_the_length(true, Wanted::Values, &shown.collect::<Vec<_>>());
}

/// The derivatives of three measured outputs by the parameters of all members, which a fit needs.
#[test]
fn the_jacobian_of_few_outputs_grows_as_the_length() {
    grow_as_the_length(|masses| {
        let measured = [0, masses as u16 / 2, masses as u16 - 1];
        let compiled = compiled(masses, true, Wanted::JacobianOf(&measured));
        counts(&compiled, &[])
    });
}

/// C99 for a simulation has no frequency response.
#[test]
fn the_c99_of_a_simulation_grows_as_the_length() {
    grow_as_the_length(|masses| {
        let compiled = compiled(masses, true, Wanted::Nothing);
        let values = vec![1.0; compiled.about.parameters.len()];
        let c::Sources { header, source } = c::sources(&compiled, &values, "chain");
        assert!(!source.contains("_response_"));
        vec![("header".into(), header.len()), ("source".into(), source.len())]
    });
}

/// The values are the same operations, whether derivatives are wanted or not.
#[test]
fn values_do_not_depend_on_what_else_is_wanted() {
    for (masses, own) in [(10, false), (10, true), (60, false), (60, true)] {
        let [all, values] = [Wanted::Jacobian, Wanted::Values].map(|wanted| compiled(masses, own, wanted));
        assert_eq!(
            all.programs.responses[0].value.ops.len(),
            values.programs.responses[0].value.ops.len()
        );
        assert!(values.about.responses[0].jacobian.is_empty());
        assert_eq!(
            all.about.responses[0].jacobian.len(),
            masses * all.model.parameters.len()
        );
    }
}

/// Groups of parameters of a model that its outputs tell apart in combinations only, and how many of these.
fn unseen(text: String) -> Vec<(Vec<String>, usize)> {
    let name = "chain.axle".to_string();
    let checked = check(Source { name, text }, &|_, _| Err(String::new())).unwrap_or_else(|report| panic!("{report}"));
    let groups = checked.unseen().iter();
    groups.map(|group| (group.parameters.clone(), group.seen)).collect()
}

/// Whatever is found out from few responses: a product in any link, however far away, and a scale that is common to all
/// forces.
#[test]
fn what_a_chain_does_not_show_is_found_at_any_length() {
    for masses in [2, 10, 40] {
        let known = chain::chain(masses, true);
        assert_eq!(unseen(known.clone()), []);
        for place in [1, masses / 2, masses] {
            let (spring, product) = (format!("spring k{place};"), format!("spring k{place}*share;"));
            let shared = known.replace("    direction z", "    param share: 1 = 1;\n    direction z");
            let found = unseen(shared.replace(&spring, &product));
            assert_eq!(
                found,
                [(vec![format!("k{place}"), "share".to_string()], 1)],
                "{masses} masses"
            );
        }
        let all = 3 * masses;
        let found = unseen(known.replace("known param", "param"));
        assert_eq!(found.len(), 1, "{masses} masses: {found:?}");
        assert_eq!((found[0].0.len(), found[0].1), (all, all - 1));
    }
}

/// One parameter set mostly tells where an effect applies. Beside unknown masses only ratios are determined, so that no
/// patched model has all its parameters determined: the answer is that of all sets and motions.
#[test]
fn effects_apply_in_a_chain_of_unknown_masses_where_they_have_candidates() {
    let text = chain::chain(6, true).replace("known param", "param");
    let name = "chain.axle".to_string();
    let chain = check(Source { name, text }, &|_, _| Err(String::new())).unwrap_or_else(|report| panic!("{report}"));
    for (text, applies) in [
        (include_str!("../../models/effects/bushing_relaxation.axle"), true),
        (include_str!("../../models/effects/bump_stop.axle"), true),
        (include_str!("../../models/effects/sliding_friction.axle"), true),
        (include_str!("../../models/effects/offset_force.axle"), false),
    ] {
        let (name, text) = ("effect.axle".to_string(), text.to_string());
        let effect = Patch::read(Source { name, text }).unwrap_or_else(|report| panic!("{report}"));
        let candidates = effect.candidates(&chain, &|_| None);
        let mut places: Vec<String> = candidates.into_iter().map(|own| own.place).collect();
        places.dedup();
        assert_eq!(effect.places(&chain), places, "{}", effect.effect().name.text);
        assert_eq!(!places.is_empty(), applies, "{}", effect.effect().name.text);
    }
}
