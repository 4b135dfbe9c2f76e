//! Studies of shipped campaigns, which take a search each: made once for all test programs, also where these run at a time.

use std::fmt::Write;
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::Command;

/// How wide a terminal its text is for.
pub const COLUMNS: usize = 100;

/// A study of a shipped campaign.
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
        let place = Path::new(env!("CARGO_TARGET_TMPDIR")).join("studies").join(campaign);
        fs::create_dir_all(&place).unwrap();
        let [folder, printed, subject] = ["results", "printed", "subject"].map(|name| place.join(name));
        let _others_wait = {
            let lock = File::create(place.join("lock")).unwrap();
            lock.lock().unwrap();
            lock
        };
        let present = state(&shipped);
        if fs::read_to_string(&subject).ok().as_deref() != Some(&present) {
            fs::write(&printed, study(&shipped, &folder)).unwrap();
            fs::write(&subject, present).unwrap();
        }
        let said = fs::read_to_string(&printed).unwrap();
        Self { folder, said }
    }
}

fn study(campaign: &Path, out: &Path) -> String {
    let _ = fs::remove_dir_all(out);
    let output = Command::new(env!("CARGO_BIN_EXE_qcar"))
        .args([Path::new("study"), campaign, Path::new("--out"), out])
        .env("COLUMNS", COLUMNS.to_string())
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

/// What a study is of: the program and the campaign's files, as they were written last.
fn state(campaign: &Path) -> String {
    let mut files = vec![PathBuf::from(env!("CARGO_BIN_EXE_qcar"))];
    let mut folders = vec![Path::new(env!("CARGO_MANIFEST_DIR")).join(campaign)];
    while let Some(folder) = folders.pop() {
        for path in fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
            if path.is_dir() { &mut folders } else { &mut files }.push(path);
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
