"""The page of a source paper: whether it is reproduced, what it has wrong, then every number."""

from collections.abc import Sequence

from compass import __version__
from compass.api.reproduce import ReproduceResult, comparison_table
from compass.document import Answer, Answers, Section, Sentence
from compass.document.blocks import Block
from compass.inputs.shipped import of_paper
from compass.pages.page import render
from compass.papers.verdict import Row, Verdict
from compass.words import capital

#: What each verdict means, in the order of what a reader asks, and the words for its table.
MEANINGS = {
    Verdict.REPRODUCED: ("Reproduced", "within the tolerance printed beside each"),
    Verdict.ERRATUM: ("The paper is wrong, and shown to be", "by numbers computed here"),
    Verdict.DIFFERS: ("Differ, the paper not shown to be wrong", "beyond that tolerance"),
    Verdict.FITTED: ("Agree because a parameter was chosen so", "no test of the paper"),
    Verdict.COMPUTED: ("Computed here, nothing published", "nothing to compare with"),
}


def paper_report(result: ReproduceResult, command: str = "") -> tuple[str, list[Section]]:
    """Make the page (HTML text) and the sections of a paper's report.

    Parameters
    ----------
    result
        The paper's numbers beside the computed ones.
    command
        The command line, for provenance.
    """
    sections = paper_sections(result)
    told = f"Every number of the paper that can be computed, {len(result.rows)} in all."
    rows = [
        ("command", command or "made from Python"),
        ("version", f"compass {__version__}"),
        ("paper", result.paper),
    ]
    listed = "\n".join(f"{row.where}: {row.item}" for row in result.rows)
    return render(result.title, told, sections, rows, listed), sections


def paper_sections(result: ReproduceResult) -> list[Section]:
    """The answer, differences, errors, figures, then all by verdict."""
    figures = result.pictures()
    sections = [_answer(result)]
    if result.differs:
        sections.append(Section("What differs", tuple(Sentence(_told(r)) for r in result.differs)))
    if wrong := _of(result, Verdict.ERRATUM):
        sections.append(Section("What the paper has wrong", tuple(map(Sentence, _errors(wrong)))))
    if figures:
        sections.append(Section("Figures of the paper, computed", figures))
    tables: list[Block] = [
        comparison_table(title, rows)
        for kind, (title, _) in MEANINGS.items()
        if (rows := _of(result, kind))
    ]
    sections.append(Section("Every number", tuple(tables)))
    return sections


def _answer(result: ReproduceResult) -> Section:
    """Whether the paper can be believed, in one sentence and a table of counts."""
    counts, wrong = result.counts, len(_of(result, Verdict.ERRATUM))
    asked = len(result.rows) - counts[Verdict.COMPUTED]
    agree = counts[Verdict.REPRODUCED] + counts[Verdict.FITTED]
    lead = f"{agree} of {asked} published numbers and statements are reproduced"
    lead += f"; {wrong} {'is' if wrong == 1 else 'are'} shown to be wrong" if wrong else ""
    left = len(result.differs)
    lead += (
        "; none differs without that."
        if not left
        else f"; {left} differ{'s' if left == 1 else ''}, and the paper is not shown to be wrong."
    )
    rows = [
        Answer(title, _share(kind, counts[kind], asked), _mark(kind, counts[kind]), how)
        for kind, (title, how) in MEANINGS.items()
        if counts[kind] or kind is Verdict.DIFFERS
    ]
    if proposed := of_paper(result.paper):
        pages = "; ".join(f"compass report designs/{name}.toml" for name in proposed)
        asked_of_it = "To build what it proposes, how long that lasts, how accurate it is"
        rows.append(Answer(asked_of_it, f"see {pages}", None, "a page each"))
    table = Answers("Published and computed", tuple(rows))
    return Section("The answer", (Sentence(lead), table))


def _share(kind: Verdict, count: int, asked: int) -> str:
    """How many of what is published; of what is not, how many."""
    return f"{count}" if kind is Verdict.COMPUTED else f"{count} of {asked}"


def _mark(kind: Verdict, count: int) -> bool | None:
    """Whether a count is good or bad; neither for what only informs."""
    return count == 0 if kind is Verdict.DIFFERS else None


def _of(result: ReproduceResult, kind: Verdict) -> tuple[Row, ...]:
    return tuple(row for row in result.rows if row.verdict is kind)


def _errors(wrong: Sequence[Row]) -> list[str]:
    """Each error of the paper once, with every number that it spoils."""
    spoilt: dict[str, list[str]] = {}
    for row in wrong:
        assert row.erratum is not None
        spoilt.setdefault(row.erratum.reason, []).append(f"{row.item} ({row.where})")
    return [f"{capital(reason)}: {'; '.join(r)}." for reason, r in spoilt.items()]


def _told(row: Row) -> str:
    """What a row says, what is found instead and why, in one sentence."""
    unit = "" if row.unit in ("", "1") else f" {row.unit}"
    made = row.computed if isinstance(row.computed, str) else f"{row.computed:.6g}"
    return f"{row.where}, {row.item}: {row.published}{unit} published, {made}{unit} computed. " + (
        f"{capital(row.reason)}" + "." * (not row.reason.endswith("."))
    )
