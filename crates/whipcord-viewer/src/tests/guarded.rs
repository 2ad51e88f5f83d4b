//! Who may connect, and what is served.

use tokio::io::{AsyncReadExt as _, AsyncWriteExt as _};
use tokio::net::TcpStream;

use super::{example, serve};

/// The answer to a request with these header lines.
async fn answer(port: u16, path: &str, headers: &[&str]) -> String {
    let mut stream = TcpStream::connect(("127.0.0.1", port)).await.unwrap();
    let headers = headers.join("\r\n");
    let request = format!("GET {path} HTTP/1.1\r\n{headers}\r\nConnection: close\r\n\r\n");
    stream.write_all(request.as_bytes()).await.unwrap();
    let mut answer = String::new();
    stream.read_to_string(&mut answer).await.unwrap();
    answer
}

fn status(answer: &str) -> &str {
    answer.split(' ').nth(1).unwrap()
}

#[tokio::test]
async fn the_page_is_served_and_nothing_else() {
    let port = serve(&example("two-segment-arm.toml")).await;
    let host = format!("Host: 127.0.0.1:{port}");
    let page = answer(port, "/", &[&host]).await;
    assert_eq!(status(&page), "200");
    assert!(page.ends_with("<p>page</p>"));
    assert!(page.contains("content-security-policy: default-src 'none';"));
    for path in [
        "/Cargo.toml",
        "/../Cargo.toml",
        "/%2e%2e/Cargo.toml",
        "/two-segment-arm.toml",
        "//etc/passwd",
    ] {
        assert_eq!(status(&answer(port, path, &[&host]).await), "404", "{path}");
    }
    let local = format!("Host: localhost:{port}");
    assert_eq!(status(&answer(port, "/viewer.js", &[&local]).await), "200");
}

#[tokio::test]
async fn a_page_of_another_name_is_refused() {
    let port = serve(&example("two-segment-arm.toml")).await;
    let own = format!("Host: 127.0.0.1:{port}");
    let rebound = [
        format!("Host: evil.example:{port}"),
        "Host: 127.0.0.1".to_owned(),
        "Host: localhost:1".to_owned(),
        format!("Host: 127.0.0.1:{port}.evil.example"),
        format!("{own}\r\n{own}"),
    ];
    for host in rebound {
        let answer = answer(port, "/", &[&host]).await;
        assert!(["421", "400"].contains(&status(&answer)), "{host}: {answer}");
        assert!(!answer.contains("<p>page</p>"));
    }
}

#[tokio::test]
async fn a_socket_comes_from_the_page_itself() {
    let port = serve(&example("two-segment-arm.toml")).await;
    let upgrade = "Connection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==";
    let (host, local) = (format!("Host: 127.0.0.1:{port}"), format!("Host: localhost:{port}"));
    let refused: [(&str, Option<String>); 5] = [
        (&host, None),
        (&host, Some("http://evil.example".to_owned())),
        (&host, Some("null".to_owned())),
        (&host, Some(format!("https://127.0.0.1:{port}"))),
        (&local, Some(format!("http://127.0.0.1:{port}"))),
    ];
    for (host, origin) in refused {
        let mut headers = vec![host.to_owned(), upgrade.to_owned()];
        headers.extend(origin.iter().map(|origin| format!("Origin: {origin}")));
        let headers: Vec<&str> = headers.iter().map(String::as_str).collect();
        let answer = answer(port, "/socket", &headers).await;
        assert_eq!(status(&answer), "403", "{origin:?}");
    }
}
