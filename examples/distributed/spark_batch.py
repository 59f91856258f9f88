"""Measures the pictures in a folder on Spark: python spark_batch.py FOLDER -o records.parquet

Spark runs the task of a lost worker again. It needs Java 17.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from urllib.parse import unquote, urlparse

import pandas as pd
import pyarrow as pa
from pyspark.sql import SparkSession
from pyspark.sql.pandas.types import from_arrow_schema

import rows


def measure(batches: Iterator[pd.DataFrame]) -> Iterator[pd.DataFrame]:
    """One row for each file, through Arrow, which knows absent numbers from NaN."""
    for batch in batches:
        names = (unquote(urlparse(uri).path) for uri in batch["path"])
        found = [rows.row_of(name, content) for name, content in zip(names, batch["content"], strict=True)]
        table = pa.Table.from_pylist(found, schema=rows.SCHEMA)
        yield table.to_pandas(types_mapper=pd.ArrowDtype)


def session(workers: int) -> SparkSession:
    """A local session with one Python worker for each of `workers` slots; a task is tried four times."""
    # Workers run this Python: it has the package.
    os.environ["PYSPARK_PYTHON"] = sys.executable
    return (
        SparkSession.builder.master(f"local[{workers},4]")
        .config("spark.ui.enabled", "false")
        .config("spark.driver.host", "127.0.0.1")
        .config("spark.sql.execution.arrow.maxRecordsPerBatch", "16")
        # Small tasks: a lost one costs little, and the last one ends soon after the others.
        .config("spark.sql.files.maxPartitionBytes", str(1 << 20))
        .config("spark.executorEnv.PYTHONPATH", str(Path(__file__).parent))
        .getOrCreate()
    )


def run(folder: str, spark: SparkSession) -> list[dict[str, Any]]:
    """The rows of all pictures."""
    for module in ("rows.py", "spark_batch.py"):
        spark.sparkContext.addPyFile(str(Path(__file__).parent / module))
    files = spark.read.format("binaryFile").option("pathGlobFilter", "*.{png,jpg,jpeg,tif,tiff,PNG,JPG,JPEG,TIF,TIFF}")
    measured = files.load(folder).select("path", "content").mapInPandas(measure, from_arrow_schema(rows.SCHEMA))
    return [row.asDict() for row in measured.collect()]


def main() -> None:
    given = rows.arguments("Spark")
    spark = session(given.workers)
    rows.write(run(given.folder, spark), given.output)
    spark.stop()


if __name__ == "__main__":
    main()
