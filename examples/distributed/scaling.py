"""How many pictures a second one process and two workers of each engine measure: python scaling.py [COUNT] [SIDE]

The share lost to the engine is 1 - (rate of two workers) / (twice the rate of one process); on a machine with two processors
that holds what the processes take from each other, too. Starting the cluster is not counted, its first pictures are.
"""

from __future__ import annotations

import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import rows
from conftest import fill


def timed(work: Callable[[], list[dict[str, Any]]], count: int) -> float:
    """Pictures a second."""
    start = time.perf_counter()
    found = work()
    assert len(found) == count
    return count / (time.perf_counter() - start)


def main() -> None:
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 400
    side = int(sys.argv[2]) if len(sys.argv) > 2 else 512
    with tempfile.TemporaryDirectory() as folder:
        fill(Path(folder), count, side)
        paths = rows.pictures_in(folder)
        total = len(paths)
        one = timed(lambda: [rows.row_of(str(path), path.read_bytes()) for path in paths], total)
        print(f"{total} pictures of {side}x{side}, {sum(path.stat().st_size for path in paths) / total / 1e3:.0f} kB each")
        print(f"  one process         {one:7.1f} pictures/s  {1e3 / one:6.2f} ms a picture", flush=True)
        for name, engine in [("Ray Data", ray_rate), ("Dask", dask_rate), ("Spark", spark_rate)]:
            rate = engine(folder, total)
            print(f"  {name:10} 2 workers {rate:6.1f} pictures/s  {1 - rate / (2 * one):6.1%} lost", flush=True)


def ray_rate(folder: str, total: int) -> float:
    import ray

    import ray_batch

    ray_batch.start(2)
    rate = timed(lambda: ray_batch.run(folder, 2), total)
    ray.shutdown()
    return rate


def dask_rate(folder: str, total: int) -> float:
    from distributed import Client

    import dask_batch

    with dask_batch.cluster(2) as cluster, Client(cluster) as client:
        return timed(lambda: dask_batch.run(folder, client), total)


def spark_rate(folder: str, total: int) -> float:
    import spark_batch

    spark = spark_batch.session(2)
    rate = timed(lambda: spark_batch.run(folder, spark), total)
    spark.stop()
    return rate


if __name__ == "__main__":
    main()
