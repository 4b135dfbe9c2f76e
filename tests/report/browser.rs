//! Chromium: a report in a window of any width, seen by a probe, and a report on paper.

use std::collections::BTreeMap;
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::{Arc, Mutex, OnceLock};

use serde_json::Value;

const PROBE: &str = include_str!("../browser/probe.js");
const FRAME: &str = include_str!("../browser/frame.html");

/// What the browser is called.
const BROWSERS: [&str; 3] = ["chromium", "chromium-browser", "google-chrome"];

/// The browser; without one, a word, so that nobody takes this for a check.
pub fn browser_or_word() -> Option<PathBuf> {
    let found = BROWSERS.iter().find_map(|name| program(name));
    if found.is_none() {
        say("not checked: reports in a browser, since Chromium is absent (apt-get install chromium)");
    }
    found
}

/// The browser, where there is a reader of PDF too; else a word.
pub fn printer_or_word() -> Option<PathBuf> {
    let found = browser_or_word()?;
    let reads = program("pdftotext").is_some();
    if !reads {
        say("not checked: reports on paper, since pdftotext is absent (apt-get install poppler-utils)");
    }
    reads.then_some(found)
}

/// Past the capture of the test's output.
fn say(word: &str) {
    let mut out = std::io::stderr();
    writeln!(out, "{word}").unwrap();
}

fn program(name: &str) -> Option<PathBuf> {
    let path = std::env::var_os("PATH")?;
    let files = std::env::split_paths(&path).map(|folder| folder.join(name));
    files.into_iter().find(|file| file.is_file())
}

/// What the probe has found in a report: several tests ask for the same page, which is opened once for them all.
pub fn look(browser: &Path, report: &str, width: u64, theme: &str) -> Value {
    static SEEN: Once<(String, u64, String), Value> = Mutex::new(BTreeMap::new());
    let page = (report.to_owned(), width, theme.to_owned());
    once(&SEEN, page, || open(browser, report, width, theme, "all"))
}

/// The paragraphs of a report alone, in a part of the time.
pub fn texts(browser: &Path, report: &str) -> Value {
    static SEEN: Once<String, Value> = Mutex::new(BTreeMap::new());
    once(&SEEN, report.to_owned(), || {
        open(browser, report, 1280, "light", "texts")
    })
}

/// What was made once, by what it was made of.
type Once<Of, Made> = Mutex<BTreeMap<Of, Arc<OnceLock<Made>>>>;

fn once<Of: Ord, Made: Clone>(known: &Once<Of, Made>, of: Of, make: impl FnOnce() -> Made) -> Made {
    let made = Arc::clone(known.lock().unwrap().entry(of).or_default());
    made.get_or_init(make).clone()
}

/// Opens a report with the probe before its scripts, which looks at `all` or at `texts`.
fn open(browser: &Path, report: &str, width: u64, theme: &str, at: &str) -> Value {
    let folder = tempfile::tempdir().unwrap();
    let themed = format!("<html lang=\"en\" data-theme=\"{theme}\" data-probed=\"{at}\">");
    let opened = report.replacen("<html lang=\"en\">", &themed, 1).replacen(
        "<style>",
        &format!("<script>{PROBE}</script><style>"),
        1,
    );
    fs::write(folder.path().join("probed.html"), opened).unwrap();
    let page = folder.path().join("frame.html");
    fs::write(&page, FRAME.replace("WIDTH", &width.to_string())).unwrap();
    let output = run(browser, &page, &["--window-size=1400,1000", "--dump-dom"]);
    let dom = String::from_utf8_lossy(&output.stdout);
    let found = dom
        .split("data-found=\"")
        .nth(1)
        .and_then(|rest| rest.split('"').next());
    let found = found.unwrap_or_else(|| panic!("the probe said nothing: {}", String::from_utf8_lossy(&output.stderr)));
    let json = found
        .replace("&quot;", "\"")
        .replace("&lt;", "<")
        .replace("&gt;", ">")
        .replace("&amp;", "&");
    serde_json::from_str(&json).unwrap()
}

/// A report as a PDF, read by `pdftotext` with these options.
pub fn printed(browser: &Path, report: &str, options: &[&str]) -> String {
    static PRINTED: Once<String, Vec<u8>> = Mutex::new(BTreeMap::new());
    let folder = tempfile::tempdir().unwrap();
    let pdf = folder.path().join("report.pdf");
    fs::write(&pdf, once(&PRINTED, report.to_owned(), || print(browser, report))).unwrap();
    let read = Command::new("pdftotext")
        .args(options)
        .arg(&pdf)
        .arg("-")
        .output()
        .unwrap();
    assert!(read.status.success(), "{}", String::from_utf8_lossy(&read.stderr));
    String::from_utf8(read.stdout).unwrap()
}

/// The bytes of its PDF.
fn print(browser: &Path, report: &str) -> Vec<u8> {
    let folder = tempfile::tempdir().unwrap();
    let [page, pdf] = ["report.html", "report.pdf"].map(|name| folder.path().join(name));
    fs::write(&page, report).unwrap();
    let out = format!("--print-to-pdf={}", pdf.display());
    run(
        browser,
        &page,
        &["--virtual-time-budget=10000", "--no-pdf-header-footer", &out],
    );
    fs::read(pdf).unwrap()
}

fn run(browser: &Path, page: &Path, options: &[&str]) -> Output {
    let profile = tempfile::tempdir().unwrap();
    Command::new(browser)
        .args([
            "--headless",
            "--no-sandbox",
            "--disable-gpu",
            "--no-first-run",
            "--hide-scrollbars",
            "--disable-background-networking",
            "--disable-component-update",
            "--disable-sync",
            "--host-resolver-rules=MAP * ~NOTFOUND",
        ])
        .args(options)
        .arg(format!("--user-data-dir={}", profile.path().display()))
        .arg(format!("file://{}", page.display()))
        .output()
        .unwrap()
}
