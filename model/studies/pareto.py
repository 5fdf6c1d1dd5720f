# SPDX-License-Identifier: MIT
"""Pareto front of points, tuples of costs and errors."""

from __future__ import annotations

from collections.abc import Sequence


def on_front(points: Sequence[tuple[float, ...]]) -> list[bool]:
    """Which of `points` are on the Pareto front.

    A point is a tuple of numbers, smaller is better. It is on the front unless another point is
    different and in no number larger.
    """
    return [
        not any(
            other != point and all(a <= b for a, b in zip(other, point, strict=True))
            for other in points
        )
        for point in points
    ]


def front(points: Sequence[tuple[float, ...]]) -> list[tuple[float, ...]]:
    """The points on the Pareto front, without duplicates, in ascending order."""
    return sorted({p for p, on in zip(points, on_front(points), strict=True) if on})
