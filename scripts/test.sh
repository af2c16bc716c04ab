#!/usr/bin/env bash
# The one test command: installs missing tools, then checks formatting, lints, docs and tests, and runs the first example
# as the README does. Tests that lack their data report "ignored". Works on a bare Debian 12 with Rust (rustup) only;
# nothing is cached outside the clone.
set -euo pipefail
cd "$(dirname "$0")/.."

say() { printf '\n== %s\n' "$*"; }

if ! command -v cargo >/dev/null 2>&1; then
  echo "error: cargo is not installed; install Rust from https://rustup.rs first" >&2
  exit 2
fi
if ! command -v cc >/dev/null 2>&1; then
  say "installing a linker"
  apt-get update -qq && apt-get install -y -qq --no-install-recommends gcc libc6-dev
fi
for component in fmt clippy; do
  if ! cargo "$component" --version >/dev/null 2>&1; then
    say "installing $component"
    rustup component add "$([ "$component" = fmt ] && echo rustfmt || echo clippy)"
  fi
done

# The GPU tests need an adapter: where there is none, Mesa's software Vulkan driver stands in.
has_vulkan() { compgen -G '/usr/share/vulkan/icd.d/*.json' >/dev/null || compgen -G '/etc/vulkan/icd.d/*.json' >/dev/null; }
if [ "$(uname)" = Linux ] && ! has_vulkan; then
  say "installing a software Vulkan driver"
  if command -v apt-get >/dev/null 2>&1 && apt-get update -qq && apt-get install -y -qq --no-install-recommends mesa-vulkan-drivers; then
    :
  else
    echo "error: no Vulkan driver, and mesa-vulkan-drivers cannot be installed; install one, then run this again" >&2
    exit 2
  fi
fi
export PLISSE_NEED_GPU=1

say "formatting"
cargo fmt --all -- --check

say "lints"
cargo clippy --workspace --all-targets --locked -- -D warnings

say "tests"
if cargo nextest --version >/dev/null 2>&1; then
  cargo nextest run --workspace --locked
else
  cargo test --workspace --locked --lib --bins --tests
fi

say "docs"
cargo test --workspace --locked --doc
RUSTDOCFLAGS="-D warnings" cargo doc --workspace --locked --no-deps --quiet

say "the first example, as the README has it"
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT
cargo run --release --locked -- solve examples/01-twisted-cylinder.toml -o "$out"
for file in base.obj wrinkled.obj wrinkled.glb field.json report.json picture.png; do
  test -s "$out/$file" || { echo "error: the example did not write $file" >&2; exit 1; }
done

say "all good"
