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
    ffmpeg -v error -y -i "$2" -vf "scale=240:135:force_original_aspect_ratio=increase:flags=area,crop=240:135:exact=1" \
      -frames:v 1 -q:v $quality "$to/$1.jpg"
    [ "$(wc -c < "$to/$1.jpg")" -gt 10000 ] || return 0
  done
}

# run SCENE FRAME [OPTION…]: a scene at a frame, without what stands on its pictures.
run() {
  scene=$1 frame=$2 name=$(echo "$1" | tr / _)
  shift 2
  "$weir" run "resources/scenes/$scene.json" --frames "$frame" --images "$work/$name" --set render.overlay=false \
    --set render.color.bar=false --set render.width=960 --set render.height=540 "$@" >/dev/null
  thumbnail "$name" "$work/$name/$(ls "$work/$name" | grep png | tail -1)"
}

for picture in docs/images/gallery/*.jpg; do
  name=$(basename "$picture" .jpg)
  if grep -q "gallery/$name.json" "$to/index.json"; then thumbnail "gallery_$name" "$picture"; fi
done
thumbnail jet_fills_goblet docs/images/jet_fills_goblet.png
thumbnail dam_break_cut_open docs/images/dam_break_cut_open.png
run dam_break 12
run dam_break_surface 12
run tank_at_rest 1
run stirrer 20
run measured_fall 9
for scene in sprinkler syrup position_based; do run $scene 10; done
run drops 50
run cohesion 20
run small_waves 9
# Coarser: they have pictures of 240 pixels.
for scene in falling_boxes boat water_wheel white_water; do run $scene 20 --set water.spacing=0.03; done
run gallery/seaside 32 --set water.spacing=0.05
run gallery/fountain 110 --set water.spacing=0.02
run gallery/goblet 93
run gallery/honey 49
run gallery/pillar 24
run gallery/turbine 48
run gallery/waterfall 110
# Its mesh is for users to choose; the picture has the duck of resources/meshes.
run mesh_in_tank 21 --set mesh.file=resources/meshes/duck.obj --set mesh.anchor=base --set mesh.position='[0.75, 0, 0.25]' \
  --set render.surfaces.0.color='[0.95, 0.62, 0.04]'
