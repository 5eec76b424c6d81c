#!/usr/bin/env bash
# strata-view used by hand inside an X server, step by step as the file STEPS says, then quit with Control + Q.
# usage: viewer_steps.sh STRATA_VIEW FOLDER STEPS SAVED ARGUMENT...; SAVED is the project file that Control + S writes.
# steps:  key NAME   down NAME   up NAME   click X Y   drag X0 Y0 X1 Y1   save NAME (leaves FOLDER/NAME.project.json)
set -euo pipefail
# shellcheck source=viewer_hands.sh
. "$(dirname "$0")/viewer_hands.sh"
view=$1 steps=$3 saved=$4
cd "$2"
shift 4
start_viewer "$view" "$@"
sleep 2

# Slow machines take in events late: a button stays down for longer than a frame.
press() { sleep 0.5 && xdotool mousedown 1 && sleep 0.8; }
release() { sleep 0.3 && xdotool mouseup 1 && sleep 0.8; }
save() {  # save NAME
  before=$(stat -c %y "$saved" 2>/dev/null || true)
  for _ in $(seq 60); do
    xdotool key ctrl+s
    for _ in $(seq 10); do
      sleep 0.1
      if [ -s "$saved" ] && [ "$(stat -c %y "$saved")" != "$before" ]; then cp "$saved" "$1.project.json" && return; fi
    done
  done
  echo "nothing was saved at step $1" >&2
  exit 1
}

while read -r step a b c d; do
  case $step in
    key) xdotool key "$a" && sleep 0.8 ;;
    down) xdotool keydown "$a" && sleep 0.5 ;;
    up) xdotool keyup "$a" && sleep 0.5 ;;
    click) xdotool mousemove "$a" "$b" && press && release ;;
    drag)
      xdotool mousemove "$a" "$b" && press
      for i in 1 2 3 4 5; do
        xdotool mousemove $((a + (c - a) * i / 5)) $((b + (d - b) * i / 5)) && sleep 0.2
      done
      release
      ;;
    save) save "$a" ;;
    *) echo "unknown step $step" >&2 && exit 1 ;;
  esac
done <"$steps"

quit_viewer
