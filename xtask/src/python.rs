//! `cargo xtask python`: the Python package, as a wheel in a virtual environment of its own.
//!
//! The wheel is built with the profile of the other builds and installed under `target/python`.
//! Its types are compared with its stubs, and its tests run, with the command `asperity` that the
//! wheel installs. Then the notebooks of `docs/notebooks` are executed.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::{Context, Result, bail, ensure};

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

/// The environment that the package is built and tested in.
pub(crate) struct Environment {
    /// Programs of the virtual environment.
    programs: PathBuf,
    /// True if the packages that build and test the wheel are installed.
    has_tools: bool,
}

/// Creates the environment and installs what the package is built, tested and compared with; none without Python 3.10
/// or newer.
pub(crate) fn prepare() -> Result<Option<Environment>> {
    let Some(interpreter) = interpreter() else { return Ok(None) };
    let root = std::path::absolute(workspace_root())?;
    let environment = root.join("target/python/venv");
    let programs = environment.join(if cfg!(windows) { "Scripts" } else { "bin" });
    let environment = environment.display().to_string();
    ensure!(
        call(&interpreter, &["-m", "venv", &environment], &root)?,
        "cannot create {environment}"
    );
    let python = programs.join("python");
    let install = |packages: &[&str]| call(&python, &[&INSTALL[..], packages].concat(), &root);
    let has_tools = install(&TOOLS)?;
    if has_tools && !install(&COMPARED)? {
        ensure!(!is_required(), "the packages to compare with cannot be installed");
        println!("python: without comparisons, {} cannot be installed", COMPARED.join(", "));
    }
    Ok(Some(Environment { programs, has_tools }))
}

/// Builds, installs and tests the package in an environment that was prepared; true if all passes. Skips, and says so,
/// without Python 3.10 or newer and where the tools cannot be installed, unless [`REQUIRED`] says otherwise.
pub(crate) fn run(environment: Option<&Environment>) -> Result<bool> {
    let Some(Environment { programs, has_tools }) = environment else {
        ensure!(!is_required(), "no Python 3.10 or newer with venv");
        println!("python: skipped, no Python 3.10 or newer with venv (set PYTHON to name one)");
        return Ok(true);
    };
    if !has_tools {
        ensure!(!is_required(), "the tools of the Python package cannot be installed");
        println!("python: skipped, {} cannot be installed", TOOLS.join(", "));
        return Ok(true);
    }
    let root = std::path::absolute(workspace_root())?;
    let (package, own) = (root.join("crates/python"), root.join("target/python"));
    let (python, wheels) = (programs.join("python"), own.join("wheels"));
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
    if !call(&python, &install, &root)? {
        return Ok(false);
    }
    // Side by side; the stubs are compared away from the sources, which the wheel must not depend on.
    let types = ["-m", "mypy", "--strict", "python/asperity", "tests", "benches"];
    let (stubs, types) = std::thread::scope(|scope| {
        let stubs = scope.spawn(|| call(&python, &["-m", "mypy.stubtest", "asperity"], &own));
        let types = call(&python, &types, &package);
        (stubs.join(), types)
    });
    let stubs = stubs.unwrap_or_else(|_| bail!("the comparison of the stubs panicked"))?;
    Ok(stubs
        && types?
        && call(&python, &["-m", "pytest", "--quiet", "--numprocesses", "2"], &package)?)
}

/// Runs a program in `folder`; true if it succeeds.
fn call(program: &Path, arguments: &[&str], folder: &Path) -> Result<bool> {
    let mut command = Command::new(program);
    command.args(arguments).current_dir(folder).env("PIP_DISABLE_PIP_VERSION_CHECK", "1");
    command.env_remove("PYTHONDONTWRITEBYTECODE");
    let status = command.status().with_context(|| program.display().to_string())?;
    Ok(status.success())
}

/// True if [`REQUIRED`] says so.
fn is_required() -> bool {
    std::env::var(REQUIRED.0).is_ok_and(|value| value == REQUIRED.1)
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
