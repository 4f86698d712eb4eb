#!/bin/sh
# Makes window.png anew: docs/pictures/window.sh [the program, built with its plugins beside it]
# Needs Xvfb, xdotool and ImageMagick.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
program=${1:-$here/../../target/release/pointstage}
state=$(mktemp -d)
Xvfb :93 -screen 0 1100x720x24 &
server=$!
export DISPLAY=:93
until xdotool getdisplaygeometry > "$state/size" 2>&1; do sleep 0.2; done
"$program" -v --state-folder "$state" "$here/../../sample-data/knotted_snake.ply" 2> "$state/log" &
window=$!
trap 'kill $window $server 2> /dev/null; rm -r "$state"' EXIT

# Waits for a line of the program's log.
wait_for() {
    for _ in $(seq 120); do
        if grep -q "$1" "$state/log"; then return; fi
        sleep 0.5
    done
    cat "$state/log"
    exit 1
}

wait_for 'drawn by org.pointstage.points'
xdotool search --sync --name Pointstage windowsize --sync 1100 720 windowfocus
xdotool mousemove 807 98 click 1 # the second renderer of the list
wait_for 'drawn by org.pointstage.surfel'
xdotool mousemove 380 300 mousedown 1
for _ in 1 2 3 4 5 6 7 8; do xdotool mousemove_relative -- 12 6; done
xdotool mouseup 1 mousemove 400 700
sleep 3 # the last picture has no line of its own
import -window root -strip +dither -colors 250 "PNG8:$here/window.png"
