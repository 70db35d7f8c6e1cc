#!/usr/bin/env bash
# bad_input_test.sh EVALUATE SOURCE_FOLDER: what cannot be run gets one clear sentence and exit status 2.
set -uo pipefail
evaluate=$1
source=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
failures=0

# expect STATUS PATTERN ARGUMENTS...: the exit status, and the one line on stderr
expect() {
  local status=$1 pattern=$2
  shift 2
  "$evaluate" "$@" >"$work/out" 2>"$work/err"
  local got=$?
  local lines
  lines=$(grep -c . "$work/err")
  if [ "$got" -ne "$status" ] || [ "$lines" -ne 1 ] || ! grep -qE "$pattern" "$work/err"; then
    echo "evaluate $*: exit status $got, expected $status and one line with /$pattern/, got:"
    cat "$work/err"
    failures=$((failures + 1))
  fi
}

scenario() {  # scenario NAME LINES...: the laboratory with these lines
  local file=$work/$1.toml
  shift
  printf '%s\n' "building = \"$source/launch/buildings/laboratory/building.toml\"" \
    "robot = \"$source/launch/robots/p3dx.toml\"" "seed = 1" "duration = 60" "$@" >"$file"
}

expect 2 'no-such-scenario.toml' --scenario "$work/no-such-scenario.toml"
printf 'building = "nowhere.toml"\nrobot = "%s"\n' "$source/launch/robots/p3dx.toml" >"$work/no-building.toml"
expect 2 'nowhere.toml' --scenario "$work/no-building.toml"
scenario in-a-wall '[start]' 'x = 0.05' 'y = 0.05' 'theta = 0.0' '[[goal]]' 'place = "workbench"'
expect 2 'start' --scenario "$work/in-a-wall.toml"
scenario no-such-place '[[goal]]' 'place = "moon"'
expect 2 'moon' --scenario "$work/no-such-place.toml"
scenario kill '[[event]]' 'at = 3' 'kind = "kill"' 'process = "localiser"' '[[goal]]' 'place = "workbench"'
expect 2 'localizer' --scenario "$work/kill.toml"
expect 2 'no folder' --suite quick --json "$work/no/such/folder.json"
expect 2 'cannot be written' --suite quick --json "$work"
expect 2 'no folder' --suite quick --html "$work/no/such/folder.html"
expect 2 'must be one of' --suite nonsense
expect 2 'A\.\.B' --suite quick --seeds 9..3
expect 2 'paper or modern' --mode fast
expect 2 'rendered or geometric' --sensing magic
expect 2 'between 1 and 256' --jobs 0
expect 2 'cannot be read' --suite quick --compare "$work/none.json"
expect 2 'I from 1 to N' --shard 4/3 --part "$work/x"
expect 2 'needs --part' --shard 1/3
expect 2 'for the whole' --shard 1/3 --part "$work/x" --json "$work/x.json"
expect 2 'without --shard, --suite' --suite quick --merge "$work/x"
echo text >"$work/x.part"
expect 1 'x.part: not a whole part' --merge "$work/x.part"
mkdir "$work/empty"
expect 2 'holds no scenario' --scenario "$work/empty"

# A goal in a wall is allowed when the scenario expects that it is refused.
scenario refused '[start]' 'x = 3.0' 'y = 7.0' 'theta = 1.5708' 'known = true' '[[goal]]' 'x = 0.05' 'y = 0.05' \
  'expect = "refused"'
if ! "$evaluate" --scenario "$work/refused.toml" --sensing geometric --json "$work/refused.json" >"$work/out" 2>&1; then
  echo "a goal in a wall that is expected to be refused:"
  cat "$work/out"
  failures=$((failures + 1))
fi
grep -q '"refused_right": 1' "$work/refused.json" || { echo "refused_right is not 1"; failures=$((failures + 1)); }
exit $((failures > 0))
