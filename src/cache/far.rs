//! What a cache asks of one that machines share.

use std::fmt::Debug;
use std::time::Duration;

use blake3::Hash;

/// A cache that machines share, and how it is used.
#[derive(Clone, Debug)]
pub struct RemoteOptions {
    /// Its address: `http://`, `https://` or `s3://BUCKET/PREFIX`.
    pub url: String,
    /// Whether what is baked is stored there too.
    pub writes: bool,
    /// Whether the person who runs the program named it: only then an HTTP server is told who asks.
    pub trusted: bool,
    /// How long one request may take.
    pub timeout: Duration,
}

/// Where something stands in a shared cache.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Place {
    /// Under a key, with its own hash behind it.
    Entry,
    /// Under the hash of its bytes.
    Object,
}

impl Place {
    #[cfg_attr(not(feature = "remote"), expect(dead_code, reason = "nothing is shared without the feature"))]
    pub(super) const fn folder(self) -> &'static str {
        match self {
            Self::Entry => "ac",
            Self::Object => "cas",
        }
    }
}

/// A shared cache. Whatever goes wrong there looks as if nothing were kept.
pub(super) trait Far: Debug + Send + Sync {
    /// What stands somewhere, as it is there.
    fn get(&self, place: Place, key: &Hash) -> Option<Vec<u8>>;

    /// Stores something, where that is wanted.
    fn put(&self, place: Place, key: &Hash, bytes: &[u8]);

    /// Notes that what stood somewhere was not what it must be.
    fn is_broken(&self);

    /// What a person should know of it, each once.
    fn troubles(&self) -> Vec<String>;
}

/// The shared cache of an address.
///
/// # Errors
/// When it is none, or this build has none.
pub(super) fn far(options: &RemoteOptions) -> Result<Box<dyn Far>, String> {
    #[cfg(feature = "remote")]
    return super::remote::Remote::new(options).map(|remote| Box::new(remote) as Box<dyn Far>);
    #[cfg(not(feature = "remote"))]
    Err(format!("this build of Kiln has no shared cache for {} (feature `remote`)", options.url))
}
