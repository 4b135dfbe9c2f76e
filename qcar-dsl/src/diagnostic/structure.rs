//! Mistakes of the structure: support, solvability, passivity.

use super::{Code, Diagnostic, all_of};
use crate::source::Span;

/// Names with their positions.
type Named<'a> = [(Span, &'a str)];

fn names(named: &Named) -> String {
    all_of(&named.iter().map(|(_, name)| *name).collect::<Vec<_>>())
}

fn label_all(diagnostic: Diagnostic, named: &Named, text: &str) -> Diagnostic {
    named
        .iter()
        .fold(diagnostic, |diagnostic, (span, _)| diagnostic.label(*span, text))
}

/// Masses that no link holds.
pub fn mass_not_held(masses: &Named) -> Diagnostic {
    let message = format!("nothing holds {}: a rigid-body mode", names(masses));
    let first = masses.first().map_or("body", |(_, name)| name);
    label_all(
        Diagnostic::error(Code::MassNotHeld, message),
        masses,
        "moves without stretching any link",
    )
    .hint(format!(
        "write a link that holds it, such as `link mount: {first} - … {{ spring k; }}`"
    ))
}

/// Masses whose weight no spring carries.
pub fn mass_sinks(masses: &Named) -> Diagnostic {
    let message = format!(
        "gravity accelerates {} without limit: no spring carries the weight",
        names(masses)
    );
    let first = masses.first().map_or("body", |(_, name)| name);
    label_all(
        Diagnostic::error(Code::MassSinks, message),
        masses,
        "held by dampers at most",
    )
    .hint(format!(
        "write a spring that carries it, such as `link spring: {first} - … {{ spring k; }}`"
    ))
}

/// A node that no link touches.
pub fn node_not_attached(span: Span, name: &str) -> Diagnostic {
    Diagnostic::error(
        Code::NodeNotAttached,
        format!("nothing holds the massless node `{name}`"),
    )
    .label(span, "no spring, damper or inerter")
    .hint(format!(
        "write links on both of its sides, such as `link mount: body - {name} {{ spring k; }}`"
    ))
}

/// A node whose balance is a nonlinear equation.
pub fn node_nonlinear(span: Span, name: &str, link: (Span, &str), what: &str) -> Diagnostic {
    let beside = if what == "rate" { "its velocity" } else { "its position" };
    Diagnostic::error(
        Code::NodeNonlinear,
        format!("the balance of the massless node `{name}` cannot be solved"),
    )
    .label(link.0, format!("this law is nonlinear in its {what}"))
    .label(span, format!("{beside} would have to be found by iteration"))
    .hint(format!(
        "write `mass {name} = …;` with the mass of the real part, or put the law of `{}` elsewhere",
        link.1
    ))
}

/// Nodes that are connected only to each other.
pub fn nodes_float(nodes: &Named, what: &str) -> Diagnostic {
    let message = format!(
        "the balance of {} cannot be solved: the nodes are connected only to each other",
        names(nodes)
    );
    label_all(
        Diagnostic::error(Code::NodesFloat, message),
        nodes,
        "moves with the others without any force",
    )
    .hint(format!(
        "write {what} between one of them and a mass or road, or leave one node out"
    ))
}

/// An inertia that is zero or negative at its defaults or everywhere.
pub fn inertia_not_positive(span: Span, name: &str) -> Diagnostic {
    Diagnostic::error(
        Code::InertiaNotPositive,
        format!("the inertia of `{name}` is not positive"),
    )
    .label(span, "zero or negative")
    .hint(format!(
        "write a positive value, or `node {name};` for a massless point"
    ))
}

/// An inertia that is a parameter whose range begins at zero or below.
pub fn inertia_can_vanish(span: Span, name: &str, low: f64) -> Diagnostic {
    Diagnostic::error(
        Code::InertiaCanVanish,
        format!("the inertia of `{name}` can be {low} within its range"),
    )
    .label(span, "must stay above zero")
    .hint("write a range that begins above zero, such as `in 0.1..50`")
}

/// A damper or inerter that can be negative.
pub fn negative_damping(span: Span, link: &str, what: &str, lowest: f64, at: &[String]) -> Diagnostic {
    let place = if at.is_empty() {
        String::new()
    } else {
        format!(" at {}", at.join(", "))
    };
    Diagnostic::error(
        Code::NegativeDamping,
        format!("the {what} of link `{link}` can be {lowest}{place}"),
    )
    .label(span, "would supply energy instead of dissipating it")
    .hint(
        "write ranges in which it is zero or positive, such as `in 0..5000`; or `active;` in the link, if it is meant to supply energy",
    )
}

/// A law without inner states that supplies energy.
pub fn law_gives_energy(span: Span, link: &str, s: f64, v: f64) -> Diagnostic {
    let message = format!("the law of link `{link}` supplies energy at s = {s:.3}, v = {v:.3}");
    Diagnostic::error(Code::LawGivesEnergy, message)
        .label(span, "acts in the direction of the motion there")
        .hint("write the force that resists, `force = c*v` with a positive `c`; or add `active;`, if it is meant to supply energy")
}

/// A law with inner states that supplies energy to small vibrations.
pub fn law_feeds_vibrations(span: Span, link: &str, frequency: f64) -> Diagnostic {
    let message = format!("the law of link `{link}` supplies energy to vibrations about rest at {frequency} rad/s");
    Diagnostic::error(Code::LawGivesEnergy, message)
        .label(span, "supplies more energy in a cycle than it dissipates")
        .hint("write a state that decays and a force that resists, `rate f = k*v - k/c*f; force = f;`; or add `active;`, if it is meant to supply energy")
}

/// Links whose laws use each other, and that together supply energy.
pub fn links_give_energy(links: &Named, span: Span) -> Diagnostic {
    let message = format!("the laws of {} together supply energy", names(links));
    Diagnostic::error(Code::LawGivesEnergy, message)
        .label(span, "acts in the direction of the motion")
        .hint("write forces that together resist the rates; or add `active;` to one of them, if they are meant to supply energy")
}

/// Two links whose elastic forces have no common potential.
pub fn no_potential(links: &Named) -> Diagnostic {
    let message = format!(
        "the laws of {} supply energy along a closed path of their stretches",
        names(links)
    );
    let diagnostic = Diagnostic::error(Code::LawGivesEnergy, message);
    label_all(diagnostic, links, "the coupling of these two forces is not symmetric")
        .hint("write both forces as derivatives of one energy, ∂E/∂s of each stretch; or add `active;` to one of them, if it is meant to supply energy")
}

/// A law of several stretches at a massless node.
pub fn coupled_at_node(link: (Span, &str), node: (Span, &str)) -> Diagnostic {
    let message = format!(
        "link `{}` uses the stretch of another link, and ends at the massless node `{}`",
        link.1, node.1
    );
    Diagnostic::error(Code::CoupledAtNode, message)
        .label(link.0, "the balance of the node would need both stretches at once")
        .label(node.0, "has no mass")
        .hint(format!("write `mass {} = …;` with the mass of the real part", node.1))
}

/// Two links with the same stretch and the same kind of term.
pub fn duplicate_link((span, first_span): (Span, Span), name: &str, first: &str, kind: &str) -> Diagnostic {
    let message = format!("link `{name}` repeats the {kind} of link `{first}`");
    Diagnostic::error(Code::DuplicateLink, message)
        .label(span, "the same stretch")
        .label(first_span, format!("already has a {kind}"))
        .hint(format!(
            "write one link with the sum, `{kind} a + b;`, or other ends for `{name}`"
        ))
}

/// A prescribed motion that no link touches.
pub fn motion_not_used(span: Span, name: &str) -> Diagnostic {
    Diagnostic::error(Code::MotionNotUsed, format!("`{name}` moves nothing"))
        .label(span, "no link touches it")
        .hint(format!("write `link tire: wheel - {name} {{ … }}`, or remove the line"))
}

/// A force input that has no point, and that no law uses.
pub fn force_not_used(span: Span, name: &str) -> Diagnostic {
    Diagnostic::error(Code::ForceNotUsed, format!("force `{name}` acts on nothing"))
        .label(span, "not applied to a point, and used by no law")
        .hint(format!(
            "write `force {name} on body - wheel;`, or use it in a law, `force = -{name};`"
        ))
}

/// A motion of a massless node that would need the rate of a force input.
pub fn force_rate_needed((span, node): (Span, &str), (force_span, force): (Span, &str), motion: &str) -> Diagnostic {
    let message = format!("the {motion} of the massless node `{node}` would need the rate of force `{force}`");
    Diagnostic::error(Code::ForceRateNeeded, message)
        .label(force_span, "acts on it; its rate is no input")
        .label(span, format!("its {motion} is an output, or a state of a law needs it"))
        .hint(format!(
            "write `mass {node} = …;` with the mass of the real part, or a damper beside its spring"
        ))
}

/// A gravity in a direction without masses.
pub fn gravity_pulls_nothing(span: Span, name: &str, direction: &str) -> Diagnostic {
    Diagnostic::warning(Code::GravityPullsNothing, format!("gravity `{name}` acts on no mass"))
        .label(span, format!("direction {direction} has no mass"))
        .hint("remove the line")
}
