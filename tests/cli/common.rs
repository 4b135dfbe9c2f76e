//! What the tests of the command line share: running it as a user would.

use std::fs;
use std::path::Path;
use std::process::Command;

/// What a command printed, and how it ended.
pub struct Ran {
    /// Exit status.
    pub status: i32,
    /// Standard output.
    pub stdout: String,
    /// Standard error.
    pub stderr: String,
}

/// Asserts that a command refused its input with these words, and without a panic.
pub fn refused(ran: &Ran, said: &[&str]) {
    assert_eq!((ran.status, ran.stdout.as_str()), (2, ""), "{}", ran.stderr);
    assert!(!ran.stderr.contains("panicked"), "{}", ran.stderr);
    for fragment in said {
        assert!(
            ran.stderr.contains(fragment),
            "expected `{fragment}` in\n{}",
            ran.stderr
        );
    }
}

/// Runs `qcar` with these arguments in the root of the repository.
pub fn qcar(arguments: &[&str]) -> Ran {
    qcar_in(Path::new(env!("CARGO_MANIFEST_DIR")), arguments)
}

/// Runs `qcar` with these arguments in a folder.
pub fn qcar_in(folder: &Path, arguments: &[&str]) -> Ran {
    let output = Command::new(env!("CARGO_BIN_EXE_qcar"))
        .args(arguments)
        .current_dir(folder)
        .output()
        .unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    Ran {
        status: output.status.code().unwrap(),
        stdout: text(output.stdout),
        stderr: text(output.stderr),
    }
}

/// Runs the words of a line as arguments of `qcar` in a folder.
pub fn run_line(folder: &Path, line: &str) -> Ran {
    qcar_in(folder, &line.split_whitespace().collect::<Vec<_>>())
}

/// Copies a folder with all that is in it.
pub fn copy(from: &Path, to: &Path) {
    fs::create_dir_all(to).unwrap();
    for entry in fs::read_dir(from).unwrap().map(Result::unwrap) {
        let target = to.join(entry.file_name());
        match entry.file_type().unwrap().is_dir() {
            true => copy(&entry.path(), &target),
            false => drop(fs::copy(entry.path(), target).unwrap()),
        }
    }
}

/// A folder that looks like the repository to those who only read its models, and can be written to.
pub fn repository() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let models = Path::new(env!("CARGO_MANIFEST_DIR")).join("models");
    std::os::unix::fs::symlink(models, folder.path().join("models")).unwrap();
    folder
}

/// Runs `qcar`, which must succeed, and gives its standard output.
pub fn succeeds(arguments: &[&str]) -> String {
    let ran = qcar(arguments);
    assert_eq!(
        ran.status,
        0,
        "qcar {}\n{}{}",
        arguments.join(" "),
        ran.stdout,
        ran.stderr
    );
    ran.stdout
}

/// A sweep of both pads from 0.5 to 30 Hz in 40 s (peak velocity in m/s), followed by body and wheel of both sides,
/// integrated with small steps: accelerations in m/s² under this header. `k` is the spring's stiffness in N/m, `c_tire`
/// the tyre's damping in N s/m.
pub fn sweep(peak_velocity: f64, header: &str, [k, c_tire]: [f64; 2]) -> String {
    let (m_body, m_wheel, c, k_tire) = (270.0, 45.0, 1300.0, 210e3);
    let growth = (30.0f64 / 0.5).ln() / 40.0;
    let velocity = |t: f64| peak_velocity * (std::f64::consts::TAU * 0.5 * ((growth * t).exp() - 1.0) / growth).sin();
    let (mut state, mut pad, dt) = ([0.0f64; 4], 0.0, 1e-4);
    let mut text = header.to_string();
    for step in 0..400_000 {
        let t = step as f64 * dt;
        let [z_body, v_body, z_wheel, v_wheel] = state;
        let strut = k * (z_wheel - z_body) + c * (v_wheel - v_body);
        let tire = k_tire * (pad - z_wheel) + c_tire * (velocity(t) - v_wheel);
        let (a_body, a_wheel) = (strut / m_body, (tire - strut) / m_wheel);
        if step % 10 == 0 {
            let a_pad = (velocity(t + 1e-5) - velocity(t - 1e-5)) / 2e-5;
            text += &format!("\n{t:.3},{a_pad:.6},{a_pad:.6},{a_body:.6},{a_body:.6},{a_wheel:.6},{a_wheel:.6}");
        }
        // Velocities first, then positions with the new ones: symplectic Euler.
        let (v_body, v_wheel) = (v_body + dt * a_body, v_wheel + dt * a_wheel);
        state = [z_body + dt * v_body, v_body, z_wheel + dt * v_wheel, v_wheel];
        pad += dt * velocity(t);
    }
    text
}
