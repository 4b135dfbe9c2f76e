//! ASAM MDF 3.30: one data group, its time channel first, all as 64-bit floats.

use super::Group;

/// A file with this group.
pub fn file(group: &Group) -> Vec<u8> {
    let mut file = b"MDF     3.30    test    ".to_vec();
    file.resize(64, 0);
    file[28..30].copy_from_slice(&330u16.to_le_bytes());
    let mut header = vec![0; 160];
    // The one data group follows the header.
    let data_group = (64 + 4 + header.len()) as u32;
    header[0..4].copy_from_slice(&data_group.to_le_bytes());
    header[12..14].copy_from_slice(&1u16.to_le_bytes());
    block(&mut file, b"HD", &header);
    block(&mut file, b"DG", &[0; 24]);
    let channels = channels(&mut file, group);
    let mut facts = [0; 22];
    facts[4..8].copy_from_slice(&channels.to_le_bytes());
    let count = 1 + group.channels.len() as u16;
    facts[14..16].copy_from_slice(&count.to_le_bytes());
    facts[16..18].copy_from_slice(&(8 * count).to_le_bytes());
    facts[18..22].copy_from_slice(&(group.len() as u32).to_le_bytes());
    let channel_group = block(&mut file, b"CG", &facts);
    let records = file.len() as u32;
    file.extend(group.records());
    let at = data_group as usize;
    file[at + 8..at + 12].copy_from_slice(&channel_group.to_le_bytes());
    file[at + 16..at + 20].copy_from_slice(&records.to_le_bytes());
    file[at + 20..at + 22].copy_from_slice(&1u16.to_le_bytes());
    file
}

/// Appends a block and gives its address.
fn block(file: &mut Vec<u8>, id: &[u8; 2], data: &[u8]) -> u32 {
    let at = file.len() as u32;
    file.extend(id);
    file.extend((4 + data.len() as u16).to_le_bytes());
    file.extend(data);
    at
}

/// The list of channels, written from its end; gives the address of the first.
fn channels(file: &mut Vec<u8>, group: &Group) -> u32 {
    let values = group.channels.iter().map(|channel| (&*channel.name, &*channel.unit));
    let all: Vec<(&str, &str)> = std::iter::once(("Time", "s")).chain(values).collect();
    let mut next: u32 = 0;
    for (place, (name, unit)) in all.into_iter().enumerate().rev() {
        let unit = conversion(file, unit);
        let mut facts = [0; 224];
        facts[0..4].copy_from_slice(&next.to_le_bytes());
        facts[4..8].copy_from_slice(&unit.to_le_bytes());
        // The first is the time; all are little-endian floats.
        facts[20] = u8::from(place == 0);
        facts[22..22 + name.len()].copy_from_slice(name.as_bytes());
        facts[182..184].copy_from_slice(&(64 * place as u16).to_le_bytes());
        facts[184..186].copy_from_slice(&64u16.to_le_bytes());
        facts[186..188].copy_from_slice(&3u16.to_le_bytes());
        next = block(file, b"CN", &facts);
    }
    next
}

/// A unit, and values as they are stored.
fn conversion(file: &mut Vec<u8>, unit: &str) -> u32 {
    let mut facts = [0; 42];
    facts[18..18 + unit.len()].copy_from_slice(unit.as_bytes());
    facts[38..40].copy_from_slice(&u16::MAX.to_le_bytes());
    block(file, b"CC", &facts)
}
