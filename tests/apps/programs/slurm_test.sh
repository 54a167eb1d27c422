#!/usr/bin/env bash
# slurm_test.sh FOLDER_OF_PROGRAMS: a job array of four on a separate Slurm
# (controller and one node, started here) gives the same bytes as a local batch.
# Exit code 77 (ctest: skipped) where Slurm cannot be started.
set -euo pipefail
programs=$1
slots=4
sequences=8

skip() {
  echo "skipped: $1"
  exit 77
}
for program in munged slurmctld slurmd sbatch sinfo; do
  command -v "$program" >/dev/null || skip "no $program here"
done

folder=$(mktemp -d)
# Daemons write their state when they end: the folder is removed after all have
# ended. Slurm uses munged until its end, so it is ended first.
stop() {
  for name in slurmd slurmctld munged; do
    local file=$folder/run/$name.pid pid
    pid=$(cat "$file" 2>/dev/null) || continue
    kill "$pid" 2>/dev/null || continue
    timeout 20 tail --pid="$pid" -f /dev/null || kill -KILL "$pid" || true
  done
  rm -rf "$folder"
}
trap stop EXIT
cd "$folder"
mkdir run state spool

# Daemons with their own files and ports, separate from any other Slurm.
host=$(hostname -s)
port=$((20000 + $$ % 20000))
head -c 1024 /dev/urandom >munge.key
chmod 400 munge.key
cat >slurm.conf <<CONF
ClusterName=test
SlurmctldHost=$host(127.0.0.1)
SlurmUser=$(id -un)
SlurmdUser=$(id -un)
AuthType=auth/munge
AuthInfo=socket=$folder/run/munge.sock
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool
SlurmctldPidFile=$folder/run/slurmctld.pid
SlurmdPidFile=$folder/run/slurmd.pid
SlurmctldLogFile=$folder/run/slurmctld.log
SlurmdLogFile=$folder/run/slurmd.log
SlurmctldPort=$port
SlurmdPort=$((port + 1))
ProctrackType=proctrack/pgid
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SwitchType=switch/none
MpiDefault=none
ReturnToService=2
NodeName=$host NodeAddr=127.0.0.1 CPUs=$(nproc) State=UNKNOWN
PartitionName=main Nodes=$host Default=YES MaxTime=INFINITE State=UP
CONF
export SLURM_CONF=$folder/slurm.conf
munged --key-file="$folder/munge.key" --socket="$folder/run/munge.sock" \
  --pid-file="$folder/run/munged.pid" --log-file="$folder/run/munged.log" \
  --seed-file="$folder/run/munge.seed" --force >run/start.log 2>&1 ||
  skip "munged does not start: $(tail -n 1 run/start.log)"
slurmctld >>run/start.log 2>&1 || skip "slurmctld does not start"
slurmd >>run/start.log 2>&1 || skip "slurmd does not start"
for _ in $(seq 30); do
  sinfo --noheader --format=%T 2>/dev/null | grep -q idle && break
  sleep 1
done
sinfo --noheader --format=%T | grep -q idle || skip "the node does not get idle"

paths=(xyz pan_tilt circle handheld)
for ((i = 0; i < sequences; ++i)); do
  "$programs/rgbd_simulate" --path="${paths[i % 4]}" --seed=$((i + 1)) \
    --frames=4 --output="sequence$i" >/dev/null
  echo "$folder/sequence$i" >>list.txt
done
plan="--sequences=$folder/list.txt --losses=huber,tukey"

# shellcheck disable=SC2086
"$programs/rgbd_batch" $plan --output=local >/dev/null 2>local.log
cat >job.sh <<JOB
#!/usr/bin/env bash
#SBATCH --array=0-$((slots - 1))
#SBATCH --output=$folder/job-%a.log
exec $programs/rgbd_batch $plan --output=$folder/array --jobs=1
JOB
timeout 120 sbatch --wait job.sh
# shellcheck disable=SC2086
"$programs/rgbd_batch" $plan --output=array --merge >/dev/null

status=0
# The last two columns are times.
without_times() { sed 's/,[^,]*,[^,]*$//' "$1"; }
diff <(without_times local/summary.csv) <(without_times array/summary.csv) ||
  status=1
[ "$(wc -l <array/summary.csv)" -eq $((2 * sequences + 1)) ] || {
  echo "array/summary.csv has no row for every run"
  status=1
}
(cd local && find . -name trajectory.txt) | while read -r file; do
  cmp "local/$file" "array/$file"
done || status=1
[ $status -eq 0 ] || cat job-*.log
exit $status
