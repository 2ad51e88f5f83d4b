//! Names in the file.

/// The format, in messages.
pub const FORMAT: &str = "MJCF";

/// Name of the site in the world that forces are measured against.
pub const WORLD_SITE: &str = "world";

/// Name of the site of a body.
pub fn node_site(node: usize) -> String {
    format!("node:{node}")
}

/// Name of the site of a cable at one of its guides.
pub fn cable_site(cable: &str, place: usize) -> String {
    format!("cable:{cable}:{place}")
}
