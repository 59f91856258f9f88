//! The report in a real browser: quiet, alone, readable on a telephone and on a desk, by day and by night.
//!
//! Talks to Chromium by its `DevTools` protocol over a pipe. Pictures of the pages stay in `BLUR_ARTEFACTS`, or else in
//! cargo's folder for tests.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a page that cannot be made or shown fails the test")]

mod common;

use std::env;
use std::fs;
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

use common::*;
use serde_json::{Value, json};

/// A tab of a browser. Commands go through `sh`, which gives the browser the pipes under the numbers that it expects.
struct Tab {
    browser: Child,
    input: ChildStdin,
    output: BufReader<ChildStdout>,
    session: Option<String>,
    next: u64,
    /// Everything that the browser told without being asked.
    events: Vec<Value>,
}

impl Tab {
    fn open(profile: &Path) -> Self {
        let chromium = env::var("BLUR_CHROMIUM").unwrap_or_else(|_| String::from("chromium"));
        let mut browser = Command::new("sh")
            .args(["-c", "exec \"$0\" \"$@\" 3<&0 4>&1 0</dev/null 1>&2", &chromium])
            .args(["--headless=new", "--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-extensions"])
            .args(["--disable-background-networking", "--disable-component-update", "--force-color-profile=srgb"])
            .arg(format!("--user-data-dir={}", profile.display()))
            .args(["--remote-debugging-pipe", "about:blank"])
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let (input, output) = (browser.stdin.take().unwrap(), BufReader::new(browser.stdout.take().unwrap()));
        let mut tab = Self { browser, input, output, session: None, next: 0, events: Vec::new() };
        let target = tab.ask("Target.createTarget", &json!({"url": "about:blank"}))["targetId"].clone();
        let attached = tab.ask("Target.attachToTarget", &json!({"targetId": target, "flatten": true}));
        tab.session = Some(attached["sessionId"].as_str().unwrap().to_owned());
        for domain in ["Page", "Runtime", "Log", "Network"] {
            tab.ask(&format!("{domain}.enable"), &json!({}));
        }
        tab
    }

    fn read(&mut self) -> Value {
        let mut message = Vec::new();
        self.output.read_until(0, &mut message).unwrap();
        assert_eq!(message.pop(), Some(0), "the browser has gone");
        serde_json::from_slice(&message).unwrap()
    }

    fn ask(&mut self, method: &str, parameters: &Value) -> Value {
        self.next += 1;
        let mut command = json!({"id": self.next, "method": method, "params": parameters});
        if let Some(session) = &self.session {
            command["sessionId"] = json!(session);
        }
        self.input.write_all(format!("{command}\0").as_bytes()).unwrap();
        loop {
            let message = self.read();
            if message["id"] == self.next {
                assert!(message["error"].is_null(), "{method}: {message}");
                return message["result"].clone();
            }
            self.events.push(message);
        }
    }

    fn go(&mut self, url: &str) {
        let loads = |events: &[Value]| events.iter().filter(|event| event["method"] == "Page.loadEventFired").count();
        let before = loads(&self.events);
        self.ask("Page.navigate", &json!({"url": url}));
        while loads(&self.events) == before {
            let message = self.read();
            self.events.push(message);
        }
    }

    fn evaluate(&mut self, expression: &str) -> Value {
        let result = self.ask("Runtime.evaluate", &json!({"expression": expression, "returnByValue": true}));
        assert!(result["exceptionDetails"].is_null(), "{result}");
        result["result"]["value"].clone()
    }

    fn show(&mut self, width: u32, scheme: &str) {
        let mobile = width < 600;
        let metrics =
            json!({"width": width, "height": 844, "deviceScaleFactor": if mobile { 2 } else { 1 }, "mobile": mobile});
        self.ask("Emulation.setDeviceMetricsOverride", &metrics);
        let features = json!([{"name": "prefers-color-scheme", "value": scheme}]);
        self.ask("Emulation.setEmulatedMedia", &json!({"features": features}));
    }

    /// The page in its whole length as a PNG.
    fn photograph(&mut self, width: u32) -> Vec<u8> {
        let height = self.evaluate("document.documentElement.scrollHeight").as_f64().unwrap();
        let clip = json!({"x": 0, "y": 0, "width": width, "height": height, "scale": 1});
        let shot = self.ask("Page.captureScreenshot", &json!({"captureBeyondViewport": true, "clip": clip}));
        decoded(shot["data"].as_str().unwrap())
    }

    fn close(mut self) -> Vec<Value> {
        self.session = None;
        self.ask("Browser.close", &json!({}));
        self.browser.wait().unwrap();
        std::mem::take(&mut self.events)
    }
}

/// RFC 4648.
fn decoded(text: &str) -> Vec<u8> {
    let digit = |c: u8| match c {
        b'A'..=b'Z' => c - b'A',
        b'a'..=b'z' => c - b'a' + 26,
        b'0'..=b'9' => c - b'0' + 52,
        b'+' => 62,
        _ => 63,
    };
    let text = text.trim_end_matches('=').as_bytes();
    let mut bytes = Vec::new();
    for chunk in text.chunks(4) {
        let group = chunk.iter().fold(0_u32, |group, &c| group << 6 | u32::from(digit(c))) << (6 * (4 - chunk.len()));
        bytes.extend(&group.to_be_bytes()[1..chunk.len()]);
    }
    bytes
}

fn artefacts() -> PathBuf {
    let folder =
        env::var_os("BLUR_ARTEFACTS").map_or_else(|| PathBuf::from(env!("CARGO_TARGET_TMPDIR")), PathBuf::from);
    let folder = folder.join("report");
    fs::create_dir_all(&folder).unwrap();
    folder
}

/// The contrast of every text with what lies behind it, by WCAG 2.1: those with too little. Words on photographs
/// have an outline of their own.
const FAINT: &str = r"(() => {
  const numbers = c => (c.match(/[\d.]+/g) || []).map(Number);
  const light = c => { const f = v => (v /= 255) <= .04045 ? v / 12.92 : ((v + .055) / 1.055) ** 2.4;
                       return .2126 * f(c[0]) + .7152 * f(c[1]) + .0722 * f(c[2]); };
  const behind = e => { for (; e; e = e.parentElement) { const c = numbers(getComputedStyle(e).backgroundColor);
                        if (c.length == 3 || c[3] > 0) return c; } return [255, 255, 255]; };
  const faint = [];
  for (const e of document.querySelectorAll('body *')) {
    if (![...e.childNodes].some(n => n.nodeType == 3 && n.data.trim())) continue;
    const style = getComputedStyle(e);
    const text = light(numbers(e.closest('svg') ? style.fill : style.color)), back = light(behind(e));
    const ratio = (Math.max(text, back) + .05) / (Math.min(text, back) + .05);
    const large = parseFloat(style.fontSize) >= 24;
    if (ratio < (large ? 3 : 4.5) && !e.closest('.missing .value, .photo')) faint.push(e.textContent.slice(0, 40) + ' ' + ratio);
  }
  return faint;
})()";

/// Texts of charts that are smaller than this on the screen, in CSS pixels.
const SMALL: &str = "[...document.querySelectorAll('svg text')].map(e =>
  [e.textContent, parseFloat(getComputedStyle(e).fontSize) * Math.hypot(e.getScreenCTM().a, e.getScreenCTM().b)]).filter(e => e[1] < 9.5)";

/// Marks of an axis that touch each other, and texts that are cut off.
const CROWDED: &str = "[...document.querySelectorAll('svg.chart')].flatMap(svg => {
  const frame = svg.getBoundingClientRect();
  const boxes = [...svg.querySelectorAll('text')].map(e => [e.textContent, e.getBoundingClientRect()]);
  const bad = boxes.filter(([, b]) => b.left < frame.left - 1 || b.right > frame.right + 1
                                   || b.top < frame.top - 1 || b.bottom > frame.bottom + 1).map(b => 'cut: ' + b[0]);
  boxes.forEach(([a, p], i) => boxes.slice(i + 1).forEach(([b, q]) => {
    if (p.left < q.right && q.left < p.right && p.top < q.bottom && q.top < p.bottom) bad.push(a + ' on ' + b); }));
  return bad; })";

/// The edge between the picture before and after, in per cent of its width.
fn edge(tab: &mut Tab) -> f64 {
    tab.evaluate("parseFloat(getComputedStyle(document.querySelector('.compare')).getPropertyValue('--at'))")
        .as_f64()
        .unwrap()
}

fn assert_edge_follows_keys_and_fingers(tab: &mut Tab) {
    assert!((edge(tab) - 50.0).abs() < 0.1);
    tab.evaluate("document.querySelector('.compare input').focus()");
    for kind in ["keyDown", "keyUp"] {
        let key = json!({"type": kind, "key": "ArrowRight", "code": "ArrowRight", "windowsVirtualKeyCode": 39});
        tab.ask("Input.dispatchKeyEvent", &key);
    }
    assert!((edge(tab) - 51.0).abs() < 0.1, "a key moves it by one per cent");
    let place = "(e => { e.scrollIntoView({block: 'center'}); const b = e.getBoundingClientRect(); \
                 return [b.left, b.top, b.width]; })(document.querySelector('.compare img'))";
    let place = tab.evaluate(place);
    let [left, top, width] = [0, 1, 2].map(|i| place[i].as_f64().unwrap());
    tab.ask("Emulation.setTouchEmulationEnabled", &json!({"enabled": true}));
    for (kind, share) in [("touchStart", 0.5), ("touchMove", 0.4), ("touchMove", 0.3), ("touchMove", 0.2)] {
        let point = json!([{"x": left + share * width, "y": top + 20.0}]);
        tab.ask("Input.dispatchTouchEvent", &json!({"type": kind, "touchPoints": point}));
    }
    tab.ask("Input.dispatchTouchEvent", &json!({"type": "touchEnd", "touchPoints": []}));
    assert!((edge(tab) - 20.0).abs() < 1.0, "a finger takes it along: {}", edge(tab));
}

#[test]
#[ignore = "browser: needs Chromium, run by cargo xtask test"]
fn the_report_is_quiet_alone_and_readable_on_every_screen() {
    let artefacts = artefacts();
    let sample = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/sample.png");
    let photograph = env::var_os("BLUR_DATA").map(|data| Path::new(&data).join("real_photos/text_motion.jpg"));
    let pictures =
        photograph.into_iter().chain([PathBuf::from(sample), artefacts.join("there-is-no-such-picture.png")]);
    let output = estimate()
        .args(["--accel", "--exposure", "100ms", "--exposure-u", "0.5ms", "--scale", "0.7789mm/px", "--scale-u"])
        .args(["0.002mm/px", "--map", "128", "--report"])
        .arg(&artefacts)
        .args(pictures)
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));

    let page = artefacts.join("report.html").canonicalize().unwrap();
    let url = format!("file://{}", page.display());
    let mut tab = Tab::open(&folder("browser-profile"));
    for width in [390, 1280] {
        for scheme in ["light", "dark"] {
            tab.show(width, scheme);
            tab.go(&url);
            let shot = tab.photograph(width);
            fs::write(artefacts.join(format!("report-{width}-{scheme}.png")), shot).unwrap();
            let wide = tab.evaluate("document.documentElement.scrollWidth").as_u64().unwrap();
            assert!(wide <= u64::from(width), "{wide} pixels on a screen of {width}");
            for (what, expression) in [("faint", FAINT), ("small", SMALL), ("crowded", CROWDED)] {
                let found = tab.evaluate(expression);
                assert_eq!(found, json!([]), "{what} at {width} pixels, {scheme}");
            }
        }
    }
    let unnamed =
        tab.evaluate("[...document.querySelectorAll('svg svg, svg')].filter(e => !e.closest('[aria-label]')).length");
    assert_eq!(unnamed, 0, "figures without a description");
    let broken =
        tab.evaluate("[...document.querySelectorAll('a')].filter(a => !document.querySelector(a.hash)).length");
    assert_eq!(broken, 0, "links that lead nowhere");
    assert_edge_follows_keys_and_fingers(&mut tab);
    let printed = tab.ask("Page.printToPDF", &json!({"printBackground": true, "preferCSSPageSize": true}));
    fs::write(artefacts.join("report.pdf"), decoded(printed["data"].as_str().unwrap())).unwrap();

    let events = tab.close();
    for event in &events {
        match event["method"].as_str().unwrap_or_default() {
            "Runtime.consoleAPICalled" | "Runtime.exceptionThrown" | "Log.entryAdded" => panic!("not quiet: {event}"),
            "Network.requestWillBeSent" => {
                let asked = event["params"]["request"]["url"].as_str().unwrap();
                assert!(asked == url || asked.starts_with("data:"), "asks for {asked}");
            }
            _ => {}
        }
    }
    assert!(events.iter().any(|event| event["params"]["request"]["url"] == url), "no request was seen at all");
}
