//! Programs that the chores start.

use std::env;
use std::path::PathBuf;
use std::process::{Command, Stdio};

/// What stopped a chore, as told to the caller.
pub(crate) type Result<T> = std::result::Result<T, String>;

/// The root of the workspace.
pub(crate) fn root() -> PathBuf {
    let member = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
    member.parent().map_or_else(|| member.clone(), PathBuf::from)
}

/// Where cargo builds.
pub(crate) fn target() -> PathBuf {
    env::var_os("CARGO_TARGET_DIR").map_or_else(|| root().join("target"), |folder| root().join(folder))
}

/// The cargo that runs this program, started from the root of the workspace.
pub(crate) fn cargo<'a>(arguments: impl IntoIterator<Item = &'a str>) -> Command {
    let mut command = Command::new(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command.args(arguments).current_dir(root());
    command
}

/// Cargo's `subcommand` for all of the workspace, the node of ROS 2 included. Whatever is tested is built in this one way:
/// other selections have other features, and nearly everything would be built again.
pub(crate) fn workspace<'a>(subcommand: &'a str, arguments: impl IntoIterator<Item = &'a str>) -> Command {
    let mut command = cargo([subcommand, "--workspace", "--features", "blur-ros/node"]);
    command.args(arguments);
    command
}

/// Builds programs of the workspace where [`target`] keeps those of the tests. Tests are asked for too: without them some
/// dependencies would have fewer features, and all above them would be built again.
pub(crate) fn build_programs<const N: usize>(names: [&str; N]) -> Result<()> {
    let mut build = workspace("build", ["--tests"]);
    succeed(build.args(names.iter().flat_map(|name| ["--bin", name])))
}

/// The command as one would type it.
pub(crate) fn shown(command: &Command) -> String {
    let program = PathBuf::from(command.get_program());
    let name = program.file_stem().unwrap_or(command.get_program()).to_string_lossy().into_owned();
    let arguments = command.get_args().map(|argument| argument.to_string_lossy().into_owned());
    std::iter::once(name).chain(arguments).collect::<Vec<_>>().join(" ")
}

/// Runs `command` to its end and asks for its success.
pub(crate) fn succeed(command: &mut Command) -> Result<()> {
    let shown = shown(command);
    let status = command.status().map_err(|error| format!("'{shown}' cannot be started: {error}"))?;
    if status.success() { Ok(()) } else { Err(format!("'{shown}' failed ({status})")) }
}

/// What a program prints, without the space around it.
pub(crate) fn printed(command: &mut Command) -> Result<String> {
    let shown = shown(command);
    let output =
        command.stderr(Stdio::null()).output().map_err(|error| format!("'{shown}' cannot be started: {error}"))?;
    if output.status.success() {
        Ok(String::from_utf8_lossy(&output.stdout).trim().to_owned())
    } else {
        Err(format!("'{shown}' failed ({})", output.status))
    }
}
