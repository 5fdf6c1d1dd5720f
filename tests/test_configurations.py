"""Whole frames, and what does not fit, on the builds of features, techniques and methods."""

import pytest

from tests.configuration_tests import TRIALS, trial


@pytest.mark.parametrize("name", TRIALS)
def test_trial(name):
    assert trial(name).model_complaint() == ""
    assert trial(name).complaint() == ""
