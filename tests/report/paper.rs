//! The report on A4: every run, every column, and nothing that answers to a pointer.

use super::browser::{printed, printer_or_word};
use super::studied::Studied;
use super::{ONE_MISSING, page};

#[test]
fn paper_has_every_column_and_every_run() {
    let Some(browser) = printer_or_word() else { return };
    let text = printed(&browser, &page(&ONE_MISSING), &["-layout"]);
    let line = |start: &str| text.lines().find(|line| line.starts_with(start)).unwrap_or("");
    assert!(line("parameter  ").ends_with("extended"), "{text}");
    for parameter in ["m_wheel ", "k_tire ", "c_tire "] {
        assert_eq!(line(parameter).matches('±').count(), 2, "{}", line(parameter));
    }
    for sweep in ["sweep_025 (fit)", "sweep_050 (held out)", "sweep_100 (fit)"] {
        assert!(text.contains(sweep), "{sweep} in {text}");
    }
    for (speed, height) in [(20, 20), (20, 30), (30, 20), (30, 30), (40, 20), (40, 30)] {
        let run = format!("{speed} km/h, cleat {height} (");
        assert_eq!(
            text.matches(&run).count(),
            2,
            "{run} as it is and as variants, in {text}"
        );
        assert!(text.contains(&format!("{height} mm, {speed} km/h")), "{text}");
    }
    for model in ["axle_c", "axle_c_with_suspended_mass"] {
        assert!(
            text.contains(&format!("Equations of motion of {model}\n")),
            "{model} in {text}"
        );
    }
    for map in ["first harmonic", "cleat runs", "K&C curves"] {
        assert!(text.contains(&format!("Baseline model: {map}")), "{map} in {text}");
    }
    for control in ["Copy", "CSV", "Dark page", "Point at a tile", "Drag over"] {
        assert!(!text.contains(control), "{control} in {text}");
    }
}

/// A wish may be missed, a target may not.
#[test]
fn a_wish_is_marked_as_one() {
    let Some(browser) = printer_or_word() else { return };
    let text = printed(&browser, &page(&Studied::targets()), &["-layout"]);
    assert!(text.contains("(wish)"), "{text}");
    assert!(text.contains("All targets that must hold are met"), "{text}");
}

/// Of each word with its height, or the width of one that is turned, none is below that of a text of six points.
#[test]
fn no_word_on_paper_is_too_small_to_read() {
    let Some(browser) = printer_or_word() else { return };
    for report in [page(&ONE_MISSING), page(&Studied::sensitivities())] {
        let boxes = printed(&browser, &report, &["-bbox"]);
        for word in boxes.lines().filter(|line| line.contains("<word ")) {
            let end = |name: &str| number(word, name);
            let [width, height] = [end("xMax") - end("xMin"), end("yMax") - end("yMin")];
            let letters = word
                .split('>')
                .nth(1)
                .map_or(0, |text| text.chars().take_while(|c| *c != '<').count());
            assert!(letters < 4 || width.min(height) > 6.0, "{word}");
        }
    }
}

/// The value of an attribute of a line.
fn number(line: &str, name: &str) -> f64 {
    let value = line.split(&format!("{name}=\"")).nth(1).unwrap();
    value.split('"').next().unwrap().parse().unwrap()
}

#[test]
fn paper_is_a4_and_cuts_no_word() {
    let Some(browser) = printer_or_word() else { return };
    let boxes = printed(&browser, &page(&ONE_MISSING), &["-bbox"]);
    let pages = boxes.lines().filter(|line| line.contains("<page "));
    for page in pages {
        let size = (number(page, "width").round(), number(page, "height").round());
        assert_eq!(size, (595.0, 842.0), "{page}");
    }
    // Margins of 12 mm are 34 points.
    let words = boxes.lines().filter(|line| line.contains("<word "));
    for word in words {
        assert!(number(word, "xMin") > 33.0 && number(word, "xMax") < 562.0, "{word}");
    }
}
