//! Writes the manual pages of the program and of its commands into a directory.

fn main() -> std::io::Result<()> {
    let directory = std::env::args_os().nth(1).expect("a directory");
    zeroset_cli::write_manual(std::path::Path::new(&directory))
}
