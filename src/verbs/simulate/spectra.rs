//! Power spectral densities of the channels of a ride, as a table and drawn.

use std::fmt::Write;

use qcar_runtime::spectrum::{Segments, Trend, Window, welch};
use qcar_signals::mdf::write::Channel;

use crate::figure::{Across, Curve, Figure, Panel, Style};
use crate::units;

/// Length of a segment, s: lines are a quarter of a hertz apart.
const SEGMENT: f64 = 4.0;
/// Highest frequency of the densities, Hz; above it a model of masses and springs is not accurate.
const HIGHEST: f64 = 100.0;

/// One-sided densities of several channels.
pub(super) struct Spectra {
    /// Frequencies, Hz.
    frequency: Vec<f64>,
    /// Name, unit and density (unit²/Hz) of each channel.
    densities: Vec<(String, String, Vec<f64>)>,
}

impl Spectra {
    /// Densities of channels with the sample rate `rate` (Hz), averaged over segments of four seconds with half
    /// overlap, a Hann window, and without their linear trend. A shorter ride is one segment.
    pub fn of(channels: &[Channel], rate: f64) -> Self {
        let samples = channels.first().map_or(0, |channel| channel.samples.len());
        let length = ((SEGMENT * rate) as usize).min(samples);
        let segments = Segments {
            length,
            overlap: length / 2,
            window: Window::Hann,
            trend: Trend::Linear,
        };
        let (mut frequency, mut densities) = (Vec::new(), Vec::new());
        for channel in channels {
            let spectrum = welch(&[&channel.samples], rate, &segments);
            let lines = || spectrum.frequency.iter().zip(&spectrum.density).skip(1);
            let lines = || lines().take_while(|(frequency, _)| **frequency <= HIGHEST);
            // One-sided: both halves of the spectrum.
            let density = lines().map(|(_, density)| 2.0 * density[(0, 0)].re).collect();
            frequency = lines().map(|(frequency, _)| *frequency).collect();
            densities.push((channel.name.clone(), channel.unit.clone(), density));
        }
        Self { frequency, densities }
    }

    /// A row for each frequency, a column for each channel.
    pub fn csv(&self) -> String {
        let heading = |(name, unit, _): &(String, String, Vec<f64>)| format!(",{name} [{}]", squared(unit));
        let mut out = format!(
            "frequency [Hz]{}\n",
            self.densities.iter().map(heading).collect::<String>()
        );
        for (line, frequency) in self.frequency.iter().enumerate() {
            let _ = write!(out, "{frequency}");
            for (_, unit, density) in &self.densities {
                let _ = write!(out, ",{}", shown(density[line], unit));
            }
            out.push('\n');
        }
        out
    }

    /// A panel for each channel, in decibels.
    pub fn figure(&self, title: &str) -> Figure {
        let panel = |(name, unit, density): &(String, String, Vec<f64>)| {
            let decibels = |density: &f64| 10.0 * shown(*density, unit).log10();
            let points = self.frequency.iter().copied().zip(density.iter().map(decibels));
            Panel {
                title: name.clone(),
                vertical: format!("dB re 1 {}", squared(unit)),
                curves: vec![Curve {
                    label: "power spectral density",
                    style: Style::After,
                    points: points.collect(),
                }],
            }
        };
        Figure {
            title: title.into(),
            across: Across::Frequency,
            panels: self.densities.iter().map(panel).collect(),
        }
    }
}

/// A density in the unit that the user has chosen.
fn shown(density: f64, si: &str) -> f64 {
    units::value(1.0, si).powi(2) * density
}

fn squared(si: &str) -> String {
    match &*units::name(si) {
        product if product.contains(['/', ' ', '^']) => format!("({product})^2/Hz"),
        plain => format!("{plain}^2/Hz"),
    }
}

#[cfg(test)]
mod tests {
    use super::squared;

    #[test]
    fn units_of_densities_are_squares() {
        let cases = [
            ("N", "N^2/Hz"),
            ("m/s^2", "(m/s^2)^2/Hz"),
            ("N s", "(N s)^2/Hz"),
            ("m^2", "(m^2)^2/Hz"),
        ];
        for (unit, expected) in cases {
            assert_eq!(squared(unit), expected);
        }
    }
}
