# SPDX-License-Identifier: MIT
"""`python -m phong75.scripts.export`."""

import sys

from phong75.scripts.export import main

sys.exit(main())
