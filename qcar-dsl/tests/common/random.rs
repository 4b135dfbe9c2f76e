//! Random linear models: trees of masses and nodes on a road, with cross links, levers, inerters and inner states.

use proptest::prelude::*;
use qcar_dsl::check::Checked;
use qcar_dsl::expr::{CoordinateId, Expr, Symbol};
use qcar_dsl::model::{CoordinateKind, Quantity, Signal, Term};

use super::Builder;

/// What a link is made of, besides its spring.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Parts {
    Spring,
    SpringDamper,
    SpringDamperInerter,
    /// A spring in parallel with a spring and damper in series, by an inner state.
    SpringMaxwell,
    /// A law written out as an expression, with two inner states.
    Written,
    /// A spring beside an actuator that follows a force input, at once and by a lag.
    Actuated,
}

/// A coordinate and the link that holds it.
#[derive(Clone, Debug)]
pub struct Member {
    pub node: bool,
    pub parent: prop::sample::Index,
    pub parts: Parts,
    /// Another coordinate that a lever takes into the stretch.
    pub lever: Option<prop::sample::Index>,
}

#[derive(Clone, Debug)]
pub struct Plan {
    pub members: Vec<Member>,
    pub cross: Vec<(prop::sample::Index, prop::sample::Index, Parts)>,
    /// What the parameters are made of.
    pub seed: u64,
    /// How many outputs are kept.
    pub outputs: usize,
}

fn parts() -> impl Strategy<Value = Parts> {
    prop_oneof![
        Just(Parts::Spring),
        Just(Parts::SpringDamper),
        Just(Parts::SpringDamperInerter),
        Just(Parts::SpringMaxwell),
        Just(Parts::Written),
        Just(Parts::Actuated),
    ]
}

fn member() -> impl Strategy<Value = Member> {
    let lever = prop::option::weighted(0.3, any::<prop::sample::Index>());
    (prop::bool::weighted(0.3), any::<prop::sample::Index>(), parts(), lever).prop_map(
        |(node, parent, parts, lever)| Member {
            node,
            parent,
            parts,
            lever,
        },
    )
}

pub fn plan() -> impl Strategy<Value = Plan> {
    plan_of(1..6, Just(usize::MAX))
}

/// So large a model that its responses are solved for one by one, with many outputs or with few.
pub fn large_plan() -> impl Strategy<Value = Plan> {
    plan_of(30..34, prop_oneof![Just(usize::MAX), Just(7)])
}

fn plan_of(members: std::ops::Range<usize>, outputs: impl Strategy<Value = usize>) -> impl Strategy<Value = Plan> {
    let cross = (any::<prop::sample::Index>(), any::<prop::sample::Index>(), parts());
    let members = prop::collection::vec(member(), members);
    let cross = prop::collection::vec(cross, 0..3);
    let plan = |(members, cross, seed, outputs)| Plan {
        members,
        cross,
        seed,
        outputs,
    };
    (members, cross, any::<u64>(), outputs).prop_map(plan)
}

fn terms(b: &mut Builder, n: usize, parts: Parts) -> (Vec<Term>, Vec<Expr>) {
    let mut p = |name: &str| b.parameter(&format!("{name}{n}"));
    let l = qcar_dsl::expr::LinkId(n as u16);
    match parts {
        Parts::Spring => (vec![Term::Spring(p("k"))], vec![]),
        Parts::SpringDamper => (vec![Term::Spring(p("k")), Term::Damper(p("c"))], vec![]),
        Parts::SpringDamperInerter => (
            vec![Term::Spring(p("k")), Term::Damper(p("c")), Term::Inerter(p("b"))],
            vec![],
        ),
        Parts::SpringMaxwell => {
            let (k, k_m, c_m) = (p("k"), p("k_m"), p("c_m"));
            let g = &mut b.model.graph;
            let (v, f) = (g.symbol(Symbol::Rate(l)), g.symbol(Symbol::Inner(l, 0)));
            let (gain, decay) = (g.mul(k_m, v), g.div(k_m, c_m));
            let relaxed = g.mul(decay, f);
            let rate = g.sub(gain, relaxed);
            (vec![Term::Spring(k), Term::Force(f)], vec![rate])
        }
        Parts::Written => {
            let (k, a, r) = (p("k"), p("a"), p("r"));
            let g = &mut b.model.graph;
            let s = g.symbol(Symbol::Stretch(l));
            let [first, second] = [0, 1].map(|i| g.symbol(Symbol::Inner(l, i)));
            let elastic = g.mul(k, s);
            let both = g.add(first, second);
            let shared = g.mul(a, both);
            let force = g.add(elastic, shared);
            let behind = g.sub(s, first);
            let first_rate = g.mul(r, behind);
            let behind = g.sub(first, second);
            let second_rate = g.mul(a, behind);
            (vec![Term::Force(force)], vec![first_rate, second_rate])
        }
        Parts::Actuated => {
            let (k, a, r) = (p("k"), p("a"), p("r"));
            let g = &mut b.model.graph;
            let (lagged, demand) = (g.symbol(Symbol::Inner(l, 0)), g.symbol(Symbol::Force(1)));
            let direct = g.mul(a, demand);
            let force = g.sub(direct, lagged);
            let behind = g.sub(demand, lagged);
            let rate = g.mul(r, behind);
            (vec![Term::Spring(k), Term::Force(force)], vec![rate])
        }
    }
}

/// A link to be: its ends, what it is made of, what a lever takes into its stretch.
type Ends = (CoordinateId, CoordinateId, Parts, Option<CoordinateId>);

impl Plan {
    /// The model and its parameters.
    pub fn build(&self) -> (Checked, Vec<f64>) {
        self.build_with(hold_groups)
    }

    /// The same, where dampers may join nodes to each other and to nothing else.
    pub fn build_with_groups(&self) -> (Checked, Vec<f64>) {
        self.build_with(level_groups)
    }

    fn build_with(&self, hold: impl Fn(&Builder, &mut Vec<Ends>)) -> (Checked, Vec<f64>) {
        let mut b = Builder::new("random");
        let road = b.coordinate("z", "road", CoordinateKind::Road);
        b.gravity("z");
        let mut coordinates = vec![road];
        let total = b.parameter("total");
        let mut rest = total;
        let mut links: Vec<Ends> = Vec::new();
        for (i, member) in self.members.iter().enumerate() {
            let kind = if member.node && i > 0 {
                CoordinateKind::Node
            } else {
                let mass = b.parameter(&format!("m{i}"));
                rest = b.model.graph.sub(rest, mass);
                CoordinateKind::Mass(mass)
            };
            let c = b.coordinate("z", &format!("q{i}"), kind);
            let parent = *member.parent.get(&coordinates);
            links.push((
                c,
                parent,
                member.parts,
                member.lever.map(|lever| *lever.get(&coordinates)),
            ));
            coordinates.push(c);
        }
        // What is left of the total is a mass of its own: a derived quantity in which every other mass appears.
        let last = b.mass("z", "last", rest);
        links.push((last, road, Parts::SpringDamper, None));
        coordinates.push(last);
        links.extend(
            self.cross
                .iter()
                .map(|(i, j, parts)| (*i.get(&coordinates), *j.get(&coordinates), *parts, None)),
        );
        links.retain(|(upper, lower, ..)| upper != lower);
        part_nodes(&b, &mut links);
        hold(&b, &mut links);
        for (n, &(upper, lower, parts, lever)) in links.iter().enumerate() {
            let (terms, inner) = terms(&mut b, n, parts);
            let mut stretch = b.between(upper, lower);
            if let Some(third) = lever.filter(|&third| third != upper && third != lower) {
                let (ratio, one) = (b.parameter(&format!("ratio{n}")), b.number(1.0));
                let g = &mut b.model.graph;
                stretch[1].1 = g.sub(ratio, one);
                stretch.push((third, g.neg(ratio)));
            }
            b.link_with_states("z", &format!("l{n}"), &stretch, terms, &inner);
        }
        b.force("f", coordinates[1]);
        b.force_along("demand", Vec::new());
        let (lever, minus) = (b.parameter("lever"), b.number(-1.0));
        b.force_along("between", vec![(coordinates[1], lever), (last, minus)]);
        b.point("nose", vec![(coordinates[1], lever), (last, minus), (road, lever)]);
        self.outputs(&mut b, &coordinates, links.len());
        let model = b.build();
        let mut p: Vec<f64> = (0..model.parameters.len())
            .map(|i| between_half_and_two(self.seed, i as u64))
            .collect();
        p[0] = 20.0;
        (model, p)
    }

    fn outputs(&self, b: &mut Builder, coordinates: &[CoordinateId], links: usize) {
        for &c in coordinates {
            b.output(Signal::Motion(c, Quantity::Acceleration));
            b.output(Signal::Motion(c, Quantity::Velocity));
            b.output(Signal::Motion(c, Quantity::Position));
        }
        for quantity in [Quantity::Acceleration, Quantity::Velocity, Quantity::Position] {
            b.output(Signal::Point(0, quantity));
        }
        for l in (0..links as u16).map(qcar_dsl::expr::LinkId) {
            b.output(Signal::LinkForce(l));
            b.output(Signal::LinkStretch(l));
        }
        // The last ones have forces of links among them.
        let all = std::mem::take(&mut b.model.outputs);
        let skipped = all.len().saturating_sub(self.outputs);
        b.model.outputs = all.into_iter().skip(skipped).collect();
    }
}

fn nodes(b: &Builder, &(upper, lower, _, lever): &Ends) -> Vec<CoordinateId> {
    let node = |c: &CoordinateId| b.model.coordinates[c.0 as usize].kind == CoordinateKind::Node;
    [Some(upper), Some(lower), lever]
        .into_iter()
        .flatten()
        .filter(node)
        .collect()
}

/// An inerter between two nodes would give two accelerations but one balance.
fn part_nodes(b: &Builder, links: &mut [Ends]) {
    for link in links {
        if link.2 == Parts::SpringDamperInerter && nodes(b, link).len() > 1 {
            link.2 = Parts::SpringDamper;
        }
    }
}

/// Gives nodes that a damper joins a damper to the road as well.
fn hold_groups(b: &Builder, links: &mut Vec<Ends>) {
    for n in 0..links.len() {
        let nodes = nodes(b, &links[n]);
        if nodes.len() > 1 && links[n].2 == Parts::SpringDamper {
            links.extend(
                nodes
                    .into_iter()
                    .map(|c| (c, CoordinateId(0), Parts::SpringDamper, None)),
            );
        }
    }
}

/// Takes the levers from dampers between nodes, so that what moves freely moves as one.
fn level_groups(b: &Builder, links: &mut Vec<Ends>) {
    for link in links {
        if link.2 == Parts::SpringDamper && nodes(b, link).len() > 1 {
            link.3 = None;
        }
    }
}

fn between_half_and_two(seed: u64, place: u64) -> f64 {
    let mixed = (seed ^ place.wrapping_mul(0x9E37_79B9_7F4A_7C15)).wrapping_mul(0xD6E8_FEB8_6659_FD93);
    0.5 + 1.5 * ((mixed ^ (mixed >> 32)) >> 11) as f64 / (1u64 << 53) as f64
}
