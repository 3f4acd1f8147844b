"""The source papers, number by number: published, computed, and who is right."""

__all__ = ["PAPERS"]

#: Keys of the papers: each names a module of this folder with its `TITLE` and `rows()`.
PAPERS = (
    "kelly2018",
    "ballard1980",
    "yu2018",
    "lou2017",
    "lou2019",
    "areostationary",
    "montenbruck2018",
    "lemoine1999",
)
