"""`rock verify`: closed forms against the solvers, printed with tolerances."""

from __future__ import annotations

from typing import Annotated

import typer


def verify(
    as_json: Annotated[bool, typer.Option("--json", help="Print the checks as JSON.")] = False,
) -> None:
    """Check the solvers against closed forms.

    Exit code 1 if one is missed.
    """
    from rockcli.engine.verify import checks

    rows = []
    failed = 0
    for check in checks():
        failed += not check.passed
        rows.append(check.as_dict())
        if not as_json:
            word = "OK" if check.passed else "FAIL"
            typer.echo(
                f"{word:<4} {check.name:<54} expected {check.expected:<18.12g} got {check.got:<18.12g} "
                f"relative difference {check.difference:8.1e}  tolerance {check.tolerance:.0e}"
            )
    if as_json:
        import json

        typer.echo(json.dumps(rows, indent=2))
    else:
        typer.echo(f"{len(rows) - failed} of {len(rows)} agree")
    raise typer.Exit(1 if failed else 0)
