//! Whatever a model file contains, it compiles or is refused with a message; the printed form of a readable file has
//! the same tree.

use qcar_dsl::check::check_members;
use qcar_dsl::compile::compile;
use qcar_dsl::parse::parse_text;
use qcar_dsl::source::Source;

/// No other file can be loaded.
fn nothing(_: &str, _: &str) -> Result<Source, String> {
    Err("there are no files".to_string())
}

/// Fails if the compiler panics or contradicts itself.
pub fn survives(text: &str) {
    let source = Source {
        name: "fuzz.axle".to_string(),
        text: text.to_string(),
    };
    let parsed = parse_text(&source, 0);
    if parsed.mistakes.is_empty() {
        let printed = Source {
            name: "printed".to_string(),
            text: parsed.file.to_string(),
        };
        let again = parse_text(&printed, 0);
        assert!(again.mistakes.is_empty(), "{}", printed.text);
        assert!(again.file == parsed.file, "{text}\nprints as\n{}", printed.text);
    }
    match compile(source.clone(), &nothing) {
        Ok(compiled) => drop(compiled),
        Err(report) => assert!(!report.to_string().is_empty() && !report.compact().is_empty()),
    }
    drop(check_members(source, &nothing));
}
