//! How the node stands up to a load: `taskset -c 1 cargo run --release -p blur-ros --features node --example load`.
//!
//! Starts `blur-node`, which stands beside the examples, on one core (`taskset -c 0`) and publishes pictures of 640x480 pixels
//! to it as `rmw_zenoh_cpp` does: 30 a second, then 300 a second. Prints a line for each, with what the node reports and the
//! memory that it held.

use std::env;
use std::error::Error;
use std::fs;
use std::io::{BufRead, BufReader};
use std::net::TcpListener;
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
use std::thread;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use blur_ros::cdr::ByteOrder;
use blur_ros::msg::{Header, Image, Message, Time};
use blur_ros::node::rmw;
use clap::Parser;
use zenoh::{Config, Session, Wait};

const WIDTH: usize = 640;
const HEIGHT: usize = 480;
/// Pixels that the content moves during an exposure, to the right.
const LENGTH: usize = 12;
const TOPIC: &str = "/camera/image_raw";
/// Pictures that are published in turn.
const PICTURES: usize = 8;

/// Publishes pictures to a node and prints how it stands up to them.
#[derive(Parser)]
struct Args {
    /// Seconds for each rate
    #[arg(long, default_value_t = 60)]
    seconds: u64,
    /// Pictures a second
    #[arg(long, value_delimiter = ',', default_values_t = [30, 300])]
    rates: Vec<u32>,
    /// Core of the node
    #[arg(long, default_value_t = 0)]
    core: usize,
    /// Further options of the node
    #[arg(last = true)]
    options: Vec<String>,
}

fn main() -> Result<(), Box<dyn Error>> {
    let args = Args::parse();
    println!("640x480 mono8, node on core {}, {} s for each rate", args.core, args.seconds);
    println!("{:>6} {:>8} {:>22}  report of the node", "Hz", "sent", "resident MB first/most");
    for &rate in &args.rates {
        load(&args, rate)?;
    }
    Ok(())
}

fn load(args: &Args, rate: u32) -> Result<(), Box<dyn Error>> {
    let port = TcpListener::bind("127.0.0.1:0")?.local_addr()?.port();
    let endpoint = format!("tcp/127.0.0.1:{port}");
    let session = listen(&endpoint)?;
    let publisher =
        session.declare_publisher(rmw::topic_key(0, TOPIC, &Image::TYPE)).wait().map_err(|e| e.to_string())?;
    let mut node = Command::new("taskset")
        .args(["-c", &args.core.to_string()])
        .arg(program()?)
        .args(["--connect", &endpoint, "--domain", "0", "--report-s", "1000000"])
        .args(&args.options)
        .stderr(Stdio::piped())
        .spawn()?;
    while !publisher.matching_status().wait().map_err(|e| e.to_string())?.matching() {
        thread::sleep(Duration::from_millis(20));
    }
    let pictures: Vec<Vec<u8>> = (0..PICTURES).map(picture).collect();
    let (start, count) = (Instant::now(), u64::from(rate) * args.seconds);
    let mut resident = Vec::new();
    for number in 0..count {
        thread::sleep((start + Duration::from_secs(number) / rate).saturating_duration_since(Instant::now()));
        let now_ns = i64::try_from(SystemTime::now().duration_since(UNIX_EPOCH)?.as_nanos())?;
        let header = Header { stamp: Time::from_nanoseconds(now_ns), frame_id: "camera_optical" };
        let data = &pictures[number as usize % PICTURES];
        let image = Image {
            header,
            height: HEIGHT as u32,
            width: WIDTH as u32,
            encoding: "mono8",
            is_bigendian: false,
            step: WIDTH as u32,
            data,
        };
        let attachment = rmw::attachment(number as i64 + 1, now_ns, [1; 16]);
        let put = publisher.put(image.to_cdr(ByteOrder::Little)).attachment(attachment);
        put.wait().map_err(|error| error.to_string())?;
        // The first second is that of plans and buffers.
        if number % u64::from(rate) == u64::from(rate) - 1 {
            resident.push(resident_mb(&node)?);
        }
    }
    thread::sleep(Duration::from_secs(1));
    // The same signal as from a terminal or from systemd.
    Command::new("kill").args(["-TERM", &node.id().to_string()]).status()?;
    let report = node.stderr.take().into_iter().flat_map(|said| BufReader::new(said).lines().map_while(Result::ok));
    let report = report.filter(|line| line.contains("received")).last().unwrap_or_default();
    node.wait()?;
    session.close().wait().map_err(|error| error.to_string())?;
    let first = resident.first().copied().unwrap_or_default();
    let most = resident.iter().copied().fold(first, f64::max);
    println!("{rate:>6} {count:>8} {first:>13.1}/{most:<8.1}  {}", report.trim_start_matches("blur-node: "));
    Ok(())
}

fn listen(endpoint: &str) -> Result<Session, Box<dyn Error>> {
    let mut config = Config::default();
    for (key, value) in [
        ("mode", "\"peer\"".to_owned()),
        ("listen/endpoints", format!("[{endpoint:?}]")),
        ("scouting/multicast/enabled", "false".to_owned()),
    ] {
        config.insert_json5(key, &value).map_err(|error| error.to_string())?;
    }
    Ok(zenoh::open(config).wait().map_err(|error| error.to_string())?)
}

/// The node of the same build.
fn program() -> Result<PathBuf, Box<dyn Error>> {
    let example = env::current_exe()?;
    let folder = example.parent().and_then(|examples| examples.parent()).ok_or("the example stands in no folder")?;
    let program = folder.join("blur-node");
    if program.exists() { Ok(program) } else { Err("blur-node is not built: cargo build with the same options".into()) }
}

/// Memory of a process in megabytes, as Linux tells it.
fn resident_mb(node: &Child) -> Result<f64, Box<dyn Error>> {
    let status = fs::read_to_string(format!("/proc/{}/status", node.id()))?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:")).ok_or("the node has ended")?;
    let kb: f64 = line.trim().trim_end_matches(" kB").parse()?;
    Ok(kb / 1024.0)
}

/// A texture of noise that moved to the right, on from picture to picture.
fn picture(number: usize) -> Vec<u8> {
    let texture = |row: usize, column: usize| {
        // SplitMix64 of the place (Steele, Lea and Flood 2014).
        let z = ((row * 4096 + column) as u64).wrapping_add(1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
        let z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 56) as usize
    };
    let first = (PICTURES - number) * LENGTH;
    (0..HEIGHT * WIDTH)
        .map(|place| {
            let (row, column) = (place / WIDTH, place % WIDTH);
            let sum: usize = (0..LENGTH).map(|step| texture(row, first + column + step)).sum();
            (sum / LENGTH) as u8
        })
        .collect()
}
