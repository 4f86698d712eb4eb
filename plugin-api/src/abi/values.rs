//! Small values: handles, open numbers, errors, setting values.

use abi_stable::StableAbi;
use abi_stable::std_types::{RSlice, RStr, RString};

/// A host-owned GPU resource: generation in the high 32 bits, index + 1 in the low 32. 0 is none.
///
/// The host checks owner, kind and generation at every use; a stale handle is an error, never another resource.
#[repr(transparent)]
#[derive(StableAbi, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Debug, Default)]
pub struct Handle(pub u64);

impl Handle {
    /// No resource.
    pub const NONE: Self = Self(0);

    /// Whether this is a handle at all (it may still be stale).
    pub const fn is_some(self) -> bool {
        self.0 != 0
    }
}

/// Declares an open number: a `#[repr(transparent)]` integer with named values, to which later versions add.
macro_rules! open_number {
    ($(#[$meta:meta])* $name:ident($int:ty) { $($(#[$vmeta:meta])* $value:ident = $number:expr),* $(,)? }) => {
        $(#[$meta])*
        #[repr(transparent)]
        #[derive(StableAbi, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Default)]
        pub struct $name(pub $int);

        impl $name {
            $($(#[$vmeta])* pub const $value: Self = Self($number);)*

            /// The value's name, if this version knows it.
            pub fn name(self) -> Option<&'static str> {
                $(if self.0 == $number { return Some(stringify!($value)); })*
                None
            }

            /// The value of a name, in any case: `RGBA16_FLOAT` or `rgba16_float`.
            pub fn from_name(name: &str) -> Option<Self> {
                $(if name.eq_ignore_ascii_case(stringify!($value)) { return Some(Self::$value); })*
                None
            }
        }

        impl core::fmt::Debug for $name {
            fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
                match self.name() {
                    Some(name) => f.write_str(name),
                    None => write!(f, concat!(stringify!($name), "({})"), self.0),
                }
            }
        }
    };
}

/// Declares an open set of flags: as [`open_number`], with union and test.
macro_rules! open_flags {
    ($(#[$meta:meta])* $name:ident { $($(#[$vmeta:meta])* $value:ident = $number:expr),* $(,)? }) => {
        open_number! { $(#[$meta])* $name(u32) { $($(#[$vmeta])* $value = $number),* } }

        impl $name {
            /// No flag.
            pub const NONE: Self = Self(0);

            /// Whether all flags of `other` are set.
            pub const fn contains(self, other: Self) -> bool {
                self.0 & other.0 == other.0
            }

            /// Whether any flag of `other` is set.
            pub const fn intersects(self, other: Self) -> bool {
                self.0 & other.0 != 0
            }
        }

        impl core::ops::BitOr for $name {
            type Output = Self;
            fn bitor(self, other: Self) -> Self {
                Self(self.0 | other.0)
            }
        }

        impl core::ops::BitOrAssign for $name {
            fn bitor_assign(&mut self, other: Self) {
                self.0 |= other.0;
            }
        }
    };
}
pub(crate) use {open_flags, open_number};

open_number! {
    /// What went wrong, coarsely; the message says it for people.
    ErrorCode(u32) {
        /// The plugin's own failure, or one that fits no other code.
        FAILED = 1,
        /// A descriptor, command or shader was refused; the message has the details.
        VALIDATION = 2,
        /// A handle is stale, of another owner or of another kind.
        BAD_HANDLE = 3,
        /// The device's memory or the plugin's quota is used up.
        OUT_OF_MEMORY = 4,
        /// The host, the device or this version of the border cannot do it.
        UNSUPPORTED = 5,
        /// The code on the other side panicked; the message is the panic's.
        PANICKED = 6,
        /// The call was cancelled.
        CANCELLED = 7,
        /// The device is gone; the host prepares again on a new one.
        DEVICE_LOST = 8,
        /// The scene lacks what the renderer needs.
        UNSUITABLE_SCENE = 9,
    }
}

/// An error as it crosses the border.
#[repr(C)]
#[derive(StableAbi, Clone, Debug)]
pub struct ErrorRecord {
    pub code: ErrorCode,
    /// One or two sentences: where, expected, found, what to do.
    pub message: RString,
    /// The long form (a shader's full diagnosis, a backtrace); may be empty.
    pub detail: RString,
}

/// A version of the border.
#[repr(C)]
#[derive(StableAbi, Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct VersionRecord {
    pub major: u32,
    pub minor: u32,
    pub patch: u32,
}

open_number! {
    /// Severity of a log line.
    LogLevel(u32) {
        /// The act failed or data was lost.
        ERROR = 1,
        /// Done, but not as asked.
        WARN = 2,
        /// It works, but slower than it could; says why.
        PERFORMANCE = 3,
        /// Rare, for the user.
        INFO = 4,
        /// Per act.
        DEBUG = 5,
        /// Per frame.
        TRACE = 6,
    }
}

open_number! {
    /// Which field of a [`SettingRecord`] holds the value.
    ValueKind(u32) {
        /// `integer`: 0 or 1.
        BOOL = 1,
        /// `integer`.
        INT = 2,
        /// `numbers[0]`.
        FLOAT = 3,
        /// `text`: the id of the chosen option.
        CHOICE = 4,
        /// `numbers`: linear red, green, blue, alpha.
        COLOUR = 5,
        /// `text`.
        TEXT = 6,
    }
}

/// One setting's value, checked by the host against the manifest's schema.
#[repr(C)]
#[derive(StableAbi, Clone, Copy, Debug)]
pub struct SettingRecord<'a> {
    pub id: RStr<'a>,
    pub kind: ValueKind,
    pub integer: i64,
    pub numbers: [f64; 4],
    pub text: RStr<'a>,
}

/// One measured or counted quantity of a frame.
#[repr(C)]
#[derive(StableAbi, Clone, Debug)]
pub struct StatisticRecord {
    /// A well-known key of [`crate::statistics`] or the plugin's own.
    pub key: RString,
    pub value: f64,
}

/// The settings of one call, in the schema's order.
pub type SettingRecords<'a> = RSlice<'a, SettingRecord<'a>>;
