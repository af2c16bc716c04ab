#!/usr/bin/env bash
# The tests of the studio's window. scripts/test.sh lints the studio with all else but leaves these out: building a window takes long.
set -euo pipefail
cd "$(dirname "$0")/.."

if ! command -v cargo >/dev/null 2>&1; then
  echo "error: cargo is not installed; install Rust from https://rustup.rs first" >&2
  exit 2
fi
if cargo nextest --version >/dev/null 2>&1; then
  cargo nextest run -p plisse-studio --locked
else
  cargo test -p plisse-studio --locked --lib --bins --tests
fi
