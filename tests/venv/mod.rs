//! A Python with packages of the public registry, where they can be had.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The folder of programs of a virtual environment with these packages, made once and kept among the build's own files;
/// why not, where it cannot be made.
pub(crate) fn environment(name: &str, packages: &[&str]) -> Result<PathBuf, String> {
    let venv = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let programs = venv.join("bin");
    let ready = venv.join("ready");
    let wanted = packages.join("\n");
    if fs::read_to_string(&ready).is_ok_and(|made| made == wanted) {
        return Ok(programs);
    }
    let run = |program: &Path, args: &[&str]| {
        let output = Command::new(program)
            .args(args)
            .output()
            .map_err(|e| format!("{}: {e}", program.display()))?;
        let last = String::from_utf8_lossy(&output.stderr);
        let last = last.lines().rfind(|l| l.starts_with("ERROR")).unwrap_or("it failed").to_owned();
        output.status.success().then_some(()).ok_or(last)
    };
    run(Path::new("python3"), &["-m", "venv", "--clear", &venv.display().to_string()])?;
    let install = ["-m", "pip", "install", "--quiet", "--disable-pip-version-check"];
    let patience = ["--retries", "1", "--timeout", "20"];
    run(&programs.join("python"), &[&install[..], &patience, packages].concat())?;
    fs::write(ready, wanted).map_err(|e| e.to_string())?;
    Ok(programs)
}
