"""CPU time that outputs add to a run, of two checkouts in turns, for engineering/reliability.md.

  output_cost_in_turns.py OLD_CHECKOUT OLD_PROGRAM NEW_PROGRAM ROUNDS SIDE SECONDS     SIDE: particles along an edge of the cube"""
import os
import resource
import statistics
import subprocess
import sys
import tempfile
import time

SCENE = "resources/scenes/benchmark_dam_break.json"
old, new = sys.argv[2:4]
scenes = {"old": f"{sys.argv[1]}/{SCENE}", "new": SCENE}
def cpu(args, env):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    t = time.time()
    r = subprocess.run(args, env=env, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    if r.returncode: print(r.stderr[-400:]); sys.exit(1)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, time.time() - t
rows = {}
rounds, side, seconds = int(sys.argv[4]), int(sys.argv[5]), sys.argv[6]
for k in range(rounds):
    for kind in ["none", "images", "export", "checkpoint"]:
        for which in (("old", "new") if k % 2 == 0 else ("new", "old")):
            with tempfile.TemporaryDirectory() as f:
                a = [old if which == "old" else new, "run", scenes[which], "--device", "cpu", "--threads", "1", "--set", f"water.spacing={0.81/side:.9g}", "--set", "world.frame_rate=30", "--duration", seconds, "--stats", f + "/s.json", "--quiet"]
                a += {"none": [], "images": ["--images", f + "/i"], "export": ["--export", f + "/e.vtkhdf"], "checkpoint": ["--checkpoint", f + "/c.h5", "--checkpoint-every", "1"]}[kind]
                rows.setdefault((which, kind), []).append(cpu(a, dict(os.environ, WEIR_CPU_ISA="baseline")))
for kind in ["none", "images", "export", "checkpoint"]:
    for which in ("old", "new"):
        c = [x[0] for x in rows[which, kind]]
        print(f"{kind:10} {which}: CPU min {min(c):.3f} median {statistics.median(c):.3f} s   wall min {min(x[1] for x in rows[which, kind]):.3f}")
