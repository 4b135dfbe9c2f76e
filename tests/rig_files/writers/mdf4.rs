//! ASAM MDF 4.10: a data group for each rate, its time channel first, all as 64-bit floats.

use super::Group;

/// A file with these groups.
pub fn file(groups: &[Group]) -> Vec<u8> {
    let mut file = identification();
    // The header's only link that is used is that to the first data group.
    let header = block(&mut file, b"##HD", &[0; 6], &[0; 32]);
    let mut link = header + 24;
    for (number, group) in groups.iter().enumerate() {
        let data = block(&mut file, b"##DT", &[], &group.records());
        let channels = channels(&mut file, group);
        let name = text(&mut file, &format!("group {number}"));
        let mut facts = [0; 32];
        facts[8..16].copy_from_slice(&(group.len() as u64).to_le_bytes());
        facts[24..28].copy_from_slice(&(8 * (1 + group.channels.len()) as u32).to_le_bytes());
        let channel_group = block(&mut file, b"##CG", &[0, channels, name, 0, 0, 0], &facts);
        let data_group = block(&mut file, b"##DG", &[0, channel_group, data, 0], &[0; 8]);
        file[link as usize..link as usize + 8].copy_from_slice(&data_group.to_le_bytes());
        link = data_group + 24;
    }
    file
}

fn identification() -> Vec<u8> {
    let mut block = b"MDF     4.10    test    ".to_vec();
    block.resize(64, 0);
    block[28..30].copy_from_slice(&410u16.to_le_bytes());
    block
}

/// Appends a block and gives its address.
fn block(file: &mut Vec<u8>, id: &[u8; 4], links: &[u64], data: &[u8]) -> u64 {
    file.resize(file.len().next_multiple_of(8), 0);
    let at = file.len() as u64;
    file.extend(id);
    file.extend([0; 4]);
    file.extend((24 + 8 * links.len() as u64 + data.len() as u64).to_le_bytes());
    file.extend((links.len() as u64).to_le_bytes());
    file.extend(links.iter().flat_map(|link| link.to_le_bytes()));
    file.extend(data);
    at
}

fn text(file: &mut Vec<u8>, text: &str) -> u64 {
    block(file, b"##TX", &[], format!("{text}\0").as_bytes())
}

/// The list of channels, written from its end; gives the address of the first.
fn channels(file: &mut Vec<u8>, group: &Group) -> u64 {
    let values = group
        .channels
        .iter()
        .map(|channel| (channel.name.as_str(), channel.unit.as_str()));
    let all: Vec<(&str, &str)> = std::iter::once(("Time", "s")).chain(values).collect();
    let mut next = 0;
    for (place, (name, unit)) in all.into_iter().enumerate().rev() {
        let (name, unit) = (text(file, name), text(file, unit));
        let mut facts = [0; 72];
        // The first is the master, of time; all are little-endian floats.
        (facts[0], facts[1]) = if place == 0 { (2, 1) } else { (0, 0) };
        facts[2] = 4;
        facts[4..8].copy_from_slice(&(8 * place as u32).to_le_bytes());
        facts[8..12].copy_from_slice(&64u32.to_le_bytes());
        next = block(file, b"##CN", &[next, 0, name, 0, 0, 0, unit, 0], &facts);
    }
    next
}
