//! MAT 7.3 as MATLAB writes it without compression: HDF5 with a superblock of version 0 behind 512 bytes of text, a
//! column of doubles for each channel and one of times named `t`. It knows no units.
//!
//! Addresses count from the superblock.

use super::Group;

const USER_BLOCK: usize = 512;
const SUPERBLOCK: usize = 96;
const NOTHING: u64 = u64::MAX;
/// Half of the most symbols in a node.
const HALF_NODE: u16 = 16;

/// A file with this group of at most 31 channels.
pub fn file(group: &Group) -> Vec<u8> {
    let times: Vec<f64> = (0..group.len()).map(|at| group.time(at)).collect();
    let channels = group.channels.iter().map(|own| (&*own.name, &own.samples[..]));
    let mut columns: Vec<(&str, &[f64])> = channels.chain([("t", &times[..])]).collect();
    // Symbols are in the order of their names.
    columns.sort_by_key(|column| column.0);
    let mut file = vec![0; SUPERBLOCK];
    let headers: Vec<u64> = columns.iter().map(|column| dataset(&mut file, column.1)).collect();
    let (heap, names) = heap(&mut file, columns.iter().map(|column| column.0));
    let node = node(&mut file, &names, &headers);
    let tree = tree(&mut file, node, names[names.len() - 1]);
    let root = header(&mut file, &[(0x11, numbers(&[tree, heap]))]);
    let begin = superblock(root, [tree, heap], file.len() as u64);
    file[..SUPERBLOCK].copy_from_slice(&begin);
    [user_block(), file].concat()
}

fn user_block() -> Vec<u8> {
    let mut block = b"MATLAB 7.3 MAT-file".to_vec();
    block.resize(124, b' ');
    block.extend([0x00, 0x02, b'I', b'M']);
    block.resize(USER_BLOCK, 0);
    block
}

fn superblock(root: u64, of_root: [u64; 2], end: u64) -> Vec<u8> {
    let mut block = b"\x89HDF\r\n\x1a\n".to_vec();
    block.extend([0, 0, 0, 0, 0, 8, 8, 0]);
    block.extend(HALF_NODE.to_le_bytes());
    block.extend([16, 0, 0, 0, 0, 0]);
    block.extend(numbers(&[
        USER_BLOCK as u64,
        NOTHING,
        USER_BLOCK as u64 + end,
        NOTHING,
        0,
        root,
    ]));
    // The entry of the root group holds the places of its symbols.
    block.extend([1, 0, 0, 0, 0, 0, 0, 0]);
    block.extend(numbers(&of_root));
    block
}

/// A column of doubles in one piece: its header lists size, type and place.
fn dataset(file: &mut Vec<u8>, samples: &[f64]) -> u64 {
    let at = append(
        file,
        &samples
            .iter()
            .flat_map(|sample| sample.to_le_bytes())
            .collect::<Vec<_>>(),
    );
    let mut space = vec![1, 2, 0, 0, 0, 0, 0, 0];
    space.extend(numbers(&[1, samples.len() as u64]));
    // A little-endian number of 64 bits by IEEE 754: exponent of 11 bits at bit 52, mantissa of 52 bits at bit 0.
    let double = [
        0x11, 0x20, 0x3f, 0, 8, 0, 0, 0, 0, 0, 64, 0, 52, 11, 0, 52, 0xff, 0x03, 0, 0, 0, 0, 0, 0,
    ];
    let mut layout = vec![3, 1];
    layout.extend(numbers(&[at, 8 * samples.len() as u64]));
    layout.resize(24, 0);
    header(file, &[(1, space), (3, double.to_vec()), (8, layout)])
}

/// An object header of version 1 with these messages.
fn header(file: &mut Vec<u8>, messages: &[(u16, Vec<u8>)]) -> u64 {
    let mut body = Vec::new();
    for (kind, message) in messages {
        body.extend([kind.to_le_bytes(), (message.len() as u16).to_le_bytes()].concat());
        body.extend([0; 4]);
        body.extend(message);
    }
    let mut header = vec![1, 0];
    header.extend((messages.len() as u16).to_le_bytes());
    header.extend(
        [1u32, body.len() as u32, 0]
            .iter()
            .flat_map(|number| number.to_le_bytes()),
    );
    append(file, &[header, body].concat())
}

/// A heap of names, each in a multiple of eight bytes behind an empty one; gives its address and where in it each name
/// stands.
fn heap<'a>(file: &mut Vec<u8>, names: impl Iterator<Item = &'a str>) -> (u64, Vec<u64>) {
    let mut data = vec![0; 8];
    let mut places = Vec::new();
    for name in names {
        places.push(data.len() as u64);
        data.extend(name.as_bytes());
        data.resize((data.len() + 1).next_multiple_of(8), 0);
    }
    let at = append(file, &data);
    let head = [b"HEAP\0\0\0\0".to_vec(), numbers(&[data.len() as u64, 1, at])].concat();
    (append(file, &head), places)
}

/// A node with the symbol of each dataset.
fn node(file: &mut Vec<u8>, names: &[u64], headers: &[u64]) -> u64 {
    let mut node = b"SNOD\x01\0".to_vec();
    node.extend((names.len() as u16).to_le_bytes());
    for (&name, &header) in names.iter().zip(headers) {
        node.extend(numbers(&[name, header, 0, 0, 0]));
    }
    node.resize(8 + 40 * 2 * usize::from(HALF_NODE), 0);
    append(file, &node)
}

/// A tree of one node, between the empty name and the last one.
fn tree(file: &mut Vec<u8>, node: u64, last: u64) -> u64 {
    let mut tree = b"TREE\0\0\x01\0".to_vec();
    tree.extend(numbers(&[NOTHING, NOTHING, 0, node, last]));
    // Room for 32 children, each with a key, and one more key.
    tree.resize(24 + 8 * (2 * 32 + 1), 0);
    append(file, &tree)
}

fn append(file: &mut Vec<u8>, data: &[u8]) -> u64 {
    file.resize(file.len().next_multiple_of(8), 0);
    let at = file.len() as u64;
    file.extend(data);
    at
}

fn numbers(numbers: &[u64]) -> Vec<u8> {
    numbers.iter().flat_map(|number| number.to_le_bytes()).collect()
}
