"""A publisher that speaks as rmw_zenoh_cpp does gives frames to the node and takes its velocities."""

import math
import os
import signal
import socket
import struct
import subprocess
import time

import numpy as np
import pytest
import xxhash
import zenoh

from conftest import STORE, camera_info, compressed, estimate, image, picture, program, save, write_bag

MS = 10**6
START = 1_700_000_000 * 10**9
TOPIC = "/robot/image_raw"
DOMAIN = 7
METRIC = ("--exposure-s", "0.01", "--scale-m-per-px", "0.001")
# Of the document docs/design.md of rmw_zenoh, for these types.
TYPES = {
    "image": ("sensor_msgs/msg/Image", "sensor_msgs::msg::dds_::Image_"),
    "compressed": ("sensor_msgs/msg/CompressedImage", "sensor_msgs::msg::dds_::CompressedImage_"),
    "info": ("sensor_msgs/msg/CameraInfo", "sensor_msgs::msg::dds_::CameraInfo_"),
    "twist": ("geometry_msgs/msg/TwistWithCovarianceStamped", "geometry_msgs::msg::dds_::TwistWithCovarianceStamped_"),
    "diagnostics": ("diagnostic_msgs/msg/DiagnosticArray", "diagnostic_msgs::msg::dds_::DiagnosticArray_"),
}


def key(topic, name):
    ros, dds = TYPES[name]
    return f"{DOMAIN}/{topic.strip('/')}/{dds}/{STORE.hash_rihs01(ros)}"


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


def until(condition, seconds=60.0):
    """Waits for something to become true: a limit for failures, not a measurement."""
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end, "it did not happen"
        time.sleep(0.01)


class Robot:
    """A session that listens, publishes frames and keeps what the node sends."""

    def __init__(self, port):
        config = zenoh.Config()
        config.insert_json5("mode", '"peer"')
        config.insert_json5("listen/endpoints", f'["tcp/127.0.0.1:{port}"]')
        config.insert_json5("scouting/multicast/enabled", "false")
        self.session = zenoh.open(config)
        self.sent = 0
        self.tokens = set()
        self.twists, self.diagnostics = [], []
        self.publishers = {}
        self.subscribers = [
            self.session.liveliness().declare_subscriber("@ros2_lv/**", self._token, history=True),
            self.session.declare_subscriber(key("/blur/twist", "twist"), lambda s: self.twists.append(s)),
            self.session.declare_subscriber(key("/diagnostics", "diagnostics"), lambda s: self.diagnostics.append(s)),
        ]

    def _token(self, sample):
        change = self.tokens.add if sample.kind == zenoh.SampleKind.PUT else self.tokens.discard
        change(str(sample.key_expr))

    def send(self, topic, name, message, big=False):
        if topic not in self.publishers:
            self.publishers[topic] = self.session.declare_publisher(key(topic, name))
        content = message if isinstance(message, bytes) else self.cdr(TYPES[name][0], message, big)
        self.sent += 1
        attachment = struct.pack("<qqB16s", self.sent, time.time_ns(), 16, b"0123456789abcdef")
        self.publishers[topic].put(content, attachment=attachment)

    @staticmethod
    def cdr(ros, message, big):
        return bytes(STORE.serialize_cdr(message, ros, little_endian=not big))

    def frames(self):
        """The diagnostics of frames, without those of the stream."""
        found = [STORE.deserialize_cdr(s.payload.to_bytes(), TYPES["diagnostics"][0]) for s in list(self.diagnostics)]
        return [message for message in found if message.status[0].name == f"blur: {TOPIC}"]

    def velocities(self):
        return [STORE.deserialize_cdr(s.payload.to_bytes(), TYPES["twist"][0]) for s in list(self.twists)]

    def close(self):
        self.session.close()


class Node:
    def __init__(self, port, *args):
        command = [program("blur-node"), "--connect", f"tcp/127.0.0.1:{port}", "--domain", str(DOMAIN)]
        command += ["--topic", TOPIC, *args]
        self.process = subprocess.Popen(list(map(str, command)), stderr=subprocess.PIPE, text=True)

    def end(self, how=signal.SIGTERM):
        if how:
            self.process.send_signal(how)
        _, said = self.process.communicate(timeout=60)
        return self.process.returncode, said


@pytest.fixture
def robot():
    port = free_port()
    robot = Robot(port)
    robot.port = port
    yield robot
    robot.close()


@pytest.fixture
def start(robot):
    """Starts a node and waits until its subscription is seen."""
    nodes = []

    def started(*args):
        node = Node(robot.port, *args)
        nodes.append(node)
        until(lambda: any("/MS/" in token and "image_raw" in token for token in robot.tokens))
        # The token travels apart from the subscription itself.
        time.sleep(0.5)
        return node

    yield started
    for node in nodes:
        if node.process.poll() is None:
            node.process.kill()
            node.process.communicate()


def test_frames_become_velocities_and_the_records_of_files(tmp_path, robot, start):
    node = start(*METRIC, "--queue", "8")
    frames = [picture(degrees=215, length=12, shift=12 * i) for i in range(4)]
    for i, frame in enumerate(frames):
        robot.send(TOPIC, "image", image(START + i * 10 * MS, frame), big=i % 2 == 1)
        until(lambda i=i: len(robot.frames()) == i + 1)
    until(lambda: len(robot.twists) == 4)
    messages = [("/t", START + i * 10 * MS, image(START + i * 10 * MS, frame)) for i, frame in enumerate(frames)]
    records, _ = estimate(write_bag(tmp_path / "bag", messages), "--exposure", "10ms", "--scale", "1mm/px")
    (of_file,), _ = estimate(save(tmp_path / "0.png", frames[0]), "--exposure", "10ms", "--scale", "1mm/px")
    for i, (record, diagnostics, twist) in enumerate(zip(records, robot.frames(), robot.velocities(), strict=True)):
        found = {pair.key: pair.value for pair in diagnostics.status[0].values}
        for name, value in record.items():
            if isinstance(value, float):
                assert float(found[name]) == value, name
        assert set(found) == set(record) - {"image"}
        assert (twist.header.stamp.nanosec, twist.header.frame_id) == (i * 10 * MS, "camera_optical")
        direction = math.radians(record.get("direction_deg", record["angle_deg"]))
        linear = twist.twist.twist.linear
        expected = (record["speed_m_s"] * math.cos(direction), -record["speed_m_s"] * math.sin(direction))
        assert (linear.x, linear.y) == pytest.approx(expected)
    assert float({p.key: p.value for p in robot.frames()[0].status[0].values}["length_px"]) == of_file["length_px"]
    status, said = node.end()
    assert status == 0 and "4 frames received, 4 done, 0 dropped, 0 late" in said


def test_ros_sees_a_node_with_its_ends(robot, start):
    node = start(*METRIC)
    zid = next(iter(robot.tokens)).split("/")[2]
    image_hash, twist_hash, diagnostics_hash = (STORE.hash_rihs01(TYPES[n][0]) for n in ("image", "twist", "diagnostics"))
    head = f"@ros2_lv/{DOMAIN}/{zid}/0"
    publisher = f"{head}/1/MP/%/%/blur_node/%blur%twist/{TYPES['twist'][1]}/{twist_hash}/::,10:,:,:,,"
    assert robot.tokens == {
        f"{head}/0/NN/%/%/blur_node",
        publisher,
        f"{head}/2/MP/%/%/blur_node/%diagnostics/{TYPES['diagnostics'][1]}/{diagnostics_hash}/::,10:,:,:,,",
        f"{head}/4/MS/%/%/blur_node/%robot%image_raw/{TYPES['image'][1]}/{image_hash}/2::,2:,:,:,,",
    }
    for i in range(2):
        robot.send(TOPIC, "image", image(START + i * 10 * MS, picture()))
        until(lambda i=i: len(robot.twists) == i + 1)
    for i, sample in enumerate(robot.twists):
        number, sent_ns, length, gid = struct.unpack("<qqB16s", sample.attachment.to_bytes())
        assert (number, length) == (i + 1, 16)
        assert abs(sent_ns - time.time_ns()) < 120 * 10**9
        digest = xxhash.xxh3_128_intdigest(publisher.encode())
        assert gid == digest.to_bytes(16, "little")
    status, _ = node.end(signal.SIGINT)
    assert status == 0
    # All that it declared is gone with it.
    until(lambda: not robot.tokens)


def test_the_camera_comes_over_its_own_topic(robot, start):
    node = start("--exposure-s", "0.01", "--distance-m", "2")
    robot.send(TOPIC, "image", image(START, picture()))
    until(lambda: len(robot.frames()) == 1)
    robot.send("/robot/camera_info", "info", camera_info(START, f=500.0))
    time.sleep(0.5)
    robot.send(TOPIC, "image", image(START + 10 * MS, picture()))
    until(lambda: len(robot.frames()) == 2 and len(robot.twists) == 1)
    found = {pair.key: pair.value for pair in robot.frames()[1].status[0].values}
    assert float(found["scale_m_per_px"]) == pytest.approx(2 / 500)
    _, said = node.end()
    assert said.count("no usable CameraInfo") == 1


def test_compressed_frames_have_the_records_of_files(tmp_path, robot, start):
    node = start(*METRIC, "--compressed")
    path = save(tmp_path / "frame.jpeg", picture(degrees=60))
    robot.send(TOPIC, "compressed", compressed(START, path.read_bytes(), "jpeg"))
    until(lambda: len(robot.frames()) == 1)
    (of_file,), _ = estimate(path, "--exposure", "10ms", "--scale", "1mm/px")
    found = {pair.key: pair.value for pair in robot.frames()[0].status[0].values}
    assert found["linearized"] == "true"
    for name in ("angle_deg", "length_px", "speed_m_s", "speed_std_m_s", "correlation"):
        assert float(found[name]) == of_file[name]
    assert node.end()[0] == 0


def test_what_is_no_frame_is_told_and_the_next_goes_on(robot, start):
    node = start(*METRIC, "--queue", "8")
    bayer = image(START, picture(), "bayer_rggb8")
    for i, message in enumerate([b"", b"\x00\x09\x00\x00", bayer, image(START + MS, picture())]):
        robot.send(TOPIC, "image", message)
        until(lambda i=i: len(robot.frames()) == i + 1)
    assert [int(message.status[0].level) for message in robot.frames()] == [2, 2, 2, 1]
    assert len(robot.twists) == 1
    status, said = node.end()
    assert status == 0 and "bayer_rggb8" in said and "4 frames: 3 failed" in said


def test_a_flood_is_dropped_and_counted_and_memory_stays_bounded(robot, start):
    node = start(*METRIC, "--queue", "2", "--report-s", "0.2")
    pid = node.process.pid

    def resident():
        with open(f"/proc/{pid}/status", encoding="ascii") as status:
            return next(int(line.split()[1]) for line in status if line.startswith("VmRSS"))

    content = Robot.cdr(TYPES["image"][0], image(START, picture()), big=False)
    large = np.random.default_rng(1).integers(0, 255, (1024, 1280), np.uint8)
    robot.send(TOPIC, "image", image(START, large))
    until(lambda: len(robot.frames()) == 1)
    before = resident()
    count = 400
    for i in range(count):
        message = image(START + (i + 1) * MS, large)
        robot.send(TOPIC, "image", message)
    robot.send(TOPIC, "image", content)
    until(lambda: "received" in report(robot) and int(report(robot)["received"]) > 0 and quiet(robot))
    # The flood is 500 MB; a queue of two frames holds 3.
    assert resident() - before < 150_000, (before, resident())
    status, said = node.end()
    counts = said.strip().splitlines()[-2]
    received, done, dropped, late = (int(word) for word in counts.replace(",", "").split() if word.isdigit())
    assert status == 0
    assert received == done + dropped + late
    assert dropped > 0 and done >= 1


def report(robot):
    found = [STORE.deserialize_cdr(s.payload.to_bytes(), TYPES["diagnostics"][0]) for s in list(robot.diagnostics)]
    found = [message for message in found if message.status[0].name == f"blur: stream of {TOPIC}"]
    return {pair.key: pair.value for pair in found[-1].status[0].values} if found else {}


def quiet(robot):
    """Whether nothing has come for a while."""
    before = len(robot.frames())
    time.sleep(1.0)
    return len(robot.frames()) == before


def test_it_ends_by_itself_after_its_time(robot, start):
    node = start(*METRIC, "--duration-s", "3")
    status, said = node.end(how=None)
    assert status == 0 and "0 frames received" in said


def test_no_thread_is_left_without_a_peer():
    node = Node(free_port(), *METRIC, "--duration-s", "1")
    status, _ = node.end(how=None)
    assert status == 0
    with pytest.raises(ProcessLookupError):
        os.kill(node.process.pid, 0)
