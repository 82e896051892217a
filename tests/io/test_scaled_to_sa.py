"""The recipe of docs/suites.md that scales records to one Sa(T): its Python and its study, over the records shipped."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import yaml

from rockcli.engine.run import solve
from rockcli.study.open import open_study

ROOT = Path(__file__).resolve().parents[2]
SECTION = (ROOT / "docs" / "suites.md").read_text(encoding="utf-8").split("## Records scaled to one Sa(T)")[1]


def test_records_have_the_sa_that_is_asked_for(rock, tmp_path, capsys):
    assert rock("records", "info", ROOT / "records", "--sa", 0.5, "--json") == 0
    (tmp_path / "info.json").write_text(capsys.readouterr().out, encoding="utf-8")
    (script,) = re.findall(r"^```python\n(.*?)^```", SECTION, re.DOTALL | re.M)
    (part,) = re.findall(r"^```yaml\n(.*?)^```", SECTION, re.DOTALL | re.M)[:1]
    exec(compile(script, "docs/suites.md", "exec"), {})
    (tmp_path / "sa.csv").write_text("sa(0.5) [g],rate\n0.1,1e-2\n1,1e-4\n5,1e-6\n", encoding="utf-8")
    case = {"block": {"height": 2.2, "width": 0.6}, "motion": {"record": {"file": "any.AT2", "scale": 1}}}
    text = yaml.safe_dump({"name": "scaled", "case": case} | yaml.safe_load(part), sort_keys=False)
    (tmp_path / "scaled.yaml").write_text(text, encoding="utf-8")
    contents = solve(open_study(tmp_path / "scaled.yaml"))
    axes = contents.fields["fragility_intensity"].dims
    found = contents.values("fragility_intensity")
    target = contents.values("target") * 9.81
    wanted = target if axes[-1] == "target" else target[:, None]
    np.testing.assert_allclose(found, np.broadcast_to(wanted, found.shape), rtol=1e-6)
    assert contents.values("annual_rate").shape == (2, 1)
