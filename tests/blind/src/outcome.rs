//! The answer to a case of the matrix, compared with the truth, as a line of a table.

use serde_json::Value;

use crate::hidden::Hidden;
use crate::matrix::{Case, Kind, family};

/// An answer and the truth.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    pub kind: Kind,
    /// Name of the case.
    pub case: String,
    /// RMS of the hidden effects' response that no parameter can reproduce, in units of the noise.
    pub strength: f64,
    /// The hidden effects.
    pub truth: Vec<Place>,
    /// `none`, `found`, `class`, `unknown`, or `failed` if there was no answer.
    pub verdict: String,
    /// Probability that the answer states. This and the following fields are `None` if the answer does not state them.
    pub probability: Option<f64>,
    /// The effects that the answer names.
    pub named: Vec<Place>,
    /// The members of the class, if several effects explain the data equally well.
    pub alike: Vec<Place>,
    /// Share of the excess of the squared held-out gap that the answer explains.
    pub closed: f64,
    /// Largest relative error of the parameters of rightly named effects.
    pub error: f64,
    /// Number of these parameters within two standard errors of the truth, and their total number.
    pub covered: (usize, usize),
    /// Place of the learned law and the share of the gap that it closes.
    pub learned: Option<(String, f64)>,
    /// Places at which the model lacks an effect, the most probable first.
    pub places: Vec<String>,
    /// The best candidates, each with its probability and the share of the gap that it explains.
    pub candidates: Vec<String>,
    /// Sensor, kind of run and the remaining residual, in percent of the signal.
    pub left: Vec<String>,
    pub seconds: f64,
}

/// An effect at its place. For a law that differs from the catalogue's, several names may count as right: `name` holds
/// them separated by `|`.
#[derive(Clone, Debug, PartialEq)]
pub struct Place {
    pub name: String,
    pub at: String,
}

/// The columns of the table.
pub const HEADER: &str = "kind\tcase\tstrength\ttruth\tverdict\tprobability\tnamed\talike\tclosed\terror\tcovered\tof\t\
                          learned_at\tlearned_closed\tplaces\tcandidates\tleft\tseconds";

impl Place {
    fn of_hidden(hidden: &Hidden) -> Self {
        Self {
            name: family(&hidden.name).to_owned(),
            at: hidden.at.clone(),
        }
    }

    /// From a JSON object with name and place, or from the text `effect@place`.
    fn of_json(value: &Value) -> Option<Self> {
        if let Some(text) = value.as_str() {
            return Some(Self::parse(text));
        }
        let name = value["effect"].as_str().or(value["name"].as_str())?;
        Some(Self {
            name: name.to_owned(),
            at: value["at"].as_str().unwrap_or_default().to_owned(),
        })
    }

    fn parse(text: &str) -> Self {
        let (name, at) = text.split_once('@').unwrap_or((text, ""));
        Self {
            name: name.to_owned(),
            at: at.to_owned(),
        }
    }

    /// `effect@place`.
    pub fn words(&self) -> String {
        format!("{}@{}", self.name, self.at)
    }

    /// Whether both name the same effect at the same place.
    pub fn is_named_by(&self, other: &Self) -> bool {
        self.has_name_of(other) && self.at == other.at
    }

    /// Whether the names agree, at any place.
    pub fn has_name_of(&self, other: &Self) -> bool {
        self.name.split('|').any(|name| name == other.name)
    }
}

impl Outcome {
    /// From the JSON of `qcar discover`.
    pub fn new(case: &Case, answer: &Value, strength: f64) -> Self {
        let findings = list(&answer["findings"]).chain(list(&answer["effects"]));
        let findings: Vec<&Value> = findings.collect();
        let is_alike = |finding: &&Value| finding["one_of"] == Value::Bool(true);
        let places = |values: &[&Value]| values.iter().copied().filter_map(Place::of_json).collect::<Vec<_>>();
        let (alike, named): (Vec<&Value>, Vec<&Value>) = findings.iter().partition(|finding| is_alike(finding));
        let mut outcome = Self {
            truth: truth(case),
            verdict: answer["verdict"].as_str().unwrap_or_default().to_owned(),
            probability: answer["probability"].as_f64(),
            named: places(&named),
            alike: places(&[alike, list(&answer["alike"]).collect()].concat()),
            closed: closed(answer),
            learned: learned(&answer["learned"]),
            places: words(&answer["places"], |place| Some(place["at"].as_str()?.to_owned())),
            candidates: words(&answer["candidates"], candidate),
            left: words(&answer["left"], left),
            seconds: answer["seconds"].as_f64().unwrap_or(f64::NAN),
            ..Self::failed(case, strength)
        };
        for hidden in &case.order.effects {
            let truth = Place::of_hidden(hidden);
            let found = |finding: &&&Value| Place::of_json(finding).is_some_and(|own| truth.is_named_by(&own));
            if let Some(finding) = findings.iter().find(found) {
                outcome.compare(hidden, finding);
            }
        }
        outcome
    }

    /// An outcome without an answer.
    pub fn failed(case: &Case, strength: f64) -> Self {
        Self {
            kind: case.kind,
            case: case.name.clone(),
            strength,
            truth: truth(case),
            verdict: "failed".to_owned(),
            probability: None,
            named: Vec::new(),
            alike: Vec::new(),
            closed: 0.0,
            error: 0.0,
            covered: (0, 0),
            learned: None,
            places: Vec::new(),
            candidates: Vec::new(),
            left: Vec::new(),
            seconds: f64::NAN,
        }
    }

    fn compare(&mut self, hidden: &Hidden, finding: &Value) {
        for (name, truth) in &hidden.parameters {
            let Some(value) = finding["parameters"][name].as_f64() else {
                continue;
            };
            let stderr = finding["stderr"][name].as_f64();
            if stderr == Some(0.0) {
                continue;
            }
            let truth = truth * scale(hidden, finding, name);
            self.error = self.error.max((value / truth - 1.0).abs());
            if let Some(error) = stderr {
                self.covered.0 += usize::from((value - truth).abs() <= 2.0 * error);
                self.covered.1 += 1;
            }
        }
    }

    /// The outcome as a line of the table.
    pub fn line(&self) -> String {
        let join = |places: &[Place]| places.iter().map(Place::words).collect::<Vec<_>>().join("+");
        let (learned_at, learned_closed) = match &self.learned {
            Some((at, closed)) => (at.as_str(), format!("{closed:.4}")),
            None => ("", String::new()),
        };
        [
            format!("{:?}", self.kind),
            self.case.clone(),
            format!("{:.3}", self.strength),
            join(&self.truth),
            self.verdict.clone(),
            self.probability.map_or(String::new(), |p| format!("{p:.4}")),
            join(&self.named),
            join(&self.alike),
            format!("{:.4}", self.closed),
            format!("{:.4}", self.error),
            self.covered.0.to_string(),
            self.covered.1.to_string(),
            learned_at.to_owned(),
            learned_closed,
            self.places.join("+"),
            self.candidates.join("+"),
            self.left.join("+"),
            format!("{:.1}", self.seconds),
        ]
        .join("\t")
    }

    /// Reads such a line.
    ///
    /// # Errors
    /// A line with a wrong number of cells, an unknown kind, or text where a number is expected.
    pub fn parse(line: &str) -> Result<Self, String> {
        let cells: Vec<&str> = line.split('\t').collect();
        let expected = HEADER.split('\t').count();
        if cells.len() != expected {
            return Err(format!("{} columns where {expected} are expected: {line}", cells.len()));
        }
        let cell = |name: &str| {
            let place = HEADER.split('\t').position(|column| column == name);
            cells[place.expect("a column of the table")]
        };
        let number = |name: &str| {
            let cell = cell(name);
            cell.parse()
                .map_err(|_| format!("{name} is {cell}, a number is expected: {line}"))
        };
        let count = |name: &str| number(name).map(|value: f64| value as usize);
        let optional = |name: &str| {
            Some(cell(name))
                .filter(|cell| !cell.is_empty())
                .map(|_| number(name))
                .transpose()
        };
        let parts = |name: &str| {
            let parts = cell(name).split('+').filter(|part| !part.is_empty());
            parts.map(str::to_owned).collect::<Vec<_>>()
        };
        let places = |name: &str| parts(name).iter().map(|part| Place::parse(part)).collect::<Vec<_>>();
        let kind = cell("kind");
        Ok(Self {
            kind: Kind::named(kind).ok_or(format!("there is no kind {kind}: {line}"))?,
            case: cell("case").to_owned(),
            strength: number("strength")?,
            truth: places("truth"),
            verdict: cell("verdict").to_owned(),
            probability: optional("probability")?,
            named: places("named"),
            alike: places("alike"),
            closed: number("closed")?,
            error: number("error")?,
            covered: (count("covered")?, count("of")?),
            learned: optional("learned_closed")?.map(|closed| (cell("learned_at").to_owned(), closed)),
            places: parts("places"),
            candidates: parts("candidates"),
            left: parts("left"),
            seconds: number("seconds")?,
        })
    }
}

fn list(value: &Value) -> impl Iterator<Item = &Value> {
    value.as_array().into_iter().flatten()
}

fn words(value: &Value, word: impl Fn(&Value) -> Option<String>) -> Vec<String> {
    list(value).filter_map(word).collect()
}

/// Factor that converts a true parameter to the answer's units. The answer assumes a half length of the sub-frame,
/// which scales its pitch inertia and offset. The factor is 1 for every other parameter.
fn scale(hidden: &Hidden, finding: &Value, name: &str) -> f64 {
    let length = || Some(finding["parameters"]["half_length"].as_f64()? / hidden.get("half_length"));
    match (hidden.name.as_str(), name) {
        ("subframe_pitch", "inertia") => length().map_or(1.0, |ratio| ratio.powi(2)),
        ("subframe_pitch", "arm_offset") => length().unwrap_or(1.0),
        _ => 1.0,
    }
}

fn truth(case: &Case) -> Vec<Place> {
    case.order.effects.iter().map(Place::of_hidden).collect()
}

/// The share that the answer states, or else the share that follows from the gaps that it states.
fn closed(answer: &Value) -> f64 {
    if let Some(explained) = answer["explained"].as_f64() {
        return explained;
    }
    let gap = |when: &str| (answer["gap"]["held_out"][when].as_f64().unwrap_or(1.0).powi(2) - 1.0).max(0.0);
    if gap("before") > 0.0 {
        1.0 - gap("after") / gap("before")
    } else {
        0.0
    }
}

fn learned(value: &Value) -> Option<(String, f64)> {
    let explained = value["explained"].as_f64().unwrap_or(0.0);
    Some((value["at"].as_str()?.to_owned(), explained))
}

/// `effect@place:probability:explained`.
fn candidate(value: &Value) -> Option<String> {
    let place = Place::of_json(value)?;
    let share = |name: &str| {
        value[name]
            .as_f64()
            .map_or(String::new(), |share| format!("{share:.3}"))
    };
    Some(format!(
        "{}:{}:{}",
        place.words(),
        share("probability"),
        share("explained")
    ))
}

/// `sensor/kind:percent`.
fn left(value: &Value) -> Option<String> {
    let (sensor, kind) = (value["channel"].as_str()?, value["kind"].as_str()?);
    Some(format!("{sensor}/{kind}:{:.2}", value["after_percent"].as_f64()?))
}
