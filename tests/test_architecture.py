"""The house rules: layers, no circles, a door per reason for each dependency, one place for a constant."""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path

import pytest

PACKAGE = Path(__file__).resolve().parents[1] / "rockcli"

LAYERS = {
    "errors": 0,
    "version": 0,
    "process_groups": 0,
    "forks": 1,
    "kernels": 1,
    "scene": 2,
    "motion": 3,
    "study": 4,
    "solvers": 4,
    "storage": 4,
    "plotting": 4,
    "analysis": 5,
    "engine": 6,
    "cli": 7,
}
"""A module imports from layers below its own, or from its own folder; siblings never import one another."""

DOORS = {
    "typer": "cli",
    "rich": "cli",
    "dask": "engine",
    "filelock": "engine",
    "distributed": "engine",
    "yaml": "study",
    "pydantic": "study",
    "sklearn": "analysis",
    "trimesh": "study",
    "scipy": "solvers",  # but for special functions and statistics, see `FREE`
    "xarray": "storage",
    "pandas": "storage",
    "openpyxl": "storage",
    "pyarrow": "storage",
    "netCDF4": "storage",
    "matplotlib": "plotting",
    "PIL": "plotting",
    "obspy": "motion",
    "numba": "kernels",
    "llvmlite": "kernels",
}

FREE = ("scipy.special", "scipy.stats", "scipy.spatial")
"""What any module above the kernels may import, as numpy: the alternative is a worse copy of it."""

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

    visit(parsed(path))
    return found


def layer_of(path: Path) -> str:
    return path.relative_to(PACKAGE).with_suffix("").parts[0]


def every_import() -> Iterator[tuple[Path, str, str, int]]:
    """File, its layer, what it imports and in which line."""
    return ((path, layer_of(path), module, line) for path in FILES for module, line in imports(path))


def test_imports_go_one_way():
    for path, own, module, line in every_import():
        parts = module.split(".")
        if parts[0] == "rockcli" and len(parts) > 1 and parts[1] in LAYERS and own in LAYERS:
            other = parts[1]
            allowed = other == own or LAYERS[other] < LAYERS[own]
            assert allowed, f"{path}:{line}: {own} may not import {module}"


def test_a_door_per_reason():
    for path, own, module, line in every_import():
        top = module.split(".")[0]
        if module in FREE and LAYERS.get(own, 0) > LAYERS["kernels"]:
            continue
        if top in DOORS and not (path.name == "__init__.py" and path.parent == PACKAGE):
            assert own == DOORS[top], f"{path}:{line}: {top} is imported in {DOORS[top]} only"


def test_programs_are_run_in_one_place():
    """Watched, limited in time, and ended with what they have started; a video is written by ffmpeg alone, and kernels
    are compiled by this program itself, once more."""
    runners = {path.name for path in FILES if any(module == "subprocess" for module, _ in imports(path))}
    assert runners == {"programs.py", "video.py", "build.py"}


@cache
def parsed(path: Path) -> ast.Module:
    return ast.parse(path.read_text(encoding="utf-8"))


def name_of(path: Path) -> str:
    parts = path.relative_to(PACKAGE.parent).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def test_no_import_circle():
    """Not at any depth: imports inside functions count, and within a layer those for the type checker too."""
    modules = {name_of(path): path for path in FILES}
    arrows = {name: imported(path, modules, run_time) - {name} for name, path in modules.items()}
    for name, path in modules.items():
        named = imported(path, modules, ast.walk) - {name}
        arrows[name] |= {other for other in named if layer_of(modules[other]) == layer_of(path)}
    left = dict(arrows)
    while ends := [name for name, to in left.items() if not to & left.keys()]:
        for name in ends:
            del left[name]
    assert not left, f"circles among or towards {sorted(left)}"


def imported(path: Path, modules: dict[str, Path], nodes: Callable[[ast.AST], Iterator[ast.AST]]) -> set[str]:
    """Modules of the package that some nodes of this one import, a name of a package counted as its package."""
    found = set()
    for node in nodes(parsed(path)):
        if isinstance(node, ast.ImportFrom) and node.module:
            for alias in node.names:
                found |= {f"{node.module}.{alias.name}", node.module} & modules.keys()
                if f"{node.module}.{alias.name}" in modules:
                    found.discard(node.module)
        elif isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names} & modules.keys()
    return found


def run_time(node: ast.AST):
    """All nodes but those that stand under TYPE_CHECKING."""
    if isinstance(node, ast.If) and "TYPE_CHECKING" in ast.dump(node.test):
        children = node.orelse
    else:
        yield node
        children = list(ast.iter_child_nodes(node))
    for child in children:
        yield from run_time(child)


def test_a_constant_stands_in_one_module():
    stands: dict[tuple[str, str], list[str]] = {}
    for path in FILES:
        for name, value in constants(path):
            stands.setdefault((name.lstrip("_"), value), []).append(name_of(path))
    twice = {name: modules for (name, _), modules in stands.items() if len(modules) > 1}
    assert not twice


def constants(path: Path):
    """(name, value) of the constants of a module; type variables are none."""
    for node in parsed(path).body:
        if isinstance(node, ast.Assign | ast.AnnAssign) and node.value is not None:
            for target in node.targets if isinstance(node, ast.Assign) else [node.target]:
                pairs = [(target, node.value)]
                if isinstance(target, ast.Tuple) and isinstance(node.value, ast.Tuple):
                    pairs = list(zip(target.elts, node.value.elts, strict=True))
                for name, value in pairs:
                    if isinstance(name, ast.Name) and name.id.isupper() and "TypeVar" not in ast.unparse(value):
                        yield name.id, ast.unparse(value)


def test_a_study_opens_files_through_one_door():
    """What is read elsewhere is on no list, and results would not know that they depend on it."""
    for path in (PACKAGE / "study").rglob("*.py"):
        tree = parsed(path)
        called = {getattr(n.func, "attr", getattr(n.func, "id", "")) for n in ast.walk(tree) if isinstance(n, ast.Call)}
        opened = called & {"open", "read_text", "read_bytes", "loadtxt", "genfromtxt", "fromfile", "load"}
        assert path.name in ("inputs.py", "loader.py") or not opened, f"{path}: {opened}"


def test_kernels_know_no_object():
    for path in (PACKAGE / "kernels").rglob("*.py"):
        for module, line in imports(path):
            assert not module.startswith("rockcli.") or module.startswith("rockcli.kernels"), f"{path}:{line}"


BUILDERS = [path for room in ("building", "cases") for path in sorted((PACKAGE / "study" / room).rglob("*.py"))]


@pytest.mark.parametrize("path", BUILDERS, ids=lambda p: str(p.relative_to(PACKAGE)))
def test_a_default_stands_in_the_schema_alone(path):
    """What is built is read from the validated case: no `or default`, no `get(key, default)`, no look into the tree."""
    for node in ast.walk(parsed(path)):
        where = f"{path}:{getattr(node, 'lineno', 0)}"
        if isinstance(node, ast.BoolOp) and isinstance(node.op, ast.Or):
            assert not states_a_default(node.values[-1]), where
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and node.func.attr == "get":
            of = node.func.value
            table = isinstance(of, ast.Name) and of.id.isupper()
            apart = isinstance(of, ast.Attribute) and of.attr in ("environ", "where")  # the machine, places in the file
            assert len(node.args) < 2 or table or apart, where
        if isinstance(node, ast.Call) and ast.unparse(node.func) == "value_at" and path.name != "numbers.py":
            assert "numbers" not in ast.unparse(node), where
        if isinstance(node, ast.Subscript):
            assert ast.unparse(node.value) != "numbers.tree", where


def states_a_default(node: ast.expr) -> bool:
    """A constant, an empty list, a mapping, something newly made."""
    empty = isinstance(node, ast.List | ast.Tuple) and not node.elts
    made = isinstance(node, ast.Call) and ast.unparse(node.func) in ("Map", "dict", "list", "tuple")
    return (
        isinstance(node, ast.Constant | ast.Dict) or empty or made or (isinstance(node, ast.Name) and node.id.isupper())
    )
