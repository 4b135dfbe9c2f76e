//! Measured files of 64 MB in memory, read into channels: bytes of the file a second.

#[path = "../tests/rig_files/writers/mod.rs"]
#[expect(dead_code, reason = "texts and workbooks are written by tests alone")]
mod writers;

use divan::Bencher;
use divan::counter::BytesCount;
use qcar_signals::read::recognise;
use writers::{Channel, Group};

fn main() {
    divan::main();
}

/// Sixteen channels of `samples` samples.
fn group(samples: usize) -> Group {
    let wave = |channel: usize| {
        (0..samples)
            .map(|at| ((at + 31 * channel) as f64 * 0.01).sin())
            .collect()
    };
    let channel = |at: usize| Channel::new(&format!("channel_{at}"), "m/s^2", wave(at));
    Group {
        rate: 1000.0,
        channels: (0..16).map(channel).collect(),
    }
}

/// Half a million samples of each channel are 64 MB in double precision.
const DOUBLE: usize = 500_000;
/// As many bytes of short integers.
const SHORT: usize = 2_000_000;

/// A format, and what writes a file of it.
type Format = (&'static str, fn() -> Vec<u8>);

const FORMATS: [Format; 5] = [
    ("mdf_4", || writers::mdf4::file(&[group(DOUBLE)])),
    ("rpc_3", || writers::rpc::file(&group(SHORT))),
    ("uff_58_text", || writers::uff::file(&group(DOUBLE))),
    ("tdms", || writers::tdms::file(&group(DOUBLE))),
    ("mat_5", || writers::mat5::file(&group(DOUBLE))),
];

#[divan::bench(sample_count = 10, args = FORMATS.map(|(name, _)| name))]
fn reads(bencher: Bencher<'_, '_>, name: &str) {
    let of_name = FORMATS.iter().find(|(own, _)| *own == name);
    let file = of_name.expect("it is one of them").1();
    bencher
        .counter(BytesCount::new(file.len()))
        .bench_local(|| recognise(&file).expect("it was written to be read"));
}
