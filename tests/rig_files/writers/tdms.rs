//! TDMS: one segment, the channels of a group as waveforms of doubles.

use super::Group;

/// A file with this group.
pub fn file(group: &Group) -> Vec<u8> {
    let mut list = ((2 + group.channels.len()) as u32).to_le_bytes().to_vec();
    for path in ["/", "/'rig'"] {
        string(&mut list, path);
        list.extend([0xff; 4]);
        list.extend([0; 4]);
    }
    for channel in &group.channels {
        string(&mut list, &format!("/'rig'/'{}'", channel.name));
        // 20 bytes on the raw data: doubles, of one dimension, so many.
        list.extend([20u32, 10, 1].iter().flat_map(|number| number.to_le_bytes()));
        list.extend((channel.samples.len() as u64).to_le_bytes());
        list.extend(2u32.to_le_bytes());
        string(&mut list, "wf_increment");
        list.extend(10u32.to_le_bytes());
        list.extend((1.0 / group.rate).to_le_bytes());
        string(&mut list, "unit_string");
        list.extend(0x20u32.to_le_bytes());
        string(&mut list, &channel.unit);
    }
    let samples = group.channels.iter().flat_map(|channel| &channel.samples);
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

fn string(into: &mut Vec<u8>, text: &str) {
    into.extend((text.len() as u32).to_le_bytes());
    into.extend(text.as_bytes());
}
