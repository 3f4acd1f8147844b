"""What the program does whatever the command: exit codes, streams, interruption, its words."""

import os
import resource
import signal
import subprocess
import sys
import time
from pathlib import Path

import click
import pytest

from compass.cli import main as program
from compass.cli.refusals import in_words_of_the_user
from compass.errors import ArgumentError
from compass.pictures.style import new_figure

COMMANDS = program.program.list_commands(click.Context(program.program))
PROGRAM = [sys.executable, "-m", "compass"]


@pytest.fixture(scope="module")
def seed(designs):
    return designs / "compass-15-5-1.toml"


@pytest.fixture
def meets(monkeypatch, run):
    """Run a command of a file and an option that meets something."""

    def call(what, *arguments):
        @click.command()
        @click.argument("design", type=click.Path(path_type=Path))
        @click.option("--duration-h", type=float)
        def command(**_):
            what()

        monkeypatch.setattr(program, "command", lambda _: program.prepared(command))
        return run("show", "x.toml", *arguments)

    return call


def options(kind):
    """Every option of a kind of every command, long name."""
    for name in COMMANDS:
        for parameter in program.program.get_command(None, name).params:
            if isinstance(parameter, click.Option) and isinstance(parameter.type, kind):
                yield name, max(parameter.opts, key=len), parameter.nargs


@pytest.mark.parametrize("value", [2**63, -(2**63) - 1, 10**30])
@pytest.mark.parametrize(("command", "option", "count"), list(options(click.types.IntParamType)))
def test_a_whole_number_that_no_kernel_takes_is_refused_by_its_option(
    run, command, option, count, value
):
    code, out, err = run(command, option, *[value] * count)
    assert (code, out) == (2, "")
    assert f"Invalid value for '{option}': {value} is not in the range" in err


@pytest.mark.parametrize(
    ("arguments", "meant"),
    [
        (["new", "desing"], "design"),
        (["schema", "sceanrio"], "scenario"),
        (["reproduce", "kely2018"], "kelly2018"),
        (["search", "--pattern", "walker-dleta"], "walker-delta"),
        (["serach", "--fold", "4"], "search"),
        (["shwo", "mine.toml"], "show"),
        (["new", "galaxy"], None),
        (["galaxy"], None),
        (["map", "x.toml", "--step-dge", "3"], "--step-deg"),
        (["trade", "x.toml", "--store", "y"], None),
    ],
)
def test_of_a_mistyped_word_the_one_that_is_near_is_offered(run, arguments, meant):
    code, out, err = run(*arguments)
    assert (code, out) == (2, "")
    assert err.count("Did you mean") == (meant is not None)
    assert meant is None or err.rstrip().endswith(f"Did you mean '{meant}'?")


def test_no_help_recites_how_large_a_whole_number_may_be(run):
    for command in {command for command, _, _ in options(click.types.IntParamType)}:
        code, out, _ = run(command, "--help")
        assert (code, str(2**63 - 1) in out) == (0, False), command


@pytest.mark.parametrize(
    ("message", "arguments", "said"),
    [
        ("step = nan: no", ["x.toml", "--step-deg", "nan"], "--step-deg = nan: no"),
        ("step_deg: no", ["x.toml", "--step-deg", "3"], "--step-deg: no"),
        ("step_deg = 3: no", ["x.toml"], "x.toml: step_deg = 3: no"),  # from the file, then
        ("stepping = 3: no", ["x.toml", "--step-deg", "3"], "x.toml: stepping = 3: no"),
        ("fold = 0: no", ["x.toml", "--fold", "0"], "--fold = 0: no"),
        ("it comes down", ["x.toml"], "x.toml: it comes down"),
        ("x.toml: it comes down", ["x.toml"], "x.toml: it comes down"),
        ("--fold: no", ["x.toml"], "--fold: no"),
        (
            "tls_ca, fold and step_deg: together",
            ["x.toml", "--tls-ca", "a"],
            "--tls-ca, --fold and --step-deg: together",
        ),
        ("sites and fold: no", ["x.toml", "--tls-ca", "a"], "x.toml: sites and fold: no"),
    ],
)
def test_a_refusal_names_the_option_or_the_file(message, arguments, said):
    with program.command("map").make_context("map", arguments) as context:
        assert in_words_of_the_user(message, context) == said


@pytest.mark.parametrize(
    ("message", "said"),
    [
        (
            "orbit: needs exactly one of radius_km and repeat; found none",
            "--orbit: needs exactly one of --radius-km and --repeat; found none",
        ),
        ("max_satellites = 0: one or more", "--max-satellites = 0: one or more"),
        ("fold, orbit and repeat; fold 3", "--fold, --orbit and --repeat; fold 3"),
        (
            "max_satellites = 3: not with orbit and repeat",
            "--max-satellites = 3: not with --orbit and --repeat",
        ),
        ("orbiting: no_option of ours", "orbiting: no_option of ours"),
    ],
)
def test_a_command_without_a_file_names_its_options_alone(message, said):
    with program.command("search").make_context("search", ["--max-satellites", "3"]) as context:
        assert in_words_of_the_user(message, context) == said


@pytest.mark.parametrize(
    ("files", "said"),
    [
        (["a.toml"], "a.toml: station: none"),
        (["a.toml", "b.toml"], "a.toml, b.toml: station: none"),
    ],
)
def test_a_refusal_names_every_file_it_may_be_about(files, said):
    with program.command("series").make_context("series", files) as context:
        assert in_words_of_the_user("station: none", context) == said


def test_a_refusal_from_inside_comes_out_in_words_of_the_user(meets):
    def refuse():
        raise ArgumentError("duration_h = 3: is not to be")

    assert meets(refuse, "--duration-h", 3) == (2, "", "--duration-h = 3: is not to be\n")
    assert meets(refuse)[2] == "x.toml: duration_h = 3: is not to be\n"


def test_what_an_interruption_turns_into_is_one_still(meets):
    def compiled():
        try:
            os.kill(os.getpid(), signal.SIGINT)
            signal.pause()
        except KeyboardInterrupt:
            raise SystemError("kernel returned a result with an exception set") from None

    code, out, err = meets(compiled)
    assert (code, out) == (130, "") and err.endswith("nothing half-written was left behind\n")
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


def test_an_interruption_that_nothing_can_raise_is_raised_again(meets):
    """As in the callbacks by which an import clears up its locks: Python prints it and goes on."""

    class Lock:
        def __del__(self):
            os.kill(os.getpid(), signal.SIGINT)
            signal.pause()

    def look():
        lock = Lock()
        del lock
        began = time.monotonic()
        while time.monotonic() - began < 20.0:
            time.sleep(0.01)
        pytest.fail("went on")

    hook = sys.unraisablehook
    code, out, err = meets(look)
    assert (code, out) == (130, "") and err.endswith("nothing half-written was left behind\n")
    assert sys.unraisablehook is hook


def test_an_interruption_waits_for_llvm(meets):
    """What is raised out of Python into LLVM, which asks for compiled code, kills the process."""
    library = {"__name__": "llvmlite.binding.executionengine"}
    exec("def asks(answer):\n    answer()\n    return 'all is well'", library)
    answers = []

    def look():
        answers.append(library["asks"](lambda: os.kill(os.getpid(), signal.SIGINT)))
        began = time.monotonic()
        while time.monotonic() - began < 20.0:
            time.sleep(0.01)
        pytest.fail("went on")

    code, out, err = meets(look)
    assert (code, out) == (130, "") and err.endswith("nothing half-written was left behind\n")
    assert answers == ["all is well"]


@pytest.mark.parametrize("holds", [True, False])
def test_an_answer_cut_short_is_an_interruption_whatever_it_says(meets, holds):
    """A search that ^C ends prints the bounds it has: that is neither done nor refuted."""

    def look():
        try:
            os.kill(os.getpid(), signal.SIGINT)
            signal.pause()
        except KeyboardInterrupt:
            if not holds:
                raise click.exceptions.Exit(program.CLAIM_FAILS) from None

    code, _, err = meets(look)
    assert (code, err) == (130, "interrupted; what is printed is what was known by then\n")


def test_a_home_that_cannot_be_written_is_no_matter_of_pictures(tmp_path):
    script = (
        "import sys\n"
        "from compass.cli.main import main\n"
        "sys.argv = ['compass', '--version']\n"
        "try: main()\n"
        "except SystemExit: pass\n"
        "import matplotlib\n"
        "assert matplotlib.get_configdir()"
    )
    nowhere = {**os.environ, "MPLCONFIGDIR": os.devnull + "/none", "TMPDIR": str(tmp_path)}
    done = subprocess.run([sys.executable, "-c", script], env=nowhere, capture_output=True)
    assert (done.returncode, done.stderr) == (0, b"")


def test_the_first_import_can_be_interrupted():
    script = (
        "import sys\n"
        "class Stop:\n"
        "    def find_spec(self, name, *_):\n"
        "        if name == 'click': raise KeyboardInterrupt\n"
        "sys.meta_path.insert(0, Stop())\n"
        "from compass.__main__ import main\nmain()\n"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
    assert (done.returncode, done.stdout) == (130, "")
    assert done.stderr == "interrupted; nothing half-written was left behind\n"


def test_an_interruption_while_python_ends_is_one_as_any_other():
    """It would kill the process by its signal, whose status is not 130 but for a shell."""
    script = (
        "import atexit, os, signal, sys\n"
        "atexit.register(lambda: os.kill(os.getpid(), signal.SIGINT) or signal.pause())\n"
        "sys.argv = ['compass', '--version']\n"
        "from compass.__main__ import main\nmain()\n"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, timeout=60)
    assert (done.returncode, done.stderr) == (130, b"")


def test_a_failure_of_the_program_is_no_verdict(meets):
    code, out, err = meets(lambda: 1 / 0)
    assert (code, out) == (3, "") and err.endswith("ZeroDivisionError: division by zero\n")


@pytest.mark.parametrize(
    ("error", "said"),
    [
        (MemoryError(), "not enough memory; take fewer or larger steps"),
        (OSError(24, "Too many open files"), "the system refuses: Too many open files"),
        (FileNotFoundError(2, "No such file", "x"), "x: No such file; give another name"),
    ],
)
def test_what_the_system_refuses_is_one_line(meets, error, said):
    def refuse():
        raise error

    code, out, err = meets(refuse)
    assert (code, out) == (2, "") and err.startswith(said) and err.count("\n") == 1


@pytest.mark.parametrize(("kind", "option"), [("RLIMIT_AS", "-v"), ("RLIMIT_DATA", "-d")])
def test_no_room_for_the_libraries_is_one_line(kind, option):
    """OpenBLAS would end the program with 1, which means "refuted", LLVM's threads with 127."""

    def small():
        resource.setrlimit(getattr(resource, kind), (100_000_000, 100_000_000))

    done = subprocess.run([*PROGRAM, "show", "no.toml"], preexec_fn=small, capture_output=True)
    assert (done.returncode, done.stdout) == (2, b"")
    assert done.stderr.startswith(
        f"not enough memory: a limit of 0.1 GB (ulimit {option})".encode()
    )
    assert done.stderr.count(b"\n") == 1


def test_letters_that_are_boxes_are_told_once(meets):
    def draw():
        figure = new_figure(2, 1)
        for x in (0.1, 0.5):
            figure.text(x, 0.5, "a\U000f0000")
        figure.draw_without_rendering()

    said = "no font here has \U000f0000: drawn as boxes; install a font that has them"
    _, _, err = meets(draw)
    assert err.startswith(said) and err.count("\n") == 1
    assert meets(lambda: None)[2] == ""


@pytest.mark.parametrize("arguments", [["--help"], ["fold", "--help"], ["show", "{}"]])
def test_a_full_disk_under_the_output_is_one_line(seed, arguments):
    filled = [a.format(seed) for a in arguments]
    with open("/dev/full", "w") as full:
        done = subprocess.run([*PROGRAM, *filled], stdout=full, stderr=subprocess.PIPE, text=True)
        assert done.returncode == 2
        assert done.stderr == (
            "the output cannot be written: No space left on device; make room, or send it "
            "elsewhere\n"
        )
        done = subprocess.run([*PROGRAM, "show", "no.toml"], stdout=full, stderr=full)
        assert done.returncode == 2


@pytest.mark.parametrize("arguments", ["--help", "show {}"])
def test_a_reader_that_has_seen_enough_ends_it_well(seed, arguments):
    words = " ".join([*PROGRAM, arguments.format(seed)])
    script = f"{words} | head -c 1 > /dev/null; exit ${{PIPESTATUS[0]}}"
    done = subprocess.run(["bash", "-c", script], capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.parametrize("locale", ["C", "C.UTF-8"])
def test_a_file_name_that_is_not_utf8_goes_all_the_way(seed, tmp_path, locale):
    design = os.path.join(os.fsencode(tmp_path), b"d\xff.toml")
    with open(design, "wb") as file:
        file.write(seed.read_bytes().replace(b"COMPASS 15/5/1", "COMPASS 15/5/1 \u5317".encode()))
    where = dict(os.environ, LC_ALL=locale, PYTHONUTF8="0", PYTHONCOERCECLOCALE="0")
    arguments = [*map(os.fsencode, PROGRAM), b"show", design]
    done = subprocess.run(arguments, capture_output=True, env=where)
    assert (done.returncode, done.stderr) == (0, b"")
    found = subprocess.run([*arguments, b"--json"], capture_output=True, env=where)
    assert found.returncode == 0 and b"15/5/1" in found.stdout
    missing = subprocess.run([*arguments[:-1], design + b"x"], capture_output=True, env=where)
    assert missing.returncode == 2 and b"no such file" in missing.stderr


def test_a_key_cannot_command_the_terminal(run, tmp_path):
    path = tmp_path / "x.toml"
    path.write_text('name = "x"\n"\\u001b[31m" = 1\n')
    code, out, err = run("show", path)
    assert (code, out) == (2, "") and "\\x1b[31m = 1: unknown key" in err
    assert all(letter.isprintable() or letter == "\n" for letter in err)


@pytest.mark.slow  # a program of its own, which certifies what it maps
def test_a_backend_that_is_not_installed_is_none_of_ours(seed, tmp_path):
    where = dict(os.environ, MPLBACKEND="module://nowhere.to.be.found")
    arguments = [*PROGRAM, "map", str(seed), "--step-deg", "45", "--epochs", "1"]
    picture = tmp_path / "m.png"
    done = subprocess.run([*arguments, "--figure", str(picture)], env=where, capture_output=True)
    assert done.returncode == 0 and picture.read_bytes().startswith(b"\x89PNG")
