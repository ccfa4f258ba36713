#!/usr/bin/env python3
"""Runs the tests on a GPU under compute-sanitizer, many at once, and prints a Markdown table of what came out.

    sanitize.py build/cuda/bin results.json [--tools memcheck,initcheck,racecheck] [--jobs 16] [--seconds 3600]

Tests that take long by themselves come last, and short ones share a process, as starting one takes seconds. A test that
has not ended after --limit seconds is cut off. With the results of an earlier run of the same build in the file, only
what was not clean in it is run. Ends with exit code 1 if anything was reported or a test failed.
"""

import argparse
import hashlib
import json
import os
import re
import select
import subprocess
import sys
import threading
import time
from collections import Counter
from pathlib import Path

BINARIES = ["weir_framework_tests", "weir_nodes_tests", "weir_outputs_tests", "weir_rendering_gl_tests",
            "weir_rendering_output_tests", "weir_studio_tests", "weir_apps_tests"]
RUN, ENDED = re.compile(r"\[ RUN      \] (\S+)"), re.compile(r"\[ +(OK|FAILED|SKIPPED) +\] ([^\s,]+).*\((\d+) ms\)")
QUIET = re.compile(r"^=========\s*(COMPUTE-SANITIZER|Target application returned|.*SUMMARY: |$)")
FOUND = re.compile(r"SUMMARY: [1-9]")
VERDICTS = ["clean", "skipped", "reported", "failed", "cut off", "not reached"]


def digest_of(folder):
    """Of the tests' programs and the libraries beside them, so that results of two builds are not mixed."""
    digest = hashlib.sha256()
    for file in sorted([*folder.glob("weir*"), *folder.glob("../lib/**/*.so")]):
        digest.update(file.read_bytes())
    return digest.hexdigest()


def plain_durations(program):
    """Milliseconds of each test by itself, without a sanitizer."""
    run = subprocess.run([program], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    return {test: int(ms) for _, test, ms in ENDED.findall(run.stdout)}


class Work:
    """What is still to do, and what came out; shared by all workers."""

    def __init__(self, options, results):
        self.options, self.results = options, results
        self.deadline = time.monotonic() + options.seconds
        self.lock = threading.Lock()
        self.batches = []  # of (tool, binary, tests), the next one last

    def next_batch(self):
        with self.lock:
            return self.batches.pop() if self.batches and time.monotonic() < self.deadline else None

    def again(self, tool, binary, tests):
        if tests:
            with self.lock:
                self.batches.append((tool, binary, tests))

    def note(self, tool, binary, test, verdict, seconds, report=()):
        with self.lock:
            entry = {"verdict": verdict, "seconds": round(seconds, 1)}
            if report:
                entry["report"] = list(report)[:40]
            self.results["tests"].setdefault(tool, {}).setdefault(binary, {})[test] = entry


def run_batch(work, gpu, tool, binary, tests):
    """Runs tests in one process. Those behind a test that is cut off are put back."""
    options, waiting = work.options, list(tests)
    command = [options.sanitizer, "--tool", tool, "--target-processes", "all", *options.tool_options.split(),
               options.folder / binary, "--gtest_color=no", "--gtest_filter=" + ":".join(tests)]
    environment = dict(os.environ, CUDA_VISIBLE_DEVICES=str(gpu))
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, env=environment, start_new_session=True)
    current, began, report, rest, found = None, time.monotonic(), [], b"", []
    while True:
        ready, _, _ = select.select([process.stdout], [], [], 0.5)
        data = os.read(process.stdout.fileno(), 1 << 16) if ready else None
        if data == b"":
            break
        *lines, rest = (rest + (data or b"")).split(b"\n")
        for line in (raw.decode(errors="replace") for raw in lines):
            if RUN.search(line):
                current, began, report = RUN.search(line).group(1), time.monotonic(), []
            elif line.startswith("=========") and not QUIET.match(line):
                report.append(line)
                found.append(line)
            elif FOUND.search(line) and not found:
                report.append(line)
            elif current and ENDED.search(line):
                verdict = "reported" if report else {"OK": "clean", "FAILED": "failed", "SKIPPED": "skipped"}[ENDED.search(line).group(1)]
                work.note(tool, binary, current, verdict, time.monotonic() - began, report)
                if current in waiting:
                    waiting.remove(current)
                current, began, report = None, time.monotonic(), []
        if time.monotonic() - began > options.limit or time.monotonic() > work.deadline:
            os.killpg(process.pid, 9)
            break
    process.wait()
    # What no test had begun, or a test that ended the process or was cut off: the first that waits.
    if waiting and (current or time.monotonic() < work.deadline):
        test = current or waiting[0]
        ended = time.monotonic() - began <= options.limit and time.monotonic() < work.deadline
        work.note(tool, binary, test, "reported" if report else "failed" if ended else "cut off", time.monotonic() - began, report)
        waiting = [other for other in waiting if other != test]
    elif report:
        # Found when the process ended: it belongs to the last test, or to any before it.
        work.note(tool, binary, tests[-1], "reported", time.monotonic() - began, report)
    work.again(tool, binary, waiting)


def batches_of(tool, binary, durations, results, seconds):
    """The tests that are not clean yet, the quickest first, in batches of that many seconds without a sanitizer."""
    known = results["tests"].get(tool, {}).get(binary, {})
    batch, total, batches = [], 0, []
    for test in sorted(durations, key=durations.get):
        if known.get(test, {}).get("verdict") in ("clean", "skipped"):
            continue
        known = results["tests"].setdefault(tool, {}).setdefault(binary, {})
        known[test] = {"verdict": "not reached"}
        if batch and total + durations[test] > 1000 * seconds:
            batches.append((total, (tool, binary, batch)))
            batch, total = [], 0
        batch.append(test)
        total += durations[test]
    return batches + ([(total, (tool, binary, batch))] if batch else [])


def table(results):
    lines = ["| | " + " | ".join(VERDICTS) + " |", "|---|" + "---:|" * len(VERDICTS)]
    for tool, binaries in results["tests"].items():
        for binary, tests in binaries.items():
            count = Counter(entry["verdict"] for entry in tests.values())
            lines.append(f"| {tool}, `{binary}` | " + " | ".join(str(count[verdict]) for verdict in VERDICTS) + " |")
    return "\n".join(lines)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path, help="of the tests' programs")
    parser.add_argument("results", type=Path, help="JSON to write, and to go on from")
    parser.add_argument("--binaries", default=",".join(BINARIES))
    parser.add_argument("--tools", default="memcheck,initcheck,racecheck")
    parser.add_argument("--sanitizer", default="compute-sanitizer", help="the program")
    parser.add_argument("--tool-options", default="", help="more options for it, as one text")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="processes at once")
    parser.add_argument("--gpus", type=int, default=1, help="to share them among")
    parser.add_argument("--batch", type=float, default=0.5, help="seconds of tests, by themselves, that share a process")
    parser.add_argument("--limit", type=float, default=600, help="seconds that a test may take under a sanitizer")
    parser.add_argument("--seconds", type=float, default=6 * 3600, help="after which all ends")
    options = parser.parse_args()

    binaries = [name for name in options.binaries.split(",") if (options.folder / name).exists()]
    if not binaries:
        sys.exit(f"error: no tests' program in {options.folder}\n  allowed: a folder with any of {options.binaries}")
    results = {"build": digest_of(options.folder), "durations": {}, "tests": {}}
    if options.results.exists():
        earlier = json.loads(options.results.read_text())
        if earlier["build"] != results["build"]:
            sys.exit(f"error: {options.results} has results of another build\n  hint: name another file")
        results = earlier
    for binary in binaries:
        if binary not in results["durations"]:
            results["durations"][binary] = plain_durations(options.folder / binary)

    work = Work(options, results)
    batches = [batch for tool in options.tools.split(",") for binary in binaries
               for batch in batches_of(tool, binary, results["durations"][binary], results, options.batch)]
    work.batches = [batch for _, batch in sorted(batches, key=lambda entry: entry[0], reverse=True)]

    def worker(index):
        while batch := work.next_batch():
            run_batch(work, index % options.gpus, *batch)

    workers = [threading.Thread(target=worker, args=(index,)) for index in range(options.jobs)]
    for thread in workers:
        thread.start()
    for thread in workers:
        thread.join()
    options.results.write_text(json.dumps(results, indent=1))
    print(table(results))
    bad = [(tool, test, entry) for tool, binaries in results["tests"].items() for tests in binaries.values()
           for test, entry in tests.items() if entry["verdict"] in ("reported", "failed")]
    for tool, test, entry in bad:
        print(f"{tool}: {test}: {entry['verdict']}", *entry.get("report", [])[:6], sep="\n  ")
    sys.exit(1 if bad else 0)


if __name__ == "__main__":
    main()
