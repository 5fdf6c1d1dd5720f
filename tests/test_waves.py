import re

from phong75.scripts import main, waves
from phong75.sim.design import BUILD


def test_every_signal_of_the_save_file_is_in_the_waveform(capsys):
    assert main.main(["waves", "normalizer"]) == 0
    vcd = BUILD / "waves" / "normalizer.vcd"
    has = {f"{scope.path}.{signal}" for scope in waves.scopes(vcd) for signal in scope.signals}
    save = vcd.with_suffix(".gtkw").read_text()
    shown = re.findall(r"^(frame_bench\..*)$", save, re.MULTILINE)
    assert set(shown) <= has
    for signal in ("clk", "s_ready", "u_normalizer.unit_x[17:0]", "u_normalizer.sum_p11[35:0]"):
        assert any(name.endswith(f".{signal}") for name in shown), signal
    assert any("gen_component[2].mantissa_p7" in name for name in shown)


def test_an_unknown_module_is_named_with_the_known_ones(capsys):
    assert main.main(["waves", "walker"]) == 2
    said = capsys.readouterr().err
    assert said == "Error: MODULE: there is no `walker`; did you mean span_walker?\n"
