"""A load that a program turns while a run goes on."""

import bisect
from typing import TYPE_CHECKING

from ._numbers import real_number
from .errors import input_error

if TYPE_CHECKING:
    from ._core import Step


class Dial:
    """A value as a function of the load that grows piece by piece, to control a run step by step.

    A dial stands where an expression may stand: `displacement=[opening, "free"]`. Between two settings
    it is linear in the load factor, before the first and after the last it keeps their values, so
    that a step that is cut finds the values between.

        opening = ps.Dial(0.0)
        for step in body.steps():  # step 0 is the body at rest
            opening.turn_to(opening(step.load) + 1e-6, step, within=0.02)
    """

    def __init__(self, value: float = 0.0) -> None:
        self._loads, self._values = [0.0], [real_number("value", value)]
        self._step, self._load = 0, 0.0  # where it was turned last

    @property
    def value(self) -> float:
        """The last setting."""
        return self._values[-1]

    def turn_to(self, value: float, step: "Step | None" = None, *, within: float) -> None:
        """Goes to a value while the load factor grows by `within` from that of the step.

        Without a step it starts from load factor 0, before the run.

        Settings beyond the load factor of the step are dropped; what the run has used stays.

        Raises:
            InputError: a value is no number, `within` is not positive, or the load factor has decreased: a
                function of it can't have two values.
        """
        value, within = real_number("value", value), real_number("within", within)
        if not within > 0.0:
            raise input_error("within", repr(within), "must be a positive part of the load factor")
        number, now = (0, 0.0) if step is None else _place_of(step)
        if number > self._step and now < self._load:
            raise input_error(
                "step",
                repr(step),
                f"has a smaller load factor than the one before, {self._load!r}: a dial is a function of the load "
                "factor, which has to grow; let loading.table grow, and let the dial go down",
            )
        self._step, self._load = number, now
        here = self(now)
        keep = bisect.bisect_left(self._loads, now)
        self._loads[keep:] = [now, now + within]
        self._values[keep:] = [here, value]

    def __call__(self, load: float) -> float:
        load = float(load)
        k = bisect.bisect_right(self._loads, load)
        if k == 0:
            return self._values[0]
        if k == len(self._loads):
            return self._values[-1]
        before, after = self._loads[k - 1], self._loads[k]
        share = (load - before) / (after - before)
        return self._values[k - 1] + share * (self._values[k] - self._values[k - 1])


def _place_of(step):
    try:
        return int(step.number), float(step.load)
    except AttributeError:
        raise input_error("step", repr(step)[:60], "must be a step of a run") from None
