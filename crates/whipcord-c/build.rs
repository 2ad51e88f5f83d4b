//! Names the shared library as programs that are linked with it ask for it.

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    // The number is `ABI_VERSION` of src/version.rs; a test compares them.
    if std::env::var("CARGO_CFG_TARGET_OS").is_ok_and(|os| os == "linux") {
        println!("cargo::rustc-cdylib-link-arg=-Wl,-soname,libwhipcord.so.1");
    }
}
