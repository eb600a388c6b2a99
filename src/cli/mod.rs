//! The command line, the only part that prints.

/// Runs the command named by the process arguments and gives its exit code.
pub fn run() -> std::process::ExitCode {
    std::process::ExitCode::SUCCESS
}
