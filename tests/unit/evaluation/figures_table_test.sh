#!/usr/bin/env bash
# figures_table_test.sh SOURCE_FOLDER: reports become Markdown tables between the marks of a page, and nothing else of it changes.
set -euo pipefail
table=$1/tests/evaluation/figures_table
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
summary='{"runs": 3, "passed": 2, "localized_ratio": 1.0, "localized_after_m_median": 4.25, "confident_wrong_runs": 0,
  "tracking_ratio": 0.995, "in_view_position_rms_m": 0.016, "in_view_heading_rms_deg": 0.36, "goals": 9, "goals_reached": 8,
  "contacts": 1, "mean_speed_m_s": 0.45}'
echo "{\"suite\": \"all\", \"sensing\": \"mixed\", \"summary\": $summary, \"scenarios\": {\"office\": $summary}}" >all.json
echo '{"machine": "2 cores", "busy": false, "results": [
  {"name": "detector/segment", "time": 40000.0, "unit": "ns", "peer": "detector/opencv"},
  {"name": "detector/opencv", "time": 800000.0, "unit": "ns"}]}' >bench.json
printf 'before\n<!-- figures -->\nold\n<!-- end of figures -->\nafter\n' >page.md
"$table" all.json bench.json --into page.md
grep -qF '| office | 2 of 3 | 100 % | 4.2 m | 0 | 99.5 % | 16 mm, 0.36° | 8 of 9 | 1 | - | 0.45 m/s |' page.md
grep -qF '| `detector/segment` | 40 µs | 20 times as fast as `detector/opencv` |' page.md
[ "$(head -n 1 page.md)" = before ] && [ "$(tail -n 1 page.md)" = after ]
if grep -q old page.md; then echo "the old table is still there"; exit 1; fi
cp page.md once.md
"$table" all.json bench.json --into page.md
cmp once.md page.md
for wrong in "all.json --into bench.json" "page.md"; do
  if "$table" $wrong 2>message; then echo "took: $wrong"; exit 1; fi
  [ "$(wc -l <message)" -eq 1 ] || { cat message; exit 1; }
done
