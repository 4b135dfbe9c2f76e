//! Any content is read or refused: no panic, and memory bounded by the size of the file.

#[path = "../../tests/support/counting.rs"]
mod counting;
#[path = "../../fuzz/mutation.rs"]
mod mutation;
#[path = "../../fuzz/bodies/recording.rs"]
mod recording;

use std::fs;
use std::io::Write as _;
use std::panic::catch_unwind;
use std::path::Path;

use flate2::Compression;
use flate2::write::ZlibEncoder;
use qcar_signals::read::recognise;

use mutation::{Random, mutated};

/// The most that a reader held beyond what it was given, bytes.
fn memory_of(bytes: &[u8]) -> isize {
    counting::memory_of(|| recording::survives(bytes))
}

fn sample(name: &str) -> Vec<u8> {
    fs::read(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/samples").join(name)).unwrap()
}

/// Bytes that a reader may hold for each byte of a file of a few hundred kilobytes, and for any file. Rows of a table
/// of text take more than they are long while its head is looked at.
const PER_BYTE: usize = 64;
const ALWAYS: usize = 48 << 20;

fn survives(names: &[&str], mutations: usize) {
    let mut random = Random(0x5eed);
    for name in names {
        let file = sample(name);
        for at in 0..mutations / names.len() {
            let bytes = mutated(&file, &mut random);
            let held = catch_unwind(|| memory_of(&bytes));
            let held = held.unwrap_or_else(|_| panic!("mutation {at} of {name} made the reader panic"));
            let bound = (PER_BYTE * bytes.len() + ALWAYS) as isize;
            assert!(
                held <= bound,
                "mutation {at} of {name}: {held} bytes for a file of {}",
                bytes.len()
            );
        }
    }
}

#[test]
fn tables_of_text() {
    survives(
        &[
            "table/kc_semicolon_comma_latin1.csv",
            "table/rig_units_row_bom_crlf.csv",
            "table/stamps_semicolon.csv",
        ],
        4500,
    );
}

#[test]
fn mdf() {
    let plain = [
        "mdf/plain_3groups.mf4",
        "mdf/v330_3groups.mdf",
        "mdf/special_text_invalid_bits.mf4",
    ];
    survives(&plain, 4000);
    survives(&["mdf/other_writer_dz.mf4", "mdf/dz_transposed_3groups.mf4"], 1000);
}

#[test]
fn uff() {
    survives(
        &[
            "uff/151_164_58_58b.uff",
            "uff/binary8byte_58b.uff",
            "uff/time_history_partial_line.uff",
        ],
        3000,
    );
}

#[test]
fn rpc() {
    survives(
        &[
            "rpc/short_4frames_group.tim",
            "rpc/drive_spaces_zero_channel.drv",
            "rpc/float_1frame_group.rpc",
        ],
        3000,
    );
}

#[test]
fn tdms() {
    survives(
        &[
            "tdms/waveform_2segments.tdms",
            "tdms/int16_linear_scale_time_channel.tdms",
            "tdms/big_endian_interleaved.tdms",
            "tdms/daqmx_two_widths.tdms",
            "tdms/time_stamps.tdms",
            "tdms/big_endian_time_stamps.tdms",
        ],
        9000,
    );
}

#[test]
fn mat() {
    survives(
        &[
            "mat/dspace_v6.mat",
            "mat/matlab65_struct_v6.mat",
            "mat/labcontrol_ensaio_A1.mat",
            "mat/scipy_structures.mat",
            "mat/scipy_v4.mat",
            "mat/matlab42_big_endian_v4.mat",
        ],
        6000,
    );
    survives(
        &["mat/testlab_v73.mat", "mat/matlab74_double_v73.mat", "mat/h5py_odd.h5"],
        4500,
    );
    survives(&["mat/h5py_v114.mat"], 2000);
}

#[test]
fn crg() {
    let binary = ["crg/slope_banking_krbi.crg", "crg/missing_border_kdbi.crg"];
    survives(&binary, 3000);
    survives(&["crg/handmade_curved_banked_sloped.crg", "crg/start_ldfi.crg"], 3000);
}

#[test]
fn workbooks() {
    survives(
        &[
            "table/kc_bounce.xlsx",
            "table/vehicle_template.xlsx",
            "table/openpyxl_dates.xlsx",
        ],
        3000,
    );
}

#[test]
fn a_file_that_is_cut_anywhere_is_refused() {
    let samples = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/samples");
    for folder in ["mdf", "mat", "rpc", "tdms", "uff", "crg"] {
        for entry in fs::read_dir(samples.join(folder)).unwrap() {
            let path = entry.unwrap().path();
            let bytes = fs::read(&path).unwrap();
            for sixteenth in 0..16 {
                let cut = &bytes[..bytes.len() * sixteenth / 16];
                assert!(recognise(cut).is_err(), "{sixteenth} sixteenths of {}", path.display());
            }
        }
    }
    let hdf5 = sample("mat/h5py_latest.mat");
    refused(&hdf5[..3659], &["3659 bytes", "3903 bytes", "cut off"]);
    let matlab = sample("mat/testlab_v73.mat");
    refused(&matlab[..60_000], &["60000 bytes", "cut off"]);
}

/// A file in which one number is replaced, to claim far more than there is.
fn claiming(name: &str, at: usize, number: &[u8]) -> Vec<u8> {
    let mut bytes = sample(name);
    bytes[at..at + number.len()].copy_from_slice(number);
    bytes
}

fn find(bytes: &[u8], what: &[u8]) -> usize {
    bytes.windows(what.len()).position(|window| window == what).unwrap()
}

/// Refused with all of `parts` in the message, in less than a megabyte.
fn refused(bytes: &[u8], parts: &[&str]) {
    let fault = recognise(bytes).unwrap_err().to_string();
    for part in parts {
        assert!(fault.contains(part), "`{part}` is not in: {fault}");
    }
    assert!(memory_of(bytes) < 1 << 20);
}

#[test]
fn a_claim_of_ten_gigabytes_allocates_no_memory() {
    let many = 1_250_000_000_u64;

    let file = sample("mdf/plain_3groups.mf4");
    let group = find(&file, b"##CG");
    let links = usize::from(file[group + 16]);
    let cycles = group + 24 + 8 * links + 8;
    refused(
        &claiming("mdf/plain_3groups.mf4", cycles, &many.to_le_bytes()),
        &["1250000000 records", "2000 whole records", "rig_500Hz"],
    );

    let file = sample("rpc/short_4frames_group.tim");
    let frames = find(&file, b"FRAMES\0") + 32;
    refused(
        &claiming("rpc/short_4frames_group.tim", frames, b"2441406\0"),
        &["2441406 frames", "2 groups are whole", "cut off"],
    );

    let file = sample("uff/binary8byte_58b.uff");
    let count = find(&file, b"         4       250") + 10;
    refused(
        &claiming("uff/binary8byte_58b.uff", count, b"1250000000"),
        &["10000000000 bytes", "channel `NONE`"],
    );

    let file = sample("crg/slope_banking_krbi.crg");
    let end = find(&file, b"reference_line_end_u") + 27;
    refused(
        &claiming("crg/slope_banking_krbi.crg", end, b"   6.0000000000000000e+07"),
        &["1200000001 rows", "120 rows of data"],
    );

    let file = sample("tdms/waveform_2segments.tdms");
    let length = file.len() - 56000 - 28;
    let second = file[..length].windows(4).rposition(|window| window == b"TDSm").unwrap();
    refused(
        &claiming("tdms/waveform_2segments.tdms", second + 12, &(8 * many).to_le_bytes()),
        &["segment 2", "the segment before it is whole"],
    );

    refused(
        &claiming("tdms/waveform_2segments.tdms", second + 12, &u64::MAX.to_le_bytes()),
        &[
            "segment 2",
            "the segment before it is whole",
            "the recording was interrupted",
        ],
    );

    let file = sample("mat/matlab65_struct_v6.mat");
    let field = find(&file, &[9, 0, 0, 0, 24, 0, 0, 0]);
    refused(
        &claiming("mat/matlab65_struct_v6.mat", field + 4, &many.to_le_bytes()[..4]),
        &["1250000000 bytes", "doublefield"],
    );

    refused(
        &claiming("mat/scipy_v4.mat", 4, &many.to_le_bytes()[..4]),
        &["10000000000 bytes of numbers", "channel `t`"],
    );

    let file = sample("mat/matlab74_double_v73.mat");
    let size = 9_u64.to_le_bytes();
    let dimension = find(&file, &[size, 1_u64.to_le_bytes()].concat());
    refused(
        &claiming("mat/matlab74_double_v73.mat", dimension, &many.to_le_bytes()),
        &["10000000000 bytes", "testdouble"],
    );
}

#[test]
fn a_packed_block_with_more_data_than_declared_is_refused() {
    // A megabyte of zeros in a thousand bytes, which claim to be eight.
    let mut packed = ZlibEncoder::new(Vec::new(), Compression::best());
    packed.write_all(&vec![0; 1 << 20]).unwrap();
    let packed = packed.finish().unwrap();
    let mut file = sample("mdf/dz_transposed_3groups.mf4");
    let block = find(&file, b"##DZ");
    let data = block + 48;
    file[data - 16..data - 8].copy_from_slice(&8_u64.to_le_bytes());
    file[data - 8..data].copy_from_slice(&(packed.len() as u64).to_le_bytes());
    file[data..data + packed.len()].copy_from_slice(&packed);
    refused(&file, &["whole records"]);
}

#[test]
fn unknown_formats_are_refused() {
    refused(b"\x7fELF\x02\x01\x01\0\0\0\0\0\0\0\0\0", &["expected"]);
    refused(b"", &["an empty file"]);
    refused(b"UnFinMF 4.10    ", &["did not finish"]);
    refused(b"MDF     5.00    ", &["MDF version `5.00`"]);
    refused(b"\xd0\xcf\x11\xe0", &[".xls", "save it as .xlsx"]);
}
