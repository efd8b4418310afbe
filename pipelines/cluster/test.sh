#!/usr/bin/env bash
# Runs a small pipeline at once, with Snakemake on this machine, with Snakemake on Slurm, and as an array of Slurm's, and compares every byte
# of the results. Not in every CI run: it installs Debian's slurm-wlm and munge, Snakemake into a folder of its own, and for a while runs
# Slurm with this machine as its one node. Debian or Ubuntu; as root.
#
#   cargo build --release --locked && sudo bash pipelines/cluster/test.sh [PATH OF lunula]
#
# VENV=FOLDER keeps Snakemake for the next time, KEEP=1 keeps all that was made.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
lunula=$(realpath "${1:-$here/../../target/release/lunula}")
[ -x "$lunula" ] || { echo "$lunula is not there: cargo build --release --locked" >&2; exit 2; }
[ "$(id -u)" = 0 ] || { echo "Slurm's configuration goes to /etc: call it as root" >&2; exit 2; }
[ ! -e /etc/slurm/slurm.conf ] || { echo "/etc/slurm/slurm.conf is there: this machine has a Slurm, which is left alone" >&2; exit 2; }

work=$(mktemp -d)
down() {
  for daemon in slurmd slurmctld munged; do
    [ ! -s "$work/$daemon.pid" ] || kill "$(cat "$work/$daemon.pid")" || true
  done
  rm -f /etc/slurm/slurm.conf
  if [ -n "${KEEP:-}" ]; then echo "kept: $work"; else rm -rf "$work"; fi
}
trap down EXIT

say() { printf '%(%T)T %s\n' -1 "$*"; }

install() {
  local missing=()
  for package in slurm-wlm munge python3-venv; do
    dpkg-query -W -f '${Status}' $package 2>/dev/null | grep -q 'ok installed' || missing+=("$package")
  done
  if [ ${#missing[@]} -gt 0 ]; then
    apt-get update -q
    DEBIAN_FRONTEND=noninteractive apt-get install -q -y --no-install-recommends "${missing[@]}"
  fi
  local venv=${VENV:-$work/venv}
  [ -x "$venv/bin/pip" ] || python3 -m venv "$venv"
  "$venv/bin/pip" install -q 'snakemake>=9' 'snakemake-executor-plugin-slurm>=2'
  export PATH="$venv/bin:$PATH"
}

# One node, and nothing that needs rights beyond root's in a container.
slurm() {
  mkdir -p "$work/state" "$work/spool" /etc/slurm
  local name memory
  name=$(hostname -s)
  memory=$(awk '/MemTotal/ { print int($2 / 1024 * 0.9) }' /proc/meminfo)
  (umask 077 && head -c 1024 /dev/urandom > "$work/munge.key")
  munged --force --key-file="$work/munge.key" --socket="$work/munge.socket" --pid-file="$work/munged.pid" \
    --log-file="$work/munged.log" --seed-file="$work/munged.seed"
  cat > /etc/slurm/slurm.conf <<CONF
ClusterName=test
SlurmctldHost=$name(127.0.0.1)
AuthType=auth/munge
AuthInfo=socket=$work/munge.socket
SlurmUser=root
StateSaveLocation=$work/state
SlurmdSpoolDir=$work/spool
SlurmctldPidFile=$work/slurmctld.pid
SlurmdPidFile=$work/slurmd.pid
SlurmctldLogFile=$work/slurmctld.log
SlurmdLogFile=$work/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core_Memory
AccountingStorageType=accounting_storage/none
JobAcctGatherType=jobacct_gather/none
MpiDefault=none
ReturnToService=2
NodeName=$name NodeAddr=127.0.0.1 CPUs=$(nproc) RealMemory=$memory State=UNKNOWN
PartitionName=main Nodes=$name Default=YES MaxTime=INFINITE State=UP
CONF
  chmod 755 "$work"
  slurmctld
  slurmd
  for _ in $(seq 100); do
    if sinfo -h -o %T 2>/dev/null | grep -q idle; then return; fi
    sleep 0.2
  done
  tail -n 5 "$work"/*.log >&2
  echo "Slurm's node does not come up" >&2
  return 1
}

# Photographs, which fall into parts, and their maps, which only the merge can make.
pipeline() {
  cat > pipeline.toml <<'TOML'
wanted = ["normalized", "maps"]

[inputs.photos]
files = "set/photos/{pose}/{subject}.png"

[stage.normalized]
job = "normalize"
photo = "photos"

[stage.maps]
job = "maps"
sums = "normalized"
TOML
  "$lunula" phantom photos --seed 1 --subjects 12 --poses extension,flexion --size 320x240 --out set --quiet
}

# All results except those with times: the records in .lunula, the report and run.json.
same() {
  diff -r --exclude=.lunula --exclude=report.html --exclude=run.json whole "$1"
  say "$1: the same bytes, $(find "$1" -type f -not -path '*/.lunula/*' | wc -l) files"
}

snake() {
  local out=$1
  shift
  snakemake -s "$here/Snakefile" "$@" --config lunula="$lunula" pipeline=pipeline.toml out="$out" parts="$out.parts" \
    "inputs_a_job=[4, 8]" threads=1 memory_mb=1000 > "$out.log" 2>&1 || { cat "$out.log" >&2; return 1; }
}

install
cd "$work"
pipeline
say "at once"
"$lunula" run pipeline.toml --out whole --quiet
say "Snakemake on this machine"
snake local --cores 2
same local
snake local --cores 2
same local
slurm
say "Snakemake on Slurm"
snake slurm --profile "$here/slurm"
same slurm
say "an array of Slurm's"
LUNULA=$lunula LUNULA_CPUS=1 LUNULA_MEMORY=1000M bash "$here/array.sbatch" pipeline.toml array 3
for _ in $(seq 300); do
  [ -n "$(squeue -h)" ] || break
  # A job that this node can't run at all waits for ever: Slurm says why.
  stuck=$(squeue -h -t PENDING -o '%i: %r' | grep -vE ': (None|Priority|Resources|Dependency|BeginTime)$' || true)
  [ -z "$stuck" ] || { echo "jobs that Slurm can't start: $stuck" >&2; exit 1; }
  sleep 1
done
[ -z "$(squeue -h)" ] || { squeue >&2; echo "jobs of the array did not end in 300 s" >&2; exit 1; }
[ -d array ] || { tail -n 20 slurm-*.out >&2; echo "the array and its merge ended without results" >&2; exit 1; }
same array
say "all the same"
