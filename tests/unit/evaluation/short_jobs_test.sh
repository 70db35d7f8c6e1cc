#!/usr/bin/env bash
# short_jobs_test.sh EVALUATE SOURCE_FOLDER: half an hour of jobs in the laboratory, with kills of the job service; twice, with the same result.
set -euo pipefail
evaluate=$1
source=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

printf '%s\n' "building = \"$source/launch/buildings/laboratory/building.toml\"" \
  "robot = \"$source/launch/robots/p3dx.toml\"" 'seed = 3' 'duration = 3600' '[start]' 'known = true' '[world]' 'calibrated = true' \
  '[dock]' 'place = "workbench"' 'contact = 1.0' '[jobs]' 'count = 6' 'time = 600' 'kills = 3' >"$work/short.toml"
for run in 1 2; do
  "$evaluate" --scenario "$work/short.toml" --sensing geometric --json "$work/$run.json" 2>&1 | tee "$work/$run.txt"
  grep -vE '"(wall_s|cpu_s|worst_step_ms|real_time_factor)"' "$work/$run.json" >"$work/$run.plain"
done
cmp "$work/1.plain" "$work/2.plain"
for figure in '"jobs": 6,' '"right": 6,' '"lost": 0,' '"doubled": 0,' '"kills": 3,'; do
  grep -q "^ *$figure" "$work/1.json" || { echo "the report has no $figure"; exit 1; }
done
