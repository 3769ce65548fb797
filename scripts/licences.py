#!/usr/bin/env python3
"""Checks that every dependency comes from crates.io and has a licence that deny.toml allows. Needs no network."""

import json
import pathlib
import re
import subprocess
import sys
import tomllib

ROOT = pathlib.Path(__file__).resolve().parent.parent


def is_allowed(expression, allowed):
    """Whether an SPDX expression can be satisfied: AND binds closer than OR, `/` is an old form of OR."""
    tokens = re.findall(r"\(|\)|[^\s()]+", expression.replace("/", " OR "))

    def alternative():
        fine = conjunction()
        while tokens and tokens[0] == "OR":
            tokens.pop(0)
            fine = conjunction() or fine
        return fine

    def conjunction():
        fine = single()
        while tokens and tokens[0] == "AND":
            tokens.pop(0)
            fine = single() and fine
        return fine

    def single():
        token = tokens.pop(0)
        if token == "(":
            fine = alternative()
            tokens.pop(0)
            return fine
        if tokens and tokens[0] == "WITH":  # an exception makes another licence of it
            token = f"{token} WITH {tokens[1]}"
            del tokens[:2]
        return token in allowed

    return alternative()


def self_test():
    """The rules themselves."""
    assert is_allowed("MIT/Apache-2.0", {"MIT"})
    assert is_allowed("(MIT OR Apache-2.0) AND Unicode-3.0", {"MIT", "Unicode-3.0"})
    assert not is_allowed("(MIT OR Apache-2.0) AND Unicode-3.0", {"MIT"})
    assert not is_allowed("GPL-3.0-only", {"MIT"})
    assert is_allowed("Apache-2.0 WITH LLVM-exception OR MIT", {"MIT"})
    assert not is_allowed("Apache-2.0 WITH LLVM-exception", {"Apache-2.0"})
    assert is_allowed("Apache-2.0 WITH LLVM-exception", {"Apache-2.0 WITH LLVM-exception"})


def main():
    self_test()
    allowed = set(tomllib.loads((ROOT / "deny.toml").read_text())["licenses"]["allow"])
    command = ["cargo", "metadata", "--format-version", "1", "--all-features", "--locked"]
    metadata = json.loads(subprocess.run(command, cwd=ROOT, check=True, capture_output=True).stdout)
    wrong = []
    for package in metadata["packages"]:
        name = f"{package['name']} {package['version']}"
        source = package["source"]
        if source is not None and source != "registry+https://github.com/rust-lang/crates.io-index":
            wrong.append(f"{name} comes from {source}")
        if not package["license"] or not is_allowed(package["license"], allowed):
            wrong.append(f"{name} has the licence {package['license']}, which deny.toml does not allow")
    print(f"{len(metadata['packages'])} packages, {len(wrong)} of them not allowed")
    sys.exit("\n".join(wrong) if wrong else 0)


if __name__ == "__main__":
    main()
