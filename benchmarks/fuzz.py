"""Hostile files: a fuzzer that is guided by coverage, over all sections of whole containers.

The core, with AddressSanitizer and UndefinedBehaviorSanitizer compiled in, decodes what libFuzzer
makes of the golden files, the refused files and files of a few faces: payloads are mutated, lengths
mended, checksums taken as right (`tests/fuzz`). The first executions keep whatever passes an edge
of the core another number of times; the rest only what reaches new edges, so that their files are
smaller. For clang and its libFuzzer; the seeds need the dependencies of the tests.

    python benchmarks/fuzz.py --runs 10000000
    python benchmarks/fuzz.py --runs 10000000 --folder FOLDER     keeps the corpus and the findings
"""

from __future__ import annotations

import argparse
import os
import re
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import NamedTuple

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "fuzz"))

from harness import build, clang
from seeds import write_seeds

MOST_BYTES = 600  # of a file
COUNTED_SHARE = 0.1  # of the executions
SECONDS, MEGABYTES = 10, 2048  # that an execution may take, and that all may
OPTIONS = ("-entropic=0", f"-max_len={MOST_BYTES}", f"-timeout={SECONDS}")
LIMITS = (f"-rss_limit_mb={MEGABYTES}", "-print_final_stats=1")
ENVIRONMENT = {
    "ASAN_OPTIONS": "detect_leaks=0:allocator_may_return_null=0",
    "UBSAN_OPTIONS": "print_stacktrace=1:halt_on_error=1",
}


class Result(NamedTuple):
    """What libFuzzer says of its executions."""

    runs: int
    edges: int
    features: int
    corpus: int
    seconds: float


def run(program: Path, folder: Path, runs: int, counters: bool, seed: int) -> Result:
    """Run the fuzzer over the corpus of a folder; `counters`: as the first executions are."""
    own = ("-use_counters=1" if counters else "-use_counters=0", f"-runs={runs}", f"-seed={seed}")
    prefix = f"-artifact_prefix={folder / 'findings'}{os.sep}"
    begin = time.perf_counter()
    log = folder / f"log-{seed}.txt"
    with log.open("wb") as output:
        subprocess.run(
            [program, *OPTIONS, *LIMITS, *own, prefix, folder / "corpus", folder / "seeds"],
            stdout=output,
            stderr=subprocess.STDOUT,
            env=os.environ | ENVIRONMENT,
        )
    seconds = time.perf_counter() - begin
    printed = log.read_text(encoding="utf-8", errors="replace")
    lines = re.findall(r"^#(\d+)\s.*?cov: (\d+) ft: (\d+) corp: (\d+)/", printed, re.MULTILINE)
    if not lines:
        sys.exit(f"the fuzzer has not run:\n{printed[-4000:]}")
    total = re.search(r"number_of_executed_units:\s*(\d+)", printed)
    last = [int(number) for number in lines[-1]]
    return Result(int(total[1]) if total else last[0], *last[1:], seconds)


def fuzz(folder: Path, runs: int) -> int:
    """Build, write the seeds, run, print a table; return how many findings there are."""
    compiler = clang()
    if compiler is None:
        sys.exit("clang and its libFuzzer are needed: in Debian, clang and libclang-rt-dev")
    for name in ("corpus", "findings", "objects"):
        (folder / name).mkdir(parents=True, exist_ok=True)
    program = build(folder / "objects", [compiler], fuzzer=True)
    count = write_seeds(folder / "seeds")
    print(f"{count} seeds", flush=True)
    print("executions  a second  edges  features  corpus", flush=True)
    first = round(COUNTED_SHARE * runs)
    for seed, (part, counters) in enumerate(((first, True), (runs - first, False)), 1):
        done = run(program, folder, part, counters, seed)
        rate = done.runs / done.seconds
        row = f"{done.runs:10} {rate:9.0f} {done.edges:6} {done.features:9} {done.corpus:7}"
        print(row, flush=True)
        findings = sorted((folder / "findings").iterdir())
        if findings:
            break
    print(f"{len(findings)} findings", *findings)
    return len(findings)


def parser() -> argparse.ArgumentParser:
    """Return the parser of the command line."""
    made = argparse.ArgumentParser(description="Decode mutated files, guided by coverage.")
    made.add_argument("--runs", type=int, default=10_000_000, help="executions")
    made.add_argument("--folder", type=Path, help="keep corpus, findings and logs there")
    return made


def main() -> None:
    """Fuzz, in a folder that is removed unless it is named."""
    arguments = parser().parse_args()
    with tempfile.TemporaryDirectory() as work:
        if fuzz(arguments.folder or Path(work), arguments.runs):
            sys.exit(1)


if __name__ == "__main__":
    main()
