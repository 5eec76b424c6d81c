#!/usr/bin/env bash
# A session with strata-view as a hand would do it, inside an X server: pick, measure, orbit, resize, save, quit.
# usage: viewer_session.sh STRATA_VIEW STORE FOLDER; leaves FOLDER/*.project.json of each step and *.png.
set -euo pipefail
view=$1 store=$2
cd "$3"
saved=$(basename "$store" .strata).project.json

"$view" "$store" --backend cpu --size 800x600 &
viewer=$!
trap 'kill $viewer 2>/dev/null || true' EXIT
window=$(timeout 60 xdotool search --sync --onlyvisible --name Strata | head -n 1)
xdotool windowfocus "$window" 2>/dev/null || true

# Slow machines take in events late: what is done is done again until the saved project shows it.
save() {  # save STEP
  rm -f "$saved"
  for _ in $(seq 60); do
    xdotool key ctrl+s
    for _ in $(seq 10); do
      sleep 0.1
      if [ -s "$saved" ]; then mv "$saved" "$1.project.json" && return; fi
    done
  done
  echo "nothing was saved at step $1" >&2
  exit 1
}

save start
for _ in $(seq 20); do
  xdotool key m
  sleep 0.3
  xdotool mousemove 380 330 click 1
  sleep 1
  xdotool mousemove 450 380 click 1
  sleep 1
  xdotool key Return
  sleep 0.3
  save measured
  if grep -q '"kind": "distance"' measured.project.json; then break; fi
done

for _ in $(seq 20); do
  xdotool mousemove 400 350 mousedown 1
  for x in 420 450 480 520; do xdotool mousemove "$x" 340 && sleep 0.1; done
  xdotool mouseup 1
  save orbited
  if ! diff -q <(grep -A4 '"eye"' start.project.json | head -n 4) <(grep -A4 '"eye"' orbited.project.json | head -n 4) >/dev/null; then break; fi
done

xdotool windowsize "$window" 640 700
sleep 1
save resized
for _ in $(seq 60); do
  xdotool key ctrl+q 2>/dev/null || true
  for _ in $(seq 10); do
    sleep 0.1
    if ! kill -0 $viewer 2>/dev/null; then
      trap - EXIT
      wait $viewer
      exit $?
    fi
  done
done
echo "the viewer does not quit" >&2
exit 1
