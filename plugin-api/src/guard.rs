//! The guard round every entry point: a panic becomes an error value, since one that reached the border would end the
//! process.

use crate::abi::{ErrorCode, ErrorRecord};
use crate::error::{Error, Result};
use abi_stable::std_types::RResult;
use std::any::Any;
use std::cell::RefCell;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Once;

thread_local! {
    /// Where the last panic of this thread happened, while a guard is active.
    static PLACE: RefCell<Option<String>> = const { RefCell::new(None) };
    /// How many guards are active on this thread.
    static DEPTH: RefCell<u32> = const { RefCell::new(0) };
}

/// Makes panics under a guard silent on standard error: the guard reports them through the host instead.
///
/// A plugin library has its own copy of the standard library, so its own hook: the host's stays as it is.
fn install_hook() {
    static INSTALLED: Once = Once::new();
    INSTALLED.call_once(|| {
        let default = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |info| {
            if DEPTH.with_borrow(|depth| *depth > 0) {
                PLACE.set(info.location().map(ToString::to_string));
            } else {
                default(info);
            }
        }));
    });
}

fn panic_message(payload: &(dyn Any + Send)) -> String {
    let text = payload
        .downcast_ref::<&str>()
        .map(ToString::to_string)
        .or_else(|| payload.downcast_ref::<String>().cloned())
        .unwrap_or_else(|| "a panic without a message".into());
    match PLACE.take() {
        Some(place) => format!("{text} (at {place})"),
        None => text,
    }
}

/// Runs `act`; a panic becomes [`ErrorCode::PANICKED`], with `what` to say where.
pub(crate) fn guarded<T>(what: &str, act: impl FnOnce() -> Result<T>) -> Result<T> {
    install_hook();
    DEPTH.with_borrow_mut(|depth| *depth += 1);
    let outcome = catch_unwind(AssertUnwindSafe(act));
    DEPTH.with_borrow_mut(|depth| *depth -= 1);
    outcome.unwrap_or_else(|payload| {
        let text = panic_message(payload.as_ref());
        Err(Error::new(
            ErrorCode::PANICKED,
            format!("the plugin panicked in {what}: {text}"),
        ))
    })
}

/// [`guarded`] as a border result.
pub(crate) fn border<T>(what: &str, act: impl FnOnce() -> Result<T>) -> RResult<T, ErrorRecord> {
    guarded(what, act).map_err(ErrorRecord::from).into()
}

/// Drops a value under the guard. A panic of its `Drop` is told to `report`, since nobody else can hear it.
pub(crate) fn drop_guarded<T>(what: &str, value: T, report: impl FnOnce(&str)) {
    let outcome = guarded(what, || {
        drop(value);
        Ok(())
    });
    if let Err(error) = outcome {
        report(&error.message);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_becomes_an_error_with_its_place() {
        let error = guarded("render", || -> Result<()> { panic!("no {}", "luck") }).unwrap_err();
        assert_eq!(error.code, ErrorCode::PANICKED);
        assert!(
            error.message.contains("render") && error.message.contains("no luck"),
            "{error}"
        );
        assert!(error.message.contains("guard.rs"), "{error}");
    }

    #[test]
    fn a_panic_in_drop_is_reported() {
        struct Bad;
        impl Drop for Bad {
            fn drop(&mut self) {
                panic!("bad drop");
            }
        }
        let mut reported = String::new();
        drop_guarded("Drop", Bad, |text| reported = text.into());
        assert!(reported.contains("bad drop"), "{reported}");
    }
}
