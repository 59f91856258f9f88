"""Each engine with two workers finds the bits of one process, and loses nothing when a worker is killed."""

import json
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pyarrow.parquet as pq
import pytest

import rows
from conftest import COUNT

Rows = list[dict[str, Any]]
Run = Callable[[str], Rows]


@pytest.fixture(scope="module")
def on_ray() -> Iterator[Run]:
    import ray

    import ray_batch

    yield lambda folder: ray_batch.run(folder, 2, 4)
    ray.shutdown()


@pytest.fixture(scope="module")
def on_dask() -> Iterator[Run]:
    from distributed import Client

    import dask_batch

    with dask_batch.cluster(2) as cluster, Client(cluster) as client:
        yield lambda folder: dask_batch.run(folder, client)


@pytest.fixture(scope="module")
def on_spark() -> Iterator[Run]:
    import spark_batch

    spark = spark_batch.session(2)
    yield lambda folder: spark_batch.run(folder, spark)
    spark.stop()


ENGINES = ["on_ray", "on_dask", "on_spark"]


def by_name(found: Rows) -> Rows:
    return sorted(found, key=lambda row: str(row["name"]))


@pytest.mark.parametrize("engine", ENGINES)
def test_two_workers_find_the_bits_of_one_process(
    engine: str, folder: Path, expected: Rows, request: pytest.FixtureRequest
) -> None:
    run: Run = request.getfixturevalue(engine)
    found = by_name(run(str(folder)))
    # Equal doubles are equal bits here: no field is NaN.
    assert found == by_name(expected)
    errors = {Path(row["name"]).name: row["error"] for row in found if row["error"]}
    assert sorted(errors) == ["damaged.png", "empty.png"] and len(found) == COUNT + 2
    assert "all pixels have the value 0" in errors["empty.png"]


def descendants(root: int) -> dict[int, str]:
    """The command lines of all processes below one."""
    parents, lines = {}, {}
    for entry in os.listdir("/proc"):
        if entry.isdigit():
            try:
                stat = Path(f"/proc/{entry}/stat").read_text().rpartition(")")[2].split()
                lines[int(entry)] = Path(f"/proc/{entry}/cmdline").read_bytes().replace(b"\0", b" ").decode()
            except OSError:
                continue
            parents[int(entry)] = int(stat[1])

    def is_below(process: int) -> bool:
        while process in parents:
            process = parents[process]
            if process == root:
                return True
        return False

    return {process: line for process, line in lines.items() if is_below(process)}


# How the command line of a process tells that it is a worker, once it has been given work.
WORKER: dict[str, Callable[[str], bool]] = {
    "on_ray": lambda line: line.startswith("ray::") and "MapBatches" in line,
    "on_dask": lambda line: "spawn_main" in line and "resource_tracker" not in line,
    "on_spark": lambda line: "pyspark.daemon" in line,
}


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.skipif(not Path("/proc").is_dir(), reason="finds workers in /proc")
def test_a_killed_worker_loses_nothing(
    engine: str, folder: Path, expected: Rows, request: pytest.FixtureRequest
) -> None:
    run: Run = request.getfixturevalue(engine)
    killed: list[int] = []
    done = threading.Event()

    def is_working(process: int) -> bool:
        """Whether it uses a processor now: then it is in the middle of a picture."""
        try:
            return Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0] == "R"
        except OSError:
            return False

    def kill() -> None:
        while not done.is_set() and not killed:
            for process, line in descendants(os.getpid()).items():
                # The daemon of Spark, which forks the workers, sleeps.
                if WORKER[engine](line) and is_working(process):
                    os.kill(process, signal.SIGKILL)
                    killed.append(process)
                    break
            time.sleep(0.01)

    killer = threading.Thread(target=kill)
    killer.start()
    try:
        found = by_name(run(str(folder)))
    finally:
        done.set()
        killer.join()
    assert killed, "no worker was seen at work"
    assert found == by_name(expected)


@pytest.mark.parametrize("program", ["ray_batch.py", "dask_batch.py", "spark_batch.py"])
def test_programs_write_a_row_for_each_picture(program: str, folder: Path, expected: Rows, tmp_path: Path) -> None:
    here = Path(__file__).parent
    output = tmp_path / "records.parquet"
    subprocess.run([sys.executable, here / program, folder, "-o", output], check=True, capture_output=True, timeout=300)
    table = pq.read_table(output)
    assert table.schema.equals(rows.SCHEMA) and table.to_pylist() == by_name(expected)


def test_lines_leave_out_what_is_absent(expected: Rows, tmp_path: Path) -> None:
    rows.write(expected, str(tmp_path / "records.jsonl"))
    lines = [json.loads(line) for line in (tmp_path / "records.jsonl").read_text().splitlines()]
    present = [{name: value for name, value in row.items() if value is not None} for row in by_name(expected)]
    assert lines == present and all("error" in line or "length_px" in line for line in lines)
