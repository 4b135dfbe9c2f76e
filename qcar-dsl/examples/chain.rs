//! Chains of masses, to see how the compiler's work grows with their length.
//!
//! `cargo run --release -p qcar-dsl --example chain -- 80` prints a chain of 80 masses, with `own` after the number one
//! whose masses, springs and dampers each have a parameter; without a number it prints how long each stage takes for
//! chains of several lengths.

use std::time::Instant;

use qcar_dsl::check::check_text;
use qcar_dsl::compile::derive;
use qcar_dsl::show::{Stage, show};
use qcar_dsl::source::Source;

/// A chain of masses, each on the one below it, the first on a road. Its parameters are those of one member, or each
/// member has `own` ones.
pub fn chain(masses: usize, own: bool) -> String {
    let mark = |place: usize| if own { place.to_string() } else { String::new() };
    let parameter = |mark: String| {
        format!(
            "    known param m{mark}: kg = 2 in 1..5;\n    param k{mark}: N/m = 4e3 in 1e3..1e5;\n    \
             param c{mark}: N s/m = 30 in 1..100;\n"
        )
    };
    let parameters = if own {
        (1..=masses).map(|place| parameter(mark(place))).collect()
    } else {
        parameter(mark(0))
    };
    let member = |place: usize| {
        let below = if place == 1 {
            "road_below".to_string()
        } else {
            format!("q{}", place - 1)
        };
        let mark = mark(place);
        format!(
            "        mass q{place} = m{mark};\n        \
             link l{place}: q{place} - {below} {{ spring k{mark}; damper c{mark}; }}\n"
        )
    };
    let members: String = (1..=masses).map(member).collect();
    format!(
        "axle chain {{\n    \"A chain of masses\"\n{parameters}    direction z {{\n        road road_below;\n{members}    }}\n}}\n"
    )
}

/// The chain as a source.
pub fn source(masses: usize, own: bool) -> Source {
    Source {
        name: "chain.axle".to_string(),
        text: chain(masses, own),
    }
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let own = arguments.iter().any(|argument| argument == "own");
    match arguments.first().and_then(|first| first.parse().ok()) {
        Some(masses) => print!("{}", chain(masses, own)),
        None => [10, 20, 40, 80].into_iter().for_each(|masses| measure(masses, own)),
    }
}

fn measure(masses: usize, own: bool) {
    let mut said = format!("{masses:3} masses");
    let mut clock = Instant::now();
    let mut lap = |what: &str| {
        said += &format!("  {what} {:.1} ms", 1e3 * clock.elapsed().as_secs_f64());
        clock = Instant::now();
    };
    let checked =
        check_text(source(masses, own), &|_, _| Err(String::new())).unwrap_or_else(|report| panic!("{report}"));
    lap("check");
    let compiled = derive(checked);
    lap("derive");
    for stage in Stage::ALL {
        let text = show(&compiled, stage);
        lap(&format!("{} ({} B)", stage.name(), text.len()));
    }
    println!("{said}");
}
