#!/usr/bin/env bash
# Moves strata-view at random by mouse and keys, in an X server, and watches its memory. Fails when the memory in the
# last quarter of the time is more than a few per cent above that in the second quarter. Writes FOLDER/soak.csv.
# usage: xvfb-run -a -s "-screen 0 1024x768x24 -noreset" viewer_soak.sh STRATA_VIEW STORE FOLDER [MINUTES]
set -euo pipefail
view=$(realpath "$1") store=$(realpath "$2") folder=$3 minutes=${4:-30}
most_growth=5  # per cent; a run of less than ten minutes is still warming up and may grow twice as much
if [ "$minutes" -lt 10 ]; then most_growth=10; fi
cd "$folder"
RANDOM=1

program=$(type -P xdotool)
xdotool() { timeout 10 "$program" "$@" || true; }
"$view" "$store" --backend cpu --size 800x600 --cache 32M &
viewer=$!
trap 'kill $viewer 2>/dev/null || true' EXIT
window=$(timeout 120 "$program" search --sync --onlyvisible --name Strata | head -n 1)
xdotool windowfocus "$window"

x() { echo $((350 + RANDOM % 100)); }  # between the panels
y() { echo $((400 + RANDOM % 150)); }
drag() {  # drag BUTTON
  xdotool mousemove "$(x)" "$(y)" mousedown "$1"
  for _ in 1 2 3 4; do xdotool mousemove "$(x)" "$(y)"; sleep 0.05; done
  xdotool mouseup "$1"
}
something() {
  case $((RANDOM % 14)) in
    0 | 1 | 2) drag 1 ;;
    3) drag 3 ;;
    4 | 5 | 6) xdotool mousemove "$(x)" "$(y)" click --repeat $((1 + RANDOM % 8)) --delay 40 4 ;;
    7 | 8) xdotool mousemove "$(x)" "$(y)" click --repeat $((1 + RANDOM % 8)) --delay 40 5 ;;
    9) xdotool key "$(shuf -n 1 --random-source=/dev/urandom -e F 1 3 7 O G)" ;;
    10) for key in w a s d e q; do xdotool keydown $key; sleep 0.15; xdotool keyup $key; done ;;
    11) xdotool mousemove "$(x)" "$(y)" click 1; sleep 0.3
        xdotool mousemove "$(x)" "$(y)" click --repeat 2 --delay 60 1 ;;
    12) xdotool key k; sleep 0.1; drag 1; xdotool key k space; sleep 1 ;;
    13) xdotool windowsize "$window" $((700 + RANDOM % 200)) $((550 + RANDOM % 150)) ;;
  esac
  # Now and then the camera goes back to where there is something to see.
  if [ $((RANDOM % 12)) = 0 ]; then xdotool key f; fi
}

# The window begins with its largest size, so that the memory of pictures is there before it is watched.
xdotool windowsize "$window" 900 700
sleep 2
echo "seconds,rss_kib,actions" >soak.csv
begin=$(date +%s) actions=0 next=0
while now=$(($(date +%s) - begin)) && [ "$now" -lt $((minutes * 60)) ]; do
  kill -0 $viewer 2>/dev/null || { echo "the viewer has ended after $now s" >&2; exit 1; }
  if [ "$now" -ge "$next" ]; then
    echo "$now,$(awk '/^VmRSS/ { print $2 }' /proc/$viewer/status),$actions" >>soak.csv
    next=$((now + 2))
  fi
  something
  actions=$((actions + 1))
done
kill -0 $viewer
xdotool key ctrl+q
for _ in $(seq 100); do kill -0 $viewer 2>/dev/null || break; sleep 0.1; done
trap - EXIT
kill $viewer 2>/dev/null && { echo "the viewer does not quit" >&2; exit 1; }
wait $viewer

awk -F, -v end=$((minutes * 60)) -v most=$most_growth '
  NR > 1 && $1 >= end / 4 && $1 < end / 2 { early += $2; n++ }
  NR > 1 && $1 >= end * 3 / 4 { late += $2; m++ }
  NR > 1 && $2 > peak { peak = $2 }
  NR > 1 { actions = $3 }
  END {
    growth = 100 * (late / m) / (early / n) - 100
    printf "%d actions; mean memory %.1f MiB in the second quarter, %.1f MiB in the last (%+.1f %%), peak %.1f MiB\n",
           actions, early / n / 1024, late / m / 1024, growth, peak / 1024
    exit growth > most
  }' soak.csv
