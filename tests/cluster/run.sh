#!/usr/bin/env bash
# Checks a library on a cluster of two nodes, one of which is killed during the run, and compares
# the result of feeler merge with a single run. Argument: the program feeler. Needs root; see
# README.md.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd -P)
root=$(cd "$here/../.." && pwd -P)
feeler=$(realpath "${1:-$root/build/release/app/feeler}")
shards=4
formats=(text json jsonl csv junit sarif)

say() { printf 'cluster: %s\n' "$*"; }
die() {
    say "FAILED: $*"
    exit 1
}

[[ -x $feeler ]] || die "program $feeler does not exist"
((EUID == 0)) || die 'root is needed to start Slurm and munge'
for command in munged slurmctld slurmd sbatch squeue scontrol sinfo; do
    command -v "$command" >/dev/null || die "$command is not installed: README.md lists the packages"
done

# --- the cluster: all its files are in one folder, and no daemon outlives this script -------------

work=$(mktemp -d /tmp/feeler-cluster-XXXXXX)
chmod 755 "$work"
declare -A daemon # process id, by name

start() { # NAME COMMAND...: as a child process of this shell
    local name=$1
    shift
    "$@" >"$work/$name.out" 2>&1 &
    daemon[$name]=$!
}

end_all() {
    local status=$?
    trap - EXIT INT TERM
    scancel --user root >/dev/null 2>&1 || true
    end_steps
    local name
    for name in n1 n2 slurmctld munged; do
        [[ -n ${daemon[$name]:-} ]] || continue
        kill "${daemon[$name]}" 2>/dev/null || true
        timeout 10 tail --pid="${daemon[$name]}" -f /dev/null || kill -9 "${daemon[$name]}" 2>/dev/null || true
        wait "${daemon[$name]}" 2>/dev/null || true
    done
    if ((status == 0)); then rm -rf "$work"; else say "the logs are in $work"; fi
    exit "$status"
}
trap end_all EXIT
trap 'exit 130' INT TERM

# Kills processes left over from jobs of a node. They are recognised by the configuration of this
# cluster in their environment.
end_steps() {
    local pid
    for pid in $(pgrep -x slurmstepd || true) $(pgrep -x "${feeler##*/}" || true); do
        { tr '\0' '\n' <"/proc/$pid/environ"; } 2>/dev/null | grep -qx "SLURM_CONF=$SLURM_CONF" || continue
        kill -9 "$pid" 2>/dev/null || true
    done
}

wait_for() { # SECONDS WHAT COMMAND...
    local left=$(($1 * 5)) what=$2
    shift 2
    until "$@"; do
        ((left-- > 0)) || die "timed out waiting for: $what"
        sleep 0.2
    done
}

start_munge() {
    mkdir "$work/munge"
    head -c 1024 /dev/urandom >"$work/munge/key"
    chmod 400 "$work/munge/key"
    chown -R munge:munge "$work/munge"
    local options=()
    for what in key log pid seed; do options+=("--$what-file=$work/munge/$what"); done
    start munged setpriv --reuid=munge --regid=munge --clear-groups \
        munged --foreground --socket="$work/munge/socket" "${options[@]}"
    wait_for 20 'munged' test -S "$work/munge/socket"
}

configure() {
    local host
    host=$(hostname -s)
    cat >"$work/slurm.conf" <<CONF
ClusterName=feeler
SlurmctldHost=$host(127.0.0.1)
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket=$work/munge/socket
SlurmctldPort=17000
SlurmctldPidFile=$work/slurmctld.pid
SlurmctldLogFile=$work/slurmctld.log
SlurmdPidFile=$work/slurmd-%n.pid
SlurmdLogFile=$work/slurmd-%n.log
SlurmdSpoolDir=$work/spool-%n
StateSaveLocation=$work/state
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
MpiDefault=none
ReturnToService=2
SlurmdTimeout=6
SlurmdParameters=config_overrides
NodeName=n[1-2] NodeHostname=$host NodeAddr=127.0.0.1 Port=17001-17002 CPUs=1
PartitionName=all Nodes=n[1-2] Default=YES MaxTime=INFINITE State=UP
CONF
    mkdir "$work/state" "$work/spool-n1" "$work/spool-n2"
}

start_node() { start "$1" slurmd -D -N "$1"; }
nodes_are_idle() { [[ $(sinfo --noheader --Node --format=%t 2>/dev/null | sort -u) == idle ]]; }

start_cluster() {
    start_munge
    configure
    export SLURM_CONF=$work/slurm.conf
    start slurmctld slurmctld -D -c
    start_node n1
    start_node n2
    wait_for 60 'two idle nodes' nodes_are_idle
}

# --- the batch -----------------------------------------------------------------------------------

# The number of programs that a shard has reported so far.
ended_of() {
    [[ -e shard-$1.log ]] || return 0
    grep -cE '^(clear|no error|no motion|collision|violation|undecided|errors|stopped|not run) ' "shard-$1.log" || true
}

# The task running on a node, once it has reported this many programs.
busy_task_on() { # NODE PROGRAMS
    local task ended
    task=$(squeue --noheader --nodelist="$1" --states=RUNNING --format=%K)
    ended=$(ended_of "$task")
    ((${ended:-0} >= $2)) && printf '%s' "$task"
}

# As after a power failure: no process of the node is left, and it sends no message.
kill_node() { # NODE
    local job script step
    job=$(squeue --noheader --nodelist="$1" --states=RUNNING --format=%A)
    script=$(scontrol listpids "$job" "$1" 2>/dev/null | awk 'NR > 1 && $1 > 0 { print $1; exit }')
    [[ -n $script ]] || die "job $job has no process on $1"
    step=$(ps -o ppid= -p "$script" | tr -d ' ')
    [[ $(ps -o comm= -p "$step") == slurmstepd ]] || die "process $script does not belong to a job"
    kill -9 "${daemon[$1]}" "$step" "$script"
    wait "${daemon[$1]}" 2>/dev/null || true
}

says() { scontrol show job "$2" | grep -oE "(^| )$1=[^ ]*" | cut -d= -f2 | head -1; }
is_requeued() { [[ $(says JobState "${job}_$task") == PENDING ]]; }
is_over() { [[ -z $(squeue --noheader 2>/dev/null) ]]; }

to_files() { # NAME: prints the options for writing every format
    for format in "${formats[@]}"; do printf '%s\n' --format "$format" -o "$1.$format"; done
}

# Replaces times, which differ between runs.
without_seconds() {
    sed -E -e 's/"seconds":[^,]*/"seconds":0/g' -e 's/ time="[^"]*"/ time="0"/g' \
        -e 's/,[0-9.]+(,("([^"]|"")*"|[^",]*)\r?)$/,0\1/' -e 's/ in ([0-9]+ min )?[0-9.]+ s: / in 0 s: /' -e '/^  slowest /d' "$1"
}

start_cluster
say "slurm $(sinfo --version | cut -d' ' -f2) with two nodes"
"$here/library.sh" "$work/library" "$root"
mkdir "$work/bin" && ln -s "$feeler" "$work/bin/feeler"
export PATH=$work/bin:$PATH
cd "$work"

job=$(sbatch --parsable --array="1-$shards" "$here/check.sbatch" "$shards" library)
mapfile -t options < <(to_files merged)
merging=$(sbatch --parsable --dependency="afterany:$job" --output=merged.out \
    --wrap "feeler merge shard-*.json ${options[*]}")
wait_for 120 'a task in the middle of its shard' busy_task_on n1 $((RANDOM % 5 + 2)) >task
task=$(cat task)
kill_node n1
before=$(ended_of "$task")
say "node n1 was killed after shard $task had reported $before programs"
[[ ! -e shard-$task.json ]] || die "an unfinished shard was written"
wait_for 90 'the controller to notice that n1 is missing' is_requeued
say "the controller has noticed that n1 is missing, and has queued shard $task again"
# Slurm would wait two minutes first, in case n1 comes back and finishes its work.
scontrol update JobId="${job}_$task" StartTime=now
wait_for 400 'the end of all shards and of merge' is_over
[[ $(says Restarts "${job}_$task") == 1 && $(says NodeList "${job}_$task") == n2 ]] || die "shard $task did not start again on n2"
say "all shards are complete; $task was started again on n2"

found=$(grep -oE '^[0-9]+ of [0-9]+ results come from earlier checks' "shard-$task.log" | cut -d' ' -f1)
((${found:-0} >= before)) || die "shard $task found ${found:-none} of its $before earlier results again"
say "shard $task was started again and found $found results in its database"

# --- merged results are equal to those of one run -------------------------------------------------

status=$(says ExitCode "$merging" | cut -d: -f1)
mapfile -t options < <(to_files one)
one_status=0
feeler check library --jobs 1 --no-cache "${options[@]}" >one.out || one_status=$?
((status == one_status)) || die "merge ends with $status, one run with $one_status"
for format in out "${formats[@]}"; do
    cmp <(without_seconds "merged.$format") <(without_seconds "one.$format") || die "the $format differs"
done
say "one run that checks everything anew gives the same in ${formats[*]}, except for the seconds"

mapfile -t options < <(to_files again)
feeler check library --jobs 1 "${options[@]}" >again.out || true
grep -q '^40 of 40 results come from earlier checks' again.out || die 'one run does not find the results of the shards'
for format in "${formats[@]}"; do cmp "merged.$format" "again.$format" || die "the $format differs"; done
say "one run that finds all stored results gives the same, byte for byte"
say "passed: all runs end with status $status"
