//! Pointers of the caller: all that is read through them and written to them.

#![allow(unsafe_code, reason = "pointers of C cannot be read or written without")]

use core::ffi::{CStr, c_char};

use crate::status::{Failure, Status};

/// The text that a pointer leads to.
///
/// # Safety
/// A pointer that is not NULL leads to a text that ends with a zero and that is not changed as long as the result is used.
pub unsafe fn text<'a>(pointer: *const c_char, what: &str) -> Result<&'a str, Failure> {
    if pointer.is_null() {
        return Err(Failure::null(what));
    }
    // SAFETY: it is not NULL, and the caller promises the rest.
    let text = unsafe { CStr::from_ptr(pointer) };
    text.to_str().map_err(|error| {
        let place = error.valid_up_to();
        Failure::new(Status::NotUtf8, format!("{what} is not UTF-8: byte {place} is not text"))
    })
}

/// The numbers of an array that must have so many, all of them finite.
///
/// # Safety
/// A pointer that is not NULL leads to `given` numbers that are not changed as long as the result is used.
pub unsafe fn numbers<'a>(
    pointer: *const f64,
    given: usize,
    needed: usize,
    what: &str,
) -> Result<&'a [f64], Failure> {
    // SAFETY: the caller promises it.
    let numbers = unsafe { array(pointer, given, needed, what)? };
    match numbers.iter().position(|number| !number.is_finite()) {
        None => Ok(numbers),
        Some(i) => {
            let message = format!("{what}[{i}] is {}: it must be finite", numbers[i]);
            Err(Failure::new(Status::InvalidArgument, message))
        }
    }
}

/// The flags of an array that must have so many, each of them 0 or 1.
///
/// # Safety
/// A pointer that is not NULL leads to `given` bytes that are not changed as long as the result is used.
pub unsafe fn flags<'a>(
    pointer: *const u8,
    given: usize,
    needed: usize,
    what: &str,
) -> Result<&'a [u8], Failure> {
    // SAFETY: the caller promises it.
    let flags = unsafe { array(pointer, given, needed, what)? };
    match flags.iter().position(|flag| *flag > 1) {
        None => Ok(flags),
        Some(i) => {
            let message = format!("{what}[{i}] is {}: it must be 0 or 1", flags[i]);
            Err(Failure::new(Status::InvalidArgument, message))
        }
    }
}

/// An array that must have so many entries.
///
/// # Safety
/// A pointer that is not NULL leads to `given` entries that are not changed as long as the result is used, and any bytes are a `T`.
unsafe fn array<'a, T>(
    pointer: *const T,
    given: usize,
    needed: usize,
    what: &str,
) -> Result<&'a [T], Failure> {
    check_length(given, needed, what)?;
    if needed == 0 {
        return Ok(&[]);
    }
    if pointer.is_null() {
        return Err(Failure::null(what));
    }
    // SAFETY: it is not NULL, so many numbers of a robot are far below isize::MAX bytes, and the caller promises that they are there.
    Ok(unsafe { core::slice::from_raw_parts(pointer, needed) })
}

/// Writes values to an array that must have so many. Nothing is written where it has not.
///
/// # Safety
/// A pointer that is not NULL leads to memory for `given` values that nothing else reads or writes during the call.
pub unsafe fn store<T>(
    pointer: *mut T,
    given: usize,
    values: impl ExactSizeIterator<Item = T>,
    what: &str,
) -> Result<(), Failure> {
    check_length(given, values.len(), what)?;
    if given == 0 {
        return Ok(());
    }
    if pointer.is_null() {
        return Err(Failure::null(what));
    }
    for (i, value) in values.take(given).enumerate() {
        // SAFETY: it is not NULL, i is less than `given`, and the caller promises memory for so many; no value is read or dropped.
        unsafe { pointer.add(i).write(value) };
    }
    Ok(())
}

/// Writes one value.
///
/// # Safety
/// As [`store`], with memory for one.
pub unsafe fn store_one<T>(pointer: *mut T, value: T, what: &str) -> Result<(), Failure> {
    // SAFETY: the caller promises it.
    unsafe { store(pointer, 1, core::iter::once(value), what) }
}

/// Makes an object and gives it to the caller, who has to free it. Where it cannot be made, the caller gets NULL.
///
/// # Safety
/// As [`store_one`].
pub unsafe fn give<T>(
    pointer: *mut *mut T,
    what: &str,
    make: impl FnOnce() -> Result<T, Failure>,
) -> Result<(), Failure> {
    // SAFETY: the caller promises it. First NULL, so that a caller who goes on after an error has no wild pointer, whatever `make` does.
    unsafe { store_one(pointer, core::ptr::null_mut(), what)? };
    let made = Box::into_raw(Box::new(make()?));
    // SAFETY: the caller promises it.
    unsafe { store_one(pointer, made, what) }
}

fn check_length(given: usize, needed: usize, what: &str) -> Result<(), Failure> {
    if given == needed {
        return Ok(());
    }
    let message = format!("{what} has the length {given}, but {needed} is needed");
    Err(Failure::new(Status::WrongLength, message))
}
