//! Values that know where they are written.

use std::ops::Deref;

use crate::language::source::Span;

/// A value and the place that wrote it. Equal when the values are, wherever they stand.
#[derive(Clone, Copy, Debug)]
pub struct Sp<T> {
    /// The value.
    pub value: T,
    /// Where it is written; [`Span::NONE`] for a default.
    pub span: Span,
}

impl<T> Sp<T> {
    /// A value with its place.
    pub const fn new(value: T, span: Span) -> Self {
        Self { value, span }
    }
}

impl<T> From<T> for Sp<T> {
    fn from(value: T) -> Self {
        Self { value, span: Span::NONE }
    }
}

impl<T> Deref for Sp<T> {
    type Target = T;

    fn deref(&self) -> &T {
        &self.value
    }
}

impl<T: PartialEq> PartialEq for Sp<T> {
    fn eq(&self, other: &Self) -> bool {
        self.value == other.value
    }
}
