# SPDX-License-Identifier: MIT
"""Every environment variable that Phong75 reads.

For users there is one:

    PHONG75_BUILD   folder for everything that is built; default: build/ of a checkout, else
                    phong75/ in the user's cache folder ($XDG_CACHE_HOME or ~/.cache)

All others are hand-overs from a program to the simulator that it starts, whose Python has no
command line. The names below are their only spelling; to set one by hand has no promised effect.
"""

from __future__ import annotations

#: Folder for everything that is built.
BUILD = "PHONG75_BUILD"

#: Folder with jobs.json, the frames that a simulation runs; its results go there.
JOBS = "PHONG_JOBS"
#: Folder with the vectors of a module test.
VECTORS = "PHONG_VECTORS"
#: Name of the module under test.
MODULE = "PHONG_MODULE"
#: Name of the configuration of the module under test.
CONFIG = "PHONG_CONFIG"
#: Seed of the random vectors of a module test.
SEED = "PHONG_SEED"
#: Only every so many vectors are sent: a slow simulator asks for it.
THIN = "PHONG_THIN"
#: Folder for coverage counts; where it is set, every bench counts.
COVERAGE = "PHONG_COVERAGE"
#: Set: the scratch folder of a simulation of frames stays, for a look at its logs.
KEEP = "PHONG_KEEP"
