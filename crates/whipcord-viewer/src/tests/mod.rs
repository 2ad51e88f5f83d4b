#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "a test fails by panicking"
)]

mod answers;
mod courses;
mod design;
mod guarded;
mod interpolation;
mod inverse;
mod live;
mod samples;
mod scenes;
mod shown;
mod soak;

use std::path::{Path, PathBuf};
use std::time::Duration;

use futures_util::{SinkExt as _, StreamExt as _};
use tokio::net::TcpStream;
use tokio_tungstenite::tungstenite::Message;
use tokio_tungstenite::tungstenite::client::IntoClientRequest as _;
use tokio_tungstenite::tungstenite::http::{HeaderValue, header};
use tokio_tungstenite::tungstenite::protocol::WebSocketConfig;
use tokio_tungstenite::{MaybeTlsStream, WebSocketStream, connect_async_with_config};

use whipcord::{Model, ModelKind, ModelPreset, Statics as _, Stations, Vec3};
use whipcord_io::{CaseFile, load};

use crate::page::Page;
use crate::protocol::{FromPage, Request, Scene, ToPage};
use crate::server::{Server, Viewed};

pub fn example(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples").join(name)
}

/// Serves a file with a page of nothing, and returns the port.
pub async fn serve(path: &Path) -> u16 {
    serve_with(path, &[]).await
}

/// The same, beginning with these models.
pub async fn serve_with(path: &Path, models: &[ModelPreset]) -> u16 {
    serve_by(Server::listen(0).await.unwrap(), Viewed::read(path, models).unwrap())
}

/// Serves what was read by this server, and returns the port.
pub fn serve_by(server: Server, viewed: Viewed) -> u16 {
    let page = Page { html: "<p>page</p>", script: "script", style: "style" };
    let port = server.port();
    tokio::spawn(server.serve(page, viewed, std::future::pending()));
    port
}

fn solve(request: &Request) -> Message {
    Message::Text(serde_json::to_string(&FromPage::Solve(request.clone())).unwrap().into())
}

/// The tip that a model finds at these tensions and with this force at the tip, from cold and without a server.
pub fn tip(name: &str, kind: ModelKind, request: &Request) -> Vec3 {
    let CaseFile { robot, mut case, .. } = load(example(name)).unwrap();
    case.commands = request.commands.iter().map(|command| command.command()).collect();
    case.loads.tip_force = request.tip_force.into();
    let model = Model::new(kind, Stations::Disks, Default::default());
    model.solve(&robot, &case).unwrap().shape.tip().position
}

/// Longer than any message takes on a machine that does much else.
const LONGEST_SILENCE: Duration = Duration::from_secs(120);

/// A page that is connected.
pub struct Client {
    socket: WebSocketStream<MaybeTlsStream<TcpStream>>,
}

impl Client {
    /// As the page of the server connects, and what it is told first.
    pub async fn connect(port: u16) -> (Self, Scene) {
        let mut request = format!("ws://127.0.0.1:{port}/socket").into_client_request().unwrap();
        let origin = HeaderValue::from_str(&format!("http://127.0.0.1:{port}")).unwrap();
        request.headers_mut().insert(header::ORIGIN, origin);
        let small = WebSocketConfig::default().read_buffer_size(4096).write_buffer_size(0);
        let (socket, _) = connect_async_with_config(request, Some(small), false).await.unwrap();
        let mut client = Self { socket };
        match client.hear().await {
            ToPage::Scene(scene) => (client, *scene),
            other => panic!("the first message is {other:?}"),
        }
    }

    pub async fn say(&mut self, message: Message) {
        self.socket.send(message).await.unwrap();
    }

    pub async fn ask(&mut self, request: &Request) {
        self.say(solve(request)).await;
    }

    /// Asks all at once: all are on the way before the first is answered.
    pub async fn ask_all(&mut self, requests: &[Request]) {
        for request in requests {
            self.socket.feed(solve(request)).await.unwrap();
        }
        self.socket.flush().await.unwrap();
    }

    /// The next message, pings apart; a server that says nothing fails the test.
    pub async fn hear(&mut self) -> ToPage {
        loop {
            let next = tokio::time::timeout(LONGEST_SILENCE, self.socket.next()).await;
            match next.expect("the server says nothing").unwrap().unwrap() {
                Message::Text(text) => return serde_json::from_str(&text).unwrap(),
                Message::Ping(_) | Message::Pong(_) => {}
                other => panic!("the server says {other:?}"),
            }
        }
    }

    /// Waits until the server ends the connection, whatever it says before.
    pub async fn wait_for_the_end(&mut self) {
        while let Some(Ok(message)) = self.socket.next().await {
            if message.is_close() {
                return;
            }
        }
    }
}
