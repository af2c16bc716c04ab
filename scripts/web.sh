#!/usr/bin/env bash
# Builds the studio for browsers into target/page/: the page, its module (WebAssembly), and the
# examples. Any static host can serve that folder.
set -euo pipefail
cd "$(dirname "$0")/.."

target=wasm32-unknown-unknown
out=target/page
say() { printf '== %s\n' "$*"; }

if ! command -v cargo >/dev/null 2>&1; then
  echo "error: cargo is not installed; install Rust from https://rustup.rs first" >&2
  exit 2
fi

# The standard library for browsers: rustup's; else Debian's compiler builds it from its source.
extra=()
build_std=()
if ls "$(rustc --print sysroot)/lib/rustlib/$target/lib" >/dev/null 2>&1; then
  :
elif command -v rustup >/dev/null 2>&1 && rustup target add "$target"; then
  :
elif [ -e /usr/lib/rustlib/src/rust/library/Cargo.lock ] && [ -x /usr/bin/rustc ]; then
  linker=$(rustc --print sysroot)/lib/rustlib/x86_64-unknown-linux-gnu/bin
  extra=(env "PATH=$linker:$PATH" RUSTC=/usr/bin/rustc RUSTC_BOOTSTRAP=1)
  build_std=(-Zbuild-std=std,panic_abort)
else
  echo "error: Rust's target $target is missing; run 'rustup target add $target'," \
    "or on Debian 'apt-get install rustc-web rust-web-src'" >&2
  exit 2
fi

say "building"
# Solves may recurse deeper than the usual stack (1 MB) allows.
"${extra[@]}" cargo rustc -p plisse-studio --bin plisse-studio --target "$target" --profile web \
  --locked "${build_std[@]}" -- -Clink-arg=-zstack-size=8388608

# The tool that joins the module to the page must have the version of the crate.
version=$(sed -n '/^name = "wasm-bindgen"$/{n;s/version = "\(.*\)"/\1/p}' Cargo.lock)
has() { [ "$("$1" --version 2>/dev/null)" = "wasm-bindgen $version" ]; }
bindgen=wasm-bindgen
has "$bindgen" || bindgen=target/web-tools/bin/wasm-bindgen
if ! has "$bindgen"; then
  say "installing wasm-bindgen $version into target/web-tools"
  cargo install wasm-bindgen-cli --version "$version" --root target/web-tools \
    --target-dir target/web-tools/build
fi

say "joining"
mkdir -p "$out"
"$bindgen" --target web --no-typescript --out-dir "$out" "target/$target/web/plisse-studio.wasm"
if command -v wasm-opt >/dev/null 2>&1; then
  say "making it smaller"
  wasm-opt -Os --all-features -o "$out/smaller.wasm" "$out/plisse-studio_bg.wasm" &&
    mv "$out/smaller.wasm" "$out/plisse-studio_bg.wasm"
fi
cp web/index.html "$out/"
cp -r examples "$out/"

packed=$(gzip -9 -c "$out/plisse-studio_bg.wasm" | wc -c)
whole=$(wc -c < "$out/plisse-studio_bg.wasm")
awk -v a="$whole" -v b="$packed" -v out="$out" \
  'BEGIN { printf "== %.1f MB (%.1f MB packed) in %s\n", a / 1e6, b / 1e6, out }'
echo "Serve it:  python3 -m http.server --bind 127.0.0.1 --directory $out 8000"
echo "and open   http://127.0.0.1:8000"
