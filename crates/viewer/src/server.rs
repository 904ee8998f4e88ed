//! The page handed out on loopback.

use std::io;
use std::net::{Ipv4Addr, SocketAddr, TcpListener};
use std::path::{Path as FilePath, PathBuf};
use std::sync::Arc;

use axum::Router;
use axum::body::Body;
use axum::extract::{Path, Request, State};
use axum::http::{HeaderMap, HeaderValue, Method, StatusCode, header};
use axum::middleware::{self, Next};
use axum::response::{IntoResponse, Response};
use axum::routing::get;
use serde_json::json;
use tower_http::services::ServeFile;

use crate::page::{Page, Slot};
use crate::remade::{Answer, Asked, Refusal, Remade};

/// A log to be shown.
pub struct Shown {
    /// What it is called.
    pub name: String,
    /// The file; it may still grow.
    pub log: PathBuf,
    /// What makes again what the log leaves out.
    pub remade: Arc<dyn Remade>,
}

/// Hands out the page and its logs to this machine alone.
///
/// It listens on 127.0.0.1 only, under a path that cannot be guessed, and answers nobody who calls it by another name: a
/// page from elsewhere that is open in the same browser cannot read a log. It only ever reads.
pub struct Server {
    listener: TcpListener,
    at: SocketAddr,
    token: String,
    router: Router,
}

impl Server {
    /// Takes a port (any free one for 0) and gets ready to show one log, or two beside each other.
    ///
    /// # Errors
    /// If the port is taken, or the machine has no randomness.
    pub fn bind(port: u16, first: Shown, second: Option<Shown>) -> io::Result<Self> {
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port))?;
        listener.set_nonblocking(true)?;
        let at = listener.local_addr()?;
        let token = format!("{:016x}", getrandom::u64().map_err(io::Error::other)?);
        let shown = [Some((Slot::A, first)), second.map(|second| (Slot::B, second))];
        let mut served = serde_json::Map::new();
        let mut inner = Router::new();
        for (slot, Shown { name, log, remade }) in shown.into_iter().flatten() {
            let slot = slot.name();
            let (log_at, derived_at) = (format!("{slot}/log"), format!("{slot}/derived"));
            served.insert(
                slot.to_owned(),
                json!({ "name": name, "log": log_at, "derived": derived_at }),
            );
            inner = inner
                .route(&format!("/{log_at}"), get(move |request| log_file(log.clone(), request)))
                .nest(&format!("/{derived_at}"), derived(remade));
        }
        let mut page = Page::default();
        page.served(served.into());
        let mut html = Vec::new();
        page.write_to(&mut html)?;
        let html: Arc<[u8]> = html.into();
        let hand_out = move || {
            let html = Body::from(html.to_vec());
            async move { ([(header::CONTENT_TYPE, "text/html; charset=utf-8")], html) }
        };
        let router = Router::new()
            .route(&format!("/{token}/"), get(hand_out))
            .nest(&format!("/{token}"), inner)
            .layer(middleware::from_fn_with_state(at.port(), only_this_machine));
        Ok(Self { listener, at, token, router })
    }

    /// Where the page is.
    #[must_use]
    pub fn address(&self) -> String {
        format!("http://{}/{}/", self.at, self.token)
    }

    /// Serves until the process ends.
    ///
    /// # Errors
    /// If the system lets nobody in any more.
    pub fn serve(self) -> io::Result<()> {
        let runtime = tokio::runtime::Builder::new_current_thread().enable_io().build()?;
        runtime.block_on(async {
            let listener = tokio::net::TcpListener::from_std(self.listener)?;
            axum::serve(listener, self.router).await
        })
    }
}

/// Where a log is by now: a run that ends gives `NAME.part` the name `NAME`.
#[must_use]
pub fn now_at(log: &FilePath) -> PathBuf {
    let ended = log.extension().is_some_and(|end| end == "part").then(|| log.with_extension(""));
    ended.filter(|ended| !log.exists() && ended.exists()).unwrap_or_else(|| log.to_path_buf())
}

/// The log, or the part of it that is asked for.
async fn log_file(log: PathBuf, request: Request) -> Response {
    match ServeFile::new(now_at(&log)).try_call(request).await {
        Ok(response) => response.map(Body::new),
        Err(error) => (StatusCode::NOT_FOUND, error.to_string()).into_response(),
    }
}

/// Lets through only who asks for this server by its own name, and only to read.
async fn only_this_machine(State(port): State<u16>, request: Request, next: Next) -> Response {
    let host = request.headers().get(header::HOST).and_then(|host| host.to_str().ok());
    // Of the web's own port browsers do not speak.
    let own = |name: &str| match host.and_then(|host| host.strip_prefix(name)) {
        Some("") => port == 80,
        Some(rest) => rest.strip_prefix(':') == Some(port.to_string().as_str()),
        None => false,
    };
    if !own("127.0.0.1") && !own("localhost") {
        return (StatusCode::MISDIRECTED_REQUEST, "not the name of this server\n").into_response();
    }
    if !matches!(*request.method(), Method::GET | Method::HEAD) {
        return StatusCode::METHOD_NOT_ALLOWED.into_response();
    }
    let mut response = next.run(request).await;
    let headers = response.headers_mut();
    // A log may grow, and the same port shows another one tomorrow.
    headers.insert(header::CACHE_CONTROL, HeaderValue::from_static("no-store"));
    headers.insert(header::X_CONTENT_TYPE_OPTIONS, HeaderValue::from_static("nosniff"));
    headers.insert(header::X_FRAME_OPTIONS, HeaderValue::from_static("DENY"));
    headers.insert(header::REFERRER_POLICY, HeaderValue::from_static("no-referrer"));
    headers.insert("cross-origin-resource-policy", HeaderValue::from_static("same-origin"));
    response
}

type Remaker = Arc<dyn Remade>;

/// What the page asks for besides the log.
fn derived(remade: Remaker) -> Router {
    let index = |State(remade): State<Remaker>| answer(remade, Asked::Index);
    let plane = |State(remade): State<Remaker>, Path((decision, name)): Path<(u32, String)>| {
        answer(remade, Asked::Plane { decision, name })
    };
    let cell = |State(remade): State<Remaker>,
                Path((decision, row, col)): Path<(u32, u32, u32)>| {
        answer(remade, Asked::Cell { decision, row, col })
    };
    let family = |State(remade): State<Remaker>, Path(decision): Path<u32>| {
        answer(remade, Asked::Family { decision })
    };
    let prices = |State(remade): State<Remaker>, Path(decision): Path<u32>| {
        answer(remade, Asked::Prices { decision })
    };
    Router::new()
        .route("/index", get(index))
        .route("/plane/{decision}/{name}", get(plane))
        .route("/cell/{decision}/{row}/{col}", get(cell))
        .route("/family/{decision}", get(family))
        .route("/prices/{decision}", get(prices))
        .with_state(remade)
}

async fn answer(remade: Remaker, asked: Asked) -> Response {
    // It may take seconds, and the log is read meanwhile.
    let made = tokio::task::spawn_blocking(move || remade.answer(&asked)).await;
    let (status, why) = match made {
        Ok(Ok(Answer::Json(value))) => return as_json(StatusCode::OK, value.to_string()),
        Ok(Ok(Answer::Plane(bytes))) => {
            let mut headers = HeaderMap::new();
            let kind = HeaderValue::from_static("application/octet-stream");
            headers.insert(header::CONTENT_TYPE, kind);
            return (headers, bytes).into_response();
        }
        Ok(Err(Refusal::NotThere(why))) => (StatusCode::NOT_FOUND, why),
        Ok(Err(Refusal::Failed(why))) => (StatusCode::UNPROCESSABLE_ENTITY, why),
        Err(broken) => (StatusCode::INTERNAL_SERVER_ERROR, broken.to_string()),
    };
    as_json(status, json!({ "error": why }).to_string())
}

fn as_json(status: StatusCode, text: String) -> Response {
    (status, [(header::CONTENT_TYPE, "application/json")], text).into_response()
}
