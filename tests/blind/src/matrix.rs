//! The cases of the blind matrix.

mod entries;
mod other_laws;

pub use other_laws::{family, only_place};

use crate::Order;
use crate::hardware::Flaw;
use crate::hidden::Hidden;
use crate::programme::Programme;
use crate::random::Random;

use entries::{Entry, OUTSIDE, OUTSIDE_LATER, SINGLES};
use other_laws::OTHER_LAWS;

/// The kind of a case.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    /// One effect of the catalogue is hidden.
    Single,
    /// Nothing is hidden.
    Clean,
    /// One effect that is not in the catalogue is hidden.
    Outside,
    /// Two effects are hidden.
    Pair,
    /// Nothing is hidden, in a short campaign.
    FastClean,
    /// Nothing is hidden in hardware with flaws.
    HardwareClean,
    /// One effect of usual strength is hidden in hardware with flaws.
    HardwareSingle,
    /// One effect of usual strength is hidden in a campaign with few runs, sensors or frequencies.
    Minimal,
    /// One effect of usual strength is hidden, with a law that differs from the catalogue's.
    OtherLaw,
}

impl Kind {
    /// All kinds.
    pub const ALL: [Self; 9] = [
        Self::Single,
        Self::Clean,
        Self::Outside,
        Self::Pair,
        Self::FastClean,
        Self::HardwareClean,
        Self::HardwareSingle,
        Self::Minimal,
        Self::OtherLaw,
    ];

    /// The kind with this name, as `{:?}` prints it.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| format!("{kind:?}") == name)
    }
}

/// A campaign of the matrix.
#[derive(Clone, Debug)]
pub struct Case {
    /// The kind of the case.
    pub kind: Kind,
    /// Unique name.
    pub name: String,
    /// The campaign.
    pub order: Order,
}

/// Places of two entries of [`SINGLES`] that are hidden together.
const PAIRS: [(usize, usize); 8] = [(3, 1), (5, 7), (3, 19), (1, 20), (0, 5), (16, 3), (11, 5), (21, 6)];

/// Noise levels of the rig's accelerometers, m/s², used in turn.
const NOISE: [f64; 3] = [0.02, 0.01, 0.04];

/// The first seed that draws strengths, pairs, noise and gain errors at random. Earlier seeds take them from tables.
const DRAWN: u64 = 3;

/// Ranges of strength from 0, the weakest effect, to 1, the strongest: the whole range, and the part from the usual
/// strength on.
const ANY: (f64, f64) = (0.0, 1.0);
const USUAL: (f64, f64) = (0.5, 1.0);

/// The cases of one seed.
pub fn cases(seed: u64) -> Vec<Case> {
    let draw = Draw { seed };
    let mut cases = draw.of_entries(Kind::Single, &SINGLES);
    cases.extend(draw.of_entries(Kind::Outside, &OUTSIDE));
    if draw.is_fresh() {
        cases.extend(draw.outside_later());
    }
    cases.extend(draw.clean());
    cases.extend(draw.pairs());
    cases.extend(draw.fast_clean());
    cases.extend(draw.hardware_clean());
    cases.extend(draw.hardware_single());
    cases.extend(draw.minimal());
    cases.extend(draw.other_laws());
    cases
}

/// Makes the cases of a seed.
struct Draw {
    seed: u64,
}

impl Draw {
    fn is_fresh(&self) -> bool {
        self.seed >= DRAWN
    }

    fn random(&self, purpose: &str) -> Random {
        Random::new(self.seed, purpose)
    }

    /// A campaign order with the noise and gain errors that belong to its number.
    fn order(&self, k: usize, axle: &str, effects: Vec<Hidden>) -> Order {
        let mut random = self.random(&format!("bench {k}"));
        let (noise, systematic) = if self.is_fresh() {
            (
                0.01 * 4_f64.powf(random.uniform(0.0, 1.0)),
                random.uniform(0.003, 0.012),
            )
        } else {
            (NOISE[k % NOISE.len()], if k.is_multiple_of(2) { 0.005 } else { 0.01 })
        };
        Order {
            noise,
            systematic,
            effects,
            ..Order::clean(axle, self.seed * 1000 + k as u64)
        }
    }

    /// The effect at this index of the table, or drawn at random.
    fn hidden(&self, entry: &Entry, strength: usize, purpose: &str, strengths: (f64, f64)) -> Hidden {
        if self.is_fresh() {
            entry.drawn(strengths, &mut self.random(purpose))
        } else {
            entry.hidden(strength)
        }
    }

    fn case(&self, kind: Kind, name: &str, order: Order) -> Case {
        Case {
            kind,
            name: format!("{name} seed {}", self.seed),
            order,
        }
    }

    /// Each entry of the table three times.
    fn of_entries(&self, kind: Kind, entries: &[Entry]) -> Vec<Case> {
        let mut cases = Vec::new();
        for (k, entry) in entries.iter().enumerate() {
            for strength in 0..3 {
                let name = format!("{} {strength}", entry.title());
                let hidden = self.hidden(entry, strength, &name, ANY);
                let order = self.order(3 * k + strength + k % 2, entry.axle, vec![hidden]);
                cases.push(self.case(kind, &name, order));
            }
        }
        cases
    }

    fn outside_later(&self) -> Vec<Case> {
        let of_number = |(k, entry): (usize, &Entry)| {
            let name = format!("{} {k}", entry.title());
            let hidden = self.hidden(entry, 1, &name, ANY);
            self.case(Kind::Outside, &name, self.order(250 + k, entry.axle, vec![hidden]))
        };
        let twice = OUTSIDE_LATER.iter().chain(&OUTSIDE_LATER);
        twice.enumerate().map(of_number).collect()
    }

    fn clean(&self) -> Vec<Case> {
        let axles = ["a", "c", "d", "a", "c", "d", "c", "a", "d", "c"];
        let of_axle = |(k, axle): (usize, &str)| {
            let order = self.order(200 + k, axle, Vec::new());
            self.case(Kind::Clean, &format!("clean {axle}{k}"), order)
        };
        axles.into_iter().enumerate().map(of_axle).collect()
    }

    fn pairs(&self) -> Vec<Case> {
        let mut cases = Vec::new();
        for (k, pair) in PAIRS.into_iter().enumerate() {
            let (one, other) = if self.is_fresh() {
                draw_pair(&mut self.random(&format!("pair {k}")))
            } else {
                (&SINGLES[pair.0], &SINGLES[pair.1])
            };
            let with_powertrain = |entry: &Entry| entry.name == "suspended_mass" || entry.at == "powertrain_mount";
            let axle = if with_powertrain(one) || with_powertrain(other) {
                "a"
            } else {
                "c"
            };
            let number = if self.is_fresh() {
                format!(" {k}")
            } else {
                String::new()
            };
            let name = format!("{}@{} and {}@{}{number}", one.name, one.at, other.name, other.at);
            let effects = [one, other].map(|entry| self.hidden(entry, 1, &format!("{name}: {}", entry.name), USUAL));
            cases.push(self.case(Kind::Pair, &name, self.order(300 + k, axle, effects.to_vec())));
        }
        cases
    }

    /// A hundred cases, all drawn at random.
    fn fast_clean(&self) -> Vec<Case> {
        let of_number = |k: usize| {
            let mut random = self.random(&format!("fast clean {k}"));
            let axle = any(&["a", "c", "d"], &mut random);
            let order = Order {
                noise: 0.01 * 4_f64.powf(random.uniform(0.0, 1.0)),
                systematic: random.uniform(0.003, 0.012),
                programme: Programme::fast(),
                ..self.order(400 + k, axle, Vec::new())
            };
            self.case(Kind::FastClean, &format!("fast clean {axle}{k}"), order)
        };
        (0..100).map(of_number).collect()
    }

    /// Each flaw alone, all mild flaws together in twenty cases (half of them short), and the flaw that is not mild.
    fn hardware_clean(&self) -> Vec<Case> {
        let mut all: Vec<(String, Vec<Flaw>, Programme)> = Vec::new();
        all.extend(Flaw::MILD.map(|flaw| (format!("{flaw:?} alone"), vec![flaw], Programme::full())));
        let together = |words: &str, programme| (words.to_owned(), Flaw::MILD.to_vec(), programme);
        all.extend(vec![together("together", Programme::full()); 10]);
        all.extend(vec![together("together fast", Programme::fast()); 10]);
        all.push((format!("{:?} alone", Flaw::Cams), vec![Flaw::Cams], Programme::full()));
        let of_number = |(k, (words, flaws, programme)): (usize, (String, Vec<Flaw>, Programme))| {
            let axle = any(&["a", "c", "d"], &mut self.random(&format!("hardware {k}")));
            let order = Order {
                flaws,
                programme,
                ..self.order(500 + k, axle, Vec::new())
            };
            self.case(Kind::HardwareClean, &format!("hardware {axle}{k} {words}"), order)
        };
        all.into_iter().enumerate().map(of_number).collect()
    }

    /// Each effect of the car in hardware with all flaws.
    fn hardware_single(&self) -> Vec<Case> {
        let of_entry = |(k, entry): (usize, &Entry)| {
            let name = format!("hardware {}", entry.title());
            let hidden = self.hidden(entry, 1, &name, USUAL);
            let order = Order {
                flaws: Flaw::MILD.to_vec(),
                ..self.order(600 + k, entry.axle, vec![hidden])
            };
            self.case(Kind::HardwareSingle, &name, order)
        };
        of_car().into_iter().enumerate().map(of_entry).collect()
    }

    /// Random effects in campaigns with few runs, sensors or frequencies.
    fn minimal(&self) -> Vec<Case> {
        let of_number = |k: usize| {
            let mut random = self.random(&format!("minimal {k}"));
            let (words, programme) = little(k, &mut random);
            let entry = any(&of_car(), &mut random);
            let hidden = entry.drawn(USUAL, &mut random);
            let order = Order {
                programme,
                ..self.order(700 + k, entry.axle, vec![hidden])
            };
            self.case(Kind::Minimal, &format!("{words}: {} {k}", entry.title()), order)
        };
        (0..32).map(of_number).collect()
    }

    /// Each law of another form twice.
    fn other_laws(&self) -> Vec<Case> {
        let mut cases = Vec::new();
        for (k, (entry, _)) in OTHER_LAWS.iter().enumerate() {
            for draw in 0..2 {
                let name = format!("{} {draw}", entry.title());
                let hidden = self.hidden(entry, 1 + draw, &name, USUAL);
                let order = self.order(800 + 2 * k + draw, entry.axle, vec![hidden]);
                cases.push(self.case(Kind::OtherLaw, &name, order));
            }
        }
        cases
    }
}

/// The reduced campaigns, used in turn.
pub const LITTLE: [&str; 4] = ["no body sensor", "one sweep", "cleats alone", "a third of the band"];

fn little(k: usize, random: &mut Random) -> (&'static str, Programme) {
    let programme = match k % LITTLE.len() {
        0 => Programme::no_body_sensor(),
        1 => Programme::one_sweep(any(&[50, 100, 150], random)),
        2 => Programme::cleats_alone(),
        _ => {
            let (from, to) = any(&[(0.5, 10.0), (5.0, 15.0), (10.0, 20.0), (20.0, 30.0)], random);
            Programme::band(from, to)
        }
    };
    (LITTLE[k % LITTLE.len()], programme)
}

/// Effects of the car; those of sensors are excluded.
fn of_car() -> Vec<&'static Entry> {
    let all = SINGLES.iter();
    all.filter(|entry| !entry.name.starts_with("sensor_")).collect()
}

/// A random one of several.
fn any<T: Copy>(of: &[T], random: &mut Random) -> T {
    of[random.uniform(0.0, of.len() as f64) as usize]
}

/// Two effects at different places that an upright axle can have together.
fn draw_pair(random: &mut Random) -> (&'static Entry, &'static Entry) {
    let fits = |entry: &&Entry| entry.axle != "d" && !entry.name.starts_with("sensor_") && entry.name != "top_mount";
    let all: Vec<&Entry> = SINGLES.iter().filter(fits).collect();
    let mut any = || all[random.uniform(0.0, all.len() as f64) as usize];
    loop {
        let (one, other) = (any(), any());
        if one.at != other.at {
            return (one, other);
        }
    }
}
