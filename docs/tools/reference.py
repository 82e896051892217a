#!/usr/bin/env python3
"""Writes docs/reference from the program itself: commands, keys of a study, variables, choices, environment, Python.

    python docs/tools/reference.py

A test holds the pages to the program, so that this is run after whatever changes them.
"""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable, Iterator
from pathlib import Path
from types import UnionType
from typing import Any, Literal, Union, get_args, get_origin

FOLDER = Path(__file__).resolve().parents[1] / "reference"
MADE = "\n<!-- made by docs/tools/reference.py -->\n"


def table(head: tuple[str, ...], rows: list[tuple[str, ...]]) -> str:
    """A table of Markdown; bars inside cells are escaped."""
    lines = [
        head,
        tuple("---" for _ in head),
        *[tuple(_shown(cell.replace("|", "\\|")) for cell in row) for row in rows],
    ]
    return "\n".join(f"| {' | '.join(' '.join(cell.split()) for cell in line)} |" for line in lines) + "\n"


def _shown(text: str) -> str:
    """Words in which `<name>` outside code is a placeholder, no tag of HTML, which a page leaves out."""
    return re.sub(r"(`[^`]*`)|<(?=\w)", lambda found: found[1] or "&lt;", text)


def commands() -> str:
    """Every command with its arguments and options."""
    import typer.main

    from rockcli.cli.main import app
    from rockcli.cli.records import app as records

    parts = ["# Commands\n\n`rock --help` and `rock COMMAND --help` say the same.\n"]
    every = [
        *_commands(typer.main.get_command(app), "rock"),
        *_commands(typer.main.get_command(records), "rock records"),
    ]
    for words, command in sorted((pair for pair in every if pair[0] != "rock records"), key=lambda pair: pair[0]):
        usage = " ".join([words, *(word for p in command.params if (word := _usage(p)))])
        parts.append(f"## {words}\n\n```text\n{usage}\n```\n\n{_prose(command.help or '')}\n")
        rows = [
            (_names(p), _plain(getattr(p, "help", "") or ""), _default(p)) for p in command.params if p.name != "help"
        ]
        if rows:
            parts.append(table(("argument or option", "meaning", "default"), rows))
    return "\n".join(parts)


def _commands(command: Any, words: str) -> Iterator[tuple[str, Any]]:
    nested = getattr(command, "commands", None)
    if nested is None:
        yield words, command
        return
    for name, one in sorted(nested.items()):
        yield from _commands(one, f"{words} {name}")


def _usage(parameter: Any) -> str:
    word = parameter.metavar or parameter.name.upper()
    if parameter.param_type_name != "argument":
        return ""
    return word if parameter.required or word.startswith("[") else f"[{word}]"


def _names(parameter: Any) -> str:
    if parameter.param_type_name == "argument":
        word = _usage(parameter)
        return f"`{word if word.count('[') > 1 else word.strip('[]')}`"
    value = "" if parameter.is_flag else f" {parameter.metavar or parameter.name.upper()}"
    return ", ".join(f"`{name}{value}`" for name in [*parameter.opts, *parameter.secondary_opts])


def _default(parameter: Any) -> str:
    default = parameter.default
    if parameter.required:
        return "required"
    return f"`{default}`" if isinstance(default, (int, float, str)) and default not in (False, "") else ""


def _plain(text: str) -> str:
    return re.sub(r"\s+", " ", text).strip()


def _prose(text: str) -> str:
    return "\n\n".join(
        _shown(_plain(paragraph)) for paragraph in inspect.cleandoc(text).replace("\b", "").split("\n\n")
    )


def keys() -> str:
    """Every key of a study, part by part, as `rock run` reads them."""
    from rockcli.study.schema import StudyPart

    parts = [
        "# Keys of a study\n\nBy examples: [study.md](../study.md). For an editor: `rock show schema`. Numbers may be expressions, such as "
        "`0.3*g` or `2*pi/T`; what may be, beside: [choices.md](choices.md).\n"
    ]
    seen: list[type] = []
    waiting: list[tuple[str, type]] = [("", StudyPart)]
    while waiting:
        path, part = waiting.pop(0)
        if part in seen:
            continue
        seen.append(part)
        rows = []
        for name, field in part.model_fields.items():  # type: ignore[attr-defined]
            key = field.alias or name
            below = [inner for inner in _parts(field.annotation) if inner not in seen]
            waiting += [(f"{path}.{key}".lstrip("."), inner) for inner in below]
            rows.append((f"`{key}`", _meaning(field), _value(field)))
        said = _prose(part.__doc__ or "")
        parts.append(
            f"## {f'`{path}`' if path else 'The file'}\n\n{said}\n\n{table(('key', 'meaning', 'default'), rows)}"
        )
    return "\n".join(parts)


def _parts(annotation: Any) -> Iterator[type]:
    if isinstance(annotation, type) and hasattr(annotation, "model_fields"):
        yield annotation
    for inner in get_args(annotation):
        yield from _parts(inner)


def _meaning(field: Any) -> str:
    said = _plain(field.description or "")
    words = [str(word) for word in _words(field.annotation)]
    return said + (
        f" ({', '.join(f'`{word}`' for word in words)})" if words and not all(w in said for w in words) else ""
    )


def _words(annotation: Any) -> Iterator[Any]:
    if get_origin(annotation) is Literal:
        yield from get_args(annotation)
    elif get_origin(annotation) in (Union, UnionType):
        for inner in get_args(annotation):
            yield from _words(inner)


def _value(field: Any) -> str:
    if field.is_required():
        return "required"
    default = field.get_default(call_default_factory=True)
    if default is None or default in ({}, [], (), "") or hasattr(type(default), "model_fields"):
        return ""
    return f"`{str(default).lower() if isinstance(default, bool) else default}`"


def variables() -> str:
    """Every variable of a dataset."""
    from rockcli.scene.response import OUTCOMES
    from rockcli.scene.variables import DIMENSIONS, VARIABLES

    parts = [
        "# Variables of a dataset\n\n`rock show variables` lists the same. Suites, uncertain inputs and hazard add theirs: "
        "[suites.md](../suites.md), [uncertain.md](../uncertain.md), [hazard.md](../hazard.md).\n"
    ]
    for over in dict.fromkeys(v.over for v in VARIABLES.values()):
        rows = [(f"`{v.name}`", v.unit, v.sentence) for v in VARIABLES.values() if v.over == over]
        parts.append(f"## Over {DIMENSIONS[over]}\n\n{table(('variable', 'unit', 'meaning'), rows)}")
    rows = [(str(flag), name) for flag, name in sorted(OUTCOMES.items())]
    parts.append(f"## Outcomes\n\n{table(('`outcome`', 'name'), rows)}")
    return "\n".join(parts)


def choices() -> str:
    """Models, backends, pulses, symbols, plots."""
    from rockcli.plotting.figures import KINDS
    from rockcli.scene.backends import BACKENDS
    from rockcli.scene.ground.pulses import SHAPES
    from rockcli.scene.laws.models import MODELS
    from rockcli.study.document.expressions import FUNCTIONS, MEANINGS, UNITS

    parts = ["# Choices\n\nModels, backends, pulses, symbols of expressions and plots, as `rock show` lists them.\n"]
    rows = [(f"`{m.name}`", f"`{m.geometry}`" if m.geometry else "", m.reference, m.sentence) for m in MODELS.values()]
    parts.append(
        f"## Models\n\n{table(('model', 'geometry', 'equation of the thesis', 'good for'), rows)}"
        "\nBeside these `flexible` ([flexible.md](../flexible.md)), `continuum` ([calculix.md](../calculix.md)) and `auto` ([auto.md](../auto.md)).\n"
    )
    rows = [
        (f"`{b.name}`", ", ".join(sorted({n for n, _ in b.models})), ", ".join(sorted(b.damping)), b.sentence)
        for b in BACKENDS.values()
    ]
    parts.append(f"## Backends\n\n{table(('backend', 'models', 'damping', 'method'), rows)}")
    rows = [(f"`{s.name}`", ", ".join(s.options), f"`{s.sentence}`") for s in SHAPES.values()]
    parts.append(f"## Pulses\n\n{table(('shape', 'options', 'a_g, tau = t - t0'), rows)}")
    rows = [(f"`{name}`", meaning) for name, meaning in MEANINGS.items()] + [("`pi`", "3.14159...")]
    rows += [(f"`{name}`", f"unit, {size:.10g} in SI") for name, size in UNITS.items()]
    rows += [(f"`{name}(x)`", "function") for name in FUNCTIONS]
    parts.append(
        f"## Symbols\n\n{table(('symbol', 'meaning'), rows)}\nOperators: `+ - * / ** ( )`; own symbols: `let` of the study.\n"
    )
    rows = [(f"`{kind.name}`", kind.sentence) for kind in KINDS.values()]
    parts.append(f"## Plots\n\n{table(('plot', 'shows'), rows)}")
    return "\n".join(parts)


def environment() -> str:
    """Environment variables."""
    from rockcli.cli.environment import ENVIRONMENT

    rows = [(f"`{name}`", meaning) for name, meaning in ENVIRONMENT.items()]
    return (
        f"# Environment variables\n\n`rock show environment` lists the same.\n\n{table(('variable', 'meaning'), rows)}"
    )


def api() -> str:
    """The functions of `rockcli`, with their docstrings."""
    import rockcli

    parts = ["# Python\n\nBy examples: [python.md](../python.md).\n"]
    for name in rockcli.__all__:
        thing = getattr(rockcli, name)
        if inspect.isfunction(thing):
            parts.append(
                f"## rockcli.{name}\n\n```python\n{name}{_signature(thing)}\n```\n\n```text\n{inspect.getdoc(thing)}\n```\n"
            )
        elif inspect.isclass(thing):
            parts.append(f"## rockcli.{name}\n\n{inspect.getdoc(thing)}\n")
    return "\n".join(parts)


def _signature(function: Any) -> str:
    signature = inspect.signature(function)
    words = [str(parameter).replace("'", "") for parameter in signature.parameters.values()]
    return f"({', '.join(words)}) -> {str(signature.return_annotation).strip(chr(39))}"


PAGES: dict[str, Callable[[], str]] = {
    "commands.md": commands,
    "keys.md": keys,
    "variables.md": variables,
    "choices.md": choices,
    "environment.md": environment,
    "api.md": api,
}


def page(name: str) -> str:
    """The text of a page of the reference."""
    title, _, rest = PAGES[name]().partition("\n")
    return f"{title}\n{MADE}{rest.rstrip()}\n"


if __name__ == "__main__":
    FOLDER.mkdir(exist_ok=True)
    for each in PAGES:
        (FOLDER / each).write_text(page(each), encoding="utf-8")
