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
use super::work::{Origin, ShapeWork, WorkLog};
use super::{Level, RealizeError};
use crate::model::{Limits, Model, Recipe, ShapeHandle};

/// Where realized shapes are kept, by what they depend on. One for all threads.
pub trait Keep: Debug + Send + Sync {
    /// The bytes under a key, whole.
    fn find(&self, key: &Hash) -> Option<Vec<u8>>;

    /// Keeps bytes under a key.
    fn keep(&self, key: &Hash, bytes: &[u8]);
}

/// What is kept of the shapes of a model and its states, and what it took to make them where that is asked for.
#[derive(Debug)]
pub struct Memo<'a> {
    keep: Option<&'a dyn Keep>,
    log: Option<&'a WorkLog>,
    models: Vec<RecipeHashes<'a>>,
}

/// What reading a kept shape costs, at least and for each byte: a gigabyte passes in a second through the system, the hash and
/// the reader, three times.
const READING: Duration = Duration::from_micros(200);
const READING_BYTE: Duration = Duration::from_nanos(3);

impl<'a> Memo<'a> {
    /// That of a model; none where nothing is kept and nothing is noted.
    #[must_use]
    pub fn new(model: &'a Model, keep: Option<&'a dyn Keep>, log: Option<&'a WorkLog>) -> Option<Self> {
        if keep.is_none() && log.is_none() {
            return None;
        }
        let models = std::iter::once(model).chain(&model.states).map(RecipeHashes::new).collect();
        Some(Self { keep, log, models })
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
        let start = Instant::now();
        let (made, origin) = self.found_or_made((maker, handle), &inherited, make)?;
        let is_own = self.models.first().is_some_and(|own| std::ptr::eq(own.model, maker.model));
        if let Some(log) = self.log.filter(|_| is_own && inherited.level.number == 0) {
            let triangles = made.0.mesh.triangles.len();
            let work = ShapeWork { time: start.elapsed(), bytes: size(&made.0), triangles, origin };
            log.add(&maker.model.shape(handle).name, work);
        }
        Ok(made)
    }

    fn found_or_made(
        &self,
        (maker, handle): (&Maker<'_>, ShapeHandle),
        inherited: &Inherited,
        make: impl Fn() -> Result<(Made, u32), RealizeError>,
    ) -> Result<((Made, u32), Origin), RealizeError> {
        let simple = is_simple(&maker.model.shape(handle).recipe);
        let keep = self.keep.filter(|_| !simple);
        let kept = keep.and_then(|keep| Some((keep, self.key(maker, handle, inherited)?)));
        let Some((keep, (key, met))) = kept else { return Ok((make()?, Origin::Made)) };
        if let Some(found) = keep.find(&key).and_then(|bytes| decode(&bytes, &met)) {
            return Ok((found, Origin::Found));
        }
        let start = Instant::now();
        let (made, sources) = make()?;
        let reading = READING_BYTE.saturating_mul(u32::try_from(size(&made)).unwrap_or(u32::MAX));
        let encoded = (start.elapsed() > READING + reading).then(|| encode(&made, sources, &met)).flatten();
        if let Some(bytes) = &encoded {
            keep.keep(&key, bytes);
        }
        Ok(((made, sources), if encoded.is_some() { Origin::Kept } else { Origin::Made }))
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
