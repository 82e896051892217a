"""The formats as ObsPy waveform plug-ins: `obspy.read` finds the pairs below by entry point.

Values stay in the file's unit, which `stats.<format>.units` names; `station` and `channel` are set in `stats`.
"""

from __future__ import annotations

from functools import partial
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
    """Whether a file is in a format (ObsPy's `isFormat`); never raises."""
    try:
        if hasattr(filename, "read"):
            return format_of(filename.read(HEAD)) is one
        with open(filename, "rb") as file:
            return format_of(file.read(HEAD)) is one
    except Exception:
        return False


def _read(one: Format, filename: Any, headonly: bool = False, **_: Any) -> Stream:
    """A file in a format as a Stream (ObsPy's `readFormat`)."""
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


is_cosmos, read_cosmos = partial(_is, COSMOS), partial(_read, COSMOS)
is_csmip, read_csmip = partial(_is, CSMIP), partial(_read, CSMIP)
is_geonet, read_geonet = partial(_is, GEONET), partial(_read, GEONET)
is_smc, read_smc = partial(_is, SMC), partial(_read, SMC)
is_esm, read_esm = partial(_is, ESM), partial(_read, ESM)
is_resorce, read_resorce = partial(_is, RESORCE), partial(_read, RESORCE)
is_csmnc, read_csmnc = partial(_is, CSMNC), partial(_read, CSMNC)
is_cwb, read_cwb = partial(_is, CWB), partial(_read, CWB)
