#!/usr/bin/env bash
# Renews the pictures of docs/studio.md (those of the page excepted) by scripts of the studio. Needs a
# desktop, or Xvfb with a software Vulkan driver: xvfb-run -s "-screen 0 1280x800x24" SCRIPT.
# usage: studio-pictures.sh [PLISSE-STUDIO]
set -euo pipefail
cd "$(dirname "$0")/.."

studio=${1:-target/release/plisse-studio}
pictures=docs/images/studio
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# A picture NAME of SIZE, by the script on standard input.
picture() {
  cat > "$work/$1.txt"
  printf 'settle\nscreenshot %s\nquit\n' "$pictures/$1.png" >> "$work/$1.txt"
  "$studio" --size "$2" --script "$work/$1.txt"
}

picture paint 1000x680 <<'S'
open curtain
hold
time 0
tab Paint
fit
settle
brush value 0.85
brush radius 0.3
stroke 0.42 0.10 0.43 0.30 0.44 0.45 0.45 0.60 0.46 0.75 0.47 0.88
stroke 0.64 0.28 0.60 0.38 0.56 0.47 0.54 0.55 0.58 0.62 0.64 0.68
S

picture direction 1000x680 <<'S'
open sleeve
hold
time 0.8
view direction
orbit -10 14
settle
fit
S

picture solved 1000x680 <<'S'
open examples/01-twisted-cylinder.toml
tab Physics
solve
settle
show solved
fit
S

picture grown 1280x800 <<'S'
open examples/22-gathers.toml
tab Grow
grow
settle
orbit -5 50
fit
S

# A flat sheet of 60 x 60 squares, 1 m wide.
awk 'BEGIN {
  for (y = 0; y <= 60; y++) for (x = 0; x <= 60; x++) print "v", x / 60, y / 60, 0
  for (y = 0; y < 60; y++) for (x = 0; x < 60; x++) {
    a = 61 * y + x + 1
    print "f", a, a + 1, a + 62
    print "f", a, a + 62, a + 61
  }
}' > "$work/sheet.obj"
picture fold 1280x800 <<S
open $work/sheet.obj
tab Grow
spacing 0.12
fold on
orbit 20 -10
fit
settle
brush radius 0.09
stroke 0.38 0.42 0.43 0.42 0.48 0.42 0.53 0.42 0.58 0.42
settle
stroke 0.42 0.62 0.46 0.61 0.50 0.60 0.54 0.57 0.58 0.53
S
