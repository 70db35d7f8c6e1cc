#!/usr/bin/env bash
# measure_test.sh SOURCE_FOLDER: failed runs are figures, but where nothing was run no older report is taken for today's.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir -p "$work/tests/evaluation" "$work/scripts" "$work/docs" "$work/out"
cp "$1/tests/evaluation/measure" "$1/tests/evaluation/figures_table" "$work/tests/evaluation"
printf '<!-- figures -->\nold\n<!-- end of figures -->\n' >"$work/docs/measurements.md"
cp "$work/docs/measurements.md" "$work/README.md"
for script in evaluate bench; do  # stand-ins: WRITES says whether there is a report, STATUS is how it ends
  cat >"$work/scripts/$script" <<'STANDIN'
#!/usr/bin/env bash
while [ $# -gt 0 ]; do
  [ "$1" != --json ] || [ "$WRITES" = no ] || echo "$REPORT" >"$2"
  shift
done
exit "$STATUS"
STANDIN
  chmod +x "$work/scripts/$script"
done
measure="$work/tests/evaluation/measure --out $work/out --jobs 1"
export REPORT='{"suite": "all", "summary": {"runs": 2, "passed": 1, "contacts": 0}, "runs": []}'

# A run failed: its figures go into the page.
echo '{"machine": "m", "busy": false, "results": []}' >"$work/out/bench.json"
WRITES=yes STATUS=1 $measure all table 2>"$work/message"
grep -q '1 of 2' "$work/docs/measurements.md"
grep -q 'contacts with walls, boxes, people | 0' "$work/README.md"

# The build failed, or nothing came out of it: a report of another day is not taken, the page stays as it is.
for status in 0 1 2; do
  cp "$work/docs/measurements.md" "$work/before.md"
  echo "$REPORT" | sed 's/"passed": 1/"passed": 2/' >"$work/out/all.json"
  if WRITES=no STATUS=$status $measure all table 2>"$work/message"; then
    echo "status $status without a report was taken for a result"; exit 1
  fi
  grep -q 'all failed' "$work/message"
  [ ! -e "$work/out/all.json" ]
  cmp "$work/before.md" "$work/docs/measurements.md"
done

# A step whose report lies there from before may be left out on purpose, one that fails may not leave its own behind.
if WRITES=no STATUS=1 $measure bench 2>"$work/message"; then echo "a bench that failed"; exit 1; fi
[ ! -e "$work/out/bench.json" ]
