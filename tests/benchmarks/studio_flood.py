#!/usr/bin/env python3
"""What clients that ask without end cost a studio's simulation: steps a second with and without them, its memory, and how
long it takes to stop.

    tests/benchmarks/studio_flood.py build/cpu/bin/weir [SECONDS]

Four windows, of which none or one has the pen, send a command up to 100,000 times a second together, as far as the server
takes it from them, in turns of SECONDS (5) with as many of quiet before and after. Needs nothing but Python 3.
"""
import base64
import json
import os
import signal
import socket
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
    """A WebSocket; what it is sent is counted and forgotten, but for the number of steps."""

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
        self.steps = self.received = 0
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
                    self.steps = json.loads(data)["data"].get("steps", 0)
        except (OSError, ValueError):
            pass

    def close(self):
        self.socket.close()


def flood(window, message, stop, sent):
    one = frame(json.dumps({"id": 1, **message}))
    batch = one * int(PER_CLIENT * SLICE)
    try:
        while not stop.is_set():
            start = time.monotonic()
            window.socket.sendall(batch)
            sent.append(int(PER_CLIENT * SLICE))
            time.sleep(max(0, SLICE - (time.monotonic() - start)))
    except OSError:
        pass


def rate(window, seconds):
    """Steps a second."""
    time.sleep(0.3)
    steps, start = window.steps, time.monotonic()
    time.sleep(seconds)
    return (window.steps - steps) / (time.monotonic() - start)


def memory(pid, name):
    with open(f"/proc/{pid}/status") as status:
        return next(int(line.split()[1]) / 1024 for line in status if line.startswith(name))


def main():
    program = sys.argv[1]
    seconds = float(sys.argv[2]) if len(sys.argv) > 2 else 5
    folder = tempfile.TemporaryDirectory()
    scene = os.path.join(folder.name, "scene.json")
    with open(scene, "w") as file:
        json.dump(SCENE, file)
    server = subprocess.Popen([program, "studio", scene, "--no-browser", "--device", "cpu"], stdout=subprocess.PIPE, text=True)
    address = server.stdout.readline().strip()
    watcher = Window(address)
    watcher.send({"id": 1, "do": "run.play"})
    while watcher.steps == 0:
        time.sleep(0.1)
    print("| command | steps/s, quiet | steps/s, flood | ratio | messages taken/s | memory, MB |\n|---|---|---|---|---|---|")
    for command in COMMANDS:
        before = rate(watcher, seconds)
        stop, sent = threading.Event(), []
        windows = [Window(address) for _ in range(CLIENTS)]
        for window in windows:
            threading.Thread(target=flood, args=(window, command, stop, sent), daemon=True).start()
        during = rate(watcher, seconds)
        taken = sum(sent) / seconds
        stop.set()
        for window in windows:
            window.close()
        watcher.send({"id": 2, "do": "role.claim"})
        watcher.send({"id": 3, "do": "run.play"})
        quiet = (before + rate(watcher, seconds)) / 2
        print(f"| `{command['do']}` | {quiet:.0f} | {during:.0f} | {during / quiet:.2f} | {taken:.0f} "
              f"| {memory(server.pid, 'VmHWM'):.0f} |", flush=True)
    windows = [Window(address) for _ in range(CLIENTS)]
    for window in windows:
        threading.Thread(target=flood, args=(window, COMMANDS[4], threading.Event(), []), daemon=True).start()
    time.sleep(1)
    start = time.monotonic()
    server.send_signal(signal.SIGINT)
    server.wait()
    print(f"\nstopped in {time.monotonic() - start:.2f} s while it was asked by all")


main()
