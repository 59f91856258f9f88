#!/usr/bin/env python3
"""Checks a board through its serial port. Linux and macOS; nothing but Python 3 is needed.

    python3 check_board.py /dev/ttyUSB0            # Hello, then the self-test (timer) or the status (drive)
    python3 check_board.py /dev/ttyUSB0 --arm      # the timer with its sensor: a run of at least one tooth
    python3 check_board.py /dev/ttyUSB0 --watch    # then prints every report until Ctrl-C

The exit status is 0 when all is well, 1 when a check fails and 2 when the port or the command line is wrong. The
format of the frames is that of the crate slider-proto.
"""

import argparse
import os
import select
import struct
import sys
import termios
import time
import zlib

VERSION = 1
HELLO, STATUS, ARM, SELF_TEST = 1, 2, 3, 7
RESET_S = 3.0  # opening a USB port may reset the board; its bootloader takes up to 2 s
ANSWER_S = 1.0
RUN_S = 60.0
EDGES, WORST_ERROR_TICKS = 26, 1

UNITS = ("timer", "drive")
TIMER_STATES = ("idle", "armed", "running", "self-test")
DRIVE_STATES = ("stopped", "starting", "running", "at the limit")
DIRECTIONS = ("forward", "reverse")
REFUSALS = ("garbled", "not mine", "busy", "sensor blocked", "no such preset", "at the limit", "out of range")


def cobs_encode(data):
    out = bytearray()
    for group in (data + b"\0").split(b"\0")[:-1]:
        assert len(group) < 254  # no frame is that long
        out += bytes([len(group) + 1]) + group
    return bytes(out)


def cobs_decode(data):
    out = bytearray()
    while data:
        length = data[0]
        if length > len(data):
            raise ValueError("not COBS")
        out += data[1:length]
        data = data[length:]
        if data and length < 255:
            out.append(0)
    return bytes(out)


def encode(sequence, kind, payload=b""):
    """The bytes of a frame, the zero at its end included."""
    body = bytes([VERSION, sequence, kind]) + payload
    return cobs_encode(body + struct.pack("<I", zlib.crc32(body))) + b"\0"


def decode(frame):
    """Sequence number, kind and payload of a frame without its zero."""
    data = cobs_decode(frame)
    body, checksum = data[:-4], data[-4:]
    if len(body) < 3 or struct.pack("<I", zlib.crc32(body)) != checksum:
        raise ValueError("wrong checksum")
    if body[0] != VERSION:
        raise ValueError(f"format version {body[0]}, this program knows {VERSION}")
    return body[1], body[2], body[3:]


def name(names, code):
    return names[code] if code < len(names) else f"unknown ({code})"


def describe(kind, payload):
    """A line of text for a report."""
    if kind == 128:
        unit, major, minor, patch, tick_hz, cause = struct.unpack("<BBBBIB", payload)
        return f"Hello from {name(UNITS, unit)} {major}.{minor}.{patch}, {tick_hz} ticks/s, reset cause {cause:#04x}"
    if kind == 129:
        return "RunStart: run {}, tick {}".format(*struct.unpack("<HI", payload))
    if kind == 130:
        run, first, count = struct.unpack("<HHB", payload[:5])
        return f"Edges: run {run}, {first} to {first + count - 1}"
    if kind == 131:
        return "RunEnd: run {}, {} edges, {} late, {} lost, reason {}".format(*struct.unpack("<HHHHB", payload))
    if kind == 132:
        return "LimitHit: tick {}".format(*struct.unpack("<I", payload))
    if kind == 133:
        index, duty, direction, state, limit = struct.unpack("<BBBBB", payload)
        switch = "open" if limit else "closed"
        return (f"Preset {index}: duty {duty} {name(DIRECTIONS, direction)}, {name(DRIVE_STATES, state)}, "
                f"limit switch {switch}")
    if kind == 134:
        state, run, edges, sensor, limit = struct.unpack("<BHHBB", payload)
        light, end = "open" if sensor else "blocked", "reached" if limit else "not reached"
        return f"Status: {name(TIMER_STATES, state)}, run {run}, {edges} edges, sensor {light}, end of travel {end}"
    if kind == 135:
        return "Ack of {}".format(*struct.unpack("<B", payload))
    if kind == 136:
        sequence, reason = struct.unpack("<BB", payload)
        return f"Nak of {sequence}: {name(REFUSALS, reason)}"
    if kind == 137:
        return "SelfTest: {} edges, worst error {} ticks".format(*struct.unpack("<BH", payload))
    return f"report of unknown kind {kind}: {payload.hex(' ')}"


class Line:
    """The serial port: 57600 baud, 8 bits, no parity, one stop bit, no translation."""

    def __init__(self, path):
        self.file = os.open(path, os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK)
        attributes = termios.tcgetattr(self.file)
        control = list(attributes[6])
        control[termios.VMIN], control[termios.VTIME] = 0, 0
        flags = termios.CS8 | termios.CREAD | termios.CLOCAL
        termios.tcsetattr(self.file, termios.TCSANOW, [0, 0, flags, 0, termios.B57600, termios.B57600, control])
        self.aligned = False
        self.frames = []
        self.rest = b""

    def send(self, sequence, kind, payload=b""):
        # A zero before the first frame ends whatever the board has heard before. If that was whole frames, it answers
        # with a Nak of 0, which means nothing.
        os.write(self.file, (b"" if self.aligned else b"\0") + encode(sequence, kind, payload))
        self.aligned = True

    def reports(self, seconds):
        """Kind and payload of every good frame that comes in so many seconds."""
        end = time.monotonic() + seconds
        while True:
            while self.frames:
                frame = self.frames.pop(0)
                try:
                    _, kind, payload = decode(frame)
                    text = describe(kind, payload)
                except (ValueError, struct.error) as error:
                    print(f"  ({len(frame)} bytes that are no frame: {error})")
                    continue
                print(f"  {text}", flush=True)
                yield kind, payload
            left = max(0.0, end - time.monotonic())
            if not select.select([self.file], [], [], left)[0]:
                return
            received = os.read(self.file, 256)
            if not received:
                raise OSError("the port is closed")
            *frames, self.rest = (self.rest + received).split(b"\0")
            self.frames += filter(None, frames)

    def wait_for(self, wanted, seconds):
        """The payload of the first report of one of these kinds."""
        for kind, payload in self.reports(seconds):
            if kind in wanted:
                return kind, payload
        return None


def hello(line):
    """The unit that answers: 0 timer, 1 drive."""
    print("waiting for the reset")
    answer = line.wait_for({128}, RESET_S)
    for sequence in (1, 2, 3):
        if answer:
            return answer[1][0]
        print("asking")
        line.send(sequence, HELLO)
        answer = line.wait_for({128}, ANSWER_S)
    return answer[1][0] if answer else None


def answer_of(line, sequence, kind, wanted, payload=b"", seconds=ANSWER_S):
    """Sends a command and returns the payload of what is to follow it, or None if it is refused or nothing comes."""
    line.send(sequence, kind, payload)
    acknowledged = False
    for kind, payload in line.reports(seconds):
        if kind == 136 and payload[0] == sequence:
            return None
        acknowledged = acknowledged or kind == 135 and payload[0] == sequence
        if kind == wanted and acknowledged:
            return payload
    return None


def check(line, arm):
    """What is wrong, or None."""
    unit = hello(line)
    if unit is None:
        return "no Hello: wrong port, another program on it, no firmware, or an HC-05 on D0 and D1"
    if unit == 1:
        print("status of the drive")
        return None if answer_of(line, 10, STATUS, 133) else "no status"
    print("status of the timer")
    if not answer_of(line, 10, STATUS, 134):
        return "no status"
    if arm:
        print("armed, unless refused: move a tooth through the sensor")
        run, trigger_ms, quiet_ms = 1, 100, 2000
        ended = answer_of(line, 11, ARM, 131, struct.pack("<HHH", run, trigger_ms, quiet_ms), RUN_S)
        return None if ended else "refused, or no end of a run"
    print("self-test")
    result = answer_of(line, 11, SELF_TEST, 137)
    if not result:
        return "no result of the self-test"
    edges, worst = struct.unpack("<BH", result)
    if edges != EDGES:
        return f"{edges} edges instead of {EDGES}: is D5 wired to D8, and the sensor unplugged?"
    if worst > WORST_ERROR_TICKS:
        return f"an interval is off by {worst} ticks: is the sensor unplugged, and the wire short?"
    return None


def main():
    parser = argparse.ArgumentParser(description="Checks a board of the slider through its serial port.")
    parser.add_argument("port", help="for example /dev/ttyUSB0 or /dev/rfcomm0")
    parser.add_argument("--arm", action="store_true", help="a run by hand instead of the timer's self-test")
    parser.add_argument("--watch", action="store_true", help="then print every report until Ctrl-C")
    arguments = parser.parse_args()
    trouble = "interrupted"
    try:
        line = Line(arguments.port)
        trouble = check(line, arguments.arm)
        print(f"FAILED: {trouble}" if trouble else "ok", flush=True)
        while arguments.watch:
            for _ in line.reports(3600.0):
                pass
    except (OSError, termios.error) as error:
        print(f"{arguments.port}: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print()
    return 1 if trouble else 0


if __name__ == "__main__":
    sys.exit(main())
