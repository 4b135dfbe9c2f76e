//! Results of shipped campaigns and targets that take a search each: made once for all test programs, also where these
//! run at a time.

use std::fmt::Write;
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::Command;

/// How wide a terminal its text is for.
pub const COLUMNS: usize = 100;

/// The line that [`Studied::targets`] runs once for all tests, as users are told to write it.
#[allow(dead_code, reason = "not every test program runs the lines that users are told")]
pub const TARGETS: &str = "target models/targets/axle_a.toml --out design";

/// A shipped campaign studied, or targets met.
pub struct Studied {
    /// The folder of its results.
    pub folder: PathBuf,
    /// What it has printed for a terminal of [`COLUMNS`].
    pub said: String,
}

impl Studied {
    /// By the name of the campaign's folder.
    pub fn new(campaign: &str) -> Self {
        let shipped = Path::new("models/campaigns").join(campaign);
        Self::once(campaign, ["study", shipped.to_str().unwrap()], &[&shipped])
    }

    /// `models/targets/axle_a.toml`, with its front and its solution space.
    #[allow(dead_code, reason = "not every test program looks at targets")]
    pub fn targets() -> Self {
        let [file, campaign] = ["models/targets/axle_a.toml", "models/campaigns/axle_a_rig"];
        Self::once("targets", ["target", file], &[Path::new(file), Path::new(campaign)])
    }

    /// Sensitivities of a shipped campaign, with uncertainty and Sobol indices.
    #[allow(dead_code, reason = "not every test program looks at sensitivities")]
    pub fn sensitivities() -> Self {
        let campaign = "models/campaigns/axle_a_rig";
        let line = ["sensitivity", campaign, "--tolerance", "k_tire=5%", "--sobol", "400"];
        Self::once("sensitivities", line, &[Path::new(campaign)])
    }

    /// A study of a campaign that a test makes from these files.
    #[allow(dead_code, reason = "not every test program makes campaigns")]
    pub fn made(name: &str, make: fn(&Path), of: &[&Path]) -> Self {
        let campaign = place(name).join("campaign");
        let make = || {
            let _ = fs::remove_dir_all(&campaign);
            fs::create_dir(&campaign).unwrap();
            make(&campaign);
        };
        Self::once_after(make, name, ["study", campaign.to_str().unwrap()], of)
    }

    fn once<const N: usize>(name: &str, arguments: [&str; N], of: &[&Path]) -> Self {
        Self::once_after(|| {}, name, arguments, of)
    }

    /// What a verb makes of a subject, unless that is there already from the same program and the same files.
    fn once_after<const N: usize>(prepare: impl FnOnce(), name: &str, arguments: [&str; N], of: &[&Path]) -> Self {
        let place = place(name);
        fs::create_dir_all(&place).unwrap();
        let [folder, printed, subject] = ["results", "printed", "subject"].map(|name| place.join(name));
        let _others_wait = {
            let lock = File::create(place.join("lock")).unwrap();
            lock.lock().unwrap();
            lock
        };
        let present = state(of);
        if fs::read_to_string(&subject).ok().as_deref() != Some(&present) {
            prepare();
            fs::write(&printed, run(arguments, &folder)).unwrap();
            fs::write(&subject, present).unwrap();
        }
        let said = fs::read_to_string(&printed).unwrap();
        Self { folder, said }
    }
}

fn place(name: &str) -> PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR")).join("studies").join(name)
}

fn run<const N: usize>(arguments: [&str; N], out: &Path) -> String {
    let _ = fs::remove_dir_all(out);
    let output = Command::new(env!("CARGO_BIN_EXE_qcar"))
        .args(arguments)
        .args([Path::new("--out"), out])
        .env("COLUMNS", COLUMNS.to_string())
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

/// What results are of: the program, and files or all files of folders, as they were written last.
fn state(of: &[&Path]) -> String {
    let mut files = Vec::new();
    let mut paths = vec![PathBuf::from(env!("CARGO_BIN_EXE_qcar"))];
    // Test programs in other folders call the same file by other names.
    let whole = |path: &&Path| Path::new(env!("CARGO_MANIFEST_DIR")).join(path).canonicalize().unwrap();
    paths.extend(of.iter().map(whole));
    while let Some(path) = paths.pop() {
        match path.is_dir() {
            true => paths.extend(fs::read_dir(path).unwrap().map(|entry| entry.unwrap().path())),
            false => files.push(path),
        }
    }
    files.sort();
    let mut state = String::new();
    for file in files {
        let written = fs::metadata(&file).unwrap().modified().unwrap();
        writeln!(state, "{} {written:?}", file.display()).unwrap();
    }
    state
}
