//! Roads on the command line with their speed: `C@60km/h`, `belgian.crg#v=0.5@50km/h:20s`.

use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use qcar_runtime::campaign::{Declared, RoadSamples, RoleNames};
use qcar_runtime::error::{InputError, Place, Problem};
use qcar_runtime::metric::{Course, SEED};
use qcar_runtime::model::About;
use qcar_runtime::road::{Class, Road, RoadError};
use qcar_runtime::roles::Roles;
use qcar_runtime::shown::shown;

use crate::failure::flag;

/// A random road of ISO 8608 or a measured profile, with speed and duration.
#[derive(Clone, Debug, PartialEq)]
pub struct RequestedRoad {
    /// The text that names it, for messages.
    written: String,
    ground: Ground,
    /// Speed, m/s.
    speed: f64,
    /// Duration, s.
    duration: Option<f64>,
    /// The file that names it; `None` for the command line.
    file: Option<PathBuf>,
}

#[derive(Clone, Debug, PartialEq)]
enum Ground {
    /// A class and the seed of its random numbers.
    Random(Class, u64),
    /// A file and the name of its channel of heights.
    Measured(PathBuf, Option<String>),
}

/// Checks that a model rolls over roads, for the `option` or subject that asks for it.
///
/// # Errors
/// Fails if the model has no tyre or several, or if a role is that of no mass.
pub fn check_rolls(about: &About, named: &RoleNames, option: &str) -> Result<(), InputError> {
    let rolls = Roles::of(about, named).map(drop);
    rolls.map_err(|error| {
        let remedy = "leave the road out, or name another model";
        flag(option, error, "a model that stands on one road", remedy).into()
    })
}

/// The expected form, for messages.
pub const EXPECTED: &str = "a road and a speed: C@60km/h (class of ISO 8608), C#7@60km/h (its seed), road.crg#v=0.5@50km/h (file and channel), \
                            each perhaps with a duration such as :20s";

/// The classes from A on.
const CLASSES: [(&str, Class); 8] = [
    ("A", Class::A),
    ("B", Class::B),
    ("C", Class::C),
    ("D", Class::D),
    ("E", Class::E),
    ("F", Class::F),
    ("G", Class::G),
    ("H", Class::H),
];

/// Smallest and largest speed, m/s.
const SPEEDS: RangeInclusive<f64> = 0.5..=100.0;
/// Shortest ride, s: about one oscillation of the body, with spectral lines at each hertz.
const SHORTEST: f64 = 1.0;
/// Longest ride, s: a road of ISO 8608 is a sum of sines, and a record is kept in memory.
const LONGEST: f64 = 600.0;
/// Durations of a ride, s.
const DURATIONS: RangeInclusive<f64> = SHORTEST..=LONGEST;

impl FromStr for RequestedRoad {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let expected = || format!("expected {EXPECTED}; found `{text}`");
        let (ground, driven) = text.rsplit_once('@').ok_or_else(expected)?;
        let (speed, duration) = match driven.split_once(':') {
            Some((speed, duration)) => (speed, Some(duration)),
            None => (driven, None),
        };
        let speed = quantity(speed, "m/s").ok_or_else(expected)?;
        let duration = duration
            .map(|text| quantity(text, "s").ok_or_else(expected))
            .transpose()?;
        Ok(Self {
            written: text.into(),
            ground: Ground::of(ground.trim()).ok_or_else(expected)?,
            speed,
            duration,
            file: None,
        })
    }
}

/// The SI value of a number with a unit of the kind of `unit`.
pub fn quantity(text: &str, unit: &str) -> Option<f64> {
    let (value, _) = Declared::quantity(text).filter(|(_, own)| own.is_like(unit))?;
    Some(value)
}

/// Checks the speed (m/s) of a ride; `problem` makes one of what was found, what was expected and the remedy.
///
/// # Errors
/// Fails if no ride is so slow or so fast.
pub fn check_speed(speed: f64, problem: impl FnOnce(String, &str, &str) -> Problem) -> Result<(), InputError> {
    within(("speed", speed), &SPEEDS, "m/s", problem)
}

fn within(
    (what, value): (&str, f64),
    range: &RangeInclusive<f64>,
    si: &str,
    problem: impl FnOnce(String, &str, &str) -> Problem,
) -> Result<(), InputError> {
    if range.contains(&value) {
        return Ok(());
    }
    let (least, most) = (shown(*range.start(), si), shown(*range.end(), si));
    let expected = format!("at least {least} and at most {most}");
    let remedy = format!("write another {what}");
    Err(problem(format!("a {what} of {}", shown(value, si)), &expected, &remedy).into())
}

impl Ground {
    fn of(text: &str) -> Option<Self> {
        let (name, choice) = match text.rsplit_once('#') {
            Some((name, choice)) => (name, Some(choice)),
            None => (text, None),
        };
        match CLASSES.iter().find(|(class, _)| *class == name) {
            Some((_, class)) => Some(Ground::Random(
                *class,
                choice.map_or(Some(SEED), |seed| seed.parse().ok())?,
            )),
            // A single letter is read as a class.
            None => (name.len() > 1).then(|| Ground::Measured(name.into(), choice.map(String::from))),
        }
    }
}

impl RequestedRoad {
    /// The same in a file: the path of the profile is relative to the folder of that file.
    #[must_use]
    pub fn asked_in(mut self, file: &Path) -> Self {
        if let Ground::Measured(profile, _) = &mut self.ground {
            *profile = file.parent().unwrap_or(Path::new("")).join(&*profile);
        }
        self.file = Some(file.into());
        self
    }

    /// A problem at the place where the road is named.
    fn problem(&self, found: String, expected: &str, remedy: &str) -> Problem {
        match &self.file {
            None => flag(&format!("--road {}", self.written), found, expected, remedy),
            Some(file) => Problem::new(file, Place::Name("roads".into()), found, expected, remedy),
        }
    }

    /// Speed and duration are checked here, not where the text is read: the units of messages are known now.
    fn check(&self) -> Result<(), InputError> {
        let problem = |found: String, expected: &str, remedy: &str| self.problem(found, expected, remedy);
        check_speed(self.speed, problem)?;
        match self.duration {
            Some(duration) => within(("duration", duration), &DURATIONS, "s", problem),
            None => Ok(()),
        }
    }

    /// The road.
    ///
    /// # Errors
    /// Fails if a file cannot be read or is no road, or if the ride is too slow, too fast, too short or too long.
    pub fn course(&self) -> Result<Course, InputError> {
        self.check()?;
        match &self.ground {
            Ground::Random(class, seed) => {
                let course = Course::random(*class, *seed, self.speed, self.duration);
                course.map_err(|error| {
                    self.problem(error.to_string(), &error.expected(), error.remedy())
                        .into()
                })
            }
            Ground::Measured(file, source) => self.along(file, source.as_deref()),
        }
    }

    fn along(&self, file: &Path, source: Option<&str>) -> Result<Course, InputError> {
        let samples = RoadSamples::measured(file, source)?;
        let road = Road::from_samples(&samples.x, &samples.z, &samples.slope).map_err(|error| no_road(file, &error))?;
        let [first, last] = road.extent();
        let whole = (last - first) / self.speed;
        if self.duration.unwrap_or(whole) > LONGEST {
            let found = format!("a road that takes {whole:.0} s");
            let remedy = format!("drive over a part of it: write `:{LONGEST}s` after the speed");
            return Err(Problem::new(file, Place::File, found, "a ride of at most ten minutes", remedy).into());
        }
        if whole < SHORTEST {
            let found = format!("a road that takes {whole:.3} s");
            let remedy = "choose a lower speed, or give a longer road";
            let expected = format!("a ride of at least {SHORTEST} s");
            return Err(Problem::new(file, Place::File, found, expected, remedy).into());
        }
        let stem = file.file_stem().unwrap_or_default().to_string_lossy();
        let chosen = source.map_or_else(String::new, |source| format!("_{}", plain(source)));
        Course::along(&format!("{}{chosen}", plain(&stem)), road, self.speed, self.duration)
            .map_err(|error| no_road(file, &error))
    }
}

/// The roads, each with a name that differs from all others and from the courses `beside` them.
///
/// # Errors
/// Fails as [`RequestedRoad::course`] does, or if two have one name.
pub fn courses(roads: &[RequestedRoad], beside: &[Course]) -> Result<Vec<Course>, InputError> {
    let mut courses: Vec<Course> = Vec::new();
    for road in roads {
        let course = road.course()?;
        if courses.iter().chain(beside).any(|own| own.name == course.name) {
            let found = format!("two rides called {}", course.name);
            let remedy = "remove one of them; another seed, channel, speed or duration makes another ride";
            return Err(road.problem(found, "each ride once", remedy).into());
        }
        courses.push(course);
    }
    Ok(courses)
}

fn no_road(file: &Path, error: &RoadError) -> InputError {
    Problem::new(file, Place::File, error.to_string(), error.expected(), error.remedy()).into()
}

/// A name that may be part of a file name.
fn plain(name: &str) -> String {
    let is_plain = |c: &char| c.is_alphanumeric() || "-_=.+".contains(*c);
    name.chars().map(|c| if is_plain(&c) { c } else { '_' }).collect()
}

#[cfg(test)]
mod tests {
    use qcar_runtime::road::Class;

    use super::{Ground, RequestedRoad};

    #[test]
    fn a_road_is_named_in_one_word() {
        let of = |text: &str| text.parse::<RequestedRoad>();
        let measured = |file: &str, channel: Option<&str>| Ground::Measured(file.into(), channel.map(String::from));
        for (text, ground, speed, duration) in [
            ("C@36km/h", Ground::Random(Class::C, 1), 10.0, None),
            ("H#7@10 m/s:30s", Ground::Random(Class::H, 7), 10.0, Some(30.0)),
            ("a/b@c.crg@36km/h", measured("a/b@c.crg", None), 10.0, None),
            (
                "b.crg#v=-0.5@36km/h:2s",
                measured("b.crg", Some("v=-0.5")),
                10.0,
                Some(2.0),
            ),
        ] {
            let asked = of(text).unwrap();
            assert_eq!(
                (asked.ground, asked.speed, asked.duration),
                (ground, speed, duration),
                "{text}"
            );
        }
        for text in ["", "C", "C@60", "C#x@60km/h", "@60km/h", "C@20mm"] {
            assert!(of(text).is_err(), "{text}");
        }
        for text in ["C@0km/h", "C@1000km/h", "C@60km/h:0s", "C@60km/h:0.9s", "C@60km/h:1h"] {
            assert!(of(text).unwrap().check().is_err(), "{text}");
        }
    }
}
