"""Tables as CSV, Markdown, LaTeX and HTML."""

from __future__ import annotations

import csv
import html
import io
import math
import re
import textwrap
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field

#: What a cell shows where there is no number: a dash.
NOTHING = "\N{EN DASH}"

MINUS = "\N{MINUS SIGN}"

# Letters that LaTeX joins into others where they follow one another, such as two hyphens into a dash.
_JOINED = re.compile(r"(?<=[-'`,!?])(?=[-'`,])")

_LATEX = {
    "\\": r"\textbackslash{}",
    "{": r"\{",
    "}": r"\}",
    "_": r"\_",
    "%": r"\%",
    "&": r"\&",
    "#": r"\#",
    "$": r"\$",
    "^": r"\textasciicircum{}",
    "~": r"\textasciitilde{}",
    "<": r"\textless{}",
    ">": r"\textgreater{}",
    "|": r"\textbar{}",
    '"': r"\textquotedbl{}",
    "∞": r"$\infty$",
    NOTHING: r"\textendash{}",
    MINUS: "$-$",
}

#: What tables in LaTeX need: a command that makes what is too wide for the page as narrow as that.
LATEX_HEAD = r"""% Tables for \input{tables.tex}. They need \usepackage{booktabs,graphicx} and \usepackage[T1]{fontenc}.
% Letters of other scripts need XeLaTeX or LuaLaTeX.
\providecommand{\fitline}[1]{\resizebox{\ifdim\width>\linewidth\linewidth\else\width\fi}{!}{#1}}
"""


@dataclass(frozen=True)
class Table:
    """A table of texts.

    Attributes
    ----------
    name : str
        By which LaTeX refers to it.
    caption : str
    header : list of str
    rows : list of list of str
    left : int
        How many columns hold names and are set to the left; the others hold numbers.
    notes : list of str
        Sentences below it.
    for_papers : bool
        Whether it is among the tables in LaTeX; lists of long texts are not.
    """

    name: str
    caption: str
    header: list[str]
    rows: list[list[str]]
    left: int = 1
    notes: list[str] = field(default_factory=list)
    for_papers: bool = True

    def markdown(self) -> str:
        """Return the table in Markdown with its caption above and its notes below."""
        marks = [":--" if k < self.left else "--:" for k in range(len(self.header))]
        lines = [_markdown_row(row) for row in (self.header, marks, *self.rows)]
        notes = [f"\n{escape_markdown(note)}" for note in self.notes]
        return "\n".join([f"**{escape_markdown(self.caption)}**\n", *lines, *notes]) + "\n"

    def latex(self) -> str:
        """Return the table in LaTeX, for the package booktabs and the command of `LATEX_HEAD`."""
        columns = "l" * self.left + "r" * (len(self.header) - self.left)
        header = [_latex_header(text, column) for text, column in zip(self.header, columns, strict=True)]
        lines = [
            r"\begin{table}[htbp]",
            r"  \centering\footnotesize\setlength{\tabcolsep}{4pt}",
            f"  \\caption{{{escape_latex(' '.join([self.caption, *self.notes]))}}}",
            f"  \\label{{tab:{self.name}}}\\smallskip",
            f"  \\fitline{{\\begin{{tabular}}{{{columns}}}",
            r"    \toprule",
            f"    {_latex_row(header)}",
            r"    \midrule",
            *(f"    {_latex_row([escape_latex(cell) for cell in row])}" for row in self.rows),
            r"    \bottomrule",
            r"  \end{tabular}}",
            r"\end{table}",
        ]
        return "\n".join(lines) + "\n"

    def html(self) -> str:
        """Return the table in HTML, in a frame that scrolls where the screen is too narrow."""
        lines = ['<div class="scroll"><table>', f"<caption>{html.escape(self.caption)}</caption>", "<thead><tr>"]
        lines += [f'<th scope="col"{self._html_class(k)}>{html.escape(text)}</th>' for k, text in enumerate(self.header)]
        lines.append("</tr></thead><tbody>")
        for row in self.rows:
            cells = []
            for k, text in enumerate(row):
                if k < self.left:
                    cells.append(f'<th scope="row" class="name">{html.escape(text)}</th>')
                else:
                    cells.append(f"<td>{html.escape(text)}</td>")
            lines.append(f"<tr>{''.join(cells)}</tr>")
        lines.append("</tbody></table></div>")
        lines += [f'<p class="note">{html.escape(note)}</p>' for note in self.notes]
        return "\n".join(lines) + "\n"

    def _html_class(self, column: int) -> str:
        return ' class="name"' if column < self.left else ""


def escape_markdown(text: str) -> str:
    """Return a text in which Markdown sees no markup."""
    for mark in "\\`*_<>|":
        text = text.replace(mark, f"\\{mark}")
    # Brackets alone are no link.
    return " ".join(text.replace("](", "]\\(").splitlines())


def escape_latex(text: str) -> str:
    """Return a text in which LaTeX sees no commands, and joins no letters."""
    parts = _JOINED.split(" ".join(text.splitlines()))
    return "{}".join("".join(_LATEX.get(letter, letter) for letter in part) for part in parts)


def _markdown_row(cells: Sequence[str]) -> str:
    return f"| {' | '.join(escape_markdown(cell) for cell in cells)} |"


def _latex_row(cells: Sequence[str]) -> str:
    """Return a row of cells that are in LaTeX already."""
    return _no_argument(" & ".join(cells)) + r" \\"


def _latex_header(text: str, side: str) -> str:
    """Return a text as the head of a column that is set to the left or right, in several lines if it is long."""
    lines = [_no_argument(escape_latex(line)) for line in textwrap.wrap(text, 13, break_long_words=False)]
    if len(lines) < 2:
        return escape_latex(text)
    return "\\begin{tabular}[b]{@{}" + side + "@{}}" + r"\\".join(lines) + r"\end{tabular}"


def _no_argument(line: str) -> str:
    """Return a line that the command at the end of the one before, \\\\ or \\midrule, does not take for its argument."""
    return re.sub(r"^\s*([\[*])", r"{\1}", line)


def csv_text(header: Sequence[str], rows: Iterable[Sequence]) -> str:
    """Return rows as CSV: numbers in full precision, ``inf`` as such, NaN and None as nothing."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(header)
    writer.writerows([_plain(value) for value in row] for row in rows)
    return text.getvalue()


def _plain(value):
    if value is None or (isinstance(value, float) and math.isnan(value)):
        return ""
    if isinstance(value, float):
        # A whole number needs no point, and numpy's own floats would name their type.
        return int(value) if value.is_integer() and abs(value) < 2**53 else float(value)
    return value


def count(value: float) -> str:
    """Return a number of evaluations or the like."""
    return _special(value) or f"{value:.0f}"


def ratio(value: float) -> str:
    """Return a ratio with four decimals; what is below 1 is never shown as 1."""
    shown = _special(value) or f"{value:.4f}"
    return "0.9999" if shown == "1.0000" and value < 1.0 else shown


def percent(value: float) -> str:
    """Return a share in percent; what is below 1 is never shown as 100 %, and what is above 0 never as 0 %."""
    if _special(value):
        return _special(value)
    shown = f"{100.0 * value:.1f}"
    if shown == "100.0" and value < 1.0:
        shown = ">99.9"
    elif shown == "0.0" and value > 0.0:
        shown = "<0.1"
    return f"{shown.removesuffix('.0')} %"


def significant(value: float) -> str:
    """Return a number with three significant digits."""
    if _special(value):
        return _special(value)
    if value == 0.0:
        return "0"
    if 1e-4 <= abs(value) < 1e6:
        return f"{value:.0f}" if abs(value) >= 999.5 else f"{value:#.3g}".removesuffix(".")
    return f"{value:.2e}"


def probability(value: float) -> str:
    """Return a p value with three decimals; what is below 0.05 is never shown as 0.050."""
    shown = _special(value) or ("<0.001" if value < 0.001 else f"{value:.3f}")
    return "<0.050" if shown == "0.050" and value < 0.05 else shown


def signed(value: float) -> str:
    """Return an effect size with three decimals and, if it is negative, a minus sign rather than a hyphen."""
    return _special(value) or f"{value:.3f}".replace("-", MINUS)


def spread(quartiles: Iterable[float], show: Callable[[float], str]) -> str:
    """Return a median with its quartiles, ``0.98 [0.97, 0.99]``, or the value alone if all are equal."""
    low, middle, high = (show(value) for value in quartiles)
    return middle if low == middle == high else f"{middle} [{low}, {high}]"


def _special(value: float) -> str:
    if math.isnan(value):
        return NOTHING
    return "∞" if value == math.inf else ""
