"""The table of agencies' record formats (COSMOS, CSMIP, SMC, GeoNet, ESM, ...), and which of them a file is in."""

from __future__ import annotations

from rockcli.motion.agencies.channel import Channel, Format
from rockcli.motion.agencies.cosmos import COSMOS
from rockcli.motion.agencies.csmip import CSMIP
from rockcli.motion.agencies.cwb import CWB
from rockcli.motion.agencies.geonet import GEONET
from rockcli.motion.agencies.keyed import CSMNC, ESM, RESORCE
from rockcli.motion.agencies.smc import SMC

FORMATS: tuple[Format, ...] = (COSMOS, CSMIP, GEONET, SMC, ESM, RESORCE, CSMNC, CWB)

HEAD = 4096
"""Bytes at the beginning of a file that tell its format."""


def format_of(data: bytes) -> Format | None:
    """The format of a file by its beginning; None if it is none of these."""
    head = data[:HEAD]
    if b"\0" in head:
        return None
    lines = lines_of(head)
    return next((one for one in FORMATS if one.recognises(lines)), None)


def lines_of(data: bytes) -> list[str]:
    """The lines of a text file, whatever its line ends, without the mark that editors put before it."""
    text = data.removeprefix(b"\xef\xbb\xbf").decode("latin-1")
    return text.replace("\r\r\n", "\n").replace("\r\n", "\n").replace("\r", "\n").split("\n")


def channels_of(data: bytes, one: Format, name: str) -> list[Channel]:
    """The components of a file.

    Raises:
        RecordError: with file and line, what is wrong.
    """
    return one.parse(lines_of(data), name)
