//! Chunks, one after the other.

use glam::DVec3;

use super::StudioFault;
use crate::import::bytes::{f32_at, u16_at, u32_at};

/// Bytes of a chunk before what is in it.
const HEAD: usize = 6;

/// A chunk that is being read from its beginning on.
#[derive(Clone, Copy)]
pub(super) struct Chunk<'b> {
    pub(super) id: u16,
    /// Its first byte in the file.
    start: usize,
    body: &'b [u8],
    /// What of the body was read.
    at: usize,
}

impl<'b> Chunk<'b> {
    /// The chunk that the whole file is.
    pub(super) fn whole(bytes: &'b [u8]) -> Result<Self, StudioFault> {
        let file = Self { id: 0, start: 0, body: bytes, at: 0 };
        if u16_at(bytes, 0) != Some(0x4d4d) {
            return Err(StudioFault::NotStudio);
        }
        file.clone().next()?.ok_or(StudioFault::NotStudio)
    }

    /// The next chunk inside, and none at the end. A few bytes that are left are no chunk.
    pub(super) fn next(&mut self) -> Result<Option<Self>, StudioFault> {
        let head = (u16_at(self.body, self.at), u32_at(self.body, self.at + 2));
        let (Some(id), Some(length)) = head else { return Ok(None) };
        let room = self.body.len() - self.at;
        let start = self.start + if self.id == 0 { 0 } else { HEAD } + self.at;
        let size = usize::try_from(length).unwrap_or(usize::MAX);
        if size < HEAD || size > room {
            return Err(StudioFault::Chunk { id, start, length, room });
        }
        let body = &self.body[self.at + HEAD..self.at + size];
        self.at += size;
        Ok(Some(Self { id, start, body, at: 0 }))
    }

    /// The chunks inside from here on.
    pub(super) fn inside(
        mut self,
        mut take: impl FnMut(Self) -> Result<(), StudioFault>,
    ) -> Result<(), StudioFault> {
        while let Some(chunk) = self.next()? {
            take(chunk)?;
        }
        Ok(())
    }

    fn ends<T>(&self, what: &'static str) -> Result<T, StudioFault> {
        Err(StudioFault::Ends { id: self.id, start: self.start, what })
    }

    /// Text up to a zero, which is read too.
    pub(super) fn text(&mut self, what: &'static str) -> Result<String, StudioFault> {
        let rest = &self.body[self.at..];
        let Some(end) = rest.iter().position(|byte| *byte == 0) else { return self.ends(what) };
        self.at += end + 1;
        let letter =
            |byte: &u8| if byte.is_ascii_graphic() || *byte == b' ' { char::from(*byte) } else { '?' };
        Ok(rest[..end].iter().map(letter).collect())
    }

    pub(super) fn short(&mut self, what: &'static str) -> Result<u16, StudioFault> {
        let Some(value) = u16_at(self.body, self.at) else { return self.ends(what) };
        self.at += 2;
        Ok(value)
    }

    pub(super) fn word(&mut self, what: &'static str) -> Result<u32, StudioFault> {
        let Some(value) = u32_at(self.body, self.at) else { return self.ends(what) };
        self.at += 4;
        Ok(value)
    }

    pub(super) fn byte(&mut self, what: &'static str) -> Result<u8, StudioFault> {
        let Some(value) = self.body.get(self.at) else { return self.ends(what) };
        self.at += 1;
        Ok(*value)
    }

    pub(super) fn float(&mut self, what: &'static str) -> Result<f64, StudioFault> {
        let Some(value) = f32_at(self.body, self.at) else { return self.ends(what) };
        self.at += 4;
        if value.is_finite() {
            return Ok(f64::from(value));
        }
        Err(StudioFault::NotFinite { id: self.id, start: self.start, what, value })
    }

    pub(super) fn vector(&mut self, what: &'static str) -> Result<DVec3, StudioFault> {
        Ok(DVec3::new(self.float(what)?, self.float(what)?, self.float(what)?))
    }

    /// So many rows of so many bytes each, held against what is left.
    pub(super) fn rows(&self, count: usize, size: usize, what: &'static str) -> Result<usize, StudioFault> {
        let left = self.body.len() - self.at;
        if count.checked_mul(size).is_some_and(|needed| needed <= left) { Ok(count) } else { self.ends(what) }
    }
}
