"""Who does the work, as the arguments of a command name them."""

from pathlib import Path
from typing import TYPE_CHECKING

from compass.errors import ArgumentError

if TYPE_CHECKING:
    from compass.study.cluster import Tls


def check_cluster(
    workers: int | None,
    scheduler: str | None,
    authority: str | Path | None,
    certificate: str | Path | None,
    key: str | Path | None,
) -> "Tls | None":
    """Return a cluster's certificates, if any are given; then all must be.

    Raises
    ------
    ArgumentError
        Workers of this machine beside a cluster, some certificates of three, or without a
        scheduler.
    """
    if scheduler is not None and workers is not None:
        raise ArgumentError("workers and scheduler: not both; a cluster has its own workers")
    if not any((authority, certificate, key)):
        return None
    if authority is None or certificate is None or key is None or scheduler is None:
        raise ArgumentError("tls_ca, tls_cert, tls_key and scheduler: all four go together")
    from compass.study.cluster import Tls

    return Tls(Path(authority), Path(certificate), Path(key))
