# A hand at strata-view inside an X server; sourced by the scripts beside it.
# shellcheck shell=bash
program=$(type -P xdotool)
xdotool() { timeout 10 "$program" "$@" || true; }  # now and then it waits for an answer that does not come
focus() { xdotool windowfocus "$window" 2>/dev/null || true; }

# start_viewer STRATA_VIEW ARGUMENT...: sets $viewer and $window
start_viewer() {
  "$@" &
  viewer=$!
  trap 'kill $viewer 2>/dev/null || true' EXIT
  window=$(timeout 60 "$program" search --sync --onlyvisible --name Strata | head -n 1)
  focus
}

# By Control + Q, which slow machines take in late; ends the script with the viewer's exit code.
quit_viewer() {
  for _ in $(seq 60); do
    xdotool key ctrl+q 2>/dev/null
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
}
