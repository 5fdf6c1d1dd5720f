# SPDX-License-Identifier: MIT
"""Whole frames on the builds of every feature, technique and method (configuration tests)."""

import pytest

from tests.configuration_tests import CONFIGURATION_TESTS, configuration_test


@pytest.mark.parametrize("name", CONFIGURATION_TESTS)
def test_configuration(name):
    assert configuration_test(name).model_failure() == ""
    assert configuration_test(name).failure() == ""
