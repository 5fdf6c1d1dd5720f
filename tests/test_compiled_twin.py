# SPDX-License-Identifier: MIT
"""The compiled twin gives the pixels of the twin in numpy, to the bit; and what its graph says."""

import numpy as np
import pytest

from phong75.model import twin
from phong75.model.analysis import metrics
from phong75.model.config import DEFAULT as C
from phong75.model.config import TECHNIQUES, Config
from phong75.model.dataflow import cpp
from phong75.model.dataflow.graph import OPERATIONS, Graph, live
from phong75.model.dataflow.trace import trace
from phong75.model.dataflow.words import words
from phong75.model.frame import InputError, fitted
from phong75.model.front.scene import load_scene, technique_scenes
from phong75.model.scene_to_frame import front_end
from phong75.model.studies import corner_cases
from phong75.model.studies.methods import CONFIGS
from phong75.model.studies.random_frames import random_frame
from phong75.sim import build, compiled_twin
from phong75.sim.compiled_twin import CompiledTwin

#: Configurations with another method in each module that has methods.
METHODS = ("dot_first_18", "parabolas_8", "fast_inverse_2", "squaring_14", "schlick_16", "width_12")


def same(frame, config) -> None:
    compared = metrics.compare(twin.render(frame, config), compiled_twin.render(frame, config))
    assert compared.mismatches == 0, compared.first


@pytest.mark.parametrize("scene", technique_scenes())
def test_technique_scenes(scene):
    same(front_end(load_scene(scene, (80, 60))).frame, C)


def test_corner_cases_and_random_frames():
    """Extremes of every word, illegal spans, which wrap, and frames without a span."""
    for frame in corner_cases.frames():
        same(frame, C)
    frame = random_frame(75, 300, 40)
    frame.spans["step"][::5, 1] = C.normal.max
    frame.spans["x"][::7] = C.max_size - 2
    frame.spans["length"][::11] = 0
    same(frame, C)
    frame.spans = frame.spans[:0]
    same(frame, C)


@pytest.mark.parametrize("name", [*METHODS, *list(TECHNIQUES)[1:]])
def test_methods_and_techniques(name):
    config = CONFIGS.get(name) or TECHNIQUES[name]
    same(random_frame(75, 400, 40, config=config), config)


def test_a_pruned_build():
    """Constants of the build in place of words of the frame, and a held normal."""
    frame = random_frame(75, 100, 30)
    frame.materials.weight[:] = frame.materials.weight[0, 0]
    constant = (int(frame.materials.weight[0, 0]),)
    config = Config(
        name="pruned", hold_unlit=True, weight_function=False, constant_weight=constant,
        constant_half_vector=frame.half_vector,
    )  # fmt: skip
    same(frame, config)


def test_an_error_in_the_generated_text_is_seen(tmp_path, monkeypatch):
    """The comparison can fail: white is one code darker."""
    right = cpp.source
    frame = random_frame(75, 300, 40)

    def wrong(*arguments):
        text = right(*arguments)
        assert "* word(255)" in text
        return text.replace("* word(255)", "* word(254)")

    monkeypatch.setattr(build, "BUILD", tmp_path)
    monkeypatch.setattr(cpp, "source", wrong)
    got = CompiledTwin(C).render(frame)
    assert metrics.compare(twin.render(frame), got).mismatches > 100


def test_every_operation_is_compared():
    configs = [C, *(CONFIGS[name] for name in METHODS), *list(TECHNIQUES.values())[1:]]
    configs += [fitted(C, front_end(load_scene(name, (8, 6))).frame) for name in technique_scenes()]
    programs = [trace(config, config.lights) for config in configs]
    used = {node.operation for p in programs for node in live([*p.walked, *p.colours])}
    # No colour depends on whether a value left its word.
    assert set(OPERATIONS) - used == {"not_equal"}


def test_equal_operations_are_one():
    graph = Graph()
    a, b = graph.input("a"), graph.input("b")
    assert graph.apply("add", a, b) is graph.apply("add", a, b)
    assert graph.apply("add", a, b) is not graph.apply("subtract", a, b)
    assert graph.apply("left_shift", 3, 4) is graph.constant(48)
    flag = graph.apply("less", a, b)
    assert flag.truth and graph.apply("bitwise_and", flag, True).truth
    assert not graph.whole(flag).truth and graph.whole(a) is a


def test_what_the_twin_does_not_use_is_refused():
    graph = Graph()
    word = words([graph.input("a")])
    for call in (lambda: np.sort(word), lambda: word / 2, lambda: np.add.accumulate(word)):
        with pytest.raises(TypeError):
            call()
    with pytest.raises(InputError, match="quadratic_spans_16: spans that carry squares"):
        trace(CONFIGS["quadratic_spans_16"])
