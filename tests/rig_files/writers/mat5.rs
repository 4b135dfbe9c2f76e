//! MAT 5: a column of doubles for each channel, and one of times named `t`. It knows no units.

use super::Group;

/// A file with this group.
pub fn file(group: &Group) -> Vec<u8> {
    let mut file = b"MATLAB 5.0 MAT-file".to_vec();
    file.resize(124, b' ');
    file.extend([0x00, 0x01, b'I', b'M']);
    let times: Vec<f64> = (0..group.len()).map(|at| group.time(at)).collect();
    matrix(&mut file, "t", &times);
    group
        .channels
        .iter()
        .for_each(|channel| matrix(&mut file, &channel.name, &channel.samples));
    file
}

/// Flags of a matrix of doubles, dimensions, name, numbers.
fn matrix(file: &mut Vec<u8>, name: &str, numbers: &[f64]) {
    let mut content = Vec::new();
    element(&mut content, 6, &[6, 0, 0, 0, 0, 0, 0, 0]);
    let dimensions = [numbers.len() as i32, 1];
    element(
        &mut content,
        5,
        &dimensions
            .iter()
            .flat_map(|size| size.to_le_bytes())
            .collect::<Vec<_>>(),
    );
    element(&mut content, 1, name.as_bytes());
    element(
        &mut content,
        9,
        &numbers
            .iter()
            .flat_map(|number| number.to_le_bytes())
            .collect::<Vec<_>>(),
    );
    element(file, 14, &content);
}

fn element(file: &mut Vec<u8>, kind: u32, data: &[u8]) {
    file.extend(kind.to_le_bytes());
    file.extend((data.len() as u32).to_le_bytes());
    file.extend(data);
    file.resize(file.len().next_multiple_of(8), 0);
}
