//! TDMS: one segment, the channels of a group as doubles: waveforms, or beside a channel of times.

use super::{Channel, Group};

/// A file with this group.
pub fn file(group: &Group) -> Vec<u8> {
    let stamps = group.stamps.iter().map(|own| Channel::new("Time", "s", own.clone()));
    let stamps: Vec<Channel> = stamps.collect();
    let step = group.stamps.is_none().then_some(1.0 / group.rate);
    let channels: Vec<&Channel> = stamps.iter().chain(&group.channels).collect();
    let mut list = ((2 + channels.len()) as u32).to_le_bytes().to_vec();
    for path in ["/", "/'rig'"] {
        string(&mut list, path);
        list.extend([0xff; 4]);
        list.extend([0; 4]);
    }
    channels.iter().for_each(|channel| object(&mut list, channel, step));
    let samples = channels.iter().flat_map(|channel| &channel.samples);
    let raw: Vec<u8> = samples.flat_map(|sample| sample.to_le_bytes()).collect();
    let mut file = b"TDSm".to_vec();
    // Meta data, a new list of objects, raw data; version 4713.
    file.extend([2u32 | 4 | 8, 4713].iter().flat_map(|number| number.to_le_bytes()));
    file.extend(((list.len() + raw.len()) as u64).to_le_bytes());
    file.extend((list.len() as u64).to_le_bytes());
    file.extend(list);
    file.extend(raw);
    file
}

/// A channel: where its samples are, and its properties.
fn object(list: &mut Vec<u8>, channel: &Channel, step: Option<f64>) {
    string(list, &format!("/'rig'/'{}'", channel.name));
    // 20 bytes on the raw data: doubles, of one dimension, so many.
    list.extend([20u32, 10, 1].iter().flat_map(|number| number.to_le_bytes()));
    list.extend((channel.samples.len() as u64).to_le_bytes());
    list.extend((1 + u32::from(step.is_some())).to_le_bytes());
    if let Some(step) = step {
        string(list, "wf_increment");
        list.extend(10u32.to_le_bytes());
        list.extend(step.to_le_bytes());
    }
    string(list, "unit_string");
    list.extend(0x20u32.to_le_bytes());
    string(list, &channel.unit);
}

fn string(into: &mut Vec<u8>, text: &str) {
    into.extend((text.len() as u32).to_le_bytes());
    into.extend(text.as_bytes());
}
