# SPDX-License-Identifier: MIT
"""The twin against float64 and mpmath, by stage and as a whole, held to the derived bounds."""

import mpmath
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from phong75.model.analysis import error_budget as budget
from phong75.model.analysis import reference
from phong75.model.analysis.metrics import error_metrics
from phong75.model.config import DEFAULT as C
from phong75.model.frame import SPAN_DTYPE, Frame, InputError, MaterialTable, half_vector_codes
from phong75.model.front.scene import load_scene
from phong75.model.scene_to_frame import front_end
from phong75.model.studies.methods import CONFIGS
from phong75.model.twin import render
from phong75.model.twin.core.inverse_sqrt import inverse_sqrt
from phong75.model.twin.core.inverse_sqrt_linear import inverse_sqrt_linear
from phong75.model.twin.core.normalizer import normalizer
from phong75.model.twin.core.phong_unit import shade
from phong75.model.twin.core.reflection import reflection
from phong75.model.twin.core.specular_power_tables import specular_power_tables
from phong75.model.twin.core.specular_weight import specular_weight
from phong75.model.twin.core.versine_of_cross import versine_of_cross
from phong75.model.twin.methods.quadratic_normalizer import quadratic_normalizer
from phong75.model.twin.methods.quadratic_unit import interpolate
from phong75.model.twin.methods.specular_power_schlick import specular_power_schlick
from phong75.model.twin.methods.specular_power_squaring import specular_power_squaring
from phong75.scripts.configurations import CONFIGURATIONS
from phong75.sim.design import PACKAGE

RNG = np.random.default_rng(75)
ANGLES = (0.0, 0.3, 1.0, np.pi / 2, 2.5, 3.1, np.pi)


def frame_of(angle, n=10.0, cp=(1.0, 1.0, 1.0), d=0.0, weight=1.0, two_sided=False):
    """A frame with one material and the eye at `angle` (radians) from the light; no spans."""
    table = MaterialTable.empty(C)
    table.set(0, cp, d, np.broadcast_to(weight, C.weight_points), n, C)
    eye = np.array([np.sin(angle), 0, np.cos(angle)])
    spans = np.zeros(1, SPAN_DTYPE)
    return Frame(1, 1, half_vector_codes(eye, C), two_sided, (0, 0, 0), table, spans)


def normals_near(half_vector, n, count):
    """Normal codes int64[3, count], half of them where a highlight of exponent n lies."""
    h = np.array([half_vector[0], 0, half_vector[1]]) / np.hypot(*half_vector)
    spread = np.where(RNG.random(count) < 0.5, 1 / np.sqrt(n + 1), 1.0)
    direction = h[:, None] + RNG.normal(size=(3, count)) * spread * 0.7
    direction /= np.linalg.norm(direction, axis=0)
    return C.normal.quantize(direction * 2.0 ** -RNG.integers(0, 12, count))


def exact(normal, frame):
    """255 S of normal codes, by the float64 reference, float64[n, 3]."""
    count = normal.shape[1]
    table, real = frame.materials, C.coefficient.real
    return reference.shade(
        normal.T.astype(float), real(table.ambient)[[0] * count], real(table.diffuse)[[0] * count],
        real(table.weight)[[0] * count], np.full(count, C.exponent.real(table.exponent[0])),
        reference.eye_of(frame.half_vector), frame.two_sided,
    )  # fmt: skip


# -- stages ----------------------------------------------------------------------------------------


def test_inverse_sqrt_every_operand_within_its_bound():
    operand = np.arange(C.root_operand.one, 4 * C.root_operand.one)
    error = C.root.real(inverse_sqrt_linear(operand, C)) * np.sqrt(C.root_operand.real(operand)) - 1
    assert np.abs(error).max() <= budget.inverse_sqrt(C)
    assert -np.log2(np.abs(error).max()) > 17.4  # good bits


@pytest.mark.parametrize(
    "config", [c for c in CONFIGS.values() if c.root_method != "lines"], ids=lambda c: c.name
)
def test_other_methods_for_inverse_sqrt_within_their_bounds(config):
    operand = np.arange(config.root_operand.one, 4 * config.root_operand.one)
    root = config.root.real(inverse_sqrt(operand, config))
    error = np.abs(root * np.sqrt(config.root_operand.real(operand)) - 1).max()
    assert error <= budget.inverse_sqrt(config) <= 2.2 * error


def test_the_fast_inverse_start_is_what_float32_gives():
    config = CONFIGS["fast_inverse_0"]
    operand = np.arange(config.root_operand.one, 4 * config.root_operand.one)
    x = config.root_operand.real(operand).astype(np.float32)
    y = (0x5F3759DF - (x.view(np.int32) >> 1)).view(np.float32)
    codes = np.floor(np.ldexp(y.astype(float), config.root.fraction))
    assert np.array_equal(inverse_sqrt(operand, config), codes)


@pytest.mark.parametrize("bits", [12, 18])
@pytest.mark.parametrize("n", [1, 2, 10, 32, 77, 127, 128])
def test_squaring_within_its_bound(bits, n):
    config = CONFIGS[f"squaring_{bits}"]
    v = np.arange(0, config.versine.one, 7)
    power = specular_power_squaring(v, np.full(len(v), n * config.exponent.one), config)
    error = np.abs(config.power.real(power) - (1 - config.versine.real(v)) ** n).max()
    assert error <= budget.specular_power(n, config) <= 4 * error


def test_squaring_rounds_n():
    config = CONFIGS["squaring_18"]
    v = np.arange(0, config.versine.one, 101)
    for n, whole in ((1.5, 2), (2.25, 2), (127.5, 128)):
        codes = [specular_power_squaring(v, np.full(len(v), config.exponent.quantize(k)), config)
                 for k in (n, whole)]  # fmt: skip
        assert np.array_equal(*codes)
    assert not budget.derived(config, 1.5) and budget.derived(config, 2.0)


@pytest.mark.parametrize("n", [1, 1.5, 10, 128])
def test_schlick_is_schlicks_formula(n):
    config = CONFIGS["schlick_18"]
    v = np.arange(0, config.versine.one, 7)
    power = specular_power_schlick(v, np.full(len(v), config.exponent.quantize(n)), config)
    x = 1 - config.versine.real(v)
    # v rounded, times n - 1, against a denominator of 1 or more; five roundings and cuts.
    bound = (n - 1) * config.power.lsb / 2 + 5 * config.power.lsb
    assert np.abs(config.power.real(power) - x / (n - n * x + x)).max() <= bound


def test_inverse_sqrt_of_zero_is_the_largest_code():
    assert inverse_sqrt_linear(np.array([0]), C) == C.root.max


@pytest.mark.parametrize("shrink", [0, 10, 20, 28])
def test_normalizer_within_its_bounds_at_any_length(shrink):
    direction = RNG.normal(size=(3, 200_000))
    direction /= np.linalg.norm(direction, axis=0)
    normal = C.normal.quantize(direction * 2.0**-shrink)
    normal = normal[:, np.abs(normal).max(axis=0) > 0]
    unit, cosine, _ = normalizer(normal, True, C)
    true = normal / np.linalg.norm(normal.astype(float), axis=0)
    assert np.abs(C.cosine.real(cosine) - np.abs(true[2])).max() <= budget.cosine(C)
    slack = budget.direction(C) + budget.length(C) + C.unit.lsb
    assert np.abs(C.unit.real(unit) - true).max() <= slack


@pytest.mark.parametrize("angle", ANGLES)
def test_versine_within_its_bound(angle):
    frame = frame_of(angle)
    normal = normals_near(frame.half_vector, 100, 200_000)
    unit, _, _ = normalizer(normal, False, C)
    v = C.versine.real(reflection(unit, frame.half_vector, C))
    true = normal / np.linalg.norm(normal.astype(float), axis=0)
    eye = reference.eye_of(frame.half_vector)
    v_true = 1 - (2 * true[2] * (eye @ true) - eye[2])
    inside = v_true < 1 - 1e-4
    error = np.abs(v - v_true)[inside]
    assert (error <= budget.versine(v_true[inside], frame.half_vector, C)).all()


@pytest.mark.parametrize("bits", [12, 18])
@pytest.mark.parametrize("angle", ANGLES)
def test_versine_of_dot_products_within_its_bound(angle, bits):
    config = CONFIGS[f"dot_first_{bits}"]
    eye = np.array([np.sin(angle), 0, np.cos(angle)])
    half = half_vector_codes(eye, config)
    normal = normals_near(half, 100, 200_000) >> (C.normal.bits - config.normal.bits)
    normal = normal[:, np.abs(normal).max(axis=0) > 0]
    unit, cosine, _ = normalizer(normal, False, config, half_vector=half)
    v = config.versine.real(versine_of_cross(unit[1], unit[0], config))
    true = normal / np.linalg.norm(normal.astype(float), axis=0)
    eye = reference.eye_of(half)
    v_true = 1 - (2 * true[2] * (eye @ true) - eye[2])
    inside = v_true < 1 - 2.0 ** (2 - bits)
    error = np.abs(v - v_true)[inside]
    assert (error <= budget.versine(v_true[inside], half, config)).all()
    assert np.abs(config.cosine.real(cosine) - np.abs(true[2])).max() <= budget.cosine(config)


def _spans(length, config, near=0.5, far=1.5):
    """Random spans of `length` pixels, with |N| between `near` and `far` at both ends."""
    ends = RNG.normal(size=(2, 3, 1000))
    ends *= RNG.uniform(near, far, (2, 1, 1000)) / np.linalg.norm(ends, axis=1)[:, None]
    spans = np.zeros(1000, SPAN_DTYPE)
    spans["length"] = length
    spans["start"] = config.normal.quantize(ends[0].T)
    spans["step"] = config.normal.quantize((ends[1] - ends[0]).T / max(length - 1, 1))
    return spans


def _frame(spans, half_vector, config, n=10.0):
    table = MaterialTable.empty(config)
    table.set(0, (0.0, 0.0, 0.0), 0.0, np.ones(config.weight_points), n, config)
    return Frame(1, 1, half_vector, False, (0, 0, 0), table, spans)


@pytest.mark.parametrize("bits", [12, 18])
@pytest.mark.parametrize("angle", ANGLES)
@pytest.mark.parametrize("length", [1, 14, 425])
def test_differences_within_their_bounds(length, angle, bits):
    config = CONFIGS[f"quadratic_spans_{bits}"]
    eye = np.array([np.sin(angle), 0, np.cos(angle)])
    half = half_vector_codes(eye, config)
    eye = reference.eye_of(half)
    spans = _spans(length, config)
    bounded = [
        budget.squares(_frame(spans[k : k + 1], half, config), config) is not None
        for k in range(len(spans))
    ]
    spans = spans[bounded]
    assert len(spans) > (950 if length < 100 else 150)
    frame = _frame(spans, half, config)
    bound = budget.squares(frame, config)
    largest = np.zeros(2)
    for k in sorted({0, 1, length // 2, length - 1} & set(range(length))):
        place = np.full(len(spans), k)
        z, square, cross = interpolate(frame, np.arange(len(spans)), place, config)
        v, cosine, _ = quadratic_normalizer(z, square, cross, True, config)
        true = config.normal.real(spans["start"]) + k * config.normal.real(spans["step"])
        length_2 = (true**2).sum(axis=1)
        assert np.abs(config.squared.real(square) / length_2 - 1).max() <= bound * (1 + 1e-6)
        true /= np.sqrt(length_2)[:, None]
        v_true = 1 - (2 * true[:, 2] * (true @ eye) - eye[2])
        cosine_error = np.abs(config.cosine.real(cosine) - np.abs(true[:, 2]))
        # beyond 1 it must be as good as 1
        v_error = np.abs(config.versine.real(v) - np.minimum(v_true, 1))
        v_bound = budget.versine(np.minimum(v_true, 1), half, config, bound)
        part = [(cosine_error / budget.cosine(config, bound)).max(), (v_error / v_bound).max()]
        largest = np.maximum(largest, part)
    assert (largest <= 1).all() and (largest >= 1 / 4).all(), largest


@pytest.mark.parametrize("bits", [12, 14, 16, 18])
def test_quadratic_spans_at_right_angles_to_h(bits):
    """Normals at right angles to h, for which the square of N x h equals |N|**2, just below a power
    of 4, and codes of h that are longer than 1: the square must fit the word that |N|**2 is
    aligned to."""
    config, longer = CONFIGS[f"quadratic_spans_{bits}"], 0
    for angle in np.linspace(1.7, 3.1, 60):
        half = half_vector_codes(np.array([np.sin(angle), 0, np.cos(angle)]), config)
        longer += np.hypot(*half) > config.half_vector.one
        cross = np.array([-half[1], 0, half[0]]) / np.hypot(*half) * (1 - config.normal.lsb)
        spans = np.zeros(3, SPAN_DTYPE)
        spans["length"] = 1
        spans["start"] = config.normal.quantize(cross / np.array([[1], [2], [4]]))
        frame = _frame(spans, half, config)
        assert np.abs(reference.render(frame, config)).max() < 1e-6
        assert (render(frame, config).rgb == 0).all(), angle
    assert longer > 10


def test_differences_have_no_bound_where_they_may_fail():
    config = CONFIGS["quadratic_spans_18"]
    half = half_vector_codes(np.array([0.6, 0, 0.8]), config)

    def bound(start, end, length):
        spans = np.zeros(1, SPAN_DTYPE)
        spans["length"], spans["start"] = length, config.normal.quantize(start)
        spans["step"] = config.normal.quantize((np.array(end) - start) / (length - 1))
        return budget.squares(_frame(spans, half, config), config)

    assert bound([0.6, 0, 0.8], [-0.6, 0, 0.8], 425) == pytest.approx(
        (1 + 424 + 424 * 423 / 2) * 2.0**-43 / 0.64, rel=1e-3
    )
    assert bound([1.9, 0.5, 0], [1.9, 0, 0.5], 10) is not None
    assert bound([1.9, 0.7, 0], [1.9, 0, 0.5], 10) is None  # |N|**2 of 4 and more
    assert bound([0.7, 0, 0.01], [-0.7, 0, 0.01], 5) is not None
    assert bound([0.7, 0, 0.01], [-0.7, 0, 0.01], 425) is None  # 1e-8 against 1e-4
    assert bound([0.7, 0, 0], [-0.7, 0, 0], 3) is None  # through 0


@pytest.mark.parametrize("n", [1, 1.5, 2, 10, 20, 32, 64, 127.5, 128])
def test_power_within_its_bound_and_the_specified_one(n):
    v = np.arange(0, C.versine.one, 3)
    power = C.power.real(specular_power_tables(v, np.full(len(v), C.exponent.quantize(n)), C))
    error = np.abs(power - (1 - C.versine.real(v)) ** n).max()
    assert error <= budget.specular_power(n, C)
    assert budget.specular_power(n, C) <= (2**-14 if n <= 32 else 2**-12)
    if n == 20:  # 50 M powers/s, 12.3 k gates, max error 0.00141 (AMM 229-231.1146, 2012)
        assert error <= 0.00141 / 10


def test_power_against_mpmath():
    v = RNG.integers(0, C.versine.one, 300)
    n = RNG.integers(C.exponent.one, 128 * C.exponent.one, 300)
    power = specular_power_tables(v, n, C)
    for vk, nk, pk in zip(v.tolist(), n.tolist(), power.tolist(), strict=True):
        true = (1 - mpmath.mpf(vk) / C.versine.one) ** (mpmath.mpf(nk) / C.exponent.one)
        assert abs(pk / mpmath.mpf(C.power.one) - true) <= budget.specular_power(
            nk / C.exponent.one, C
        )


def test_weight_within_its_bound():
    points = C.coefficient.quantize(RNG.random((C.materials, C.weight_points)))
    cosine = RNG.integers(0, C.cosine.one, 100_000)
    w = C.weight.real(specular_weight(cosine, np.full(len(cosine), 3), points, C))
    zn = np.linspace(0, 1, C.weight_points)
    true = np.interp(C.cosine.real(cosine), zn, C.coefficient.real(points[3]))
    assert np.abs(w - true).max() <= C.weight.lsb / 2


# -- the whole -------------------------------------------------------------------------------------


@pytest.mark.parametrize("angle", ANGLES)
@pytest.mark.parametrize("n", [1, 1.5, 10, 32, 128])
def test_colour_within_the_derived_bound(angle, n):
    frame = frame_of(angle, n)
    normal = normals_near(frame.half_vector, n, 100_000)
    codes = shade(normal, np.zeros(normal.shape[1], np.int64), frame).T
    bound = budget.bound_lsb(frame)
    assert np.abs(codes - exact(normal, frame)).max() <= bound
    assert bound <= 1  # for n <= 32 as specified; n = 128 keeps it too


def test_a_steep_w_costs_what_the_budget_says():
    weight = np.zeros(C.weight_points)
    weight[C.weight_points // 2 :] = 1
    frame = frame_of(0.5, 1.0, (0, 0, 0), 0.0, weight)
    normal = normals_near(frame.half_vector, 1, 200_000)
    codes = shade(normal, np.zeros(normal.shape[1], np.int64), frame).T
    bound = budget.bound_lsb(frame)
    assert np.abs(codes - exact(normal, frame)).max() <= bound
    assert bound > budget.bound_lsb(frame_of(0.5, 1.0, (0, 0, 0), 0.0, 1.0)) + 0.1


@pytest.mark.parametrize("name", ["colour_10", "colour_10_wide", "colour_12"])
def test_colours_of_more_bits_within_the_derived_bound(name):
    config = CONFIGURATIONS[name]
    front = front_end(load_scene(PACKAGE / "model/data/highlights.toml", (72, 24)), config)
    codes = render(front.frame, config).rgb
    ports = reference.render(front.frame, config)
    assert ports.max() > 0.9 * config.white > 255
    assert np.abs(codes - ports).max() <= budget.bound_lsb(front.frame, config) < 1.1


def test_nearly_all_colours_are_correctly_rounded():
    frame = frame_of(0.7, 10, (0.7, 0.5, 0.2), 0.2, 0.5)
    direction = RNG.normal(size=(3, 400_000))
    direction[2] = np.abs(direction[2])
    normal = C.normal.quantize(direction / np.linalg.norm(direction, axis=0))
    codes = shade(normal, np.zeros(normal.shape[1], np.int64), frame).T
    assert error_metrics(codes, exact(normal, frame))["correctly_rounded"] >= 0.999


component = st.integers(C.normal.min, C.normal.max) | st.integers(-40, 40)


@settings(max_examples=300, deadline=None, derandomize=True)
@given(
    normal=st.tuples(component, component, component),
    angle=st.floats(0, np.pi), n=st.floats(1, 128), two_sided=st.booleans(),
)  # fmt: skip
def test_any_normal_stays_within_the_bound(normal, angle, n, two_sided):
    frame = frame_of(angle, n, (1, 0.5, 0), 0.25, two_sided=two_sided)
    column = np.array(normal, np.int64)[:, None]
    codes = shade(column, np.zeros(1, np.int64), frame).T
    assert np.abs(codes - exact(column, frame)).max() <= budget.bound_lsb(frame)


def test_the_terminator_is_exact():
    """One unit of Zn decides, whatever the other components; zero and the zero vector are dark."""
    frame = frame_of(3.0, 1, (0.2, 0.4, 0.8), 0.5)
    one = C.normal.one
    normal = np.array([[one, 0, 1], [one, 0, 0], [one, 0, -1], [0, 0, 0], [0, 0, 1], [0, 0, -1]]).T
    ambient = C.coefficient.quantize(np.array([0.1, 0.2, 0.4]))
    dark = np.floor(255 * C.coefficient.real(ambient) + 0.5)
    codes = shade(normal, np.zeros(6, np.int64), frame).T
    assert (codes == dark).all(axis=1).tolist() == [False, True, True, True, False, True]
    frame.two_sided = True
    codes = shade(normal, np.zeros(6, np.int64), frame).T
    assert (codes == dark).all(axis=1).tolist() == [False, True, False, True, False, False]
    assert (codes[0] == codes[2]).all() and (codes[4] == codes[5]).all()


def test_colours_saturate():
    frame = frame_of(0.0, 1, (1, 1, 1), 1.0, 1.0)
    codes = shade(np.array([[0], [0], [C.normal.one]]), np.zeros(1, np.int64), frame)
    assert (codes == 255).all()


# -- what the reference itself says ----------------------------------------------------------------


def test_reference_by_hand():
    """Light and eye 60 degrees apart, the normal halfway: cos(s) = 1, cos(i) = cos(30)."""
    eye = np.array([np.sin(np.pi / 3), 0, np.cos(np.pi / 3)])
    half = np.array([[0.5, 0, np.sqrt(3) / 2]])
    weight = np.full((1, 3), 0.25)
    cp = np.array([[0.5, 0.2, 0.0]])
    got = reference.shade(half * 7, cp * 0.4, cp * 0.6, weight, np.array([9.0]), eye, False)
    want = 255 * (cp * (0.4 + 0.6 * np.sqrt(3) / 2) + 0.25)
    assert np.abs(got - want).max() < 1e-10


def test_eye_of_half_vector():
    for angle in ANGLES:
        eye = reference.eye_of(half_vector_codes([np.sin(angle), 0, np.cos(angle)], C))
        assert np.abs(eye - [np.sin(angle), 0, np.cos(angle)]).max() < 2**-16
        assert abs(np.linalg.norm(eye) - 1) < 1e-15


@pytest.mark.parametrize(
    "change", [{"cp": (1.5, 0, 0)}, {"d": -0.1}, {"weight": 2.0}, {"n": 0.5}, {"n": 129.0}]
)
def test_materials_out_of_range_are_refused(change):
    with pytest.raises(InputError, match="material 0: .* is outside"):
        frame_of(0.0, **change)
