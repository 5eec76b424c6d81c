#!/usr/bin/env bash
# A session with strata-view as a hand would do it, inside an X server: pick, measure, orbit, clip, record a camera path,
# take a picture, hide, resize, save, quit.
# usage: viewer_session.sh STRATA_VIEW STORE FOLDER; leaves FOLDER/*.project.json of each step, NAME.path.json, NAME.png.
set -euo pipefail
# shellcheck source=viewer_hands.sh
. "$(dirname "$0")/viewer_hands.sh"
view=$1 store=$2
cd "$3"
name=$(basename "$store" .strata)
saved=$name.project.json

start_viewer "$view" "$store" --backend cpu --size 800x600

# Slow machines take in events late: what is done is done again until the saved project shows it.
save() {  # save STEP
  rm -f "$saved"
  for _ in $(seq 60); do
    focus
    xdotool key ctrl+s
    for _ in $(seq 10); do
      sleep 0.1
      if [ -s "$saved" ]; then mv "$saved" "$1.project.json" && return; fi
    done
  done
  echo "nothing was saved at step $1" >&2
  exit 1
}
eye() { grep -A4 '"eye"' "$1.project.json" | head -n 4; }
drag() {  # drag Y
  xdotool mousemove 400 "$1" mousedown 1
  for x in 420 450 480 520; do xdotool mousemove $x $(($1 - 10)) && sleep 0.1; done
  xdotool mouseup 1
}
ticks() { awk '{ print $14 + $15 }' /proc/$viewer/stat; }  # of CPU time, all threads
ticks_in_two_seconds() {
  local before
  before=$(ticks)
  sleep 2
  echo $(($(ticks) - before))
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
  drag 350
  save orbited
  if [ "$(eye start)" != "$(eye orbited)" ]; then break; fi
done

for _ in $(seq 20); do
  xdotool key b
  sleep 0.3
  save clipped
  if grep -q '"box 1"' clipped.project.json; then break; fi
done

xdotool key k
sleep 0.3
drag 380
sleep 0.3
xdotool key k
sleep 0.3
save keys  # and the path

xdotool key ctrl+p
for _ in $(seq 600); do
  sleep 0.1
  if [ -s "$name.png" ]; then break; fi
done

# While a path is recorded every frame is drawn; a window that nobody sees draws none all the same.
xdotool key r
sleep 0.5
ticks_in_two_seconds >ticks_shown
xdotool windowunmap "$window"
sleep 1
ticks_in_two_seconds >ticks_hidden
xdotool windowmap "$window"
sleep 0.5
focus
ticks_in_two_seconds >ticks_shown_again
xdotool key r

xdotool windowsize "$window" 640 700
sleep 1
save resized
quit_viewer
