#!/usr/bin/env python3
"""Runs a small scene with every output and makes one call of the C library fail, for each call in turn.

  faults.py --weir build/cpu/bin/weir --layer build/cpu/lib/weir/faults/failing_calls.so [--seconds 40]
            [--device cpu] [--scenario NAME]... [--all] [--after CALL] [--places 2] [--within SECONDS] [--jobs 1] [--seed 1]

Whatever fails, the run must end with exit code 4 or 5 and a message that names the file (or with 0 and all
outputs as they would have been), without a signal and in time; what is there then must be whole, and nothing else
may be left. Where an allocation inside of HDF5 fails, HDF5 itself may crash or exit: the run leaves then what a kill
leaves. Where one of a static object of a plugin's library fails, that library may crash, and so may the loader where one of
its own does: nothing is written then.
SCENARIOS has what can fail and how. Without --all, a sample of the calls is tried that fits into --seconds. Found
failures are printed with the command that shows them again.

Exit codes: 0 if all is well, 1 if something is wrong, 3 if no try was wrong and --within was over before the last one.
"""
import argparse
import collections
import concurrent.futures
import json
import os
import random
import shlex
import shutil
import struct
import subprocess
import sys
import tempfile
import time

HERE = os.path.dirname(os.path.abspath(__file__))
SCENE = os.path.join(HERE, "block.json")

DATA = ["--export", "run.vtkhdf", "--export-surface", "skin.vtkhdf", "--ply-particles", "particles",
        "--ply", "ply", "--obj", "obj", "--checkpoint", "run.h5", "--checkpoint-every", "6",
        "--stats", "run.json", "--series", "run.jsonl"]
PICTURES = ["--images", "images", "--checkpoint", "run.h5", "--checkpoint-every", "12"]
RANKS = ["--ranks", "2", "--set", "export.by_rank=true", "--export", "run.vtkhdf", "--checkpoint", "run.h5",
         "--checkpoint-every", "6"]
VIDEO = ["--video", "run.mp4", "--checkpoint", "run.h5", "--checkpoint-every", "12"]

Scenario = collections.namedtuple("Scenario", "name outputs call error program")
SCENARIOS = [
    # name                     outputs   call      fails as   in
    Scenario("open",           DATA,     "open",   "EMFILE",  "weir"),
    Scenario("open-io",        DATA,     "open",   "EIO",     "weir"),
    Scenario("write-full",     DATA,     "write",  "ENOSPC",  "weir"),
    Scenario("write-short",    DATA,     "write",  "short",   "weir"),
    Scenario("write-io",       DATA,     "write",  "EIO",     "weir"),
    Scenario("write-again",    DATA,     "write",  "EINTR",   "weir"),
    Scenario("fsync",          DATA,     "fsync",  "EIO",     "weir"),
    Scenario("rename",         DATA,     "rename", "EIO",     "weir"),
    Scenario("close",          DATA,     "close",  "EIO",     "weir"),
    Scenario("memory",         DATA,     "malloc", "ENOMEM",  "weir"),
    Scenario("memory-hdf5",    DATA,     "malloc-hdf5", "ENOMEM", "weir"),
    Scenario("memory-load",    DATA,     "malloc-load", "ENOMEM", "weir"),
    Scenario("ranks-open",     RANKS,    "open",   "EIO",     "weir"),
    Scenario("ranks-write",    RANKS,    "write",  "ENOSPC",  "weir"),
    Scenario("ranks-fsync",    RANKS,    "fsync",  "EIO",     "weir"),
    Scenario("ranks-rename",   RANKS,    "rename", "EIO",     "weir"),
    Scenario("images-open",    PICTURES, "open",   "EMFILE",  "weir"),
    Scenario("images-write",   PICTURES, "write",  "ENOSPC",  "weir"),
    Scenario("images-short",   PICTURES, "write",  "short",   "weir"),
    Scenario("images-rename",  PICTURES, "rename", "EIO",     "weir"),
    Scenario("images-close",   PICTURES, "close",  "EIO",     "weir"),
    Scenario("video-open",     VIDEO,    "open",   "EMFILE",  "weir"),
    Scenario("video-write",    VIDEO,    "write",  "ENOSPC",  "weir"),
    Scenario("video-fsync",    VIDEO,    "fsync",  "EIO",     "weir"),
    Scenario("video-rename",   VIDEO,    "rename", "EIO",     "weir"),
    Scenario("device-memory",  DATA,     "device", "ENOMEM",  "weir"),  # a block of the device's memory pool
    Scenario("encoder-open",   VIDEO,    "open",   "EIO",     "ffmpeg"),
    Scenario("encoder-write",  VIDEO,    "write",  "ENOSPC",  "ffmpeg"),
]

# What a run may leave beside the files of a run that ended well: the checkpoint before the last one.
EXTRA = {"run.previous.h5"}
# Not the same from run to run: times, and what ffmpeg makes of its threads.
VARYING = (".json", ".jsonl", ".h5", ".hdf5", ".vtkhdf", ".mp4")
# The loader of glibc 2.39 ends a program where some of its own allocations fail, before anything is written: this one, or the
# copy in which a plugin is tried.
LOADER_ENDED = ("Inconsistency detected by ld.so", "when they are made, with exit code 127")
LIMIT = 60  # seconds for a run that takes a tenth of one
NOT_TO_THE_END = 3


def files_in(folder):
    found = set()
    for where, _, names in os.walk(folder):
        found.update(os.path.relpath(os.path.join(where, name), folder) for name in names)
    return found


def contents(path):
    with open(path, "rb") as file:
        return file.read()


class Faults:
    def __init__(self, weir, layer, device, where):
        self.weir, self.layer, self.where = os.path.abspath(weir), os.path.abspath(layer), where
        self.device, self.references = device, {}

    def arguments(self, scenario, folder):
        outputs = [word if word.startswith("--") or word.isdigit() or "=" in word else os.path.join(folder, word)
                   for word in scenario.outputs]
        return [self.weir, "run", SCENE, "--quiet", "--device", self.device, "--threads", "1"] + outputs

    def run(self, scenario, folder, at=0, places=None):
        """The finished process, and how many calls there were; counts are of a run that ended by itself."""
        counts = folder + ".counts"
        environment = dict(os.environ, LD_PRELOAD=self.layer, WEIR_FAULT_PROGRAM=scenario.program,
                           WEIR_FAULT_FOLDER=folder + "/", WEIR_FAULT_CALL=scenario.call,
                           WEIR_FAULT_AT=str(at), WEIR_FAULT_AS=scenario.error, WEIR_FAULT_COUNTS=counts,
                           WEIR_FAULT_FROM=folder + ".from")
        if places is not None:
            environment["WEIR_FAULT_PLACES"] = places
        if scenario.call == "device":
            environment["WEIR_TEST_FAIL_ALLOCATION"] = str(at)
        os.makedirs(folder)
        command = self.arguments(scenario, folder)
        try:
            done = subprocess.run(command, env=environment, capture_output=True, text=True, errors="replace",
                                  timeout=LIMIT)
        except subprocess.TimeoutExpired:
            return None, {}
        numbers = {}
        if os.path.exists(counts):
            with open(counts, encoding="ascii") as file:
                for name, number in (line.split() for line in file):  # once for each process
                    numbers[name] = max(numbers.get(name, 0), int(number))
            os.remove(counts)
        return done, numbers

    def reference(self, scenario):
        """The folder of a run in which nothing failed, and its numbers of calls."""
        wants_room = scenario.error in ("ENOSPC", "short")  # then only writes count that make a file larger
        key = (tuple(scenario.outputs), scenario.program, wants_room)
        if key not in self.references:
            folder = os.path.join(self.where, f"whole{len(self.references)}")
            done, numbers = self.run(scenario._replace(call="none"), folder)
            if done is None or done.returncode != 0:
                sys.exit("the run without a fault failed: " + (done.stderr if done else "it did not end"))
            if "--stats" in scenario.outputs:
                with open(os.path.join(folder, "run.json"), encoding="utf-8") as file:
                    numbers["device"] = json.load(file)["memory"]["device_allocations"]
            self.references[key] = folder, numbers
        return self.references[key]

    def calls_by_place(self, scenario, most):
        """At most so many calls from each place, the first, the last and between; all where places are not known."""
        folder = os.path.join(self.where, "places")
        try:
            done, _ = self.run(scenario, folder, places=folder + ".numbers")
            if done is None or done.returncode != 0 or not os.path.exists(folder + ".numbers"):
                sys.exit("no places are known of " + scenario.name)
            with open(folder + ".numbers", "rb") as file:
                numbers = file.read()
        finally:
            shutil.rmtree(folder, ignore_errors=True)
        calls = collections.defaultdict(list)
        for call, (place,) in enumerate(struct.iter_unpack("=Q", numbers), 1):
            calls[place].append(call)
        print(f"{scenario.name}: {len(numbers) // 8} calls from {len(calls)} places", flush=True)
        spread = ([of[k * (len(of) - 1) // max(1, most - 1)] for k in range(most)] for of in calls.values())
        return sorted(set(sum(spread, [])))

    def parts_in_use(self, folder):
        """The parts that checkpoints of several ranks name."""
        names = [os.path.join(folder, name) for name in ("run.h5", "run.previous.h5") if name in files_in(folder)]
        if not names:
            return set()
        info = subprocess.run([self.weir, "info"] + names, capture_output=True, text=True, timeout=LIMIT)
        told = [line.split(": ", 2)[2] for line in info.stdout.splitlines() if line.startswith("  other files: ")]
        return set(", ".join(told).split(", "))

    def damaged(self, folder):
        """What `weir info` says against checkpoints and exports, and ffprobe against videos."""
        files = sorted(os.path.join(folder, name) for name in files_in(folder) if name.endswith((".h5", ".vtkhdf")))
        said = ""
        if files:
            info = subprocess.run([self.weir, "info"] + files, capture_output=True, text=True, timeout=LIMIT)
            said = info.stderr if info.returncode != 0 else ""
        for name in sorted(name for name in files_in(folder) if name.endswith(".mp4")):
            probe = subprocess.run(["ffprobe", "-v", "error", "-count_frames", "-show_entries", "stream=nb_read_frames",
                                    "-of", "csv=p=0", os.path.join(folder, name)], capture_output=True, text=True,
                                   timeout=LIMIT)
            if probe.stderr or not probe.stdout.strip(", \n").isdigit():
                said += f"{name}: {probe.stderr.strip() or 'no frames'}"
        return said

    def check(self, scenario, at, folder):
        """What is wrong, as a text; "" if nothing is."""
        whole, _ = self.reference(scenario)
        done, _ = self.run(scenario, folder, at)
        if done is None:
            return f"did not end within {LIMIT} s"
        said = done.stderr.strip()
        may_end_as_if_killed = scenario.call == "malloc-hdf5"
        if scenario.call == "malloc" and any(text in said for text in LOADER_ENDED):
            return "left over: " + ", ".join(sorted(files_in(folder))) if files_in(folder) else ""
        expected, found = files_in(whole), files_in(folder)
        if done.returncode < 0 and scenario.call == "malloc-load":
            return "left over: " + ", ".join(sorted(found)) if found else ""
        if done.returncode < 0 and not may_end_as_if_killed:
            return f"ended by signal {-done.returncode}: {said[-400:]}"
        if may_end_as_if_killed and done.returncode != 0:
            return self.damaged(folder)
        problems = []
        if done.returncode not in (0, 4, 5):
            problems.append(f"exit code {done.returncode}: {said[-400:]}")
        if done.returncode != 0:
            if "error: " not in said:
                problems.append("no error message")
            elif not scenario.call.startswith("malloc") and scenario.call != "device" and folder not in said.split("error: ", 1)[1]:
                problems.append("the message does not name the file: " + said[-300:])
        # Which parts there must be says the checkpoint, and `weir info` misses them.
        expected = {name for name in expected if ".parts/" not in name}
        if done.returncode == 0 and expected - found:
            problems.append("exit code 0, but these are missing: " + ", ".join(sorted(expected - found)))
        left = found - EXTRA - expected - self.parts_in_use(folder)
        if left:
            problems.append("left over: " + ", ".join(sorted(left)) + ": " + said[-300:])
        for name in sorted(found & expected):
            if not name.endswith(VARYING) and contents(os.path.join(folder, name)) != contents(os.path.join(whole, name)):
                problems.append(f"{name} is not what it would have been (exit code {done.returncode})")
        broken = self.damaged(folder)
        if broken:
            problems.append("damaged: " + broken.strip()[-400:])
        return "; ".join(problems)

    def trial(self, scenario, at):
        folder = os.path.join(self.where, f"{scenario.name}-{at}")
        try:
            problem = self.check(scenario, at, folder)
        finally:
            shutil.rmtree(folder, ignore_errors=True)
        callers = ""
        if os.path.exists(folder + ".from"):
            with open(folder + ".from", encoding="utf-8", errors="replace") as file:
                callers = "".join("    from " + os.path.basename(line) for line in file.readlines()[3:15])
            os.remove(folder + ".from")
        if problem:
            device = {"WEIR_TEST_FAIL_ALLOCATION": at} if scenario.call == "device" else {}
            settings = {**device, "LD_PRELOAD": self.layer, "WEIR_FAULT_PROGRAM": scenario.program,
                        "WEIR_FAULT_FOLDER": folder + "/", "WEIR_FAULT_CALL": scenario.call, "WEIR_FAULT_AT": at,
                        "WEIR_FAULT_AS": scenario.error}
            command = [f"{name}={value}" for name, value in settings.items()] + self.arguments(scenario, folder)
            print(f"FAILED {scenario.name} {at}: {problem}\n    mkdir {folder}; " + shlex.join(command) + "\n" + callers, end="", flush=True)
        return not problem


def options_of(arguments):
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--weir", required=True)
    parser.add_argument("--layer", required=True)
    parser.add_argument("--device", default="cpu", help="of the runs: cpu or cuda")
    parser.add_argument("--scenario", action="append", help="of SCENARIOS; all without it")
    parser.add_argument("--all", action="store_true", help="every call, however long it takes")
    parser.add_argument("--at", type=int, action="append", help="this call only")
    parser.add_argument("--after", type=int, default=0, help="calls after this one only")
    parser.add_argument("--most", type=int, default=0, help="at most that many calls of a scenario, evenly spread")
    parser.add_argument("--places", type=int, default=0,
                        help="at most that many calls that come from the same functions, the first and the last among them")
    parser.add_argument("--seconds", type=float, default=40, help="of a sample")
    parser.add_argument("--within", type=float, help="seconds after which no further call is tried")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args(arguments)
    unknown = set(options.scenario or []) - {s.name for s in SCENARIOS}
    if unknown:
        parser.error("no scenario is called " + ", ".join(sorted(unknown)))
    if options.places and {"device-memory"} & set(options.scenario or ["device-memory"]):
        parser.error("--places wants scenarios of calls of the C library, which device-memory is not")
    options.sampled = not (options.all or options.at or options.places)
    return options


def calls_to_try(faults, scenario, options, seed):
    if options.at:
        return options.at
    if options.places:
        calls = faults.calls_by_place(scenario, options.places)
    else:
        calls = list(range(1, faults.reference(scenario)[1].get(scenario.call, 0) + 1))
    calls = [call for call in calls if call > options.after]
    if options.most and len(calls) > options.most:
        step = len(calls) / options.most
        calls = [calls[int(k * step)] for k in range(options.most)]
    if options.sampled:
        random.Random(seed).shuffle(calls)
    return calls


class Tries:
    """Counts tries, and says every ten seconds how far they are."""

    def __init__(self, total, limit):
        self.start = self.said = time.monotonic()
        self.total, self.limit, self.tried, self.bad = total, limit, collections.Counter(), collections.Counter()

    def is_over(self):
        return self.limit is not None and time.monotonic() - self.start > self.limit

    def note(self, scenario, well):
        self.tried[scenario.name] += 1
        self.bad[scenario.name] += not well
        now = time.monotonic()
        if now - self.said > 10:
            self.said = now
            print(f"{scenario.name}: {sum(self.tried.values())} of {self.total}, {sum(self.bad.values())} wrong, "
                  f"{now - self.start:.0f} s", file=sys.stderr, flush=True)


def main():
    options = options_of(sys.argv[1:])
    scenarios = [s for s in SCENARIOS if not options.scenario or s.name in options.scenario]
    if shutil.which("ffmpeg") is None or shutil.which("ffprobe") is None:
        scenarios = [s for s in scenarios if s.outputs is not VIDEO]

    with tempfile.TemporaryDirectory(prefix="weir-faults-") as where, \
            concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        faults = Faults(options.weir, options.layer, options.device, where)
        for scenario in scenarios:
            faults.reference(scenario)
        lists = {s.name: calls_to_try(faults, s, options, options.seed + k) for k, s in enumerate(scenarios)}
        if options.sampled:  # one of each scenario in turn
            longest = max(map(len, lists.values()))
            work = [(s, lists[s.name][k]) for k in range(longest) for s in scenarios if k < len(lists[s.name])]
        else:
            work = [(scenario, at) for scenario in scenarios for at in lists[scenario.name]]
        tries = Tries(len(work), options.seconds if options.sampled else options.within)

        def attempt(scenario, at):
            if not tries.is_over():
                tries.note(scenario, faults.trial(scenario, at))

        for done in [pool.submit(attempt, *item) for item in work]:
            done.result()
    for scenario in scenarios:
        print(f"{scenario.name:15} {len(lists[scenario.name]):7} calls, {tries.tried[scenario.name]:6} failed in turn, "
              f"{tries.bad[scenario.name]} wrong")
    tried, bad = sum(tries.tried.values()), sum(tries.bad.values())
    print(f"{tried} runs in {time.monotonic() - tries.start:.0f} s, {bad} wrong")
    if not all(lists.values()):
        print("a scenario has no calls")
        return 1
    if bad:
        return 1
    if not options.sampled and tried < len(work):
        print(f"not to the end: {len(work) - tried} calls were not tried")
        return NOT_TO_THE_END
    return 0


if __name__ == "__main__":
    sys.exit(main())
