//! Programs that compute with a peer: how they are set up, and how they are started.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use super::urdf;
use crate::bench::pinned;
use crate::python;
use crate::run::{Result, call, cargo, exists, root, shown, step};

/// A program and what stands before its arguments.
pub struct Program {
    path: PathBuf,
    arguments: Vec<String>,
}

const MAIN: &str = include_str!("../../peers/main.rs");
const MANIFEST: &str = include_str!("../../peers/Cargo.toml.in");
const PINOCCHIO: &str = include_str!("../../peers/pinocchio.cpp");
const PYTHON: &str = include_str!("../../peers/peers.py");
/// Where Debian's libeigen3-dev has what the wheel of Pinocchio leaves out.
const EIGEN: &str = "/usr/include/eigen3";
/// As the wheel's own CMake files have them: there are more joints than Boost expects.
const BOOST: [&str; 4] = [
    "-DBOOST_MPL_LIMIT_LIST_SIZE=30",
    "-DBOOST_MPL_LIMIT_VECTOR_SIZE=30",
    "-DBOOST_MPL_CFG_NO_PREPROCESSED_HEADERS",
    "-DBOOST_FUSION_INVOKE_MAX_ARITY=12",
];

impl Program {
    /// All that can be had here. What cannot is said, and why.
    pub fn set_up_all(folder: &Path) -> Result<Vec<Self>> {
        let mut programs = vec![in_rust(folder)?];
        if !python::found() {
            eprintln!("no python3 with venv: no peers in Python, and no Pinocchio");
            return Ok(programs);
        }
        fs::write(folder.join("peers.py"), PYTHON)?;
        match environment(folder, "pinocchio", "pin>=4,<5 numpy") {
            Ok(python) => {
                step("calibrated URDFs read by Pinocchio", || urdf::check(&python, folder))?;
                programs.push(Self::of_python(folder, &python, "numpy"));
                programs.push(in_cpp(folder, &python).unwrap_or_else(|error| {
                    eprintln!("Pinocchio not in C++, so through Python, call by call: {error}");
                    Self::of_python(folder, &python, "pinocchio")
                }));
            }
            Err(error) => eprintln!("skipped: Pinocchio and numpy: {error}"),
        }
        // An environment of its own: it wants an old numpy.
        match environment(folder, "pybotics", "pybotics") {
            Ok(python) => programs.push(Self::of_python(folder, &python, "pybotics")),
            Err(error) => eprintln!("skipped: pybotics: {error}"),
        }
        eprintln!("skipped: FIGAROH: its poses and Jacobians are Pinocchio's");
        Ok(programs)
    }

    fn of_python(folder: &Path, python: &Path, peer: &str) -> Self {
        let script = folder.join("peers.py").display().to_string();
        Self { path: python.to_owned(), arguments: vec![script, peer.to_owned()] }
    }

    /// What it prints, on one core: `check` or `time`.
    pub fn output(&self, folder: &Path, what: &str) -> Result<String> {
        let mut command = pinned(&self.path);
        command.args(&self.arguments).arg(folder).arg(what);
        // One core for all: numpy would take as many as there are.
        command.env("OMP_NUM_THREADS", "1").env("OPENBLAS_NUM_THREADS", "1");
        let output = command.output()?;
        if !output.status.success() {
            let error = String::from_utf8_lossy(&output.stderr);
            return Err(format!("`{}`: {}\n{error}", shown(&command), output.status).into());
        }
        Ok(String::from_utf8(output.stdout)?)
    }
}

/// truearm, k and rs-opw-kinematics: a package outside of the workspace.
fn in_rust(folder: &Path) -> Result<Program> {
    let package = folder.join("rust");
    fs::create_dir_all(package.join("src"))?;
    let manifest = MANIFEST.replace("ROOT", &root().display().to_string());
    for (name, text) in [("Cargo.toml", manifest.as_str()), ("src/main.rs", MAIN)] {
        // Untouched where it is the same: what is built stays.
        if fs::read_to_string(package.join(name)).is_ok_and(|old| old == text) {
            continue;
        }
        fs::write(package.join(name), text)?;
    }
    let mut build = cargo(&package, "build --release --quiet");
    call(build.env("CARGO_TARGET_DIR", package.join("target")))?;
    Ok(Program { path: package.join("target/release/peers"), arguments: Vec::new() })
}

/// The Python of an environment with these packages of PyPI.
fn environment(folder: &Path, name: &str, packages: &str) -> Result<PathBuf> {
    let place = folder.join(name);
    let python = place.join("bin/python");
    let done = place.join("installed");
    if fs::read_to_string(&done).is_ok_and(|installed| installed == packages) {
        return Ok(python);
    }
    call(Command::new("python3").args(["-m", "venv"]).arg(&place))?;
    let mut install = Command::new(&python);
    install.args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check"]);
    call(install.args(packages.split_whitespace()))?;
    fs::write(done, packages)?;
    Ok(python)
}

/// Pinocchio as its users in C++ have it: from the headers of its wheel.
fn in_cpp(folder: &Path, python: &Path) -> Result<Program> {
    if !exists("g++") {
        return Err("no g++".into());
    }
    if !Path::new(EIGEN).is_dir() {
        return Err("no Eigen: install Debian's libeigen3-dev".into());
    }
    let prefix = "import cmeel, pathlib; print(pathlib.Path(cmeel.__path__[0]).parent)";
    let output = Command::new(python).args(["-c", prefix]).output()?;
    let packages = PathBuf::from(String::from_utf8(output.stdout)?.trim());
    let (source, path) = (folder.join("pinocchio.cpp"), folder.join("pinocchio-cpp"));
    fs::write(&source, PINOCCHIO)?;
    let prefix = packages.join("cmeel.prefix");
    let mut compile = Command::new("g++");
    compile.args(["-std=c++17", "-O3", "-DNDEBUG", "-march=native", "-w", "-I", EIGEN]).args(BOOST);
    compile.arg("-I").arg(prefix.join("include")).arg(&source).arg("-o").arg(&path);
    compile.arg("-L").arg(prefix.join("lib")).args(["-lpinocchio_default"]);
    compile.arg(format!("-Wl,-rpath,{}", prefix.join("lib").display()));
    call(&mut compile)?;
    Ok(Program { path, arguments: Vec::new() })
}
