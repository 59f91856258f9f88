//! The library for C and C++: installed for programs, and tried by some.

use std::env;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use crate::debian;
use crate::run::{self, Result};

/// Tells the tests where the programs are that they run.
const PROGRAMS: &str = "BLUR_NATIVE_PROGRAMS";
const TOOLS: [&str; 4] = ["cc", "c++", "cmake", "pkg-config"];
const PACKAGES: [&str; 4] = ["gcc", "g++", "cmake", "pkg-config"];
/// The packages that the example for `OpenCV` needs: a quarter of `libopencv-dev`.
const OPENCV: [&str; 2] = ["libopencv-core-dev", "libopencv-imgcodecs-dev"];
const OPENCV_HEADER: &str = "/usr/include/opencv4/opencv2/imgcodecs.hpp";

/// What runs the programs, and what builds the library on the way.
const TESTS: [&str; 2] = ["--test", "installed"];

const VERSION: &str = env!("CARGO_PKG_VERSION");
/// Before 1.0 a minor version may break what was promised.
const SO_VERSION: &str = concat!(env!("CARGO_PKG_VERSION_MAJOR"), ".", env!("CARGO_PKG_VERSION_MINOR"));
/// What a program needs beside the static library on Linux: `rustc --print native-static-libs`.
const PRIVATE_LIBS: &str = "-lgcc_s -lutil -lrt -lpthread -lm -ldl -lc";
const WARNINGS: [&str; 5] = ["-Wall", "-Wextra", "-Wpedantic", "-Wno-missing-field-initializers", "-Werror"];
const SANITIZE: [&str; 4] =
    ["-fsanitize=address,undefined", "-fno-sanitize-recover=all", "-fno-omit-frame-pointer", "-g"];

/// Finds the tools, or installs them where that is allowed.
pub(crate) fn provide(is_ci: bool) -> Result<()> {
    let missing = |tool: &&str| {
        let status = Command::new(tool).arg("--version").stdout(Stdio::null()).stderr(Stdio::null()).status();
        !status.is_ok_and(|status| status.success())
    };
    if TOOLS.iter().any(missing) {
        debian::install(&PACKAGES, "build programs in C and C++")?;
    }
    if is_ci && !Path::new(OPENCV_HEADER).exists() {
        debian::install(&OPENCV, "build the example for OpenCV")?;
    }
    Ok(())
}

/// `install-ffi --prefix DIR`: builds the library for use and puts all of it below a folder.
pub(crate) fn install(arguments: &[String]) -> Result<()> {
    let [flag, prefix] = arguments else { return Err("usage: cargo xtask install-ffi --prefix DIR".to_owned()) };
    if flag != "--prefix" {
        return Err(format!("'{flag}' is not expected here; usage: cargo xtask install-ffi --prefix DIR"));
    }
    let prefix = env::current_dir().map_err(|error| format!("the working folder: {error}"))?.join(prefix);
    run::succeed(&mut run::cargo(["build", "--release", "--locked", "-p", "blur-ffi"]))?;
    install_to(&prefix, &run::target().join("release"))?;
    println!("installed in {}", prefix.display());
    Ok(())
}

/// Puts headers, both libraries from the folder `built`, and what pkg-config and `CMake` look for, below `prefix`.
fn install_to(prefix: &Path, built: &Path) -> Result<()> {
    let source = folder();
    for header in ["motion_blur.h", "motion_blur.hpp", "motion_blur_opencv.hpp"] {
        copy(&source.join("include").join(header), &prefix.join("include").join(header))?;
    }
    let lib = prefix.join("lib");
    copy(&built.join("libmotion_blur.a"), &lib.join("libmotion_blur.a"))?;
    let full = format!("libmotion_blur.so.{VERSION}");
    copy(&built.join("libmotion_blur.so"), &lib.join(&full))?;
    let for_loader = format!("libmotion_blur.so.{SO_VERSION}");
    link(&full, &lib.join(&for_loader))?;
    link(&for_loader, &lib.join("libmotion_blur.so"))?;
    for (template, to) in [
        ("motion_blur.pc", "pkgconfig"),
        ("motion_blurConfig.cmake", "cmake/motion_blur"),
        ("motion_blurConfigVersion.cmake", "cmake/motion_blur"),
    ] {
        let from = source.join("install").join(format!("{template}.in"));
        let text = fs::read_to_string(&from).map_err(|error| format!("{}: {error}", from.display()))?;
        let text = text
            .replace("@VERSION@", VERSION)
            .replace("@SOVERSION@", SO_VERSION)
            .replace("@PRIVATE_LIBS@", PRIVATE_LIBS)
            .replace("@POINTER_BYTES@", &size_of::<usize>().to_string());
        let to = lib.join(to).join(template);
        make_parent(&to)?;
        fs::write(&to, text).map_err(|error| format!("{}: {error}", to.display()))?;
    }
    Ok(())
}

/// The headers stand alone, in both languages.
pub(crate) fn check_headers() -> Result<()> {
    let include = folder().join("include");
    for (compiler, language, header) in [
        ("cc", "-std=c11", "motion_blur.h"),
        ("c++", "-std=c++17", "motion_blur.h"),
        ("c++", "-std=c++17", "motion_blur.hpp"),
    ] {
        let kind = if compiler == "cc" { "c" } else { "c++" };
        let mut command = Command::new(compiler);
        command.args([language, "-fsyntax-only"]).args(WARNINGS).args(["-x", kind]);
        run::succeed(command.arg(include.join(header)))?;
    }
    Ok(())
}

/// Installs the library, builds the examples as others would, and gives the tests that run them.
pub(crate) fn build_examples() -> Result<Command> {
    let (work, examples) = (run::target().join("native"), folder().join("examples"));
    let (prefix, programs) = (work.join("prefix"), work.join("programs"));
    for folder in [&prefix, &programs] {
        make_empty(folder)?;
    }
    install_to(&prefix, &built_for_tests()?)?;
    check_exports(&prefix)?;

    let build = work.join("cmake");
    let mut configure = Command::new("cmake");
    configure.arg("-S").arg(&examples).arg("-B").arg(&build);
    configure.arg(format!("-DCMAKE_PREFIX_PATH={}", prefix.display())).arg("-DCMAKE_COMPILE_WARNING_AS_ERROR=ON");
    run::succeed(configure.arg(format!("-DCMAKE_RUNTIME_OUTPUT_DIRECTORY={}", programs.display())))?;
    run::succeed(Command::new("cmake").arg("--build").arg(&build))?;
    for (name, is_static) in [("measure-c-pkg-config", false), ("measure-c-pkg-config-static", true)] {
        let mut compile = Command::new("cc");
        compile.arg("-std=c11").args(WARNINGS).arg(examples.join("c/measure.c"));
        let flags = pkg_config(&prefix, is_static)?;
        compile.args(flags.split_whitespace()).arg(format!("-Wl,-rpath,{}", prefix.join("lib").display()));
        run::succeed(compile.arg("-lm").arg("-o").arg(programs.join(name)))?;
    }
    let mut tests = run::workspace("test", TESTS);
    tests.args(["--", "--ignored"]).env(PROGRAMS, programs);
    Ok(tests)
}

/// The folder of the libraries that the tests are linked with, as cargo tells it.
fn built_for_tests() -> Result<PathBuf> {
    // Once to be seen, and once for the answer.
    run::succeed(run::workspace("test", TESTS).arg("--no-run"))?;
    let messages =
        run::printed(run::workspace("test", TESTS).args(["--no-run", "--message-format=json-render-diagnostics"]))?;
    let library = messages.split('"').find(|text| text.ends_with("/libmotion_blur.so"));
    let folder = library.and_then(|library| Path::new(library).parent());
    folder.map(Path::to_owned).ok_or_else(|| "cargo does not tell where libmotion_blur.so is".to_owned())
}

/// What pkg-config tells a compiler.
fn pkg_config(prefix: &Path, is_static: bool) -> Result<String> {
    let mut command = Command::new("pkg-config");
    command.env("PKG_CONFIG_PATH", prefix.join("lib/pkgconfig")).args(["--cflags", "--libs"]);
    if is_static {
        command.arg("--static");
    }
    let flags = run::printed(command.arg("motion_blur"))?;
    // Of two libraries of one name linkers take the shared one.
    Ok(if is_static { flags.replace("-lmotion_blur", "-l:libmotion_blur.a") } else { flags })
}

/// The shared library shows its interface and nothing else, so that it can live beside any other library.
fn check_exports(prefix: &Path) -> Result<()> {
    let library = prefix.join("lib/libmotion_blur.so");
    let symbols = run::printed(Command::new("nm").args(["-D", "--defined-only"]).arg(&library))?;
    let others: Vec<_> =
        symbols.lines().filter_map(|line| line.rsplit(' ').next()).filter(|name| !name.starts_with("mb_")).collect();
    if others.is_empty() && !symbols.is_empty() {
        Ok(())
    } else {
        Err(format!("{} should show symbols mb_... only, not '{}'", library.display(), others.join("', '")))
    }
}

/// Builds the library and C programs with sanitizers and runs them.
pub(crate) fn sanitize() -> Result<()> {
    let target = env_target()?;
    let work = run::target().join("native/sanitized");
    let mut build =
        run::cargo(["rustc", "--locked", "-p", "blur-ffi", "--lib", "--crate-type", "staticlib", "--target", &target]);
    // The option is not yet for everybody, and works with the compiler of everybody: the standard library stays as it is.
    build.env("RUSTC_BOOTSTRAP", "1").env("RUSTFLAGS", "-Zsanitizer=address");
    run::succeed(build.arg("--target-dir").arg(&work))?;
    let library = work.join(target).join("debug/libmotion_blur.a");
    let program = |source: &str, name: &str| {
        let out = work.join(name);
        let mut compile = Command::new("cc");
        compile.arg("-std=c11").args(WARNINGS).args(SANITIZE).arg("-I").arg(folder().join("include"));
        compile.arg(folder().join(source)).arg(&library).args(PRIVATE_LIBS.split_whitespace());
        run::succeed(compile.arg("-pthread").arg("-o").arg(&out))?;
        Ok::<_, String>(out)
    };
    let torture = program("tests/c/torture.c", "torture")?;
    run::succeed(&mut Command::new(&torture))?;
    // What is wrong on purpose must be seen, or the silence above would mean nothing.
    for (defect, expected) in [("leak", "LeakSanitizer"), ("overread", "heap-buffer-overflow")] {
        let output = Command::new(&torture).arg(defect).output().map_err(|error| format!("torture: {error}"))?;
        if output.status.success() || !String::from_utf8_lossy(&output.stderr).contains(expected) {
            return Err(format!("'torture {defect}' ended without '{expected}' ({})", output.status));
        }
    }
    let measure = program("examples/c/measure.c", "measure")?;
    let picture = work.join("blocks.pgm");
    fs::write(&picture, blocks()).map_err(|error| format!("{}: {error}", picture.display()))?;
    run::succeed(Command::new(&measure).arg(&picture).stdout(Stdio::null()))?;
    run::succeed(Command::new(&measure).arg(&picture).args(["5", "7", "80", "70"]).stdout(Stdio::null()))
}

/// A PGM with some contrast; what is measured in it does not matter.
fn blocks() -> Vec<u8> {
    let codes = (0..100_u32 * 100).map(|i| ((i / 300 * 37 + i % 100 / 4 * 91) % 251) as u8);
    b"P5\n100 100\n255\n".iter().copied().chain(codes).collect()
}

/// The target of the compiler itself: named, its flags do not reach what runs while building.
fn env_target() -> Result<String> {
    let about = run::printed(Command::new(env::var_os("RUSTC").unwrap_or_else(|| "rustc".into())).arg("-vV"))?;
    let target = about.lines().find_map(|line| line.strip_prefix("host: "));
    target.map(str::to_owned).ok_or_else(|| "rustc does not tell its host".to_owned())
}

fn folder() -> PathBuf {
    run::root().join("crates/blur-ffi")
}

fn make_parent(path: &Path) -> Result<()> {
    let parent = path.parent().unwrap_or(path);
    fs::create_dir_all(parent).map_err(|error| format!("{}: {error}", parent.display()))
}

fn make_empty(folder: &Path) -> Result<()> {
    if folder.exists() {
        fs::remove_dir_all(folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    }
    fs::create_dir_all(folder).map_err(|error| format!("{}: {error}", folder.display()))
}

fn copy(from: &Path, to: &Path) -> Result<()> {
    make_parent(to)?;
    fs::copy(from, to).map(|_| ()).map_err(|error| format!("{} to {}: {error}", from.display(), to.display()))
}

/// A symbolic link beside its target, in place of one that is there.
fn link(target: &str, at: &Path) -> Result<()> {
    if at.symlink_metadata().is_ok() {
        fs::remove_file(at).map_err(|error| format!("{}: {error}", at.display()))?;
    }
    #[cfg(unix)]
    let linked = std::os::unix::fs::symlink(target, at);
    #[cfg(not(unix))]
    let linked = fs::copy(at.with_file_name(target), at).map(|_| ());
    linked.map_err(|error| format!("{}: {error}", at.display()))
}
