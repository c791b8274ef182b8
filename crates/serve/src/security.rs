//! Who may ask: tokens, and the names and pages that requests may come by.
//!
//! A web page of somebody else's must not move a robot. A browser says by `Origin` which page it asks for, which has to
//! be one of ours; and what name it has reached this program by in `Host`: another name than ours is one that was made
//! to lead here (DNS rebinding). Addresses can't be, so they are all allowed.

use std::net::{Ipv4Addr, Ipv6Addr};
use std::sync::Arc;

use axum::extract::{Request, State};
use axum::http::{HeaderMap, Method, Uri, header};
use axum::middleware::Next;
use axum::response::Response;
use subtle::ConstantTimeEq;

use crate::problem::{Kind, Problem};

/// What browsers put before a token among the subprotocols of a WebSocket, which can't have other headers there.
const TOKEN_PROTOCOL: &str = "deltarobot.token.";

/// Who may do what.
#[derive(Debug, Default)]
pub(crate) struct Guard {
    /// Of who may drive and watch.
    pub(crate) drive: Option<String>,
    /// Of who may watch, and cancel.
    pub(crate) watch: Option<String>,
    /// Names by which this program is reached, besides addresses and localhost.
    pub(crate) hosts: Vec<String>,
    /// Pages of others that may ask, such as `https://example.org`.
    pub(crate) origins: Vec<String>,
}

impl Guard {
    /// Refuses requests that may not be.
    pub(crate) async fn check(
        State(guard): State<Arc<Self>>,
        request: Request,
        next: Next,
    ) -> Result<Response, Problem> {
        guard.check_names(request.uri(), request.headers())?;
        guard.check_token(request.method(), request.uri().path(), request.headers())?;
        Ok(next.run(request).await)
    }

    fn check_names(&self, uri: &Uri, headers: &HeaderMap) -> Result<(), Problem> {
        let forbidden = |text: String| Err(Problem::new(Kind::Forbidden, text));
        let host =
            headers.get(header::HOST).and_then(|host| host.to_str().ok()).or_else(|| Some(uri.authority()?.as_str()));
        let Some(host) = host else { return forbidden("the header Host is missing".into()) };
        if headers.get_all(header::HOST).iter().count() > 1 || !self.is_ours(host) {
            return forbidden(format!("`{host}` is no name of this program; --host allows one"));
        }
        let mut origins = headers.get_all(header::ORIGIN).iter();
        let is_ours = |origin: &str| {
            let same = ["http://", "https://"].iter().any(|scheme| origin.strip_prefix(scheme) == Some(host));
            same || self.origins.iter().any(|allowed| allowed == origin)
        };
        match origins.find(|origin| !origin.to_str().is_ok_and(is_ours)) {
            Some(origin) => forbidden(format!(
                "pages of {} may not ask; `origins` in the configuration allows them",
                String::from_utf8_lossy(origin.as_bytes())
            )),
            None => Ok(()),
        }
    }

    fn is_ours(&self, host: &str) -> bool {
        let name = match host.rsplit_once(':') {
            Some((name, port)) if !port.contains(']') => name,
            _ => host,
        };
        let in_brackets = name.strip_prefix('[').and_then(|name| name.strip_suffix(']'));
        in_brackets.map_or_else(|| name.parse::<Ipv4Addr>().is_ok(), |name| name.parse::<Ipv6Addr>().is_ok())
            || name.eq_ignore_ascii_case("localhost")
            || self.hosts.iter().any(|host| host.eq_ignore_ascii_case(name))
    }

    fn check_token(&self, method: &Method, path: &str, headers: &HeaderMap) -> Result<(), Problem> {
        if self.drive.is_none() && self.watch.is_none() || !path.starts_with("/api/") {
            return Ok(());
        }
        let Some(given) = token(headers) else {
            return Err(Problem::new(Kind::NoToken, "send the header `Authorization: Bearer TOKEN`"));
        };
        let is = |token: &Option<String>| {
            token.as_ref().is_some_and(|token| bool::from(token.as_bytes().ct_eq(given.as_bytes())))
        };
        // Both are compared whatever the first says.
        match (is(&self.drive), is(&self.watch)) {
            (true, _) => Ok(()),
            (_, true) if may_watch(method, path) => Ok(()),
            (_, true) => Err(Problem::new(Kind::Forbidden, "this token is for watching and cancelling alone")),
            _ => Err(Problem::new(Kind::NoToken, "this token is not known")),
        }
    }

    /// Whether the token in these headers, if any is needed, allows to drive.
    pub(crate) fn may_drive(&self, headers: &HeaderMap) -> bool {
        self.check_token(&Method::POST, "/api/", headers).is_ok()
    }
}

/// What needs no right to drive.
fn may_watch(method: &Method, path: &str) -> bool {
    let only_computes = ["/api/kinematics/forward", "/api/kinematics/inverse", "/api/recordings"];
    method == Method::GET || method == Method::HEAD || path.ends_with("/cancel") || only_computes.contains(&path)
}

fn token(headers: &HeaderMap) -> Option<&str> {
    if let Some(value) = headers.get(header::AUTHORIZATION) {
        return value.to_str().ok()?.strip_prefix("Bearer ").map(str::trim);
    }
    let offered = headers.get_all(header::SEC_WEBSOCKET_PROTOCOL).iter().filter_map(|value| value.to_str().ok());
    offered.flat_map(|value| value.split(',')).find_map(|value| value.trim().strip_prefix(TOKEN_PROTOCOL))
}

#[cfg(test)]
mod tests {
    use super::{Guard, HeaderMap, Method, header};

    fn headers(pairs: &[(header::HeaderName, &str)]) -> HeaderMap {
        pairs.iter().map(|(name, value)| (name.clone(), value.parse().unwrap())).collect()
    }

    #[test]
    fn names_and_pages() {
        let guard = Guard {
            hosts: vec!["robots.example".into()],
            origins: vec!["https://dash.example".into()],
            ..Guard::default()
        };
        let is_ok = |host: &str, origin: Option<&str>| {
            let mut all = headers(&[(header::HOST, host)]);
            if let Some(origin) = origin {
                all.insert(header::ORIGIN, origin.parse().unwrap());
            }
            guard.check_names(&"/api/robots".parse().unwrap(), &all).is_ok()
        };
        for host in
            ["127.0.0.1:7373", "[::1]:7373", "[::1]", "localhost", "Localhost:1", "robots.example:80", "10.0.0.1"]
        {
            assert!(is_ok(host, None), "{host}");
            assert!(is_ok(host, Some(&format!("http://{host}"))), "{host}");
            assert!(is_ok(host, Some("https://dash.example")), "{host}");
            for origin in ["http://evil.example", "null", "http://localhost:8080", "https://dash.example.evil", ""] {
                assert!(!is_ok(host, Some(origin)), "{host} {origin}");
            }
        }
        for host in [
            "evil.example",
            "localhost.evil.example:7373",
            "127.0.0.1.evil.example",
            "",
            ":",
            "[",
            "robots.example.",
            "::1:x",
        ] {
            assert!(!is_ok(host, None), "{host}");
        }
    }

    #[test]
    fn tokens_and_what_they_allow() {
        let guard = Guard { drive: Some("d".repeat(16)), watch: Some("w".repeat(16)), ..Guard::default() };
        let check =
            |method: Method, path: &str, all: &HeaderMap| guard.check_token(&method, path, all).map_err(|it| it.kind);
        let bearer = |token: &str| headers(&[(header::AUTHORIZATION, &format!("Bearer {token}"))]);
        let (drive, watch) = (bearer(&"d".repeat(16)), bearer(&"w".repeat(16)));
        assert!(check(Method::POST, "/api/robots/a/move", &drive).is_ok());
        assert!(check(Method::POST, "/api/robots/a/move", &watch).is_err());
        assert!(check(Method::POST, "/api/robots/a/cancel", &watch).is_ok());
        assert!(check(Method::GET, "/api/robots", &watch).is_ok());
        let offered = headers(&[(header::SEC_WEBSOCKET_PROTOCOL, "deltarobot, deltarobot.token.wwwwwwwwwwwwwwww")]);
        assert!(check(Method::GET, "/api/events", &offered).is_ok());
        for wrong in ["", "d", &"d".repeat(17), &"x".repeat(16)] {
            assert!(check(Method::GET, "/api/robots", &bearer(wrong)).is_err());
        }
        assert!(check(Method::GET, "/api/robots", &HeaderMap::new()).is_err());
        assert!(guard.may_drive(&drive) && !guard.may_drive(&watch));
    }
}
