//! UFF 58: a dataset of text for each channel, four numbers of double precision in a line.

use std::fmt::Write as _;

use super::Group;

/// A file with this group.
pub fn file(group: &Group) -> Vec<u8> {
    let mut text = String::new();
    for channel in &group.channels {
        let _ = writeln!(text, "{:>6}\n{:>6}\n{}", -1, 58, channel.name);
        text += "NONE\n22-Nov-26 10:00:00\nNONE\nNONE\n";
        // A time response, of no degree of freedom.
        let _ = writeln!(
            text,
            "{:>5}{:>10}{:>5}{:>10} NONE      {:>10}{:>4} NONE      {:>10}{:>4}",
            1, 0, 0, 0, 0, 0, 0, 0
        );
        let step = exponential(1.0 / group.rate, 5);
        let _ = writeln!(
            text,
            "{:>10}{:>10}{:>10}{:>13}{step:>13}{:>13}",
            4,
            channel.samples.len(),
            1,
            "0.00000E+00",
            "0.00000E+00"
        );
        for (kind, label, unit) in [
            (17, "Time", "s"),
            (12, "Acceleration", &channel.unit),
            (0, "NONE", "NONE"),
            (0, "NONE", "NONE"),
        ] {
            let _ = writeln!(text, "{kind:>10}{:>5}{:>5}{:>5} {label:<20} {unit:<20}", 0, 0, 0);
        }
        for four in channel.samples.chunks(4) {
            let line: String = four
                .iter()
                .map(|sample| format!("{:>20}", exponential(*sample, 12)))
                .collect();
            text += &(line + "\n");
        }
        let _ = writeln!(text, "{:>6}", -1);
    }
    text.into_bytes()
}

/// A number as Fortran writes it, with so many digits behind the point and at least two in the exponent.
fn exponential(number: f64, digits: usize) -> String {
    let text = format!("{number:.digits$E}");
    let (mantissa, exponent) = text.split_once('E').unwrap();
    let exponent: i32 = exponent.parse().unwrap();
    format!(
        "{mantissa}E{}{:02}",
        if exponent < 0 { '-' } else { '+' },
        exponent.abs()
    )
}
