"""The house rules: layers, one door per dependency, file size."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

PACKAGE = Path(__file__).resolve().parents[1] / "rockcli"

LAYERS = {
    "errors": 0,
    "kernels": 1,
    "scene": 2,
    "motion": 3,
    "study": 4,
    "solvers": 4,
    "storage": 4,
    "plotting": 4,
    "engine": 5,
    "cli": 6,
}
"""A module imports from layers below its own, or from its own folder; siblings never import one another."""

DOORS = {
    "typer": "cli",
    "rich": "cli",
    "dask": "engine",
    "distributed": "engine",
    "yaml": "study",
    "pydantic": "study",
    "scipy": "solvers",
    "xarray": "storage",
    "netCDF4": "storage",
    "matplotlib": "plotting",
    "PIL": "plotting",
    "obspy": "motion",
    "numba": "kernels",
}

FILES = sorted(PACKAGE.rglob("*.py"))


def imports(path: Path) -> list[tuple[str, int]]:
    """Modules imported at run time, with line numbers; what stands under TYPE_CHECKING does not count."""
    found: list[tuple[str, int]] = []

    def visit(node: ast.AST) -> None:
        if isinstance(node, ast.If) and "TYPE_CHECKING" in ast.dump(node.test):
            for child in node.orelse:
                visit(child)
            return
        if isinstance(node, ast.Import):
            found.extend((alias.name, node.lineno) for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}:{node.lineno}: relative import"
            base = node.module or ""
            found.extend((f"{base}.{alias.name}" if base == "rockcli" else base, node.lineno) for alias in node.names)
        for child in ast.iter_child_nodes(node):
            visit(child)

    visit(ast.parse(path.read_text(encoding="utf-8")))
    return found


def layer_of(path: Path) -> str:
    return path.relative_to(PACKAGE).with_suffix("").parts[0]


@pytest.mark.parametrize("path", FILES, ids=lambda p: str(p.relative_to(PACKAGE)))
def test_imports_go_one_way(path):
    own = layer_of(path)
    for module, line in imports(path):
        parts = module.split(".")
        if parts[0] == "rockcli" and len(parts) > 1 and parts[1] in LAYERS and own in LAYERS:
            other = parts[1]
            allowed = other == own or LAYERS[other] < LAYERS[own]
            assert allowed, f"{path}:{line}: {own} may not import {module}"


@pytest.mark.parametrize("path", FILES, ids=lambda p: str(p.relative_to(PACKAGE)))
def test_one_door_per_dependency(path):
    own = layer_of(path)
    for module, line in imports(path):
        top = module.split(".")[0]
        if top in DOORS and not (path.name == "__init__.py" and path.parent == PACKAGE):
            assert own == DOORS[top], f"{path}:{line}: {top} is imported in {DOORS[top]} only"


@pytest.mark.parametrize("path", FILES, ids=lambda p: str(p.relative_to(PACKAGE)))
def test_files_are_short(path):
    assert len(path.read_text(encoding="utf-8").splitlines()) <= 400


def test_a_study_opens_files_through_one_door():
    """What is read elsewhere is on no list, and results would not know that they depend on it."""
    for path in (PACKAGE / "study").glob("*.py"):
        tree = ast.parse(path.read_text(encoding="utf-8"))
        called = {getattr(n.func, "attr", getattr(n.func, "id", "")) for n in ast.walk(tree) if isinstance(n, ast.Call)}
        opened = called & {"open", "read_text", "read_bytes", "loadtxt", "genfromtxt", "fromfile", "load"}
        assert path.name in ("inputs.py", "loader.py") or not opened, f"{path}: {opened}"


def test_kernels_know_no_object():
    for path in (PACKAGE / "kernels").rglob("*.py"):
        for module, line in imports(path):
            assert not module.startswith("rockcli.") or module.startswith("rockcli.kernels"), f"{path}:{line}"
