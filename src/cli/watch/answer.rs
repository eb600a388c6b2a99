//! What the page gets: itself, what was baked, pictures of that, and places in the text.
//!
//! Everything comes from memory but the modules of three.js; no path that is asked for reaches any other file.

use std::hash::{BuildHasher as _, RandomState};
use std::sync::{Arc, Mutex, PoisonError};

use serde_json::json;

use super::baked::Asset;
use super::request::Request;
use super::show::Stand;
use super::{heat, joints};
use crate::cli::three::Three;
use crate::preview::heat::Heat;
use crate::preview::{Camera, Look, Moment, Shading, Stage, View, draw_picture};

/// What all connections share.
pub(super) struct Site {
    /// The port that it is served at.
    pub(super) port: u16,
    pub(super) stand: Stand,
    three: Option<Three>,
    /// The page, with the word in it that alone lets its map of modules in.
    page: String,
    policy: String,
    /// Pictures are drawn one after the other, each on all cores.
    drawing: Mutex<()>,
}

impl Site {
    pub(super) fn new(port: u16, three: Option<Three>) -> Self {
        let word = format!("{:016x}", RandomState::new().hash_one(port));
        let viewer = if three.is_some() { "three" } else { "frames" };
        let page = PAGE.replace("{word}", &word).replace("{viewer}", viewer);
        let policy = format!(
            "Content-Security-Policy: default-src 'self'; script-src 'self' 'wasm-unsafe-eval' 'nonce-{word}'; \
             img-src 'self' blob: data:; connect-src 'self' blob: data:; base-uri 'none'; form-action 'none'; \
             frame-ancestors 'none'\r\n"
        );
        Self { port, stand: Stand::new(), three, page, policy, drawing: Mutex::new(()) }
    }
}

/// An answer.
pub(super) enum Answer {
    /// One that has an end.
    Whole(Content),
    /// Every bake as it comes.
    News,
}

/// What is answered.
pub(super) struct Content {
    pub(super) status: (u16, &'static str),
    pub(super) kind: &'static str,
    /// A header line, or nothing.
    pub(super) policy: String,
    pub(super) body: Body,
}

/// Bytes that are sent.
pub(super) enum Body {
    Own(Vec<u8>),
    Fixed(&'static str),
    Asset(Arc<Asset>),
}

impl Body {
    pub(super) fn bytes(&self) -> &[u8] {
        match self {
            Self::Own(bytes) => bytes,
            Self::Fixed(text) => text.as_bytes(),
            Self::Asset(asset) => &asset.compiled.bytes,
        }
    }
}

const PAGE: &str = include_str!("page/index.html");

/// The page's own files.
const FILES: [(&str, &str, &str); 5] = [
    ("/page/style.css", CSS, include_str!("page/style.css")),
    ("/page/page.js", JAVASCRIPT, include_str!("page/page.js")),
    ("/page/texts.js", JAVASCRIPT, include_str!("page/texts.js")),
    ("/page/viewer.js", JAVASCRIPT, include_str!("page/viewer.js")),
    ("/page/frames.js", JAVASCRIPT, include_str!("page/frames.js")),
];

const HTML: &str = "text/html; charset=utf-8";
const CSS: &str = "text/css; charset=utf-8";
const JAVASCRIPT: &str = "text/javascript; charset=utf-8";
const JSON: &str = "application/json";
const TEXT: &str = "text/plain; charset=utf-8";

pub(super) fn answer(request: &Request, site: &Site) -> Answer {
    let path = request.path.as_str();
    let good = |kind, body| Content { status: (200, "OK"), kind, policy: String::new(), body };
    let content = match path {
        "/" => {
            let page = Body::Own(site.page.clone().into_bytes());
            Content { policy: site.policy.clone(), ..good(HTML, page) }
        }
        "/news" => return Answer::News,
        "/state" => good(JSON, Body::Own(site.stand.now().text.clone().into_bytes())),
        "/sources" => good(JSON, Body::Own(site.stand.now().sources.clone().into_bytes())),
        "/favicon.ico" => nothing(),
        "/asset" => match asset(request, site) {
            Some(asset) => good("model/gltf-binary", Body::Asset(asset)),
            None => nothing(),
        },
        "/heat" => match colors(request, site) {
            Ok(bytes) => good("application/octet-stream", Body::Own(bytes)),
            Err(content) => content,
        },
        "/joints" => match angles(request, site) {
            Ok(text) => good(JSON, Body::Own(text.into_bytes())),
            Err(content) => content,
        },
        "/frame" => match frame(request, site) {
            Ok(png) => good("image/png", Body::Own(png)),
            Err(content) => content,
        },
        "/place" => {
            place(request, site).map_or_else(nothing, |text| good(JSON, Body::Own(text.into_bytes())))
        }
        _ => {
            let own = FILES.iter().find(|(name, _, _)| *name == path);
            let three = || site.three.as_ref()?.read(path.strip_prefix("/three/")?);
            match own {
                Some((_, kind, text)) => good(kind, Body::Fixed(text)),
                None => three().map_or_else(missing, |bytes| good(JAVASCRIPT, Body::Own(bytes))),
            }
        }
    };
    Answer::Whole(content)
}

/// Not an error: what is asked for was replaced a moment ago, or does not exist though it may.
fn nothing() -> Content {
    Content { status: (204, "No Content"), kind: TEXT, policy: String::new(), body: Body::Fixed("") }
}

fn missing() -> Content {
    wrong((404, "Not Found"), "there is nothing here".to_owned())
}

fn wrong(status: (u16, &'static str), message: String) -> Content {
    Content { status, kind: TEXT, policy: String::new(), body: Body::Own((message + "\n").into_bytes()) }
}

/// The shown file that a request names.
fn asset(request: &Request, site: &Site) -> Option<Arc<Asset>> {
    let key = request.value("key")?;
    site.stand.now().assets.iter().find(|asset| asset.key == key).cloned()
}

/// Where the triangle comes from that a request names.
fn place(request: &Request, site: &Site) -> Option<String> {
    let asset = asset(request, site)?;
    let corners = [request.number("a")?, request.number("b")?, request.number("c")?];
    let (file, line) = asset.place(request.number("mesh")?, corners)?;
    Some(json!({ "file": file, "line": line, "current": site.stand.now().good }).to_string())
}

/// What a request asks to be shown as colors; none where it asks for nothing of that kind.
fn heat(request: &Request) -> Result<Option<Heat>, Content> {
    let Some(text) = request.value("heat") else { return Ok(None) };
    let known = Heat::named(text).map(Some);
    known.ok_or_else(|| wrong((400, "Bad Request"), format!("`{text}` is nothing to be measured")))
}

/// Why there is nothing to be measured: no error, the page says it.
fn unmeasured(message: String) -> Content {
    wrong((200, "OK"), message)
}

/// The colors that a request names.
fn colors(request: &Request, site: &Site) -> Result<Vec<u8>, Content> {
    let asset = asset(request, site).ok_or_else(nothing)?;
    let heat =
        heat(request)?.ok_or_else(|| wrong((400, "Bad Request"), "write what is measured".to_owned()))?;
    let _turn = site.drawing.lock().unwrap_or_else(PoisonError::into_inner);
    heat::colors(&asset, level(request), &heat).map_err(unmeasured)
}

/// The level of detail that a request names, the finest where it names none.
fn level(request: &Request) -> usize {
    request.number("lod").unwrap_or(0)
}

/// The moment that a request names; rest where it names no clip.
fn moment(request: &Request, asset: &Asset) -> Moment {
    let time = request.number("time").unwrap_or(0.0);
    let clip = request.number::<usize>("clip").and_then(|clip| asset.clips().nth(clip));
    Moment { clip: clip.map(|(name, _)| name.to_owned()), time }
}

/// How far the joints of a file are turned that a request names.
fn angles(request: &Request, site: &Site) -> Result<String, Content> {
    let asset = asset(request, site).ok_or_else(nothing)?;
    let found = joints::angles(&asset, &moment(request, &asset));
    found.map(|found| found.to_string()).map_err(|message| wrong((500, "Internal Server Error"), message))
}

/// Pixels that a picture may have across and down.
const PIXELS: std::ops::RangeInclusive<u32> = 1..=2048;

/// The picture that a request names.
fn frame(request: &Request, site: &Site) -> Result<Vec<u8>, Content> {
    let bad = |message: &str| wrong((400, "Bad Request"), message.to_owned());
    let asset = asset(request, site).ok_or_else(nothing)?;
    let angle = |name, most: f64| {
        request.number(name).filter(|angle: &f64| angle.abs() <= most).ok_or_else(|| bad("write degrees"))
    };
    let view = View { azimuth: angle("azimuth", 360.0)?, elevation: angle("elevation", 90.0)? };
    let size = request.number("width").zip(request.number("height"));
    let (width, height) = size
        .filter(|(width, height)| PIXELS.contains(width) && PIXELS.contains(height))
        .ok_or_else(|| bad("write a width and a height of 1 to 2048 pixels"))?;
    let moment = moment(request, &asset);
    let shading = if request.value("normals").is_some() { Shading::Normals } else { Shading::Standard };
    let look = Look { size: (width, height), shading, ..Look::default() };
    let heat = heat(request)?;
    let failed = |message: String| wrong((500, "Internal Server Error"), message);
    let _turn = site.drawing.lock().unwrap_or_else(PoisonError::into_inner);
    let level = level(request);
    let (drawn, _) = asset.drawn(level).map_err(|message| failed(message.to_owned()))?;
    // All levels are seen by one camera.
    let (_, bounds) = asset.drawn(0).map_err(|message| failed(message.to_owned()))?;
    let camera = Camera::turning(bounds, view, look.projection, look.size);
    let picture = match heat {
        Some(heat) => {
            let stage = heat::heated(&asset, level, &moment, &heat).map_err(unmeasured)?;
            let picture = draw_picture(drawn, &stage, &camera, &look);
            match &stage.heat {
                Some(map) => {
                    let range = (map.low, map.high, map.greatest);
                    picture.with_legend(&heat.title(), range, look.background)
                }
                None => picture,
            }
        }
        None => {
            let stage = Stage::new(drawn, &moment).map_err(|error| failed(error.to_string()))?;
            draw_picture(drawn, &stage, &camera, &look)
        }
    };
    picture.png().map_err(|error| failed(error.to_string()))
}
