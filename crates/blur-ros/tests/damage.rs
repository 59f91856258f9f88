//! Messages and bags that were damaged on the way: no panic, no memory for what is not there.
#![allow(clippy::unwrap_used, reason = "a test that cannot be set up fails")]

use std::collections::BTreeMap;
use std::io::Cursor;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::{env, fs, process};

use blur_ros::bag;
use blur_ros::cdr::ByteOrder;
use blur_ros::frame::{Frame, FrameKind, Samples};
use blur_ros::msg::{
    CameraInfo, CompressedImage, DiagnosticArray, DiagnosticStatus, Header, Image, KeyValue, Level, Message, Time,
    TwistWithCovarianceStamped,
};
use mcap::records::MessageHeader;
use mcap::{Compression, WriteOptions};

/// `SplitMix64` (Steele, Lea and Flood 2014).
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    fn below(&mut self, end: usize) -> usize {
        (self.next() % end as u64) as usize
    }

    /// The bytes with one to four of them changed, or cut off, or with a few in between.
    fn damage(&mut self, bytes: &[u8]) -> Vec<u8> {
        let mut damaged = bytes.to_vec();
        match self.below(8) {
            0 => damaged.truncate(self.below(bytes.len())),
            1 => {
                let at = self.below(bytes.len());
                damaged.splice(at..at, [0xFF; 3]);
            }
            _ => {
                for _ in 0..=self.below(4) {
                    let at = self.below(bytes.len());
                    damaged[at] = match self.below(4) {
                        0 => 0xFF,
                        1 => 0,
                        2 => damaged[at] ^ (1 << self.below(8)),
                        _ => self.next() as u8,
                    };
                }
            }
        }
        damaged
    }
}

const HEADER: Header<'static> = Header { stamp: Time { sec: 12, nanosec: 34 }, frame_id: "camera" };

fn image(data: &[u8]) -> Image<'_> {
    Image { header: HEADER, height: 8, width: 8, encoding: "mono16", is_bigendian: true, step: 17, data }
}

fn camera_info() -> CameraInfo<'static> {
    CameraInfo { header: HEADER, distortion_model: "plumb_bob", d: vec![0.1; 5], k: [1.0; 9], ..CameraInfo::default() }
}

fn diagnostics() -> DiagnosticArray<'static> {
    let value = |key: &'static str| KeyValue { key: key.into(), value: "1.5".into() };
    let status = DiagnosticStatus {
        level: Level::Warn,
        name: "blur".into(),
        message: "ambiguous".into(),
        hardware_id: "camera".into(),
        values: vec![value("angle_deg"), value("length_px")],
    };
    DiagnosticArray { header: HEADER, status: vec![status.clone(), status] }
}

fn twist() -> TwistWithCovarianceStamped<'static> {
    let covariance = std::array::from_fn(|i| i as f64);
    TwistWithCovarianceStamped { header: HEADER, linear: [1.0, -2.0, 0.0], angular: [0.5; 3], covariance }
}

#[test]
fn messages_come_back_as_they_went_in_either_order_of_bytes() {
    let data: Vec<u8> = (0..136).collect();
    for order in [ByteOrder::Little, ByteOrder::Big] {
        assert_eq!(Image::from_cdr(&image(&data).to_cdr(order)).unwrap(), image(&data));
        let compressed = CompressedImage { header: HEADER, format: "png", data: &data };
        assert_eq!(CompressedImage::from_cdr(&compressed.to_cdr(order)).unwrap(), compressed);
        assert_eq!(CameraInfo::from_cdr(&camera_info().to_cdr(order)).unwrap(), camera_info());
        assert_eq!(DiagnosticArray::from_cdr(&diagnostics().to_cdr(order)).unwrap(), diagnostics());
        assert_eq!(TwistWithCovarianceStamped::from_cdr(&twist().to_cdr(order)).unwrap(), twist());
    }
}

#[test]
fn damaged_messages_do_no_harm() {
    let mut random = Random(1);
    let data: Vec<u8> = (0..136).collect();
    let compressed = CompressedImage { header: HEADER, format: "png", data: &data };
    let mut samples = Samples::default();
    for order in [ByteOrder::Little, ByteOrder::Big] {
        let messages = [
            image(&data).to_cdr(order),
            compressed.to_cdr(order),
            camera_info().to_cdr(order),
            diagnostics().to_cdr(order),
            twist().to_cdr(order),
        ];
        for message in &messages {
            for _ in 0..5000 {
                let damaged = random.damage(message);
                // Whatever is announced, no more is taken than a few times what is there.
                let taken = allocation_counter::measure(|| {
                    let _ = DiagnosticArray::from_cdr(&damaged);
                    let _ = CameraInfo::from_cdr(&damaged);
                    let _ = TwistWithCovarianceStamped::from_cdr(&damaged);
                    let _ = Frame::from_cdr(FrameKind::Compressed, &damaged);
                    if let Ok(image) = Image::from_cdr(&damaged) {
                        let _ = samples.pixels(&image);
                    }
                });
                assert!(taken.bytes_max < 1 << 16, "{} bytes", taken.bytes_max);
            }
        }
    }
}

/// A bag in memory with a few frames.
fn bag_of_frames(compression: Option<Compression>) -> Vec<u8> {
    let data: Vec<u8> = (0..136).collect();
    let mut file = Cursor::new(Vec::new());
    let options = WriteOptions::new().profile("ros2").compression(compression).compression_threads(0);
    let mut writer = options.create(&mut file).unwrap();
    let schema = writer.add_schema(&Image::TYPE.ros(), "ros2msg", Image::TYPE.definition.as_bytes()).unwrap();
    let channel_id = writer.add_channel(schema, "/camera/image_raw", "cdr", &BTreeMap::new()).unwrap();
    for sequence in 0..4 {
        let header = MessageHeader { channel_id, sequence, log_time: 10, publish_time: 10 };
        writer.write_to_known_channel(&header, &image(&data).to_cdr(ByteOrder::Little)).unwrap();
    }
    writer.finish().unwrap();
    drop(writer);
    file.into_inner()
}

/// A file that goes away with its guard.
struct Scratch(PathBuf);

impl Scratch {
    fn new(name: &str) -> Self {
        Self(env::temp_dir().join(format!("blur-ros-{name}-{}.mcap", process::id())))
    }

    fn path(&self) -> &Path {
        &self.0
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        let _ = fs::remove_file(&self.0);
    }
}

#[test]
fn damaged_bags_do_no_harm() {
    let scratch = Scratch::new("damage");
    let mut random = Random(2);
    for compression in [None, Some(Compression::Zstd), Some(Compression::Lz4)] {
        let bag = bag_of_frames(compression);
        let mut failures = 0;
        for _ in 0..2000 {
            fs::write(scratch.path(), random.damage(&bag)).unwrap();
            let mut outcome = Ok(());
            let taken = allocation_counter::measure(|| {
                outcome = bag::read(scratch.path(), |message| {
                    let _ = Frame::from_cdr(FrameKind::Raw, message.data);
                    ControlFlow::Continue(())
                });
            });
            failures += u32::from(outcome.is_err());
            assert!(taken.bytes_max < MOST_BYTES, "{} bytes", taken.bytes_max);
        }
        assert!(failures > 100, "only {failures} of the damages were noticed");
    }
}

/// Far more than the bag and its buffers take, far less than damaged lengths announce.
const MOST_BYTES: u64 = 1 << 21;

#[test]
fn a_whole_bag_gives_all_its_messages() {
    let scratch = Scratch::new("whole");
    for compression in [None, Some(Compression::Zstd), Some(Compression::Lz4)] {
        fs::write(scratch.path(), bag_of_frames(compression)).unwrap();
        let mut frames = 0;
        bag::read(scratch.path(), |message| {
            assert_eq!((message.topic, message.log_ns), ("/camera/image_raw", 10));
            assert_eq!(Image::from_cdr(message.data).unwrap().width, 8);
            frames += 1;
            ControlFlow::Continue(())
        })
        .unwrap();
        assert_eq!(frames, 4);
    }
}
