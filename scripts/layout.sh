#!/usr/bin/env bash
# The layout that CONTRIBUTING.md promises: no source file of more than 500 lines, no type name twice in one crate.
set -euo pipefail
cd "$(dirname "$0")/.."

wrong=0
while read -r lines file; do
  if [ "$file" != total ] && [ "$lines" -gt 500 ]; then
    echo "$file has $lines lines: 500 are the most" >&2
    wrong=1
  fi
done < <(git ls-files -z '*.rs' '*.py' | xargs -0 wc -l)

for source in crates/*/src; do
  twice=$(git ls-files -z "$source/*.rs" | xargs -0 grep -hoE '^ *(pub(\([a-z]+\))? )?(struct|enum|trait) [A-Z][A-Za-z0-9]*' \
    | awk '{ print $NF }' | sort | uniq -d)
  for name in $twice; do
    echo "$source defines $name more than once" >&2
    wrong=1
  done
done
exit "$wrong"
