//! A browser of the Chromium family, driven by the DevTools protocol over a WebSocket of our own: nothing but the browser is needed.

#![allow(dead_code, reason = "each test file makes use of a part")]

use std::fs;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use serde_json::{Value, json};

/// No answer takes longer.
const PATIENCE: Duration = Duration::from_secs(60);

pub(crate) struct Browser {
    process: Child,
    socket: BufReader<TcpStream>,
    calls: u64,
    /// Everything that was said meanwhile: errors of scripts, messages of the console, requests.
    events: Vec<Value>,
    _profile: tempfile::TempDir,
}

/// A page that is open.
pub(crate) struct Tab<'b> {
    browser: &'b mut Browser,
    session: String,
    target: String,
}

/// The first browser of the Chromium family on the path.
fn program() -> Option<PathBuf> {
    let folders = std::env::var_os("PATH")?;
    let names = ["chromium", "chromium-browser", "google-chrome", "chrome"];
    std::env::split_paths(&folders)
        .flat_map(|folder| names.map(|name| folder.join(name)))
        .find(|path| path.is_file())
}

impl Browser {
    /// Starts one; `None`, with a message, if there is none. `options` are added to the command line.
    #[expect(clippy::disallowed_methods, reason = "waits for another program")]
    pub(crate) fn start(options: &[&str]) -> Option<Self> {
        let Some(program) = program() else {
            eprintln!(
                "skipped: no Chromium on the path, so the pages were not looked at; install the package chromium"
            );
            return None;
        };
        let profile = tempfile::tempdir().unwrap();
        let mut process = Command::new(program)
            .args([
                "--headless",
                "--no-sandbox",
                "--disable-gpu",
                "--disable-dev-shm-usage",
                "--disable-quic",
            ])
            .args([
                "--no-first-run",
                "--disable-background-networking",
                "--disable-component-update",
                "--disable-sync",
            ])
            .args([
                "--use-gl=angle",
                "--use-angle=swiftshader",
                "--enable-unsafe-swiftshader",
                "--window-size=1200,800",
            ])
            .args(options)
            .arg(format!("--user-data-dir={}", profile.path().display()))
            .args(["--remote-debugging-port=0", "about:blank"])
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let start = Instant::now();
        let place = profile.path().join("DevToolsActivePort");
        let (port, path) = loop {
            let text = fs::read_to_string(&place).unwrap_or_default();
            if let Some((port, path)) = text.trim().split_once('\n') {
                break (port.parse::<u16>().unwrap(), path.to_owned());
            }
            if start.elapsed() > PATIENCE {
                process.kill().ok();
                panic!("the browser does not start");
            }
            std::thread::sleep(Duration::from_millis(20));
        };
        Some(Self {
            process,
            socket: connect(port, &path),
            calls: 0,
            events: Vec::new(),
            _profile: profile,
        })
    }

    /// Opens a file and waits until its page is ready.
    pub(crate) fn open(&mut self, file: &Path) -> Tab<'_> {
        let mut tab = self.navigate(file);
        tab.run("new Promise(done => document.readyState === 'complete' ? done() : addEventListener('load', done)).then(() => window.ready).then(() => true)");
        tab
    }

    /// Begins to open a file.
    pub(crate) fn navigate(&mut self, file: &Path) -> Tab<'_> {
        let target =
            self.call("", "Target.createTarget", &json!({ "url": "about:blank" }))["targetId"].clone();
        let attached = self.call(
            "",
            "Target.attachToTarget",
            &json!({ "targetId": target, "flatten": true }),
        );
        let session = attached["sessionId"].as_str().unwrap().to_owned();
        for domain in ["Runtime", "Log", "Network", "Page"] {
            self.call(&session, &format!("{domain}.enable"), &json!({}));
        }
        self.events.clear();
        self.call(
            &session,
            "Page.navigate",
            &json!({ "url": format!("file://{}", file.display()) }),
        );
        Tab {
            browser: self,
            session,
            target: target.as_str().unwrap().to_owned(),
        }
    }

    fn call(&mut self, session: &str, method: &str, parameters: &Value) -> Value {
        self.calls += 1;
        let id = self.calls;
        let mut message = json!({ "id": id, "method": method, "params": parameters });
        if !session.is_empty() {
            message["sessionId"] = json!(session);
        }
        send(self.socket.get_mut(), message.to_string().as_bytes());
        loop {
            let said: Value = serde_json::from_slice(&receive(&mut self.socket)).unwrap();
            if said["id"] == json!(id) {
                assert!(said["error"].is_null(), "{method}: {said}");
                return said["result"].clone();
            }
            self.events.push(said);
        }
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        self.process.kill().ok();
        self.process.wait().ok();
    }
}

impl Tab<'_> {
    fn call(&mut self, method: &str, parameters: &Value) -> Value {
        self.browser.call(&self.session, method, parameters)
    }

    /// The value of an expression, or of what it promises.
    pub(crate) fn run(&mut self, expression: &str) -> Value {
        let asked = json!({ "expression": expression, "awaitPromise": true, "returnByValue": true });
        let said = self.call("Runtime.evaluate", &asked);
        assert!(said["exceptionDetails"].is_null(), "{expression}: {said}");
        said["result"]["value"].clone()
    }

    /// A click of the mouse, in pixels of the page.
    pub(crate) fn click(&mut self, x: f64, y: f64) {
        for kind in ["mousePressed", "mouseReleased"] {
            let event = json!({ "type": kind, "x": x, "y": y, "button": "left", "clickCount": 1 });
            self.call("Input.dispatchMouseEvent", &event);
        }
    }

    /// A key, such as `n`.
    pub(crate) fn press(&mut self, key: &str) {
        for kind in ["keyDown", "keyUp"] {
            self.call("Input.dispatchKeyEvent", &json!({ "type": kind, "key": key }));
        }
    }

    /// Errors so far, and requests for anything but the page itself.
    pub(crate) fn complaints(&mut self) -> Vec<String> {
        self.run("true");
        let events = self.browser.events.iter();
        let bad = events.filter(|event| match event["method"].as_str() {
            Some("Runtime.exceptionThrown") => true,
            Some("Runtime.consoleAPICalled") => event["params"]["type"] != "log",
            Some("Log.entryAdded") => event["params"]["entry"]["level"] == "error",
            Some("Network.requestWillBeSent") => event["params"]["type"] != "Document",
            _ => false,
        });
        bad.map(Value::to_string).collect()
    }
}

impl Drop for Tab<'_> {
    fn drop(&mut self) {
        if !std::thread::panicking() {
            let closed = json!({ "targetId": self.target });
            self.browser.call("", "Target.closeTarget", &closed);
        }
    }
}

/// Opens a WebSocket (RFC 6455).
fn connect(port: u16, path: &str) -> BufReader<TcpStream> {
    let mut stream = TcpStream::connect(("127.0.0.1", port)).unwrap();
    stream.set_read_timeout(Some(PATIENCE)).unwrap();
    write!(
        stream,
        "GET {path} HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n\
         Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\nSec-WebSocket-Version: 13\r\n\r\n"
    )
    .unwrap();
    let mut socket = BufReader::new(stream);
    let mut line = String::new();
    socket.read_line(&mut line).unwrap();
    assert!(line.contains(" 101 "), "{line}");
    while line.trim() != "" {
        line.clear();
        socket.read_line(&mut line).unwrap();
    }
    socket
}

/// One text frame; its mask is 0.
fn send(stream: &mut TcpStream, text: &[u8]) {
    let mut frame = vec![0x81, 0xff];
    frame.extend((text.len() as u64).to_be_bytes());
    frame.extend([0; 4]);
    frame.extend(text);
    stream.write_all(&frame).unwrap();
}

/// One message, of one frame or several.
fn receive(socket: &mut BufReader<TcpStream>) -> Vec<u8> {
    let mut message = Vec::new();
    loop {
        let mut head = [0; 2];
        socket
            .read_exact(&mut head)
            .expect("the browser answers within a minute");
        let length = match head[1] & 0x7f {
            126 => {
                let mut two = [0; 2];
                socket.read_exact(&mut two).unwrap();
                u64::from(u16::from_be_bytes(two))
            }
            127 => {
                let mut eight = [0; 8];
                socket.read_exact(&mut eight).unwrap();
                u64::from_be_bytes(eight)
            }
            short => u64::from(short),
        };
        let mut part = vec![0; usize::try_from(length).unwrap()];
        socket.read_exact(&mut part).unwrap();
        // Pings and pongs may come between the frames of a message.
        if head[0] & 0x0f < 8 {
            message.extend(part);
            if head[0] & 0x80 != 0 {
                return message;
            }
        }
    }
}
