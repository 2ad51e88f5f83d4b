//! Versions.

#![allow(unsafe_code, reason = "a name for the linker is an unsafe attribute")]

use core::ffi::{CStr, c_char};

/// Version of the binary interface, the number in the name of the shared library. It changes when a program must be compiled anew.
pub const ABI_VERSION: u32 = 1;

/// The version of the library, such as "0.1.0".
// SAFETY: no other symbol has this name.
#[unsafe(no_mangle)]
pub extern "C" fn whipcord_version() -> *const c_char {
    const VERSION: &CStr =
        match CStr::from_bytes_with_nul(concat!(env!("CARGO_PKG_VERSION"), "\0").as_bytes()) {
            Ok(version) => version,
            Err(_) => c"",
        };
    VERSION.as_ptr()
}

/// The version of the binary interface of the library that is loaded; `WHIPCORD_ABI_VERSION` is that of the header.
// SAFETY: no other symbol has this name.
#[unsafe(no_mangle)]
pub extern "C" fn whipcord_abi_version() -> u32 {
    ABI_VERSION
}
