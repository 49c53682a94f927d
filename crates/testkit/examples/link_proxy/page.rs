//! A page that changes the link: what it sends are the lines of standard input.

use crate::ends::Arrival;
use std::io::{self, BufRead as _, BufReader, Read as _, Write as _};
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::sync::mpsc::{SyncSender, sync_channel};
use std::thread;
use std::time::Duration;

const PAGE: &str = include_str!("page.html");
/// No request is longer.
const REQUEST_MAX: u64 = 16 << 10;
const PATIENCE: Duration = Duration::from_secs(5);

/// Serves the page at an address; answers at which, as the port may be 0.
pub(crate) fn serve(
    address: SocketAddr,
    station: Option<&str>,
    arrivals: &SyncSender<Arrival>,
) -> io::Result<SocketAddr> {
    let listener = TcpListener::bind(address)?;
    let at = listener.local_addr()?;
    let page = PAGE.replace("STATION_PAGE", station.unwrap_or_default());
    let arrivals = arrivals.clone();
    let serve = move || {
        for stream in listener.incoming().flatten() {
            // Whoever does not ask properly is not answered.
            drop(answer(&stream, &page, &arrivals));
        }
    };
    thread::Builder::new().spawn(serve)?;
    Ok(at)
}

fn answer(stream: &TcpStream, page: &str, arrivals: &SyncSender<Arrival>) -> io::Result<()> {
    stream.set_read_timeout(Some(PATIENCE))?;
    let mut reader = BufReader::new(stream.take(REQUEST_MAX));
    let (mut first, mut line, mut length) = (String::new(), String::new(), 0);
    reader.read_line(&mut first)?;
    while reader.read_line(&mut line)? > 2 {
        if let Some((name, value)) = line.split_once(':')
            && name.eq_ignore_ascii_case("content-length")
        {
            length = value.trim().parse().unwrap_or(0);
        }
        line.clear();
    }
    let mut body = String::new();
    reader.take(length).read_to_string(&mut body)?;
    if first.starts_with("GET / ") {
        return reply(stream, "200 OK", "text/html; charset=utf-8", page);
    }
    if !first.starts_with("POST /say ") || body == "end" {
        return reply(stream, "404 Not Found", "text/plain", "");
    }
    let (sender, said) = sync_channel(1);
    arrivals.send(Arrival::Line(body, Some(sender))).map_err(io::Error::other)?;
    let said = said.recv_timeout(PATIENCE).map_err(io::Error::other)?;
    reply(stream, "200 OK", "application/json", &said)
}

fn reply(mut stream: &TcpStream, status: &str, kind: &str, body: &str) -> io::Result<()> {
    let length = body.len();
    let head = format!(
        "HTTP/1.1 {status}\r\nContent-Type: {kind}\r\nContent-Length: {length}\r\nConnection: close\r\n\r\n"
    );
    stream.write_all(head.as_bytes())?;
    stream.write_all(body.as_bytes())
}
