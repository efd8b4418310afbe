//! Which requests are this server's own page's: checked before anything of them is used.

use axum::http::header::{AUTHORIZATION, COOKIE, HOST, ORIGIN, UPGRADE};
use axum::http::request::Parts;
use axum::http::{HeaderMap, HeaderName, Method};

use crate::token::Token;

const SEC_FETCH_SITE: HeaderName = HeaderName::from_static("sec-fetch-site");
const SEC_FETCH_MODE: HeaderName = HeaderName::from_static("sec-fetch-mode");
const SEC_FETCH_DEST: HeaderName = HeaderName::from_static("sec-fetch-dest");
/// Paths below it need the token or the cookie.
const API: &str = "/api/";
/// Where the token is exchanged for the cookie.
pub(crate) const SESSION: &str = "/api/session";
pub(crate) const PAGES: &str = "/api/pages";

/// Whom to let in.
pub(crate) struct Guard {
    /// What a browser calls this server, with the port.
    hosts: Vec<String>,
    /// Known to whoever was given the address.
    pub(crate) token: Token,
    /// Known to the browser that showed the token.
    session: Token,
    cookie: String,
}

impl Guard {
    /// Of a server at `port`; `names` are what it is called beside its loopback addresses.
    pub(crate) fn new(port: u16, names: &[String]) -> Result<Self, getrandom::Error> {
        let own = ["127.0.0.1", "localhost", "[::1]"].into_iter().chain(names.iter().map(String::as_str));
        Ok(Self {
            hosts: own.map(|name| format!("{name}:{port}")).collect(),
            token: Token::random()?,
            session: Token::random()?,
            // Cookies of one address are shared by all its ports.
            cookie: format!("lunula-{port}"),
        })
    }

    /// Whether a request may be answered. Why not is nobody's business.
    pub(crate) fn lets_in(&self, request: &Parts) -> bool {
        let headers = &request.headers;
        let Some(host) = only(headers, &HOST).filter(|host| self.knows(host)) else { return false };
        if request.uri.authority().is_some_and(|authority| authority.as_str() != host) {
            return false;
        }
        let own = format!("http://{host}");
        let origin_is_own = match only(headers, &ORIGIN) {
            Some(origin) => origin == own,
            // Browsers name the origin of whatever is more than a plain read.
            None => !headers.contains_key(ORIGIN) && is_plain_read(request),
        };
        let path = request.uri.path();
        let site_is_own = match only(headers, &SEC_FETCH_SITE) {
            Some(site) => matches!(site, "same-origin" | "none") || path == "/" && is_opened(headers),
            None => !headers.contains_key(SEC_FETCH_SITE),
        };
        let known = !path.starts_with(API) || path == SESSION || self.has_secret(headers);
        origin_is_own && site_is_own && known
    }

    /// The cookie for the browser that showed the token.
    pub(crate) fn set_cookie(&self) -> String {
        format!("{}={}; HttpOnly; SameSite=Strict; Path=/", self.cookie, self.session.reveal())
    }

    fn knows(&self, host: &str) -> bool {
        self.hosts.iter().any(|one| one == host)
    }

    fn has_secret(&self, headers: &HeaderMap) -> bool {
        let bearer = only(headers, &AUTHORIZATION).and_then(|value| value.strip_prefix("Bearer "));
        let cookies = headers.get_all(COOKIE).iter().filter_map(|value| value.to_str().ok());
        let mut pairs = cookies.flat_map(|all| all.split(';')).filter_map(|pair| pair.trim().split_once('='));
        bearer.is_some_and(|token| self.token.is(token))
            || pairs.any(|(name, value)| name == self.cookie && self.session.is(value))
    }
}

/// Whether a request opens a page of its own, as a link in a letter or the file for the browser does; the page it gets
/// knows nothing yet, and no other page sees it.
fn is_opened(headers: &HeaderMap) -> bool {
    only(headers, &SEC_FETCH_MODE) == Some("navigate") && only(headers, &SEC_FETCH_DEST) == Some("document")
}

/// Whether a request only reads.
fn is_plain_read(request: &Parts) -> bool {
    matches!(request.method, Method::GET | Method::HEAD) && !request.headers.contains_key(UPGRADE)
}

/// A header that is there once, as text.
fn only<'a>(headers: &'a HeaderMap, name: &HeaderName) -> Option<&'a str> {
    let mut all = headers.get_all(name).iter();
    let first = all.next()?.to_str().ok()?;
    all.next().is_none().then_some(first)
}

#[cfg(test)]
mod tests {
    use axum::http::Request;

    use super::*;

    const OWN: &str = "127.0.0.1:8000";

    fn asks(guard: &Guard, method: &str, path: &str, headers: &[(&str, &str)]) -> bool {
        let mut request = Request::builder().method(method).uri(path);
        for (name, value) in headers {
            request = request.header(*name, *value);
        }
        guard.lets_in(&request.body(()).unwrap().into_parts().0)
    }

    #[test]
    fn only_the_names_of_this_machine_are_hosts() {
        let guard = Guard::new(8000, &["lab".to_owned()]).unwrap();
        for host in [OWN, "localhost:8000", "[::1]:8000", "lab:8000"] {
            assert!(asks(&guard, "GET", "/", &[("host", host)]), "{host}");
        }
        for host in
            ["127.0.0.1", "127.0.0.1:8001", "evil.example:8000", "localhost.evil.example:8000", "", "LOCALHOST:8000"]
        {
            assert!(!asks(&guard, "GET", "/", &[("host", host)]), "{host}");
        }
        assert!(!asks(&guard, "GET", "/", &[]));
        assert!(!asks(&guard, "GET", "/", &[("host", OWN), ("host", OWN)]));
        assert!(!asks(&guard, "GET", "http://evil.example/", &[("host", OWN)]));
    }

    #[test]
    fn other_pages_are_refused() {
        let guard = Guard::new(8000, &[]).unwrap();
        let own = "http://127.0.0.1:8000";
        let with =
            |method: &str, more: &[(&str, &str)]| asks(&guard, method, SESSION, &[&[("host", OWN)], more].concat());
        assert!(with("POST", &[("origin", own)]));
        for origin in ["http://evil.example", "null", "http://localhost:8000", "https://127.0.0.1:8000", ""] {
            assert!(!with("POST", &[("origin", origin)]) && !with("GET", &[("origin", origin)]), "{origin}");
        }
        // No origin is good for reading only.
        assert!(with("GET", &[]) && with("HEAD", &[]));
        for method in ["POST", "PUT", "DELETE", "OPTIONS"] {
            assert!(!with(method, &[]), "{method}");
        }
        assert!(!with("GET", &[("upgrade", "websocket")]) && with("GET", &[("upgrade", "websocket"), ("origin", own)]));
        for (site, good) in [("same-origin", true), ("none", true), ("same-site", false), ("cross-site", false)] {
            assert_eq!(with("GET", &[("sec-fetch-site", site)]), good, "{site}");
        }
        // A link to the page itself, in a tab of its own.
        let link = |path: &str, dest: &str| {
            let headers = [("host", OWN), ("sec-fetch-site", "cross-site"), ("sec-fetch-mode", "navigate")];
            asks(&guard, "GET", path, &[&headers[..], &[("sec-fetch-dest", dest)]].concat())
        };
        assert!(link("/", "document") && !link("/", "iframe") && !link(SESSION, "document"));
    }

    #[test]
    fn what_is_more_than_the_page_needs_a_secret() {
        let guard = Guard::new(8000, &[]).unwrap();
        let with = |more: &[(&str, &str)]| asks(&guard, "GET", "/api/results", &[&[("host", OWN)], more].concat());
        let bearer = format!("Bearer {}", guard.token.reveal());
        let cookie = guard.set_cookie().split(';').next().unwrap().to_owned();
        assert!(!with(&[]) && with(&[("authorization", &bearer)]) && with(&[("cookie", &cookie)]));
        assert!(with(&[("cookie", &format!("other=1; {cookie}"))]));
        // The token is no cookie, the cookie no token, another port's cookie none.
        assert!(!with(&[("cookie", &format!("lunula-8000={}", guard.token.reveal()))]));
        assert!(!with(&[("authorization", &cookie.replace("lunula-8000=", "Bearer "))]));
        assert!(!with(&[("cookie", &cookie.replace("8000", "8001"))]));
        assert!(asks(&guard, "GET", "/app.js", &[("host", OWN)]));
    }
}
