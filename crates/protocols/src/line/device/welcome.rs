//! How devices sign in (page "Ozeki Line Protocol", section "Rules").

use super::ID_MAX;
use crate::line::encoder::{EncodeError, Encoder};

/// A device as its welcome describes it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Welcome<'a> {
    /// Its id: see [`is_id`].
    pub id: &'a [u8],
    /// What it is.
    pub r#type: &'a [u8],
    /// Its place; 0 when that is left out.
    pub pos: i32,
    /// Its name, if it has one.
    pub name: Option<&'a [u8]>,
    /// Its version, if it has one.
    pub version: Option<&'a [u8]>,
}

/// Whether a device behind a link may have that id: one to [`ID_MAX`] of the bytes that need no encoding,
/// `[0-9A-Za-z._-]`.
#[must_use]
pub fn is_id(id: &[u8]) -> bool {
    !id.is_empty()
        && id.len() <= ID_MAX
        && id.iter().all(|byte| byte.is_ascii_alphanumeric() || matches!(byte, b'.' | b'_' | b'-'))
}

impl Welcome<'_> {
    /// Writes the line.
    ///
    /// # Errors
    ///
    /// When it does not fit.
    pub fn write(&self, room: &mut [u8]) -> Result<usize, EncodeError> {
        let mut line = Encoder::begin(room, b"welcome");
        line.text(b"id", self.id).text(b"type", self.r#type);
        if self.pos != 0 {
            line.int(b"pos", self.pos);
        }
        if let Some(name) = self.name {
            line.text(b"name", name);
        }
        if let Some(version) = self.version {
            line.text(b"version", version);
        }
        line.finish(false)
    }
}
