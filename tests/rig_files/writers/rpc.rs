//! RPC III: parameters in a header of blocks, then groups of short integers or floats.

use super::{Channel, Group};

const POINTS_OF_GROUP: usize = 2048;
/// The largest value in a file that a controller takes for full scale.
const FULL_SCALE: f64 = 32752.0;

/// The unit of a step of this channel.
pub fn step(channel: &Channel) -> f64 {
    channel
        .samples
        .iter()
        .fold(0.0, |most: f64, value| most.max(value.abs()))
        / FULL_SCALE
}

/// A file with this group as short integers.
pub fn file(group: &Group) -> Vec<u8> {
    let steps: Vec<f64> = group.channels.iter().map(step).collect();
    let short = |channel: usize, value: f64| ((value / steps[channel]).round() as i16).to_le_bytes();
    [header(group, "SHORT_INTEGER", &steps), frames(group, short)].concat()
}

/// A file with this group as floats of single precision.
pub fn floats(group: &Group) -> Vec<u8> {
    let single = |_, value: f64| (value as f32).to_le_bytes();
    [
        header(group, "FLOATING_POINT", &vec![1.0; group.channels.len()]),
        frames(group, single),
    ]
    .concat()
}

fn header(group: &Group, data_type: &str, scales: &[f64]) -> Vec<u8> {
    let frames = group.len().div_ceil(POINTS_OF_GROUP);
    let mut parameters = vec![
        ("FORMAT".into(), "BINARY_IEEE_LITTLE_END".into()),
        ("NUM_HEADER_BLOCKS".to_string(), String::new()),
        ("NUM_PARAMS".into(), String::new()),
        ("FILE_TYPE".into(), "TIME_HISTORY".into()),
        ("TIME_TYPE".into(), "RESPONSE".into()),
        ("DELTA_T".into(), format!("{:E}", 1.0 / group.rate)),
        ("CHANNELS".into(), group.channels.len().to_string()),
        ("PTS_PER_FRAME".into(), POINTS_OF_GROUP.to_string()),
        ("PTS_PER_GROUP".into(), POINTS_OF_GROUP.to_string()),
        ("FRAMES".into(), frames.to_string()),
        ("SAMPLES".into(), group.len().to_string()),
        ("DATA_TYPE".into(), data_type.into()),
    ];
    for (number, (channel, scale)) in group.channels.iter().zip(scales).enumerate() {
        parameters.push((format!("DESC.CHAN_{}", number + 1), channel.name.clone()));
        parameters.push((format!("UNITS.CHAN_{}", number + 1), channel.unit.clone()));
        parameters.push((format!("SCALE.CHAN_{}", number + 1), format!("{scale:E}")));
    }
    let blocks = parameters.len().div_ceil(4);
    parameters[1].1 = blocks.to_string();
    parameters[2].1 = parameters.len().to_string();
    let mut header: Vec<u8> = parameters
        .iter()
        .flat_map(|(name, value)| [padded(name, 32), padded(value, 96)].concat())
        .collect();
    header.resize(blocks * 512, 0);
    header
}

/// The values of each channel, group after group, the last one padded with zeros.
fn frames<const N: usize>(group: &Group, stored: impl Fn(usize, f64) -> [u8; N]) -> Vec<u8> {
    let mut frames = Vec::new();
    for first in (0..group.len()).step_by(POINTS_OF_GROUP) {
        for (number, channel) in group.channels.iter().enumerate() {
            let value = |at: usize| channel.samples.get(at).copied().unwrap_or(0.0);
            frames.extend((first..first + POINTS_OF_GROUP).flat_map(|at| stored(number, value(at))));
        }
    }
    frames
}

fn padded(text: &str, length: usize) -> Vec<u8> {
    let mut bytes = text.as_bytes().to_vec();
    bytes.resize(length, 0);
    bytes
}
