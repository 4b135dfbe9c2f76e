//! Measured files of 64 MB of samples in memory: read into channels, of which every sample is then requested once as a
//! double.
//!
//! The rate is that of the samples as the file stores them (two bytes for short integers, eight for doubles and for
//! numbers of a text), without times, names and padding.

#[path = "../../tests/rig_files/writers/mod.rs"]
#[expect(dead_code, reason = "texts and workbooks are written by tests alone")]
mod writers;

use divan::Bencher;
use divan::counter::BytesCount;
use qcar_signals::read::recognise;
use writers::{Channel, Group};

fn main() {
    divan::main();
}

const CHANNELS: usize = 16;
/// In each format.
const BYTES: usize = 64_000_000;

/// Sixteen channels with samples of so many bytes.
fn group(width: usize) -> Group {
    let samples = BYTES / CHANNELS / width;
    let wave = |channel: usize| {
        (0..samples)
            .map(|at| ((at + 31 * channel) as f64 * 0.01).sin())
            .collect()
    };
    let channel = |at: usize| Channel::new(&format!("channel_{at}"), "m/s^2", wave(at));
    Group::at(1000.0, (0..CHANNELS).map(channel).collect())
}

const SHORT: usize = 2;
const SINGLE: usize = 4;
const DOUBLE: usize = 8;

/// A format, and what writes a file of it.
type Format = (&'static str, fn() -> Vec<u8>);

const BINARY: [Format; 8] = [
    ("mat_5", || writers::mat5::file(&group(DOUBLE))),
    ("mat_7_3", || writers::mat73::file(&group(DOUBLE))),
    ("mdf_3", || writers::mdf3::file(&group(DOUBLE))),
    ("mdf_4", || writers::mdf4::file(&[group(DOUBLE)])),
    ("rpc_3_short", || writers::rpc::file(&group(SHORT))),
    ("rpc_3_float", || writers::rpc::floats(&group(SINGLE))),
    ("tdms", || writers::tdms::file(&group(DOUBLE))),
    ("uff_58b", || writers::uff::binary(&group(DOUBLE))),
];

#[divan::bench(sample_count = 10, args = BINARY.map(|(name, _)| name))]
fn binary(bencher: Bencher<'_, '_>, name: &str) {
    measure(bencher, &BINARY, name);
}

const TEXT: [Format; 2] = [
    ("uff_58", || writers::uff::file(&group(DOUBLE))),
    ("csv", || writers::tables::text(&group(DOUBLE))),
];

#[divan::bench(sample_count = 10, args = TEXT.map(|(name, _)| name))]
fn text(bencher: Bencher<'_, '_>, name: &str) {
    measure(bencher, &TEXT, name);
}

fn measure(bencher: Bencher<'_, '_>, formats: &[Format], name: &str) {
    let of_name = formats.iter().find(|(own, _)| *own == name);
    let file = of_name.expect("it is one of them").1();
    bencher.counter(BytesCount::new(BYTES)).bench_local(|| sum(&file));
}

/// Of all samples of all channels.
fn sum(file: &[u8]) -> f64 {
    let recording = recognise(file).expect("it was written to be read");
    assert_eq!(recording.signals.len(), CHANNELS);
    recording.signals.iter().flat_map(|signal| signal.samples.iter()).sum()
}
