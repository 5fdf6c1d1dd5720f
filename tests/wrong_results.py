# SPDX-License-Identifier: MIT
"""What a broken design or simulation could return, as changes of a good `SimResult`."""


def wrong_colour(result):
    result.pixels.rgb[5, 1] ^= 1


def lost_pixel(result):
    for name in ("x", "y", "rgb", "last"):
        setattr(result.pixels, name, getattr(result.pixels, name)[:-1])


def extra_pixel(result):
    result.extra_pixels = 1


def far_away(result):
    result.pixels.x[0] += 1000
