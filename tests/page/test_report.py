# SPDX-License-Identifier: MIT
"""The page of `make report`: what is in it, and in Chromium what it draws and what its controls do.

The tests marked `browser` need Chromium.
"""

import base64
import csv
import io
import json
import shutil

import numpy as np
import pytest
from PIL import Image

from phong75.model import twin
from phong75.model.analysis.pictures import canvas, write_picture
from phong75.model.config import TECHNIQUES
from phong75.model.frame import InputError, fitted
from phong75.model.front.scene import bundled_scenes, load_scene
from phong75.model.scene_to_frame import front_end
from phong75.scripts import console, recorded, scene_results
from phong75.scripts import run as run_scene
from phong75.scripts.console import Steps
from phong75.scripts.page import report
from phong75.sim.design import PACKAGE
from phong75.sim.frame.run_frame import SimResult

RED, BLUE = (200, 30, 20), (20, 40, 200)
SCENES = ("pyramid", "sphere")
SECTIONS = (
    "scenes", "shadings", "techniques", "cycles", "features", "precision", "tessellation",
    "arguments", "stability", "budget", "hardware",
)  # fmt: skip
browser = pytest.mark.browser


def point(method, label, cycles, rms, **more):
    """A row of the precision sweep."""
    return {
        "name": label, "family": "precision", "method": method, "label": label, "cycles": cycles,
        "clock_mhz": 200, "clock_source": "stated", "frame_us": cycles / 200, "max_lsb": 2 * rms,
        "rms_lsb": rms, "p999_lsb": 1.5 * rms, "mean_lsb": rms / 2,
        "correctly_rounded": 1 - rms / 9, "psnr_db": 50, "simulate_s": 1, "model_s": 0.5,
        "dsp": "", "lut_cells": "", "ff": "", "ebr": "", "pareto": 1,
    } | more  # fmt: skip


PRECISION = [
    point("tables", "8 lines", 1000, 2.0), point("tables", "64 lines", 1000, 0.4),
    point("Newton", "1 step", 1300, 0.3), point("Newton", "2 steps", 1900, 0.29),
]  # fmt: skip


#: A technique that went well and one that did not, neither with a picture.
TECHNIQUES_RUN = [
    {"scene": scene, "technique": technique, "configuration": "default_lights_8", "lights": 8,
     "multipliers": 22, "size": "640×480", "pixels": 4000, "spans": 500, "cycles": 32_100,
     "fps": 6230.0, "stalled_cycles": 40_000, "mismatches": wrong, "max_lsb": 0.5111,
     "bound_lsb": 0.5222, "correctly_rounded": 0.999, "undecided": 0}
    for scene, technique, wrong in (("coloured_lights", "phong", 0), ("lamps", "gouraud", 3))
]  # fmt: skip


def write_csv(path, rows):
    with path.open("w", newline="") as file:
        out = csv.DictWriter(file, rows[0])
        out.writeheader()
        out.writerows(rows)


def solid(path, colour):
    """Fill the picture in `path` with a colour."""
    with Image.open(path) as picture:
        Image.new("RGB", picture.size, colour).save(path)


@pytest.fixture(scope="module")
def build(tmp_path_factory):
    """A build folder with two scenes that were run, one of them "in" two older techniques, which
    are a red and a blue picture here, and small tables of each kind."""
    build = tmp_path_factory.mktemp("build")
    for name in SCENES:
        out = build / name
        request = run_scene.request(name, size=(160, 120), out=out)
        run_scene.run(request, run_scene.run_frame.simulate, Steps())
    for name, colour in (("gouraud", RED), ("flat", BLUE)):
        shutil.copytree(build / "sphere", build / f"sphere-{name}")
        solid(build / f"sphere-{name}" / "frame.png", colour)
    report.compare_missing(build)
    (build / "sweep").mkdir()
    write_csv(build / "sweep" / "precision.csv", PRECISION)
    write_csv(build / "sweep" / "tessellation.csv", [
        {"shape": "sphere", "technique": t, "level": k, "triangles": 20 * 4**k,
         "spans": "" if t == "cubic" else 90 * 2**k,
         "cycles": "" if t == "cubic" else 9000 + 10 * 2**k, "max_lsb": 30 / 4**k,
         "rms_lsb": 9 / (1 + j) / 4**k, "p999_lsb": 20 / 4**k, "mean_lsb": 3 / 4**k,
         "method_rms_lsb": 8 / (1 + j) / 4**k}
        for j, t in enumerate(("flat", "gouraud", "phong", "cubic")) for k in range(4)
    ])  # fmt: skip
    orders = {"method_rms": 1.83, "facing_rms": 2.0, "highlight_rms": 1.99}
    (build / "sweep" / "tessellation.json").write_text(json.dumps(
        {"orders": {"sphere": {t: orders for t in ("phong", "gouraud", "flat")}}}
    ))  # fmt: skip
    band = {"slope_rms": 0.25, "intensity_rms": 1e-14}
    turn = {"change_rms": 0.5, "change_max": 29.0, "peak_range": [200, 236]}
    techniques = ("phong", "gouraud", "flat")
    (build / "sweep" / "arguments.json").write_text(json.dumps({
        "mach_bands": {"torus": {"16": dict.fromkeys(techniques, band)}},
        "flicker": {"torus": dict.fromkeys(techniques, turn)},
        "orientation": {k: {"largest_spread_lsb": 127.5} for k in ("quadrilateral", "triangles")},
    }))  # fmt: skip
    row = {"scene": "sphere", "size": "160×120", "pixels": 9000, "spans": 500, "cycles": 9075,
           "fps": 22000.0, "mismatches": 0, "max_lsb": 0.5, "bound_lsb": 0.55}  # fmt: skip
    (build / "results.json").write_text(json.dumps(
        {"schema": report.RESULTS, "fps": 30, "clock_hz": 200e6, "cycles_available": 6_666_666,
         "rows": [row], "techniques": TECHNIQUES_RUN}
    ))  # fmt: skip
    case = {"case": "a case", "extreme": "much", "expected": "well", "pixels": 5, "max_lsb": 0.5,
            "bound_lsb": 0.6, "mismatches": 0, "zero_normals": 1, "failures": [],
            "verdict": "ok"}  # fmt: skip
    bad = case | {"case": "<b>bad</b>", "max_lsb": None, "failures": ["it broke"],
                  "verdict": "FAILED"}  # fmt: skip
    errors = [
        {"family": f"n ≤ {limit}", "limit": limit, "steep": False, "bound_lsb": 0.6,
         "scenes_lsb": 0.51, "adversarial_lsb": 0.55, "adversarial_bound_lsb": 0.58}
        for limit in (10, 32, 128)
    ]  # fmt: skip
    (build / "stability").mkdir()
    (build / "stability" / "report.json").write_text(json.dumps({
        "schema": report.STABILITY, "rows": [case, bad], "errors": errors,
        "amm_2012_at_20": 0.00141,
        "powers": [{"n": 20, "codes": 4, "max_error": 1e-5, "at_versine": 0, "bound": 2e-5}],
    }))  # fmt: skip
    return build


@pytest.fixture(scope="module")
def html(build):
    return report.page(build)


# -- without a browser -----------------------------------------------------------------------------


def test_the_numbers_are_those_of_the_runs(html, build):
    for name in SCENES:
        run = json.loads((build / name / "report.json").read_text())
        assert f"{run['error']['max_lsb']:.4f} LSB, bound {run['error']['bound_lsb']:.4f}" in html
        assert f"0 of {run['pixels']:,} pixels".replace(",", " ") in html
    assert "LFE5U-85F" in html and "make formal" in html and "it broke" in html
    assert "0.25, 0" in html and "200 to 236" in html
    assert "1.83, 2.00, 1.99" in html and "the frame is one-sided" in html
    assert "&lt;b&gt;bad&lt;/b&gt;" in html and "<b>bad</b>" not in html


def test_techniques_show_their_figures_and_pictures(html, build):
    part = html.partition('<section id="techniques"')[2].partition("</section>")[0]
    good, bad = part.split("<article")[1:]
    assert "coloured_lights" in good and 'verdict good">ok' in good and "eight coloured" in good
    assert "0.5111 LSB, bound 0.5222" in good and "32 100, 8.025 per pixel" in good
    assert "default_lights_8" in good and "0 of 2 × 4 000" in good
    assert "lamps, Gouraud" in bad and 'verdict bad">failed' in bad and "<img" not in good + bad
    path = scene_results.picture_path(build, "lamps", "gouraud")
    path.parent.mkdir()
    shutil.copy(build / "sphere" / "frame.png", path)
    shown = report.techniques(report.load(build / "results.json"), build)
    assert [bool(t.picture) for t in shown] == [False, True]
    shutil.rmtree(path.parent)


def test_what_is_missing_names_its_command(tmp_path, monkeypatch):
    monkeypatch.setattr(recorded, "FOLDER", tmp_path)
    html = report.page(tmp_path)
    for target in ("run", "compare", "scenes", "sweep", "tessellation", "stability", "synth"):
        command = f"make {target}"
        assert f"{target}:" in (PACKAGE / "Makefile").read_text()
        assert f"Not run yet: <code>{command}" in html, command


def test_every_part_names_its_scene_and_size(html):
    for part in SECTIONS:
        text = html.partition(f'<section id="{part}"')[2].partition("</section>")[0]
        assert '<p class="shown">' in text, part
    for text in (
        "pyramid <span class=\"note\">160 × 120</span>", "cone, 320 × 240, as in Figs. 1, 4",
        "Every bundled scene at 160×120.",
        "teapot 320 × 240 (", "highlights 384 × 128 (", "facets 960 × 160 (",
        "sphere; 640 × 480.", "Scenes: torus; 640 × 480.", "30 frames of 320 × 240",
        "a square; 200 × 200", "3840 × 2160", "pyramid, 160 × 120: bound",
    ):  # fmt: skip
        assert text in html, text


def test_a_tessellation_plot_shows_either_codes_or_unrounded_values(build):
    rows = report.load_csv(build / "sweep" / "tessellation.csv", report.TESSELLATION)
    plots = report.tessellation_plots(rows)
    codes, unrounded = (
        plots[f"sphere/triangles/{error}"] for error in ("rms_lsb", "method_rms_lsb")
    )
    assert [trace["name"] for trace in codes["data"]] == ["flat", "Gouraud", "Phong"]
    names = [trace["name"] for trace in unrounded["data"]]
    assert names == ["flat", "Gouraud", "Phong", "cubic (model only)"]
    for trace in unrounded["data"]:
        assert ("codes of the RTL" in trace["text"][0]) == ("cubic" not in trace["name"])
    assert unrounded["layout"]["yaxis"]["title"]["text"].startswith("not rounded")
    assert "perfect rounding" in str(codes["layout"]) and "perfect" not in str(unrounded["layout"])


def test_pictures_are_packed_without_loss(build):
    path = build / "pyramid" / "error.png"
    head, _, data = report.data_uri(path).partition(",")
    assert head == "data:image/webp;base64"
    with Image.open(io.BytesIO(base64.b64decode(data))) as packed, Image.open(path) as picture:
        np.testing.assert_array_equal(packed.convert("RGB"), picture.convert("RGB"))


def without_rtl(path, frame, config, progress=None):
    """A simulation that gives the model's pixels."""
    pixels = twin.render(frame, config)
    count = len(pixels.x)
    return SimResult(pixels, True, count, 77, 0, 0, 0, 0.0, 0.0)


def test_the_page_of_all_scenes_weighs_less_than_5_mb(build, tmp_path):
    """All bundled scenes at their own size, by every technique, and the charts of the studies."""
    shutil.copytree(build, tmp_path, dirs_exist_ok=True)
    for name in bundled_scenes():
        out = tmp_path / name
        run_scene.run(run_scene.request(name, out=out), without_rtl, Steps())
        for technique in ("gouraud", "flat"):
            config = TECHNIQUES[technique]
            frame = front_end(load_scene(name, None, config), config).frame
            pixels = twin.render(frame, config)
            (tmp_path / f"{name}-{technique}").mkdir(exist_ok=True)
            write_picture(
                tmp_path / f"{name}-{technique}" / "frame.png",
                canvas(frame, pixels.x, pixels.y, pixels.rgb),
            )
    runs = []
    (tmp_path / "techniques").mkdir()
    for scene, technique in scene_results.technique_runs():
        config = TECHNIQUES[technique]
        frame = front_end(load_scene(scene, None, config), config).frame
        pixels = twin.render(frame, fitted(config, frame))
        path = scene_results.picture_path(tmp_path, scene, technique)
        write_picture(path, canvas(frame, pixels.x, pixels.y, pixels.rgb))
        runs.append(TECHNIQUES_RUN[0] | {"scene": scene, "technique": technique})
    results = json.loads((tmp_path / "results.json").read_text()) | {"techniques": runs}
    (tmp_path / "results.json").write_text(json.dumps(results))
    noise = np.random.default_rng(75).integers(0, 256, (300, 300, 3), np.uint8)  # 270 kB
    for name in ("mach", "flicker", "orientation"):
        write_picture(tmp_path / "sweep" / f"{name}.png", noise)
    text = report.page(tmp_path)
    assert text.count("data:image/webp") == 5 * len(bundled_scenes()) + len(runs) + 3 + 1
    assert len(text.encode()) < report.LIMIT_BYTES == 5_000_000


def test_backticks_are_code():
    assert report.code("a `b` <c> `<d>`") == "a <code>b</code> &lt;c&gt; <code>&lt;d&gt;</code>"


def test_the_clock_is_named():
    rows = [point("a", str(k), 1000, 1.0) for k in range(3)]
    shown = report.precision_plots(rows)["frame_us/rms_lsb"]["data"][1]["marker"]["symbol"]
    assert shown == ["circle"] * 3  # all the same: none is worse
    assert (
        report.clock_note(rows) == "The clock is a stated 200 MHz, not measured, the same for all."
    )
    rows[0] |= {"clock_mhz": 150, "clock_source": "nextpnr, grade 6, seed 1, kept"}
    rows[0]["longest_path"] = "ram to rom"
    plots = report.precision_plots(rows)
    shown = plots["frame_us/rms_lsb"]["data"][1]["marker"]["symbol"]
    assert shown == ["circle", "circle-open", "circle-open"]
    assert plots["cycles/rms_lsb"]["data"][1]["marker"]["symbol"] == ["circle"] * 3
    hover = plots["frame_us/rms_lsb"]["data"][1]["text"]
    assert "at 150 MHz (nextpnr, grade 6, seed 1, kept)" in hover[0]
    assert "longest path: ram to rom" in hover[0] and "longest path" not in hover[1]
    note = report.clock_note(rows)
    assert "(nextpnr, grade 6, seed 1, kept), but for 2 of 3, the open marks: a stated 200" in note
    for row in rows[1:]:
        row["clock_source"] = "nextpnr, grade 6, seed 1"
    assert "stated" not in report.clock_note(rows)


def test_a_broken_file_is_named(build, tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(report, "run_missing", lambda *_: None)
    monkeypatch.setattr(report, "compare_missing", lambda *_: None)
    (tmp_path / "stability").mkdir()
    (tmp_path / "sweep").mkdir()
    for name, text, message in (
        ("results.json", "{", "not JSON"),
        ("stability/report.json", '{"schema": 1, "rows": []}', "another version wrote it"),
        ("sweep/precision.csv", "method,label\na,b\n", "no column `cycles`"),
    ):
        (tmp_path / name).write_text(text)
        assert console.exit_code(lambda: report.main(tmp_path)) == 2
        lines = capsys.readouterr().err.splitlines()
        assert len(lines) == 1 and lines[0].startswith(f"Error: {tmp_path / name}: {message}")
        assert not (tmp_path / "report").exists()
        (tmp_path / name).unlink()


def test_the_page_is_one_file(build, capsys, monkeypatch):
    monkeypatch.setattr(report, "run_missing", lambda *_: None)
    monkeypatch.setattr(report, "compare_missing", lambda *_: None)
    assert report.main(build) == 0
    assert [p.name for p in (build / "report").iterdir()] == ["index.html"]
    assert "report/index.html: " in capsys.readouterr().out


def test_scenes_without_a_current_result_are_run(build, monkeypatch, capsys):
    ran = []

    def run(request, simulate, steps):
        assert request.out == report.folder(build, request.scene, request.config.technique)
        ran.append((request.scene, request.config.technique))

    monkeypatch.setattr(report.run_scene, "run", run)
    report.run_missing(list(SCENES), build)
    # The sphere is there in all three.
    assert ran == [("pyramid", "gouraud"), ("pyramid", "flat")]
    monkeypatch.setattr(report, "newest_source", lambda: 4e9)
    report.run_missing(["sphere"], build)
    assert ran[2:] == [("sphere", technique) for technique in ("phong", "gouraud", "flat")]


def test_the_comparison_is_made_if_there_is_no_current_one(build, monkeypatch):
    ran = []
    monkeypatch.setattr(report.compare, "compare", lambda request, steps: ran.append(request))
    report.compare_missing(build)
    assert not ran
    monkeypatch.setattr(report, "newest_source", lambda: 4e9)
    report.compare_missing(build)
    assert [(r.scene, r.size, r.out) for r in ran] == [
        (*report.compare.SHOWN, build / "cone-compare")
    ]


def test_a_comparison_that_failed_is_seen(build, tmp_path):
    shutil.copytree(build / "cone-compare", tmp_path / "cone-compare")
    path = tmp_path / "cone-compare" / "comparison.json"
    found = json.loads(path.read_text())
    assert found["shadings"][1]["mismatches"] == 0
    found["shadings"][1]["mismatches"] = 7
    path.write_text(json.dumps(found))
    part = report.page(tmp_path).partition('<section id="shadings"')[2].partition("</section>")[0]
    assert 'verdict bad">failed' in part and "Gouraud: 7 of " in part


def test_a_scene_that_cannot_be_run_ends_the_report(build, monkeypatch):
    def run(request, simulate, steps):
        raise InputError("no such scene")

    monkeypatch.setattr(report, "newest_source", lambda: 4e9)
    monkeypatch.setattr(report.run_scene, "run", run)
    with pytest.raises(InputError, match="no such scene"):
        report.run_missing(["sphere"], build)


# -- in Chromium -----------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def chromium():
    from playwright.sync_api import sync_playwright

    path = shutil.which("chromium")
    assert path, "Chromium is missing: apt-get install chromium"
    with sync_playwright() as playwright:
        made = playwright.chromium.launch(executable_path=path, args=["--no-sandbox"])
        yield made
        made.close()


@pytest.fixture
def visit(chromium, tmp_path):
    """Open a text as a page: what it complains of, and what it asks for, is kept and must be
    nothing but the page."""
    pages, complaints = [], []

    def visit(html, width=1280, height=900, **options):
        path = tmp_path / "index.html"
        path.write_text(html, encoding="utf-8")
        page = chromium.new_page(
            viewport={"width": width, "height": height}, reduced_motion="reduce", **options
        )
        page.on("console", lambda message: complaints.append(f"{message.type}: {message.text}"))
        page.on("pageerror", lambda error: complaints.append(str(error)))
        page.on("request", lambda request: request.url.startswith("data:")
                or request.url == path.as_uri() or complaints.append(request.url))  # fmt: skip
        page.goto(path.as_uri())
        page.wait_for_selector("html[data-ready]", state="attached")
        pages.append(page)
        return page

    yield visit
    for page in pages:
        page.close()
    assert not complaints, complaints


def drawn(element):
    """The pixels of an element as they are on the screen, int[height, width, 3]."""
    element.scroll_into_view_if_needed()
    with Image.open(io.BytesIO(element.screenshot())) as picture:
        return np.asarray(picture.convert("RGB")).astype(int)


def near(pixels, colour, tolerance=24):
    """Which of `pixels` have about the colour, bool[height, width]."""
    return (np.abs(pixels - np.array(colour)) <= tolerance).all(axis=-1)


def rgb(text):
    return tuple(int(text[k : k + 2], 16) for k in (1, 3, 5))


def check_the_wipe(page):
    scene = page.locator("#scene-sphere")
    scene.locator(".choose-left").select_option("gouraud")
    scene.locator(".choose-right").select_option("flat")
    for percent in (0, 25, 70, 100):
        scene.locator(".slider").fill(str(percent))
        pixels = drawn(scene.locator(".wipe"))[2:-2]  # the outline may fall between pixels
        edge = round(percent * pixels.shape[1] / 100)
        left, right = pixels[:, 2 : max(edge - 3, 2)], pixels[:, edge + 3 : -2]
        assert near(left, RED).all(), f"{percent} %: left of the edge"
        assert near(right, BLUE).all(), f"{percent} %: right of the edge"


@browser
def test_the_slider_wipes_one_picture_over_the_other(visit, html):
    check_the_wipe(visit(html))


@browser
def test_the_check_of_the_slider_can_fail(visit, html):
    with pytest.raises(AssertionError, match="edge"):
        check_the_wipe(visit(html.replace("clip-path: inset", "unknown: inset")))


@browser
def test_a_click_on_the_picture_moves_the_edge(visit, html):
    page = visit(html)
    scene = page.locator("#scene-sphere")
    scene.locator(".choose-left").select_option("gouraud")
    scene.locator(".choose-right").select_option("flat")
    scene.locator(".wipe").scroll_into_view_if_needed()
    box = scene.locator(".wipe").bounding_box()
    page.mouse.click(box["x"] + 0.8 * box["width"], box["y"] + 0.5 * box["height"])
    share = near(drawn(scene.locator(".wipe")), RED).mean()
    assert abs(share - 0.8) * box["width"] < 5  # the edge itself is 4 pixels wide


@browser
def test_the_slider_moves_by_keyboard(visit, html):
    page = visit(html)
    slider = page.locator("#scene-sphere .slider")
    slider.focus()
    page.keyboard.press("End")
    assert slider.input_value() == "100"


@browser
def test_the_picture_is_that_of_the_rtl(visit, html, build):
    page = visit(html)
    scene = page.locator("#scene-pyramid")
    scene.locator(".slider").fill("100")
    pixels = drawn(scene.locator(".wipe"))[:, :-4]
    with Image.open(build / "pyramid" / "frame.png") as picture:
        size = (pixels.shape[1] + 4, pixels.shape[0])
        want = np.asarray(picture.resize(size, Image.Resampling.BILINEAR)).astype(int)[:, :-4]
    assert np.abs(pixels - want).mean() < 3 and np.ptp(want) > 100
    error_map = drawn(scene.locator("img.map"))
    assert len(np.unique(error_map.reshape(-1, 3), axis=0)) > 50


def mark_at(page, plot, trace, index):
    """Where on the screen a mark of a plot should be: x, y in pixels of the plot's screenshot."""
    return page.evaluate(
        """([plot, trace, index]) => {
          const div = document.getElementById("plot-" + plot), l = div._fullLayout;
          const data = div.data.filter((t) => t.mode !== "lines")[trace];
          return [l.xaxis._offset + l.xaxis.d2p(data.x[index]),
                  l.yaxis._offset + l.yaxis.d2p(data.y[index])];
        }""",
        [plot, trace, index],
    )


@browser
def test_the_marks_are_drawn_where_the_numbers_are(visit, html):
    page = visit(html)
    plot = page.locator("#plot-precision")
    pixels = drawn(plot)
    places = []
    for trace, colour in enumerate(report.COLOURS[:2]):
        for index in range(2):
            x, y = (round(v) for v in mark_at(page, "precision", trace, index))
            assert near(pixels[y - 3 : y + 4, x - 3 : x + 4], rgb(colour)).mean() > 0.5, (x, y)
            places.append((x, y))
    # Higher errors are higher up, more time is further right.
    (x0, y0), (x1, y1), (x2, y2), (x3, y3) = places
    assert x0 == x1 < x2 < x3 and y0 < y1 < y2 < y3
    front = near(pixels, (0xC4, 0xC4, 0xC4), 12)
    assert front.sum() > 500, "no Pareto front"


@browser
def test_choosing_an_axis_draws_another_plot(visit, html):
    page = visit(html)
    plot = page.locator("#plot-precision")
    before, title = drawn(plot), "share not correctly rounded"
    page.locator("#precision-error").select_option(label=title)
    page.wait_for_timeout(200)
    after = drawn(plot)
    assert (before != after).any(axis=-1).sum() > 300
    assert plot.locator(".ytitle").text_content() == title
    costs = page.locator("#precision-cost option").all_text_contents()
    assert (
        "run time of all frames, µs" in costs and "multipliers" not in costs
    )  # nothing was synthesized


@browser
def test_values_show_on_hover(visit, html):
    page = visit(html)
    plot = page.locator("#plot-precision")
    plot.scroll_into_view_if_needed()
    before = drawn(plot)
    box, (x, y) = plot.bounding_box(), mark_at(page, "precision", 1, 1)
    page.mouse.move(box["x"] + x, box["y"] + y)
    label = plot.locator(".hoverlayer .hovertext")
    label.wait_for()
    assert "Newton: 2 steps" in label.text_content() and "0.29 LSB" in label.text_content()
    assert (before != drawn(plot)).any(axis=-1).sum() > 1000


@browser
@pytest.mark.parametrize("name", ["budget", "tessellation", "errors", "stages"])
def test_every_plot_is_drawn_in_its_colours(visit, html, name):
    page = visit(html)
    pixels = drawn(page.locator(f"#plot-{name}"))
    traces = page.evaluate(f"document.getElementById('plot-{name}').data.length")
    for colour in report.COLOURS[: min(traces, 2)]:
        assert near(pixels, rgb(colour)).sum() > 100, colour


@browser
def test_light_and_dark(visit, html):
    """By the system's setting and by the button; text keeps its contrast, plots follow."""
    for scheme in ("light", "dark"):
        page = visit(html, color_scheme=scheme)
        for _ in range(2):
            pixels = drawn(page.locator("#h-cycles"))
            paper, ink = pixels[0, 0].mean(), pixels.mean(axis=-1)
            assert (paper < 64) == (scheme == "dark"), scheme
            assert np.abs(ink - paper).max() > 180
            plot = drawn(page.locator("#plot-errors"))
            assert (plot[2, 2].mean() < 64) == (scheme == "dark"), f"plot, {scheme}"
            page.locator("#theme").click()
            scheme = "dark" if scheme == "light" else "light"


@browser
def test_on_a_phone(visit, html):
    page = visit(html, 360, 740)
    assert page.evaluate("document.documentElement.scrollWidth") <= 360
    picture = page.locator("#scene-sphere .wipe").bounding_box()
    assert picture["width"] > 260 and picture["x"] + picture["width"] <= 360
    assert near(drawn(page.locator("#plot-precision")), rgb(report.COLOURS[1])).sum() > 30


@browser
@pytest.mark.parametrize("width", [360, 800, 1280])
def test_the_verdicts_of_stability_show_without_scrolling_aside(visit, html, width):
    page = visit(html, width)
    region = page.get_by_role("region", name="Stability cases")
    box = region.bounding_box()
    verdicts = region.locator("tbody .verdict")
    assert verdicts.all_text_contents() == ["failed", "ok"]  # what failed stands first
    for k in range(2):
        cell = verdicts.nth(k).bounding_box()
        assert box["x"] <= cell["x"] and cell["x"] + cell["width"] <= box["x"] + box["width"]
    assert "2 cases, 1 failed" in page.locator("#stability").text_content()
    assert "2 stiff and extreme cases, 1 failed" in page.locator(".summary").text_content()


@browser
def test_a_drag_zooms_and_a_double_click_goes_back(visit, html):
    page = visit(html)
    plot = page.locator("#plot-precision")
    plot.scroll_into_view_if_needed()
    whole = "document.getElementById('plot-precision')._fullLayout.yaxis.range"
    before = page.evaluate(whole)
    box = plot.bounding_box()
    page.mouse.move(box["x"] + 200, box["y"] + 150)
    page.mouse.down()
    page.mouse.move(box["x"] + 400, box["y"] + 300, steps=4)
    page.mouse.up()
    page.wait_for_timeout(300)
    near_to = page.evaluate(whole)
    assert before[0] < near_to[0] < near_to[1] < before[1]
    page.mouse.dblclick(box["x"] + 300, box["y"] + 200)
    page.wait_for_timeout(500)
    assert page.evaluate(whole) == pytest.approx(before)


@browser
def test_a_browser_that_cannot_unpack_says_so(visit, html):
    page = visit(html.replace("new DecompressionStream", "new Missing"))
    for plot in page.locator(".plot").all():
        assert "cannot unpack the plots" in plot.text_content()


@browser
def test_nothing_is_without_a_name(visit, html):
    """For those who do not see the page: pictures, controls and plots say what they are."""
    page = visit(html)
    nameless = page.evaluate("""() => [...document.querySelectorAll("img, input, select, .plot")]
      .filter((e) => !(e.alt || e.ariaLabel || (e.labels && e.labels.length)))
      .map((e) => e.outerHTML)""")
    assert not nameless
    assert page.locator("h1").count() == 1 and page.locator("html[lang=en]").count() == 1


@browser
def test_a_page_without_any_result(visit, tmp_path, monkeypatch):
    monkeypatch.setattr(recorded, "FOLDER", tmp_path)
    page = visit(report.page(tmp_path))
    assert page.locator(".missing:visible").count() == 11


def test_every_bundled_scene_has_a_place(monkeypatch, tmp_path):
    asked = []
    monkeypatch.setattr(report, "scene_result", lambda name, build: asked.append(name))
    report.page(tmp_path)
    assert asked == bundled_scenes()
