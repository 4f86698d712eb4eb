#!/bin/sh
# Makes window.png anew: docs/pictures/window.sh [the program, built with its plugins beside it]
# Needs Xvfb, xdotool and ImageMagick.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
program=${1:-$here/../../target/release/pointstage}
folder=$(mktemp -d)
Xvfb :93 -screen 0 1100x720x24 &
server=$!
export DISPLAY=:93
until xdotool getdisplaygeometry > "$folder/size" 2>&1; do sleep 0.2; done
export POINTSTAGE_UI_STATE="$folder/state.json"
"$program" --state-folder "$folder" "$here/../../sample-data/knotted_snake.ply" &
window=$!
trap 'kill $window $server 2> /dev/null; rm -r "$folder"' EXIT

# Waits until the window has settled and its state holds the text $1.
wait_for() {
    for _ in $(seq 120); do
        state=$(cat "$POINTSTAGE_UI_STATE" 2> /dev/null || true)
        case $state in *'"settled":true'*) case $state in *"$1"*) return ;; esac ;; esac
        sleep 0.5
    done
    echo "$state"
    exit 1
}

# Left and top edge of the widget named $1.
place_of() {
    sed -n 's/.*"name":"'"$1"'"[^}]*"rect":\[\([0-9]*\),\([0-9]*\),.*/\1 \2/p' "$POINTSTAGE_UI_STATE"
    echo # the file ends without a line's end, and so would the answer
}

wait_for '"drawn_by":"org.pointstage.points"'
xdotool search --sync --name Pointstage windowsize --sync 1100 720 windowfocus
sleep 1 # the window answers its new size
wait_for '"width":7'
place_of Surfels | {
    read -r x y
    xdotool mousemove $((x + 8)) $((y + 10)) click 1
}
wait_for '"drawn_by":"org.pointstage.surfel"'
xdotool mousemove 380 300 mousedown 1
for _ in 1 2 3 4 5 6 7 8; do xdotool mousemove_relative -- 12 6; sleep 0.1; done
xdotool mouseup 1 mousemove 400 700
sleep 1 # the last gesture reaches the window
wait_for '"drawn_by":"org.pointstage.surfel"'
sleep 1 # the last pass reaches the screen
import -window root -strip +dither -colors 250 "PNG8:$here/window.png"
