//! Growth of the work of verbs with the length of a chain of masses, in instructions of the whole program. Valgrind
//! counts them, so other programs on the machine do not disturb. `docs/benchmarks.md` has the table.

#![allow(missing_docs, reason = "a program, of which nothing is public")]

#[path = "chains/campaign.rs"]
mod campaign;
#[path = "../qcar-dsl/examples/chain.rs"]
#[allow(dead_code, reason = "the example measures times")]
mod chain;

use std::fs;
use std::path::Path;
use std::process::Command;

const LENGTHS: [usize; 4] = [10, 20, 40, 80];

/// Verbs with their arguments; CHAIN stands for the model, CAMPAIGN for the folder of the campaigns that drive it.
const ASKED: [&str; 14] = [
    "check CHAIN",
    "show CHAIN --stage equations",
    "show CHAIN --stage matrices",
    "show CHAIN --stage rust",
    "show CHAIN --stage latex",
    "matrices CHAIN",
    "matrices CHAIN --format json",
    "frf CHAIN",
    "frf CHAIN --format json",
    "compare CHAIN CHAIN",
    "kc CAMPAIGN/kc",
    "simulate CAMPAIGN/sweep",
    "simulate CAMPAIGN/history",
    "simulate CAMPAIGN/cleat",
];

/// The same for FEW, the chain with channels to three of its masses, and TABLE, a new file. Only with three parameters.
const ASKED_OF_FEW: [&str; 9] = [
    "diff FEW CHAIN",
    "patch FEW coulomb_friction --at l2",
    "fit CAMPAIGN/fitted",
    "plan CAMPAIGN/fitted",
    "score CAMPAIGN/fitted",
    "explore FEW --vary c=20..40 --count 16 --metrics modes,transmissibility --out TABLE",
    "sensitivity FEW --metrics mode.*",
    "sensitivity FEW --metrics mode.1.*",
    "target CAMPAIGN/targets.toml",
];

/// The same, only with three parameters of each member.
const ASKED_OF_OWN: [&str; 1] = ["explore FEW --vary c1=20..40 --count 16 --metrics transmissibility --out TABLE"];

/// Targets for the damping of a mode.
const TARGETS: &str = "subject = \"few.axle\"
[[target]]
metric = \"mode.1.damping\"
at_least = \"110 %\"
[[parameter]]
name = \"c\"
range = [\"70 %\", \"150 %\"]
";

fn main() {
    let valgrind = Command::new("valgrind").arg("--version").output();
    if valgrind.is_err() {
        println!("instructions are not counted: valgrind is not installed; write `apt-get install valgrind`");
        return;
    }
    let folder = tempfile::tempdir().expect("a temporary folder can be made");
    for (own, what) in [
        (false, "three parameters that all members share"),
        (true, "three parameters of each member"),
    ] {
        println!("{what}: millions of instructions of {LENGTHS:?} masses; exponent from 10 to 80, from 40 to 80");
        LENGTHS.iter().for_each(|&masses| write(folder.path(), masses, own));
        ASKED.iter().for_each(|asked| measure(folder.path(), asked));
        let further = if own { &ASKED_OF_OWN[..] } else { &ASKED_OF_FEW[..] };
        further.iter().for_each(|asked| measure(folder.path(), asked));
    }
}

/// A chain and the campaigns that drive it, in a folder of their own.
fn write(folder: &Path, masses: usize, own: bool) {
    let folder = folder.join(masses.to_string());
    fs::create_dir_all(&folder).expect("the folder is writable");
    let chain = chain::chain(masses, own);
    let files = [
        ("chain.axle", with_channels(&chain, 1..=masses)),
        ("few.axle", with_channels(&chain, campaign::SENSORS)),
        ("targets.toml", TARGETS.to_string()),
    ];
    for (name, text) in files {
        fs::write(folder.join(name), text).expect("the folder is writable");
    }
    campaign::write(&folder, masses);
}

/// A channel from the road to each of these masses.
fn with_channels(chain: &str, masses: impl IntoIterator<Item = usize>) -> String {
    let channel =
        |place: usize| format!("        channel to_q{place} = q{place}.acceleration / road_below.acceleration;\n");
    let channels: String = masses.into_iter().map(channel).collect();
    let end = "    }\n}\n";
    chain.strip_suffix(end).expect("a chain ends its direction").to_string() + &channels + end
}

fn measure(folder: &Path, asked: &str) {
    let counts = LENGTHS.map(|masses| instructions(&folder.join(masses.to_string()), asked));
    let exponent = |from: usize| {
        let grown = counts[3] / counts[from];
        grown.ln() / (LENGTHS[3] as f64 / LENGTHS[from] as f64).ln()
    };
    let counted = counts.map(|count| format!("{:9.1}", count / 1e6)).concat();
    println!("{asked:30}{counted}{:8.2}{:6.2}", exponent(0), exponent(2));
}

/// The instructions of a whole run of the program, in a folder.
fn instructions(folder: &Path, asked: &str) -> f64 {
    let names = [
        ("CHAIN", "chain.axle"),
        ("FEW", "few.axle"),
        ("CAMPAIGN", "."),
        ("TABLE", "table.csv"),
    ];
    let asked = names
        .iter()
        .fold(asked.to_string(), |asked, (of, name)| asked.replace(of, name));
    let out = Command::new("valgrind")
        .args(["--tool=cachegrind", "--cache-sim=no", "--cachegrind-out-file=/dev/null"])
        .arg(env!("CARGO_BIN_EXE_qcar"))
        .args(asked.split(' '))
        .env("RAYON_NUM_THREADS", "1")
        .current_dir(folder)
        .output()
        .expect("valgrind runs");
    let said = String::from_utf8_lossy(&out.stderr);
    // The number of blanks in `I   refs:` differs between versions of valgrind.
    let counted = said.lines().find_map(|line| line.split_once("refs:"));
    let counted = counted.unwrap_or_else(|| panic!("`qcar {asked}`: {said}")).1;
    assert!(out.status.success(), "`qcar {asked}`: {said}");
    counted.trim().replace(',', "").parse().expect("valgrind counts")
}
