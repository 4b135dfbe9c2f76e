//! Reading of recordings of several gigabytes: time and memory.
//!
//! `cargo bench --bench long_recording -- 2` writes files of 2 GB into the temporary folder and removes them again.
//! Each is read by a separate process, for which the system reports the largest resident set (Linux).

#[path = "../tests/rig_files/writers/mod.rs"]
#[expect(dead_code, reason = "other formats are written by tests alone")]
mod writers;

use std::env;
use std::error::Error;
use std::fs::{self, File};
use std::io::{BufWriter, Write};
use std::path::Path;
use std::process::Command;
use std::time::Instant;

use qcar_runtime::campaign::Campaign;
use qcar_signals::read::read;
use writers::{Channel, Group};

type Done<T> = Result<T, Box<dyn Error>>;

const CHANNELS: usize = 16;
/// Sample rate, Hz.
const RATE: f64 = 1000.0;
/// Samples of a frame of RPC III.
const FRAME: usize = 2048;

fn main() -> Done<()> {
    let arguments: Vec<String> = env::args().skip(1).filter(|word| word != "--bench").collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match words[..] {
        ["read", file] => told(|| Ok(read(Path::new(file))?.signals.len())),
        ["open", folder] => told(|| Ok(Campaign::open(Path::new(folder))?.runs.len())),
        [gigabytes] => measure(gigabytes.parse()?),
        _ => {
            println!("left out: `cargo bench --bench long_recording -- 2` reads recordings of 2 GB");
            Ok(())
        }
    }
}

/// Runs a function and prints its time and the largest memory of this process.
fn told(work: impl Fn() -> Done<usize>) -> Done<()> {
    let begun = Instant::now();
    let count = work()?;
    println!("{count} {} {}", begun.elapsed().as_secs_f64(), largest_resident_set());
    Ok(())
}

/// Largest memory of this process so far, MB; NaN if the system does not report it.
fn largest_resident_set() -> f64 {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    let kibibytes = line.and_then(|line| line.trim().strip_suffix("kB")?.trim().parse().ok());
    kibibytes.map_or(f64::NAN, |kibibytes: f64| kibibytes * 1024.0 / 1e6)
}

fn measure(gigabytes: f64) -> Done<()> {
    let folder = tempfile::tempdir()?;
    println!("what | seconds | MB/s | memory, MB");
    for (name, write) in [("doubles.mf4", mdf as fn(&Path, f64) -> Done<()>), ("shorts.rpc", rpc)] {
        let file = folder.path().join(name);
        write(&file, gigabytes * 1e9)?;
        fs::write(folder.path().join("campaign.toml"), campaign(name))?;
        let megabytes = fs::metadata(&file)?.len() as f64 / 1e6;
        for (task, path) in [("read", file.as_path()), ("open", folder.path())] {
            let output = Command::new(env::current_exe()?).arg(task).arg(path).output()?;
            let said = String::from_utf8(output.stdout)?;
            let [_, seconds, memory] = said.split_whitespace().collect::<Vec<_>>()[..] else {
                return Err(String::from_utf8(output.stderr)?.into());
            };
            let speed = megabytes / seconds.parse::<f64>()?;
            println!("{task} {name}, {megabytes:.0} MB | {seconds:.4} | {speed:.0} | {memory:.6}");
        }
        fs::remove_file(file)?;
    }
    Ok(())
}

/// Two minutes at the beginning, and one later.
fn campaign(file: &str) -> String {
    let channel = |place: &str, source: usize| {
        format!(
            "[[channel]]\nname = \"{place}_left_z\"\nlocation = \"{place}\"\nside = \"left\"\naxis = \"z\"\n\
             quantity = \"acceleration\"\nsource = \"channel_{source}\"\n\n"
        )
    };
    let run = |name: &str, from: u32, to: u32| {
        format!(
            "[[run]]\nname = \"{name}\"\nkind = \"time_history\"\nfile = \"{file}\"\nrole = \"fit\"\nband_limited = true\n\
             from = {from}\nto = {to}\n\n"
        )
    };
    let head = "format = 1\nname = \"long\"\nmodel = \"quarter_car\"\n\n[vehicle]\nm_corner = 400.0\n\n";
    head.to_string() + &channel("pad", 0) + &channel("body", 1) + &run("first", 0, 120) + &run("later", 600, 660)
}

/// Sixteen channels of `samples` samples.
fn group(samples: usize) -> Group {
    let wave = |channel: usize| (0..samples).map(|at| value(at, channel)).collect();
    let channel = |at: usize| Channel::new(&format!("channel_{at}"), "m/s^2", wave(at));
    Group::at(RATE, (0..CHANNELS).map(channel).collect())
}

/// A sample of a sawtooth, different in each channel.
fn value(at: usize, channel: usize) -> f64 {
    ((at + 31 * channel) % 1009) as f64 - 504.0
}

/// MDF 4 of doubles: a small file with a longer block of data appended, which replaces its own.
fn mdf(file: &Path, bytes: f64) -> Done<()> {
    let record = 8 * (1 + CHANNELS);
    let records = bytes as usize / record;
    let mut head = writers::mdf4::file(&[group(1)]);
    head.resize(head.len().next_multiple_of(8), 0);
    let at = |head: &[u8], place: usize| {
        head[place..]
            .first_chunk()
            .map_or(0, |link| u64::from_le_bytes(*link) as usize)
    };
    let data_group = at(&head, 64 + 24);
    let channel_group = at(&head, data_group + 24 + 8);
    let data = head.len() as u64;
    head[data_group + 24 + 16..][..8].copy_from_slice(&data.to_le_bytes());
    head[channel_group + 24 + 48 + 8..][..8].copy_from_slice(&(records as u64).to_le_bytes());
    let mut out = BufWriter::new(File::create(file)?);
    out.write_all(&head)?;
    out.write_all(b"##DT\0\0\0\0")?;
    out.write_all(&(24 + (records * record) as u64).to_le_bytes())?;
    out.write_all(&[0; 8])?;
    for at in 0..records {
        out.write_all(&(at as f64 / RATE).to_le_bytes())?;
        for channel in 0..CHANNELS {
            out.write_all(&value(at, channel).to_le_bytes())?;
        }
    }
    // Pending writes to the disk would be measured too.
    Ok(out.into_inner()?.sync_all()?)
}

/// RPC III of short integers: a file of one frame, with its frame again and again.
fn rpc(file: &Path, bytes: f64) -> Done<()> {
    let mut head = writers::rpc::file(&group(FRAME));
    let frame = head.split_off(head.len() - 2 * CHANNELS * FRAME);
    let frames = bytes as usize / frame.len();
    for (name, number) in [("FRAMES", frames), ("SAMPLES", frames * FRAME)] {
        let mut key = name.as_bytes().to_vec();
        key.resize(32, 0);
        let place = head
            .windows(32)
            .position(|own| own == key)
            .ok_or("a header without frames")?;
        let mut text = number.to_string().into_bytes();
        text.resize(96, 0);
        head[place + 32..place + 128].copy_from_slice(&text);
    }
    let mut out = BufWriter::new(File::create(file)?);
    out.write_all(&head)?;
    for _ in 0..frames {
        out.write_all(&frame)?;
    }
    Ok(out.into_inner()?.sync_all()?)
}
