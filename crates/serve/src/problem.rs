//! Why something was not done: RFC 9457.

use std::fmt;

use axum::http::{StatusCode, header};
use axum::response::{IntoResponse, Response};
use serde::Serialize;

/// Kinds of problems.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// The request is not what is described.
    Malformed,
    /// There is no token, or a wrong one.
    NoToken,
    /// The token's role, or the page that asks, may not.
    Forbidden,
    /// There is no such robot, or nothing at that path.
    NotFound,
    /// Not by this method.
    Method,
    /// Somebody else drives.
    Driven,
    /// The robot moves already.
    Busy,
    /// Only who drives may ask so.
    NoLease,
    /// The request has come too late.
    Expired,
    /// More bytes than are taken.
    TooLong,
    /// What is asked for can't be.
    Impossible,
    /// The robot can't be reached.
    Down,
    /// More at a time than is taken.
    Overload,
}

impl Kind {
    const fn parts(self) -> (StatusCode, &'static str, &'static str) {
        match self {
            Self::Malformed => (StatusCode::BAD_REQUEST, "malformed", "The request can't be read"),
            Self::NoToken => (StatusCode::UNAUTHORIZED, "no-token", "A token is needed"),
            Self::Forbidden => (StatusCode::FORBIDDEN, "forbidden", "Not allowed"),
            Self::NotFound => (StatusCode::NOT_FOUND, "not-found", "Nothing is there"),
            Self::Method => (StatusCode::METHOD_NOT_ALLOWED, "method", "Not by this method"),
            Self::Driven => (StatusCode::CONFLICT, "driven", "Somebody else drives the robot"),
            Self::Busy => (StatusCode::CONFLICT, "busy", "The robot is busy"),
            Self::NoLease => (StatusCode::CONFLICT, "no-lease", "A lease is needed"),
            Self::Expired => (StatusCode::CONFLICT, "expired", "The request came too late"),
            Self::TooLong => (StatusCode::PAYLOAD_TOO_LARGE, "too-long", "The request is too long"),
            Self::Impossible => (StatusCode::UNPROCESSABLE_ENTITY, "impossible", "That can't be"),
            Self::Down => (StatusCode::SERVICE_UNAVAILABLE, "down", "The robot can't be reached"),
            Self::Overload => (StatusCode::SERVICE_UNAVAILABLE, "overload", "Too much at a time"),
        }
    }
}

/// Such a problem, and what it is exactly.
#[derive(Clone, Debug)]
pub(crate) struct Problem {
    /// What kind it is.
    pub(crate) kind: Kind,
    /// In words.
    pub(crate) detail: String,
}

impl Problem {
    /// A problem of that kind.
    pub(crate) fn new(kind: Kind, detail: impl Into<String>) -> Self {
        Self { kind, detail: detail.into() }
    }

    /// As JSON.
    pub(crate) fn body(&self) -> Body<'_> {
        let (status, name, title) = self.kind.parts();
        Body { name: format!("/problems/{name}"), title, status: status.as_u16(), detail: &self.detail }
    }
}

/// What is sent of it.
#[derive(Debug, Serialize)]
pub(crate) struct Body<'a> {
    #[serde(rename = "type")]
    name: String,
    title: &'static str,
    status: u16,
    detail: &'a str,
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.kind.parts().2, self.detail)
    }
}

impl IntoResponse for Problem {
    fn into_response(self) -> Response {
        let body = serde_json::to_string(&self.body()).unwrap_or_default();
        let mut response =
            (self.kind.parts().0, [(header::CONTENT_TYPE, "application/problem+json")], body).into_response();
        if self.kind == Kind::NoToken {
            response.headers_mut().insert(header::WWW_AUTHENTICATE, header::HeaderValue::from_static("Bearer"));
        }
        response
    }
}
