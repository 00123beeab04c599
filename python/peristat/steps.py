"""A run as a sequence of steps."""

import atexit
import queue
import threading
import weakref
from typing import TYPE_CHECKING, Any

from ._package import load_core

if TYPE_CHECKING:
    from ._core import Step as Step
    from .run import Run
else:
    Step = load_core().Step


class Steps:
    """The accepted steps of a run, one by one: the run waits while the loop's body works.

    Leaving the loop, `close`, or the end of a `with` block ends the run after the present step; the
    results are then closed, and `run` has them. What the run raises is raised in the loop.
    """

    def __init__(self, start):
        self._told = queue.SimpleQueue()  # steps, at last the end
        self._exchange = _Exchange(self._told)
        self._run, self._step = None, None
        self._thread = threading.Thread(
            target=_work, args=(start, self._exchange), name="peristat", daemon=True
        )
        self._is_started = False
        # The thread must have ended before Python does.
        self._close = weakref.finalize(self, _end, self._exchange, self._thread)

    @property
    def run(self) -> "Run":
        """The `Run`, whose results are closed first if it is still going on.

        Raises:
            RuntimeError: there is none: no step has been asked for, or the run has ended by an exception.
        """
        self.close()
        if self._run is None:
            raise RuntimeError("there is no run: no step has been asked for, or an exception has ended it")
        return self._run

    def __iter__(self) -> "Steps":
        return self

    def __next__(self) -> "Step":
        if not self._is_started:
            self._is_started = True
            self._thread.start()
        elif self._step is None:
            raise StopIteration
        else:
            self._exchange.go_on()
        return self._next_told()

    def close(self) -> None:
        """Ends the run after the present step."""
        if self._is_started and self._step is not None:
            self._exchange.stop()
            while True:  # a step may have been on its way
                try:
                    self._next_told()
                except StopIteration:
                    return
        self._is_started = True

    def __enter__(self) -> "Steps":
        return self

    def __exit__(self, *_: Any) -> None:
        self.close()

    def _next_told(self):
        self._step = None
        try:
            told = self._told.get()
        except BaseException:  # an interrupt from the keyboard, while the run searches
            self._exchange.stop()
            self._thread.join()
            raise
        if isinstance(told, _End):
            self._thread.join()
            self._run = told.run
            if told.error is not None:
                raise told.error
            raise StopIteration
        self._step = told
        return told


class _End:
    def __init__(self, run=None, error=None):
        self.run, self.error = run, error


class _Exchange:
    """What the thread of the run and that of the loop say to each other."""

    def __init__(self, told):
        self._told, self._may_go, self._stops = told, threading.Semaphore(0), False

    def __call__(self, step):
        """The run tells a step: it waits until the loop asks for the next one."""
        if not self._stops:
            self._told.put(step)
            self._may_go.acquire()
        if self._stops:
            step.stop("the loop over its steps was left")

    def is_left(self):
        """The run asks now and then, also in the midst of a step."""
        return self._stops

    def go_on(self):
        self._may_go.release()

    def stop(self):
        self._stops = True
        self._may_go.release()

    def end(self, end):
        self._told.put(end)


_open = {}  # threads of runs, and their exchanges


def _work(start, exchange):
    _open[threading.current_thread()] = exchange
    try:
        exchange.end(_End(run=start(exchange)))
    except BaseException as error:
        exchange.end(_End(error=error))
    finally:
        del _open[threading.current_thread()]


def _end(exchange, thread):
    exchange.stop()
    if thread.is_alive() and thread is not threading.current_thread():
        thread.join()


@atexit.register  # after the compiled part, and so called before it: it waits for all runs
def _end_all():
    for thread, exchange in list(_open.items()):
        _end(exchange, thread)
