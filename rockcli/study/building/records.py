"""Finds the records of a study, reads and processes each once."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from difflib import get_close_matches
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rockcli.errors import RecordError
from rockcli.forks import shared_out
from rockcli.study.building.matching import MOST, WILDCARDS, TooManyFiles, matched
from rockcli.study.catalog import how_to_obtain
from rockcli.study.document.tree import Source, Where

if TYPE_CHECKING:
    from rockcli.motion.floors import Arrival
    from rockcli.motion.motion import Given, Motion
    from rockcli.scene.ground.excitation import Samples


SYNTHETIC = "synthetic_"
"""What the names of the records begin with that come with the program; they are sought there last."""

MANY = 100
"""Files from which it pays to read them in several processes: one takes 10 to 20 ms to begin and to answer."""


class MissingRecordError(RecordError):
    """A record that stands in none of the folders: `--skip-missing` passes over its study."""


@dataclass(frozen=True, eq=False)
class Prepared:
    """A record as a study uses it: the processed motion and that of the file; both measured, once for each g."""

    motion: Motion
    raw: Motion
    path: Path
    unscaled: dict[tuple[float, tuple[str, ...], str], Samples] = field(default_factory=dict)


@dataclass(eq=False)
class Records:
    """The records of one study, each read and processed once per distinct settings.

    Attributes:
        given: those it holds itself; readers: processes that read, at most.
    """

    source: Source
    prepared: dict[tuple[str, str], Prepared] = field(default_factory=dict)
    directions: dict[tuple[Prepared, Prepared, float], Prepared] = field(default_factory=dict)
    found: dict[str, Path] = field(default_factory=dict)
    arrivals: dict[tuple[bytes, float, bytes, bytes], Arrival] = field(default_factory=dict)
    given: Mapping[str, Given | Motion] = field(default_factory=dict)
    readers: int = 1

    @cached_property
    def folders(self) -> list[Path]:
        """Where records are sought, first to last."""
        folder = self.source.folder
        absolute = folder.absolute()
        listed = [folder, *(parent / "records" for parent in (absolute, *absolute.parents)), Path("records")]
        listed += [Path(entry) for entry in _environment()]
        unique: dict[Path, Path] = {}
        for path in listed:
            unique.setdefault(path.absolute(), path)
        return list(unique.values())

    def find(self, name: str, where: Where) -> Path:
        """The file of a record.

        Raises:
            MissingRecordError: it is nowhere; says where it was sought and how to get it.
        """
        if name not in self.found:
            for folder in self._sought(name):
                if os.path.isfile(path := folder / name):
                    self.found[name] = path
                    break
            else:
                raise self.source.record_error(where, self._missing(name), MissingRecordError)
        return self.found[name]

    def match(self, key: str, pattern: str, where: Where) -> list[str]:
        """Names of the records that a glob at a key matches, sorted, in the first folder that has any.

        Raises:
            MissingRecordError: none; says where they were sought and how to get them.
            RecordError: it would take too long to look.
        """
        for folder in [Path()] if os.path.isabs(pattern) else self._sought(pattern):
            try:
                there = {name: path for name in matched(pattern, folder) if os.path.isfile(path := folder / name)}
            except (OSError, ValueError, RecursionError):
                continue
            except TooManyFiles:
                why = f"looks through more than {MOST} files; begin with the folder in which the records are"
                raise self.source.record_error(where, f"{key} is {pattern[:200]!r}, which {why}") from None
            if there:
                self.found |= there  # where `find` would find them: no folder before this one has any
                return list(there)
        searched = ", ".join(self._searched(pattern))
        lines = [f"{key} is {pattern[:200]!r}, which no file matches", f"Searched: {searched}"]
        raise self.source.record_error(where, "\n  ".join(lines + how_to_obtain(pattern)), MissingRecordError)

    def _sought(self, name: str) -> list[Path]:
        """Where a record or a glob is sought, first to last."""
        return [*self.folders, _shipped()] if name.startswith(SYNTHETIC) else self.folders

    def prepare(self, name: str, where: Where, *, reading: dict[str, Any], steps: dict[str, Any], g: float) -> Prepared:
        """Read and process a record, or take what was prepared before.

        Args:
            name: as in the study.
            where: place in the study, for errors.
            reading: component, units, dt; steps: window ... resample, None left out.
            g: for the PGV of values in g, in sentences [m/s²].
        """
        return self._prepared(name, where, reading, steps, g, _key(reading, steps, g))

    def prepare_all(
        self,
        named: Sequence[tuple[str, Where]],
        *,
        reading: dict[str, Any],
        steps: dict[str, Any],
        g: float,
        measure: Callable[[Prepared, str], object],
    ) -> list[Prepared]:
        """`prepare` of many, each with its place; of many files in several processes, which `measure` them too."""
        from rockcli.motion.reading import ready_for

        options = _key(reading, steps, g)

        def made(one: tuple[str, Path]) -> Prepared:
            name, path = one
            prepared = self._made(name, path, reading, steps, g)
            measure(prepared, name)
            return prepared

        new: dict[tuple[str, str], tuple[str, Path]] = {}
        with suppress(RecordError):  # told below
            for name, where in named:
                path = self._path(name, where)
                if (str(path), options) not in self.prepared and name not in self.given:
                    new[str(path), options] = name, path
        ready_for(len(new))  # before processes are forked
        if len(new) >= MANY and self.readers > 1:
            found = zip(new, shared_out(made, list(new.values()), self.readers), strict=True)
            self.prepared |= {key: prepared for key, prepared in found if prepared is not None}
        return [self._prepared(name, where, reading, steps, g, options) for name, where in named]

    def _prepared(
        self, name: str, where: Where, reading: dict[str, Any], steps: dict[str, Any], g: float, options: str
    ) -> Prepared:
        path = self._path(name, where)
        key = str(path), options
        if key not in self.prepared:
            self.prepared[key] = self._made(name, path, reading, steps, g)
        self.source.inputs.note(name, path, self.prepared[key].raw.sha256)  # one file may have several names
        return self.prepared[key]

    def _made(self, name: str, path: Path, reading: dict[str, Any], steps: dict[str, Any], g: float) -> Prepared:
        raw = motion = self._read(name, path, reading)
        if steps:
            from rockcli.motion.processing import process

            motion = process(raw, **steps, g=g)
        return Prepared(motion, raw, path)

    def _path(self, name: str, where: Where) -> Path:
        return Path(name) if name in self.given else self.find(name, where)

    def _read(self, name: str, path: Path, reading: dict[str, Any]) -> Motion:
        from rockcli.motion.reading import motion_of, read_record

        given = self.given.get(name)
        return read_record(path, **reading) if given is None else motion_of(given, name, **reading)

    def _missing(self, name: str) -> str:
        """What is missing, where it was sought and how to get it: a line each."""
        lines = [f"the record {name[:200]!r} was not found"]
        if WILDCARDS & set(name):
            lines.append("A pattern stands for several files, which are an axis or points of its named settings:")
            lines.append("vary: {motion.record.file: PATTERN}, or vary: {motion.record: {near: {file: PATTERN}}}")
        lines.append(f"Searched: {', '.join(self._searched(name))}")
        close = get_close_matches(Path(name).name[:200], list(dict.fromkeys(self._present())), n=3, cutoff=0.6)
        if close:
            lines.append(f"Close names: {', '.join(close)}")
        how = how_to_obtain(name)
        lines += how or ["Put it beside the study, into records/, or into a folder named in ROCK_RECORDS"]
        return "\n  ".join(lines)

    def _searched(self, name: str) -> list[str]:
        """The folders there are, those on the way of a name that are locked, and those of ROCK_RECORDS that are not."""
        named = {Path(entry).absolute() for entry in _environment()}
        searched = []
        for folder in self.folders:
            if _is_locked(inside := (folder / name).parent):
                searched.append(f"{inside} (permission denied)")
            elif os.path.isdir(folder):
                searched.append(str(folder))
            elif folder.absolute() in named:
                searched.append(f"{folder} (of ROCK_RECORDS; there is no such folder)")
        return searched or ["no folder: there is none"]

    def _present(self) -> Iterator[str]:
        """Names of files where records are sought, and of the records that come with the program."""
        for folder, begin in (*((each, "") for each in self.folders), (_shipped(), SYNTHETIC)):
            try:
                yield from (path.name for path in folder.iterdir() if path.is_file() and path.name.startswith(begin))
            except OSError:
                continue


def _is_locked(folder: Path) -> bool:
    """Whether this user may not look into a folder, or into one above it."""
    try:
        os.stat(os.path.join(folder, "."))
    except PermissionError:
        return True
    except (OSError, ValueError):
        pass
    return False


def _key(reading: dict[str, Any], steps: dict[str, Any], g: float) -> str:
    return json.dumps([reading, steps, g], sort_keys=True)


def _shipped() -> Path:
    """The records that come with the program: in the package, or beside it in the sources."""
    package = Path(__file__).resolve().parents[2]
    inside = package / "shipped" / "records"
    return inside if inside.is_dir() else package.parent / "records"


def _environment() -> list[str]:
    return [entry for entry in os.environ.get("ROCK_RECORDS", "").split(os.pathsep) if entry]
