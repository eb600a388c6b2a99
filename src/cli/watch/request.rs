//! Requests of the page, and the refusal of all others.
//!
//! A page of another origin must not get at what is served here, not by a name of its own that it lets lead to this
//! machine either (DNS rebinding): only requests that name this host as loopback are answered, and none that a browser
//! says come from elsewhere.
//!
//! Source: R. Fielding, M. Nottingham, J. Reschke, RFC 9112, HTTP/1.1, 2022, sections 3.2 (target, host) and 9.3
//! (persistence); W3C, Fetch Metadata Request Headers, 2025.

/// Longest request, bytes.
pub(super) const LONGEST: usize = 16 << 10;

/// Most headers.
const MOST: usize = 64;

/// A request for something.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Request {
    /// The path, with no character escaped.
    pub(super) path: String,
    /// Names and values after the question mark.
    query: Vec<(String, String)>,
    /// Whether only the head of the answer is wanted.
    pub(super) head: bool,
    /// Whether more requests follow on the connection.
    pub(super) stays: bool,
}

impl Request {
    /// A value of the query.
    pub(super) fn value(&self, name: &str) -> Option<&str> {
        self.query.iter().find(|(own, _)| own == name).map(|(_, value)| value.as_str())
    }

    /// A value of the query that is of a kind.
    pub(super) fn number<T: std::str::FromStr>(&self, name: &str) -> Option<T> {
        self.value(name)?.parse().ok()
    }
}

/// Why a request is not answered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Refusal {
    /// It is not HTTP/1.1.
    Malformed,
    /// It is too long.
    TooLong,
    /// It did not come to its end in time.
    TooSlow,
    /// It asks for more than reading.
    Method,
    /// It brings something along.
    Body,
    /// It is meant for another host, or comes from another site.
    Foreign,
    /// Too many ask at once.
    Busy,
}

impl Refusal {
    /// The status line's code and words, and what to say.
    pub(super) fn status(self) -> (u16, &'static str) {
        match self {
            Self::Malformed => (400, "Bad Request"),
            Self::Foreign => (403, "Forbidden"),
            Self::Method => (405, "Method Not Allowed"),
            Self::TooSlow => (408, "Request Timeout"),
            Self::Body => (413, "Content Too Large"),
            Self::TooLong => (431, "Request Header Fields Too Large"),
            Self::Busy => (503, "Service Unavailable"),
        }
    }
}

/// The request that stands at the start of some bytes, and its length; none while it is not at its end.
pub(super) fn read(bytes: &[u8], port: u16) -> Result<Option<(Request, usize)>, Refusal> {
    let mut headers = [httparse::EMPTY_HEADER; MOST];
    let mut parsed = httparse::Request::new(&mut headers);
    let length = match parsed.parse(bytes) {
        Ok(httparse::Status::Complete(length)) => length,
        Ok(httparse::Status::Partial) if bytes.len() >= LONGEST => return Err(Refusal::TooLong),
        Ok(httparse::Status::Partial) => return Ok(None),
        Err(httparse::Error::TooManyHeaders) => return Err(Refusal::TooLong),
        Err(_) => return Err(Refusal::Malformed),
    };
    let (Some(method), Some(target), Some(version)) = (parsed.method, parsed.path, parsed.version) else {
        return Err(Refusal::Malformed);
    };
    let all = |name: &str| {
        let own = parsed.headers.iter().filter(move |header| header.name.eq_ignore_ascii_case(name));
        own.map(|header| std::str::from_utf8(header.value).map(str::trim).map_err(|_| Refusal::Malformed))
            .collect::<Result<Vec<&str>, Refusal>>()
    };
    let hosts = all("host")?;
    let [host] = hosts.as_slice() else { return Err(Refusal::Malformed) };
    let (named, target) = split(target, host)?;
    let origins = all("origin")?;
    let own = |origin: &&str| origin.strip_prefix("http://").is_some_and(|host| is_loopback(host, port));
    let elsewhere = all("sec-fetch-site")?.iter().any(|site| !matches!(*site, "same-origin" | "none"));
    if !is_loopback(host, port) || !is_loopback(named, port) || !origins.iter().all(own) || elsewhere {
        return Err(Refusal::Foreign);
    }
    let head = match method {
        "GET" => false,
        "HEAD" => true,
        _ => return Err(Refusal::Method),
    };
    if !all("transfer-encoding")?.is_empty() || all("content-length")?.iter().any(|length| *length != "0") {
        return Err(Refusal::Body);
    }
    let connection = all("connection")?;
    let says = |word: &str| {
        connection.iter().any(|list| list.split(',').any(|one| one.trim().eq_ignore_ascii_case(word)))
    };
    let stays = if version == 0 { says("keep-alive") } else { !says("close") };
    let (path, query) = target.split_once('?').unwrap_or((target, ""));
    let pair = |pair: &str| {
        let (name, value) = pair.split_once('=').unwrap_or((pair, ""));
        (name.to_owned(), value.to_owned())
    };
    let query = query.split('&').filter(|pair| !pair.is_empty()).map(pair).collect();
    Ok(Some((Request { path: path.to_owned(), query, head, stays }, length)))
}

/// The host and the rest of a target, which may be a whole address.
fn split<'a>(target: &'a str, host: &'a str) -> Result<(&'a str, &'a str), Refusal> {
    if target.starts_with('/') {
        return Ok((host, target));
    }
    let whole = target.strip_prefix("http://").ok_or(Refusal::Malformed)?;
    Ok(whole.find('/').map_or((whole, "/"), |slash| whole.split_at(slash)))
}

/// Whether a host names this machine by loopback, at this port.
fn is_loopback(host: &str, port: u16) -> bool {
    let (name, number) = host.rsplit_once(':').unwrap_or((host, "80"));
    let own = ["127.0.0.1", "localhost", "[::1]"].iter().any(|own| own.eq_ignore_ascii_case(name));
    own && number.parse() == Ok(port)
}

#[cfg(test)]
mod tests {
    use super::{LONGEST, Refusal, read};

    fn refusal(text: &str) -> Refusal {
        read(text.as_bytes(), 80).unwrap_err()
    }

    #[test]
    fn a_request_is_read_once_it_is_whole() {
        let text = "GET /frame?key=a1&time=0.5&flag HTTP/1.1\r\nHost: localhost:81\r\n\r\nGET";
        let whole = text.len() - 3;
        for cut in 0..whole {
            assert_eq!(read(&text.as_bytes()[..cut], 81), Ok(None), "{cut}");
        }
        let (request, length) = read(text.as_bytes(), 81).unwrap().unwrap();
        assert_eq!((request.path.as_str(), length, request.stays), ("/frame", whole, true));
        assert_eq!((request.value("key"), request.number::<f64>("time")), (Some("a1"), Some(0.5)));
        assert_eq!((request.value("flag"), request.value("none")), (Some(""), None));
    }

    #[test]
    fn whole_addresses_and_closing_are_understood() {
        let read = |text: &str| read(text.as_bytes(), 80).unwrap().unwrap().0;
        let whole =
            read("HEAD http://127.0.0.1/a?b=c HTTP/1.1\r\nHost: 127.0.0.1\r\nConnection: close\r\n\r\n");
        assert_eq!((whole.path.as_str(), whole.head, whole.stays), ("/a", true, false));
        assert!(!read("GET / HTTP/1.0\r\nHost: [::1]:80\r\n\r\n").stays);
        assert_eq!(read("GET http://localhost HTTP/1.1\r\nHost: localhost\r\n\r\n").path, "/");
    }

    #[test]
    fn other_hosts_and_sites_are_refused() {
        for host in ["evil.test", "127.0.0.1.evil.test", "localhost:81", "127.0.0.1:", "0.0.0.0", "", "127.1"]
        {
            assert_eq!(
                refusal(&format!("GET / HTTP/1.1\r\nHost: {host}\r\n\r\n")),
                Refusal::Foreign,
                "{host}"
            );
        }
        let with = |header: &str| refusal(&format!("GET / HTTP/1.1\r\nHost: localhost\r\n{header}\r\n\r\n"));
        assert_eq!(with("Origin: http://evil.test"), Refusal::Foreign);
        assert_eq!(with("Origin: null"), Refusal::Foreign);
        assert_eq!(with("Sec-Fetch-Site: cross-site"), Refusal::Foreign);
        assert_eq!(with("Host: localhost"), Refusal::Malformed);
        assert_eq!(refusal("GET / HTTP/1.1\r\n\r\n"), Refusal::Malformed);
        assert_eq!(refusal("GET http://evil.test/ HTTP/1.1\r\nHost: localhost\r\n\r\n"), Refusal::Foreign);
        assert_eq!(refusal("GET ftp://localhost/ HTTP/1.1\r\nHost: localhost\r\n\r\n"), Refusal::Malformed);
    }

    #[test]
    fn what_is_no_plain_reading_is_refused() {
        let post = "POST / HTTP/1.1\r\nHost: localhost\r\nContent-Length: 3\r\n\r\nabc";
        assert_eq!(refusal(post), Refusal::Method);
        assert_eq!(refusal(&post.replace("POST", "GET")), Refusal::Body);
        assert_eq!(
            refusal("GET / HTTP/1.1\r\nHost: localhost\r\nTransfer-Encoding: chunked\r\n\r\n"),
            Refusal::Body
        );
        assert_eq!(refusal("\0\u{1}\u{2}\r\n\r\n"), Refusal::Malformed);
        assert_eq!(refusal("GET / HTTP/9.9\r\n\r\n"), Refusal::Malformed);
        assert_eq!(refusal(&format!("GET / HTTP/1.1\r\nA: {}", "a".repeat(LONGEST))), Refusal::TooLong);
        assert_eq!(refusal(&format!("GET / HTTP/1.1\r\n{}\r\n", "A: b\r\n".repeat(100))), Refusal::TooLong);
    }
}
