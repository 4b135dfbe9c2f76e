//! Curves over frequency or time as a self-contained SVG.

use std::fmt::Write;

/// Panels in rows that share their legend.
pub struct Figure {
    /// Title.
    pub title: String,
    /// The horizontal axis of all panels.
    pub across: Across,
    /// Panels from left to right, then down.
    pub panels: Vec<Panel>,
}

/// A horizontal axis.
#[derive(Clone, Copy)]
pub enum Across {
    /// Frequency, Hz, logarithmic.
    Frequency,
    /// Time, s.
    Time,
}

/// A diagram.
pub struct Panel {
    /// Title of the diagram.
    pub title: String,
    /// Label of the vertical axis, with its unit.
    pub vertical: String,
    /// Curves in drawing order.
    pub curves: Vec<Curve>,
}

/// A line through points of ascending frequency or time.
pub struct Curve {
    /// Label in the legend.
    pub label: &'static str,
    /// Line style.
    pub style: Style,
    /// Frequency in Hz or time in s, and value; points that are not finite are left out.
    pub points: Vec<(f64, f64)>,
}

/// Line style of a curve.
#[derive(Clone, Copy)]
#[expect(missing_docs, reason = "each is one role of a curve in a comparison")]
pub enum Style {
    Measured,
    Before,
    After,
}

const WIDTH: f64 = 380.0;
const HEIGHT: f64 = 236.0;
const LEFT: f64 = 56.0;
const RIGHT: f64 = 14.0;
const TOP: f64 = 28.0;
const BOTTOM: f64 = 44.0;

/// Number of panels in a row.
const COLUMNS: usize = 3;

/// Space for the title above the panels and for the legend below them.
const MARGIN: f64 = 26.0;

pub(crate) const CSS: &str = "\
svg{background:#fff}text{font:12px sans-serif;fill:#222}.title{font-weight:bold}\
.grid{stroke:#ddd;stroke-width:1}.frame{fill:none;stroke:#888}\
.curve{fill:none;stroke-width:1.6;stroke-linejoin:round}\
.measured{stroke:#aaa;stroke-width:4.5}.before{stroke:#c77700;stroke-dasharray:5 3}.after{stroke:#0068b5}";

impl Figure {
    /// The SVG text.
    pub fn svg(&self) -> String {
        let rows = self.panels.len().div_ceil(COLUMNS);
        let width = WIDTH * self.panels.len().min(COLUMNS) as f64;
        let height = HEIGHT * rows as f64 + 2.0 * MARGIN;
        let mut out = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" \
             height=\"{height}\" role=\"img\">\n<title>{}</title>\n<style>{CSS}</style>\n",
            escaped(&self.title)
        );
        text(&mut out, LEFT, 18.0, "start", "title", &self.title);
        for (at, panel) in self.panels.iter().enumerate() {
            let (left, top) = (WIDTH * (at % COLUMNS) as f64, MARGIN + HEIGHT * (at / COLUMNS) as f64);
            let _ = writeln!(out, "<g transform=\"translate({left} {top})\">");
            panel.draw(&mut out, self.across);
            out.push_str("</g>\n");
        }
        self.legend(&mut out, height - 10.0);
        out.push_str("</svg>\n");
        out
    }

    fn legend(&self, out: &mut String, y: f64) {
        let curves = self.panels.first().map_or(&[][..], |panel| &panel.curves);
        for (at, curve) in curves.iter().enumerate() {
            let x = LEFT + 150.0 * at as f64;
            let class = curve.style.class();
            let _ = writeln!(
                out,
                "<path class=\"curve {class}\" d=\"M{x} {}H{}\"/>",
                y - 4.0,
                x + 28.0
            );
            text(out, x + 34.0, y, "start", "", curve.label);
        }
    }
}

impl Style {
    fn class(self) -> &'static str {
        match self {
            Style::Measured => "measured",
            Style::Before => "before",
            Style::After => "after",
        }
    }
}

impl Panel {
    fn draw(&self, out: &mut String, across: Across) {
        let Some(scale) = Scale::over(self, across) else { return };
        text(
            out,
            LEFT,
            TOP - 10.0,
            "start",
            "",
            &format!("{}, {}", self.title, self.vertical),
        );
        for (at, label) in across.ticks(scale.x.0, scale.x.1) {
            let x = scale.x(at);
            let _ = writeln!(out, "<path class=\"grid\" d=\"M{x:.1} {TOP}V{:.1}\"/>", HEIGHT - BOTTOM);
            text(out, x, HEIGHT - BOTTOM + 16.0, "middle", "", &label);
        }
        for value in ticks(scale.y.0, scale.y.1) {
            let y = scale.y(value);
            let (from, to) = (LEFT, WIDTH - RIGHT);
            let _ = writeln!(out, "<path class=\"grid\" d=\"M{from:.1} {y:.1}H{to:.1}\"/>");
            text(out, from - 6.0, y + 4.0, "end", "", &format!("{value}"));
        }
        text(
            out,
            (LEFT + WIDTH - RIGHT) / 2.0,
            HEIGHT - BOTTOM + 34.0,
            "middle",
            "",
            across.title(),
        );
        for curve in &self.curves {
            let _ = writeln!(
                out,
                "<path class=\"curve {}\" d=\"{}\"/>",
                curve.style.class(),
                scale.path(&curve.points)
            );
        }
        let (width, height) = (WIDTH - LEFT - RIGHT, HEIGHT - TOP - BOTTOM);
        let _ = writeln!(
            out,
            "<rect class=\"frame\" x=\"{LEFT}\" y=\"{TOP}\" width=\"{width}\" height=\"{height}\"/>"
        );
    }
}

impl Across {
    fn title(self) -> &'static str {
        match self {
            Across::Frequency => "frequency, Hz",
            Across::Time => "time, s",
        }
    }

    fn ticks(self, from: f64, to: f64) -> Vec<(f64, String)> {
        match self {
            Across::Frequency => frequency_ticks(from, to),
            Across::Time => ticks(from, to).into_iter().map(|t| (t, format!("{t}"))).collect(),
        }
    }
}

/// From axis coordinates to page coordinates.
struct Scale {
    across: Across,
    x: (f64, f64),
    y: (f64, f64),
}

impl Scale {
    /// Range of all points of a panel; `None` without points.
    fn over(panel: &Panel, across: Across) -> Option<Scale> {
        let points = || {
            panel
                .curves
                .iter()
                .flat_map(|curve| &curve.points)
                .filter(|(_, y)| y.is_finite())
        };
        let span = |values: &mut dyn Iterator<Item = f64>| {
            values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| {
                (low.min(v), high.max(v))
            })
        };
        let x = span(&mut points().map(|p| p.0));
        let (low, high) = span(&mut points().map(|p| p.1));
        let least = match across {
            // Decibels.
            Across::Frequency => 0.5,
            Across::Time => f64::MIN_POSITIVE,
        };
        let margin = (0.06 * (high - low)).max(least);
        (x.0 < x.1).then_some(Scale {
            across,
            x,
            y: (low - margin, high + margin),
        })
    }

    fn x(&self, at: f64) -> f64 {
        let (first, last) = self.x;
        let share = match self.across {
            Across::Frequency => (at / first).ln() / (last / first).ln(),
            Across::Time => (at - first) / (last - first),
        };
        LEFT + share * (WIDTH - LEFT - RIGHT)
    }

    fn y(&self, value: f64) -> f64 {
        let share = (value - self.y.0) / (self.y.1 - self.y.0);
        HEIGHT - BOTTOM - share * (HEIGHT - TOP - BOTTOM)
    }

    fn path(&self, points: &[(f64, f64)]) -> String {
        let mut path = String::new();
        for (at, value) in points.iter().filter(|(_, value)| value.is_finite()) {
            let step = if path.is_empty() { 'M' } else { 'L' };
            let _ = write!(path, "{step}{:.1} {:.1}", self.x(*at), self.y(*value));
        }
        path
    }
}

/// 1, 2 and 5 of every decade.
fn frequency_ticks(from: f64, to: f64) -> Vec<(f64, String)> {
    let decades = from.log10().floor() as i32..=to.log10().floor() as i32;
    let all = decades.flat_map(|decade| [1.0, 2.0, 5.0].map(|step| step * 10f64.powi(decade)));
    all.filter(|f| (from..=to).contains(f))
        .map(|f| (f, format!("{f}")))
        .collect()
}

/// Four to eight round values.
fn ticks(from: f64, to: f64) -> Vec<f64> {
    let raw = (to - from) / 5.0;
    let decade = 10f64.powf(raw.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0]
        .map(|s| s * decade)
        .into_iter()
        .find(|s| *s >= raw)
        .unwrap_or(raw);
    let first = (from / step).ceil() as i64;
    let last = (to / step).floor() as i64;
    (first..=last).map(|n| n as f64 * step).collect()
}

pub(crate) fn text(out: &mut String, x: f64, y: f64, anchor: &str, class: &str, content: &str) {
    let class = if class.is_empty() {
        String::new()
    } else {
        format!(" class=\"{class}\"")
    };
    let content = escaped(content);
    let _ = writeln!(
        out,
        "<text{class} x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\">{content}</text>"
    );
}

pub(crate) fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::{frequency_ticks, ticks};

    #[test]
    fn ticks_are_round_and_inside() {
        assert_eq!(ticks(-41.0, 12.0), [-40.0, -20.0, 0.0]);
        assert_eq!(ticks(-1.2, 3.9), [0.0, 2.0]);
        let labels: Vec<_> = frequency_ticks(0.5, 30.0).into_iter().map(|(_, label)| label).collect();
        assert_eq!(labels, ["0.5", "1", "2", "5", "10", "20"]);
    }
}
