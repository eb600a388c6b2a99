//! Realized shapes that are kept from one bake to the next.
//!
//! Promise: a shape that is found is bit for bit the one that would be made; what is not whole counts as not found. A shape is
//! kept under all that it depends on, before materials, optimization and encoding, so that another color, profile or node
//! cuts no surface again, and another curve only those that use it. Not promised: that a shape is kept. Where making it is
//! quicker than reading it would be, it is made again.

use std::fmt::Debug;
use std::time::{Duration, Instant};

use blake3::{Hash, Hasher};

use super::inherited::Inherited;
use super::made_bytes::{decode, encode, size};
use super::recipe_hash::{Met, RecipeHashes};
use super::shape::{Made, Maker};
use super::{Level, RealizeError};
use crate::model::{Limits, Model, Recipe, ShapeHandle};

/// Where realized shapes are kept, by what they depend on. One for all threads.
pub trait Keep: Debug + Send + Sync {
    /// The bytes under a key, whole.
    fn find(&self, key: &Hash) -> Option<Vec<u8>>;

    /// Keeps bytes under a key.
    fn keep(&self, key: &Hash, bytes: &[u8]);
}

/// What is kept of the shapes of a model and its states.
#[derive(Debug)]
pub struct Memo<'a> {
    keep: &'a dyn Keep,
    models: Vec<RecipeHashes<'a>>,
}

/// What reading a kept shape costs, at least and for each byte: a gigabyte passes in a second through the system, the hash and
/// the reader, three times.
const READING: Duration = Duration::from_micros(200);
const READING_BYTE: Duration = Duration::from_nanos(3);

impl<'a> Memo<'a> {
    /// That of a model.
    #[must_use]
    pub fn new(model: &'a Model, keep: &'a dyn Keep) -> Self {
        let models = std::iter::once(model).chain(&model.states).map(RecipeHashes::new).collect();
        Self { keep, models }
    }

    fn key(&self, maker: &Maker<'_>, handle: ShapeHandle, inherited: &Inherited) -> Option<(Hash, Met)> {
        let hashes = self.models.iter().find(|hashes| std::ptr::eq(hashes.model, maker.model))?;
        let Inherited { tolerance, rounding, uv, level: Level { number, factor, least } } = *inherited;
        let Limits { triangles, vertices, memory } = maker.model.limits;
        let mut hasher = Hasher::new();
        for number in [tolerance.unwrap_or(f64::NAN), rounding, factor, least, maker.coarser()] {
            hasher.update(&number.to_bits().to_le_bytes());
        }
        for count in [u64::from(uv), u64::from(number), u64::from(maker.levels), triangles, vertices, memory]
        {
            hasher.update(&count.to_le_bytes());
        }
        let met = hashes.feed(handle, &mut hasher);
        Some((hasher.finalize(), met))
    }

    /// A shape that is kept, or that is made now, with the number of its sources.
    pub(super) fn shape(
        &self,
        (maker, handle): (&Maker<'_>, ShapeHandle),
        inherited: Inherited,
        make: impl Fn() -> Result<(Made, u32), RealizeError>,
    ) -> Result<(Made, u32), RealizeError> {
        if is_simple(&maker.model.shape(handle).recipe) {
            return make();
        }
        let Some((key, met)) = self.key(maker, handle, &inherited) else { return make() };
        if let Some(found) = self.keep.find(&key).and_then(|bytes| decode(&bytes, &met)) {
            return Ok(found);
        }
        let start = Instant::now();
        let (made, sources) = make()?;
        let reading = READING_BYTE.saturating_mul(u32::try_from(size(&made)).unwrap_or(u32::MAX));
        if start.elapsed() > READING + reading
            && let Some(bytes) = encode(&made, sources, &met)
        {
            self.keep.keep(&key, &bytes);
        }
        Ok((made, sources))
    }
}

/// Whether a shape is always quicker made than looked for.
fn is_simple(recipe: &Recipe) -> bool {
    matches!(
        recipe,
        Recipe::Cuboid { .. }
            | Recipe::RoundedBox(_)
            | Recipe::Geodesic(_)
            | Recipe::Plane(_)
            | Recipe::Wire(_)
            | Recipe::Assembly(_)
    )
}
