#!/bin/sh
# Runs the scripts of docs/clusters.md on a Slurm of one node (slurm_of_one_node.sh): a job that its time limit warns, saves
# and is requeued until it is done; one that a job of higher priority preempts; an array of a sweep. What they leave must
# be what runs without a queue leave. Takes some ten minutes, most of them waiting; needs root, slurm-wlm and munge.
#
# usage: try_slurm.sh WEIR [FOLDER]          WEIR: the program
set -eu
[ $# -ge 1 ] || { sed -n '2,6s/^# \{0,1\}//p' "$0" >&2; exit 2; }
weir=$(realpath "$1") source=$(cd "$(dirname "$0")/../.." && pwd)
folder=$(realpath -m "${2:-/var/tmp/weir-slurm}")
rm -rf "$folder" && mkdir -p "$folder/jobs"
PATH=$(dirname "$weir"):$PATH
export PATH SLURM_CONF="$folder/slurm/slurm.conf"
"$source/tools/clusters/slurm_of_one_node.sh" start "$folder/slurm"
trap '"$source/tools/clusters/slurm_of_one_node.sh" stop "$folder/slurm"' EXIT
cd "$folder/jobs"
fail() { printf 'try_slurm: %s\n' "$*" >&2; exit 1; }
say() { printf '== %s\n' "$*"; }

# The page's script for sbatch, and its command for a sweep.
script() { awk '/^```sh/ { inside = 1; text = ""; next } /^```/ && inside { inside = 0; if (text ~ /#SBATCH/) printf "%s", text }
  inside { text = text $0 "\n" }' "$source/docs/clusters.md"; }
sweep() { awk '/^weir sweep .*--set/ { inside = 1 } inside { print } inside && !/\\$/ { exit }' "$source/docs/clusters.md"; }
state() { squeue --noheader --states=all --jobs "$1" --format=%T | sort -u | tr '\n' ' '; }
restarts() { scontrol show job "$1" | sed -n 's/.*Restarts=\([0-9]*\).*/\1/p' | head -n 1; }
wait_for() { # JOB STATE SECONDS
  tries=$3
  until [ "$(state "$1")" = "$2 " ]; do
    tries=$((tries - 1))
    [ "$tries" -gt 0 ] || fail "job $1 is $(state "$1")and not $2"
    sleep 1
  done
}

# Without the two fields that time is in.
compare_series() {
  python3 - "$1" "$2" <<'PY' || fail "$1 and $2 differ"
import json, sys
def frames(name):
    return [{k: v for k, v in json.loads(line).items() if k != "stepping_seconds"} for line in open(name)]
one, other = frames(sys.argv[1]), frames(sys.argv[2])
print(f"{len(one)} frames, {'the same' if one == other else 'not the same'}")
sys.exit(one != other)
PY
}

# As long as some two minutes of one core: what is longer than one time limit.
frames=${WEIR_TRY_FRAMES:-600}
longer="--set water.spacing=0.03 --set world.duration=1000 --frames $frames --threads 1 --series run.jsonl --checkpoint-every 20s"
single_job() { script | sed "s|--quiet|$longer --quiet|"; }

say "Alone"
mkdir alone && cd alone
single_job | grep srun | sed 's/^srun //' | sh
cd ..

say "A job whose time limit of one minute comes before its end"
mkdir limit && cd limit
single_job >job.sh && cat job.sh
job=$(sbatch --parsable --time=1 --signal=USR1@30 --ntasks=1 job.sh)
wait_for "$job" COMPLETED 1200
say "job $job: $(state "$job"), requeued $(restarts "$job") times"
[ "$(restarts "$job")" -gt 0 ] || fail "it was not requeued"
compare_series ../alone/run.jsonl run.jsonl
cd ..

say "A job that another one preempts"
mkdir preempted && cd preempted
single_job >job.sh
job=$(sbatch --parsable --ntasks=1 --cpus-per-task="$(nproc)" job.sh)
wait_for "$job" RUNNING 200
sleep 10
other=$(sbatch --parsable --partition=high --cpus-per-task="$(nproc)" --wrap 'sleep 5')
wait_for "$other" COMPLETED 200
wait_for "$job" COMPLETED 1200
say "job $job: $(state "$job"), requeued $(restarts "$job") times"
[ "$(restarts "$job")" -gt 0 ] || fail "it was not requeued"
compare_series ../alone/run.jsonl run.jsonl
cd ..

say "A sweep as an array"
mkdir array && cd array
sweep >sweep.sh
script | sed '/^srun/ { r sweep.sh
  d
}' | sed 's/^weir sweep/srun weir sweep/' >job.sh
cat job.sh
job=$(sbatch --parsable --ntasks=1 --array=1-4 job.sh)
wait_for "$job" COMPLETED 300
sed 's/--out study/--out local/' sweep.sh | sh >/dev/null
cmp study/table.csv local/table.csv || fail "the table of the array is not that of one sweep"
say "the table of the array is that of one sweep:"
cut -c 1-100 study/table.csv
