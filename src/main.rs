//! The `kiln` command: arguments in, exit code out.

fn main() -> std::process::ExitCode {
    kiln::cli::run()
}
