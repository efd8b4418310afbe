#!/bin/sh
# Makes the pictures of the README, byte for byte: docs/pictures/make.sh [FOLDER]   (LUNULA=PROGRAM if not on PATH)
set -eu
lunula=${LUNULA:-lunula}
out=${1:-$(dirname "$0")}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# Average coloration of 16 generated subjects in four poses.
"$lunula" phantom photos --seed 1 --light chamber --poses nominal,extension,flexion,normal --no-normalized \
    --out "$work/scene" --quiet
"$lunula" photos "$work/scene/photos" --size 200 --out "$work/coloration" --quiet
mv "$work/coloration/figures/contrast.png" "$out/coloration.png"
