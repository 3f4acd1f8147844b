"""A cluster with TLS: certificates of an authority made for the test, and wrong ones."""

import shutil
import subprocess

import pytest
from trade_processes import CANDIDATES, DaskProcesses, Trade

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(not shutil.which("openssl"), reason="no openssl to make certificates"),
]


def authority(folder, name):
    """Make an authority (NAME-ca.pem) and a certificate of it with its key; return the three."""

    def openssl(*arguments):
        subprocess.run(["openssl", *map(str, arguments)], check=True, capture_output=True)

    ca, cert, key = (folder / f"{name}-{part}.pem" for part in ("ca", "cert", "key"))
    curve = ("-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1", "-nodes", "-days", 1)
    ca_key, request = folder / f"{name}-ca-key.pem", folder / f"{name}.csr"
    openssl("req", "-x509", *curve, "-keyout", ca_key, "-out", ca, "-subj", f"/CN={name}")
    openssl("req", "-new", *curve[:4], "-nodes", "-keyout", key, "-out", request, "-subj", "/CN=me")
    openssl(
        "x509", "-req", "-in", request, "-CA", ca, "-CAkey", ca_key, "-CAcreateserial",
        "-days", 1, "-out", cert,
    )  # fmt: skip
    return ca, cert, key


def given(ca, cert, key):
    return ["--tls-ca", ca, "--tls-cert", cert, "--tls-key", key]


@pytest.fixture
def refused(run, killed_study, tmp_path):
    """What the program says of options that it refuses before any work."""

    def call(*options):
        code, _, message = run("trade", killed_study, "--store", tmp_path / "store", *options)
        assert code == 2
        return message

    return call


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    return authority(tmp_path_factory.mktemp("tls"), "ours")


@pytest.fixture(scope="module")
def secure(files, killed_study, tmp_path_factory):
    """Give the address of a scheduler with two workers that speak TLS only."""
    pytest.importorskip("distributed")
    folder = tmp_path_factory.mktemp("secure")
    environment = Trade(killed_study, folder / "store").environment
    options = [
        option
        for name, file in zip(("ca-file", "cert", "key"), files, strict=True)
        for option in (f"--tls-{name}", file)
    ]
    dask = DaskProcesses(folder, environment, options)
    _, address = dask.scheduler("--host", "tls://127.0.0.1")
    for _ in range(2):
        dask.worker(address)
    yield address
    dask.end()


@pytest.fixture
def trade(killed_study, tmp_path):
    return Trade(killed_study, tmp_path / "store")


def test_the_same_is_found_with_tls(trade, secure, files, undisturbed):
    summary = trade.start("--scheduler", secure, *given(*files)).finish()
    assert summary["computed"]["screen"] == CANDIDATES
    trade.check_undisturbed(undisturbed)


def test_certificates_of_another_authority_are_refused(trade, secure, tmp_path):
    others = authority(tmp_path, "theirs")
    message = trade.start("--scheduler", secure, *given(*others)).finish(2)
    assert "no connection" in message and "certificate" in message.lower()
    assert message.count("\n") <= 2


def test_a_scheduler_with_tls_wants_certificates(trade, secure):
    message = trade.start("--scheduler", secure).finish(2)
    assert "needs certificates; give --tls-ca, --tls-cert and --tls-key" in message
    plain = secure.replace("tls://", "tcp://")
    assert "whether it has TLS" in trade.start("--scheduler", plain).finish(2)


@pytest.mark.parametrize("place", [0, 1, 2])
def test_files_that_are_no_certificates_are_refused(refused, files, tmp_path, place):
    pytest.importorskip("distributed")
    wrong = list(files)
    wrong[place] = tmp_path / "text.pem"
    wrong[place].write_text("not a certificate")
    address = ("--scheduler", "tls://127.0.0.1:9")
    message = refused(*address, *given(*wrong))
    assert str(wrong[place]) in message and "(PEM)" in message
    wrong[place] = tmp_path / "missing.pem"
    message = refused(*address, *given(*wrong))
    assert "missing.pem: no such file" in message


def test_an_address_without_tls_goes_with_no_certificates(refused, files):
    pytest.importorskip("distributed")
    message = refused("--scheduler", "tcp://127.0.0.1:9", *given(*files))
    assert "with certificates, write it as tls://host:port" in message
