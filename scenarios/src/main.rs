//! The program `tridisk`.

fn main() -> std::process::ExitCode {
    tridisk::command_line::main()
}
