#!/bin/sh
# A Slurm cluster of one node on loopback, to try scripts for queues with real arrays, warnings and preemption.
# Needs root, and Debian's slurm-wlm and munge. Two partitions: `low`, whose jobs are requeued when a job in `high` wants
# their processors, and `high`.
#
# usage: slurm_of_one_node.sh start FOLDER      then: export SLURM_CONF=FOLDER/slurm.conf
#        slurm_of_one_node.sh stop FOLDER
set -eu
[ $# -eq 2 ] || { sed -n '2,7s/^# \{0,1\}//p' "$0" >&2; exit 2; }
command=$1 folder=$(realpath -m "$2")
host=$(hostname -s)

write_configuration() {
  mkdir -p "$folder/state" "$folder/spool" "$folder/munge"
  chmod 700 "$folder/munge"
  (umask 077 && head -c 128 /dev/urandom >"$folder/munge/key")
  cat >"$folder/slurm.conf" <<TEXT
ClusterName=one
SlurmctldHost=$host(127.0.0.1)
SlurmUser=root
AuthType=auth/munge
AuthInfo=socket=$folder/munge/socket
SlurmctldPort=16817
SlurmdPort=16818
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/slurmd.pid
SlurmctldLogFile=$folder/slurmctld.log
SlurmdLogFile=$folder/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerParameters=sched_interval=2,bf_interval=2
PreemptType=preempt/partition_prio
PreemptMode=REQUEUE
SlurmctldParameters=preempt_send_user_signal
KillWait=5
MinJobAge=3600
RebootProgram=/bin/true
NodeName=$host NodeAddr=127.0.0.1 CPUs=$(nproc) RealMemory=2000 State=UNKNOWN
PartitionName=low Nodes=$host Default=YES MaxTime=INFINITE PriorityTier=1 GraceTime=60
PartitionName=high Nodes=$host MaxTime=INFINITE PriorityTier=10 PreemptMode=OFF
TEXT
}

start() {
  write_configuration
  export SLURM_CONF="$folder/slurm.conf"
  munged --force --key-file="$folder/munge/key" --socket="$folder/munge/socket" --pid-file="$folder/munge/pid" \
    --log-file="$folder/munge/log" --seed-file="$folder/munge/seed"
  slurmctld
  slurmd
  tries=0
  until sinfo --noheader --states=idle 2>/dev/null | grep -q "$host"; do
    tries=$((tries + 1))
    [ "$tries" -lt 30 ] || { tail -n 5 "$folder"/slurm*.log >&2; exit 1; }
    sleep 1
  done
  sinfo
}

stop() {
  for pid in "$folder/slurmd.pid" "$folder/slurmctld.pid" "$folder/munge/pid"; do
    if [ -e "$pid" ]; then kill "$(cat "$pid")" || true; fi
  done
}

case "$command" in
  start) start ;;
  stop) stop ;;
  *) echo "slurm_of_one_node: there is no command '$command': start or stop" >&2 && exit 2 ;;
esac
