"""Bags go in from rosbags and come out to rosbags, and their records are those of picture files."""

import math
import struct
from pathlib import Path

import numpy as np
import pytest
from rosbags.rosbag2 import Reader

from conftest import (
    HEIGHT,
    STORE,
    TOPIC,
    WIDTH,
    camera_info,
    compressed,
    estimate,
    image,
    picture,
    save,
    write_bag,
)

CRATE = Path(__file__).parents[2]
MS = 10**6
START = 1_700_000_000 * 10**9
TWIST = "/blur/twist"
DIAGNOSTICS = "/diagnostics"
METRIC = ("--exposure", "10ms", "--scale", "1mm/px")
UNKNOWN = 1e6


def read(path):
    """The messages of a bag by topic, with the time that each was logged."""
    found = {TWIST: [], DIAGNOSTICS: []}
    with Reader(path) as reader:
        for connection, ns, data in reader.messages():
            found[connection.topic].append((ns, STORE.deserialize_cdr(data, connection.msgtype)))
    return found


def values(diagnostics):
    return {pair.key: pair.value for pair in diagnostics.status[0].values}


def same_bits(record, of_file):
    """Whether a record has the bits of that of a file, apart from what only one of both knows."""
    only_of_files = {"image", "time_ms", "exposure_source"}
    # A scale that was given is not told again of files.
    only_of_sequences = {"image", "tracked", "direction_deg"}
    a = {key: value for key, value in record.items() if key not in only_of_sequences}
    b = {key: value for key, value in of_file.items() if key not in only_of_files | only_of_sequences}
    assert a == b


GREY = picture(degrees=30)
RGB = np.stack([GREY, GREY // 2 + 20, 255 - GREY], axis=2)
DEEP = GREY.astype(np.uint16) * 200 + 13


@pytest.mark.parametrize(
    ("encoding", "data", "bigendian", "file"),
    [
        ("mono8", GREY, False, GREY),
        ("8UC1", GREY, True, GREY),
        ("mono16", DEEP, False, DEEP),
        ("16UC1", DEEP, True, DEEP),
        ("rgb8", RGB, False, RGB),
        ("bgr8", RGB[..., ::-1], False, RGB),
        ("rgba8", np.dstack([RGB, GREY]), False, RGB),
        ("bgra8", np.dstack([RGB[..., ::-1], GREY]), False, RGB),
    ],
)
@pytest.mark.parametrize("big_cdr", [False, True])
def test_a_frame_has_the_record_of_the_same_picture_in_a_file(tmp_path, encoding, data, bigendian, file, big_cdr):
    message = image(START, data, encoding, bigendian, pad=5)
    bag = write_bag(tmp_path / "bag", [(TOPIC, START, message)], big=[TOPIC] if big_cdr else [])
    (of_file,), _ = estimate(save(tmp_path / "frame.png", file), *METRIC)
    (record,), _ = estimate(bag, *METRIC, "-o", tmp_path / "out.mcap")
    assert record["image"] == f"{bag}:{TOPIC}@1700000000.000000000"
    same_bits(record, of_file)
    # The diagnostics hold the very record, and the bits of its numbers.
    ((_, diagnostics),) = read(tmp_path / "out.mcap")[DIAGNOSTICS]
    found = values(diagnostics)
    assert set(found) == set(record) - {"image"}
    for key, value in record.items():
        if isinstance(value, bool):
            assert found[key] == str(value).lower()
        elif isinstance(value, float):
            assert struct.pack("d", float(found[key])) == struct.pack("d", value)
        elif key != "image":
            assert found[key] == str(value)


def test_float_frames_are_the_numbers_of_the_codes(tmp_path):
    bag = write_bag(tmp_path / "bag", [(TOPIC, START, image(START, GREY.astype(np.float32), "32FC1", True))])
    (of_file,), _ = estimate(save(tmp_path / "frame.png", GREY), *METRIC)
    (record,), _ = estimate(bag, *METRIC)
    same_bits(record, of_file)


@pytest.mark.parametrize("format", ["png", "jpeg"])
def test_compressed_frames_are_files(tmp_path, format):
    path = save(tmp_path / f"frame.{format}", GREY)
    bag = write_bag(tmp_path / "bag", [(TOPIC + "/compressed", START, compressed(START, path.read_bytes(), format))])
    (of_file,), _ = estimate(path, *METRIC)
    (record,), _ = estimate(bag, *METRIC)
    assert record["linearized"] == (format == "jpeg")
    same_bits(record, of_file)


def test_stored_samples_are_linear_unless_asked(tmp_path):
    bag = write_bag(tmp_path / "bag", [(TOPIC, START, image(START, GREY))])
    (record,), _ = estimate(bag)
    assert not record["linearized"]
    (record,), _ = estimate(bag, "--linearize", "on")
    (of_file,), _ = estimate(save(tmp_path / "frame.png", GREY), "--linearize", "on")
    assert record["linearized"]
    same_bits(record, of_file)


def test_the_output_is_a_bag_of_ros_2(tmp_path):
    bag = write_bag(tmp_path / "bag", [(TOPIC, START + 5, image(START, GREY))])
    estimate(bag, *METRIC, "-o", tmp_path / "out.mcap")
    with Reader(tmp_path / "out.mcap") as reader:
        found = {connection.topic: connection for connection in reader.connections}
        for topic, kind in [
            (TWIST, "geometry_msgs/msg/TwistWithCovarianceStamped"),
            (DIAGNOSTICS, "diagnostic_msgs/msg/DiagnosticArray"),
        ]:
            connection = found[topic]
            assert connection.msgtype == kind
            assert connection.msgcount == 1
            assert connection.msgdef.data == STORE.generate_msgdef(kind, ros_version=2)[0]
            (qos,) = connection.ext.offered_qos_profiles
            assert (qos.depth, qos.reliability.name, qos.durability.name) == (10, "RELIABLE", "VOLATILE")
    content = (tmp_path / "out.mcap").read_bytes()
    assert content[:8] == content[-8:] == b"\x89MCAP0\r\n"
    assert b"ros2" in content[:64]
    for messages in read(tmp_path / "out.mcap").values():
        ((ns, message),) = messages
        assert ns == START + 5
        assert (message.header.stamp.sec, message.header.stamp.nanosec) == (1_700_000_000, 0)
        assert message.header.frame_id == "camera_optical"


@pytest.mark.parametrize("file", sorted((CRATE / "msg").glob("*.msg")), ids=lambda file: file.stem)
def test_types_have_the_definition_and_hash_that_rosbags_computes(file):
    (kind,) = [kind for kind in STORE.types if kind.endswith(f"/msg/{file.stem}")]
    assert file.read_text() == STORE.generate_msgdef(kind, ros_version=2)[0]
    sources = "".join(source.read_text() for source in (CRATE / "src" / "msg").glob("*.rs"))
    declared = sources.split(f'name: "{file.stem}",')[1].split("};")[0]
    assert f'"{STORE.hash_rihs01(kind)}"' in declared and f'"../../msg/{file.name}"' in declared


def test_hashes_are_those_of_the_descriptions(tmp_path):
    bag = write_bag(tmp_path / "bag", [(TOPIC, START, image(START, GREY))])
    estimate(bag, *METRIC, "-o", tmp_path / "out.mcap")
    content = (tmp_path / "out.mcap").read_bytes()
    for kind in ("geometry_msgs/msg/TwistWithCovarianceStamped", "diagnostic_msgs/msg/DiagnosticArray"):
        assert STORE.hash_rihs01(kind).encode() in content


def expected_covariance(record, ambiguous):
    """By derivatives taken numerically, not by the formula of the program."""
    v, d = record["speed_m_s"], math.radians(record["angle_deg"])

    def velocity(v, d):
        return np.array([v * math.cos(d), -v * math.sin(d)])

    sv, sd = record["speed_std_m_s"], math.radians(record["angle_std_deg"])
    shared = record["correlation"] * v / record["length_px"] * record["length_std_px"] * sd
    h = 1e-6
    by = np.stack(
        [
            (velocity(v + h, d) - velocity(v - h, d)) / (2 * h),
            (velocity(v, d + h) - velocity(v, d - h)) / (2 * h),
        ],
        axis=1,
    )
    covariance = by @ np.array([[sv**2, shared], [shared, sd**2]]) @ by.T
    if ambiguous:
        # The mean square error of v for a truth of v and -v with equal chance.
        x = velocity(v, d)
        covariance += 0.5 * np.outer(2 * x, 2 * x)
    return velocity(v, d), covariance


def test_a_single_frame_is_an_axis_with_the_coin_flip_in_its_covariance(tmp_path):
    bag = write_bag(tmp_path / "bag", [(TOPIC, START, image(START, GREY))])
    (record,), _ = estimate(bag, *METRIC, "-o", tmp_path / "out.mcap")
    assert "direction_deg" not in record
    found = read(tmp_path / "out.mcap")
    ((_, twist),), ((_, diagnostics),) = found[TWIST], found[DIAGNOSTICS]
    velocity, covariance = expected_covariance(record, ambiguous=True)
    linear = twist.twist.twist.linear
    assert (linear.x, linear.y) == pytest.approx(tuple(velocity), rel=1e-12)
    # Up to the right is x to the right and y, which points down, below 0.
    assert abs(record["angle_deg"] - 30) < 1 and linear.x > 0 > linear.y
    assert math.hypot(linear.x, linear.y) == pytest.approx(14 * 1e-3 / 10e-3, rel=0.03)
    matrix = twist.twist.covariance.reshape(6, 6)
    assert matrix[:2, :2] == pytest.approx(covariance, rel=1e-6)
    assert np.diag(matrix)[2:] == pytest.approx([UNKNOWN] * 4)
    assert np.count_nonzero(matrix) == 8
    angular = twist.twist.twist.angular
    assert (linear.z, angular.x, angular.y, angular.z) == (0, 0, 0, 0)
    assert np.linalg.eigvalsh(matrix).min() > 0
    assert int(diagnostics.status[0].level) == 1
    assert "direction ambiguous" in diagnostics.status[0].message
    assert diagnostics.status[0].hardware_id == "camera_optical"


def test_frames_that_follow_each_other_tell_the_direction(tmp_path):
    # Content that moves to the lower left; every frame goes on where the one before ended.
    frames = [
        (TOPIC, START + i * 10 * MS, image(START + i * 10 * MS, picture(degrees=215, length=12, shift=12 * i)))
        for i in range(4)
    ]
    bag = write_bag(tmp_path / "bag", frames)
    records, _ = estimate(bag, *METRIC, "-o", tmp_path / "out.mcap")
    found = read(tmp_path / "out.mcap")
    for record, (_, twist), (_, diagnostics) in list(zip(records, found[TWIST], found[DIAGNOSTICS], strict=True))[1:]:
        assert record["direction_deg"] == pytest.approx(215, abs=2)
        linear = twist.twist.twist.linear
        speed = record["speed_m_s"]
        direction = math.radians(record["direction_deg"])
        assert (linear.x, linear.y) == pytest.approx((speed * math.cos(direction), -speed * math.sin(direction)))
        assert linear.x < 0 < linear.y
        _, covariance = expected_covariance(record, ambiguous=False)
        assert twist.twist.covariance.reshape(6, 6)[:2, :2] == pytest.approx(covariance, rel=1e-6)
        assert int(diagnostics.status[0].level) == 0, diagnostics.status[0].message


def test_the_camera_of_the_bag_makes_the_scale(tmp_path):
    messages = [
        (TOPIC, START, image(START, GREY)),
        ("/camera/camera_info", START + 1, camera_info(START, f=500.0)),
        ("/other/camera_info", START + 1, camera_info(START, f=50.0)),
    ]
    bag = write_bag(tmp_path / "bag", messages)
    (record,), _ = estimate(bag, "--exposure", "10ms", "--distance", "2m", "-o", tmp_path / "out.mcap")
    # Scale = distance / focal length.
    assert record["scale_m_per_px"] == pytest.approx(2 / 500, rel=1e-9)
    assert len(read(tmp_path / "out.mcap")[TWIST]) == 1
    (record,), _ = estimate(
        bag, "--exposure", "10ms", "--distance", "2m", "--camera-info", "/other/camera_info"
    )
    assert record["scale_m_per_px"] == pytest.approx(2 / 50, rel=1e-9)


def turned(about, degrees_per_s, exposure_s, focal, seed=5):
    """What a pinhole camera sees that turns about one of its axes during the exposure, as a mean of sharp pictures.

    Only the rotation matrix knows of signs here: no blur direction enters.
    """
    size = 600
    random = np.random.default_rng(seed)
    texture = random.normal(size=(size, size))
    f = np.fft.fftfreq(size)
    smooth = np.exp(-2 * (np.pi * 1.0) ** 2 * (f[:, None] ** 2 + f[None, :] ** 2))
    texture = np.fft.ifft2(np.fft.fft2(texture) * smooth).real
    v, u = np.mgrid[0:HEIGHT, 0:WIDTH]
    rays = np.stack([(u - (WIDTH - 1) / 2) / focal, (v - (HEIGHT - 1) / 2) / focal, np.ones_like(u, float)])
    total = np.zeros((HEIGHT, WIDTH))
    steps = 97

    def seen(time):
        angle = math.radians(degrees_per_s) * time
        c, s = math.cos(angle), math.sin(angle)
        # Right-handed rotations of the camera in the world.
        rotation = np.array([[1, 0, 0], [0, c, -s], [0, s, c]] if about == "x" else [[c, 0, s], [0, 1, 0], [-s, 0, c]])
        world = np.tensordot(rotation, rays, axes=1)
        x, y = world[0] / world[2] * focal + size / 2, world[1] / world[2] * focal + size / 2
        x0, y0 = np.floor(x).astype(int), np.floor(y).astype(int)
        fx, fy = x - x0, y - y0
        def at(dy, dx):
            return texture[(y0 + dy) % size, (x0 + dx) % size]
        return (at(0, 0) * (1 - fx) + at(0, 1) * fx) * (1 - fy) + (at(1, 0) * (1 - fx) + at(1, 1) * fx) * fy

    def exposed(start):
        total = sum(seen(start + exposure_s * (i + 0.5) / steps) for i in range(steps)) / steps
        return total

    frames = [exposed(i * exposure_s) for i in range(3)]
    scale = 40 / frames[0].std()
    return [np.clip(np.rint(frame * scale + 128), 0, 255).astype(np.uint8) for frame in frames]


@pytest.mark.parametrize(("about", "rate"), [("y", 120.0), ("y", -120.0), ("x", 120.0), ("x", -120.0)])
def test_a_camera_that_turns_is_told_with_its_sign(tmp_path, about, rate):
    exposure, focal = 0.01, 600.0
    frames = turned(about, rate, exposure, focal)
    messages = [("/camera/camera_info", START, camera_info(START, f=focal))]
    for i, frame in enumerate(frames):
        ns = START + i * 10 * MS
        messages.append((TOPIC, ns, image(ns, frame)))
    bag = write_bag(tmp_path / "bag", messages)
    records, _ = estimate(bag, "--exposure", "10ms", "--rotating", "-o", tmp_path / "out.mcap")
    assert "direction_deg" in records[-1], records[-1]
    _, twist = read(tmp_path / "out.mcap")[TWIST][-1]
    angular, linear = twist.twist.twist.angular, twist.twist.twist.linear
    found = {"x": angular.x, "y": angular.y}
    other = {"x": "y", "y": "x"}[about]
    assert found[about] == pytest.approx(math.radians(rate), rel=0.04)
    assert abs(found[other]) < 0.05 * math.radians(abs(rate))
    assert (linear.x, linear.y, linear.z, angular.z) == (0, 0, 0, 0)
    matrix = twist.twist.covariance.reshape(6, 6)
    along, across = {"x": (3, 4), "y": (4, 3)}[about]
    # Along the motion the length counts, across it the angle.
    rate_std = records[-1]["angular_rate_std_rad_s"]
    assert matrix[along, along] == pytest.approx(rate_std**2, rel=0.05)
    angle_std = math.radians(records[-1]["angle_std_deg"])
    assert matrix[across, across] == pytest.approx((math.radians(rate) * angle_std) ** 2, rel=0.1)
    assert np.diag(matrix)[[0, 1, 2, 5]] == pytest.approx([UNKNOWN] * 4)


def test_without_a_scale_there_are_diagnostics_and_a_note(tmp_path):
    bag = write_bag(tmp_path / "bag", [(TOPIC, START, image(START, GREY)), (TOPIC, START + MS, image(START + MS, GREY))])
    _, said = estimate(bag, "-o", tmp_path / "out.mcap")
    assert said.count("--scale") == 1
    found = read(tmp_path / "out.mcap")
    assert found[TWIST] == [] and len(found[DIAGNOSTICS]) == 2
    _, said = estimate(bag, "--scale", "1mm/px")
    assert said.count("--exposure") == 1
    _, said = estimate(bag, "--exposure", "1ms", "--distance", "1m")
    assert said.count("CameraInfo") == 1


def test_no_blur_is_an_error_in_the_diagnostics_and_no_velocity(tmp_path):
    bag = write_bag(tmp_path / "bag", [(TOPIC, START, image(START, picture(length=0.01)))])
    (record,), _ = estimate(bag, *METRIC, "-o", tmp_path / "out.mcap")
    assert record["status"] == "no_motion_blur"
    found = read(tmp_path / "out.mcap")
    ((_, diagnostics),) = found[DIAGNOSTICS]
    assert found[TWIST] == []
    assert int(diagnostics.status[0].level) == 2 and diagnostics.status[0].message.startswith("no_motion_blur")


def test_wrong_frames_are_told_and_the_next_goes_on(tmp_path):
    good = [image(START + i * 10 * MS, picture(degrees=30, shift=14 * i)) for i in range(6)]
    good[1].encoding = "bayer_rggb8"
    good[2].step = WIDTH - 1
    good[3].data = good[3].data[:-1]
    good[4].encoding = "yuv422"
    messages = [(TOPIC, START + i * 10 * MS, message) for i, message in enumerate(good)]
    bag = write_bag(tmp_path / "bag", messages)
    lines, said = estimate(bag, *METRIC, "-o", tmp_path / "out.mcap", status=1)
    assert ["error" in line for line in lines] == [False, True, True, True, True, False]
    assert "bayer_rggb8" in lines[1]["error"] and "yuv422" in lines[4]["error"]
    # Nothing is concluded over what is missing.
    assert "direction_deg" not in lines[5]
    for i in range(1, 5):
        assert said.count(f"@1700000000.{i:02}0000000: ") == 1
    assert "6 frames: 4 failed" in said
    found = read(tmp_path / "out.mcap")
    assert [int(message.status[0].level) for _, message in found[DIAGNOSTICS]] == [1, 2, 2, 2, 2, 1]
    assert len(found[TWIST]) == 2


def test_frames_out_of_order_missing_repeated_and_resized_are_handled(tmp_path):
    # In units of 10 ms: 30 is late, 31 comes twice, 33 to 35 are missing, from 37 on pictures are smaller.
    order = [26, 27, 28, 29, 31, 30, 31, 32, 32, 36, 37, 38]
    messages = []
    for at, number in enumerate(order):
        width = 256 if number >= 37 else WIDTH
        stamp = START + number * 10 * MS
        messages.append((TOPIC, START + at * 10 * MS, image(stamp, picture(degrees=30, shift=14 * number, width=width))))
    bag = write_bag(tmp_path / "bag", messages)
    lines, said = estimate(bag, *METRIC, "-o", tmp_path / "out.mcap")
    # 30 is missing too when 31 comes.
    assert "12 frames: 0 failed, 1 out of order, 2 repeated, 4 missing, 1 changes of size" in said
    assert said.count("out of order: ") == 1 and said.count("now 256x240 pixels, 320x240 before") == 1
    # A repeated frame is not measured again: the second 31 and the second 32.
    assert len(lines) == 10
    assert lines[-1]["width"] == 256
    assert [line["width"] for line in lines].count(WIDTH) == 8
    assert len(read(tmp_path / "out.mcap")[DIAGNOSTICS]) == 10


def test_topics_are_chosen_or_named(tmp_path):
    messages = [("/a/image_raw", START, image(START, GREY)), ("/b/image_raw", START, image(START, GREY))]
    bag = write_bag(tmp_path / "two", messages)
    lines, said = estimate(bag, status=1)
    assert lines == [] and "/a/image_raw, /b/image_raw" in said and "--topic" in said
    (record,), _ = estimate(bag, "--topic", "/b/image_raw")
    assert ":/b/image_raw@" in record["image"]
    _, said = estimate(bag, "--topic", "/c", status=1)
    assert "'/c'" in said and "/a/image_raw" in said
    bag = write_bag(tmp_path / "none", [("/camera/camera_info", START, camera_info(START))])
    _, said = estimate(bag, status=1)
    assert "sensor_msgs/msg/CameraInfo" in said


def test_a_folder_of_rosbag2_is_a_bag(tmp_path):
    file = write_bag(tmp_path / "bag", [(TOPIC, START, image(START, GREY))])
    (of_file,), _ = estimate(file)
    (of_folder,), _ = estimate(tmp_path / "bag")
    same_bits(of_folder, of_file)
    metadata = tmp_path / "bag" / "metadata.yaml"
    metadata.write_text(metadata.read_text().replace("storage_identifier: mcap", "storage_identifier: sqlite3"))
    _, said = estimate(tmp_path / "bag", status=1)
    assert "sqlite3" in said and "ros2 bag convert" in said


def test_a_bag_that_breaks_off_gives_what_it_holds(tmp_path):
    messages = [(TOPIC, START + i * MS, image(START + i * MS, GREY)) for i in range(4)]
    file = write_bag(tmp_path / "bag", messages)
    content = file.read_bytes()
    file.write_bytes(content[: len(content) // 2])
    lines, said = estimate(file, *METRIC, "-o", tmp_path / "out.mcap", status=1)
    assert 1 <= len(lines) < 4
    assert "ends too early" in said
    assert len(read(tmp_path / "out.mcap")[TWIST]) == len(lines)


def test_what_makes_no_sense_is_refused(tmp_path):
    bag = write_bag(tmp_path / "bag", [(TOPIC, START, image(START, GREY))])
    before = bag.read_bytes()
    _, said = estimate(bag, "-o", bag, status=1)
    assert "overwrite" in said and bag.read_bytes() == before
    for args, word in [
        ((bag, "--map", "64"), "--map"),
        ((bag, "--roi", "0,0,64,64"), "--roi"),
        ((bag, save(tmp_path / "a.png", GREY)), "alone"),
        ((tmp_path / "a.png", "--topic", "/x"), "--topic"),
        ((tmp_path / "a.png", "--distance", "1m"), "--camera"),
    ]:
        _, said = estimate(*args, status=2)
        assert word in said
    (tmp_path / "text.mcap").write_text("no bag at all")
    _, said = estimate(tmp_path / "text.mcap", status=1)
    assert "no bag" in said
