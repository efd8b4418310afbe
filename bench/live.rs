//! How fast `lunula live` is as a whole process: from a row that is written to it to the row that it answers, beside a
//! thread that hands the same bytes back (the control: what the machine itself takes), and with a page that is
//! pestered; how much of a core several fingers or a fast one take; how its memory grows.
//!
//! `cargo bench -p lunula-cli --bench live -- [SECONDS] [ROWS]`: seconds of each latency (5), rows for memory (2
//! million). Linux only: it reads `/proc`.

use std::fs::File;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::channel;
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

const LUNULA: &str = env!("CARGO_BIN_EXE_lunula");
const NAMES: &str = "time_s,P1,P2,P3,P4,P5,P6,P7,P8\n";
const VOLTS: &str = "3.4123,3.9456,3.4012,2.9321,3.4444,2.9111,3.5001,3.1017\n";

/// Both ends of something that answers a line with a line.
struct Link {
    to: Box<dyn Write + Send>,
    from: Box<dyn Read + Send>,
    child: Option<Child>,
    /// The control thread, which ends with its input.
    thread: Option<JoinHandle<()>>,
}

fn main() {
    let mut arguments = std::env::args().skip(1).filter(|one| !one.starts_with("--"));
    let seconds = arguments.next().map_or(5.0, |text| text.parse().expect("seconds"));
    let rows: u64 = arguments.next().map_or(2_000_000, |text| text.parse().expect("rows"));
    let dir = tempfile::tempdir().expect("a folder");
    prepare(dir.path());
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    println!("{cores} cores; microseconds from a row written to its answer, 1000 rows a second for {seconds} s");
    println!("{:<10} {:<6} {:<8} {:>8} {:>8} {:>8} {:>8}", "load", "link", "who", "p50", "p99", "p99.9", "max");
    for load in [0, 4 * cores] {
        let busy = busy(load);
        for (link, pair) in [("pipe", [control_pipe as fn(&Path) -> Link, live_pipe]), ("tcp", [control_tcp, live_tcp])]
        {
            let page = (link == "tcp").then_some(("page", live_page as fn(&Path) -> Link));
            for (who, open) in [("control", pair[0]), ("lunula", pair[1])].into_iter().chain(page) {
                let [p50, p99, p999, max] = latency(open(dir.path()), seconds);
                println!("{load:<10} {link:<6} {who:<8} {p50:>8.0} {p99:>8.0} {p999:>8.0} {max:>8.0}");
            }
        }
        busy.stop();
    }
    rates(dir.path(), seconds);
    memory(dir.path(), rows);
}

/// A model of forces, and a switch.
fn prepare(dir: &Path) {
    let run = |arguments: &[&str]| {
        let status = Command::new(LUNULA).args(arguments).current_dir(dir).stdout(Stdio::null()).status();
        assert!(status.expect("the binary runs").success(), "{arguments:?}");
    };
    run(&["phantom", "log", "--protocol", "touch", "--seconds", "60", "--seed", "1", "--out", "scene", "-q"]);
    run(&["train", "scene/log.csv", "--target", "force", "--model", "linear", "--out", "force.json", "-q"]);
    std::fs::write(dir.join("s.toml"), "on_N = 0.5\noff_N = 0.3\nwatchdog_s = 0.5\n").expect("a file");
}

fn live(dir: &Path, source: &str) -> Child {
    live_with(dir, source, &[], Stdio::null())
}

fn live_with(dir: &Path, source: &str, more: &[&str], said: Stdio) -> Child {
    let fixed = ["--model", "force.json", "--switch", "s.toml", "-q"];
    let mut command = Command::new(LUNULA);
    command.args(["live", "--source", source]).args(fixed).args(more).current_dir(dir);
    command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(said).spawn().expect("the binary runs")
}

fn live_pipe(dir: &Path) -> Link {
    let mut child = live(dir, "-");
    let (to, from) = (child.stdin.take().expect("a pipe"), child.stdout.take().expect("a pipe"));
    Link { to: Box::new(to), from: Box::new(from), child: Some(child), thread: None }
}

fn live_tcp(dir: &Path) -> Link {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
    let mut child = live(dir, &format!("tcp:{}?once", listener.local_addr().expect("an address")));
    let (to, _) = listener.accept().expect("it connects");
    to.set_nodelay(true).expect("a socket");
    let from = child.stdout.take().expect("a pipe");
    Link { to: Box::new(to), from: Box::new(from), child: Some(child), thread: None }
}

/// As [`live_tcp`], with its page: a thousand connections that never ask, one that does not read, and one that sends
/// ten gigabytes again and again.
fn live_page(dir: &Path) -> Link {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
    let source = format!("tcp:{}?once", listener.local_addr().expect("an address"));
    let mut child = live_with(dir, &source, &["--serve"], Stdio::piped());
    let mut said = BufReader::new(child.stderr.take().expect("a pipe")).lines();
    let page = said.find_map(|line| line.ok()?.strip_prefix("page: http://").map(str::to_owned)).expect("an address");
    let (at, token) = page.split_once("/#").expect("an address");
    let mut watchers: Vec<TcpStream> = (0..1000).filter_map(|_| TcpStream::connect(at).ok()).collect();
    let mut asleep = TcpStream::connect(at).expect("it listens");
    write!(asleep, "GET /api/live HTTP/1.1\r\nHost: {at}\r\nAuthorization: Bearer {token}\r\n\r\n").expect("it reads");
    watchers.push(asleep);
    let (at, head) = (at.to_owned(), format!("POST /api/session HTTP/1.1\r\nHost: {at}\r\nOrigin: http://{at}\r\n"));
    std::thread::spawn(move || {
        while let Ok(mut large) = TcpStream::connect(&at) {
            let mut sent = write!(large, "{head}Content-Length: 10000000000\r\n\r\n");
            while sent.is_ok() {
                sent = large.write_all(&[0; 1 << 16]);
                std::thread::sleep(Duration::from_millis(1));
            }
        }
    });
    let (to, _) = listener.accept().expect("it connects");
    to.set_nodelay(true).expect("a socket");
    let from = child.stdout.take().expect("a pipe");
    // They stay until the program is gone.
    let thread = std::thread::spawn(move || {
        said.for_each(drop);
        drop(watchers);
    });
    Link { to: Box::new(to), from: Box::new(from), child: Some(child), thread: Some(thread) }
}

/// Hands back what comes, and hears nothing of what it is.
fn echo(mut from: impl Read + Send + 'static, mut to: impl Write + Send + 'static) -> JoinHandle<()> {
    std::thread::spawn(move || {
        let mut bytes = [0; 4096];
        while let Ok(count @ 1..) = from.read(&mut bytes) {
            if to.write_all(&bytes[..count]).is_err() {
                return;
            }
        }
    })
}

fn control_pipe(_: &Path) -> Link {
    let (there, to) = std::io::pipe().expect("a pipe");
    let (from, back) = std::io::pipe().expect("a pipe");
    Link { to: Box::new(to), from: Box::new(from), child: None, thread: Some(echo(there, back)) }
}

fn control_tcp(_: &Path) -> Link {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
    let there = TcpStream::connect(listener.local_addr().expect("an address")).expect("it listens");
    let (to, _) = listener.accept().expect("it connects");
    to.set_nodelay(true).expect("a socket");
    let (from, back) = std::io::pipe().expect("a pipe");
    Link { to: Box::new(to), from: Box::new(from), child: None, thread: Some(echo(there, back)) }
}

/// Percentiles of the time from a row to its answer, microseconds.
fn latency(link: Link, seconds: f64) -> [f64; 4] {
    let Link { mut to, from, child, thread } = link;
    let rows = (1000.0 * seconds) as usize;
    let (begins, begun) = channel();
    let reader = std::thread::spawn(move || {
        let mut lines = BufReader::new(from).lines();
        lines.next();
        begins.send(()).expect("somebody waits");
        lines.take(rows).map(|_| Instant::now()).collect::<Vec<_>>()
    });
    to.write_all(NAMES.as_bytes()).expect("it reads");
    // A process takes its time to begin, on a busy machine most of all.
    begun.recv().expect("an answer to the names");
    std::thread::sleep(Duration::from_millis(300));
    let begin = Instant::now();
    let mut written = Vec::with_capacity(rows);
    for k in 0..rows {
        let due = begin + Duration::from_millis(k as u64);
        std::thread::sleep(due.saturating_duration_since(Instant::now()));
        let row = format!("{:.3},{VOLTS}", 0.001 * k as f64);
        written.push(Instant::now());
        to.write_all(row.as_bytes()).expect("it reads");
    }
    drop(to);
    let answered = reader.join().expect("the reader");
    assert_eq!(answered.len(), rows, "every row is answered");
    let mut us: Vec<f64> =
        answered.iter().zip(&written).map(|(a, w)| 1e6 * a.duration_since(*w).as_secs_f64()).collect();
    us.sort_by(f64::total_cmp);
    if let Some(mut child) = child {
        child.wait().expect("a child");
    }
    if let Some(thread) = thread {
        thread.join().expect("the control");
    }
    [0.5, 0.99, 0.999, 1.0].map(|share| us[((share * rows as f64) as usize).min(rows - 1)])
}

/// Threads that do nothing but compute.
struct Busy(Arc<AtomicBool>, Vec<JoinHandle<()>>);

fn busy(threads: usize) -> Busy {
    let stop = Arc::new(AtomicBool::new(false));
    let one = || {
        let stop = Arc::clone(&stop);
        std::thread::spawn(move || {
            let mut x = 1_u64;
            while !stop.load(Ordering::Relaxed) {
                (0..10_000).for_each(|_| x = std::hint::black_box(x.wrapping_mul(6_364_136_223_846_793_005)));
            }
        })
    };
    let all = (0..threads).map(|_| one()).collect();
    Busy(stop, all)
}

impl Busy {
    fn stop(self) {
        self.0.store(true, Ordering::Relaxed);
        self.1.into_iter().for_each(|thread| thread.join().expect("a thread"));
    }
}

/// Seconds of a processor that a process has used.
fn used_s(child: &Child) -> f64 {
    let stat = std::fs::read_to_string(format!("/proc/{}/stat", child.id())).expect("Linux");
    let after = stat.rsplit_once(')').map_or("", |(_, after)| after);
    let ticks: u64 = after.split_whitespace().skip(11).take(2).filter_map(|one| one.parse::<u64>().ok()).sum();
    // 100 a second on every Linux.
    ticks as f64 / 100.0
}

fn resident_kb(child: &Child) -> u64 {
    let status = std::fs::read_to_string(format!("/proc/{}/status", child.id())).expect("Linux");
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:")).expect("Linux");
    line.split_whitespace().next().and_then(|kb| kb.parse().ok()).expect("a number")
}

/// The share of a core that fast streams take.
fn rates(dir: &Path, seconds: f64) {
    let listeners: Vec<TcpListener> = (0..10).map(|_| TcpListener::bind("127.0.0.1:0").expect("a port")).collect();
    let mut command = Command::new(LUNULA);
    command.args(["live", "--model", "force.json", "-q"]).current_dir(dir);
    for (k, listener) in listeners.iter().enumerate() {
        command.arg("--source").arg(format!("f{k}=tcp:{}?once", listener.local_addr().expect("an address")));
    }
    let child = command.stdout(Stdio::piped()).stderr(Stdio::null()).spawn().expect("the binary runs");
    let mut to: Vec<TcpStream> = listeners.iter().map(|listener| listener.accept().expect("it connects").0).collect();
    to.iter().for_each(|one| one.set_nodelay(true).expect("a socket"));
    share(
        child,
        "ten fingers of 8 photodiodes at 1 kHz, TCP",
        1000.0,
        seconds,
        move |text| {
            to.iter_mut().for_each(|one| one.write_all(text.as_bytes()).expect("it reads"));
        },
        10,
    );
    let mut child = live(dir, "-");
    let mut to = child.stdin.take().expect("a pipe");
    share(
        child,
        "one finger at 20 kHz, pipe",
        20_000.0,
        seconds,
        move |text| {
            to.write_all(text.as_bytes()).expect("it reads");
        },
        1,
    );
}

/// Rows are written once a millisecond, as many as are due.
fn share(mut child: Child, what: &str, rate_hz: f64, seconds: f64, mut write: impl FnMut(&str), fingers: usize) {
    let out = child.stdout.take().expect("a pipe");
    let answers = std::thread::spawn(move || BufReader::new(out).lines().count());
    write(NAMES);
    std::thread::sleep(Duration::from_millis(300));
    let (begin, before_s) = (Instant::now(), used_s(&child));
    let mut sent = 0;
    while begin.elapsed().as_secs_f64() < seconds {
        let due = (rate_hz * begin.elapsed().as_secs_f64()) as u64;
        let text: String = (sent..due).map(|k| format!("{:.6},{VOLTS}", k as f64 / rate_hz)).collect();
        sent = sent.max(due);
        write(&text);
        std::thread::sleep(Duration::from_millis(1));
    }
    let (took_s, used_s) = (begin.elapsed().as_secs_f64(), used_s(&child) - before_s);
    drop(write);
    let _ = child.wait();
    let answered = answers.join().expect("the reader") - 1;
    println!(
        "{what}: {:.1} % of a core, {answered} of {} rows answered",
        100.0 * used_s / took_s,
        sent * fingers as u64
    );
}

/// How memory grows from a quarter of the rows to their end.
fn memory(dir: &Path, rows: u64) {
    let mut child = live(dir, "-");
    let mut to = std::io::BufWriter::with_capacity(1 << 16, child.stdin.take().expect("a pipe"));
    let mut out = child.stdout.take().expect("a pipe");
    let answers = std::thread::spawn(move || std::io::copy(&mut out, &mut File::create("/dev/null").expect("a file")));
    to.write_all(NAMES.as_bytes()).expect("it reads");
    let (begin, mut early_kb) = (Instant::now(), 0);
    for k in 0..rows {
        write!(to, "{:.3},{VOLTS}", 0.001 * k as f64).expect("it reads");
        if k == rows / 4 {
            early_kb = resident_kb(&child);
        }
    }
    to.flush().expect("it reads");
    let late_kb = resident_kb(&child);
    drop(to);
    let _ = (child.wait(), answers.join());
    println!(
        "{rows} rows as fast as they go: {:.2} us each, {late_kb} kB resident, {} kB more than at a quarter of them",
        1e6 * begin.elapsed().as_secs_f64() / rows as f64,
        late_kb as i64 - early_kb as i64
    );
}
