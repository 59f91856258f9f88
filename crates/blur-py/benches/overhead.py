"""What a call from Python costs over the same call from Rust, in pairs one right after the other.

python crates/blur-py/benches/overhead.py PROGRAM [PAIRS]

PROGRAM is the example timed_meter of blur-core, built with the profile of the wheel:
cargo build --release -p blur-core --example timed_meter
"""

import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import motion_blur

SIDE = 512


def main() -> None:
    program, pairs = sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 100
    picture = motion_blur.simulate((SIDE, SIDE), 24.0, 30.0, noise_db=35.0, seed=1)
    meter = motion_blur.Meter()
    with tempfile.TemporaryDirectory() as folder:
        raw = Path(folder) / "picture.raw"
        raw.write_bytes(picture.tobytes())
        rust = subprocess.Popen(
            [program, str(raw), str(SIDE), str(SIDE)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        )
        assert rust.stdin is not None and rust.stdout is not None
        in_rust, in_python = [], []
        for pair in range(pairs + 5):
            rust.stdin.write("\n")
            rust.stdin.flush()
            nanoseconds, length = rust.stdout.readline().split()
            start = time.perf_counter_ns()
            record = meter.measure(picture)
            took = time.perf_counter_ns() - start
            assert record.length_px == float(length)
            # The first pairs fill caches and make plans.
            if pair >= 5:
                in_rust.append(int(nanoseconds))
                in_python.append(took)
        rust.stdin.close()
        rust.wait()
    differences = [python - rust for python, rust in zip(in_python, in_rust, strict=True)]
    typical = statistics.median(in_rust)
    print(f"{SIDE}x{SIDE}, {pairs} pairs, medians")
    print(f"  Rust    {typical / 1e6:8.3f} ms")
    print(f"  Python  {statistics.median(in_python) / 1e6:8.3f} ms")
    print(f"  more    {statistics.median(differences) / typical:+8.2%} of the call, by the median difference of a pair")


if __name__ == "__main__":
    main()
