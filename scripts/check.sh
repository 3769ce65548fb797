#!/usr/bin/env bash
# Everything that has to be green before a change lands. Needs the Rust toolchain only; run from anywhere.
# With TESTED=1 the workspace's tests are not run again (continuous integration does so itself), and benches are left out: the
# libraries that they compare with take half as long to check as everything else.
# PROFILE=dev runs examples and benches as the tests are built, instead of building everything once more in release.
set -euo pipefail
cd "$(dirname "$0")/.."

profile=${PROFILE:-release}

step() { printf '\n== %s (%s s)\n' "$*" "$SECONDS"; }

step "format"
cargo fmt --all --check

step "layout: lengths of files, names of types"
scripts/layout.sh

step "licences and sources of the dependencies"
if command -v python3 > /dev/null; then python3 scripts/licences.py; else echo "no python3: not checked"; fi

step "clippy, all targets, warnings are errors"
without_benches=()
[ "${TESTED:-0}" = 1 ] && without_benches=(--exclude satisfice-benches)
cargo clippy --workspace ${without_benches[@]+"${without_benches[@]}"} --all-targets --all-features --quiet -- -D warnings

if [ "${TESTED:-0}" != 1 ]; then
  step "tests and doc tests"
  cargo test --workspace --quiet
fi

step "examples compile ($profile)"
# Of the whole workspace: with another choice of packages, libraries have other features and are compiled again.
cargo build --workspace --examples --profile "$profile" --quiet
folder=$profile
[ "$profile" = dev ] && folder=debug
binaries=${CARGO_TARGET_DIR:-target}/$folder/examples
out=$(mktemp -d)

# Most examples use one core: the other one does the next steps.
run_examples() {
  for example in examples/*.rs crates/satisfice-{bench,draw}/examples/*.rs; do
    name=$(basename "$example" .rs)
    echo "-- $name"
    SATISFICE_QUICK=1 SATISFICE_OUT="$out/$name" "$binaries/$name" > "$out/$name.txt" 2>&1 \
      || { tail -n 40 "$out/$name.txt"; return 1; }
    tail -n 3 "$out/$name.txt"
  done
}
run_examples > "$out/log" &
examples=$!
trap 'kill "$examples" 2> /dev/null || true; rm -rf "$out"' EXIT

step "docs without warnings"
# Nobody calls the native part of the Python package from Rust.
RUSTDOCFLAGS="-D warnings" cargo doc --workspace --exclude satisfice-python --no-deps --all-features --quiet

step "feature matrix: none, each alone"
# The workspace's tests have all features. On one thread they run the code that there is without rayon.
cargo check -p satisfice --quiet --no-default-features --all-targets
for features in rayon interval; do
  echo "-- satisfice with features: $features"
  cargo check -p satisfice --quiet --no-default-features --features "$features"
done

if rustup target list --installed 2> /dev/null | grep -q '^wasm32-unknown-unknown$'; then
  step "the core compiles for the web"
  cargo check -p satisfice --quiet --no-default-features --target wasm32-unknown-unknown
fi

step "fuzz targets compile"
# Their bodies run as tests (satisfice-collision, fuzz_targets and continuous). Without libFuzzer itself, which is C++ and is not linked here.
CUSTOM_LIBFUZZER_PATH=./none.a cargo check --manifest-path fuzz/Cargo.toml --target-dir "${CARGO_TARGET_DIR:-target}" --locked --quiet

if [ "${TESTED:-0}" != 1 ]; then
  step "every bench, once, as a test ($profile)"
  cargo test --workspace --profile "$profile" --bench '*' --quiet
fi

step "every example ($profile)"
wait "$examples" && status=0 || status=$?
cat "$out/log"
[ "$status" = 0 ] || exit "$status"

step "all green"
