"""Equations as the pages write them, in plain text, to MathML, which browsers show without a script or a network.

    q'' = -p² [ (1 + a_v/g) sin(alpha - q) + s (a_g/g) cos(alpha - q) ]          (T1)

A line is a row; its number, as (T1), stands at its end or its beginning.  Names of Greek letters become letters,
`x_g`, `c_(k+2)`, `S_{k-1}` subscripts, `p²`, `x^k`, `B^T` superscripts, `sqrt(...)` a root; other words stay words.
"""

from __future__ import annotations

import re
from html import escape

GREEK = {"alpha": "α", "beta": "β", "gamma": "γ", "delta": "δ", "zeta": "ζ", "eta": "η", "theta": "θ", "kappa": "κ"}
GREEK |= {"lam": "λ", "mu": "μ", "nu": "ν", "xi": "ξ", "pi": "π", "rho": "ρ", "sigma": "σ", "tau": "τ", "phi": "φ"}
GREEK |= {"psi": "ψ", "omega": "ω", "Delta": "Δ", "Phi": "Φ", "integral": "∫", "sum": "Σ"}
FUNCTIONS = {"sin", "cos", "tan", "atan", "atan2", "exp", "ln", "sgn", "min", "max"}
SIGNS = {"<=": "≤", ">=": "≥", "!=": "≠", "->": "→", "*": "·", "-": "−", "...": "…", "..": "…"}
RAISED = dict(zip("²³⁴", "234", strict=True))
OPEN, CLOSE = "([{", ")]}"

TOKEN = re.compile(
    r"(?P<space>\s+)|(?P<number>\d+(?:\.\d+)?|\.\d+)|(?P<primes>'+)|(?P<name>[^\W\d_²³⁴]+\d*)|(?P<code>`[^`]+`)"
    r"|(?P<sign><=|>=|!=|->|\.{2,3}|.)"
)
LABEL = re.compile(r"^\s*\(([A-Z]?\d*)\)\s{2,}(.*?)$|^(.*?),?\s{2,}\(([A-Z]?\d*)\)[.,]?$")


def rendered(block: str) -> str:
    """A block of equations as one line of HTML: a table of rows, numbers at the right."""
    rows = [_row(line) for line in block.splitlines() if line.strip()]
    return f'<div class="equations">{"".join(rows)}</div>'


def _row(line: str) -> str:
    found = LABEL.match(line)
    number, text = ("", line) if found is None else (found[1] or found[4] or "", found[2] or found[3] or "")
    indent = ' class="continued"' if line.startswith("  ") and not number else ""
    label = f"<span>({escape(number)})</span>" if number else ""
    return f'<div{indent}><math display="block"><mrow>{mathml(text.strip())}</mrow></math>{label}</div>'


def mathml(text: str) -> str:
    """The children of an mrow.

    Raises:
        ValueError: a bracket after `_`, `^` or `sqrt` that is not closed.
    """
    tokens = [(found.lastgroup or "", found[0]) for found in TOKEN.finditer(text)]
    parts, at = [], 0
    while at < len(tokens):
        part, at = _item(tokens, at)
        parts.append(part)
    return "".join(parts)


Tokens = list[tuple[str, str]]


def _item(tokens: Tokens, at: int) -> tuple[str, int]:
    """One symbol with its primes, subscript and superscript."""
    kind, text = tokens[at]
    if kind == "space":
        wide = '<mspace width="1.5em"/>' if len(text) > 1 else '<mspace width="0.25em"/>'
        return wide, at + 1
    if text == "sqrt" and at + 1 < len(tokens):
        at += 1 + (tokens[at + 1][0] == "space")
        inside, at = _group(tokens, at)
        base = f"<msqrt><mrow>{inside}</mrow></msqrt>"
    else:
        base, at = _symbol(kind, text), at + 1
    low, high = "", ""
    while at < len(tokens):
        kind, text = tokens[at]
        if kind == "primes":
            high, at = f"<mo>{'′' * len(text)}</mo>{high}", at + 1
        elif (text == "*" or (text in "+-" and high)) and (at + 1 == len(tokens) or tokens[at + 1][1][0] in " ),]"):
            high, at = f"{high}<mo>{text}</mo>", at + 1  # q*, theta'+
        elif text in RAISED:
            high, at = f"{high}<mn>{RAISED[text]}</mn>", at + 1
        elif text in "_^" and at + 1 < len(tokens):
            inside, at = _group(tokens, at + 1)
            low, high = (low + inside, high) if text == "_" else (low, high + inside)
        else:
            break
    return _scripts(base, low, high), at


def _scripts(base: str, low: str, high: str) -> str:
    low, high = (f"<mrow>{part}</mrow>" if part else "" for part in (low, high))
    if low and high:
        return f"<msubsup>{base}{low}{high}</msubsup>"
    if low:
        return f"<msub>{base}{low}</msub>"
    return f"<msup>{base}{high}</msup>" if high else base


def _group(tokens: Tokens, at: int) -> tuple[str, int]:
    """What a subscript, a superscript or a root holds: one symbol, or all up to the closing bracket."""
    kind, text = tokens[at]
    if text not in OPEN:
        return _symbol(kind, text), at + 1
    depth, parts, at = 1, [], at + 1
    while at < len(tokens):
        text = tokens[at][1]
        depth += (text in OPEN) - (text in CLOSE)
        if depth == 0:
            return "".join(parts), at + 1
        part, at = _item(tokens, at)
        parts.append(part)
    raise ValueError("a bracket is not closed")


def _symbol(kind: str, text: str) -> str:
    """A number, a letter, a function, a word or a sign."""
    if kind == "number":
        return f"<mn>{text}</mn>"
    if kind == "code":
        return f"<mtext>{escape(text.strip('`'))}</mtext>"
    if kind != "name":
        return f'<mo stretchy="false">{escape(SIGNS.get(text, text))}</mo>'
    if text in ("integral", "sum"):
        return f"<mo>{GREEK[text]}</mo>"
    if text in GREEK:
        return f"<mi>{GREEK[text]}</mi>"
    if text in FUNCTIONS:
        return f'<mi mathvariant="normal">{text}</mi>'
    if text in ("Σ", "∫"):
        return f"<mo>{text}</mo>"
    return f"<mi>{text}</mi>" if len(text) == 1 else f"<mtext>{text}</mtext>"
