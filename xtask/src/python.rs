//! `cargo xtask python`: the Python package, as a wheel in a virtual environment of its own.
//!
//! The wheel is built with the profile of the other builds and installed under `target/python`.
//! Its types are compared with its stubs, and its tests run, with the command `asperity` that the
//! wheel installs. Then the notebooks of `docs/notebooks` are executed.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::{Context, Result, ensure};

use crate::workspace::workspace_root;

/// Interpreters to look for, after the one that the variable PYTHON names.
const INTERPRETERS: [&str; 2] = ["python3", "python"];

/// Condition of an interpreter, as its program: the version of `requires-python`, and `venv`.
const ACCEPTED: &str = "import sys, venv, ensurepip; sys.exit(sys.version_info < (3, 10))";

/// Packages that build and test the wheel.
const TOOLS: [&str; 5] = ["maturin>=1.9,<2", "mypy", "numpy", "pytest", "pytest-xdist"];

/// Packages that results are compared with, that take tables, that run the notebooks, and the widget; tests
/// without them skip, by name.
const COMPARED: [&str; 11] = [
    "anywidget",
    "ipykernel",
    "matplotlib",
    "nbclient",
    "pandas",
    "polars",
    "pyarrow",
    "pyFRF",
    "scipy",
    "sdypy-sep005",
    "xarray",
];

/// Installs packages. Their modules are compiled when they are first imported, and most are not.
const INSTALL: [&str; 5] = ["-m", "pip", "install", "--quiet", "--no-compile"];

/// Variable that makes the package a condition, with this value.
const REQUIRED: (&str, &str) = ("ASPERITY_PYTHON", "required");

/// Builds, installs and tests the package; true if all passes. Skips, and says so, without Python
/// 3.10 or newer and where the tools cannot be installed, unless [`REQUIRED`] says otherwise.
pub(crate) fn run() -> Result<bool> {
    let required = std::env::var(REQUIRED.0).is_ok_and(|value| value == REQUIRED.1);
    let Some(interpreter) = interpreter() else {
        ensure!(!required, "no Python 3.10 or newer with venv");
        println!("python: skipped, no Python 3.10 or newer with venv (set PYTHON to name one)");
        return Ok(true);
    };
    let root = std::path::absolute(workspace_root())?;
    let (package, own) = (root.join("crates/python"), root.join("target/python"));
    let (environment, wheels) = (own.join("venv"), own.join("wheels"));
    let programs = environment.join(if cfg!(windows) { "Scripts" } else { "bin" });
    let python = programs.join("python");
    let call = |program: &Path, arguments: &[&str], folder: &Path| -> Result<bool> {
        let mut command = Command::new(program);
        command.args(arguments).current_dir(folder).env("PIP_DISABLE_PIP_VERSION_CHECK", "1");
        command.env_remove("PYTHONDONTWRITEBYTECODE");
        let status = command.status().with_context(|| program.display().to_string())?;
        Ok(status.success())
    };
    let environment = environment.display().to_string();
    ensure!(
        call(&interpreter, &["-m", "venv", &environment], &root)?,
        "cannot create {environment}"
    );
    let install = [&INSTALL[..], &TOOLS].concat();
    if !call(&python, &install, &root)? {
        ensure!(!required, "the tools of the Python package cannot be installed");
        println!("python: skipped, {} cannot be installed", TOOLS.join(", "));
        return Ok(true);
    }
    let compared = [&INSTALL[..], &COMPARED].concat();
    if !call(&python, &compared, &root)? {
        ensure!(!required, "the packages to compare with cannot be installed");
        println!("python: without comparisons, {} cannot be installed", COMPARED.join(", "));
    }
    if wheels.exists() {
        std::fs::remove_dir_all(&wheels).with_context(|| wheels.display().to_string())?;
    }
    let out = wheels.display().to_string();
    let build =
        ["build", "--profile", "dev", "--features", "shared-build", "--quiet", "--out", &out];
    if !call(&programs.join("maturin"), &build, &package)? {
        return Ok(false);
    }
    let wheel = std::fs::read_dir(&wheels)?.next().context("maturin built no wheel")??.path();
    let wheel = wheel.display().to_string();
    let install = [&INSTALL[..], &["--force-reinstall", "--no-deps", &wheel]].concat();
    // The stubs are compared away from the sources, which the wheel must not depend on.
    Ok(call(&python, &install, &root)?
        && call(&python, &["-m", "mypy.stubtest", "asperity"], &own)?
        && call(
            &python,
            &["-m", "mypy", "--strict", "python/asperity", "tests", "benches"],
            &package,
        )?
        && call(&python, &["-m", "pytest", "--quiet", "--numprocesses", "2"], &package)?)
}

/// Interpreter that PYTHON or the path names and that is new enough.
fn interpreter() -> Option<PathBuf> {
    let named = std::env::var_os("PYTHON").map(PathBuf::from);
    let known = INTERPRETERS.iter().map(PathBuf::from);
    named.into_iter().chain(known).find(|program| {
        let mut command = Command::new(program);
        command.args(["-c", ACCEPTED]).stdout(Stdio::null()).stderr(Stdio::null());
        command.status().is_ok_and(|status| status.success())
    })
}
