//! The `whipcord` command.

fn main() {}
