"""Errors that a user can mend: each message names the object, what is wrong and what to do."""


class PccError(Exception):
    """Base of every error that this add-on raises on purpose; its text is shown to the user as it is."""


class ProbeError(PccError):
    """A probe whose transform or settings cannot be baked."""


class BakeError(PccError):
    """A bake that could not be done or stored."""


class Cancelled(PccError):
    """The user stopped the job; everything is as it was before."""
