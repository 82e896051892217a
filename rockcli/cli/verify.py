"""`rock verify`: closed forms against the solvers, printed with tolerances."""

from __future__ import annotations

from typing import Annotated

import typer

from rockcli.cli.say import say
from rockcli.cli.tables import table


def verify(
    as_json: Annotated[bool, typer.Option("--json", help="Print the checks as JSON.")] = False,
) -> None:
    """Check the solvers against closed forms.

    Exit code 1 if one is missed.
    """
    from rockcli.engine.verify import checks

    made = list(checks())
    agree = sum(check.passed for check in made)
    if as_json:
        import json

        say(json.dumps([check.as_dict() for check in made], indent=2))
    else:
        rows = [
            (
                "OK" if check.passed else "FAIL",
                check.name,
                f"{check.expected:.12g}",
                f"{check.got:.12g}",
                f"{check.difference:.1e}",
                f"{check.tolerance:.0e}",
            )
            for check in made
        ]
        say(table(("", "closed form", "expected", "got", "difference", "allowed"), rows, right=4))
        say(f"{agree} of {len(made)} agree; differences are relative")
    raise typer.Exit(0 if agree == len(made) else 1)
