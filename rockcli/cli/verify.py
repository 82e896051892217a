"""`rock verify`: closed forms against the solvers, printed with tolerances."""

from __future__ import annotations

from typing import Annotated

import typer

from rockcli.cli.say import say


def verify(
    as_json: Annotated[bool, typer.Option("--json", help="Print the checks as JSON.")] = False,
) -> None:
    """Check the solvers against closed forms.

    Exit code 1 if one is missed.
    """
    from rockcli.engine.verify import checks

    rows = []
    failed = 0
    if not as_json:
        say(f"     {'':<54} {'expected':>15} {'got':>15} {'difference':>10} {'allowed':>8}")
    for check in checks():
        failed += not check.passed
        rows.append(check.as_dict())
        if not as_json:
            word = "OK" if check.passed else "FAIL"
            numbers = f"{check.expected:>15.12g} {check.got:>15.12g} {check.difference:>10.1e} {check.tolerance:>8.0e}"
            say(f"{word:<4} {check.name:<54} {numbers}")
    if as_json:
        import json

        say(json.dumps(rows, indent=2))
    else:
        say(f"{len(rows) - failed} of {len(rows)} agree; differences are relative")
    raise typer.Exit(1 if failed else 0)
