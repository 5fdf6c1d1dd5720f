# SPDX-License-Identifier: MIT
"""Command line of bitwuzla, which its wheel does not include: SMT-LIB on stdin, answers on stdout.

SymbiYosys runs this program as `bitwuzla --lang smt2`. It first checks with `--help` that the
option exists.
"""

from __future__ import annotations

import ctypes
import sys
from collections.abc import Iterable, Iterator

import bitwuzla


def commands(lines: Iterable[str]) -> Iterator[str]:
    """Yield the SMT-LIB commands in `lines`, each as soon as its parentheses are balanced."""
    text, depth = "", 0
    for line in lines:
        bare = line.split(";")[0] if "|" not in line else line
        depth += bare.count("(") - bare.count(")")
        text += line
        if depth == 0:
            if text.strip().startswith("("):
                yield text.strip()
            text = ""


def main() -> int:
    """Execute commands until `(exit)` or the end of input; returns the exit code."""
    if "--help" in sys.argv:
        print("--lang <smt2>")
        return 0
    options = bitwuzla.Options()
    options.set(bitwuzla.Option.PRODUCE_MODELS, True)
    parser = bitwuzla.Parser(bitwuzla.TermManager(), options)
    flush = ctypes.CDLL(None).fflush
    for command in commands(sys.stdin):
        word = command[1:].split(None, 1)[0].rstrip(")")
        if word == "exit":
            break
        if word in ("push", "pop"):  # on the solver itself: the parser keeps a count of its own
            levels = int(command[1:-1].split()[1]) if " " in command else 1
            getattr(parser.bitwuzla(), word)(levels)
            continue
        parser.parse(command, False, False)
        flush(None)
    return 0


if __name__ == "__main__":
    sys.exit(main())
