#!/usr/bin/env bash
# same_results_test.sh EVALUATE SOURCE_FOLDER: results do not depend on --jobs nor on --shard, and a failed run's command repeats it.
set -euo pipefail
evaluate=$1
source=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# Runs that cannot be done in time, so that there is a failure to repeat; a folder of scenarios outside the tree.
mkdir "$work/scenarios"
for name in short far; do
  printf '%s\n' "building = \"$source/launch/buildings/laboratory/building.toml\"" \
    "robot = \"$source/launch/robots/p3dx.toml\"" "seed = 1" "duration = $([ $name = short ] && echo 10 || echo 20)" \
    '[[person]]' 'speed = 0.8' '[[goal]]' 'place = "lift"' >"$work/scenarios/$name.toml"
done
cd /
runs=(--scenario "$work/scenarios" --seeds 3..5 --sensing geometric)
for jobs in 1 2; do
  "$evaluate" "${runs[@]}" --jobs $jobs --json "$work/$jobs.json" >"$work/$jobs.txt" 2>/dev/null || true
done
for shard in 4 3 2 1; do
  "$evaluate" "${runs[@]}" --shard $shard/4 --part "$work/$shard.part" >/dev/null 2>&1
done
"$evaluate" --merge "$work"/?.part --json "$work/merged.json" --html "$work/merged.html" >/dev/null && { echo "all passed"; exit 1; }
# everything but what a clock measured
for report in 1 2 merged; do
  grep -vE '"(wall_s|cpu_s|worst_step_ms|real_time_factor)"' "$work/$report.json" >"$work/$report.plain"
done
cmp "$work/1.plain" "$work/2.plain"
cmp "$work/1.plain" "$work/merged.plain"
[ "$(grep -c '"seed": ' "$work/1.json")" -eq 6 ] || { echo "not six runs"; exit 1; }

again=$(grep -m1 '^  again: ' "$work/1.txt" | sed 's/^  again: //')
case $again in "$source/scripts/evaluate "*) ;; *) echo "strange command: $again"; exit 1 ;; esac
# the wrapper would set up and build first; here the program is what was built
eval "set -- ${again#"$source/scripts/evaluate"}"
"$evaluate" "$@" --json "$work/again.json" >/dev/null 2>&1 && { echo "the failed run passed"; exit 1; }
# What the first run that failed came to; a run may pass though little time is given, where it starts beside its goal.
first_failed() {
  sed -n '/"runs": \[/,$p' "$1" |
    grep -E '"(scenario|seed|failure|localized_s|driven_m|hash|min_clearance_m)":' | paste -d' ' - - - - - - - |
    grep -v '"failure": ""' | head -1
}
[ -n "$(first_failed "$work/1.json")" ] || { echo "no run failed"; exit 1; }
diff <(first_failed "$work/1.json") <(first_failed "$work/again.json")
