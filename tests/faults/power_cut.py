#!/usr/bin/env python3
"""Cuts the power of a run with checkpoints, at any moment, and looks whether it can be resumed.

  power_cut.py --weir build/cpu/bin/weir --layer build/cpu/lib/weir/faults/failing_calls.so [--trials 50] [--seed 1]

The layer under the program records what it does to the files of its checkpoints: the bytes that it writes, what it
syncs, its names. A trial takes a moment of that record and rebuilds what a disk may hold after a power cut then. What
was synced is there. Of what was not, each write (in pieces of 512 bytes) and each change of a name is there or is
not, whatever came before or after it; room that was taken and not written is zeros. Then the checkpoint at its path,
or else the one before it (NAME.previous.h5), must be whole and not older than the last one whose names were synced.
Some of them are resumed to the end.
"""
import argparse
import bisect
import collections
import os
import random
import shutil
import subprocess
import sys
import tempfile

HERE = os.path.dirname(os.path.abspath(__file__))
SCENE = os.path.join(HERE, "block.json")
PIECE = 512
FRAME = "  frame: "

Entry = collections.namedtuple("Entry", "what file where data")


def run(weir, *arguments, **more):
    return subprocess.run([weir, *arguments], capture_output=True, text=True, errors="replace", timeout=900, **more)


def read_record(path):
    """What was done, in order: writes and syncs of files (by number), and names that were given and taken."""
    with open(path, "rb") as file:
        while line := file.readline():
            what, _, rest = line[:-1].decode().partition(" ")
            if what == "write":
                number, offset, size = map(int, rest.split())
                yield Entry("write", number, offset, file.read(size))
            elif what in ("truncate", "allocate"):
                number, size = map(int, rest.split())
                yield Entry(what, number, size, None)
            elif what == "fsync":
                yield Entry("fsync", int(rest), 0, None)
            elif what == "create":
                number, _, name = rest.partition(" ")
                yield Entry("create", int(number), name, None)
            elif what == "unlink":
                yield Entry("unlink", 0, rest, None)
            else:  # rename and link
                yield Entry(what, 0, *rest.split("\t"))


class Disk:
    """What is on the disk for sure, what may be on it, and which names the files have for the program."""

    def __init__(self, folder, folder_number, rng):
        self.folder, self.folder_number, self.rng = folder, folder_number, rng
        self.names = {}  # of the program
        self.pending_names = []  # [{name: number or None}]
        self.synced_names = {}
        self.synced = collections.defaultdict(bytearray)
        self.pending = collections.defaultdict(list)

    def apply(self, entry):
        if entry.what in ("write", "truncate", "allocate"):
            self.pending[entry.file].append(entry)
        elif entry.what == "fsync" and entry.file == self.folder_number:
            for change in self.pending_names:
                self.synced_names.update(change)
            self.pending_names = []
        elif entry.what == "fsync":
            for write in self.pending.pop(entry.file, []):
                self.put(self.synced[entry.file], write)
        elif entry.what == "create":
            self.change({entry.where: entry.file})
        elif entry.what == "unlink":
            self.change({entry.where: None})
        elif entry.what == "link":
            self.change({entry.data: self.names.get(entry.where)})
        elif entry.what == "rename":
            self.change({entry.data: self.names.get(entry.where), entry.where: None})

    def change(self, change):
        self.names.update(change)
        self.pending_names.append(change)

    @staticmethod
    def put(content, entry):
        if entry.what == "truncate":
            del content[entry.where:]
        size = entry.where + len(entry.data) if entry.what == "write" else entry.where
        content.extend(bytes(max(0, size - len(content))))
        if entry.what == "write":
            content[entry.where:size] = entry.data

    def pieces(self, entry):
        if entry.what != "write":
            return [entry]
        return [Entry("write", entry.file, entry.where + at, entry.data[at:at + PIECE])
                for at in range(0, len(entry.data), PIECE)]

    def after_cut(self, to):
        """Writes one of the states that the disk may be in into an empty folder."""
        kept = self.rng.choice([0.0, 0.5, 0.9, 1.0])  # from nothing to all of what was not synced
        names = dict(self.synced_names)
        for change in self.pending_names:
            if self.rng.random() < self.rng.choice([0.0, 0.5, 1.0]):
                names.update(change)
        for name, number in names.items():
            if number is None:
                continue
            content = bytearray(self.synced[number])
            for entry in self.pending[number]:
                for piece in self.pieces(entry):
                    if self.rng.random() < kept:
                        self.put(content, piece)
            with open(os.path.join(to, os.path.basename(name)), "wb") as file:
                file.write(content)


def frames_of(weir, files):
    """The frame of each checkpoint that is whole."""
    found, file = {}, None
    for line in run(weir, "info", *files).stdout.splitlines():
        if line.endswith(": a checkpoint, whole"):
            file = line.rsplit(": ", 1)[0]
        elif line.startswith(FRAME) and file:
            found[file] = int(line[len(FRAME):].split()[0])
    return found


class Trials:
    def __init__(self, weir, where, folder, number, scene, seed):
        self.weir, self.where, self.folder, self.number, self.scene = weir, where, folder, number, scene
        self.rng = random.Random(seed)
        self.resumed = 0

    def run(self, entries, durable, promised, count, resumes, quiet=False):
        """How many of `count` trials fail."""
        failed, batch = 0, []
        for k in range(count):
            cut = self.rng.randrange(1, len(entries) + 1)
            disk = Disk(self.folder, self.number, self.rng)
            for entry in entries[:cut]:
                disk.apply(entry)
            trial = os.path.join(self.where, f"trial{k:05}")
            os.mkdir(trial)
            disk.after_cut(trial)
            reached = bisect.bisect_right(durable, cut)
            batch.append((trial, cut, promised[reached - 1] if reached else 0))
            if len(batch) == 25 or k + 1 == count:
                for problem in self.problems(batch, resumes):
                    failed += 1
                    if not quiet:
                        print("FAILED: " + problem)
                batch = []
        return failed

    def problems(self, batch, resumes):
        names = [os.path.join(trial, name) for trial, _, _ in batch for name in ("run.h5", "run.previous.h5")]
        frames = frames_of(self.weir, [name for name in names if os.path.exists(name)])
        for trial, cut, least in batch:
            frame, name = max(((frames[name], name) for name in names if name.startswith(trial + "/") and name in frames),
                              default=(0, None))
            if frame < least:
                yield f"cut after entry {cut}: frame {least} was synced, but {frame or 'nothing'} is there"
            elif name and self.resumed < resumes:
                self.resumed += 1
                end = run(self.weir, *self.scene, "--resume", name, "--stats", os.path.join(trial, "end.json"))
                if end.returncode != 0:
                    yield f"cut after entry {cut}: not resumed: {end.stderr}"
            shutil.rmtree(trial)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--weir", required=True)
    parser.add_argument("--layer", required=True)
    parser.add_argument("--trials", type=int, default=50)
    parser.add_argument("--resumes", type=int, default=5, help="how many of them are resumed to their end")
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    weir = os.path.abspath(options.weir)
    with tempfile.TemporaryDirectory(prefix="weir-power-") as where:
        folder, record = os.path.join(where, "run"), os.path.join(where, "record")
        os.mkdir(folder)
        scene = ["run", SCENE, "--quiet", "--device", "cpu", "--threads", "1"]
        done = run(weir, *scene, "--checkpoint", os.path.join(folder, "run.h5"), "--checkpoint-every", "4",
                   env=dict(os.environ, LD_PRELOAD=os.path.abspath(options.layer), WEIR_FAULT_PROGRAM="weir",
                            WEIR_FAULT_FOLDER=folder, WEIR_FAULT_RECORD=record))
        if done.returncode != 0:
            sys.exit("the run failed: " + done.stderr)
        entries = list(read_record(record))
        number = os.stat(folder).st_ino
        # After each sync of the folder that follows a rename to the checkpoint's name, that one is there for good.
        durable, promised, renamed = [], [], 0
        for k, entry in enumerate(entries):
            if entry.what == "rename" and entry.data.endswith("/run.h5"):
                renamed += 1
            elif entry.what == "fsync" and entry.file == number and renamed:
                durable.append(k + 1)
                promised.append(4 * renamed)
        if renamed < 5 or len(durable) < renamed:
            sys.exit(f"the record has {renamed} checkpoints and {len(durable)} syncs of their folder")

        trials = Trials(weir, where, folder, number, scene, options.seed)
        failed = trials.run(entries, durable, promised, options.trials, options.resumes)
        # Without the syncs of the files the same trials must find something: else they would look at nothing.
        unsynced = [entry if entry.file == number or entry.what != "fsync" else entry._replace(what="nothing")
                    for entry in entries]
        found = trials.run(unsynced, durable, promised, max(25, options.trials // 10), 0, quiet=True)
        if not found:
            print("FAILED: a program that syncs no files would not be noticed")
    print(f"{len(entries)} entries of {renamed} checkpoints, {options.trials} power cuts, {trials.resumed} resumed, "
          f"{failed} wrong; without syncs {found} would be")
    return 1 if failed or not found or (options.resumes and not trials.resumed) else 0


if __name__ == "__main__":
    sys.exit(main())
