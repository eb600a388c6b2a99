//! Connections of browsers: each on a thread of its own, which sleeps while nothing is asked.
//!
//! Promise: what is sent here harms no other connection: requests have a length and a time, connections a number.

use std::io::{ErrorKind, Read as _, Write as _};
use std::net::{Shutdown, TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use super::answer::{Answer, Content, Site, answer};
use super::request::{LONGEST, Refusal, Request, read};

/// Most connections at once; a browser opens up to six for a page.
const MOST: usize = 256;

/// How long a request may take to come, and a connection may stand idle.
const REQUEST: Duration = Duration::from_secs(10);

/// How long one that is answered may take to read on.
const WRITE: Duration = Duration::from_secs(30);

/// How often those that wait for news hear that there are none; so is found who went away.
const NEWS: Duration = Duration::from_secs(15);

/// Answers all who connect, for as long as the program runs.
pub(super) fn serve(listener: &TcpListener, site: &Arc<Site>) {
    let open = Arc::new(AtomicUsize::new(0));
    for stream in listener.incoming() {
        let Ok(stream) = stream else {
            // Out of file handles, say: others must close first.
            thread::sleep(Duration::from_millis(20));
            continue;
        };
        let place = Place::take(&open);
        let site = Arc::clone(site);
        let talk = move || {
            let crowded = place.number > MOST;
            // Errors of a connection concern nobody else.
            let _ = if crowded { refuse(&stream, Refusal::Busy) } else { talk(&stream, &site) };
            drop(place);
        };
        // Without a thread the connection is dropped.
        let _ = thread::Builder::new().name("connection".to_owned()).spawn(talk);
    }
}

/// One of the connections that are open.
struct Place {
    number: usize,
    open: Arc<AtomicUsize>,
}

impl Place {
    fn take(open: &Arc<AtomicUsize>) -> Self {
        Self { number: open.fetch_add(1, Ordering::Relaxed) + 1, open: Arc::clone(open) }
    }
}

impl Drop for Place {
    fn drop(&mut self) {
        self.open.fetch_sub(1, Ordering::Relaxed);
    }
}

fn talk(stream: &TcpStream, site: &Site) -> std::io::Result<()> {
    stream.set_nodelay(true)?;
    stream.set_write_timeout(Some(WRITE))?;
    let mut waiting = Vec::new();
    loop {
        let request = match next(stream, &mut waiting, site.port)? {
            Ok(Some(request)) => request,
            Ok(None) => return Ok(()),
            Err(refusal) => return refuse(stream, refusal),
        };
        match answer(&request, site) {
            Answer::Whole(content) => send(stream, &content, &request)?,
            Answer::News => return news(stream, site, &request),
        }
        if !request.stays {
            return close(stream);
        }
    }
}

/// The next request of a connection; none when it is at its end.
fn next(
    mut stream: &TcpStream,
    waiting: &mut Vec<u8>,
    port: u16,
) -> std::io::Result<Result<Option<Request>, Refusal>> {
    let end = Instant::now() + REQUEST;
    let mut bytes = [0; 4096];
    loop {
        match read(waiting, port) {
            Ok(Some((request, length))) => {
                waiting.drain(..length);
                return Ok(Ok(Some(request)));
            }
            Ok(None) => {}
            Err(refusal) => return Ok(Err(refusal)),
        }
        let left = end.saturating_duration_since(Instant::now());
        if left.is_zero() {
            return Ok(if waiting.is_empty() { Ok(None) } else { Err(Refusal::TooSlow) });
        }
        stream.set_read_timeout(Some(left))?;
        let room = bytes.len().min(LONGEST.saturating_sub(waiting.len()).max(1));
        match stream.read(&mut bytes[..room]) {
            Ok(0) => return Ok(Ok(None)),
            Ok(count) => waiting.extend_from_slice(&bytes[..count]),
            Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => {}
            Err(error) if error.kind() == ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
    }
}

/// Headers of every answer: nothing is kept, guessed, or shown inside of other sites.
const COMMON: &str = "Cache-Control: no-store\r\nX-Content-Type-Options: nosniff\r\nX-Frame-Options: DENY\r\n\
                      Referrer-Policy: no-referrer\r\nCross-Origin-Resource-Policy: same-origin\r\n\
                      Cross-Origin-Opener-Policy: same-origin\r\n";

fn send(mut stream: &TcpStream, content: &Content, request: &Request) -> std::io::Result<()> {
    let (status, words) = content.status;
    let body = content.body.bytes();
    let connection = if request.stays { "keep-alive" } else { "close" };
    // What says that it has no content must not tell of its length.
    let about = if status == 204 {
        String::new()
    } else {
        format!("Content-Type: {}\r\nContent-Length: {}\r\n", content.kind, body.len())
    };
    let head = format!(
        "HTTP/1.1 {status} {words}\r\n{about}Connection: {connection}\r\n{COMMON}{}\r\n",
        content.policy,
    );
    stream.write_all(head.as_bytes())?;
    if request.head { Ok(()) } else { stream.write_all(body) }
}

fn refuse(mut stream: &TcpStream, refusal: Refusal) -> std::io::Result<()> {
    let (status, words) = refusal.status();
    let allow = if refusal == Refusal::Method { "Allow: GET, HEAD\r\n" } else { "" };
    stream.set_write_timeout(Some(WRITE))?;
    let text = format!(
        "HTTP/1.1 {status} {words}\r\nContent-Type: text/plain\r\nContent-Length: {}\r\nConnection: close\r\n{allow}{COMMON}\r\n{words}\n",
        words.len() + 1
    );
    stream.write_all(text.as_bytes())?;
    close(stream)
}

/// Closes a connection so that what was written arrives: what is still being sent is read, for a moment.
fn close(mut stream: &TcpStream) -> std::io::Result<()> {
    stream.shutdown(Shutdown::Write)?;
    stream.set_read_timeout(Some(Duration::from_millis(500)))?;
    let mut bytes = [0; 4096];
    let mut left = 64;
    while left > 0 && stream.read(&mut bytes)? > 0 {
        left -= 1;
    }
    Ok(())
}

/// Tells of each bake as it comes, by server-sent events.
///
/// Source: WHATWG, HTML Living Standard, section 9.2 (server-sent events).
fn news(mut stream: &TcpStream, site: &Site, request: &Request) -> std::io::Result<()> {
    let head =
        format!("HTTP/1.1 200 OK\r\nContent-Type: text/event-stream\r\nConnection: close\r\n{COMMON}\r\n");
    stream.write_all(head.as_bytes())?;
    if request.head {
        return close(stream);
    }
    let mut show = site.stand.now();
    loop {
        stream.write_all(format!("data: {}\n\n", show.text).as_bytes())?;
        show = loop {
            match site.stand.after(show.revision, NEWS) {
                Some(next) => break next,
                None => stream.write_all(b": no news\n\n")?,
            }
        };
    }
}
