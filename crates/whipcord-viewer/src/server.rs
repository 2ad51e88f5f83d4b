//! The server: the page, and its WebSocket, for this machine alone.
//!
//! Any web page that a browser shows can send requests to this machine. So every request must name this machine as
//! its host, which a page of another name that resolves to it does not (DNS rebinding), and a WebSocket must come from
//! the page itself.

use std::net::{Ipv4Addr, SocketAddr};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use axum::Router;
use axum::extract::ws::WebSocketUpgrade;
use axum::extract::{Request, State};
use axum::http::{HeaderMap, HeaderName, HeaderValue, StatusCode, header};
use axum::middleware::{self, Next};
use axum::response::{IntoResponse, Response};
use axum::routing::get;
use axum::serve::ListenerExt as _;
use tokio::net::TcpListener;
use tokio::sync::{Semaphore, watch};
use whipcord::ModelPreset;

use crate::beside::Beside;
use crate::connection::{self, Limits, Shared, Shows};
use crate::error::ViewError;
use crate::opened::{Opened, Watched, follow};
use crate::page::Page;
use crate::protocol::MOST_BYTES;

/// How long solves may take.
const LIMITS: Limits =
    Limits { patience: Duration::from_millis(500), deadline: Duration::from_secs(20) };
/// Pages that are served at once, each with one solve at most.
const MOST_PAGES: usize = 256;

/// What a page is read by, at a time: its messages have about a thousand bytes, and what is held for them is held for each page.
const READ_BYTES: usize = 4096;

/// Nothing but the page's own script and style, and no connection but to this server. The page may be framed by
/// notebooks on this machine.
const POLICY: &str = "default-src 'none'; script-src 'self'; style-src 'self' 'unsafe-inline'; \
    img-src 'self' data: blob:; media-src blob:; connect-src 'self'; base-uri 'none'; form-action 'none'; \
    frame-ancestors 'self' http://localhost:* http://127.0.0.1:*";

#[derive(Clone, Debug)]
struct Served {
    page: Page,
    port: u16,
    shared: Shared,
    pages: Arc<Semaphore>,
}

/// What is served beside the page.
#[derive(Debug)]
pub struct Viewed {
    /// The robot file.
    pub path: PathBuf,
    /// What pages begin with; where none is named, the first that takes the robot.
    pub models: Vec<ModelPreset>,
    /// As it was read.
    pub opened: Opened,
    /// What tells that it has changed.
    pub watched: Watched,
    /// Robots that are shown beside it.
    pub beside: Vec<Beside>,
    /// What another program shows.
    pub shown: Option<Shows>,
}

impl Viewed {
    /// Reads a robot file.
    ///
    /// # Errors
    /// As [`Opened::read`].
    pub fn read(path: &Path, models: &[ModelPreset]) -> Result<Self, ViewError> {
        let (opened, watched) = Opened::read(path, models)?;
        let (path, models) = (path.to_owned(), models.to_vec());
        Ok(Self { path, models, opened, watched, beside: Vec::new(), shown: None })
    }
}

/// A server that listens.
#[derive(Debug)]
pub struct Server {
    listener: TcpListener,
    address: SocketAddr,
    limits: Limits,
}

impl Server {
    /// Listens on a port of this machine; on a free one for 0.
    ///
    /// # Errors
    /// [`ViewError::Port`] when that is not to be had.
    pub async fn listen(port: u16) -> Result<Self, ViewError> {
        let bound = TcpListener::bind((Ipv4Addr::LOCALHOST, port)).await;
        let failed = |source| ViewError::Port { port, source };
        let listener = bound.map_err(failed)?;
        let address = listener.local_addr().map_err(failed)?;
        Ok(Self { listener, address, limits: LIMITS })
    }

    /// The server with other times that solves may take.
    #[cfg(test)]
    pub fn with_limits(self, limits: Limits) -> Self {
        Self { limits, ..self }
    }

    /// The port it listens on.
    pub fn port(&self) -> u16 {
        self.address.port()
    }

    /// Serves the page and the file until `stop` comes to an end.
    ///
    /// # Errors
    /// [`ViewError::Server`] when it stops before.
    pub async fn serve(
        self,
        page: Page,
        viewed: Viewed,
        stop: impl Future<Output = ()>,
    ) -> Result<(), ViewError> {
        let Viewed { path, models, opened, watched, beside, shown } = viewed;
        let (tell, opened) = watch::channel(opened);
        let shared = Shared { opened, beside: beside.into(), shown, limits: self.limits };
        let pages = Arc::new(Semaphore::new(MOST_PAGES));
        let served = Served { page, port: self.port(), shared, pages };
        // An answer is not held back until the page has said that it has the one before, which it does with its next request.
        let listener = self.listener.tap_io(|stream| {
            // Without it answers come later, and that is all.
            let _ = stream.set_nodelay(true);
        });
        let server = axum::serve(listener, router(served)).into_future();
        tokio::select! {
            () = follow(path, models, watched, tell) => Ok(()),
            () = stop => Ok(()),
            stopped = server => stopped.map_err(ViewError::Server),
        }
    }
}

fn router(served: Served) -> Router {
    Router::new()
        .route("/", get(html))
        .route("/viewer.js", get(script))
        .route("/viewer.css", get(style))
        .route("/socket", get(socket))
        .layer(middleware::from_fn_with_state(served.clone(), guard))
        .with_state(served)
}

async fn html(State(served): State<Served>) -> impl IntoResponse {
    ([(header::CONTENT_TYPE, "text/html; charset=utf-8")], served.page.html)
}

async fn script(State(served): State<Served>) -> impl IntoResponse {
    ([(header::CONTENT_TYPE, "text/javascript; charset=utf-8")], served.page.script)
}

async fn style(State(served): State<Served>) -> impl IntoResponse {
    ([(header::CONTENT_TYPE, "text/css; charset=utf-8")], served.page.style)
}

async fn socket(
    State(served): State<Served>,
    headers: HeaderMap,
    upgrade: WebSocketUpgrade,
) -> Response {
    if !comes_from_the_page(&headers, served.port) {
        return refusal(StatusCode::FORBIDDEN, "only the viewer's own page may connect");
    }
    let Ok(permit) = Arc::clone(&served.pages).try_acquire_owned() else {
        return refusal(StatusCode::SERVICE_UNAVAILABLE, "too many pages are open");
    };
    let upgrade = upgrade
        .max_message_size(MOST_BYTES)
        .max_frame_size(MOST_BYTES)
        .read_buffer_size(READ_BYTES)
        .write_buffer_size(0);
    upgrade.on_upgrade(move |socket| async move {
        connection::serve(socket, served.shared).await;
        drop(permit);
    })
}

/// Refuses what does not name this machine as its host, and says what the page may do.
async fn guard(State(served): State<Served>, request: Request, next: Next) -> Response {
    let mut response = if names_this_machine(request.headers(), served.port) {
        next.run(request).await
    } else {
        refusal(StatusCode::MISDIRECTED_REQUEST, "this server answers to localhost only")
    };
    let constants = [
        (header::CONTENT_SECURITY_POLICY, POLICY),
        (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
        (header::REFERRER_POLICY, "no-referrer"),
        (header::CACHE_CONTROL, "no-store"),
        (HeaderName::from_static("cross-origin-resource-policy"), "same-origin"),
    ];
    for (name, value) in constants {
        response.headers_mut().insert(name, HeaderValue::from_static(value));
    }
    response
}

fn refusal(status: StatusCode, why: &'static str) -> Response {
    (status, [(header::CONTENT_TYPE, "text/plain; charset=utf-8")], why).into_response()
}

/// Names of this machine that a browser may call it by.
const NAMES: [&str; 2] = ["127.0.0.1", "localhost"];

fn names_this_machine(headers: &HeaderMap, port: u16) -> bool {
    only(headers, header::HOST)
        .is_some_and(|host| NAMES.iter().any(|name| host == format!("{name}:{port}")))
}

/// Whether a WebSocket's origin is this server under the very name that it was reached by.
fn comes_from_the_page(headers: &HeaderMap, port: u16) -> bool {
    let (origin, host) = (only(headers, header::ORIGIN), only(headers, header::HOST));
    names_this_machine(headers, port)
        && origin.zip(host).is_some_and(|(origin, host)| origin == format!("http://{host}"))
}

/// The value of a header that is there once.
fn only(headers: &HeaderMap, name: HeaderName) -> Option<&str> {
    let mut values = headers.get_all(name).iter();
    let value = values.next()?.to_str().ok()?;
    values.next().is_none().then_some(value)
}
