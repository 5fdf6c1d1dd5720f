# SPDX-License-Identifier: MIT
"""Comparison metrics: bit-exact comparison of two pixel streams, and error against exact shading.

Errors are in LSB of an 8-bit colour code.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from phong75.model.arrays import ArrayLike, Ints
from phong75.model.config import DEFAULT
from phong75.model.twin import Pixels


@dataclass(frozen=True)
class Mismatch:
    """The first difference of two pixel streams.

    index: number of the pixel in the stream. expected, got: (x, y, red, green, blue, last) of the
    pixel in either stream; None if the stream is shorter.
    """

    index: int
    expected: tuple[int, ...] | None
    got: tuple[int, ...] | None


@dataclass(frozen=True)
class Comparison:
    """Result of comparing two pixel streams.

    pixels: length of the longer stream. mismatches: number of pixels that differ. first: the first
    of them, None if the streams are equal.
    """

    pixels: int
    mismatches: int
    first: Mismatch | None


def compare(expected: Pixels, got: Pixels) -> Comparison:
    """Compare two streams of pixels (`model.twin.Pixels`) pixel by pixel, bit for bit.

    Position, colour and the last flag must be equal. A pixel that only one stream has is a
    mismatch.
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


def _rows(pixels: Pixels) -> Ints:
    """The fields of all pixels, int64[n, 6]."""
    return np.column_stack([pixels.x, pixels.y, pixels.rgb, pixels.last]).astype(np.int64)


def _row(rows: Ints, index: int) -> tuple[int, ...] | None:
    """The fields of pixel `index` as a tuple; None if the stream is shorter."""
    return tuple(int(v) for v in rows[index]) if index < len(rows) else None


def rounded(exact: ArrayLike) -> Ints:
    """The correctly rounded codes floor(exact + 1/2), int64, of `exact` = white clamp(S, 0, 1)."""
    return np.floor(np.asarray(exact, np.float64) + 0.5).astype(np.int64)


def error_metrics(codes: ArrayLike, exact: ArrayLike, white: int = DEFAULT.white) -> dict[str, Any]:
    """Error of `codes` (integers[n, 3]) against `exact` = white clamp(S, 0, 1) (float64[n, 3]).

    `exact` is not rounded, so that perfect codes have errors of up to 1/2 LSB. Pass only shaded
    pixels, no background. The keys of the result:

    - max_lsb, mean_lsb, rms_lsb: maximum, mean and RMS of the error's magnitude, LSB.
    - p999_lsb: 99.9 % quantile: that many channel values have at most this error, LSB.
    - correctly_rounded: fraction of the channel values that equal `rounded(exact)`.
    - psnr_db: peak signal-to-noise ratio, dB, peak `white`; None if all errors are 0.

    Without pixels the errors are 0 LSB, the fraction is 1 and the PSNR None. Raises ValueError if
    the shapes differ.
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
        "psnr_db": 10 * float(np.log10(white**2 / mean_square)) if mean_square else None,
    }
