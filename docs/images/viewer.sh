#!/usr/bin/env bash
# Makes the pictures of docs/viewer.md: a new user's way from a LAZ file to a measured distance.
# usage: docs/images/viewer.sh BIN [OUT], BIN the folder of the programs; needs xvfb-run, xdotool and ffmpeg.
set -euo pipefail
if [ -z "${STRATA_INSIDE_X:-}" ]; then
  STRATA_INSIDE_X=1 exec xvfb-run -a -s "-screen 0 1280x800x24 -noreset" "$0" "$(realpath "$1")" "$(realpath "${2:-$(dirname "$0")}")"
fi
bin=$1 out=$2
work=$(mktemp -d)
trap 'kill $viewer 2>/dev/null || true; rm -rf "$work"' EXIT
cd "$work"

# until PATTERN: until the viewer says so of itself
until_it_says() {
  for _ in $(seq 3000); do
    if grep -qE "$1" state.json 2>/dev/null; then return; fi
    sleep 0.1
  done
  echo "waited in vain for $1" >&2
  exit 1
}
settle() { sleep 0.5 && until_it_says '"settled":true'; }
focus() { settle && xdotool windowfocus "$(xdotool search --onlyvisible --name Strata | head -n 1)" && until_it_says '"focused":true'; }
# shot NAME [WIDTH:HEIGHT:X:Y], of the screen
shot() { settle && ffmpeg -loglevel error -y -f x11grab -draw_mouse 1 -video_size 1280x800 -i "$DISPLAY" -frames:v 1 -vf "crop=${2:-1280:800:0:0},scale=iw*3/4:-1" -q:v 5 "$out/$1.jpg" </dev/null; }
key() { xdotool key "$1" && settle; }
click() { xdotool mousemove "$1" "$2" click 1 && settle; }
item() { click $(sed -n 's/.*"'"$1"'":\[\([0-9]*\)[0-9.]*,\([0-9]*\)[0-9.]*\].*/\1 \2/p' state.json); }

"$bin/strata-convert" "synthetic:city?points=8e6&seed=1" -o made.strata >/dev/null 2>&1
"$bin/strata-export" made.strata -o city.laz >/dev/null 2>&1
rm -rf made.strata

"$bin/strata-view" city.laz --size 1280x800 --state state.json &
viewer=$!
focus
shot viewer-convert 640:200:320:300
item convert || true  # the window goes away
until_it_says '"drawn":[1-9]'
focus
xdotool mousemove 760 470 click --repeat 3 --delay 300 4
settle
key m
click 620 460
until_it_says '"measuring":1'
click 830 520
until_it_says '"measured":1'
key Return
key Escape
shot viewer-measured
key p
key k
xdotool mousemove 480 620 mousedown 1
for x in 500 520 540 560; do xdotool mousemove $x 620 && sleep 0.2; done
xdotool mouseup 1
settle
key k
shot viewer-path
