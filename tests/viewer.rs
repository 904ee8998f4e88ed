//! `wisdom view` and `wisdom report`: what is served, to whom, and what is in the page that is written.

use std::collections::BTreeSet;
use std::fs;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde_json::Value;
use wisdom_logbook::{LogReader, Reel, derive_at, plane};

fn sample(version: u32) -> PathBuf {
    let name = format!("logs/sample/paper-decisions-{version}.mcap");
    Path::new(env!("CARGO_MANIFEST_DIR")).join(name)
}

fn wisdom(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_wisdom")).args(arguments).output().expect("the command runs")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).expect("text")
}

/// A server that ends with the test.
struct Served {
    child: Child,
    port: u16,
    folder: String,
}

impl Drop for Served {
    fn drop(&mut self) {
        self.child.kill().ok();
        self.child.wait().ok();
    }
}

struct Answer {
    status: u16,
    headers: String,
    body: Vec<u8>,
}

impl Answer {
    fn json(&self) -> Value {
        serde_json::from_slice(&self.body).unwrap_or_else(|e| panic!("{e}: {}", self.headers))
    }
}

impl Served {
    fn new(logs: &[&Path]) -> Self {
        let mut child = Command::new(env!("CARGO_BIN_EXE_wisdom"))
            .args(["view", "--no-open", "--json"])
            .args(logs)
            .stdout(Stdio::piped())
            .spawn()
            .expect("the command runs");
        let mut line = String::new();
        let out = child.stdout.take().expect("piped");
        BufReader::new(out).read_line(&mut line).expect("it says where it is");
        let told: Value = serde_json::from_str(&line).expect("JSON");
        let address = told["address"].as_str().expect("an address");
        let (host, folder) =
            address.strip_prefix("http://").and_then(|rest| rest.split_once('/')).expect("http");
        let port = host.strip_prefix("127.0.0.1:").expect("loopback alone").parse().expect("port");
        Self { child, port, folder: format!("/{folder}") }
    }

    fn ask(&self, request: &str) -> Answer {
        let mut stream = TcpStream::connect(("127.0.0.1", self.port)).expect("it listens");
        stream.write_all(request.as_bytes()).expect("it takes the request");
        let mut all = Vec::new();
        stream.read_to_end(&mut all).expect("it answers");
        let end = all.windows(4).position(|four| four == b"\r\n\r\n").expect("a head");
        let headers = text(&all[..end]).to_lowercase();
        let status = headers.split(' ').nth(1).and_then(|s| s.parse().ok()).expect("a status");
        Answer { status, headers, body: all[end + 4..].to_vec() }
    }

    fn get_with(&self, path: &str, more: &str) -> Answer {
        let host = format!("127.0.0.1:{}", self.port);
        self.ask(&format!("GET {path} HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\n{more}\r\n"))
    }

    fn get(&self, path: &str) -> Answer {
        self.get_with(&format!("{}{path}", self.folder), "")
    }
}

/// Numbers of a plane as it is served: row, column, rows, columns, values.
fn served_plane(bytes: &[u8]) -> ([u32; 4], Vec<f32>) {
    let words: Vec<[u8; 4]> = bytes.chunks_exact(4).map(|c| c.try_into().expect("four")).collect();
    let (place, values) = words.split_at(4);
    let place = [0, 1, 2, 3].map(|i| u32::from_le_bytes(place[i]));
    (place, values.iter().map(|word| f32::from_le_bytes(*word)).collect())
}

#[test]
fn the_page_and_both_logs_are_served_whole_and_in_parts() {
    let (a, b) = (sample(5), sample(4));
    let served = Served::new(&[&a, &b]);
    let page = text(&served.get("").body);
    assert!(page.starts_with("<!doctype html>"));
    let told = page.split(r#"id="served">"#).nth(1).and_then(|rest| rest.split('<').next());
    let told: Value = serde_json::from_str(told.expect("it tells the page")).expect("JSON");
    assert_eq!(told["a"]["name"], "paper-decisions-5.mcap");
    for (slot, path) in [("a", &a), ("b", &b)] {
        let bytes = fs::read(path).expect("a log");
        let address = told[slot]["log"].as_str().expect("an address");
        assert!(served.get(address).body == bytes, "{slot}");
        let log = format!("{}{address}", served.folder);
        let part = served.get_with(&log, "Range: bytes=100-199\r\n");
        assert_eq!((part.status, &part.body[..]), (206, &bytes[100..200]));
        let range = format!("content-range: bytes 100-199/{}", bytes.len());
        assert!(part.headers.contains(&range), "{}", part.headers);
        assert!(part.headers.contains("cache-control: no-store"), "{}", part.headers);
    }
}

#[test]
fn nobody_else_is_answered() {
    let served = Served::new(&[&sample(5)]);
    assert_eq!(served.get("").status, 200);
    // Without the token, and by a name that a page from elsewhere could have pointed here.
    assert_eq!(served.get_with("/", "").status, 404);
    assert_eq!(served.get_with("/a/log", "").status, 404);
    let asked = |host: &str, method: &str| {
        let folder = &served.folder;
        let request =
            format!("{method} {folder} HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\n\r\n");
        served.ask(&request).status
    };
    let own = format!("127.0.0.1:{}", served.port);
    assert_eq!(asked(&own, "GET"), 200);
    assert_eq!(asked(&format!("localhost:{}", served.port), "GET"), 200);
    for host in ["example.org", "127.0.0.1", "", "127.0.0.1:1"] {
        assert_eq!(asked(host, "GET"), 421, "{host}");
    }
    for method in ["POST", "PUT", "DELETE", "OPTIONS"] {
        assert_eq!(asked(&own, method), 405, "{method}");
    }
    assert_eq!(served.get("../../etc/passwd").status, 404);
}

#[test]
fn what_is_made_again_is_what_the_decision_used() {
    let path = sample(5);
    let served = Served::new(&[&path]);
    let log = LogReader::open(&path).expect("a log");
    let index = served.get("a/derived/index").json();
    let names: Vec<&str> = index["planes"]
        .as_array()
        .expect("planes")
        .iter()
        .filter_map(|p| p["name"].as_str())
        .collect();
    assert_eq!(index["experts"], serde_json::json!(["dem", "temperature", "texture"]));
    // Back and forth: the server keeps some decisions and goes on from them.
    for number in [3, 0, 4] {
        let past = derive_at(&log, number).expect("it follows").expect("it is there");
        for name in &names {
            let answer = served.get(&format!("a/derived/plane/{number}/{name}"));
            let (place, values) = served_plane(&answer.body);
            let derived = plane(&past.rover, name).expect("a plane");
            assert_eq!(place, [0, 0, 101, 101], "{name}");
            assert!(values == derived.values(), "{name} of decision {number}");
        }
        let cell = served.get(&format!("a/derived/cell/{number}/40/70")).json();
        let here = wisdom_grid::Cell::new(40, 70);
        for (name, value) in cell["planes"].as_object().expect("planes") {
            let derived = plane(&past.rover, name).expect("a plane")[here];
            assert_eq!(value.as_f64(), Some(f64::from(derived)), "{name}");
        }
        let evidence = &past.maps().evidence;
        let credits = wisdom_fusion::credit(evidence, &past.rover.spec().fusion, here);
        for ((expert, told), credit) in
            evidence.experts().zip(cell["experts"].as_array().expect("experts")).zip(credits)
        {
            assert_eq!(
                (told["name"].as_str(), told["credit"].as_f64()),
                (Some(expert.0), Some(credit))
            );
            let masses = ["interesting", "not_interesting", "ignorance", "paradox"]
                .map(|kind| told["masses"][kind].as_f64().expect("a mass"));
            assert_eq!(masses, expert.1[here].masses());
        }
        let plans = served.get(&format!("a/derived/family/{number}")).json();
        let plans = plans["plans"].as_array().expect("plans").clone();
        assert_eq!(plans.len(), past.decision.family.len());
        for (told, option) in plans.iter().zip(&past.decision.family) {
            let cells = told["cells"].as_array().expect("cells");
            let legs = option.plan.legs.iter().map(|leg| leg.route.cells.len() - 1).sum::<usize>();
            assert_eq!(cells.len(), legs + 1, "legs meet, and the meeting cell is told once");
        }
    }
}

#[test]
fn price_tags_are_those_that_explain_prints() {
    let path = sample(5);
    let served = Served::new(&[&path]);
    let told = served.get("a/derived/prices/2").json();
    let explained = wisdom(&["explain", path.to_str().expect("text"), "--decision", "2", "--json"]);
    let explained: Value = serde_json::from_slice(&explained.stdout).expect("JSON");
    assert!(!told["left_out"].as_array().expect("goals").is_empty());
    assert_eq!(told["left_out"], explained["left_out"]);
    assert!(told["limits"]["energy_j"].is_number() && told["limits"] == explained["limits"]);
}

#[test]
fn a_log_that_cannot_be_derived_is_served_all_the_same_and_says_why() {
    let folder = tempfile::tempdir().expect("a folder");
    let cut = folder.path().join("cut.mcap");
    let bytes = fs::read(sample(5)).expect("the sample");
    fs::write(&cut, &bytes[..200]).expect("room");
    for (path, why) in [(sample(4), "version 4"), (cut, "mission")] {
        let served = Served::new(&[&path]);
        assert!(served.get("a/log").body == fs::read(&path).expect("a log"));
        let index = served.get("a/derived/index");
        let told = index.json()["unavailable"].as_str().expect("why").to_owned();
        assert!(index.status == 200 && told.contains(why), "{told}");
        assert_eq!(served.get("a/derived/plane/0/ignorance").status, 422);
    }
}

#[test]
fn mistakes_are_told_before_anything_is_served_or_written() {
    let folder = tempfile::tempdir().expect("a folder");
    let notes = folder.path().join("notes.html");
    fs::write(&notes, "<p>mine</p>").expect("room");
    let (log, notes_at) = (sample(5), notes.to_str().expect("text").to_owned());
    let log = log.to_str().expect("text");
    let new = folder.path().join("new.html");
    let new_at = new.to_str().expect("text");
    let cases: [(&[&str], &str); 7] = [
        (&["view", "no-such.mcap"], "no-such.mcap"),
        (&["view", &notes_at], "is not an MCAP file"),
        (&["report", log, "--html", &notes_at], "is there already"),
        (&["report", log, "--html", "run.txt"], "ends in .html"),
        (&["report", log, "--html", new_at, "--planes", "ignorence"], "`ignorence`"),
        (&["report", log, "--html", new_at, "--prices", "77"], "--prices 77"),
        (&["report", log, &notes_at, "--html", new_at], "is not an MCAP file"),
    ];
    for (arguments, told) in cases {
        let output = wisdom(arguments);
        let error = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {error}");
        assert!(error.contains(told), "{error}");
    }
    assert!(!new.exists() && fs::read(&notes).expect("still there") == b"<p>mine</p>");
}

/// What is in an element of a page, by its id.
fn element<'a>(page: &'a str, id: &str) -> Option<&'a str> {
    let from = page.find(&format!(r#"id="{id}""#))?;
    let body = &page[from..];
    body.split_once('>')?.1.split_once('<').map(|(inside, _)| inside)
}

fn decoded(base64: &str) -> Vec<u8> {
    STANDARD.decode(base64).expect("base64")
}

#[test]
fn a_report_holds_the_logs_byte_for_byte_and_may_be_written_again() {
    let folder = tempfile::tempdir().expect("a folder");
    let html = folder.path().join("both.html");
    let (a, b) = (sample(5), sample(4));
    for _ in 0..2 {
        let output = Command::new(env!("CARGO_BIN_EXE_wisdom"))
            .arg("report")
            .args([&a, &b])
            .arg("--html")
            .arg(&html)
            .output()
            .expect("the command runs");
        assert!(output.status.success(), "{}", text(&output.stderr));
    }
    let page = fs::read_to_string(&html).expect("a page");
    assert!(decoded(element(&page, "log").expect("the first")) == fs::read(&a).expect("a log"));
    assert!(decoded(element(&page, "log-b").expect("the second")) == fs::read(&b).expect("a log"));
    assert!(element(&page, "derived").is_none() && element(&page, "served").is_none());
    let beside: Vec<_> = fs::read_dir(folder.path()).expect("a folder").collect();
    assert_eq!(beside.len(), 1, "nothing but the page is left: {beside:?}");
}

/// The page of a report with further things inside, and how the command ended.
fn report(folder: &Path, logs: &[&Path], more: &[&str]) -> (String, Output) {
    let html = folder.join("report.html");
    let output = Command::new(env!("CARGO_BIN_EXE_wisdom"))
        .arg("report")
        .args(logs)
        .arg("--html")
        .arg(&html)
        .args(more)
        .output()
        .expect("the command runs");
    (fs::read_to_string(&html).expect("a page"), output)
}

#[test]
fn what_is_asked_for_goes_beside_the_log_and_the_log_stays_as_it_is() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = sample(5);
    let more = ["--planes", "credit-dem,reliability", "--families", "--prices", "1"];
    let (page, output) = report(folder.path(), &[&path], &more);
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert!(decoded(element(&page, "log").expect("the log")) == fs::read(&path).expect("a log"));
    let beside = folder.path().join("planes.mcap");
    fs::write(&beside, decoded(element(&page, "planes").expect("the planes"))).expect("room");
    let (log, planes) = (LogReader::open(&path).expect("a log"), LogReader::open(&beside));
    let planes = planes.expect("a log");
    assert_eq!(planes.decisions().count(), 0);
    let topics: BTreeSet<&str> = planes.maps().map(|(_, topic)| topic).collect();
    assert!(topics.iter().all(|topic| topic.contains("credit-dem") || topic.contains("reliab")));
    for number in 0..log.decisions().count() as u32 {
        let past = derive_at(&log, number).expect("it follows").expect("it is there");
        for name in ["credit-dem", "reliability"] {
            let mut reel = Reel::of(name);
            let logged = reel.turn_to(&planes, number).expect("it fits").expect("asked for");
            assert!(*logged == *plane(&past.rover, name).expect("a plane"), "{name} of {number}");
        }
    }
    let more: Value =
        serde_json::from_str(element(&page, "derived").expect("the rest")).expect("JSON");
    let more = &more["a"];
    assert_eq!(more["families"].as_object().expect("families").len(), log.decisions().count());
    let priced: Vec<&String> = more["prices"].as_object().expect("prices").keys().collect();
    assert_eq!(priced, ["1"]);
    let planes = more["index"]["planes"].as_array().expect("planes");
    let names: Vec<_> = planes.iter().filter_map(|plane| plane["name"].as_str()).collect();
    assert_eq!(names, ["reliability", "credit-dem"]);
}

#[test]
fn a_report_of_a_log_that_is_not_whole_holds_it_as_it_is_and_says_so() {
    let folder = tempfile::tempdir().expect("a folder");
    let bytes = fs::read(sample(5)).expect("the sample");
    let cut = folder.path().join("cut.mcap");
    fs::write(&cut, &bytes[..bytes.len() * 2 / 3]).expect("room");
    let flipped = folder.path().join("flipped.mcap");
    let mut wrong = bytes.clone();
    wrong[bytes.len() / 2] ^= 1;
    fs::write(&flipped, &wrong).expect("room");
    for (log, code) in [(&cut, 3), (&flipped, 1)] {
        for more in [&[][..], &["--planes", "ignorance", "--families"][..]] {
            let (page, output) = report(folder.path(), &[log], more);
            assert_eq!(output.status.code(), Some(code), "{}", text(&output.stderr));
            let inside = decoded(element(&page, "log").expect("the log"));
            assert!(inside == fs::read(log).expect("a log"), "{more:?}");
            assert_eq!(element(&page, "planes").is_some(), !more.is_empty());
        }
    }
}

#[test]
fn of_two_logs_the_one_that_cannot_be_derived_is_put_in_without_planes() {
    let folder = tempfile::tempdir().expect("a folder");
    let (a, b) = (sample(5), sample(4));
    let (page, output) = report(folder.path(), &[&a, &b], &["--planes", "ignorance"]);
    assert_eq!(output.status.code(), Some(3), "{}", text(&output.stderr));
    assert!(text(&output.stderr).contains("version 4"), "{}", text(&output.stderr));
    assert!(decoded(element(&page, "log-b").expect("it is there")) == fs::read(&b).expect("a log"));
    assert!(element(&page, "planes").is_some() && element(&page, "planes-b").is_none());
    let more: Value =
        serde_json::from_str(element(&page, "derived").expect("the rest")).expect("JSON");
    assert!(more["b"]["index"]["unavailable"].as_str().is_some_and(|why| why.contains("version")));
}

#[test]
fn a_log_that_grows_and_gets_its_name_is_served_on() {
    let folder = tempfile::tempdir().expect("a folder");
    let bytes = fs::read(sample(5)).expect("the sample");
    let (part, whole) = (folder.path().join("run.mcap.part"), folder.path().join("run.mcap"));
    fs::write(&part, &bytes[..bytes.len() / 2]).expect("room");
    let served = Served::new(&[&part]);
    assert_eq!(served.get("a/derived/family/0").status, 200);
    assert_eq!(served.get("a/derived/family/4").status, 404);
    fs::write(&part, &bytes).expect("room");
    assert_eq!(served.get("a/derived/family/4").status, 200, "it has grown");
    fs::rename(&part, &whole).expect("it is renamed");
    assert!(served.get("a/log").body == bytes);
    assert_eq!(served.get("a/derived/family/3").status, 200);
}
