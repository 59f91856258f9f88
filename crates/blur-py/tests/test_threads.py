"""Many pictures on many threads; the interpreter goes on meanwhile."""

import os
import signal
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

import motion_blur
from motion_blur import MotionBlurError, Record

Pixels = npt.NDArray[Any]


def pictures(count: int, side: int = 96) -> list[Pixels]:
    return [motion_blur.simulate((side, side), 6.0 + k % 7, 17.0 * k, noise_db=40.0, seed=k) for k in range(count)]


@pytest.mark.parametrize("threads", [None, 1, 2, 7])
def test_a_batch_keeps_the_order_and_the_bits(threads: int | None) -> None:
    many = pictures(23)
    expected = [motion_blur.estimate(picture) for picture in many]
    assert motion_blur.estimate_batch(many, threads=threads) == expected
    assert motion_blur.estimate_batch(iter(many), threads=threads) == expected


def test_one_bad_picture_is_one_error() -> None:
    many: list[Any] = pictures(5)
    many[1] = np.zeros((64, 64), np.uint8)
    many[3] = "no picture"
    results = motion_blur.estimate_batch(many, threads=2)
    assert [type(result) for result in results] == [Record, MotionBlurError, Record, MotionBlurError, Record]
    assert "all pixels have the value 0" in str(results[1]) and "not of type str" in str(results[3])
    assert results[4] == motion_blur.estimate(many[4])


def test_an_empty_batch_is_empty() -> None:
    assert motion_blur.estimate_batch([]) == []


def test_errors_of_the_caller_are_raised() -> None:
    def broken() -> Iterator[Pixels]:
        yield from pictures(1)
        raise KeyError("mine")

    with pytest.raises(KeyError, match="mine"):
        motion_blur.estimate_batch(broken())
    with pytest.raises(MotionBlurError, match="exposure"):
        motion_blur.estimate_batch([], exposure_s=-1.0)
    with pytest.raises((ValueError, OverflowError)):
        motion_blur.estimate_batch([], threads=0)


def ticks_during(work: Any) -> int:
    """How often a Python thread that sleeps one millisecond at a time woke up while another was in `work`."""
    ticks, done = 0, threading.Event()

    def tick() -> None:
        nonlocal ticks
        while not done.is_set():
            time.sleep(0.001)
            ticks += 1

    ticker = threading.Thread(target=tick)
    ticker.start()
    before = ticks
    work()
    during = ticks - before
    done.set()
    ticker.join()
    return during


def test_the_interpreter_goes_on_while_a_picture_is_measured() -> None:
    large = motion_blur.simulate((1024, 1024), 30.0, 40.0, noise_db=40.0, seed=1)
    meter = motion_blur.Meter()
    # A thread that has to wait for the lock wakes up once or twice; the picture takes hundreds of milliseconds.
    for work in [
        lambda: motion_blur.estimate(large),
        lambda: meter.measure(large),
        lambda: motion_blur.estimate_batch([large], threads=1),
        lambda: motion_blur.restore(large, motion_blur.Blur(30.0, 40.0)),
    ]:
        assert ticks_during(work) > 10


@pytest.mark.skipif(not Path("/proc/self/task").is_dir(), reason="needs /proc")
def test_threads_share_the_work() -> None:
    def busy() -> dict[str, int]:
        """Processor time of each thread, in ticks of the kernel."""
        used = {}
        for task in os.listdir("/proc/self/task"):
            try:
                fields = Path(f"/proc/self/task/{task}/stat").read_text().rpartition(")")[2].split()
            except OSError:
                continue
            used[task] = int(fields[11]) + int(fields[12])
        return used

    many = pictures(2, side=768) * 8
    before, most, done = set(busy()), dict[str, int](), threading.Event()

    def watch() -> None:
        while not done.wait(0.005):
            most.update(busy())

    watcher = threading.Thread(target=watch)
    watcher.start()
    motion_blur.estimate_batch(many, threads=2)
    done.set()
    watcher.join()
    workers = [used for task, used in most.items() if task not in before and task != str(watcher.native_id)]
    assert len(workers) == 2
    # Both worked side by side: neither did it nearly alone.
    assert min(workers) > 0.25 * sum(workers)


def test_a_batch_can_be_interrupted() -> None:
    many = pictures(2, side=512) * 500
    timer = threading.Timer(0.5, lambda: signal.raise_signal(signal.SIGINT))
    measured = []
    # Whoever starts the tests in the background may have Ctrl-C ignored.
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        timer.start()
        with pytest.raises(KeyboardInterrupt):
            measured = motion_blur.estimate_batch(many, threads=1)
        timer.join()
    finally:
        signal.signal(signal.SIGINT, before)
    assert measured == []


def test_one_meter_serves_several_threads() -> None:
    many = pictures(8)
    expected = [motion_blur.estimate(picture) for picture in many]
    meter = motion_blur.Meter()
    found: dict[int, Record] = {}

    def measure(k: int) -> None:
        found[k] = meter.measure(many[k])

    threads = [threading.Thread(target=measure, args=(k,)) for k in range(len(many))]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert [found[k] for k in range(len(many))] == expected
