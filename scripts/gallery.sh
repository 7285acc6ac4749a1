#!/usr/bin/env bash
# Makes the pictures of docs/gallery.md, of meshes that belong to the project: globe.png and gallery_* in docs/images, and
# README's clip, hero.webp. Everything on the way lies in out/gallery. Needs a build with a window, ImageMagick, Xvfb, xdotool and chromium.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
for tool in convert import Xvfb xdotool chromium; do
  command -v "$tool" >/dev/null || { echo "install $tool first" >&2; exit 1; }
done
cmake --preset release >&2
cmake --build --preset release --target raymap_cli >&2

raymap="$PWD/build/release/bin/raymap"
out=out/gallery images="$PWD/docs/images"
mkdir -p "$out"
python3 scripts/gallery_figures.py "$out"
cd "$out"
rm -f -- *.png

raymap() { echo "raymap $*"; "$raymap" "$@" --quiet; }
keep() { # a picture, in this size and few colours: pictures in a repository should be small
  convert "$1" -resize "$2" -strip -colors 96 -define png:compression-level=9 "PNG8:$images/gallery_$1"
}

stills=(--size 400 300)
raymap example -o globe.ply
raymap example -o torn.ply --holes
raymap example -o fine.ply --fine
raymap generate globe.ply -o globe.vdb --resolution 256 --overwrite
raymap generate torn.ply -o torn.nrrd --resolution 192 --overwrite
raymap render fine.ply -o globe.png --resolution 512
raymap render globe.vdb -o half.png "${stills[@]}" --cut --shell 0.04
raymap render globe.vdb -o plane.png "${stills[@]}" --cut-plane 0,1,0,0.4 --direction -0.5,-1.1,-1
raymap render globe.vdb -o slice.png "${stills[@]}" --cut-plane 0.3,0,1,0 --slice-plane 0.3,0,1,0
raymap render globe.vdb -o grown.png "${stills[@]}" --iso 0.08
raymap info torn.ply --picture torn.png
raymap render torn.nrrd -o torn_field.png "${stills[@]}"
raymap render bowl.obj -o bowl.png "${stills[@]}" --direction -0.4,-0.8,-1 --thickness 0.06 --resolution 192
raymap render walker.glb --frames 0:23 -o walk.%02d.png --size 150 180 --direction -0.8,-0.2,-0.6 --resolution 128
"$(../../scripts/python_env.sh)" ../../scripts/hero_clip.py "$raymap" .
raymap render globe.vdb -o globe.html --cut
cp globe.png "$images/globe.png"
for picture in half plane slice grown torn torn_field bowl; do keep $picture.png 400x300; done
convert -delay 4 -loop 0 walk.??.png +dither -colors 40 -layers optimize "$images/gallery_walk.gif"

# The page in a browser, and the window on a display in memory.
chromium --headless=new --no-sandbox --hide-scrollbars --window-size=900,640 --virtual-time-budget=20000 \
  --screenshot="$PWD/page.png" "file://$PWD/globe.html" 2>/dev/null
keep page.png 675x480
exec 3>display.txt
Xvfb -displayfd 3 -screen 0 1000x740x24 2>/dev/null &
server=$!
trap 'kill $server' EXIT
until [[ -s display.txt ]]; do sleep 0.1; done
DISPLAY=":$(<display.txt)"
export DISPLAY
"$raymap" view globe.ply --size 1000 740 --resolution 128 --cut-plane 0,0,1,0 --slice-plane 0,1,0,-1.2 >view.txt &
viewer=$!
window=$(xdotool search --sync --onlyvisible --pid "$viewer" | head -1)
xdotool windowfocus --sync "$window" key --window "$window" s # It writes a picture once that is as fine as it will be.
until grep -q wrote view.txt; do sleep 0.2; done
import -window root window.png
xdotool key --window "$window" q
wait "$viewer"
keep window.png 750x555
ls -l "$images"/gallery_*
