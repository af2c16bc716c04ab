#!/usr/bin/env bash
# Builds the page (scripts/web.sh) and opens it in headless Chromium, with WebGL 2 in software:
# paints, changes views, solves a scene, exports a file, and leaves pictures in target/page-test/.
# Fails if the page reports an error or is blank. Not part of scripts/test.sh: the build takes long.
set -euo pipefail
cd "$(dirname "$0")/.."

for tool in chromium python3; do
  if ! command -v "$tool" >/dev/null 2>&1; then
    echo "error: $tool is missing; on Debian 'apt-get install $tool'" >&2
    exit 2
  fi
done
[ "${1:-}" = --built ] || scripts/web.sh
[ "${1:-}" = --built ] ||
  cargo clippy -p plisse-studio --target wasm32-unknown-unknown --locked -- -D warnings

pictures=target/page-test
steps=target/page/test
mkdir -p "$pictures" "$steps"
rm -f "$pictures"/*

cat > "$steps/paint.txt" <<'S'
open curtain
hold
time 0
tab Paint
fit
brush layer wrinkles
brush radius 0.28
wait 0.5
settle
stroke 0.40 0.25 0.42 0.35 0.46 0.45 0.50 0.55 0.52 0.65 0.52 0.75
stroke 0.58 0.25 0.60 0.40 0.60 0.55
settle
S
cat > "$steps/sleeve.txt" <<'S'
open sleeve
hold
time 0.9
settle
fit
settle
S
cat > "$steps/direction.txt" <<'S'
open sleeve
hold
time 0.9
view direction
settle
fit
settle
S
cat > "$steps/solve.txt" <<'S'
tab Physics
settle
solve
settle
show solved
orbit 0 50
fit
settle
S
cat > "$steps/export.txt" <<'S'
open square
hold
time 0.8
tab Export
settle
fit
settle
export surface square.obj
settle
S

python3 -u -m http.server --bind 127.0.0.1 --directory target/page 0 > "$steps/port" 2>/dev/null &
server=$!
trap 'kill $server' EXIT
port=
while [ -z "$port" ]; do
  sleep 0.2
  port=$(sed -n 's/.*port \([0-9]*\).*/\1/p' "$steps/port")
done

soft=(--use-angle=swiftshader --enable-unsafe-swiftshader)
page="http://127.0.0.1:$port/"
for name in paint sleeve direction export; do
  python3 scripts/drive_page.py "$page?graphics=webgl&script=test/$name.txt" \
    "$pictures/$name.png" "${soft[@]}"
done
scene=examples/03-sheared-rectangle.toml
python3 scripts/drive_page.py "$page?graphics=webgl&file=$scene&script=test/solve.txt" \
  "$pictures/solve.png" "${soft[@]}"
if ! grep -q '^v ' "$pictures/square.obj"; then
  echo "error: the exported surface was not downloaded" >&2
  exit 1
fi
echo "pictures are in $pictures"
