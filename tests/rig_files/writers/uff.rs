//! UFF 58: a dataset for each channel, in double precision; as text four numbers in a line.

use std::fmt::Write as _;

use super::{Channel, Group};

/// A file of text with this group.
pub fn file(group: &Group) -> Vec<u8> {
    let mut text = String::new();
    for channel in &group.channels {
        let _ = write!(text, "{:>6}\n{:>6}\n{}", -1, 58, head(channel, group.rate));
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

/// A file of binary datasets (58b) with this group: little-endian numbers of IEEE 754 behind eleven lines.
pub fn binary(group: &Group) -> Vec<u8> {
    let mut file = Vec::new();
    for channel in &group.channels {
        let bytes = 8 * channel.samples.len();
        let first = format!(
            "{:>6}b{:>6}{:>6}{:>12}{bytes:>12}{:>6}{:>6}{:>12}{:>12}",
            58, 1, 2, 11, 0, 0, 0, 0
        );
        file.extend(format!("{:>6}\n{first}\n{}", -1, head(channel, group.rate)).bytes());
        file.extend(channel.samples.iter().flat_map(|sample| sample.to_le_bytes()));
        file.extend(format!("\n{:>6}\n", -1).bytes());
    }
    file
}

/// The eleven lines before the numbers: five of text, what was measured where, how it is stored, and the axes.
fn head(channel: &Channel, rate: f64) -> String {
    let mut text = format!("{}\nNONE\n22-Nov-26 10:00:00\nNONE\nNONE\n", channel.name);
    // A time response, of no degree of freedom.
    let _ = writeln!(
        text,
        "{:>5}{:>10}{:>5}{:>10} NONE      {:>10}{:>4} NONE      {:>10}{:>4}",
        1, 0, 0, 0, 0, 0, 0, 0
    );
    let step = exponential(1.0 / rate, 5);
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
    text
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
