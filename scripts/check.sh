#!/usr/bin/env bash
# Everything that has to be green before a change lands. Needs the Rust toolchain only; run from anywhere.
# With SKIP_BENCHES=1 the benches are checked by clippy but not run (they build every peer once more, in release).
# With TESTED=1 the workspace's tests are not run again (continuous integration has just done so).
set -euo pipefail
cd "$(dirname "$0")/.."

step() { printf '\n== %s (%s s)\n' "$*" "$SECONDS"; }

step "format"
cargo fmt --all --check

step "clippy, all targets, warnings are errors"
cargo clippy --workspace --all-targets --all-features --quiet -- -D warnings

if [ "${TESTED:-0}" != 1 ]; then
  step "tests and doc tests"
  cargo test --workspace --quiet
fi

step "docs without warnings"
RUSTDOCFLAGS="-D warnings" cargo doc --workspace --no-deps --all-features --quiet

step "feature matrix: none, each alone; the tests are the same, so the results are"
# The conformance suite, the longest, runs with all features in the workspace's tests and here with none.
cargo test -p satisfice --quiet --no-default-features --lib --tests
for features in rayon serde interval; do
  echo "-- satisfice with features: $features"
  cargo test -p satisfice --quiet --no-default-features --features "$features" --lib --test allocation --test checkpoint
done

step "every example, in release, as a user runs it"
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT
for example in examples/*.rs; do
  name=$(basename "$example" .rs)
  echo "-- $name"
  SATISFICE_QUICK=1 SATISFICE_OUT="$out/$name" cargo run --release --quiet --example "$name" > "$out/$name.txt" \
    || { tail -n 40 "$out/$name.txt"; exit 1; }
  tail -n 3 "$out/$name.txt"
done

if [ "${SKIP_BENCHES:-0}" != 1 ]; then
  step "every bench, once, as a test"
  cargo test --release --benches --quiet
fi

step "all green"
