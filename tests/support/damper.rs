//! The shipped records of a real damper, cut to what a search needs.

use std::fs;
use std::io::Read;
use std::path::Path;

use flate2::read::GzDecoder;

use super::studied::Studied;

const SHIPPED: &str = "models/campaigns/mr_damper";
/// Four seconds, up to four turns of the crank: a search takes a fifteenth of the time that it takes with all 15 s.
const SAMPLES: usize = 400;

/// A study of the first seconds of each record.
pub fn short_damper() -> Studied {
    Studied::made("short_damper", write_short, &[SHIPPED, file!()].map(Path::new))
}

fn write_short(folder: &Path) {
    let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join(SHIPPED);
    for number in [1, 3, 5, 7, 9] {
        let mut text = String::new();
        let packed = fs::File::open(shipped.join(format!("crank_{number}.csv.gz"))).expect("it is shipped");
        GzDecoder::new(packed).read_to_string(&mut text).expect("text");
        let lines: Vec<&str> = text.lines().take(1 + SAMPLES).collect();
        fs::write(folder.join(format!("crank_{number}.csv")), lines.join("\n") + "\n").expect("a new file");
    }
    let manifest = fs::read_to_string(shipped.join("campaign.toml")).expect("it is shipped");
    fs::write(folder.join("campaign.toml"), manifest.replace(".csv.gz", ".csv")).expect("a new file");
}
