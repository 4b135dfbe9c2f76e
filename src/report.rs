//! A report as one HTML file with its text, figures and data, which needs no network.

use serde::Serialize;

use crate::json::inert;
use crate::units;

// Numbers rounded for the page.
pub mod rounded;

const TEMPLATE: &str = include_str!("report/page.html");

/// Plots: uPlot 1.6.32, with its licence beside it.
const UPLOT: [&str; 2] = [
    include_str!("report/uplot/uPlot.min.css"),
    include_str!("report/uplot/uPlot.iife.min.js"),
];

const STYLE: [&str; 4] = [
    include_str!("report/css/page.css"),
    include_str!("report/css/parts.css"),
    include_str!("report/css/figures.css"),
    include_str!("report/css/print.css"),
];

/// Scripts that all reports share, in the order in which they use each other.
const SCRIPTS: [&str; 15] = [
    include_str!("report/js/view.js"),
    include_str!("report/js/format.js"),
    include_str!("report/js/units.js"),
    include_str!("report/js/dom.js"),
    include_str!("report/js/export.js"),
    include_str!("report/js/roles.js"),
    include_str!("report/js/sketch.js"),
    include_str!("report/js/plot.js"),
    include_str!("report/js/keys.js"),
    include_str!("report/js/picker.js"),
    include_str!("report/js/layout.js"),
    include_str!("report/js/axle.js"),
    include_str!("report/js/sliders.js"),
    include_str!("report/js/theme.js"),
    include_str!("report/js/page.js"),
];

/// The sections of a study; the last one starts.
const STUDY: [&str; 20] = [
    include_str!("report/js/shapes.js"),
    include_str!("report/js/changes.js"),
    include_str!("report/js/judgement.js"),
    include_str!("report/js/verdict.js"),
    include_str!("report/js/curves.js"),
    include_str!("report/js/tried.js"),
    include_str!("report/js/rig.js"),
    include_str!("report/js/parameters.js"),
    include_str!("report/js/modes.js"),
    include_str!("report/js/grid.js"),
    include_str!("report/js/track.js"),
    include_str!("report/js/orbit.js"),
    include_str!("report/js/records.js"),
    include_str!("report/js/heat.js"),
    include_str!("report/js/gap.js"),
    include_str!("report/js/effects.js"),
    include_str!("report/js/discovery.js"),
    include_str!("report/js/record.js"),
    include_str!("report/js/limits.js"),
    include_str!("report/js/study.js"),
];

/// The sections of a comparison; the last one starts.
const COMPARISON: [&str; 10] = [
    include_str!("report/js/shapes.js"),
    include_str!("report/js/changes.js"),
    include_str!("report/js/compare/sides.js"),
    include_str!("report/js/compare/summary.js"),
    include_str!("report/js/compare/moves.js"),
    include_str!("report/js/compare/vibrations.js"),
    include_str!("report/js/compare/gradients.js"),
    include_str!("report/js/compare/ratios.js"),
    include_str!("report/js/compare/cleat_runs.js"),
    include_str!("report/js/compare/comparison.js"),
];

/// The sections of targets; the last one starts.
const TARGETS: [&str; 9] = [
    include_str!("report/js/target/wanted.js"),
    include_str!("report/js/target/tried.js"),
    include_str!("report/js/target/intervals.js"),
    include_str!("report/js/target/dots.js"),
    include_str!("report/js/target/front.js"),
    include_str!("report/js/target/cuts.js"),
    include_str!("report/js/target/tornado.js"),
    include_str!("report/js/target/rides.js"),
    include_str!("report/js/target/target.js"),
];

/// The sections of sensitivities; the last one starts.
const SENSITIVITIES: [&str; 7] = [
    include_str!("report/js/sensitivity/bars.js"),
    include_str!("report/js/sensitivity/summary.js"),
    include_str!("report/js/sensitivity/tornado.js"),
    include_str!("report/js/sensitivity/matrix.js"),
    include_str!("report/js/sensitivity/uncertainty.js"),
    include_str!("report/js/sensitivity/sobol.js"),
    include_str!("report/js/sensitivity/sensitivity.js"),
];

/// What a page reports.
#[derive(Clone, Copy)]
pub enum Report {
    /// A study of a campaign.
    Study,
    /// A comparison of two sides.
    Comparison,
    /// Targets of an axle.
    Targets,
    /// What its metrics depend on.
    Sensitivities,
}

impl Report {
    fn sections(self) -> &'static [&'static str] {
        match self {
            Report::Study => &STUDY,
            Report::Comparison => &COMPARISON,
            Report::Targets => &TARGETS,
            Report::Sensitivities => &SENSITIVITIES,
        }
    }
}

/// A report. Its script may use a `program`, an expression of JavaScript that contains only [`inert`] texts.
pub fn page(report: Report, title: &str, data: &impl Serialize, program: Option<&str>) -> String {
    let mut out = String::new();
    for part in TEMPLATE.split("{{").enumerate() {
        match part {
            (0, text) => out += text,
            (_, part) => {
                let (slot, text) = part.split_once("}}").expect("the template closes its slots");
                out += &filled(slot, report, title, data, program);
                out += text;
            }
        }
    }
    out
}

fn filled(slot: &str, report: Report, title: &str, data: &impl Serialize, program: Option<&str>) -> String {
    match slot {
        "title" => escaped(title),
        "style" => UPLOT[0].to_string() + "\n" + &STYLE.join("\n"),
        "uplot" => UPLOT[1].to_string(),
        "data" => inert(data),
        "script" => {
            let program = format!("const PROGRAM = {};", program.unwrap_or("null"));
            [
                SCRIPTS.join("\n"),
                units::script(),
                program,
                report.sections().join("\n"),
            ]
            .join("\n")
        }
        other => unreachable!("the template has no slot {other}"),
    }
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::{Report, page};

    #[test]
    fn data_cannot_leave_its_script() {
        let page = page(Report::Study, "a < b", &"</script><script>alert(1)</script>", None);
        assert!(!page.contains("alert(1)</script>"));
        assert!(page.contains("\\u003c/script>\\u003cscript>alert(1)"));
        assert!(page.contains("<title>a &lt; b</title>"));
    }

    #[test]
    fn nothing_is_loaded_from_elsewhere() {
        let pages = [
            Report::Study,
            Report::Comparison,
            Report::Targets,
            Report::Sensitivities,
        ]
        .map(|report| page(report, "t", &0, None))
        .concat();
        for loader in [
            "src=",
            "href=\"http",
            "@import",
            "url(",
            "fetch(",
            "XMLHttpRequest",
            "WebSocket",
        ] {
            assert!(!pages.contains(loader), "{loader}");
        }
    }
}
