//! RPC III: parameters in a header of blocks, then groups of short integers.

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

/// A file with this group.
pub fn file(group: &Group) -> Vec<u8> {
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
        ("DATA_TYPE".into(), "SHORT_INTEGER".into()),
    ];
    let steps: Vec<f64> = group.channels.iter().map(step).collect();
    for (number, (channel, step)) in group.channels.iter().zip(&steps).enumerate() {
        parameters.push((format!("DESC.CHAN_{}", number + 1), channel.name.clone()));
        parameters.push((format!("UNITS.CHAN_{}", number + 1), channel.unit.clone()));
        parameters.push((format!("SCALE.CHAN_{}", number + 1), format!("{step:E}")));
    }
    let blocks = parameters.len().div_ceil(4);
    parameters[1].1 = blocks.to_string();
    parameters[2].1 = parameters.len().to_string();
    let mut file: Vec<u8> = parameters
        .iter()
        .flat_map(|(name, value)| [padded(name, 32), padded(value, 96)].concat())
        .collect();
    file.resize(blocks * 512, 0);
    for frame in 0..frames {
        for (channel, step) in group.channels.iter().zip(&steps) {
            let points = frame * POINTS_OF_GROUP..(frame + 1) * POINTS_OF_GROUP;
            file.extend(points.flat_map(|at| {
                let value = channel.samples.get(at).copied().unwrap_or(0.0);
                ((value / step).round() as i16).to_le_bytes()
            }));
        }
    }
    file
}

fn padded(text: &str, length: usize) -> Vec<u8> {
    let mut bytes = text.as_bytes().to_vec();
    bytes.resize(length, 0);
    bytes
}
