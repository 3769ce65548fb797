"""The command `satisfice`, as `python -m satisfice`."""

import sys

from ._satisfice import command


def main() -> None:
    """Run the command with the arguments of this process and exit with its code."""
    sys.exit(command(["satisfice", *sys.argv[1:]]))


if __name__ == "__main__":
    main()
