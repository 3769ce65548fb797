#!/usr/bin/env bash
# Builds the Python package as users get it, installs it in a virtual environment of its own and runs its tests.
# PROFILE=dev (the default) builds as the tests of the workspace are built; PROFILE=release as `pip install` does.
# ONLY=build does not run the tests, ONLY=test runs them on what was built.
# FULL=1 also compares the type stubs with the native part, audits the wheel and tests other tools' adapters.
set -euo pipefail
cd "$(dirname "$0")/../crates/satisfice-python"
profile=${PROFILE:-dev}
target=${CARGO_TARGET_DIR:-$PWD/../../target}
environment=$target/python-environment
python=$environment/bin/python

if ! "${PYTHON:-python3}" -c 'import sys, venv, ensurepip; sys.exit(sys.version_info < (3, 11))' 2> /dev/null; then
  echo "no Python 3.11 or later with venv: the Python package is not tested" >&2
  exit 0
fi
if [ "${ONLY:-build}" = build ]; then
  [ -x "$python" ] || "${PYTHON:-python3}" -m venv "$environment"
  tools=(maturin pytest pandas)
  [ "${FULL:-0}" = 1 ] && tools+=(abi3audit mypy distributed scipy trimesh hyperqueue)
  "$python" -m pip install --quiet --disable-pip-version-check "${tools[@]}"

  # Our crates are those that the workspace's tests have been built with.
  features=()
  [ "$profile" = dev ] && features=(--features as-tested)
  rm -rf "$target/wheels-python"
  CARGO_TARGET_DIR=$target RUSTFLAGS="${RUSTFLAGS:-}" "$python" -m maturin build --quiet --profile "$profile" ${features[@]+"${features[@]}"} --out "$target/wheels-python"
  "$python" -m pip install --quiet --disable-pip-version-check --force-reinstall --no-deps "$target"/wheels-python/*.whl
  "$python" -m pip install --quiet --disable-pip-version-check "$target"/wheels-python/*.whl
fi

if [ "${FULL:-0}" = 1 ]; then
  "$python" -m mypy --strict -p satisfice
  "$python" -m mypy.stubtest satisfice._satisfice
  "$python" -m abi3audit --strict "$target"/wheels-python/*.whl
fi
[ "${ONLY:-test}" = test ] || exit 0
"$python" -m pytest --quiet "$@" tests
