#!/usr/bin/env python3
"""Runs the program for hours and notes its memory: a run with every output of data, and a studio whose viewers come and go.

  soak.py --weir build/cpu/bin/weir --minutes 180 [--report soak.csv]

The studio plays a small scene without an end, begins anew when it has finished, and is asked for particles and scenes by up
to four viewers that stay for a few seconds each; every third one leaves in the middle of a message. Ends with 1 if a program
ends badly, does not stop within 2 s of Ctrl-C, or takes more than --grows more memory at the end than after a quarter of
the time.
"""
import argparse
import base64
import json
import os
import random
import re
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import threading
import time

HERE = os.path.dirname(os.path.abspath(__file__))
SCENE = os.path.join(HERE, "..", "faults", "block.json")


class Viewer:
    """Just enough of a WebSocket client."""

    def __init__(self, address):
        host, port, token = re.match(r"http://([^:/]+):(\d+)/\?token=(\w+)", address).groups()
        self.socket = socket.create_connection((host, int(port)), timeout=30)
        key = base64.b64encode(os.urandom(16)).decode()
        self.socket.sendall((f"GET /ws HTTP/1.1\r\nHost: {host}:{port}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
                             f"Authorization: Bearer {token}\r\nSec-WebSocket-Key: {key}\r\n"
                             "Sec-WebSocket-Version: 13\r\n\r\n").encode())
        self.bytes = b""
        while b"\r\n\r\n" not in self.bytes:
            self.bytes += self.receive()
        head, self.bytes = self.bytes.split(b"\r\n\r\n", 1)
        if b" 101 " not in head.split(b"\r\n")[0]:
            raise OSError("refused: " + head.decode(errors="replace"))

    def receive(self):
        more = self.socket.recv(1 << 16)
        if not more:
            raise OSError("closed")
        return more

    def send(self, message, cut=False):
        data = json.dumps(message).encode()
        size = bytes([0x80 | len(data)]) if len(data) < 126 else bytes([0x80 | 126]) + struct.pack(">H", len(data))
        mask = os.urandom(4)
        frame = b"\x81" + size + mask + bytes(byte ^ mask[k % 4] for k, byte in enumerate(data))
        self.socket.sendall(frame[:len(frame) // 2] if cut else frame)

    def take(self, count):
        while len(self.bytes) < count:
            self.bytes += self.receive()
        taken, self.bytes = self.bytes[:count], self.bytes[count:]
        return taken

    def message(self):
        first, size = self.take(2)
        if size == 126:
            size, = struct.unpack(">H", self.take(2))
        elif size == 127:
            size, = struct.unpack(">Q", self.take(8))
        return first & 15, self.take(size)

    def close(self):
        self.socket.close()


class Viewers:
    def __init__(self, address, end):
        self.address, self.end = address, end
        self.visits, self.messages, self.failures = 0, 0, []
        self.threads = [threading.Thread(target=self.come_and_go, args=(k,)) for k in range(4)]
        for thread in self.threads:
            thread.start()

    def come_and_go(self, seed):
        rng = random.Random(seed)
        while time.monotonic() < self.end:
            try:
                self.visit(rng)
            except OSError as error:
                self.failures.append(str(error))
            time.sleep(rng.uniform(0, 1))

    def visit(self, rng):
        viewer = Viewer(self.address)
        try:
            leaves = time.monotonic() + rng.uniform(0.5, 10)
            for number, do in enumerate(["hello", "role.claim", "run.play"]):
                viewer.send({"id": number, "do": do})
            while time.monotonic() < min(leaves, self.end):
                kind, data = viewer.message()
                self.messages += 1
                if kind == 2:  # a frame
                    viewer.send({"do": "frame.seen", "id": 3})
                    viewer.send({"id": 4, "do": "particles", "node": "water", "count": 20})
                elif b'"finished"' in data:
                    viewer.send({"id": 5, "do": "role.claim"})
                    viewer.send({"id": 6, "do": "run.reset"})
                    viewer.send({"id": 7, "do": "run.play"})
            self.visits += 1
            if self.visits % 3 == 0:
                viewer.send({"id": 8, "do": "particles", "node": "water"}, cut=True)
        finally:
            viewer.close()


def memory_of(process):
    """kB in use, open files, threads."""
    with open(f"/proc/{process.pid}/status", encoding="ascii", errors="replace") as file:
        status = dict(line.split(":", 1) for line in file)
    return int(status["VmRSS"].split()[0]), len(os.listdir(f"/proc/{process.pid}/fd")), int(status["Threads"])


def start(command, **more):
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True, **more)


def options_of():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--weir", required=True)
    parser.add_argument("--minutes", type=float, default=180)
    parser.add_argument("--every", type=float, default=10, help="seconds between two notes")
    parser.add_argument("--grows", type=float, default=0.1, help="the part by which memory may grow")
    # Frames take between half of this and all of it, states between a quarter and half, each on its own, so the most of both
    # together comes late: growth by up to three quarters of this is no leak. It is little beside the 33 MB of the rest.
    parser.add_argument("--frames-mb", type=int, default=2, help="memory of the studio for frames, and half of it for states, to go back to")
    parser.add_argument("--report", help="a table of what was noted (.csv)")
    options = parser.parse_args()
    options.weir = os.path.abspath(options.weir)
    return options


def start_programs(options, folder):
    """The run and the studio, each of the scene without an end."""
    with open(SCENE, encoding="utf-8") as file:
        scene = json.load(file)
    scene["world"]["duration"] = 1e6
    with open(os.path.join(folder, "scene.json"), "w", encoding="utf-8") as file:
        json.dump(scene, file)
    run = start([options.weir, "run", "scene.json", "--quiet", "--device", "cpu", "--threads", "1",
                 "--export", "run.vtkhdf", "--series", "run.jsonl", "--stats", "run.json", "--checkpoint", "run.h5",
                 "--checkpoint-every", "500"], cwd=folder)
    studio = start([options.weir, "studio", "scene.json", "--no-browser", "--device", "cpu", "--threads", "1",
                    "--frames-mb", str(options.frames_mb)], cwd=folder)
    return {"run": run, "studio": studio}


def watch(programs, viewers, options, begin, end, problems):
    """Lines of numbers, until the end or the first problem."""
    notes = []
    with open(options.report or os.devnull, "w", encoding="ascii", buffering=1) as report:  # by lines: a soak that is killed keeps them
        report.write("seconds,run kB,run files,run threads,studio kB,studio files,studio threads,visits,messages\n")
        while time.monotonic() < end and not problems:
            time.sleep(min(options.every, max(0.1, end - time.monotonic())))
            note = [round(time.monotonic() - begin)]
            for name, program in programs.items():
                if program.poll() is not None:
                    problems.append(f"{name} ended with {program.returncode}")
                    note += [0, 0, 0]
                else:
                    note += memory_of(program)
            notes.append(note + [viewers.visits, viewers.messages])
            report.write(",".join(map(str, notes[-1])) + "\n")
    return notes


def stop(programs, problems):
    for name, program in programs.items():
        asked = time.monotonic()
        program.send_signal(signal.SIGINT)
        try:
            program.wait(120)
        except subprocess.TimeoutExpired:
            program.kill()
        took = time.monotonic() - asked
        print(f"{name} ended with {program.returncode}, {took:.2f} s after Ctrl-C")
        if program.returncode != (130 if name == "run" else 0) or took > 2:
            problems.append(f"{name} did not stop as it should")


def judge_growth(notes, grows, problems):
    early, late = notes[len(notes) // 4], notes[-1]
    for name, column in (("run", 1), ("studio", 4)):
        growth = late[column] / max(early[column], 1) - 1
        print(f"{name}: {early[column]} kB after {early[0]} s, {late[column]} kB after {late[0]} s ({100 * growth:+.1f} %), "
              f"{late[column + 1]} open files, {late[column + 2]} threads")
        if growth > grows:
            problems.append(f"{name} grows")


def main():
    options = options_of()
    begin = time.monotonic()
    end = begin + 60 * options.minutes
    problems = []
    with tempfile.TemporaryDirectory(prefix="weir-soak-") as folder:
        programs = start_programs(options, folder)
        viewers = Viewers(programs["studio"].stdout.readline().strip(), end)
        notes = watch(programs, viewers, options, begin, end, problems)
        viewers.end = 0
        for thread in viewers.threads:
            thread.join()
        stop(programs, problems)
        size = os.path.getsize(os.path.join(folder, "run.vtkhdf"))
    judge_growth(notes, options.grows, problems)
    print(f"{viewers.visits} visits, {viewers.messages} messages, {len(viewers.failures)} connections failed "
          f"{sorted(set(viewers.failures))[:3]}; an export of {size / 1e6:.0f} MB")
    for problem in problems:
        print("PROBLEM: " + problem)
    return 1 if problems or viewers.visits == 0 else 0


if __name__ == "__main__":
    sys.exit(main())
