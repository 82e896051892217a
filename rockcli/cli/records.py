"""`rock records`: what a record is, and the same record in another format."""

from __future__ import annotations

import os
import re
from math import inf, isnan
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from rockcli.cli.say import say
from rockcli.cli.tables import facts
from rockcli.scene.constants import STANDARD_G
from rockcli.scene.counted import counted

if TYPE_CHECKING:
    from rockcli.motion.motion import Motion

app = typer.Typer(
    help="Look at ground-motion records and convert them.",
    context_settings={"help_option_names": ["--help", "-h"]},
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
)

Component = Annotated[
    str | None, typer.Option(metavar="NAME|N", help="Which one of several: its name, or its place from 0.")
]
Units = Annotated[
    str | None,
    typer.Option(metavar="g|m/s2|cm/s2|gal|mm/s2", help="Units of the values, where the format does not say."),
]
TimeStep = Annotated[
    float | None, typer.Option("--dt", metavar="SECONDS", help="Time step [s], where the format does not say.")
]
Gravity = Annotated[float, typer.Option("--g", metavar="G", help="What 1 g is [m/s²], between values in g and m/s².")]


@app.command()
def info(
    files: Annotated[
        list[Path],
        typer.Argument(
            metavar="FILE|FOLDER", help="Records; a name alone is searched for as a study does.", show_default=False
        ),
    ],
    component: Component = None,
    units: Units = None,
    dt: TimeStep = None,
    g: Gravity = STANDARD_G,
    sa: Annotated[
        list[float] | None, typer.Option("--sa", metavar="T", help="Sa(T) at 5 % [s]; may be given several times.")
    ] = None,
    rotd: Annotated[
        bool, typer.Option("--rotd", help="The files are pairs of components: RotD50 and RotD100 of each.")
    ] = False,
    spectrum: Annotated[
        Path | None,
        typer.Option(
            "--spectrum", metavar="FILE", help="Draw the response spectra, with --rotd of the pairs: .png, .pdf, .svg."
        ),
    ] = None,
    json: Annotated[bool, typer.Option("--json", help="Print one JSON list instead of a table.")] = False,
) -> None:
    """Say what records are: length, time step and measures as they stand in their files, without any processing.

    Of a folder, with --sa or with --rotd one row each.
    """
    import json as json_module

    from rockcli.cli.record_tables import listed, pair_facts, rows_table, spectral
    from rockcli.errors import RecordError
    from rockcli.motion.flatfile import metadata_of
    from rockcli.motion.reading import ready_for

    periods = _periods(sa or [])
    _check_g(g)
    _check_spectrum(spectrum)
    chosen = listed(files)
    ready_for(len(chosen))
    if rotd and len(chosen) % 2:
        raise RecordError(f"--rotd needs pairs of components, not {counted(len(chosen), 'file')}")
    rows: list[dict[str, Any]] = []
    motions: list[Motion] = []
    sources: list[Path] = []
    complaints: list[RecordError] = []
    brief = any(inside for _, inside in chosen) or bool(periods) or rotd
    for file, inside in chosen:
        try:
            if os.path.isdir(file):
                raise RecordError("there is no file in this folder; folders in it are not searched", file)
            file = _found(file)
            found = _components(file, component, units, dt, every=brief and not rotd)
        except RecordError as error:
            if inside and not rotd:  # others may stand in a folder of records
                say(f"rock: left out: {error}", err=True)
            else:
                complaints.append(error)
            continue
        for motion in found:
            row = {
                "file": str(file),
                **_facts(motion, g),
                **metadata_of(file, motion.header),
                **spectral(motion, g, periods),
            }
            if not json and not brief:
                say(("\n" if rows else "") + _table(row))
            rows.append(row)
            motions.append(motion)
            sources.append(file)
    if rotd and not complaints:
        pairs = list(zip(motions[::2], motions[1::2], strict=True))
        rows = [
            {"file": f"{one.name}, {two.name}", "dt": one.dt, **pair_facts(one, two, g, periods)} for one, two in pairs
        ]
    if brief and rows and not json:
        say(rows_table(rows, g))
    if rotd or (brief and not json):  # which have no place for remarks
        for file, motion in zip(sources, motions, strict=True):
            for remark in motion.warnings:
                say(f"rock: {' '.join(filter(None, (str(file), motion.component)))}: {remark}", err=True)
    if json:
        say(json_module.dumps(rows, indent=2))
    if spectrum is not None and motions and not (rotd and complaints):
        _draw(spectrum, sources, motions, g, rotd=rotd)
    if not rows and not complaints:
        raise RecordError("no record in it can be read", files[0])
    for complaint in complaints[:-1]:
        say(f"rock: {complaint}", err=True)
    if complaints:
        raise complaints[-1]


def _check_g(g: float) -> None:
    from rockcli.errors import RecordError

    if not 0.0 < g < inf:
        raise RecordError(f"--g is {g:g}; expected m/s², above zero")


def _periods(said: list[float]) -> list[float]:
    from rockcli.errors import RecordError

    for period in said:
        if not 0.0 < period < 1e3:
            raise RecordError(f"--sa is {period:g}; expected a period in seconds, above zero")
    return list(dict.fromkeys(said))


def _check_spectrum(path: Path | None) -> None:
    from rockcli.engine.draw import FORMATS, format_of
    from rockcli.errors import RecordError
    from rockcli.storage.places import check_file

    if path is None:
        return
    if format_of(path) not in FORMATS:
        raise RecordError(f"--spectrum ends in {path.suffix!r}; expected one of .{', .'.join(FORMATS)}", path)
    check_file(path)


def _components(file: Path, component: str | None, units: str | None, dt: float | None, *, every: bool) -> list[Motion]:
    """All components of a file, or the one that is asked for."""
    from rockcli.motion.reading import components_of

    if component is not None or not every:
        return [_read(file, _component(component), units, dt)]
    return [_read(file, one, units, dt) for one in components_of(file)]


def _draw(path: Path, sources: list[Path], motions: list[Motion], g: float, *, rotd: bool) -> None:
    """The spectra of records, or of pairs in every direction: of more than can be told apart RotD50 alone."""
    import numpy as np

    from rockcli.cli.record_tables import LONGEST, POINTS, SHORTEST, pair_spectra, spectrum_of
    from rockcli.plotting.common.style import MOST_CURVES
    from rockcli.plotting.record_spectra import draw
    from rockcli.storage.atomic import replacing

    periods = np.geomspace(SHORTEST, LONGEST, POINTS)
    places = [file.absolute() for file in sources]
    shared = os.path.commonpath([place.parent for place in places])  # of all files: names tell the rest
    names = [
        f"{place.relative_to(shared)} {motion.component}".rstrip()
        for place, motion in zip(places, motions, strict=True)
    ]
    title = "Response spectra, 5 % damping"
    if rotd:
        ends = ("RotD50", "RotD100") if len(names) <= MOST_CURVES else ("RotD50",)
        title = f"Response spectra in every direction, {' and '.join(ends)}, 5 % damping"
        spectra = [
            (f"{', '.join(names[i : i + 2])}: {end}", values / g)
            for i in range(0, len(names), 2)
            for end, values in zip(ends, pair_spectra(motions[i], motions[i + 1], g, periods), strict=False)
        ]
    else:
        spectra = [(name, spectrum_of(motion, g, periods) / g) for name, motion in zip(names, motions, strict=True)]
    with replacing(path) as scratch:
        draw(scratch, periods, spectra, title)
    say(str(path), err=True)


@app.command()
def convert(
    source: Annotated[
        Path, typer.Argument(metavar="IN", help="The record, or its name as in a study.", show_default=False)
    ],
    target: Annotated[Path, typer.Argument(metavar="OUT", help="OUT.AT2 or OUT.txt.", show_default=False)],
    component: Component = None,
    units: Units = None,
    dt: TimeStep = None,
    g: Gravity = STANDARD_G,
    force: Annotated[bool, typer.Option("--force", help="Replace a file that is already there.")] = False,
) -> None:
    """Write a record as AT2 (values in g) or as two columns, time and acceleration (in the units read)."""
    from rockcli.errors import RecordError
    from rockcli.motion.at2 import at2_text
    from rockcli.motion.motion import start_of
    from rockcli.motion.text import two_columns
    from rockcli.storage.atomic import write_text
    from rockcli.storage.places import check_file

    kind = target.suffix.lower()
    if kind not in (".at2", ".txt"):
        raise RecordError(f"the name ends in {target.suffix!r}; expected .AT2 or .txt, which says the format", target)
    _check_g(g)
    check_file(target)
    if target.exists() and not force:
        raise RecordError("the file is already there; choose another name, or replace it with --force", target)
    motion = _read(_found(source), _component(component), units, dt)
    if kind == ".txt":
        title = f"converted from {motion.name} ({motion.format})"
        text = two_columns(motion.values, motion.dt, motion.units, [title, *filter(None, [start_of(motion)])])
    else:
        values = motion.values if motion.in_g else motion.values / g
        text = at2_text(values, motion.dt, _titles(motion, g), target)
    write_text(target, text)
    for remark in motion.warnings:
        say(f"{source}: {remark}", err=True)
    say(f"{target}: {len(motion.values)} values, dt {motion.dt:g} s")


def _found(path: Path) -> Path:
    """The path where something is there or it has a folder; else the record that a study here finds by that name.

    Raises:
        MissingRecordError: there is none; says where it was searched for.
    """
    from rockcli.study.building.records import Records
    from rockcli.study.document.tree import Source

    if os.path.lexists(path) or path.parent != Path():
        return path
    return Records(Source(None)).find(str(path), None)


def _read(file: Path, component: str | int | None, units: str | None, dt: float | None) -> Motion:
    """The record; what is wrong with it is said in the words of the command line.

    Raises:
        RecordError: it cannot be read, or not without more options.
    """
    from rockcli.errors import RecordError
    from rockcli.motion.options import OptionError
    from rockcli.motion.reading import read_record

    try:
        return read_record(file, component=component, units=units, dt=dt)
    except OptionError as error:
        message = re.sub(r"`(units|dt|component):?`", r"--\1", error.message)
        raise RecordError(message, error.file, error.line) from None


def _component(text: str | None) -> str | int | None:
    """A place in the file if it is a number without leading zeros, else a name."""
    return int(text) if text is not None and text.isdigit() and str(int(text)) == text else text


def _titles(motion: Motion, g: float) -> list[str]:
    """Two lines of header that say where the values come from, and when they begin."""
    from rockcli.motion.at2 import UNKNOWN
    from rockcli.motion.motion import start_of

    unit = "" if motion.in_g else f", 1 g = {g:g} m/s2"
    event, date, station = (str(motion.header.get(key) or "") for key in ("event", "date", "station"))
    place, component = (said.replace(",", "") for said in (station, motion.component))  # commas separate the four
    known = (event or UNKNOWN[0], date, place or UNKNOWN[1], component)
    identity = ", ".join(part for part in known if part) if component else "-"
    converted = ", ".join(filter(None, [f"Converted from {motion.name} ({motion.format}{unit})", start_of(motion)]))
    return [_printable(converted), _printable(identity)]


def _printable(text: str) -> str:
    return "".join(character if character.isprintable() else " " for character in text)


def _facts(motion: Motion, g: float) -> dict[str, Any]:
    from rockcli.motion.measures import measures
    from rockcli.motion.motion import start_of

    values = measures(motion.acceleration(g), motion.dt, g)
    known = {name: None if isnan(value) else value for name, value in values.items()}  # JSON has no NaN
    return {
        "format": motion.format,
        "component": motion.component,
        "title": "; ".join(motion.header.get("title", [])),
        "start": start_of(motion).removeprefix("start: "),
        "npts": len(motion.values),
        "dt": motion.dt,
        "duration": motion.duration,
        "units": motion.units,
        "pga_g": values["pga"] / g,
        **known,
        "sha256": motion.sha256,
        "processing": list(motion.processing),
        "warnings": list(motion.warnings),
    }


LINES = (
    ("format", "format", ""),
    ("component", "component", ""),
    ("title", "title", ""),
    ("start", "first sample at", ""),
    ("npts", "values", ""),
    ("dt", "time step", "s"),
    ("duration", "duration", "s"),
    ("units", "values read in", ""),
    ("pga_g", "PGA", "g"),
    ("pgv", "PGV", "m/s"),
    ("pgd", "PGD", "m"),
    ("arias", "Arias intensity", "m/s"),
    ("cav", "CAV", "m/s"),
    ("d5_95", "duration 5-95 %", "s"),
    ("t_mean", "mean period", "s"),
)
"""The table of `info`: key, words, unit."""

_UNIT_WORDS = {"g": "g, the acceleration of gravity", "m/s2": "metres per second squared"}


def _table(row: dict[str, Any]) -> str:
    rows = []
    for key, words, unit in LINES:
        if row[key] is None:
            continue
        value = f"{row[key]:.6g}" if isinstance(row[key], float) else _UNIT_WORDS.get(row[key], str(row[key]))
        if value:
            rows.append((words, f"{value} {unit}".rstrip()))
    rows += [("processing", sentence) for sentence in row["processing"]]
    rows += [("remark", sentence) for sentence in row["warnings"]]
    return f"{row['file']}\n{facts(rows)}"
