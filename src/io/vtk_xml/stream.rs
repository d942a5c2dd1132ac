//! `Stream`: the binary bytes of a `DataArray`, raw or base64, taken in sequence.

use std::borrow::Cow;

use super::base64::Base64;

/// Bytes that a file holds raw or in base64.
#[derive(Clone, Debug)]
pub(super) enum Stream<'a> {
    Raw(&'a [u8]),
    Base64(Base64<'a>),
}

impl<'a> Stream<'a> {
    /// No more bytes than these can follow.
    pub(super) fn at_most(&self) -> usize {
        match self {
            Self::Raw(bytes) => bytes.len(),
            Self::Base64(stream) => stream.at_most(),
        }
    }

    /// The next `count` bytes; `None` where fewer follow.
    pub(super) fn take(&mut self, count: usize) -> Option<Cow<'a, [u8]>> {
        match self {
            Self::Raw(bytes) => {
                let (taken, rest) = bytes.split_at_checked(count)?;
                *bytes = rest;
                Some(Cow::Borrowed(taken))
            }
            Self::Base64(stream) => stream.take(count).map(Cow::Owned),
        }
    }
}
