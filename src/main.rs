//! The `kiln` command: arguments in, exit code out.

/// Most of a small bake's time goes into pages that the system hands out and takes back: measured on the vase
/// of the benchmark, this allocator (in its second version, which starts faster than the third and touches less)
/// takes a quarter off the processor time of the system's own. The library leaves the choice to its user.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

fn main() -> std::process::ExitCode {
    kiln::cli::run()
}
