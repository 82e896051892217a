"""What only compiled lanes have (`compiled_fused`)."""

from __future__ import annotations

from typing import Any

from rockcli.kernels import jit as door


def _absent(*_: Any) -> Any:
    raise RuntimeError("lanes under records run compiled only")


gather = scatter = bits = lowest_bit = page_the_stack = _absent

if door.compiling():
    from rockcli.kernels.lanes.vector import compiled_fused

    for _name in ("gather", "scatter", "bits", "lowest_bit", "page_the_stack"):
        globals()[_name] = getattr(compiled_fused, _name)
