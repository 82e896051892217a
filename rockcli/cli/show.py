"""`rock show`: what there is to choose from."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated

import typer

from rockcli.cli.say import say
from rockcli.cli.tables import table


def _topics(incomplete: str) -> list[str]:
    return [topic for topic in _TOPICS if topic.startswith(incomplete)]


def show(
    topic: Annotated[
        str,
        typer.Argument(
            metavar="models|backends|variables|symbols|pulses|plots|environment|schema",
            help="What to list.",
            autocompletion=_topics,
        ),
    ],
) -> None:
    """List what there is to choose from.

    Models, backends, variables of the dataset, symbols of expressions, pulses, plots, environment variables; or the
    schema of a study as JSON.
    """
    from rockcli.errors import StudyError
    from rockcli.study.document.tree import meant

    if topic not in _TOPICS:
        close = meant(topic, _TOPICS)
        hint = "" if close is None else f"; did you mean {close!r}?"
        raise StudyError(f"show {topic}: expected one of {', '.join(_TOPICS)}{hint}")
    say(_TOPICS[topic]())


def _models() -> str:
    from rockcli.scene.auto import AUTO
    from rockcli.scene.laws.models import CONTINUUM, FLEXIBLE, MODELS

    rows = [(m.name, m.geometry or "-", m.reference, m.sentence) for m in MODELS.values()]
    rows.append((FLEXIBLE, "corotational", "-", "the deformable column on a rigid or Winkler base (docs/flexible.md)"))
    rows.append((CONTINUUM, "-", "-", "the same body as a full mesh, solved by CalculiX (docs/calculix.md)"))
    rows.append((AUTO, "-", "-", "the cheapest of these that keeps a tolerance, case by case (docs/auto.md)"))
    return table(("model", "geometry", "equation", "good for"), rows)


def _backends() -> str:
    from rockcli.scene.backends import BACKENDS

    rows = []
    for backend in BACKENDS.values():
        models = ", ".join(sorted({name for name, _ in backend.models}))
        rows.append((backend.name, models, ", ".join(sorted(backend.damping)), backend.sentence))
    return table(("backend", "models", "damping", "method"), rows)


def _variables() -> str:
    from rockcli.scene.response import OUTCOMES
    from rockcli.scene.variables import DIMENSIONS, VARIABLES

    rows = [(v.name, DIMENSIONS[v.over], v.unit, v.sentence) for v in VARIABLES.values()]
    outcomes = ", ".join(f"{flag} {name}" for flag, name in sorted(OUTCOMES.items()))
    return f"{table(('variable', 'over', 'unit', 'meaning'), rows)}\n\noutcome: {outcomes}"


def _symbols() -> str:
    from rockcli.study.document.expressions import FUNCTIONS, MEANINGS, UNITS

    rows = [*MEANINGS.items(), ("pi", "3.14159...")]
    rows += [(name, f"unit, {size:.10g} in SI") for name, size in UNITS.items()]
    rows += [(f"{name}(x)", "function") for name in FUNCTIONS]
    return table(("symbol", "meaning"), rows) + "\n\noperators: + - * / ** ( ); own symbols: `let` of the study"


def _pulses() -> str:
    from rockcli.scene.ground.pulses import SHAPES

    rows = [(s.name, ", ".join(s.options) or "-", s.sentence) for s in SHAPES.values()]
    return table(("shape", "options", "a_g, tau = t - t0"), rows)


def _plots() -> str:
    from rockcli.plotting.figures import KINDS

    return table(("plot", "shows"), [(kind.name, kind.sentence) for kind in KINDS.values()])


def _environment() -> str:
    from rockcli.cli.environment import ENVIRONMENT

    return table(("variable", "meaning"), list(ENVIRONMENT.items()))


def _schema() -> str:
    import json

    from rockcli.study.editor_schema import editor_schema

    return json.dumps(editor_schema(), indent=2)


_TOPICS: dict[str, Callable[[], str]] = {
    "models": _models,
    "backends": _backends,
    "variables": _variables,
    "symbols": _symbols,
    "pulses": _pulses,
    "plots": _plots,
    "environment": _environment,
    "schema": _schema,
}
