import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text()


def blocks(language):
    return re.findall(rf"```{language}\n(.*?)```", README, re.DOTALL)


def test_python_of_the_readme_runs(monkeypatch, capsys):
    monkeypatch.chdir(ROOT)
    code = "\n".join(blocks("python"))
    exec(compile(code, "README.md", "exec"), {})
    printed = capsys.readouterr().out
    assert "4 satellites in view at least" in printed


def test_design_of_the_readme_reads():
    from compass.inputs import read_design_text

    assert read_design_text(blocks("toml")[0]).constellation.size == 15


def test_study_of_the_readme_reads():
    from compass.inputs.study import read_study_text

    study = read_study_text(blocks("toml")[1], folder=ROOT / "designs")
    assert study.entry is not None and study.compare is not None


def test_commands_of_the_readme_exist():
    named = set(re.findall(r"^\| `compass (\w+)", README, re.MULTILINE))
    script = "from compass.cli.main import main; import sys; sys.argv = ['c', '--help']; main()"
    listed = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True).stdout
    assert named
    for name in named:
        assert re.search(rf"^  {name} ", listed, re.MULTILINE), name


def test_every_command_is_in_the_readme():
    files = {p.stem for p in (ROOT / "compass" / "cli").glob("*.py")}
    for name in files - {"__init__", "main", "shared"}:
        assert f"`compass {name}" in README, name


def test_ci_runs_the_readmes_test_command():
    command = next(block.strip() for block in blocks("sh") if "tox" in block)
    assert command in (ROOT / ".ci" / "run").read_text()
