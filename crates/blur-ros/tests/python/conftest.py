"""Pictures with a known blur, and bags of them written by rosbags."""

import json
import os
import subprocess
from pathlib import Path

import numpy as np
import pytest
from PIL import Image as Picture
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

STORE = get_typestore(Stores.LATEST)
TYPES = STORE.types
TOPIC = "/camera/image_raw"
WIDTH, HEIGHT = 320, 240


def program(name):
    """The program of this workspace, which whoever runs the tests has built."""
    return Path(os.environ["BLUR_PROGRAMS"]) / name


def picture(length=14, degrees=0.0, seed=1, width=WIDTH, height=HEIGHT, shift=0):
    """Grey values of a random texture that moved `length` pixels along `degrees` during the exposure.

    `shift` says how far along the path it had moved before; the motion is exact, by a phase in the spectrum.
    """
    random = np.random.default_rng(seed)
    texture = random.normal(size=(height, width))
    v = np.fft.fftfreq(height)[:, None]
    u = np.fft.rfftfreq(width)[None, :]
    # Direction counter-clockwise as seen, rows grow downwards.
    along = u * np.cos(np.radians(degrees)) - v * np.sin(np.radians(degrees))
    lens = np.exp(-2 * (np.pi * 0.7) ** 2 * (u**2 + v**2))
    transfer = lens * np.sinc(along * length) * np.exp(-2j * np.pi * along * (shift + length / 2))
    moved = np.fft.irfft2(np.fft.rfft2(texture) * transfer, s=(height, width))
    moved = moved / moved.std() * 40 + 128 + random.normal(scale=0.5, size=moved.shape)
    return np.clip(np.rint(moved), 0, 255).astype(np.uint8)


def stamp(ns):
    return TYPES["builtin_interfaces/msg/Time"](sec=ns // 10**9, nanosec=ns % 10**9)


def header(ns, frame="camera_optical"):
    return TYPES["std_msgs/msg/Header"](stamp=stamp(ns), frame_id=frame)


def image(ns, data, encoding="mono8", bigendian=False, pad=0, frame="camera_optical"):
    """A message of stored samples; `pad` bytes stand behind each row."""
    rows = data.reshape(data.shape[0], -1)
    if rows.dtype.itemsize > 1:
        rows = rows.astype(rows.dtype.newbyteorder(">" if bigendian else "<"))
    rows = np.ascontiguousarray(rows).view(np.uint8)
    rows = np.pad(rows, ((0, 0), (0, pad)), constant_values=77)
    return TYPES["sensor_msgs/msg/Image"](
        header=header(ns, frame),
        height=data.shape[0],
        width=data.shape[1],
        encoding=encoding,
        is_bigendian=int(bigendian),
        step=rows.shape[1],
        data=rows.reshape(-1),
    )


def compressed(ns, content, format):
    return TYPES["sensor_msgs/msg/CompressedImage"](
        header=header(ns), format=format, data=np.frombuffer(content, np.uint8)
    )


def camera_info(ns, f=500.0, width=WIDTH, height=HEIGHT, d=(0.0,) * 5, model="plumb_bob"):
    cx, cy = (width - 1) / 2, (height - 1) / 2
    roi = TYPES["sensor_msgs/msg/RegionOfInterest"](x_offset=0, y_offset=0, height=0, width=0, do_rectify=False)
    return TYPES["sensor_msgs/msg/CameraInfo"](
        header=header(ns),
        height=height,
        width=width,
        distortion_model=model,
        d=np.array(d),
        k=np.array([f, 0, cx, 0, f, cy, 0, 0, 1.0]),
        r=np.eye(3).reshape(-1),
        p=np.array([f, 0, cx, 0, 0, f, cy, 0, 0, 0, 1, 0.0]),
        binning_x=0,
        binning_y=0,
        roi=roi,
    )


def write_bag(path, messages, big=()):
    """A bag of (topic, time in ns, message); topics in `big` are written in big endian CDR. The path of its MCAP file."""
    with Writer(path, version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        connections = {}
        for topic, ns, message in messages:
            if topic not in connections:
                connections[topic] = writer.add_connection(topic, message.__msgtype__, typestore=STORE)
            if isinstance(message, bytes):
                data = message
            else:
                data = bytes(STORE.serialize_cdr(message, message.__msgtype__, little_endian=topic not in big))
            writer.write(connections[topic], ns, data)
    (file,) = path.glob("*.mcap")
    return file


def estimate(*args, status=0):
    """The objects that `estimate --json` prints, and what it says besides."""
    run = subprocess.run(
        [program("estimate"), "--json", *map(str, args)], capture_output=True, text=True, timeout=300, check=False
    )
    assert run.returncode == status, run.stderr
    return [json.loads(line) for line in run.stdout.splitlines()], run.stderr


def save(path, data, mode=None):
    Picture.fromarray(data, mode).save(path)
    return path


@pytest.fixture(scope="session")
def store():
    return STORE
