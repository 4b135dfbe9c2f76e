//! Campaigns made from the sweeps of the shipped rig.

use std::fs;
use std::io::Read;
use std::path::Path;

use flate2::read::GzDecoder;

use super::studied::Studied;

const LEVELS: [&str; 3] = ["025", "050", "100"];

/// The sweeps of the shipped rig, with every sample of a column changed.
pub fn swept(folder: &Path, changed: &mut dyn FnMut(&str, f64) -> f64) {
    let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("models/campaigns/axle_a_rig");
    fs::create_dir(folder.join("rig")).expect("a folder");
    for level in LEVELS {
        let file = format!("rig/sweep_{level}.csv.gz");
        let mut text = String::new();
        let packed = fs::File::open(shipped.join(&file)).expect("it is shipped");
        GzDecoder::new(packed).read_to_string(&mut text).expect("text");
        let mut lines = text.lines();
        let names: Vec<&str> = lines.next().expect("a header").split(',').collect();
        let mut out = names.join(",") + "\n";
        for line in lines {
            let cells = names.iter().zip(line.split(','));
            let cells = cells.map(|(name, cell)| match *name {
                "time" => cell.to_owned(),
                name => format!("{:.5}", changed(name, cell.parse().expect("a number"))),
            });
            out += &(cells.collect::<Vec<_>>().join(",") + "\n");
        }
        fs::write(folder.join(format!("rig/sweep_{level}.csv")), out).expect("a new file");
    }
    let manifest = fs::read_to_string(shipped.join("campaign.toml")).expect("it is shipped");
    let runs = manifest
        .split("[[run]]")
        .filter(|run| !run.contains("kind =") || run.contains("\"sweep\""));
    let manifest = runs.collect::<Vec<_>>().join("[[run]]").replace(".csv.gz", ".csv");
    fs::write(folder.join("campaign.toml"), manifest).expect("a new file");
}

/// A study of the sweeps where only pad and wheel have vertical sensors, of which the wheel's shows 6 % too much.
pub fn two_sensors() -> Studied {
    let from = ["models/campaigns/axle_a_rig", file!()].map(Path::new);
    Studied::made("two_sensors", write_two_sensors, &from)
}

fn write_two_sensors(folder: &Path) {
    swept(folder, &mut |name, value| {
        if name.starts_with("wheel") { 1.06 * value } else { value }
    });
    let is_one =
        |name: &str| name == "time" || name.ends_with("_z") && ["pad", "wheel"].iter().any(|own| name.starts_with(own));
    let manifest = folder.join("campaign.toml");
    let text = fs::read_to_string(&manifest).expect("it was written");
    let is_kept = |part: &&str| !part.starts_with("[[channel]]") || part.split('"').nth(1).is_some_and(is_one);
    let parts: Vec<&str> = text.split("\n\n").filter(is_kept).collect();
    fs::write(manifest, parts.join("\n\n")).expect("it is there");
    for level in LEVELS {
        let file = folder.join(format!("rig/sweep_{level}.csv"));
        let text = fs::read_to_string(&file).expect("it was written");
        fs::write(file, with_columns(&text, is_one)).expect("it is there");
    }
}

/// The columns of a table that are wanted.
fn with_columns(table: &str, wanted: impl Fn(&str) -> bool) -> String {
    let header = table.lines().next().expect("a header");
    let kept: Vec<bool> = header.split(',').map(wanted).collect();
    let line = |line: &str| {
        let cells = line.split(',').zip(&kept).filter(|(_, kept)| **kept);
        cells.map(|(cell, _)| cell).collect::<Vec<_>>().join(",") + "\n"
    };
    table.lines().map(line).collect()
}
