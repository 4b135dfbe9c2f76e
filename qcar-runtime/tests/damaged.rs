//! Whatever the files of a campaign hold, they are read or refused: what the fuzz targets of campaigns run without end,
//! some thousand times here.

#[path = "../../fuzz/bodies/campaign.rs"]
mod campaign;
#[path = "../../fuzz/mutation.rs"]
mod mutation;

use std::fs;
use std::path::Path;

use campaign::{MANIFEST, TABLE, survives_campaign, survives_table, survives_workbook};
use mutation::{Random, mutated};

/// Runs a body on so many damaged copies of a file.
fn survives(body: fn(&[u8]), file: &[u8], mutations: usize) {
    let mut random = Random(0x5eed);
    body(file);
    for _ in 0..mutations {
        body(&mutated(file, &mut random));
    }
}

#[test]
fn manifests() {
    survives(survives_campaign, MANIFEST.as_bytes(), 1500);
}

#[test]
fn tables() {
    survives(survives_table, TABLE.as_bytes(), 1500);
}

#[test]
fn workbooks() {
    let file =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../qcar-signals/tests/samples/table/vehicle_template.xlsx");
    survives(survives_workbook, &fs::read(file).unwrap(), 300);
}
