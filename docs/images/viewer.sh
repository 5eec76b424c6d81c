#!/usr/bin/env bash
# Makes the pictures of docs/viewer.md: a new user's way from a LAZ file to a measured distance.
# usage: docs/images/viewer.sh BIN [OUT], BIN the folder of the programs; needs xvfb-run, xdotool and ffmpeg.
set -euo pipefail
if [ -z "${STRATA_INSIDE_X:-}" ]; then
  STRATA_INSIDE_X=1 exec xvfb-run -a -s "-screen 0 1280x800x24" "$0" "$(realpath "$1")" "$(realpath "${2:-$(dirname "$0")}")"
fi
bin=$1 out=$2
program=$(type -P xdotool)
xdotool() { timeout 10 "$program" "$@" || true; }
work=$(mktemp -d)
trap 'kill $viewer 2>/dev/null || true; rm -rf "$work"' EXIT
cd "$work"

shot() { ffmpeg -loglevel error -y -f x11grab -draw_mouse 1 -video_size 1280x800 -i "$DISPLAY" -frames:v 1 -vf scale=960:-1 -q:v 5 "$out/$1.jpg" </dev/null; }
key() { xdotool key "$1"; sleep 1; }
click() { xdotool mousemove "$1" "$2"; sleep 0.3; xdotool click 1; sleep 1.5; }

"$bin/strata-convert" "synthetic:city?points=8e6&seed=1" -o made.strata >/dev/null 2>&1
"$bin/strata-export" made.strata -o city.laz >/dev/null 2>&1
rm -rf made.strata

"$bin/strata-view" city.laz --size 1280x800 &
viewer=$!
window=$(timeout 60 "$program" search --sync --onlyvisible --name Strata | head -n 1)
xdotool windowfocus "$window"
sleep 2
shot viewer-convert
click 472 431  # "convert"
for _ in $(seq 120); do
  sleep 1
  [ -e city.strata/store.json ] && break
done
sleep 6
window=$(timeout 60 "$program" search --sync --onlyvisible --name Strata | head -n 1)
xdotool windowfocus "$window"
sleep 1
xdotool mousemove 760 470 click --repeat 3 --delay 300 4
sleep 3
key m
click 620 460
click 830 520
key Return
sleep 2
shot viewer-measured
key p
key k
xdotool mousemove 480 620 mousedown 1
for x in 500 520 540 560; do xdotool mousemove $x 620; sleep 0.2; done
xdotool mouseup 1
key k
sleep 2
shot viewer-path
