"""Measures the pictures in a folder on Dask: python dask_batch.py FOLDER -o records.parquet

Dask runs the tasks of a lost worker again, and starts another worker.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import dask.bag
from distributed import Client, LocalCluster

import rows


def measure(path: str) -> dict[str, Any]:
    """The row of a file, which is read where it is measured."""
    return rows.row_of(path, rows.read_bytes(path))


def run(folder: str, client: Client) -> list[dict[str, Any]]:
    """The rows of all pictures."""
    paths = [str(path) for path in rows.pictures_in(folder)]
    if not paths:
        return []
    bag = dask.bag.from_sequence(paths, npartitions=min(len(paths), 1000))
    found: list[dict[str, Any]] = client.compute(bag.map(measure)).result()
    return found


def cluster(workers: int) -> LocalCluster:
    """A local cluster: processes with one thread each, which know this folder."""
    made = LocalCluster(n_workers=workers, threads_per_worker=1, processes=True, dashboard_address=None)
    folder = str(Path(__file__).parent)
    with Client(made) as client:
        client.run(add_to_path, folder)
    return made


def add_to_path(folder: str) -> None:
    """Lets a worker import what lies beside this file."""
    import sys

    if folder not in sys.path:
        sys.path.insert(0, folder)


def main() -> None:
    given = rows.arguments("Dask")
    with cluster(given.workers) as made, Client(made) as client:
        rows.write(run(given.folder, client), given.output)


if __name__ == "__main__":
    main()
