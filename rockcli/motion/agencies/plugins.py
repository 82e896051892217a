"""The formats as ObsPy waveform plug-ins: `obspy.read` finds these functions by entry point.

Values stay in the file's unit, which `stats.<format>.units` names; `station` and `channel` are set in `stats`.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from rockcli.motion.agencies.channel import Format
from rockcli.motion.agencies.cosmos import COSMOS
from rockcli.motion.agencies.csmip import CSMIP
from rockcli.motion.agencies.cwb import CWB
from rockcli.motion.agencies.formats import HEAD, channels_of, format_of
from rockcli.motion.agencies.geonet import GEONET
from rockcli.motion.agencies.keyed import CSMNC, ESM, RESORCE
from rockcli.motion.agencies.smc import SMC
from rockcli.motion.file import record_bytes

if TYPE_CHECKING:
    from obspy import Stream


def _is(one: Format, filename: Any) -> bool:
    try:
        if hasattr(filename, "read"):
            return format_of(filename.read(HEAD)) is one
        with open(filename, "rb") as file:
            return format_of(file.read(HEAD)) is one
    except Exception:
        return False


def _read(one: Format, filename: Any, headonly: bool) -> Stream:
    from obspy import Stream, Trace
    from obspy.core import AttribDict

    if hasattr(filename, "read"):
        data, name = bytes(filename.read()), str(getattr(filename, "name", "record"))
    else:
        data, name = record_bytes(Path(filename)), str(filename)
    stream = Stream()
    for channel in channels_of(data, one, name):
        trace = Trace(data=np.array([]) if headonly else channel.values)
        trace.stats.delta = channel.dt
        if headonly:
            trace.stats.npts = len(channel.values)
        trace.stats.station, trace.stats.channel = channel.station, channel.component
        trace.stats[one.name.lower()] = AttribDict(units=channel.units, peak=channel.peak, **channel.header)
        stream.append(trace)
    return stream


def is_cosmos(filename: Any) -> bool:
    """Whether a file is in the format COSMOS (ObsPy's `isFormat`); never raises."""
    return _is(COSMOS, filename)


def read_cosmos(filename: Any, headonly: bool = False, **_: Any) -> Stream:
    """A file in the format COSMOS as a Stream (ObsPy's `readFormat`)."""
    return _read(COSMOS, filename, headonly)


def is_csmip(filename: Any) -> bool:
    """Whether a file is in the format CSMIP (ObsPy's `isFormat`); never raises."""
    return _is(CSMIP, filename)


def read_csmip(filename: Any, headonly: bool = False, **_: Any) -> Stream:
    """A file in the format CSMIP as a Stream (ObsPy's `readFormat`)."""
    return _read(CSMIP, filename, headonly)


def is_geonet(filename: Any) -> bool:
    """Whether a file is in the format GEONET (ObsPy's `isFormat`); never raises."""
    return _is(GEONET, filename)


def read_geonet(filename: Any, headonly: bool = False, **_: Any) -> Stream:
    """A file in the format GEONET as a Stream (ObsPy's `readFormat`)."""
    return _read(GEONET, filename, headonly)


def is_smc(filename: Any) -> bool:
    """Whether a file is in the format SMC (ObsPy's `isFormat`); never raises."""
    return _is(SMC, filename)


def read_smc(filename: Any, headonly: bool = False, **_: Any) -> Stream:
    """A file in the format SMC as a Stream (ObsPy's `readFormat`)."""
    return _read(SMC, filename, headonly)


def is_esm(filename: Any) -> bool:
    """Whether a file is in the format ESM (ObsPy's `isFormat`); never raises."""
    return _is(ESM, filename)


def read_esm(filename: Any, headonly: bool = False, **_: Any) -> Stream:
    """A file in the format ESM as a Stream (ObsPy's `readFormat`)."""
    return _read(ESM, filename, headonly)


def is_resorce(filename: Any) -> bool:
    """Whether a file is in the format RESORCE (ObsPy's `isFormat`); never raises."""
    return _is(RESORCE, filename)


def read_resorce(filename: Any, headonly: bool = False, **_: Any) -> Stream:
    """A file in the format RESORCE as a Stream (ObsPy's `readFormat`)."""
    return _read(RESORCE, filename, headonly)


def is_csmnc(filename: Any) -> bool:
    """Whether a file is in the format CSMNC (ObsPy's `isFormat`); never raises."""
    return _is(CSMNC, filename)


def read_csmnc(filename: Any, headonly: bool = False, **_: Any) -> Stream:
    """A file in the format CSMNC as a Stream (ObsPy's `readFormat`)."""
    return _read(CSMNC, filename, headonly)


def is_cwb(filename: Any) -> bool:
    """Whether a file is in the format CWB (ObsPy's `isFormat`); never raises."""
    return _is(CWB, filename)


def read_cwb(filename: Any, headonly: bool = False, **_: Any) -> Stream:
    """A file in the format CWB as a Stream (ObsPy's `readFormat`)."""
    return _read(CWB, filename, headonly)
