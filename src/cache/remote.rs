//! A cache that machines share: a plain HTTP server, or an object store that speaks S3.
//!
//! Layout, as Bazel's remote caches have it: `URL/ac/KEY` is what is kept under a key, with its own hash behind it; `URL/cas/HASH` are
//! objects under the hash of their bytes. Keys and hashes are 64 hexadecimal digits (BLAKE3). Sources: Bazel documentation,
//! 2025, "Remote caching", section "HTTP caching protocol"; AWS Signature Version 4, by presigned URLs.
//!
//! Promise: what does not have the hash that it must have is not used. A server that fails, refuses or is too slow is left alone for
//! the rest of the run and told once; a bake never fails for it. Addresses are told without what was signed, and no secret is ever
//! printed. Not promised: that a server which others may write to keeps their bakes apart from lies; who may write there is trusted.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use blake3::Hash;
use rusty_s3::{Bucket, Credentials, S3Action as _, UrlStyle};
use ureq::Agent;
use ureq::tls::{RootCerts, TlsConfig};

use super::credentials;
use super::far::{Far, Place, RemoteOptions};

/// How often something is tried where the server fails, and how long the first pause is; each is four times the one before.
const TRIES: u32 = 3;
const PAUSE: Duration = Duration::from_millis(100);

/// Nothing larger is taken: it would have to stand in memory.
const LARGEST: u64 = 1 << 30;

/// How long a signed address is good for.
const SIGNED: Duration = Duration::from_secs(900);

/// A shared cache.
pub(super) struct Remote {
    agent: Agent,
    target: Target,
    /// As it is told.
    shown: String,
    writes: bool,
    /// Whether it is left alone from now on, and why.
    down: AtomicBool,
    trouble: Mutex<Option<String>>,
    broken: AtomicU64,
}

/// Where it is.
enum Target {
    Http { base: String, authorization: Option<String> },
    Store { bucket: Box<Bucket>, credentials: Option<Credentials>, prefix: String },
}

/// Why a request came to nothing.
enum Fault {
    /// It may go better the next time.
    Passing(String),
    /// It will not.
    Lasting(String),
}

impl std::fmt::Debug for Remote {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.debug_struct("Remote").field("shown", &self.shown).finish_non_exhaustive()
    }
}

impl Remote {
    /// The shared cache of an address.
    ///
    /// # Errors
    /// When it is none, in words.
    pub(super) fn new(options: &RemoteOptions) -> Result<Self, String> {
        let shown = options.url.trim_end_matches('/').to_owned();
        let (scheme, rest) = shown.split_once("://").unwrap_or(("", &shown));
        let authority = rest.split('/').next().unwrap_or_default();
        if authority.contains('@') {
            return Err(
                "the address of a shared cache holds no password: set KILN_REMOTE_AUTHORIZATION".to_owned()
            );
        }
        if rest.contains(['?', '#']) {
            return Err("the address of a shared cache has a query, which it cannot have".to_owned());
        }
        let target = match scheme {
            "http" | "https" if !authority.is_empty() => {
                let authorization = credentials::authorization().filter(|_| options.trusted);
                Target::Http { base: shown.clone(), authorization }
            }
            "s3" if !authority.is_empty() => store(rest)?,
            _ => {
                return Err(format!(
                    "{shown} is no address of a shared cache: write http://, https:// or s3://BUCKET/PREFIX"
                ));
            }
        };
        let tls = TlsConfig::builder()
            .root_certs(RootCerts::PlatformVerifier)
            .unversioned_rustls_crypto_provider(Arc::new(rustls::crypto::ring::default_provider()))
            .build();
        let agent = Agent::config_builder()
            .timeout_global(Some(options.timeout))
            .http_status_as_error(false)
            // What is signed or authorized is for one server.
            .max_redirects(0)
            .user_agent(concat!("kiln/", env!("CARGO_PKG_VERSION")))
            .tls_config(tls)
            .build();
        Ok(Self {
            agent: agent.into(),
            target,
            shown,
            writes: options.writes,
            down: AtomicBool::new(false),
            trouble: Mutex::default(),
            broken: AtomicU64::new(0),
        })
    }

    /// The address of an entry; for stores signed anew for each request.
    fn address(&self, place: Place, key: &Hash, writes: bool) -> String {
        let path = format!("{}/{}", place.folder(), key.to_hex());
        match &self.target {
            Target::Http { base, .. } => format!("{base}/{path}"),
            Target::Store { bucket, credentials, prefix } => {
                let name = format!("{prefix}{path}");
                let signer = credentials.as_ref();
                let url = if writes {
                    bucket.put_object(signer, &name).sign(SIGNED)
                } else {
                    bucket.get_object(signer, &name).sign(SIGNED)
                };
                url.into()
            }
        }
    }

    fn authorization(&self) -> Option<&str> {
        match &self.target {
            Target::Http { authorization, .. } => authorization.as_deref(),
            Target::Store { .. } => None,
        }
    }

    /// One request for an entry.
    fn read(&self, place: Place, key: &Hash) -> Result<Option<Vec<u8>>, Fault> {
        let mut request = self.agent.get(self.address(place, key, false));
        if let Some(value) = self.authorization() {
            request = request.header("authorization", value);
        }
        let mut response = request.call().map_err(|error| fault(&error))?;
        match response.status().as_u16() {
            200 => response
                .body_mut()
                .with_config()
                .limit(LARGEST)
                .read_to_vec()
                .map(Some)
                .map_err(|error| fault(&error)),
            404 | 410 => Ok(None),
            status => Err(refusal(status)),
        }
    }

    /// One request that stores an entry.
    fn write(&self, place: Place, key: &Hash, bytes: &[u8]) -> Result<(), Fault> {
        let mut request = self.agent.put(self.address(place, key, true));
        if let Some(value) = self.authorization() {
            request = request.header("authorization", value);
        }
        let response = request.send(bytes).map_err(|error| fault(&error))?;
        match response.status().as_u16() {
            200..=299 => Ok(()),
            status => Err(refusal(status)),
        }
    }

    /// Tries a request a few times; a server that fails all the same is left alone.
    fn tried<T>(&self, ask: impl Fn() -> Result<T, Fault>) -> Option<T> {
        let mut pause = PAUSE;
        for turn in 1.. {
            if self.down.load(Ordering::Relaxed) {
                return None;
            }
            match ask() {
                Ok(answer) => return Some(answer),
                Err(Fault::Passing(_)) if turn < TRIES => {
                    std::thread::sleep(pause);
                    pause *= 4;
                }
                Err(Fault::Passing(why) | Fault::Lasting(why)) => {
                    self.down.store(true, Ordering::Relaxed);
                    let mut trouble = self.trouble.lock().unwrap_or_else(PoisonError::into_inner);
                    trouble.get_or_insert(why);
                    return None;
                }
            }
        }
        None
    }
}

impl Far for Remote {
    fn get(&self, place: Place, key: &Hash) -> Option<Vec<u8>> {
        self.tried(|| self.read(place, key)).flatten()
    }

    fn put(&self, place: Place, key: &Hash, bytes: &[u8]) {
        if self.writes {
            let _ = self.tried(|| self.write(place, key, bytes));
        }
    }

    fn is_broken(&self) {
        self.broken.fetch_add(1, Ordering::Relaxed);
    }

    fn troubles(&self) -> Vec<String> {
        let trouble = self.trouble.lock().unwrap_or_else(PoisonError::into_inner).take();
        let down = trouble.map(|why| format!("the shared cache {} is left alone: {why}", self.shown));
        let broken = self.broken.swap(0, Ordering::Relaxed);
        let lies = (broken > 0)
            .then(|| format!("{broken} broken entries of the shared cache {} were ignored", self.shown));
        down.into_iter().chain(lies).collect()
    }
}

/// The object store of `BUCKET/PREFIX`.
fn store(rest: &str) -> Result<Target, String> {
    let (name, prefix) = rest.split_once('/').unwrap_or((rest, ""));
    let prefix = if prefix.is_empty() { String::new() } else { format!("{prefix}/") };
    let region = credentials::region();
    let (endpoint, style) = match credentials::endpoint() {
        Some(endpoint) => (endpoint, UrlStyle::Path),
        None => (format!("https://s3.{region}.amazonaws.com"), UrlStyle::VirtualHost),
    };
    let wrong =
        |error: &dyn std::fmt::Display| format!("{endpoint} is no address of an object store: {error}");
    let url = endpoint.parse().map_err(|error| wrong(&error))?;
    let bucket = Bucket::new(url, style, name.to_owned(), region).map_err(|error| wrong(&error))?;
    let credentials = credentials::of_store();
    Ok(Target::Store { bucket: Box::new(bucket), credentials, prefix })
}

fn refusal(status: u16) -> Fault {
    match status {
        401 | 403 => Fault::Lasting(format!("it refuses (status {status}); are the credentials right?")),
        429 | 500..=599 => Fault::Passing(format!("it fails (status {status})")),
        _ => Fault::Lasting(format!("it answers with status {status}")),
    }
}

/// What went wrong on the way, without the address, which may be signed.
fn fault(error: &ureq::Error) -> Fault {
    match error {
        ureq::Error::Timeout(_) => Fault::Lasting("it is too slow".to_owned()),
        ureq::Error::HostNotFound => Fault::Lasting("there is no such host".to_owned()),
        ureq::Error::ConnectionFailed => Fault::Passing("no connection".to_owned()),
        ureq::Error::Io(error) => Fault::Passing(match error.kind() {
            std::io::ErrorKind::ConnectionRefused => "no connection".to_owned(),
            kind => kind.to_string(),
        }),
        ureq::Error::BodyExceedsLimit(_) => Fault::Lasting("an entry is larger than 1 GiB".to_owned()),
        ureq::Error::Tls(_) | ureq::Error::Rustls(_) => {
            Fault::Lasting("its certificate, or the encryption, is not accepted".to_owned())
        }
        _ => Fault::Passing("the request failed".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::Remote;
    use crate::cache::far::RemoteOptions;

    #[test]
    fn addresses_without_sense_are_told_and_secrets_are_not() {
        let new = |url: &str| {
            let timeout = Duration::from_secs(1);
            Remote::new(&RemoteOptions { url: url.to_owned(), writes: true, trusted: true, timeout })
        };
        for (url, words) in [
            ("cache.example", "is no address"),
            ("ftp://cache.example", "is no address"),
            ("http://", "is no address"),
            ("https://me:secret@cache.example/a", "holds no password"),
            ("https://cache.example/a?token=secret", "has a query"),
        ] {
            let error = new(url).expect_err(url);
            assert!(error.contains(words), "{error}");
            assert!(!error.contains("secret"), "{error}");
        }
        let remote = new("https://cache.example/a/").expect("an address");
        assert_eq!(format!("{remote:?}"), "Remote { shown: \"https://cache.example/a\", .. }");
    }
}
