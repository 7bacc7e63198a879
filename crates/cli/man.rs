//! Writes the manual pages of the program and of its commands into one directory, and scripts that
//! complete its arguments in shells into another.

fn main() -> std::io::Result<()> {
    let directories: Vec<_> = std::env::args_os().skip(1).map(std::path::PathBuf::from).collect();
    let [manual, completions] = directories.as_slice() else {
        panic!("two directories are needed: of manual pages, and of completions");
    };
    zeroset_cli::write_manual(manual)?;
    zeroset_cli::write_completions(completions)
}
