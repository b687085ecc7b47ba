"""The same macro, typed in the app."""

import pytest


def test_a_macro_is_typed_in_the_app(app):
    app.press("r", "enter")
    assert "Referenced" in app.text
    app.press("m")
    app.type("o<drill_row> call [20] [15] [2] [-10]")
    app.press("enter")
    assert app.mill.carriages_mm["x"] == pytest.approx(35, abs=0.01)
    assert not any(app.mill.lost_steps.values())
