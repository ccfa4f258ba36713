#!/usr/bin/env python3
"""What clients that ask without end cost a studio's simulation: steps a second with and without them, its memory, and how
long it takes to stop.

    tests/benchmarks/studio_flood.py build/cpu/bin/weir [SECONDS] [--turns N] [--commands NAME...] [--cores LIST]

Four windows, the first of which takes the pen, send a command up to 100,000 times a second together, as far as the server
takes it from them, for SECONDS (5), of which the first go to what windows have saved up. Before and after it is quiet for as
long. Needs nothing but Python 3. The share of the time that the simulation spends in steps, and what the server's thread takes
of a core, mean something on any machine.

Steps a second need a machine with nothing else at work, and vary there by 12 % from one time to another, as water moves. So
each flood is compared with the quiet just before and after it, and with `--turns 7` the median of seven such ratios is told,
with the least and the largest. Windows cost cores, too: `--cores 0-7` keeps the server on these (as taskset names them), and
`taskset -c 8-9` in front of it all keeps the windows on others.
"""
import argparse
import base64
import json
import os
import signal
import socket
import statistics
import struct
import subprocess
import sys
import tempfile
import threading
import time
import urllib.parse

CLIENTS = 4
PER_CLIENT = 25_000  # messages a second
SLICE = 0.05  # s
SCENE = {
    "weir": 1,
    "world": {"duration": 10000, "frame_rate": 10, "dt": 0.001},
    "nodes": {
        "block": {"type": "BoxSampler", "params": {"min": [0, 0, 0], "max": [0.6, 0.6, 0.6]}},
        "tank": {"type": "StaticBoundary",
                 "params": {"shape": "box", "min": [0, 0, 0], "max": [1.2, 1.2, 1.2], "inverted": True}},
        "water": {"type": "ParticleFluid", "params": {"spacing": 0.03, "rest_steps": 0}},
    },
    "links": ["block.particles -> water.initial", "tank.boundary -> water.boundaries"],
}
CAMERA = {"eye": [2, 2, 2], "target": [0, 0, 0]}
COMMANDS = [
    {"do": "hello"}, {"do": "frame.seen"}, {"do": "run.seek", "frame": 0},
    {"do": "particle", "node": "water", "particle": 3},
    {"do": "particles", "node": "water", "sort": "speed", "count": 1000},
    {"do": "stream.set", "particles": True}, {"do": "run.play"}, {"do": "run.step", "frames": 1000000},
    {"do": "scene.set", "scene": SCENE}, {"do": "scene.save", "path": "saved.json", "overwrite": True},
    {"do": "view.set", "attribute": "speed", "most": 50},
    {"do": "picture", "width": 64, "height": 36, **CAMERA}, {"do": "role.claim"}, {"do": "nonsense"},
]


def frame(text: str) -> bytes:
    data = text.encode()
    length = bytes([0x80 | len(data)]) if len(data) < 126 else bytes([0xFE]) + struct.pack(">H", len(data))
    return b"\x81" + length + b"\0\0\0\0" + data


class Window:
    """A WebSocket; what it is sent is counted and forgotten, but for the steps at each status: (when, steps, s in them)."""

    def __init__(self, address):
        url = urllib.parse.urlparse(address)
        token = urllib.parse.parse_qs(url.query)["token"][0]
        self.socket = socket.create_connection((url.hostname, url.port))
        key = base64.b64encode(os.urandom(16)).decode()
        self.socket.sendall((f"GET /api/live HTTP/1.1\r\nHost: {url.netloc}\r\nAuthorization: Bearer {token}\r\n"
                             "Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
                             f"Sec-WebSocket-Key: {key}\r\n\r\n").encode())
        self.stream = self.socket.makefile("rb")
        while self.stream.readline() != b"\r\n":
            pass
        self.statuses, self.received = [], 0
        threading.Thread(target=self.read, daemon=True).start()

    def send(self, message):
        self.socket.sendall(frame(json.dumps(message)))

    def read(self):
        try:
            while True:
                first, length = self.stream.read(2)
                if length >= 126:
                    length = int.from_bytes(self.stream.read(2 if length == 126 else 8), "big")
                data = self.stream.read(length)
                self.received += 1
                if first & 15 == 9:  # a ping
                    self.socket.sendall(b"\x8a\x80\0\0\0\0")
                if b'"event":"status"' in data[:40].replace(b" ", b""):
                    status = json.loads(data)["data"]
                    self.statuses.append((time.monotonic(), status.get("steps", 0), status.get("stepping_seconds", 0)))
        except (OSError, ValueError):
            pass

    def close(self):
        self.socket.shutdown(socket.SHUT_RDWR)


def flood(window, message, stop):
    one = frame(json.dumps({"id": 1, **message}))
    batch = one * int(PER_CLIENT * SLICE)
    try:
        while not stop.is_set():
            start = time.monotonic()
            window.socket.sendall(batch)
            time.sleep(max(0, SLICE - (time.monotonic() - start)))
    except OSError:
        pass


def serving(pid):
    """Seconds of a core that the server's thread, the main one, has taken."""
    with open(f"/proc/{pid}/task/{pid}/stat") as stat:
        words = stat.read().rsplit(")", 1)[1].split()
    return (int(words[11]) + int(words[12])) / os.sysconf("SC_CLK_TCK")


def rates(window, pid, seconds):
    """Steps, seconds in steps, and of a core for the server's thread, a second."""
    time.sleep(0.3)
    first, before, start = len(window.statuses), serving(pid), time.monotonic()
    time.sleep(seconds)
    share = (serving(pid) - before) / (time.monotonic() - start)
    # A status comes every 0.1 s: from the first to the last of them, not from one end of the time to the other.
    (begin, *old), (end, *new) = window.statuses[first], window.statuses[-1]
    return [*((n - o) / (end - begin) for o, n in zip(old, new)), share]


def memory(pid, name):
    with open(f"/proc/{pid}/status") as status:
        return next(int(line.split()[1]) / 1024 for line in status if line.startswith(name))


class Studio:
    """A server that runs the scene, and a window that plays and watches it."""

    def __init__(self, program, cores, folder):
        scene = os.path.join(folder, "scene.json")
        with open(scene, "w") as file:
            json.dump(SCENE, file)
        bound = ["taskset", "-c", cores] if cores else []
        self.process = subprocess.Popen([*bound, program, "studio", scene, "--no-browser", "--device", "cpu"],
                                        stdout=subprocess.PIPE, text=True)
        self.address = self.process.stdout.readline().strip()
        self.watcher = Window(self.address)
        self.play()
        while not self.watcher.statuses or self.watcher.statuses[-1][1] == 0:
            time.sleep(0.1)

    def play(self):
        self.watcher.send({"id": 2, "do": "role.claim"})
        self.watcher.send({"id": 3, "do": "run.play"})

    def quiet(self, seconds):
        return rates(self.watcher, self.process.pid, seconds)

    def flooded(self, command, seconds):
        """The rates, and answers a second."""
        stop = threading.Event()
        windows = [Window(self.address) for _ in range(CLIENTS)]
        windows[0].send({"id": 1, "do": "role.claim"})
        for window in windows:
            threading.Thread(target=flood, args=(window, command, stop), daemon=True).start()
        during = rates(self.watcher, self.process.pid, seconds)
        stop.set()
        answers = sum(window.received for window in windows) / seconds
        for window in windows:
            window.close()
        self.play()
        return [*during, answers]

    def seconds_to_stop(self):
        for window in [Window(self.address) for _ in range(CLIENTS)]:
            threading.Thread(target=flood, args=(window, COMMANDS[4], threading.Event()), daemon=True).start()
        time.sleep(1)
        start = time.monotonic()
        self.process.send_signal(signal.SIGINT)
        self.process.wait()
        return time.monotonic() - start


def row(studio, command, seconds, turns):
    """Quiet, flood, quiet, flood … quiet; medians of them."""
    quiet, during = [studio.quiet(seconds)], []
    for _ in range(turns):
        during.append(studio.flooded(command, seconds))
        quiet.append(studio.quiet(seconds))
    ratios = [2 * d[0] / (before[0] + after[0]) for d, before, after in zip(during, quiet, quiet[1:])]
    q, d = ([statistics.median(column) for column in zip(*rows)] for rows in (quiet, during))
    return (f"| `{command['do']}` | {q[0]:.0f} | {d[0]:.0f} | {statistics.median(ratios):.2f} | {min(ratios):.2f} to {max(ratios):.2f} "
            f"| {q[1]:.0%} | {d[1]:.0%} | {q[2]:.1%} | {d[2]:.1%} | {d[3]:.0f} | {memory(studio.process.pid, 'VmHWM'):.0f} |")


def main():
    names = [command["do"] for command in COMMANDS]
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("program")
    options.add_argument("seconds", type=float, nargs="?", default=5)
    options.add_argument("--turns", type=int, default=1)
    options.add_argument("--commands", nargs="+", choices=names, default=names, metavar="NAME")
    options.add_argument("--cores")
    options = options.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        studio = Studio(options.program, options.cores, folder)
        print("| command | steps/s, quiet | flood | ratio | of turns | time in steps, quiet | flood | server's thread, quiet | flood "
              "| answers/s | peak, MB |")
        print("|---" * 11 + "|")
        for command in COMMANDS:
            if command["do"] in options.commands:
                print(row(studio, command, options.seconds, options.turns), flush=True)
        print(f"\nstopped in {studio.seconds_to_stop():.2f} s while it was asked by all")


main()
