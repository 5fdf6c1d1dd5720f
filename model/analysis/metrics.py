# SPDX-License-Identifier: MIT
"""How far pixels are from each other (in bits) and from the exact shading (in LSB)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Mismatch:
    """The first place where two streams differ: its index, and `x, y, r, g, b, last` of each.

    A stream that ended too early has None there.
    """

    index: int
    expected: tuple[int, ...] | None
    got: tuple[int, ...] | None


@dataclass(frozen=True)
class Comparison:
    """Two streams side by side: `pixels` of the longer one, `mismatches` of them, the `first`."""

    pixels: int
    mismatches: int
    first: Mismatch | None


def compare(expected, got) -> Comparison:
    """Compare two streams of pixels (`model.twin.Pixels`) place by place, to the bit.

    Place, colour and the last flag all count; a pixel that only one stream has is a mismatch.
    """
    rows_expected, rows_got = _rows(expected), _rows(got)
    pixels = max(len(rows_expected), len(rows_got))
    both = min(len(rows_expected), len(rows_got))
    differs = np.ones(pixels, bool)
    differs[:both] = (rows_expected[:both] != rows_got[:both]).any(axis=1)
    if not differs.any():
        return Comparison(pixels, 0, None)
    index = int(np.argmax(differs))
    first = Mismatch(index, _row(rows_expected, index), _row(rows_got, index))
    return Comparison(pixels, int(differs.sum()), first)


def _rows(pixels):
    return np.column_stack([pixels.x, pixels.y, pixels.rgb, pixels.last]).astype(np.int64)


def _row(rows, index):
    return tuple(int(v) for v in rows[index]) if index < len(rows) else None


def rounded(exact) -> np.ndarray:
    """The correctly rounded codes, int64, of `exact` = 255*clamp(S, 0, 1): floor(exact + 1/2)."""
    return np.floor(np.asarray(exact, np.float64) + 0.5).astype(np.int64)


def error_metrics(codes, exact) -> dict:
    """The error of `codes` (integers[n, 3]) against `exact` (float64[n, 3], 255*clamp(S, 0, 1)).

    `exact` is not rounded, so perfect codes still have errors of up to 1/2 LSB. Only shaded pixels
    belong here. The keys: `max_lsb`, `mean_lsb` (of magnitudes), `rms_lsb`, `p999_lsb` (99.9 % of
    the channel values are at most this far off), `correctly_rounded` (the share of channel values
    equal to `rounded(exact)`) and `psnr_db` (peak 255; None where there is no error at all). No
    pixels means no error: 0 LSB, a share of 1, and None.
    """
    codes, exact = np.asarray(codes), np.asarray(exact, np.float64)
    if codes.shape != exact.shape:
        raise ValueError(f"codes are {codes.shape}, the exact values {exact.shape}")
    if codes.size == 0:
        return {
            "max_lsb": 0.0, "mean_lsb": 0.0, "rms_lsb": 0.0, "p999_lsb": 0.0,
            "correctly_rounded": 1.0, "psnr_db": None,
        }  # fmt: skip
    error = np.abs(codes - exact)
    mean_square = float(np.mean(error**2))
    return {
        "max_lsb": float(error.max()),
        "mean_lsb": float(error.mean()),
        "rms_lsb": mean_square**0.5,
        "p999_lsb": float(np.quantile(error, 0.999, method="higher")),
        "correctly_rounded": float(np.mean(codes == rounded(exact))),
        "psnr_db": 10 * float(np.log10(255**2 / mean_square)) if mean_square else None,
    }
