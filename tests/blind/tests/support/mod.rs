//! Reads what the simulator writes.

use std::collections::BTreeMap;
use std::fs;
use std::io::Read as _;

use flate2::read::GzDecoder;
use qcar_blind::{Order, make};

/// Columns of a record by their names.
pub type Record = BTreeMap<String, Vec<f64>>;

/// Makes a campaign and reads some of its files.
pub fn records<const N: usize>(order: &Order, files: [&str; N]) -> [Record; N] {
    let folder = tempfile::tempdir().expect("a folder");
    let campaign = folder.path().join("campaign");
    make(order.clone(), &campaign).expect("a campaign");
    files.map(|file| {
        let bytes = fs::read(campaign.join(file)).expect("the file");
        let mut text = String::new();
        if file.ends_with(".gz") {
            GzDecoder::new(&bytes[..]).read_to_string(&mut text).expect("text");
        } else {
            text = String::from_utf8(bytes).expect("text");
        }
        record(&text)
    })
}

fn record(text: &str) -> Record {
    let mut lines = text.lines();
    let names: Vec<&str> = lines.next().expect("a header").split(',').collect();
    let mut columns = vec![Vec::new(); names.len()];
    for line in lines {
        for (column, cell) in columns.iter_mut().zip(line.split(',')) {
            column.push(cell.parse().expect("a number"));
        }
    }
    names.into_iter().map(str::to_owned).zip(columns).collect()
}

/// Root mean square.
pub fn rms(values: &[f64]) -> f64 {
    (values.iter().map(|x| x * x).sum::<f64>() / values.len() as f64).sqrt()
}
