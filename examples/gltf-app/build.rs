//! Bakes the folder `assets`.

fn main() {
    kiln::Build::new("assets").run();
}
