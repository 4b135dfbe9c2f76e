//! Kinds of places. Two places are of one kind if everything near them is the same but for its names.
//!
//! An effect changes its place and the parts that touch it. Where the motion of every part nearby is an output, their
//! equations contain nothing else of the model but these motions, which the outputs show. So whether the compiler accepts
//! the effect, and which parameters the outputs then determine, is the same for all places of a kind.

use std::collections::BTreeSet;

use super::model_tree::ModelTree;
use super::place::Place;
use super::roles::{OF_LINKS, OF_MASSES, Roles};
use crate::check::Checked;
use crate::front::print::one_line;
use crate::front::syntax::{CoordinateKind, Effect, Statement};
use crate::hash::{HashMap, HashSet};
use crate::model::Signal;

/// How far a place is compared, in steps from a part to the statements that connect it. The first finds what an effect
/// changes at a link or a mass, the second the masses whose equations contain that, the third all other links of these.
const STEPS: usize = 3;

/// The parts of a model, to compare what is near its places.
pub struct Parts<'a> {
    roles: &'a Roles,
    statements: Vec<Line<'a>>,
    /// The positions of the statements that declare a name.
    declared: HashMap<&'a str, Vec<usize>>,
    /// The positions of the statements that contain a name.
    mentioned: HashMap<&'a str, Vec<usize>>,
    /// Directions and names of coordinates whose motion is an output.
    seen: HashSet<(&'a str, &'a str)>,
    /// The group of each undetermined parameter, and the number of combinations that the outputs do not determine.
    unseen: HashMap<&'a str, (usize, usize)>,
}

/// A statement in one line, with the names of the model in it.
struct Line<'a> {
    statement: &'a Statement,
    direction: &'a str,
    text: String,
    names: Vec<&'a str>,
}

impl<'a> Parts<'a> {
    /// The parts of a model, whose identifiability has been checked.
    pub fn of(base: &'a ModelTree, roles: &'a Roles, model: &'a Checked) -> Parts<'a> {
        let global = base.axle.body.iter().map(|statement| ("", statement));
        let inside = base.directions().flat_map(|direction| {
            let own = direction.body.iter();
            own.map(|statement| (direction.name.text.as_str(), statement))
        });
        let all = global
            .chain(inside)
            .filter(|(_, own)| !matches!(own, Statement::Direction(_)));
        let all: Vec<(&str, &Statement)> = all.collect();
        let mut declared = HashMap::<&str, Vec<usize>>::default();
        for (at, (_, statement)) in all.iter().enumerate() {
            if let Some(name) = statement.name() {
                declared.entry(&name.text).or_default().push(at);
            }
        }
        let line = |(direction, statement)| Line::of(direction, statement, &declared);
        let statements: Vec<Line> = all.into_iter().map(line).collect();
        let mut mentioned = HashMap::<&str, Vec<usize>>::default();
        for (at, line) in statements.iter().enumerate() {
            for name in line.names.iter().copied().collect::<BTreeSet<_>>() {
                mentioned.entry(name).or_default().push(at);
            }
        }
        Parts {
            roles,
            statements,
            declared,
            mentioned,
            seen: seen(model),
            unseen: unseen(model),
        }
    }

    /// The kind of a place of an effect; `None` if the outputs do not show all motions near it, or if a parameter of the
    /// effect could get a name that the model has, so that the place is unlike any other.
    pub fn kind(&self, effect: &Effect, place: &Place) -> Option<String> {
        let is_new = |name: &str| !self.declared.contains_key(format!("{name}_{}", place.name).as_str());
        let forms = effect.forms.iter().flat_map(|form| form.parameters());
        let mut parameters = effect.parameters().into_iter().chain(forms);
        let near = self.near(&place.name);
        let all_seen = near.iter().all(|&at| self.statements[at].is_seen(&self.seen));
        (all_seen && parameters.all(|own| is_new(&own.name.text))).then(|| self.described(place, &near))
    }

    /// The positions of the statements near a part, in the order of the text: what connects it, what that contains, and
    /// what is measured there.
    fn near(&self, part: &str) -> BTreeSet<usize> {
        let mut near = BTreeSet::new();
        let mut open = BTreeSet::from([part]);
        for _ in 0..STEPS {
            let connecting = self.containing(&open).filter(|&at| self.statements[at].connects());
            let new: Vec<usize> = connecting.filter(|&at| near.insert(at)).collect();
            let names = new.iter().flat_map(|&at| &self.statements[at].names).copied();
            open = names.filter(|name| self.is_part(name)).collect();
        }
        let mut open: Vec<usize> = near.iter().copied().collect();
        while let Some(at) = open.pop() {
            let names = self.statements[at].names.iter();
            let declaring = names.flat_map(|name| &self.declared[name]).copied();
            open.extend(declaring.filter(|&at| near.insert(at)));
        }
        let names = near.iter().flat_map(|&at| &self.statements[at].names).copied();
        let parts: BTreeSet<&str> = names.filter(|name| self.is_part(name)).collect();
        near.extend(self.containing(&parts).filter(|&at| self.statements[at].measures()));
        near
    }

    /// The positions of the statements that contain one of these names.
    fn containing<'n>(&'n self, names: &'n BTreeSet<&'n str>) -> impl Iterator<Item = usize> + 'n {
        let positions = names.iter().filter_map(|name| self.mentioned.get(name));
        positions.flatten().copied()
    }

    /// True if a name is that of something that moves or connects. All places share the roads and motions.
    fn is_part(&self, name: &str) -> bool {
        let mut declaring = self.declared[name].iter().map(|&at| &self.statements[at]);
        declaring.any(|line| line.connects() && !line.is_driven())
    }

    /// Statements with numbers in place of the names, and what follows from the rest of the model: roles, corner, number
    /// of uses, and undetermined parameters.
    fn described(&self, place: &Place, near: &BTreeSet<usize>) -> String {
        let mut numbers = Numbers::default();
        let own = numbers.of(&place.name).to_string();
        let mut lines = vec![format!("{own} along {}", place.direction)];
        for line in near.iter().map(|&at| &self.statements[at]) {
            let text = with_names(&line.text, |word| {
                let name = self.declared.get_key_value(word).map(|(name, _)| *name);
                name.map(|name| numbers.of(name).to_string())
            });
            lines.push(format!(
                "{}: {text} {}",
                line.direction,
                self.context(line, &mut numbers)
            ));
        }
        let corner = self.roles.of_corner(place.key());
        lines.extend(corner.map(|part| {
            numbers
                .known(part)
                .map_or(part.to_string(), |number| number.to_string())
        }));
        lines.join("\n")
    }

    /// What a statement does not say of what it declares.
    fn context(&self, line: &Line, numbers: &mut Numbers<'a>) -> String {
        let Some(name) = line.statement.name() else {
            return String::new();
        };
        let (along, name) = (line.direction, name.text.as_str());
        let roles = |all: &[&str], has: &dyn Fn(&str) -> bool| {
            let own: Vec<&str> = all.iter().copied().filter(|role| has(role)).collect();
            own.join(" ")
        };
        match line.statement {
            Statement::Link(_) => roles(&OF_LINKS, &|role| self.roles.is_link(along, name, role)),
            Statement::Coordinate(_) => roles(&OF_MASSES, &|role| self.roles.is_mass(along, name, role)),
            Statement::Parameter(_) | Statement::Let(_) => {
                let uses = self.mentioned[name].len();
                let group = self.unseen.get(name);
                let group = group.map(|&(group, hidden)| (numbers.of_group(group), hidden));
                format!("{uses} {group:?}")
            }
            _ => String::new(),
        }
    }
}

impl<'a> Line<'a> {
    fn of(direction: &'a str, statement: &'a Statement, declared: &HashMap<&'a str, Vec<usize>>) -> Line<'a> {
        let text = one_line(statement);
        let mut names = Vec::new();
        with_names(&text, |word| {
            names.extend(declared.get_key_value(word).map(|(name, _)| *name));
            None
        });
        Line {
            statement,
            direction,
            text,
            names,
        }
    }

    fn connects(&self) -> bool {
        use Statement::*;
        matches!(self.statement, Coordinate(_) | Link(_) | Point(..) | Force(..))
    }

    fn measures(&self) -> bool {
        matches!(self.statement, Statement::Output(..) | Statement::Channel(..))
    }

    fn is_driven(&self) -> bool {
        let Statement::Coordinate(own) = self.statement else {
            return false;
        };
        matches!(own.kind, CoordinateKind::Road | CoordinateKind::Motion)
    }

    /// False for a coordinate whose motion neither is given nor is among those that are seen.
    fn is_seen(&self, seen: &HashSet<(&str, &str)>) -> bool {
        let Statement::Coordinate(own) = self.statement else {
            return true;
        };
        self.is_driven() || seen.contains(&(self.direction, own.name.text.as_str()))
    }
}

/// Numbers of names and of groups in the order in which they first occur.
#[derive(Default)]
struct Numbers<'a> {
    names: HashMap<&'a str, usize>,
    groups: HashMap<usize, usize>,
}

impl<'a> Numbers<'a> {
    fn of(&mut self, name: &'a str) -> usize {
        let next = self.names.len();
        *self.names.entry(name).or_insert(next)
    }

    fn known(&self, name: &str) -> Option<usize> {
        self.names.get(name).copied()
    }

    fn of_group(&mut self, group: usize) -> usize {
        let next = self.groups.len();
        *self.groups.entry(group).or_insert(next)
    }
}

/// A text without its descriptions, in which `replace` gives other words for some of its words.
fn with_names(text: &str, mut replace: impl FnMut(&str) -> Option<String>) -> String {
    let mut replaced = String::with_capacity(text.len());
    for undescribed in text.split('"').step_by(2) {
        let is_inside = |c: char| c.is_alphanumeric() || c == '_';
        let mut rest = undescribed;
        while let Some(start) = rest.find(is_inside) {
            let (before, from) = rest.split_at(start);
            let (word, after) = from.split_at(from.find(|c| !is_inside(c)).unwrap_or(from.len()));
            replaced += before;
            replaced += replace(word).as_deref().unwrap_or(word);
            rest = after;
        }
        replaced += rest;
    }
    replaced
}

fn seen(model: &Checked) -> HashSet<(&str, &str)> {
    let moving = model.outputs.iter().filter_map(|output| match output.signal {
        Signal::Motion(coordinate, _) => Some(&model.coordinates[usize::from(coordinate.0)]),
        _ => None,
    });
    moving
        .map(|own| (own.direction.0.as_str(), own.name.as_str()))
        .collect()
}

fn unseen(model: &Checked) -> HashMap<&str, (usize, usize)> {
    let groups = model.unseen().iter().enumerate();
    let of_group = groups.flat_map(|(at, group)| {
        let hidden = (at, group.parameters.len() - group.seen);
        group.parameters.iter().map(move |name| (name.as_str(), hidden))
    });
    of_group.collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compile;
    use crate::patch::{Patch, place};
    use crate::source::Source;

    fn source(text: String) -> Source {
        let name = "written.axle".to_string();
        Source { name, text }
    }

    /// The kind of each link of a chain of 12 masses with further statements.
    fn kinds(more: &str) -> Vec<Option<String>> {
        let member = |at: usize| {
            format!(
                "mass q{at} = m; link l{at}: q{at} - q{} {{ spring k; damper c; }}\n",
                at - 1
            )
        };
        let members: String = (2..=12).map(member).collect();
        let chain = format!(
            "axle chain {{ known param m: kg = 2; param k: N/m = 4e3; param c: N s/m = 30;
             direction z {{ road pad; mass q1 = m; link l1: q1 - pad {{ spring k; damper c; }} {members} {more} }} }}"
        );
        let model =
            compile::check(source(chain), &|_, _| Err(String::new())).unwrap_or_else(|report| panic!("{report}"));
        let effect = "effect stiffer at link l with spring { \"A spring in parallel\" source \"none\"; shows \"more\";
             strength param k_added: N/m = 1 N/m in 0 N/m..2 N/m \"Stiffness\"; add to l { spring k_added; } }";
        let patch = Patch::read(source(effect.into())).unwrap_or_else(|report| panic!("{report}"));
        let base = ModelTree::of(&model);
        let roles = Roles::of(&base, &|_| None);
        let parts = Parts::of(&base, &roles, &model);
        let places = place::fitting(&base, &roles, &patch.effect().pattern);
        let chain = places.iter().filter(|place| place.name.starts_with('l'));
        chain.map(|place| parts.kind(patch.effect(), place)).collect()
    }

    /// How many of the links 2 to 12 are of the kind of link 6.
    fn like_the_sixth(kinds: &[Option<String>]) -> usize {
        kinds[1..].iter().filter(|kind| **kind == kinds[5]).count()
    }

    #[test]
    fn links_far_from_both_ends_are_of_one_kind() {
        let kinds = kinds("");
        assert!(kinds.iter().all(Option::is_some));
        // Of links 2 to 4 the road or the wheel is near, of 10 to 12 the end.
        assert_eq!(like_the_sixth(&kinds), 5);
    }

    #[test]
    fn what_is_near_a_place_is_part_of_its_kind() {
        let kinds = kinds("link more: q8 - q6 { spring 1e3 N/m; }");
        assert_ne!(kinds[5], kinds[4]);
        assert_eq!(like_the_sixth(&kinds), 1, "no other link has it above its upper end");
    }

    #[test]
    fn a_place_near_a_motion_that_no_output_shows_is_of_no_kind() {
        let kinds =
            kinds("output q1.acceleration; output q2.acceleration; output q3.acceleration; output q4.acceleration;");
        assert!(kinds[0].is_some() && kinds[5..].iter().all(Option::is_none));
    }
}
