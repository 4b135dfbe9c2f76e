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

fn reads(bencher: Bencher<'_, '_>, file: &[u8]) {
    bencher
        .counter(BytesCount::new(file.len()))
        .bench_local(|| recognise(file).expect("it was written to be read"));
}

#[divan::bench(sample_count = 10)]
fn mdf_4(bencher: Bencher<'_, '_>) {
    reads(bencher, &writers::mdf4::file(&[group(DOUBLE)]));
}

#[divan::bench(sample_count = 10)]
fn rpc_3(bencher: Bencher<'_, '_>) {
    reads(bencher, &writers::rpc::file(&group(SHORT)));
}

#[divan::bench(sample_count = 10)]
fn uff_58_text(bencher: Bencher<'_, '_>) {
    reads(bencher, &writers::uff::file(&group(DOUBLE)));
}

#[divan::bench(sample_count = 10)]
fn tdms(bencher: Bencher<'_, '_>) {
    reads(bencher, &writers::tdms::file(&group(DOUBLE)));
}

#[divan::bench(sample_count = 10)]
fn mat_5(bencher: Bencher<'_, '_>) {
    reads(bencher, &writers::mat5::file(&group(DOUBLE)));
}
