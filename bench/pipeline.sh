#!/usr/bin/env bash
# The figures of pipelines, measured: what one more subject costs, whether a killed run ends as one that was not, whether the
# bytes are the same for any threads and shards, and what a pipeline costs over the bare commands.
#
#   bench/pipeline.sh target/release/lunula                    all of them, in a temporary folder (TMPDIR)
#   bench/pipeline.sh target/release/lunula added killed       only these: added, detected, killed, same, overhead, again
#
# SUBJECTS=200 subjects of `added`, PHOTOS=DIR takes these photographs (of SUBJECTS + 1, by `lunula phantom photos`) instead of
# generating them, KILLS=10, THREADS=4, SEED=1 of the moments of killing. Needs bash 5 and diffutils. Ends with 1 where bytes differ or
# recorded work was done again.
set -euo pipefail

[[ $# -ge 1 ]] || { sed -n '2,11s/^# \?//p' "$0"; exit 2; }
lunula=$(realpath "$1")
shift
figures=("$@")
[[ ${#figures[@]} -gt 0 ]] || figures=(added detected killed same overhead again)
subjects=${SUBJECTS:-200} kills=${KILLS:-10} threads=${THREADS:-4} photos=${PHOTOS:+$(realpath "$PHOTOS")}
here=$(realpath "$(dirname "$0")")
RANDOM=${SEED:-1}
work=$(mktemp -d "${TMPDIR:-/tmp}/lunula-pipeline.XXXXXX")
trap 'rm -rf "$work"' EXIT
cd "$work"
wrong=0

row() { printf '%-62s %12s  %s\n' "$@"; }
calc() { awk "BEGIN { printf \"$1\", $2 }"; }
median() { printf '%s\n' "$@" | sort -g | awk '{ a[NR] = $1 } END { print a[int((NR + 1) / 2)] }'; }

# Runs a command; its seconds are left in $took, those of all cores together in $cpu.
timed() {
    local TIMEFORMAT='%R %U %S' user system
    { time "$@" 2>&3; } 3>&2 2>times
    read -r took user system < <(tail -1 times)
    cpu=$(calc %.3f "$user + $system")
}

# What is in two folders of results, but for what may hold times.
same() {
    diff -rq --exclude=.lunula --exclude=report.html --exclude=run.json "$1" "$2" >"$work/differ" && echo same && return
    echo DIFFERS
    cat "$work/differ" >&2
    return 1
}

# A study of few people and short videos; every stage of pipelines/study.toml has work in it.
small_study() {
    sed -e 's/^study = .*/study = { seed = 1, subjects = 3, sensors = 2, presses = 2, seconds = 16 }/' \
        -e '/name = "rising"/!s/ fps = 15,/ fps = 15, seconds = 8,/' \
        "$here/../pipelines/study.toml" >study.toml
}

photographs() {
    [[ -z $photos ]] || return 0
    "$lunula" phantom photos --subjects $((subjects + 1)) --light chamber --no-normalized --out "$work/photographs" -q
    photos=$work/photographs
}

# Photographs of some poses, all subjects but the last; $last is the last.
lay_out() {
    local to=$1 pose
    shift
    last=$(printf 's%0*d' $((subjects + 1 >= 1000 ? 4 : subjects + 1 >= 100 ? 3 : 2)) $((subjects + 1)))
    for pose in "$@"; do
        mkdir -p "$to/$pose"
        cp "$photos/photos/$pose/"* "$to/$pose/"
        rm "$to/$pose/$last".*
    done
    # What was written this moment is hashed again the next time.
    sleep 3
}

# added NAME OUTLINE WANTED POSES..: one subject more against the whole.
one_more() {
    local name=$1 outline=$2 wanted=$3 whole more whole_cpu more_cpu cost
    shift 3
    lay_out "$name-photos" "$@"
    cat >"$name.toml" <<EOF
wanted = $wanted
[inputs.photos]
files = "$name-photos/{pose}/{subject}.png"
[stage.normalized]
job = "normalize"
photo = "photos"
outline = "$outline"
[stage.maps]
job = "maps"
sums = "normalized"
EOF
    timed "$lunula" run "$name.toml" --out "$name" --threads "$threads" -q
    whole=$took whole_cpu=$cpu
    sleep 3
    for pose in "$@"; do cp "$photos/photos/$pose/$last".* "$name-photos/$pose/"; done
    timed "$lunula" run "$name.toml" --out "$name" --threads "$threads" -q
    more=$took more_cpu=$cpu
    timed "$lunula" run "$name.toml" --out "$name" --threads "$threads" -q
    cost=$(calc %.2f "100 * $more / $whole")
    row "one subject added to $subjects x $# poses, $name" "$cost %" "$more s of $whole s; nothing new: $took s"
    row "  of the processor's time" "$(calc %.2f "100 * $more_cpu / $whole_cpu") %" "$more_cpu s of $whole_cpu s; nothing new: $cpu s"
    rm -rf "$name-new"
    "$lunula" run "$name.toml" --out "$name-new" --threads "$threads" -q
    same "$name" "$name-new" >/dev/null || { row "  bytes as made at once" DIFFER ""; wrong=1; }
    rm -rf "$name" "$name-new" "$name-photos"
}

all_poses=(extension flexion lateral_negative lateral_positive longitudinal_negative longitudinal_positive nominal normal)

added() {
    photographs
    one_more drawn-outlines annotated '["maps"]' "${all_poses[@]}"
    one_more drawn-outlines-figures annotated '["maps", "maps.figures"]' "${all_poses[@]}"
}

detected() {
    photographs
    one_more detected-outlines detect '["maps"]' nominal normal
}

# Records with their inode and time: one that is written again is another.
records() { find "$1/.lunula/records" -type f -printf '%f %i %T@\n' 2>/dev/null | sort || true; }

# Killed at random moments, up to the time of a whole run, until it ends for once; as often from nothing as the kills need.
killed() {
    small_study
    # Generated beforehand: its long tasks would be killed again and again, and hide the others.
    "$lunula" phantom study --seed 1 --subjects 3 --sensors 2 --presses 2 --seconds 16 --out data -q
    local film name protocol seed
    for film in spiral:touch:1 random:touch-random:2 held-out:touch-random:3 rising:normal:4; do
        IFS=: read -r name protocol seed <<<"$film"
        "$lunula" phantom nailvideo --protocol "$protocol" --seed "$seed" --fps 15 --seconds 8 --size 480x360 \
            --nail-px 142 --out "data/nailvideo/$name" -q
    done
    sed -i '/^\[phantom\]/,/^$/d; s/{phantom}/data/' study.toml
    sleep 3
    timed "$lunula" run study.toml --out once --threads "$threads" -q
    local alone=$took killed=0 rounds=0 again=0 stood=() verdict=same status
    while ((killed < kills)); do
        rounds=$((rounds + 1))
        rm -rf often
        : >before
        while true; do
            if ((killed < kills)); then
                status=0
                # The program is one process, which is waited for.
                timeout --foreground -s KILL "$(calc %.3f "$alone * $RANDOM / 32768 + 0.01")" \
                    "$lunula" run study.toml --out often --threads "$threads" -q || status=$?
                ((status != 137)) || killed=$((killed + 1))
                ((status == 0 || status == 137)) || exit "$status"
            else
                "$lunula" run study.toml --out often --threads "$threads" -q
            fi
            records often >after
            again=$((again + $(comm -23 before after | wc -l)))
            mv after before
            [[ ! -f often/run.json ]] || break
            stood+=("$(wc -l <before)")
        done
        [[ $(same once often) == same ]] || { verdict=DIFFERS; wrong=1; }
    done
    row "killed at $killed random moments, started again: bytes" "$verdict" "$rounds runs from nothing; uninterrupted: $alone s"
    row "  recorded tasks done again" "$again" "stood when killed: ${stood[*]} of $(wc -l <before)"
    ((again == 0)) || wrong=1
    rm -rf once often data
}

same_bytes() {
    small_study
    local n k verdict parts
    for n in 1 2 4; do
        timed "$lunula" run study.toml --out "threads-$n" --threads "$n" -q
        verdict=$(same threads-1 "threads-$n") || wrong=1
        row "bytes with --threads $n" "$verdict" "$took s"
    done
    rm -rf threads-2 threads-4
    for n in 1 3 7; do
        parts=()
        for ((k = 1; k <= n; k++)); do
            "$lunula" run study.toml --out "part-$k" --shard "$k/$n" --threads "$threads" -q
            parts+=("part-$k")
        done
        timed "$lunula" merge "${parts[@]}" --out merged --threads "$threads" -q
        verdict=$(same threads-1 merged) || wrong=1
        row "bytes of $n parts merged" "$verdict" "merge: $took s"
        rm -rf merged part-*
    done
    rm -rf threads-1
}

overhead() {
    # What the work is on, made beforehand.
    "$lunula" phantom study --seed 1 --subjects 3 --sensors 2 --presses 2 --seconds 30 --out data -q
    cat >bare.toml <<'EOF'
wanted = ["sets", "force", "training", "training.pictures", "validation", "validation.pictures"]
[inputs.sessions]
table = "data/tables/sessions.csv"
keys = ["subject", "session", "kind", "repetition"]
[stage.angles]
job = "posture"
video = { from = "sessions.video", where = { kind = ["bending", "bending-random"] } }
markers = "sessions.markers"
[stage.sets]
job = "align"
joints = "angles"
log = "sessions.log"
[stage.force]
job = "train"
target = "force"
each = ["subject"]
data = { from = "sessions.log", where = { kind = "touch", repetition = ["1", "2"] } }
[stage.training]
job = "evaluate"
model = "force"
data = { from = "sessions.log", where = { kind = "touch", repetition = ["1", "2"] } }
[stage.validation]
job = "evaluate"
model = "force"
data = { from = "sessions.log", where = { kind = "touch", repetition = "3" } }
EOF
    local turn bare=() piped=() bare_cpu=() piped_cpu=()
    for turn in 1 2 3; do
        rm -rf by-hand piped
        timed by_hand
        bare+=("$took") bare_cpu+=("$cpu")
        timed "$lunula" run bare.toml --out piped --threads 1 -q
        piped+=("$took") piped_cpu+=("$cpu")
    done
    local a b
    a=$(median "${bare[@]}") b=$(median "${piped[@]}")
    row "pipeline over the bare commands, one thread" "$(calc %+.2f "100 * ($b / $a - 1)") %" "$b s and $a s; medians of 3 (${piped[*]}; ${bare[*]})"
    a=$(median "${bare_cpu[@]}") b=$(median "${piped_cpu[@]}")
    row "  of the processor's time" "$(calc %+.2f "100 * ($b / $a - 1)") %" "$b s and $a s"
}

by_hand() {
    local s kind session out touch
    for s in s01 s02; do
        for kind in bending bending-random; do
            session=data/$s/$kind out=by-hand/$s/$kind
            mkdir -p "$out"
            "$lunula" posture "$session/video.mp4" --markers "$session/markers.toml" --out "$out/joints.csv" --no-figures --threads 1 -q
            "$lunula" align --joints "$out/joints.csv" --log "$session/log.csv" --out "$out/training.csv" --no-figures \
                --threads 1 -q
        done
        touch=by-hand/$s/touch
        mkdir -p "$touch"
        "$lunula" train "data/$s/touch-1/log.csv" "data/$s/touch-2/log.csv" --target force --out "$touch/model.json" --threads 1 -q
        "$lunula" evaluate "$touch/model.json" "data/$s/touch-1/log.csv" "data/$s/touch-2/log.csv" --out "$touch-training" --threads 1 -q
        "$lunula" evaluate "$touch/model.json" "data/$s/touch-3/log.csv" --out "$touch-validation" --threads 1 -q
    done
}

again() {
    local turn times=()
    timed "$lunula" run "$here/../pipelines/study.toml" --out study --threads "$threads" -q
    row "pipelines/study.toml from nothing" "$took s" "$threads threads"
    sleep 3
    for turn in 1 2 3; do
        timed "$lunula" run "$here/../pipelines/study.toml" --out study --threads "$threads" -q
        times+=("$took")
    done
    row "  again with nothing changed" "$(median "${times[@]}") s" "${times[*]}"
}

row "$("$lunula" --version)" "" "$(nproc) cores"
for figure in "${figures[@]}"; do
    case $figure in
        same) same_bytes ;;
        added | detected | killed | overhead | again) "$figure" ;;
        *) echo "no figure $figure: added, detected, killed, same, overhead, again" >&2; exit 2 ;;
    esac
done
exit "$wrong"
