#!/bin/sh
# Makes the thumbnails of the studio's templates, 240x135 pixels and at most 10 kB each:
#   tools/studio/make_thumbnails.sh build/cpu/bin/weir
# Scenes that docs/ has a picture of are not run again; docs/gallery.md says how those were made. Needs ffmpeg.
set -eu
cd "$(dirname "$0")/../.."
weir=$1
to=resources/scenes/templates
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# thumbnail NAME PICTURE
thumbnail() {
  for quality in 4 6 8 11 15 20; do
    ffmpeg -v error -y -i "$2" -vf "scale=240:135:force_original_aspect_ratio=increase:flags=area,crop=240:135" \
      -frames:v 1 -q:v $quality "$to/$1.jpg"
    [ "$(wc -c < "$to/$1.jpg")" -gt 10000 ] || return 0
  done
}

# run NAME FRAME: a scene at a frame, without what stands on its pictures.
run() {
  "$weir" run "resources/scenes/$1.json" --frames "$2" --images "$work/$1" --set render.overlay=false \
    --set render.color.bar=false --set render.width=960 --set render.height=540 >/dev/null
  thumbnail "$1" "$work/$1/$(ls "$work/$1" | grep png | tail -1)"
}

for picture in docs/images/gallery/*.jpg; do
  name=$(basename "$picture" .jpg)
  [ ! -e "resources/scenes/gallery/$name.json" ] || thumbnail "gallery_$name" "$picture"
done
thumbnail jet_fills_goblet docs/images/jet_fills_goblet.png
thumbnail dam_break_cut_open docs/images/dam_break_cut_open.png
run dam_break 12
run dam_break_surface 12
run tank_at_rest 1
run mesh_in_tank 20
run stirrer 20
