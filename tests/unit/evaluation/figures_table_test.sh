#!/usr/bin/env bash
# figures_table_test.sh SOURCE_FOLDER: reports become Markdown tables between the marks of a page, and nothing else of it changes.
set -euo pipefail
table=$1/tests/evaluation/figures_table
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
summary='{"runs": 3, "passed": 2, "localized_ratio": 1.0, "localized_after_m_median": 4.25, "localized_after_m_p95": 9.0,
  "confident_wrong_runs": 0, "tracking_ratio": 0.995, "in_view_position_rms_m": 0.016, "in_view_heading_rms_deg": 0.36,
  "goals": 9, "goals_reached": 8, "contacts": 1, "contacts_hard": 2, "mean_speed_m_s": 0.45}'
echo "{\"suite\": \"all\", \"sensing\": \"mixed\", \"summary\": $summary, \"suites\": {\"missions\": $summary}, \"runs\": [
  {\"simulated_s\": 3600, \"group\": \"office\", \"passed\": false}, {\"simulated_s\": 3600, \"group\": \"office\", \"passed\": true}]}" >all.json
echo '{"machine": "2 cores", "busy": false, "results": [
  {"name": "detector/modern", "time": 40000.0, "unit": "ns", "peer": "detector/opencv", "counters": {}},
  {"name": "lcm/300", "time": 50000.0, "unit": "ns", "peer": "udp_multicast/300", "counters": {"p99_us": 140.2}},
  {"name": "route/1000", "time": 28000000.0, "unit": "ns", "counters": {}},
  {"name": "replan/1000", "time": 2000000.0, "unit": "ns", "counters": {}},
  {"name": "udp_multicast/300", "time": 20000.0, "unit": "ns", "counters": {}},
  {"name": "detector/opencv", "time": 800000.0, "unit": "ns", "counters": {}}]}' >bench.json
printf 'before\n<!-- figures -->\nold\n<!-- end of figures -->\nafter\n' >page.md
"$table" all.json bench.json --into page.md
grep -qF '`scripts/evaluate --suite all`, 3 runs, 2 simulated hours:' page.md
grep -qF '| the same, calibrated | 16 mm, 0.36° | 12 mm, 0.5° | `missions` |' page.md
grep -qF '| boxes, people, a closed door: goals reached | 8 of 9 | 99 % | `missions` |' page.md
grep -qF '| contacts with walls, boxes, people | 1; 2 with what sonar hardly sees | 0 | `all` |' page.md
grep -qF '`detector/modern` | 40 µs | 20 x `detector/opencv` |  |' page.md
grep -qF '`route/1000` | 28 ms |  | 20 ms |' page.md
grep -qF '`replan/1000` | 2 ms | 14 x `route/1000` | 10 % of a plan |' page.md
grep -qF '`lcm/300` | 50 µs, 99 %: 140 µs | 2.5 times as long as `udp_multicast/300` |' page.md
grep -qF 'Runs that did not pass: office 1 of 2.' page.md
if grep -q 'refused' page.md; then echo "a row without its figure"; exit 1; fi
[ "$(head -n 1 page.md)" = before ] && [ "$(tail -n 1 page.md)" = after ]
if grep -q old page.md; then echo "the old table is still there"; exit 1; fi
cp page.md once.md
"$table" all.json bench.json --into page.md
cmp once.md page.md
for wrong in "all.json --into bench.json" "page.md"; do
  if "$table" $wrong 2>message; then echo "took: $wrong"; exit 1; fi
  [ "$(wc -l <message)" -eq 1 ] || { cat message; exit 1; }
done
