# SPDX-License-Identifier: MIT
"""Records against what is measured now."""

from __future__ import annotations

import pytest


def differences(now, kept, relative: float = 1e-6, where: str = "") -> list[str]:
    """Where `now` is not what the record `kept` holds, a line each; reals may differ by `relative`.

    Both are made of dictionaries, lists, numbers and names.
    """
    if isinstance(kept, dict) and isinstance(now, dict):
        lines = [f"{where}: {sorted(set(kept) ^ set(now))}"] if set(kept) != set(now) else []
        return lines + [
            line
            for key in kept.keys() & now.keys()
            for line in differences(now[key], kept[key], relative, f"{where}/{key}")
        ]
    if isinstance(kept, list) and isinstance(now, list) and len(kept) == len(now):
        pairs = enumerate(zip(now, kept, strict=True))
        return [line for k, (a, b) in pairs for line in differences(a, b, relative, f"{where}/{k}")]
    if isinstance(kept, float) and isinstance(now, float):
        same = now == pytest.approx(kept, rel=relative)
    else:
        same = now == kept
    return [] if same else [f"{where}: {now}, recorded {kept}"]
