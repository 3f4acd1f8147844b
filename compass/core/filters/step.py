"""One step of any filter, chosen by number, so that a Monte Carlo run is one compiled loop."""

from compass.core.filters.ci import ci_step
from compass.core.filters.ci_feedback import ci_feedback_step
from compass.core.filters.dcifaif import dcifaif_step
from compass.core.filters.ekf import ekf_step
from compass.core.filters.federated import federated_step
from compass.core.filters.information import information_start, information_step
from compass.core.filters.iterated import iterated_step
from compass.core.jit import kernel

EKF, ITERATED, INFORMATION, CI, CI_FEEDBACK, DCIFAIF, FEDERATED = range(7)


@kernel
def start(algorithm, settings, bank, work):
    """Make ready what a filter carries besides the start; False if it cannot be made."""
    if algorithm == INFORMATION:
        return information_start(settings, bank, work)
    return True


@kernel
def step(algorithm, settings, epoch, bank, work):
    """Move a bank of estimates over one epoch; False if the filter diverged."""
    bank.gated[:] = False
    if algorithm == EKF:
        return ekf_step(settings, epoch, bank, work)
    if algorithm == ITERATED:
        return iterated_step(settings, epoch, bank, work)
    if algorithm == INFORMATION:
        return information_step(settings, epoch, bank, work)
    if algorithm == CI:
        return ci_step(settings, epoch, bank, work)
    if algorithm == CI_FEEDBACK:
        return ci_feedback_step(settings, epoch, bank, work)
    if algorithm == DCIFAIF:
        return dcifaif_step(settings, epoch, bank, work)
    return federated_step(settings, epoch, bank, work)
